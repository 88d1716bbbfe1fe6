//! A small least-squares solve.

use crate::linalg::{add_scaled, dot, norm};

/// Least squares `min |T y - c|` by Householder factorisation with the largest rows first, row and column exchange, which
/// keeps rows of very different size apart (Cox & Higham 1998). Keeps its space between calls.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSquares {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// Row after row, as given.
    pub(crate) given: Vec<f64>,
    pub(crate) given_right: Vec<f64>,
    /// Column after column, rows in `order`; the last column is the right-hand side.
    pub(crate) matrix: Vec<f64>,
    pub(crate) order: Vec<usize>,
    pub(crate) sizes: Vec<f64>,
    /// Which column of `matrix` holds which unknown, and what is left of it, squared.
    pub(crate) places: Vec<usize>,
    pub(crate) left: Vec<f64>,
    pub(crate) vector: Vec<f64>,
    pub(crate) diagonal: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    pub(crate) residual: Vec<f64>,
}

impl LeastSquares {
    /// Space for `rows` by `columns`, all zero. Fill it with [`LeastSquares::set`].
    pub(crate) fn begin(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.given.clear();
        self.given.resize(rows * columns, 0.0);
        self.given_right.clear();
        self.given_right.resize(rows, 0.0);
    }

    /// Row `i` is `row`, padded with zeros, and its right-hand side `right`.
    pub(crate) fn set(&mut self, i: usize, row: &[f64], right: f64) {
        let n = self.columns;
        self.given[i * n..i * n + row.len()].copy_from_slice(row);
        self.given_right[i] = right;
    }

    /// One more entry of a row.
    pub(crate) fn set_entry(&mut self, i: usize, column: usize, value: f64) {
        self.given[i * self.columns + column] = value;
    }

    /// Solves into `y`. Columns that vanish against the first pivot count as zero.
    pub(crate) fn solve(&mut self, y: &mut [f64]) {
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
    pub(crate) fn residual(&self) -> &[f64] {
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
