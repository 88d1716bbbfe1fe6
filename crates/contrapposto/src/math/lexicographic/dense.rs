//! Sums over rows, in a fixed order that does not depend on the machine, and a small least-squares solve.
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
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
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
pub(crate) fn add_scaled(y: &mut [f64], s: f64, x: &[f64]) {
    let ((y, y_rest), (x, x_rest)) = (y.as_chunks_mut(), x.as_chunks());
    add_scaled_fours(y, s, x);
    for (y, x) in y_rest.iter_mut().zip(x_rest) {
        *y += s * x;
    }
}

/// `matrix += weight row row^T`.
pub(crate) fn add_square(matrix: &mut [f64], row: &[f64], weight: f64) {
    for (to, a) in matrix.chunks_exact_mut(row.len().max(1)).zip(row) {
        if *a != 0.0 {
            add_scaled(to, weight * a, row);
        }
    }
}

/// `y += sum_r by_r x_r` of four rows that are whole fours.
#[inline]
pub(crate) fn add_fours(y: &mut [[f64; 4]], by: [f64; 4], [a, b, c, d]: [&[[f64; 4]]; 4]) {
    let [p, q, r, s] = by.map(f64x4::splat);
    for (y, ((a, b), (c, d))) in y.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d))) {
        let more = (p * lanes(a) + q * lanes(b)) + (r * lanes(c) + s * lanes(d));
        *y = (lanes(y) + more).to_array();
    }
}

/// `y += s x` of rows that are whole fours.
#[inline]
pub(crate) fn add_scaled_fours(y: &mut [[f64; 4]], s: f64, x: &[[f64; 4]]) {
    let scale = f64x4::splat(s);
    for (y, x) in y.iter_mut().zip(x) {
        *y = (lanes(y) + scale * lanes(x)).to_array();
    }
}

/// `matrix += sum_r weight_r row_r^T row_r` on and above the diagonal; rows of width `n`, one after the other, zeros at the end
/// of neighbours left out.
pub(crate) fn add_squares(matrix: &mut [f64], n: usize, rows: &[f64], weight: impl Fn(usize) -> f64) {
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
pub(super) fn dot_pair(a: &[f64], b: &[f64], t: &[f64]) -> (f64, f64) {
    let (mut left, mut right) = ([f64x4::ZERO; 2], [f64x4::ZERO; 2]);
    for ((a, b), t) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0).zip(t.as_chunks::<8>().0) {
        add_products(&mut left, a, t);
        add_products(&mut right, b, t);
    }
    (sum(left), sum(right))
}

/// `t += p a + q b`; lengths are whole fours.
#[inline]
pub(super) fn add_scaled_pair(t: &mut [f64], p: f64, a: &[f64], q: f64, b: &[f64]) {
    let (p, q) = (f64x4::splat(p), f64x4::splat(q));
    for ((t, a), b) in t.as_chunks_mut::<4>().0.iter_mut().zip(a.as_chunks::<4>().0).zip(b.as_chunks::<4>().0) {
        *t = (lanes(t) + (p * lanes(a) + q * lanes(b))).to_array();
    }
}

/// Length of a vector, and how many entries are not zero.
pub(super) fn norm_and_count(a: &[f64]) -> (f64, u64) {
    let count = a.iter().map(|x| u64::from(*x != 0.0)).sum();
    (norm(a), count)
}

/// Length of a vector.
#[inline]
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Least squares `min |T y - c|` by Householder factorisation with the largest rows first, row and column exchange, which
/// keeps rows of very different size apart (Cox & Higham 1998). Keeps its space between calls.
#[derive(Clone, Debug, Default)]
pub(super) struct LeastSquares {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Row after row, as given.
    pub(super) given: Vec<f64>,
    pub(super) given_right: Vec<f64>,
    /// Column after column, rows in `order`; the last column is the right-hand side.
    pub(super) matrix: Vec<f64>,
    pub(super) order: Vec<usize>,
    pub(super) sizes: Vec<f64>,
    /// Which column of `matrix` holds which unknown, and what is left of it, squared.
    pub(super) places: Vec<usize>,
    pub(super) left: Vec<f64>,
    pub(super) vector: Vec<f64>,
    pub(super) diagonal: Vec<f64>,
    pub(super) scale: Vec<f64>,
    pub(super) residual: Vec<f64>,
}

impl LeastSquares {
    /// Space for `rows` by `columns`, all zero. Fill it with [`LeastSquares::set`].
    pub(super) fn begin(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.given.clear();
        self.given.resize(rows * columns, 0.0);
        self.given_right.clear();
        self.given_right.resize(rows, 0.0);
    }

    /// Row `i` is `row`, padded with zeros, and its right-hand side `right`.
    pub(super) fn set(&mut self, i: usize, row: &[f64], right: f64) {
        let n = self.columns;
        self.given[i * n..i * n + row.len()].copy_from_slice(row);
        self.given_right[i] = right;
    }

    /// One more entry of a row.
    pub(super) fn set_entry(&mut self, i: usize, column: usize, value: f64) {
        self.given[i * self.columns + column] = value;
    }

    /// Solves into `y`. Columns that vanish against the first pivot count as zero.
    pub(super) fn solve(&mut self, y: &mut [f64]) {
        let (m, n) = (self.rows, self.columns);
        y[..n].fill(0.0);
        self.arrange();
        let Self { matrix, places, left, vector, order, diagonal, scale: scales, residual, .. } = self;
        diagonal.clear();
        scales.clear();
        let (mut rank, mut first) = (0, 0.0);
        while rank < n.min(m) {
            let r = rank;
            let pivot = (r..n).fold(r, |best, j| if left[places[j]] > left[places[best]] { j } else { best });
            places.swap(r, pivot);
            let start = places[r] * m;
            let column = &matrix[start + r..start + m];
            let length = norm(column);
            first = if r == 0 { length } else { first };
            if length <= 1e-14 * first || length == 0.0 {
                break;
            }
            let top =
                column.iter().enumerate().fold(0, |top, (i, a)| if a.abs() > column[top].abs() { i } else { top });
            if top > 0 {
                matrix.chunks_exact_mut(m).for_each(|column| column.swap(r, r + top));
                order.swap(r, r + top);
            }
            vector.clear();
            vector.extend_from_slice(&matrix[start + r..start + m]);
            let beta = if vector[0] > 0.0 { -length } else { length };
            vector[0] -= beta;
            let scale = -1.0 / (beta * vector[0]);
            for &j in places[r + 1..].iter().chain([&n]) {
                let column = &mut matrix[j * m + r..(j + 1) * m];
                let s = scale * dot(vector, column);
                add_scaled(column, -s, vector);
                if j < n {
                    let rest = left[j] - column[0] * column[0];
                    left[j] = if rest > 1e-3 * left[j] { rest } else { dot(&column[1..], &column[1..]) };
                }
            }
            matrix[start + r..start + m].copy_from_slice(vector);
            diagonal.push(beta);
            scales.push(scale);
            rank += 1;
        }
        for r in (0..rank).rev() {
            let rest: f64 = places[r + 1..rank].iter().map(|&j| matrix[j * m + r] * y[j]).sum();
            y[places[r]] = (matrix[n * m + r] - rest) / diagonal[r];
        }
        // What no y can reach, turned back: as exact for light rows as for heavy ones, which c - T y would not be.
        matrix[n * m..n * m + rank].fill(0.0);
        let (vectors, left_over) = matrix.split_at_mut(n * m);
        for r in (0..rank).rev() {
            let vector = &vectors[places[r] * m + r..(places[r] + 1) * m];
            let s = scales[r] * dot(vector, &left_over[r..]);
            add_scaled(&mut left_over[r..], -s, vector);
        }
        residual.clear();
        residual.resize(m, 0.0);
        for (i, value) in order.iter().zip(left_over) {
            residual[*i] = *value;
        }
    }

    /// `c - T y` of the last solution, by row.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Columns with the largest rows first.
    fn arrange(&mut self) {
        let (m, n) = (self.rows, self.columns);
        let Self { given, given_right, matrix, order, sizes, places, left, .. } = self;
        sizes.clear();
        sizes.extend((0..m).map(|i| given[i * n..(i + 1) * n].iter().fold(0.0, |s: f64, a| s.max(a.abs()))));
        order.clear();
        order.extend(0..m);
        order.sort_unstable_by(|&i, &j| sizes[j].total_cmp(&sizes[i]).then(i.cmp(&j)));
        matrix.clear();
        left.clear();
        for j in 0..n {
            matrix.extend(order.iter().map(|&i| given[i * n + j]));
            let column = &matrix[j * m..];
            left.push(dot(column, column));
        }
        matrix.extend(order.iter().map(|&i| given_right[i]));
        places.clear();
        places.extend(0..n);
    }
}
