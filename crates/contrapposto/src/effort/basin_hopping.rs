//! Searches for the lowest of the local minima of effort near a posture, by basin hopping.
//!
//! Effort has many local minima: arms, neck and spine each can hang on their passive tissue in more than one way. From the nearest
//! local minimum the posture is perturbed, as far as the constraints allow to first order, and descends again; the lower one is
//! kept (Wales & Doye 1997, "Global optimization by basin-hopping"), subtree by subtree where subtrees are decoupled
//! ([`super::decoupled_subtrees`]). Perturbations come from a fixed sequence of numbers: equal problems have equal answers.

use super::decoupled_subtrees::DecoupledSubtrees;
use super::problem::EffortProblem;
use super::reduced_problem::ReducedProblem;
use super::sqp::{LocalMinimum, Sqp, SqpOptions};
use super::tolerances::{
    FINAL_VIOLATION, LARGEST_RANGE, LEAST_IMPROVEMENT, PERTURBED_COORDINATES, PERTURBED_SHARE, SEARCH_VIOLATION,
};
use crate::joint_torques::JointTorquesError;
use crate::math::next_number;
use crate::model::Model;
use crate::posture::Posture;

/// To the nearest local minimum.
const TO_NEAREST: SqpOptions = SqpOptions {
    feasibility_step: 0.15,
    gauss_newton_steps: 0,
    trust_radius: 0.3,
    extrapolates: true,
    max_steps: 100,
    least_gain: 1e-3,
};
/// From a perturbed posture, whose targets are near; descents that must go far rarely end low.
const FROM_PERTURBED: SqpOptions = SqpOptions {
    feasibility_step: 0.4,
    gauss_newton_steps: 5,
    trust_radius: 0.6,
    extrapolates: false,
    max_steps: 20,
    least_gain: 0.05,
};
/// To the nearest local minimum once more, where [`TO_NEAREST`] leaves constraints violated.
const RETRY: SqpOptions =
    SqpOptions { trust_radius: 0.3, extrapolates: true, max_steps: 100, least_gain: 1e-3, ..FROM_PERTURBED };
/// From a posture that is mixed from subtrees of two postures.
const FROM_MIXED: SqpOptions = SqpOptions { gauss_newton_steps: 0, trust_radius: 0.3, ..FROM_PERTURBED };
/// From a posture that hardly moves any more to its own local minimum: a smaller predicted gain is not worth a motion.
const AT_REST: SqpOptions = SqpOptions {
    feasibility_step: 0.4,
    gauss_newton_steps: 0,
    trust_radius: 0.1,
    extrapolates: true,
    max_steps: 40,
    least_gain: 1e-6,
};
/// To the local minimum that is the answer.
const FINAL: SqpOptions = SqpOptions {
    feasibility_step: 0.4,
    gauss_newton_steps: 0,
    trust_radius: 0.3,
    extrapolates: true,
    max_steps: 100,
    least_gain: 1e-13,
};

/// Workspace of the search, except for reduced models.
#[derive(Clone, Debug)]
pub(crate) struct BasinHopping {
    sqp: Sqp,
    lowest: Candidate,
    nearest: Posture,
    hop: Hop,
    /// Steps of all descents so far.
    steps: usize,
    /// Work of the descents of reduced problems so far.
    work_reduced: usize,
}

/// A posture with its forces, and the multipliers of the constraints.
#[derive(Clone, Debug)]
struct Candidate {
    posture: Posture,
    forces: Vec<f64>,
    multipliers: Vec<f64>,
}

/// Workspace of a hop to another local minimum.
#[derive(Clone, Debug)]
struct Hop {
    perturbed: Candidate,
    perturbation: Vec<f64>,
}

impl BasinHopping {
    pub(crate) fn new(model: &Model) -> Self {
        let candidate = Candidate { posture: model.default_posture(), forces: vec![], multipliers: vec![] };
        Self {
            sqp: Sqp::new(model),
            lowest: candidate.clone(),
            nearest: model.default_posture(),
            hop: Hop { perturbed: candidate, perturbation: vec![] },
            steps: 0,
            work_reduced: 0,
        }
    }

    /// Moves `posture` to the lowest local minimum of `count`, the nearest one and others that hops reach. `None` leaves the
    /// posture where it is: no descent from there satisfies the constraints.
    pub(crate) fn minimise(
        &mut self,
        problem: &EffortProblem<'_>,
        posture: &mut Posture,
        count: usize,
    ) -> Result<Option<LocalMinimum>, JointTorquesError> {
        let mut reduced = ReducedProblem::of(problem, posture)?;
        if problem.contact.supports().is_empty() {
            let smaller = reduced.take().filter(|reduced| reduced.model.rates().len() < problem.model.rates().len());
            if let Some(reduced) = smaller {
                let mut hopping = Self::new(&reduced.model);
                let minimum = hopping.minimise(&reduced.problem(problem), posture, count);
                self.steps += hopping.steps;
                self.work_reduced += hopping.work();
                return minimum;
            }
        }
        let before = self.steps;
        let Some(nearest) = self.descend_to_nearest(problem, reduced.as_ref(), posture)? else { return Ok(None) };
        let (sqp, lowest) = (&mut self.sqp, &mut self.lowest);
        if reduced.is_some() {
            reduced = ReducedProblem::of(problem, &lowest.posture)?; // fixed joints may have moved
        }
        if let Some(reduced) = &reduced {
            let mut upper = Candidate { forces: vec![], ..lowest.clone() };
            let mut sqp = Sqp::new(&reduced.model);
            let steps = self.hop.search(&reduced.problem(problem), &mut sqp, &mut upper, count);
            self.work_reduced += sqp.work();
            self.steps += steps?;
            lowest.posture = upper.posture;
        } else {
            self.steps += self.hop.search(problem, sqp, lowest, count)?;
        }
        let mut last = sqp.descend(problem, &lowest.posture, &lowest.forces, &lowest.multipliers, &FINAL)?;
        self.steps += last.steps;
        let moved = lowest.posture != self.nearest;
        if reduced.is_some() && moved && (last.violation > SEARCH_VIOLATION || last.objective > nearest.objective) {
            // The gain of the reduced problem costs the rest of the body more.
            last = sqp.descend(problem, &self.nearest, &lowest.forces, &lowest.multipliers, &FINAL)?;
            self.steps += last.steps;
        }
        if last.violation > SEARCH_VIOLATION {
            return Ok(None);
        }
        posture.values_mut().copy_from_slice(sqp.iterate.posture.values());
        let converged = last.converged && last.violation <= FINAL_VIOLATION;
        Ok(Some(LocalMinimum { steps: self.steps - before, converged, ..last }))
    }

    /// The errors of the levels above effort in `posture`, as [`EffortProblem::shortfall`].
    pub(crate) fn shortfall(
        &mut self,
        problem: &EffortProblem<'_>,
        posture: &Posture,
    ) -> Result<Vec<f64>, JointTorquesError> {
        self.sqp.start_at(problem, posture, problem.contact.forces())?;
        Ok(self.sqp.iterate.shortfall(problem))
    }

    /// Steps of all descents so far, also of those that ended nowhere.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Work of all descents so far, in units of [`Engine::work`](crate::posture_solver::Engine::work).
    pub(crate) fn work(&self) -> usize {
        self.work_reduced + self.sqp.work()
    }

    /// Descends from `posture` to the nearest local minimum, in the reduced problem first.
    fn descend_to_nearest(
        &mut self,
        problem: &EffortProblem<'_>,
        reduced: Option<&ReducedProblem>,
        posture: &Posture,
    ) -> Result<Option<LocalMinimum>, JointTorquesError> {
        let (sqp, lowest) = (&mut self.sqp, &mut self.lowest);
        lowest.forces.clear();
        lowest.forces.extend_from_slice(problem.contact.forces());
        lowest.posture.values_mut().copy_from_slice(posture.values());
        if let Some(reduced) = reduced {
            let mut sqp = Sqp::new(&reduced.model);
            let end = sqp.descend(&reduced.problem(problem), posture, &[], &[], &TO_NEAREST);
            self.work_reduced += sqp.work();
            let end = end?;
            self.steps += end.steps;
            if end.violation <= SEARCH_VIOLATION {
                lowest.keep_posture(&sqp);
            }
        }
        let mut nearest = sqp.descend(problem, &lowest.posture, &lowest.forces, &[], &TO_NEAREST)?;
        self.steps += nearest.steps;
        if nearest.violation > SEARCH_VIOLATION {
            nearest = sqp.descend(problem, &lowest.posture, &lowest.forces, &[], &RETRY)?;
            self.steps += nearest.steps;
        }
        if nearest.violation > SEARCH_VIOLATION {
            return Ok(None);
        }
        lowest.keep(sqp);
        self.nearest.values_mut().copy_from_slice(lowest.posture.values());
        Ok(Some(nearest))
    }

    /// Moves `posture` near its local minimum, or leaves it where it is if constraints are violated there; returns whether it did.
    pub(crate) fn near_minimum(
        &mut self,
        problem: &EffortProblem<'_>,
        posture: &mut Posture,
    ) -> Result<bool, JointTorquesError> {
        let reduced = ReducedProblem::of(problem, posture)?;
        let found = self.descend_to_nearest(problem, reduced.as_ref(), posture)?.is_some();
        if found {
            posture.values_mut().copy_from_slice(self.lowest.posture.values());
        }
        Ok(found)
    }

    /// Moves `posture` to its own local minimum, and returns whether it did: not if a coordinate would change by more than
    /// `most`, or a constraint is violated there.
    pub(crate) fn descend(
        &mut self,
        problem: &EffortProblem<'_>,
        posture: &mut Posture,
        most: f64,
    ) -> Result<bool, JointTorquesError> {
        let forces = &mut self.lowest.forces;
        forces.clear();
        forces.extend_from_slice(problem.contact.forces());
        let minimum = self.sqp.descend(problem, posture, forces, &[], &AT_REST)?;
        self.steps += minimum.steps;
        let end = &self.sqp.iterate.posture;
        let near = end.values().iter().zip(posture.values()).all(|(a, b)| (a - b).abs() <= most);
        let reached = minimum.converged && minimum.violation <= FINAL_VIOLATION && near;
        if reached {
            posture.values_mut().copy_from_slice(end.values());
        }
        Ok(reached)
    }
}

impl Candidate {
    /// Copies the iterate of a descent.
    fn keep(&mut self, sqp: &Sqp) {
        self.keep_posture(sqp);
        self.forces.clone_from(&sqp.iterate.forces);
        self.multipliers.clone_from(&sqp.multipliers);
    }

    fn keep_posture(&mut self, sqp: &Sqp) {
        self.posture.values_mut().copy_from_slice(sqp.iterate.posture.values());
    }
}

impl Hop {
    /// Moves `lowest` to the lowest of `count` local minima, itself included; returns the number of steps.
    fn search(
        &mut self,
        problem: &EffortProblem<'_>,
        sqp: &mut Sqp,
        lowest: &mut Candidate,
        count: usize,
    ) -> Result<usize, JointTorquesError> {
        sqp.start_at(problem, &lowest.posture, &lowest.forces)?;
        let subtrees = DecoupledSubtrees::of(problem, &sqp.iterate);
        let mut objectives = subtrees.objectives(&sqp.iterate.residual);
        let (mut best, mut steps, mut random) = (sqp.iterate.objective, 0, 0);
        for _ in 1..count {
            self.draw_perturbation(problem, &mut random);
            if sqp.perturb(problem, &lowest.posture, &lowest.forces, &self.perturbation).is_err() {
                continue;
            }
            self.perturbed.keep(sqp);
            let (start, forces) = (&self.perturbed.posture, &self.perturbed.forces);
            let Ok(found) = sqp.descend(problem, start, forces, &[], &FROM_PERTURBED) else { continue };
            steps += found.steps;
            if found.violation > SEARCH_VIOLATION {
                continue;
            }
            // A second start: every subtree from that of the two local minima in which its objective is lower.
            let others = subtrees.objectives(&sqp.iterate.residual);
            let mixed: f64 = objectives.iter().zip(&others).map(|(a, b)| a.min(*b)).sum();
            self.perturbed.posture.values_mut().copy_from_slice(lowest.posture.values());
            subtrees.mix(problem, &mut self.perturbed.posture, &objectives, &sqp.iterate.posture, &others);
            self.perturbed.forces.clone_from(&sqp.iterate.forces);
            let lower = best * (1.0 - LEAST_IMPROVEMENT);
            if found.objective < lower {
                (best, objectives) = (found.objective, others);
                lowest.keep(sqp);
            }
            let lower = best * (1.0 - LEAST_IMPROVEMENT);
            if mixed >= lower {
                continue;
            }
            let (start, forces) = (&self.perturbed.posture, &self.perturbed.forces);
            let Ok(found) = sqp.descend(problem, start, forces, &[], &FROM_MIXED) else { continue };
            steps += found.steps;
            if found.violation <= SEARCH_VIOLATION && found.objective < lower {
                (best, objectives) = (found.objective, subtrees.objectives(&sqp.iterate.residual));
                lowest.keep(sqp);
            }
        }
        Ok(steps)
    }

    /// Draws a change of every unknown: numbers from -1 to 1 times the perturbed share of each coordinate's range, for neighbouring
    /// coordinates in the model's order; 0 for the others and for the forces.
    fn draw_perturbation(&mut self, problem: &EffortProblem<'_>, random: &mut u64) {
        self.perturbation.clear();
        let count = problem.free.len() as f64;
        let first = 0.5 * (1.0 + next_number(random));
        self.perturbation.extend(problem.free.iter().enumerate().map(|(i, &rate)| {
            let by = next_number(random);
            let perturbed = (i as f64 / count - first).rem_euclid(1.0) < PERTURBED_COORDINATES;
            let range = problem.model.rates()[rate].coordinate.map(|c| problem.model.coordinates()[c].range);
            let width = range.map_or(0.0, |(lower, upper)| upper - lower);
            if perturbed && width.is_finite() { PERTURBED_SHARE * width.min(LARGEST_RANGE) * by } else { 0.0 }
        }));
        self.perturbation.resize(problem.unknowns(), 0.0);
    }
}
