//! Writes `decisions.csv`: every relief of a run, one row each, with a plain sentence.

use std::fmt::Write;

use contrapposto::hybrid::{Outcome, Strategy, goal_in_words};
use contrapposto::model::{Coordinate, CoordinateKind, Model, Side};
use contrapposto::simulation::{Attempt, ReliefLog, ReliefRecord};

use crate::motion::csv_cell;

/// Nearer to its goal than this it has got there, rad or m.
const REACHED: f64 = 0.01;

/// The whole file. Angles in degrees (slides in m), torques in N m (N), time in s.
pub fn decisions_csv(model: &Model, log: &ReliefLog) -> String {
    let mut text =
        "time_s,end_s,coordinate,group,fatigue,strategy,attempt,case,outcome,start_deg,goal_deg,end_deg,active_nm,\
        active_end_nm,predicted_nm,real_nm,steps_done,steps_deferred,steps_taken_back,steps_idle,sentence\n"
            .to_owned();
    for record in &log.records {
        let coordinate = &model.coordinates()[record.coordinate];
        let shown = |x: f64| if coordinate.kind == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let idle = if matches!(record.attempt, Attempt::OtherJoint { .. }) { "other_joint" } else { "idle" };
        let (case, outcome) =
            record.decision.map_or(("", idle), |decision| (decision.case.number(), decision.outcome.word()));
        let goal = record.decision.and_then(|decision| decision.goal).map_or(String::new(), |g| shown(g).to_string());
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{case},{outcome},{},{goal},{},{},{},{},{},{},{},{},{},{}",
            record.time.0,
            record.time.1,
            csv_cell(&coordinate.name),
            csv_cell(group(coordinate, record)),
            record.fatigue,
            strategy(record.strategy),
            csv_cell(&attempt(model, record.attempt)),
            shown(record.value.0),
            shown(record.value.1),
            record.active.0,
            record.active.1,
            record.predicted,
            record.actual,
            record.done,
            record.deferred,
            record.taken_back,
            record.idle,
            csv_cell(&relief_sentence(model, record)),
        );
    }
    text
}

/// One sentence about a relief: the tired group, its goal, and the result.
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
        let (from, to) = (record.active.0, record.active.1);
        return match record.attempt {
            Attempt::OtherJoint { coordinate, direction } => {
                let way = if direction == Side::Positive { "up" } else { "down" };
                let joint = &model.coordinates()[coordinate].name;
                format!(
                    "{tired}, is unloaded by {joint}, which moves {way}: active torque from {from:.1} to {to:.1} {unit}"
                )
            }
            Attempt::GivenUp => format!(
                "{tired}: neither strategy nor another joint lets it rest, or its relief cost more than it gained; it waits"
            ),
            _ => format!("{tired}: supports, tasks or a more tired group prevent its relief; it waits"),
        };
    };
    let goal = decision.goal.unwrap_or(record.value.0);
    let verb = if matches!(decision.outcome, Outcome::Stay | Outcome::None) { "stays at" } else { "goes to" };
    let other = if record.attempt == Attempt::OtherStrategy { ", by the other strategy" } else { "" };
    let answer = format!("{verb} {}, {}{other}", shown(goal), goal_in_words(&decision));
    let (from, to) = (shown(record.value.0), shown(record.value.1));
    let way = if from == to { format!("at {to} throughout") } else { format!("from {from} to {to}") };
    let mut sentence =
        format!("{tired}, {answer}: {way}, active torque from {:.1} to {:.1} {unit}", record.active.0, record.active.1);
    // Beyond its first goal it followed one that moved.
    let left = |goal: f64| (goal - record.value.1) * (goal - record.value.0).signum();
    let short = decision.goal.is_some_and(|goal| left(goal) > REACHED);
    let mut reasons = vec![];
    if record.deferred > 0 {
        reasons.push(format!("supports, tasks or a more tired group prevented it in {} steps", record.deferred));
    }
    if record.taken_back > 0 {
        reasons.push(format!("{} steps increased the load and were reversed", record.taken_back));
    }
    match (short, reasons.is_empty()) {
        (true, true) => sentence.push_str("; the decision changed, or relief ended, before it reached its goal"),
        (true, false) => {
            let _ = write!(sentence, "; it did not reach its goal: {}", reasons.join(", "));
        }
        (false, false) => {
            let _ = write!(sentence, "; {}", reasons.join(", "));
        }
        (false, true) => {}
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

/// The word of `decisions.csv`; with the name of the joint that moves for another one.
fn attempt(model: &Model, attempt: Attempt) -> String {
    match attempt {
        Attempt::Strategy => "strategy".to_owned(),
        Attempt::OtherStrategy => "other_strategy".to_owned(),
        Attempt::OtherJoint { coordinate, .. } => format!("other_joint {}", model.coordinates()[coordinate].name),
        Attempt::GivenUp => "given_up".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use contrapposto::hybrid::{Carrier, Case, Decision, Equilibrium};
    use contrapposto::model::{Adult, adult};
    use contrapposto::passive::SlopeAngles;

    use super::*;

    /// Of a hip that asked for 102 deg from 10 deg and came to `end`, deg.
    fn sentence_of(end: f64, deferred: u64, taken_back: u64) -> String {
        let model = adult(&Adult::default()).unwrap();
        let goal = Some(102f64.to_radians());
        let decision = Decision {
            case: Case::C32,
            outcome: Outcome::Passive,
            goal,
            active_torque: -12.6,
            active_torque_at_goal: goal,
            decrease_ratio: None,
            slope_angles: SlopeAngles { lower: None, upper: None },
            interval: None,
            equilibrium: Some(Equilibrium::Stable(Carrier::Ligaments)),
            beyond_tables: false,
        };
        let record = ReliefRecord {
            coordinate: model.coordinate("hip_flexion_r").unwrap(),
            side: Side::Negative,
            fatigue: 0.6,
            strategy: Strategy::Passive,
            attempt: Attempt::Strategy,
            decision: Some(decision),
            time: (0.0, 4.0),
            value: (10f64.to_radians(), end.to_radians()),
            active: (-12.6, -18.2),
            predicted: -8.5,
            actual: -5.6,
            done: 36,
            deferred,
            taken_back,
            idle: 0,
        };
        relief_sentence(&model, &record)
    }

    #[test]
    fn a_relief_that_fell_short_says_why() {
        let way = |end: &str| {
            format!(
                "hip_flexion_r, hip extension, tired to 0.60, goes to 102.0 deg, a balance, stable by ligaments: from 10.0 deg to {end} deg, active torque from -12.6 to -18.2 N m"
            )
        };
        assert_eq!(sentence_of(102.0, 0, 0), way("102.0"));
        assert_eq!(
            sentence_of(26.0, 0, 0),
            way("26.0") + "; the decision changed, or relief ended, before it reached its goal"
        );
        let stood = "supports, tasks or a more tired group prevented it in 8 steps";
        assert_eq!(sentence_of(26.0, 8, 0), way("26.0") + "; it did not reach its goal: " + stood);
        let worse = "5 steps increased the load and were reversed";
        assert_eq!(sentence_of(26.0, 8, 5), way("26.0") + "; it did not reach its goal: " + stood + ", " + worse);
        // A goal that moves away is followed beyond its first value.
        assert_eq!(sentence_of(110.0, 0, 5), way("110.0") + "; " + worse);
    }

    #[test]
    fn a_relief_by_another_joint_says_which_way_that_moves() {
        let model = adult(&Adult::default()).unwrap();
        let [elbow, arm] = ["elbow_flex_r", "arm_flex_r"].map(|name| model.coordinate(name).unwrap());
        let sentence = |direction: Side| {
            let record = ReliefRecord {
                coordinate: elbow,
                side: Side::Positive,
                fatigue: 0.5,
                strategy: Strategy::Active,
                attempt: Attempt::OtherJoint { coordinate: arm, direction },
                decision: None,
                time: (0.0, 4.0),
                value: (0.1, 0.1),
                active: (12.0, 8.0),
                predicted: 0.0,
                actual: -4.0,
                done: 10,
                deferred: 0,
                taken_back: 0,
                idle: 0,
            };
            relief_sentence(&model, &record)
        };
        let expected = |way: &str| {
            format!(
                "elbow_flex_r, elbow flexion, tired to 0.50, is unloaded by arm_flex_r, which moves {way}: active torque from 12.0 to 8.0 N m"
            )
        };
        assert_eq!(sentence(Side::Positive), expected("up"));
        assert_eq!(sentence(Side::Negative), expected("down"));
    }
}
