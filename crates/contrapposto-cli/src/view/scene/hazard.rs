//! Names joints that ligaments carry where that is a hazard: a flexed lumbar spine, a spine at the end of its measured range, a
//! hyperextended knee. The angles and their sources are in `data/hazards.toml` of the science crate.

use contrapposto::joint_torques::Hazard;
use contrapposto::model::Model;
use contrapposto::model::data::{HazardRow, library};

use crate::view::frame::Frame;
use crate::view::words::{how_long, list};

/// The hazard that a coordinate is in.
pub(crate) fn hazard(model: &Model, frame: &Frame, i: usize) -> Option<&'static HazardRow> {
    Hazard::at(&model.coordinates()[i], frame.angles[i], frame.external[i], frame.passive[i])
}

/// A text for each kind of hazard in the frames, about the coordinates where they are loaded most. `lasts`: the frames follow
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
            let (angle, external, passive) = (worst.angles[i], worst.external[i], worst.passive[i]);
            joints.push(Hazard { coordinate: i, angle, external, passive, row }.in_words(model));
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
        sentences.push(format!("{joints}{long}; {}{too_long}", row.finding));
    }
    sentences
}
