//! The questions on which controls differ or sources disagree, each with all its readings.
//!
//! A control definition in `data/controls` answers every one of them; no code asks for a control's name.

use serde::Deserialize;

macro_rules! policies {
    ($($(#[$doc:meta])* $field:ident: $name:ident { $($(#[$reading:meta])* $variant:ident),+ $(,)? })+) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
            #[serde(rename_all = "kebab-case")]
            pub enum $name { $($(#[$reading])* $variant),+ }
        )+

        /// A control's answers.
        #[derive(Clone, Copy, Debug, Deserialize)]
        #[serde(rename_all = "kebab-case", deny_unknown_fields)]
        pub struct Policies { $($(#[$doc])* pub $field: $name),+ }
    };
}

policies! {
    /// What a length without a decimal point counts.
    decimal_rule: DecimalRule {
        /// Least increments, or whole units when the parameter for calculator input is set.
        ByParameter,
        /// Whole millimetres, inches or degrees, as on a pocket calculator.
        AlwaysCalculator,
    }
    /// Digits finer than the least increment.
    fine_digits: FineDigits {
        /// Cut off towards zero.
        Cut,
        /// Rounded to the nearest increment.
        Round,
    }
    /// A length without a decimal point where the point decides what it counts.
    missing_point: MissingPoint {
        /// It counts by the decimal rule.
        Counts,
        /// Refused, unless it is zero.
        Alarm,
    }
    /// A whole number with a point.
    integer_words: IntegerWords {
        /// The point is refused.
        PointRefused,
        /// Refused only when something other than zero stands behind the point.
        FractionRefused,
    }
    /// A feed below zero.
    negative_feed: NegativeFeed {
        /// Refused.
        Alarm,
        /// Taken without its sign.
        Absolute,
    }
    /// A dwell below zero.
    negative_dwell: NegativeDwell {
        /// Refused.
        Alarm,
        /// No dwell.
        Zero,
    }
    /// A dwell in spindle revolutions while the spindle stands.
    turn_dwell_without_spindle: TurnDwellWithoutSpindle {
        /// Refused.
        Alarm,
        /// The control waits until it turns; a warning says so.
        Warn,
    }
    /// Feed per revolution.
    feed_per_revolution: FeedPerRevolution {
        /// It exists.
        Available,
        /// It is an option that this control does not have.
        Alarm,
    }
    /// Two S words in one block.
    repeated_speed_word: RepeatedSpeedWord {
        /// As any other address twice in a block.
        AsOtherAddresses,
        /// Refused.
        Alarm,
    }
    /// Program number zero.
    program_zero: ProgramZero {
        /// Refused.
        Alarm,
        /// A number like any other.
        Allowed,
    }
    /// A program that begins without O.
    unnumbered_program: UnnumberedProgram {
        /// The sequence number of its first block is its number.
        TakesFirstSequence,
        /// It has none.
        Nameless,
    }
    /// A block skip mark behind words.
    skip_inside_block: SkipInsideBlock {
        /// The rest of the block is left out while the switch is on.
        SkipsRest,
        /// Refused: marks stand at the head of a block only.
        Alarm,
    }
    /// A bracket that opens inside a comment.
    nested_comment: NestedComment {
        /// Part of the comment; a warning says so.
        Warn,
        /// Refused.
        Alarm,
    }
    /// The same address twice in a block.
    repeated_address: RepeatedAddress {
        /// The last counts, or an alarm, as the parameter says.
        ByParameter,
        /// Refused.
        Alarm,
    }
    /// A code that acts once and a motion code in one block.
    one_shot_with_motion: OneShotWithMotion {
        /// The axis words belong to the one that acts once, the motion code is in force afterwards.
        Allowed,
        /// Refused.
        Alarm,
    }
    /// Coordinate setting beside the code of a work coordinate system in one block.
    setting_beside_system: SettingBesideSystem {
        /// The system is selected, then its coordinates are set.
        Both,
        /// The coordinates are set and the code of the system is passed over.
        SettingOnly,
    }
    /// The absolute and the incremental word of one axis in one block.
    axis_word_conflict: AxisWordConflict {
        /// The one that stands later counts.
        LaterWord,
        /// The absolute one counts wherever it stands.
        AbsoluteWins,
    }
    /// M codes that meet in one block although they belong to one group, or although one has to stand alone.
    auxiliary_combination: AuxiliaryCombination {
        /// The last of a group acts; beside a stop or an end nothing else does.
        LastActs,
        /// Refused.
        Alarm,
    }
    /// When spindle stop and coolant off act in a block with a move. Stops, ends and calls always act behind it.
    stopping_codes: StoppingCodes {
        /// Behind the move: nearly every machine's logic waits for its end.
        BehindTheMove,
        /// With its start, as all other M codes do.
        WithTheMove,
    }
    /// What a reset or program end does to the speed limit of constant surface speed.
    speed_limit_at_reset: SpeedLimitAtReset {
        /// It stays.
        Kept,
        /// It is cancelled.
        Cancelled,
    }
    /// What decides whether a tool offset shifts the coordinates or moves the tool.
    offset_action: OffsetAction {
        /// Geometry and wear each by a parameter of its own.
        ByPart,
        /// One parameter for the whole offset.
        Whole,
    }
    /// A tool word without its leading zeros.
    short_tool_word: ShortToolWord {
        /// Leading zeros may be left out.
        Accepted,
        /// Station and offset are written with all their digits.
        Refused,
    }
    /// What programs may write with data setting, and how they name parameters.
    data_setting: DataSetting {
        /// Offsets and work zeros; parameters with L50.
        WithOldCode,
        /// Offsets and work zeros; parameters with L50 or L52.
        WithEitherCode,
        /// Tool life with L3, where foreign words are passed over, and with L52 parameters, which are read too and
        /// where P counts for parameters of axes alone; no offsets.
        ListsOnly,
    }
    /// A T word in a block that sets data.
    tool_in_data_setting: ToolInDataSetting {
        /// Refused when the parameter for T in setting blocks says so.
        ByParameter,
        /// No word of data setting.
        Foreign,
    }
    /// The form of a punched parameter text.
    parameter_text: ParameterText {
        /// `N1320 A1P99999999`: lengths in least increments.
        Short,
        /// `N01320 Q1 A1P99999.999`: marked as parameters, the path named, lengths with a point.
        Long,
    }
    /// An arc whose end point does not lie on the circle given by its centre.
    arc_end_error: ArcEndError {
        /// An arc with the start radius, then a straight line along one axis to the end point.
        TailLine,
        /// The radius changes with the angle, so that the end point is met.
        Spiral,
        /// The start radius is kept and the centre moved so that both ends fit.
        Recentre,
        /// The same, however far the radii of start and end differ: only a chord longer than the circle is wide is
        /// refused.
        RecentreAlways,
    }
    /// A negative radius word of an arc.
    negative_arc_radius: NegativeArcRadius {
        /// Refused; arcs of 180 degrees and more are given by their centre.
        Alarm,
        /// The arc of more than 180 degrees.
        LongArc,
    }
    /// Words for automatic corners of a linear move.
    corner_words: CornerWords {
        /// `I`, `K`, `R`, or plain `C` and `R` by parameter, or the same with a comma.
        ChamferAndRadius,
        /// `L` for the chamfer, `D` for the fillet.
        LengthAndFillet,
    }
    /// Corner words behind a comma while plain corner letters are on.
    comma_corner_words: CommaCornerWords {
        /// Taken all the same.
        Accepted,
        /// Refused.
        RefusedWithPlainLetters,
    }
    /// Lines by their angle, and corners between slanting lines.
    drawing_dimensions: DrawingDimensions {
        /// Every control of the series has them. Plain corner letters, where they are on, serve them too: between
        /// lines that are not at a right angle along the axes, or in a block with an angle, a size without a sign
        /// is a drawing dimension; at a right angle its sign is checked.
        Standard,
        /// An option. Words behind a comma and angles run, with a warning that the option is needed; plain C and R
        /// only make right-angled corners.
        Option,
    }
    /// Motion codes that the first block of a figure may have.
    first_figure_code: FirstFigureCode {
        /// Positioning or a straight cut.
        RapidOrLinear,
        /// Arcs too.
        AnyMotion,
    }
    /// What increments (U, W) of the local zero do.
    local_increments: LocalIncrements {
        /// They add to the local shift in force. From memory of how other coordinate data take increments.
        Add,
        /// They are the local shift, as X and Z are.
        Replace,
    }
    /// Whether the codes of the second stroke check must stand alone in their block.
    stroke_check_block: StrokeCheckBlock {
        /// Another word is an alarm, and so is the code while the checks are switched off.
        Alone,
        /// Other words are read; a warning says that the manuals ask for a block of their own.
        Shared,
    }
    /// What a positive workpiece shift does. From memory: a manual's example sets +1 where the position should
    /// read one more, that is, the zero goes the other way; the external offset does not.
    workpiece_shift: WorkpieceShift {
        /// It is added to the coordinates of the tool, so that the zero moves the other way.
        AddsToCoordinates,
        /// It moves the zero, as the external offset does.
        MovesZero,
    }
    /// How the roughing cycle knows whether the figure has pockets.
    cycle_type: CycleType {
        /// Both axes in the figure's first block mean pockets.
        ByFirstBlock,
        /// From the figure itself, or by the first block when the parameter says so.
        ByTypeParameter,
    }
    /// Which plane the turning cycles work in.
    cycle_plane: CyclePlane {
        /// The turning plane of Z and X only.
        TurningOnly,
        /// Whichever plane is in force.
        Follows,
    }
    /// Feed modes in which polar and cylindrical interpolation may begin.
    interpolation_feed: InterpolationFeed {
        /// Feed per minute only.
        PerMinute,
        /// Both.
        Any,
    }
    /// Positioning in polar interpolation.
    polar_rapid: PolarRapid {
        /// Refused: the mode is left first.
        Alarm,
        /// Straight in the polar plane.
        Allowed,
    }
    /// A T word in polar interpolation.
    polar_tool: PolarTool {
        /// Acts as ever.
        Allowed,
        /// Refused: the tool is called and positioned before the mode begins.
        Alarm,
    }
    /// A feed at which the rotary axis cannot follow near the spindle axis in polar interpolation.
    polar_overspeed: PolarOverspeed {
        /// Refused.
        Alarm,
        /// Cut, with a warning: what the machine does is not known.
        Warn,
    }
    /// Whether words of the rotary axis can be lengths in cylindrical interpolation.
    cylinder_lengths: CylinderLengths {
        /// No: they are degrees.
        Never,
        /// With `K1` in the block that begins it.
        ByWord,
    }
    /// The words J K R L of cylindrical interpolation: the figure is roughed in passes.
    cylinder_roughing: CylinderRoughing {
        /// There are none.
        Absent,
        /// X stands at the depth of the figure when the cycle begins: the last pass runs there.
        FigureAtStart,
        /// X stands at the uncut surface when the cycle begins: the figure lies below it by depth and allowance.
        SurfaceAtStart,
    }
    /// Which of those words are diameters.
    cylinder_roughing_words: CylinderRoughingWords {
        /// As in the pattern cycle, whose names they have: K is one, J and R are radii.
        AsInPattern,
        /// None: all are radii.
        Radii,
        /// All of them.
        Diameters,
    }
    /// Whether the depth J of those words counts the allowance K in.
    cylinder_roughing_total: CylinderRoughingTotal {
        /// No: K remains below it.
        WithoutAllowance,
        /// Yes: roughing takes J less K.
        WithAllowance,
    }
    /// The sign of J among those words.
    cylinder_roughing_sign: CylinderRoughingSign {
        /// That of the way into the work: negative cuts towards the spindle axis.
        WayIn,
        /// That of the way from the figure to the surface, as in the pattern cycle.
        WayOut,
    }
    /// Repetitive cycles with everything in one block, beside those in two.
    cycle_form: CycleForm {
        /// They do not exist.
        Absent,
        /// One form is read, as the parameter says.
        ByParameter,
        /// Both are read, each by its letters; a warning says where the parameter wants the other.
        Recognised,
    }
    /// A nose radius below zero.
    negative_nose_radius: NegativeNoseRadius {
        /// Left and right of the path are exchanged.
        ExchangesSides,
        /// Refused.
        Alarm,
    }
    /// More blocks without a move in nose compensation than the control reads ahead over.
    compensation_gap: CompensationGap {
        /// The nose stands square to the end of the move before them, and goes on from there.
        Square,
        /// Refused.
        Alarm,
    }
    /// What nose compensation does to the figure of a roughing cycle.
    roughing_compensation: RoughingCompensation {
        /// Nothing: the figure is roughed as it is written.
        None,
        /// In force before the cycle, it shifts the figure first.
        BeforeCycle,
        /// Named in the figure, it shifts it when the parameter says so.
        ByParameter,
        /// Named in the figure's first block, it shifts the figure.
        InFirstBlock,
    }
    /// A subprogram call in nose compensation.
    call_in_compensation: CallInCompensation {
        /// The path goes on in the subprogram.
        Allowed,
        /// Refused.
        Alarm,
    }
    /// A turning or facing cycle in nose compensation whose imaginary tip points away from the work.
    single_cycle_overcut: SingleCycleOvercut {
        /// Cut with the nose beside the work all the same.
        Cut,
        /// Refused.
        Alarm,
    }
    /// Which way nose compensation shifts the cut of a turning or facing cycle. A manual known from memory draws the
    /// shift by the tip, whichever code is on; other texts say that it goes by the side of the code.
    single_cycle_side: SingleCycleSide {
        /// Towards the start point, with either code.
        Start,
        /// To the side that the code names, seen in the direction of the cut.
        Code,
    }
    /// What the third type of start and end of nose compensation is.
    start_up_type_c: StartUpTypeC {
        /// Starts and ends with a move are those of the other types; a code alone moves the nose square to the next
        /// move, or from the path to the programmed point.
        ShiftsWithoutMove,
        /// The nose stands square to both moves, one after the other.
        BothSquare,
    }
    /// Where single-block operation stops in roughing, pattern and grooving cycles. Threads stop pass by pass, single
    /// cycles at their end.
    cycle_single_block: CycleSingleBlock {
        /// Behind every move.
        EveryMove,
        /// Behind every pass, or every move when the parameter says so.
        ByParameter,
    }
    /// What roughing with pockets does.
    type_two: TypeTwo {
        /// It exists.
        Available,
        /// It exists in rough turning; rough facing refuses it.
        TurningOnly,
        /// It is an option that this control does not have.
        Alarm,
    }
    /// A roughing level exactly on a stretch of the figure that is parallel to the cut.
    coincident_level: CoincidentLevel {
        /// The cut goes on to the far end of the stretch.
        Through,
        /// The cut ends where it first touches the figure.
        Stop,
    }
    /// Where the roughing levels are counted from.
    level_origin: LevelOrigin {
        /// The start point moved by the allowances.
        ShiftedStart,
        /// The start point itself.
        Start,
    }
    /// Speed of the 45-degree escape after a roughing pass.
    escape_speed: EscapeSpeed {
        /// Cutting feed.
        Feed,
        /// Rapid traverse.
        Rapid,
    }
    /// The pass along the figure at the end of roughing with pockets.
    pocket_semi_finish: PocketSemiFinish {
        /// It is made unless the parameter leaves it out.
        ByParameter,
        /// Only with the word J1 in the block that runs the cycle.
        ByWord,
    }
    /// The flat top between two pockets, when it lies between two levels. From figures of the manuals; where there
    /// was none to read, the first.
    flat_hump: FlatHump {
        /// It is cut along with the climb out of the first pocket.
        AlongContour,
        /// The first pocket is finished, then one cut at its height goes on to the far wall.
        ExtraLevel,
    }
    /// How a cut that ends on a bottom parallel to it is left when roughing with pockets.
    bottom_escape: BottomEscape {
        /// Along the figure.
        Follow,
        /// At 45 degrees, unless the parameter for following it is set. Known at second hand.
        ByParameter,
    }
    /// Speed of the small way off the figure at the end of a pass when roughing with pockets. No source gives it.
    pocket_lift_speed: PocketLiftSpeed {
        /// Cutting feed.
        Feed,
        /// Rapid traverse.
        Rapid,
    }
    /// A figure of pattern repeating that turns back in Z.
    pattern_monotony: PatternMonotony {
        /// Nothing is said against it.
        Free,
        /// The manual asks for Z to run one way; whether the control refuses it is not known, so it runs, with a
        /// warning.
        Required,
    }
    /// A pattern repeating cycle with one pass.
    single_pattern_pass: SinglePatternPass {
        /// One pass, at the allowance.
        Once,
        /// Two passes.
        Twice,
    }
    /// Radial distances given by integer words of the grooving cycles.
    groove_words: GrooveWords {
        /// Radius values.
        Radius,
        /// Diameter values.
        Diameter,
    }
    /// Units of the integer words of grooving and threading cycles.
    cycle_integer_words: CycleIntegerWords {
        /// Least increments; a point is refused.
        Increments,
        /// Least increments or millimetres, as the unit parameter says; a point is taken in millimetres only.
        ByUnitParameter,
    }
    /// A negative relief of a grooving cycle where the direction is fixed.
    groove_relief_sign: GrooveReliefSign {
        /// An alarm.
        Refused,
        /// Only the amount counts.
        Ignored,
    }
    /// Direction of the relief at the bottom of a single groove.
    groove_relief_alone: GrooveReliefAlone {
        /// The sign of the relief.
        BySign,
        /// Always towards plus.
        AlwaysPlus,
    }
    /// A peck of zero in a drilling cycle.
    zero_peck: ZeroPeck {
        /// Refused.
        Alarm,
        /// The hole is drilled in one go.
        NoPecks,
    }
    /// A groove cycle with an end point but without the word for its pecks.
    groove_without_peck: GrooveWithoutPeck {
        /// Refused, as a step of zero is.
        Alarm,
        /// It is no block that cuts: it stores its return, and nothing moves.
        StoresData,
        /// The tool plunges in one go.
        OnePlunge,
    }
    /// Which figure the finishing cycle takes when several have its sequence numbers.
    finishing_figure: FinishingFigure {
        /// The one that a search from the cycle block on finds first.
        Searched,
        /// The one that a roughing cycle with the same numbers cut last; without one, that of the search.
        Remembered,
    }
    /// What the word for the length of a run-out does without that for its depth, on controls with both.
    run_out_length_alone: RunOutLengthAlone {
        /// No depth is no run-out.
        NoRunOut,
        /// The run-out is as deep as long.
        AsDeepAsLong,
    }
    /// What the word for the way of pecking means, on controls whose drilling cycles have one.
    peck_mode_word: PeckModeWord {
        /// 0 goes back by the retract, 1 to the start level.
        ZeroIsShort,
        /// 1 goes back by the retract, 0 to the start level.
        OneIsShort,
    }
    /// How the least depth limits the passes of the threading cycle.
    thread_depth_clamp: ThreadDepthClamp {
        /// Each increment is at least the least depth: depths add up.
        Accumulate,
        /// Each depth is the larger of the root rule and its predecessor in that rule plus the least depth.
        Formula,
    }
    /// The packed digits of the threading cycle (passes, run-out, angle) when fewer than six are written.
    thread_digits: ThreadDigits {
        /// Zeros stand before them; a number of passes of zero leaves the one before.
        LeadingZeros,
        /// Parts that are not written stay as they were.
        PartsWritten,
        /// All three parts must be written.
        AllParts,
    }
    /// Further words of the threading cycle.
    multi_thread_words: MultiThreadWords {
        /// None.
        Plain,
        /// J and K, the run-out, in the block that stores.
        RunOutInData,
        /// D, the flanks, and L, the number of starts, in the block that stores; J and K in the block that cuts.
        FlanksAndStarts,
    }
    /// Nose angles that the threading cycle takes.
    thread_angles: ThreadAngles {
        /// 0, 29, 30, 55, 60 and 80 degrees.
        Listed,
        /// 0 to 99 degrees.
        Any,
    }
    /// When a figure that turns back is refused by type I roughing.
    monotony_check: MonotonyCheck {
        /// With the parameter for checking the figure.
        ByFigureCheck,
        /// With the parameter for checking monotony.
        ByMonotonyBit,
        /// With the parameters for monotony and for the type.
        ByMonotonyBits,
        /// With the word K1 in the block that runs the cycle.
        ByWord,
    }
    /// Where execution goes on after a roughing cycle.
    after_roughing: AfterRoughing {
        /// Behind the last block of the figure.
        BehindFigure,
        /// Behind the figure when it follows the cycle at once, else behind the cycle block.
        BehindAdjacentFigure,
    }
    /// The sequence number of a figure found twice.
    duplicate_sequence: DuplicateSequence {
        /// The first found counts, with a warning.
        FirstWithWarning,
        /// Refused.
        Alarm,
    }
    /// A block without axis words while a single cycle is in force.
    single_cycle_repeat: SingleCycleRepeat {
        /// The cycle runs again.
        OnEveryBlock,
        /// Only axis words run it again.
        OnWordsOnly,
    }
    /// A taper of a single cycle whose sign and size make the path cross itself.
    taper_sign: TaperSign {
        /// Refused.
        Alarm,
        /// Cut, with a warning.
        Warn,
    }
    /// A variable that holds nothing.
    null_variable: NullVariable {
        /// A word with it is as if it were not there, and it equals only another empty one.
        IsNothing,
        /// It is zero in words and comparisons.
        IsZero,
    }
    /// Functions of custom macro expressions beyond the oldest ones.
    macro_functions: MacroFunctions {
        /// None: no `MOD`, `POW`, `ADP`, no `ATAN` of one argument.
        Basic,
        /// Those, and no random numbers.
        Extended,
        /// Those and `RAND`, `SRAND`.
        ExtendedWithRandom,
    }
    /// Parameters (`PRM[n]`), axis numbers (`AXNUM[X]`) and names of system variables (`[#_DATE]`) in expressions.
    macro_names: MacroNames {
        /// There are none.
        None,
        /// They are known. Which names there are is from memory.
        Known,
    }
    /// Conditions of `IF` and `WHILE` joined by `AND`, `OR` and `XOR`.
    joined_conditions: JoinedConditions {
        /// Refused: a condition is one comparison.
        Refused,
        /// Taken: `IF[[#1EQ1]AND[#2EQ2]]`. From memory for the GSK controls.
        Taken,
    }
    /// How precisely variables are kept.
    macro_precision: MacroPrecision {
        /// Eight significant digits, up to 10^47. What is stored is cut to them; inside an expression more digits
        /// are carried, as the manuals' error of a single operation (parts in 10^10, from memory) asks for.
        EightDigits,
        /// Double precision.
        Double,
    }
    /// A function whose argument stands without brackets.
    bare_argument: BareArgument {
        /// Refused.
        Refused,
        /// Taken.
        Taken,
    }
    /// How the parameter for the range of the arc tangent turns the range of the arc sine.
    arc_sine_range: ArcSineRange {
        /// The same way: unsigned 270 to 90, or signed.
        WithArcTangent,
        /// The other way round: signed while the arc tangent is unsigned, else 90 to 270.
        Opposite,
    }
    /// Numbers without a point handed to a macro.
    macro_argument_numbers: MacroArgumentNumbers {
        /// Least increments of their letter, unless numbers without a point are whole units anyway.
        Increments,
        /// As they are written.
        AsWritten,
    }
    /// Variables numbered 9100 to 9999.
    nine_thousand_variables: NineThousandVariables {
        /// System variables or none.
        Direct,
        /// The variable whose number is held by the one 9000 below.
        Indirect,
    }
    /// The order of axes behind the numbers of position variables.
    position_variables: PositionVariables {
        /// X, Z.
        XThenZ,
        /// X, Y, Z.
        XThenYThenZ,
    }
    /// The variable of the Z workpiece shift.
    work_shift_variables: WorkShiftVariables {
        /// A hundred above that of X.
        HundredApart,
        /// The next one after that of X.
        Neighbours,
    }
    /// The variables of work zeros.
    work_zero_variables: WorkZeroVariables {
        /// Programs read and write them.
        Writable,
        /// Programs read them.
        ReadOnly,
    }
    /// Which variables of the modal state programs see.
    modal_variables: ModalVariables {
        /// All groups and addresses.
        All,
        /// Those that the manual lists.
        Listed,
    }
    /// Where a skip leaves its place.
    skip_variables: SkipVariables {
        /// In the position variables of skips.
        Positions,
        /// Also in the common variables 995 (X) and 996 (Z).
        CommonVariables,
    }
    /// What the clock variables count.
    clock_variables: ClockVariables {
        /// Milliseconds since power-on, and hours of automatic operation.
        MillisecondsAndHours,
        /// Seconds of this part, and seconds of cutting.
        Seconds,
    }
    /// A call of a macro while a modal one is in force.
    call_under_modal_call: CallUnderModalCall {
        /// Both are in force, one inside the other.
        Nests,
        /// The modal one ends.
        Cancels,
    }
    /// A modal call of a macro while another is in force.
    nested_modal_call: NestedModalCall {
        /// Both are in force; the macro of the later one runs first.
        Allowed,
        /// Refused.
        Refused,
    }
    /// `G67` while no modal call is in force.
    macro_cancel_without_call: MacroCancelWithoutCall {
        /// Nothing happens.
        Harmless,
        /// An alarm, unless the parameter for it says otherwise.
        ByParameter,
    }
    /// Arithmetic by `G65 H`.
    type_a_macro: TypeAMacro {
        /// There is none: H is an argument.
        None,
        /// A block with H is arithmetic.
        ByWord,
        /// A block with H is arithmetic when the parameter says so.
        ByParameter,
    }
    /// A program number beyond four digits that was computed.
    computed_program_number: ComputedProgramNumber {
        /// The digits before the last four are the count, as when typed.
        CountAndNumber,
        /// Refused; so is a count given twice.
        FourDigits,
    }
    /// Names of programs beside their numbers.
    program_names: ProgramNames {
        /// There are none.
        None,
        /// `O<NAME>` heads a program, `M98 <NAME>` and `G65 <NAME>` call it.
        InAngles,
        /// `M98 P[NAME]` and `G65 P[NAME]` call the file of that name. Several programs in one text are headed
        /// by `O<NAME>`, a way of writing of ours: on the control each is a file.
        InBrackets,
    }
    /// `Q` beside `M98`: the block of the program to begin with.
    call_entry: CallEntry {
        /// There is none.
        Absent,
        /// It is taken.
        ByWord,
    }
    /// Calls of programs in a program that was typed in at the panel.
    calls_in_mdi: CallsInMdi {
        /// As deep as in automatic operation.
        AsInMemory,
        /// The program called calls none itself.
        OneLevel,
    }
    /// `M98` without a program.
    call_without_program: CallWithoutProgram {
        /// Refused.
        Alarm,
        /// With the number of a first block, the program in work calls itself.
        CallsItself,
    }
    /// The word beside F that gives the lead of a thread.
    lead_words: LeadWords {
        /// E: a lead with more digits.
        FeedOrExact,
        /// I: threads per inch.
        FeedOrCount,
    }
    /// Units of the start angle of a thread.
    start_angle_unit: StartAngleUnit {
        /// Thousandths of a degree; a point is refused.
        Thousandths,
        /// Degrees.
        Degrees,
        /// Thousandths or degrees, as the unit parameter says.
        ByUnitParameter,
    }
    /// The start angle of a thread with changing lead.
    variable_lead_start_angle: VariableLeadStartAngle {
        /// It is taken as in a thread of constant lead.
        Taken,
        /// There is none.
        Refused,
    }
    /// Words for the run-out of a thread: J across, K along.
    run_out_words: RunOutWords {
        /// There are none; the parameters say how cycles run out, single threads do not.
        Absent,
        /// Without K the run-out is as long as it is deep.
        LengthAsDepth,
        /// Without K the tool leaves straight out of the end of the thread.
        StraightOut,
    }
    /// What the depth of a run-out of a tapered single thread is counted from.
    run_out_base: RunOutBase {
        /// From the place where the run-out begins: J is the way of the short axis in the run-out.
        Leaving,
        /// From the programmed end point.
        End,
    }
    /// The words L and P of the single thread cycle.
    thread_cycle_words: ThreadCycleWords {
        /// There are none.
        Plain,
        /// L starts; P0 cuts along Z, P1 across the face.
        StartsAndFace,
        /// L starts; P0 cuts, P1 repairs a thread that was taken out of the chuck.
        StartsAndRepair,
    }
    /// A thread faster than an axis may feed.
    thread_overspeed: ThreadOverspeed {
        /// Refused before the first pass.
        Alarm,
        /// The axis is held at its limit and loses the lead; a warning says so.
        Warn,
    }
    /// F of the codes that lead the spindle as an axis: rigid tapping and rigid threads.
    led_spindle_feed: LedSpindleFeed {
        /// In tapping a feed, by the speed a lead; in threads a lead without sign.
        Plain,
        /// The lead, in tapping too; a negative one is left-handed.
        SignedLead,
    }
    /// A thread while no spindle speed is commanded.
    thread_without_spindle: ThreadWithoutSpindle {
        /// Refused before the first pass.
        Alarm,
        /// Refused unless the parameter switches the check off.
        ByCheckParameter,
        /// The axis waits for the spindle; a warning says so.
        Warn,
    }
}

/// Which alarm numbers a control shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlarmIds {
    /// Three digits.
    Three,
    /// Two letters and four digits.
    Four,
    /// Own names where no number is known.
    Named,
}
