//! Computes the optimality conditions (Karush, Kuhn & Tucker) of every level, and the residuals that follow from the working
//! set of an answer, both in numbers of 32 digits.

use crate::double_double::{Double, dot, inner};
use crate::generator::{Draw, Row, outside};
use hierarchical_least_squares::{Problem, Solver};
use rand::RngExt;
use rand_pcg::Pcg64;

/// A residual above this, in rows of scale one, counts; below, the row counts as satisfied.
pub const RESIDUAL: f64 = 1e-9;

/// As [`RESIDUAL`], for a level with these scales: the heaviest rows keep residuals as much smaller than those of the
/// lightest as the squares of their scales say.
pub fn residual_of(scales: impl Iterator<Item = f64> + Clone) -> f64 {
    let (least, most) = (scales.clone().fold(f64::INFINITY, f64::min), scales.fold(0.0, f64::max));
    (RESIDUAL * (least / most).powi(2)).max(INVISIBLE_RESIDUAL)
}

/// A residual below this, in rows of scale one, is rounding.
const INVISIBLE_RESIDUAL: f64 = 1e-13;

/// As [`residual_of`], for problems with damped levels.
const DAMPED_RESIDUAL: f64 = 1e-12;

/// A multiplier below this, in rows of scale one, counts as zero.
const ZERO_MULTIPLIER: f64 = 1e-13;
/// A multiplier above this, relative to the square of the level's least scale and to the residual of the level, fixes its limit
/// for all levels below: leaving the limit would cost the level something, so that the multiplier at levels below may have
/// either sign (the multipliers of one limit are positive in the lexicographic sense).
const FIXING_MULTIPLIER: f64 = 1e-8;

/// The least multiplier with which a level fixes limits, in rows of these scales: multipliers are in proportion to the residual
/// of the level, rounding is not.
fn fixing_multiplier(residuals: &[f64], scales: impl Iterator<Item = f64> + Clone) -> f64 {
    let kept = residuals.iter().zip(scales.clone()).map(|(r, scale)| r.abs() / scale).fold(0.0, f64::max);
    FIXING_MULTIPLIER * kept.clamp(1e-6, 1.0) * scales.fold(f64::INFINITY, f64::min).powi(2)
}

/// Number of times the last digits are changed.
const PERTURBATIONS: usize = 5;

/// Solution, residuals and multipliers of a solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    pub x: Vec<f64>,
    pub residuals: Vec<Vec<f64>>,
    /// By level: of bounds, of the rows of all levels above.
    pub multipliers: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Answer {
    pub fn of(solver: &Solver, levels: usize) -> Self {
        let multipliers = |k| {
            let m = solver.multipliers(k);
            (m.bounds.to_vec(), m.rows.to_vec())
        };
        Self {
            x: solver.solution().to_vec(),
            residuals: (0..levels).map(|k| solver.residual(k).to_vec()).collect(),
            multipliers: (0..levels).map(multipliers).collect(),
        }
    }
}

/// `a x` of every row of a level.
pub fn products(problem: &Problem, k: usize, x: &[f64]) -> Vec<Double> {
    let n = x.len();
    if n == 0 {
        return vec![Double::ZERO; problem.levels[k].rows()];
    }
    problem.levels[k].matrix.chunks(n).map(|a| dot(a, x)).collect()
}

/// The residual of a row whose `a x` is `value`.
pub fn residual(value: Double, lower: f64, upper: f64) -> Double {
    let (above, below) = (value - Double::from(upper), value - Double::from(lower));
    if upper.is_finite() && above.value() > 0.0 {
        above
    } else if lower.is_finite() && below.value() < 0.0 {
        below
    } else {
        Double::ZERO
    }
}

/// The largest violations of the conditions; all should be rounding.
#[derive(Clone, Copy, Debug, Default)]
pub struct Violations {
    /// Reported residuals against those recomputed.
    pub residual: f64,
    /// Unknowns outside their bounds.
    pub bounds: f64,
    /// Gradient of the Lagrangian.
    pub stationarity: f64,
    /// Multipliers of inactive limits, or of the wrong sign.
    pub sign: f64,
}

impl Violations {
    pub fn largest(&mut self, other: &Self) {
        self.residual = self.residual.max(other.residual);
        self.bounds = self.bounds.max(other.bounds);
        self.stationarity = self.stationarity.max(other.stationarity);
        self.sign = self.sign.max(other.sign);
    }

    pub fn are_rounding(&self) -> bool {
        self.residual < 1e-13 && self.bounds == 0.0 && self.stationarity < 1e-11 && self.sign < 1e-11
    }
}

/// Violations by an answer of the conditions of all levels; of damped levels only those of the last, as those above are
/// done somewhere else. Gradients are relative to the square of the level's largest scale.
pub fn violations(problem: &Problem, scales: &[Vec<f64>], answer: &Answer) -> Violations {
    let (n, x) = (problem.unknowns(), &answer.x);
    let mut violations = Violations::default();
    for ((&x, &lower), &upper) in x.iter().zip(&problem.lower).zip(&problem.upper) {
        let outside = if x.is_finite() { outside(x, lower, upper).abs() } else { f64::INFINITY };
        violations.bounds = violations.bounds.max(outside);
    }
    let mut values: Vec<Vec<Double>> = vec![];
    // Damped levels have residuals in proportion to their damping, and cause residuals of that size in other levels.
    let damped = problem.levels.iter().any(|level| level.damping > 0.0);
    let smallest = |level: &Vec<f64>| if damped { DAMPED_RESIDUAL } else { residual_of(level.iter().copied()) };
    let smallest: Vec<f64> = scales.iter().map(smallest).collect();
    // In levels of such scales a heavy row at its limit may have a residual below rounding: either sign is right there.
    let mut invisible = vec![];
    let mut fixed: Vec<Vec<bool>> = scales.iter().map(|level| vec![false; level.len()]).collect();
    let mut fixed_bounds = vec![false; n];
    for (k, level) in problem.levels.iter().enumerate() {
        let (products, scale) = (products(problem, k, x), scales[k].iter().copied().fold(0.0, f64::max));
        let fixing_multiplier = fixing_multiplier(&answer.residuals[k], scales[k].iter().copied());
        let (mut sum, mut size) = (vec![Double::ZERO; n], vec![0.0; n]);
        // The change of the sum by the last digit of `x`: no answer in doubles is nearer.
        let mut blur = vec![0.0; n];
        let mut add = |a: &[f64], factor: Double| {
            for (j, a) in a.iter().enumerate() {
                let product = Double::from(*a) * factor;
                sum[j] += product;
                size[j] += product.value().abs();
            }
        };
        for (i, a) in level.matrix.chunks(n.max(1)).enumerate() {
            let (lower, upper) = (level.lower[i], level.upper[i]);
            let residual = residual(products[i], lower, upper);
            add(a, residual);
            let size: f64 = a.iter().zip(x).map(|(a, x)| (a * x).abs()).sum();
            let side = [lower, upper].into_iter().filter(|s| s.is_finite()).fold(0.0, |m: f64, s| m.max(s.abs()));
            for (blur, a) in blur.iter_mut().zip(a) {
                *blur += 0.5 * f64::EPSILON * size * a.abs();
            }
            let miss = (answer.residuals[k][i] - residual.value()).abs() / (size + side).max(f64::MIN_POSITIVE);
            violations.residual = violations.residual.max(miss);
        }
        let keeps = answer.residuals[k].iter().zip(&scales[k]).any(|(r, scale)| r.abs() > smallest[k] * scale);
        invisible.push(keeps && residual_of(scales[k].iter().copied()) == INVISIBLE_RESIDUAL);
        values.push(products);
        if level.damping > 0.0 && k + 1 < problem.levels.len() {
            continue;
        }
        let (bounds, rows) = &answer.multipliers[k];
        let above = problem.levels[..k].iter().enumerate();
        let above = above.flat_map(|(j, level)| (0..level.rows()).map(move |i| (j, i, level)));
        assert_eq!(above.clone().count(), rows.len(), "a multiplier for every row above");
        let mut signs = vec![];
        for ((j, i, level), &factor) in above.zip(rows) {
            add(&level.matrix[i * n..(i + 1) * n], Double::from(factor));
            let (lower, upper, scale) = (level.lower[i], level.upper[i], scales[j][i]);
            let free = residual(values[j][i], lower, upper).value().abs() > smallest[j] * scale;
            if !free && lower != upper && !fixed[j][i] {
                let off = |side: f64| {
                    let off = (values[j][i] - Double::from(side)).value().abs();
                    off.is_nan() || off > RESIDUAL * (scale + side.abs())
                };
                let (side, other) = if factor > 0.0 { (upper, lower) } else { (lower, upper) };
                if off(side) && (off(other) || !invisible[j]) {
                    signs.push(factor.abs() * scale);
                } else {
                    fixed[j][i] = factor.abs() * scale > fixing_multiplier;
                }
            }
        }
        for (j, &factor) in bounds.iter().enumerate() {
            let side = if factor > 0.0 { problem.upper[j] } else { problem.lower[j] };
            if problem.lower[j] != problem.upper[j] && !fixed_bounds[j] {
                if x[j] == side {
                    fixed_bounds[j] = factor.abs() > fixing_multiplier;
                } else {
                    signs.push(factor.abs());
                }
            }
        }
        for (j, factor) in bounds.iter().enumerate() {
            let pull = Double::product(level.damping, level.damping) * Double::from(x[j]);
            sum[j] += Double::from(*factor) + pull;
            size[j] += factor.abs() + pull.value().abs();
        }
        // Relative to the sum of absolute values, but to no less than a residual of one.
        let size = scale * scale + size.iter().copied().fold(0.0, f64::max);
        let off = sum.iter().zip(&blur).map(|(sum, blur)| sum.value().abs() - blur);
        let stationarity = off.fold(0.0, f64::max) / size.max(f64::MIN_POSITIVE);
        let sign = signs.iter().copied().fold(0.0, f64::max) / size.max(f64::MIN_POSITIVE);
        violations.stationarity = violations.stationarity.max(stationarity);
        violations.sign = violations.sign.max(sign);
    }
    violations
}

/// An active row `a x = value`.
struct Active<'a> {
    a: &'a [f64],
    value: Double,
    multiplier: f64,
    inequality: bool,
}

/// The residuals (of rows before scaling) that follow from the working set of the answer. With the right signs of the
/// multipliers they are optimal, whatever `x` is.
pub fn reference(draw: &Draw, answer: &Answer) -> Result<Vec<Vec<f64>>, String> {
    let n = draw.n;
    let units: Vec<Vec<f64>> = (0..n).map(|j| (0..n).map(|i| if i == j { 1.0 } else { 0.0 }).collect()).collect();
    let mut known: Vec<Vec<Double>> = vec![];
    // The limit at which an inequality is fixed: 1 upper, -1 lower, 0 none.
    let mut fixed_sides: Vec<f64> = vec![];
    let mut fixed_bound_sides = vec![0.0; n];
    for (k, rows) in draw.levels.iter().enumerate() {
        let largest = rows.iter().map(|row| row.scale).fold(0.0, f64::max);
        let fixing_multiplier =
            fixing_multiplier(&answer.residuals[k], rows.iter().map(|row| row.scale)) / (largest * largest);
        let (bounds, factors) = &answer.multipliers[k];
        let scales = draw.levels[..k].iter().flatten().map(|row| row.scale);
        let all = factors.iter().zip(scales).map(|(factor, scale)| factor * scale).chain(bounds.iter().copied());
        let zero_multiplier =
            ZERO_MULTIPLIER * all.fold(1.0, |most: f64, factor| most.max(factor.abs() / (largest * largest)));
        let mut held = vec![];
        for (j, a) in units.iter().enumerate() {
            let multiplier = bounds[j] / (largest * largest);
            let fixed = draw.lower[j] == draw.upper[j];
            if fixed || multiplier.abs() > zero_multiplier {
                let inequality = !fixed && fixed_bound_sides[j] == 0.0;
                let upper = if inequality { multiplier > 0.0 } else { fixed_bound_sides[j] > 0.0 };
                let side = if upper { draw.upper[j] } else { draw.lower[j] };
                if side.is_infinite() {
                    continue;
                }
                let value = Double::from(side);
                held.push(Active { a, value, multiplier, inequality });
                if inequality && multiplier.abs() > fixing_multiplier {
                    fixed_bound_sides[j] = multiplier.signum();
                }
            }
        }
        let smallest = |rows: &[Row]| residual_of(rows.iter().map(|row| row.scale));
        let above = draw.levels[..k].iter().zip(&known).flat_map(|(rows, known)| {
            let smallest = smallest(rows);
            rows.iter().zip(known).map(move |(row, known)| (row, known, known.value().abs() > smallest))
        });
        fixed_sides.resize(factors.len(), 0.0);
        for (((row, &known, short), factor), lock) in above.zip(factors).zip(&mut fixed_sides) {
            let multiplier = factor * row.scale / (largest * largest);
            let kept = row.equation() || short;
            if kept || multiplier.abs() > zero_multiplier {
                let inequality = !kept && *lock == 0.0;
                let side = [known.value(), *lock, multiplier].into_iter().find(|side| *side != 0.0);
                let side = if side > Some(0.0) { row.upper } else { row.lower };
                if side.is_infinite() {
                    continue;
                }
                let value = Double::from(side) + known;
                held.push(Active { a: &row.a, value, multiplier, inequality });
                if inequality && multiplier.abs() > fixing_multiplier {
                    *lock = multiplier.signum();
                }
            }
        }
        // The rows with a residual.
        let smallest = smallest(rows);
        let mut short = vec![];
        for (row, residual) in rows.iter().zip(&answer.residuals[k]) {
            if row.equation() || residual.abs() > smallest * row.scale {
                let side = if *residual > 0.0 { row.upper } else { row.lower };
                short.push((row.a.as_slice(), Double::from(side), row.scale / largest));
            }
        }
        let (found, wrong) = least(n, &held, &short);
        if wrong.iter().any(|wrong| *wrong) {
            // The multiplier has the wrong sign; it counts where it is above rounding.
            let others: Vec<Active<'_>> =
                held.into_iter().zip(&wrong).filter(|(_, wrong)| !**wrong).map(|(held, _)| held).collect();
            let (better, _) = least(n, &others, &short);
            let change = found.iter().zip(&better).map(|(a, b)| (*a - *b).value().abs()).fold(0.0, f64::max);
            if change > 1e-9 {
                return Err(format!("level {k}: without rows that pull, residuals change by {change:.1e}"));
            }
        }
        let mut found = found.into_iter();
        let all = rows.iter().zip(&answer.residuals[k]).map(|(row, residual)| {
            let short = row.equation() || residual.abs() > smallest * row.scale;
            if short { found.next().unwrap() } else { Double::ZERO }
        });
        known.push(all.collect());
    }
    Ok(known.iter().map(|level| level.iter().map(|r| r.value()).collect()).collect())
}

/// Change of the residuals when the last digit of every coefficient changes: no solver can know them better.
pub fn spread(draw: &Draw, answer: &Answer, rng: &mut Pcg64) -> Result<f64, String> {
    let known = reference(draw, answer)?;
    let mut most: f64 = 0.0;
    for _ in 0..PERTURBATIONS {
        let mut nudged = draw.clone();
        for a in nudged.levels.iter_mut().flatten().flat_map(|row| &mut row.a) {
            *a *= 1.0 + f64::EPSILON * f64::from(rng.random_range(-1..=1));
        }
        let other = reference(&nudged, answer)?;
        let moved = known.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs());
        most = moved.fold(most, f64::max);
    }
    Ok(most)
}

/// Least squares of `short` (row, limit, weight) with `held` as equations: residuals before weighting, and which of `held` have
/// a multiplier of the wrong sign.
fn least(n: usize, held: &[Active<'_>], short: &[(&[f64], Double, f64)]) -> (Vec<Double>, Vec<bool>) {
    let plain = |a: &[f64]| a.iter().map(|a| Double::from(*a)).collect::<Vec<_>>();
    let axpy = |y: &mut [Double], factor: Double, x: &[Double]| {
        for (y, x) in y.iter_mut().zip(x) {
            *y += factor * *x;
        }
    };
    // Orthonormal directions of the active rows, the largest remainder first; `x` satisfies them.
    let mut rests: Vec<Vec<Double>> = held.iter().map(|held| plain(held.a)).collect();
    let mut directions: Vec<Vec<Double>> = vec![];
    let mut order: Vec<usize> = vec![];
    let mut x = vec![Double::ZERO; n];
    loop {
        let lengths: Vec<f64> = rests.iter().map(|rest| inner(rest, rest).value()).collect();
        let candidates = (0..held.len()).filter(|i| !order.contains(i));
        let Some(next) = candidates.max_by(|a, b| lengths[*a].total_cmp(&lengths[*b])) else { break };
        if lengths[next] < 1e-18 {
            break;
        }
        let length = inner(&rests[next], &rests[next]).sqrt();
        let direction: Vec<Double> = rests[next].iter().map(|r| *r / length).collect();
        let missing = held[next].value - inner(&plain(held[next].a), &x);
        axpy(&mut x, missing / length, &direction);
        for rest in &mut rests {
            let share = inner(rest, &direction);
            axpy(rest, -share, &direction);
        }
        order.push(next);
        directions.push(direction);
    }
    // The rows with residuals in the null space, weighted, as columns.
    let mut columns = vec![vec![Double::ZERO; short.len()]; n];
    let mut residuals = vec![];
    for (i, (a, side, weight)) in short.iter().enumerate() {
        let mut row = plain(a);
        residuals.push((inner(&row, &x) - *side) * Double::from(*weight));
        for direction in &directions {
            let share = inner(&row, direction);
            axpy(&mut row, -share, direction);
        }
        for (column, entry) in columns.iter_mut().zip(row) {
            column[i] = entry * Double::from(*weight);
        }
    }
    for _ in 0..n.min(short.len()) {
        let Some(longest) = columns.iter().max_by(|a, b| inner(a, a).value().total_cmp(&inner(b, b).value())) else {
            break;
        };
        let length = inner(longest, longest).sqrt();
        if length.value() < 1e-12 {
            break;
        }
        let direction: Vec<Double> = longest.iter().map(|c| *c / length).collect();
        for column in columns.iter_mut().chain([&mut residuals]) {
            let share = inner(column, &direction);
            axpy(column, -share, &direction);
        }
    }
    // Multipliers of the answer, corrected for the independent rows.
    let mut gradient = vec![Double::ZERO; n];
    for ((a, _, weight), residual) in short.iter().zip(&residuals) {
        axpy(&mut gradient, *residual * Double::from(*weight), &plain(a));
    }
    let mut multipliers: Vec<Double> = held.iter().map(|held| Double::from(held.multiplier)).collect();
    for (held, multiplier) in held.iter().zip(&multipliers) {
        axpy(&mut gradient, *multiplier, &plain(held.a));
    }
    for (&i, direction) in order.iter().zip(&directions).rev() {
        let a = plain(held[i].a);
        let correction = -inner(&gradient, direction) / inner(&a, direction);
        multipliers[i] += correction;
        axpy(&mut gradient, correction, &a);
    }
    let wrong = held.iter().zip(&multipliers).map(|(held, multiplier)| {
        let wrong = if held.multiplier > 0.0 { -multiplier.value() } else { multiplier.value() };
        held.inequality && wrong > 1e-14
    });
    let found = residuals.iter().zip(short).map(|(residual, (_, _, weight))| *residual / Double::from(*weight));
    (found.collect(), wrong.collect())
}
