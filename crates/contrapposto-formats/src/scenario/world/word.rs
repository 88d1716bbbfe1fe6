//! Reads numbers and names of one table of a thing; errors are placed at its keys.

use contrapposto::model::{LARGEST, Model};
use nalgebra::Vector3;

use crate::input_error::InputError;
use crate::scenario::names;
use crate::toml_file::{Located, shown};

/// A table of the file.
pub(super) struct Word<'a> {
    pub(super) at: &'a Located<'a>,
    pub(super) path: Vec<String>,
}

impl<'a> Word<'a> {
    pub(super) fn new(at: &'a Located<'a>, path: &[&str]) -> Self {
        Self { at, path: path.iter().map(|&key| key.to_owned()).collect() }
    }

    pub(super) fn keys<'b>(&'b self, key: &'b str) -> Vec<&'b str> {
        self.path.iter().map(String::as_str).chain([key]).collect()
    }

    pub(super) fn error(&self, key: &str, message: String, help: Option<String>) -> InputError {
        self.at.error(&self.keys(key), message, help)
    }

    /// The segment, which the body must have.
    pub(super) fn segment(&self, model: &Model, key: &str, name: &str) -> Result<usize, InputError> {
        names::segment(self.at, model, &self.keys(key), name)
    }

    /// A number within limits.
    pub(super) fn number(
        &self,
        key: &str,
        value: f64,
        (least, most): (f64, f64),
        unit: &str,
    ) -> Result<f64, InputError> {
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let help = centimetres(value, (least, most), unit);
        let message = format!("{key} is {} {unit}; it must lie in {least}..{most} {unit}", shown(value));
        Err(self.error(key, message, help))
    }

    /// Lengths of a thing, m.
    pub(super) fn size(&self, size: [f64; 3]) -> Result<[f64; 3], InputError> {
        const LENGTHS: (f64, f64) = (0.001, 20.0);
        size.iter().try_for_each(|length| self.number("size_m", *length, LENGTHS, "m").map(|_| ()))?;
        Ok(size)
    }

    /// A place, ground, m.
    pub(super) fn place(&self, place: [f64; 3]) -> Result<Vector3<f64>, InputError> {
        place.iter().try_for_each(|x| self.number("at_m", *x, (-LARGEST, LARGEST), "m").map(|_| ()))?;
        Ok(place.into())
    }
}

/// A question whether centimetres were written for metres.
fn centimetres(value: f64, (least, most): (f64, f64), unit: &str) -> Option<String> {
    let metres = value / 100.0;
    let fits = unit == "m" && value > most && (least..=most).contains(&metres);
    fits.then(|| format!("{} m? lengths are in metres", shown(metres)))
}
