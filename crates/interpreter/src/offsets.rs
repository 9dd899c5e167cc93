//! Tool offsets: the two tables, and what the offset called by T does.
//!
//! In: the setup, T words, data setting, system variables. Out: a shift of the work coordinates, a movement of
//! the tool, a nose radius and a tip direction.
//!
//! A row has geometry and wear with X, Y, Z and nose radius, and one tip direction for both. Values are kept as
//! the control's screen shows them, exact; [`Core::offset_radius`] alone makes their X a radius.
//!
//! The offset called acts in two ways, chosen by parameters for geometry and wear. As a *shift* it moves the
//! work zero: the tool stands and has new coordinates. As a *movement* it leaves the zero and moves the tool by
//! its value: at once in the block of the T word, or together with the next move of each axis. Commands locate
//! the imaginary tip that the offset describes. A T word therefore gives the tip its true place (`relocate`),
//! and a movement still to be made is the way from there to the programmed place (`Core::untaken`).
//!
//! Changed values act with the next T word, or at once by parameter.
//!
//! Source: tool offsets, their parameters and data setting, both families.

use turnwright_canon::{Action, Shape};
use turnwright_control::policy::OffsetAction;
use turnwright_control::{OffsetRow, Parameters, Setup, SetupFault};
use turnwright_syntax::Word;
use turnwright_units::{
    Diameter, Displacement, LeastIncrement, Length, MachineTurret, Position, Radius, WorkTip,
};

use crate::functions::FunctionId;
use crate::machine::Core;
use crate::report::Alarm;

/// One of the two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OffsetTable {
    Geometry,
    Wear,
}

/// A column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OffsetField {
    X,
    Y,
    Z,
    NoseRadius,
}

/// Why a value was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OffsetFault {
    /// The table has no such row: `offset-number-illegal`.
    Number,
    /// The value is too large: `offset-data-out-of-range`.
    Value,
}

impl OffsetFault {
    /// The alarm that says so.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Number => "offset-number-illegal",
            Self::Value => "offset-data-out-of-range",
        }
    }
}

/// The values of one row of one table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Cells([Length; 4]);

/// A row: both tables and the tip direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Row {
    geometry: Cells,
    wear: Cells,
    tip: u8,
}

impl Row {
    const EMPTY: Self = Self { geometry: Cells([Length::ZERO; 4]), wear: Cells([Length::ZERO; 4]), tip: 0 };

    fn cells_mut(&mut self, table: OffsetTable) -> &mut Cells {
        match table {
            OffsetTable::Geometry => &mut self.geometry,
            OffsetTable::Wear => &mut self.wear,
        }
    }
}

/// The tables. Rows that nobody wrote are zero and take no memory behind the last one written.
#[derive(Clone, Debug, Default)]
pub(crate) struct OffsetTables {
    /// By number; row 0 belongs to controls on which it shifts the work coordinates.
    rows: Vec<Row>,
}

impl OffsetTables {
    /// The tables of a setup.
    pub(crate) fn new(setup: &Setup) -> Result<Self, SetupFault> {
        /// Longer tables exist on no lathe control.
        const ROWS_MAX: usize = 1_000;
        let mut tables = Self::default();
        for (name, offset) in &setup.offsets {
            let number = name.parse().ok().filter(|number| *number < ROWS_MAX);
            let Some(number) = number else {
                let message = format!("[offsets] has no offset {name}; they are numbers");
                return Err(SetupFault { message, line: 0 });
            };
            if offset.tip > 9 {
                let message = format!("[offsets.{name}] tip {} is none; tips are 0 to 9", offset.tip);
                return Err(SetupFault { message, line: 0 });
            }
            *tables.row_mut(number) =
                Row { geometry: cells(offset.geometry)?, wear: cells(offset.wear)?, tip: offset.tip };
        }
        Ok(tables)
    }

    /// Number of the last row that was written.
    pub(crate) fn last_number(&self) -> u32 {
        self.rows.len().saturating_sub(1) as u32
    }

    /// X, Y, Z and nose radius of a row, as the screen shows them.
    pub(crate) fn values(&self, table: OffsetTable, number: u32) -> [Length; 4] {
        let row = self.row(number);
        let cells = if table == OffsetTable::Geometry { row.geometry } else { row.wear };
        cells.0
    }

    /// Tip direction of a row.
    pub(crate) fn tip(&self, number: u32) -> u8 {
        self.row(number).tip
    }

    fn row(&self, number: u32) -> &Row {
        self.rows.get(number as usize).unwrap_or(&Row::EMPTY)
    }

    fn row_mut(&mut self, number: usize) -> &mut Row {
        if self.rows.len() <= number {
            self.rows.resize(number + 1, Row::EMPTY);
        }
        &mut self.rows[number]
    }
}

fn cells(row: OffsetRow) -> Result<Cells, SetupFault> {
    let mut cells = Cells::default();
    for (cell, mm) in cells.0.iter_mut().zip([row.x, row.y, row.z, row.r]) {
        if mm.is_nan() || mm.abs() >= 1e6 {
            return Err(SetupFault { message: format!("the offset {mm} is out of range"), line: 0 });
        }
        *cell = Length::from_nm((mm * 1e6).round() as i64);
    }
    Ok(cells)
}

/// What the offset called by T does, fixed when it is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OffsetInForce {
    /// The work zero moves by this.
    pub(crate) shift: Displacement<MachineTurret>,
    /// The tool moves by this.
    pub(crate) movement: Displacement<MachineTurret>,
    /// The same two in Y.
    pub(crate) shift_y: Length,
    pub(crate) movement_y: Length,
    /// Geometry and wear together.
    pub(crate) nose_radius: Length,
    /// Direction of the imaginary tip, 0 to 9.
    pub(crate) tip: u8,
}

impl OffsetInForce {
    /// No offset.
    pub(crate) const NONE: Self = Self {
        shift: Displacement::new(Radius::ZERO, Length::ZERO),
        movement: Displacement::new(Radius::ZERO, Length::ZERO),
        shift_y: Length::ZERO,
        movement_y: Length::ZERO,
        nose_radius: Length::ZERO,
        tip: 0,
    };
}

/// Parameters of T words and offsets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OffsetSettings {
    /// Digits of the offset number at the end of a T word.
    pub(crate) number_digits: u32,
    /// Most digits of a T word.
    pub(crate) tool_digits: u32,
    pub(crate) geometry_by_tool_number: bool,
    geometry_moves: bool,
    wear_shifts: bool,
    zero_cancels_geometry: bool,
    pub(crate) moves_with_axis: bool,
    acts_at_once: bool,
    x_is_radius: bool,
    wear_x_is_radius: bool,
    pub(crate) converts_units: bool,
    /// The increments of the tables, metric and inch, where they differ from those of the program.
    increments: Option<(LeastIncrement, LeastIncrement)>,
    zero_row_shifts: bool,
    reset_takes_wear: bool,
    reset_takes_geometry: bool,
    keeps_untaken: bool,
    wear_max: Length,
    wear_change_max: Length,
    /// T with a dwell, data setting or coordinate setting is an alarm.
    pub(crate) refuses_tool_in_setting: bool,
}

impl OffsetSettings {
    pub(crate) fn new(parameters: &Parameters) -> Self {
        let bit = |name| parameters.bit(name);
        let mm = |name: &str| Length::from_nm((parameters.value(name) * 1e6).round() as i64);
        let count = |name: &str| parameters.value(name).clamp(0.0, 8.0) as u32;
        Self {
            number_digits: match count("offset-number-digits") {
                0 if bit("offset-digits-one") => 1,
                0 => 2,
                digits => digits,
            },
            tool_digits: match count("tool-digits") {
                0 => 8,
                digits => digits,
            },
            geometry_by_tool_number: bit("geometry-by-tool-number"),
            geometry_moves: bit("geometry-by-movement"),
            wear_shifts: bit("wear-by-shift"),
            zero_cancels_geometry: bit("cancel-geometry-with-zero"),
            moves_with_axis: bit("offset-with-next-move"),
            acts_at_once: bit("offset-changed-at-once"),
            x_is_radius: bit("offset-in-radius"),
            wear_x_is_radius: bit("wear-in-radius"),
            converts_units: bit("convert-offsets"),
            increments: match (bit("offset-increment-a"), bit("offset-increment-c")) {
                (true, false) => Some((LeastIncrement::METRIC_A, LeastIncrement::INCH_A)),
                (false, true) => Some((LeastIncrement::METRIC_C, LeastIncrement::INCH_C)),
                (false, false) | (true, true) => None,
            },
            zero_row_shifts: bit("offset-zero-shifts-work"),
            reset_takes_wear: bit("reset-clears-wear"),
            reset_takes_geometry: bit("reset-clears-geometry"),
            keeps_untaken: bit("untaken-offset-kept"),
            wear_max: mm("wear-maximum"),
            wear_change_max: mm("wear-increment-maximum"),
            refuses_tool_in_setting: bit("tool-in-setting-block-alarm"),
        }
    }
}

impl OffsetSettings {
    /// Whether X of the wear table is a diameter.
    pub(crate) const fn wear_x_is_diameter(&self) -> bool {
        !(self.x_is_radius || self.wear_x_is_radius)
    }

    /// Whether offset number 0 takes the geometry away too: a movement always, a shift by parameter.
    pub(crate) const fn zero_takes_geometry(&self) -> bool {
        self.zero_cancels_geometry || self.geometry_moves
    }
}

impl Core {
    /// The least increment of the tables in the unit in force.
    pub(crate) fn offset_increment(&self) -> LeastIncrement {
        match self.settings.offsets.increments {
            Some((_, inch)) if self.modal.is_inch => inch,
            Some((metric, _)) => metric,
            None => self.modal.increment(&self.settings),
        }
    }

    /// A value of the tables, as the screen shows it.
    pub(crate) fn offset_value(
        &self,
        table: OffsetTable,
        field: OffsetField,
        number: u32,
    ) -> Result<Length, OffsetFault> {
        self.check_offset_number(number)?;
        let row = self.offsets.row(number);
        let cells = if table == OffsetTable::Geometry { row.geometry } else { row.wear };
        Ok(cells.0[field as usize])
    }

    /// Writes a value of the tables.
    pub(crate) fn set_offset_value(
        &mut self,
        table: OffsetTable,
        field: OffsetField,
        number: u32,
        value: Length,
    ) -> Result<(), OffsetFault> {
        self.store_offset_value(table, field, number, value)?;
        self.after_offset_change(number);
        Ok(())
    }

    /// Writes a value of the tables; [`Core::after_offset_change`] follows when the row is complete.
    pub(crate) fn store_offset_value(
        &mut self,
        table: OffsetTable,
        field: OffsetField,
        number: u32,
        value: Length,
    ) -> Result<(), OffsetFault> {
        self.check_offset_number(number)?;
        if !self.is_offset_value(table, value) {
            return Err(OffsetFault::Value);
        }
        self.offsets.row_mut(number as usize).cells_mut(table).0[field as usize] = value;
        Ok(())
    }

    /// A value with something added; wear has a largest single change.
    pub(crate) fn increased_offset(
        &self,
        table: OffsetTable,
        field: OffsetField,
        number: u32,
        change: Length,
    ) -> Result<Length, OffsetFault> {
        let limit = self.settings.offsets.wear_change_max;
        if table == OffsetTable::Wear && limit.signum() > 0 && change.abs() > limit {
            return Err(OffsetFault::Value);
        }
        Ok(self.offset_value(table, field, number)? + change)
    }

    /// The tip direction of an offset.
    pub(crate) fn offset_tip(&self, number: u32) -> Result<u8, OffsetFault> {
        self.check_offset_number(number)?;
        Ok(self.offsets.row(number).tip)
    }

    /// Writes the tip direction of an offset.
    pub(crate) fn set_offset_tip(&mut self, number: u32, tip: u8) -> Result<(), OffsetFault> {
        self.store_offset_tip(number, tip)?;
        self.after_offset_change(number);
        Ok(())
    }

    /// Writes the tip direction of an offset; [`Core::after_offset_change`] follows when the row is complete.
    pub(crate) fn store_offset_tip(&mut self, number: u32, tip: u8) -> Result<(), OffsetFault> {
        self.check_offset_number(number)?;
        if tip > 9 {
            return Err(OffsetFault::Value);
        }
        self.offsets.row_mut(number as usize).tip = tip;
        Ok(())
    }

    fn check_offset_number(&self, number: u32) -> Result<(), OffsetFault> {
        if (1..=self.control.limits.offset_number_max).contains(&number) {
            Ok(())
        } else {
            Err(OffsetFault::Number)
        }
    }

    /// Whether a table can hold a value.
    fn is_offset_value(&self, table: OffsetTable, value: Length) -> bool {
        let digits = u32::from(self.control.limits.offset_value_digits.min(9));
        let limit = 10i64.pow(digits) * self.modal.increment(&self.settings).nm();
        let wear_max = self.settings.offsets.wear_max;
        value.abs().nm() < limit
            && (table == OffsetTable::Geometry || wear_max.signum() <= 0 || value.abs() <= wear_max)
    }

    /// A changed offset in force acts with the next T word, or at once by parameter.
    pub(crate) fn after_offset_change(&mut self, number: u32) {
        let is_in_force = number == self.modal.offset || number == self.modal.geometry;
        if is_in_force && self.settings.offsets.acts_at_once {
            let offset = self.offset_called();
            self.with_new_zero(|core| core.modal.offset_in_force = offset);
        }
    }

    /// Whether every value of the offset called fits into its table.
    pub(crate) fn offset_called_is_legal(&self) -> bool {
        let geometry = self.offsets.row(self.modal.geometry).geometry;
        let wear = self.offsets.row(self.modal.offset).wear;
        geometry.0.iter().all(|value| self.is_offset_value(OffsetTable::Geometry, *value))
            && wear.0.iter().all(|value| self.is_offset_value(OffsetTable::Wear, *value))
    }

    /// What the offset numbers in force do, with the values that the tables have now.
    pub(crate) fn offset_called(&self) -> OffsetInForce {
        let settings = &self.settings.offsets;
        let row = |number: u32| if number == 0 { &Row::EMPTY } else { self.offsets.row(number) };
        let (geometry_row, wear_row) = (row(self.modal.geometry), row(self.modal.offset));
        let geometry = self.offset_radius(OffsetTable::Geometry, geometry_row.geometry);
        let wear = self.offset_radius(OffsetTable::Wear, wear_row.wear);
        let geometry_moves = settings.geometry_moves;
        let wear_moves = match self.control.policies.offset_action {
            OffsetAction::ByPart => !settings.wear_shifts,
            OffsetAction::Whole => geometry_moves,
        };
        let mut offset = OffsetInForce {
            nose_radius: geometry_row.geometry.0[OffsetField::NoseRadius as usize]
                + wear_row.wear.0[OffsetField::NoseRadius as usize],
            tip: geometry_row.tip,
            ..OffsetInForce::NONE
        };
        let y = |row: &Cells| row.0[OffsetField::Y as usize];
        let parts =
            [(geometry, y(&geometry_row.geometry), geometry_moves), (wear, y(&wear_row.wear), wear_moves)];
        for (part, part_y, moves) in parts {
            let (sum, sum_y) = if moves {
                (&mut offset.movement, &mut offset.movement_y)
            } else {
                (&mut offset.shift, &mut offset.shift_y)
            };
            *sum = Displacement::new(sum.x + part.x, sum.z + part.z);
            *sum_y += part_y;
        }
        if settings.zero_row_shifts {
            let work = self.offset_radius(OffsetTable::Geometry, self.offsets.row(0).geometry);
            offset.shift = Displacement::new(offset.shift.x + work.x, offset.shift.z + work.z);
        }
        offset
    }

    /// A row as a way of the turret: the one place where X of an offset becomes a radius.
    fn offset_radius(&self, table: OffsetTable, cells: Cells) -> Displacement<MachineTurret> {
        let settings = &self.settings.offsets;
        let is_radius = settings.x_is_radius || (table == OffsetTable::Wear && settings.wear_x_is_radius);
        let x = cells.0[OffsetField::X as usize];
        let x = if is_radius { Radius(x) } else { Diameter(x).to_radius() };
        Displacement::new(x, cells.0[OffsetField::Z as usize])
    }

    /// Reads the digits of all offsets in the other unit: what a change of units does unless offsets are
    /// converted.
    #[cold]
    pub(crate) fn reread_offsets(&mut self, from: LeastIncrement, to: LeastIncrement) {
        for row in &mut self.offsets.rows {
            for value in row.geometry.0.iter_mut().chain(&mut row.wear.0) {
                *value = Length::from_nm(value.rounded(from).nm() / from.nm() * to.nm());
            }
        }
    }

    /// Whether any offset has a value.
    pub(crate) fn has_offset_values(&self) -> bool {
        self.offsets.rows.iter().any(|row| *row != Row { tip: row.tip, ..Row::EMPTY })
    }
}

/// The part of the offset's movement that the tool has not made yet: from where the tip is to where the
/// program has it.
impl Core {
    /// Adds to the movement that is still to be made.
    #[cold]
    pub(crate) fn owe_movement(&mut self, x: Radius, z: Length) {
        let owed = self.untaken.unwrap_or(Displacement::new(Radius::ZERO, Length::ZERO));
        let owed = Displacement::new(owed.x + x, owed.z + z);
        self.untaken = (!owed.x.0.is_zero() || !owed.z.is_zero()).then_some(owed);
    }

    /// A move names these axes: they make their movement on the way. Both do unless each waits for its own move.
    #[cold]
    pub(crate) fn take_movement(&mut self, names_x: bool, names_z: bool) {
        let Some(owed) = self.untaken.take() else { return };
        if self.settings.offsets.moves_with_axis {
            let x = if names_x { Radius::ZERO } else { owed.x };
            let z = if names_z { Length::ZERO } else { owed.z };
            self.owe_movement(x, z);
        }
    }

    /// Gives out a move while an axis that it does not name still waits.
    #[cold]
    pub(crate) fn emit_move_short(&mut self, to: Position<WorkTip>, mut action: Action) -> Result<(), Alarm> {
        let Some(owed) = self.untaken.take() else { return self.emit_move(to, action) };
        let short = Position::new(to.x - owed.x, to.z - owed.z);
        if let Action::Rapid { to, .. } | Action::Feed { to, .. } | Action::Thread { to, .. } = &mut action {
            *to = short;
        }
        let moved = self.emit_move(short, action);
        self.untaken = Some(owed);
        moved
    }

    /// Makes the whole movement that is still to be made as a move of its own: at rapid while positioning, at
    /// feed while cutting.
    #[cold]
    pub(crate) fn make_movement(&mut self, word: Option<&Word>) -> Result<(), Alarm> {
        let others = self.take_movement_y();
        if self.untaken.take().is_none() && others.is_none() {
            return Ok(());
        }
        self.stop_reading_ahead()?;
        let motion = self.modal.motion.get();
        let to = self.modal.position;
        let is_cut = self.modal.motion != FunctionId::RAPID && !motion.repeats && !motion.takes_lead;
        let action = if is_cut {
            let Some(feed) = self.feed_in_force() else { return Err(self.alarm_at("feed-missing", word)) };
            Action::Feed { to, shape: Shape::Line, feed, others }
        } else {
            Action::Rapid { to, path: self.rapid_path(), others }
        };
        self.beside_contour(|core| core.emit_move(to, action))
    }

    /// Whether a movement is still to be made.
    pub(crate) fn owes_movement(&self) -> bool {
        self.untaken.is_some() || !self.axes.untaken_y.is_zero()
    }

    /// At the end of a block with a T word: a movement that does not wait for an axis is made now.
    #[cold]
    pub(crate) fn end_of_tool_block(&mut self, word: Option<&Word>) -> Result<(), Alarm> {
        if self.settings.offsets.moves_with_axis || self.corner.is_some() || self.is_capturing() {
            return Ok(());
        }
        self.make_movement(word)
    }

    /// What a reset does to the offset: by parameter it takes the wear away, the geometry, and a movement that was
    /// not made yet. Nothing moves.
    pub(crate) fn reset_offset(&mut self) {
        let settings = self.settings.offsets;
        if settings.reset_takes_wear || settings.reset_takes_geometry {
            self.modal.offset = if settings.reset_takes_wear { 0 } else { self.modal.offset };
            self.modal.geometry = if settings.reset_takes_geometry { 0 } else { self.modal.geometry };
            let offset = self.offset_called();
            self.with_new_zero(|core| core.modal.offset_in_force = offset);
        }
        if settings.keeps_untaken
            && let Some(owed) = self.untaken
        {
            self.modal.position = self.tip + owed;
        } else {
            self.untaken = None;
            self.modal.position = self.tip;
            self.axes.untaken_y = Length::ZERO;
        }
    }

    /// After a move to a place of the machine: the movement is left out of it and comes back with the next move.
    pub(crate) fn leave_out_movement(&mut self, names_x: bool, names_z: bool) {
        let movement = self.modal.offset_in_force.movement;
        let x = if names_x { movement.x } else { Radius::ZERO };
        let z = if names_z { movement.z } else { Length::ZERO };
        if !x.0.is_zero() || !z.is_zero() {
            let place = self.modal.position;
            self.modal.position = Position::new(place.x + x, place.z + z);
            self.owe_movement(x, z);
        }
    }
}
