//! Decisions of a run in plain words.

use contrapposto::hybrid::{Carrier, Decision, Equilibrium, Outcome};
use contrapposto::model::Model;

use super::film::{Event, What};
use super::frame::Frame;
use super::muscles::tired;
use super::words::{percent, plain, sentence, value};

/// What was decided, and about what.
pub(crate) fn decision(model: &Model, event: &Event, frame: &Frame) -> String {
    let i = event.coordinate;
    let name = sentence(&plain(&model.coordinates()[i].name));
    let tired = match tired(model, i, frame) {
        Some((group, fatigue)) => format!("muscles of {group} are at {} fatigue", percent(fatigue)),
        None => "it asks for relief".to_owned(),
    };
    match &event.what {
        What::Decided(decision) => {
            let from = value(model, i, frame.posture[i]);
            let goal = decision.goal.map(|goal| value(model, i, goal)).unwrap_or_default();
            let answer = sentence(&answer(decision, &from, &goal));
            format!("{name}: {tired}. {answer} (case {})", decision.case)
        }
        What::Waits => {
            format!(
                "{name}: {tired}, but something more important holds it, or relief cost more than it gave: it waits."
            )
        }
        What::Recovered => format!("{name}: its muscles are rested; it needs no relief any more."),
    }
}

/// Where relief lies, as the second half of a sentence about a joint.
pub(crate) fn answer(decision: &Decision, from: &str, goal: &str) -> String {
    let go = if from == goal { format!("it stays at {from}") } else { format!("it goes from {from} to {goal}") };
    match (decision.outcome, decision.equilibrium) {
        (Outcome::Stay, _) => format!("it stays at {from}: muscles hold next to nothing there."),
        (Outcome::None, _) => format!("it stays at {from}: the printed tables find no goal."),
        (Outcome::AtLimit, _) => format!("{go}, the end of its range, where least is left for muscles."),
        (Outcome::Active, None) => format!("{go}, where muscles work well and hold least."),
        (Outcome::Active, Some(_)) => format!("{go}, where it balances in the middle of its range."),
        (Outcome::Passive, Some(Equilibrium::Stable(Carrier::Gravity))) => {
            format!("{go}, where it hangs by its own weight.")
        }
        (Outcome::Passive, _) => format!("{go}, where ligaments carry it."),
    }
}
