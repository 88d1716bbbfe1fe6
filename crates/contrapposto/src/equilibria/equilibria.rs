//! In which different postures can a body do its tasks at little effort?
//!
//! A posture of least effort is a valley; which one [`Engine`](crate::posture_solver::Engine) finds depends on where it begins. So it begins in
//! several places, all of them given by the body and the tables of the paper, none by chance (`finder.rs`):
//!
//! 1. where the scenario starts, moved to its tasks first as [`crate::ik`] would;
//! 2. from the posture found there, every coordinate is asked ([`crate::hybrid::minimise`]) where its active and where its passive
//!    solution lies, with the slope along the motion that supports and tasks leave it. All active goals together, all passive goals
//!    together, and those of the [`SINGLE`] hardest-worked coordinates one by one, are half-spaces below the tasks and above
//!    effort; the body moves under them for [`SCOUT`] steps at most, then as many without them. Active goals lie where curves are
//!    flat, passive ones near the ends of ranges, where ligaments carry;
//! 3. the same again from the posture of least effort so far, as long as that is a new one, [`ROUNDS`] times at most;
//! 4. the mirror image of every posture found, where the body has one ([`super::Mirror`]), moved to the tasks likewise.
//!
//! What is new then settles with all the steps it may have. Valleys are flat: a forearm may turn without a muscle noticing. So two
//! postures are one if at no joint what weight asks or what ligaments give differs by more than [`SAME`] of the strength there; the
//! one of less effort is kept. Those whose tasks were left farther away than in the best posture, that slipped or fell, are counted
//! and left out. Every start begins with a solver that
//! remembers nothing, so the list does not depend on the order of starts except through what is listed above.

use super::finder::Finder;
use super::stability::Stability;
use crate::contact::{Missing, Support};
use crate::model::{Model, Side};
use crate::posture::Posture;
use crate::posture_solver::{EngineError, Options, SolvedPosture};
use crate::statics::Load;
use crate::tasks::PriorityLevel;

/// Coordinates that are pushed one by one.
pub const SINGLE: usize = 6;
/// How often pushes begin anew from a better posture.
pub const ROUNDS: usize = 2;
/// Steps under pushes, and steps without them before it is asked whether a posture is new.
pub const SCOUT: usize = 40;
/// Postures are one if at no joint the torque of weight and loads, or of ligaments, differs by more than this share of
/// strength.
pub const SAME: f64 = 0.05;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Search<'a> {
    /// The body.
    pub model: &'a Model,
    /// Where it starts, and where its supports stay.
    pub start: &'a Posture,
    /// What carries it.
    pub supports: &'a [Support],
    /// Tasks, the most important first. Effort of all muscles comes last where no goal asks for effort.
    pub goals: &'a [PriorityLevel],
    /// What pulls on it besides its weight.
    pub loads: &'a [Load],
    /// Rates that do not move, besides those of locked coordinates.
    pub locked: &'a [usize],
}

/// Why nothing was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// Body, supports or goals do not fit.
    #[error(transparent)]
    Relax(#[from] EngineError),
    /// From no start a posture was found in which the supports hold the body.
    #[error("the supports cannot hold the body, in the best posture that was tried: {0}")]
    CannotStand(Missing),
}

/// A muscle group at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// The coordinate.
    pub coordinate: usize,
    /// Which of its groups.
    pub side: Side,
    /// Active torque, N m.
    pub active: f64,
    /// Strength of the group at its angle, N m.
    pub strength: f64,
    /// How long the group, rested at first, can hold this, s; infinite if for ever.
    pub endurance: f64,
}

impl Work {
    /// Torque over strength, 0 and up.
    pub fn relative_load(&self) -> f64 {
        self.active.abs() / self.strength
    }
}

/// A joint whose ligaments carry at least half of what weight and loads ask of it.
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
    /// Passive torque as a share of what is asked; above 1 the muscles pull against the ligaments.
    pub fn share(&self) -> f64 {
        -self.passive / self.external
    }
}

/// What one support carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Normal force as a share of body weight.
    pub share: f64,
    /// Whole force on the body, ground, N.
    pub force: nalgebra::Vector3<f64>,
    /// Where its normal part acts, ground, m; `None` where nothing is carried.
    pub center_of_pressure: Option<nalgebra::Vector3<f64>>,
}

/// A posture of least effort.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxedPosture {
    /// Where it is, what is left of every goal, and how it ended.
    pub relaxed: SolvedPosture,
    /// By supports, in their order.
    pub supports: Vec<Carried>,
    /// What holds it when nobody attends.
    pub stability: Stability,
    /// Torque of weight, loads and contact forces, and of passive tissue, by rate, N m.
    pub torques: [Vec<f64>; 2],
    /// Groups that work, the hardest first.
    pub work: Vec<Work>,
    /// Joints that hang on their ligaments, the one with the largest passive torque first.
    pub hanging: Vec<Hanging>,
    /// Starts that led here, in words.
    pub starts: Vec<String>,
}

impl RelaxedPosture {
    /// The group that gives up first when the posture is held and nobody shifts; none where all can hold for ever.
    pub fn fails_first(&self) -> Option<&Work> {
        let tires = self.work.iter().filter(|work| work.endurance.is_finite());
        tires.min_by(|a, b| a.endurance.total_cmp(&b.endurance))
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibria {
    /// Different postures, that of least effort first.
    pub postures: Vec<RelaxedPosture>,
    /// Number of starts.
    pub starts: usize,
    /// Starts from which the body fell.
    pub fell: usize,
    /// Different postures in which tasks were left farther away than need be, or supports slipped.
    pub yielded: usize,
    /// Steps of all starts together.
    pub steps: usize,
}

/// Finds them. `options` are those of the last stage.
///
/// # Errors
/// [`SearchError`] when something does not fit the model, or the body cannot stand.
pub fn equilibria(search: &Search<'_>, options: Options) -> Result<Equilibria, SearchError> {
    let mut finder = Finder::new(search, options)?;
    finder.scout()?;
    finder.settle()?;
    finder.finish()
}
