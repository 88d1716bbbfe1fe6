//! Defines the parts of a decision: the case, the outcome and the kind of balance at the goal.

use crate::passive::SlopeAngles;
use serde::{Deserialize, Serialize};

/// The kind of solution that is sought (Rodriguez & Boulic 2007, section 2.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Strategy {
    /// Mid-range, where muscles work well: a reactive posture.
    Active,
    /// Near a limit, where ligaments carry the load: a relaxed posture.
    Passive,
}

/// The ten cases of Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Case {
    /// None or one slope, torque within tolerance: stay.
    C11,
    /// None or one slope, positive torque: root below the present angle.
    C12,
    /// None or one slope, negative torque: root above the present angle.
    C13,
    /// Two slopes, torque within tolerance, between the slopes or with nothing between them: stay.
    C21,
    /// Two slopes, torque within tolerance at a limit, active: root between the slopes.
    C22,
    /// As 2.2, passive: stay.
    C23,
    /// Torque keeps its sign between the slopes; active, and the decrease ratio is enough: its least value.
    C31,
    /// Torque keeps its sign between the slopes; otherwise: passive root beyond them.
    C32,
    /// Torque changes sign; active: root between the slopes.
    C33,
    /// Torque changes sign; passive: root beyond the slopes.
    C34,
}

impl Case {
    /// All ten, in the paper's order.
    pub const ALL: [Self; 10] =
        [Self::C11, Self::C12, Self::C13, Self::C21, Self::C22, Self::C23, Self::C31, Self::C32, Self::C33, Self::C34];

    /// The paper's number, `"3.2"`.
    pub fn number(self) -> &'static str {
        match self {
            Self::C11 => "1.1",
            Self::C12 => "1.2",
            Self::C13 => "1.3",
            Self::C21 => "2.1",
            Self::C22 => "2.2",
            Self::C23 => "2.3",
            Self::C31 => "3.1",
            Self::C32 => "3.2",
            Self::C33 => "3.3",
            Self::C34 => "3.4",
        }
    }
}

impl std::fmt::Display for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.number())
    }
}

/// Outcome of the request for relief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Outcome {
    /// The present angle is the goal.
    Stay,
    /// The goal is an unstable balance, where muscles work well.
    Active,
    /// The goal is a stable balance: passive tissue, or the load as in a hanging pendulum, restores it.
    Passive,
    /// The active torque is least at the goal, which is neither a stable nor an unstable balance: a slope angle, in case 3.1 or
    /// where the range holds no balance, or an angle in a zone of level torque.
    LeastTorque,
    /// The goal is no balance: the range holds none, and the active torque is least at this limit.
    AtLimit,
    /// Literal mode only: the printed tables search an interval without a root.
    None,
}

impl Outcome {
    /// The word used in outputs: `stay`, `active`, `passive`, `least_torque`, `at_limit`, `none`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Stay => "stay",
            Self::Active => "active",
            Self::Passive => "passive",
            Self::LeastTorque => "least_torque",
            Self::AtLimit => "at_limit",
            Self::None => "none",
        }
    }
}

/// The torque that restores a stable balance: the larger of `-d tau_p` and `-d tau_e`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Carrier {
    /// Passive tissue.
    Ligaments,
    /// The external load itself, as in a hanging pendulum.
    Gravity,
}

/// Kind of balance. With muscles off the net torque is `-tau_a`, so a balance is stable when `d tau_a / d theta > 0` and
/// unstable when it is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Equilibrium {
    /// Stable: the joint returns by itself.
    Stable(Carrier),
    /// Unstable: muscles must correct every disturbance.
    Unstable,
}

/// The answer of Tables 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// The case of Table 1 that applied. Depends on the problem only.
    pub case: Case,
    /// Outcome of the request.
    pub outcome: Outcome,
    /// The goal angle `theta_g`, rad, inside the range; `None` only for [`Outcome::None`].
    pub goal: Option<f64>,
    /// Present active torque, N m.
    pub active_torque: f64,
    /// Extrapolated active torque at the goal, N m.
    pub active_torque_at_goal: Option<f64>,
    /// `R` (Eq. 3) of the candidate that case 3.1 would take; `None` where there is no such candidate.
    pub decrease_ratio: Option<f64>,
    /// `theta_smin` and `theta_smax` where they lie in the range.
    pub slope_angles: SlopeAngles,
    /// The interval that was searched for a root, rad.
    pub interval: Option<(f64, f64)>,
    /// Kind of balance at the goal: unstable for [`Outcome::Active`], stable for [`Outcome::Passive`], either for
    /// [`Outcome::Stay`] within the tolerance; otherwise, and where the active torque is level, `None`.
    pub equilibrium: Option<Equilibrium>,
    /// The printed tables' interval held no root, so the total mode looked further (docs/deviations.md, D3).
    pub beyond_tables: bool,
}

impl Decision {
    /// The case that applies at `active_torque` (N m), before a goal is sought.
    pub(crate) fn without_goal(case: Case, active_torque: f64, slope_angles: SlopeAngles) -> Self {
        Self {
            case,
            outcome: Outcome::None,
            goal: None,
            active_torque,
            active_torque_at_goal: None,
            decrease_ratio: None,
            slope_angles,
            interval: None,
            equilibrium: None,
            beyond_tables: false,
        }
    }

    /// The same case with the present angle `angle` (rad) for its goal.
    pub(crate) fn staying(self, angle: f64) -> Self {
        Self {
            outcome: Outcome::Stay,
            goal: Some(angle),
            active_torque_at_goal: Some(self.active_torque),
            equilibrium: None,
            ..self
        }
    }
}
