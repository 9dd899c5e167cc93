//! The picture as PNG: the SVG drawn with one bundled font, so that every machine makes the same pixels.
//!
//! In: SVG text. Out: the bytes of a PNG. Fonts of the system are never looked at.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use super::svg::FONT_FAMILY;

/// Latin, the signs of drawings and the Chinese characters of the texts; its licence stands beside it.
const FONT: &[u8] = include_bytes!("../../assets/turnwright-sans.otf");

/// Greatest side of a picture.
pub const PICTURE_SIDE_PX_MAX: u32 = 16_384;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureFault {
    /// The text is no SVG; what the reader said.
    NotAPicture(String),
    /// No size at all, or a side above [`PICTURE_SIDE_PX_MAX`].
    Size {
        /// Width asked for.
        width_px: u32,
        /// Height asked for.
        height_px: u32,
    },
    /// The pixels could not be packed; what the packer said.
    Packing(String),
}

impl std::fmt::Display for PictureFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotAPicture(why) => write!(f, "not a picture: {why}"),
            Self::Size { width_px, height_px } => {
                write!(
                    f,
                    "a picture of {width_px} by {height_px} pixels is outside 1 to {PICTURE_SIDE_PX_MAX}"
                )
            }
            Self::Packing(why) => write!(f, "the picture could not be packed: {why}"),
        }
    }
}

impl std::error::Error for PictureFault {}

/// Draws `svg` with `scale` pixels for each of its own.
pub fn write_png(svg: &str, scale: f32) -> Result<Vec<u8>, PictureFault> {
    let mut options = usvg::Options { font_family: FONT_FAMILY.to_owned(), ..usvg::Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family(FONT_FAMILY);
    let tree =
        usvg::Tree::from_str(svg, &options).map_err(|fault| PictureFault::NotAPicture(fault.to_string()))?;
    // A float that is too great, or no number, becomes a size that is refused.
    let width_px = (tree.size().width() * scale).ceil() as u32;
    let height_px = (tree.size().height() * scale).ceil() as u32;
    let fits = |side| (1..=PICTURE_SIDE_PX_MAX).contains(&side);
    let pixels = (fits(width_px) && fits(height_px)).then(|| tiny_skia::Pixmap::new(width_px, height_px));
    let Some(mut pixels) = pixels.flatten() else {
        return Err(PictureFault::Size { width_px, height_px });
    };
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|fault| PictureFault::Packing(fault.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Language;
    use crate::formats::svg::{PictureOptions, write_svg};
    use crate::path::PathRecorder;
    use crate::words::REPORT_TEXTS;
    use skrifa::MetadataProvider;
    use turnwright_units::{Length, Position, Radius};

    fn svg(language: Language) -> String {
        let home = Position::new(Radius::ZERO, Length::ZERO);
        let options = PictureOptions { language, ..PictureOptions::default() };
        write_svg(&PathRecorder::new(home, 1.0, 1.0), &options)
    }

    #[test]
    fn a_picture_is_a_png_of_the_size_asked_for() {
        for language in [Language::English, Language::Chinese] {
            let png = write_png(&svg(language), 1.5).expect("a picture");
            assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
            let side = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
            assert_eq!((side(16), side(20)), (1800, 1080));
            assert!(png.len() > 5_000, "there is something on it");
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        assert!(matches!(write_png("no svg", 1.0), Err(PictureFault::NotAPicture(_))));
        for scale in [0.0, -1.0, 1e9, f32::NAN] {
            assert!(
                matches!(write_png(&svg(Language::English), scale), Err(PictureFault::Size { .. })),
                "{scale}"
            );
        }
    }

    #[test]
    fn the_font_has_every_character_of_the_texts_and_is_small() {
        let characters = skrifa::FontRef::new(FONT).expect("a font").charmap();
        let has = |c: char| characters.map(c).is_some();
        assert!(has('A') && has('⌀') && has('▷') && has('∠') && has('\u{2212}') && !has('\u{1f600}'));
        let texts: serde_json::Value = serde_json::from_str(REPORT_TEXTS).expect("JSON");
        for (key, entry) in texts.as_object().expect("an object") {
            for tag in ["en", "zh"] {
                let text = entry[tag].as_str().expect("a text");
                let missing: Vec<char> = text.chars().filter(|c| !has(*c)).collect();
                assert!(missing.is_empty(), "{key}: run assets/make_font.py for {missing:?}");
            }
        }
        assert!(FONT.len() < 300_000);
    }
}
