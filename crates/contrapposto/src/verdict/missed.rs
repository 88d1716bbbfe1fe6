//! Finds the targets that a posture misses.

use crate::model::{Model, plain_name};
use crate::tasks::{LookAt, LookAtGoal, PriorityLevel, Task, Unit};

/// A target counts as missed from here on, m. Assumed: what a hand or an eye makes good without another posture.
pub const MISSED_DISTANCE: f64 = 5e-3;
/// A direction counts as missed from here on, rad (1 degree). Assumed likewise.
pub const MISSED_ANGLE: f64 = 0.017_453;

/// A target that is missed.
#[derive(Clone, Debug, PartialEq)]
pub struct Missed {
    /// The tasks of its priority in plain words: `point right hand`.
    pub task: String,
    /// By how much, in `unit`.
    pub distance: f64,
    /// The unit; `None` where metres and radians are taken together.
    pub unit: Option<Unit>,
    /// It is the most important target.
    pub decides: bool,
}

impl Missed {
    /// The missed targets among the levels of a posture, the most important first, with the lengths of their errors. Only the first
    /// level with a target decides.
    pub fn of_levels<'a>(model: &Model, levels: impl IntoIterator<Item = (&'a PriorityLevel, f64)>) -> Vec<Self> {
        let mut first = true;
        let mut missed = vec![];
        for (level, error) in levels {
            let (is_target, is_direction) = (level.tasks.iter().any(is_target), level.tasks.iter().any(is_direction));
            if !is_target && !is_direction {
                continue;
            }
            let decides = is_target && std::mem::replace(&mut first, false);
            let unit = unit(level);
            let least = if unit == Some(Unit::Radian) { MISSED_ANGLE } else { MISSED_DISTANCE };
            if error > least {
                let words: Vec<String> = level.tasks.iter().map(|task| in_words(&task.label(model))).collect();
                missed.push(Self { task: words.join(" and "), distance: error, unit, decides });
            }
        }
        missed
    }
}

/// Whether a task names a place or a direction that the job asks for: not balance, which [`super::VerdictKind::CannotStand`] judges,
/// not least effort, a posture or an upright head, which take what the targets leave.
fn is_target(task: &Task) -> bool {
    let condition = is_direction(task) || matches!(task, Task::CenterOfMass(_));
    !condition && !matches!(task, Task::Effort(_) | Task::Posture(_) | Task::Bounds(_) | Task::Clearance(_))
}

/// An upright head or trunk, a direction of the gaze.
fn is_direction(task: &Task) -> bool {
    matches!(task, Task::LookAt(LookAt { goal: LookAtGoal::Direction(_), .. }))
}

/// The unit of all errors of a level.
fn unit(level: &PriorityLevel) -> Option<Unit> {
    let of = |task: &Task| match task {
        Task::Point(_) | Task::Distance(_) => Some(Unit::Metre),
        Task::Orientation(_) | Task::LookAt(_) => Some(Unit::Radian),
        _ => None,
    };
    let mut units = level.tasks.iter().map(of);
    let first = units.next().flatten()?;
    units.all(|unit| unit == Some(first)).then_some(first)
}

/// `look_at head` is `look at head`, `point hand_r` is `point right hand`.
fn in_words(label: &str) -> String {
    let words = label.split(' ').map(|word| if word == "look_at" { "look at".to_owned() } else { plain_name(word) });
    words.collect::<Vec<_>>().join(" ")
}
