//! Factorises the rows of the working set as `C = L Q1^T`, with `L` lower triangular and `Q = [Q1 Z]` orthogonal. `Z` spans the
//! null space of the rows, in which a level moves (Dimitrov, Sherikov & Wieber 2015).
//!
//! `Q` is a product of Householder reflections, one a row that was appended, and of Givens rotations, one chain of them a row
//! that was removed or a column that joined (Golub & Van Loan 2013, "Matrix Computations", 6.5.2 and 6.5.3; Escande, Mansard &
//! Wieber 2014). Neither is ever multiplied out.
//!
//! An unknown that is at a bound when the factorisation begins is a column left out; a bound that becomes active later is a
//! row. Where the first level has few unknowns, these come first, and the vectors of its reflections end early.

use crate::linalg::{add_scaled, add_scaled_pair, dot, dot_pair, norm, rotate, rotation};
use crate::tolerances::ROTATIONS_PER_COLUMN;
use crate::working_set::{Constraint, Side};

/// The factor, which grows by a row at its end, and from which rows are removed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factor {
    /// Unknowns of the columns, and unknowns left out.
    columns: Vec<usize>,
    columns_left_out: Vec<usize>,
    /// Length of the vectors of the reflections and of the columns of `L`: the number of unknowns, rounded up to a multiple of
    /// eight.
    stride: usize,
    /// The constraint of each row.
    constraints: Vec<Constraint>,
    /// `L` below its diagonal, column after column; and its diagonal.
    lower: Vec<f64>,
    diagonal: Vec<f64>,
    /// Vectors of the reflections: zero before the index of their row and behind the columns, so that sums run over whole
    /// groups of eight.
    vectors: Vec<f64>,
    reflections: Vec<Reflection>,
    chains: Vec<Chain>,
    /// Cosine and sine of each rotation of the chains.
    rotations: Vec<(f64, f64)>,
    /// Number of reflections whose row was removed by a chain: all of them precede the last chain.
    removed: usize,
    /// Number of resets: a [`Position`] of an earlier one is void.
    resets: usize,
    /// Workspace: a column that joins.
    joining: Vec<f64>,
}

/// `t -= scale (v^T t) v` with a vector `v` of [`Factor::vectors`].
#[derive(Clone, Copy, Debug)]
struct Reflection {
    /// The row at which it was appended: the first entry of its vector that is not zero.
    row: usize,
    /// A multiple of eight, from which on the vector is zero.
    end: usize,
    scale: f64,
    /// Inner product of the vector with the one before.
    cross: f64,
}

/// Rotations of neighbouring columns, or of each column with one that joined.
#[derive(Clone, Copy, Debug)]
struct Chain {
    /// Number of reflections that precede it.
    reflections: usize,
    /// The first column that is rotated.
    first: usize,
    /// The column with which each is rotated, where it is not the next one.
    with: Option<usize>,
    /// Indices of its rotations.
    from: usize,
    to: usize,
}

/// Reflections and rotations of `Q^T` that a vector was multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Position {
    reset: usize,
    reflections: usize,
    chains: usize,
    columns: usize,
}

impl Factor {
    pub(crate) fn with_capacity(n: usize) -> Self {
        Self {
            columns: Vec::with_capacity(n),
            columns_left_out: Vec::with_capacity(n),
            constraints: Vec::with_capacity(n),
            lower: Vec::with_capacity(n * n),
            diagonal: Vec::with_capacity(n),
            vectors: Vec::with_capacity(2 * n * n),
            reflections: Vec::with_capacity(2 * n),
            chains: Vec::with_capacity(3 * n),
            rotations: Vec::with_capacity((ROTATIONS_PER_COLUMN + 1) * n),
            joining: Vec::with_capacity(n),
            ..Self::default()
        }
    }

    /// Removes all rows. The columns become the unknowns of `order` that are at none of their `bounds`; without `bounds` all of them.
    pub(crate) fn reset(&mut self, order: &[usize], bounds: &[Side]) {
        let at_bound = |i: usize| bounds.get(i).is_some_and(|side| *side != Side::Inactive);
        self.columns.clear();
        self.columns.extend(order.iter().filter(|&&i| !at_bound(i)));
        self.columns_left_out.clear();
        self.columns_left_out.extend(order.iter().filter(|&&i| at_bound(i)));
        self.stride = order.len().next_multiple_of(8);
        self.lower.resize(self.stride * self.stride, 0.0);
        self.constraints.clear();
        self.diagonal.clear();
        self.vectors.clear();
        self.reflections.clear();
        self.chains.clear();
        self.rotations.clear();
        self.removed = 0;
        self.resets += 1;
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.constraints.len()
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Length of transformed rows, which are zero behind [`Factor::width`].
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Removes all rows from `len` on, none of which precedes a row that [`Factor::remove`] took out.
    pub(crate) fn truncate(&mut self, len: usize) {
        let reflections = len + self.removed;
        debug_assert!(self.chains.last().is_none_or(|chain| chain.reflections <= reflections), "rows behind a chain");
        self.constraints.truncate(len);
        self.diagonal.truncate(len);
        self.reflections.truncate(reflections);
        self.vectors.truncate(reflections * self.stride);
    }

    /// The entries of `x` at the columns, then zeros.
    pub(crate) fn gather(&self, x: &[f64], out: &mut [f64]) {
        for (out, &i) in out.iter_mut().zip(&self.columns) {
            *out = x[i];
        }
        out[self.columns.len()..self.stride].fill(0.0);
    }

    /// The position behind all rows.
    pub(crate) fn position(&self) -> Position {
        Position {
            reset: self.resets,
            reflections: self.reflections.len(),
            chains: self.chains.len(),
            columns: self.columns.len(),
        }
    }

    /// Replaces `t` by `Q^T t`, with the first `len` rows: those that [`Factor::truncate`] accepts.
    pub(crate) fn transform(&self, t: &mut [f64], len: usize) {
        self.apply(t, 0, 0, len + self.removed);
    }

    /// Continues the transformation of the row `x`, by unknown, that is `t` at an earlier position; `false` where the
    /// factorisation began anew since.
    pub(crate) fn continue_transform(&self, x: &[f64], t: &mut [f64], from: Position) -> bool {
        if from.reset != self.resets {
            return false;
        }
        for (t, &i) in t[from.columns..].iter_mut().zip(&self.columns[from.columns..]) {
            *t = x[i];
        }
        self.apply(t, from.reflections, from.chains, self.reflections.len());
        true
    }

    /// Applies the reflection of the last row.
    #[inline]
    pub(crate) fn transform_by_last(&self, t: &mut [f64]) {
        self.reflect(self.reflections.len() - 1, t);
    }

    /// Applies the reflections `from..to` and the chains between them, from `chain` on. Two reflections at a time read `t` once.
    fn apply(&self, t: &mut [f64], from: usize, chain: usize, to: usize) {
        let mut r = from;
        for chain in &self.chains[chain..] {
            self.reflect_range(t, r, chain.reflections);
            self.rotate_forward(chain, t);
            r = chain.reflections;
        }
        self.reflect_range(t, r, to);
    }

    #[inline]
    fn reflect_range(&self, t: &mut [f64], from: usize, to: usize) {
        let mut r = from;
        while r + 1 < to {
            let (a, b, t) = self.pair(r + 1, t);
            let (p, q) = dot_pair(a, b, t);
            let second = &self.reflections[r + 1];
            let p = self.reflections[r].scale * p;
            let q = second.scale * (q - p * second.cross);
            add_scaled_pair(t, -p, a, -q, b);
            r += 2;
        }
        if r < to {
            self.reflect(r, t);
        }
    }

    /// Applies one reflection.
    #[inline]
    fn reflect(&self, r: usize, t: &mut [f64]) {
        let Reflection { row, end, scale, .. } = self.reflections[r];
        let (start, first) = (r * self.stride, row / 8 * 8);
        let (v, t) = (&self.vectors[start + first..start + end], &mut t[first..end]);
        let s = scale * dot(v, t);
        add_scaled(t, -s, v);
    }

    /// The vectors of the reflections `r - 1` and `r`, and `t`, from the group of eight where the first begins to the end of
    /// both.
    #[inline]
    fn pair<'a>(&'a self, r: usize, t: &'a mut [f64]) -> (&'a [f64], &'a [f64], &'a mut [f64]) {
        let (a, b) = (&self.reflections[r - 1], &self.reflections[r]);
        let (first, end) = (a.row.min(b.row) / 8 * 8, a.end.max(b.end));
        let vector = |r: usize| &self.vectors[r * self.stride + first..r * self.stride + end];
        (vector(r - 1), vector(r), &mut t[first..end])
    }

    fn rotate_forward(&self, chain: &Chain, t: &mut [f64]) {
        for (k, &(c, s)) in self.rotations[chain.from..chain.to].iter().enumerate() {
            let (i, j) = chain.pair(k);
            (t[i], t[j]) = (c * t[i] + s * t[j], c * t[j] - s * t[i]);
        }
    }

    fn rotate_back(&self, chain: &Chain, t: &mut [f64]) {
        for (k, &(c, s)) in self.rotations[chain.from..chain.to].iter().enumerate().rev() {
            let (i, j) = chain.pair(k);
            (t[i], t[j]) = (c * t[i] - s * t[j], c * t[j] + s * t[i]);
        }
    }

    /// Replaces `t` by `Q t`.
    pub(crate) fn transform_back(&self, t: &mut [f64]) {
        let mut end = self.reflections.len();
        for chain in self.chains.iter().rev() {
            self.reflect_range_back(t, chain.reflections, end);
            self.rotate_back(chain, t);
            end = chain.reflections;
        }
        self.reflect_range_back(t, 0, end);
    }

    fn reflect_range_back(&self, t: &mut [f64], from: usize, to: usize) {
        let mut r = to;
        while r >= from + 2 {
            let (a, b, t) = self.pair(r - 1, t);
            let (p, q) = dot_pair(a, b, t);
            let second = &self.reflections[r - 1];
            let q = second.scale * q;
            let p = self.reflections[r - 2].scale * (p - q * second.cross);
            add_scaled_pair(t, -p, a, -q, b);
            r -= 2;
        }
        if r > from {
            self.reflect(from, t);
        }
    }

    /// Appends a row, given as `t = Q^T a`. Its part behind [`Factor::len`] must not vanish.
    pub(crate) fn append(&mut self, t: &[f64], constraint: Constraint) {
        let (r, w, stride) = (self.len(), self.width(), self.stride);
        let first = r / 8 * 8;
        let last = t[first..stride].as_chunks::<8>().0.iter().rposition(|eight| *eight != [0.0; 8]);
        let end = first + 8 * (last.unwrap_or(0) + 1);
        let length = norm(&t[r..end.min(w)]);
        let beta = if t[r] > 0.0 { -length } else { length };
        for (column, entry) in self.lower.chunks_exact_mut(stride).zip(&t[..r]) {
            column[r] = *entry;
        }
        let start = self.vectors.len();
        self.vectors.extend_from_slice(&t[..stride]);
        self.vectors[start..start + r].fill(0.0);
        self.vectors[start + r] = t[r] - beta;
        let (before, own) = self.vectors.split_at(start);
        let before = before.get(start.wrapping_sub(stride)..);
        let cross = before.map_or(0.0, |before| dot(&before[first..end], &own[first..end]));
        self.reflections.push(Reflection { row: r, end, scale: -1.0 / (beta * (t[r] - beta)), cross });
        self.diagonal.push(beta);
        self.constraints.push(constraint);
    }

    /// Removes the row `j` and restores the triangle by rotations of neighbouring columns; `false`, with the factor as it was,
    /// where too many rotations have gathered.
    pub(crate) fn remove(&mut self, j: usize) -> bool {
        let (len, stride) = (self.len(), self.stride);
        if !self.has_room_for(len - 1 - j) {
            return false;
        }
        self.constraints.remove(j);
        for (c, column) in self.lower.chunks_exact_mut(stride).take(len - 1).enumerate() {
            column.copy_within((j + 1).max(c + 1)..len, j.max(c));
        }
        let from = self.rotations.len();
        for c in j..len - 1 {
            let (left, right) = self.lower[c * stride..(c + 2) * stride].split_at_mut(stride);
            let (length, cosine, sine) = rotation(left[c], self.diagonal[c + 1]);
            self.diagonal[c] = length;
            rotate(&mut left[c + 1..len - 1], &mut right[c + 1..len - 1], cosine, sine);
            self.rotations.push((cosine, sine));
        }
        self.diagonal.pop();
        self.push_chain(j, None, from);
        self.removed += 1;
        true
    }

    /// Adds the left-out column of the unknown `i`, whose coefficient in each row is given, and restores the triangle by
    /// rotations; `false`, with the factor as it was, where too many rotations have gathered.
    pub(crate) fn join(&mut self, i: usize, coefficient: impl Fn(Constraint) -> f64) -> bool {
        let (len, stride, w) = (self.len(), self.stride, self.width());
        if !self.has_room_for(len) {
            return false;
        }
        self.columns_left_out.retain(|&left_out| left_out != i);
        self.columns.push(i);
        self.joining.clear();
        self.joining.extend(self.constraints.iter().map(|&constraint| coefficient(constraint)));
        let from = self.rotations.len();
        let first = self.joining.iter().position(|entry| *entry != 0.0).unwrap_or(len);
        for c in first..len {
            let (length, cosine, sine) = rotation(self.diagonal[c], self.joining[c]);
            self.diagonal[c] = length;
            rotate(&mut self.lower[c * stride + c + 1..c * stride + len], &mut self.joining[c + 1..], cosine, sine);
            self.rotations.push((cosine, sine));
        }
        self.push_chain(first, Some(w), from);
        true
    }

    fn has_room_for(&self, rotations: usize) -> bool {
        self.rotations.len() + rotations <= ROTATIONS_PER_COLUMN * self.stride
            && self.reflections.len() < 2 * self.stride
    }

    fn push_chain(&mut self, first: usize, with: Option<usize>, from: usize) {
        let (reflections, to) = (self.reflections.len(), self.rotations.len());
        self.chains.push(Chain { reflections, first, with, from, to });
    }

    /// Solves `L y = c` for the rows `from..`, as if the solution of the rows before were zero.
    pub(crate) fn solve_lower(&self, from: usize, c: &[f64], y: &mut [f64]) {
        let rows = self.len() - from;
        y[..rows].copy_from_slice(&c[..rows]);
        for r in from..self.len() {
            let (own, rest) = y[r - from..rows].split_at_mut(1);
            own[0] /= self.diagonal[r];
            add_scaled(rest, -own[0], &self.lower[r * self.stride + r + 1..r * self.stride + self.len()]);
        }
    }

    /// Replaces `h[..len]` by the solution of `L^T z = h` with the first `len` rows.
    pub(crate) fn solve_lower_transposed(&self, len: usize, h: &mut [f64]) {
        for r in (0..len).rev() {
            let (own, rest) = h[r..len].split_at_mut(1);
            let column = &self.lower[r * self.stride + r + 1..r * self.stride + len];
            own[0] = (own[0] - dot(column, rest)) / self.diagonal[r];
        }
    }

    /// `L[r][r]`.
    pub(crate) fn diagonal(&self, r: usize) -> f64 {
        self.diagonal[r]
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

impl Chain {
    /// The columns of its rotation `k`.
    #[inline]
    fn pair(&self, k: usize) -> (usize, usize) {
        let i = self.first + k;
        (i, self.with.unwrap_or(i + 1))
    }
}
