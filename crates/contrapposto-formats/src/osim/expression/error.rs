//! Errors of expressions, and the largest sizes that are read.

use contrapposto::math::expression::OperandError;

/// Most bytes of one expression.
pub const MOST_EXPRESSION_BYTES: usize = 16 << 10;
/// Most operations that may wait inside each other: brackets, signs, powers.
pub const MOST_DEPTH: usize = 64;

/// The reason for which a formula was refused. Columns count characters of the formula from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// More bytes than accepted.
    #[error("the expression has {bytes} bytes; at most {MOST_EXPRESSION_BYTES} are accepted")]
    TooLong {
        /// Length of the expression.
        bytes: usize,
    },
    /// Brackets, signs or powers inside each other.
    #[error("column {column}: more than {MOST_DEPTH} brackets, signs or powers inside each other")]
    TooDeep {
        /// Column of the first one too many.
        column: usize,
    },
    /// The text ends, or a definition is empty.
    #[error("column {column}: the expression ends here; a number, a name, a function or `(` is expected")]
    Ends {
        /// One past the last character.
        column: usize,
    },
    /// Something else should stand there.
    #[error("column {column}: found `{found}`; expected {expected}")]
    Unexpected {
        /// Column of the text.
        column: usize,
        /// The text that stands there.
        found: String,
        /// The accepted values.
        expected: &'static str,
    },
    /// Neither `q`, `qdot` nor defined.
    #[error(
        "column {column}: unknown name `{name}`; names are `q`, `qdot` and what is defined after a `;` to the right"
    )]
    UnknownName {
        /// Column of the name.
        column: usize,
        /// The name.
        name: String,
    },
    /// No such function.
    #[error("column {column}: unknown function `{name}`; there are {FUNCTIONS}")]
    UnknownFunction {
        /// Column of the name.
        column: usize,
        /// The name.
        name: String,
    },
    /// Too many or too few operands in brackets.
    #[error("column {column}: `{name}` takes {expected} argument(s), found {found}")]
    Arguments {
        /// Column of the function.
        column: usize,
        /// The function.
        name: String,
        /// Number of operands that the function takes.
        expected: usize,
        /// Number of operands in the brackets.
        found: usize,
    },
    /// Digits that are no finite number.
    #[error("column {column}: `{text}` is not a finite decimal number")]
    Number {
        /// Column of the digits.
        column: usize,
        /// The digits.
        text: String,
    },
    /// Operands that do not stand before their operation. The reader puts them there.
    #[error(transparent)]
    Operand(#[from] OperandError),
    /// A piece after `;` without `name =`.
    #[error("column {column}: a definition has the form `name = expression`")]
    Definition {
        /// Column at which the piece begins.
        column: usize,
    },
}

const FUNCTIONS: &str = "sqrt, exp, log, sin, cos, sec, csc, tan, cot, asin, acos, atan, sinh, cosh, tanh, erf, erfc, step, \
                         delta, square, cube, recip, abs, min, max";
