//! States a search for postures of least effort, and its errors.

use crate::contact::{Missing, Support};
use crate::model::Model;
use crate::posture::Posture;
use crate::posture_solver::EngineError;
use crate::statics::Load;
use crate::tasks::{PriorityLevel, Task};

/// Body, supports and tasks.
#[derive(Clone, Debug)]
pub struct Search<'a> {
    /// The body.
    pub model: &'a Model,
    /// Start; the supports stay where they are in it.
    pub start: &'a Posture,
    /// Supports that carry the body.
    pub supports: &'a [Support],
    /// Tasks, the most important first. Effort of all muscles comes last where no level asks for effort.
    pub goals: &'a [PriorityLevel],
    /// Inequalities above all goals.
    pub limits: &'a [Task],
    /// Loads on the body besides its weight.
    pub loads: &'a [Load],
    /// Rates that do not move, besides those of locked coordinates.
    pub locked: &'a [usize],
    /// Greatest work ([`Equilibria::work`](super::Equilibria::work)): no start is begun after so much, nor after three quarters while starts
    /// are explored, so that a search ends at the same start on every machine.
    pub most_work: usize,
    /// Number of starts that are scattered over the ranges of the joints ([`SCATTERED_STARTS`](super::SCATTERED_STARTS) finds what random starts
    /// of another method find); 0 where the posture is known to be near, as after a rest.
    pub scattered: usize,
    /// The postures that the caller needs.
    pub aim: Aim<'a>,
    /// Threads that solve from the starts; the answer does not depend on their number. One is right where the caller has its own.
    pub threads: usize,
}

/// The postures that a search is for.
#[derive(Clone, Copy, Debug)]
pub enum Aim<'a> {
    /// All different ways to stand.
    Ways,
    /// The same; of two that are mirror images of each other and take the same effort, the first ([`RelaxedPosture::mirrored`](super::RelaxedPosture::mirrored)).
    WaysOnEitherSide,
    /// The posture of least effort. Where local minima of an earlier search of the same body are given, they are the starts, besides all goals of
    /// each strategy together.
    Least(&'a [Posture]),
}

impl Aim<'_> {
    /// Postures of earlier searches.
    pub(super) fn known(&self) -> &[Posture] {
        match self {
            Self::Ways | Self::WaysOnEitherSide => &[],
            Self::Least(known) => known,
        }
    }
}

/// Stage of a search: its index in the engines and in the allowed errors.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stage {
    Exploratory = 0,
    /// Near the local minimum of an explored posture.
    Nearest = 1,
    /// At the local minimum.
    Settled = 2,
    /// At the lowest of the local minima nearby, by basin hopping.
    Converged = 3,
}

/// The reason for which no posture was found.
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
