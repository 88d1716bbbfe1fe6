//! Suggests a cut-off for the low-pass filter of a motion by residual analysis (Winter 2009, "Biomechanics and Motor Control of Human Movement",
//! section 3.4.4.3; recalled).
//!
//! The residual of a cut-off is the root mean square of the filtered signal less the recorded one. White noise leaves a residual that falls in a straight line from low
//! cut-offs to half of the frame rate; what lies above this line at low cut-offs is signal. The line through the residuals of high cut-offs, continued to a
//! cut-off of 0, gives the noise in all; the suggested cut-off is the one with that residual, so that as much signal is lost as noise passes.

use super::error::MotionError;
use super::sampling::{Sampling, Smoothing};
use crate::model::{CoordinateKind, Model};
use crate::posture::Posture;

/// Least and greatest cut-off that is suggested, Hz: that of slow posture, and that of impacts (assumed).
const SUGGESTED: (f64, f64) = (2.0, 20.0);
/// Step of cut-offs, Hz.
const CUTOFF_STEP: f64 = 0.5;
/// The line is fitted to cut-offs from this share of half of the frame rate to `LAST` of it (assumed: human motion has little above a quarter of 100 Hz).
const FIRST: f64 = 0.5;
const LAST: f64 = 0.9;
/// A coordinate that moves by less, rad or m, says nothing.
const STILL: f64 = 1e-3;

/// The cut-off in Hz that residual analysis suggests for a motion: the middle one of those of all rotations that move. `smoothing` gives a filter for a cut-off.
///
/// # Errors
/// [`MotionError`] where the motion cannot be filtered, or nothing moves.
pub fn suggested_cutoff(
    model: &Model,
    motion: &[(f64, Posture)],
    smoothing: impl Fn(f64) -> Smoothing,
) -> Result<f64, MotionError> {
    let times: Vec<f64> = motion.iter().map(|(time, _)| *time).collect();
    // Refuses times that no spline takes.
    Sampling::new(times.clone(), Smoothing::None)?;
    let span = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
    let half_rate = 0.5 * (times.len() - 1) as f64 / span;
    let last = LAST * half_rate;
    let count = (last / CUTOFF_STEP).floor() as usize;
    let cutoffs: Vec<f64> = (2..=count).map(|k| CUTOFF_STEP * k as f64).collect();
    let filters = cutoffs.iter().map(|cutoff| Sampling::new(times.clone(), smoothing(*cutoff)));
    let filters: Vec<Sampling> = filters.collect::<Result<_, _>>()?;
    let mut suggested = vec![];
    for (index, coordinate) in model.coordinates().iter().enumerate() {
        if coordinate.kind != CoordinateKind::Rotation || model.is_dependent(index) {
            continue;
        }
        let values: Vec<f64> = motion.iter().map(|(_, posture)| posture.values()[index]).collect();
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        if high - low > STILL {
            let residual = |filter: &Sampling| root_mean_square(&values, &filter.derivatives(&values));
            let residuals: Vec<f64> = filters.iter().map(residual).collect();
            suggested.extend(of_residuals(&cutoffs, &residuals, FIRST * half_rate));
        }
    }
    suggested.sort_by(f64::total_cmp);
    let middle = suggested.get(suggested.len() / 2).ok_or(MotionError::NoCutoff)?;
    Ok(middle.clamp(SUGGESTED.0, SUGGESTED.1.min(last)))
}

fn root_mean_square(values: &[f64], filtered: &[[f64; 3]]) -> f64 {
    let squares = values.iter().zip(filtered).map(|(value, filtered)| (value - filtered[0]).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

/// The cut-off whose residual is the intercept of the line through those from the cut-off `from` on; `None` of fewer than three.
fn of_residuals(cutoffs: &[f64], residuals: &[f64], from: f64) -> Option<f64> {
    let line: Vec<(f64, f64)> =
        cutoffs.iter().copied().zip(residuals.iter().copied()).filter(|(cutoff, _)| *cutoff >= from).collect();
    if line.len() < 3 {
        return None;
    }
    let n = line.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| line.iter().map(part).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let slope =
        line.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / line.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    let intercept = y - slope * x;
    let after = residuals.iter().position(|residual| *residual <= intercept)?;
    let Some(before) = after.checked_sub(1) else { return Some(cutoffs[0]) };
    let share = (residuals[before] - intercept) / (residuals[before] - residuals[after]);
    Some(cutoffs[before] + share * (cutoffs[after] - cutoffs[before]))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::{Smoothing, of_residuals, suggested_cutoff};
    use crate::dynamics::MotionError;
    use crate::model::{Adult, adult};
    use crate::posture::Posture;

    #[test]
    fn a_line_of_noise_below_a_signal_gives_the_cutoff_of_its_intercept() {
        // Noise 1 - f / 50, and a signal that ends at 5 Hz.
        let cutoffs: Vec<f64> = (2..=90).map(|k| 0.5 * f64::from(k)).collect();
        let residuals: Vec<f64> = cutoffs.iter().map(|f| 1.0 - f / 50.0 + 2.0 * (5.0 - f).max(0.0)).collect();
        // 1 - f / 50 + 2 (5 - f) = 1 where f = 10 / 2.02; between 4.5 and 5 the residuals are a straight line.
        let found = of_residuals(&cutoffs, &residuals, 25.0).unwrap();
        assert!((found - 10.0 / 2.02).abs() < 1e-9, "{found}");
        assert_eq!(of_residuals(&cutoffs, &residuals, 44.3), None);
    }

    /// A swing at 1 Hz with noise of half a degree: the suggestion lies between the swing and the noise, and more noise lowers it.
    #[test]
    fn more_noise_lowers_the_cutoff() {
        let model = adult(&Adult::default()).unwrap();
        let elbow = model.coordinate("elbow_flex_r").unwrap();
        let suggestion = |noise: f64| {
            let mut rng = Pcg64::seed_from_u64(9);
            let motion: Vec<(f64, Posture)> = (0..400)
                .map(|i| {
                    let time = f64::from(i) / 100.0;
                    let mut posture = model.default_posture();
                    let swing: f64 = (1..=4)
                        .map(|k| 0.6 / f64::from(k).powi(3) * libm::sin(std::f64::consts::TAU * f64::from(k) * time))
                        .sum();
                    posture.values_mut()[elbow] = 1.0 + swing + noise * rng.random_range(-1.0..1.0);
                    (time, posture)
                })
                .collect();
            suggested_cutoff(&model, &motion, Smoothing::OpenSim).unwrap()
        };
        let [little, more, much] = [1e-4, 5e-3, 5e-2].map(suggestion);
        assert!(little > more && more > much, "{little} {more} {much}");
        assert!((2.0..=12.0).contains(&more), "{more}");
        let still: Vec<(f64, Posture)> = (0..100).map(|i| (f64::from(i) / 100.0, model.default_posture())).collect();
        assert_eq!(suggested_cutoff(&model, &still, Smoothing::OpenSim), Err(MotionError::NoCutoff));
    }
}
