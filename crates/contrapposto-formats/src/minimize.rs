//! Reads one joint problem a line of JSON and writes its decision as JSON.

use contrapposto::hybrid::{Decision, Equilibrium, Problem, explain, minimise, minimise_literal};
use contrapposto::passive::{DoubleExponential, PassiveCurve};
use contrapposto::simulation::Tables;
use serde::{Deserialize, Serialize};

use crate::input_error::shortened;
use crate::passive_law::DoubleExponentialText;
use crate::scenario::StrategyKindText;

/// Longest line that is read, bytes.
pub const MOST_LINE_BYTES: usize = 1 << 16;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProblemLine {
    passive: DoubleExponentialText,
    range_deg: [f64; 2],
    angle_deg: f64,
    external_nm: f64,
    external_slope_nm_per_rad: f64,
    strategy: StrategyKindText,
    minimum_decrease_ratio: f64,
    tolerance_nm: f64,
}

/// A decision as it is printed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DecisionLine {
    /// Case of Table 1.
    pub case: &'static str,
    /// `stay`, `active`, `passive`, `least_torque`, `at_limit`; `none` in literal mode.
    pub outcome: &'static str,
    /// Goal angle, deg.
    pub goal_deg: Option<f64>,
    /// Active torque now, N m.
    pub active_nm: f64,
    /// Extrapolated active torque at the goal, N m.
    pub active_at_goal_nm: Option<f64>,
    /// `R` of the candidate of case 3.1.
    pub decrease_ratio: Option<f64>,
    /// Interval searched for a root, deg.
    pub interval_deg: Option<[f64; 2]>,
    /// Whether the balance at the goal is stable; null where the goal is no balance.
    pub stable: Option<bool>,
    /// One plain sentence.
    pub why: String,
}

impl DecisionLine {
    /// The decision in degrees.
    pub fn new(problem: &Problem, decision: &Decision) -> Self {
        Self {
            case: decision.case.number(),
            outcome: decision.outcome.word(),
            goal_deg: decision.goal.map(f64::to_degrees),
            active_nm: decision.active_torque + 0.0, // no -0
            active_at_goal_nm: decision.active_torque_at_goal.map(|torque| torque + 0.0),
            decrease_ratio: decision.decrease_ratio.map(|ratio| ratio + 0.0),
            interval_deg: decision.interval.map(|(from, to)| [from.to_degrees(), to.to_degrees()]),
            stable: decision.equilibrium.map(|kind| kind != Equilibrium::Unstable),
            why: explain(problem, decision),
        }
    }
}

/// Decides one line.
///
/// # Errors
/// A message that names the reason.
pub fn minimize_line(line: &str, tables: Tables) -> Result<DecisionLine, String> {
    let text: ProblemLine = serde_json::from_str(line).map_err(|error| reworded(line, &error))?;
    let [min, max] = text.range_deg;
    if min >= max {
        return Err(format!("range_deg is [{min}, {max}]; the lower limit must come first, below the upper one"));
    }
    // Degrees go to radians once, and the present angle with its limits, so that equal degrees stay equal.
    let range = (text.range_deg[0].to_radians(), text.range_deg[1].to_radians());
    let form = DoubleExponential::from(text.passive).form().map_err(|error| format!("passive: {error}"))?;
    let curve = PassiveCurve::new(form, range, None).map_err(|error| format!("passive: {error}"))?;
    let problem = Problem {
        curve: &curve,
        angle: text.angle_deg.to_radians(),
        external_torque: text.external_nm,
        external_slope: text.external_slope_nm_per_rad,
        strategy: text.strategy.into(),
        minimum_decrease_ratio: text.minimum_decrease_ratio,
        torque_tolerance: text.tolerance_nm,
        accepted: None,
    };
    let decision = match tables {
        Tables::Total => minimise(&problem),
        Tables::Literal => minimise_literal(&problem),
    };
    let mut line = DecisionLine::new(&problem, &decision.map_err(|error| error.to_string())?);
    if let Some(goal) = &mut line.goal_deg {
        // A stay is the angle that was given, to the digit; and no rounding of the conversion leaves the range.
        *goal = if line.outcome == "stay" { text.angle_deg } else { goal.clamp(text.range_deg[0], text.range_deg[1]) };
    }
    Ok(line)
}

/// The message of the JSON reader. Each line is a file of its own: its place is the column.
fn reworded(line: &str, error: &serde_json::Error) -> String {
    // Many programs write these; JSON has no such words.
    let before = line.get(..error.column().saturating_sub(1)).unwrap_or("");
    let start = before.rfind([':', ',', '[', ' ', '\t']).map_or(0, |at| at + 1);
    let word = line[start..].split([',', ']', '}', ' ', '\t']).next().unwrap_or("");
    let bare = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    if ["nan", "inf", "infinity"].contains(&bare.as_str()) {
        return format!("`{word}` is not a finite number at column {}", start + 1);
    }
    shortened(error.to_string()).replace("at line 1 column", "at column")
}
