//! Computes smoothed values of samples with their first and second derivative, by a low-pass filter and quintic splines.
//!
//! As OpenSim's `InverseDynamicsTool` makes them (Delp et al. 2007; the rule read from opensim-core's sources): the samples are
//! padded by half of their number at either end, reflected in the end point; where the steps of time differ, they are interpolated at the
//! shortest step; a Butterworth filter of order 3 runs forward and backward; and a natural quintic spline through the filtered samples gives
//! value, speed and acceleration. Without a cut-off the spline passes through the samples themselves.

use super::error::MotionError;
use crate::math::{LEAST_POINTS, Lowpass, QuinticBasis, reflected};

/// Cut-off that OpenSim's published inverse dynamics of walking name (gait2392, gait10dof18musc), Hz.
pub const PUBLISHED_CUTOFF: f64 = 6.0;
/// Order of OpenSim's filter.
const OPENSIM_ORDER: usize = 3;
/// Order of the filter that runs forward and backward as `filtfilt`: fourth order in all, the habit of gait analysis (Winter 2009,
/// "Biomechanics and Motor Control of Human Movement", section 3.4.4; recalled).
const FILTFILT_ORDER: usize = 2;
/// Differences of the steps of time that count as rounding, as a share of a step.
const EVEN_STEPS: f64 = 1e-9;
/// Most samples at the shortest step for each sample given: a shorter step is a fault of the times (assumed).
const MOST_RESAMPLED: f64 = 20.0;

/// The filter of a motion, before its splines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// No filter.
    None,
    /// OpenSim's, with a cut-off in Hz.
    OpenSim(f64),
    /// Second order forward and backward as scipy's `filtfilt`, with a cut-off in Hz.
    Filtfilt(f64),
}

/// The common part of all columns that are sampled at the same times.
pub(super) struct Sampling {
    times: Vec<f64>,
    filter: Option<Filter>,
    /// Splines with knots at the times of the filtered samples.
    basis: QuinticBasis,
}

struct Filter {
    lowpass: Lowpass,
    smoothing: Smoothing,
    pad: usize,
    /// Splines through the padded samples, and the even times to take from them; none where the steps are even.
    resampled: Option<(QuinticBasis, Vec<f64>)>,
}

impl Sampling {
    pub(super) fn new(times: Vec<f64>, smoothing: Smoothing) -> Result<Self, MotionError> {
        if times.len() < LEAST_POINTS {
            return Err(MotionError::TooFew { found: times.len(), needed: LEAST_POINTS });
        }
        if let Some(index) = (1..times.len()).find(|&i| !(times[i] > times[i - 1] && times[i].is_finite())) {
            return Err(MotionError::Order { index, time: times[index] });
        }
        let (cutoff, order, pad) = match smoothing {
            Smoothing::None => {
                return Ok(Self { basis: QuinticBasis::new(times.clone())?, times, filter: None });
            }
            Smoothing::OpenSim(cutoff) => (cutoff, OPENSIM_ORDER, times.len() / 2),
            Smoothing::Filtfilt(cutoff) => (cutoff, FILTFILT_ORDER, 0),
        };
        let padded = reflected(&times, pad);
        let (first, span) = (padded[0], padded[padded.len() - 1] - padded[0]);
        let average = span / (padded.len() - 1) as f64;
        let step = padded.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let even = average - step <= EVEN_STEPS * average;
        let step = if even { average } else { step };
        if average > MOST_RESAMPLED * step {
            return Err(MotionError::Uneven { shortest: step, average });
        }
        if !(cutoff > 0.0 && cutoff < 0.5 / step) {
            return Err(MotionError::Cutoff { cutoff, sampling: 1.0 / step });
        }
        let (resampled, knots) = if even {
            (None, padded)
        } else {
            let count = (span / step + EVEN_STEPS).floor() as usize;
            let grid: Vec<f64> = (0..=count).map(|i| first + step * i as f64).collect();
            (Some((QuinticBasis::new(padded)?, grid.clone())), grid)
        };
        let filter = Filter { lowpass: Lowpass::new(order, cutoff, 1.0 / step), smoothing, pad, resampled };
        Ok(Self { times, filter: Some(filter), basis: QuinticBasis::new(knots)? })
    }

    /// Value, speed and acceleration at every time.
    pub(super) fn derivatives(&self, values: &[f64]) -> Vec<[f64; 3]> {
        if values.windows(2).all(|pair| pair[0] == pair[1]) {
            return values.iter().map(|value| [*value, 0.0, 0.0]).collect();
        }
        let Some(filter) = &self.filter else { return self.basis.through(values).knots().to_vec() };
        let mut samples = reflected(values, filter.pad);
        if let Some((basis, grid)) = &filter.resampled {
            let spline = basis.through(&samples);
            samples = grid.iter().map(|&time| spline.at(time)[0]).collect();
        }
        let samples = match filter.smoothing {
            Smoothing::Filtfilt(_) => filter.lowpass.filtfilt(&samples),
            _ => filter.lowpass.as_opensim(&samples),
        };
        let spline = self.basis.through(&samples);
        self.times.iter().map(|&time| spline.at(time)).collect()
    }
}
