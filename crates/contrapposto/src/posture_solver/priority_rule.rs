//! The step rule of strict priorities: for tasks without supports, where the levels follow in their order and no level
//! costs one above it anything (Baerlocher & Boulic 2004, "An inverse kinematics architecture enforcing an arbitrary
//! number of strict priority levels").
//!
//! Levels are damped by the errors of theirs and of the levels above. The first level that no longer comes nearer is
//! out of reach and becomes a Newton level ([`super::newton_level`]), one at a time; the levels below wait until its
//! steps are short. A step of a Newton level is rejected where it raises
//!
//! ```text
//! merit = |r| + penalty * sum of |errors of the levels above|        penalty above the multipliers, over |r|
//! ```

use super::error::EngineError;
use super::iterate::Iterate;
use super::linearisation::Linearisation;
use super::newton_level::NewtonLevel;
use super::options::Options;
use super::settings::Settings;
use super::tolerances::{
    COOLED_STEP, DAMPING, LARGEST_DAMPED_ERROR, LEAST_ERROR, LEAST_REJECTED_STEP, LEVELS_ABOVE_MET, LEVELS_ABOVE_NEAR,
    MERIT_ROUNDING, SETTLED_STEP, SHRINK_AFTER_REJECTION, STALLED_ERROR, STALLED_RESIDUAL, STALLED_STEP, STALLED_STEPS,
    STEPS_BEFORE_COOLING, STEPS_OF_COOLING, TRUST_GROWTH, UNSETTLED, WEIGHT_OF_ACTIVE_ROWS,
};
use crate::posture::Posture;
use crate::tasks::{ErrorHessian, PriorityLevel, Task};
use hierarchical_least_squares::{Multipliers, Solver};

/// See the module's text.
#[derive(Clone, Debug)]
pub(super) struct PriorityRule {
    /// Length of the error of each level in the present posture, and in the one before.
    errors: Vec<f64>,
    errors_before: Vec<f64>,
    /// By level: steps in a row that hardly lowered its error.
    stalled: Vec<usize>,
    /// Index of the Newton level.
    newton: Option<usize>,
    /// The levels below the Newton level wait for it.
    below_waits: bool,
    /// Largest change of this step, and of the next one: a step is judged after the next one is bounded.
    trust_radius: f64,
    next_trust_radius: f64,
    /// Largest change of any step, and its factor from step to step toward the end of a solve.
    ceiling: f64,
    cooling: f64,
    /// Number of steps since the restart.
    steps: usize,
    /// Largest change of the last step, and of the one before.
    largest: [f64; 2],
    newton_level: NewtonLevel,
    hessian: ErrorHessian,
    /// The problem that takes back errors of second order, and its solver.
    restoration: Linearisation,
    restoration_solver: Solver,
}

impl PriorityRule {
    pub(super) fn new(settings: &Settings<'_>) -> Self {
        let (n, levels) = (settings.model.rates().len(), settings.levels.len());
        let rows = |level: &PriorityLevel| level.rows();
        let most = settings.levels.iter().map(rows).max().unwrap_or(0);
        let restoration = Linearisation::new(settings, 0);
        let mut rule = Self {
            errors: vec![f64::INFINITY; levels],
            errors_before: vec![f64::INFINITY; levels],
            stalled: vec![0; levels],
            newton: None,
            below_waits: true,
            trust_radius: 0.0,
            next_trust_radius: 0.0,
            ceiling: 0.0,
            cooling: 1.0,
            steps: 0,
            largest: [f64::INFINITY; 2],
            newton_level: NewtonLevel::new(n, most, settings.levels.iter().map(rows).sum()),
            hessian: ErrorHessian::new(&settings.model, settings.levels.iter().flat_map(|level| &level.tasks)),
            restoration_solver: restoration.new_solver(),
            restoration,
        };
        rule.restart(&settings.options);
        rule
    }

    /// Forgets the steps so far.
    pub(super) fn restart(&mut self, options: &Options) {
        self.errors.fill(f64::INFINITY);
        self.errors_before.fill(f64::INFINITY);
        self.stalled.fill(0);
        self.newton = None;
        self.below_waits = true;
        self.widen_trust_region(options);
        self.trust_radius = options.max_step;
        self.ceiling = options.max_step;
        self.steps = 0;
        self.cooling = 1.0;
        self.largest = [f64::INFINITY; 2];
        self.restoration_solver.forget();
    }

    /// After a fifth of the largest number of steps the trust radius shrinks, within a quarter of that number to next to
    /// nothing, so that the body comes to rest whatever it is asked.
    pub(super) fn cool_toward_rest(&mut self, options: &Options) {
        let steps = (options.max_steps / STEPS_OF_COOLING).max(1);
        self.cooling = libm::pow(COOLED_STEP * options.step_tolerance / options.max_step, 1.0 / steps as f64);
    }

    /// The next step may be as long as the first one.
    pub(super) fn widen_trust_region(&mut self, options: &Options) {
        self.next_trust_radius = options.max_step;
    }

    /// Records the errors of a posture that has just been linearised.
    pub(super) fn record(&mut self, linearisation: &Linearisation) {
        self.errors_before.copy_from_slice(&self.errors);
        self.errors.copy_from_slice(&linearisation.lengths);
    }

    /// The posture before is the present one again.
    pub(super) fn take_back(&mut self) {
        self.errors.copy_from_slice(&self.errors_before);
    }

    /// Whether the last step of a Newton level raised the merit.
    pub(super) fn merit_rose(&self, solver: &Solver) -> bool {
        let Some(k) = self.newton else { return false };
        let largest = solver.multipliers(k).rows.iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        let penalty = 1.0 + 2.0 * largest / self.errors_before[k].max(LEAST_ERROR);
        let merit = |errors: &[f64]| errors[k] + penalty * errors[..k].iter().sum::<f64>();
        let (now, before) = (merit(&self.errors), merit(&self.errors_before));
        now > before + MERIT_ROUNDING && self.largest[0] > LEAST_REJECTED_STEP
    }

    /// Adapts the trust radius to the last step.
    pub(super) fn adapt(&mut self, options: &Options, merit_rose: bool) {
        self.trust_radius = self.next_trust_radius;
        if merit_rose {
            self.next_trust_radius = SHRINK_AFTER_REJECTION * self.largest[0];
            self.trust_radius = self.next_trust_radius;
        } else if self.newton.is_some() {
            self.next_trust_radius = (TRUST_GROWTH * self.next_trust_radius).min(options.max_step);
        }
    }

    /// Completes the problem of a step: bounds, damping, and the rows of the Newton level.
    pub(super) fn prepare(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        linearisation: &mut Linearisation,
        solver: &Solver,
    ) {
        linearisation.bound(settings, iterate, self.trust_radius.min(self.ceiling));
        self.choose_newton_level(settings.options.level_tolerance, solver);
        self.damp(settings, linearisation);
        let Some(k) = self.newton else { return };
        self.write_newton_level(settings, iterate, linearisation, solver.multipliers(k), k);
        let settled = if self.below_waits { SETTLED_STEP } else { UNSETTLED * SETTLED_STEP };
        self.below_waits = self.largest[0] > settled;
        if self.below_waits && k + 1 < settings.levels.len() {
            linearisation.ask_for_least_motion(k + 1);
        }
    }

    /// Takes back the errors above a Newton level that a long step leaves, and counts the step.
    pub(super) fn finish(
        &mut self,
        settings: &Settings<'_>,
        iterate: &mut Iterate,
        posture: &mut Posture,
        largest: f64,
    ) -> Result<(), EngineError> {
        if let Some(k) = self.newton.filter(|k| *k > 0) {
            self.restore(settings, iterate, posture, k)?;
        }
        self.largest = [largest, self.largest[0]];
        self.steps += 1;
        if self.steps > settings.options.max_steps / STEPS_BEFORE_COOLING {
            self.ceiling *= self.cooling;
        }
        Ok(())
    }

    /// The first level that has stalled though all levels above it come nearer becomes the Newton level; or the last
    /// level, when steps no longer shrink. One at a time: the rows of a Newton level have no second derivative of their
    /// own.
    fn choose_newton_level(&mut self, level_tolerance: f64, solver: &Solver) {
        if let Some(k) = self.newton {
            if self.errors[k] <= level_tolerance {
                self.newton = None;
            }
            return;
        }
        let Some(last) = self.errors.len().checked_sub(1) else { return };
        let mut above = 0.0;
        for k in 0..last {
            let (error, before) = (self.errors[k], self.errors_before[k]);
            let stalls = above < LEVELS_ABOVE_NEAR
                && error > STALLED_ERROR * before
                && solver.residual_norm(k) > STALLED_RESIDUAL * before;
            self.stalled[k] = if stalls && error > level_tolerance { self.stalled[k] + 1 } else { 0 };
            if self.stalled[k] >= STALLED_STEPS {
                self.newton = Some(k);
                return;
            }
            above += error;
        }
        let stalls = above < LEVELS_ABOVE_NEAR && self.largest[0] > STALLED_STEP * self.largest[1];
        self.stalled[last] = if stalls { self.stalled[last] + 1 } else { 0 };
        // Oscillations keep the levels above from being met: these are waited for a little longer.
        if self.stalled[last] >= if above < LEVELS_ABOVE_MET { STALLED_STEPS / 2 } else { STALLED_STEPS } {
            self.newton = Some(last);
        }
    }

    /// Damps levels by the errors of theirs and of the levels above: far from the target a row says little about the
    /// way. The last level is not damped, for no level below could suffer.
    fn damp(&self, settings: &Settings<'_>, linearisation: &mut Linearisation) {
        let mut missing = 0.0;
        let last = settings.levels.len().saturating_sub(1);
        for (k, level) in linearisation.problem.levels.iter_mut().enumerate() {
            let newton = self.newton == Some(k);
            missing += if newton { 0.0 } else { self.errors[k] };
            let exact = k == last || newton || settings.levels[k].hard;
            level.damping = if exact { 0.0 } else { DAMPING * missing.min(LARGEST_DAMPED_ERROR) };
        }
    }

    fn write_newton_level(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        linearisation: &mut Linearisation,
        last: Multipliers<'_>,
        k: usize,
    ) {
        let (newton, problem) = (&mut self.newton_level, &mut linearisation.problem);
        newton.take(problem, k);
        newton.estimate(problem, k, last);
        self.hessian.clear();
        let mut multipliers = newton.estimate.multipliers();
        for level in &settings.levels[..k] {
            multipliers = add_tasks(&mut self.hessian, settings, iterate, level, multipliers);
            multipliers = multipliers.split_at_checked(level.half_spaces.len()).map_or(&[], |(_, rest)| rest);
        }
        add_tasks(&mut self.hessian, settings, iterate, &settings.levels[k], &newton.residual);
        if let Some(hessian) = self.hessian.evaluate(&settings.model, iterate.torques.kinematics()) {
            let n = hessian.size();
            for (e, entry) in newton.matrix.iter_mut().enumerate() {
                *entry = 0.5 * (hessian.get(e / n, e % n) + hessian.get(e % n, e / n));
            }
        }
        let size = newton.add_first_derivatives();
        let weight = WEIGHT_OF_ACTIVE_ROWS * size;
        newton.weigh_rows(&problem.levels[..k], weight, |multiplier, (lower, upper), _| {
            let equation = lower == upper;
            (equation || multiplier != 0.0).then_some(if equation { multiplier } else { 0.0 })
        });
        newton.weigh_bounds(problem, last.bounds, weight);
        newton.write_with_absolute_curvature(&mut problem.levels[k], size);
    }

    /// A long step of Newton level `k` leaves errors above it that grow with its square: takes them back with the least
    /// motion.
    fn restore(
        &mut self,
        settings: &Settings<'_>,
        iterate: &mut Iterate,
        posture: &mut Posture,
        k: usize,
    ) -> Result<(), EngineError> {
        iterate.evaluate(settings, posture)?;
        self.restoration.write_above(settings, iterate, k);
        self.restoration.bound(settings, iterate, settings.options.max_step.min(self.ceiling));
        self.restoration.ask_for_least_motion(k);
        self.restoration_solver.solve_next(&self.restoration.problem)?;
        posture.displace(&settings.model, self.restoration_solver.solution());
        settings.keep_ranges(posture);
        Ok(())
    }
}

/// Adds the tasks of a level with the first of these weights, and returns the others.
fn add_tasks<'w>(
    hessian: &mut ErrorHessian,
    settings: &Settings<'_>,
    iterate: &Iterate,
    level: &PriorityLevel,
    mut weights: &'w [f64],
) -> &'w [f64] {
    for task in &level.tasks {
        let (own, rest) = weights.split_at(Task::rows(task).min(weights.len()));
        hessian.add(&settings.model, iterate.torques.kinematics(), task, own);
        weights = rest;
    }
    weights
}
