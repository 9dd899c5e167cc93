//! The limits of a control: numbers that its data states, each with an alarm of its own.

/// Limits of a control, each with an alarm of its own.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Axes that a cut moves together. From memory; options of some machines allow more.
    pub simultaneous_axes_max: u8,
    /// Digits of a length.
    pub number_digits: u8,
    /// Digits of a sequence number.
    pub sequence_digits: u8,
    /// Digits of a program number.
    pub program_digits: u8,
    /// Smallest lead of a thread while the units are metric, nanometres.
    pub lead_metric_min_nm: i64,
    /// Largest lead of a thread while the units are metric, nanometres.
    pub lead_metric_max_nm: i64,
    /// Smallest lead of a thread while the units are inch, nanometres.
    pub lead_inch_min_nm: i64,
    /// Largest lead of a thread while the units are inch, nanometres.
    pub lead_inch_max_nm: i64,
    /// Inputs that can end a dwell; 0 when the control lacks the function.
    pub dwell_inputs: u8,
    /// Highest offset number.
    pub offset_number_max: u32,
    /// Inputs that a skip move can name.
    pub skip_inputs: u8,
    /// Additional work coordinate systems.
    pub additional_work_systems: u16,
    /// Digits of a value in the offset tables.
    pub offset_value_digits: u8,
    /// Deepest nesting of subprograms.
    pub call_depth_max: u8,
    /// Deepest nesting of macro calls.
    pub macro_depth_max: u8,
    /// Deepest nesting of subprograms and macro calls together.
    pub combined_depth_max: u8,
    /// Deepest nesting of square brackets in an expression, functions included.
    pub bracket_depth_max: u8,
    /// Last common variable that power-off forgets; the first is 100.
    pub common_variable_last: u32,
    /// Last common variable that power-off keeps; the first is 500.
    pub retained_variable_last: u32,
    /// Highest repeat count of a call.
    pub repeat_count_max: u32,
    /// First of the programs that G codes call by parameter.
    pub g_call_program: u32,
    /// First of the programs that M codes call as macros by parameter.
    pub m_call_program: u32,
    /// First of the programs that M codes call as subprograms by parameter.
    pub m_subprogram: u32,
    /// First of the programs that single T codes call by parameter.
    pub t_call_program: u32,
    /// The program that every T word calls when the parameter says so; 0 for none.
    pub t_program: u32,
    /// The first of a thousand M codes that call the program of their own number; 0 for none.
    pub direct_calling_m_code: u32,
    /// Number of the alarm that a program raises with 0.
    pub user_alarm_base: u32,
    /// Highest number that may be added to it.
    pub user_alarm_max: u32,
    /// Blocks without a move that may stand between a corner and the line it leads to.
    pub corner_gap_max: u8,
    /// The same between the lines of a drawing dimension.
    pub drawing_gap_max: u8,
    /// Blocks without a move between two moves of a compensated path over which the control reads ahead.
    pub compensation_gap_max: u8,
    /// Largest size of a corner between any cuts; larger ones are passed over.
    pub corner_size_max_mm: u16,
    /// Most blocks in the figure of a cycle.
    pub figure_blocks_max: u32,
    /// Most pockets in a figure that is roughed; 0 for any number.
    pub pockets_max: u32,
}
