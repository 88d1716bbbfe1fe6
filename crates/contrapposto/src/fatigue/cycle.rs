//! Holds the relative load of a muscle group over one cycle of a repeated job.

use super::{Interval, REST_LOAD};

/// Relative load over a cycle, which changes in a straight line between its instants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCycle {
    /// Times (s) and relative loads, in order.
    points: Vec<(f64, f64)>,
}

impl LoadCycle {
    /// The load at the next instant, s, which is not before the last one.
    pub fn push(&mut self, time: f64, load: f64) {
        self.points.push((time, load));
    }

    /// Length, s.
    pub fn seconds(&self) -> f64 {
        self.points.first().zip(self.points.last()).map_or(0.0, |(first, last)| last.0 - first.0)
    }

    /// Relative load of the first instant; 0 of none.
    pub fn first(&self) -> f64 {
        self.points.first().map_or(0.0, |point| point.1)
    }

    /// Whether the group never works.
    pub fn is_idle(&self) -> bool {
        self.points.iter().all(|(_, load)| *load <= 0.0)
    }

    /// The times between two instants each, of a group with `strength` times the strength that the loads are shares of.
    pub fn intervals(&self, strength: f64) -> impl Iterator<Item = Interval> {
        self.points.windows(2).map(move |ends| Interval {
            load: (ends[0].1 / strength, ends[1].1 / strength),
            seconds: ends[1].0 - ends[0].0,
        })
    }

    /// The share of the time `every` (s) of a cycle with its pause in which the group works: its load is above [`REST_LOAD`]. And its mean load.
    pub fn duty(&self, every: f64) -> (f64, f64) {
        let (mut works, mut sum) = (0.0, 0.0);
        for interval in self.intervals(1.0) {
            for piece in interval.pieces() {
                let (load, seconds) = interval.constant(piece);
                works += if load > REST_LOAD { seconds } else { 0.0 };
                sum += load * seconds;
            }
        }
        let every = every.max(f64::MIN_POSITIVE);
        (works / every, sum / every)
    }
}
