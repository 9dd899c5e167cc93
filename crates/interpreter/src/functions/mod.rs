//! The functions that codes name, one file each.
//!
//! A file holds the manual entry (its head comment), the specification (words, place in figures, effect on
//! modal state) and the code. Numbers, groups and texts stand in `data/functions.toml` under the same name, so
//! that the same function can be `G71` here and `G73` there, and codes that are not executed yet are known by
//! name. `linear.rs` is the model file.

pub(crate) mod arc;
mod arc_thread;
mod conic;
mod coordinate_setting;
pub(crate) mod cylinder_roughing;
mod data_setting;
mod dwell;
mod finishing;
mod fluctuation;
mod groove;
pub(crate) mod hole;
mod hole_tap;
mod interpolation;
mod linear;
mod look_ahead;
mod machine_coordinates;
mod macro_call;
mod measuring;
mod modes;
pub(crate) mod multi_thread;
mod nose_compensation;
mod one_block;
mod path_mode;
mod pattern;
mod plane_arc;
mod planes;
mod polygon;
mod rapid;
pub(crate) mod reference_return;
mod rough;
mod single_cycles;
mod skip;
mod stroke_check;
mod tapping_in_line;
pub(crate) mod thread;
mod three_point_arc;
mod transforms;

use turnwright_canon::Turn;
use turnwright_control::{CodeSystem, Control, Functions};
use turnwright_syntax::Block;

use crate::block::Call;
use crate::in_force::{GROUPS, codes_at_power_on};
use crate::machine::Core;
use crate::macros::CallKind;
use crate::report::Alarm;

/// What a function does when its block runs.
type Run = fn(&mut Core, &mut Call<'_>) -> Result<(), Alarm>;

/// A path of single moves: lines of such may go the [`short`](crate::short) way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathKind {
    Rapid,
    Line,
    Arc(Turn),
}

/// When a function acts.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    /// Changes a mode before anything else in the block.
    Mode(Run),
    /// Moves the tool; stays in force.
    Motion(Run),
    /// Acts once.
    OneShot(Run),
    /// Calls a macro, with the other words of the block as arguments.
    Call(CallKind),
}

/// The function that ends a modal macro call.
pub(crate) const MODAL_CALL_CANCEL: &str = "modal-macro-cancel";

/// A function: what the block may hold and what happens.
pub(crate) struct Function {
    /// Its entry in `data/functions.toml`.
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    /// Letters it takes besides X, Z, U, W and those of every block.
    pub(crate) letters: u32,
    /// Letters that make a motion run when its code is in force from an earlier block.
    pub(crate) trigger: u32,
    /// Which letters of axes beyond X and Z it takes: all or none.
    pub(crate) other_axes: u32,
    /// May stand in the figure of a cycle.
    pub(crate) in_figure: bool,
    /// Its F is a lead.
    pub(crate) takes_lead: bool,
    /// Its S is a speed limit.
    pub(crate) takes_speed_limit: bool,
    /// A T word in its block is an alarm by parameter.
    pub(crate) sets_data: bool,
    /// Runs again in blocks without axis words on some controls.
    pub(crate) repeats: bool,
    /// Leaves the end point of a single cycle in force.
    pub(crate) keeps_single_cycle: bool,
    /// May stand while the coordinates are rotated.
    pub(crate) in_rotation: bool,
    /// One of the multiple repetitive cycles: a foreign letter has an alarm of its own.
    pub(crate) is_multiple_cycle: bool,
    /// A hole cycle, in force until another motion code or the code that cancels it.
    pub(crate) is_hole_cycle: bool,
    /// Its lines may be given by their angle.
    pub(crate) draws_lines: bool,
    /// Its blocks are single moves: see [`plain`](crate::plain).
    pub(crate) path: Option<PathKind>,
}

/// The bits of some letters.
pub(crate) const fn letters(text: &[u8]) -> u32 {
    let mut bits = 0;
    let mut at = 0;
    while at < text.len() {
        bits |= Block::bit(text[at]);
        at += 1;
    }
    bits
}

const AXES: u32 = letters(b"XZUW");

impl Function {
    const fn new(name: &'static str, kind: Kind) -> Self {
        Self {
            name,
            kind,
            letters: 0,
            trigger: 0,
            other_axes: 0,
            in_figure: false,
            takes_lead: false,
            takes_speed_limit: false,
            sets_data: false,
            repeats: false,
            keeps_single_cycle: false,
            in_rotation: false,
            is_multiple_cycle: false,
            is_hole_cycle: false,
            draws_lines: false,
            path: None,
        }
    }

    /// A mode.
    pub(crate) const fn mode(name: &'static str, run: Run) -> Self {
        Self::new(name, Kind::Mode(run))
    }

    /// A motion, run by axis words.
    pub(crate) const fn motion(name: &'static str, run: Run) -> Self {
        let mut function = Self::new(name, Kind::Motion(run));
        function.trigger = AXES;
        function
    }

    /// A macro call.
    pub(crate) const fn call(name: &'static str, kind: CallKind) -> Self {
        Self::new(name, Kind::Call(kind))
    }

    /// Whether it calls a macro.
    pub(crate) const fn is_call(&self) -> bool {
        matches!(self.kind, Kind::Call(_))
    }

    /// A one-shot function.
    pub(crate) const fn one_shot(name: &'static str, run: Run) -> Self {
        Self::new(name, Kind::OneShot(run))
    }

    pub(crate) const fn with_letters(mut self, text: &[u8]) -> Self {
        self.letters = letters(text);
        self
    }

    pub(crate) const fn triggered_by(mut self, text: &[u8]) -> Self {
        self.trigger |= letters(text);
        self
    }

    pub(crate) const fn with_other_axes(mut self) -> Self {
        self.other_axes = u32::MAX;
        self
    }

    pub(crate) const fn allowed_in_figure(mut self) -> Self {
        self.in_figure = true;
        self
    }

    pub(crate) const fn allowed_in_rotation(mut self) -> Self {
        self.in_rotation = true;
        self
    }

    pub(crate) const fn with_lead(mut self) -> Self {
        self.takes_lead = true;
        self
    }

    pub(crate) const fn with_speed_limit(mut self) -> Self {
        self.takes_speed_limit = true;
        self
    }

    pub(crate) const fn setting_data(mut self) -> Self {
        self.sets_data = true;
        self
    }

    pub(crate) const fn repeating(mut self) -> Self {
        self.repeats = true;
        self
    }

    pub(crate) const fn keeping_single_cycle(mut self) -> Self {
        self.keeps_single_cycle = true;
        self
    }

    /// A line whose angle alone makes it run.
    pub(crate) const fn drawing_lines(mut self) -> Self {
        self.draws_lines = true;
        self.with_letters(crate::corner::LETTERS).triggered_by(b"AQ")
    }

    /// A path of single moves.
    pub(crate) const fn making_a_path(mut self, kind: PathKind) -> Self {
        self.path = Some(kind);
        self
    }

    pub(crate) const fn multiple_cycle(mut self) -> Self {
        self.is_multiple_cycle = true;
        self
    }

    pub(crate) const fn hole_cycle(mut self) -> Self {
        self.is_hole_cycle = true;
        self.with_other_axes().allowed_in_rotation().with_letters(b"RQPKJD").triggered_by(b"RQPKJD")
    }

    /// A hole cycle that may have its lead as threads per inch.
    pub(crate) const fn tapping_cycle(self) -> Self {
        self.hole_cycle().with_letters(b"RQPKJDI")
    }

    /// A tapping cycle.
    pub(crate) fn is_tapping(&self) -> bool {
        matches!(self.name, "face-tapping" | "side-tapping")
    }

    /// It can lead the spindle as an axis.
    pub(crate) fn leads_spindle(&self) -> bool {
        self.is_tapping() || matches!(self.name, "rigid-thread" | "rigid-thread-cycle")
    }

    /// A turning, facing or thread cycle of one block.
    pub(crate) fn is_single_cycle(&self) -> bool {
        matches!(
            self.name,
            "turning-cycle" | "thread-cycle" | "facing-cycle" | "rigid-thread-cycle" | "run-in-thread-cycle"
        )
    }

    #[inline]
    pub(crate) fn run(&self, core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
        match self.kind {
            Kind::Mode(run) | Kind::Motion(run) | Kind::OneShot(run) => run(core, call),
            // Calls take the whole block and never get here.
            Kind::Call(_) => Ok(()),
        }
    }
}

/// All functions; a new file adds its line here.
static ALL: &[&Function] = &[
    &rapid::RAPID,
    &linear::LINEAR,
    &arc::ARC_CLOCKWISE,
    &arc::ARC_COUNTER_CLOCKWISE,
    &three_point_arc::THREE_POINT_ARC,
    &three_point_arc::THREE_POINT_ARC_ABSOLUTE,
    &conic::ELLIPSE_CLOCKWISE,
    &conic::ELLIPSE_COUNTER_CLOCKWISE,
    &conic::PARABOLA_CLOCKWISE,
    &conic::PARABOLA_COUNTER_CLOCKWISE,
    &thread::THREAD,
    &thread::VARIABLE_LEAD_THREAD,
    &thread::VARIABLE_LEAD_THREAD_R,
    &thread::RIGID_THREAD,
    &arc_thread::ARC_THREAD_CLOCKWISE,
    &arc_thread::ARC_THREAD_COUNTER_CLOCKWISE,
    &arc_thread::CIRCULAR_THREAD_CLOCKWISE,
    &arc_thread::CIRCULAR_THREAD_COUNTER_CLOCKWISE,
    &tapping_in_line::TAPPING_IN_LINE,
    &dwell::DWELL,
    &modes::INCH,
    &modes::METRIC,
    &nose_compensation::OFF,
    &nose_compensation::LEFT,
    &nose_compensation::RIGHT,
    &modes::WORK_COORDINATES_1,
    &modes::WORK_COORDINATES_2,
    &modes::WORK_COORDINATES_3,
    &modes::WORK_COORDINATES_4,
    &modes::WORK_COORDINATES_5,
    &modes::WORK_COORDINATES_6,
    &modes::WORK_COORDINATES_ADDITIONAL,
    &modes::CONSTANT_SURFACE_SPEED,
    &modes::CONSTANT_SPINDLE_SPEED,
    &modes::FEED_PER_MINUTE,
    &modes::FEED_PER_REVOLUTION,
    &modes::ABSOLUTE,
    &modes::INCREMENTAL,
    &planes::PLANE_XY,
    &planes::PLANE_ZX,
    &planes::PLANE_YZ,
    &interpolation::POLAR_ON,
    &interpolation::POLAR_OFF,
    &interpolation::POLAR_WORDS_ON,
    &interpolation::POLAR_WORDS_OFF,
    &interpolation::CYLINDRICAL,
    &polygon::POLYGON_ON,
    &polygon::POLYGON_OFF,
    &hole::HOLE_CYCLE_OFF,
    &hole::RETURN_TO_START_LEVEL,
    &hole::RETURN_TO_R_LEVEL,
    &hole::FACE_DRILLING,
    &hole::SIDE_DRILLING,
    &hole::FACE_DRILLING_WITH_RETRACT,
    &hole::SIDE_DRILLING_WITH_RETRACT,
    &hole::FACE_TAPPING,
    &hole::SIDE_TAPPING,
    &hole::FACE_BORING,
    &hole::SIDE_BORING,
    &path_mode::EXACT_STOP,
    &path_mode::EXACT_STOP_MODE,
    &path_mode::TAPPING_MODE,
    &path_mode::CUTTING_MODE,
    &look_ahead::LOOK_AHEAD_CONTROL,
    &look_ahead::ADVANCED_PREVIEW,
    &transforms::DOUBLE_TURRET_MIRROR_ON,
    &transforms::DOUBLE_TURRET_MIRROR_OFF,
    &transforms::ROTATION_ON,
    &transforms::ROTATION_OFF,
    &stroke_check::STROKE_CHECK_ON,
    &stroke_check::STROKE_CHECK_OFF,
    &fluctuation::SPINDLE_FLUCTUATION_ON,
    &fluctuation::SPINDLE_FLUCTUATION_OFF,
    &coordinate_setting::COORDINATE_SETTING,
    &data_setting::DATA_SETTING,
    &data_setting::DATA_SETTING_END,
    &coordinate_setting::COORDINATE_PRESET,
    &coordinate_setting::LOCAL_COORDINATES,
    &machine_coordinates::MACHINE_COORDINATES,
    &skip::SKIP,
    &measuring::MEASURING_X,
    &measuring::MEASURING_Z,
    &reference_return::REFERENCE_RETURN,
    &reference_return::SECOND_REFERENCE_RETURN,
    &reference_return::REFERENCE_LEAVE,
    &reference_return::REFERENCE_CHECK,
    &single_cycles::TURNING_CYCLE,
    &single_cycles::THREAD_CYCLE,
    &single_cycles::RIGID_THREAD_CYCLE,
    &single_cycles::RUN_IN_THREAD_CYCLE,
    &single_cycles::FACING_CYCLE,
    &finishing::FINISHING,
    &rough::ROUGH_TURNING,
    &rough::ROUGH_FACING,
    &pattern::PATTERN_REPEATING,
    &groove::FACE_GROOVE,
    &groove::RADIAL_GROOVE,
    &multi_thread::MULTI_THREAD,
    &multi_thread::ENHANCED_THREAD,
    &multi_thread::ENHANCED_THREAD_980,
    &macro_call::MACRO_CALL,
    &macro_call::MODAL_MACRO_CALL,
    &macro_call::MACRO_CALL_EACH_BLOCK,
    &macro_call::MODAL_MACRO_CANCEL,
];

/// A function by its place in the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FunctionId(u8);

impl FunctionId {
    /// Positioning.
    pub(crate) const RAPID: Self = Self(0);
    /// The straight cut.
    pub(crate) const LINEAR: Self = Self(1);

    #[inline]
    pub(crate) fn get(self) -> &'static Function {
        ALL[usize::from(self.0)]
    }
}

/// Names of the functions that are executed; all others of the table are refused by name.
pub fn implemented_functions() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|function| function.name)
}

/// From a code to its function, for one control.
pub(crate) struct Dispatch {
    /// By code times ten; 0 is no function, else its place in the list plus one.
    table: Box<[u8; 10_000]>,
    /// Modal group by place in the list.
    groups: [u8; ALL.len()],
    /// By group, times ten.
    pub(crate) codes_at_power_on: [Option<u16>; GROUPS],
    pub(crate) system: CodeSystem,
    /// U and W are increments of X and Z.
    pub(crate) has_incremental_words: bool,
}

impl std::fmt::Debug for Dispatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Dispatch {{ system: {:?} }}", self.system)
    }
}

impl Dispatch {
    pub(crate) fn new(control: &Control) -> Self {
        let system = if control.parameters.bit("g-code-system-c") {
            CodeSystem::C
        } else if control.parameters.bit("g-code-system-b") {
            CodeSystem::B
        } else {
            CodeSystem::A
        };
        let functions = Functions;
        let mut table = Box::new([0u8; 10_000]);
        let mut groups = [0; ALL.len()];
        let entries = ALL.iter().enumerate().filter_map(|(place, f)| Some((place, functions.get(f.name)?)));
        let entries: Vec<_> = entries.collect();
        // What a parameter brings in comes last, in place of what had the code before.
        let plain = entries.iter().filter(|(_, entry)| entry.only_with().is_none());
        let chosen = entries.iter().filter(|(_, entry)| {
            entry.only_with().is_some_and(|parameter| control.parameters.bit(parameter))
        });
        for &(place, entry) in plain.chain(chosen) {
            groups[place] = entry.group().0;
            if !entry.is_on(control.code_table) {
                continue;
            }
            for code in entry.code_numbers(system) {
                table[usize::from(*code)] = place as u8 + 1;
            }
        }
        let codes_at_power_on = codes_at_power_on(&control.parameters, system, control.code_table);
        Self { table, groups, codes_at_power_on, system, has_incremental_words: system == CodeSystem::A }
    }

    /// The modal group of a function, 0 for one-shot codes.
    #[inline]
    pub(crate) fn group(&self, id: FunctionId) -> u8 {
        self.groups[usize::from(id.0)]
    }

    /// The function that a code (times ten, below 10,000) names.
    #[inline]
    pub(crate) fn function(&self, code: u16) -> Option<FunctionId> {
        let place = self.table.get(usize::from(code)).copied().unwrap_or(0);
        place.checked_sub(1).map(FunctionId)
    }
}
