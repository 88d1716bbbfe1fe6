//! Finds how much the answer of a population depends on each parameter of its bodies: the regression on ranks of their times, or of their loads
//! where too many times are equal.

use super::part::Study;
use super::rank_regression::{RankCoefficient, RankRegression};

/// Fewest bodies for a regression.
pub const LEAST_FOR_SENSITIVITY: usize = 40;
/// Names of the parameters in words, in the order of the plan; sex, which stands last in it, comes first here.
pub const PARAMETERS: [&str; 5] =
    ["sex", "stature", "mass for that stature", "strength", "stiffness of passive tissue"];
/// Ceiling of the regression on times below which that on loads is taken, since too many times are equal. Assumed.
const LEAST_CEILING: f64 = 0.3;

/// The shares of the parameters in the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The answer is the load of the hardest worked group, since too many bodies have the same time; else it is the time, at most the asked one.
    pub of_load: bool,
    /// Number of judged bodies that are left out, since their load is not known.
    pub left_out: usize,
    /// Those of [`PARAMETERS`] that differ between these bodies.
    pub parameters: Vec<&'static str>,
    /// One coefficient for each of them.
    pub regression: RankRegression,
}

/// The reason for which no shares are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSensitivity {
    /// Fewer bodies than [`LEAST_FOR_SENSITIVITY`] could be judged.
    TooFew,
    /// All bodies have the same time and the same load.
    SameAnswers,
    /// The times give no regression, and the loads are not known or give none.
    NotKnown,
}

/// A body that was judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    /// Number of the row.
    pub(crate) row: usize,
    /// Time, at most the asked one.
    pub(crate) minutes: f64,
    /// Load of the hardest worked group.
    pub(crate) load: Option<f64>,
}

impl Sensitivity {
    /// Of the times of bodies, or of their loads where too many times are equal.
    pub(crate) fn new(study: &Study, bodies: &[Body], seed: u32) -> Result<Self, NoSensitivity> {
        let times: Vec<(usize, f64)> = bodies.iter().map(|body| (body.row, body.minutes)).collect();
        let of_times = Self::of(study, &times, seed);
        match &of_times {
            Err(NoSensitivity::TooFew) => return of_times,
            Ok(found) if found.regression.ceiling >= LEAST_CEILING => return of_times,
            _ => {}
        }
        let loads: Vec<(usize, f64)> = bodies.iter().filter_map(|body| Some((body.row, body.load?))).collect();
        match (of_times, Self::of(study, &loads, seed)) {
            (_, Ok(found)) => Ok(Self { of_load: true, left_out: bodies.len() - loads.len(), ..found }),
            (Ok(found), Err(_)) => Ok(found),
            (Err(NoSensitivity::SameAnswers), Err(NoSensitivity::SameAnswers)) => Err(NoSensitivity::SameAnswers),
            (Err(_), Err(_)) => Err(NoSensitivity::NotKnown),
        }
    }

    /// Of the answers of rows; parameters that do not differ between these rows are left out.
    fn of(study: &Study, answers: &[(usize, f64)], seed: u32) -> Result<Self, NoSensitivity> {
        if answers.len() < LEAST_FOR_SENSITIVITY {
            return Err(NoSensitivity::TooFew);
        }
        let values: Vec<f64> = answers.iter().map(|(_, value)| *value).collect();
        if is_constant(&values) {
            return Err(NoSensitivity::SameAnswers);
        }
        let mut lists = vec![vec![]; PARAMETERS.len()];
        for (row, _) in answers {
            lists[0].push(study.plan_of(*row) as f64);
            lists[1..].iter_mut().zip(study.point(*row)).for_each(|(list, value)| list.push(value));
        }
        let differ = PARAMETERS.into_iter().zip(lists).filter(|(_, list)| !is_constant(list));
        let (parameters, lists): (Vec<_>, Vec<_>) = differ.unzip();
        let regression = RankRegression::new(&values, &lists, seed).ok_or(NoSensitivity::NotKnown)?;
        Ok(Self { of_load: false, left_out: 0, parameters, regression })
    }

    /// Names and coefficients of the parameters, the greatest share first.
    pub fn sorted(&self) -> Vec<(&'static str, RankCoefficient)> {
        let coefficients = self.regression.coefficients.iter().copied();
        let mut all: Vec<_> = self.parameters.iter().copied().zip(coefficients).collect();
        all.sort_by(|a, b| b.1.share().total_cmp(&a.1.share()));
        all
    }
}

fn is_constant(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] == pair[1])
}
