//! How does a body come down into a valley of little effort?
//!
//! Sequential quadratic programming on posture and contact forces together, with the second derivative of the Lagrangian
//! ([`super::hessian`]): `min |e|^2/2` while the root is in equilibrium, supports stay, goals above effort are reached. A step
//! counts if it lowers `|e|^2/2 + price sum |what does not hold|`; the shift of the second derivative follows the ratio of what
//! was gained and foreseen (Nielsen 1999, "Damping parameter in Marquardt's method"). Where effort bends down along what is free,
//! the shift that makes the matrix positive also keeps steps short; as long as they keep what they foresaw, each may be twice as
//! long as the one before. What bends away from a long step is corrected with the factors at hand before it is judged (Fletcher
//! 1982, "Second order corrections for non-differentiable optimization"), or feet that turn would keep steps short.

use super::hessian::{Hessian, HessianModel};
use super::iterate::Iterate;
use super::problem::EffortProblem;
use super::qp::QuadraticProgram;
use crate::contact::bounds;
use crate::model::Model;
use crate::posture::Posture;
use crate::tasks::body::BodyError;
use hierarchical_least_squares::linalg::dot;

/// How to go down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SqpOptions {
    /// Length of what does not hold that one step takes on: on the way to a far goal the body stays where effort is little.
    pub(crate) pace: f64,
    /// Steps at the beginning that use first derivatives only.
    pub(crate) plain: usize,
    /// Largest change of any rate in one step.
    pub(crate) reach: f64,
    /// Steps lengthen where effort bends down.
    pub(crate) longer: bool,
    pub(crate) steps: usize,
    /// It ends when a step is foreseen to gain less than this share of the merit.
    pub(crate) gain: f64,
}

/// Where it came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalMinimum {
    /// Half the sum of squares of the effort level.
    pub(crate) effort: f64,
    /// Sum of sizes of what does not hold.
    pub(crate) violation: f64,
    pub(crate) steps: usize,
    /// It ended for want of gain.
    pub(crate) settled: bool,
}

/// Shift after a step that was taken back, at least.
const LEAST: f64 = 1e-4;
/// No rate changes by more any longer, rad or m.
const STILL: f64 = 1e-10;
/// A corrected step is tried when less of what was foreseen came true, a longer one next when more did.
const AGREES: f64 = 0.7;

/// Posture and forces on their way down. Keeps its space.
#[derive(Clone, Debug)]
pub(crate) struct Sqp {
    pub(crate) at: Iterate,
    next: Iterate,
    hessian: Hessian,
    problem: QuadraticProgram,
    correction: Vec<f64>,
    by_rate: Vec<f64>,
    /// Of the rows of `at`.
    pub(crate) multipliers: Vec<f64>,
}

impl Sqp {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            at: Iterate::new(model),
            next: Iterate::new(model),
            hessian: Hessian::new(model),
            problem: QuadraticProgram::default(),
            correction: vec![],
            by_rate: vec![0.0; model.rates().len()],
            multipliers: vec![],
        }
    }

    /// Goes down from `start` with `forces` and the multipliers of what must hold, if known; the end is in `at`.
    pub(crate) fn go(
        &mut self,
        ask: &EffortProblem<'_>,
        start: &Posture,
        forces: &[f64],
        multipliers: &[f64],
        manner: &SqpOptions,
    ) -> Result<LocalMinimum, BodyError> {
        self.begin(ask, start, forces)?;
        self.multipliers.extend_from_slice(multipliers);
        let (mut shift, mut raise, mut price, mut reach) = (0f64, 2f64, 0f64, manner.reach);
        let mut stretch = 1f64;
        let (mut steps, mut settled, mut little) = (0, false, 0);
        while steps < manner.steps && !settled {
            steps += 1;
            let share = self.share(manner.pace);
            self.problem.unit = self.at.write(share, &mut self.problem);
            if steps > manner.plain {
                self.hessian.bend(
                    ask,
                    &self.at.seen(ask),
                    &self.multipliers,
                    HessianModel::Full,
                    &mut self.problem.matrix,
                );
            }
            self.bound(ask);
            let Some(needed) = self.problem.solve(shift) else { break };
            let rates = ask.free.len();
            let largest = self.problem.step[..rates].iter().fold(0.0, |most: f64, d| most.max(d.abs()));
            let most = self.problem.multipliers.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
            price = (0.7 * price).max(1.5 * most);
            let violation = self.at.violation();
            let slope = dot(&self.problem.slope, &self.problem.step);
            let bend = self.problem.bend();
            let foresee = |length: f64| {
                let held = 1.0 - (1.0 - length * share).abs();
                price * held * violation - length * (slope + 0.5 * length * bend)
            };
            let mut length = (reach / largest).min(1.0);
            if stretch > 1.0 {
                let long = (reach / largest).min(stretch).min(self.problem.room());
                length = if foresee(long) > foresee(length) { long } else { length };
            }
            let foreseen = foresee(length);
            if foreseen <= 0.0 && largest > STILL {
                // What is held was not the right choice: again, with a shorter step and a fresh choice.
                self.problem.forget();
                shift = (raise * needed).max(LEAST);
                raise *= 2.0;
                continue;
            }
            let before = self.at.effort + price * violation;
            let after = self.try_step(ask, length, share, price, (before, foreseen))?;
            let gained = before - after;
            let noise = gained.abs() <= 1e-11 * before;
            let forced = needed > shift;
            let ratio = if foreseen > 0.0 { gained / foreseen } else { -1.0 };
            if ratio > 1e-4 || noise {
                std::mem::swap(&mut self.at, &mut self.next);
                self.multipliers.clone_from(&self.problem.multipliers);
                let agreement = if noise { 1.0 } else { ratio.min(1.5) };
                let factor = (1.0 - (2.0 * agreement - 1.0).powi(3)).clamp(1.0 / 3.0, 3.0);
                shift = if factor > 1.0 { (factor * needed).max(1e-5) } else { factor * needed.min(shift) };
                if shift < 1e-7 {
                    shift = 0.0;
                }
                (raise, reach) = (2.0, (2.0 * reach).min(manner.reach));
                stretch = if manner.longer && forced && ratio > AGREES { 2.0 * length.max(1.0) } else { 1.0 };
            } else if length > 1.0 {
                stretch = 1.0;
            } else {
                shift = (raise * needed).max(LEAST);
                raise *= 2.0;
                reach = 0.5 * length * largest;
            }
            little = if foreseen <= manner.gain * before && share == 1.0 { little + 1 } else { 0 };
            settled = little >= 2 || length * largest <= STILL || (little > 0 && foreseen < 1e-13 * before);
        }
        Ok(LocalMinimum { effort: self.at.effort, violation: self.at.violation(), steps, settled })
    }

    /// Moves `at` from `start` as near to `wish` as what must hold allows to first order.
    pub(crate) fn aside(
        &mut self,
        ask: &EffortProblem<'_>,
        start: &Posture,
        forces: &[f64],
        wish: &[f64],
    ) -> Result<(), BodyError> {
        self.begin(ask, start, forces)?;
        self.at.write(1.0, &mut self.problem);
        let n = self.problem.n;
        self.problem.matrix.fill(0.0);
        self.problem.slope.fill(0.0);
        self.problem.unit = 1.0;
        (0..n).for_each(|i| self.problem.matrix[i * n + i] = 1.0);
        self.problem.slope.iter_mut().zip(wish).for_each(|(slope, wish)| *slope = -wish);
        self.bound(ask);
        if self.problem.solve(0.0).is_some() {
            self.move_next(ask, 1.0);
            std::mem::swap(&mut self.at, &mut self.next);
        }
        Ok(())
    }

    pub(crate) fn begin(&mut self, ask: &EffortProblem<'_>, start: &Posture, forces: &[f64]) -> Result<(), BodyError> {
        self.at.posture.values_mut().copy_from_slice(start.values());
        for site in [&mut self.at, &mut self.next] {
            site.forces.clear();
            site.forces.extend_from_slice(forces);
        }
        self.at.see(ask)?;
        self.problem.n = ask.unknowns();
        self.problem.shifted = ask.free.len();
        self.problem.forget();
        self.multipliers.clear();
        Ok(())
    }

    /// The share of what does not hold that the next step takes on.
    fn share(&self, pace: f64) -> f64 {
        let missing = self.at.lower.iter().zip(&self.at.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
        let length = missing.map(|m| m * m).sum::<f64>().sqrt();
        if length > pace { pace / length } else { 1.0 }
    }

    /// Ranges, and forces that only push.
    fn bound(&mut self, ask: &EffortProblem<'_>) {
        let problem = &mut self.problem;
        problem.least.clear();
        problem.most.clear();
        for &rate in ask.free {
            let range = ask.model.rates()[rate].coordinate.map(|c| {
                let (lower, upper) = ask.model.coordinates()[c].range;
                let value = self.at.posture.values()[c];
                ((lower - value).min(0.0), (upper - value).max(0.0))
            });
            let (lower, upper) = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            problem.least.push(lower);
            problem.most.push(upper);
        }
        for (i, force) in self.at.forces.iter().enumerate() {
            let (lower, upper) = bounds(i);
            problem.least.push((lower - force).min(0.0));
            problem.most.push((upper - force).max(0.0));
        }
    }

    /// Puts `next` where the step leads.
    fn move_next(&mut self, ask: &EffortProblem<'_>, length: f64) {
        self.next.posture.values_mut().copy_from_slice(self.at.posture.values());
        self.next.forces.copy_from_slice(&self.at.forces);
        displace(&mut self.next, ask, &self.problem.step, length, &mut self.by_rate);
    }

    /// The merit after the step, corrected where that helps; `next` is there.
    fn try_step(
        &mut self,
        ask: &EffortProblem<'_>,
        length: f64,
        share: f64,
        price: f64,
        (before, foreseen): (f64, f64),
    ) -> Result<f64, BodyError> {
        self.move_next(ask, length);
        if self.next.see(ask).is_err() {
            return Ok(f64::INFINITY); // so far away that numbers end
        }
        let after = self.next.effort + price * self.next.violation();
        let (at, next, problem) = (&self.at, &self.next, &mut self.problem);
        let left = 1.0 - length * share;
        // What is missing beyond what the step was to leave.
        let bent = |row: usize| {
            let missing = |site: &Iterate| site.lower[row].max(0.0) + site.upper[row].min(0.0);
            missing(next) - left * missing(at)
        };
        let sum: f64 = (0..next.lower.len()).filter(|row| problem.holds(*row)).map(|row| bent(row).abs()).sum();
        if before - after >= AGREES * foreseen || price * sum <= 0.2 * foreseen {
            return Ok(after);
        }
        self.correction.resize(problem.n, 0.0);
        problem.correct(bent, &mut self.correction);
        displace(&mut self.next, ask, &self.correction, 1.0, &mut self.by_rate);
        let seen = self.next.see(ask).is_ok();
        let corrected = if seen { self.next.effort + price * self.next.violation() } else { f64::INFINITY };
        if corrected < after {
            return Ok(corrected);
        }
        if after < before {
            self.move_next(ask, length);
            self.next.see(ask)?;
        }
        Ok(after)
    }
}

/// Moves posture and forces by `length` times the step.
fn displace(site: &mut Iterate, ask: &EffortProblem<'_>, step: &[f64], length: f64, by_rate: &mut [f64]) {
    by_rate.fill(0.0);
    for (rate, d) in ask.free.iter().zip(step) {
        by_rate[*rate] = length * d;
    }
    site.posture.displace(ask.model, by_rate);
    for (force, d) in site.forces.iter_mut().zip(&step[ask.free.len()..]) {
        *force += length * d;
    }
}
