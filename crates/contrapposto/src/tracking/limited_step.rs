//! Finds the least value of a convex quadratic function within limits of each unknown.
//!
//! A primal active-set method: unknowns at a limit leave the linear system until their multiplier has the wrong sign (Nocedal & Wright
//! 2006, "Numerical Optimization", algorithm 16.3, for bounds). Does not allocate after the first call.

use hierarchical_least_squares::linalg::{cholesky, dot, solve_upper, solve_upper_transposed};

use super::tolerances::NO_MULTIPLIER;

/// State of an unknown in the working set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum At {
    Free,
    Low,
    High,
}

/// Workspace for `n` unknowns. Filled by [`LimitedStep::solve`].
#[derive(Clone, Debug)]
pub(super) struct LimitedStep {
    /// The least point.
    pub(super) step: Vec<f64>,
    at: Vec<At>,
    free: Vec<usize>,
    matrix: Vec<f64>,
    right: Vec<f64>,
    slope: Vec<f64>,
}

impl LimitedStep {
    pub(super) fn new(n: usize) -> Self {
        Self {
            step: vec![0.0; n],
            at: vec![At::Free; n],
            free: Vec::with_capacity(n),
            matrix: vec![0.0; n * n],
            right: vec![0.0; n],
            slope: vec![0.0; n],
        }
    }

    /// Minimises `gradient . s + 1/2 s . matrix s` within `limits`, which hold `s = 0`; `matrix` symmetric, row after row. Answers the decrease,
    /// or `None` where the matrix is not positive definite.
    pub(super) fn solve(&mut self, matrix: &[f64], gradient: &[f64], limits: &[(f64, f64)]) -> Option<f64> {
        let n = gradient.len();
        if n == 0 {
            return Some(0.0);
        }
        self.step.fill(0.0);
        for ((at, g), (low, high)) in self.at.iter_mut().zip(gradient).zip(limits) {
            *at = match () {
                () if *low >= 0.0 && *g >= 0.0 => At::Low,
                () if *high <= 0.0 && *g <= 0.0 => At::High,
                () => At::Free,
            };
        }
        // Each pass adds or releases one unknown; a convex problem ends before, but for rounding.
        let mut whole = false;
        for _ in 0..4 * n + 4 {
            self.slope.copy_from_slice(gradient);
            for (slope, row) in self.slope.iter_mut().zip(matrix.chunks_exact(n)) {
                *slope += dot(row, &self.step);
            }
            if whole && !self.release() {
                break;
            }
            if !self.newton(matrix, n) {
                return None;
            }
            whole = !self.advance(limits);
        }
        let curved: f64 = matrix.chunks_exact(n).zip(&self.step).map(|(row, s)| s * dot(row, &self.step)).sum();
        Some(-dot(gradient, &self.step) - 0.5 * curved)
    }

    /// The step of the free unknowns to their least point, in `right`. Answers whether the matrix is positive definite there.
    fn newton(&mut self, matrix: &[f64], n: usize) -> bool {
        self.free.clear();
        self.free.extend((0..n).filter(|&i| self.at[i] == At::Free));
        let k = self.free.len();
        for (r, &i) in self.free.iter().enumerate() {
            for (c, &j) in self.free.iter().enumerate().skip(r) {
                self.matrix[r * k + c] = matrix[i * n + j];
            }
            self.right[r] = -self.slope[i];
        }
        if !cholesky(&mut self.matrix[..k * k], k) {
            return false;
        }
        solve_upper_transposed(&self.matrix[..k * k], k, &mut self.right[..k]);
        solve_upper(&self.matrix[..k * k], k, &mut self.right[..k]);
        self.right[..k].iter().all(|x| x.is_finite())
    }

    /// Goes along `right` as far as the limits allow. Answers whether one of them was met.
    fn advance(&mut self, limits: &[(f64, f64)]) -> bool {
        let (mut share, mut met) = (1.0, None);
        for (&i, &by) in self.free.iter().zip(&self.right) {
            let (low, high) = limits[i];
            let (limit, at) = if by < 0.0 { (low, At::Low) } else { (high, At::High) };
            let room = limit - self.step[i];
            if by.abs() * share > room.abs() {
                (share, met) = (room / by, Some((i, limit, at)));
            }
        }
        for (&i, &by) in self.free.iter().zip(&self.right) {
            self.step[i] += share * by;
        }
        if let Some((i, limit, at)) = met {
            (self.step[i], self.at[i]) = (limit, at);
        }
        met.is_some()
    }

    /// Frees the unknown whose multiplier is the most wrong. Answers whether there is one.
    fn release(&mut self) -> bool {
        let size = self.slope.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let wrong = |i: usize| match self.at[i] {
            At::Free => 0.0,
            At::Low => -self.slope[i],
            At::High => self.slope[i],
        };
        let worst = (0..self.at.len()).max_by(|&a, &b| wrong(a).total_cmp(&wrong(b)));
        match worst.filter(|&i| wrong(i) > NO_MULTIPLIER * size) {
            Some(i) => {
                self.at[i] = At::Free;
                true
            }
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::LimitedStep;

    /// The least value over all ways to put unknowns at their limits.
    fn brute_force(matrix: &DMatrix<f64>, gradient: &DVector<f64>, limits: &[(f64, f64)]) -> f64 {
        let n = gradient.len();
        let mut least = f64::INFINITY;
        for choice in 0..3_usize.pow(n as u32) {
            let at = |i: usize| (choice / 3_usize.pow(i as u32)) % 3;
            let free: Vec<usize> = (0..n).filter(|&i| at(i) == 0).collect();
            let mut s = DVector::from_fn(n, |i, _| [0.0, limits[i].0, limits[i].1][at(i)]);
            let slope = gradient + matrix * &s;
            let inner = DMatrix::from_fn(free.len(), free.len(), |r, c| matrix[(free[r], free[c])]);
            let right = DVector::from_fn(free.len(), |r, _| -slope[free[r]]);
            let solved = inner.try_inverse().unwrap() * right;
            free.iter().zip(solved.iter()).for_each(|(&i, x)| s[i] = *x);
            if s.iter().zip(limits).all(|(x, (low, high))| (*low..=*high).contains(x)) {
                least = least.min(gradient.dot(&s) + 0.5 * s.dot(&(matrix * &s)));
            }
        }
        least
    }

    #[test]
    fn least_values_within_limits_are_those_of_brute_force() {
        let mut random = Pcg64Mcg::new(2025);
        let mut at_limits = 0;
        for round in 0..2000 {
            let n = 1 + round % 5;
            let half = DMatrix::from_fn(n, n + 1, |_, _| random.random_range(-1.0..1.0));
            let matrix = &half * half.transpose() + DMatrix::identity(n, n) * 1e-3;
            let gradient = DVector::from_fn(n, |_, _| random.random_range(-1.0..1.0));
            let mut limit = || if random.random_range(0..4) == 0 { 0.0 } else { random.random_range(0.0..0.8) };
            let limits: Vec<(f64, f64)> = (0..n).map(|_| (-limit(), limit())).collect();
            let mut step = LimitedStep::new(n);
            let by_rows = matrix.as_slice();
            let decrease = step.solve(by_rows, gradient.as_slice(), &limits).unwrap();
            assert!(step.step.iter().zip(&limits).all(|(s, (low, high))| (*low..=*high).contains(s)));
            let least = brute_force(&matrix, &gradient, &limits);
            assert!((decrease + least).abs() < 1e-11, "round {round}: {decrease} against {}", -least);
            at_limits += step.at.iter().filter(|at| **at != super::At::Free).count();
        }
        assert!(at_limits > 1000, "{at_limits}");
    }

    #[test]
    fn an_indefinite_matrix_is_told() {
        let mut step = LimitedStep::new(1);
        assert_eq!(step.solve(&[-1.0], &[0.5], &[(-1.0, 1.0)]), None);
    }
}
