//! Names joints that ligaments carry where that is a hazard: a flexed lumbar spine, a spine at the end of its measured range, a
//! hyperextended knee. The angles and their sources are in `data/hazards.toml` of the science crate.

use contrapposto::model::data::{HazardRow, library};
use contrapposto::model::{Coordinate, Model};
use contrapposto::simulation::{CoordinateSummary, Summary};
use contrapposto_report::Report;

use crate::view::frame::{Frame, carried};
use crate::view::words::{how_long, list, percent, plain, value};

/// The hazard that a coordinate is in.
pub(crate) fn hazard(model: &Model, frame: &Frame, i: usize) -> Option<&'static HazardRow> {
    hazard_at(&model.coordinates()[i], frame.angles[i], frame.carried(i)?)
}

/// The hazard of a coordinate at an angle where passive tissue carries this share of the external torque.
fn hazard_at(coordinate: &Coordinate, angle: f64, carried: f64) -> Option<&'static HazardRow> {
    library().hazards().iter().find(|row| row.applies(coordinate, angle, carried))
}

/// `lumbar extension at −60.0° (74 % of 165 N m)`.
fn loaded(model: &Model, i: usize, angle: f64, share: f64, external: f64) -> String {
    let name = plain(&model.coordinates()[i].name);
    format!("{name} at {} ({} of {:.0} N m)", value(model, i, angle), percent(share), external.abs())
}

/// A sentence for each kind of hazard in the frames, about the coordinates where they are loaded most. `lasts`: the frames follow
/// each other in time.
pub(crate) fn hazards(model: &Model, frames: &[Frame], lasts: bool) -> Vec<String> {
    let mut sentences = vec![];
    for row in library().hazards() {
        let is_in = |frame: &Frame, i: usize| hazard(model, frame, i).is_some_and(|found| std::ptr::eq(found, row));
        let mut joints: Vec<String> = vec![];
        let mut longest: f64 = 0.0;
        for i in 0..model.coordinates().len() {
            let worst = frames.iter().filter(|frame| is_in(frame, i));
            let Some(worst) = worst.max_by(|a, b| a.passive[i].abs().total_cmp(&b.passive[i].abs())) else { continue };
            let share = worst.carried(i).unwrap_or_default();
            joints.push(loaded(model, i, worst.angles[i], share, worst.external[i]));
            let spans = frames.windows(2).filter(|pair| is_in(&pair[0], i)).map(|pair| pair[1].time - pair[0].time);
            longest = longest.max(spans.sum());
        }
        if joints.is_empty() {
            continue;
        }
        let long = if lasts && longest > 0.0 { format!(" for {}", how_long(longest)) } else { String::new() };
        let too_long = if row.seconds().is_some_and(|limit| lasts && longest > limit) {
            "; that is longer than the study allowed"
        } else {
            ""
        };
        let joints = list(&joints);
        sentences.push(format!("Hazard: ligaments hold {joints}{long}; {}{too_long}.", row.finding));
    }
    sentences
}

/// A sentence for each kind of hazard in which a run ends, by the coordinates of its last posture.
pub(crate) fn hazards_at_end(model: &Model, summary: &Summary) -> Vec<String> {
    let mut sentences = vec![];
    for row in library().hazards() {
        let joint = |(i, (coordinate, end)): (usize, (&Coordinate, &CoordinateSummary))| {
            let [external, passive, _] = end.final_torques;
            let share = carried(external, passive)?;
            let found = hazard_at(coordinate, end.final_value, share)?;
            std::ptr::eq(found, row).then(|| loaded(model, i, end.final_value, share, external))
        };
        let joints: Vec<String> =
            model.coordinates().iter().zip(&summary.coordinates).enumerate().filter_map(joint).collect();
        if !joints.is_empty() {
            sentences.push(format!("Hazard: at the end ligaments hold {}; {}.", list(&joints), row.finding));
        }
    }
    sentences
}

/// Puts the sentences behind the first reason of a page.
pub(crate) fn tell(report: &mut Report, sentences: Vec<String>) {
    let place = report.reasons.len().min(1);
    report.reasons.splice(place..place, sentences);
}
