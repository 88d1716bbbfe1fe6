//! Solves quadratic programs that need not be convex, by an active-set method.
//!
//! `min g.d + d^T H d / 2` with `lower <= A d <= upper` and bounds on `d`. The working set of inequalities is solved as equations,
//! then changed: violated rows join, rows with multipliers of the wrong sign leave (Nocedal & Wright 2006, "Numerical
//! Optimization", ch. 16.5). Each solution is one Cholesky factorisation of `[M A^T; A 0]`, where `M` is `H` with the squares of the
//! working-set rows added, which removes negative curvature in directions that they forbid. Where `M` is not positive definite,
//! the diagonal is regularised.
//!
//! From one step of a descent to the next few constraints change, and one or two changes of the working set, each of many constraints at once,
//! find the solution (`qp_working_set.rs`). Where three do not, as such changes may follow each other without end, a dual method
//! (`dual_active_set.rs`) finds the working set of `M` with the squares of the equations, or of those and of limits that its solution is known to meet: a
//! strictly convex program.

use super::dual_active_set::DualActiveSet;
use super::tolerances::{
    CONTRADICTION, DIAGONAL_SHARE, DUAL_CHANGES_OF_A_UNIT, FIRST_REGULARISATION, FORCES_SHARE, LARGEST_REGULARISATION,
    QP_ZERO, REGULARISATION_FACTOR, WORK_OF_PROGRAM, WORKING_SET_WEIGHT, ZERO_ROW,
};
use hierarchical_least_squares::linalg::{
    add_outer_products, add_scaled, add_symmetric_column, block_start, blocked_cholesky, dot, padded_width,
    solve_upper, solve_upper_transposed,
};

/// A program, its solution, and the factors, which also serve for corrections.
#[derive(Clone, Debug, Default)]
pub(crate) struct QuadraticProgram {
    /// Number of unknowns.
    pub(crate) n: usize,
    /// `H`; the upper triangle is read.
    pub(crate) matrix: Vec<f64>,
    /// `g`.
    pub(crate) gradient: Vec<f64>,
    /// `A`, row after row.
    pub(crate) rows: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    /// Bounds of each unknown.
    pub(crate) lower_bounds: Vec<f64>,
    pub(crate) upper_bounds: Vec<f64>,
    /// Number of rates: the first unknowns. The others are forces, which are regularised by [`FORCES_SHARE`] as much.
    pub(crate) rates: usize,
    /// Diagonal entry that one unit of regularisation adds.
    pub(crate) unit: f64,
    /// `d` of the solution, and the multipliers of the rows.
    pub(crate) step: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    /// `H` with the squares added ([`QuadraticProgram::stiffen`]), upper triangle; the weight of the square of each row; `g` less the equations'.
    stiffened: Vec<f64>,
    weights: Vec<f64>,
    stiffened_gradient: Vec<f64>,
    /// Side at which each unknown lies at its bound, each row at its limit: -1, 1, or 0 for neither.
    pub(super) at_bound: Vec<i8>,
    pub(super) at_limit: Vec<i8>,
    /// The same of those whose squares are added to `H` ([`QuadraticProgram::stiffen`]).
    pub(super) known_bound: Vec<i8>,
    pub(super) known_limit: Vec<i8>,
    /// Unknowns between their bounds.
    pub(super) free: Vec<usize>,
    /// Rows solved as equations.
    pub(super) working_set: Vec<usize>,
    /// `[R V z]` over `[. S -]`, see [`QuadraticProgram::factorise`].
    pub(super) factor: Vec<f64>,
    /// `H d`; during a solve `M d` of the unknowns at bounds.
    product: Vec<f64>,
    pub(super) dual: DualActiveSet,
    /// Work of all programs so far, in units of [`Engine::work`](crate::posture_solver::Engine::work): of each one what it takes by itself, whatever
    /// was solved before.
    pub(crate) work: usize,
    /// The dual method has left out constraints of the last program that contradict the others by more than [`CONTRADICTION`].
    pub(crate) contradictory: bool,
    // Scratch.
    of_rows: Vec<f64>,
    pub(super) of_unknowns: Vec<f64>,
}

impl QuadraticProgram {
    /// Empties the working set.
    pub(crate) fn forget(&mut self) {
        self.at_bound.clear();
        self.at_limit.clear();
    }

    /// Solves with at least this regularisation; returns the one that was needed. `None` if none up to
    /// [`LARGEST_REGULARISATION`] makes the matrix positive definite, or the solution is not finite.
    pub(crate) fn solve(&mut self, regularisation: f64) -> Option<f64> {
        let before = self.dual.changes();
        let needed = self.find(regularisation);
        self.work += WORK_OF_PROGRAM + (self.dual.changes() - before) / DUAL_CHANGES_OF_A_UNIT;
        needed
    }

    fn find(&mut self, regularisation: f64) -> Option<f64> {
        let (n, m) = (self.n, self.lower.len());
        self.contradictory = false;
        self.at_bound.resize(n, 0);
        self.at_limit.resize(m, 0);
        self.step.resize(n, 0.0);
        self.product.resize(n, 0.0);
        self.stiffen(false);
        let regularisation = match self.change_many(regularisation) {
            Some(needed) => needed,
            None => {
                let needed = self.find_working_set(regularisation);
                self.contradictory = self.dual.left_out_by() > CONTRADICTION;
                needed?
            }
        };
        for (d, (least, most)) in self.step.iter_mut().zip(self.lower_bounds.iter().zip(&self.upper_bounds)) {
            *d = d.clamp(*least, *most);
        }
        self.product.fill(0.0);
        for (j, d) in self.step.iter().enumerate() {
            add_symmetric_column(&mut self.product, *d, &self.matrix, j);
        }
        let finite = self.step.iter().chain(&self.multipliers).all(|number| number.is_finite());
        finite.then_some(regularisation)
    }

    /// Factorises with this regularisation, or the least one above it that makes the matrix positive definite; returns it.
    pub(super) fn factorise_regularised(&mut self, mut regularisation: f64) -> Option<f64> {
        loop {
            self.fill();
            if self.factorise(regularisation) {
                return Some(regularisation);
            }
            regularisation = (REGULARISATION_FACTOR * regularisation).max(FIRST_REGULARISATION);
            if regularisation > LARGEST_REGULARISATION {
                return None;
            }
        }
    }

    /// The least change of the last solution, measured by `M`, that changes the working-set rows by `change`.
    pub(crate) fn correct(&mut self, change: impl Fn(usize) -> f64, correction: &mut [f64]) {
        let (k, q) = (self.free.len(), self.working_set.len());
        let w = padded_width(k + q + 1);
        self.of_rows.clear();
        self.of_rows.extend(self.working_set.iter().map(|row| change(*row)));
        self.solve_schur();
        let mut z = std::mem::take(&mut self.of_unknowns);
        z.clear();
        z.extend((0..k).map(|i| dot(&self.factor[i * w + k..i * w + k + q], &self.of_rows)));
        solve_upper(&self.factor, w, &mut z);
        correction.fill(0.0);
        self.free.iter().zip(&z).for_each(|(i, z)| correction[*i] = *z);
        self.of_unknowns = z;
    }

    /// Whether the row is an equation or at a limit.
    pub(crate) fn in_working_set(&self, row: usize) -> bool {
        self.lower[row] == self.upper[row] || self.at_limit[row] != 0
    }

    /// Largest multiple of the step, at least 1, that violates no further bound or row.
    pub(crate) fn longest(&self) -> f64 {
        let limit = |least: f64, most: f64, d: f64| match d {
            d if d > QP_ZERO => most / d,
            d if d < -QP_ZERO => least / d,
            _ => f64::INFINITY,
        };
        let bounds = self.step.iter().zip(self.lower_bounds.iter().zip(&self.upper_bounds));
        let longest = bounds.fold(f64::INFINITY, |longest, (d, (least, most))| longest.min(limit(*least, *most, *d)));
        let rows = self.rows.chunks_exact(self.n).zip(self.lower.iter().zip(&self.upper));
        let rows = rows.filter(|(_, (lower, upper))| lower != upper);
        let longest = rows.fold(longest, |longest, (row, (l, u))| longest.min(limit(*l, *u, dot(row, &self.step))));
        longest.max(1.0)
    }

    /// `d^T H d` of the solution.
    pub(crate) fn curvature(&self) -> f64 {
        dot(&self.product, &self.step)
    }

    /// Adds the squares of the equations, which every working set contains, and, where they are `known`, of the bounds and limits at which the
    /// last solution lies.
    pub(super) fn stiffen(&mut self, known: bool) {
        let n = self.n;
        let size = (0..n).fold(0.0, |size: f64, i| size.max(self.matrix[i * n + i].abs()));
        self.stiffened.clone_from(&self.matrix);
        self.stiffened_gradient.clone_from(&self.gradient);
        self.weights.clear();
        let (lower, upper, at_limit) = (&self.lower, &self.upper, &self.at_limit);
        let counts = |r: usize| lower[r] == upper[r] || known && at_limit[r] != 0;
        for (r, row) in self.rows.chunks_exact(n).enumerate() {
            let square = dot(row, row);
            let weight = if square > ZERO_ROW { WORKING_SET_WEIGHT * size / square } else { 0.0 };
            self.weights.push(weight);
            if counts(r) {
                let target = if at_limit[r] > 0 { upper[r] } else { lower[r] };
                add_scaled(&mut self.stiffened_gradient, -weight * target, row);
            }
        }
        let weights = &self.weights;
        add_outer_products(&mut self.stiffened, n, &self.rows, |r| if counts(r) { weights[r] } else { 0.0 });
        for (i, side) in self.at_bound.iter().enumerate().filter(|(_, side)| known && **side != 0) {
            let bound = if *side > 0 { self.upper_bounds[i] } else { self.lower_bounds[i] };
            self.stiffened[i * n + i] += WORKING_SET_WEIGHT * size;
            self.stiffened_gradient[i] -= WORKING_SET_WEIGHT * size * bound;
        }
    }

    /// Writes `[M A^T -g; 0 0 c]` over free unknowns and working-set rows.
    fn fill(&mut self) {
        let (n, k, q) = (self.n, self.free.len(), self.working_set.len());
        let w = padded_width(k + q + 1);
        self.factor.resize((k + q) * w, 0.0);
        let all = k == n;
        self.product.fill(0.0);
        for (j, side) in self.at_bound.iter().enumerate() {
            if *side != 0 {
                add_symmetric_column(&mut self.product, self.step[j], &self.stiffened, j);
            }
        }
        for (a, &i) in self.free.iter().enumerate() {
            let (from, to) = (&self.stiffened[i * n..(i + 1) * n], &mut self.factor[a * w..(a + 1) * w]);
            let gradient = self.stiffened_gradient[i] + self.product[i];
            to[block_start(a)..a].fill(0.0);
            if all {
                to[a..k].copy_from_slice(&from[a..]);
            } else {
                to[a..k].iter_mut().zip(&self.free[a..]).for_each(|(to, j)| *to = from[*j]);
            }
            for (to, row) in to[k..].iter_mut().zip(&self.working_set) {
                *to = self.rows[row * n + i];
            }
            to[k + q] = -gradient;
            to[k + q + 1..].fill(0.0);
        }
        for (r, &row) in self.working_set.iter().enumerate() {
            let from = &self.rows[row * n..(row + 1) * n];
            let target = if self.at_limit[row] > 0 { self.upper[row] } else { self.lower[row] };
            let target = target - if all { 0.0 } else { dot(from, &self.step) };
            let line = &mut self.factor[(k + r) * w..(k + r + 1) * w];
            line.fill(0.0);
            line[k + q] = target;
            if self.lower[row] == self.upper[row] {
                continue;
            }
            // The square of an inequality at its limit.
            let weight = self.weights[row];
            for (a, &i) in self.free.iter().enumerate().filter(|(_, i)| from[**i] != 0.0) {
                let line = &mut self.factor[a * w..(a + 1) * w];
                let by = weight * from[i];
                line[a..k].iter_mut().zip(&self.free[a..]).for_each(|(to, j)| *to += by * from[*j]);
                line[k + q] += by * target;
            }
        }
    }

    /// `M = R^T R`, `V = R^-T A^T`, `z = R^-T(-g)`, and `S = V^T V` by a second factorisation.
    fn factorise(&mut self, regularisation: f64) -> bool {
        let (k, q) = (self.free.len(), self.working_set.len());
        let w = padded_width(k + q + 1);
        let (mut rates, mut forces) = (0f64, 0f64);
        for (a, &i) in self.free.iter().enumerate() {
            let size = self.factor[a * w + a].abs();
            if i < self.rates { rates = rates.max(size) } else { forces = forces.max(size) }
        }
        for (a, &i) in self.free.iter().enumerate() {
            let more = if i < self.rates {
                regularisation * self.unit + DIAGONAL_SHARE * rates
            } else {
                (FORCES_SHARE * regularisation + DIAGONAL_SHARE) * forces
            };
            self.factor[a * w + a] += more;
        }
        if !blocked_cholesky(&mut self.factor, w, 0, k) {
            return false;
        }
        // Linearly dependent rows.
        let trace = (k..k + q).fold(0.0, |most: f64, r| most.max(-self.factor[r * w + r])) * QP_ZERO;
        for r in k..k + q {
            let line = &mut self.factor[r * w..(r + 1) * w];
            line[k..].iter_mut().for_each(|entry| *entry = -*entry);
            line[r] += trace;
        }
        blocked_cholesky(&mut self.factor, w, k, k + q)
    }

    /// Solves for step and multipliers with the factors.
    pub(super) fn back_substitute(&mut self) {
        let (k, q) = (self.free.len(), self.working_set.len());
        let w = padded_width(k + q + 1);
        self.of_rows.clear();
        self.of_rows.extend((k..k + q).map(|r| self.factor[r * w + k + q]));
        solve_upper(self.factor.get(k * w + k..).unwrap_or_default(), w, &mut self.of_rows);
        let mut z = std::mem::take(&mut self.of_unknowns);
        z.clear();
        z.extend((0..k).map(|i| {
            let line = &self.factor[i * w..(i + 1) * w];
            line[k + q] - dot(&line[k..k + q], &self.of_rows)
        }));
        solve_upper(&self.factor, w, &mut z);
        self.free.iter().zip(&z).for_each(|(i, z)| self.step[*i] = *z);
        self.of_unknowns = z;
        self.multipliers.clear();
        self.multipliers.resize(self.lower.len(), 0.0);
        self.working_set.iter().zip(&self.of_rows).for_each(|(row, y)| self.multipliers[*row] = *y);
    }

    /// Replaces `of_rows` by `S^-1` times it.
    fn solve_schur(&mut self) {
        let (k, q) = (self.free.len(), self.working_set.len());
        let w = padded_width(k + q + 1);
        let schur = self.factor.get(k * w + k..).unwrap_or_default();
        solve_upper_transposed(schur, w, &mut self.of_rows);
        solve_upper(schur, w, &mut self.of_rows);
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{
        DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
    };
    use hierarchical_least_squares::linalg::norm;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const SEED: u64 = 31;

    /// A program such as a descent builds: some step satisfies all rows, the step 0 need not.
    fn random_program(random: &mut Pcg64Mcg, negative_curvature: bool) -> QuadraticProgram {
        let n = random.random_range(20..70);
        let equations = random.random_range(0..=n / 3);
        let rows = equations + random.random_range(0..=n / 2);
        let mut numbers = |count: usize| (0..count).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
        let mut program = QuadraticProgram { n, rates: n, unit: 1.0, ..QuadraticProgram::default() };
        program.gradient = numbers(n);
        program.rows = numbers(rows * n);
        program.matrix = vec![0.0; n * n];
        for (k, row) in numbers(2 * n * n).chunks_exact(n).enumerate() {
            // Eigenvalues over three decades, as of effort.
            let weight = libm::pow(10.0, -3.0 * k as f64 / (2 * n) as f64);
            for i in 0..n {
                add_scaled(&mut program.matrix[i * n + i..(i + 1) * n], weight * row[i], &row[i..]);
            }
        }
        let (inside, room) = (numbers(n), numbers(rows + 2 * n));
        let room: Vec<f64> = room.iter().map(|x| if *x < -0.5 { 0.0 } else { x.abs() }).collect();
        for (r, row) in program.rows.chunks_exact(n).enumerate() {
            let value = dot(row, &inside);
            let (lower, upper) = match r {
                r if r < equations => (value, value),
                r if r % 2 == 0 => (value - room[r], f64::INFINITY),
                _ => (f64::NEG_INFINITY, value + room[r]),
            };
            program.lower.push(lower);
            program.upper.push(upper);
        }
        for (i, x) in inside.iter().enumerate() {
            let bounded = i % 3 == 0;
            program.lower_bounds.push(if bounded { x.min(0.0) - room[rows + 2 * i] } else { f64::NEG_INFINITY });
            program.upper_bounds.push(if bounded { x.max(0.0) + room[rows + 2 * i + 1] } else { f64::INFINITY });
        }
        if negative_curvature {
            // Negative curvature only in directions that the equations forbid.
            for row in program.rows[..equations * n].chunks_exact(n) {
                for i in 0..n {
                    add_scaled(&mut program.matrix[i * n + i..(i + 1) * n], -0.5 * row[i], &row[i..]);
                }
                add_scaled(&mut program.gradient, 0.5 * dot(row, &inside), row);
            }
        }
        program
    }

    /// The solution by an interior-point method; a matrix of negative curvature gets the square of each equation first.
    fn clarabel(program: &QuadraticProgram, negative_curvature: bool) -> Option<Vec<f64>> {
        let (n, m) = (program.n, program.lower.len());
        let (mut matrix, mut gradient) = (program.matrix.clone(), program.gradient.clone());
        let equation = |r: &usize| program.lower[*r] == program.upper[*r];
        let row = |r: usize| &program.rows[r * n..(r + 1) * n];
        let (mut lines, mut limits): (Vec<Vec<f64>>, Vec<f64>) = (vec![], vec![]);
        for r in (0..m).filter(equation) {
            lines.push(row(r).to_vec());
            limits.push(program.upper[r]);
            if negative_curvature {
                for i in 0..n {
                    add_scaled(&mut matrix[i * n + i..(i + 1) * n], 0.5 * row(r)[i], &row(r)[i..]);
                }
                add_scaled(&mut gradient, -0.5 * program.upper[r], row(r));
            }
        }
        let equations = lines.len();
        let unit = |i: usize, sign: f64| (0..n).map(|j| if i == j { sign } else { 0.0 }).collect::<Vec<f64>>();
        let sides = (0..m).filter(|r| !equation(r)).map(|r| (row(r).to_vec(), program.lower[r], program.upper[r]));
        let bounds = (0..n).map(|i| (unit(i, 1.0), program.lower_bounds[i], program.upper_bounds[i]));
        for (line, lower, upper) in sides.chain(bounds) {
            if upper.is_finite() {
                lines.push(line.clone());
                limits.push(upper);
            }
            if lower.is_finite() {
                lines.push(line.iter().map(|a| -a).collect());
                limits.push(-lower);
            }
        }
        let matrix: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| if i <= j { matrix[i * n + j] } else { 0.0 }).collect()).collect();
        let cones = [ZeroConeT(equations), NonnegativeConeT(lines.len() - equations)];
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-12)
            .tol_gap_rel(1e-12)
            .tol_feas(1e-12)
            .build()
            .unwrap();
        let (p, a) = (CscMatrix::from(&matrix), CscMatrix::from(&lines));
        let mut solver = DefaultSolver::new(&p, &gradient, &a, &limits, &cones, settings).unwrap();
        solver.solve();
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved)
            .then(|| solver.solution.x.clone())
    }

    /// Repeats each inequality, and adds to each pair its sum: more constraints meet in a point than are independent.
    fn repeat_constraints(program: &mut QuadraticProgram) {
        let n = program.n;
        let (rows, limits) = (program.rows.clone(), program.lower.iter().zip(&program.upper).map(|(l, u)| (*l, *u)));
        let limits: Vec<(f64, f64)> = limits.collect();
        let mut before: Option<usize> = None;
        for (r, &(lower, upper)) in limits.iter().enumerate().filter(|(_, (lower, upper))| lower != upper) {
            let row = &rows[r * n..(r + 1) * n];
            program.rows.extend_from_slice(row);
            program.lower.push(lower);
            program.upper.push(upper);
            if let Some(before) = before {
                program.rows.extend(row.iter().zip(&rows[before * n..]).map(|(a, b)| a + b));
                program.lower.push(lower + limits[before].0);
                program.upper.push(upper + limits[before].1);
            }
            before = Some(r);
        }
    }

    /// A method that solves random programs.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum By {
        ChangesOfMany,
        Dual,
    }

    fn compare(by: By, (negative_curvature, repeated): (bool, bool)) {
        let mut random = Pcg64Mcg::new(SEED.into());
        let (mut compared, mut worst, mut off) = (0, 0f64, 0f64);
        for _ in 0..600 {
            let mut program = random_program(&mut random, negative_curvature);
            if repeated {
                repeat_constraints(&mut program);
            }
            let Some(peer) = clarabel(&program, negative_curvature) else { continue };
            match by {
                By::ChangesOfMany => assert_eq!(program.solve(0.0), Some(0.0)),
                By::Dual => solve_by_dual(&mut program),
            }
            compared += 1;
            let n = program.n;
            let value = |d: &[f64]| {
                let upper = |i: usize, j: usize| program.matrix[i.min(j) * n + i.max(j)];
                dot(&program.gradient, d)
                    + 0.5 * (0..n * n).map(|e| d[e / n] * upper(e / n, e % n) * d[e % n]).sum::<f64>()
            };
            let missing = program.rows.chunks_exact(n).enumerate().fold(0.0, |most: f64, (r, row)| {
                let value = dot(row, &program.step);
                most.max(program.lower[r] - value).max(value - program.upper[r])
            });
            let limits = program.lower_bounds.iter().zip(&program.upper_bounds);
            let beyond = program.step.iter().zip(limits).map(|(d, (least, most))| (least - d).max(d - most));
            off = beyond.fold(off.max(missing), f64::max);
            let more = (value(&program.step) - value(&peer)) / (1.0 + value(&peer).abs());
            worst = worst.max(more.abs());
        }
        println!("seed {SEED}, {by:?}: {compared} problems, off by {worst:.1e} at most, limits missed by {off:.1e}");
        assert!(compared > 550 && worst < 1e-6 && off < 1e-9, "{compared} {worst} {off}");
    }

    fn solve_by_dual(program: &mut QuadraticProgram) {
        program.at_bound.resize(program.n, 0);
        program.at_limit.resize(program.lower.len(), 0);
        program.step.resize(program.n, 0.0);
        program.product.resize(program.n, 0.0);
        program.stiffen(false);
        assert_eq!(program.find_working_set(0.0), Some(0.0));
    }

    /// Limits are moved away from the solution of random programs first.
    #[test]
    fn longest_multiple_of_a_step_meets_a_limit_and_passes_none() {
        let mut random = Pcg64Mcg::new(SEED.into());
        let mut longer = 0;
        for _ in 0..200 {
            let mut program = random_program(&mut random, false);
            program.solve(0.0).unwrap();
            for limits in [&mut program.lower_bounds, &mut program.upper_bounds, &mut program.lower, &mut program.upper]
            {
                limits.iter_mut().for_each(|limit| *limit *= 3.0);
            }
            let room = program.longest();
            longer += usize::from(room > 1.0);
            let n = program.n;
            let bounds = program
                .step
                .iter()
                .zip(program.lower_bounds.iter().zip(&program.upper_bounds))
                .map(|(d, (l, u))| (*d, *l, *u));
            let rows = program.rows.chunks_exact(n).zip(program.lower.iter().zip(&program.upper));
            let rows = rows
                .map(|(row, (l, u))| (dot(row, &program.step), *l, *u))
                .filter(|(_, l, u)| *l <= 0.0 && *u >= 0.0 && l != u);
            let passed: Vec<f64> = bounds.chain(rows).map(|(d, l, u)| (l - room * d).max(room * d - u)).collect();
            let most = passed.iter().fold(f64::NEG_INFINITY, |most, by| most.max(*by));
            assert!(room == 1.0 || most.abs() < 1e-9, "seed {SEED}: {most:e} at {room} times the step");
        }
        assert!(longer > 100, "{longer}");
    }

    /// The square of what is missed at an inequality that the solution of a convex program meets is taken away from it, which leaves the solution where
    /// it is.
    #[test]
    fn negative_curvature_across_a_limit_that_the_solution_meets_often_needs_no_regularisation() {
        let mut random = Pcg64Mcg::new(SEED.into());
        let (mut compared, mut without, mut worst) = (0, 0, 0f64);
        while compared < 300 {
            let mut program = random_program(&mut random, false);
            assert_eq!(program.solve(0.0), Some(0.0));
            let met = |r: &usize| program.at_limit[*r] != 0 && program.multipliers[*r].abs() > 1e-3;
            let Some(met) = (0..program.lower.len()).find(met) else { continue };
            let (n, solution) = (program.n, program.step.clone());
            let limit = if program.at_limit[met] > 0 { program.upper[met] } else { program.lower[met] };
            let row = program.rows[met * n..(met + 1) * n].to_vec();
            let size = (0..n).fold(0.0, |size: f64, i| size.max(program.matrix[i * n + i]));
            let share = 2.0 * size / dot(&row, &row);
            for (i, entry) in row.iter().enumerate() {
                add_scaled(&mut program.matrix[i * n + i..(i + 1) * n], -share * entry, &row[i..]);
            }
            add_scaled(&mut program.gradient, share * limit, &row);
            program.forget();
            let needed = program.solve(0.0).unwrap();
            compared += 1;
            if needed == 0.0 {
                without += 1;
                let off = program.step.iter().zip(&solution).map(|(a, b)| (a - b).abs());
                worst = off.fold(worst, f64::max);
            }
        }
        println!("seed {SEED}: {without} of {compared} without regularisation, off by {worst:.1e} at most");
        assert!(2 * without > compared && worst < 1e-6, "{without} {worst}");
    }

    /// A rate and two forces. The second one has no curvature of its own, as forces that cancel each other within a support, and a mixed part with
    /// the rate.
    #[test]
    fn a_force_without_curvature_needs_little_regularisation() {
        let mut program = QuadraticProgram { n: 3, rates: 1, unit: 1.0, ..QuadraticProgram::default() };
        program.matrix = vec![1.0, 0.0, 0.02, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        program.gradient = vec![1.0, 0.0, 0.0];
        program.lower_bounds = vec![f64::NEG_INFINITY; 3];
        program.upper_bounds = vec![f64::INFINITY; 3];
        let needed = program.solve(0.0).unwrap();
        assert!(needed > 0.0 && needed < 1.0, "{needed}");
    }

    /// Two limits that no step satisfies, and before that the same program without them.
    #[test]
    fn the_dual_method_tells_programs_with_limits_that_contradict_each_other() {
        let mut random = Pcg64Mcg::new(SEED.into());
        for k in 0..100 {
            let mut program = random_program(&mut random, false);
            solve_by_dual(&mut program);
            assert!(program.dual.left_out_by() < CONTRADICTION, "{k}: {}", program.dual.left_out_by());
            let row: Vec<f64> = (0..program.n).map(|_| random.random_range(-1.0..1.0)).collect();
            for (lower, upper) in [(1.0, f64::INFINITY), (f64::NEG_INFINITY, -1.0)] {
                program.rows.extend_from_slice(&row);
                program.lower.push(lower);
                program.upper.push(upper);
            }
            solve_by_dual(&mut program);
            let apart = 2.0 / norm(&row);
            assert!(program.dual.left_out_by() > 0.999 * apart, "{k}: {} of {apart}", program.dual.left_out_by());
        }
    }

    #[test]
    fn random_programs_have_the_objective_of_an_interior_point_method() {
        for by in [By::ChangesOfMany, By::Dual] {
            for kind in [(false, false), (true, false), (false, true), (true, true)] {
                compare(by, kind);
            }
        }
    }
}
