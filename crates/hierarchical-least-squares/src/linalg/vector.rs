//! Sums over rows, in a fixed order that does not depend on the machine.
//!
//! Four numbers at a time, by name: left to itself the compiler gathers numbers of several rounds of such a loop first, which
//! takes up to three times as long.

use wide::f64x4;

/// Four numbers.
#[inline]
fn lanes(numbers: &[f64; 4]) -> f64x4 {
    f64x4::new(*numbers)
}

/// `a . b`, in eight partial sums.
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

/// Eight products, each on its partial sum.
#[inline]
fn add_products(sums: &mut [f64x4; 2], x: &[f64; 8], y: &[f64; 8]) {
    for (sum, (x, y)) in sums.iter_mut().zip(x.as_chunks::<4>().0.iter().zip(y.as_chunks::<4>().0)) {
        *sum += lanes(x) * lanes(y);
    }
}

/// What eight partial sums make.
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

/// `matrix += weight row row^T`.
#[inline]
pub fn add_square(matrix: &mut [f64], row: &[f64], weight: f64) {
    for (to, a) in matrix.chunks_exact_mut(row.len().max(1)).zip(row) {
        if *a != 0.0 {
            add_scaled(to, weight * a, row);
        }
    }
}

/// `y += sum_r by_r x_r` of four rows that are whole fours.
#[inline]
pub fn add_fours(y: &mut [[f64; 4]], by: [f64; 4], [a, b, c, d]: [&[[f64; 4]]; 4]) {
    let [p, q, r, s] = by.map(f64x4::splat);
    for (y, ((a, b), (c, d))) in y.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d))) {
        let more = (p * lanes(a) + q * lanes(b)) + (r * lanes(c) + s * lanes(d));
        *y = (lanes(y) + more).to_array();
    }
}

/// `y += s x` of rows that are whole fours.
#[inline]
pub fn add_scaled_fours(y: &mut [[f64; 4]], s: f64, x: &[[f64; 4]]) {
    let scale = f64x4::splat(s);
    for (y, x) in y.iter_mut().zip(x) {
        *y = (lanes(y) + scale * lanes(x)).to_array();
    }
}

/// `matrix += sum_r weight_r row_r^T row_r` on and above the diagonal; rows of width `n`, one after the other, zeros at the end
/// of neighbours left out.
pub fn add_squares(matrix: &mut [f64], n: usize, rows: &[f64], weight: impl Fn(usize) -> f64) {
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
            let by = [weights[0] * a[i], weights[1] * b[i], weights[2] * c[i], weights[3] * d[i]];
            if by == [0.0; 4] {
                continue;
            }
            let rest = a[i..].iter().zip(&b[i..]).zip(c[i..].iter().zip(&d[i..]));
            for (to, ((a, b), (c, d))) in to[i..].iter_mut().zip(rest) {
                *to += (by[0] * a + by[1] * b) + (by[2] * c + by[3] * d);
            }
        }
    }
}

/// `a . t` and `b . t`; lengths are whole eights.
#[inline]
pub fn dot_pair(a: &[f64], b: &[f64], t: &[f64]) -> (f64, f64) {
    let (mut left, mut right) = ([f64x4::ZERO; 2], [f64x4::ZERO; 2]);
    for ((a, b), t) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0).zip(t.as_chunks::<8>().0) {
        add_products(&mut left, a, t);
        add_products(&mut right, b, t);
    }
    (sum(left), sum(right))
}

/// `t += p a + q b`; lengths are whole fours.
#[inline]
pub fn add_scaled_pair(t: &mut [f64], p: f64, a: &[f64], q: f64, b: &[f64]) {
    let (p, q) = (f64x4::splat(p), f64x4::splat(q));
    for ((t, a), b) in t.as_chunks_mut::<4>().0.iter_mut().zip(a.as_chunks::<4>().0).zip(b.as_chunks::<4>().0) {
        *t = (lanes(t) + (p * lanes(a) + q * lanes(b))).to_array();
    }
}

/// Length of a vector, and how many entries are not zero.
#[inline]
pub fn norm_and_count(a: &[f64]) -> (f64, u64) {
    let count = a.iter().map(|x| u64::from(*x != 0.0)).sum();
    (norm(a), count)
}

/// Length of a vector.
#[inline]
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
