//! The part as STL, binary: triangles in millimetres, the spindle axis is Z.
//!
//! In: a [`Mesh`]. Out: the bytes; the head tells the unit and how far the triangles may lie off the part, which the
//! format itself cannot. Threads wind as the mesh has them.

use turnwright_geometry::{Point, Vector};

use super::part_svg::mm;
use crate::mesh::{End, Mesh, Turned};
use crate::wound::Wound;

const HEAD_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 50;

/// The bytes of an STL file.
pub fn write_stl(mesh: &Mesh) -> Vec<u8> {
    let count = mesh.triangle_count();
    let mut bytes = Vec::with_capacity(HEAD_BYTES + 4 + TRIANGLE_BYTES * count);
    // A head that began with the word solid would make readers take it for text.
    bytes.extend_from_slice(format!("turnwright, mm, within {} mm", mm(mesh.chord_mm())).as_bytes());
    bytes.resize(HEAD_BYTES, b' ');
    bytes.extend_from_slice(&(count as u32).to_le_bytes());
    match mesh {
        Mesh::Turned(turned) => push_turned(&mut bytes, turned),
        Mesh::Wound(wound) => push_wound(&mut bytes, wound),
    }
    bytes
}

fn push_turned(bytes: &mut Vec<u8>, mesh: &Turned) {
    for strip in &mesh.strips {
        let way = Vector::between(strip.start.place, strip.end.place);
        // The flat strip between two directions looks half-way between them.
        let out = Vector { x: -way.z, z: way.x }.times(1.0 / way.length());
        for corners in mesh.triangles(strip) {
            let (cosine, sine) = half_way(mesh, corners[0].1);
            push(bytes, [out.x * cosine, out.x * sine, out.z]);
            for (end, side) in corners {
                let Point { x, z } = match end {
                    End::Start => strip.start.place,
                    End::End => strip.end.place,
                };
                let (cosine, sine) = mesh.directions[side];
                push(bytes, [x * cosine, x * sine, z]);
            }
            bytes.extend_from_slice(&[0, 0]);
        }
    }
}

fn push_wound(bytes: &mut Vec<u8>, mesh: &Wound) {
    for facet in &mesh.facets {
        let corners = facet.corners.map(|corner| mesh.place(corner));
        let across = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            let (u, v) = ([0, 1, 2].map(|axis| b[axis] - a[axis]), [0, 1, 2].map(|axis| c[axis] - a[axis]));
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        };
        let [x, y, z] = across(corners[0], corners[1], corners[2]);
        // A sliver has no direction of its own; zero lets readers find one.
        let length = x.hypot(y).hypot(z);
        push(bytes, if length > 0.0 { [x, y, z].map(|value| value / length) } else { [0.0; 3] });
        corners.into_iter().for_each(|place| push(bytes, place));
        bytes.extend_from_slice(&[0, 0]);
    }
}

/// The direction between one and the next.
fn half_way(mesh: &Turned, side: usize) -> (f64, f64) {
    let (a, b) = (mesh.directions[side], mesh.directions[(side + 1) % mesh.directions.len()]);
    let (cosine, sine) = (a.0 + b.0, a.1 + b.1);
    let length = cosine.hypot(sine);
    (cosine / length, sine / length)
}

fn push(bytes: &mut Vec<u8>, vector: [f64; 3]) {
    // Adding nothing makes minus zero plain, so that corners that are one have the same bytes.
    vector.iter().for_each(|value| bytes.extend_from_slice(&(*value as f32 + 0.0).to_le_bytes()));
}
