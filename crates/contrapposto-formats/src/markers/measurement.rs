//! Defines measurements: distances between markers that give the factors of bodies.

use nalgebra::Vector3;

use super::Markers;
use crate::xml::{Position, shorten};

/// A measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Name in messages.
    pub name: String,
    /// Pairs of markers; the factor is the mean of theirs.
    pub pairs: Vec<[String; 2]>,
    /// Bodies that get the factor, and their axes x, y, z that do.
    pub bodies: Vec<(String, [bool; 3])>,
    /// Place in a setup file.
    pub place: Option<Position>,
}

/// The reason for which a text is no measurement.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{problem}; accepted: NAME=MARKER,MARKER:BODY,BODY:XYZ, like thigh=R.ASIS,R.Knee:femur_r:XYZ (more pairs after a semicolon, the axes may be left out)"
)]
pub struct MeasurementError {
    problem: String,
}

impl Measurement {
    /// Reads `NAME=MARKER,MARKER;MARKER,MARKER:BODY,BODY:XYZ`. Axes that are left out are all three.
    ///
    /// # Errors
    /// [`MeasurementError`] names the part that is wrong.
    pub fn parse(text: &str) -> Result<Self, MeasurementError> {
        let wrong = |problem: String| Err(MeasurementError { problem });
        let Some((name, rest)) = text.split_once('=') else {
            return wrong(format!("`{}` has no `=`", shorten(text)));
        };
        let parts: Vec<&str> = rest.split(':').collect();
        let (pairs, bodies, axes) = match parts[..] {
            [pairs, bodies] => (pairs, bodies, "XYZ"),
            [pairs, bodies, axes] => (pairs, bodies, axes),
            _ => return wrong(format!("`{}` has {} parts apart by `:`, not 2 or 3", shorten(rest), parts.len())),
        };
        let mut measurement = Self { name: name.trim().to_owned(), ..Self::default() };
        for pair in pairs.split(';') {
            let names: Vec<&str> = pair.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
            let [first, second] = names[..] else {
                return wrong(format!("`{}` is no pair of markers", shorten(pair)));
            };
            measurement.pairs.push([first.to_owned(), second.to_owned()]);
        }
        let Some(axes) = axis_flags(axes) else { return wrong(format!("`{}` names no axes", shorten(axes))) };
        for body in bodies.split(',').map(str::trim) {
            if body.is_empty() {
                return wrong(format!("`{}` has an empty name of a body", shorten(bodies)));
            }
            measurement.bodies.push((body.to_owned(), axes));
        }
        Ok(measurement)
    }
}

/// Axes of a word like `XYZ` or `X Y`; `None` for other letters or none.
pub(super) fn axis_flags(text: &str) -> Option<[bool; 3]> {
    let mut flags = [false; 3];
    for letter in text.chars().filter(|c| !c.is_whitespace()) {
        flags["xyz".find(letter.to_ascii_lowercase())?] = true;
    }
    flags.contains(&true).then_some(flags)
}

impl Markers {
    /// The frames of a time range, as OpenSim takes them: from the last one at or before its begin to the first one at or after its end.
    pub fn frames_between(&self, from: f64, to: f64) -> std::ops::RangeInclusive<usize> {
        let last = self.times.len().saturating_sub(1);
        let first = self.times.iter().rposition(|time| *time <= from).unwrap_or(0);
        let end = self.times[first..].iter().position(|time| *time >= to - f64::EPSILON);
        first..=end.map_or(last, |end| first + end)
    }

    /// Mean distance of two markers over frames that have both, m; `None` without such a frame.
    pub fn mean_distance(&self, [a, b]: [usize; 2], frames: std::ops::RangeInclusive<usize>) -> Option<f64> {
        let both = self.places[frames].iter().filter_map(|row| row[a].zip(row[b]));
        let (sum, count) = both.fold((0.0, 0), |(sum, count), (a, b)| (sum + (b - a).norm(), count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Mean place of a marker over frames that have it, m, and its largest movement along an axis, m; `None` without such a frame.
    pub fn mean_place(&self, marker: usize, frames: std::ops::RangeInclusive<usize>) -> Option<(Vector3<f64>, f64)> {
        let seen: Vec<Vector3<f64>> = self.places[frames].iter().filter_map(|row| row[marker]).collect();
        let first = seen.first()?;
        let (low, high) = seen.iter().fold((*first, *first), |(low, high), place| (low.inf(place), high.sup(place)));
        Some((seen.iter().sum::<Vector3<f64>>() / seen.len() as f64, (high - low).max()))
    }
}

#[cfg(test)]
mod tests {
    use super::Measurement;

    #[test]
    fn a_short_text_is_a_measurement() {
        let read = Measurement::parse("thigh=R.ASIS,R.Knee;L.ASIS,L.Knee:femur_r, femur_l:xY").unwrap();
        assert_eq!(read.name, "thigh");
        assert_eq!(read.pairs, [["R.ASIS", "R.Knee"], ["L.ASIS", "L.Knee"]].map(|pair| pair.map(str::to_owned)));
        assert_eq!(read.bodies[1], ("femur_l".to_owned(), [true, true, false]));
        assert_eq!(Measurement::parse("a=b,c:d").unwrap().bodies[0].1, [true; 3]);
        for (text, part) in [
            ("thigh", "`thigh` has no `=`"),
            ("a=b:c", "`b` is no pair of markers"),
            ("a=b,c", "has 1 parts"),
            ("a=b,c:d:w", "`w` names no axes"),
            ("a=b,c:d,:x", "empty name of a body"),
        ] {
            let message = Measurement::parse(text).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("NAME=MARKER,MARKER:BODY"), "{message}");
        }
    }
}
