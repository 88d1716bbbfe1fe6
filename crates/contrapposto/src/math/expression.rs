//! Evaluates the expressions of OpenSim, with their slope.
//!
//! `ExpressionBasedCoordinateForce` writes a torque as a formula of the coordinate `q`, such as
//! `-2*exp(-5*(q+0.1)) + k; k=3`. The grammar and the precedence are OpenSim's own (the Lepton parser): `-q^2` is `-(q^2)`,
//! `2^3^2` is 512, white space does not count, there is no unary plus, and definitions follow after semicolons, each may use
//! those to its right. Where OpenSim simplifies before it evaluates and that changes a value, so do we: `0*x`, `0/x`, `0^x` and
//! `x-x` are 0, `x/x` and `x^0` are 1. The slope is exact, by dual numbers. At rest `qdot` is 0.
//!
//! Parts of a number that OpenSim drops in silence (`1e5.5` reads as 1e5, `.` as 0) are errors here.

mod dual;
mod parse;

pub use parse::ExpressionError;

use dual::Dual;

/// Most bytes of one expression.
pub const MOST_BYTES: usize = 16 << 10;
/// Most operations that may wait inside each other: brackets, signs, powers.
pub const MOST_DEPTH: usize = 64;

/// A formula of `q`. Evaluation takes time linear in its length.
///
/// ```
/// use contrapposto::math::expression::Expression;
/// let torque = Expression::parse("-k*q^2; k=10")?;
/// assert_eq!(torque.value_and_slope(0.5), (-2.5, -10.0));
/// # Ok::<(), contrapposto::math::expression::ExpressionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    nodes: Vec<Node>,
    root: usize,
}

/// One operation; operands stand before it in the list. Constants by their bits, so that equal parts are one part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Node {
    Constant(u64),
    Q,
    QDot,
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Unary {
    Negate,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Sec,
    Csc,
    Tan,
    Cot,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Erf,
    Erfc,
    Step,
    Delta,
    Square,
    Cube,
    Recip,
    Abs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

impl Expression {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`ExpressionError`] with the column.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        let (nodes, root) = parse::parse(text)?;
        Ok(Self { text: text.to_owned(), nodes, root })
    }

    /// The formula as written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Value and slope at `q`. Not finite where the formula is not defined (`log(q)` at 0). At a corner (`abs`, `min`, `max`)
    /// the slope is the mean of both sides; the jumps of `step` and `delta` have slope 0.
    #[must_use]
    pub fn value_and_slope(&self, q: f64) -> (f64, f64) {
        let mut done: Vec<Dual> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let result = match *node {
                Node::Constant(bits) => Dual::constant(f64::from_bits(bits)),
                Node::Q => Dual { value: q, slope: 1.0 },
                Node::QDot => Dual::constant(0.0),
                Node::Unary(function, a) => dual::unary(function, done[a]),
                Node::Binary(operation, a, b) => dual::binary(operation, done[a], done[b]),
            };
            done.push(result);
        }
        let Dual { value, slope } = done[self.root];
        (value, slope)
    }

    /// Value at `q`.
    #[must_use]
    pub fn value(&self, q: f64) -> f64 {
        self.value_and_slope(q).0
    }
}
