//! The modal state: everything that stays in force from block to block.

use turnwright_canon::{PathMode, SpindleState, SpindleWatch};
use turnwright_control::policy::Policies;
use turnwright_control::{Axis, Parameters};
use turnwright_cycles::FlankInfeed;
use turnwright_syntax::Block;
use turnwright_units::{LeastIncrement, Length, Position, Radius, Rpm, SurfaceSpeed, WorkTip};

use crate::axes::Plane;
use crate::compensation::CompensationSettings;
use crate::functions::FunctionId;
use crate::functions::hole::{HoleInForce, HoleSettings};
use crate::functions::multi_thread::{RunOutWords, flank_infeed};
use crate::functions::thread::RunOut;
use crate::in_force::InForce;
use crate::offsets::{OffsetInForce, OffsetSettings};

/// Feed per minute or per revolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FeedMode {
    PerMinute,
    PerRevolution,
}

/// Constant speed of the spindle or of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpeedMode {
    Constant,
    Surface,
}

/// End point and taper of a single cycle, kept while its code is in force.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SingleCycle {
    pub(crate) x: Option<Radius>,
    pub(crate) z: Option<Length>,
    pub(crate) taper: Length,
    /// J and K of a thread: run-out across and along.
    pub(crate) run_out_depth: Option<Length>,
    pub(crate) run_out_length: Option<Length>,
    /// D and E of a thread: run-in across and along.
    pub(crate) run_in_depth: Option<Length>,
    pub(crate) run_in_length: Option<Length>,
    /// Starts of a thread; 0 and 1 are one.
    pub(crate) starts: u32,
    /// The thread runs across the face.
    pub(crate) is_face_thread: bool,
    /// The thread goes through the recorded place.
    pub(crate) repairs: bool,
    pub(crate) pass: u32,
}

/// What stays in force.
#[derive(Clone, Debug)]
pub(crate) struct Modal {
    /// Where the tool tip is.
    pub(crate) position: Position<WorkTip>,
    /// The function of group 01 in force.
    pub(crate) motion: FunctionId,
    /// Its code as written, times ten.
    pub(crate) motion_code: u16,
    pub(crate) is_inch: bool,
    pub(crate) feed_mode: FeedMode,
    /// The feed word in force: mm per minute or per revolution.
    pub(crate) feed: Option<Length>,
    /// A thread gave it: it is a lead.
    pub(crate) feed_is_lead: bool,
    /// The run-out that words of a thread block gave last.
    pub(crate) run_out: Option<RunOut>,
    /// That lead is a left-handed one, of a code that leads the spindle.
    pub(crate) lead_is_left: bool,
    pub(crate) path_mode: PathMode,
    /// The lead that threads per inch gave, until a thread has another.
    pub(crate) lead_by_count: Option<Length>,
    pub(crate) speed_mode: SpeedMode,
    pub(crate) rpm: Rpm,
    pub(crate) surface: SurfaceSpeed,
    pub(crate) rpm_max: Option<Rpm>,
    pub(crate) spindle: SpindleState,
    /// Gear of the spindle, 1 to 8.
    pub(crate) gear: u8,
    /// How its speed is watched, when it is.
    pub(crate) watch: SpindleWatch,
    pub(crate) is_watched: bool,
    pub(crate) tool: u32,
    pub(crate) offset: u32,
    /// Number of the geometry offset in force; that of the wear is `offset`.
    pub(crate) geometry: u32,
    /// What the offset does, with the values that it had when it was called.
    pub(crate) offset_in_force: OffsetInForce,
    /// Work coordinate system: 0 to 5 are the standard ones, the additional ones follow.
    pub(crate) work: usize,
    pub(crate) cycle: SingleCycle,
    /// The hole cycle in force.
    pub(crate) hole: Option<HoleInForce>,
    /// Systems B and C: hole cycles stay at the R point.
    pub(crate) stays_at_r: bool,
    /// Rigid tapping is announced, its cycle is still to come.
    pub(crate) awaits_rigid_tap: bool,
    /// Systems B and C: X and Z are increments.
    pub(crate) is_incremental: bool,
    /// The second stroke check looks at moves.
    pub(crate) stroke_two_is_on: bool,
    /// The codes and values that programs and displays can read.
    pub(crate) in_force: InForce,
}

impl Modal {
    /// The least increment of the words in force.
    pub(crate) fn increment(&self, settings: &Settings) -> LeastIncrement {
        if self.is_inch { settings.inch_increment } else { settings.metric_increment }
    }
}

/// Parameters that programs and cycles consult, resolved once; data blocks of cycles write some of them.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(crate) metric_increment: LeastIncrement,
    pub(crate) inch_increment: LeastIncrement,
    pub(crate) metric_decimals: u8,
    /// Lengths reach to this, metric.
    pub(crate) length_limit_nm: i64,
    pub(crate) is_calculator: bool,
    /// X and U are radii.
    pub(crate) x_is_radius: bool,
    pub(crate) cycle_words_in_mm: bool,
    pub(crate) linear_rapid: bool,
    pub(crate) plane_at_power_on: Plane,
    pub(crate) polar_linear_axis: u32,
    pub(crate) polar_rotary_axis: u32,
    pub(crate) polar_feed_max: Length,
    pub(crate) polar_automatic_override: bool,
    pub(crate) linear_machine_move: bool,
    pub(crate) skip_feed_overridden: bool,
    pub(crate) coordinate_setting_alarm: bool,
    pub(crate) first_reference_by_hand: bool,
    pub(crate) start_without_reference: bool,
    pub(crate) reference_return_clears_local: bool,
    pub(crate) reference_return_clears_preset: bool,
    pub(crate) reference_return_cancels_offset: bool,
    pub(crate) reset_clears_local: bool,
    pub(crate) program_end_clears_local: bool,
    pub(crate) stroke_two_at_power_on: bool,
    pub(crate) rotation_angle_deg: f64,
    pub(crate) feed_per_rev_fine: bool,
    pub(crate) feed_per_min_fine: bool,
    pub(crate) arc_tolerance_mm: f64,
    pub(crate) arc_without_radius_alarm: bool,
    pub(crate) arc_small_radius_alarm: bool,
    pub(crate) duplicate_word_alarm: bool,
    pub(crate) several_auxiliary: bool,
    /// M codes behind which the control waits for the moves before it reads on, first and last of each range.
    pub(crate) unbuffered: Box<[(u32, u32)]>,
    /// The letter of the second auxiliary function, as the bit of [`Block::present`]; 0 without.
    pub(crate) second_auxiliary: u32,
    /// M99 is given out as well.
    pub(crate) gives_return_code: bool,
    /// Largest number of an M word.
    pub(crate) auxiliary_max: u32,
    /// How moves meet before any code says it.
    pub(crate) path_mode_at_power_on: PathMode,
    /// Speed before the first S word.
    pub(crate) rpm_at_power_on: Rpm,
    /// Of the spindle by parameter, in any mode and gear; `None` without.
    pub(crate) rpm_max: Option<Rpm>,
    /// Of gears 1 to 8; `None` without.
    pub(crate) gear_rpm_max: [Option<Rpm>; 8],
    /// How the speed is watched before any word says it.
    pub(crate) watch: SpindleWatch,
    /// Words and parameters of the watch count tenths of a percent.
    pub(crate) watch_counts_tenths: bool,
    pub(crate) surface_speed_available: bool,
    /// Number of the axis whose coordinate gives the diameter; 0 and 1 are X.
    pub(crate) surface_speed_axis: u32,
    pub(crate) spindle_selection_code: u32,
    /// Largest number of an S word.
    pub(crate) speed_max: u32,
    pub(crate) linear_at_power_on: bool,
    pub(crate) incremental_at_power_on: bool,
    pub(crate) feed_mode_at_power_on: FeedMode,
    /// mm per minute.
    pub(crate) initial_feed: Length,
    pub(crate) clear_modes_at_reset: bool,
    pub(crate) reset_selects_first_work: bool,
    /// At M02.
    pub(crate) no_rewind_at_plain_end: bool,
    /// At M30.
    pub(crate) no_rewind_at_end: bool,
    pub(crate) end_of_record_allowed: bool,
    pub(crate) plain_corner_letters: bool,
    pub(crate) angle_as_supplement: bool,
    pub(crate) corner_length_to_corner: bool,
    pub(crate) dwell_in_revolutions: bool,
    /// The fastest that the long axis of a thread may be, when that is limited.
    pub(crate) thread_feed_max_mm_per_min: Option<f64>,
    /// That limit is the assumed machine's.
    pub(crate) thread_feed_is_assumed: bool,
    /// The largest cutting feed was set to zero by hand.
    pub(crate) cutting_feed_is_barred: bool,
    pub(crate) thread_speed_check_off: bool,
    pub(crate) thread_repair: bool,
    pub(crate) thread_repair_follows: bool,
    pub(crate) thread_record_kept: bool,
    /// Speed of leaving a thread, mm per minute; `None` is rapid traverse.
    pub(crate) thread_pull_out_feed: Option<Length>,
    pub(crate) run_out_tenths: u32,
    /// Depth of a run-in that no word gives, radius.
    pub(crate) run_in_depth: Length,
    /// Length of a run-in that no word gives.
    pub(crate) run_in_length: Length,
    pub(crate) run_out_angle_deg: u8,
    pub(crate) one_block_form: bool,
    pub(crate) cut_depth: Length,
    /// A block of its own has given depth or escape.
    pub(crate) has_roughing_data: bool,
    pub(crate) cut_escape: Length,
    pub(crate) pattern_relief_x: Radius,
    pub(crate) pattern_relief_z: Length,
    pub(crate) pattern_passes: u32,
    pub(crate) groove_return: Length,
    pub(crate) thread_finishing_passes: u32,
    pub(crate) thread_nose_angle_deg: u8,
    pub(crate) thread_minimum_depth: Radius,
    pub(crate) thread_finishing_allowance: Radius,
    /// What data blocks of the threading cycle write beside parameters.
    pub(crate) thread_infeed: FlankInfeed,
    pub(crate) thread_starts: u32,
    pub(crate) thread_run_out_words: RunOutWords,
    pub(crate) enhanced_thread_infeed: FlankInfeed,
    pub(crate) enhanced_thread_equal_steps: bool,
    pub(crate) enhanced_thread_finishing_passes: Option<u32>,
    pub(crate) enhanced_thread_starts: u32,
    pub(crate) cycle_stops_behind_moves: bool,
    pub(crate) corner_stops_single_block: bool,
    pub(crate) figure_check: bool,
    pub(crate) monotony_check: bool,
    pub(crate) type_by_first_block: bool,
    pub(crate) no_semi_finish: bool,
    pub(crate) no_pocket_semi_finish: bool,
    /// How far a figure may turn back along the first and the second axis; the second as a radius.
    pub(crate) monotony_tolerances: [Length; 2],
    pub(crate) pocket_clearance: Length,
    pub(crate) follows_pocket_bottom: bool,
    pub(crate) rapid_escape: bool,
    pub(crate) hole: HoleSettings,
    pub(crate) offsets: OffsetSettings,
    pub(crate) compensation: CompensationSettings,
}

impl Settings {
    /// Writes into the parameters what programs have changed here: data blocks of cycles write parameters.
    pub(crate) fn store(&self, parameters: &mut Parameters) {
        let lengths = [
            ("cycle-depth-of-cut", self.cut_depth),
            ("cycle-escape", self.cut_escape),
            ("pattern-relief-x", self.pattern_relief_x.0),
            ("pattern-relief-z", self.pattern_relief_z),
            ("groove-return", self.groove_return),
            ("thread-minimum-depth", self.thread_minimum_depth.0),
            ("thread-finishing-allowance", self.thread_finishing_allowance.0),
        ];
        for (name, length) in lengths {
            parameters.set_by_name(name, length.to_mm());
        }
        let counts = [
            ("pattern-passes", self.pattern_passes),
            ("thread-finishing-passes", self.thread_finishing_passes),
            ("thread-nose-angle", u32::from(self.thread_nose_angle_deg)),
            ("thread-run-out", self.run_out_tenths),
        ];
        for (name, count) in counts {
            parameters.set_by_name(name, f64::from(count));
        }
    }

    pub(crate) fn new(
        parameters: &Parameters,
        policies: &Policies,
        always_calculator: bool,
        digits: u8,
    ) -> Self {
        let bit = |name| parameters.bit(name);
        let mm = |name: &str| Length::from_nm((parameters.value(name) * 1e6).round() as i64);
        let count = |name: &str| parameters.value(name).clamp(0.0, 1e9) as u32;
        let rpm = |name: &str| Some(Rpm(count(name))).filter(|rpm| rpm.0 > 0);
        let (metric_increment, inch_increment) = if bit("least-input-increment-c") {
            (LeastIncrement::METRIC_C, LeastIncrement::INCH_C)
        } else if bit("least-input-increment-a") {
            (LeastIncrement::METRIC_A, LeastIncrement::INCH_A)
        } else {
            (LeastIncrement::METRIC_B, LeastIncrement::INCH_B)
        };
        Self {
            metric_increment,
            inch_increment,
            metric_decimals: metric_increment.metric_decimals(),
            length_limit_nm: 10i64.pow(u32::from(digits.min(9))) * metric_increment.nm(),
            is_calculator: always_calculator || bit("decimal-point-input"),
            x_is_radius: !bit("diameter-programming"),
            cycle_words_in_mm: bit("cycle-words-in-millimetres"),
            linear_rapid: bit("linear-rapid"),
            plane_at_power_on: match (bit("turning-plane-at-power-on"), bit("plane-yz-at-power-on")) {
                (_, true) => Plane::Yz,
                (true, false) => Plane::Zx,
                (false, false) => Plane::Xy,
            },
            polar_linear_axis: count("polar-linear-axis"),
            polar_rotary_axis: count("polar-rotary-axis"),
            polar_feed_max: mm("polar-feed-maximum"),
            polar_automatic_override: bit("polar-automatic-override"),
            linear_machine_move: bit("linear-machine-move"),
            skip_feed_overridden: bit("skip-feed-overridden"),
            coordinate_setting_alarm: bit("coordinate-setting-alarm"),
            first_reference_by_hand: bit("first-reference-by-hand"),
            start_without_reference: bit("start-without-reference"),
            reference_return_clears_local: bit("reference-return-clears-local-shift"),
            reference_return_clears_preset: bit("reference-return-clears-preset"),
            reference_return_cancels_offset: !bit("reference-return-keeps-offset"),
            reset_clears_local: bit("reset-clears-local-shift"),
            program_end_clears_local: bit("program-end-clears-local-shift"),
            rotation_angle_deg: parameters.value("rotation-angle"),
            stroke_two_at_power_on: !bit("stroke-check-two-off-at-power-on"),
            feed_per_rev_fine: bit("feed-per-rev-fine"),
            feed_per_min_fine: bit("feed-per-min-fine"),
            arc_tolerance_mm: parameters.value("arc-tolerance"),
            arc_without_radius_alarm: bit("arc-without-radius-alarm"),
            arc_small_radius_alarm: bit("arc-small-radius-alarm"),
            duplicate_word_alarm: bit("duplicate-word-alarm"),
            several_auxiliary: bit("several-auxiliary-codes"),
            unbuffered: unbuffered(parameters),
            second_auxiliary: second_auxiliary(parameters),
            gives_return_code: bit("return-code-to-machine"),
            auxiliary_max: 10u32.pow(count("auxiliary-digits").clamp(2, 8)) - 1,
            path_mode_at_power_on: if bit("exact-stop-always") {
                PathMode::ExactStop
            } else {
                PathMode::default()
            },
            rpm_at_power_on: Rpm(count("rpm-at-power-on").min(9_999)),
            rpm_max: rpm("spindle-maximum-rpm"),
            gear_rpm_max: [
                rpm("gear-1-maximum-rpm"),
                rpm("gear-2-maximum-rpm"),
                rpm("gear-3-maximum-rpm"),
                rpm("gear-4-maximum-rpm"),
                rpm("gear-5-maximum-rpm"),
                rpm("gear-6-maximum-rpm"),
                rpm("gear-7-maximum-rpm"),
                rpm("gear-8-maximum-rpm"),
            ],
            watch: SpindleWatch {
                delay_ms: count("fluctuation-delay"),
                reached_permille: count("fluctuation-reached").saturating_mul(if bit("fluctuation-unit") {
                    1
                } else {
                    10
                }),
                allowed_permille: count("fluctuation-allowed").saturating_mul(if bit("fluctuation-unit") {
                    1
                } else {
                    10
                }),
                band: Rpm(count("fluctuation-band")),
            },
            watch_counts_tenths: bit("fluctuation-unit"),
            surface_speed_available: bit("surface-speed-available"),
            surface_speed_axis: count("surface-speed-axis"),
            spindle_selection_code: count("spindle-selection-code"),
            speed_max: 10u32.pow(count("spindle-digits").clamp(1, 8)) - 1,
            linear_at_power_on: bit("linear-at-power-on"),
            incremental_at_power_on: bit("incremental-at-power-on"),
            feed_mode_at_power_on: if bit("feed-per-minute-at-power-on") {
                FeedMode::PerMinute
            } else {
                FeedMode::PerRevolution
            },
            initial_feed: mm("initial-feed"),
            clear_modes_at_reset: bit("clear-modes-at-reset"),
            reset_selects_first_work: bit("reset-selects-first-work-coordinates"),
            no_rewind_at_plain_end: bit("no-rewind-at-stop"),
            no_rewind_at_end: bit("no-rewind-at-end"),
            end_of_record_allowed: bit("end-of-record-allowed"),
            plain_corner_letters: bit("plain-corner-letters"),
            angle_as_supplement: bit("angle-as-supplement"),
            corner_length_to_corner: bit("corner-length-to-corner"),
            dwell_in_revolutions: bit("dwell-in-revolutions"),
            thread_feed_max_mm_per_min: ["cutting-feed-maximum", "cutting-feed-maximum-axis"]
                .into_iter()
                .map(|name| parameters.axis_value(name, Axis::Z))
                .filter(|limit| *limit > 0.0)
                .reduce(f64::min),
            thread_feed_is_assumed: false,
            cutting_feed_is_barred: parameters.is_stated("cutting-feed-maximum")
                && parameters.value("cutting-feed-maximum") == 0.0
                && Axis::TURNING.map(|axis| parameters.axis_value("cutting-feed-maximum-axis", axis))
                    == [0.0; 2],
            thread_speed_check_off: bit("thread-speed-check-off"),
            thread_repair: bit("thread-repair"),
            thread_repair_follows: bit("thread-repair-follows"),
            thread_record_kept: bit("thread-record-kept"),
            thread_pull_out_feed: Some(mm("thread-pull-out-feed")).filter(|feed| feed.signum() > 0),
            run_out_tenths: count("thread-run-out"),
            run_in_depth: mm("thread-run-in"),
            run_in_length: mm("thread-run-in-length"),
            run_out_angle_deg: count("thread-run-out-angle").min(89) as u8,
            one_block_form: bit("one-block-cycle-form"),
            cut_depth: mm("cycle-depth-of-cut"),
            has_roughing_data: false,
            cut_escape: mm("cycle-escape"),
            pattern_relief_x: Radius(mm("pattern-relief-x")),
            pattern_relief_z: mm("pattern-relief-z"),
            pattern_passes: count("pattern-passes"),
            groove_return: mm("groove-return"),
            thread_finishing_passes: count("thread-finishing-passes"),
            thread_nose_angle_deg: count("thread-nose-angle").min(120) as u8,
            thread_minimum_depth: Radius(mm("thread-minimum-depth")),
            thread_finishing_allowance: Radius(mm("thread-finishing-allowance")),
            thread_infeed: FlankInfeed::WithCut,
            thread_starts: 1,
            thread_run_out_words: RunOutWords::default(),
            enhanced_thread_infeed: flank_infeed(count("thread-flank-mode"))
                .unwrap_or(FlankInfeed::BothFlanks),
            enhanced_thread_equal_steps: count("thread-depth-mode") == 0,
            enhanced_thread_finishing_passes: None,
            enhanced_thread_starts: 1,
            cycle_stops_behind_moves: bit("cycle-single-block-element"),
            corner_stops_single_block: bit("corner-single-block"),
            figure_check: bit("figure-check"),
            monotony_check: bit("monotony-check"),
            type_by_first_block: bit("type-by-first-block"),
            no_semi_finish: bit("no-semi-finish-type-one"),
            no_pocket_semi_finish: bit("no-semi-finish-type-two"),
            monotony_tolerances: [mm("monotony-tolerance-1"), mm("monotony-tolerance-2")],
            pocket_clearance: mm("cycle-clearance"),
            follows_pocket_bottom: bit("pocket-bottom-follow"),
            rapid_escape: bit("rapid-escape"),
            hole: HoleSettings::new(parameters),
            offsets: OffsetSettings::new(parameters),
            compensation: CompensationSettings::new(parameters, policies),
        }
    }
}

/// The bit of the letter of the second auxiliary function; 0 where the machine has none.
fn second_auxiliary(parameters: &Parameters) -> u32 {
    const NAME: &str = "second-auxiliary-letter";
    let letter = parameters.value(NAME) as u8;
    if parameters.is_stated(NAME) && b"ABCV".contains(&letter) { Block::bit(letter) } else { 0 }
}

/// The M codes that stop reading ahead: single ones, then ranges.
fn unbuffered(parameters: &Parameters) -> Box<[(u32, u32)]> {
    let code = |name: String| parameters.value(&name) as u32;
    let single = (1..=10).map(|place| code(format!("unbuffered-m-code-{place}"))).map(|only| (only, only));
    let ranges = (1..=6).map(|place| {
        (code(format!("unbuffered-m-first-{place}")), code(format!("unbuffered-m-last-{place}")))
    });
    single.chain(ranges).filter(|(first, _)| *first > 0).collect()
}
