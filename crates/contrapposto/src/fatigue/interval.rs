//! Steps the fatigue of a muscle group between two instants, between which its relative load changes in a straight line.

use super::{FatigueLaw, FatigueState};

/// Longest piece of time under one load, s.
const PIECE: f64 = 0.25;
/// Most pieces between two instants.
const MOST_PIECES: f64 = 1000.0;
/// Bisections of the piece in which a group reaches a fatigue: to the last bits of a piece of 0.25 s.
const BISECTIONS: usize = 50;

/// The time between two instants for one group. It is stepped in pieces, each under the load of its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Relative load before and after.
    pub load: (f64, f64),
    /// Length, s.
    pub seconds: f64,
}

impl Interval {
    /// The pieces, each from a share of the interval to another one.
    pub fn pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        let pieces = (self.seconds / PIECE).ceil().clamp(1.0, MOST_PIECES);
        (0..pieces as u64).map(move |piece| (piece as f64 / pieces, (piece + 1) as f64 / pieces))
    }

    /// Relative load at a share of the interval.
    pub fn load_at(&self, share: f64) -> f64 {
        self.load.0 + share * (self.load.1 - self.load.0)
    }

    /// The load of a piece, and its length, s.
    pub(super) fn constant(&self, (from, to): (f64, f64)) -> (f64, f64) {
        (self.load_at(f64::midpoint(from, to)), (to - from) * self.seconds)
    }

    /// State and fatigue at the end of a piece that begins in the state `start`.
    pub fn advance(&self, law: &FatigueLaw, start: FatigueState, piece: (f64, f64)) -> (FatigueState, f64) {
        if self.seconds <= 0.0 {
            return (start, start.level(self.load.1));
        }
        let (load, seconds) = self.constant(piece);
        let state = law.advance(start, load, seconds);
        (state, state.level(self.load_at(piece.1)))
    }

    /// The share at which fatigue reaches a level within a piece that begins in the state `start`, and at whose end it is reached.
    pub fn share_of(&self, law: &FatigueLaw, start: FatigueState, (from, to): (f64, f64), level: f64) -> f64 {
        let (mut before, mut after) = (from, to);
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(before, after);
            let reached = self.advance(law, start, (from, middle)).1 >= level;
            if reached { after = middle } else { before = middle }
        }
        after
    }
}
