//! Solves triangular systems of factors that are stored row after row, `width` entries a row.
//!
//! An unknown whose diagonal entry is zero depends on the others ([`super::semidefinite_cholesky`]); its value is zero.

use super::vector::{add_scaled, dot};

/// Replaces `b` by the solution of `L x = b`.
pub fn solve_lower(factor: &[f64], width: usize, b: &mut [f64]) {
    for r in 0..b.len() {
        let row = &factor[r * width..=r * width + r];
        b[r] = if row[r] == 0.0 { 0.0 } else { (b[r] - dot(&row[..r], &b[..r])) / row[r] };
    }
}

/// Replaces `b` by the solution of `L^T x = b`.
pub fn solve_lower_transposed(factor: &[f64], width: usize, b: &mut [f64]) {
    for r in (0..b.len()).rev() {
        let diagonal = factor[r * width + r];
        let rest: f64 = (r + 1..b.len()).map(|s| factor[s * width + r] * b[s]).sum();
        b[r] = if diagonal == 0.0 { 0.0 } else { (b[r] - rest) / diagonal };
    }
}

/// Replaces `b` by the solution of `R x = b`.
pub fn solve_upper(factor: &[f64], width: usize, b: &mut [f64]) {
    let n = b.len();
    for r in (0..n).rev() {
        let row = &factor[r * width..r * width + n];
        b[r] = (b[r] - dot(&row[r + 1..], &b[r + 1..])) / row[r];
    }
}

/// Replaces `b` by the solution of `R^T x = b`.
pub fn solve_upper_transposed(factor: &[f64], width: usize, b: &mut [f64]) {
    let n = b.len();
    for r in 0..n {
        let row = &factor[r * width..r * width + n];
        b[r] /= row[r];
        let value = b[r];
        add_scaled(&mut b[r + 1..], -value, &row[r + 1..]);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn solutions_satisfy_their_systems_at_any_width() {
        let mut random = Pcg64Mcg::new(4);
        for n in 0..=20 {
            let width = n + 3;
            let mut full = DMatrix::from_fn(n, width, |_, _| random.random_range(-1.0..1.0));
            (0..n).for_each(|i| full[(i, i)] += 8.0);
            let factor = full.transpose().as_slice().to_vec();
            let square = full.columns(0, n).into_owned();
            let (lower, upper) = (square.lower_triangle(), square.upper_triangle());
            let right = DVector::from_fn(n, |_, _| random.random_range(-1.0..1.0));
            let solved = |solve: fn(&[f64], usize, &mut [f64])| {
                let mut x = right.as_slice().to_vec();
                solve(&factor, width, &mut x);
                DVector::from_vec(x)
            };
            assert!((&lower * solved(solve_lower) - &right).norm() < 1e-13);
            assert!((lower.transpose() * solved(solve_lower_transposed) - &right).norm() < 1e-13);
            assert!((&upper * solved(solve_upper) - &right).norm() < 1e-13);
            assert!((upper.transpose() * solved(solve_upper_transposed) - &right).norm() < 1e-13);
        }
    }
}
