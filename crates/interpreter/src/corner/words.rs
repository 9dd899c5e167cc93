//! The words of corners and drawing dimensions: which letters a control takes, and what they ask for.

use turnwright_control::policy::{CommaCornerWords, CornerWords, DrawingDimensions};
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_syntax::{Block, Word};
use turnwright_units::Length;

use super::Motion;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

/// Letters that may shape a corner or give an angle; [`Core::path_words`] knows which do on the control.
pub(crate) const LETTERS: &[u8] = b"ACDIKLQR";

/// What breaks the corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Chamfer,
    Fillet,
}

/// Between which elements a corner may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Two lines along the axes, at a right angle; the sign is the direction of the second.
    RightAngle,
    /// As at a right angle when the lines lie so, else as between any lines.
    PlainLetter,
    /// Any two lines.
    AnyLines,
    /// Any two cuts, lines or arcs.
    AnyCuts,
}

/// A word that breaks the corner at the end of its block.
#[derive(Clone, Debug)]
pub(super) struct CornerWord {
    pub(super) form: Form,
    pub(super) rule: Rule,
    pub(super) word: Word,
    /// A radius value, with its sign.
    pub(super) size: Length,
    pub(super) place: Place,
    pub(super) quote: String,
}

/// A word that gives the direction of a line.
#[derive(Clone, Debug)]
pub(super) struct AngleWord {
    /// Counter-clockwise from +Z.
    pub(super) rad: f64,
    pub(super) word: Word,
    pub(super) place: Place,
    pub(super) quote: String,
}

/// What a block says about its line besides X, Z, U and W.
#[derive(Debug, Default)]
pub(super) struct PathWords {
    pub(super) angle: Option<AngleWord>,
    pub(super) corner: Option<CornerWord>,
}

/// What a letter stands for.
enum Meaning {
    Angle,
    Corner(Form, Rule),
}

impl Core {
    /// Whether a word behind a comma makes a line run without an end point.
    #[cold]
    pub(crate) fn gives_angle(&self, block: &Block) -> bool {
        block.comma_word(b'A').is_some()
            && self.control.policies.corner_words == CornerWords::ChamferAndRadius
    }

    /// Whether a letter breaks corners on this control.
    pub(crate) fn breaks_corners(&self, word: &Word) -> bool {
        match self.control.policies.corner_words {
            CornerWords::LengthAndFillet => matches!(word.address, b'L' | b'D'),
            CornerWords::ChamferAndRadius => matches!(word.address, b'C' | b'I' | b'K' | b'R'),
        }
    }

    /// Words behind a comma belong to lines only.
    pub(crate) fn refuse_comma_words(&self, block: &Block) -> Result<(), Alarm> {
        match block.words.iter().find(|word| word.comma) {
            Some(word) if block.has_comma => Err(self.alarm("illegal-address", word)),
            _ => Ok(()),
        }
    }

    /// The words of a block that belong to its corner or give its angle.
    pub(super) fn path_words(&mut self, block: &Block, motion: Option<&Motion>) -> Result<PathWords, Alarm> {
        let mut found = PathWords::default();
        for word in &block.words {
            let is_wall = matches!(word.address, b'I' | b'K') && self.has_wall_words();
            if !word.comma && (!LETTERS.contains(&word.address) || is_wall) {
                continue;
            }
            match self.meaning(word, motion)? {
                Some(Meaning::Angle) => found.angle = Some(self.angle_word(word)?),
                Some(Meaning::Corner(form, rule)) => {
                    if found.corner.is_some() {
                        return Err(self.alarm("too-many-corner-words", word));
                    }
                    found.corner = Some(self.sized(form, rule, word)?);
                }
                None => {}
            }
        }
        if let (Some(_), Some(corner)) = (&found.angle, &found.corner)
            && corner.rule == Rule::RightAngle
        {
            // An angle beside a word of the right-angled corner.
            return Err(self.alarm("too-many-corner-words", &corner.word));
        }
        let has_angle = found.angle.is_some();
        found.corner = match found.corner {
            Some(corner) if self.is_out_of_range(&corner) => None,
            // A corner of no size is the plain corner of two lines.
            Some(corner) if corner.size.is_zero() => None,
            corner => corner,
        };
        if has_angle || found.corner.as_ref().is_some_and(|corner| corner.rule == Rule::AnyLines) {
            self.mention_option(block);
        }
        Ok(found)
    }

    /// What a letter means on this control; `motion` is `None` in arcs.
    fn meaning(&self, word: &Word, motion: Option<&Motion>) -> Result<Option<Meaning>, Alarm> {
        use Form::{Chamfer, Fillet};
        let policies = &self.control.policies;
        let meaning = match policies.corner_words {
            CornerWords::LengthAndFillet => match (word.address, word.comma) {
                (b'L', false) => Meaning::Corner(Chamfer, Rule::AnyCuts),
                (b'D', false) => Meaning::Corner(Fillet, Rule::AnyCuts),
                (b'Q', false) if motion.is_some() => Meaning::Angle,
                // The centre and the radius of an arc.
                (b'R' | b'I' | b'K', false) if motion.is_none() => return Ok(None),
                _ => return Err(self.strange_letter(word, motion)),
            },
            CornerWords::ChamferAndRadius => {
                let is_plain = self.settings.plain_corner_letters;
                let drawn = policies.drawing_dimensions == DrawingDimensions::Standard;
                let plain_rule = if is_plain && drawn { Rule::PlainLetter } else { Rule::RightAngle };
                let by_sign = if self.is_negative(word) { Rule::RightAngle } else { Rule::AnyLines };
                match (word.address, word.comma) {
                    (b'A' | b'C' | b'R', true) if self.refuses_comma() => {
                        return Err(self.alarm("drawing-sequence-illegal", word));
                    }
                    (b'A', true) => Meaning::Angle,
                    (b'A', false) if is_plain => Meaning::Angle,
                    (b'C', true) => Meaning::Corner(Chamfer, by_sign),
                    (b'R', true) => Meaning::Corner(Fillet, by_sign),
                    (b'C', false) if is_plain => Meaning::Corner(Chamfer, plain_rule),
                    (b'R', false) => Meaning::Corner(Fillet, plain_rule),
                    (b'I' | b'K', false) => Meaning::Corner(Chamfer, Rule::RightAngle),
                    _ => return Err(self.strange_letter(word, motion)),
                }
            }
        };
        match (&meaning, motion) {
            (Meaning::Corner(_, Rule::RightAngle), Some(Motion::Rapid(_))) => {
                Err(self.alarm("illegal-address", word))
            }
            (Meaning::Corner(Fillet, _), Some(Motion::Rapid(_))) => {
                let quote = self.quote(word.start, word.end);
                let diagnostic = Diagnostic::error("rapid-fillet").at(self.place(word));
                Err(self.finish(diagnostic.with("word", quote)))
            }
            _ => Ok(Some(meaning)),
        }
    }

    /// Plain letters are on, and the control then takes no comma.
    fn refuses_comma(&self) -> bool {
        self.settings.plain_corner_letters
            && self.control.policies.comma_corner_words == CommaCornerWords::RefusedWithPlainLetters
    }

    fn is_negative(&self, word: &Word) -> bool {
        self.number(word).is_ok_and(|number| number.is_negative && number.digits != 0)
    }

    fn strange_letter(&self, word: &Word, motion: Option<&Motion>) -> Alarm {
        let names_corner_elsewhere =
            !word.comma && matches!(word.address, b'C' | b'D' | b'I' | b'K' | b'L' | b'R');
        match motion {
            Some(Motion::Feed(_)) if names_corner_elsewhere => self.alarm("corner-letter-illegal", word),
            _ => self.alarm("illegal-address", word),
        }
    }

    fn sized(&mut self, form: Form, rule: Rule, word: &Word) -> Result<CornerWord, Alarm> {
        let size = self.radius(word, Role::CornerSize)?.0;
        self.missing_point(word);
        let (place, quote) = (self.place(word), self.quote(word.start, word.end));
        Ok(CornerWord { form, rule, word: *word, size, place, quote })
    }

    /// Where corners lie between any cuts, sizes below zero and above the limit are passed over.
    fn is_out_of_range(&mut self, corner: &CornerWord) -> bool {
        let most = Length::from_mm(i32::from(self.control.limits.corner_size_max_mm));
        let is_out = corner.rule == Rule::AnyCuts && (corner.size.signum() < 0 || corner.size > most);
        if is_out {
            self.warn("corner-size-ignored", &corner.word);
        }
        is_out
    }

    /// Degrees counter-clockwise from +Z, or the supplement by parameter.
    fn angle_word(&mut self, word: &Word) -> Result<AngleWord, Alarm> {
        let number = self.number(word)?;
        let in_degrees = match self.control.policies.corner_words {
            CornerWords::LengthAndFillet if number.has_point && !self.settings.cycle_words_in_mm => {
                return Err(self.alarm("point-not-allowed", word));
            }
            CornerWords::LengthAndFillet => self.settings.cycle_words_in_mm,
            CornerWords::ChamferAndRadius => number.has_point || self.settings.is_calculator,
        };
        let typed = number.digits as f64 / 10i64.pow(u32::from(number.scale.min(18))) as f64;
        let degrees = if in_degrees { typed } else { typed * self.angle_increment() };
        self.check_angle(word, in_degrees, degrees);
        let counted = if self.settings.angle_as_supplement { 180.0 - degrees } else { degrees };
        let (place, quote) = (self.place(word), self.quote(word.start, word.end));
        Ok(AngleWord { rad: counted.to_radians(), word: *word, place, quote })
    }

    /// The least increment of a rotary word, degrees: as fine as that of a length in millimetres.
    fn angle_increment(&self) -> f64 {
        self.settings.metric_increment.to_mm()
    }

    /// Warns about an angle below a degree that was typed as a whole number.
    fn check_angle(&mut self, word: &Word, in_degrees: bool, degrees: f64) {
        if in_degrees
            || degrees == 0.0
            || degrees.abs() >= 1.0
            || self.already_said("angle-without-point", self.at.line)
        {
            return;
        }
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::warning("angle-without-point").at(self.place(word)).with("word", quote);
        self.say(diagnostic.with("value", format!("{degrees}")));
    }

    /// Says once that the control has drawing dimensions as an option only.
    fn mention_option(&mut self, block: &Block) {
        if self.control.policies.drawing_dimensions == DrawingDimensions::Option
            && !self.already_said("drawing-option", 0)
            && let Some(word) = block.words.iter().find(|word| word.comma || word.address == b'A')
        {
            let quote = self.quote(word.start, word.end);
            self.say(Diagnostic::warning("drawing-option").at(self.place(word)).with("word", quote));
        }
    }
}
