//! Which step is best where effort is a quadratic function and what must hold is linear?
//!
//! `min g.d + d^T H d / 2` with `lower <= A d <= upper` and bounds on `d`. Of inequalities a guess is held as equations, then
//! solved, then put right: what is violated is added, what pulls is let go (Nocedal & Wright 2006, "Numerical Optimization",
//! ch. 16.5). Each solution is one Cholesky factorisation of `[M A^T; A 0]`, `M` being `H` with the squares of the held rows
//! added: directions that they forbid must not look as if effort bent down there. What is still not positive gets a shift.
//!
//! The guess is put right a few times only. Where most unknowns lie at bounds it may still be wrong then (one in ten of small
//! random problems): bounds hold, rows may be missed, and a descent, which judges every step by what comes of it, goes on.

use hierarchical_least_squares::linalg::{
    add_outer_products, add_scaled, add_symmetric_column, block_start, blocked_cholesky, dot, padded_width,
    solve_upper, solve_upper_transposed,
};

/// Weight of held rows in `M`, against the largest diagonal entry.
const FAST: f64 = 10.0;
/// Share of the largest diagonal entry of each kind that is always added.
const FLAT: f64 = 1e-10;
/// How often the guess is put right; in the second half nothing is let go any more.
const ROUNDS: usize = 14;
/// Of what is violated, all that is violated by this share of the worst is added at once.
const WORST: f64 = 0.3;
/// Relative size of a violation or multiplier that counts as zero.
const NOTHING: f64 = 1e-12;
/// The first shift that is tried, and by what it grows until it is enough: too much of it makes steps short.
const LEAST: f64 = 1e-4;
const MORE: f64 = 3.0;
/// Rows shorter than this count as zero.
const SHORT: f64 = 1e-12;

/// The problem, its answer, and the factors, which serve for corrections. Keeps its space.
#[derive(Clone, Debug, Default)]
pub(crate) struct QuadraticProgram {
    /// Number of unknowns.
    pub(crate) n: usize,
    /// `H`; the upper triangle is read.
    pub(crate) matrix: Vec<f64>,
    pub(crate) slope: Vec<f64>,
    /// `A`, row after row.
    pub(crate) rows: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    /// Bounds of each unknown.
    pub(crate) least: Vec<f64>,
    pub(crate) most: Vec<f64>,
    /// The first unknowns, which the shift is added to; the others only get a trace.
    pub(crate) shifted: usize,
    /// What one of shift adds to the diagonal.
    pub(crate) unit: f64,
    /// The answer, and the multipliers of the rows.
    pub(crate) step: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    /// `H` with the squares of equations added, upper triangle, the weight of each, and `g` with their pulls.
    stiff: Vec<f64>,
    weights: Vec<f64>,
    pull: Vec<f64>,
    /// Is each unknown held at a bound, each row at a limit: -1, 0 or 1?
    held: Vec<i8>,
    kept: Vec<i8>,
    free: Vec<usize>,
    on: Vec<usize>,
    /// `[R V z]` over `[. S -]`, see [`QuadraticProgram::factorise`].
    factor: Vec<f64>,
    table: Vec<f64>,
    /// `H d`, or `M d` of what is held.
    bent: Vec<f64>,
    answer: Vec<f64>,
}

impl QuadraticProgram {
    /// Forgets what was held.
    pub(crate) fn forget(&mut self) {
        self.held.clear();
        self.kept.clear();
    }

    /// Solves with at least `shift`; returns the shift that was needed. `false` if no shift helps.
    pub(crate) fn solve(&mut self, mut shift: f64) -> Option<f64> {
        let (n, m) = (self.n, self.lower.len());
        self.held.resize(n, 0);
        self.kept.resize(m, 0);
        self.step.resize(n, 0.0);
        self.bent.resize(n, 0.0);
        self.stiffen();
        for round in 0..ROUNDS {
            self.choose();
            loop {
                self.fill();
                if self.factorise(shift) {
                    break;
                }
                shift = (MORE * shift).max(LEAST);
                if shift > 1e6 {
                    return None;
                }
            }
            self.answer();
            if !self.put_right(2 * round < ROUNDS) {
                break;
            }
        }
        for (d, (least, most)) in self.step.iter_mut().zip(self.least.iter().zip(&self.most)) {
            *d = d.clamp(*least, *most);
        }
        self.bent.fill(0.0);
        for (j, d) in self.step.iter().enumerate() {
            add_symmetric_column(&mut self.bent, *d, &self.matrix, j);
        }
        let finite = self.step.iter().chain(&self.multipliers).all(|number| number.is_finite());
        finite.then_some(shift)
    }

    /// The least change of the last answer, measured by `M`, that changes the rows that are held by `change`.
    pub(crate) fn correct(&mut self, change: impl Fn(usize) -> f64, correction: &mut [f64]) {
        let (k, q) = (self.free.len(), self.on.len());
        let w = padded_width(k + q + 1);
        self.answer.clear();
        self.answer.extend(self.on.iter().map(|row| change(*row)));
        self.solve_schur();
        let mut z = std::mem::take(&mut self.table);
        z.clear();
        z.extend((0..k).map(|i| dot(&self.factor[i * w + k..i * w + k + q], &self.answer)));
        solve_upper(&self.factor, w, &mut z);
        correction.fill(0.0);
        self.free.iter().zip(&z).for_each(|(i, z)| correction[*i] = *z);
        self.table = z;
    }

    /// Is the row an equation, or held at a limit?
    pub(crate) fn holds(&self, row: usize) -> bool {
        self.lower[row] == self.upper[row] || self.kept[row] != 0
    }

    /// How often the answer can be taken before a bound or a row's limit is met, other than those it stays at; at least once.
    pub(crate) fn room(&self) -> f64 {
        let limit = |least: f64, most: f64, d: f64| match d {
            d if d > NOTHING => most / d,
            d if d < -NOTHING => least / d,
            _ => f64::INFINITY,
        };
        let bounds = self.step.iter().zip(self.least.iter().zip(&self.most));
        let room = bounds.fold(f64::INFINITY, |room, (d, (least, most))| room.min(limit(*least, *most, *d)));
        let rows = self.rows.chunks_exact(self.n).zip(self.lower.iter().zip(&self.upper));
        let rows = rows.filter(|(_, (lower, upper))| lower != upper);
        let room = rows.fold(room, |room, (row, (l, u))| room.min(limit(*l, *u, dot(row, &self.step))));
        room.max(1.0)
    }

    /// `d^T H d` of the answer.
    pub(crate) fn bend(&self) -> f64 {
        dot(&self.bent, &self.step)
    }

    /// What serves every guess: equations are always held.
    fn stiffen(&mut self) {
        let n = self.n;
        let size = (0..n).fold(0.0, |size: f64, i| size.max(self.matrix[i * n + i].abs()));
        self.stiff.clone_from(&self.matrix);
        self.pull.clone_from(&self.slope);
        self.weights.clear();
        for (r, row) in self.rows.chunks_exact(n).enumerate() {
            let square = dot(row, row);
            let weight = if square > SHORT { FAST * size / square } else { 0.0 };
            self.weights.push(weight);
            if self.lower[r] == self.upper[r] {
                add_scaled(&mut self.pull, -weight * self.lower[r], row);
            }
        }
        let (lower, upper, weights) = (&self.lower, &self.upper, &self.weights);
        add_outer_products(&mut self.stiff, n, &self.rows, |r| if lower[r] == upper[r] { weights[r] } else { 0.0 });
    }

    /// What is free, what is held.
    fn choose(&mut self) {
        self.free.clear();
        self.free.extend((0..self.n).filter(|i| self.held[*i] == 0));
        if 2 * self.free.len() < self.n {
            self.held.fill(0);
            self.free.clear();
            self.free.extend(0..self.n);
        }
        for (i, held) in self.held.iter().enumerate() {
            self.step[i] = match held {
                0 => 0.0,
                -1 => self.least[i],
                _ => self.most[i],
            };
        }
        self.on.clear();
        for row in 0..self.lower.len() {
            if self.lower[row] == self.upper[row] || self.kept[row] != 0 {
                self.on.push(row);
            }
        }
    }

    /// `[M A^T -g; 0 0 c]` over what is free and held.
    fn fill(&mut self) {
        let (n, k, q) = (self.n, self.free.len(), self.on.len());
        let w = padded_width(k + q + 1);
        self.factor.resize((k + q) * w, 0.0);
        let all = k == n;
        self.bent.fill(0.0);
        for (j, held) in self.held.iter().enumerate() {
            if *held != 0 {
                add_symmetric_column(&mut self.bent, self.step[j], &self.stiff, j);
            }
        }
        for (a, &i) in self.free.iter().enumerate() {
            let (from, to) = (&self.stiff[i * n..(i + 1) * n], &mut self.factor[a * w..(a + 1) * w]);
            let pull = self.pull[i] + self.bent[i];
            to[block_start(a)..a].fill(0.0);
            if all {
                to[a..k].copy_from_slice(&from[a..]);
            } else {
                to[a..k].iter_mut().zip(&self.free[a..]).for_each(|(to, j)| *to = from[*j]);
            }
            for (to, row) in to[k..].iter_mut().zip(&self.on) {
                *to = self.rows[row * n + i];
            }
            to[k + q] = -pull;
            to[k + q + 1..].fill(0.0);
        }
        for (r, &row) in self.on.iter().enumerate() {
            let from = &self.rows[row * n..(row + 1) * n];
            let target = if self.kept[row] > 0 { self.upper[row] } else { self.lower[row] };
            let target = target - if all { 0.0 } else { dot(from, &self.step) };
            let line = &mut self.factor[(k + r) * w..(k + r + 1) * w];
            line.fill(0.0);
            line[k + q] = target;
            if self.lower[row] == self.upper[row] {
                continue;
            }
            // The square of a limit that is held.
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
    fn factorise(&mut self, shift: f64) -> bool {
        let (k, q) = (self.free.len(), self.on.len());
        let w = padded_width(k + q + 1);
        let (mut posture, mut forces) = (0f64, 0f64);
        for (a, &i) in self.free.iter().enumerate() {
            let size = self.factor[a * w + a].abs();
            if i < self.shifted { posture = posture.max(size) } else { forces = forces.max(size) }
        }
        for (a, &i) in self.free.iter().enumerate() {
            let more = if i < self.shifted { shift * self.unit + FLAT * posture } else { FLAT * forces };
            self.factor[a * w + a] += more;
        }
        if !blocked_cholesky(&mut self.factor, w, 0, k) {
            return false;
        }
        // Rows that say the same twice.
        let trace = (k..k + q).fold(0.0, |most: f64, r| most.max(-self.factor[r * w + r])) * NOTHING;
        for r in k..k + q {
            let line = &mut self.factor[r * w..(r + 1) * w];
            line[k..].iter_mut().for_each(|entry| *entry = -*entry);
            line[r] += trace;
        }
        blocked_cholesky(&mut self.factor, w, k, k + q)
    }

    /// Step and multipliers from the factors.
    fn answer(&mut self) {
        let (k, q) = (self.free.len(), self.on.len());
        let w = padded_width(k + q + 1);
        self.answer.clear();
        self.answer.extend((k..k + q).map(|r| self.factor[r * w + k + q]));
        solve_upper(self.factor.get(k * w + k..).unwrap_or_default(), w, &mut self.answer);
        let mut z = std::mem::take(&mut self.table);
        z.clear();
        z.extend((0..k).map(|i| {
            let line = &self.factor[i * w..(i + 1) * w];
            line[k + q] - dot(&line[k..k + q], &self.answer)
        }));
        solve_upper(&self.factor, w, &mut z);
        self.free.iter().zip(&z).for_each(|(i, z)| self.step[*i] = *z);
        self.table = z;
        self.multipliers.clear();
        self.multipliers.resize(self.lower.len(), 0.0);
        self.on.iter().zip(&self.answer).for_each(|(row, y)| self.multipliers[*row] = *y);
    }

    /// `S^-1` of what stands in `answer`.
    fn solve_schur(&mut self) {
        let (k, q) = (self.free.len(), self.on.len());
        let w = padded_width(k + q + 1);
        let schur = self.factor.get(k * w + k..).unwrap_or_default();
        solve_upper_transposed(schur, w, &mut self.answer);
        solve_upper(schur, w, &mut self.answer);
    }

    /// Adds what is violated, lets go what pulls; `true` if anything changed.
    fn put_right(&mut self, let_go: bool) -> bool {
        let n = self.n;
        let mut changed = false;
        if let_go {
            for i in 0..n {
                if self.held[i] == 0 {
                    continue;
                }
                let above: f64 = (0..i).map(|j| self.matrix[j * n + i] * self.step[j]).sum();
                let mut pull = self.slope[i] + above + dot(&self.matrix[i * n + i..(i + 1) * n], &self.step[i..]);
                for &row in &self.on {
                    pull += self.multipliers[row] * self.rows[row * n + i];
                }
                if pull * f64::from(self.held[i]) > 1e3 * NOTHING * self.slope[i].abs() {
                    self.held[i] = 0;
                    changed = true;
                }
            }
        }
        let excess = |i: usize| (self.least[i] - self.step[i]).max(self.step[i] - self.most[i]);
        let worst = self.free.iter().fold(0.0, |worst: f64, i| worst.max(excess(*i)));
        if worst > NOTHING {
            for &i in &self.free {
                if excess(i) >= WORST * worst {
                    self.held[i] = if self.step[i] < self.least[i] { -1 } else { 1 };
                    changed = true;
                }
            }
        }
        for row in 0..self.lower.len() {
            if self.lower[row] == self.upper[row] {
                continue;
            }
            let pull = self.multipliers[row];
            if self.kept[row] != 0 {
                if let_go && pull * f64::from(self.kept[row]) < 0.0 {
                    self.kept[row] = 0;
                    changed = true;
                }
                continue;
            }
            let value = dot(&self.rows[row * n..(row + 1) * n], &self.step);
            let side = i8::from(value > self.upper[row] + NOTHING) - i8::from(value < self.lower[row] - NOTHING);
            changed |= side != 0;
            self.kept[row] = side;
        }
        changed
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{
        DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
    };
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const SEED: u64 = 31;

    /// A problem as a descent meets it: the step 0 need not hold, but some step does.
    fn random_problem(random: &mut Pcg64Mcg, bent_down: bool) -> QuadraticProgram {
        let n = random.random_range(20..70);
        let equations = random.random_range(0..=n / 3);
        let rows = equations + random.random_range(0..=n / 2);
        let mut numbers = |count: usize| (0..count).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
        let mut problem = QuadraticProgram { n, shifted: n, unit: 1.0, ..QuadraticProgram::default() };
        problem.slope = numbers(n);
        problem.rows = numbers(rows * n);
        problem.matrix = vec![0.0; n * n];
        for (k, row) in numbers(2 * n * n).chunks_exact(n).enumerate() {
            // From stiff to soft, as effort is.
            let weight = 10f64.powf(-3.0 * k as f64 / (2 * n) as f64);
            for i in 0..n {
                add_scaled(&mut problem.matrix[i * n + i..(i + 1) * n], weight * row[i], &row[i..]);
            }
        }
        let (inside, room) = (numbers(n), numbers(rows + 2 * n));
        let room: Vec<f64> = room.iter().map(|x| if *x < -0.5 { 0.0 } else { x.abs() }).collect();
        for (r, row) in problem.rows.chunks_exact(n).enumerate() {
            let value = dot(row, &inside);
            let (lower, upper) = match r {
                r if r < equations => (value, value),
                r if r % 2 == 0 => (value - room[r], f64::INFINITY),
                _ => (f64::NEG_INFINITY, value + room[r]),
            };
            problem.lower.push(lower);
            problem.upper.push(upper);
        }
        for (i, x) in inside.iter().enumerate() {
            let bounded = i % 3 == 0;
            problem.least.push(if bounded { x.min(0.0) - room[rows + 2 * i] } else { f64::NEG_INFINITY });
            problem.most.push(if bounded { x.max(0.0) + room[rows + 2 * i + 1] } else { f64::INFINITY });
        }
        if bent_down {
            // Along what equations hold fast, effort may bend down as it likes.
            for row in problem.rows[..equations * n].chunks_exact(n) {
                for i in 0..n {
                    add_scaled(&mut problem.matrix[i * n + i..(i + 1) * n], -0.5 * row[i], &row[i..]);
                }
                add_scaled(&mut problem.slope, 0.5 * dot(row, &inside), row);
            }
        }
        problem
    }

    /// The same by an interior-point method; where the matrix bends down it is given the square of each equation.
    fn clarabel(problem: &QuadraticProgram, bent_down: bool) -> Option<Vec<f64>> {
        let (n, m) = (problem.n, problem.lower.len());
        let (mut matrix, mut slope) = (problem.matrix.clone(), problem.slope.clone());
        let equation = |r: &usize| problem.lower[*r] == problem.upper[*r];
        let row = |r: usize| &problem.rows[r * n..(r + 1) * n];
        let (mut lines, mut limits): (Vec<Vec<f64>>, Vec<f64>) = (vec![], vec![]);
        for r in (0..m).filter(equation) {
            lines.push(row(r).to_vec());
            limits.push(problem.upper[r]);
            if bent_down {
                for i in 0..n {
                    add_scaled(&mut matrix[i * n + i..(i + 1) * n], 0.5 * row(r)[i], &row(r)[i..]);
                }
                add_scaled(&mut slope, -0.5 * problem.upper[r], row(r));
            }
        }
        let equations = lines.len();
        let unit = |i: usize, sign: f64| (0..n).map(|j| if i == j { sign } else { 0.0 }).collect::<Vec<f64>>();
        let sides = (0..m).filter(|r| !equation(r)).map(|r| (row(r).to_vec(), problem.lower[r], problem.upper[r]));
        let bounds = (0..n).map(|i| (unit(i, 1.0), problem.least[i], problem.most[i]));
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
        let mut solver = DefaultSolver::new(&p, &slope, &a, &limits, &cones, settings).unwrap();
        solver.solve();
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved)
            .then(|| solver.solution.x.clone())
    }

    fn compare(bent_down: bool) {
        let mut random = Pcg64Mcg::new(SEED.into());
        let (mut compared, mut worst, mut off) = (0, 0f64, 0f64);
        for _ in 0..600 {
            let mut problem = random_problem(&mut random, bent_down);
            let Some(peer) = clarabel(&problem, bent_down) else { continue };
            assert_eq!(problem.solve(0.0), Some(0.0));
            compared += 1;
            let n = problem.n;
            let value = |d: &[f64]| {
                let upper = |i: usize, j: usize| problem.matrix[i.min(j) * n + i.max(j)];
                dot(&problem.slope, d)
                    + 0.5 * (0..n * n).map(|e| d[e / n] * upper(e / n, e % n) * d[e % n]).sum::<f64>()
            };
            let missing = problem.rows.chunks_exact(n).enumerate().fold(0.0, |most: f64, (r, row)| {
                let value = dot(row, &problem.step);
                most.max(problem.lower[r] - value).max(value - problem.upper[r])
            });
            off = off.max(missing);
            let more = (value(&problem.step) - value(&peer)) / (1.0 + value(&peer).abs());
            worst = worst.max(more.abs());
            let limits = problem.least.iter().zip(&problem.most);
            assert!(problem.step.iter().zip(limits).all(|(d, (least, most))| d >= least && d <= most));
        }
        println!("seed {SEED}: {compared} problems, off by {worst:.1e} at most, rows missed by {off:.1e}");
        assert!(compared > 550 && worst < 1e-6 && off < 1e-9, "{compared} {worst} {off}");
    }

    /// With limits moved away from where the answer met them: taken as often as there is room, it meets one and passes none.
    #[test]
    fn a_step_with_room_meets_a_limit() {
        let mut random = Pcg64Mcg::new(SEED.into());
        let mut longer = 0;
        for _ in 0..200 {
            let mut problem = random_problem(&mut random, false);
            problem.solve(0.0).unwrap();
            for limits in [&mut problem.least, &mut problem.most, &mut problem.lower, &mut problem.upper] {
                limits.iter_mut().for_each(|limit| *limit *= 3.0);
            }
            let room = problem.room();
            longer += usize::from(room > 1.0);
            let n = problem.n;
            let bounds =
                problem.step.iter().zip(problem.least.iter().zip(&problem.most)).map(|(d, (l, u))| (*d, *l, *u));
            let rows = problem.rows.chunks_exact(n).zip(problem.lower.iter().zip(&problem.upper));
            let rows = rows
                .map(|(row, (l, u))| (dot(row, &problem.step), *l, *u))
                .filter(|(_, l, u)| *l <= 0.0 && *u >= 0.0 && l != u);
            let passed: Vec<f64> = bounds.chain(rows).map(|(d, l, u)| (l - room * d).max(room * d - u)).collect();
            let most = passed.iter().fold(f64::NEG_INFINITY, |most, by| most.max(*by));
            assert!(room == 1.0 || most.abs() < 1e-9, "seed {SEED}: {most:e} at {room} times the step");
        }
        assert!(longer > 100, "{longer}");
    }

    #[test]
    fn steps_are_those_of_an_interior_point_method() {
        compare(false);
        compare(true);
    }
}
