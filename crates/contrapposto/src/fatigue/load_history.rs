//! Records the relative load of a muscle group over time, in pieces during which it stays the same.

use serde::{Deserialize, Serialize};

/// A load that differs by less, as a share of strength, counts as the same.
const SAME_LOAD: f64 = 0.005;

/// Relative load of one group over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadHistory {
    /// Times (s) from which on the group carries a load, and that load.
    pieces: Vec<(f64, f64)>,
}

impl LoadHistory {
    /// One load from the time 0 on.
    pub fn constant(load: f64) -> Self {
        Self { pieces: vec![(0.0, load)] }
    }

    /// The load at a time, s, which is not before the last one.
    pub fn push(&mut self, time: f64, load: f64) {
        if self.pieces.last().is_none_or(|(_, last)| (last - load).abs() > SAME_LOAD) {
            self.pieces.push((time, load));
        }
    }

    /// Times (s) from which on the group carries a relative load, and that load, in order.
    pub fn pieces(&self) -> &[(f64, f64)] {
        &self.pieces
    }

    /// The load at a time, s; 0 before the first.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.pieces.partition_point(|(from, _)| *from <= time);
        after.checked_sub(1).map_or(0.0, |last| self.pieces[last].1)
    }
}
