//! Chooses the values of every row of a plan by its design.
//!
//! A design gives every row a point of the unit cube. Correlated parameters have normal scores `z = quantile(u)`, mixed by the
//! Cholesky factor of their correlation (a Gaussian copula), and their points are those of the mixed scores.

use contrapposto::math::normal::{cumulative, quantile};
use contrapposto_formats::{Design, Distribution, Parameter, Plan, Value};

use super::random::{permutation, uniform};
use super::sobol::{shifted_sobol, sobol};

/// Streams of the places within strata lie behind those of the permutations.
const WITHIN_STRATA: usize = 1 << 20;
/// Streams of the shifts of a Sobol sequence lie behind those.
const SHIFTS: usize = 2 << 20;
/// Nearest a probability comes to 0 and 1, so that every quantile is finite.
const LEAST_PROBABILITY: f64 = 1e-15;

/// The rows of a plan.
#[derive(Clone, Debug)]
pub struct Sampler {
    plan: Plan,
    /// Of a Latin hypercube, the stratum of every row, by parameter.
    strata: Vec<Vec<u32>>,
}

impl Sampler {
    /// The rows of the plan.
    pub fn new(plan: &Plan) -> Self {
        let strata = match plan.design {
            Design::LatinHypercube => {
                (0..plan.parameters.len()).map(|parameter| permutation(plan.seed, parameter, plan.rows)).collect()
            }
            _ => vec![],
        };
        Self { plan: plan.clone(), strata }
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Whether the rows do not depend on their number, so that those behind the last one of the plan have values, too.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self.plan.design, Design::Sobol | Design::ShiftedSobol | Design::Random)
    }

    /// Independent points of the unit interval, one for each parameter, before correlation.
    pub fn point(&self, row: usize) -> Vec<f64> {
        let Plan { seed, rows, design, .. } = self.plan;
        let place = |parameter: usize| match design {
            Design::Sobol => sobol(row as u32 + 1, parameter),
            Design::ShiftedSobol => shifted_sobol(row as u32, parameter, uniform(seed, SHIFTS + parameter, 0)),
            Design::Random => uniform(seed, parameter, row),
            Design::LatinHypercube => {
                let within = uniform(seed, WITHIN_STRATA + parameter, row);
                (f64::from(self.strata[parameter][row]) + within) / rows as f64
            }
            Design::Grid => {
                let (level, levels) = self.level(row, parameter);
                (level as f64 + 0.5) / levels as f64
            }
        };
        (0..self.plan.parameters.len()).map(place).collect()
    }

    /// The values of a row, one for each parameter.
    pub fn values(&self, row: usize) -> Vec<Value> {
        let parameters = self.plan.parameters.iter().enumerate();
        if self.plan.design == Design::Grid {
            return parameters.map(|(i, parameter)| grid_value(parameter, self.level(row, i))).collect();
        }
        let point = self.point(row);
        let scores: Vec<f64> = match &self.plan.mixing {
            Some(mixing) => {
                let scores: Vec<f64> = point.iter().map(|u| quantile(clipped(*u))).collect();
                mixing.iter().map(|row| row.iter().zip(&scores).map(|(weight, score)| weight * score).sum()).collect()
            }
            None => vec![],
        };
        parameters.map(|(i, parameter)| value(parameter, point[i], scores.get(i).copied())).collect()
    }

    /// The level of a parameter in a row of a grid, and the number of its levels; the last parameter changes first.
    fn level(&self, row: usize, parameter: usize) -> (usize, usize) {
        let parameters = &self.plan.parameters;
        let after: usize = parameters[parameter + 1..].iter().map(|parameter| parameter.levels).product();
        let levels = parameters[parameter].levels;
        (row / after % levels, levels)
    }
}

fn clipped(probability: f64) -> f64 {
    probability.clamp(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
}

/// The value at a point of the unit interval, or at a normal score where the parameter has one.
fn value(parameter: &Parameter, point: f64, score: Option<f64>) -> Value {
    let normal = || score.unwrap_or_else(|| quantile(clipped(point)));
    let point = || score.map_or(point, cumulative);
    // The score where the distribution is cut off, and the value at a score.
    let cut_off = |score_of: &dyn Fn(f64) -> f64, value_of: &dyn Fn(f64) -> f64| match parameter.within {
        Some([low, high]) => value_of(truncated(point(), [low, high].map(score_of))).clamp(low, high),
        None => value_of(normal()),
    };
    match &parameter.distribution {
        Distribution::Normal { mean, deviation } => {
            Value::Number(cut_off(&|value| (value - mean) / deviation, &|score| mean + deviation * score))
        }
        Distribution::Lognormal { median, deviation } => {
            Value::Number(cut_off(&|value| libm::log((value / median).max(0.0)) / deviation, &|score| {
                median * libm::exp(deviation * score)
            }))
        }
        Distribution::Range { low, high } => Value::Number((low * (1.0 - point()) + high * point()).clamp(*low, *high)),
        Distribution::List(list) => {
            let place = (point() * list.len() as f64) as usize;
            list.get(place.min(list.len().saturating_sub(1))).cloned().unwrap_or(Value::Number(f64::NAN))
        }
    }
}

/// The normal score at a point of the unit interval, of the part of a normal distribution between two scores.
fn truncated(point: f64, ends: [f64; 2]) -> f64 {
    let [low, high] = ends.map(cumulative);
    quantile(clipped(low * (1.0 - point) + high * point))
}

/// The value of a level: of a range both ends are values, of a distribution the levels are equally likely.
fn grid_value(parameter: &Parameter, (level, levels): (usize, usize)) -> Value {
    match &parameter.distribution {
        Distribution::Range { low, high } if levels > 1 => {
            let share = level as f64 / (levels - 1) as f64;
            Value::Number(low * (1.0 - share) + high * share)
        }
        _ => value(parameter, (level as f64 + 0.5) / levels as f64, None),
    }
}
