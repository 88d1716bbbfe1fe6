//! Figures and names that the pages of postures share.

use contrapposto::model::Model;
use contrapposto_report::{Figure, Report};

use crate::view::frame::Frame;
use crate::view::muscles::{fails_first, hardest};
use crate::view::scene::Scene;
use crate::view::words::{how_long, percent, sentence};

/// Names of what carries the body.
pub(super) fn carriers(scene: &Scene<'_>) -> Vec<String> {
    scene.names_of_supports()
}

/// `right foot 85 %, left foot 15 %`.
pub(super) fn weight(frame: &Frame, supports: &[String]) -> String {
    let shares = frame.shares().into_iter().zip(supports).map(|(share, name)| format!("{name} {}", percent(share)));
    shares.collect::<Vec<_>>().join(", ")
}

pub(super) fn figure(label: &str, value: String, note: &str) -> Figure {
    Figure { label: label.to_owned(), value, note: note.to_owned() }
}

/// Shares of the supports, the highest load, and the endurance.
pub(super) fn figures_of(model: &Model, frame: &Frame, supports: &[String], report: &mut Report) {
    for (share, name) in frame.shares().into_iter().zip(supports).take(4) {
        report.figures.push(figure(&format!("Weight on {name}"), percent(share), "of body and load"));
    }
    if let Some((name, load)) = hardest(model, frame).filter(|(_, load)| *load > 0.0) {
        report.figures.push(figure("Highest load", percent(load), &sentence(&name)));
    }
    if let Some((name, time)) = fails_first(model, frame) {
        report.figures.push(figure("Endurance", how_long(time), &format!("then {name} fails")));
    }
}
