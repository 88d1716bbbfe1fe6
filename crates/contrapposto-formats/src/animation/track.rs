//! Holds the course of a few numbers over time, without keys where nothing changes.

/// Coarser than rounding of the kinematics, finer than `f32` in a body's size: a number that stands still then has one value only.
const GRAIN: f64 = 1e-9;

/// A component this near to its rest is there: rounding of `f32` in a body's size.
const AT_REST: f32 = 5e-7;

/// Values of one node.
#[derive(Clone, Debug)]
pub(super) struct Track<const N: usize> {
    /// Index of the posture, and the value there. Between two equal neighbours nothing happens.
    keys: Vec<(usize, [f32; N])>,
}

impl<const N: usize> Track<N> {
    pub(super) fn new() -> Self {
        Self { keys: vec![] }
    }

    /// Takes in the next value.
    pub(super) fn push(&mut self, index: usize, value: [f64; N]) {
        let value = value.map(|v| grained(v) as f32);
        if let [.., (_, one), (at, other)] = self.keys.as_mut_slice()
            && *one == value
            && *other == value
        {
            *at = index;
        } else {
            self.keys.push((index, value));
        }
    }

    /// As [`Track::push`] with the sign that lies nearer to the last value: of a quaternion both are the same turn.
    pub(super) fn push_nearer(&mut self, index: usize, value: [f64; N]) {
        let along = match self.keys.last() {
            Some((_, last)) => last.iter().zip(value).map(|(a, b)| f64::from(*a) * b).sum(),
            None => value[N - 1],
        };
        self.push(index, if along < 0.0 { value.map(|v| -v) } else { value });
    }

    /// The first value.
    pub(super) fn first(&self) -> Option<[f32; N]> {
        self.keys.first().map(|key| key.1)
    }

    /// Indices and values, unless it is the same all the time.
    pub(super) fn moving(&self) -> Option<(Vec<usize>, Vec<f32>)> {
        let moves = self.keys.windows(2).any(|pair| pair[0].1 != pair[1].1);
        moves.then(|| self.all())
    }

    /// Indices and values, unless it is at rest all the time, to the grain.
    pub(super) fn off(&self, rest: [f32; N]) -> Option<(Vec<usize>, Vec<f32>)> {
        let is_off = |value: &[f32; N]| value.iter().zip(rest).any(|(v, rest)| (v - rest).abs() > AT_REST);
        self.keys.iter().any(|key| is_off(&key.1)).then(|| self.all())
    }

    fn all(&self) -> (Vec<usize>, Vec<f32>) {
        (self.keys.iter().map(|key| key.0).collect(), self.keys.iter().flat_map(|key| key.1).collect())
    }
}

/// To the grain, where `f32` is finer than that; never -0.
fn grained(v: f64) -> f64 {
    if v.abs() < 1.0 { (v / GRAIN).round() * GRAIN + 0.0 } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_moves_keeps_keys() {
        let mut track = Track::<1>::new();
        for (i, value) in [1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0].into_iter().enumerate() {
            track.push(i, [value]);
        }
        assert_eq!(track.moving(), Some((vec![0, 3, 4, 5, 7], vec![1.0, 1.0, 2.0, 3.0, 3.0])));
        let mut still = Track::<2>::new();
        (0..5).for_each(|i| still.push(i, [0.5, 1e-17 * i as f64]));
        assert_eq!((still.moving(), still.first()), (None, Some([0.5, 0.0])));
        let mut turning = Track::<4>::new();
        turning.push_nearer(0, [0.0, 0.0, 0.0, -1.0]);
        turning.push_nearer(1, [0.0, 0.0, -0.6, -0.8]);
        assert_eq!(turning.moving(), Some((vec![0, 1], vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.8])));
    }
}
