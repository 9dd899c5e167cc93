//! Writes solids of seeded random turned parts, for the tests that read them back with other programs.
//!
//! `cargo run -p turnwright-export --example demo_solids -- FOLDER [COUNT]`
//!
//! The folder gets `0.step`, `0.stl`, `0.glb`, `0.dxf`, `1.step` … and `manifest.json` with what each must hold: the volume
//! of the section by Pappus, its pieces, and how many faces of each kind it has.

#![allow(clippy::disallowed_methods, clippy::disallowed_macros)]

mod turned;

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::json;
use turnwright_export::formats::dxf::write_part_dxf;
use turnwright_export::formats::glb::write_glb;
use turnwright_export::formats::step::write_step;
use turnwright_export::formats::stl::write_stl;
use turnwright_export::mesh::{CHORD_MM, Mesh};
use turnwright_export::part::PartShape;
use turnwright_export::solid::{Surface, bodies};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().expect("usage: demo_solids FOLDER [COUNT]"));
    let count = arguments.next().map_or(100, |count| count.parse().expect("a number"));
    let mut manifest = Vec::new();
    for seed in 0..count {
        let section = turned::part(seed);
        let Some(shape) = PartShape::new(&section, &section, &[]) else { continue };
        let (Some(step), Some(mesh)) = (write_step(&shape, &seed.to_string()), Mesh::new(&shape, CHORD_MM))
        else {
            continue;
        };
        for (end, bytes) in [
            ("step", step.into_bytes()),
            ("stl", write_stl(&mesh)),
            ("glb", write_glb(&mesh, &seed.to_string())),
            ("dxf", write_part_dxf(&shape, None).into_bytes()),
        ] {
            std::fs::write(folder.join(format!("{seed}.{end}")), bytes).expect("a file");
        }
        let bodies = bodies(&shape);
        let mut faces: BTreeMap<String, usize> = BTreeMap::new();
        for edge in bodies.iter().flat_map(|body| body.shells()).flat_map(|shell| &shell.profile) {
            *faces.entry(format!("{:?}", Surface::of(edge))).or_default() += 1;
        }
        manifest.push(json!({
            "name": seed.to_string(),
            "volume": section.volume_mm3(),
            "pieces": section.pieces().len(),
            "bodies": bodies.len(),
            "voids": bodies.iter().map(|body| body.voids.len()).sum::<usize>(),
            "faces": faces,
            "edges": shape.loops.iter().map(Vec::len).sum::<usize>(),
        }));
    }
    let manifest = serde_json::to_string_pretty(&manifest).expect("JSON");
    std::fs::write(folder.join("manifest.json"), manifest).expect("the manifest");
}
