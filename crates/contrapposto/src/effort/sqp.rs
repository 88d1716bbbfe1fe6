//! Descends to a local minimum of effort by sequential quadratic programming on posture and contact forces together.
//!
//! Every step minimises the quadratic model with the second derivative of the Lagrangian ([`super::hessian`]) under linearised
//! constraints ([`super::qp`]; Nocedal & Wright 2006, "Numerical Optimization", ch. 18). A step is accepted if it lowers the merit
//! `1/2 |r|^2 + penalty sum |violations|`. The regularisation of the second derivative follows the ratio of actual and predicted
//! decrease (Nielsen 1999, "Damping parameter in Marquardt's method"). Where the curvature is negative in free directions,
//! regularisation also keeps steps short; while their predictions come true, each step may be twice as long as the one before.
//! Constraint violations of second order are corrected with the factors at hand before a step is judged (Fletcher 1982, "Second
//! order corrections for non-differentiable optimization"): otherwise rotating feet shorten the steps (the Maratos effect).

use super::hessian::{Hessian, HessianModel};
use super::iterate::Iterate;
use super::problem::EffortProblem;
use super::qp::QuadraticProgram;
use super::tolerances::{
    ACCEPTED_SHARE, CONTRADICTIONS, FIRST_REGULARISATION, GOOD_AGREEMENT, LEAST_STEP, NO_REGULARISATION, PENALTY_DECAY,
    PENALTY_MARGIN, PREDICTED_ROUNDING, RAISED_REGULARISATION, ROUNDING_SHARE, SEARCH_VIOLATION, WORTH_CORRECTING,
};
use crate::contact::bounds;
use crate::joint_torques::JointTorquesError;
use crate::model::Model;
use crate::posture::Posture;
use hierarchical_least_squares::linalg::dot;

/// Settings of a descent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SqpOptions {
    /// Length of the constraint violation that one step corrects, in units of the rows: on the way to a far target effort stays
    /// low.
    pub(crate) feasibility_step: f64,
    /// First steps that use first derivatives only.
    pub(crate) gauss_newton_steps: usize,
    /// Largest change of any rate in one step, rad or m.
    pub(crate) trust_radius: f64,
    /// Whether steps lengthen where the curvature is negative.
    pub(crate) extrapolates: bool,
    pub(crate) max_steps: usize,
    /// The descent ends when two steps in a row predict a smaller decrease than this share of the merit.
    pub(crate) least_gain: f64,
}

/// End of a descent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalMinimum {
    /// Half the effort.
    pub(crate) objective: f64,
    /// Sum of all constraint violations.
    pub(crate) violation: f64,
    pub(crate) steps: usize,
    /// Whether the descent ended because no more decrease was predicted.
    pub(crate) converged: bool,
}

/// Workspace of a descent.
#[derive(Clone, Debug)]
pub(crate) struct Sqp {
    pub(crate) iterate: Iterate,
    /// Multipliers of the constraint rows at the iterate.
    pub(crate) multipliers: Vec<f64>,
    // Scratch.
    candidate: Iterate,
    hessian: Hessian,
    program: QuadraticProgram,
    correction: Vec<f64>,
    by_rate: Vec<f64>,
}

/// A step to be tried.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Share of the constraint violation that the whole step corrects.
    share: f64,
    /// Regularisation that the program needed.
    regularisation: f64,
    /// Largest change of a rate in the whole step.
    largest: f64,
    /// Multiple of the step that is taken.
    length: f64,
    /// Merit before the step, and its predicted decrease.
    merit: f64,
    predicted: f64,
}

/// Quantities that control a descent from step to step.
#[derive(Clone, Copy, Debug)]
struct Control {
    regularisation: f64,
    /// Factor of the regularisation after the next rejected step.
    growth: f64,
    penalty: f64,
    trust_radius: f64,
    /// Largest multiple of the next step.
    extrapolation: f64,
    /// Steps in a row that predicted little decrease.
    small_gains: usize,
    /// Contradictory programs in a row.
    contradictions: usize,
}

impl Control {
    fn new(options: &SqpOptions) -> Self {
        Self {
            regularisation: 0.0,
            growth: 2.0,
            penalty: 0.0,
            trust_radius: options.trust_radius,
            extrapolation: 1.0,
            small_gains: 0,
            contradictions: 0,
        }
    }

    /// Raises the regularisation after a step that needed `used`.
    fn raise_regularisation(&mut self, used: f64) {
        self.regularisation = (self.growth * used).max(FIRST_REGULARISATION);
        self.growth *= 2.0;
    }

    /// Decides from the merit after a step whether it is accepted, and prepares the next one.
    fn judge(&mut self, step: &Step, after: f64, options: &SqpOptions) -> bool {
        let actual = step.merit - after;
        let rounding = actual.abs() <= ROUNDING_SHARE * step.merit;
        let ratio = if step.predicted > 0.0 { actual / step.predicted } else { -1.0 };
        let accepted = ratio > ACCEPTED_SHARE || rounding;
        if accepted {
            let was_raised = step.regularisation > self.regularisation;
            let agreement = if rounding { 1.0 } else { ratio.min(1.5) };
            let factor = (1.0 - (2.0 * agreement - 1.0).powi(3)).clamp(1.0 / 3.0, 3.0);
            self.regularisation = if factor > 1.0 {
                (factor * step.regularisation).max(RAISED_REGULARISATION)
            } else {
                factor * step.regularisation.min(self.regularisation)
            };
            if self.regularisation < NO_REGULARISATION {
                self.regularisation = 0.0;
            }
            self.growth = 2.0;
            self.trust_radius = (2.0 * self.trust_radius).min(options.trust_radius);
            let lengthens = options.extrapolates && was_raised && ratio > GOOD_AGREEMENT;
            self.extrapolation = if lengthens { 2.0 * step.length.max(1.0) } else { 1.0 };
        } else if step.length > 1.0 {
            self.extrapolation = 1.0;
        } else {
            self.raise_regularisation(step.regularisation);
            self.trust_radius = 0.5 * step.length * step.largest;
        }
        let small = step.predicted <= options.least_gain * step.merit && step.share == 1.0;
        self.small_gains = if small { self.small_gains + 1 } else { 0 };
        accepted
    }

    /// Whether the descent has converged with this step.
    fn converged(&self, step: &Step) -> bool {
        self.small_gains >= 2
            || step.length * step.largest <= LEAST_STEP
            || (self.small_gains > 0 && step.predicted < PREDICTED_ROUNDING * step.merit)
    }
}

impl Sqp {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            iterate: Iterate::new(model),
            multipliers: vec![],
            candidate: Iterate::new(model),
            hessian: Hessian::new(model),
            program: QuadraticProgram::default(),
            correction: vec![],
            by_rate: vec![0.0; model.rates().len()],
        }
    }

    /// Descends from `start` with `forces` and the multipliers of the constraints (empty if unknown) to `iterate`.
    pub(crate) fn descend(
        &mut self,
        problem: &EffortProblem<'_>,
        start: &Posture,
        forces: &[f64],
        multipliers: &[f64],
        options: &SqpOptions,
    ) -> Result<LocalMinimum, JointTorquesError> {
        self.start_at(problem, start, forces)?;
        self.multipliers.extend_from_slice(multipliers);
        let mut control = Control::new(options);
        let (mut steps, mut converged) = (0, false);
        while steps < options.max_steps && !converged {
            steps += 1;
            let share = self.corrected_share(options.feasibility_step);
            let second_order = steps > options.gauss_newton_steps;
            let Some(step) = self.solve_step(problem, share, second_order, &mut control) else { break };
            if control.contradictions >= CONTRADICTIONS && self.iterate.violation() > SEARCH_VIOLATION {
                break;
            }
            if step.predicted <= 0.0 && step.largest > LEAST_STEP {
                // The working set was wrong: an empty one and a shorter step.
                self.program.forget();
                control.raise_regularisation(step.regularisation);
                continue;
            }
            let after = self.try_step(problem, &step, control.penalty)?;
            if control.judge(&step, after, options) {
                std::mem::swap(&mut self.iterate, &mut self.candidate);
                self.multipliers.clone_from(&self.program.multipliers);
            }
            converged = control.converged(&step);
        }
        let (objective, violation) = (self.iterate.objective, self.iterate.violation());
        Ok(LocalMinimum { objective, violation, steps, converged })
    }

    /// Moves the iterate from `start` by the change of the unknowns that is nearest to `perturbation` and keeps the constraints to
    /// first order.
    pub(crate) fn perturb(
        &mut self,
        problem: &EffortProblem<'_>,
        start: &Posture,
        forces: &[f64],
        perturbation: &[f64],
    ) -> Result<(), JointTorquesError> {
        self.start_at(problem, start, forces)?;
        self.iterate.write(1.0, &mut self.program);
        let n = self.program.n;
        self.program.matrix.fill(0.0);
        self.program.gradient.fill(0.0);
        self.program.unit = 1.0;
        (0..n).for_each(|i| self.program.matrix[i * n + i] = 1.0);
        self.program.gradient.iter_mut().zip(perturbation).for_each(|(entry, by)| *entry = -by);
        self.write_bounds(problem);
        if self.program.solve(0.0).is_some() {
            self.move_candidate(problem, 1.0);
            std::mem::swap(&mut self.iterate, &mut self.candidate);
        }
        Ok(())
    }

    /// Work of all descents so far ([`QuadraticProgram::work`]).
    pub(crate) fn work(&self) -> usize {
        self.program.work
    }

    /// Evaluates the iterate at `start` and forgets earlier descents.
    pub(crate) fn start_at(
        &mut self,
        problem: &EffortProblem<'_>,
        start: &Posture,
        forces: &[f64],
    ) -> Result<(), JointTorquesError> {
        self.iterate.posture.values_mut().copy_from_slice(start.values());
        for iterate in [&mut self.iterate, &mut self.candidate] {
            iterate.forces.clear();
            iterate.forces.extend_from_slice(forces);
        }
        self.iterate.evaluate(problem)?;
        self.program.n = problem.unknowns();
        self.program.rates = problem.free.len();
        self.program.forget();
        self.multipliers.clear();
        Ok(())
    }

    /// Share of the constraint violation that the next step corrects.
    fn corrected_share(&self, feasibility_step: f64) -> f64 {
        let limits = self.iterate.lower.iter().zip(&self.iterate.upper);
        let violations = limits.map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
        let length = violations.map(|v| v * v).sum::<f64>().sqrt();
        if length > feasibility_step { feasibility_step / length } else { 1.0 }
    }

    /// Solves the quadratic program at the iterate, and updates the penalty. `None` if the program has no solution.
    fn solve_step(
        &mut self,
        problem: &EffortProblem<'_>,
        share: f64,
        second_order: bool,
        control: &mut Control,
    ) -> Option<Step> {
        self.program.unit = self.iterate.write(share, &mut self.program);
        if second_order {
            let (at, matrix) = (self.iterate.first_order(problem), &mut self.program.matrix);
            self.hessian.add_second_derivative(problem, &at, &self.multipliers, HessianModel::Full, matrix);
        }
        self.write_bounds(problem);
        let program = &mut self.program;
        let regularisation = program.solve(control.regularisation)?;
        control.contradictions = if program.contradictory { control.contradictions + 1 } else { 0 };
        let largest = program.step[..problem.free.len()].iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let multiplier = program.multipliers.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        control.penalty = (PENALTY_DECAY * control.penalty).max(PENALTY_MARGIN * multiplier);
        let violation = self.iterate.violation();
        let slope = dot(&program.gradient, &program.step);
        let curvature = program.curvature();
        let predict = |length: f64| {
            let corrected = 1.0 - (1.0 - length * share).abs();
            control.penalty * corrected * violation - length * (slope + 0.5 * length * curvature)
        };
        let mut length = (control.trust_radius / largest).min(1.0);
        if control.extrapolation > 1.0 {
            let long = (control.trust_radius / largest).min(control.extrapolation).min(program.longest());
            length = if predict(long) > predict(length) { long } else { length };
        }
        let merit = self.iterate.objective + control.penalty * violation;
        Some(Step { share, regularisation, largest, length, merit, predicted: predict(length) })
    }

    /// Writes the bounds of the unknowns: ranges of coordinates, and forces that only push.
    fn write_bounds(&mut self, problem: &EffortProblem<'_>) {
        let program = &mut self.program;
        program.lower_bounds.clear();
        program.upper_bounds.clear();
        for &rate in problem.free {
            let range = problem.model.rates()[rate].coordinate.map(|c| {
                let (lower, upper) = problem.model.coordinates()[c].range;
                let value = self.iterate.posture.values()[c];
                ((lower - value).min(0.0), (upper - value).max(0.0))
            });
            let (lower, upper) = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            program.lower_bounds.push(lower);
            program.upper_bounds.push(upper);
        }
        for (i, force) in self.iterate.forces.iter().enumerate() {
            let (lower, upper) = bounds(i);
            program.lower_bounds.push((lower - force).min(0.0));
            program.upper_bounds.push((upper - force).max(0.0));
        }
    }

    /// Places the candidate at `length` times the step.
    fn move_candidate(&mut self, problem: &EffortProblem<'_>, length: f64) {
        self.candidate.posture.values_mut().copy_from_slice(self.iterate.posture.values());
        self.candidate.forces.copy_from_slice(&self.iterate.forces);
        self.candidate.displace(problem, &self.program.step, length, &mut self.by_rate);
    }

    /// Evaluates the candidate after the step, with a second-order correction where that lowers the merit; returns the merit.
    fn try_step(&mut self, problem: &EffortProblem<'_>, step: &Step, penalty: f64) -> Result<f64, JointTorquesError> {
        self.move_candidate(problem, step.length);
        if self.candidate.evaluate(problem).is_err() {
            return Ok(f64::INFINITY); // numbers overflow that far away
        }
        let after = self.candidate.objective + penalty * self.candidate.violation();
        let (iterate, candidate, program) = (&self.iterate, &self.candidate, &mut self.program);
        let left = 1.0 - step.length * step.share;
        // Violation beyond the predicted one.
        let excess = |row: usize| {
            let violation = |at: &Iterate| at.lower[row].max(0.0) + at.upper[row].min(0.0);
            violation(candidate) - left * violation(iterate)
        };
        let rows = (0..candidate.lower.len()).filter(|row| program.in_working_set(*row));
        let sum: f64 = rows.map(|row| excess(row).abs()).sum();
        let agrees = step.merit - after >= GOOD_AGREEMENT * step.predicted;
        if agrees || penalty * sum <= WORTH_CORRECTING * step.predicted {
            return Ok(after);
        }
        self.correction.resize(program.n, 0.0);
        program.correct(excess, &mut self.correction);
        self.candidate.displace(problem, &self.correction, 1.0, &mut self.by_rate);
        let corrected = match self.candidate.evaluate(problem) {
            Ok(()) => self.candidate.objective + penalty * self.candidate.violation(),
            Err(_) => f64::INFINITY,
        };
        if corrected < after {
            return Ok(corrected);
        }
        if after < step.merit {
            self.move_candidate(problem, step.length);
            self.candidate.evaluate(problem)?;
        }
        Ok(after)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::standing_adult::StandingAdult;
    use super::{Control, SqpOptions, Step};

    const SEED: u64 = 36;

    #[test]
    fn no_free_coordinate_leaves_its_range_however_long_the_step() {
        let mut at_a_limit = 0;
        StandingAdult::new().each_posture(&mut Pcg64Mcg::new(SEED.into()), 20, |random, problem, iterate| {
            let step: Vec<f64> = (0..problem.unknowns()).map(|_| random.random_range(-4.0..4.0)).collect();
            let mut moved = iterate.clone();
            moved.displace(problem, &step, 1.0, &mut vec![0.0; problem.model.rates().len()]);
            for rate in problem.free {
                let Some(c) = problem.model.rates()[*rate].coordinate else { continue };
                let (value, (lower, upper)) = (moved.posture.values()[c], problem.model.coordinates()[c].range);
                assert!((lower..=upper).contains(&value), "seed {SEED}, coordinate {c}: {value}");
                at_a_limit += u32::from(value == lower || value == upper);
            }
        });
        assert!(at_a_limit > 100, "seed {SEED}: {at_a_limit}");
    }

    /// Steps that predict half of the least gain, and keep that.
    #[test]
    fn small_gains_end_a_descent_only_where_whole_violations_are_corrected() {
        let options = SqpOptions {
            feasibility_step: 0.1,
            gauss_newton_steps: 0,
            trust_radius: 1.0,
            extrapolates: false,
            max_steps: 10,
            least_gain: 1e-6,
        };
        let converged = |share: f64| {
            let mut control = Control::new(&options);
            let predicted = 0.5 * options.least_gain;
            let step = Step { share, regularisation: 0.0, largest: 0.1, length: 1.0, merit: 1.0, predicted };
            [0, 1, 2].map(|_| {
                assert!(control.judge(&step, 1.0 - predicted, &options));
                control.converged(&step)
            })
        };
        assert_eq!(converged(1.0), [false, true, true]);
        assert_eq!(converged(0.5), [false; 3]);
    }
}
