//! Space for the largest problem to come, all at once.

use crate::diagonal::Diagonal;
use crate::factor::Factor;
use crate::linalg::LeastSquares;
use crate::multipliers::Table;
use crate::solver::Solver;

impl Solver {
    /// Knows nothing yet, and allocates nothing for problems up to this size: `unknowns`, `levels`, `most` rows in one of them,
    /// `all` rows.
    pub fn with_capacity(unknowns: usize, levels: usize, most: usize, all: usize) -> Self {
        let n = unknowns.next_multiple_of(8);
        Self {
            x: Vec::with_capacity(n),
            offsets: Vec::with_capacity(levels + 1),
            places: Vec::with_capacity(all),
            bounds: Vec::with_capacity(n),
            held: Vec::with_capacity(n),
            sides: Vec::with_capacity(all),
            roles: Vec::with_capacity(all),
            norms: Vec::with_capacity(all),
            single: Vec::with_capacity(all),
            limits: Vec::with_capacity(all),
            residuals: Vec::with_capacity(all),
            order: Vec::with_capacity(n),
            factor: Factor::with_capacity(n),
            dependents: Vec::with_capacity(all),
            table: Table::with_capacity(unknowns, levels, all),
            turned: Vec::with_capacity(most * n),
            left: Vec::with_capacity(most),
            soft: Vec::with_capacity(most),
            right: Vec::with_capacity(most),
            kept: Vec::with_capacity(most),
            y: Vec::with_capacity(n),
            step: Vec::with_capacity(n),
            gradient: Vec::with_capacity(n),
            work: Vec::with_capacity(n),
            turned_x: Vec::with_capacity(n),
            entries: Vec::with_capacity(n + all),
            least: LeastSquares::with_capacity(most + n, n),
            diagonal: Diagonal::with_capacity(n),
            ..Self::default()
        }
    }
}

impl Factor {
    fn with_capacity(n: usize) -> Self {
        Self {
            free: Vec::with_capacity(n),
            left_out: Vec::with_capacity(n),
            entries: Vec::with_capacity(n),
            lower: Vec::with_capacity(n * n),
            vectors: Vec::with_capacity(n * n),
            ends: Vec::with_capacity(n),
            diagonal: Vec::with_capacity(n),
            scale: Vec::with_capacity(n),
            cross: Vec::with_capacity(n),
        }
    }
}

impl Table {
    fn with_capacity(unknowns: usize, levels: usize, all: usize) -> Self {
        Self {
            bounds: Vec::with_capacity(levels * unknowns),
            rows: Vec::with_capacity(levels * all),
            starts: Vec::with_capacity(levels + 1),
            ..Self::default()
        }
    }
}

impl Diagonal {
    fn with_capacity(n: usize) -> Self {
        Self {
            asked: Vec::with_capacity(n),
            unasked: Vec::with_capacity(n),
            half: Vec::with_capacity(n * n),
            square: Vec::with_capacity(n * n),
            columns: Vec::with_capacity(n),
            wanted: Vec::with_capacity(n),
        }
    }
}
