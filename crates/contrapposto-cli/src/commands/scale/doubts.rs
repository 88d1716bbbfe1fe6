//! Doubts about the markers of a static trial: another unit than the file says, left and right swapped in their names.

use std::ops::RangeInclusive;

use contrapposto::tracking;
use contrapposto_formats::markers::{Markers, TrackingTasks};
use contrapposto_formats::tissue::SourcedModel;

use crate::commands::track::doubts::{size, swapped_sides};
use crate::commands::track::matching::{Matched, Observed, Source};
use crate::fail::Fail;

/// Refuses markers that are many times larger or smaller than the model: no person is, and a model of their size would be worth nothing.
pub(super) fn refuse_other_unit(
    model: &SourcedModel,
    (markers, name): (&Markers, &str),
    frames: RangeInclusive<usize>,
) -> Result<(), Fail> {
    let Ok(matched) = matched(model, (markers, name), None) else { return Ok(()) };
    let places = [places(markers, &matched, frames)];
    match size(&model.model, &matched, markers.unit, &places) {
        Some(why) => Err(Fail::Refused(format!("{name}: {why}; no model is written"))),
        None => Ok(()),
    }
}

/// The warning about left and right, if the scaled model meets the markers much better with their names swapped.
pub(super) fn sides(
    scaled: &SourcedModel,
    (markers, name): (&Markers, &str),
    tasks: Option<&TrackingTasks>,
    frames: RangeInclusive<usize>,
) -> Option<String> {
    let mut matched = matched(scaled, (markers, name), tasks).ok()?;
    // A marker that tasks do not trust says nothing about sides.
    let trusted: Vec<bool> = matched.goals.markers.iter().map(|marker| marker.weight > 0.0).collect();
    matched.keep(&trusted);
    let observed = places(markers, &matched, frames);
    let model = &scaled.model;
    let start = model.default_posture();
    let tracked = tracking::track(model, matched.goals.clone(), &start, [observed.as_slice()]).ok()?;
    let why = swapped_sides(model, &matched, (&[observed], &tracked))?;
    Some(format!("{name}: {why}; lengths of both sides and placed markers are those of the other side"))
}

fn matched(
    model: &SourcedModel,
    (markers, name): (&Markers, &str),
    tasks: Option<&TrackingTasks>,
) -> Result<Matched, Fail> {
    Matched::new(model, markers, tasks, Source { model: "", markers: name, tasks: "" })
}

/// Mean places of the matched markers, m.
fn places(markers: &Markers, matched: &Matched, frames: RangeInclusive<usize>) -> Observed {
    let mean = |&column: &usize| markers.mean_place(column, frames.clone()).map(|(place, _)| place);
    matched.columns.iter().map(mean).collect()
}
