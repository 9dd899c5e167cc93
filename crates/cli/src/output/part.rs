//! The forms in which a part is written, by the end of the file's name.

use std::path::Path;

use turnwright_export::formats::dxf::write_part_dxf;
use turnwright_export::formats::glb::write_glb;
use turnwright_export::formats::part_svg::{PartDrawing, write_part_svg};
use turnwright_export::formats::step::write_step;
use turnwright_export::formats::stl::write_stl;
use turnwright_export::mesh::Mesh;

/// A form of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PartFile {
    /// The drawing.
    Svg,
    /// The drawing in pixels; whoever writes it paints it.
    Png,
    /// The solid.
    Step,
    /// Triangles.
    Stl,
    /// Triangles with normals and materials.
    Glb,
    /// The half-section.
    Dxf,
}

impl PartFile {
    /// The ends of names, and what they stand for.
    pub(crate) const ENDS: [(&str, Self); 7] = [
        ("svg", Self::Svg),
        ("png", Self::Png),
        ("step", Self::Step),
        ("stp", Self::Step),
        ("stl", Self::Stl),
        ("glb", Self::Glb),
        ("dxf", Self::Dxf),
    ];

    /// The form that a name asks for.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let end = path.extension()?;
        Self::ENDS.iter().find(|(known, _)| end.eq_ignore_ascii_case(known)).map(|(_, form)| *form)
    }

    /// Whether it is made of triangles.
    pub(crate) const fn is_mesh(self) -> bool {
        matches!(self, Self::Stl | Self::Glb)
    }

    /// The file; nothing when the part has more edges than a solid may have.
    pub(crate) fn bytes(self, drawing: &PartDrawing<'_>, mesh: Option<&Mesh>) -> Option<Vec<u8>> {
        let shape = drawing.shape;
        match self {
            Self::Svg | Self::Png => Some(write_part_svg(drawing).into_bytes()),
            Self::Step => write_step(shape, &drawing.title).map(String::into_bytes),
            Self::Stl => mesh.map(write_stl),
            Self::Glb => mesh.map(|mesh| write_glb(mesh, &drawing.title)),
            Self::Dxf => Some(write_part_dxf(shape, drawing.stock).into_bytes()),
        }
    }
}
