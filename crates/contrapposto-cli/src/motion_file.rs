//! POSTURES and MOTION on the command line, and the loads that act on the body in them.

use std::path::Path;

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto_formats::loads::{self, GroundReaction, GroundReactionError};
use contrapposto_formats::motion::{self, Units, postures, read_table};
use contrapposto_formats::tissue::SourcedModel;

use crate::args::LoadArgs;
use crate::fail::Fail;
use crate::input::read;

/// Held weights and forces, and ground reactions if there are any.
pub(crate) fn loads_of(
    args: &LoadArgs,
    model: &Model,
    notes: &mut Vec<String>,
) -> Result<(Vec<Load>, Option<GroundReaction>), Fail> {
    let mut loads = vec![];
    for text in &args.load {
        loads.push(loads::weight(model, text).map_err(|error| Fail::Refused(format!("--load \"{text}\": {error}")))?);
    }
    for text in &args.force {
        loads.push(loads::force(model, text).map_err(|error| Fail::Refused(format!("--force \"{text}\": {error}")))?);
    }
    let ground = args.grf.as_deref().map(|path| ground_reaction(path, &args.grf_on, model, notes)).transpose()?;
    Ok((loads, ground))
}

/// The table of --grf; notes say on which segments its plates are taken to act.
fn ground_reaction(path: &Path, on: &[String], model: &Model, notes: &mut Vec<String>) -> Result<GroundReaction, Fail> {
    let name = path.display().to_string();
    let bytes = read(path, motion::MOST_TABLE_BYTES as u64)?;
    let ground = GroundReaction::read(&name, &bytes, on, model).map_err(|error| match error {
        GroundReactionError::Table(error) => Fail::from(error),
        GroundReactionError::Count { .. } => Fail::Refused(format!("--grf-on {error}")),
        GroundReactionError::Segment(_) => Fail::Refused(format!("--grf-on: {error}")),
        GroundReactionError::Unknown { .. } => Fail::Refused(format!("{error} with --grf-on SEG,SEG")),
        error => Fail::Refused(error.to_string()),
    })?;
    for (label, segment) in ground.guessed() {
        notes.push(format!("`{label}` of {name} is taken to act on `{segment}`; --grf-on says otherwise"));
    }
    Ok(ground)
}

/// The postures of a table, with their times. `accepted`: the sentence that names the accepted files.
pub(crate) fn read_motion(
    path: &Path,
    accepted: &str,
    args: &LoadArgs,
    model: &Model,
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Posture)>, Fail> {
    let name = path.display().to_string();
    let bytes = read(path, motion::MOST_TABLE_BYTES as u64).map_err(|fail| match fail {
        Fail::Refused(why) => Fail::Refused(format!("{why}\n  {accepted}")),
        other => other,
    })?;
    let table = read_table(&name, &bytes)?;
    let units = match (args.degrees, args.radians) {
        (true, _) => Units::Degrees,
        (_, true) => Units::Radians,
        _ => Units::FromFile,
    };
    let read = postures(&table, &name, &bytes, model, units)?;
    for (names, what) in [
        (&read.missing, "coordinates have no column and stay at their default"),
        (&read.unknown, "columns are no coordinate of the model and are ignored"),
    ] {
        if !names.is_empty() {
            notes.push(format!("{name}: {} {what}: {}", names.len(), first_of(names)));
        }
    }
    if read.postures.is_empty() {
        return Err(Fail::Refused(format!("{name}: holds no rows")));
    }
    Ok(read.postures)
}

fn first_of(names: &[String]) -> String {
    let more = if names.len() > 12 { ", ..." } else { "" };
    format!("{}{more}", names.iter().take(12).map(String::as_str).collect::<Vec<_>>().join(", "))
}

/// Notes the coordinates that leave their range, and those that leave the range of their built-in curve.
pub(crate) fn note_values_out_of_range(opened: &SourcedModel, frames: &[(f64, Posture)], notes: &mut Vec<String>) {
    /// Beyond a limit without a word, rad or m.
    const SLACK: f64 = 1e-3;
    let model = &opened.model;
    let ranges = opened.passive_ranges();
    let (mut beyond, mut held) = (vec![], vec![]);
    for (index, coordinate) in model.coordinates().iter().enumerate() {
        let (min, max) = coordinate.range;
        if coordinate.kind == CoordinateKind::Quaternion || model.is_dependent(index) {
            continue;
        }
        let any = |test: &dyn Fn(f64) -> bool| frames.iter().any(|(_, posture)| test(posture.values()[index]));
        if any(&|value| value < min - SLACK || value > max + SLACK) {
            beyond.push(format!("`{}`", coordinate.name));
        }
        if ranges[index].is_some_and(|(min, max)| any(&|value| value < min - SLACK || value > max + SLACK)) {
            held.push(format!("`{}`", coordinate.name));
        }
    }
    for (names, what) in [
        (beyond, "outside their range in some frame"),
        (held, "outside the range of their built-in curve in some frame, passive torque held at its limit"),
    ] {
        if !names.is_empty() {
            notes.push(format!("{what}: {}", first_of(&names)));
        }
    }
}
