//! Stores the Lagrange multipliers of the levels and bounds above each level.

/// Lagrange multipliers of one level `k`: `A_k^T residual_k + mu^2 x + sum_{j<k} A_j^T rows_j + bounds = 0`.
///
/// The damping term exists for a damped level only, with the `x` at the end of that level, before the levels below moved on.
///
/// At an upper limit a multiplier is positive or zero, at a lower limit negative or zero: the level would gain by passing the
/// limit. Equations, rows with a residual, and limits with a multiplier at a level between may have either sign: to leave such
/// a limit would cost a higher level something. The residual `y` of a hard first level that is infeasible, and its `bounds`,
/// are the certificate (Farkas): `A^T y + bounds = 0`, and no `x` within the bounds satisfies the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multipliers<'a> {
    /// By unknown.
    pub bounds: &'a [f64],
    /// By row of all levels above, the first level first.
    pub rows: &'a [f64],
}

/// Multipliers of all levels.
#[derive(Clone, Debug, Default)]
pub(crate) struct MultiplierTable {
    unknowns: usize,
    bounds: Vec<f64>,
    rows: Vec<f64>,
    /// First entry of `rows` for each level; one more at the end.
    starts: Vec<usize>,
}

impl MultiplierTable {
    pub(crate) fn with_capacity(unknowns: usize, levels: usize, rows: usize) -> Self {
        Self {
            bounds: Vec::with_capacity(levels * unknowns),
            rows: Vec::with_capacity(levels * rows),
            starts: Vec::with_capacity(levels + 1),
            ..Self::default()
        }
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.starts.clear();
    }

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

    /// Multipliers of one level; empty before the first solution.
    pub(crate) fn level(&self, k: usize) -> Multipliers<'_> {
        let Some(starts) = self.starts.get(k..k + 2) else { return Multipliers { bounds: &[], rows: &[] } };
        Multipliers {
            bounds: &self.bounds[k * self.unknowns..(k + 1) * self.unknowns],
            rows: &self.rows[starts[0]..starts[1]],
        }
    }

    /// Bounds and rows of one level, to be filled.
    pub(crate) fn level_mut(&mut self, k: usize) -> (&mut [f64], &mut [f64]) {
        let bounds = &mut self.bounds[k * self.unknowns..(k + 1) * self.unknowns];
        (bounds, &mut self.rows[self.starts[k]..self.starts[k + 1]])
    }
}
