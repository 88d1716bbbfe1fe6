//! Computes with values, first and second derivatives by three variables at once (forward differentiation; Griewank & Walther 2008,
//! "Evaluating Derivatives", ch. 13).

use nalgebra::{Matrix3, Vector3};

/// A value with its gradient and its Hessian by three variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) gradient: Vector3<f64>,
    /// Symmetric.
    pub(crate) hessian: Matrix3<f64>,
}

impl Jet {
    /// `f(self)` from the value and the first two derivatives of `f` there.
    pub(crate) fn compose(self, [value, first, second]: [f64; 3]) -> Self {
        let outer = self.gradient * self.gradient.transpose();
        Self { value, gradient: first * self.gradient, hessian: first * self.hessian + second * outer }
    }

    pub(crate) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.compose([root, 0.5 / root, -0.25 / (root * self.value)])
    }

    pub(crate) fn recip(self) -> Self {
        let inverse = self.value.recip();
        self.compose([inverse, -inverse * inverse, 2.0 * inverse.powi(3)])
    }

    /// The angle of the point `(x, self)`, rad.
    pub(crate) fn atan2(self, x: Self) -> Self {
        let (a, b) = (self.value, x.value);
        let squared = a * a + b * b;
        let (by_a, by_b) = (b / squared, -a / squared);
        // Second derivatives of atan2: d2/da2 = -2ab/r^4 = -d2/db2, d2/dadb = (a^2 - b^2)/r^4.
        let (twice, mixed) = (2.0 * a * b / (squared * squared), (a * a - b * b) / (squared * squared));
        let (g, h) = (self.gradient, x.gradient);
        let hessian = by_a * self.hessian + by_b * x.hessian - twice * (g * g.transpose() - h * h.transpose())
            + mixed * (g * h.transpose() + h * g.transpose());
        Self { value: libm::atan2(a, b), gradient: by_a * g + by_b * h, hessian }
    }
}

impl std::ops::Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            hessian: self.hessian + other.hessian,
        }
    }
}

impl std::ops::Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let outer = self.gradient * other.gradient.transpose();
        Self {
            value: self.value * other.value,
            gradient: self.value * other.gradient + other.value * self.gradient,
            hessian: self.value * other.hessian + other.value * self.hessian + outer + outer.transpose(),
        }
    }
}

impl std::ops::Mul<Jet> for f64 {
    type Output = Jet;

    fn mul(self, jet: Jet) -> Jet {
        Jet { value: self * jet.value, gradient: self * jet.gradient, hessian: self * jet.hessian }
    }
}
