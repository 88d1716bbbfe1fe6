//! Factorises the rows of the working set as `C = L Q1^T`, with `L` lower triangular and `Q = [Q1 Z]` a product of Householder
//! reflections, one a row. `Z` spans the null space of the rows, in which a level moves (Dimitrov, Sherikov & Wieber 2015).
//!
//! An unknown that is at a bound when the factorisation begins is a column left out; a bound that becomes active later is a
//! row. Where the first level has few unknowns, these come first, and the vectors of its reflections end early.

use crate::linalg::{add_scaled, add_scaled_pair, dot, dot_pair, norm};
use crate::working_set::Constraint;

/// The factor, which grows by a row and shrinks from its end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factor {
    /// Unknowns of the columns, and unknowns left out.
    columns: Vec<usize>,
    columns_left_out: Vec<usize>,
    /// The constraint of each row.
    constraints: Vec<Constraint>,
    /// `L` below its diagonal, one row after the other, as long as `columns`; and its diagonal.
    lower: Vec<f64>,
    diagonal: Vec<f64>,
    /// Vectors of the reflections, [`Factor::padded_width`] long: zero before index `r` and behind `columns`, so that sums run
    /// over whole groups of eight.
    vectors: Vec<f64>,
    /// A multiple of eight for each vector, from which on it is zero.
    ends: Vec<usize>,
    scales: Vec<f64>,
    /// Inner product of each vector with the one before.
    cross: Vec<f64>,
}

impl Factor {
    pub(crate) fn with_capacity(n: usize) -> Self {
        Self {
            columns: Vec::with_capacity(n),
            columns_left_out: Vec::with_capacity(n),
            constraints: Vec::with_capacity(n),
            lower: Vec::with_capacity(n * n),
            diagonal: Vec::with_capacity(n),
            vectors: Vec::with_capacity(n * n),
            ends: Vec::with_capacity(n),
            scales: Vec::with_capacity(n),
            cross: Vec::with_capacity(n),
        }
    }

    /// Removes all rows. The columns become the unknowns of `order` that are not `at_bound`.
    pub(crate) fn reset(&mut self, order: &[usize], at_bound: impl Fn(usize) -> bool) {
        self.columns.clear();
        self.columns.extend(order.iter().filter(|&&i| !at_bound(i)));
        self.columns_left_out.clear();
        self.columns_left_out.extend(order.iter().filter(|&&i| at_bound(i)));
        self.truncate(0);
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.constraints.len()
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// The next multiple of eight of the width: the length of transformed rows, which are zero behind [`Factor::width`].
    pub(crate) fn padded_width(&self) -> usize {
        self.columns.len().next_multiple_of(8)
    }

    /// Removes all rows from `len` on.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.constraints.truncate(len);
        self.lower.truncate(len * self.columns.len());
        self.vectors.truncate(len * self.padded_width());
        self.ends.truncate(len);
        self.diagonal.truncate(len);
        self.scales.truncate(len);
        self.cross.truncate(len);
    }

    /// The entries of `x` at the columns, then zeros.
    pub(crate) fn gather(&self, x: &[f64], out: &mut [f64]) {
        for (out, &i) in out.iter_mut().zip(&self.columns) {
            *out = x[i];
        }
        out[self.columns.len()..self.padded_width()].fill(0.0);
    }

    /// `t -= scale (v^T t) v` with the vector `v` of row `r`.
    #[inline]
    fn reflect(&self, r: usize, t: &mut [f64]) {
        let start = r * self.padded_width();
        let (first, end) = (r / 8 * 8, self.ends[r]);
        let (v, t) = (&self.vectors[start + first..start + end], &mut t[first..end]);
        let s = self.scales[r] * dot(v, t);
        add_scaled(t, -s, v);
    }

    /// The vectors of the rows `r - 1` and `r`, and `t`, from the group of eight where the first begins to the end of both.
    #[inline]
    fn pair<'a>(&'a self, r: usize, t: &'a mut [f64]) -> (&'a [f64], &'a [f64], &'a mut [f64]) {
        let c = self.padded_width();
        let (first, end) = ((r - 1) / 8 * 8, self.ends[r - 1].max(self.ends[r]));
        let vector = |r: usize| &self.vectors[r * c + first..r * c + end];
        (vector(r - 1), vector(r), &mut t[first..end])
    }

    /// Replaces `t` by `Q^T t`, with the reflections of the rows `from..to`. Two reflections at a time read `t` once.
    pub(crate) fn transform(&self, t: &mut [f64], from: usize, to: usize) {
        let mut r = from;
        while r + 1 < to {
            let (a, b, t) = self.pair(r + 1, t);
            let (p, q) = dot_pair(a, b, t);
            let p = self.scales[r] * p;
            let q = self.scales[r + 1] * (q - p * self.cross[r + 1]);
            add_scaled_pair(t, -p, a, -q, b);
            r += 2;
        }
        if r < to {
            self.reflect(r, t);
        }
    }

    /// Replaces `t` by `Q t`.
    pub(crate) fn transform_back(&self, t: &mut [f64]) {
        let mut r = self.len();
        while r >= 2 {
            let (a, b, t) = self.pair(r - 1, t);
            let (p, q) = dot_pair(a, b, t);
            let q = self.scales[r - 1] * q;
            let p = self.scales[r - 2] * (p - q * self.cross[r - 1]);
            add_scaled_pair(t, -p, a, -q, b);
            r -= 2;
        }
        if r == 1 {
            self.reflect(0, t);
        }
    }

    /// Appends a row, given as `t = Q^T a`. Its part behind [`Factor::len`] must not vanish.
    pub(crate) fn append(&mut self, t: &[f64], constraint: Constraint) {
        let (r, w, c) = (self.len(), self.width(), self.padded_width());
        let first = r / 8 * 8;
        let last = t[first..c].as_chunks::<8>().0.iter().rposition(|eight| *eight != [0.0; 8]);
        let end = first + 8 * (last.unwrap_or(0) + 1);
        let length = norm(&t[r..end.min(w)]);
        let beta = if t[r] > 0.0 { -length } else { length };
        self.lower.extend_from_slice(&t[..w]);
        let start = self.vectors.len();
        self.vectors.extend_from_slice(&t[..c]);
        self.vectors[start..start + r].fill(0.0);
        self.vectors[start + r] = t[r] - beta;
        let (before, own) = self.vectors.split_at(start);
        self.cross.push(if r == 0 { 0.0 } else { dot(&before[start - c + first..start - c + end], &own[first..end]) });
        self.ends.push(end);
        self.diagonal.push(beta);
        self.scales.push(-1.0 / (beta * (t[r] - beta)));
        self.constraints.push(constraint);
    }

    /// Solves `L y = c` for the rows `from..`, as if the solution of the rows before were zero.
    pub(crate) fn solve_lower(&self, from: usize, c: &[f64], y: &mut [f64]) {
        let w = self.columns.len();
        for r in from..self.len() {
            let row = &self.lower[r * w..r * w + r];
            y[r - from] = (c[r - from] - dot(&row[from..], &y[..r - from])) / self.diagonal[r];
        }
    }

    /// Replaces `h[..len]` by the solution of `L^T z = h` with the first `len` rows.
    pub(crate) fn solve_lower_transposed(&self, len: usize, h: &mut [f64]) {
        let w = self.columns.len();
        for r in (0..len).rev() {
            h[r] /= self.diagonal[r];
            let z = h[r];
            add_scaled(&mut h[..r], -z, &self.lower[r * w..r * w + r]);
        }
    }

    /// `L[r][r]`.
    pub(crate) fn diagonal(&self, r: usize) -> f64 {
        self.diagonal[r]
    }

    /// `L[r][..r]`.
    pub(crate) fn lower_row(&self, r: usize) -> &[f64] {
        let w = self.columns.len();
        &self.lower[r * w..r * w + r]
    }

    /// Unknowns of the columns.
    pub(crate) fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Unknowns left out.
    pub(crate) fn columns_left_out(&self) -> &[usize] {
        &self.columns_left_out
    }

    /// The constraint of each row.
    pub(crate) fn constraints(&self) -> &[Constraint] {
        &self.constraints
    }
}
