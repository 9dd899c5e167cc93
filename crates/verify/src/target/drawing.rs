//! Half-sections out of DXF drawings, the text form that every CAD system writes.
//!
//! In: the bytes of a drawing. Out: lines and arcs by layer, in millimetres: X of the drawing is Z of the machine, Y is
//! the radius, as our own drawings have it. Read are `LINE`, `ARC`, `CIRCLE`, `LWPOLYLINE` and `POLYLINE` with their
//! bulges, and the unit from `$INSUNITS` (none: millimetres). Texts, dimensions, hatches and points are no contour and are
//! passed over, as is what lies on the sheet instead of in the model. Curves that are no arcs (`SPLINE`, `ELLIPSE`) and
//! blocks (`INSERT`) are remembered with their layer, for a contour that holds them cannot be read.
//!
//! Invariant: any bytes give a drawing or a [`DrawingFault`] with its line; no number leaves that is not finite or lies
//! beyond [`OUTLINE_MM_MAX`].

use std::collections::BTreeMap;

use turnwright_geometry::{Bend, OUTLINE_MM_MAX, Point, Segment};

/// A drawing is no longer.
pub const DRAWING_BYTES_MAX: usize = 16 << 20;

/// A bulge that is smaller bends nothing.
const FLAT: f64 = 1e-9;

/// The contours of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// By the names of their layers.
    pub layers: BTreeMap<String, Layer>,
}

/// What is drawn on a layer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Lines and arcs.
    pub edges: Vec<Segment>,
    /// The first thing that is neither, by its name in the file and its line there.
    pub unread: Option<(String, u32)>,
}

/// Why bytes are no drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DrawingFault {
    /// It has more than [`DRAWING_BYTES_MAX`] bytes.
    TooLong,
    /// It is of the binary form.
    Binary,
    /// It ends before its end is said.
    Truncated,
    /// A group code stands here that is no number.
    NotGroup(u32),
    /// A number is expected in this line.
    NotNumber(u32),
    /// A coordinate in this line is larger than any lathe.
    TooLarge(u32),
    /// It is drawn in a unit of this number, which is neither a millimetre nor an inch.
    Unit(i64),
    /// A shape in this line is drawn on a plane that is tilted.
    Tilted(u32),
    /// A polyline in this line is a mesh or a curve.
    Mesh(u32),
}

/// A group: a code, a value, and the line of the value.
#[derive(Clone, Copy, Debug)]
struct Group<'a> {
    code: i32,
    value: &'a str,
    line: u32,
}

impl Group<'_> {
    fn number(self) -> Result<f64, DrawingFault> {
        let number = self.value.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or(DrawingFault::NotNumber(self.line))
    }

    fn integer(self) -> Result<i64, DrawingFault> {
        self.value.parse().map_err(|_| DrawingFault::NotNumber(self.line))
    }
}

impl Drawing {
    /// Reads a drawing.
    ///
    /// # Errors
    /// [`DrawingFault`].
    pub fn read(bytes: &[u8]) -> Result<Self, DrawingFault> {
        if bytes.len() > DRAWING_BYTES_MAX {
            return Err(DrawingFault::TooLong);
        }
        if bytes.starts_with(b"AutoCAD Binary DXF") {
            return Err(DrawingFault::Binary);
        }
        let text = String::from_utf8_lossy(bytes);
        let mut lines = text.trim_start_matches('\u{feff}').lines().zip(1u32..);
        let mut reader = Reader { mm_per_unit: 1.0, ..Reader::default() };
        loop {
            let Some((code, line)) = lines.next() else { return Err(DrawingFault::Truncated) };
            let code = code.trim().parse::<i32>().map_err(|_| DrawingFault::NotGroup(line))?;
            let Some((value, line)) = lines.next() else { return Err(DrawingFault::Truncated) };
            let group = Group { code, value: value.trim(), line };
            if group.code == 0 && group.value == "EOF" {
                reader.end_entity()?;
                return Ok(reader.drawing);
            }
            reader.take(group)?;
        }
    }

    /// The layer that holds the contour: the one that is named, else `PART`, else the only one that has lines.
    ///
    /// # Errors
    /// The names of the layers to choose from; none when nothing is drawn.
    pub fn layer(&self, name: Option<&str>) -> Result<&Layer, Vec<&str>> {
        let named = |name: &str| {
            let is_so = |known: &&String| known.to_lowercase() == name.to_lowercase();
            self.layers.keys().find(is_so).map(|known| &self.layers[known])
        };
        let names = || self.layers.keys().map(String::as_str).collect::<Vec<_>>();
        match name {
            Some(name) => named(name).ok_or_else(names),
            None => {
                let mut all = self.layers.values();
                let only = all.next().filter(|_| all.next().is_none());
                named("PART").or(only).ok_or_else(names)
            }
        }
    }
}

/// What is being read.
#[derive(Debug, Default)]
struct Reader<'a> {
    drawing: Drawing,
    mm_per_unit: f64,
    section: &'a str,
    /// A variable of the header.
    variable: &'a str,
    /// The shape in work, its groups so far, and its line.
    shape: &'a str,
    line: u32,
    groups: Vec<Group<'a>>,
    /// A polyline whose corners follow as shapes of their own.
    polyline: Option<Polyline>,
}

/// Corners with the bulge behind each.
#[derive(Debug, Default)]
struct Polyline {
    layer: String,
    is_closed: bool,
    is_mirrored: bool,
    is_on_sheet: bool,
    corners: Vec<(Point, f64)>,
}

impl<'a> Reader<'a> {
    fn take(&mut self, group: Group<'a>) -> Result<(), DrawingFault> {
        if group.code == 0 {
            self.end_entity()?;
            (self.shape, self.line) = (group.value, group.line);
            if group.value == "ENDSEC" {
                if self.polyline.is_some() {
                    return Err(DrawingFault::Truncated);
                }
                self.section = "";
            }
            return Ok(());
        }
        match (self.shape, self.section, group.code) {
            ("SECTION", _, 2) => self.section = group.value,
            (_, "HEADER", 9) => self.variable = group.value,
            (_, "HEADER", 70) if self.variable == "$INSUNITS" => {
                self.mm_per_unit = match group.integer()? {
                    0 | 4 => 1.0,
                    1 => 25.4,
                    other => return Err(DrawingFault::Unit(other)),
                };
            }
            (_, "ENTITIES", _) => self.groups.push(group),
            _ => {}
        }
        Ok(())
    }

    /// The shape in work is complete.
    fn end_entity(&mut self) -> Result<(), DrawingFault> {
        let groups = std::mem::take(&mut self.groups);
        if self.section != "ENTITIES" {
            return Ok(());
        }
        let entity = Entity { groups: &groups, line: self.line, mm_per_unit: self.mm_per_unit };
        let layer = || entity.text(8).unwrap_or("0").to_string();
        let is_on_sheet = entity.text(67) == Some("1");
        match self.shape {
            "VERTEX" => {
                // The frame of a spline is not its curve.
                let is_frame = entity.integer(70)?.is_some_and(|flags| flags & 16 != 0);
                if let Some(polyline) = self.polyline.as_mut().filter(|_| !is_frame) {
                    let corner = entity.place(10, polyline.is_mirrored)?;
                    polyline.corners.push((corner, entity.bulge(42, polyline.is_mirrored)?));
                }
                return Ok(());
            }
            "SEQEND" => {
                if let Some(polyline) = self.polyline.take() {
                    self.add(polyline);
                }
                return Ok(());
            }
            _ => {}
        }
        // A polyline without its end is broken off.
        if self.polyline.is_some() {
            return Err(DrawingFault::Truncated);
        }
        let mut edges = Vec::new();
        match self.shape {
            "LINE" => {
                let (start, end) = (entity.place(10, false)?, entity.place(11, false)?);
                edges.push(Segment { start, end, bend: None });
            }
            "ARC" | "CIRCLE" => edges = entity.arcs(self.shape == "CIRCLE")?,
            "LWPOLYLINE" => {
                let polyline = entity.light_polyline(layer())?;
                if !is_on_sheet {
                    self.add(polyline);
                }
                return Ok(());
            }
            "POLYLINE" => {
                let flags = entity.integer(70)?.unwrap_or(0);
                if flags & (4 | 16 | 64) != 0 {
                    return Err(DrawingFault::Mesh(self.line));
                }
                let is_mirrored = entity.is_mirrored()?;
                let (layer, is_closed) = (layer(), flags & 1 != 0);
                self.polyline =
                    Some(Polyline { layer, is_closed, is_mirrored, is_on_sheet, corners: Vec::new() });
                return Ok(());
            }
            "SPLINE" | "ELLIPSE" | "INSERT" | "MLINE" | "SOLID" | "TRACE" | "REGION" | "3DSOLID" | "BODY" => {
                if !is_on_sheet {
                    let (name, line) = (self.shape.to_string(), self.line);
                    self.drawing.layers.entry(layer()).or_default().unread.get_or_insert((name, line));
                }
                return Ok(());
            }
            _ => return Ok(()),
        }
        if !is_on_sheet {
            self.drawing.layers.entry(layer()).or_default().edges.extend(edges);
        }
        Ok(())
    }

    fn add(&mut self, polyline: Polyline) {
        if polyline.is_on_sheet {
            return;
        }
        let layer = self.drawing.layers.entry(polyline.layer).or_default();
        let corners = &polyline.corners;
        let next = corners.iter().cycle().skip(1);
        let count = if polyline.is_closed { corners.len() } else { corners.len().saturating_sub(1) };
        layer.edges.extend(
            corners.iter().zip(next).take(count).map(|((start, bulge), (end, _))| arc(*start, *end, *bulge)),
        );
    }
}

/// The line or arc between two corners: the bulge is the tangent of a quarter of its angle.
fn arc(start: Point, end: Point, bulge: f64) -> Segment {
    let bend = (bulge.abs() > FLAT).then(|| {
        let to_centre = (1.0 - bulge * bulge) / (4.0 * bulge);
        let (dx, dz) = (end.x - start.x, end.z - start.z);
        let middle = Point::new((start.x + end.x) / 2.0, (start.z + end.z) / 2.0);
        // To the left of the chord, seen with Z to the right and X up.
        let centre = Point::new(middle.x + dz * to_centre, middle.z - dx * to_centre);
        Bend { centre, clockwise: bulge < 0.0 }
    });
    let is_flat = bend.is_some_and(|bend| bend.centre.distance(start) > OUTLINE_MM_MAX);
    Segment { start, end, bend: bend.filter(|_| !is_flat) }
}

/// A shape with its groups.
#[derive(Clone, Copy)]
struct Entity<'a> {
    groups: &'a [Group<'a>],
    line: u32,
    mm_per_unit: f64,
}

impl<'a> Entity<'a> {
    fn find(&self, code: i32) -> Option<Group<'a>> {
        self.groups.iter().find(|group| group.code == code).copied()
    }

    fn text(&self, code: i32) -> Option<&'a str> {
        self.find(code).map(|group| group.value)
    }

    fn integer(&self, code: i32) -> Result<Option<i64>, DrawingFault> {
        self.find(code).map(Group::integer).transpose()
    }

    fn number(&self, code: i32) -> Result<f64, DrawingFault> {
        self.find(code).ok_or(DrawingFault::NotNumber(self.line))?.number()
    }

    fn length(&self, group: Group<'_>) -> Result<f64, DrawingFault> {
        let mm = group.number()? * self.mm_per_unit;
        if mm.abs() <= OUTLINE_MM_MAX { Ok(mm) } else { Err(DrawingFault::TooLarge(group.line)) }
    }

    /// A place; of a mirrored shape from the other side.
    fn place(&self, code: i32, is_mirrored: bool) -> Result<Point, DrawingFault> {
        let length = |code| match self.find(code) {
            Some(group) => self.length(group),
            None => Err(DrawingFault::NotNumber(self.line)),
        };
        let (along, up) = (length(code)?, length(code + 10)?);
        Ok(Point::new(up, if is_mirrored { -along } else { along }))
    }

    fn bulge(&self, code: i32, is_mirrored: bool) -> Result<f64, DrawingFault> {
        let bulge = self.find(code).map_or(Ok(0.0), Group::number)?;
        Ok(if is_mirrored { -bulge } else { bulge })
    }

    /// Whether the shape is drawn on the back of the sheet.
    fn is_mirrored(&self) -> Result<bool, DrawingFault> {
        let way = |code| self.find(code).map_or(Ok(0.0), Group::number);
        let (x, y, z) = (way(210)?, way(220)?, self.find(230).map_or(Ok(1.0), Group::number)?);
        if x.abs() > FLAT || y.abs() > FLAT || (z.abs() - 1.0).abs() > FLAT {
            return Err(DrawingFault::Tilted(self.line));
        }
        Ok(z < 0.0)
    }

    /// An arc, or the two halves of a circle.
    fn arcs(&self, is_circle: bool) -> Result<Vec<Segment>, DrawingFault> {
        let is_mirrored = self.is_mirrored()?;
        let centre = self.place(10, is_mirrored)?;
        let radius = match self.find(40) {
            Some(group) => self.length(group)?,
            None => return Err(DrawingFault::NotNumber(self.line)),
        };
        let at = |degrees: f64| {
            let (sine, cosine) = libm::sincos(degrees.to_radians());
            let along = if is_mirrored { -cosine } else { cosine };
            Point::new(centre.x + radius * sine, centre.z + radius * along)
        };
        let bend = Some(Bend { centre, clockwise: is_mirrored });
        let piece = |from: f64, to: f64| Segment { start: at(from), end: at(to), bend };
        if is_circle {
            return Ok(vec![piece(0.0, 180.0), piece(180.0, 0.0)]);
        }
        Ok(vec![piece(self.number(50)?, self.number(51)?)])
    }

    fn light_polyline(&self, layer: String) -> Result<Polyline, DrawingFault> {
        let is_mirrored = self.is_mirrored()?;
        let is_closed = self.integer(70)?.is_some_and(|flags| flags & 1 != 0);
        let mut polyline = Polyline { layer, is_closed, is_mirrored, ..Polyline::default() };
        let starts = self.groups.iter().enumerate().filter(|(_, group)| group.code == 10);
        let starts: Vec<usize> = starts.map(|(index, _)| index).collect();
        for (place, start) in starts.iter().enumerate() {
            let end = starts.get(place + 1).copied().unwrap_or(self.groups.len());
            let corner = Entity { groups: &self.groups[*start..end], ..*self };
            polyline.corners.push((corner.place(10, is_mirrored)?, corner.bulge(42, is_mirrored)?));
        }
        Ok(polyline)
    }
}
