//! Opens scaled models, and finds the frames of a static trial.

use std::ops::RangeInclusive;

use contrapposto_formats::ModelFormat;
use contrapposto_formats::markers::Markers;
use contrapposto_formats::tissue::SourcedModel;

use crate::args::ScaleArgs;
use crate::commands::track::asked;
use crate::fail::Fail;

pub(super) fn refused(error: impl std::fmt::Display) -> Fail {
    Fail::Refused(error.to_string())
}

/// The model of a text.
pub(super) fn opened(name: &str, text: &str) -> Result<SourcedModel, Fail> {
    let none = &mut |_: &str| Err("an OpenSim model includes no files".to_owned());
    let opened = SourcedModel::read(name, text.as_bytes(), None, none).map_err(refused)?;
    if opened.format != ModelFormat::OpenSim {
        return Err(Fail::Refused(format!("{name}: is no OpenSim model; an .osim file of OpenSim 4 is accepted")));
    }
    Ok(opened)
}

/// Times that are averaged, s, as the arguments say, else as a setup file does, else all.
pub(super) fn time_range(args: &ScaleArgs, given: Option<(f64, f64)>) -> (f64, f64) {
    let (from, to) = given.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    (args.from.unwrap_or(from), args.to.unwrap_or(to))
}

/// The frames of a time range that must hold some.
pub(super) fn frames(markers: &Markers, name: &str, (from, to): (f64, f64)) -> Result<RangeInclusive<usize>, Fail> {
    let (first, last) = (markers.times[0], markers.times[markers.times.len() - 1]);
    if from > last || to < first || from > to {
        let asked = asked(Some(from).filter(|time| time.is_finite()), Some(to).filter(|time| time.is_finite()));
        let why =
            format!("no instant lies in the time that is asked for ({asked}); it goes from {first} s to {last} s");
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    Ok(markers.frames_between(from, to))
}
