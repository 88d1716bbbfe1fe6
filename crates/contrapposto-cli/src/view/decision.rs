//! Decisions of a run in plain words.

use contrapposto::hybrid::{Decision, Outcome, goal_in_words};
use contrapposto::model::Model;

use super::excerpt::{Event, EventKind};
use super::frame::Frame;
use super::muscles::tired;
use super::words::{percent, plain, sentence, value};

/// An event of a run in one or two sentences.
pub(crate) fn decision(model: &Model, event: &Event, frame: &Frame) -> String {
    let i = event.coordinate;
    let name = sentence(&plain(&model.coordinates()[i].name));
    let tired = match tired(model, i, frame) {
        Some((group, fatigue)) => format!("muscles of {group} are at {} fatigue", percent(fatigue)),
        None => "it needs relief".to_owned(),
    };
    match &event.kind {
        EventKind::Decided(decision) => {
            let from = value(model, i, frame.angles[i]);
            let goal = decision.goal.map(|goal| value(model, i, goal)).unwrap_or_default();
            let answer = sentence(&answer(decision, &from, &goal));
            format!("{name}: {tired}. {answer} (case {})", decision.case)
        }
        EventKind::Waits => {
            format!(
                "{name}: {tired}; supports, tasks or a more tired group prevent its relief, or its relief cost more than it gained: it waits."
            )
        }
        EventKind::Recovered => format!("{name}: its muscles are rested; it needs no more relief."),
    }
}

/// The answer of a decision, as the second half of a sentence about a joint.
pub(crate) fn answer(decision: &Decision, from: &str, goal: &str) -> String {
    let stays = matches!(decision.outcome, Outcome::Stay | Outcome::None) || from == goal;
    let go = if stays { format!("it stays at {from}") } else { format!("it goes from {from} to {goal}") };
    format!("{go}, {}.", goal_in_words(decision))
}
