//! Defines the passive torque of a coordinate, whatever its form.
//!
//! Relief needs a falling curve with a range ([`PassiveCurve`]); torques of imported models need more: laws coupled to
//! neighbouring joints, and sums of whatever a file holds, falling or not.

use std::borrow::Cow;

use super::{
    CoordinateLimitForce, DoubleExponential, Exponentials, Form, PassiveCurve, PassiveError, PassiveParameter,
    RienerEdrich1999, Slice,
};
use crate::math::expression::Expression;

/// Passive torque of one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub enum PassiveLaw {
    /// A falling curve over the coordinate's range.
    Curve(PassiveCurve),
    /// Riener & Edrich's law of hip, knee and ankle.
    Coupled(Coupled),
    /// Several terms that add up.
    Sum(Vec<Term>),
    /// That of muscles, near one posture.
    Slice(Slice),
}

/// A law of hip, knee and ankle angle together.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupled {
    /// The law, in its own directions (hip and knee flexion, ankle plantarflexion).
    pub law: RienerEdrich1999,
    /// Coordinates of hip, knee and ankle with +1, or -1 where the coordinate runs the other way; `None` counts as zero.
    pub neighbours: [Option<(usize, f64)>; 3],
}

/// One term of a sum.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// `-stiffness (q - rest)`: OpenSim's SpringGeneralizedForce, MJCF's stiffness and springref.
    Spring {
        /// N m/rad.
        stiffness: f64,
        /// rad.
        rest: f64,
    },
    /// `-sum k_i x^i`, `x = q - rest`, coefficients from x^1 upward.
    Polynomial {
        /// N m/rad^i.
        coefficients: Vec<f64>,
        /// rad.
        rest: f64,
    },
    /// OpenSim's CoordinateLimitForce.
    CoordinateLimitForce(CoordinateLimitForce),
    /// OpenSim's ExponentialCoordinateLimitForce.
    Exponentials(Exponentials),
    /// A formula of q.
    Expression(Expression),
}

impl PassiveLaw {
    /// The falling curve, where the law is one.
    pub fn curve(&self) -> Option<&PassiveCurve> {
        if let Self::Curve(curve) = self { Some(curve) } else { None }
    }

    /// The falling curve of coordinate `own` over `range` (rad), with the neighbours held as in `posture`; `None` where the
    /// law is a sum of a file's terms, which need not fall.
    pub fn curve_at(&self, own: usize, posture: &[f64], range: (f64, f64)) -> Option<Cow<'_, PassiveCurve>> {
        match self {
            Self::Curve(curve) => Some(Cow::Borrowed(curve)),
            Self::Coupled(coupled) => {
                let angles = coupled.angles(posture);
                let mirrored = coupled.neighbours.iter().flatten().any(|&(index, sign)| index == own && sign < 0.0);
                let held = coupled.law.held(angles, mirrored).ok()?;
                PassiveCurve::new(Form::Exponentials(held), range, None).ok().map(Cow::Owned)
            }
            Self::Slice(slice) => slice.curve(own, posture, range).ok().map(Cow::Owned),
            Self::Sum(_) => None,
        }
    }

    /// Torque (N m) of coordinate `own` in a posture (values of all coordinates, rad).
    pub fn torque(&self, own: usize, posture: &[f64]) -> f64 {
        match self {
            Self::Curve(curve) => curve.torque(posture[own]),
            Self::Coupled(coupled) => coupled.torque_and_gradient(posture).0,
            Self::Sum(terms) => terms.iter().map(|term| term.torque_and_slope(posture[own]).0).sum(),
            Self::Slice(slice) => slice.torque_and_slopes(own, posture, |_, _| {}),
        }
    }
}

impl PassiveLaw {
    /// Torque (N m) of coordinate `own` in a posture (values of all coordinates, rad), and through `visit` its derivatives by
    /// coordinates, N m/rad.
    pub(crate) fn torque_and_slopes(&self, own: usize, posture: &[f64], mut visit: impl FnMut(usize, f64)) -> f64 {
        match self {
            Self::Curve(curve) => {
                let (torque, slope) = curve.torque_and_slope(posture[own]);
                visit(own, slope);
                torque
            }
            Self::Coupled(coupled) => {
                let (torque, gradient) = coupled.torque_and_gradient(posture);
                for (neighbour, slope) in coupled.neighbours.iter().zip(gradient) {
                    if let Some((by, _)) = neighbour {
                        visit(*by, slope);
                    }
                }
                torque
            }
            Self::Sum(terms) => terms.iter().fold(0.0, |sum, term| {
                let (torque, slope) = term.torque_and_slope(posture[own]);
                visit(own, slope);
                sum + torque
            }),
            Self::Slice(slice) => slice.torque_and_slopes(own, posture, visit),
        }
    }

    /// Derivative by the own coordinate `own` at `angle`, N m/rad; 0 for Riener & Edrich's laws.
    pub(crate) fn own_slope(&self, own: usize, angle: f64) -> f64 {
        match self {
            Self::Curve(curve) => curve.torque_and_slope(angle).1,
            Self::Coupled(_) => 0.0,
            Self::Sum(terms) => terms.iter().map(|term| term.torque_and_slope(angle).1).sum(),
            Self::Slice(slice) => slice.own_slope(own, angle),
        }
    }
}

impl Coupled {
    /// Hip, knee and ankle angle in the law's own directions, rad.
    fn angles(&self, posture: &[f64]) -> [f64; 3] {
        self.neighbours.map(|n| n.map_or(0.0, |(index, sign)| sign * posture[index]))
    }

    /// Torque in the coordinate's direction, and its derivatives by the coordinates of hip, knee and ankle.
    pub(crate) fn torque_and_gradient(&self, posture: &[f64]) -> (f64, [f64; 3]) {
        let angles = self.angles(posture);
        let signs = self.neighbours.map(|n| n.map_or(0.0, |(_, sign)| sign));
        let (torque, mut gradient) = self.law.torque_and_gradient(angles);
        let own = if signs[self.law.joint] < 0.0 { -1.0 } else { 1.0 };
        for (slope, sign) in gradient.iter_mut().zip(signs) {
            *slope *= own * sign;
        }
        (own * torque, gradient)
    }

    /// Second derivatives of that torque by the coordinates of hip, knee and ankle.
    pub(crate) fn curvature(&self, posture: &[f64]) -> [[f64; 3]; 3] {
        let signs = self.neighbours.map(|n| n.map_or(0.0, |(_, sign)| sign));
        let own = if signs[self.law.joint] < 0.0 { -1.0 } else { 1.0 };
        let mut curvature = self.law.curvature(self.angles(posture));
        for (row, a) in curvature.iter_mut().zip(signs) {
            row.iter_mut().zip(signs).for_each(|(entry, b)| *entry *= own * a * b);
        }
        curvature
    }
}

impl Term {
    /// Torque (N m) and slope (N m/rad) at `q`.
    pub fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        match self {
            Self::Spring { stiffness, rest } => (-stiffness * (q - rest), -stiffness),
            Self::Polynomial { coefficients, rest } => {
                let x = q - rest;
                let (value, slope) = coefficients.iter().rev().fold((0.0, 0.0), |(p, d), k| (p * x + k, d * x + p));
                (-value * x, -(value + slope * x))
            }
            Self::CoordinateLimitForce(law) => law.torque_and_slope(q),
            Self::Exponentials(law) => law.torque_and_slope(q),
            Self::Expression(formula) => formula.value_and_slope(q),
        }
    }

    /// A double exponential as a term.
    ///
    /// # Errors
    /// [`PassiveError`] for numbers without meaning.
    pub fn double_exponential(law: DoubleExponential) -> Result<Self, PassiveError> {
        match law.form()? {
            Form::Exponentials(exponentials) => Ok(Self::Exponentials(exponentials)),
            _ => Err(PassiveError::Parameter {
                parameter: PassiveParameter::Law,
                value: f64::NAN,
                accepted: "a double exponential",
            }),
        }
    }
}
