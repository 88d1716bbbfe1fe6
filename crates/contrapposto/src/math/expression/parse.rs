//! Text to operations: precedence as OpenSim's parser has it.
//!
//! `+ -` bind least, then `* /`, then the sign, then `^` (to the right). The right operand of any operator may carry a sign.

use std::collections::HashMap;

use super::{Binary, MOST_BYTES, MOST_DEPTH, Node, Unary};

/// Why a formula was refused. Columns count characters of the formula from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// More bytes than accepted.
    #[error("the expression has {bytes} bytes; at most {MOST_BYTES} are accepted")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// Brackets, signs or powers inside each other.
    #[error("column {column}: more than {MOST_DEPTH} brackets, signs or powers inside each other")]
    TooDeep {
        /// Where the first one too many stands.
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
        /// Where.
        column: usize,
        /// The text at that place.
        found: String,
        /// The text that would be accepted.
        expected: &'static str,
    },
    /// Neither `q`, `qdot` nor defined.
    #[error(
        "column {column}: unknown name `{name}`; names are `q`, `qdot` and what is defined after a `;` to the right"
    )]
    UnknownName {
        /// Where.
        column: usize,
        /// The name.
        name: String,
    },
    /// No such function.
    #[error("column {column}: unknown function `{name}`; there are {}", FUNCTIONS)]
    UnknownFunction {
        /// Where.
        column: usize,
        /// The name.
        name: String,
    },
    /// Too many or too few operands in brackets.
    #[error("column {column}: `{name}` takes {expected} argument(s), found {found}")]
    Arguments {
        /// Where.
        column: usize,
        /// The function.
        name: String,
        /// How many it takes.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// Digits that are no finite number.
    #[error("column {column}: `{text}` is not a finite decimal number")]
    Number {
        /// Where.
        column: usize,
        /// The digits.
        text: String,
    },
    /// A piece after `;` without `name =`.
    #[error("column {column}: a definition has the form `name = expression`")]
    Definition {
        /// Where the piece begins.
        column: usize,
    },
}

const FUNCTIONS: &str = "sqrt, exp, log, sin, cos, sec, csc, tan, cot, asin, acos, atan, sinh, cosh, tanh, erf, erfc, step, \
                         delta, square, cube, recip, abs, min, max";

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

pub(super) fn parse(text: &str) -> Result<(Vec<Node>, usize), ExpressionError> {
    if text.len() > MOST_BYTES {
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
    Ok((builder.nodes, root))
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

/// How many characters OpenSim takes for one number. More than one decimal point or an exponent with one end up in an error.
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
    nodes: Vec<Node>,
    known: HashMap<Node, usize>,
    definitions: HashMap<String, usize>,
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
            None if name == "q" => Ok(self.intern(Node::Q)),
            None if name == "qdot" => Ok(self.intern(Node::QDot)),
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

    fn intern(&mut self, node: Node) -> usize {
        let nodes = &mut self.nodes;
        *self.known.entry(node).or_insert_with(|| {
            nodes.push(node);
            nodes.len() - 1
        })
    }

    fn constant(&mut self, value: f64) -> usize {
        self.intern(Node::Constant(value.to_bits()))
    }

    fn unary(&mut self, function: Unary, a: usize) -> usize {
        self.intern(Node::Unary(function, a))
    }

    /// With OpenSim's simplifications that change a value somewhere.
    fn binary(&mut self, operation: Binary, a: usize, b: usize) -> usize {
        let constant = |at: usize| match self.nodes[at] {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
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
            None => self.intern(Node::Binary(operation, a, b)),
        }
    }
}
