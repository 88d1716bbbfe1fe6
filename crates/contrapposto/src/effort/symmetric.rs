//! Symmetric matrices by their upper triangles, row after row.

use hierarchical_least_squares::linalg::{add_fours, add_scaled, add_scaled_fours, dot};

/// Adds `by` times column `j` of a symmetric matrix, of which the upper triangle is read.
pub(crate) fn add_times(matrix: &[f64], j: usize, by: f64, to: &mut [f64]) {
    let n = to.len();
    let (above, below) = to.split_at_mut(j);
    add_scaled(below, by, &matrix[j * n + j..(j + 1) * n]);
    above.iter_mut().zip(matrix[j..].iter().step_by(n)).for_each(|(to, entry)| *to += by * entry);
}

/// Rows are as wide as a whole number of fours, which are added at once.
pub(crate) fn width(count: usize) -> usize {
    count.next_multiple_of(4)
}

/// Where the four of an entry begins. What then lies below the diagonal is written, but never counts.
pub(crate) fn four(i: usize) -> usize {
    i - i % 4
}

/// Eliminates rows `from..to` of a matrix of rows of a [`width`] `w` from all rows below, upper triangle only, four at a time;
/// each becomes a row of a Cholesky factor. `false` where the matrix is not positive.
pub(crate) fn eliminate(matrix: &mut [f64], w: usize, from: usize, to: usize) -> bool {
    let (matrix, w) = (matrix.as_chunks_mut::<4>().0, w / 4);
    let mut p = from;
    while p < to {
        let size = (to - p).min(4);
        let (upper, lower) = matrix.split_at_mut((p + size) * w);
        let pivots = &mut upper[p * w..];
        for c in 0..size {
            let (done, rest) = pivots.split_at_mut(c * w);
            let (start, lane) = ((p + c) / 4, (p + c) % 4);
            let row = &mut rest[start..w];
            for by in done.chunks_exact(w) {
                let by = &by[start..];
                add_scaled_fours(row, -by[0][lane], by);
            }
            let pivot = row[0][lane];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return false;
            }
            let over = 1.0 / pivot.sqrt();
            row.as_flattened_mut().iter_mut().for_each(|entry| *entry *= over);
        }
        for (i, target) in (p + size..).zip(lower.chunks_exact_mut(w)) {
            let (start, lane) = (i / 4, i % 4);
            let target = &mut target[start..];
            if size == 4 {
                let rows = [0, 1, 2, 3].map(|r| &pivots[r * w + start..(r + 1) * w]);
                let by = rows.map(|row| -row[0][lane]);
                if by != [0.0; 4] {
                    add_fours(target, by, rows);
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

/// `R^-1 b` with the factor in the first columns of rows of width `w`.
pub(crate) fn back(factor: &[f64], w: usize, b: &mut [f64]) {
    let k = b.len();
    for i in (0..k).rev() {
        let row = &factor[i * w..i * w + k];
        b[i] = (b[i] - dot(&row[i + 1..], &b[i + 1..])) / row[i];
    }
}
