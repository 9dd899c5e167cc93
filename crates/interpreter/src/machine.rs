//! The step machine itself.

use std::collections::HashSet;

use turnwright_canon::{Action, Command, CycleOrigin, OtherAxes, PathMode};
use turnwright_control::{Control, Mode, Parameters, Setup, SetupFault, ThreadRecord};
use turnwright_cycles::Element;
use turnwright_diagnostics::{Diagnostic, Place, SourceId};
use turnwright_syntax::Block;
use turnwright_units::{Angle, Displacement, Length, Position, Radius, SurfaceSpeed, WorkTip};

use crate::Environment;
use crate::auxiliary::Waiting;
use crate::axes::{Axes, Places};
use crate::cache::Cache;
use crate::compensation::Compensation;
use crate::corner::OpenPath;
use crate::data_list::{DataList, ToolLife};
use crate::figure::{FigureRange, Roughed};
use crate::flow::{Frame, Resume};
use crate::functions::cylinder_roughing::CylinderRoughing;
use crate::functions::reference_return::Homing;
use crate::functions::{Dispatch, FunctionId};
use crate::in_force::{InForce, MOTION};
use crate::index::ProgramIndex;
use crate::limits;
use crate::macros::Macros;
use crate::modal::{Modal, Settings, SingleCycle, SpeedMode};
use crate::moves::ActiveCycle;
use crate::offsets::{OffsetInForce, OffsetTables};
use crate::parts::Parts;
use crate::queue::Queue;
use crate::report::Alarm;
use crate::short::{KeptLines, TextLines};
use crate::spindle::MachineLimits;
use crate::strokes::Strokes;
use crate::text::{Cursor, Line, Text};
use crate::transform::Transform;
use crate::zeros::Zeros;

/// What one step gave.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A command to be carried out.
    Emit(Command),
    /// The control would wait here for the world; go on by calling again.
    NeedSync(SyncReason),
    /// The control stops with an alarm; nothing follows.
    Alarm(Box<Diagnostic>),
    /// The program is over.
    End,
}

/// What the control waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncReason {
    /// Cycle start after a program stop.
    CycleStart,
    /// The end of the moves given out so far: a macro asks where the axes are.
    MovesDone,
}

/// Why a block was not executed to its end.
#[derive(Debug)]
pub(crate) enum Halt {
    /// The control stops.
    Alarm(Alarm),
    /// The block runs again when the world has caught up.
    Wait(SyncReason),
}

impl From<Alarm> for Halt {
    fn from(alarm: Alarm) -> Self {
        Self::Alarm(alarm)
    }
}

/// A parameter that a word of a cycle's data block has written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenParameter {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The word.
    pub word: String,
    /// Where it stands.
    pub place: Place,
    /// Number of the text that holds it, and its line there.
    pub source: SourceId,
    /// The line, from 1.
    pub line: u32,
}

/// What the caller may choose for a run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Blocks executed before the run is stopped.
    pub blocks_max: u64,
    /// Blocks of loops executed without a move before the run is stopped.
    pub idle_blocks_max: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { blocks_max: limits::BLOCKS_MAX, idle_blocks_max: limits::IDLE_BLOCKS_MAX }
    }
}

/// The place of the block in work.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockPlace {
    pub(crate) source: SourceId,
    pub(crate) line: u32,
    pub(crate) line_offset: u64,
    pub(crate) first_byte: u32,
    pub(crate) last_byte: u32,
    pub(crate) sequence: Option<u32>,
}

/// The figure being read.
#[derive(Debug)]
pub(crate) struct Capture {
    pub(crate) elements: Vec<Element>,
    /// Elements beyond the first that arcs of ellipses and parabolas take: they are no blocks.
    pub(crate) curve_pieces: usize,
    pub(crate) range: FigureRange,
}

/// Everything but the block buffer, so that functions can read the block while they change the rest.
#[derive(Debug)]
pub(crate) struct Core {
    pub(crate) control: Control,
    pub(crate) settings: Settings,
    pub(crate) dispatch: Dispatch,
    pub(crate) options: Options,
    /// No tool has a nose radius, whatever its offset says.
    pub(crate) has_sharp_noses: bool,
    pub(crate) zeros: Zeros,
    /// Axes beyond X and Z.
    pub(crate) axes: Axes,
    pub(crate) homing: Homing,
    pub(crate) mode: Mode,
    pub(crate) strokes: Strokes,
    /// From program to work coordinates.
    pub(crate) transform: Transform,
    /// Where the last skip move ended.
    pub(crate) skip_place: Position<WorkTip>,
    /// The same of the axes beyond X and Z.
    pub(crate) skip_places: Places,
    /// Moves are transformed, checked against strokes, or refused: see [`Core::look_at_moves`].
    pub(crate) looks_at_moves: bool,
    /// Rapid rates of X and Z.
    pub(crate) rapid_rates_mm_per_min: [f64; 2],
    pub(crate) offsets: OffsetTables,
    pub(crate) modal: Modal,
    pub(crate) text: Text,
    pub(crate) line: Line,
    /// First byte of the next block in the line, when the line holds several.
    pub(crate) from: usize,
    pub(crate) at: BlockPlace,
    pub(crate) program: Option<u32>,
    pub(crate) program_start: Resume,
    /// The first line of the text that the run began with.
    pub(crate) text_start: Cursor,
    /// First byte of the block in work in its line.
    pub(crate) block_from: usize,
    pub(crate) frames: Vec<Frame>,
    pub(crate) indexes: Vec<(SourceId, ProgramIndex)>,
    pub(crate) cache: Cache,
    pub(crate) macros: Macros,
    pub(crate) out: Queue,
    /// End of the last move given out.
    pub(crate) tip: Position<WorkTip>,
    /// From there to the programmed place: a movement of the tool offset that is still to be made.
    pub(crate) untaken: Option<Displacement<WorkTip>>,
    /// The list that data setting has opened.
    pub(crate) data_list: Option<DataList>,
    pub(crate) tool_life: ToolLife,
    pub(crate) active: Option<ActiveCycle>,
    /// What the block of the cycle in work does when the cycle has run.
    pub(crate) waiting: Option<Waiting>,
    pub(crate) in_cycle: Option<CycleOrigin>,
    /// The figure on the cylinder that is roughed.
    pub(crate) cylinder_roughing: Option<Box<CylinderRoughing>>,
    pub(crate) capture: Option<Capture>,
    /// Elements that wait for a later block.
    pub(crate) corner: Option<OpenPath>,
    /// Nose compensation, from G41 or G42 until the move behind G40.
    pub(crate) compensation: Option<Box<Compensation>>,
    /// Parameters that data blocks of cycles have written.
    pub(crate) given: Vec<GivenParameter>,
    /// Crest of the thread in many passes that began last, at its start.
    pub(crate) thread_crest: Option<Radius>,
    /// Figures that were roughed.
    pub(crate) roughed: Vec<Roughed>,
    /// Lines of figures that were finished before anything roughed them.
    pub(crate) finished_first: Vec<u32>,
    /// Bit 0: the block before was a thread; bit 1: the block in work is one.
    pub(crate) thread_blocks: u8,
    /// The place of a thread that the operator recorded.
    pub(crate) thread_record: Option<ThreadRecord>,
    /// Where the thread in work started: of a chain, its first block.
    pub(crate) thread_start_angle: Angle,
    /// The thread before was left by a run-out.
    pub(crate) ends_in_run_out: bool,
    pub(crate) last_spindle: Option<turnwright_canon::Action>,
    pub(crate) parts: Parts,
    /// The block in work comes to rest at its end, those behind it do not.
    pub(crate) stops_once: bool,
    /// The tool has coordinates that no command told, since the end of the program.
    pub(crate) has_untold_place: bool,
    /// Moves meet in another way, and no command told it.
    pub(crate) has_untold_path_mode: bool,
    pub(crate) blocks_run: u64,
    /// Blocks of loops executed since the last move.
    pub(crate) idle_blocks: u64,
    /// The moves given out so far are done: the caller was told to wait for them.
    pub(crate) moves_done: bool,
    /// Moves of cycles given out, and how many of them end the cycle in work with an error.
    pub(crate) cycle_moves: u64,
    pub(crate) cycle_moves_end: u64,
    pub(crate) has_started: bool,
    /// Nothing in force looks at blocks that are nothing but a path: see [`plain`](crate::plain).
    pub(crate) is_plain: bool,
    /// The next block may hold the number of its program.
    pub(crate) expects_program_number: bool,
    pub(crate) is_over: bool,
    pub(crate) sync: Option<SyncReason>,
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) warnings_given: usize,
    /// What was said by key, line and column; column 0 for the whole line, line 0 for the whole run.
    pub(crate) said: HashSet<(&'static str, u32, u32)>,
    /// What the machine can do, as its parameters limit it.
    pub(crate) machine_limits: MachineLimits,
    /// The warning about a standing spindle was given.
    pub(crate) said_spindle_stands: bool,
}

/// Runs one program.
#[derive(Debug)]
pub struct Interpreter {
    pub(crate) core: Core,
    block: Block,
    pub(crate) text_lines: TextLines,
    kept_lines: KeptLines,
    pub(crate) alarm: Option<Alarm>,
}

impl Interpreter {
    /// An interpreter at the start of text `source`, in the state after power-on. Parameters of the setup must
    /// be in `control` already.
    ///
    /// # Errors
    /// A setup whose machine or work systems make no sense.
    pub fn new(
        control: Control,
        setup: &Setup,
        source: SourceId,
        options: Options,
    ) -> Result<Self, SetupFault> {
        let always =
            control.policies.decimal_rule == turnwright_control::policy::DecimalRule::AlwaysCalculator;
        let mut settings =
            Settings::new(&control.parameters, &control.policies, always, control.limits.number_digits);
        let machine = setup.machine()?;
        if settings.thread_feed_max_mm_per_min.is_none() {
            // What the control does not limit, the machine does.
            settings.thread_feed_max_mm_per_min = Some(machine.cutting_max_mm_per_min);
            settings.thread_feed_is_assumed =
                setup.machine.is_none() && !setup.rates.contains_key("cutting_max_mm_per_min");
        }
        let dispatch = Dispatch::new(&control);
        let macros = Macros::new(&control);
        let machine = machine.limited_by(&control.parameters);
        let machine_limits = MachineLimits::new(&machine);
        let strokes = Strokes::new(&control.parameters, &machine.axes);
        let zeros = Zeros::new(&control, setup, &machine)?;
        let mut axes =
            Axes::new(machine.axes, machine.live_tool_rpm_max.is_some(), dispatch.has_incremental_words);
        axes.plane = settings.plane_at_power_on;
        let offsets = OffsetTables::new(setup)?;
        let bit = |name| control.parameters.bit(name);
        let modal = Modal {
            position: Position::new(Radius::ZERO, Length::ZERO),
            motion: if settings.linear_at_power_on { FunctionId::LINEAR } else { FunctionId::RAPID },
            motion_code: dispatch.codes_at_power_on[MOTION].unwrap_or_default(),
            is_inch: bit("inch-input"),
            feed_mode: settings.feed_mode_at_power_on,
            feed: None,
            feed_is_lead: false,
            run_out: None,
            lead_is_left: false,
            path_mode: settings.path_mode_at_power_on,
            lead_by_count: None,
            speed_mode: SpeedMode::Constant,
            rpm: settings.rpm_at_power_on,
            surface: SurfaceSpeed::from_m_per_min(0),
            rpm_max: None,
            spindle: Default::default(),
            gear: 1,
            watch: settings.watch,
            is_watched: false,
            tool: 0,
            offset: 0,
            geometry: 0,
            offset_in_force: OffsetInForce::NONE,
            work: 0,
            cycle: SingleCycle::default(),
            hole: None,
            stays_at_r: false,
            awaits_rigid_tap: false,
            is_incremental: false,
            stroke_two_is_on: settings.stroke_two_at_power_on,
            in_force: InForce::new(dispatch.codes_at_power_on),
        };
        let parts = Parts::new(&control.parameters);
        let untold = control.parameters.stated_untold();
        let warnings =
            untold.map(|number| Diagnostic::warning("parameter-untold").with("parameter", number)).collect();
        let start = Cursor { source, offset: 0, line: 1 };
        let mut core = Core {
            control,
            settings,
            dispatch,
            options,
            has_sharp_noses: false,
            zeros,
            axes,
            homing: Homing {
                is_made: setup.start.homed,
                by_way_of: None,
                others_by_way_of: OtherAxes::default(),
            },
            mode: setup.start.mode,
            strokes,
            transform: Transform::default(),
            skip_place: modal.position,
            skip_places: Places::default(),
            looks_at_moves: false,
            rapid_rates_mm_per_min: [machine.rapid_x_mm_per_min, machine.rapid_z_mm_per_min],
            offsets,
            tip: modal.position,
            untaken: None,
            data_list: None,
            tool_life: ToolLife::default(),
            modal,
            text: Text::new(source),
            line: Line::default(),
            from: 0,
            at: BlockPlace { source, line: 1, ..BlockPlace::default() },
            program: None,
            program_start: Resume { line: start, from: 0 },
            text_start: start,
            parts,
            block_from: 0,
            frames: Vec::new(),
            indexes: Vec::new(),
            cache: Cache::default(),
            macros,
            out: Queue::default(),
            active: None,
            waiting: None,
            in_cycle: None,
            cylinder_roughing: None,
            capture: None,
            corner: None,
            compensation: None,
            given: Vec::new(),
            thread_crest: None,
            roughed: Vec::new(),
            finished_first: Vec::new(),
            thread_blocks: 0,
            thread_record: setup.thread_repair,
            thread_start_angle: Angle::ZERO,
            ends_in_run_out: false,
            last_spindle: None,
            stops_once: false,
            has_untold_place: false,
            has_untold_path_mode: false,
            blocks_run: 0,
            idle_blocks: 0,
            moves_done: true,
            cycle_moves: 0,
            cycle_moves_end: 0,
            has_started: false,
            is_plain: false,
            expects_program_number: true,
            is_over: false,
            sync: None,
            warnings,
            warnings_given: 0,
            said: HashSet::new(),
            machine_limits,
            said_spindle_stands: false,
        };
        if setup.machine.is_some() || setup.rates.contains_key("reference") {
            core.said.insert(("home-is-assumed", 0, 0));
        }
        if core.modal.path_mode != PathMode::default() {
            core.emit(Action::PathMode(core.modal.path_mode));
        }
        core.modal.feed = core.initial_feed();
        core.modal.is_incremental = core.starts_incremental();
        core.modal.offset_in_force = core.offset_called();
        core.start_at_reference();
        core.look_at_moves();
        Ok(Self {
            core,
            block: Block::new(),
            text_lines: TextLines::default(),
            kept_lines: KeptLines::default(),
            alarm: None,
        })
    }

    /// Where the tool tip stands.
    pub fn position(&self) -> Position<WorkTip> {
        self.core.stands()
    }

    /// The control in use.
    pub fn control(&self) -> &Control {
        &self.core.control
    }

    /// Blocks executed so far.
    pub fn blocks_run(&self) -> u64 {
        self.core.blocks_run
    }

    /// Bytes of the text in work that lie behind the block in work, from its start: for progress.
    pub fn offset(&self) -> u64 {
        self.core.at.line_offset
    }

    /// The parameters as they are now: data blocks of cycles write some of them.
    pub fn parameters(&self) -> Parameters {
        let mut parameters = self.core.control.parameters.clone();
        self.core.settings.store(&mut parameters);
        parameters
    }

    /// The parameters that data blocks of cycles have written so far, each with the last word that did.
    pub fn given_parameters(&self) -> &[GivenParameter] {
        &self.core.given
    }

    /// Crest of the thread in many passes that began last, at the thread's start: its depths count from there.
    pub fn thread_crest(&self) -> Option<Radius> {
        self.core.thread_crest
    }

    /// Decimal places of the control's least increment, metric.
    pub fn decimals(&self) -> u8 {
        self.core.settings.metric_increment.metric_decimals()
    }

    /// The same with sharp tools: compensated moves then lead the tip along the contour as it was programmed.
    #[must_use]
    pub fn with_sharp_noses(mut self) -> Self {
        self.core.has_sharp_noses = true;
        self
    }

    /// Warnings given since the last call.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.core.warnings)
    }

    /// Goes on until there is something to say.
    #[inline]
    pub fn step(&mut self, environment: &mut dyn Environment) -> Step {
        // The moves of a cycle come one behind the other with nothing in between, and so do those of short lines. Each
        // kind has a function of its own: what the others keep at hand would be in its way.
        if self.text_lines.goes_on() {
            return self.step_by_lines(environment);
        }
        if self.core.out.is_empty() && self.core.sync.is_none() {
            if self.core.active.is_some() {
                if let Some(command) = self.next_cycle_move() {
                    return Step::Emit(command);
                }
            } else if self.alarm.is_none() {
                return if self.core.cache.current.is_some() {
                    self.step_by_kept_lines(environment)
                } else {
                    self.step_by_lines(environment)
                };
            }
        }
        self.step_by_blocks(environment)
    }

    #[inline(never)]
    fn step_by_lines(&mut self, environment: &mut dyn Environment) -> Step {
        match self.core.next_short_move(&mut self.text_lines) {
            Some(command) => self.emit(command),
            None => self.step_by_blocks(environment),
        }
    }

    #[inline(never)]
    fn step_by_kept_lines(&mut self, environment: &mut dyn Environment) -> Step {
        match self.core.next_short_move(&mut self.kept_lines) {
            Some(command) => self.emit(command),
            None => self.step_by_blocks(environment),
        }
    }

    #[inline(always)]
    fn emit(&mut self, command: Command) -> Step {
        self.note_move();
        Step::Emit(command)
    }

    /// A move is given out: the program does something, and its moves are not over.
    #[inline(always)]
    fn note_move(&mut self) {
        self.core.idle_blocks = 0;
        self.core.moves_done = false;
    }

    #[inline(always)]
    fn next_cycle_move(&mut self) -> Option<Command> {
        let command = self.core.next_cycle_move()?;
        self.note_move();
        Some(command)
    }

    /// The same on the way from blocks to a cycle, which is gone once a cycle.
    #[cold]
    fn first_cycle_move(&mut self) -> Option<Command> {
        self.next_cycle_move()
    }

    fn step_by_blocks(&mut self, environment: &mut dyn Environment) -> Step {
        loop {
            if let Some(command) = self.core.out.front() {
                if command.action.end_point().is_some() {
                    self.core.idle_blocks = 0;
                }
                if self.core.out.second().is_some() || self.core.macros.state.single_block != 0 {
                    self.core.mark_running_on();
                }
                self.core.moves_done = false;
            }
            if let Some(command) = self.core.out.pop_front() {
                return Step::Emit(command);
            }
            if let Some(reason) = self.core.sync.take() {
                return Step::NeedSync(reason);
            }
            if let Some(alarm) = self.alarm.take() {
                return Step::Alarm(alarm);
            }
            if self.core.is_over {
                return Step::End;
            }
            let result = if self.core.active.is_some() {
                if let Some(command) = self.first_cycle_move() {
                    return Step::Emit(command);
                }
                self.core.look_at_cycle_move().map_err(Halt::from)
            } else if self.core.is_due() {
                self.core.finish_waiting(&self.block, environment).map_err(Halt::from)
            } else {
                self.core.run_block(&mut self.block, environment)
            };
            match result {
                Ok(()) => {}
                Err(Halt::Wait(_)) if self.core.has_waiting_move() => self.finish_waiting_move(),
                Err(Halt::Wait(reason)) => {
                    self.core.moves_done = true;
                    return Step::NeedSync(reason);
                }
                Err(Halt::Alarm(alarm)) => self.stop(alarm),
            }
        }
    }

    /// The control waits for the moves read so far: the one that waits for the next goes without it.
    #[cold]
    fn finish_waiting_move(&mut self) {
        if let Err(alarm) = self.core.stop_reading_ahead() {
            self.stop(alarm);
        }
    }

    /// The control stops behind the moves that it has read.
    #[cold]
    fn stop(&mut self, alarm: Alarm) {
        // What is wrong with the last of them would only have come to light later.
        let _ = self.core.stop_reading_ahead();
        self.core.is_over = true;
        self.core.active = None;
        self.alarm = Some(alarm);
    }
}
