//! `decisions.csv`: every relief of a run, one row each, with a plain sentence.

use std::fmt::Write;

use contrapposto::hybrid::{Carrier, Equilibrium, Outcome, Strategy};
use contrapposto::model::{Coordinate, CoordinateKind, Model};
use contrapposto::simulation::{ReliefLog, ReliefRecord};

/// The whole file. Angles in degrees (slides in m), torques in N m (N), time in s.
pub fn decisions_csv(model: &Model, log: &ReliefLog) -> String {
    let mut text = "time_s,end_s,coordinate,group,fatigue,strategy,case,outcome,start_deg,goal_deg,end_deg,active_nm,\
        active_end_nm,predicted_nm,real_nm,steps_done,steps_deferred,steps_taken_back,steps_idle,sentence\n"
        .to_owned();
    for record in &log.records {
        let coordinate = &model.coordinates()[record.coordinate];
        let shown = |x: f64| if coordinate.kind == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let (case, outcome) =
            record.decision.map_or(("", "idle"), |decision| (decision.case.number(), decision.outcome.word()));
        let goal = record.decision.and_then(|decision| decision.goal).map_or(String::new(), |g| shown(g).to_string());
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{case},{outcome},{},{goal},{},{},{},{},{},{},{},{},{},{}",
            record.time.0,
            record.time.1,
            quoted(&coordinate.name),
            quoted(group(coordinate, record)),
            record.fatigue,
            strategy(record.strategy),
            shown(record.value.0),
            shown(record.value.1),
            record.active.0,
            record.active.1,
            record.predicted,
            record.real,
            record.done,
            record.deferred,
            record.taken_back,
            record.idle,
            quoted(&relief_sentence(model, record)),
        );
    }
    text
}

/// What happened, for people: who asked, for what, and what came of it.
pub fn relief_sentence(model: &Model, record: &ReliefRecord) -> String {
    let coordinate = &model.coordinates()[record.coordinate];
    let shown = |x: f64| match coordinate.kind {
        CoordinateKind::Rotation => format!("{:.1} deg", x.to_degrees()),
        CoordinateKind::Translation => format!("{x:.3} m"),
        CoordinateKind::Quaternion => format!("{x:.3}"),
    };
    let unit = if coordinate.kind == CoordinateKind::Translation { "N" } else { "N m" };
    let tired = format!("{}, {}, tired to {:.2}", coordinate.name, group(coordinate, record), record.fatigue);
    let Some(decision) = record.decision else {
        return format!(
            "{tired}: nothing more important lets it move, or what it tried cost more than it gave; it waits"
        );
    };
    let goal = decision.goal.unwrap_or(record.value.0);
    let kind = match decision.equilibrium {
        Some(Equilibrium::Stable(Carrier::Ligaments)) => ", where ligaments hold it",
        Some(Equilibrium::Stable(Carrier::Gravity)) => ", where the load keeps it like a pendulum",
        Some(Equilibrium::Unstable) => ", a balance held by attention",
        None => "",
    };
    let wish = match decision.outcome {
        Outcome::Stay => format!("stays at {}", shown(goal)),
        Outcome::Active => format!("goes to where muscles work well, {}{kind}", shown(goal)),
        Outcome::Passive => format!("goes to a rest at {}{kind}", shown(goal)),
        Outcome::AtLimit => format!("goes to the end of its range, {}, where least is left to hold", shown(goal)),
        Outcome::None => "finds no answer in the printed tables".to_owned(),
    };
    let mut sentence = format!(
        "{tired}, {wish}: from {} to {}, active torque from {:.1} to {:.1} {unit}",
        shown(record.value.0),
        shown(record.value.1),
        record.active.0,
        record.active.1
    );
    if record.deferred > 0 {
        let _ = write!(sentence, "; something more important stood against it in {} steps", record.deferred);
    }
    if record.taken_back > 0 {
        let _ = write!(sentence, "; {} steps made things worse and were taken back", record.taken_back);
    }
    sentence
}

fn group<'a>(coordinate: &'a Coordinate, record: &ReliefRecord) -> &'a str {
    let side = record.side.index();
    coordinate.groups.as_ref().map_or(["positive", "negative"][side], |groups| &groups[side].name)
}

fn strategy(strategy: Strategy) -> &'static str {
    match strategy {
        Strategy::Active => "active",
        Strategy::Passive => "passive",
    }
}

/// A text as one field of the table.
fn quoted(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    if plain.contains([',', '"']) { format!("\"{}\"", plain.replace('"', "\"\"")) } else { plain }
}
