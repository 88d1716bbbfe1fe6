//! Integrates fatigue from published endurance curves, which give the time a constant load can be held.
//!
//! Published endurance curves give the time `T(f)` to exhaustion at relative load `f`; fatigue grows by `dt / T(f)` and is
//! exhausted at 1. The integral knows no recovery, so a named one is added: at rest fatigue falls as `exp(-k t)`.

use super::REST_LOAD;
use super::linear_step::LinearStep;

/// The published shapes, times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EnduranceForm {
    /// `T = b0 f^b1` (Frey-Law & Avin 2010 and others).
    Power {
        /// Time at full load, s.
        b0: f64,
        /// Exponent, negative.
        b1: f64,
    },
    /// `T = a exp(-k f)` (Manenica 1986 and others).
    Exponential {
        /// Time at no load, s.
        a: f64,
        /// Decay.
        k: f64,
    },
    /// `T = a (f - f0)^p`, for ever up to `f0` (Monod & Scherrer; Sato).
    ShiftedPower {
        /// Scale, s.
        a: f64,
        /// Load that can be held for ever.
        f0: f64,
        /// Exponent, negative.
        p: f64,
    },
    /// `T = c0 + c1/f + c2/f^2 + c3/f^3` (Rohmert 1960).
    InversePolynomial {
        /// The four coefficients, s.
        c: [f64; 4],
    },
    /// `T = a ((1 - f)/(f - f0))^p`, for ever up to `f0` (Huijgens 1981).
    Huijgens {
        /// Scale, s.
        a: f64,
        /// Load that can be held for ever.
        f0: f64,
        /// Exponent.
        p: f64,
    },
    /// `T = a / (100 f - 15)^p - c`, for ever up to 0.15 (consumed endurance).
    ConsumedEndurance {
        /// Scale, s.
        a: f64,
        /// Exponent.
        p: f64,
        /// Offset, s.
        c: f64,
    },
    /// `T = -60 m ln(f) / f` (Ma et al. 2009).
    Ma {
        /// Factor, min.
        m: f64,
    },
}

/// A named endurance curve.
#[derive(Clone, Debug, PartialEq)]
pub struct EnduranceCurve {
    /// Name in the data files, e.g. `freylaw_avin_2010_elbow`.
    pub name: String,
    /// Shape of the curve.
    pub form: EnduranceForm,
}

/// Endurance-time integral with a recovery law of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Endurance {
    /// The curve.
    pub curve: EnduranceCurve,
    /// Recovery rate at rest, 1/s.
    pub recovery_rate: f64,
}

impl EnduranceCurve {
    /// Endurance time at relative load `load`, s: infinite where the curve ends (or at rest), never negative. A load above
    /// strength counts as 1, the end of every published curve.
    pub(crate) fn time(&self, load: f64) -> f64 {
        if load <= 0.0 {
            return f64::INFINITY;
        }
        let f = load.min(1.0);
        let seconds = match self.form {
            EnduranceForm::Power { b0, b1 } => b0 * libm::pow(f, b1),
            EnduranceForm::Exponential { a, k } => a * libm::exp(-k * f),
            EnduranceForm::ShiftedPower { f0, .. } | EnduranceForm::Huijgens { f0, .. } if f <= f0 => f64::INFINITY,
            EnduranceForm::ShiftedPower { a, f0, p } => a * libm::pow(f - f0, p),
            EnduranceForm::Huijgens { a, f0, p } => a * libm::pow((1.0 - f) / (f - f0), p),
            EnduranceForm::InversePolynomial { c } => c[0] + (c[1] + (c[2] + c[3] / f) / f) / f,
            EnduranceForm::ConsumedEndurance { .. } if f <= 0.15 => f64::INFINITY,
            EnduranceForm::ConsumedEndurance { a, p, c } => a / libm::pow(100.0 * f - 15.0, p) - c,
            EnduranceForm::Ma { m } => -60.0 * m * libm::log(f) / f,
        };
        seconds.max(0.0)
    }
}

/// Bisections to the load that is held for a time: to the last bits.
const LOAD_HALVINGS: usize = 60;

impl EnduranceCurve {
    /// The load (0..=1) whose endurance time is `seconds`, by bisection; 1 where full load lasts as long.
    pub(crate) fn load_held_for(&self, seconds: f64) -> f64 {
        if self.time(1.0) >= seconds {
            return 1.0;
        }
        let (mut held, mut failed) = (0.0, 1.0);
        for _ in 0..LOAD_HALVINGS {
            let middle = f64::midpoint(held, failed);
            if self.time(middle) >= seconds { held = middle } else { failed = middle }
        }
        held
    }
}

impl Endurance {
    /// Fatigue after `seconds` under relative load `load`.
    pub(crate) fn advance(&self, share: f64, load: f64, seconds: f64) -> f64 {
        if load <= REST_LOAD {
            return share * libm::exp(-self.recovery_rate * seconds);
        }
        let time = self.curve.time(load);
        if time > 0.0 { (share + seconds / time).min(1.0) } else { 1.0 }
    }
    /// The same as a step, of a group that does not fail.
    pub(super) fn linear_step(&self, load: f64, seconds: f64) -> LinearStep {
        if load <= REST_LOAD {
            return LinearStep::of_share(libm::exp(-self.recovery_rate * seconds), 0.0);
        }
        let time = self.curve.time(load);
        if time > 0.0 { LinearStep::of_share(1.0, seconds / time) } else { LinearStep::of_share(0.0, 1.0) }
    }
}
