//! Writes passive laws in the terms of the formats: springs, limit forces, and formulas of `q`.

use contrapposto::passive::{CoordinateLimitForce, Exponentials, Form, PassiveLaw, Reshape, Tabulated, Term};

use super::xml::number;
use crate::osim::expression::MOST_EXPRESSION_BYTES;

/// One summand of a law.
pub(super) enum Part<'a> {
    /// `-stiffness (q - rest)`.
    Spring {
        /// N m/rad.
        stiffness: f64,
        /// rad.
        rest: f64,
    },
    /// `-sum k_i x^i`, `x = q - rest`, from x^1 upward.
    Polynomial {
        /// N m/rad^i.
        coefficients: &'a [f64],
        /// rad.
        rest: f64,
    },
    /// OpenSim's own force.
    Limit(&'a CoordinateLimitForce),
    /// Torque in OpenSim's syntax of expressions.
    Formula(String),
}

/// The summands; none for a law that depends on several coordinates.
pub(super) fn summands(law: &PassiveLaw) -> Option<Vec<Part<'_>>> {
    match law {
        PassiveLaw::Curve(curve) => {
            let mut all = vec![match curve.form() {
                Form::Exponentials(law) => Part::Formula(exponentials(law)),
                Form::CoordinateLimitForce(law) => Part::Limit(law),
                Form::Tabulated(law) => Part::Formula(tabulated(law)?),
            }];
            let added = curve.reshape().map(|reshape| ends(reshape, curve.range()));
            all.extend(added.filter(|text| !text.is_empty()).map(Part::Formula));
            Some(all)
        }
        PassiveLaw::Coupled(_) | PassiveLaw::Slice(_) => None,
        PassiveLaw::Sum(terms) => terms.iter().map(summand).collect(),
    }
}

fn summand(term: &Term) -> Option<Part<'_>> {
    Some(match term {
        Term::Spring { stiffness, rest } => Part::Spring { stiffness: *stiffness, rest: *rest },
        Term::Polynomial { coefficients, rest } => Part::Polynomial { coefficients, rest: *rest },
        Term::CoordinateLimitForce(law) => Part::Limit(law),
        Term::Exponentials(law) => Part::Formula(exponentials(law)),
        Term::Expression(formula) => Part::Formula(formula.text().to_owned()),
    })
}

/// `q` less a number.
fn from(angle: f64) -> String {
    match angle {
        0.0 => "q".to_owned(),
        a if a < 0.0 => format!("(q+{})", number(-a)),
        a => format!("(q-{})", number(a)),
    }
}

/// A number as a further summand's factor, its sign in front.
fn signed(value: f64) -> String {
    if value < 0.0 { number(value) } else { format!("+{}", number(value)) }
}

/// A sum begins without a plus.
fn sum(text: String) -> String {
    match text.strip_prefix('+') {
        Some(rest) => rest.to_owned(),
        None if text.is_empty() => "0".to_owned(),
        None => text,
    }
}

fn exponentials(law: &Exponentials) -> String {
    let mut text = String::new();
    if law.constant() != 0.0 {
        text += &signed(law.constant());
    }
    let (stiffness, neutral) = law.linear_term();
    if stiffness != 0.0 {
        text += &format!("{}*{}", signed(-stiffness), from(neutral));
    }
    for (torque, rate, angle) in law.exponential_terms() {
        text += &format!("{}*exp({}*{})", signed(torque), number(rate), from(angle));
    }
    sum(text)
}

/// The formula that reshaping adds near both limits.
fn ends(reshape: &Reshape, (min, max): (f64, f64)) -> String {
    let (below, above) = (min + reshape.zone, max - reshape.zone);
    let mut text = String::new();
    if reshape.lower_stiffness != 0.0 {
        text += &format!("+{}*max(0,{}-q)", number(reshape.lower_stiffness), number(below));
    }
    if reshape.upper_stiffness != 0.0 {
        text += &format!("-{}*max(0,{})", number(reshape.upper_stiffness), from(above));
    }
    text.strip_prefix('+').map_or(text.clone(), str::to_owned)
}

/// Cubic pieces, each switched on between its ends; the outer ones go on beyond.
fn tabulated(law: &Tabulated) -> Option<String> {
    let pieces = law.pieces();
    let mut text = String::new();
    for (i, piece) in pieces.iter().enumerate() {
        let x = from(piece.start);
        let [c0, c1, c2, c3] = piece.coefficients.map(plain);
        let cubic = format!("({c0}+{x}*({c1}+{x}*({c2}+{x}*{c3})))");
        let on = if i == 0 { "1".to_owned() } else { format!("step{}", bracketed(&x)) };
        let off = pieces.get(i + 1).map_or(String::new(), |next| format!("-step{}", bracketed(&from(next.start))));
        text += &format!("+({on}{off})*{cubic}");
    }
    let text = sum(text);
    (text.len() <= MOST_EXPRESSION_BYTES).then_some(text)
}

fn bracketed(x: &str) -> String {
    if x.starts_with('(') { x.to_owned() } else { format!("({x})") }
}

/// A number as an operand, which may carry its sign.
fn plain(value: f64) -> String {
    if value < 0.0 { format!("({})", number(value)) } else { number(value) }
}

/// A polynomial as a formula, in the order in which we evaluate it.
pub(super) fn polynomial(coefficients: &[f64], rest: f64) -> String {
    let x = from(rest);
    let mut text = String::new();
    for (i, k) in coefficients.iter().rev().enumerate() {
        text = if i == 0 { plain(*k) } else { format!("({text}*{x}+{})", plain(*k)) };
    }
    if text.is_empty() { "0".to_owned() } else { format!("-{text}*{x}") }
}
