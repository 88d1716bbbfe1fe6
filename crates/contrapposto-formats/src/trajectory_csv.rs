//! The table of a run: one row an instant, columns as in docs/scenario.md.

use std::fmt::Write;

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::simulation::Sample;

/// Header line, without line end: `time`, then `COORDINATE.angle_deg` and so on.
pub fn csv_header(model: &Model) -> String {
    let mut line = "time".to_owned();
    for coordinate in model.coordinates() {
        let name = quoted(&coordinate.name);
        let (value, unit) = match coordinate.kind {
            CoordinateKind::Rotation => ("angle_deg", "nm"),
            CoordinateKind::Translation => ("position_m", "n"),
            CoordinateKind::Quaternion => ("value", "nm"),
        };
        let goal = if coordinate.kind == CoordinateKind::Translation { "goal_m" } else { "goal_deg" };
        // Names of strangers may hold commas and quotes; ours do not.
        for column in [value, &format!("external_{unit}"), &format!("passive_{unit}"), &format!("active_{unit}")] {
            let _ = write!(line, ",{name}.{column}");
        }
        let _ = write!(line, ",{name}.fatigue_positive,{name}.fatigue_negative,{name}.case,{name}.{goal}");
    }
    line
}

/// Appends one row, with its line end, to `line`. Numbers are written in their shortest form that reads back the same.
pub fn csv_row(model: &Model, sample: &Sample, line: &mut String) {
    let _ = write!(line, "{}", sample.time);
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let shown = |x: f64| if coordinate.kind == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let [positive, negative] = sample.fatigue[i];
        let _ = write!(
            line,
            ",{},{},{},{},{positive},{negative},",
            shown(sample.posture[i]),
            sample.external[i],
            sample.passive[i],
            sample.active[i],
        );
        let decision = sample.decisions[i].as_ref();
        if let Some(decision) = decision {
            line.push_str(decision.case.number());
        }
        line.push(',');
        if let Some(goal) = decision.and_then(|decision| decision.goal) {
            let _ = write!(line, "{}", shown(goal));
        }
    }
    line.push('\n');
}

/// A name that is safe inside a column title.
fn quoted(name: &str) -> String {
    name.chars().map(|c| if c == ',' || c == '"' || c.is_control() { '_' } else { c }).collect()
}
