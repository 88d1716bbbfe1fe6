//! Decisions of a run in plain words.

use contrapposto::hybrid::{Decision, Outcome, goal_in_words};
use contrapposto::model::Model;

use super::excerpt::{Event, EventKind};
use super::frame::Frame;
use super::muscles::tired;
use super::words::{how_long, percent, plain, sentence, value};

/// A decision in plain words that stands for all of its kind: those of one joint and one sentence.
pub(crate) fn merged(model: &Model, events: &[(&Event, &Frame)]) -> Option<String> {
    let (&(first, frame), &(last, _)) = events.first().zip(events.last())?;
    let text = decision(model, first, frame);
    if events.len() == 1 {
        return Some(text);
    }
    let goals = events.iter().filter_map(|(event, _)| match &event.kind {
        EventKind::Decided(decision) => decision.goal,
        _ => None,
    });
    let (low, high) =
        goals.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), goal| (low.min(goal), high.max(goal)));
    let [from, to] = [low, high].map(|goal| value(model, first.coordinate, goal));
    let goals = if low < high && from != to { format!(", to goals from {from} to {to}") } else { String::new() };
    Some(format!("{text} ({} times until {}{goals})", events.len(), how_long(last.time)))
}

/// Whether two events have one sentence pattern.
pub(crate) fn alike(a: &Event, b: &Event) -> bool {
    let stays = |decision: &Decision| matches!(decision.outcome, Outcome::Stay | Outcome::None);
    a.coordinate == b.coordinate
        && match (&a.kind, &b.kind) {
            (EventKind::Decided(a), EventKind::Decided(b)) => stays(a) == stays(b),
            (EventKind::Waits, EventKind::Waits) | (EventKind::Recovered, EventKind::Recovered) => true,
            _ => false,
        }
}

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
            format!("{name}: {tired}. {answer}")
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
