//! Solves `min |T y - c|` by Householder QR with the largest rows first and with row and column exchange, which keeps rows of
//! very different size apart (Cox & Higham 1998, "Stability of Householder QR factorization for weighted least squares
//! problems").

use super::vector::{add_scaled, dot, norm};
use crate::tolerances::{DEPENDENT_COLUMN, NORM_UPDATE};

/// One least-squares problem, its factors and its residual. The buffers are kept between calls.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSquares {
    rows: usize,
    columns: usize,
    /// `T` row after row, and `c`, as given.
    given: Vec<f64>,
    given_right: Vec<f64>,
    /// `T` column after column, rows in `row_order`; the last column is `c`. Once factorised, `R` above the diagonal, and the
    /// Householder vectors on and below it.
    matrix: Vec<f64>,
    row_order: Vec<usize>,
    /// Largest entry of each row, in absolute value.
    row_sizes: Vec<f64>,
    /// The column of `matrix` at each pivot position.
    column_order: Vec<usize>,
    /// Squared norm of each column below the pivots so far.
    remainders: Vec<f64>,
    vector: Vec<f64>,
    /// Diagonal of `R`, and the factor of each reflection.
    diagonal: Vec<f64>,
    scales: Vec<f64>,
    residual: Vec<f64>,
}

impl LeastSquares {
    /// An empty problem with space for so many rows and columns.
    pub(crate) fn with_capacity(rows: usize, columns: usize) -> Self {
        Self {
            given: Vec::with_capacity(rows * columns),
            given_right: Vec::with_capacity(rows),
            matrix: Vec::with_capacity(rows * (columns + 1)),
            row_order: Vec::with_capacity(rows),
            row_sizes: Vec::with_capacity(rows),
            column_order: Vec::with_capacity(columns),
            remainders: Vec::with_capacity(columns),
            vector: Vec::with_capacity(rows),
            diagonal: Vec::with_capacity(columns),
            scales: Vec::with_capacity(columns),
            residual: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// Starts a problem of this size, all entries zero. Fill it with [`LeastSquares::set`].
    pub(crate) fn begin(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.given.clear();
        self.given.resize(rows * columns, 0.0);
        self.given_right.clear();
        self.given_right.resize(rows, 0.0);
    }

    /// Sets row `i` to `row`, padded with zeros, and its right-hand side to `right`.
    pub(crate) fn set(&mut self, i: usize, row: &[f64], right: f64) {
        let n = self.columns;
        self.given[i * n..i * n + row.len()].copy_from_slice(row);
        self.given_right[i] = right;
    }

    /// Sets one entry.
    pub(crate) fn set_entry(&mut self, i: usize, column: usize, value: f64) {
        self.given[i * self.columns + column] = value;
    }

    /// Solves into the first entries of `y`. Unknowns of columns that depend on others are zero.
    pub(crate) fn solve(&mut self, y: &mut [f64]) {
        let (m, n) = (self.rows, self.columns);
        y[..n].fill(0.0);
        self.arrange();
        self.factorise();
        for r in (0..self.diagonal.len()).rev() {
            let known = self.column_order[r + 1..self.diagonal.len()].iter();
            let rest: f64 = known.map(|&j| self.matrix[j * m + r] * y[j]).sum();
            y[self.column_order[r]] = (self.matrix[n * m + r] - rest) / self.diagonal[r];
        }
        self.compute_residual();
    }

    /// The smallest pivot of the last solution; 0 where columns depend on each other.
    pub(crate) fn least_pivot(&self) -> f64 {
        let least = self.diagonal.iter().fold(f64::INFINITY, |least, pivot| least.min(pivot.abs()));
        if self.diagonal.len() == self.columns { least } else { 0.0 }
    }

    /// `c - T y` of the last solution, by row.
    pub(crate) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Sorts the rows by size, the largest first, and stores columns.
    fn arrange(&mut self) {
        let (m, n) = (self.rows, self.columns);
        let Self { given, given_right, matrix, row_order, row_sizes, column_order, remainders, .. } = self;
        row_sizes.clear();
        row_sizes.extend((0..m).map(|i| given[i * n..(i + 1) * n].iter().fold(0.0, |s: f64, a| s.max(a.abs()))));
        row_order.clear();
        row_order.extend(0..m);
        row_order.sort_unstable_by(|&i, &j| row_sizes[j].total_cmp(&row_sizes[i]).then(i.cmp(&j)));
        matrix.clear();
        remainders.clear();
        for j in 0..n {
            matrix.extend(row_order.iter().map(|&i| given[i * n + j]));
            let column = &matrix[j * m..];
            remainders.push(dot(column, column));
        }
        matrix.extend(row_order.iter().map(|&i| given_right[i]));
        column_order.clear();
        column_order.extend(0..n);
    }

    /// Householder reflections of `T` and `c`, the column with the largest remainder first, its largest entry as pivot. Ends at
    /// the first dependent column: the length of `diagonal` is the rank.
    fn factorise(&mut self) {
        let (m, n) = (self.rows, self.columns);
        self.diagonal.clear();
        self.scales.clear();
        let mut first = 0.0;
        for r in 0..n.min(m) {
            let Self { matrix, row_order, column_order, remainders, vector, .. } = self;
            let largest = |best: usize, j: usize| {
                if remainders[column_order[j]] > remainders[column_order[best]] { j } else { best }
            };
            let pivot = (r..n).fold(r, largest);
            column_order.swap(r, pivot);
            let start = column_order[r] * m;
            let column = &matrix[start + r..start + m];
            let length = norm(column);
            first = if r == 0 { length } else { first };
            if length <= DEPENDENT_COLUMN * first || length == 0.0 {
                break;
            }
            let top =
                column.iter().enumerate().fold(0, |top, (i, a)| if a.abs() > column[top].abs() { i } else { top });
            if top > 0 {
                matrix.chunks_exact_mut(m).for_each(|column| column.swap(r, r + top));
                row_order.swap(r, r + top);
            }
            vector.clear();
            vector.extend_from_slice(&matrix[start + r..start + m]);
            let beta = if vector[0] > 0.0 { -length } else { length };
            vector[0] -= beta;
            let scale = -1.0 / (beta * vector[0]);
            self.reflect_columns_behind(r, scale);
            self.matrix[start + r..start + m].copy_from_slice(&self.vector);
            self.diagonal.push(beta);
            self.scales.push(scale);
        }
    }

    /// Applies the reflection of pivot `r` to the columns behind it and to the right-hand side.
    fn reflect_columns_behind(&mut self, r: usize, scale: f64) {
        let (m, n) = (self.rows, self.columns);
        for &j in self.column_order[r + 1..].iter().chain([&n]) {
            let column = &mut self.matrix[j * m + r..(j + 1) * m];
            let s = scale * dot(&self.vector, column);
            add_scaled(column, -s, &self.vector);
            if j < n {
                let rest = self.remainders[j] - column[0] * column[0];
                let exact = rest > NORM_UPDATE * self.remainders[j];
                self.remainders[j] = if exact { rest } else { dot(&column[1..], &column[1..]) };
            }
        }
    }

    /// The part of the right-hand side outside the range of `T`, transformed back by `Q`. It is as exact for small rows as for
    /// large ones, which `c - T y` would not be.
    fn compute_residual(&mut self) {
        let (m, n, rank) = (self.rows, self.columns, self.diagonal.len());
        self.matrix[n * m..n * m + rank].fill(0.0);
        let (vectors, right) = self.matrix.split_at_mut(n * m);
        for r in (0..rank).rev() {
            let vector = &vectors[self.column_order[r] * m + r..(self.column_order[r] + 1) * m];
            let s = self.scales[r] * dot(vector, &right[r..]);
            add_scaled(&mut right[r..], -s, vector);
        }
        self.residual.clear();
        self.residual.resize(m, 0.0);
        for (i, value) in self.row_order.iter().zip(right) {
            self.residual[*i] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn residual_of_any_rank_and_row_scale_is_orthogonal_to_the_columns() {
        let mut random = Pcg64Mcg::new(8);
        let mut problem = LeastSquares::default();
        for case in 0..200 {
            let (m, n) = (random.random_range(1..12), random.random_range(1..12));
            let rank = random.random_range(1..=n.min(m));
            let mut entry = |_: usize, _: usize| random.random_range(-1.0..1.0);
            let mut matrix = DMatrix::from_fn(m, rank, &mut entry) * DMatrix::from_fn(rank, n, &mut entry);
            let right = DVector::from_fn(m, |_, _| entry(0, 0));
            if case % 2 == 0 {
                matrix.row_mut(0).scale_mut(1e4);
            }
            problem.begin(m, n);
            for i in 0..m {
                problem.set(i, matrix.row(i).transpose().as_slice(), right[i]);
            }
            let mut y = vec![0.0; n];
            problem.solve(&mut y);
            let residual = DVector::from_column_slice(problem.residual());
            let size = matrix.norm();
            let direct = &right - &matrix * DVector::from_vec(y);
            assert!((matrix.transpose() * &residual).norm() < 1e-12 * size, "case {case}");
            assert!((direct - residual).norm() < 1e-9 * size, "case {case}");
        }
    }
}
