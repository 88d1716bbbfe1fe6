//! Describes the postures of least effort that a search has found.

use super::stability::Stability;
use crate::model::Side;
use crate::posture::Posture;
use crate::posture_solver::SolvedPosture;

/// Most local minima that a search returns for later searches. Assumed.
pub(super) const MOST_MINIMA: usize = 12;

/// A muscle group at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// The coordinate.
    pub coordinate: usize,
    /// The group of the coordinate, by the sign of its torque.
    pub side: Side,
    /// Active torque, N m.
    pub active: f64,
    /// Strength of the group at its angle, N m.
    pub strength: f64,
    /// Time for which the group, rested at first, can hold this load, s; infinite if for ever.
    pub endurance: f64,
}

impl Work {
    /// Torque over strength, 0 and up.
    pub fn relative_load(&self) -> f64 {
        self.active.abs() / self.strength
    }
}

/// A joint whose ligaments carry at least half of the torque of weight and loads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hanging {
    /// The coordinate.
    pub coordinate: usize,
    /// Torque of weight, loads and contact forces, N m.
    pub external: f64,
    /// Torque of passive tissue, N m.
    pub passive: f64,
}

impl Hanging {
    /// Passive torque as a share of the external one; above 1 the muscles pull against the ligaments.
    pub fn share(&self) -> f64 {
        -self.passive / self.external
    }
}

/// Load of one support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Normal force as a share of body weight.
    pub share: f64,
    /// Whole force on the body, ground, N.
    pub force: nalgebra::Vector3<f64>,
    /// Point where its normal part acts, ground, m; `None` without force.
    pub center_of_pressure: Option<nalgebra::Vector3<f64>>,
}

/// A posture of least effort.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxedPosture {
    /// Posture, errors of all levels, and why the steps ended.
    pub relaxed: SolvedPosture,
    /// By supports, in their order.
    pub supports: Vec<Carried>,
    /// Stability without attention.
    pub stability: Stability,
    /// Torque of weight, loads and contact forces, and of passive tissue, by rate, N m.
    pub torques: [Vec<f64>; 2],
    /// Groups that work, the hardest first.
    pub work: Vec<Work>,
    /// Joints that hang on their ligaments, the one with the largest passive torque first.
    pub hanging: Vec<Hanging>,
    /// Starts that led to this posture, in words.
    pub starts: Vec<String>,
    /// Whether the mirror image of the posture was found, too, at the same effort, and is left out ([`Aim::WaysOnEitherSide`](super::Aim::WaysOnEitherSide)).
    pub mirrored: bool,
}

impl RelaxedPosture {
    /// The group that gives up first when the posture is held and nobody shifts; none where all can hold for ever.
    pub fn fails_first(&self) -> Option<&Work> {
        let tires = self.work.iter().filter(|work| work.endurance.is_finite());
        tires.min_by(|a, b| a.endurance.total_cmp(&b.endurance))
    }
}

/// The postures found.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibria {
    /// Different postures, that of least effort first.
    pub postures: Vec<RelaxedPosture>,
    /// Different local minima for a later search of the same body, twelve at most: those found, then others near explored postures, each from that of
    /// least effort on.
    pub minima: Vec<Posture>,
    /// Number of starts.
    pub starts: usize,
    /// Starts from which the body fell.
    pub fell: usize,
    /// Different postures in which tasks were left farther away than need be, or supports slipped.
    pub yielded: usize,
    /// Postures left out because they are the same way to stand as one of less effort, because a group would need more than its
    /// strength or the body more than twice the least effort and 0.05 besides, because a limb without a task is held up that hangs in the start, or
    /// because five others are better.
    pub alike: usize,
    /// Steps of all starts together.
    pub steps: usize,
    /// Work of these steps ([`Engine::work`](crate::posture_solver::Engine::work)).
    pub work: usize,
    /// The search ended at [`Search::most_work`](super::Search::most_work), not because all starts were tried.
    pub cut: bool,
}
