//! Computes how much an answer hangs on each of several parameters: standardised coefficients of the regression on ranks (SRRC; Saltelli,
//! Chan & Scott 2000, Sensitivity Analysis, recalled).
//!
//! Answer and parameters are replaced by their ranks, equal values by the mean of theirs, and each is scaled to variance 1. Of independent
//! parameters the squares of the coefficients add up to R^2, the share of the variance of the ranks that the regression explains. An answer
//! that first rises and then falls with a parameter, or in which parameters work only together, is not explained: a small R^2 says so.
//!
//! Equal answers lower R^2, too: of n answers with groups of t equal ones a parameter without equal values, from which the answer follows
//! without ever falling (or rising), has R^2 = 1 - sum(t^3 - t) / (n^3 - n), the `ceiling`.

use nalgebra::{DMatrix, DVector};

use super::random::uniform;

/// Draws of rows for the intervals of the coefficients.
const DRAWS: usize = 400;
/// Ends of these intervals, as shares of the draws.
const ENDS: [f64; 2] = [0.025, 0.975];
/// Sum of squares about the mean below which a column has one value: two ranks differ by a half at least.
const LEAST_SQUARES: f64 = 0.1;
/// Streams of the draws lie behind those of samplers.
const DRAWN: usize = 3 << 20;

/// A regression on ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct RankRegression {
    /// Share of the variance of the ranks of the answer that is explained, 0 to 1.
    pub explained: f64,
    /// Greatest share that one parameter without equal values can explain, above 0 to 1: less than 1 where answers are equal. A parameter with
    /// equal values, and several together, can explain more.
    pub ceiling: f64,
    /// Of each parameter.
    pub coefficients: Vec<RankCoefficient>,
}

/// The standardised coefficient of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankCoefficient {
    /// -1 to 1; above 0 where the answer rises with the parameter.
    pub value: f64,
    /// 95 % interval, from rows that are drawn anew, with their ranks.
    pub interval: [f64; 2],
}

impl RankCoefficient {
    /// Share of the variance of the ranks of the answer.
    pub fn share(&self) -> f64 {
        self.value * self.value
    }

    /// Ends of the interval of the share.
    pub fn share_interval(&self) -> [f64; 2] {
        let [low, high] = self.interval.map(|end| end * end);
        if self.interval[0] * self.interval[1] <= 0.0 { [0.0, low.max(high)] } else { [low.min(high), low.max(high)] }
    }
}

impl RankRegression {
    /// The explained share as one of the ceiling, at most 1.
    pub fn of_ceiling(&self) -> f64 {
        (self.explained / self.ceiling).min(1.0)
    }

    /// Of answers on parameters, one list for each. `None` where the answer or a parameter has one value only, parameters follow from each
    /// other, or lists have different lengths.
    pub fn new(answers: &[f64], parameters: &[Vec<f64>], seed: u32) -> Option<Self> {
        let n = answers.len();
        if parameters.is_empty() || parameters.iter().any(|parameter| parameter.len() != n) {
            return None;
        }
        let columns: Vec<Vec<f64>> = parameters.iter().map(Vec::as_slice).chain([answers]).map(ranks).collect();
        let (value, explained) = solved(&columns, 0..n)?;
        let ceiling = columns.last().map_or(1.0, |ranks| ceiling(ranks));
        let mut drawn: Vec<Vec<f64>> = vec![vec![]; parameters.len()];
        for draw in 0..DRAWS {
            let row = |place: usize| (uniform(seed, DRAWN + draw, place) * n as f64) as usize;
            // A draw in which a column has one value says nothing.
            let Some((values, _)) = solved(&columns, (0..n).map(|place| row(place).min(n - 1))) else { continue };
            drawn.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
        }
        let coefficients = value.into_iter().zip(drawn).map(|(value, mut drawn)| {
            drawn.sort_by(f64::total_cmp);
            let end = |share: f64| drawn.get((share * drawn.len() as f64) as usize).copied().unwrap_or(value);
            RankCoefficient { value, interval: ENDS.map(end) }
        });
        Some(Self { explained, ceiling, coefficients: coefficients.collect() })
    }
}

/// Ranks of values, from 1; equal ones have the mean of their ranks.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let mean = first as f64 + f64::midpoint(1.0, equal.len() as f64);
        equal.iter().for_each(|place| ranks[*place] = mean);
        first += equal.len();
    }
    ranks
}

/// Variance of ranks over that of as many ranks without equal ones, (n^2 - 1) / 12.
fn ceiling(ranks: &[f64]) -> f64 {
    let n = ranks.len() as f64;
    let middle = f64::midpoint(1.0, n);
    let squares: f64 = ranks.iter().map(|rank| (rank - middle).powi(2)).sum();
    (12.0 * squares / (n * (n * n - 1.0))).min(1.0)
}

/// Coefficients of the regression of the last column on the others in these rows, and R^2; `None` where there is none.
fn solved(columns: &[Vec<f64>], rows: impl Iterator<Item = usize>) -> Option<(Vec<f64>, f64)> {
    let (size, n) = (columns.len(), columns.first()?.len());
    // Ranks lie about their mean, so that sums of products keep their digits.
    let middle = f64::midpoint(1.0, n as f64);
    let (mut sums, mut products, mut count) = (DVector::zeros(size), DMatrix::zeros(size, size), 0.0);
    let mut row = DVector::zeros(size);
    for place in rows {
        row.iter_mut().zip(columns).for_each(|(cell, column)| *cell = column[place] - middle);
        sums += &row;
        products.ger(1.0, &row, &row, 1.0);
        count += 1.0;
    }
    let covariance: DMatrix<f64> = products - &sums * sums.transpose() / count;
    if covariance.diagonal().iter().any(|sum| *sum < LEAST_SQUARES) {
        return None;
    }
    let scale: DVector<f64> = covariance.diagonal().map(f64::sqrt);
    let correlation = covariance.component_div(&(&scale * scale.transpose()));
    let last = size - 1;
    let with_answer = correlation.view((0, last), (last, 1)).into_owned();
    let solution = correlation.view((0, 0), (last, last)).into_owned().cholesky()?.solve(&with_answer);
    let explained = solution.dot(&with_answer).clamp(0.0, 1.0);
    Some((solution.iter().copied().collect(), explained))
}
