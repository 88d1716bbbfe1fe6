//! Finds the targets that a posture misses.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::{Model, plain_name};
use crate::posture::Posture;
use crate::tasks::{LookAt, LookAtGoal, Point, PriorityLevel, Task, Unit};

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
    /// The target is the most important one, or one that is demanded.
    pub decides: bool,
    /// Of a single point: where it gets.
    pub nearest: Option<Nearest>,
    /// A more important target of the same part, which is met, is elsewhere.
    pub contradicts: bool,
}

/// Place of a point that misses its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Place of the point, ground, m.
    pub at: Vector3<f64>,
    /// From there to the target on the asked axes, ground, m.
    pub to_target: Vector3<f64>,
    /// Upward, of length 1; zero without gravity.
    pub up: Vector3<f64>,
}

impl Missed {
    /// The missed targets among the levels of a posture, the most important first, with the lengths of their errors. The first
    /// level with a target decides, and those that are demanded.
    pub fn of_levels<'a>(
        model: &Model,
        posture: &Posture,
        levels: impl IntoIterator<Item = (&'a PriorityLevel, f64)>,
    ) -> Vec<Self> {
        let mut first = true;
        let (mut missed, mut met) = (vec![], vec![]);
        for (level, error) in levels {
            let (is_target, is_direction) = (level.tasks.iter().any(is_target), level.tasks.iter().any(is_direction));
            if !is_target && !is_direction {
                continue;
            }
            let decides = is_target && (std::mem::replace(&mut first, false) || level.demanded);
            let points = || level.tasks.iter().filter_map(as_point);
            let unit = unit(level);
            let least = if unit == Some(Unit::Radian) { MISSED_ANGLE } else { MISSED_DISTANCE };
            if error > least {
                let words: Vec<String> = level.tasks.iter().map(|task| in_words(&task.label(model))).collect();
                let nearest = match level.tasks.as_slice() {
                    [Task::Point(point)] => Nearest::of(model, posture, point),
                    _ => None,
                };
                // An error of another moment, or of another target, is not that of the posture.
                let nearest = nearest.filter(|nearest| (nearest.to_target.norm() - error).abs() < 0.05 * error);
                let contradicts = points().any(|point| met.iter().any(|other| contradict(point, other)));
                missed.push(Self { task: words.join(" and "), distance: error, unit, decides, nearest, contradicts });
            } else {
                met.extend(points().copied());
            }
        }
        missed
    }
}

impl Nearest {
    /// Of a point in a posture; `None` where that cannot be computed.
    fn of(model: &Model, posture: &Posture, point: &Point) -> Option<Self> {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).ok()?;
        let at = kinematics.station(model, point.segment, point.point);
        let to_target = Vector3::from_fn(|k, _| if point.axes[k] { point.target[k] - at[k] } else { 0.0 });
        let up = (-model.gravity()).try_normalize(1e-9).unwrap_or_default();
        Some(Self { at, to_target, up })
    }
}

fn as_point(task: &Task) -> Option<&Point> {
    if let Task::Point(point) = task { Some(point) } else { None }
}

/// Whether two targets of one point are in different places.
fn contradict(a: &Point, b: &Point) -> bool {
    let apart = (0..3).any(|k| a.axes[k] && b.axes[k] && (a.target[k] - b.target[k]).abs() > MISSED_DISTANCE);
    a.segment == b.segment && (a.point - b.point).norm() < MISSED_DISTANCE && apart
}

/// Whether a task names a place or a direction that the job asks for: not balance, which [`super::VerdictKind::CannotStand`] judges,
/// not least effort, a posture, a rhythm or an upright head, which take what the targets leave.
fn is_target(task: &Task) -> bool {
    let condition = is_direction(task) || matches!(task, Task::CenterOfMass(_));
    !condition
        && !matches!(task, Task::Effort(_) | Task::Posture(_) | Task::Bounds(_) | Task::Height(_) | Task::Clearance(_))
}

/// An upright head or trunk, a direction of the gaze.
fn is_direction(task: &Task) -> bool {
    matches!(task, Task::LookAt(LookAt { goal: LookAtGoal::Direction(_), .. }))
}

/// The unit of all errors of a level.
pub(super) fn unit(level: &PriorityLevel) -> Option<Unit> {
    let of = |task: &Task| match task {
        Task::Point(_) | Task::Distance(_) | Task::Height(_) | Task::CenterOfMass(_) => Some(Unit::Metre),
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
