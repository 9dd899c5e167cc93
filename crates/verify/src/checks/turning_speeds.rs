//! How fast the spindle turns, order by order: for checks of what speed does to chuck and bar.

use turnwright_canon::{Action, Command, Origin, SpindleSpeed, SpindleState};

use super::State;

/// Orders of a speed that are kept.
const ORDERS_MAX: usize = 1_000;

/// The fastest that each order of a speed comes to: S itself, or what constant surface speed makes of the smallest
/// diameter that is cut, as far as the limit in force lets it. Where no limit is, the way to the axis has no speed to judge
/// by; `surface-speed-without-limit` and `chuck-too-fast` tell of that.
#[derive(Default)]
pub(super) struct TurningSpeeds {
    orders: Vec<(f64, Origin)>,
    /// Nearest to the axis under the constant surface speed in force, mm.
    nearest_mm: f64,
    is_open: bool,
}

impl TurningSpeeds {
    #[inline]
    pub(super) fn on_move(&mut self, command: &Command, state: &State) {
        let Some(SpindleSpeed::Surface(surface)) = state.speed else { return };
        let to = match &command.action {
            Action::Feed { to, .. } | Action::Thread { to, .. } => to,
            _ => return,
        };
        let radius_mm = to.x.to_mm().abs().min(state.at.x.to_mm().abs());
        if radius_mm >= self.nearest_mm || state.spindle == SpindleState::Stop {
            return;
        }
        let Some(limit) = state.rpm_max else { return };
        self.nearest_mm = radius_mm;
        let by_diameter = surface.to_m_per_min() * 1e3 / (2.0 * std::f64::consts::PI * radius_mm);
        let rpm = by_diameter.min(f64::from(limit.0));
        if !self.is_open && self.orders.len() < ORDERS_MAX {
            self.orders.push((rpm, command.origin));
        } else if let Some(last) = self.orders.last_mut().filter(|last| last.0 < rpm) {
            *last = (rpm, command.origin);
        }
        self.is_open = true;
    }

    pub(super) fn on_other(&mut self, command: &Command) {
        let Action::Spindle { state, speed, rpm_max } = &command.action else { return };
        (self.nearest_mm, self.is_open) = (f64::INFINITY, false);
        if let (SpindleSpeed::Constant(rpm), true) = (speed, *state != SpindleState::Stop) {
            let rpm = rpm.0.min(rpm_max.map_or(u32::MAX, |limit| limit.0));
            let rpm = f64::from(rpm);
            // A new limit above the speed in force asks for nothing new.
            if self.orders.len() < ORDERS_MAX && self.orders.last().is_none_or(|last| last.0 != rpm) {
                self.orders.push((rpm, command.origin));
            }
        }
    }

    /// Speeds above a limit, in revolutions per minute, and where they are asked for.
    pub(super) fn above(&self, rpm: f64) -> impl Iterator<Item = (f64, &Origin)> {
        self.orders.iter().filter(move |order| order.0 > rpm).map(|(rpm, origin)| (*rpm, origin))
    }
}
