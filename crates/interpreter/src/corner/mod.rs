//! The open path: elements that wait for a later block, because their end or the corner behind them depends on it.
//!
//! Three families of words need it. The automatic corner joins two lines along the axes at a right angle (`R`,
//! `I`, `K`, plain `C`). Drawing dimensions give lines by their angle and break corners between any two of them
//! (`,A ,C ,R`, plain letters by parameter). Other controls break the corner of any two cuts (`L`, `D`) and give
//! the angle with `Q`.
//!
//! In: one element a block, from the functions of lines and arcs. Out: moves, as soon as they are settled: an
//! element given by its angle alone waits for the next, which must have both coordinates and its own angle; an
//! element with a corner waits until the one behind it is known. So at most three elements are open at a time.
//!
//! The point written is the corner before it is broken; increments of the next block count from there. Geometry
//! computes in millimetres from unrounded points; each point that is given out is rounded once. What the blocks
//! between do besides moving is held back until the moves before them are given out.
//!
//! Source: automatic chamfer and corner R, direct drawing dimensions of both families.

mod join;
mod words;

use turnwright_canon::{Action, Command, RapidPath, Shape, Turn};
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_geometry::{Line, Point};
use turnwright_syntax::Block;
use turnwright_units::{Feed, Position, WorkTip};
pub(crate) use words::LETTERS;
use words::{AngleWord, CornerWord, PathWords, Rule};

use crate::machine::{BlockPlace, Core};
use crate::plane::point;
use crate::report::Alarm;

/// Lines nearer than this to parallel have no crossing and no corner.
const PARALLEL_DEG: f64 = 1.0;

/// How an element is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    Rapid(RapidPath),
    Feed(Feed),
}

impl Motion {
    fn action(self, to: Position<WorkTip>, shape: Shape) -> Action {
        match self {
            Self::Rapid(path) => Action::Rapid { to, path, others: None },
            Self::Feed(feed) => Action::Feed { to, shape, feed, others: None },
        }
    }
}

/// An element whose moves are not given out yet.
#[derive(Clone, Debug)]
struct Element {
    motion: Motion,
    /// The line, or the arc with its centre.
    shape: Shape,
    /// The corner that it starts from, unbroken.
    from: Position<WorkTip>,
    /// Where it really starts, behind the corner before it.
    start: Point,
    /// Where it ends if no corner is broken; `None` while only its angle is known.
    end: Option<Point>,
    /// The end on the least increment.
    to: Position<WorkTip>,
    /// The block has words for X and for Z.
    names: (bool, bool),
    angle: Option<AngleWord>,
    corner: Option<CornerWord>,
    /// Its block.
    at: BlockPlace,
    /// What later blocks asked for besides moves.
    held: Vec<Command>,
}

/// Elements that wait for a later block.
#[derive(Clone, Debug, Default)]
pub(crate) struct OpenPath {
    elements: Vec<Element>,
    /// Blocks without an element since the last one.
    gap: u8,
    /// The block in work added an element.
    is_new: bool,
    /// Where the program stands; if this changes without an element, the zero has moved.
    stands: Option<Position<WorkTip>>,
}

impl OpenPath {
    /// Keeps a command until the moves before it are given out.
    #[cold]
    pub(crate) fn hold(&mut self, command: Command) {
        if let Some(last) = self.elements.last_mut() {
            last.held.push(command);
        }
    }

    fn last(&self) -> Option<&Element> {
        self.elements.last()
    }
}

impl Element {
    /// The place of its block.
    fn place(&self) -> Place {
        self.at.span(self.at.first_byte, self.at.last_byte)
    }

    /// The words that keep the element open, for messages.
    fn words(&self) -> (Place, String) {
        match (&self.corner, &self.angle) {
            (Some(corner), _) => (corner.place, corner.quote.clone()),
            (None, Some(angle)) => (angle.place, angle.quote.clone()),
            (None, None) => (self.place(), String::new()),
        }
    }

    /// The rule of its corner; an angle makes it a drawing dimension.
    fn rule(&self) -> Rule {
        let corner = self.corner.as_ref().filter(|_| self.angle.is_none());
        corner.map_or(Rule::AnyLines, |corner| corner.rule)
    }

    /// The alarm when the element is left open.
    fn fault(&self, cause: Interruption) -> &'static str {
        match (self.rule(), cause) {
            (Rule::RightAngle | Rule::PlainLetter, Interruption::TooManyBlocks) => "bad-move-after-corner",
            (Rule::RightAngle | Rule::PlainLetter, Interruption::OtherFunction | Interruption::End) => {
                "no-perpendicular-after-corner"
            }
            (Rule::AnyLines, Interruption::TooManyBlocks | Interruption::OtherFunction) => {
                "drawing-sequence-illegal"
            }
            (Rule::AnyLines, Interruption::End) => "drawing-end-missing",
            (Rule::AnyLines, Interruption::EndOfFigure) => "figure-ends-in-drawing",
            (_, Interruption::EndOfFigure) => "figure-ends-in-corner",
            (Rule::AnyCuts, _) => "no-cut-after-corner",
        }
    }

    /// Whether what keeps this element open lets `next` follow.
    fn may_be_followed_by(&self, next: &Self) -> bool {
        let is_line = next.shape == Shape::Line;
        let is_cut = matches!(next.motion, Motion::Feed(_));
        let needs_line = self.end.is_none();
        match self.corner.as_ref().map(|corner| corner.rule) {
            Some(Rule::RightAngle) => is_line && is_cut,
            Some(Rule::PlainLetter | Rule::AnyLines) | None => is_line,
            // Rapids take part in drawing dimensions only.
            Some(Rule::AnyCuts) => {
                let is_drawing = matches!(self.motion, Motion::Rapid(_)) || self.angle.is_some();
                (is_cut || is_drawing) && (is_line || !needs_line)
            }
        }
    }
}

/// What leaves a path open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interruption {
    /// A function that no path may hold.
    OtherFunction,
    /// More blocks without a move than may stand between.
    TooManyBlocks,
    /// The end of the program, or a stop or call, which the control does not read past.
    End,
    /// The last block of the figure of a cycle.
    EndOfFigure,
}

impl Core {
    /// A line that has words of a path, or follows an open one.
    #[cold]
    pub(crate) fn line_in_path(&mut self, block: &Block, motion: Motion) -> Result<(), Alarm> {
        if self.axes.plane != crate::axes::Plane::Zx
            && let Some(word) = block.words.iter().find(|word| word.comma || LETTERS.contains(&word.address))
        {
            return Err(self.alarm("drawing-plane-illegal", word));
        }
        let words = self.path_words(block, Some(&motion))?;
        if let Some(corner) = words.corner.as_ref().filter(|_| self.compensation_changes()) {
            return Err(self.alarm("corner-in-compensation-start", &corner.word));
        }
        let element = self.line_element(block, words, motion)?;
        self.add_element(element)
    }

    /// An arc that has a corner word, or follows an open path.
    #[cold]
    pub(crate) fn arc_in_path(
        &mut self,
        block: &Block,
        (from, to): (Position<WorkTip>, Position<WorkTip>),
        (turn, centre): (Turn, Position<WorkTip>),
        feed: Feed,
    ) -> Result<(), Alarm> {
        let words = self.path_words(block, None)?;
        let shape = Shape::Arc { turn, centre };
        let element =
            self.element(block, Motion::Feed(feed), shape, (from, point(from)), Some((to, point(to))));
        self.add_element(Element { corner: words.corner, ..element })
    }

    /// Whether an arc of this block belongs to a path: only where corners lie between any cuts.
    pub(crate) fn joins_arcs(&self, block: &Block) -> bool {
        self.corner.is_some() || block.has(b'L') || block.has(b'D')
    }

    /// Refuses an arc behind an element that only a line may follow.
    pub(crate) fn check_arc_in_path(&mut self) -> Result<(), Alarm> {
        let open = self.corner.as_ref().and_then(|path| path.last());
        let takes_arc = |open: &Element| {
            open.end.is_some() && open.corner.as_ref().is_some_and(|corner| corner.rule == Rule::AnyCuts)
        };
        if open.is_none_or(takes_arc) { Ok(()) } else { Err(self.corner_interrupted()) }
    }

    fn element(
        &self,
        block: &Block,
        motion: Motion,
        shape: Shape,
        (from, start): (Position<WorkTip>, Point),
        end: Option<(Position<WorkTip>, Point)>,
    ) -> Element {
        Element {
            motion,
            shape,
            from,
            start,
            end: end.map(|(_, point)| point),
            to: end.map_or(from, |(to, _)| to),
            names: (block.has(b'X') || block.has(b'U'), block.has(b'Z') || block.has(b'W')),
            angle: None,
            corner: None,
            at: self.at,
            held: Vec::new(),
        }
    }

    fn line_element(&mut self, block: &Block, words: PathWords, motion: Motion) -> Result<Element, Alarm> {
        let open = self.corner.as_ref().and_then(|path| path.last());
        let is_behind_angle = open.is_some_and(|open| open.end.is_none());
        let from = self.modal.position;
        let start = open.and_then(|open| open.end).unwrap_or(point(from));
        let element = self.element(block, motion, Shape::Line, (from, start), None);
        let end = match (&words.angle, element.names) {
            _ if is_behind_angle => {
                self.check_behind_angle(block, &words, element.names)?;
                let to = self.target(block)?;
                Some((to, point(to)))
            }
            (None, _) => {
                let to = self.target(block)?;
                Some((to, point(to)))
            }
            (Some(_), (false, false)) => None,
            (Some(angle), (true, true)) => return Err(self.alarm("drawing-sequence-illegal", &angle.word)),
            (Some(angle), (is_x, _)) => {
                let to = self.target(block)?;
                let given = if is_x { Line::at_x(to.x.to_mm()) } else { Line::at_z(to.z.to_mm()) };
                let line = Line { through: start, angle_rad: angle.rad };
                let Some(end) = line.crossing(given, PARALLEL_DEG.to_radians()) else {
                    return Err(self.alarm("drawing-end-unsolvable", &angle.word));
                };
                self.warn_against_angle(angle, start, end);
                Some((self.snapped(end)?, end))
            }
        };
        let mut element = Element { angle: words.angle, corner: words.corner, ..element };
        if let Some((to, end)) = end {
            (element.to, element.end) = (to, Some(end));
        }
        self.check_right_angle(&mut element)?;
        Ok(element)
    }

    /// The block behind a line given by its angle alone must fix it: both coordinates, absolute, and an angle.
    fn check_behind_angle(&self, block: &Block, words: &PathWords, names: (bool, bool)) -> Result<(), Alarm> {
        if words.angle.is_none() {
            return Err(self.alarm_block("angle-form-illegal"));
        }
        let increment = block.word(b'U').or(block.word(b'W'));
        if names != (true, true) || increment.is_some() || self.modal.is_incremental {
            return Err(self.alarm_at("drawing-end-missing", increment));
        }
        Ok(())
    }

    /// Warns when a computed point lies where the angle does not lead.
    fn warn_against_angle(&mut self, angle: &AngleWord, start: Point, end: Point) {
        let line = Line { through: start, angle_rad: angle.rad };
        if line.way_to(end) < 0.0 && !self.already_said("drawing-angle-against", angle.place.line) {
            let diagnostic = Diagnostic::warning("drawing-angle-against").at(angle.place);
            self.say(diagnostic.with("word", angle.quote.clone()));
        }
    }

    /// Takes an element in, and gives out what is settled by it.
    fn add_element(&mut self, mut element: Element) -> Result<(), Alarm> {
        let mut path = self.corner.take().unwrap_or_default();
        if path.stands.is_some_and(|stands| stands != self.modal.position) {
            self.corner = Some(path);
            return Err(self.zero_moved());
        }
        if !self.is_capturing() {
            // The first element of a path takes the movement of the offset along.
            self.untaken = None;
        }
        if let Some(last) = path.elements.last_mut() {
            if !last.may_be_followed_by(&element) {
                self.corner = Some(path);
                return Err(self.corner_interrupted());
            }
            if last.end.is_none() {
                self.settle_angle(last, &mut element)?;
            }
        }
        let reached = element.end.map(|_| element.to);
        path.elements.push(element);
        self.give_out(&mut path)?;
        if let Some(last) = path.last() {
            self.check_room(last)?;
        }
        if let Some(reached) = reached {
            self.modal.position = reached;
        }
        if !path.elements.is_empty() {
            (path.gap, path.is_new, path.stands) = (0, true, Some(self.modal.position));
            self.corner = Some(path);
        }
        Ok(())
    }

    /// Finds the end of a line given by its angle, where it meets the next one.
    fn settle_angle(&mut self, open: &mut Element, next: &mut Element) -> Result<(), Alarm> {
        let (Some(angle), Some(next_angle), Some(end)) = (&open.angle, &next.angle, next.end) else {
            return Err(self.alarm_block("angle-form-illegal"));
        };
        let line = Line { through: open.start, angle_rad: angle.rad };
        let next_line = Line { through: end, angle_rad: next_angle.rad };
        let Some(meet) = line.crossing(next_line, PARALLEL_DEG.to_radians()) else {
            let diagnostic = Diagnostic::alarm("drawing-end-unsolvable").at(angle.place);
            let diagnostic = diagnostic.with("word", angle.quote.clone());
            return Err(self.finish(diagnostic.near(next_angle.place, "next-block")));
        };
        self.warn_against_angle(angle, open.start, meet);
        self.warn_against_angle(next_angle, meet, end);
        open.to = self.snapped(meet)?;
        open.end = Some(meet);
        (next.from, next.start) = (open.to, meet);
        Ok(())
    }

    /// Gives out every element whose end and corner are known.
    fn give_out(&mut self, path: &mut OpenPath) -> Result<(), Alarm> {
        let mut settled = 0;
        while let Some([first, second]) = path.elements.get_mut(settled..settled + 2)
            && first.end.is_some()
            && second.end.is_some()
        {
            self.give_first(first, second)?;
            settled += 1;
        }
        path.elements.drain(..settled);
        if let [last] = &path.elements[..]
            && last.end.is_some()
            && last.corner.is_none()
        {
            let (to, action) = (last.to, last.motion.action(last.to, last.shape.clone()));
            path.elements.clear();
            self.emit_move(to, action)?;
        }
        Ok(())
    }

    /// Gives out an element up to its corner, the corner, and what was held behind it.
    fn give_first(&mut self, first: &mut Element, second: &mut Element) -> Result<(), Alarm> {
        let corner = match &first.corner {
            Some(word) => self.broken(first, word, second)?,
            None => None,
        };
        // Both moves belong to the block that asked for them.
        let here = std::mem::replace(&mut self.at, first.at);
        match corner {
            None => {
                self.emit_move(first.to, first.motion.action(first.to, first.shape.clone()))?;
                second.start = first.end.unwrap_or(second.start);
            }
            Some(corner) => {
                let (before, after) = (self.snapped(corner.from)?, self.snapped(corner.to)?);
                self.emit_move(before, first.motion.action(before, first.shape.clone()))?;
                let shape = self.corner_shape(&corner, before, after);
                self.emit_move(after, first.motion.action(after, shape))?;
                second.start = corner.to;
            }
        }
        self.at = here;
        for command in first.held.drain(..) {
            self.pass_on(command);
        }
        Ok(())
    }

    /// After a block while a path is open: not too many blocks without a move, and no other zero.
    #[cold]
    pub(crate) fn check_open_path(&mut self) -> Result<(), Alarm> {
        let limits = self.control.limits;
        let stands = Some(self.modal.position);
        let Some(path) = &mut self.corner else { return Ok(()) };
        if std::mem::take(&mut path.is_new) {
            return Ok(());
        }
        path.gap += 1;
        let (gap, moves_zero) = (path.gap, path.stands != stands);
        let Some(last) = path.last() else { return Ok(()) };
        if moves_zero {
            return Err(self.zero_moved());
        }
        let gap_max = match last.rule() {
            Rule::AnyLines => limits.drawing_gap_max,
            Rule::RightAngle | Rule::PlainLetter | Rule::AnyCuts => limits.corner_gap_max,
        };
        if gap <= gap_max { Ok(()) } else { Err(self.left_open(Interruption::TooManyBlocks)) }
    }

    /// An offset or coordinate system changed while the path is open.
    fn zero_moved(&self) -> Alarm {
        let diagnostic = Diagnostic::error("zero-moved-in-corner").at(self.block_place());
        let Some(last) = self.corner.as_ref().and_then(|path| path.last()) else {
            return self.finish(diagnostic.with("word", ""));
        };
        let (place, quote) = last.words();
        self.finish(diagnostic.with("word", quote).near(place, "next-block"))
    }

    /// The block in work may not follow the open path.
    pub(crate) fn corner_interrupted(&mut self) -> Alarm {
        self.left_open(Interruption::OtherFunction)
    }

    /// The program or the figure ends while the path is open.
    pub(crate) fn corner_without_next(&mut self) -> Alarm {
        self.left_open(if self.is_in_figure() { Interruption::EndOfFigure } else { Interruption::End })
    }

    /// An alarm at the words that keep the path open, with the block in work beside them.
    fn left_open(&mut self, cause: Interruption) -> Alarm {
        let path = self.corner.take().unwrap_or_default();
        let Some(last) = path.last() else { return self.alarm_block("drawing-end-missing") };
        let (place, quote) = last.words();
        let diagnostic = Diagnostic::alarm(last.fault(cause)).at(place).with("word", quote);
        self.finish(diagnostic.near(self.block_place(), "next-block"))
    }
}
