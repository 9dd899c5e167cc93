//! `plane-xy`, `plane-zx`, `plane-yz` — the working plane (G17, G18, G19).
//!
//! Arcs lie in the plane: of X and Z (G18, the turning plane), of X and Y, or of Y and Z. Straight moves do not
//! ask for it. Arcs in the other two need a Y axis, or the rotary axis as a virtual one (polar and cylindrical
//! interpolation). Axis words in the block of the code move as usual; `G18 W0 H0`, which names the axes of the
//! plane, moves nothing. The plane is not changed while nose compensation is on.
//!
//! Turning cycles work in the turning plane. Where a control's cycles follow the plane, the other planes are
//! refused by name.
//!
//! Source: plane selection of both families.

use turnwright_control::policy::CyclePlane;
use turnwright_syntax::Block;

use super::Function;
use crate::axes::Plane;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static PLANE_XY: Function =
    Function::mode("plane-xy", |core, call| plane(core, call, Plane::Xy)).allowed_in_rotation();
pub(super) static PLANE_ZX: Function =
    Function::mode("plane-zx", |core, call| plane(core, call, Plane::Zx)).allowed_in_rotation();
pub(super) static PLANE_YZ: Function =
    Function::mode("plane-yz", |core, call| plane(core, call, Plane::Yz)).allowed_in_rotation();

fn plane(core: &mut Core, call: &mut Call<'_>, plane: Plane) -> Result<(), Alarm> {
    if plane != core.axes.plane && core.is_compensating() {
        return Err(core.alarm_at("plane-change-in-compensation", call.word));
    }
    if plane != core.axes.plane {
        core.check_plane_before_tap(call.word)?;
    }
    core.axes.plane = plane;
    Ok(())
}

impl Core {
    /// Turning cycles outside the turning plane.
    #[cold]
    pub(crate) fn refuse_cycle_plane(&self, block: &Block, function: &Function) -> Result<(), Alarm> {
        // A bare code of a single cycle cuts nothing.
        let cuts =
            function.is_multiple_cycle || (function.is_single_cycle() && block.present() & super::AXES != 0);
        if !cuts {
            return Ok(());
        }
        let code = block.word(b'G');
        if self.control.policies.cycle_plane == CyclePlane::Follows && self.axes.machine.y.is_some() {
            return Err(self.alarm_at("cycle-plane-not-supported", code));
        }
        if function.is_multiple_cycle {
            return Err(self.alarm_at("cycle-mode-forbidden", code));
        }
        let outside = if self.axes.plane == Plane::Xy { b"ZW" } else { b"XU" };
        let word = outside.iter().find_map(|letter| block.word(*letter)).or(code);
        Err(self.alarm_at("single-cycle-axis-illegal", word))
    }
}
