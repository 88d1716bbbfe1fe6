//! Which directions are still free? Rows that are fixed or active, as `C = L Q1^T`: `L` lower triangular, `Q` a product of
//! Householder reflections, one a row. What is left of `Q` spans the null space of all rows so far.
//!
//! Unknowns at a bound from the start are not rows but columns left out (`free` lists the others). Where the
//! first level knows few unknowns, as two placed feet do, these come first, and its vectors end early.

use crate::linalg::{add_scaled, add_scaled_pair, dot, dot_pair, norm};

/// What a row of the factor stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// The bound of an unknown.
    Bound(usize),
    /// A row, counted through all levels.
    Row(usize),
}

/// See the module's text.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factor {
    /// Unknowns that are not left out, and those that are.
    pub(crate) free: Vec<usize>,
    pub(crate) left_out: Vec<usize>,
    /// What each row stands for.
    pub(crate) entries: Vec<Entry>,
    /// `L[r][..r]`, one row after the other, as long as `free`.
    pub(crate) lower: Vec<f64>,
    /// The reflections' vectors, [`Factor::padded`] long: zero before place `r` and behind `free`, so that sums may run over
    /// whole eights.
    pub(crate) vectors: Vec<f64>,
    /// Where they end, in whole eights: only zeros from there on.
    pub(crate) ends: Vec<usize>,
    pub(crate) diagonal: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    /// Product of each vector with the one before.
    pub(crate) cross: Vec<f64>,
}

impl Factor {
    /// No rows; the unknowns of `order` that are `fixed` are left out.
    pub(crate) fn reset(&mut self, order: &[usize], fixed: impl Fn(usize) -> bool) {
        self.free.clear();
        self.free.extend(order.iter().filter(|&&i| !fixed(i)));
        self.left_out.clear();
        self.left_out.extend(order.iter().filter(|&&i| fixed(i)));
        self.truncate(0);
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Number of unknowns that are not left out.
    pub(crate) fn width(&self) -> usize {
        self.free.len()
    }

    /// The width up to the next eight: so long are turned rows, zero behind [`Factor::width`].
    pub(crate) fn padded(&self) -> usize {
        self.free.len().next_multiple_of(8)
    }

    /// Forgets all rows from `len` on.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.entries.truncate(len);
        self.lower.truncate(len * self.free.len());
        self.vectors.truncate(len * self.padded());
        self.ends.truncate(len);
        self.diagonal.truncate(len);
        self.scale.truncate(len);
        self.cross.truncate(len);
    }

    /// The entries of `x` at the free unknowns, then zeros.
    pub(crate) fn gather(&self, x: &[f64], out: &mut [f64]) {
        for (out, &i) in out.iter_mut().zip(&self.free) {
            *out = x[i];
        }
        out[self.free.len()..self.padded()].fill(0.0);
    }

    /// `t -= scale (v . t) v` with the vector of row `r`.
    #[inline]
    fn reflect(&self, r: usize, t: &mut [f64]) {
        let start = r * self.padded();
        let (first, end) = (r / 8 * 8, self.ends[r]);
        let (v, t) = (&self.vectors[start + first..start + end], &mut t[first..end]);
        let s = self.scale[r] * dot(v, t);
        add_scaled(t, -s, v);
    }

    /// The vectors of rows `r - 1` and `r` and what they are applied to, from the eight where the first begins to where both end.
    #[inline]
    fn pair<'a>(&'a self, r: usize, t: &'a mut [f64]) -> (&'a [f64], &'a [f64], &'a mut [f64]) {
        let c = self.padded();
        let (first, end) = ((r - 1) / 8 * 8, self.ends[r - 1].max(self.ends[r]));
        let vector = |r: usize| &self.vectors[r * c + first..r * c + end];
        (vector(r - 1), vector(r), &mut t[first..end])
    }

    /// Applies the reflections of rows `from..to` to `t`: `Q^T t`, as far as they go. Two at a time, which reads `t` once.
    pub(crate) fn turn(&self, t: &mut [f64], from: usize, to: usize) {
        let mut r = from;
        while r + 1 < to {
            let (a, b, t) = self.pair(r + 1, t);
            let (p, q) = dot_pair(a, b, t);
            let p = self.scale[r] * p;
            let q = self.scale[r + 1] * (q - p * self.cross[r + 1]);
            add_scaled_pair(t, -p, a, -q, b);
            r += 2;
        }
        if r < to {
            self.reflect(r, t);
        }
    }

    /// Applies all reflections backwards: `Q t`.
    pub(crate) fn turn_back(&self, t: &mut [f64]) {
        let mut r = self.len();
        while r >= 2 {
            let (a, b, t) = self.pair(r - 1, t);
            let (p, q) = dot_pair(a, b, t);
            let q = self.scale[r - 1] * q;
            let p = self.scale[r - 2] * (p - q * self.cross[r - 1]);
            add_scaled_pair(t, -p, a, -q, b);
            r -= 2;
        }
        if r == 1 {
            self.reflect(0, t);
        }
    }

    /// Adds a turned row, `Q^T` times it: its part beyond [`Factor::len`] must not vanish.
    pub(crate) fn append(&mut self, t: &[f64], entry: Entry) {
        let (r, w, c) = (self.len(), self.width(), self.padded());
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
        self.scale.push(-1.0 / (beta * (t[r] - beta)));
        self.entries.push(entry);
    }

    /// `y` with `L y = c` for the rows `from..`, whose right-hand sides are `c`; entries before `from` count as zero.
    pub(crate) fn solve_lower(&self, from: usize, c: &[f64], y: &mut [f64]) {
        let w = self.free.len();
        for r in from..self.len() {
            let row = &self.lower[r * w..r * w + r];
            y[r - from] = (c[r - from] - dot(&row[from..], &y[..r - from])) / self.diagonal[r];
        }
    }

    /// Replaces `h[..len]` by the solution of `L[..len]^T z = h`.
    pub(crate) fn solve_upper(&self, len: usize, h: &mut [f64]) {
        let w = self.free.len();
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
        let w = self.free.len();
        &self.lower[r * w..r * w + r]
    }
}
