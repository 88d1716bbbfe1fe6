//! What do the levels and bounds above a level cost it?

/// Lagrange multipliers of one level `k`: `A_k^T residual_k + mu^2 x + sum_{j<k} A_j^T rows_j + bounds = 0` (the damping
/// term only for a damped level, with the `x` it ended at, before the levels below moved on).
///
/// At an upper side a multiplier is positive or zero, at a lower side negative or zero: the level would gain by passing it.
/// Rows that are equations, or that keep a residual of their own, may have either sign; so may a side that a level between
/// presses on (its multiplier there is not zero): to leave it would cost that level something, which no lower one may. Of a hard first level that cannot
/// hold, residual and `bounds` are the certificate: with `y` the residual, `A^T y + bounds = 0`, and no `x` between the
/// bounds satisfies the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multipliers<'a> {
    /// By unknown.
    pub bounds: &'a [f64],
    /// By row, all levels above, the first level first.
    pub rows: &'a [f64],
}

/// Storage of all levels' multipliers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub(crate) unknowns: usize,
    pub(crate) bounds: Vec<f64>,
    pub(crate) rows: Vec<f64>,
    /// Where the rows of each level begin.
    pub(crate) starts: Vec<usize>,
}

impl Table {
    /// Zeros for `unknowns` and levels whose first rows are `offsets`.
    pub(crate) fn reset(&mut self, unknowns: usize, offsets: &[usize]) {
        self.unknowns = unknowns;
        let levels = offsets.len() - 1;
        self.bounds.clear();
        self.bounds.resize(levels * unknowns, 0.0);
        self.starts.clear();
        let mut sum = 0;
        for offset in offsets {
            self.starts.push(sum);
            sum += offset;
        }
        self.rows.clear();
        self.rows.resize(self.starts[levels], 0.0);
    }

    /// Those of one level; none where nothing was solved.
    pub(crate) fn level(&self, k: usize) -> Multipliers<'_> {
        let Some(starts) = self.starts.get(k..k + 2) else { return Multipliers { bounds: &[], rows: &[] } };
        Multipliers {
            bounds: &self.bounds[k * self.unknowns..(k + 1) * self.unknowns],
            rows: &self.rows[starts[0]..starts[1]],
        }
    }

    /// Those of one level, to fill: bounds and rows.
    pub(crate) fn level_mut(&mut self, k: usize) -> (&mut [f64], &mut [f64]) {
        let bounds = &mut self.bounds[k * self.unknowns..(k + 1) * self.unknowns];
        (bounds, &mut self.rows[self.starts[k]..self.starts[k + 1]])
    }
}
