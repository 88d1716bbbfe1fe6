//! The step rule of the merit function: for bodies on supports, where effort is lowered while the levels above it hold.
//!
//! Effort is a sum of squares under nonlinear constraints. A step is one of Gauss-Newton with the whole second
//! derivative of the Lagrangian ([`crate::effort::hessian`]) within a trust region; it is rejected where it raises
//!
//! ```text
//! merit = |e|^2 / 2 + penalty * sum of |errors of the levels above|         penalty above every multiplier
//! ```
//!
//! (Nocedal & Wright 2006, "Numerical Optimization", ch. 18). Contact forces, of which effort is a quadratic function,
//! are solved anew in every posture (Kaufman 1975, "A variable projection method for solving separable nonlinear least
//! squares problems"); in a step they are unknowns beside the posture, and the Newton level has their mixed second
//! derivatives, too. Without an effort level every step counts.

use super::iterate::Iterate;
use super::linearisation::{Linearisation, missing};
use super::newton_level::NewtonLevel;
use super::options::{Options, Step};
use super::settings::{Rates, Settings};
use super::tolerances::{
    CUT_SHORT, DAMPING, FEASIBILITY_STEP, IDLE_STEPS, LARGEST_DAMPED_ERROR, LEAST_REGULARISATION,
    LEAST_REJECTED_EFFORT_STEP, MERIT_PENALTY_DECAY, MERIT_PENALTY_MARGIN, MERIT_SHARE_ROUNDING,
    REGULARISATION_AFTER_RISE, REGULARISATION_DECAY, REGULARISATION_GROWTH, SHRINK_AFTER_RISE, TRUST_GROWTH,
    WEIGHT_OF_EQUATIONS,
};
use crate::effort::hessian::{FirstOrder, Hessian, HessianModel};
use crate::effort::problem::EffortProblem;
use crate::tasks::{PriorityLevel, Task};
use hierarchical_least_squares::{Level, Multipliers, Solver};

/// Objective and constraint errors of a posture.
#[derive(Clone, Debug)]
struct Errors {
    /// `|e|^2 / 2` of the effort level.
    objective: f64,
    /// Sum of the sizes of the errors of all levels above effort; infinite where nothing is known.
    above: f64,
}

/// See the module's text.
#[derive(Clone, Debug)]
pub(super) struct MeritRule {
    /// Errors of the present posture, and of the one before.
    errors: Errors,
    errors_before: Errors,
    penalty: f64,
    trust_radius: f64,
    /// Addition to the diagonal of the Newton level.
    regularisation: f64,
    /// By level of the linearised problem: the length of what the last step left of it.
    unreached: Vec<f64>,
    /// Largest change of the last step.
    largest: f64,
    /// Steps in a row with little change of the merit.
    idle: usize,
    /// Second derivatives that are used.
    pub(super) hessian_model: HessianModel,
    hessian: Hessian,
    newton_level: NewtonLevel,
    /// Multipliers of the root's equilibrium and of the tasks above effort.
    multipliers: Vec<f64>,
}

impl MeritRule {
    /// Space for the levels of `settings` and as many contact forces.
    pub(super) fn new(settings: &Settings<'_>, forces: usize) -> Self {
        let unknowns = settings.model.rates().len() + forces;
        let unknown = Errors { objective: f64::INFINITY, above: f64::INFINITY };
        Self {
            errors: unknown.clone(),
            errors_before: unknown,
            penalty: 0.0,
            trust_radius: settings.options.max_step,
            regularisation: 0.0,
            unreached: vec![],
            largest: f64::INFINITY,
            idle: 0,
            hessian_model: HessianModel::Full,
            hessian: Hessian::new(&settings.model),
            newton_level: NewtonLevel::new(unknowns, unknowns, unknowns),
            multipliers: vec![],
        }
    }

    /// Forgets the steps so far.
    pub(super) fn restart(&mut self, options: &Options) {
        let unknown = Errors { objective: f64::INFINITY, above: f64::INFINITY };
        (self.errors, self.errors_before) = (unknown.clone(), unknown);
        self.penalty = 0.0;
        self.unreached.clear();
        self.trust_radius = options.max_step;
        self.regularisation = 0.0;
        self.idle = 0;
    }

    /// The next step may be as long as the first one, and counts in any case.
    pub(super) fn widen_trust_region(&mut self, options: &Options) {
        self.trust_radius = options.max_step;
        self.errors.above = f64::INFINITY;
    }

    /// Records the errors of a posture that has just been linearised.
    pub(super) fn record(&mut self, settings: &Settings<'_>, linearisation: &Linearisation) {
        let levels = &linearisation.problem.levels;
        let effort = settings.effort_level.map(|level| settings.first_level() + level);
        let objective = |k: usize| 0.5 * missing(&levels[k]).map(|m| m * m).sum::<f64>();
        let above = &levels[..effort.unwrap_or(0)];
        let errors = Errors {
            objective: effort.map_or(0.0, objective),
            above: above.iter().map(|level| missing(level).map(f64::abs).sum::<f64>()).sum(),
        };
        self.errors_before = std::mem::replace(&mut self.errors, errors);
    }

    /// The posture before is the present one again.
    pub(super) fn take_back(&mut self) {
        self.errors = self.errors_before.clone();
    }

    fn merit(&self, errors: &Errors) -> f64 {
        if errors.above.is_finite() { errors.objective + self.penalty * errors.above } else { f64::INFINITY }
    }

    /// Whether there is a merit to compare with.
    fn is_comparable(&self, settings: &Settings<'_>) -> bool {
        settings.effort_level.is_some() && self.merit(&self.errors_before).is_finite()
    }

    /// Whether the last step raised the merit.
    pub(super) fn merit_rose(&self, settings: &Settings<'_>) -> bool {
        self.is_comparable(settings)
            && self.merit(&self.errors) > self.merit(&self.errors_before) * (1.0 + MERIT_SHARE_ROUNDING)
            && self.largest > LEAST_REJECTED_EFFORT_STEP
    }

    /// Adapts trust radius and regularisation to the last step.
    pub(super) fn adapt(&mut self, settings: &Settings<'_>, merit_rose: bool) {
        if !self.is_comparable(settings) {
            return;
        }
        if merit_rose {
            self.trust_radius = SHRINK_AFTER_RISE * self.largest;
            self.regularisation = (REGULARISATION_GROWTH * self.regularisation).max(REGULARISATION_AFTER_RISE);
        } else {
            self.trust_radius = (TRUST_GROWTH * self.trust_radius).min(settings.options.max_step);
            self.regularisation *= REGULARISATION_DECAY;
            if self.regularisation < LEAST_REGULARISATION {
                self.regularisation = 0.0;
            }
        }
    }

    /// Completes the problem of a step: bounds, damping, the feasibility step, and the rows of the effort level.
    pub(super) fn prepare(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        linearisation: &mut Linearisation,
        solver: &Solver,
    ) {
        linearisation.bound(settings, iterate, self.trust_radius.min(settings.options.max_step));
        let first = settings.first_level();
        let end = first + settings.effort_level.unwrap_or(settings.levels.len());
        self.damp(first, &mut linearisation.problem.levels[..end]);
        let Some(problem) = settings.effort_problem(&iterate.contact, Rates::All) else { return };
        linearisation.problem.levels[first..end].iter_mut().for_each(limit_feasibility_step);
        self.write_effort_level(&problem, iterate, linearisation, solver.multipliers(end), first);
    }

    /// Adapts the penalty to the multipliers of the step, and counts steps that change the merit little.
    pub(super) fn finish(&mut self, settings: &Settings<'_>, solver: &Solver, step: &Step) {
        self.largest = step.largest;
        if let Some(level) = settings.effort_level {
            let rows = solver.multipliers(settings.first_level() + level).rows;
            let most = rows.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
            self.penalty = (MERIT_PENALTY_DECAY * self.penalty).max(MERIT_PENALTY_MARGIN * most);
        }
        self.unreached.clear();
        self.unreached.extend((0..settings.first_level() + settings.levels.len()).map(|k| solver.residual_norm(k)));
        let (now, before) = (self.merit(&self.errors), self.merit(&self.errors_before));
        let little = (before - now).abs() <= settings.options.merit_tolerance * now;
        let idle = little && step.largest < CUT_SHORT * self.trust_radius && !step.rejected_previous;
        self.idle = if idle { self.idle + 1 } else { 0 };
    }

    /// Whether so many steps in a row have changed the merit little that more are not worth while.
    pub(super) fn is_idle(&self) -> bool {
        self.idle >= IDLE_STEPS
    }

    /// Damps levels above effort by what the last step left of them.
    fn damp(&self, first: usize, levels: &mut [Level]) {
        for (k, level) in levels.iter_mut().enumerate().skip(first) {
            let unreached = self.unreached.get(k).copied().unwrap_or(0.0);
            level.damping = if level.hard { 0.0 } else { DAMPING * unreached.min(LARGEST_DAMPED_ERROR) };
        }
    }

    /// Replaces the rows of the effort level by those of its Newton level. Equations above are weighed into the matrix, lest
    /// curvature along them look negative. Raises the regularisation where it must; where none makes the matrix positive, the
    /// level keeps its first derivatives. `last` are the multipliers of the last step.
    fn write_effort_level(
        &mut self,
        effort: &EffortProblem<'_>,
        iterate: &Iterate,
        linearisation: &mut Linearisation,
        last: Multipliers<'_>,
        first: usize,
    ) {
        let (newton, problem) = (&mut self.newton_level, &mut linearisation.problem);
        let k = first + effort.above.len();
        newton.take(problem, k);
        match self.hessian_model {
            HessianModel::Full => newton.estimate(problem, k, last),
            HessianModel::Partial => newton.estimate.take_last(&problem.levels[..k], last),
        }
        gather(effort, &problem.levels[..k], first, newton.estimate.multipliers(), &mut self.multipliers);
        let at = FirstOrder {
            body: &iterate.torques,
            loads: iterate.torques.loads(),
            columns: effort.contact.columns(),
            residual: &newton.residual,
            jacobian: &newton.level.matrix,
            support_rows: &problem.levels[1].matrix,
        };
        self.hessian.add_second_derivative(effort, &at, &self.multipliers, self.hessian_model, &mut newton.matrix);
        let size = newton.add_first_derivatives();
        newton.weigh_rows(&problem.levels[..k], WEIGHT_OF_EQUATIONS * size, |_, (lower, upper), weight| {
            (lower == upper).then_some(-weight * upper)
        });
        newton.write_regularised(&mut problem.levels[k], effort.free.len(), &mut self.regularisation);
    }
}

/// No level above effort takes on more than [`FEASIBILITY_STEP`].
fn limit_feasibility_step(level: &mut Level) {
    let length = missing(level).map(|m| m * m).sum::<f64>().sqrt();
    if length > FEASIBILITY_STEP {
        level.lower.iter_mut().chain(&mut level.upper).for_each(|limit| *limit *= FEASIBILITY_STEP / length);
    }
}

/// The multipliers of rows with a second derivative: of the root's equilibrium (the last rows of the first level), of
/// the supports' places, of the limits, and of the tasks above effort.
fn gather(effort: &EffortProblem<'_>, above: &[Level], first: usize, all: &[f64], gathered: &mut Vec<f64>) {
    gathered.clear();
    let mut rest = all;
    for (k, level) in above.iter().enumerate() {
        let (own, below) = rest.split_at(level.rows());
        rest = below;
        let tasks = |level: &PriorityLevel| ..level.tasks.iter().map(Task::rows).sum();
        match k {
            0 => gathered.extend_from_slice(&own[own.len() - effort.contact.root().len()..]),
            1 | 2 => gathered.extend_from_slice(own),
            _ if k < first => {}
            _ => gathered.extend_from_slice(&own[tasks(&effort.above[k - first])]),
        }
    }
}
