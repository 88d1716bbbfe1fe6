//! Reads analog channels of a C3D file in their units.

use super::LABELS_OF_ONE;
use super::layout::Layout;
use super::parameters::Parameters;
use super::refusal::C3dError;

/// Scales, offsets and units of all channels: a value is `(sample - offset) scale gain`.
pub(super) struct Analog {
    /// Number of channels.
    pub(super) channels: usize,
    /// Samples of a channel in a frame.
    pub(super) per_frame: usize,
    scales: Vec<f64>,
    offsets: Vec<f64>,
    units: Vec<String>,
    gain: f64,
    unsigned: bool,
}

impl Analog {
    pub(super) fn new(parameters: &Parameters<'_>, layout: &Layout) -> Self {
        let (channels, per_frame) = layout.analog;
        let format = parameters.texts("ANALOG:FORMAT", 1).and_then(|texts| texts.into_iter().next());
        let unsigned = format.is_some_and(|format| format.eq_ignore_ascii_case("UNSIGNED"));
        let lists = |name: &str, signed: bool| -> Vec<f64> {
            of_parts(channels, name, |part, most| parameters.list(part, signed, most))
        };
        Self {
            channels,
            per_frame,
            scales: lists("ANALOG:SCALE", true),
            offsets: lists("ANALOG:OFFSET", !unsigned),
            units: of_parts(channels, "ANALOG:UNITS", |part, most| parameters.texts(part, most)),
            gain: parameters.number("ANALOG:GEN_SCALE").unwrap_or(1.0),
            unsigned,
        }
    }

    /// The value of a channel in a sample of a frame.
    ///
    /// # Errors
    /// The number that is no value.
    pub(super) fn value(&self, layout: &Layout, frame: &[u8], at: (usize, usize)) -> Result<f64, f64> {
        let raw = layout.sample(frame, at, self.unsigned).unwrap_or(f64::NAN);
        let of = |list: &[f64], usual: f64| list.get(at.0).copied().unwrap_or(usual);
        let value = (raw - of(&self.offsets, 0.0)) * of(&self.scales, 1.0) * self.gain;
        if value.abs() <= contrapposto::model::LARGEST { Ok(value) } else { Err(value) }
    }

    /// The unit of a channel, in small letters without blanks and signs: `n`, `nmm`.
    pub(super) fn unit(&self, channel: usize) -> String {
        let unit = self.units.get(channel).map_or("", String::as_str);
        unit.chars().filter(|c| c.is_ascii_alphabetic()).collect::<String>().to_ascii_lowercase()
    }
}

/// The values of `SCALE`, `SCALE2`, ..., one for each channel at most. `read` gives so many of a part at most.
fn of_parts<T>(channels: usize, name: &str, read: impl Fn(&str, usize) -> Option<Vec<T>>) -> Vec<T> {
    let mut all = vec![];
    for part in 1..=channels.div_ceil(LABELS_OF_ONE) {
        let part = if part == 1 { name.to_owned() } else { format!("{name}{part}") };
        all.extend(read(&part, channels - all.len()).unwrap_or_default());
    }
    all
}

/// The refusal of a value.
pub(super) fn no_value(layout: &Layout, (frame, channel): (usize, usize), value: f64) -> C3dError {
    let message = format!("analog channel {} in frame {}: {value} is no value", channel + 1, layout.first + frame + 1);
    C3dError::at(layout.start + frame * layout.frame, message, "a finite number of at most 1e9 in size is accepted")
}
