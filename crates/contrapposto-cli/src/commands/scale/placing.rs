//! Places the markers of a scaled model where they are measured in the static posture.

use contrapposto::kinematics::Kinematics;
use contrapposto::tracking::{self, TrackedFrame};
use contrapposto_formats::markers::{Markers, ScaleSetup};
use contrapposto_formats::osim::scaling;
use nalgebra::Vector3;

use super::files::{frames, opened, refused, time_range};
use crate::args::ScaleArgs;
use crate::commands::track::matching::{Matched, Source, length, listed};
use crate::fail::Fail;
use crate::output::print_note;

/// Movement of a marker from which on a person does not stand still, m: OpenSim's threshold.
const STANDS_STILL: f64 = 0.01;

/// The model with placed markers.
pub(super) struct Placed {
    pub(super) text: String,
    /// The line of the answer.
    pub(super) line: String,
}

pub(super) fn place(
    args: &ScaleArgs,
    setup: &ScaleSetup,
    text: &str,
    (markers, name): (&Markers, &str),
) -> Result<Placed, Fail> {
    let shown = args.model.display().to_string();
    let tasks = setup.placing.as_ref();
    let range = time_range(args, tasks.and_then(|tasks| tasks.time_range));
    let frames = frames(markers, name, range)?;
    let means: Vec<_> = (0..markers.names.len()).map(|m| markers.mean_place(m, frames.clone())).collect();
    let opened = opened(&shown, text)?;
    let tasks_file = args.setup.as_ref().map_or_else(String::new, |path| path.display().to_string());
    let source = Source { model: &shown, markers: name, tasks: &tasks_file };
    let matched = Matched::new(&opened, markers, tasks, source)?;
    matched.warnings.iter().for_each(|warning| print_note("warning", warning));
    tell_movement(markers, name, &means);
    let mean = |column: usize| means[column].map(|(place, _)| place);
    // OpenSim solves the posture by the frames within the range, and places markers by one more on each side of it.
    let within: Vec<usize> = frames.clone().filter(|&i| (range.0..=range.1).contains(&markers.times[i])).collect();
    let posed = match (within.first(), within.last()) {
        (Some(first), Some(last)) => *first..=*last,
        _ => frames.clone(),
    };
    let place = |&column: &usize| markers.mean_place(column, posed.clone()).map(|(place, _)| place);
    let observed: Vec<Option<Vector3<f64>>> = matched.columns.iter().map(place).collect();
    if observed.iter().flatten().next().is_none() {
        return Err(Fail::Refused(format!(
            "{name}: none of the tracked markers has a place at the times that are averaged"
        )));
    }
    let model = &opened.model;
    let tracked = tracking::track(model, matched.goals.clone(), &model.default_posture(), [observed.as_slice()])
        .map_err(refused)?;
    let frame = &tracked[0];
    let mut line = posture_line(frame, &matched);
    let mut body = Kinematics::new(model);
    body.update(model, &frame.posture).map_err(refused)?;
    let new_place = |name: &str| {
        let marker = opened.markers.iter().find(|marker| marker.name == name)?;
        let column = markers.names.iter().position(|known| known == name)?;
        let place = mean(column).filter(|_| setup.moves_markers || args.place_markers)?;
        Some(body.placement(model, marker.segment).inverse_transform_point(&place.into()).coords)
    };
    let keep = |name: &str| markers.names.iter().any(|known| known == name);
    let placed = scaling::with_placed_markers(text, &shown, &new_place, &keep).map_err(refused)?;
    if !placed.removed.is_empty() {
        let names: Vec<&str> = placed.removed.iter().map(String::as_str).collect();
        let said = format!("{} markers that {name} lacks are left out: {}", names.len(), listed(&names));
        print_note("note", &said);
    }
    let far = placed.moved.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((marker, way)) = far {
        let count = placed.moved.len();
        line.push_str(&format!("; {count} markers moved onto measured ones, by up to {} (`{marker}`)", length(*way)));
    }
    line.push_str(".\n");
    Ok(Placed { text: placed.text, line })
}

/// Warns of markers that do not stay.
fn tell_movement(markers: &Markers, name: &str, means: &[Option<(Vector3<f64>, f64)>]) {
    let moving = markers.names.iter().zip(means).filter(|(_, mean)| mean.is_some_and(|(_, way)| way > STANDS_STILL));
    let moving: Vec<&str> = moving.map(|(name, _)| name.as_str()).collect();
    if !moving.is_empty() {
        let (count, names) = (moving.len(), listed(&moving));
        let said = format!("{name}: {count} markers move by more than 10 mm while they are averaged: {names}");
        print_note("warning", &said);
    }
}

/// The beginning of the line about the static posture.
fn posture_line(frame: &TrackedFrame, matched: &Matched) -> String {
    if !frame.solved.converged {
        let said = format!("the static posture is not solved to the end: optimality {:.1e}", frame.solved.optimality);
        print_note("warning", &said);
    }
    let mut line = format!(
        "Static posture: the error of {} markers is {} in the root mean square",
        frame.seen,
        length(frame.root_mean_square())
    );
    if let Some((marker, most)) = frame.largest {
        line.push_str(&format!(", the largest {} (`{}`)", length(most), matched.names[marker]));
    }
    line
}
