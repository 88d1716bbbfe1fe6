//! Computes the torque that the two-joint muscles and ligaments of the leg give at hip, knee and ankle together.
//!
//! Riener & Edrich 1999 (J. Biomech. 32:539-544), ten healthy adults, relaxed muscles included:
//! `tau = sum_i sign_i exp(c0_i + c_hip,i hip + c_knee,i knee + c_ankle,i ankle) + constant`, hip and knee flexion and ankle
//! plantarflexion positive. The coefficients live in the data files. With the neighbours held it is a sum of falling
//! exponentials in the joint's own angle; it has no energy, because the cross derivatives of the published laws differ.

use super::{Exponentials, PassiveError, PassiveParameter};

/// One term `sign * exp(c0 + rates . (hip, knee, ankle))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledTerm {
    /// +1 or -1, N m.
    pub sign: f64,
    /// Exponent at zero angles.
    pub c0: f64,
    /// Growth with hip, knee and ankle angle, 1/rad.
    pub rates: [f64; 3],
}

/// Passive torque of one leg joint as a function of hip, knee and ankle angle.
///
/// ```
/// use contrapposto::passive::{CoupledTerm, Form, PassiveCurve, RienerEdrich1999};
/// // The ankle: exp(2.1016 - 0.0843 A - 0.0176 K) - exp(-7.9763 + 0.1949 A + 0.0008 K) - 1.792, in degrees.
/// let term = |sign, c0, knee: f64, ankle: f64| CoupledTerm { sign, c0, rates: [0.0, knee.to_degrees(), ankle.to_degrees()] };
/// let ankle = RienerEdrich1999 {
///     joint: 2,
///     terms: vec![term(1.0, 2.1016, -0.0176, -0.0843), term(-1.0, -7.9763, 0.0008, 0.1949)],
///     constant: -1.792,
/// };
/// let (torque, gradient) = ankle.torque_and_gradient([0.0; 3]);
/// assert!((torque - 6.39).abs() < 0.005 && gradient[0] == 0.0 && gradient[1] < 0.0 && gradient[2] < 0.0);
/// let straight_knee = Form::Exponentials(ankle.held([0.0; 3], false)?);
/// let curve = PassiveCurve::new(straight_knee, (-0.5, 0.9), None)?;
/// assert!((curve.torque(0.0) - torque).abs() < 1e-12);
/// # Ok::<(), contrapposto::passive::PassiveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RienerEdrich1999 {
    /// The joint the torque acts on: 0 hip, 1 knee, 2 ankle.
    pub joint: usize,
    /// The exponential terms.
    pub terms: Vec<CoupledTerm>,
    /// Constant torque, N m.
    pub constant: f64,
}

impl RienerEdrich1999 {
    /// Torque (N m) and its derivative with respect to hip, knee and ankle angle (N m/rad).
    ///
    /// `angles`: hip flexion, knee flexion, ankle plantarflexion, rad.
    pub fn torque_and_gradient(&self, angles: [f64; 3]) -> (f64, [f64; 3]) {
        let mut torque = self.constant;
        let mut gradient = [0.0; 3];
        for term in &self.terms {
            let value = term.sign * libm::exp(term.exponent(angles));
            torque += value;
            for (slope, rate) in gradient.iter_mut().zip(term.rates) {
                *slope += rate * value;
            }
        }
        (torque, gradient)
    }

    /// Second derivatives of the torque by the three angles, N m/rad^2.
    pub(crate) fn curvature(&self, angles: [f64; 3]) -> [[f64; 3]; 3] {
        let mut curvature = [[0.0; 3]; 3];
        for term in &self.terms {
            let value = term.sign * libm::exp(term.exponent(angles));
            for (row, rate) in curvature.iter_mut().zip(term.rates) {
                row.iter_mut().zip(term.rates).for_each(|(entry, other)| *entry += rate * other * value);
            }
        }
        curvature
    }

    /// The law in the joint's own angle with the neighbours held at `angles`. With `mirrored` the coordinate runs the
    /// other way (OpenSim's ankle counts dorsiflexion positive): angle and torque change sign.
    ///
    /// # Errors
    /// [`PassiveError::Parameter`] where the exponents overflow, or for a joint other than 0, 1 and 2.
    pub fn held(&self, angles: [f64; 3], mirrored: bool) -> Result<Exponentials, PassiveError> {
        let sign = if mirrored { -1.0 } else { 1.0 };
        let mut others = angles;
        let Some(own) = others.get_mut(self.joint) else {
            let value = self.joint as f64;
            return Err(PassiveError::Parameter {
                parameter: PassiveParameter::Joint,
                value,
                accepted: "0 hip, 1 knee or 2 ankle",
            });
        };
        *own = 0.0;
        let terms: Vec<_> = self
            .terms
            .iter()
            .map(|term| (sign * term.sign * libm::exp(term.exponent(others)), sign * term.rates[self.joint], 0.0))
            .collect();
        Exponentials::new(&terms, 0.0, 0.0, sign * self.constant)
    }
}

impl CoupledTerm {
    fn exponent(&self, angles: [f64; 3]) -> f64 {
        self.c0 + self.rates[0] * angles[0] + self.rates[1] * angles[1] + self.rates[2] * angles[2]
    }
}
