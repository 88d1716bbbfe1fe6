//! Computes with numbers of about 32 digits: the unevaluated sum of two `f64` (Dekker 1971, Knuth's two-sum).

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

#[derive(Clone, Copy, Debug, Default)]
pub struct Double {
    high: f64,
    low: f64,
}

impl Double {
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The exact sum of two numbers.
    pub fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// The exact product of two numbers.
    pub fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    pub fn value(self) -> f64 {
        self.high + self.low
    }

    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        // One step of Newton doubles the digits.
        let root = Self::from(self.high.sqrt());
        root + (self - root * root) / Self::from(2.0 * root.high)
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let first = Self::sum(high.high, high.low + low.high);
        Self::sum(first.high, first.low + low.low)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let exact = Self::product(self.high, other.high);
        Self::sum(exact.high, exact.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        Self::sum(first, second) + Self::from(rest.high / other.high)
    }
}

impl AddAssign for Double {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Double {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// `a b` of plain numbers.
pub fn dot(a: &[f64], b: &[f64]) -> Double {
    assert_eq!(a.len(), b.len());
    let mut sum = Double::ZERO;
    for (a, b) in a.iter().zip(b) {
        sum += Double::product(*a, *b);
    }
    sum
}

pub fn inner(a: &[Double], b: &[Double]) -> Double {
    assert_eq!(a.len(), b.len());
    let mut sum = Double::ZERO;
    for (a, b) in a.iter().zip(b) {
        sum += *a * *b;
    }
    sum
}

#[test]
fn thirty_digits() {
    let third = Double::from(1.0) / Double::from(3.0);
    assert!((third * Double::from(3.0) - Double::from(1.0)).value().abs() < 1e-31);
    let root = Double::from(2.0).sqrt();
    assert!((root * root - Double::from(2.0)).value().abs() < 1e-30);
    assert_eq!((Double::from(1e20) + Double::from(1.0) - Double::from(1e20)).value(), 1.0);
    assert_eq!(Double::product(1.0 + 1e-10, 1.0 - 1e-10).value(), 1.0 - 1e-20);
    let tiny = Double::product(1.0 + f64::EPSILON, 1.0 + f64::EPSILON) - Double::from(1.0 + 2.0 * f64::EPSILON);
    assert_eq!(tiny.value(), f64::EPSILON * f64::EPSILON);
}
