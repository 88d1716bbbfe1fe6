//! Computes the tension of ligaments and springs along a path from its length.

use crate::math::Function;

/// A ligament or spring that pulls along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Ligament {
    /// Name of the ligament.
    pub name: String,
    /// Index of its path in [`super::Paths::paths`].
    pub path: usize,
    /// Tension of the ligament as a function of the path's length.
    pub law: LigamentLaw,
}

/// Tension as a function of length; none below the slack length.
#[derive(Clone, Debug, PartialEq)]
pub enum LigamentLaw {
    /// OpenSim's `Ligament`: a force times a curve of length over slack length.
    Curve {
        /// Slack length, m.
        slack_length: f64,
        /// The force, N.
        force: f64,
        /// The curve.
        curve: Function,
    },
    /// Blankevoort & Huiskes 1991 in the form of OpenSim's `Blankevoort1991Ligament`: `k e^2 / (2 t)` of the strain e up to the transition
    /// strain t, `k (e - t / 2)` beyond.
    Blankevoort1991 {
        /// Slack length, m.
        slack_length: f64,
        /// k, N.
        stiffness: f64,
        /// t.
        transition_strain: f64,
    },
    /// OpenSim's `PathSpring`: in proportion to the stretch.
    Spring {
        /// Slack length, m.
        slack_length: f64,
        /// Stiffness, N/m.
        stiffness: f64,
    },
}

impl LigamentLaw {
    /// Tension, N, and its derivative by the length, N/m.
    pub fn tension_and_slope(&self, length: f64) -> (f64, f64) {
        match self {
            Self::Curve { slack_length, .. }
            | Self::Blankevoort1991 { slack_length, .. }
            | Self::Spring { slack_length, .. }
                if length <= *slack_length =>
            {
                (0.0, 0.0)
            }
            Self::Curve { slack_length, force, curve } => {
                let [value, slope, _] = curve.value_slope_curvature(length / slack_length);
                (force * value, force * slope / slack_length)
            }
            Self::Blankevoort1991 { slack_length, stiffness, transition_strain } => {
                let strain = length / slack_length - 1.0;
                let slope = stiffness / slack_length;
                if strain < *transition_strain {
                    let share = strain / transition_strain;
                    (0.5 * stiffness * strain * share, slope * share)
                } else {
                    (stiffness * (strain - 0.5 * transition_strain), slope)
                }
            }
            Self::Spring { slack_length, stiffness } => (stiffness * (length - slack_length), *stiffness),
        }
    }
}
