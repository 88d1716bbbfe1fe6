//! Finds where the points of a C3D file lie, and what their numbers mean.

use contrapposto::model::LARGEST;
use nalgebra::Vector3;

use super::numbers::Processor;
use super::parameters::{BLOCK, Parameters};
use super::refusal::C3dError;
use crate::markers::trc::MarkerUnit;
use crate::motion::MOST_COLUMNS;

/// Numbers of a point: three places, and its residual.
const OF_POINT: usize = 4;
/// Greatest number of a frame in the header; longer trials have parameters.
const LAST_OF_HEADER: usize = u16::MAX as usize;
/// Least and greatest number of frames a second (assumed: a frame in a thousand seconds, and above all cameras).
const RATES: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// Most analog samples of a frame: thousands of channels at a thousand samples each (assumed).
const MOST_SAMPLES: usize = 10_000_000;
/// Layout of the frames.
pub(super) struct Layout {
    processor: Processor,
    pub(super) points: usize,
    /// Number of the first frame, from 0.
    pub(super) first: usize,
    /// Frames that the file says to have.
    pub(super) frames: usize,
    /// Frames a second.
    pub(super) rate: f64,
    /// Units of an integer; `None` for reals.
    scale: Option<f64>,
    /// Length of a unit, m.
    metres: f64,
    /// Place of the first frame in the file.
    pub(super) start: usize,
    /// Bytes of a frame: points, and analog samples.
    pub(super) frame: usize,
    /// Analog channels, and samples of each in a frame.
    pub(super) analog: (usize, usize),
}

/// Bytes of the header at which its entries begin: points, analog samples of a frame, first and last frame, scale, block of the first frame,
/// analog samples of a channel in a frame, rate.
mod entry {
    pub(super) const POINTS: usize = 2;
    pub(super) const SAMPLES: usize = 4;
    pub(super) const FIRST: usize = 6;
    pub(super) const LAST: usize = 8;
    pub(super) const SCALE: usize = 12;
    pub(super) const START: usize = 16;
    pub(super) const PER_CHANNEL: usize = 18;
    pub(super) const RATE: usize = 20;
}

impl Layout {
    /// The layout by the header of a file of `length` bytes, and by the parameters where they say more.
    pub(super) fn new(
        (header, length): (&[u8; BLOCK], usize),
        parameters: &Parameters<'_>,
        unit: MarkerUnit,
        warnings: &mut Vec<String>,
    ) -> Result<Self, C3dError> {
        let processor = parameters.processor;
        let word = |at: usize| usize::from(processor.word([header[at], header[at + 1]]));
        let float = |at: usize| processor.float([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        let points = word(entry::POINTS);
        if 3 * points > MOST_COLUMNS {
            let (message, most) = (format!("the file has {points} points a frame"), MOST_COLUMNS / 3);
            return Err(C3dError::at(entry::POINTS, message, format!("{most} at most are accepted")));
        }
        if let Some(used) = parameters.number("POINT:USED").filter(|used| *used != points as f64) {
            warnings.push(format!("the header says {points} points a frame, POINT:USED {used}; the header's are read"));
        }
        let (at, rate) = first_of(parameters, "POINT:RATE", (entry::RATE, float(entry::RATE)));
        if !RATES.contains(&rate) {
            let accepted = format!("{:?} to {:?} are accepted", RATES.start(), RATES.end());
            return Err(C3dError::at(at, format!("the rate is {rate} frames a second"), accepted));
        }
        let (at, scale) = first_of(parameters, "POINT:SCALE", (entry::SCALE, float(entry::SCALE)));
        if !(scale.abs() > 0.0 && scale.abs() <= LARGEST) {
            let accepted = "a negative number for reals, that of an integer's unit otherwise, is accepted";
            return Err(C3dError::at(at, format!("the scale of its points is {scale}"), accepted));
        }
        let block = word(entry::START);
        if block < 2 {
            let message = format!("its frames begin in block {block}");
            return Err(C3dError::at(entry::START, message, "a block after the header is accepted"));
        }
        let (first, frames) = frames(parameters, (word(entry::FIRST), word(entry::LAST)));
        let scale = Some(scale).filter(|scale| *scale > 0.0);
        let size = if scale.is_none() { 4 } else { 2 };
        let (metres, start) = (unit.metres(), (block - 1) * BLOCK);
        let of_frame = |samples: usize| size * (OF_POINT * points + samples);
        // Frames fill the file up to the end of a block.
        let fits = |samples: usize| {
            let end = start.saturating_add(frames.saturating_mul(of_frame(samples)));
            (end..end.saturating_add(BLOCK)).contains(&length)
        };
        let samples = samples(parameters, (word(entry::SAMPLES), word(entry::PER_CHANNEL)), &fits, warnings);
        let frame = of_frame(samples);
        let per_channel = word(entry::PER_CHANNEL).max(1);
        let analog = (samples / per_channel, per_channel);
        Ok(Self { processor, points, first, frames, rate, scale, metres, start, frame, analog })
    }

    /// Bytes of a point.
    pub(super) fn point(&self) -> usize {
        OF_POINT * if self.scale.is_none() { 4 } else { 2 }
    }

    /// Length of a unit of places, m.
    pub(super) fn unit(&self) -> f64 {
        self.metres
    }

    /// The analog sample of a channel in a frame, as it stands there; integers without a sign where `unsigned` is true.
    pub(super) fn sample(&self, frame: &[u8], (channel, sample): (usize, usize), unsigned: bool) -> Option<f64> {
        let place = self.points * self.point() + (sample * self.analog.0 + channel) * (self.point() / OF_POINT);
        match (self.scale, frame.get(place..)?) {
            (None, [a, b, c, d, ..]) => Some(self.processor.float([*a, *b, *c, *d])),
            (Some(_), [a, b, ..]) => {
                let word = self.processor.word([*a, *b]);
                Some(if unsigned { f64::from(word) } else { f64::from(word as i16) })
            }
            _ => None,
        }
    }

    /// A point of a frame in m: three places, then its residual. `None` where it was not seen; the number that is no place otherwise.
    pub(super) fn place(&self, bytes: &[u8]) -> Result<Option<Vector3<f64>>, f64> {
        let number = |i: usize| match self.scale {
            None => self.processor.float([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]]),
            Some(_) => f64::from(self.processor.word([bytes[2 * i], bytes[2 * i + 1]]) as i16),
        };
        let place = Vector3::new(number(0), number(1), number(2));
        // Some programs write NaN for a gap.
        if number(3) < 0.0 || place.iter().any(|value| value.is_nan()) {
            return Ok(None);
        }
        let place = place * self.scale.unwrap_or(1.0) * self.metres;
        match place.iter().find(|value| value.abs() > LARGEST) {
            Some(value) => Err(value / self.metres),
            None => Ok(Some(place)),
        }
    }
}

/// Analog samples of a frame: those of the header, or those of all channels where only their frames fill the file. Some programs write the number of channels.
fn samples(
    parameters: &Parameters<'_>,
    (said, per_channel): (usize, usize),
    fits: &dyn Fn(usize) -> bool,
    warnings: &mut Vec<String>,
) -> usize {
    let channels = parameters.number("ANALOG:USED").map_or(0, |channels| channels as usize);
    let used = channels.saturating_mul(per_channel);
    // A file that was cut off must not be taken for one with fewer samples.
    let counts_channels = said == channels && used > said && used <= MOST_SAMPLES;
    if fits(said) || !counts_channels || !fits(used) {
        return said;
    }
    warnings.push(format!(
        "the header says {said} analog samples a frame, ANALOG:USED and the size of the file {used}, which are passed over"
    ));
    used
}

/// The place of a number and its value: a parameter's, or the header's where it is missing or 0.
fn first_of(parameters: &Parameters<'_>, name: &str, header: (usize, f64)) -> (usize, f64) {
    let value = parameters.number(name).filter(|value| *value != 0.0);
    value.map_or(header, |value| (parameters.byte(name), value))
}

/// Number of the first frame, from 0, and the number of frames. The header has 16 bits for each; longer trials have parameters, which count where they agree
/// with the header as far as it goes.
fn frames(parameters: &Parameters<'_>, (first, last): (usize, usize)) -> (usize, usize) {
    let long =
        |name: &str| parameters.numbers(name).map(|[low, high]| low as usize + (LAST_OF_HEADER + 1) * high as usize);
    let agree = |long: usize, header: usize| [long & LAST_OF_HEADER, long.min(LAST_OF_HEADER)].contains(&header);
    let trial = long("TRIAL:ACTUAL_START_FIELD").zip(long("TRIAL:ACTUAL_END_FIELD"));
    let trial = trial.filter(|(start, end)| (1..=*end).contains(start) && agree(*start, first) && agree(*end, last));
    if let Some((start, end)) = trial {
        return (start - 1, end - start + 1);
    }
    let count = |name: &str| parameters.number(name).map_or(0, |count| count as usize);
    let said = count("POINT:FRAMES");
    match (first, last) {
        // Some programs count from 0.
        (0, last) if said == last => (0, last),
        (0, last) => (0, last + 1),
        (first, LAST_OF_HEADER) => {
            let of_header = LAST_OF_HEADER + 1 - first;
            (first - 1, of_header.max(said).max(count("POINT:LONG_FRAMES")))
        }
        (first, last) => (first - 1, (last + 1).saturating_sub(first)),
    }
}
