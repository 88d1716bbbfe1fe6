//! Draws random problems of known rank.
//!
//! Every level's rows, seen in the null space of the levels above, have singular values above `CLEAR` or below `NEGLIGIBLE`,
//! nothing between; a draw that does not is thrown away and counted. Two styles:
//! - smooth: new directions from a random orthonormal basis with singular values in 0.1..1, and exact combinations of the
//!   directions of the levels above;
//! - grid: rows of few small integers, right-hand sides of integers, copies and sums of rows: ties and degenerate corners.
//!
//! Rows are drawn near unit length and scaled last; `Draw` keeps both.

use crate::linear::null_space;
use hierarchical_least_squares::{Level, Problem};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Singular values that count are above the first, those that do not below the second.
pub const CLEAR: f64 = 1e-2;
pub const NEGLIGIBLE: f64 = 1e-12;
/// The square root of 1000.
const NEAR_SCALES: f64 = 31.6;

/// `lower <= a x <= upper`, before its scale.
#[derive(Clone, Debug)]
pub struct Row {
    pub a: Vec<f64>,
    pub lower: f64,
    pub upper: f64,
    pub scale: f64,
}

impl Row {
    pub fn equation(&self) -> bool {
        self.lower == self.upper
    }

    pub fn dot(&self, x: &DVector<f64>) -> f64 {
        self.a.iter().zip(x.iter()).map(|(a, x)| a * x).sum()
    }

    /// Signed distance of `value` from the limits.
    pub fn outside(&self, value: f64) -> f64 {
        outside(value, self.lower, self.upper)
    }
}

pub fn outside(value: f64, lower: f64, upper: f64) -> f64 {
    if value > upper {
        value - upper
    } else if value < lower {
        value - lower
    } else {
        0.0
    }
}

/// Scales are log-uniform in 1e-4..1e4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scaling {
    /// One a level.
    ByLevel,
    /// One a row, within a factor of 1000 in a level.
    Near,
    /// One a row.
    ByRow,
}

#[derive(Clone, Debug)]
pub struct Draw {
    pub n: usize,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    pub levels: Vec<Vec<Row>>,
    /// Some levels may be impossible; otherwise every residual can be zero.
    pub conflicting: bool,
    pub scaling: Scaling,
}

impl Draw {
    pub fn problem(&self) -> Problem {
        let mut problem = Problem::new(self.n);
        problem.lower.clone_from(&self.lower);
        problem.upper.clone_from(&self.upper);
        for rows in &self.levels {
            let mut level = empty_level();
            for row in rows {
                let a: Vec<f64> = row.a.iter().map(|a| a * row.scale).collect();
                level.push(&a, row.lower * row.scale, row.upper * row.scale);
            }
            problem.levels.push(level);
        }
        problem
    }

    pub fn scales(&self) -> Vec<Vec<f64>> {
        self.levels.iter().map(|rows| rows.iter().map(|row| row.scale).collect()).collect()
    }

    pub fn describe(&self) -> String {
        let levels: Vec<String> = self
            .levels
            .iter()
            .map(|rows| format!("{}({}=)", rows.len(), rows.iter().filter(|r| r.equation()).count()))
            .collect();
        let zeros = self.levels.iter().flatten().filter(|row| row.a.iter().all(|a| *a == 0.0)).count();
        let bounds = self.lower.iter().chain(&self.upper).filter(|b| b.is_finite()).count();
        format!(
            "n {}, rows by level {}, {zeros} rows of zeros, {bounds} bounds, {}, {:?}",
            self.n,
            levels.join(" "),
            if self.conflicting { "conflicting" } else { "consistent" },
            self.scaling
        )
    }
}

pub fn empty_level() -> Level {
    Level { matrix: vec![], lower: vec![], upper: vec![], damping: 0.0, hard: false }
}

/// Kinds of rows that a draw may contain.
#[derive(Clone, Copy, Debug)]
pub struct DrawOptions {
    pub conflicting: bool,
    pub scaling: Scaling,
    pub bounds: bool,
    pub inequalities: bool,
    pub largest: usize,
}

/// The generator of problem `index`: any problem can be drawn again without those before it.
pub fn random(seed: u64, index: usize) -> Pcg64 {
    Pcg64::seed_from_u64(seed ^ (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// A problem, and how many draws were thrown away before it.
pub fn draw(rng: &mut Pcg64, options: DrawOptions) -> (Draw, usize) {
    let mut thrown = 0;
    loop {
        let draw = attempt(rng, options);
        if is_clear(&draw) {
            return (draw, thrown);
        }
        thrown += 1;
    }
}

fn attempt(rng: &mut Pcg64, options: DrawOptions) -> Draw {
    let n = log_integer(rng, 2, options.largest);
    let grid = rng.random_bool(0.25);
    let count = rng.random_range(1..=6);
    let matrices = if grid { grid_rows(rng, n, count) } else { smooth_rows(rng, n, count) };
    // Everything holds at this point, unless it is to conflict.
    let x = DVector::from_fn(n, |_, _| if grid { integer(rng, 2) } else { rng.random_range(-1.0..1.0) });
    let (mut lower, mut upper) = (vec![f64::NEG_INFINITY; n], vec![f64::INFINITY; n]);
    for i in (0..n).filter(|_| options.bounds) {
        let kind = rng.random_range(0..20);
        if kind == 0 {
            (lower[i], upper[i]) = (x[i], x[i]);
        }
        if (1..10).contains(&kind) {
            lower[i] = x[i] - slack(rng, grid);
        }
        if (5..15).contains(&kind) {
            upper[i] = x[i] + slack(rng, grid);
        }
    }
    let must = rng.random_range(0..count);
    let mut levels = vec![];
    for (k, matrix) in matrices.iter().enumerate() {
        let conflict = options.conflicting && (k == must || rng.random_bool(0.6));
        let mode = if options.inequalities { rng.random_range(0..4) } else { 0 };
        let middle = match options.scaling {
            Scaling::Near => log_uniform(rng, 1e-4 * NEAR_SCALES, 1e4 / NEAR_SCALES),
            _ => log_uniform(rng, 1e-4, 1e4),
        };
        let rows = matrix.row_iter().map(|a| {
            let mut target = (a * &x)[0];
            if conflict {
                target += if grid { integer(rng, 2) } else { normal(rng) };
            }
            let kind = match mode {
                0 => 0,
                1 => rng.random_range(1..4),
                _ => rng.random_range(0..4),
            };
            let (lower, upper) = match kind {
                0 => (target, target),
                1 => (f64::NEG_INFINITY, target + slack(rng, grid)),
                2 => (target - slack(rng, grid), f64::INFINITY),
                _ => (target - slack(rng, grid), target + slack(rng, grid)),
            };
            let scale = match options.scaling {
                Scaling::ByLevel => middle,
                Scaling::Near => middle * log_uniform(rng, 1.0 / NEAR_SCALES, NEAR_SCALES),
                Scaling::ByRow => log_uniform(rng, 1e-4, 1e4),
            };
            Row { a: a.iter().copied().collect(), lower, upper, scale }
        });
        levels.push(rows.collect());
    }
    Draw { n, lower, upper, levels, conflicting: options.conflicting, scaling: options.scaling }
}

/// Distance to one limit; often zero, so that the row is just satisfied.
fn slack(rng: &mut Pcg64, grid: bool) -> f64 {
    match (rng.random_bool(0.3), grid) {
        (true, _) => 0.0,
        (false, true) => f64::from(rng.random_range(1..3)),
        (false, false) => rng.random_range(0.0..1.0),
    }
}

fn smooth_rows(rng: &mut Pcg64, n: usize, levels: usize) -> Vec<DMatrix<f64>> {
    let basis = orthonormal(rng, n);
    let mut used = 0;
    let mut all: Vec<DMatrix<f64>> = vec![];
    for _ in 0..levels {
        let rows = log_integer(rng, 1, n + 2);
        let most = rows.min(n - used);
        let new = if rng.random_bool(0.5) { most } else { rng.random_range(0..=most) };
        let most = (rows - new).min(used);
        let old = if most == 0 { 0 } else { rng.random_range(0..=most) };
        // Directions: old ones within the span of those above, new ones with a part in it.
        let above = basis.columns(0, used);
        let mut directions = DMatrix::zeros(n, old + new);
        if old > 0 {
            directions.columns_mut(0, old).copy_from(&(above * orthonormal(rng, used).columns(0, old)));
        }
        let lean = 0.5 / (used.max(1) as f64).sqrt();
        let mix = DMatrix::from_fn(used, new, |_, _| lean * normal(rng));
        directions.columns_mut(old, new).copy_from(&(basis.columns(used, new) + above * mix));
        for mut direction in directions.column_iter_mut() {
            direction *= rng.random_range(0.1..1.0);
        }
        let mut matrix = orthonormal(rng, rows).columns(0, old + new) * directions.transpose();
        if rng.random_bool(0.1) {
            let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let (to, from) = (rng.random_range(0..rows), rng.random_range(0..rows));
            let copy = match all.last() {
                Some(above) if rng.random_bool(0.5) => above.row(from % above.nrows()) * sign,
                _ => matrix.row(from) * sign,
            };
            matrix.row_mut(to).copy_from(&copy);
        }
        used += new;
        all.push(matrix);
    }
    all
}

fn grid_rows(rng: &mut Pcg64, n: usize, levels: usize) -> Vec<DMatrix<f64>> {
    let mut all: Vec<DMatrix<f64>> = vec![];
    for _ in 0..levels {
        let rows = log_integer(rng, 1, n + 2);
        let mut matrix = DMatrix::zeros(rows, n);
        for i in 0..rows {
            if i > 1 && rng.random_bool(0.15) {
                let sum = matrix.row(rng.random_range(0..i)) - matrix.row(rng.random_range(0..i));
                matrix.row_mut(i).copy_from(&sum);
            } else if rng.random_bool(0.1) && !all.is_empty() {
                let above = &all[rng.random_range(0..all.len())];
                let copy = -above.row(rng.random_range(0..above.nrows()));
                matrix.row_mut(i).copy_from(&copy);
            } else {
                for _ in 0..rng.random_range(1..=3) {
                    matrix[(i, rng.random_range(0..n))] = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                }
            }
        }
        all.push(matrix);
    }
    all
}

/// True where the rank of every level, in the null space of the levels above, is clear.
fn is_clear(draw: &Draw) -> bool {
    let mut free = DMatrix::identity(draw.n, draw.n);
    for rows in &draw.levels {
        match null_space(&matrix_of(draw.n, rows.iter()), &free, CLEAR, NEGLIGIBLE) {
            Some(next) => free = next,
            None => return false,
        }
    }
    true
}

pub fn matrix_of<'a>(n: usize, rows: impl Iterator<Item = &'a Row>) -> DMatrix<f64> {
    let rows: Vec<&Row> = rows.collect();
    DMatrix::from_fn(rows.len(), n, |i, j| rows[i].a[j])
}

pub fn orthonormal(rng: &mut Pcg64, n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |_, _| normal(rng)).qr().q()
}

/// Small integers `-most..=most`.
fn integer(rng: &mut Pcg64, most: i32) -> f64 {
    f64::from(rng.random_range(-most..=most))
}

pub fn normal(rng: &mut Pcg64) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - rng.random::<f64>())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * rng.random::<f64>())
}

pub fn log_uniform(rng: &mut Pcg64, from: f64, to: f64) -> f64 {
    libm::exp(rng.random_range(libm::log(from)..libm::log(to)))
}

/// Whole numbers of `from..=to`, the small ones more often.
pub fn log_integer(rng: &mut Pcg64, from: usize, to: usize) -> usize {
    (log_uniform(rng, from as f64, to as f64 + 1.0) as usize).clamp(from, to)
}
