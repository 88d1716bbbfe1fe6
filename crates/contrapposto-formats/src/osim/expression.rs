//! Reads OpenSim's expressions: a torque as a formula of the coordinate `q`, such as `-2*exp(-5*(q+0.1)) + k; k=3`.
//!
//! Grammar and precedence are OpenSim's own (the Lepton parser of `ExpressionBasedCoordinateForce`). `+ -` bind least, then `* /`,
//! then the sign, then `^` (to the right): `-q^2` is `-(q^2)`, `2^3^2` is 512. The right operand of any operator may carry a sign.
//! White space does not count, there is no unary plus, and definitions follow after semicolons, each seeing those to its right.
//! Where OpenSim simplifies before it evaluates and the value changes, this reader does the same: `0*x`, `0/x`, `0^x` and `x-x`
//! are 0, `x/x` and `x^0` are 1.
//!
//! Parts of a number that OpenSim drops in silence (`1e5.5` reads as 1e5, `.` as 0) are errors here.

mod error;

pub use error::{ExpressionError, MOST_DEPTH, MOST_EXPRESSION_BYTES};

use std::collections::HashMap;

use contrapposto::math::expression::{Binary, Expression, Operation, Unary};

const OPERAND: &str = "a number, a name, a function, `(` or `-`";

enum Function {
    One(Unary),
    Two(Binary),
}

fn function(name: &str) -> Option<Function> {
    use Function::{One, Two};
    Some(match name {
        "sqrt" => One(Unary::Sqrt),
        "exp" => One(Unary::Exp),
        "log" => One(Unary::Log),
        "sin" => One(Unary::Sin),
        "cos" => One(Unary::Cos),
        "sec" => One(Unary::Sec),
        "csc" => One(Unary::Csc),
        "tan" => One(Unary::Tan),
        "cot" => One(Unary::Cot),
        "asin" => One(Unary::Asin),
        "acos" => One(Unary::Acos),
        "atan" => One(Unary::Atan),
        "sinh" => One(Unary::Sinh),
        "cosh" => One(Unary::Cosh),
        "tanh" => One(Unary::Tanh),
        "erf" => One(Unary::Erf),
        "erfc" => One(Unary::Erfc),
        "step" => One(Unary::Step),
        "delta" => One(Unary::Delta),
        "square" => One(Unary::Square),
        "cube" => One(Unary::Cube),
        "recip" => One(Unary::Recip),
        "abs" => One(Unary::Abs),
        "min" => Two(Binary::Min),
        "max" => Two(Binary::Max),
        _ => return None,
    })
}

/// A character that is not white space, and its column.
type Glyph = (char, usize);

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Operator(char),
    Name(String),
    Call(String),
    Open,
    Close,
    Comma,
}

impl std::fmt::Display for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Operator(c) => write!(f, "{c}"),
            Self::Name(name) => f.write_str(name),
            Self::Call(name) => write!(f, "{name}("),
            Self::Open => f.write_str("("),
            Self::Close => f.write_str(")"),
            Self::Comma => f.write_str(","),
        }
    }
}

/// Reads a formula.
///
/// ```
/// let torque = contrapposto_formats::osim::expression::parse("-k*q^2; k=10")?;
/// assert_eq!(torque.value_and_slope(0.5), (-2.5, -10.0));
/// # Ok::<(), contrapposto_formats::osim::expression::ExpressionError>(())
/// ```
///
/// # Errors
/// [`ExpressionError`] with the column.
pub fn parse(text: &str) -> Result<Expression, ExpressionError> {
    if text.len() > MOST_EXPRESSION_BYTES {
        return Err(ExpressionError::TooLong { bytes: text.len() });
    }
    let is_space = |c: char| matches!(c, ' ' | '\t'..='\r');
    let glyphs: Vec<Glyph> = text.chars().zip(1..).filter(|&(c, _)| !is_space(c)).collect();
    let end = text.chars().count() + 1;
    let mut pieces = glyphs.split(|g| g.0 == ';');
    let primary = pieces.next().unwrap_or_default();
    let definitions: Vec<&[Glyph]> = pieces.filter(|piece| !piece.is_empty()).collect();
    let mut builder = Builder::default();
    // The last definition first: each may use those to its right.
    for piece in definitions.into_iter().rev() {
        let column = piece[0].1;
        let equals = piece.iter().position(|g| g.0 == '=').ok_or(ExpressionError::Definition { column })?;
        if equals == 0 {
            return Err(ExpressionError::Definition { column });
        }
        let name: String = piece[..equals].iter().map(|g| g.0).collect();
        let value = builder.whole(&piece[equals + 1..], piece[piece.len() - 1].1 + 1)?;
        builder.definitions.insert(name, value);
    }
    let root = builder.whole(primary, primary.last().map_or(end, |g| g.1 + 1))?;
    // All operands stand before the root; the operations behind it belong to definitions that nothing uses.
    builder.operations.truncate(root + 1);
    Ok(Expression::new(text, builder.operations)?)
}

fn tokens(glyphs: &[Glyph]) -> Result<Vec<(Token, usize)>, ExpressionError> {
    let mut list = Vec::new();
    let mut at = 0;
    while let Some(&(c, column)) = glyphs.get(at) {
        let rest = &glyphs[at..];
        let (token, length) = match c {
            '(' => (Token::Open, 1),
            ')' => (Token::Close, 1),
            ',' => (Token::Comma, 1),
            '+' | '-' | '*' | '/' | '^' => (Token::Operator(c), 1),
            '0'..='9' | '.' => {
                let length = number_length(rest);
                let digits: String = rest[..length].iter().map(|g| g.0).collect();
                let value = digits.parse().ok().filter(|v: &f64| v.is_finite());
                (Token::Number(value.ok_or(ExpressionError::Number { column, text: digits })?), length)
            }
            _ => {
                let stop = rest.iter().position(|g| matches!(g.0, '+' | '-' | '*' | '/' | '^' | ',' | '(' | ')'));
                let length = stop.unwrap_or(rest.len());
                let name = rest[..length].iter().map(|g| g.0).collect();
                if rest.get(length).is_some_and(|g| g.0 == '(') {
                    (Token::Call(name), length + 1)
                } else {
                    (Token::Name(name), length)
                }
            }
        };
        list.push((token, column));
        at += length;
    }
    Ok(list)
}

/// Number of characters that OpenSim takes for one number. A second decimal point, or an exponent with a decimal point, ends up in an error.
fn number_length(rest: &[Glyph]) -> usize {
    let (mut point, mut exponent, mut at) = (false, false, 0);
    while let Some(&(c, _)) = rest.get(at) {
        match c {
            '0'..='9' => {}
            '.' if !point => point = true,
            'e' | 'E' if !exponent => {
                exponent = true;
                if rest.get(at + 1).is_some_and(|g| matches!(g.0, '+' | '-')) {
                    at += 1;
                }
            }
            _ => break,
        }
        at += 1;
    }
    at
}

#[derive(Default)]
struct Builder {
    operations: Vec<Operation>,
    /// Places of the operations by their keys: equal parts of a formula are one part.
    known: HashMap<Key, usize>,
    definitions: HashMap<String, usize>,
}

/// An operation as a key: the constant by its bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    Constant(u64),
    Coordinate,
    Speed,
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
}

impl From<Operation> for Key {
    fn from(operation: Operation) -> Self {
        match operation {
            Operation::Constant(value) => Self::Constant(value.to_bits()),
            Operation::Coordinate => Self::Coordinate,
            Operation::Speed => Self::Speed,
            Operation::Unary(function, a) => Self::Unary(function, a),
            Operation::Binary(function, a, b) => Self::Binary(function, a, b),
        }
    }
}

struct Cursor<'a> {
    tokens: &'a [(Token, usize)],
    at: usize,
    depth: usize,
    end: usize,
}

impl Cursor<'_> {
    fn peek(&self) -> Option<&(Token, usize)> {
        self.tokens.get(self.at)
    }

    fn unexpected(&self, expected: &'static str) -> ExpressionError {
        match self.peek() {
            Some((token, column)) => {
                ExpressionError::Unexpected { column: *column, found: token.to_string(), expected }
            }
            None => ExpressionError::Unexpected { column: self.end, found: "the end".to_owned(), expected },
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if matches!(self.peek(), Some((Token::Close, _))) {
            self.at += 1;
            return Ok(());
        }
        Err(self.unexpected("`)` or an operator"))
    }
}

const SIGN: u8 = 2;

/// Precedence, and the precedence asked of the right operand.
fn binding(operator: char) -> (Binary, u8, u8) {
    match operator {
        '+' => (Binary::Add, 0, 1),
        '-' => (Binary::Subtract, 0, 1),
        '*' => (Binary::Multiply, 1, 2),
        '/' => (Binary::Divide, 1, 2),
        _ => (Binary::Power, 3, 3),
    }
}

impl Builder {
    /// One formula up to its end.
    fn whole(&mut self, glyphs: &[Glyph], end: usize) -> Result<usize, ExpressionError> {
        let tokens = tokens(glyphs)?;
        let mut cursor = Cursor { tokens: &tokens, at: 0, depth: 0, end };
        let result = self.part(&mut cursor, 0)?;
        if cursor.at < tokens.len() {
            return Err(cursor.unexpected("an operator or the end"));
        }
        Ok(result)
    }

    fn part(&mut self, cursor: &mut Cursor<'_>, precedence: u8) -> Result<usize, ExpressionError> {
        let Some((token, column)) = cursor.peek().cloned() else {
            return Err(ExpressionError::Ends { column: cursor.end });
        };
        cursor.depth += 1;
        if cursor.depth > MOST_DEPTH {
            return Err(ExpressionError::TooDeep { column });
        }
        cursor.at += 1;
        let mut result = match token {
            Token::Number(value) => self.constant(value),
            Token::Name(name) => self.name(name, column)?,
            Token::Open => {
                let inner = self.part(cursor, 0)?;
                cursor.close()?;
                inner
            }
            Token::Call(name) => self.call(cursor, name, column)?,
            Token::Operator('-') => {
                let operand = self.part(cursor, SIGN)?;
                self.unary(Unary::Negate, operand)
            }
            Token::Operator(_) | Token::Close | Token::Comma => {
                cursor.at -= 1;
                return Err(cursor.unexpected(OPERAND));
            }
        };
        while let Some(&(Token::Operator(operator), _)) = cursor.peek() {
            let (operation, own, right) = binding(operator);
            if own < precedence {
                break;
            }
            cursor.at += 1;
            let operand = self.part(cursor, right)?;
            result = self.binary(operation, result, operand);
        }
        cursor.depth -= 1;
        Ok(result)
    }

    fn name(&mut self, name: String, column: usize) -> Result<usize, ExpressionError> {
        match self.definitions.get(&name) {
            Some(&defined) => Ok(defined),
            None if name == "q" => Ok(self.intern(Operation::Coordinate)),
            None if name == "qdot" => Ok(self.intern(Operation::Speed)),
            None => Err(ExpressionError::UnknownName { column, name }),
        }
    }

    fn call(&mut self, cursor: &mut Cursor<'_>, name: String, column: usize) -> Result<usize, ExpressionError> {
        let Some(function) = function(&name) else {
            return Err(ExpressionError::UnknownFunction { column, name });
        };
        let mut operands = vec![self.part(cursor, 0)?];
        while matches!(cursor.peek(), Some((Token::Comma, _))) {
            cursor.at += 1;
            operands.push(self.part(cursor, 0)?);
        }
        cursor.close()?;
        let found = operands.len();
        match (function, operands.as_slice()) {
            (Function::One(function), &[a]) => Ok(self.unary(function, a)),
            (Function::Two(operation), &[a, b]) => Ok(self.binary(operation, a, b)),
            (Function::One(_), _) => Err(ExpressionError::Arguments { column, name, expected: 1, found }),
            (Function::Two(_), _) => Err(ExpressionError::Arguments { column, name, expected: 2, found }),
        }
    }

    /// The place of the operation, which is added where it is not known yet.
    fn intern(&mut self, operation: Operation) -> usize {
        let operations = &mut self.operations;
        *self.known.entry(operation.into()).or_insert_with(|| {
            operations.push(operation);
            operations.len() - 1
        })
    }

    fn constant(&mut self, value: f64) -> usize {
        self.intern(Operation::Constant(value))
    }

    fn unary(&mut self, function: Unary, a: usize) -> usize {
        self.intern(Operation::Unary(function, a))
    }

    /// With OpenSim's simplifications that change a value somewhere.
    fn binary(&mut self, operation: Binary, a: usize, b: usize) -> usize {
        let constant = |at: usize| match self.operations[at] {
            Operation::Constant(value) => Some(value),
            _ => None,
        };
        let (first, second) = (constant(a), constant(b));
        let one_varies = first.is_none() || second.is_none();
        let simple = match operation {
            Binary::Multiply if one_varies && (first == Some(0.0) || second == Some(0.0)) => Some(0.0),
            Binary::Subtract if one_varies && a == b => Some(0.0),
            Binary::Divide if one_varies && a == b => Some(1.0),
            Binary::Divide if one_varies && first == Some(0.0) => Some(0.0),
            Binary::Power if one_varies && first == Some(0.0) => Some(0.0),
            Binary::Power if one_varies && (first == Some(1.0) || second == Some(0.0)) => Some(1.0),
            _ => None,
        };
        match simple {
            Some(value) => self.constant(value),
            None => self.intern(Operation::Binary(operation, a, b)),
        }
    }
}
