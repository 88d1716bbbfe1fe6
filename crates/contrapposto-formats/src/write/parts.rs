//! Numbers inside laws and splines that the model's crate shows only in its `Debug` text.
//!
//! That text has every number in its shortest exact form. What is read from it is put together again and compared with the
//! original, so a text that ever looked different would be a loss that is named, never a wrong file.

use contrapposto::math::Spline;
use contrapposto::passive::{Exponentials, Tabulated};

/// What a sum of exponentials is made of.
pub(super) struct ExponentialParts {
    /// Torque, rate, angle.
    pub(super) terms: Vec<(f64, f64, f64)>,
    pub(super) stiffness: f64,
    pub(super) neutral: f64,
    pub(super) constant: f64,
}

/// All numbers that follow `name: `, lists flattened.
fn after(text: &str, name: &str) -> Vec<f64> {
    let mut found = vec![];
    let label = format!("{name}: ");
    for (at, _) in text.match_indices(&label) {
        if text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &text[at + label.len()..];
        let mut depth = 0;
        let end = rest.find(|c: char| {
            depth += match c {
                '[' => 1,
                ']' => -1,
                _ => 0,
            };
            depth < 0 || (depth == 0 && ",]}".contains(c))
        });
        let words = rest[..end.unwrap_or(rest.len())].split(|c: char| "[], ".contains(c));
        found.extend(words.filter_map(|word| word.parse::<f64>().ok()));
    }
    found
}

pub(super) fn exponentials(law: &Exponentials) -> Option<ExponentialParts> {
    let text = format!("{law:?}");
    let one = |name| after(&text, name).first().copied();
    let (torques, rates, angles) = (after(&text, "torque"), after(&text, "rate"), after(&text, "angle"));
    let terms = torques.into_iter().zip(rates).zip(angles).map(|((torque, rate), angle)| (torque, rate, angle));
    let parts = ExponentialParts {
        terms: terms.take(one("count")? as usize).collect(),
        stiffness: one("stiffness")?,
        neutral: one("neutral")?,
        constant: one("constant")?,
    };
    let again = Exponentials::new(&parts.terms, parts.stiffness, parts.neutral, parts.constant).ok()?;
    (again == *law).then_some(parts)
}

/// Start and coefficients of each cubic piece.
pub(super) fn tabulated(law: &Tabulated) -> Option<Vec<(f64, [f64; 4])>> {
    let text = format!("{law:?}");
    let (starts, ends) = (after(&text, "start"), after(&text, "end"));
    let coefficients = after(&text, "coefficients");
    let pieces: Vec<(f64, [f64; 4])> =
        starts.into_iter().zip(coefficients.chunks_exact(4)).map(|(s, c)| (s, [c[0], c[1], c[2], c[3]])).collect();
    let (&(start, last), &end) = (pieces.last()?, ends.last()?);
    let t = end - start;
    let mut rows: Vec<(f64, f64)> = pieces.iter().map(|(start, c)| (*start, c[0])).collect();
    // The last row's torque is the end of the last cubic, up to rounding; no piece before it depends on that.
    let value = last[0] + t * (last[1] + t * (last[2] + t * last[3]));
    rows.push((end, value.min(last[0])));
    Tabulated::new(&rows).is_ok().then_some(pieces)
}

/// How a spline's points are joined.
pub(super) enum Joined {
    /// By SIMM's cubic.
    Simm,
    /// By straight lines.
    Straight,
}

/// Points of a spline, x and y.
pub(super) fn spline(spline: &Spline) -> Option<(Joined, Vec<f64>, Vec<f64>)> {
    let text = format!("{spline:?}");
    let (x, pieces) = (after(&text, "knots"), after(&text, "pieces"));
    let y: Vec<f64> = pieces.chunks_exact(4).map(|piece| piece[0]).collect();
    let (simm, straight) = (Spline::simm(&x, &y).ok()?, Spline::piecewise_linear(&x, &y).ok()?);
    if straight == *spline {
        return Some((Joined::Straight, x, y));
    }
    // A spline that was multiplied differs in the last digit.
    let theirs = after(&format!("{simm:?}"), "pieces");
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * (a.abs() + b.abs() + 1.0);
    let alike = theirs.len() == pieces.len() && theirs.iter().zip(&pieces).all(near);
    alike.then_some((Joined::Simm, x, y))
}
