//! Evaluates a formula of one coordinate `q` and its slope, exactly, by dual numbers.
//!
//! A formula is a list of operations. The list comes from a reader of text, which alone knows a grammar (the formats crate reads
//! OpenSim's). At rest the speed `qdot` is 0.

mod dual;
mod operation;

use dual::Dual;

pub use operation::{Binary, Operation, Unary};

/// A formula of `q`. Evaluation takes time linear in the number of operations.
///
/// ```
/// use contrapposto::math::expression::{Binary, Expression, Operation, Unary};
/// let square = [Operation::Coordinate, Operation::Unary(Unary::Square, 0), Operation::Constant(-10.0)];
/// let operations = [square.as_slice(), &[Operation::Binary(Binary::Multiply, 2, 1)]].concat();
/// let torque = Expression::new("-10*q^2", operations)?;
/// assert_eq!(torque.value_and_slope(0.5), (-2.5, -10.0));
/// # Ok::<(), contrapposto::math::expression::OperandError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    operations: Vec<Operation>,
}

/// A list of operations was refused: an operand does not stand before its operation, or the list is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("operation {operation} of a formula takes operand {operand}; an operand stands before its operation")]
pub struct OperandError {
    /// Place of the operation.
    pub operation: usize,
    /// Place of the operand.
    pub operand: usize,
}

impl Expression {
    /// The formula whose value is that of the last operation. `text` is the formula as written.
    ///
    /// # Errors
    /// [`OperandError`] for an operand that does not stand before its operation.
    pub fn new(text: &str, operations: Vec<Operation>) -> Result<Self, OperandError> {
        for (operation, given) in operations.iter().enumerate() {
            let operand = match *given {
                Operation::Unary(_, a) => a,
                Operation::Binary(_, a, b) => a.max(b),
                Operation::Constant(_) | Operation::Coordinate | Operation::Speed => continue,
            };
            if operand >= operation {
                return Err(OperandError { operation, operand });
            }
        }
        if operations.is_empty() {
            return Err(OperandError { operation: 0, operand: 0 });
        }
        Ok(Self { text: text.to_owned(), operations })
    }

    /// The formula with `times` the value everywhere.
    pub(crate) fn scaled(&self, times: f64) -> Self {
        let last = self.operations.len() - 1;
        let product = [Operation::Constant(times), Operation::Binary(Binary::Multiply, last, last + 1)];
        let operations = self.operations.iter().copied().chain(product).collect();
        Self { text: format!("{times}*({})", self.text), operations }
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
        let mut done: Vec<Dual> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let result = match *operation {
                Operation::Constant(value) => Dual::constant(value),
                Operation::Coordinate => Dual { value: q, slope: 1.0 },
                Operation::Speed => Dual::constant(0.0),
                Operation::Unary(function, a) => dual::unary(function, done[a]),
                Operation::Binary(operation, a, b) => dual::binary(operation, done[a], done[b]),
            };
            done.push(result);
        }
        done.last().map_or((f64::NAN, f64::NAN), |last| (last.value, last.slope))
    }

    /// Value at `q`.
    #[must_use]
    pub fn value(&self, q: f64) -> f64 {
        self.value_and_slope(q).0
    }
}
