//! Reads finite numbers from text, with the place in every error.

use crate::xml::{Place, shorten};

/// The reason for which a text does not hold the numbers that are needed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NumberError {
    /// Not a number at all.
    #[error("{place}: `{value}` is not a number")]
    NotANumber {
        /// Place in the file.
        place: Place,
        /// As written, shortened.
        value: String,
    },
    /// NaN, infinite, or too large for a double.
    #[error("{place}: `{value}` is not a finite number")]
    NotFinite {
        /// Place in the file.
        place: Place,
        /// As written, shortened.
        value: String,
    },
    /// Too many or too few.
    #[error("{place}: {found} numbers; {} accepted", between(*least, *most))]
    Count {
        /// Place in the file.
        place: Place,
        /// Number of numbers found; one more than `most` if there are more.
        found: usize,
        /// Fewest accepted.
        least: usize,
        /// Most accepted.
        most: usize,
    },
}

fn between(least: usize, most: usize) -> String {
    if least == most { format!("exactly {least}") } else { format!("{least} to {most}") }
}

/// Reads one word as a finite number.
///
/// # Errors
/// [`NumberError`] with the place that `place` makes.
pub(crate) fn number(text: &str, place: impl Fn() -> Place) -> Result<f64, NumberError> {
    let mut values = [0.0];
    fixed(text, &mut values, place)?;
    Ok(values[0])
}

/// Reads exactly as many finite numbers as `values` has room for, separated by white space.
///
/// # Errors
/// [`NumberError`] with the place that `place` makes.
pub(crate) fn fixed(text: &str, values: &mut [f64], place: impl Fn() -> Place) -> Result<(), NumberError> {
    let read = list(text, values.len()..=values.len(), place)?;
    values.copy_from_slice(&read);
    Ok(())
}

/// Reads a list of finite numbers separated by white space, as many as `count` allows.
///
/// # Errors
/// [`NumberError`] with the place that `place` makes.
pub(crate) fn list(
    text: &str,
    count: std::ops::RangeInclusive<usize>,
    place: impl Fn() -> Place,
) -> Result<Vec<f64>, NumberError> {
    let (least, most) = (*count.start(), *count.end());
    let mut values = Vec::new();
    for word in text.split_ascii_whitespace() {
        if values.len() == most {
            return Err(NumberError::Count { place: place(), found: most + 1, least, most });
        }
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => values.push(value),
            Ok(_) => return Err(NumberError::NotFinite { place: place(), value: shorten(word) }),
            Err(_) => return Err(NumberError::NotANumber { place: place(), value: shorten(word) }),
        }
    }
    if values.len() < least {
        return Err(NumberError::Count { place: place(), found: values.len(), least, most });
    }
    Ok(values)
}
