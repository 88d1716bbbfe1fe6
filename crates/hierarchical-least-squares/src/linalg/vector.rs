//! Computes sums and products of vectors, in a fixed order that does not depend on the machine.
//!
//! The loops name groups of four numbers explicitly: the compiler on its own gathers numbers of several iterations of such a
//! loop first, which takes up to three times as long.

use wide::f64x4;

/// Four numbers.
#[inline]
fn lanes(numbers: &[f64; 4]) -> f64x4 {
    f64x4::new(*numbers)
}

/// `a^T b`, in eight partial sums.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [f64x4::ZERO; 2];
    for (x, y) in a.iter().zip(b) {
        add_products(&mut sums, x, y);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    sum(sums) + rest
}

/// Adds eight products, each to its partial sum.
#[inline]
fn add_products(sums: &mut [f64x4; 2], x: &[f64; 8], y: &[f64; 8]) {
    for (sum, (x, y)) in sums.iter_mut().zip(x.as_chunks::<4>().0.iter().zip(y.as_chunks::<4>().0)) {
        *sum += lanes(x) * lanes(y);
    }
}

/// The total of eight partial sums.
#[inline]
fn sum([a, b]: [f64x4; 2]) -> f64 {
    let [a, b, c, d] = (a + b).to_array();
    (a + b) + (c + d)
}

/// `y += s x`.
#[inline]
pub fn add_scaled(y: &mut [f64], s: f64, x: &[f64]) {
    let ((y, y_rest), (x, x_rest)) = (y.as_chunks_mut(), x.as_chunks());
    add_scaled_fours(y, s, x);
    for (y, x) in y_rest.iter_mut().zip(x_rest) {
        *y += s * x;
    }
}

/// `matrix += weight row row^T`. Zeros of `row` are skipped.
#[inline]
pub fn add_outer_product(matrix: &mut [f64], row: &[f64], weight: f64) {
    for (to, a) in matrix.chunks_exact_mut(row.len().max(1)).zip(row) {
        if *a != 0.0 {
            add_scaled(to, weight * a, row);
        }
    }
}

/// `y += sum_r factors_r x_r` of four rows, in whole groups of four entries.
#[inline]
pub(super) fn add_four_scaled(y: &mut [[f64; 4]], factors: [f64; 4], [a, b, c, d]: [&[[f64; 4]]; 4]) {
    let [p, q, r, s] = factors.map(f64x4::splat);
    for (y, ((a, b), (c, d))) in y.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d))) {
        let more = (p * lanes(a) + q * lanes(b)) + (r * lanes(c) + s * lanes(d));
        *y = (lanes(y) + more).to_array();
    }
}

/// `y += s x`, in whole groups of four entries.
#[inline]
pub(super) fn add_scaled_fours(y: &mut [[f64; 4]], s: f64, x: &[[f64; 4]]) {
    let scale = f64x4::splat(s);
    for (y, x) in y.iter_mut().zip(x) {
        *y = (lanes(y) + scale * lanes(x)).to_array();
    }
}

/// `matrix += sum_r weight(r) row_r row_r^T` on and above the diagonal; rows of width `n`, one after the other. Zeros that four
/// consecutive rows have at their end are skipped.
pub fn add_outer_products(matrix: &mut [f64], n: usize, rows: &[f64], weight: impl Fn(usize) -> f64) {
    for (block, rows) in rows.chunks(4 * n).enumerate() {
        let mut parts: [&[f64]; 4] = [&rows[..n]; 4];
        let mut weights = [0.0; 4];
        for (r, row) in rows.chunks_exact(n).enumerate() {
            (parts[r], weights[r]) = (row, weight(4 * block + r));
        }
        let end =
            parts.iter().filter_map(|row| row.iter().rposition(|entry| *entry != 0.0)).max().map_or(0, |last| last + 1);
        let [a, b, c, d] = parts.map(|row| &row[..end]);
        for (i, to) in matrix.chunks_exact_mut(n).take(end).enumerate() {
            let factors = [weights[0] * a[i], weights[1] * b[i], weights[2] * c[i], weights[3] * d[i]];
            if factors == [0.0; 4] {
                continue;
            }
            let rest = a[i..].iter().zip(&b[i..]).zip(c[i..].iter().zip(&d[i..]));
            for (to, ((a, b), (c, d))) in to[i..].iter_mut().zip(rest) {
                *to += (factors[0] * a + factors[1] * b) + (factors[2] * c + factors[3] * d);
            }
        }
    }
}

/// `a^T t` and `b^T t`; lengths are multiples of eight.
#[inline]
pub(crate) fn dot_pair(a: &[f64], b: &[f64], t: &[f64]) -> (f64, f64) {
    let (mut left, mut right) = ([f64x4::ZERO; 2], [f64x4::ZERO; 2]);
    for ((a, b), t) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0).zip(t.as_chunks::<8>().0) {
        add_products(&mut left, a, t);
        add_products(&mut right, b, t);
    }
    (sum(left), sum(right))
}

/// `t += p a + q b`; lengths are multiples of four.
#[inline]
pub(crate) fn add_scaled_pair(t: &mut [f64], p: f64, a: &[f64], q: f64, b: &[f64]) {
    let (p, q) = (f64x4::splat(p), f64x4::splat(q));
    for ((t, a), b) in t.as_chunks_mut::<4>().0.iter_mut().zip(a.as_chunks::<4>().0).zip(b.as_chunks::<4>().0) {
        *t = (lanes(t) + (p * lanes(a) + q * lanes(b))).to_array();
    }
}

/// Length `r`, cosine and sine of the Givens rotation that takes `(a, b)`, not both zero, to `(r, 0)`.
#[inline]
pub fn rotation(a: f64, b: f64) -> (f64, f64, f64) {
    let r = (a * a + b * b).sqrt();
    (r, a / r, b / r)
}

/// Replaces `x` by `cosine x + sine y`, and `y` by `cosine y - sine x`.
#[inline]
pub fn rotate(x: &mut [f64], y: &mut [f64], cosine: f64, sine: f64) {
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks_mut::<4>(), y.as_chunks_mut::<4>());
    let (c, s) = (f64x4::splat(cosine), f64x4::splat(sine));
    for (x, y) in x.iter_mut().zip(y) {
        let (a, b) = (lanes(x), lanes(y));
        (*x, *y) = ((c * a + s * b).to_array(), (c * b - s * a).to_array());
    }
    for (x, y) in x_rest.iter_mut().zip(y_rest) {
        (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x);
    }
}

/// Euclidean norm of a vector, and the number of its entries that are not zero.
#[inline]
pub(crate) fn norm_and_nonzeros(a: &[f64]) -> (f64, u64) {
    let count = a.iter().map(|x| u64::from(*x != 0.0)).sum();
    (norm(a), count)
}

/// Euclidean norm of a vector.
#[inline]
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// `y += s a_j` with column `j` of a symmetric matrix as wide as `y`, of which the upper triangle is read.
pub fn add_symmetric_column(y: &mut [f64], s: f64, matrix: &[f64], j: usize) {
    let n = y.len();
    let (above, below) = y.split_at_mut(j);
    add_scaled(below, s, &matrix[j * n + j..(j + 1) * n]);
    above.iter_mut().zip(matrix[j..].iter().step_by(n)).for_each(|(y, entry)| *y += s * entry);
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    fn vector(random: &mut Pcg64Mcg, n: usize) -> DVector<f64> {
        DVector::from_fn(n, |_, _| random.random_range(-1.0..1.0))
    }

    fn close(a: &[f64], b: &DVector<f64>) -> bool {
        a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() < 1e-13)
    }

    #[test]
    fn sums_of_any_length_are_those_of_nalgebra() {
        let mut random = Pcg64Mcg::new(6);
        for n in 0..40 {
            let (a, b, y) = (vector(&mut random, n), vector(&mut random, n), vector(&mut random, n));
            assert!((dot(a.as_slice(), b.as_slice()) - a.dot(&b)).abs() < 1e-13);
            assert!((norm(a.as_slice()) - a.norm()).abs() < 1e-13);
            let mut sum = y.clone();
            add_scaled(sum.as_mut_slice(), 0.7, a.as_slice());
            assert!(close(sum.as_slice(), &(&y + 0.7 * &a)));
            let mut sparse = a.clone();
            sparse.iter_mut().step_by(3).for_each(|x| *x = 0.0);
            assert_eq!(norm_and_nonzeros(sparse.as_slice()).1 as usize, n - n.div_ceil(3));
            if n % 8 == 0 {
                let (p, q) = dot_pair(a.as_slice(), b.as_slice(), y.as_slice());
                assert!((p - a.dot(&y)).abs() < 1e-13 && (q - b.dot(&y)).abs() < 1e-13);
                let mut sum = y.clone();
                add_scaled_pair(sum.as_mut_slice(), 0.3, a.as_slice(), -0.4, b.as_slice());
                assert!(close(sum.as_slice(), &(&y + 0.3 * &a - 0.4 * &b)));
            }
        }
    }

    #[test]
    fn outer_products_and_columns_of_any_size_are_those_of_nalgebra() {
        let mut random = Pcg64Mcg::new(7);
        for n in 1..12 {
            let mut rows = DMatrix::from_fn(n + 3, n, |_, _| random.random_range(-1.0..1.0));
            rows.column_mut(n - 1).rows_mut(0, 4.min(n + 3)).fill(0.0);
            let weights = vector(&mut random, n + 3);
            let expected = rows.transpose() * DMatrix::from_diagonal(&weights) * &rows;
            let by_rows = rows.transpose().as_slice().to_vec();
            let (mut upper, mut full) = (vec![0.0; n * n], vec![0.0; n * n]);
            add_outer_products(&mut upper, n, &by_rows, |r| weights[r]);
            for (row, weight) in by_rows.chunks_exact(n).zip(weights.iter()) {
                add_outer_product(&mut full, row, *weight);
            }
            for i in 0..n {
                assert!((0..n).all(|j| (full[i * n + j] - expected[(i, j)]).abs() < 1e-13));
                assert!((i..n).all(|j| (upper[i * n + j] - expected[(i, j)]).abs() < 1e-13));
                let mut column = vec![0.0; n];
                add_symmetric_column(&mut column, 2.0, &upper, i);
                assert!(close(&column, &(2.0 * expected.column(i))));
            }
        }
    }
}
