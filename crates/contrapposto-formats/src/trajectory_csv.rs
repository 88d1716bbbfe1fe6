//! Writes the table of a run: one row an instant, columns as in docs/scenario.md.

use std::fmt::Write;

use contrapposto::hybrid::Case;
use contrapposto::joint_torques::active_torque;
use contrapposto::model::{CoordinateKind, Model};

use crate::motion::plain;

/// The numbers of a row, one entry a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct TableRow<'a> {
    /// Time, s.
    pub time: f64,
    /// Value of every coordinate, rad or m.
    pub posture: &'a [f64],
    /// External torque, N m.
    pub external: &'a [f64],
    /// Passive torque, N m.
    pub passive: &'a [f64],
    /// Fatigue of the positive and negative group, 0 to 1.
    pub fatigue: &'a [[f64; 2]],
    /// Case and goal of those that asked for relief.
    pub asked: &'a [Option<(Case, Option<f64>)>],
}

/// Header line, without line end: `time`, then `COORDINATE.angle_deg` and so on.
pub fn csv_header(model: &Model) -> String {
    let mut line = "time".to_owned();
    for coordinate in model.coordinates() {
        let name = plain(&coordinate.name, true);
        let (value, unit) = match coordinate.kind {
            CoordinateKind::Rotation => ("angle_deg", "nm"),
            CoordinateKind::Translation => ("position_m", "n"),
            CoordinateKind::Quaternion => ("value", "nm"),
        };
        let goal = if coordinate.kind == CoordinateKind::Translation { "goal_m" } else { "goal_deg" };
        for column in [value, &format!("external_{unit}"), &format!("passive_{unit}"), &format!("active_{unit}")] {
            let _ = write!(line, ",{name}.{column}");
        }
        let _ = write!(line, ",{name}.fatigue_positive,{name}.fatigue_negative,{name}.case,{name}.{goal}");
    }
    line
}

/// Appends one row, with its line end, to `line`. Numbers are written in their shortest form that reads back the same.
pub fn csv_row(model: &Model, row: &TableRow, line: &mut String) {
    let _ = write!(line, "{:?}", row.time);
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let shown = |x: f64| if coordinate.kind == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let [positive, negative] = row.fatigue[i];
        let _ = write!(
            line,
            ",{:?},{:?},{:?},{:?},{positive:?},{negative:?},",
            shown(row.posture[i]),
            row.external[i],
            row.passive[i],
            active_torque(row.external[i], row.passive[i]),
        );
        if let Some((case, _)) = row.asked[i] {
            line.push_str(case.number());
        }
        line.push(',');
        if let Some(goal) = row.asked[i].and_then(|(_, goal)| goal) {
            let _ = write!(line, "{:?}", shown(goal));
        }
    }
    line.push('\n');
}
