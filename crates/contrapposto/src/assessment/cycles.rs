//! Finds the cycles of a motion, and the mean and the spread of a quantity over them.
//!
//! Where the forces of the ground are known, a cycle goes from one landing of a foot to its next one. Otherwise the motion is compared with
//! itself a lag later:
//! `d(lag) = sum |q(t + lag) - q(t)|^2 / sum (|q(t) - m|^2 + |q(t + lag) - m'|^2)`, with the angles `q` and the means `m` and `m'` of both parts,
//! is 0 where the motion comes back exactly and 1 of two parts that have nothing in common. The first minimum below `ALIKE` after a value above
//! `APART` is the length of a cycle, and each start lies where the motion is nearest to the first cycle.
//!
//! A quantity is read at each percent of every cycle, linearly between the instants of the motion. The spread is the standard deviation of the
//! sample of cycles (divisor `n - 1`); one cycle has none.

use super::cycle_search::{NoCycles, cycle_bounds};

/// Upward force of the ground from which on a foot has landed, N. Assumed: force plates drift by some newtons.
const LANDED: f64 = 20.0;
/// Least time on the ground after a landing, and in the air before it, s. Assumed: shorter ones are noise.
const LEAST_TIME: f64 = 0.05;
/// The longest of the cycles between landings over the shortest, from which on these are no cycles. Assumed.
const MOST_UNEVEN: f64 = 1.5;
/// Part of a cycle by which the last one of a given length may end after the motion: times are written in decimals. Assumed.
const LAST_SHARE: f64 = 1e-6;
/// Most cycles of a given length. Assumed.
const MOST_CYCLES: f64 = 1e6;
/// Number of the values of a curve: one for each percent, both ends included.
pub const PERCENTS: usize = 101;

/// The reason for the bounds of cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleOrigin {
    /// Landings of the segment of this index.
    Landings(usize),
    /// Angles that come back.
    Angles,
    /// Given times.
    Given,
    /// The whole motion is one cycle.
    Whole,
}

/// Cycles of a motion, one directly after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycles {
    /// The start of every cycle, and the end of the last one, s; rising, two at least.
    pub bounds: Vec<f64>,
    /// The reason for them.
    pub origin: CycleOrigin,
}

impl Cycles {
    /// The cycles between landings: `forces` has for each segment that the ground pushes its upward force (N) at all `times`. The segment
    /// with most landings counts, of equals the first. Where angles come back in much less time, forces have missed landings, and the
    /// angles count.
    ///
    /// # Errors
    /// The reason why the angles show no cycles either.
    pub fn find(times: &[f64], forces: &[(usize, Vec<f64>)], angles: &[Vec<f64>]) -> Result<Self, NoCycles> {
        let by_angles = cycle_bounds(times, angles).map(|bounds| Self { bounds, origin: CycleOrigin::Angles });
        let Some(by_landings) = Self::of_landings(times, forces) else { return by_angles };
        match by_angles {
            Ok(shorter) if MOST_UNEVEN * shorter.length().0 < by_landings.length().0 => Ok(shorter),
            _ => Ok(by_landings),
        }
    }

    /// Cycles of one length (s, above 0) from the start of a motion on, as many as it has whole ones; `None` if it is shorter than one.
    pub fn of_length(length: f64, (start, end): (f64, f64)) -> Option<Self> {
        let count = ((end - start) / length + LAST_SHARE).floor();
        let bound = |k: usize| (start + k as f64 * length).min(end);
        (1.0..=MOST_CYCLES)
            .contains(&count)
            .then(|| Self { bounds: (0..=count as usize).map(bound).collect(), origin: CycleOrigin::Given })
    }

    fn of_landings(times: &[f64], forces: &[(usize, Vec<f64>)]) -> Option<Self> {
        let mut best: Option<Self> = None;
        for (segment, force) in forces {
            let bounds = landings(times, force);
            if bounds.len() >= 2.max(best.as_ref().map_or(0, |best| best.bounds.len() + 1)) {
                best = Some(Self { bounds, origin: CycleOrigin::Landings(*segment) });
            }
        }
        best.filter(|cycles| {
            let (least, most) = cycles.lengths().fold((f64::INFINITY, 0.0), |(a, b), s| (s.min(a), s.max(b)));
            most <= MOST_UNEVEN * least
        })
    }

    /// Number of cycles.
    pub fn count(&self) -> usize {
        self.bounds.len().saturating_sub(1)
    }

    /// Lengths of the cycles, s.
    fn lengths(&self) -> impl Iterator<Item = f64> + Clone {
        self.bounds.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// Mean length and its standard deviation, s; one cycle has none.
    pub fn length(&self) -> (f64, Option<f64>) {
        mean_and_deviation(self.lengths())
    }
}

/// The times at which a force begins to push, s: between two instants in a straight line.
fn landings(times: &[f64], force: &[f64]) -> Vec<f64> {
    let mut found = vec![];
    let (mut in_air_since, mut landed): (Option<f64>, Option<f64>) = (None, None);
    for (i, (&time, &newtons)) in times.iter().zip(force).enumerate() {
        if newtons < LANDED {
            (in_air_since, landed) = (in_air_since.or(Some(time)), None);
            continue;
        }
        if let Some(since) = in_air_since.take().filter(|since| time - since >= LEAST_TIME) {
            debug_assert!(time > since);
            let (before, force_before) = (times[i - 1], force[i - 1]);
            landed = Some(before + (LANDED - force_before) / (newtons - force_before) * (time - before));
        }
        if let Some(at) = landed.filter(|at| time - at >= LEAST_TIME) {
            found.push(at);
            landed = None;
        }
    }
    found
}

/// Mean and standard deviation (divisor `n - 1`) of values; one value has no deviation.
fn mean_and_deviation(values: impl Iterator<Item = f64> + Clone) -> (f64, Option<f64>) {
    let (count, sum) = values.clone().fold((0_usize, 0.0), |(count, sum), value| (count + 1, sum + value));
    let mean = sum / count.max(1) as f64;
    let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
    (mean, (count > 1).then(|| (squares / (count - 1) as f64).sqrt()))
}

/// A quantity over the percents of a cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Mean over the cycles, [`PERCENTS`] values.
    pub mean: Vec<f64>,
    /// Standard deviation at the same percents; empty of one cycle.
    pub deviation: Vec<f64>,
}

/// The places in a motion at which its cycles are read.
#[derive(Clone, Debug)]
pub struct CycleGrid {
    /// Of every percent of every cycle: the instant before it, and the share of the way to the next one.
    places: Vec<[(usize, f64); PERCENTS]>,
}

impl CycleGrid {
    /// The places in a motion with these times, s.
    ///
    /// ```
    /// use contrapposto::assessment::{CycleGrid, CycleOrigin, Cycles};
    /// let cycles = Cycles { bounds: vec![0.0, 1.0, 2.0], origin: CycleOrigin::Given };
    /// let curve = CycleGrid::new(&cycles, &[0.0, 1.0, 2.0]).curve(&[0.0, 10.0, 30.0]);
    /// assert_eq!(curve.mean[50], 12.5); // 5 in the first cycle, 20 in the second one
    /// assert_eq!(curve.deviation[50], 112.5_f64.sqrt());
    /// ```
    pub fn new(cycles: &Cycles, times: &[f64]) -> Self {
        let last = times.len().saturating_sub(1);
        let place = |time: f64| {
            let before = times.partition_point(|t| *t <= time).saturating_sub(1).min(last.saturating_sub(1));
            let (from, to) = (times[before], times[(before + 1).min(last)]);
            (before, if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 })
        };
        let of_cycle = |pair: &[f64]| {
            std::array::from_fn(|percent| place(pair[0] + percent as f64 / (PERCENTS - 1) as f64 * (pair[1] - pair[0])))
        };
        let pairs = cycles.bounds.windows(2).filter(|_| !times.is_empty());
        Self { places: pairs.map(of_cycle).collect() }
    }

    /// Mean and spread of a quantity that has a value at each time of the motion.
    pub fn curve(&self, values: &[f64]) -> Curve {
        let read = |(before, share): (usize, f64)| {
            let from = values.get(before).copied().unwrap_or_default();
            from + share * (values.get(before + 1).copied().unwrap_or(from) - from)
        };
        let mut curve = Curve::default();
        for percent in 0..PERCENTS {
            let (mean, deviation) = mean_and_deviation(self.places.iter().map(|cycle| read(cycle[percent])));
            curve.mean.push(mean);
            curve.deviation.extend(deviation);
        }
        curve
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use std::f64::consts::TAU;

    use super::*;

    /// Sixty instants a second.
    fn times(seconds: f64) -> Vec<f64> {
        (0..=(60.0 * seconds) as usize).map(|i| i as f64 / 60.0).collect()
    }

    /// A force that pushes with 700 N in the first six tenths of each cycle, from its bound on.
    fn steps(times: &[f64], bounds: &[f64]) -> Vec<f64> {
        let on = |time: f64| bounds.windows(2).any(|pair| (0.0..0.6 * (pair[1] - pair[0])).contains(&(time - pair[0])));
        times.iter().map(|&time| if on(time) { 700.0 } else { 3.0 }).collect()
    }

    #[test]
    fn cycles_go_from_landing_to_landing_of_the_foot_that_lands_most() {
        let times = times(6.0);
        let right = [0.4, 1.5, 2.55, 3.7, 4.8, 5.95];
        let left = [1.0, 2.1, 3.2, 4.3, 5.4];
        let forces = [(7, steps(&times, &left)), (3, steps(&times, &right))];
        let found = Cycles::find(&times, &forces, &[]).unwrap();
        assert_eq!(found.origin, CycleOrigin::Landings(3));
        let landed = &right[..5]; // nothing pushes after the last bound
        assert_eq!(found.bounds.len(), landed.len());
        for (found, wanted) in found.bounds.iter().zip(landed) {
            assert!((found - wanted).abs() <= 1.0 / 60.0, "{found} {wanted}");
        }
        let (mean, deviation) = found.length();
        assert!((mean - 1.1).abs() < 0.01 && (deviation.unwrap() - 0.04).abs() < 0.02, "{mean} {deviation:?}");
    }

    #[test]
    fn noise_of_plates_and_uneven_landings_are_no_cycles() {
        let times = times(6.0);
        let mut force = steps(&times, &[0.5, 1.5, 2.5, 3.5]);
        let clean = Cycles::find(&times, &[(0, force.clone())], &[]).unwrap();
        force[250] = 40.0; // a spike in the air, after the last step
        force[40] = 0.0; // and a gap on the ground
        assert_eq!(Cycles::find(&times, &[(0, force)], &[]), Ok(clean));
        let uneven = steps(&times, &[0.5, 1.5, 4.5, 5.5]);
        let none = Err(NoCycles::TooShort); // there are no angles
        assert_eq!(Cycles::find(&times, &[(0, uneven)], &[]), none);
        assert_eq!(Cycles::find(&times, &[(0, vec![700.0; times.len()])], &[]), none, "a foot that stays");
    }

    #[test]
    fn landings_that_plates_miss_do_not_double_a_cycle() {
        let times = times(6.0);
        let angle: Vec<f64> = times.iter().map(|time| libm::sin(TAU * time / 1.2)).collect();
        let seen = steps(&times, &[0.3, 0.9, 2.7])
            .iter()
            .zip(&times)
            .map(|(f, t)| if *t < 2.0 { *f } else { 0.0 })
            .collect::<Vec<_>>();
        let twice: Vec<f64> =
            seen.iter().zip(&times).map(|(f, t)| if (2.7..3.4).contains(t) { 700.0 } else { *f }).collect();
        let found = Cycles::find(&times, &[(0, twice)], &[angle]).unwrap();
        assert_eq!(found.origin, CycleOrigin::Angles);
        assert!((found.length().0 - 1.2).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn cycles_of_a_given_length_fill_the_motion() {
        let found = Cycles::of_length(0.1, (0.2, 0.5)).unwrap();
        assert_eq!((found.count(), found.bounds[3], found.origin), (3, 0.5, CycleOrigin::Given));
        assert_eq!(Cycles::of_length(1.0, (0.0, 3.7)).unwrap().bounds, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(Cycles::of_length(4.0, (0.0, 3.7)), None);
        assert_eq!(Cycles::of_length(1e-9, (0.0, 3.7)), None);
    }

    #[test]
    fn mean_and_spread_of_a_known_family_of_curves() {
        // Cycles of unequal length; in each of them the quantity is its factor times sin.
        let (bounds, factors) = ([0.0, 1.0, 2.5, 3.3], [1.0, 2.0, 6.0]);
        let times: Vec<f64> = (0..=33_000).map(|i| f64::from(i) * 1e-4).collect();
        let value = |time: f64| {
            let k = bounds[1..3].iter().filter(|bound| time >= **bound).count();
            factors[k] * libm::sin(TAU * (time - bounds[k]) / (bounds[k + 1] - bounds[k]))
        };
        let values: Vec<f64> = times.iter().map(|time| value(*time)).collect();
        let cycles = Cycles { bounds: bounds.to_vec(), origin: CycleOrigin::Given };
        let curve = CycleGrid::new(&cycles, &times).curve(&values);
        for percent in 0..PERCENTS {
            let sine = libm::sin(TAU * percent as f64 / 100.0);
            assert!((curve.mean[percent] - 3.0 * sine).abs() < 1e-5, "{percent}");
            assert!((curve.deviation[percent] - 7f64.sqrt() * sine.abs()).abs() < 1e-5, "{percent}");
        }
        let one = Cycles { bounds: vec![0.0, 1.0], ..cycles };
        let curve = CycleGrid::new(&one, &times).curve(&values);
        assert!(curve.deviation.is_empty() && (curve.mean[25] - 1.0).abs() < 1e-6);
    }
}
