//! What a program does over time: places, speeds, the spindle, what is removed.
//!
//! In: the timings of its commands, in order of execution, and what each removed. Out: a few thousand [`Moment`]s of
//! equal length. Nobody knows beforehand how long a program takes: whenever there are too many moments, each two
//! become one, so memory does not grow.
//!
//! Within a command places and spindle change evenly; its speed is the mean over its time.

use turnwright_motion::{Kind, Timing};
use turnwright_units::{Position, WorkTip};

/// Moments kept; a power of two.
pub const MOMENTS_MAX: usize = 4096;

/// Length of the first moments, seconds.
const SHORTEST_S: f64 = 1.0 / 64.0;

/// Least and greatest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least.
    pub min: f64,
    /// Greatest.
    pub max: f64,
}

impl Range {
    const NONE: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };

    fn add(&mut self, value: f64) {
        *self = Self { min: self.min.min(value), max: self.max.max(value) };
    }

    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether there is a value at all.
    pub const fn is_known(&self) -> bool {
        self.min <= self.max
    }
}

/// A stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// X, mm, as a diameter.
    pub x_mm: Range,
    /// Z, mm.
    pub z_mm: Range,
    /// Speed along the path, mm/min.
    pub speed_mm_per_min: Range,
    /// Speed of the spindle, rpm.
    pub rpm: Range,
    /// Material taken away, mm³.
    pub removed_mm3: f64,
    /// Seconds spent cutting, in rapids, and on everything else.
    pub shares_s: [f64; 3],
}

impl Moment {
    const NONE: Self = Self {
        x_mm: Range::NONE,
        z_mm: Range::NONE,
        speed_mm_per_min: Range::NONE,
        rpm: Range::NONE,
        removed_mm3: 0.0,
        shares_s: [0.0; 3],
    };

    /// Both together, one behind the other.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            x_mm: self.x_mm.with(other.x_mm),
            z_mm: self.z_mm.with(other.z_mm),
            speed_mm_per_min: self.speed_mm_per_min.with(other.speed_mm_per_min),
            rpm: self.rpm.with(other.rpm),
            removed_mm3: self.removed_mm3 + other.removed_mm3,
            shares_s: std::array::from_fn(|index| self.shares_s[index] + other.shares_s[index]),
        }
    }
}

/// A change of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolCall {
    /// Seconds since the start.
    pub at_s: f64,
    /// Turret station.
    pub tool: u32,
}

/// Tool changes that are remembered.
const TOOL_CALLS_MAX: usize = 200;

/// Records a program.
#[derive(Clone, Debug)]
pub struct Timeline {
    moments: Vec<Moment>,
    moment_s: f64,
    now_s: f64,
    tools: Vec<ToolCall>,
    has_removal: bool,
}

impl Default for Timeline {
    fn default() -> Self {
        let moments = Vec::with_capacity(MOMENTS_MAX);
        Self { moments, moment_s: SHORTEST_S, now_s: 0.0, tools: Vec::new(), has_removal: false }
    }
}

/// Which of the shares of a moment a kind of time belongs to.
const fn share_of(kind: Kind) -> usize {
    match kind {
        Kind::Cutting | Kind::Threading => 0,
        Kind::Rapid => 1,
        _ => 2,
    }
}

/// What is the same, or changes evenly, during an interval.
struct Stretch {
    x_mm: [f64; 2],
    z_mm: [f64; 2],
    rpm: Option<[f64; 2]>,
    speed_mm_per_min: f64,
    removed_mm3: f64,
    kind: Kind,
}

impl Timeline {
    /// The stretches of time, in order.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// How long each of them is, seconds.
    pub const fn moment_s(&self) -> f64 {
        self.moment_s
    }

    /// Seconds in all.
    pub const fn duration_s(&self) -> f64 {
        self.now_s
    }

    /// The changes of the tool, the first two hundred.
    pub fn tools(&self) -> &[ToolCall] {
        &self.tools
    }

    /// Whether anybody said what was removed.
    pub const fn has_removal(&self) -> bool {
        self.has_removal
    }

    /// A tool is called now.
    pub fn call_tool(&mut self, tool: u32) {
        let is_new = self.tools.last().is_none_or(|last| last.tool != tool);
        if tool != 0 && is_new && self.tools.len() < TOOL_CALLS_MAX {
            self.tools.push(ToolCall { at_s: self.now_s, tool });
        }
    }

    /// Adds a command that ends at `to`; `removed_mm3` is what it took away, when anybody knows.
    pub fn add(&mut self, timing: &Timing, to: Position<WorkTip>, removed_mm3: Option<f64>) {
        self.has_removal |= removed_mm3.is_some();
        let place = |at: Position<WorkTip>| (at.x.to_diameter().0.to_mm(), at.z.to_mm());
        let ((x0, z0), (x1, z1)) = (place(timing.from), place(to));
        let rpm = timing.rpm.map(|rpm| [rpm.min, rpm.max]);
        if timing.waited_s > 0.0 {
            let still = Stretch {
                x_mm: [x0, x0],
                z_mm: [z0, z0],
                rpm,
                speed_mm_per_min: 0.0,
                removed_mm3: 0.0,
                kind: Kind::SpindleWait,
            };
            self.spend(timing.waited_s, &still);
        }
        let seconds = timing.seconds - timing.waited_s;
        if seconds > 0.0 && seconds.is_finite() {
            let speed_mm_per_min = timing.length_mm / seconds * 60.0;
            let removed_mm3 = removed_mm3.unwrap_or(0.0);
            let kind = timing.kind;
            let moving = Stretch { x_mm: [x0, x1], z_mm: [z0, z1], rpm, speed_mm_per_min, removed_mm3, kind };
            self.spend(seconds, &moving);
        }
    }

    /// Lets seconds go by.
    fn spend(&mut self, seconds: f64, stretch: &Stretch) {
        let (start_s, end_s) = (self.now_s, self.now_s + seconds);
        self.now_s = end_s;
        while end_s > self.moment_s * MOMENTS_MAX as f64 {
            self.halve();
        }
        let mut index = (start_s / self.moment_s) as usize;
        loop {
            let from_s = start_s.max(index as f64 * self.moment_s);
            let to_s = end_s.min((index + 1) as f64 * self.moment_s);
            // An interval that ends with a moment does not touch the next one.
            if from_s >= to_s && from_s > start_s || index >= MOMENTS_MAX {
                return;
            }
            while self.moments.len() <= index {
                self.moments.push(Moment::NONE);
            }
            let moment = &mut self.moments[index];
            for at_s in [from_s, to_s] {
                let part = (at_s - start_s) / seconds;
                let between = |[from, to]: [f64; 2]| from + (to - from) * part;
                moment.x_mm.add(between(stretch.x_mm));
                moment.z_mm.add(between(stretch.z_mm));
            }
            if let Some([min, max]) = stretch.rpm {
                moment.rpm.add(min);
                moment.rpm.add(max);
            }
            moment.speed_mm_per_min.add(stretch.speed_mm_per_min);
            moment.removed_mm3 += stretch.removed_mm3 * (to_s - from_s) / seconds;
            moment.shares_s[share_of(stretch.kind)] += to_s - from_s;
            index += 1;
        }
    }

    /// Makes one moment of each two.
    fn halve(&mut self) {
        let count = self.moments.len().div_ceil(2);
        for index in 0..count {
            let first = self.moments[2 * index];
            self.moments[index] = self.moments.get(2 * index + 1).map_or(first, |next| first.with(next));
        }
        self.moments.truncate(count);
        self.moment_s *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use turnwright_motion::RpmRange;
    use turnwright_units::{Length, Radius};

    use super::*;

    fn at(radius: i32, z: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_mm(radius)), Length::from_mm(z))
    }

    fn cut(seconds: f64) -> Timing {
        let rpm = Some(RpmRange { min: 500.0, max: 1000.0 });
        Timing { kind: Kind::Cutting, from: at(10, 0), seconds, waited_s: 0.0, length_mm: 30.0, rpm }
    }

    #[test]
    fn nothing_is_lost_when_moments_are_joined() {
        let mut timeline = Timeline::default();
        for _ in 0..1000 {
            timeline.add(&cut(0.7), at(10, -30), Some(2.0));
        }
        assert!(timeline.moments().len() <= MOMENTS_MAX && timeline.moments().len() > MOMENTS_MAX / 4);
        let sum = |of: fn(&Moment) -> f64| timeline.moments().iter().map(of).sum::<f64>();
        assert!((sum(|moment| moment.removed_mm3) - 2000.0).abs() < 1e-6);
        assert!((sum(|moment| moment.shares_s[0]) - 700.0).abs() < 1e-6);
        assert!((timeline.moment_s() * timeline.moments().len() as f64 - 700.0).abs() <= timeline.moment_s());
    }

    #[test]
    fn a_cut_in_the_middle_of_its_way_is_there() {
        let mut timeline = Timeline::default();
        timeline.add(&Timing { waited_s: 1.0, ..cut(4.0) }, at(10, -30), None);
        let moment = |second: f64| timeline.moments()[(second / timeline.moment_s()) as usize];
        assert_eq!((moment(0.5).z_mm, moment(0.5).speed_mm_per_min.max), (Range { min: 0.0, max: 0.0 }, 0.0));
        let middle = moment(2.5);
        assert!(middle.z_mm.min < -14.9 && middle.z_mm.max > -15.2, "{middle:?}");
        assert_eq!((middle.x_mm.max, middle.speed_mm_per_min.max), (20.0, 600.0));
        assert_eq!(middle.rpm, Range { min: 500.0, max: 1000.0 });
        assert!(!timeline.has_removal());
    }
}
