//! Lists the operations of a formula.

/// One operation of a formula; its operands are places in the list of operations before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// A number.
    Constant(f64),
    /// The coordinate `q`.
    Coordinate,
    /// The speed `qdot`, 0 at rest.
    Speed,
    /// A function of one operand.
    Unary(Unary, usize),
    /// A function of two operands.
    Binary(Binary, usize, usize),
}

/// A function of one operand a.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// -a.
    Negate,
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Log,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// 1 / cos a.
    Sec,
    /// 1 / sin a.
    Csc,
    /// Tangent.
    Tan,
    /// 1 / tan a.
    Cot,
    /// Inverse sine.
    Asin,
    /// Inverse cosine.
    Acos,
    /// Inverse tangent.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Error function.
    Erf,
    /// 1 - erf a.
    Erfc,
    /// 1 from 0 on, else 0.
    Step,
    /// 1 at 0, else 0.
    Delta,
    /// a a.
    Square,
    /// a a a.
    Cube,
    /// 1 / a.
    Recip,
    /// Size.
    Abs,
}

/// A function of two operands a and b.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a - b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// a to the power b.
    Power,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
}
