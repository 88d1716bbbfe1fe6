//! Solves a strictly convex quadratic program by the dual active-set method of Goldfarb & Idnani (1983), "A numerically stable dual
//! method for solving strictly convex quadratic programs", Mathematical Programming 27.
//!
//! It begins at the minimum under the equations alone, and lets the constraint that is violated most join, one after the other; those whose
//! multiplier would change its sign leave. The objective rises from change to change, so that no working set comes back, however many
//! constraints meet in one point. With `M = R^T R` the unknowns are `w = R d`, in which the objective is the distance from its minimum, and
//! a constraint `c.d >= b` is `v.w >= b` with `v = R^-T c`. The constraints of the working set are factorised as `V = Q T`, with orthonormal
//! columns of `Q` and an upper triangle `T`.

use super::tolerances::{DEPENDENT_CONSTRAINT, DUAL_CHANGES, QP_VIOLATION};
use hierarchical_least_squares::linalg::{
    add_scaled, dot, norm, rotate, rotation, solve_upper, solve_upper_transposed,
};

/// Rows and bounds of a program, `n` unknowns, and the triangle `R` of its matrix, `width` entries a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraints<'a> {
    pub(super) factor: &'a [f64],
    pub(super) width: usize,
    pub(super) rows: &'a [f64],
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    pub(super) lower_bounds: &'a [f64],
    pub(super) upper_bounds: &'a [f64],
}

/// A constraint of the working set: a row, or with an index behind the rows the bound of an unknown; 1 at its upper limit, -1 at its lower one,
/// 0 for an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Active {
    index: usize,
    side: i8,
}

/// Working set, its factors and the iterate. The buffers are kept between calls.
#[derive(Clone, Debug, Default)]
pub(super) struct DualActiveSet {
    n: usize,
    active: Vec<Active>,
    multipliers: Vec<f64>,
    /// `Q^T` and `T`, row after row, `n` entries each.
    basis: Vec<f64>,
    triangle: Vec<f64>,
    /// The iterate: `w`, and `d`.
    w: Vec<f64>,
    d: Vec<f64>,
    /// Length of each constraint, rows first, 0 where it is left out.
    lengths: Vec<f64>,
    /// The constraint that joins: `v`, its part outside the working set, its shares of the basis, and `T^-1` times these.
    joining: Vec<f64>,
    outside: Vec<f64>,
    shares: Vec<f64>,
    slopes: Vec<f64>,
    /// Changes of all solutions so far.
    changes: usize,
    /// Violation of the constraints that were left out, when they were, beside their lengths: the greatest.
    left_out_by: f64,
}

impl DualActiveSet {
    /// Finds the working set of the minimum; `w` is that without constraints. Constraints that contradict those before them are left out.
    pub(super) fn solve(&mut self, program: &Constraints<'_>, w: &[f64]) {
        self.begin(program, w);
        for index in (0..program.lower.len()).filter(|&r| program.lower[r] == program.upper[r]) {
            self.take_constraint(program, Active { index, side: 0 });
            if self.project() {
                let step = self.missing(program, Active { index, side: 0 }) / dot(&self.outside, &self.outside);
                self.advance(step);
                self.append(Active { index, side: 0 }, step);
            }
        }
        let mut left = DUAL_CHANGES * (self.n + program.lower.len());
        while let Some(violated) = self.most_violated(program) {
            self.take_constraint(program, violated);
            if !self.join(program, violated, &mut left) {
                return;
            }
        }
    }

    /// Number of changes of the working set in all solutions so far.
    pub(super) fn changes(&self) -> usize {
        self.changes
    }

    /// Greatest violation, beside its length, of a constraint that contradicts those before it.
    pub(super) fn left_out_by(&self) -> f64 {
        self.left_out_by
    }

    /// `d` of the minimum.
    pub(super) fn solution(&self) -> &[f64] {
        &self.d
    }

    /// Writes the sides of bounds and rows of the working set.
    pub(super) fn write(&self, at_bound: &mut [i8], at_limit: &mut [i8]) {
        at_bound.fill(0);
        at_limit.fill(0);
        for active in &self.active {
            match active.index.checked_sub(at_limit.len()) {
                Some(unknown) => at_bound[unknown] = active.side,
                None => at_limit[active.index] = active.side,
            }
        }
    }

    fn begin(&mut self, program: &Constraints<'_>, w: &[f64]) {
        self.n = w.len();
        self.left_out_by = 0.0;
        self.active.clear();
        self.multipliers.clear();
        self.basis.clear();
        self.triangle.clear();
        self.w.clear();
        self.w.extend_from_slice(w);
        self.lengths.clear();
        self.lengths.extend(program.rows.chunks_exact(self.n.max(1)).map(norm));
        self.lengths.resize(program.lower.len() + self.n, 1.0);
    }

    /// Lets a violated constraint join, for which others may leave; `false` after too many changes.
    fn join(&mut self, program: &Constraints<'_>, joining: Active, left: &mut usize) -> bool {
        let mut multiplier = 0.0;
        loop {
            if *left == 0 {
                return false;
            }
            *left -= 1;
            self.changes += 1;
            let independent = self.project();
            let whole = match independent {
                true => self.missing(program, joining) / dot(&self.outside, &self.outside),
                false => f64::INFINITY,
            };
            let leaving = self.first_to_leave();
            let step = leaving.map_or(whole, |(share, _)| whole.min(share));
            if step == f64::INFINITY {
                // The working set contradicts it.
                let length = std::mem::take(&mut self.lengths[joining.index]);
                self.left_out_by = self.left_out_by.max(self.missing(program, joining) / length);
                return true;
            }
            if independent {
                self.advance(step);
            }
            for (own, slope) in self.multipliers.iter_mut().zip(&self.slopes) {
                *own -= step * slope;
            }
            multiplier += step;
            match leaving {
                Some((share, k)) if share < whole => self.remove(k),
                _ => {
                    self.append(joining, multiplier);
                    return true;
                }
            }
        }
    }

    /// Writes `v` of a constraint, turned so that it must not be less than its limit.
    fn take_constraint(&mut self, program: &Constraints<'_>, constraint: Active) {
        let n = self.n;
        self.joining.clear();
        match constraint.index.checked_sub(program.lower.len()) {
            None => self.joining.extend_from_slice(&program.rows[constraint.index * n..(constraint.index + 1) * n]),
            Some(unknown) => {
                self.joining.resize(n, 0.0);
                self.joining[unknown] = 1.0;
            }
        }
        if constraint.side > 0 {
            self.joining.iter_mut().for_each(|entry| *entry = -*entry);
        }
        solve_upper_transposed(program.factor, program.width, &mut self.joining);
    }

    /// By how much `v.w` is below its limit.
    fn missing(&self, program: &Constraints<'_>, constraint: Active) -> f64 {
        let (lower, upper) = match constraint.index.checked_sub(program.lower.len()) {
            None => (program.lower[constraint.index], program.upper[constraint.index]),
            Some(unknown) => (program.lower_bounds[unknown], program.upper_bounds[unknown]),
        };
        let limit = if constraint.side > 0 { -upper } else { lower };
        limit - dot(&self.joining, &self.w)
    }

    /// The row or bound that is violated most, beside its length.
    fn most_violated(&mut self, program: &Constraints<'_>) -> Option<Active> {
        self.d.clone_from(&self.w);
        solve_upper(program.factor, program.width, &mut self.d);
        let rows = program.rows.chunks_exact(self.n.max(1)).map(|row| dot(row, &self.d));
        let limits = program.lower.iter().zip(program.upper);
        let bounds = self.d.iter().copied().zip(program.lower_bounds.iter().zip(program.upper_bounds));
        let mut worst: Option<(f64, Active)> = None;
        for (index, (value, (lower, upper))) in rows.zip(limits).chain(bounds).enumerate() {
            let (below, above, length) = (lower - value, value - upper, self.lengths[index]);
            let (by, side) = if below > above { (below, -1) } else { (above, 1) };
            let most = worst.map_or(QP_VIOLATION, |(most, _)| most);
            if lower != upper && by > most * length && length > 0.0 && !self.active.iter().any(|a| a.index == index) {
                worst = Some((by / length, Active { index, side }));
            }
        }
        worst.map(|(_, constraint)| constraint)
    }

    /// Splits `v` into its shares of the basis and the part outside, orthogonalised twice; `false` where it depends on the working set.
    fn project(&mut self) -> bool {
        let (n, q) = (self.n, self.active.len());
        self.outside.clone_from(&self.joining);
        self.shares.clear();
        self.shares.resize(q, 0.0);
        for _ in 0..2 {
            for (share, vector) in self.shares.iter_mut().zip(self.basis.chunks_exact(n.max(1))) {
                let more = dot(vector, &self.outside);
                *share += more;
                add_scaled(&mut self.outside, -more, vector);
            }
        }
        self.slopes.clone_from(&self.shares);
        solve_upper(&self.triangle, n, &mut self.slopes);
        norm(&self.outside) > DEPENDENT_CONSTRAINT * norm(&self.joining)
    }

    /// The inequality whose multiplier is the first to become zero, after which step.
    fn first_to_leave(&self) -> Option<(f64, usize)> {
        let largest = self.slopes.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let mut first: Option<(f64, usize)> = None;
        for (k, (active, slope)) in self.active.iter().zip(&self.slopes).enumerate() {
            if active.side != 0 && *slope > DEPENDENT_CONSTRAINT * largest {
                let share = (self.multipliers[k] / slope).max(0.0);
                if first.is_none_or(|(least, _)| share < least) {
                    first = Some((share, k));
                }
            }
        }
        first
    }

    fn advance(&mut self, step: f64) {
        add_scaled(&mut self.w, step, &self.outside);
    }

    /// Appends the constraint that joins.
    fn append(&mut self, joining: Active, multiplier: f64) {
        let (n, q) = (self.n, self.active.len());
        let length = norm(&self.outside);
        self.basis.extend(self.outside.iter().map(|entry| entry / length));
        for (row, share) in self.triangle.chunks_exact_mut(n).zip(&self.shares) {
            row[q] = *share;
        }
        self.triangle.resize((q + 1) * n, 0.0);
        self.triangle[q * n + q] = length;
        self.active.push(joining);
        self.multipliers.push(multiplier);
    }

    /// Removes a constraint and restores the triangle by rotations of neighbouring rows.
    fn remove(&mut self, k: usize) {
        let (n, q) = (self.n, self.active.len());
        self.active.remove(k);
        self.multipliers.remove(k);
        for row in self.triangle.chunks_exact_mut(n) {
            row.copy_within(k + 1..q, k);
        }
        for i in k..q - 1 {
            let (upper, lower) = self.triangle[i * n..(i + 2) * n].split_at_mut(n);
            let (length, cosine, sine) = rotation(upper[i], lower[i]);
            (upper[i], lower[i]) = (length, 0.0);
            rotate(&mut upper[i + 1..q - 1], &mut lower[i + 1..q - 1], cosine, sine);
            let (upper, lower) = self.basis[i * n..(i + 2) * n].split_at_mut(n);
            rotate(upper, lower, cosine, sine);
        }
        self.basis.truncate((q - 1) * n);
        self.triangle.truncate((q - 1) * n);
    }
}
