//! Symmetric matrices by their upper triangles, row after row.

use crate::math::lexicographic::{add_scaled, dot};

/// Adds `by` times column `j` of a symmetric matrix, of which the upper triangle is read.
pub(super) fn add_times(matrix: &[f64], j: usize, by: f64, to: &mut [f64]) {
    let n = to.len();
    let (above, below) = to.split_at_mut(j);
    add_scaled(below, by, &matrix[j * n + j..(j + 1) * n]);
    above.iter_mut().zip(matrix[j..].iter().step_by(n)).for_each(|(to, entry)| *to += by * entry);
}

/// Eliminates rows `from..to` of a matrix of rows of width `w` from all rows below, upper triangle only, four at a time; each
/// becomes that of a Cholesky factor. `false` where the matrix is not positive.
pub(super) fn eliminate(matrix: &mut [f64], w: usize, from: usize, to: usize) -> bool {
    let mut p = from;
    while p < to {
        let size = (to - p).min(4);
        let (upper, lower) = matrix.split_at_mut((p + size) * w);
        for c in p..p + size {
            let (done, rest) = upper.split_at_mut(c * w);
            let row = &mut rest[..w];
            for by in p..c {
                let by = &done[by * w..(by + 1) * w];
                let factor = by[c];
                add_scaled(&mut row[c..], -factor, &by[c..]);
            }
            if !(row[c] > 0.0 && row[c].is_finite()) {
                return false;
            }
            let over = 1.0 / row[c].sqrt();
            row[c..].iter_mut().for_each(|entry| *entry *= over);
        }
        let rows = &upper[p * w..];
        if size == 4 {
            let (a, rest) = rows.split_at(w);
            let (b, rest) = rest.split_at(w);
            let (c, d) = rest.split_at(w);
            for (i, target) in lower.chunks_exact_mut(w).enumerate() {
                let i = p + 4 + i;
                let (fa, fb, fc, fd) = (a[i], b[i], c[i], d[i]);
                if fa == 0.0 && fb == 0.0 && fc == 0.0 && fd == 0.0 {
                    continue;
                }
                let sources = a[i..].iter().zip(&b[i..]).zip(c[i..].iter().zip(&d[i..]));
                for (entry, ((a, b), (c, d))) in target[i..].iter_mut().zip(sources) {
                    *entry -= (fa * a + fb * b) + (fc * c + fd * d);
                }
            }
        } else {
            for (i, target) in lower.chunks_exact_mut(w).enumerate() {
                let i = p + size + i;
                for row in rows.chunks_exact(w) {
                    add_scaled(&mut target[i..], -row[i], &row[i..]);
                }
            }
        }
        p += size;
    }
    true
}

/// `R^-1 b` with the factor in the first columns of rows of width `w`.
pub(super) fn back(factor: &[f64], w: usize, b: &mut [f64]) {
    let k = b.len();
    for i in (0..k).rev() {
        let row = &factor[i * w..i * w + k];
        b[i] = (b[i] - dot(&row[i + 1..], &b[i + 1..])) / row[i];
    }
}
