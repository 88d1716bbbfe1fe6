//! Computes the curves of MuJoCo's muscles (`mju_muscleGain`, `mju_muscleBias`, read for the facts) at zero velocity: an active curve of four
//! parabolas, and a passive one that is a parabola up to half way to the greatest active length and straight beyond. The tendon is rigid.

use super::curves::{Curves, MuscleError};

/// The parameters of one muscle's curves; lengths over optimal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MujocoMuscle {
    /// Length below which there is no active force (`lmin`).
    pub least: f64,
    /// Length above which there is no active force (`lmax`).
    pub greatest: f64,
    /// Twice the passive force half way between optimal length and `greatest`, over the greatest isometric force (`fpmax`).
    pub passive_force: f64,
}

impl MujocoMuscle {
    /// Itself, if its numbers have a meaning.
    pub(super) fn checked(&self) -> Result<Self, MuscleError> {
        let refuse = |what, value, accepted| Err(MuscleError { what, value, accepted });
        match *self {
            Self { least, .. } if !(0.0..1.0).contains(&least) => {
                refuse("lmin", least, "0 up to, but not including, 1")
            }
            Self { greatest, .. } if !(greatest > 1.0 && greatest <= crate::model::LARGEST) => {
                refuse("lmax", greatest, "above 1 and at most 1e9")
            }
            Self { passive_force, .. } if !(0.0..=crate::model::LARGEST).contains(&passive_force) => {
                refuse("fpmax", passive_force, "0 to 1e9")
            }
            itself => Ok(itself),
        }
    }
}

impl Curves for MujocoMuscle {
    fn active(&self, length: f64) -> (f64, f64) {
        let (least, greatest) = (self.least, self.greatest);
        if !(least..=greatest).contains(&length) {
            return (0.0, 0.0);
        }
        let (left, right) = (0.5 * (least + 1.0), 0.5 * (1.0 + greatest));
        // From a foot, force 0, or from the top, force 1; the parabolas meet half way between.
        let (from, wide, top) = match length {
            l if l <= left => (least, left - least, false),
            l if l <= 1.0 => (1.0, left - 1.0, true),
            l if l <= right => (1.0, right - 1.0, true),
            _ => (greatest, right - greatest, false),
        };
        let x = (length - from) / wide;
        if top { (1.0 - 0.5 * x * x, -x / wide) } else { (0.5 * x * x, x / wide) }
    }

    fn passive(&self, length: f64) -> (f64, f64) {
        let wide = 0.5 * (1.0 + self.greatest) - 1.0;
        let x = (length - 1.0) / wide;
        let (force, slope) = match x {
            x if x <= 0.0 => (0.0, 0.0),
            x if x <= 1.0 => (0.5 * x * x, x),
            _ => (x - 0.5, 1.0),
        };
        (self.passive_force * force, self.passive_force * slope / wide)
    }

    fn tendon(&self, _: f64) -> (f64, f64) {
        (0.0, 0.0)
    }
}
