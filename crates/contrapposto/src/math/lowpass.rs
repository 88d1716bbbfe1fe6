//! Computes zero-phase low-pass filters of sampled signals: Butterworth filters, run forward and backward.
//!
//! The filter of order `n` comes from the analogue one by the bilinear transform with the cut-off prewarped, `w = tan(pi f_c / f_s)`
//! (Oppenheim & Schafer, "Discrete-Time Signal Processing"; recalled). It is a product of sections in the delay `z`:
//!
//! ```text
//! (odd n)   w (1 + z) / ((1 + w) + (w - 1) z)
//! k-th      w^2 (1 + z)^2 / ((1 + p w + w^2) + 2 (w^2 - 1) z + (1 - p w + w^2) z^2),   p = 2 sin((2 k + 1) pi / 2n)
//! ```
//!
//! The gain at the cut-off is 1/sqrt(2) in one direction, so 1/2 in both. The two ways to begin differ at the ends of the signal only.

use std::f64::consts::PI;

/// A digital Butterworth filter, lowest power of the delay first; the first entry of the denominator is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowpass {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl Lowpass {
    /// The filter of an order of at least 1, for a cut-off above 0 and below half of the sampling frequency, both in Hz.
    pub fn new(order: usize, cutoff: f64, sampling: f64) -> Self {
        let w = libm::tan(PI * cutoff / sampling);
        let (mut numerator, mut denominator) = (vec![1.0], vec![1.0]);
        let mut section = |above: &[f64], below: &[f64]| {
            let scaled = |part: &[f64]| part.iter().map(|c| c / below[0]).collect::<Vec<_>>();
            numerator = product(&numerator, &scaled(above));
            denominator = product(&denominator, &scaled(below));
        };
        if order % 2 == 1 {
            section(&[w, w], &[1.0 + w, w - 1.0]);
        }
        for k in 0..order / 2 {
            let p = 2.0 * libm::sin((2 * k + 1) as f64 * PI / (2 * order) as f64);
            let square = w * w;
            let below = [1.0 + p * w + square, 2.0 * (square - 1.0), 1.0 - p * w + square];
            section(&[square, 2.0 * square, square], &below);
        }
        Self { numerator, denominator }
    }

    /// Forward and backward as OpenSim's `Signal::LowpassIIR` runs: the first samples of either run, as many as the order, stay as they
    /// are. The signal should be padded.
    #[must_use]
    pub fn as_opensim(&self, signal: &[f64]) -> Vec<f64> {
        let once = |signal: &[f64]| {
            let order = self.denominator.len() - 1;
            let mut filtered = signal.to_vec();
            for i in order..signal.len() {
                let past = |k: usize, from: &[f64]| from[i - k];
                let fed: f64 = self.numerator.iter().enumerate().map(|(k, b)| b * past(k, signal)).sum();
                let back: f64 = self.denominator.iter().enumerate().skip(1).map(|(k, a)| a * past(k, &filtered)).sum();
                filtered[i] = fed - back;
            }
            filtered.reverse();
            filtered
        };
        once(&once(signal))
    }

    /// Forward and backward as scipy's `filtfilt` runs by default: the signal is padded by point reflection with three times as many
    /// samples as the filter has coefficients, and either run begins in the steady state of its first sample. A signal that is too
    /// short is padded with all it has.
    #[must_use]
    pub fn filtfilt(&self, signal: &[f64]) -> Vec<f64> {
        if signal.len() < 2 {
            return signal.to_vec();
        }
        let pad = (3 * self.denominator.len()).min(signal.len() - 1);
        let mut padded = reflected(signal, pad);
        for _ in 0..2 {
            self.run_from_steady_state(&mut padded);
            padded.reverse();
        }
        padded[pad..pad + signal.len()].to_vec()
    }

    fn run_from_steady_state(&self, signal: &mut [f64]) {
        let order = self.denominator.len() - 1;
        let (b, a) = (&self.numerator, &self.denominator);
        // Transposed direct form; the state that a constant signal of 1 leaves as it is.
        let mut state = vec![0.0; order + 1];
        for k in (0..order).rev() {
            state[k] = state[k + 1] + b[k + 1] - a[k + 1];
        }
        let first = signal[0];
        state.iter_mut().for_each(|state| *state *= first);
        for value in signal {
            let given = *value;
            *value = b[0] * given + state[0];
            for k in 0..order {
                state[k] = state[k + 1] + b[k + 1] * given - a[k + 1] * *value;
            }
        }
    }
}

/// A signal with `pad` samples more at either end, reflected in the point of the end: `2 s_0 - s_k`. `pad` is less than its length.
#[must_use]
pub fn reflected(signal: &[f64], pad: usize) -> Vec<f64> {
    let last = signal.len() - 1;
    let before = (1..=pad).rev().map(|k| 2.0 * signal[0] - signal[k]);
    let after = (1..=pad).map(|k| 2.0 * signal[last] - signal[last - k]);
    before.chain(signal.iter().copied()).chain(after).collect()
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (k, y) in b.iter().enumerate() {
            sum[i + k] += x * y;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_passes_and_a_sine_at_the_cutoff_is_halved_without_a_shift() {
        for order in 1..=5 {
            let filter = Lowpass::new(order, 6.0, 100.0);
            assert!(filter.filtfilt(&[3.5; 60]).iter().all(|value| (value - 3.5).abs() < 1e-10));
            let sine: Vec<f64> = (0..2000).map(|i| libm::sin(2.0 * PI * 6.0 * f64::from(i) / 100.0 + 0.4)).collect();
            for filtered in [filter.filtfilt(&sine), filter.as_opensim(&sine)] {
                let off = |i: usize| (filtered[i] - 0.5 * sine[i]).abs();
                assert!((800..1200).all(|i| off(i) < 1e-6), "order {order}");
            }
        }
    }

    #[test]
    fn a_signal_reflected_in_its_ends_goes_on_through_their_points() {
        assert_eq!(reflected(&[1.0, 2.0, 4.0], 2), [-2.0, 0.0, 1.0, 2.0, 4.0, 6.0, 7.0]);
    }

    /// `scipy.signal.filtfilt(*butter(n, 0.24), x)` of scipy 1.17.1 with x_i = sin(i/2) + (i mod 3)/5, i = 0..25; scripts/filter_reference.py.
    #[test]
    fn filtfilt_of_a_known_signal_is_scipys() {
        let signal: Vec<f64> = (0..25).map(|i| libm::sin(0.5 * f64::from(i)) + f64::from(i % 3) / 5.0).collect();
        for (order, expected) in SCIPY {
            let filtered = Lowpass::new(order, 12.0, 100.0).filtfilt(&signal);
            filtered
                .iter()
                .zip(expected)
                .for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "order {order}: {a} and {b}"));
        }
    }

    const SCIPY: [(usize, [f64; 25]); 3] = [
        (
            2,
            [
                0.0016691168910109438,
                0.5149683775047817,
                0.8945758733232784,
                1.0595023832120714,
                0.9927969421694388,
                0.7246841470792269,
                0.3273306800033899,
                -0.09644057135001069,
                -0.4446696151085576,
                -0.6347701641603812,
                -0.6182656752925291,
                -0.4013854344403005,
                -0.03911344236846635,
                0.3826274465878051,
                0.7589658545988508,
                0.996414287684946,
                1.0406273593267878,
                0.8811561964775478,
                0.5586531988272062,
                0.15851135758174908,
                -0.222026996892859,
                -0.4989763488748856,
                -0.6254704222075836,
                -0.6175972255566704,
                -0.5386582166925502,
            ],
        ),
        (
            3,
            [
                -0.0036805542773662853,
                0.5454141926033531,
                0.9611189912197542,
                1.148812947010779,
                1.0773958288760208,
                0.7798612241674465,
                0.34008730405272625,
                -0.1290319070241273,
                -0.5123231193670528,
                -0.7178650382003446,
                -0.6972699683409171,
                -0.4570886286144253,
                -0.057010368900620216,
                0.40452256841835355,
                0.8136587759284168,
                1.0695549908380324,
                1.1102386398037425,
                0.9284005588041098,
                0.5736832383961209,
                0.13899288804290777,
                -0.2672773323515888,
                -0.5542826958117264,
                -0.6770113971636412,
                -0.6495794521266315,
                -0.5365463257141458,
            ],
        ),
        (
            4,
            [
                -0.0019504144520468402,
                0.5651373499460844,
                0.9958034810000781,
                1.1919090971426576,
                1.1180231650874741,
                0.8065134515495475,
                0.34520310677475535,
                -0.14664350282197938,
                -0.5473425167595457,
                -0.7605508096621861,
                -0.7365494056007328,
                -0.4830512005429118,
                -0.06313730096546716,
                0.41960255864133705,
                0.8458970310553322,
                1.1102814383092177,
                1.148100516385277,
                0.9527109119043434,
                0.5774862277968128,
                0.12082415458931822,
                -0.30267950532396626,
                -0.5967653491976617,
                -0.7129156981951141,
                -0.6646890594985413,
                -0.5219177296703674,
            ],
        ),
    ];
}
