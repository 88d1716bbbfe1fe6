//! Values with their slope.

use super::operation::{Binary, Unary};

/// A value and its derivative by `q`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) slope: f64,
}

impl Dual {
    pub(super) fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// Chain rule. A constant gives no slope, even where the outer derivative is infinite or not a number.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: if self.slope == 0.0 { 0.0 } else { derivative * self.slope } }
    }
}

pub(super) fn unary(function: Unary, a: Dual) -> Dual {
    let x = a.value;
    match function {
        Unary::Negate => a.chain(-x, -1.0),
        Unary::Sqrt => a.chain(x.sqrt(), 0.5 / x.sqrt()),
        Unary::Exp => a.chain(libm::exp(x), libm::exp(x)),
        Unary::Log => a.chain(libm::log(x), 1.0 / x),
        Unary::Sin => a.chain(libm::sin(x), libm::cos(x)),
        Unary::Cos => a.chain(libm::cos(x), -libm::sin(x)),
        Unary::Sec => a.chain(1.0 / libm::cos(x), libm::tan(x) / libm::cos(x)),
        Unary::Csc => a.chain(1.0 / libm::sin(x), -1.0 / (libm::sin(x) * libm::tan(x))),
        Unary::Tan => a.chain(libm::tan(x), 1.0 + libm::tan(x) * libm::tan(x)),
        Unary::Cot => a.chain(1.0 / libm::tan(x), -1.0 / (libm::sin(x) * libm::sin(x))),
        Unary::Asin => a.chain(libm::asin(x), 1.0 / (1.0 - x * x).sqrt()),
        Unary::Acos => a.chain(libm::acos(x), -1.0 / (1.0 - x * x).sqrt()),
        Unary::Atan => a.chain(libm::atan(x), 1.0 / (1.0 + x * x)),
        Unary::Sinh => a.chain(libm::sinh(x), libm::cosh(x)),
        Unary::Cosh => a.chain(libm::cosh(x), libm::sinh(x)),
        Unary::Tanh => a.chain(libm::tanh(x), 1.0 - libm::tanh(x) * libm::tanh(x)),
        Unary::Erf => a.chain(erf(x), std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x)),
        Unary::Erfc => a.chain(erfc(x), -std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x)),
        Unary::Step => Dual::constant(f64::from(x >= 0.0)),
        Unary::Delta => Dual::constant(f64::from(x == 0.0)),
        Unary::Square => a.chain(x * x, 2.0 * x),
        Unary::Cube => a.chain(x * x * x, 3.0 * x * x),
        Unary::Recip => a.chain(1.0 / x, -1.0 / (x * x)),
        Unary::Abs => a.chain(x.abs(), if x == 0.0 { 0.0 } else { x.signum() }),
    }
}

pub(super) fn binary(operation: Binary, a: Dual, b: Dual) -> Dual {
    let (x, y) = (a.value, b.value);
    let sum = |value, by_a, by_b| Dual { value, slope: a.chain(x, by_a).slope + b.chain(y, by_b).slope };
    let choose = |second: bool| {
        if x == y {
            sum(x, 0.5, 0.5)
        } else if second {
            b
        } else {
            a
        }
    };
    match operation {
        Binary::Add => sum(x + y, 1.0, 1.0),
        Binary::Subtract => sum(x - y, 1.0, -1.0),
        Binary::Multiply => sum(x * y, y, x),
        Binary::Divide => sum(x / y, 1.0 / y, -x / (y * y)),
        Binary::Power => {
            let by_base = if y == 0.0 { 0.0 } else { y * libm::pow(x, y - 1.0) };
            let by_exponent = if x == 0.0 && y > 0.0 { 0.0 } else { libm::pow(x, y) * libm::log(x) };
            sum(libm::pow(x, y), by_base, by_exponent)
        }
        // As the C++ library: the first where they are not ordered.
        Binary::Min => choose(y < x),
        Binary::Max => choose(x < y),
    }
}

/// Argument at which the series hands over to the continued fraction.
const SERIES_END: f64 = 2.5;

/// `erf(x) = 2/sqrt(pi) exp(-x^2) (x + 2 x^3/3 + 4 x^5/15 + ...)`: all terms of one sign (Abramowitz & Stegun 7.1.6).
fn erf(x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    if x.abs() > SERIES_END {
        return x.signum() - x.signum() * erfc(x.abs());
    }
    let (mut term, mut sum, mut n) = (x, x, 0.0);
    while term.abs() > sum.abs() * f64::EPSILON * 0.1 {
        n += 1.0;
        term *= 2.0 * x * x / (2.0 * n + 1.0);
        sum += term;
    }
    std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x) * sum
}

/// `erfc(x) = exp(-x^2)/sqrt(pi) 1/(x + (1/2)/(x + 1/(x + (3/2)/(x + ...))))` far out (Abramowitz & Stegun 7.1.14).
fn erfc(x: f64) -> f64 {
    if x <= SERIES_END || x.is_nan() {
        return if x < -SERIES_END { 2.0 - erfc(-x) } else { 1.0 - erf(x) };
    }
    let fraction = (1..=120).rev().fold(x, |below, k| x + 0.5 * f64::from(k) / below);
    0.5 * std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x) / fraction
}
