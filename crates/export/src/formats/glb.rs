//! The part as glTF 2.0 in one binary file, for 3D viewers and web pages.
//!
//! In: a [`Mesh`]. Out: the bytes. glTF measures in metres with Y up: the spindle axis is X, so that the part lies in a
//! viewer as in the section, chuck to the left. Surfaces that go on smoothly share their corners and look round, edges
//! stay sharp. Threads have a material of their own.

use serde_json::{Value, json};
use turnwright_geometry::Vector;

use crate::mesh::{Corner, End, Mesh, Turned};
use crate::wound::Wound;

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
const ALIGNMENT: usize = 4;
/// Numbers of the specification: what buffers are for, and types of their parts.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// Surfaces whose normals differ by less are one: the cosine of half a degree.
const SMOOTH_COSINE: f64 = 0.99996;

/// The vertices and triangles of one material.
#[derive(Default)]
struct Primitive {
    places: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<u32>,
}

/// The bytes of a GLB file; `name` is the part's.
pub fn write_glb(mesh: &Mesh, name: &str) -> Vec<u8> {
    let (mut binary, mut views, mut accessors, mut primitives) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (material, is_thread) in [false, true].into_iter().enumerate() {
        let primitive = match mesh {
            Mesh::Turned(turned) => Primitive::turned(turned, is_thread),
            Mesh::Wound(wound) => Primitive::wound(wound, is_thread),
        };
        if primitive.triangles.is_empty() {
            continue;
        }
        let first = accessors.len();
        let (count, indices) = (primitive.places.len(), primitive.triangles.len());
        let (min, max) = primitive.bounds();
        for (target, bytes) in [
            (VERTICES, floats(&primitive.places)),
            (VERTICES, floats(&primitive.normals)),
            (INDICES, primitive.triangles.iter().flat_map(|index| index.to_le_bytes()).collect()),
        ] {
            let at = binary.len();
            views.push(json!({ "buffer": 0, "byteOffset": at, "byteLength": bytes.len(), "target": target }));
            binary.extend(bytes);
        }
        accessors.extend([
            json!({ "bufferView": first, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max }),
            json!({ "bufferView": first + 1, "componentType": FLOAT, "count": count, "type": "VEC3" }),
            json!({ "bufferView": first + 2, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR" }),
        ]);
        primitives.push(json!({
            "attributes": { "POSITION": first, "NORMAL": first + 1 },
            "indices": first + 2,
            "material": material.min(primitives.len()),
        }));
    }
    let materials: Vec<Value> =
        [material("turned steel", [0.70, 0.72, 0.75]), material("thread", [0.85, 0.65, 0.30])]
            .into_iter()
            .take(primitives.len())
            .collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": "turnwright", "extras": { "chord_mm": mesh.chord_mm() } },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": name }],
        "meshes": [{ "primitives": primitives, "name": name }],
        "materials": materials,
        "buffers": [{ "byteLength": binary.len() }],
        "bufferViews": views,
        "accessors": accessors,
    });
    container(document.to_string().into_bytes(), binary)
}

/// A metal that is bright with and without surroundings to reflect.
fn material(name: &str, [red, green, blue]: [f64; 3]) -> Value {
    json!({
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [red, green, blue, 1.0],
            "metallicFactor": 0.5,
            "roughnessFactor": 0.45,
        },
    })
}

impl Primitive {
    fn turned(mesh: &Turned, is_thread: bool) -> Self {
        let mut primitive = Self::default();
        let mut row_before: Option<(Corner, u32)> = None;
        for strip in mesh.strips.iter().filter(|strip| strip.is_thread == is_thread) {
            let goes_on = |corner: &Corner| {
                let (a, b) = (corner.normal, strip.start.normal);
                corner.place == strip.start.place
                    && a.x * b.x + a.z * b.z > SMOOTH_COSINE
                    && corner.place.x > 0.0
            };
            let start = match row_before.filter(|(corner, _)| goes_on(corner)) {
                Some((_, row)) => row,
                None => primitive.row(mesh, &strip.start),
            };
            let end = primitive.row(mesh, &strip.end);
            for corners in mesh.triangles(strip) {
                let index = |(end_of, side): (End, usize)| match end_of {
                    End::Start => start + side as u32,
                    End::End => end + side as u32,
                };
                primitive.triangles.extend(corners.map(index));
            }
            row_before = Some((strip.end, end));
        }
        primitive.without_lone_vertices()
    }

    /// Triangles whose corners share a vertex where they look alike.
    fn wound(mesh: &Wound, is_thread: bool) -> Self {
        let mut primitive = Self::default();
        // Of each corner the normals that it has so far, with their vertices.
        let mut known: Vec<Vec<(Vector, u32)>> = vec![Vec::new(); mesh.corners.len()];
        for facet in mesh.facets.iter().filter(|facet| facet.is_thread == is_thread) {
            for (corner, normal) in facet.corners.into_iter().zip(facet.normals) {
                let is_alike = |one: &&(Vector, u32)| one.0.x * normal.x + one.0.z * normal.z > SMOOTH_COSINE;
                let vertex = match known[corner].iter().find(is_alike) {
                    Some((_, vertex)) => *vertex,
                    None => {
                        let (cosine, sine) = mesh.directions[mesh.corners[corner].side];
                        let [x, y, z] = mesh.place(corner);
                        primitive.places.push(metres(z, x, y));
                        let Vector { x, z } = normal;
                        primitive.normals.push([z as f32, (x * cosine) as f32, (x * sine) as f32]);
                        let vertex = primitive.places.len() as u32 - 1;
                        known[corner].push((normal, vertex));
                        vertex
                    }
                };
                primitive.triangles.push(vertex);
            }
        }
        primitive
    }

    /// A corner in all directions; on the axis each looks half-way to the next.
    fn row(&mut self, mesh: &Turned, corner: &Corner) -> u32 {
        let first = self.places.len() as u32;
        let count = mesh.directions.len();
        for (side, direction) in mesh.directions.iter().enumerate() {
            let (cosine, sine) = *direction;
            let next = mesh.directions[(side + 1) % count];
            let looks = if corner.place.x > 0.0 { (cosine, sine) } else { middle(*direction, next) };
            self.places.push(metres(corner.place.z, corner.place.x * cosine, corner.place.x * sine));
            let Vector { x, z } = corner.normal;
            self.normals.push([z as f32, (x * looks.0) as f32, (x * looks.1) as f32]);
        }
        first
    }

    /// Every triangle of a fan has a tip of its own; of some rows not all vertices are used.
    fn without_lone_vertices(self) -> Self {
        let mut kept: Vec<Option<u32>> = vec![None; self.places.len()];
        let mut used = Self::default();
        for index in self.triangles {
            let place = *kept[index as usize].get_or_insert_with(|| {
                used.places.push(self.places[index as usize]);
                used.normals.push(self.normals[index as usize]);
                used.places.len() as u32 - 1
            });
            used.triangles.push(place);
        }
        used
    }

    fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for place in &self.places {
            for axis in 0..3 {
                min[axis] = min[axis].min(place[axis]);
                max[axis] = max[axis].max(place[axis]);
            }
        }
        (min, max)
    }
}

fn middle(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let (cosine, sine) = (a.0 + b.0, a.1 + b.1);
    let length = cosine.hypot(sine);
    (cosine / length, sine / length)
}

fn metres(x_mm: f64, y_mm: f64, z_mm: f64) -> [f32; 3] {
    [x_mm, y_mm, z_mm].map(|mm| (mm / 1000.0) as f32)
}

fn floats(vectors: &[[f32; 3]]) -> Vec<u8> {
    vectors.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
}

/// The two chunks, each filled up to whole words.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(ALIGNMENT), b' ');
    binary.resize(binary.len().next_multiple_of(ALIGNMENT), 0);
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let mut bytes = Vec::with_capacity(length);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&(length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        bytes.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        bytes.extend_from_slice(kind);
        bytes.extend_from_slice(chunk);
    }
    bytes
}
