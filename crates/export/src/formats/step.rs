//! The part as STEP (ISO 10303-21, AP214): solids whose faces are planes, cylinders, cones, spheres and tori.
//!
//! In: a [`PartShape`]. Out: one text; the spindle axis is Z, zero is that of the program, lengths are millimetres.
//! Every edge of the half-section is one face that goes all the way round, with its seam at X+, as CAD systems write
//! turned geometry themselves. An arc whose circle crosses the axis off its centre is a face of revolution: a torus
//! that passes through itself is not read everywhere. Threads are plain faces at the crest, with a colour of their
//! own and a name such as `THREAD D20 P1.5 ROOT D17.8`.
//!
//! Invariants: the same part gives the same bytes, so the header has no time; a number is given to a picometre, so
//! that a diameter of 30 mm is a radius of 15.; every circle is an edge of exactly two faces.

use std::fmt::Write;

use turnwright_geometry::{Bend, Point, Segment};

use super::part_svg::mm;
use crate::part::{PartShape, Thread};
use crate::solid::{Body, Shell, Surface, bodies};

/// How near places are that mean one, mm: ends of edges are rounded to this.
pub const UNCERTAINTY_MM: f64 = 1e-6;

/// Red, green and blue of the part and of its threads.
const PART_COLOUR: [f64; 3] = [0.70, 0.72, 0.75];
const THREAD_COLOUR: [f64; 3] = [0.85, 0.65, 0.30];

/// The part as the text of a STEP file; nothing when it has no solid. `name` is the product's.
pub fn write_step(shape: &PartShape, name: &str) -> Option<String> {
    let bodies = bodies(shape);
    if bodies.is_empty() {
        return None;
    }
    let mut step = Step { shape, text: String::new(), last: 0, circles: Vec::new(), threads: Vec::new() };
    let name = quoted(name);
    let _ = write!(
        step.text,
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('turned part, mm, spindle axis Z'),'2;1');\n\
         FILE_NAME({name},'',(''),(''),'turnwright','turnwright','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n"
    );
    let context = step.context();
    let origin = step.placement(Point::default(), Axis::Up);
    let solids: Vec<Id> = bodies.iter().map(|body| step.body(body, &name)).collect();
    let items = list(&[&[origin], solids.as_slice()].concat());
    let representation = step.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION({name},{items},{context})"));
    step.product(&name, representation);
    step.colours(&solids, context);
    step.text.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
    Some(step.text)
}

/// The number of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Id(u32);

impl std::fmt::Display for Id {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "#{}", self.0)
    }
}

/// Where the axis of a placement points; its X is across the spindle, in the plane of the section.
#[derive(Clone, Copy, Debug)]
enum Axis {
    /// Along Z.
    Up,
    /// Against Z.
    Down,
    /// Square to the section, so that angles run counter-clockwise with Z to the right and X up.
    Across,
    /// The same from behind.
    Back,
}

struct Step<'a> {
    shape: &'a PartShape,
    text: String,
    last: u32,
    /// The circles of the profile that is being written: one for each start of an edge, none on the axis.
    circles: Vec<Option<Id>>,
    threads: Vec<Id>,
}

impl Step<'_> {
    fn add(&mut self, entity: &str) -> Id {
        self.last += 1;
        let _ = writeln!(self.text, "#{}={entity};", self.last);
        Id(self.last)
    }

    fn point(&mut self, place: Point) -> Id {
        self.add(&format!("CARTESIAN_POINT('',({},0.,{}))", real(place.x), real(place.z)))
    }

    fn direction(&mut self, [x, y, z]: [f64; 3]) -> Id {
        self.add(&format!("DIRECTION('',({},{},{}))", ratio(x), ratio(y), ratio(z)))
    }

    fn placement(&mut self, place: Point, axis: Axis) -> Id {
        let point = self.point(place);
        let axis = self.direction(match axis {
            Axis::Up => [0.0, 0.0, 1.0],
            Axis::Down => [0.0, 0.0, -1.0],
            Axis::Across => [0.0, 1.0, 0.0],
            Axis::Back => [0.0, -1.0, 0.0],
        });
        let across = self.direction([1.0, 0.0, 0.0]);
        self.add(&format!("AXIS2_PLACEMENT_3D('',{point},{axis},{across})"))
    }

    fn circle(&mut self, centre: Point, axis: Axis, radius_mm: f64) -> Id {
        let placement = self.placement(centre, axis);
        self.add(&format!("CIRCLE('',{placement},{})", real(radius_mm)))
    }

    fn body(&mut self, body: &Body, name: &str) -> Id {
        let outer = self.shell(&body.outer);
        if body.voids.is_empty() {
            return self.add(&format!("MANIFOLD_SOLID_BREP({name},{outer})"));
        }
        let mut voids = Vec::with_capacity(body.voids.len());
        for void in &body.voids {
            let shell = self.shell(void);
            voids.push(self.add(&format!("ORIENTED_CLOSED_SHELL('',*,{shell},.T.)")));
        }
        self.add(&format!("BREP_WITH_VOIDS({name},{outer},{})", list(&voids)))
    }

    fn shell(&mut self, shell: &Shell) -> Id {
        let mut starts: Vec<Point> = shell.profile.iter().map(|edge| edge.start).collect();
        if !shell.is_ring() {
            starts.extend(shell.profile.last().map(|last| last.end));
        }
        let mut vertices = Vec::with_capacity(starts.len());
        self.circles.clear();
        for start in starts {
            let point = self.point(start);
            let vertex = self.add(&format!("VERTEX_POINT('',{point})"));
            vertices.push(vertex);
            let circle = (start.x > 0.0).then(|| {
                let circle = self.circle(Point { x: 0.0, ..start }, Axis::Up, start.x);
                self.add(&format!("EDGE_CURVE('',{vertex},{vertex},{circle},.T.)"))
            });
            self.circles.push(circle);
        }
        let mut faces = Vec::with_capacity(shell.profile.len());
        for (index, edge) in shell.profile.iter().enumerate() {
            let ends = (index, (index + 1) % vertices.len());
            faces.push(self.face(edge, ends, (vertices[ends.0], vertices[ends.1])));
        }
        self.add(&format!("CLOSED_SHELL('',{})", list(&faces)))
    }

    /// The face that an edge turns into. Its bounds run so that it lies to their left, seen from outside.
    fn face(&mut self, edge: &Segment, ends: (usize, usize), vertices: (Id, Id)) -> Id {
        let (start, end) = (self.circles[ends.0], self.circles[ends.1]);
        let start = start.map(|circle| self.oriented(circle, ".F."));
        let end = end.map(|circle| self.oriented(circle, ".T."));
        let mut bounds = Vec::new();
        if Surface::of(edge) == Surface::Plane {
            // The greater circle is the outer one.
            let grows = edge.end.x > edge.start.x;
            for (circle, is_outer) in [(start, !grows), (end, grows)] {
                let Some(circle) = circle else { continue };
                let bound = if is_outer { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
                let path = self.add(&format!("EDGE_LOOP('',({circle}))"));
                bounds.push(self.add(&format!("{bound}('',{path},.T.)")));
            }
        } else {
            let seam = self.seam(edge, vertices);
            let out = self.oriented(seam, ".T.");
            let back = self.oriented(seam, ".F.");
            let way: Vec<Id> = [Some(out), end, Some(back), start].into_iter().flatten().collect();
            let path = self.add(&format!("EDGE_LOOP('',{})", list(&way)));
            bounds.push(self.add(&format!("FACE_OUTER_BOUND('',{path},.T.)")));
        }
        let (surface, sense) = self.surface(edge);
        let thread = self.shape.thread_of(edge);
        let name = thread.map_or_else(String::new, thread_name);
        let face = self.add(&format!("ADVANCED_FACE('{name}',{},{surface},{sense})", list(&bounds)));
        if thread.is_some() {
            self.threads.push(face);
        }
        face
    }

    fn oriented(&mut self, edge: Id, sense: &str) -> Id {
        self.add(&format!("ORIENTED_EDGE('',*,*,{edge},{sense})"))
    }

    /// The edge itself, at X+.
    fn seam(&mut self, edge: &Segment, (start, end): (Id, Id)) -> Id {
        let curve = match edge.bend {
            None => {
                let point = self.point(edge.start);
                let length = edge.start.distance(edge.end);
                let (dx, dz) = (edge.end.x - edge.start.x, edge.end.z - edge.start.z);
                let direction = self.direction([dx / length, 0.0, dz / length]);
                let vector = self.add(&format!("VECTOR('',{direction},1.)"));
                self.add(&format!("LINE('',{point},{vector})"))
            }
            Some(Bend { centre, clockwise }) => {
                let axis = if clockwise { Axis::Back } else { Axis::Across };
                self.circle(centre, axis, centre.distance(edge.start))
            }
        };
        self.add(&format!("EDGE_CURVE('',{start},{end},{curve},.T.)"))
    }

    /// The surface of a face, and whether it looks out of the material.
    fn surface(&mut self, edge: &Segment) -> (Id, &'static str) {
        let sense = |is_same: bool| if is_same { ".T." } else { ".F." };
        let (start, end) = (edge.start, edge.end);
        let foot = |place: Point| Point { x: 0.0, ..place };
        // Cylinders and cones look away from the axis, and the material is to the left of the edge.
        let is_outside = end.z < start.z;
        let radius = edge.bend.map_or(0.0, |bend| bend.centre.distance(start));
        let is_convex = edge.bend.is_some_and(|bend| !bend.clockwise);
        let centre = edge.bend.map(|bend| bend.centre).unwrap_or_default();
        match Surface::of(edge) {
            Surface::Plane => {
                let axis = if end.x > start.x { Axis::Up } else { Axis::Down };
                let placement = self.placement(foot(start), axis);
                (self.add(&format!("PLANE('',{placement})")), ".T.")
            }
            Surface::Cylinder => {
                let placement = self.placement(foot(start), Axis::Up);
                let surface = format!("CYLINDRICAL_SURFACE('',{placement},{})", real(start.x));
                (self.add(&surface), sense(is_outside))
            }
            Surface::Cone => {
                let (narrow, wide) = if start.x < end.x { (start, end) } else { (end, start) };
                let axis = if wide.z > narrow.z { Axis::Up } else { Axis::Down };
                let placement = self.placement(foot(narrow), axis);
                let half_angle = ((wide.x - narrow.x) / (wide.z - narrow.z).abs()).atan();
                let surface =
                    format!("CONICAL_SURFACE('',{placement},{},{})", real(narrow.x), ratio(half_angle));
                (self.add(&surface), sense(is_outside))
            }
            Surface::Sphere => {
                let placement = self.placement(foot(centre), Axis::Up);
                let surface = format!("SPHERICAL_SURFACE('',{placement},{})", real(radius));
                (self.add(&surface), sense(is_convex))
            }
            Surface::Torus => {
                let placement = self.placement(foot(centre), Axis::Up);
                let surface = format!("TOROIDAL_SURFACE('',{placement},{},{})", real(centre.x), real(radius));
                (self.add(&surface), sense(is_convex))
            }
            Surface::SpindleTorus => {
                // Round the axis first, along the circle second: counter-clockwise, it looks at the circle's centre.
                let circle = self.circle(centre, Axis::Across, radius);
                let point = self.point(Point::default());
                let up = self.direction([0.0, 0.0, 1.0]);
                let axis = self.add(&format!("AXIS1_PLACEMENT('',{point},{up})"));
                let surface = self.add(&format!("SURFACE_OF_REVOLUTION('',{circle},{axis})"));
                (surface, sense(!is_convex))
            }
        }
    }

    /// Units and accuracy.
    fn context(&mut self) -> Id {
        let length = self.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
        let angle = self.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
        let solid_angle = self.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
        let uncertainty = self.add(&format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),{length},'distance_accuracy_value','')",
            ratio(UNCERTAINTY_MM)
        ));
        self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty})) \
             GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle})) REPRESENTATION_CONTEXT('',''))"
        ))
    }

    /// What the representation is of.
    fn product(&mut self, name: &str, representation: Id) {
        let application = self.add("APPLICATION_CONTEXT('automotive design')");
        self.add(&format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})"
        ));
        let of_product = self.add(&format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
        let product = self.add(&format!("PRODUCT({name},{name},'',({of_product}))"));
        self.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
        let formation = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
        let of_definition =
            self.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
        let definition = self.add(&format!("PRODUCT_DEFINITION('design','',{formation},{of_definition})"));
        let of_shape = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION({of_shape},{representation})"));
    }

    fn colours(&mut self, solids: &[Id], context: Id) {
        let part = self.colour(PART_COLOUR);
        let mut items = Vec::with_capacity(solids.len() + self.threads.len());
        for solid in solids {
            items.push(self.add(&format!("STYLED_ITEM('',({part}),{solid})")));
        }
        let threads = std::mem::take(&mut self.threads);
        if !threads.is_empty() {
            let colour = self.colour(THREAD_COLOUR);
            for face in threads {
                let whole = items[0];
                items.push(self.add(&format!("OVER_RIDING_STYLED_ITEM('',({colour}),{face},{whole})")));
            }
        }
        self.add(&format!(
            "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{},{context})",
            list(&items)
        ));
    }

    fn colour(&mut self, [red, green, blue]: [f64; 3]) -> Id {
        let colour = self.add(&format!("COLOUR_RGB('',{},{},{})", ratio(red), ratio(green), ratio(blue)));
        let fill = self.add(&format!("FILL_AREA_STYLE_COLOUR('',{colour})"));
        let area = self.add(&format!("FILL_AREA_STYLE('',({fill}))"));
        let surface = self.add(&format!("SURFACE_STYLE_FILL_AREA({area})"));
        let side = self.add(&format!("SURFACE_SIDE_STYLE('',({surface}))"));
        let usage = self.add(&format!("SURFACE_STYLE_USAGE(.BOTH.,{side})"));
        self.add(&format!("PRESENTATION_STYLE_ASSIGNMENT(({usage}))"))
    }
}

/// What the face of a thread is called: nothing but ASCII, for every reader.
fn thread_name(thread: &Thread) -> String {
    let mut name = String::from(if thread.is_inside { "THREAD INSIDE" } else { "THREAD" });
    let _ = write!(name, " D{} P{}", mm(thread.crest_mm), mm(thread.lead_mm));
    if thread.starts > 1 {
        let _ = write!(name, " STARTS {}", thread.starts);
    }
    let _ = write!(name, " ROOT D{}", mm(thread.root_mm));
    name
}

fn list(ids: &[Id]) -> String {
    let ids: Vec<String> = ids.iter().map(Id::to_string).collect();
    format!("({})", ids.join(","))
}

/// A length, to a picometre.
fn real(mm: f64) -> String {
    ratio((mm * 1e9).round() / 1e9)
}

/// A number as STEP writes them: with a point, and with a large E.
fn ratio(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    let (digits, power) = text.split_once('e').map_or((text.as_str(), None), |(a, b)| (a, Some(b)));
    let mut number = digits.strip_suffix('0').filter(|cut| cut.ends_with('.')).unwrap_or(digits).to_owned();
    if !number.contains('.') {
        number.push('.');
    }
    if let Some(power) = power {
        number.push('E');
        number.push_str(power);
    }
    number
}

/// A text in quotes; what is not ASCII as the code units of UTF-16.
fn quoted(text: &str) -> String {
    let mut out = String::from("'");
    let mut is_wide = false;
    let mut units = [0; 2];
    for c in text.chars() {
        let is_plain = matches!(c, ' '..='~');
        if is_plain == is_wide {
            out.push_str(if is_plain { "\\X0\\" } else { "\\X2\\" });
            is_wide = !is_plain;
        }
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            _ if is_plain => out.push(c),
            _ => c.encode_utf16(&mut units).iter().for_each(|unit| {
                let _ = write!(out, "{unit:04X}");
            }),
        }
    }
    out.push_str(if is_wide { "\\X0\\'" } else { "'" });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_step() {
        for (value, text) in [
            (15.0, "15."),
            (-0.0, "0."),
            (0.5, "0.5"),
            (100.0, "100."),
            (1e-7, "1.E-7"),
            (2.5e-9, "2.5E-9"),
            (1e20, "1.E20"),
        ] {
            assert_eq!(ratio(value), text);
        }
        assert_eq!(real(14.999_999_999_999_98), "15.");
    }

    #[test]
    fn names_hold_any_text() {
        assert_eq!(quoted("a'b\\c"), "'a''b\\\\c'");
        assert_eq!(quoted("轴1.nc"), "'\\X2\\8F74\\X0\\1.nc'");
        assert_eq!(quoted("⌀"), "'\\X2\\2300\\X0\\'");
    }
}
