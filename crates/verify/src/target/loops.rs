//! Lines and arcs in any order become the half-section that they enclose.

use turnwright_geometry::{CORNER_MM, OUTLINE_SEGMENTS_MAX, Outline, Point, Segment};
use turnwright_stock::Section;

/// Ends that are nearer are one corner, mm: drawings are not always drawn to the last digit.
pub const JOIN_MM: f64 = 1e-3;

/// Why lines and arcs are no half-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContourFault {
    /// There are none.
    Nothing,
    /// There are more than [`OUTLINE_SEGMENTS_MAX`].
    TooMany(usize),
    /// The contour reaches below the axis here.
    BelowAxis(Point),
    /// The contour ends here, and not on the axis.
    Open(Point),
    /// More than two lines meet here.
    Branch(Point),
    /// Lines cross each other here.
    Crossing(Point),
    /// A loop encloses nothing, or lies in a hollow of another: there is one here.
    NoPart(Point),
}

/// The half-section of a drawing: lines on the axis are no edges, but ends on it are joined along it.
///
/// # Errors
/// [`ContourFault`].
pub fn section(edges: &[Segment]) -> Result<Section, ContourFault> {
    let mut edges: Vec<Segment> = edges.iter().flat_map(|edge| above_axis(*edge)).collect();
    edges.retain(|edge| !is_on_axis(edge));
    if edges.is_empty() {
        return Err(ContourFault::Nothing);
    }
    if edges.len() > OUTLINE_SEGMENTS_MAX {
        return Err(ContourFault::TooMany(edges.len()));
    }
    for edge in &edges {
        let places = (0..=16).map(|part| edge.at(f64::from(part) / 16.0));
        if let Some(below) = places.into_iter().find(|place| place.x < -JOIN_MM) {
            return Err(ContourFault::BelowAxis(below));
        }
    }
    join(&mut edges);
    close_on_axis(&mut edges)?;
    let mut outlines = Vec::new();
    while let Some(first) = edges.pop() {
        outlines.push(outline(first, &mut edges)?);
    }
    assemble(outlines)
}

/// A circle round a centre on the axis is its upper half.
fn above_axis(edge: Segment) -> Option<Segment> {
    let Some(bend) = edge.bend.filter(|bend| bend.centre.x.abs() <= JOIN_MM) else { return Some(edge) };
    // Of two half circles with their ends on the axis, one lies below it.
    let is_half = edge.start.x.abs() <= JOIN_MM && edge.end.x.abs() <= JOIN_MM;
    (!is_half || edge.at(0.5).x > bend.centre.x).then_some(edge)
}

fn is_on_axis(edge: &Segment) -> bool {
    edge.bend.is_none() && edge.start.x.max(edge.end.x) <= JOIN_MM
}

/// Makes ends that are nearly one the same; what is shorter than that goes.
fn join(edges: &mut Vec<Segment>) {
    let mut corners: Vec<Point> = Vec::new();
    let mut corner = |place: Point| {
        let place = if place.x.abs() <= JOIN_MM { Point { x: 0.0, ..place } } else { place };
        match corners.iter().find(|corner| corner.distance(place) <= JOIN_MM) {
            Some(known) => *known,
            None => {
                corners.push(place);
                place
            }
        }
    };
    for edge in edges.iter_mut() {
        (edge.start, edge.end) = (corner(edge.start), corner(edge.end));
        edge.bend = edge.bend.map(|bend| bend.evened(edge.start, edge.end));
    }
    edges.retain(|edge| edge.start.distance(edge.end) >= CORNER_MM);
}

/// Joins the ends that lie on the axis, two by two from the back.
fn close_on_axis(edges: &mut Vec<Segment>) -> Result<(), ContourFault> {
    let mut ends: Vec<Point> = edges.iter().flat_map(|edge| [edge.start, edge.end]).collect();
    ends.sort_by(|a, b| a.z.total_cmp(&b.z).then(a.x.total_cmp(&b.x)));
    let mut on_axis = Vec::new();
    for meeting in ends.chunk_by(|a, b| a == b) {
        match (meeting, meeting[0]) {
            ([_, _], _) => {}
            ([end], _) if end.x == 0.0 => on_axis.push(*end),
            ([end], _) => return Err(ContourFault::Open(*end)),
            (_, place) => return Err(ContourFault::Branch(place)),
        }
    }
    for pair in on_axis.chunks(2) {
        let [start, end] = pair else { return Err(ContourFault::Open(pair[0])) };
        edges.push(Segment { start: *start, end: *end, bend: None });
    }
    Ok(())
}

/// The loop that an edge belongs to; its edges leave the others.
fn outline(first: Segment, edges: &mut Vec<Segment>) -> Result<Outline, ContourFault> {
    let mut chain = vec![first];
    let mut at = first.end;
    while at != first.start {
        let next = edges.iter().position(|edge| edge.start == at || edge.end == at);
        let next = edges.swap_remove(next.ok_or(ContourFault::Open(at))?);
        let next = if next.start == at { next } else { next.reversed() };
        at = next.end;
        chain.push(next);
    }
    Outline::new(chain).map_err(|fault| match fault {
        turnwright_geometry::OutlineFault::Crossing { at, .. } => ContourFault::Crossing(at),
        _ => ContourFault::NoPart(first.start),
    })
}

/// Bodies beside each other, less the hollows in them.
fn assemble(mut outlines: Vec<Outline>) -> Result<Section, ContourFault> {
    outlines.sort_by(|a, b| b.area_mm2().total_cmp(&a.area_mm2()));
    let (mut bodies, mut hollows) = (Vec::new(), Vec::new());
    for (index, outline) in outlines.iter().enumerate() {
        let place = outline.segments()[0].at(0.5);
        match outlines[..index].iter().filter(|other| other.contains(place)).count() {
            0 => bodies.push(outline),
            1 => hollows.push(outline),
            _ => return Err(ContourFault::NoPart(place)),
        }
    }
    let no_part = |outline: &Outline| ContourFault::NoPart(outline.segments()[0].start);
    let solid = |outline: &Outline| Section::new(outline).map_err(|_| no_part(outline));
    let bounds = outlines.iter().map(Outline::bounds).reduce(|a, b| a.with(b.min).with(b.max));
    let bounds = bounds.ok_or(ContourFault::Nothing)?;
    let room = || Section::bar(bounds.max.x + 1.0, bounds.min.z - 1.0, bounds.max.z + 1.0);
    let (Ok(mut around), Ok(mut section)) = (room(), room()) else { return Err(ContourFault::Nothing) };
    for body in bodies {
        around.cut_section(&solid(body)?);
    }
    section.cut_section(&around);
    for hollow in hollows {
        section.cut_section(&solid(hollow)?);
    }
    Ok(section)
}

#[cfg(test)]
mod tests {
    use turnwright_geometry::Bend;

    use super::*;

    fn line(a: (f64, f64), b: (f64, f64)) -> Segment {
        Segment { start: Point::new(a.0, a.1), end: Point::new(b.0, b.1), bend: None }
    }

    /// A pin of ⌀20, 30 long, with a face at Z0, in no order.
    fn pin() -> Vec<Segment> {
        vec![line((10., -30.), (10., 0.)), line((0., 0.), (10., 0.)), line((10., -30.), (0., -30.))]
    }

    #[test]
    fn edges_in_any_order_close_along_the_axis() {
        assert!((section(&pin()).expect("a pin").area_mm2() - 300.0).abs() < 1e-9);
        let mut with_axis = pin();
        with_axis.push(line((0., -40.), (0., 5.)));
        assert!((section(&with_axis).expect("a pin").area_mm2() - 300.0).abs() < 1e-9);
        let bend = Some(Bend { centre: Point::new(0., 0.), clockwise: false });
        let half = |a, b| Segment { bend, ..line(a, b) };
        let ball = section(&[half((0., 5.), (0., -5.)), half((0., -5.), (0., 5.))]).expect("a ball");
        assert!((ball.area_mm2() - 12.5 * std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn bodies_and_hollows_are_told_apart() {
        let mut edges = pin();
        let rectangle = |x: (f64, f64), z: (f64, f64)| {
            let corners = [(x.0, z.0), (x.1, z.0), (x.1, z.1), (x.0, z.1), (x.0, z.0)];
            corners.windows(2).map(|pair| line(pair[0], pair[1])).collect::<Vec<_>>()
        };
        edges.extend(rectangle((2., 4.), (-10., -5.)));
        edges.extend(rectangle((12., 14.), (-10., -5.)));
        let section = super::section(&edges).expect("a section");
        assert!((section.area_mm2() - 300.0).abs() < 1e-9);
        assert_eq!(
            (section.rings(-7.), section.rings(-20.).len()),
            (vec![(0., 2.), (4., 10.), (12., 14.)], 1)
        );
        edges.extend(rectangle((2.5, 3.5), (-9., -6.)));
        assert!(matches!(super::section(&edges), Err(ContourFault::NoPart(_))));
    }

    #[test]
    fn what_does_not_close_is_refused_with_its_place() {
        assert_eq!(section(&[]).map(|_| ()), Err(ContourFault::Nothing));
        assert_eq!(section(&pin()[..2]).map(|_| ()), Err(ContourFault::Open(Point::new(10., -30.))));
        let mut edges = pin();
        // A gap of a micrometre is none, two are one.
        edges[0].end.z = -0.001;
        assert!(section(&edges).is_ok());
        edges[0].end.z = -0.002;
        assert!(matches!(section(&edges), Err(ContourFault::Open(_))));
        let mut edges = pin();
        edges.push(line((10., 0.), (12., 3.)));
        assert!(matches!(section(&edges), Err(ContourFault::Branch(_) | ContourFault::Open(_))));
        let crossed =
            [line((0., 0.), (10., -30.)), line((10., -30.), (10., 0.)), line((10., 0.), (0., -30.))];
        assert!(matches!(section(&crossed), Err(ContourFault::Crossing(_))));
        let below = [line((-5., 0.), (10., 0.)), line((10., 0.), (10., -5.)), line((10., -5.), (-5., 0.))];
        assert_eq!(section(&below).map(|_| ()), Err(ContourFault::BelowAxis(Point::new(-5., 0.))));
        let many = vec![line((1., 0.), (1., -1.)); OUTLINE_SEGMENTS_MAX + 1];
        assert_eq!(section(&many).map(|_| ()), Err(ContourFault::TooMany(OUTLINE_SEGMENTS_MAX + 1)));
    }

    #[test]
    fn as_many_edges_as_an_outline_may_have_are_taken() {
        let steps = (OUTLINE_SEGMENTS_MAX - 2) / 2;
        let mut edges = vec![line((0., 0.), (10., 0.))];
        let mut at = (10., 0.);
        for step in 0..steps {
            let (along, out) = ((at.0, at.1 - 1.0), (10. + (step % 2) as f64, at.1 - 1.0));
            edges.push(line(at, along));
            if along != out {
                edges.push(line(along, out));
            }
            at = out;
        }
        edges.push(line(at, (0., at.1)));
        assert!(edges.len() <= OUTLINE_SEGMENTS_MAX);
        assert!(section(&edges).is_ok());
    }
}
