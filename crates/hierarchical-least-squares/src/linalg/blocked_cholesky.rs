//! Computes Cholesky factors four rows at a time, in rows padded to whole fours.
//!
//! `A = R^T R` on the upper triangle, as in `cholesky`; each group of four rows is subtracted from all rows below at once,
//! which reads and writes every row a quarter as often (Golub & Van Loan 2013, "Matrix Computations", section 4.2.6).

use super::vector::{add_four_scaled, add_scaled_fours};

/// Entries per row of a matrix with so many columns: the next whole number of fours.
pub fn padded_width(columns: usize) -> usize {
    columns.next_multiple_of(4)
}

/// First entry of the four that entry `i` belongs to. Entries of that four below the diagonal are written and never read as
/// part of the factor.
pub fn block_start(i: usize) -> usize {
    i - i % 4
}

/// Eliminates the rows `from..to` of a matrix with rows of a [`padded_width`] from all rows below, upper triangle only; each
/// becomes a row of `R`. Returns `false` where a pivot is not positive and finite.
///
/// Columns behind the last row are right-hand sides, which become `R^-T b`. Rows behind `to` become the Schur complement.
pub fn blocked_cholesky(matrix: &mut [f64], width: usize, from: usize, to: usize) -> bool {
    let (matrix, w) = (matrix.as_chunks_mut::<4>().0, width / 4);
    let mut p = from;
    while p < to {
        let size = (to - p).min(4);
        let (upper, lower) = matrix.split_at_mut((p + size) * w);
        let pivots = &mut upper[p * w..];
        if !factorise_block(pivots, w, p, size) {
            return false;
        }
        for (i, target) in (p + size..).zip(lower.chunks_exact_mut(w)) {
            let (start, lane) = (i / 4, i % 4);
            let target = &mut target[start..];
            if size == 4 {
                let rows = [0, 1, 2, 3].map(|r| &pivots[r * w + start..(r + 1) * w]);
                let factors = rows.map(|row| -row[0][lane]);
                if factors != [0.0; 4] {
                    add_four_scaled(target, factors, rows);
                }
            } else {
                for row in pivots.chunks_exact(w) {
                    add_scaled_fours(target, -row[start][lane], &row[start..]);
                }
            }
        }
        p += size;
    }
    true
}

/// The rows `first..first + size`, eliminated from each other and scaled by the roots of their pivots.
#[inline]
fn factorise_block(rows: &mut [[f64; 4]], w: usize, first: usize, size: usize) -> bool {
    for r in 0..size {
        let (done, rest) = rows.split_at_mut(r * w);
        let (start, lane) = ((first + r) / 4, (first + r) % 4);
        let row = &mut rest[start..w];
        for above in done.chunks_exact(w) {
            let above = &above[start..];
            add_scaled_fours(row, -above[0][lane], above);
        }
        let pivot = row[0][lane];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let scale = 1.0 / pivot.sqrt();
        row.as_flattened_mut().iter_mut().for_each(|entry| *entry *= scale);
    }
    true
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::super::{cholesky, solve_upper};
    use super::*;

    /// Factor and right-hand side beside those of the plain factorisation, in two calls that meet at any row.
    #[test]
    fn factors_in_fours_are_those_of_the_plain_factorisation() {
        let mut random = Pcg64Mcg::new(5);
        for n in 1..=18 {
            let half = DMatrix::from_fn(n, n + 2, |_, _| random.random_range(-1.0..1.0));
            let matrix = &half * half.transpose();
            let mut plain = matrix.as_slice().to_vec();
            assert!(cholesky(&mut plain, n));
            for split in 0..=n {
                let width = padded_width(n + 1);
                let mut blocked = vec![0.0; n * width];
                for (i, row) in blocked.chunks_exact_mut(width).enumerate() {
                    row[i..n].iter_mut().zip(i..).for_each(|(entry, j)| *entry = matrix[(i, j)]);
                    row[n] = 1.0;
                }
                assert!(blocked_cholesky(&mut blocked, width, 0, split));
                assert!(blocked_cholesky(&mut blocked, width, split, n));
                let upper = |i: usize, j: usize| (blocked[i * width + j], plain[i * n + j]);
                let entries = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
                assert!(entries.map(|(i, j)| upper(i, j)).all(|(a, b)| (a - b).abs() < 1e-10));
                let mut x: Vec<f64> = (0..n).map(|i| blocked[i * width + n]).collect();
                solve_upper(&blocked, width, &mut x);
                let back = &matrix * nalgebra::DVector::from_vec(x);
                assert!(back.iter().all(|one| (one - 1.0).abs() < 1e-6), "size {n}");
            }
            let mut indefinite = vec![0.0; n * padded_width(n)];
            assert!(!blocked_cholesky(&mut indefinite, padded_width(n), 0, n));
        }
    }
}
