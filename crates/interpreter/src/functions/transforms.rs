//! `double-turret-mirror-on`, `double-turret-mirror-off` — mirror image for a second turret (G68, G69);
//! `rotation-on`, `rotation-off` — coordinate rotation (G68.1, G69.1).
//!
//! G68: the tool is one of the turret on the other side of the spindle. X of the program counts towards that
//! side, and the tool's place is that of the first turret less the distance of the turrets (1290, as a radius).
//! The program stays as it is for the first turret; commands show the true side. G69 ends it. Nothing moves by
//! either; they stand alone in their block, else a warning says so.
//!
//! `G68.1 X_ Z_ R_` turns the moves that follow about the point X, Z by R degrees, counter-clockwise positive with Z
//! to the right and X up; X as a diameter is halved first. Without X or Z the tool's own place counts, without R
//! the parameter 5410. While it is on, only moves and arcs, feed and speed modes, planes and hole cycles may
//! follow; G69.1 ends it. Whether the FANUC option forbids the same codes was not read: the stricter rule is
//! used on all.
//!
//! Source: mirror image for double turret; coordinate rotation of the 988 series.

use turnwright_syntax::Word;
use turnwright_units::Position;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::transform::Rotation;
use crate::words::Role;

pub(super) static DOUBLE_TURRET_MIRROR_ON: Function =
    Function::mode("double-turret-mirror-on", |core, call| mirror(core, call, true));
pub(super) static DOUBLE_TURRET_MIRROR_OFF: Function =
    Function::mode("double-turret-mirror-off", |core, call| mirror(core, call, false));
pub(super) static ROTATION_ON: Function = Function::one_shot("rotation-on", rotation_on).with_letters(b"R");
pub(super) static ROTATION_OFF: Function = Function::mode("rotation-off", rotation_off).allowed_in_rotation();

fn mirror(core: &mut Core, call: &mut Call<'_>, is_on: bool) -> Result<(), Alarm> {
    if core.transform.is_mirrored == is_on {
        // A safety line may hold the code that is in force.
        return Ok(());
    }
    if call.block.present() & super::AXES != 0
        && let Some(word) = call.word
    {
        core.warn("mirror-with-move", word);
    }
    core.with_new_zero(|core| core.transform.is_mirrored = is_on);
    core.look_at_moves();
    Ok(())
}

fn rotation_on(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    if let Some(word) = block.word(b'U').or(block.word(b'W')) {
        return Err(core.alarm("illegal-address", word));
    }
    let here = core.modal.position;
    let mut centre = Position::new(here.x, here.z);
    if let Some(word) = block.word(b'X') {
        centre.x = core.radius(word, Role::XCoordinate)?;
        core.missing_point(word);
    }
    if let Some(word) = block.word(b'Z') {
        centre.z = core.length(word)?;
        core.missing_point(word);
    }
    let angle_deg = match block.word(b'R') {
        Some(word) => core.degrees(word)?,
        None => core.settings.rotation_angle_deg,
    };
    core.with_new_zero(|core| core.transform.rotation = Some(Rotation::new(centre, angle_deg)));
    core.look_at_moves();
    Ok(())
}

fn rotation_off(core: &mut Core, _: &mut Call<'_>) -> Result<(), Alarm> {
    if core.transform.rotation.is_some() {
        core.with_new_zero(|core| core.transform.rotation = None);
        core.look_at_moves();
    }
    Ok(())
}

impl Core {
    /// An angle word in degrees: without a point it counts thousandths, on controls with calculator input whole
    /// degrees.
    fn degrees(&self, word: &Word) -> Result<f64, Alarm> {
        let number = self.number(word)?;
        let places = if number.has_point || self.settings.is_calculator { 3 } else { 0 };
        match number.scaled(places) {
            Some((thousandths, _)) if thousandths.abs() <= 360_000 => Ok(thousandths as f64 / 1000.0),
            _ => Err(self.alarm("data-out-of-range", word)),
        }
    }
}
