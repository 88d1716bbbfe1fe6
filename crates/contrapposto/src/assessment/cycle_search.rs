//! Searches a motion for the time after which its angles come back.

/// Angles count as those of the cycle before where their `d` is below this number. Assumed: of strides of one person it is below 0.05.
pub const ALIKE: f64 = 0.1;
/// Angles have left those of the start where `d` is above this number. Assumed.
const APART: f64 = 0.5;
/// Longest lag that is tried, as a share of the motion: the rest of it is compared. Assumed.
const LONGEST_LAG: f64 = 0.8;
/// Least variance of the compared parts as a share of that of the motion: two parts at rest are alike, and no cycles. Assumed.
const LEAST_VARIANCE: f64 = 0.25;
/// Least standard deviation of all angles together of a motion with cycles, rad (1 degree). Assumed.
const LEAST_MOVEMENT: f64 = 0.017_453;
/// Most instants that are compared at a time, and the longest step between them in a first search of the beginning, s. Both assumed.
const MOST_INSTANTS: usize = 1500;
const LONGEST_STEP: f64 = 0.05;
/// Steps of a cycle when the starts are found.
const STEPS: usize = 100;
/// Steps by which a cycle may be longer or shorter than the first. Assumed.
const MOST_SHIFT: usize = 20;
/// Least part of a cycle that must be there for its start to be found, steps.
const LEAST_COMPARED: usize = STEPS / 4;

/// The reason why a motion has no cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoCycles {
    /// Fewer than three instants, or no angles.
    TooShort,
    /// Angles that move less than a degree.
    Still,
    /// Angles that do not come back: the lag after which they are nearest to it once they have left, s, and `d` there; `None` if they never
    /// leave, or if nothing moves beside the nearest lag.
    NotBack(Option<(f64, f64)>),
}

/// Values of all angles at even times.
struct Grid {
    start: f64,
    step: f64,
    /// Instant by instant.
    rows: Vec<f64>,
    width: usize,
}

impl Grid {
    /// Angles, linear between their times, at `count` times from `start` on.
    fn new(times: &[f64], angles: &[Vec<f64>], (start, step, count): (f64, f64, usize)) -> Self {
        let width = angles.len();
        let mut rows = Vec::with_capacity(width * count);
        let mut before = 0;
        for k in 0..count {
            let time = start + step * k as f64;
            while before + 2 < times.len() && times[before + 1] <= time {
                before += 1;
            }
            let (from, to) = (times[before], times[before + 1]);
            let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            rows.extend(angles.iter().map(|angle| angle[before] + share * (angle[before + 1] - angle[before])));
        }
        Self { start, step, rows, width }
    }

    fn count(&self) -> usize {
        self.rows.len() / self.width.max(1)
    }

    /// Sum of the squared differences of two rows.
    fn apart(&self, a: usize, b: usize) -> f64 {
        let row = |at: usize| &self.rows[at * self.width..(at + 1) * self.width];
        row(a).iter().zip(row(b)).map(|(x, y)| (x - y) * (x - y)).sum()
    }

    /// Mean of the same over the rows of the first cycle and those from row `at` on, as many as there are. The first rows weigh most, so that
    /// a cycle that is longer or shorter shifts its start little. Infinite for too few rows.
    fn distance_to_first(&self, at: usize) -> f64 {
        let part = STEPS.min(self.count().saturating_sub(at));
        let weight = |k: usize| (1.0 - k as f64 / STEPS as f64).powi(4);
        let [sum, weights] = (0..part)
            .fold([0.0; 2], |[sum, weights], k| [sum + weight(k) * self.apart(k, at + k), weights + weight(k)]);
        if part >= LEAST_COMPARED { sum / weights } else { f64::INFINITY }
    }
}

/// Sums from the start of a grid to each row, by which variances of parts follow.
struct Sums {
    width: usize,
    /// Of all angles.
    values: Vec<f64>,
    /// Of the squares, over all angles.
    squares: Vec<f64>,
}

impl Sums {
    fn new(grid: &Grid) -> Self {
        let width = grid.width;
        let (mut values, mut squares) = (vec![0.0; width], vec![0.0]);
        for (row, numbers) in grid.rows.chunks_exact(width.max(1)).enumerate() {
            squares.push(squares[row] + numbers.iter().map(|x| x * x).sum::<f64>());
            for (k, number) in numbers.iter().enumerate() {
                values.push(values[row * width + k] + number);
            }
        }
        Self { width, values, squares }
    }

    /// Sum of the squared deviations of the rows `from..to` from their mean.
    fn spread(&self, from: usize, to: usize) -> f64 {
        let count = (to - from) as f64;
        let sum = |k: usize| self.values[to * self.width + k] - self.values[from * self.width + k];
        let of_mean: f64 = (0..self.width).map(|k| sum(k) * sum(k) / count).sum();
        (self.squares[to] - self.squares[from] - of_mean).max(0.0)
    }
}

/// The bounds of the cycles of a motion, s, from its start on: two at least.
///
/// # Errors
/// The reason why there are none.
pub(super) fn cycle_bounds(times: &[f64], angles: &[Vec<f64>]) -> Result<Vec<f64>, NoCycles> {
    let span = times.first().zip(times.last()).map_or(0.0, |(first, last)| last - first);
    if times.len() < 3 || span <= 0.0 || angles.is_empty() || angles.iter().any(|angle| angle.len() != times.len()) {
        return Err(NoCycles::TooShort);
    }
    let recorded = span / (times.len() - 1) as f64;
    let fine = (span / MOST_INSTANTS as f64).max(recorded).min(LONGEST_STEP.max(recorded));
    let coarse = (span / MOST_INSTANTS as f64).max(recorded);
    let of_beginning = period(times, angles, fine);
    let found = if of_beginning.is_err() && coarse > fine { period(times, angles, coarse) } else { of_beginning };
    Ok(bounds(times, angles, found?))
}

/// The length of a cycle in the first instants of a motion, s, by steps of `step`.
fn period(times: &[f64], angles: &[Vec<f64>], step: f64) -> Result<f64, NoCycles> {
    let span = times[times.len() - 1] - times[0];
    let count = ((span / step) as usize + 1).min(MOST_INSTANTS + 1);
    let grid = Grid::new(times, angles, (times[0], step, count));
    let sums = Sums::new(&grid);
    let whole = sums.spread(0, count) / count as f64;
    if whole < LEAST_MOVEMENT * LEAST_MOVEMENT {
        return Err(NoCycles::Still);
    }
    let d = |lag: usize| {
        let compared = count - lag;
        let spread = sums.spread(0, compared) + sums.spread(lag, count);
        let moves = spread >= 2.0 * LEAST_VARIANCE * whole * compared as f64;
        if moves { (0..compared).map(|k| grid.apart(k, lag + k)).sum::<f64>() / spread } else { f64::INFINITY }
    };
    let (mut apart, mut nearest) = (false, None);
    let (mut before, mut now) = (0.0, d(1));
    for lag in 1..(LONGEST_LAG * count as f64) as usize {
        let next = d(lag + 1);
        apart |= now > APART && now.is_finite();
        if apart && now < ALIKE && now <= next {
            return Ok(grid.step * (lag as f64 + lowest(before, now, next)));
        }
        if apart && now.is_finite() && nearest.is_none_or(|(_, least)| now < least) {
            nearest = Some((grid.step * lag as f64, now));
        }
        (before, now) = (now, next);
    }
    Err(NoCycles::NotBack(nearest))
}

/// The place of the least value of the parabola through three values at -1, 0 and 1; 0 where the middle one is not the least.
fn lowest(before: f64, now: f64, after: f64) -> f64 {
    let bend = before - 2.0 * now + after;
    if bend.is_finite() && bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

/// The start of each cycle and the end of the last one: where the angles are nearest to those of the first cycle.
fn bounds(times: &[f64], angles: &[Vec<f64>], period: f64) -> Vec<f64> {
    let (first, last) = (times[0], times[times.len() - 1]);
    let step = period / STEPS as f64;
    let count = ((last - first) / step) as usize + 1;
    let grid = Grid::new(times, angles, (first, step, count));
    let mut bounds = vec![first];
    let mut start = 0;
    loop {
        let far = |at: usize| grid.distance_to_first(at);
        let candidates = start + STEPS - MOST_SHIFT..=start + STEPS + MOST_SHIFT;
        // At the end of what can be compared the angles may come nearer still.
        let nearest = candidates.min_by(|a, b| far(*a).total_cmp(&far(*b)));
        let Some(at) = nearest.filter(|at| far(at + 1).is_finite()) else { break };
        bounds.push(grid.start + step * (at as f64 + lowest(far(at - 1), far(at), far(at + 1))));
        start = at;
    }
    // The last cycle may end with the motion, where nothing follows that tells its end.
    let mean = if bounds.len() > 1 { (bounds[bounds.len() - 1] - first) / (bounds.len() - 1) as f64 } else { period };
    let end = bounds[bounds.len() - 1] + mean;
    if end <= last + step {
        bounds.push(end.min(last));
    }
    bounds
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use std::f64::consts::TAU;

    use super::*;

    fn angles(times: &[f64], phase: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
        // Both legs, half a cycle apart, each with a second harmonic.
        let leg = |shift: f64| {
            let angle = |time: &f64| {
                let at = TAU * (phase(*time) + shift);
                0.5 * libm::sin(at) + 0.3 * libm::cos(2.0 * at)
            };
            times.iter().map(angle).collect()
        };
        vec![leg(0.0), leg(0.5)]
    }

    #[test]
    fn spread_is_that_of_the_rows_about_their_mean() {
        let grid = Grid { start: 0.0, step: 1.0, rows: (0..36).map(|i| f64::from(i * 7 % 11)).collect(), width: 3 };
        let sums = Sums::new(&grid);
        for (from, to) in [(0, 12), (3, 4), (2, 9), (7, 12)] {
            let of = |k: usize| (from..to).map(move |row| row * 3 + k).map(|i| grid.rows[i]);
            let mean = |k: usize| of(k).sum::<f64>() / (to - from) as f64;
            let expected: f64 = (0..3).map(|k| of(k).map(|x| (x - mean(k)).powi(2)).sum::<f64>()).sum();
            let found = sums.spread(from, to);
            assert!((found - expected).abs() < 1e-9, "{found} and {expected}, rows {from} to {to}");
        }
    }

    #[test]
    fn the_bounds_of_even_and_of_uneven_cycles_are_found() {
        for rate in [30.0, 60.0, 100.0] {
            let times: Vec<f64> = (0..=(8.0 * rate) as usize).map(|i| i as f64 / rate).collect();
            // Cycles that become longer: the phase is t / 1.1 - 0.006 t^2, the last one 13 percent longer than the first.
            let phase = |t: f64| t / 1.1 - 0.006 * t * t;
            let found = cycle_bounds(&times, &angles(&times, phase)).unwrap();
            let bound = |k: f64| (1.0 / 1.1 - (1.0 / 1.21 - 0.024 * k).sqrt()) / 0.012;
            assert_eq!(found.len(), 7, "{found:?}");
            for (k, found) in found.iter().enumerate() {
                assert!((found - bound(k as f64)).abs() < 0.025, "{rate}: bound {k} {found} {}", bound(k as f64));
            }
            let found = cycle_bounds(&times, &angles(&times, |t| t / 1.6)).unwrap();
            assert_eq!(found.len(), 6, "{found:?}");
            assert!(found.iter().enumerate().all(|(k, at)| (at - 1.6 * k as f64).abs() < 2e-3), "{found:?}");
        }
    }

    #[test]
    fn a_long_motion_is_searched_in_two_scales() {
        let times: Vec<f64> = (0..=20_000).map(|i| f64::from(i) * 0.05).collect();
        for length in [1.3, 140.0] {
            let found = cycle_bounds(&times, &angles(&times, |t| t / length)).unwrap();
            let mean = (found[found.len() - 1] - found[0]) / (found.len() - 1) as f64;
            assert!((mean / length - 1.0).abs() < 0.01, "{length}: {mean} {found:?}");
        }
    }

    #[test]
    fn a_motion_that_does_not_come_back_has_no_cycles() {
        let times: Vec<f64> = (0..=400).map(|i| f64::from(i) * 0.01).collect();
        let of = |angle: &dyn Fn(f64) -> f64| vec![times.iter().map(|time| angle(*time)).collect::<Vec<f64>>()];
        let not_back = |found: NoCycles| matches!(found, NoCycles::NotBack(_));
        for (what, angle) in [
            ("one lift, with rest before and after", of(&|t| libm::exp(-(t - 2.0) * (t - 2.0) / 0.1))),
            ("a slow rise", of(&|t| 0.5 * t)),
            ("growing frequency", of(&|t| libm::sin(3.0 * t * t))),
        ] {
            assert!(cycle_bounds(&times, &angle).is_err_and(not_back), "{what}");
        }
        for (what, angle) in
            [("nothing moves", of(&|_| 0.3)), ("less than a degree", of(&|t| 0.01 * libm::sin(6.0 * t)))]
        {
            assert_eq!(cycle_bounds(&times, &angle), Err(NoCycles::Still), "{what}");
        }
        assert_eq!(cycle_bounds(&[], &[]), Err(NoCycles::TooShort));
        assert_eq!(cycle_bounds(&[0.0, 1.0], &[vec![0.0, 1.0]]), Err(NoCycles::TooShort));
    }
}
