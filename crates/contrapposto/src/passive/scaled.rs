//! Multiplies passive laws by a factor: people differ in the stiffness of their ligaments.

use super::{
    CoordinateLimitForce, Coupled, CoupledTerm, Form, PassiveCurve, PassiveError, PassiveLaw, RienerEdrich1999, Term,
};

impl PassiveLaw {
    /// The law with `times` the torque at every angle; `times` is positive.
    ///
    /// # Errors
    /// [`PassiveError::NotFinite`] where the torque overflows.
    pub fn scaled(&self, times: f64) -> Result<Self, PassiveError> {
        Ok(match self {
            Self::Curve(curve) => Self::Curve(curve.scaled(times)?),
            Self::Coupled(coupled) => {
                Self::Coupled(Coupled { law: coupled.law.scaled(times), neighbours: coupled.neighbours })
            }
            Self::Sum(terms) => Self::Sum(terms.iter().map(|term| term.scaled(times)).collect()),
            Self::Slice(slice) => Self::Slice(slice.scaled(times)?),
        })
    }
}

impl PassiveCurve {
    pub(super) fn scaled(&self, times: f64) -> Result<Self, PassiveError> {
        let form = match &self.form {
            Form::Exponentials(form) => Form::Exponentials(form.scaled(times)),
            Form::CoordinateLimitForce(form) => Form::CoordinateLimitForce(form.scaled(times)),
            Form::Tabulated(form) => Form::Tabulated(form.scaled(times)),
        };
        let reshape = self.reshape.map(|mut reshape| {
            reshape.lower_stiffness *= times;
            reshape.upper_stiffness *= times;
            reshape
        });
        Self::new(form, self.range, reshape)
    }
}

impl CoordinateLimitForce {
    fn scaled(self, times: f64) -> Self {
        Self { upper_stiffness: times * self.upper_stiffness, lower_stiffness: times * self.lower_stiffness, ..self }
    }
}

impl RienerEdrich1999 {
    /// A factor of an exponential is a term of its exponent.
    fn scaled(&self, times: f64) -> Self {
        let term = |term: &CoupledTerm| CoupledTerm { c0: term.c0 + libm::log(times), ..*term };
        Self { joint: self.joint, terms: self.terms.iter().map(term).collect(), constant: times * self.constant }
    }
}

impl Term {
    fn scaled(&self, times: f64) -> Self {
        match self {
            Self::Spring { stiffness, rest } => Self::Spring { stiffness: times * stiffness, rest: *rest },
            Self::Polynomial { coefficients, rest } => {
                Self::Polynomial { coefficients: coefficients.iter().map(|k| times * k).collect(), rest: *rest }
            }
            Self::CoordinateLimitForce(law) => Self::CoordinateLimitForce(law.scaled(times)),
            Self::Exponentials(law) => Self::Exponentials(law.scaled(times)),
            Self::Expression(formula) => Self::Expression(formula.scaled(times)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{CoordinateLimitForce, Coupled, CoupledTerm, PassiveCurve, PassiveLaw, RienerEdrich1999, Term};
    use crate::math::expression::{Expression, Operation, Unary};
    use crate::passive::{DoubleExponential, End, Reshape, Tabulated};

    fn laws() -> Vec<PassiveLaw> {
        let range = (-0.5, 1.5);
        let end = |angle| End { torque: 3.0, rate: 8.0, angle };
        let exponentials = DoubleExponential { lower: end(-0.5), upper: end(1.5), stiffness: 0.4, neutral: 0.3 };
        let limit = CoordinateLimitForce {
            upper_stiffness: 300.0,
            upper_limit: 1.2,
            lower_stiffness: 200.0,
            lower_limit: -0.2,
            transition: 0.3,
        };
        let table = Tabulated::new(&[(-0.5, 6.0), (0.0, 1.0), (0.5, 0.0), (1.0, 0.0), (1.5, -4.0)]).unwrap();
        let reshape = Reshape { zone: 0.2, lower_stiffness: 30.0, upper_stiffness: 20.0 };
        let curve = |form, reshape| PassiveLaw::Curve(PassiveCurve::new(form, range, reshape).unwrap());
        let term = CoupledTerm { sign: -1.0, c0: -1.0, rates: [0.3, 1.0, 0.0] };
        let coupled = RienerEdrich1999 { joint: 1, terms: vec![term], constant: 2.0 };
        let sine = vec![Operation::Coordinate, Operation::Unary(Unary::Sin, 0)];
        let sum = vec![
            Term::Spring { stiffness: 2.0, rest: 0.1 },
            Term::Polynomial { coefficients: vec![1.0, 0.5], rest: 0.2 },
            Term::CoordinateLimitForce(limit),
            Term::double_exponential(exponentials).unwrap(),
            Term::Expression(Expression::new("sin(q)", sine).unwrap()),
        ];
        vec![
            curve(exponentials.form().unwrap(), Some(reshape)),
            curve(limit.form().unwrap(), None),
            curve(table.form(), None),
            PassiveLaw::Coupled(Coupled { law: coupled, neighbours: [Some((1, 1.0)), Some((0, 1.0)), None] }),
            PassiveLaw::Sum(sum),
        ]
    }

    #[test]
    fn every_law_times_1_3_has_1_3_times_the_torque_and_slopes() {
        for law in laws() {
            let scaled = law.scaled(1.3).unwrap();
            for step in 0..=40 {
                let posture = [-0.5 + 0.05 * f64::from(step), 0.4];
                let slopes = |law: &PassiveLaw| {
                    let mut slopes = [0.0; 2];
                    let torque = law.torque_and_slopes(0, &posture, |by, slope| slopes[by] += slope);
                    [torque, slopes[0], slopes[1]]
                };
                for (a, b) in slopes(&law).into_iter().zip(slopes(&scaled)) {
                    assert!((1.3 * a - b).abs() < 1e-12 * (1.0 + a.abs()), "{law:?} at {posture:?}: {a}, scaled {b}");
                }
            }
        }
    }

    #[test]
    fn a_scaled_curve_has_a_scaled_energy_and_the_same_flattest_zone() {
        for law in laws() {
            let (Some(curve), Ok(scaled)) = (law.curve(), law.scaled(0.5)) else { continue };
            let scaled = scaled.curve().unwrap();
            let (a, b) = (curve.energy(1.4) - curve.energy(0.3), scaled.energy(1.4) - scaled.energy(0.3));
            assert!((0.5 * a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a}, scaled {b}");
            assert!((curve.flattest_angle() - scaled.flattest_angle()).abs() < 1e-9);
        }
    }
}
