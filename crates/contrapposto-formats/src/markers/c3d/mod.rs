//! Reads points and force plates of C3D files: the binary files of motion capture (Motion Lab Systems, The C3D File Format, User Guide, 2008).
//!
//! A header of 512 bytes, a section of parameters, and frames of points and of analog samples. Numbers are those of Intel, DEC or MIPS
//! computers; places are reals, or integers with a scale. A point whose fourth number is negative was not seen. Events are passed over.

mod analog;
mod layout;
mod numbers;
mod parameters;
mod plates;
mod refusal;
mod trial;

use std::collections::HashSet;

use super::trc::{MarkerUnit, Markers};
use crate::motion::{MOST_NAME_BYTES, MOST_NUMBERS};
use crate::xml::shorten;
use contrapposto::model::LARGEST;
use layout::Layout;
use parameters::Parameters;
pub(crate) use plates::LEAST_FORCE;
pub use plates::{ForcePlate, ForcePlates, read_force_plates};
pub use refusal::C3dError;
use trial::{KEY, read_unit, trial, up};

/// Labels of a parameter; more go on in further ones.
const LABELS_OF_ONE: usize = 255;

/// Whether bytes begin as those of a C3D file: with the number of the block in which parameters begin, a character that begins no text.
pub fn is_c3d(bytes: &[u8]) -> bool {
    matches!(bytes, [first, KEY, ..] if *first > 0 && first.is_ascii_control() && !first.is_ascii_whitespace())
}

/// Reads the points of a C3D file. Time of frame `n`, counted from 1, is `(n - 1) / rate`, where a trial may begin after its first frame. `unit`: that of
/// the places, whatever the file says. `name` stands in errors and warnings only.
///
/// # Errors
/// [`C3dError`] says what is wrong, at which byte, and what would be accepted.
pub fn read_c3d(name: &str, bytes: &[u8], unit: Option<MarkerUnit>) -> Result<Markers, C3dError> {
    let mut read = markers(bytes, unit).map_err(|error| error.of(name))?;
    for warning in &mut read.warnings {
        *warning = format!("{name}: {warning}");
    }
    Ok(read)
}

fn markers(bytes: &[u8], unit: Option<MarkerUnit>) -> Result<Markers, C3dError> {
    let mut warnings = vec![];
    let (parameters, layout, data) = trial(bytes, unit, &mut warnings)?;
    let unit = read_unit(&parameters, unit)?;
    let columns = names(&parameters, layout.points, &mut warnings)?;
    let there = data.len() / layout.frame;
    if there.saturating_mul(3 * columns.len()) > MOST_NUMBERS {
        let message = format!("{there} frames of {} markers have more than {MOST_NUMBERS} numbers", columns.len());
        return Err(C3dError::at(layout.start, message, "a shorter part of the trial is accepted"));
    }
    if (layout.first + there) as f64 / layout.rate > LARGEST {
        let message = format!("the trial begins at frame {}, at {} frames a second", layout.first + 1, layout.rate);
        return Err(C3dError::at(
            parameters.byte("TRIAL:ACTUAL_START_FIELD"),
            message,
            "times up to 1e9 s are accepted",
        ));
    }
    let places = places(&layout, &columns, data, &mut warnings)?;
    let times = (0..there).map(|index| (layout.first + index) as f64 / layout.rate).collect();
    let names = columns.into_iter().map(|(name, _)| name).collect();
    Ok(Markers { names, times, places, unit, up: up(&parameters), warnings })
}

/// Places of the named points in whole frames.
fn places(
    layout: &Layout,
    columns: &[(String, usize)],
    data: &[u8],
    warnings: &mut Vec<String>,
) -> Result<Vec<Vec<Option<nalgebra::Vector3<f64>>>>, C3dError> {
    let size = layout.point();
    let mut zeros = 0;
    let mut places = Vec::with_capacity(data.len() / layout.frame);
    for (index, frame) in data.chunks_exact(layout.frame).enumerate() {
        let mut row = Vec::with_capacity(columns.len());
        for (name, column) in columns {
            let at = size * column;
            let place = layout.place(&frame[at..at + size]).map_err(|value| {
                let message = format!(
                    "`{}` in frame {}: {value} is no place of a marker",
                    shorten(name),
                    layout.first + index + 1
                );
                let accepted = "a finite number is accepted, a negative residual or NaN for a gap";
                C3dError::at(layout.start + index * layout.frame + at, message, accepted)
            })?;
            let is_zero = place.is_some_and(|place| place.iter().all(|value| *value == 0.0));
            zeros += usize::from(is_zero);
            row.push(place.filter(|_| !is_zero));
        }
        places.push(row);
    }
    if zeros > 0 {
        warnings.push(format!("{zeros} places of markers are 0, 0, 0, which are read as gaps"));
    }
    Ok(places)
}

/// Names of the points that are markers, each with the number of its point.
fn names(
    parameters: &Parameters<'_>,
    points: usize,
    warnings: &mut Vec<String>,
) -> Result<Vec<(String, usize)>, C3dError> {
    let byte = parameters.byte("POINT:LABELS");
    let mut labels = parameters.texts("POINT:LABELS", points).unwrap_or_default();
    for number in 2..=points.div_ceil(LABELS_OF_ONE) {
        let missing = points.saturating_sub(labels.len());
        labels.extend(parameters.texts(&format!("POINT:LABELS{number}"), missing).unwrap_or_default());
    }
    let nameless = points - labels.iter().filter(|label| !label.is_empty()).count();
    if nameless == points {
        let message = format!("none of the {points} points of a frame has a name");
        return Err(C3dError::at(byte, message, "a name for each in POINT:LABELS, LABELS2, ... is accepted"));
    }
    if nameless > 0 {
        warnings.push(format!("{nameless} of {points} points have no name (POINT:LABELS) and are left out"));
    }
    let (mut columns, mut seen) = (vec![], HashSet::new());
    for (point, name) in labels.into_iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        if name.len() > MOST_NAME_BYTES || name.contains(char::is_control) {
            let accepted = format!("a name has {MOST_NAME_BYTES} bytes at most and no control characters");
            return Err(C3dError::at(byte, format!("the name of point {} cannot be read", point + 1), accepted));
        }
        if seen.insert(name.clone()) {
            columns.push((name, point));
        } else {
            warnings.push(format!("two markers are named `{name}`; the first one is read"));
        }
    }
    Ok(columns)
}
