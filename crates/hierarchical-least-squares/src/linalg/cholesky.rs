//! Computes Cholesky factors of small symmetric matrices.
//!
//! `A = R^T R` with `R` upper triangular, or `A = L L^T` with `L` lower triangular (Golub & Van Loan 2013, "Matrix
//! Computations", sections 4.2.5 and 4.2.8).

use super::vector::dot;

/// Replaces the upper triangle of an `n` by `n` matrix by `R` with `R^T R = A`. Returns `false`, with the matrix half
/// replaced, where a pivot is not positive.
pub fn cholesky(a: &mut [f64], n: usize) -> bool {
    for r in 0..n {
        let (upper, lower) = a.split_at_mut((r + 1) * n);
        let row = &mut upper[r * n..];
        if row[r].is_nan() || row[r] <= 0.0 {
            return false;
        }
        let root = row[r].sqrt();
        row[r..].iter_mut().for_each(|entry| *entry /= root);
        for (below, target) in lower.chunks_exact_mut(n).enumerate() {
            let i = r + 1 + below;
            let factor = row[i];
            if factor != 0.0 {
                target[i..].iter_mut().zip(&row[i..]).for_each(|(entry, by)| *entry -= factor * by);
            }
        }
    }
    true
}

/// Factorises a symmetric `n` by `n` matrix with the largest diagonal entry first, and returns the number of pivots `k`.
///
/// Row `order[r]` of `a`, at the columns `order[r..]`, becomes row `r` of `R`. The factorisation ends where no diagonal entry
/// is above `smallest_pivot`; the Schur complement that is left stands at the rows and columns `order[k..]`.
pub fn pivoted_cholesky(a: &mut [f64], n: usize, order: &mut Vec<usize>, smallest_pivot: f64) -> usize {
    order.clear();
    order.extend(0..n);
    for r in 0..n {
        let best = (r..n).fold(
            r,
            |best, i| {
                if a[order[i] * n + order[i]] > a[order[best] * n + order[best]] { i } else { best }
            },
        );
        let p = order[best];
        if a[p * n + p] <= smallest_pivot {
            return r;
        }
        order.swap(r, best);
        let root = a[p * n + p].sqrt();
        a[p * n + p] = root;
        let rest = &order[r + 1..];
        for &j in rest {
            a[p * n + j] /= root;
        }
        for &i in rest {
            let factor = a[p * n + i];
            if factor == 0.0 {
                continue;
            }
            for &j in rest {
                a[i * n + j] -= factor * a[p * n + j];
            }
        }
    }
    n
}

/// Replaces the lower triangle of a positive semidefinite `n` by `n` matrix by `L` with `L L^T = A`, and returns its rank.
///
/// A row whose pivot is not above `smallest(A[r][r])` depends on the rows before it: its diagonal entry and its column become
/// zero, and the triangular solves of this module answer zero for it.
pub fn semidefinite_cholesky(a: &mut [f64], n: usize, smallest: impl Fn(f64) -> f64) -> usize {
    let mut rank = 0;
    for r in 0..n {
        let (before, row) = a.split_at_mut(r * n);
        for c in 0..r {
            let other = &before[c * n..c * n + c + 1];
            row[c] = if other[c] > 0.0 { (row[c] - dot(&row[..c], &other[..c])) / other[c] } else { 0.0 };
        }
        let pivot = row[r] - dot(&row[..r], &row[..r]);
        let independent = pivot > smallest(row[r]);
        row[r] = if independent { pivot.sqrt() } else { 0.0 };
        rank += usize::from(independent);
    }
    rank
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::{solve_lower, solve_lower_transposed};
    use super::*;

    /// `rows` random rows of `n` entries, and `G G^T`.
    fn gram(random: &mut Pcg64Mcg, n: usize, rows: usize) -> DMatrix<f64> {
        let half = DMatrix::from_fn(n, rows, |_, _| random.random_range(-1.0..1.0));
        &half * half.transpose()
    }

    fn by_rows(matrix: &DMatrix<f64>) -> Vec<f64> {
        matrix.transpose().as_slice().to_vec()
    }

    #[test]
    fn plain_factor_gives_the_matrix_back_and_refuses_an_indefinite_one() {
        let mut random = Pcg64Mcg::new(1);
        for n in 0..=20 {
            let matrix = gram(&mut random, n, n + 2);
            let mut factor = by_rows(&matrix);
            assert!(cholesky(&mut factor, n));
            let upper = DMatrix::from_fn(n, n, |i, j| if i <= j { factor[i * n + j] } else { 0.0 });
            assert!((upper.transpose() * &upper - &matrix).abs().sum() < 1e-11);
            if n > 0 {
                let mut indefinite = by_rows(&(matrix - DMatrix::identity(n, n) * 100.0));
                assert!(!cholesky(&mut indefinite, n));
            }
        }
    }

    #[test]
    fn pivoted_factor_and_schur_complement_give_an_indefinite_matrix_back() {
        let mut random = Pcg64Mcg::new(2);
        for n in 1..=20 {
            let matrix = gram(&mut random, n, n) - gram(&mut random, n, 2);
            let (mut factor, mut order) = (by_rows(&matrix), vec![]);
            let rank = pivoted_cholesky(&mut factor, n, &mut order, 1e-9);
            let mut back = DMatrix::zeros(n, n);
            for r in 0..rank {
                let mut row = DVector::zeros(n);
                order[r..].iter().for_each(|&j| row[j] = factor[order[r] * n + j]);
                back += &row * row.transpose();
            }
            for &i in &order[rank..] {
                order[rank..].iter().for_each(|&j| back[(i, j)] += factor[i * n + j]);
                assert!(factor[i * n + i] <= 1e-9);
            }
            assert!((back - &matrix).abs().max() < 1e-11, "size {n}");
        }
    }

    #[test]
    fn semidefinite_factor_finds_the_rank_and_solves_consistent_systems() {
        let mut random = Pcg64Mcg::new(3);
        for n in 1..=20_usize {
            let rank = n.div_ceil(2);
            let matrix = gram(&mut random, n, rank);
            let mut factor = by_rows(&matrix);
            assert_eq!(semidefinite_cholesky(&mut factor, n, |diagonal| 1e-10 * diagonal), rank);
            let x = DVector::from_fn(n, |_, _| random.random_range(-1.0..1.0));
            let right = &matrix * &x;
            let mut solution = right.as_slice().to_vec();
            solve_lower(&factor, n, &mut solution);
            solve_lower_transposed(&factor, n, &mut solution);
            assert!((&matrix * DVector::from_vec(solution) - right).norm() < 1e-9, "size {n}");
        }
    }
}
