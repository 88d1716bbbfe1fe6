//! Describes an experiment: body, start, loads, strategy and thresholds, all checked before the first step.

use super::Fall;
use super::rest::{Rest, check_rests, goal_with, limits_with};
use super::setting::Setting;
use crate::contact::{Missing, Support, SupportError};
use crate::fatigue::Hysteresis;
use crate::hybrid::Strategy;
use crate::joint_torques::{JointMuscles, JointTorquesError, MuscleShareError};
use crate::model::Model;
use crate::muscle::SharingError;
use crate::posture::{Posture, PostureError};
use crate::posture_solver::EngineError;
use crate::statics::{Load, LoadError};
use crate::tasks::PriorityLevel;
use crate::tasks::{Task, TaskError};

/// Reading of Tables 1 and 2 that decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tables {
    /// [`crate::hybrid::minimise`]: gaps closed, an accepted strategy kept.
    Total,
    /// [`crate::hybrid::minimise_literal`]: as printed.
    Literal,
}

/// The kind of relief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrategySettings {
    /// Active or passive.
    pub kind: Strategy,
    /// `R_min`, 0..=1.
    pub minimum_decrease_ratio: f64,
}

/// Step sizes and tolerances of relief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefSettings {
    /// `beta` of Eq. 9, above 0, below 1.
    pub step_gain: f64,
    /// `delta theta_max` of Eq. 9, rad, positive.
    pub max_step: f64,
    /// `eps`, N m, not negative.
    pub torque_tolerance: f64,
    /// Relief of a body may raise its effort to so many times the effort before all present reliefs, at least 1.
    pub effort_factor: f64,
    /// Reading of Tables 1 and 2 that decides.
    pub tables: Tables,
}

/// Duration and time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSettings {
    /// Simulated time, s, not negative.
    pub duration: f64,
    /// Time step, s, positive. Loads count as constant from one sample to the next.
    pub step: f64,
    /// End as soon as relief no longer moves anything and no event is to come.
    pub stop_when_settled: bool,
    /// Threads for the searches of the run, at least one; their number changes no byte.
    pub threads: usize,
}

impl RunSettings {
    /// Steps after the first sample; rounding does not lose the last one of a whole number of them.
    pub fn steps(&self) -> u64 {
        (self.duration / self.step + 1e-9).floor() as u64
    }

    /// Time of the last sample, s.
    pub fn end(&self) -> f64 {
        self.steps() as f64 * self.step
    }
}

/// Tasks of the body besides relief.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskSettings {
    /// Tasks of one priority.
    pub goal: PriorityLevel,
    /// More important than the relief of tired muscles.
    pub above_relief: bool,
}

impl TaskSettings {
    /// The kinds and segments of its tasks, e.g. `point hand_r + look_at head`. The tasks must have passed [`Task::check`].
    pub fn label(&self, model: &Model) -> String {
        self.goal.tasks.iter().map(|task| task.label(model)).collect::<Vec<_>>().join(" + ")
    }
}

/// A change during a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Event {
    /// Time of the change, s.
    pub time: f64,
    /// Strategy of every coordinate from then on.
    pub strategies: Option<Vec<Strategy>>,
    /// Loads from then on.
    pub loads: Option<Vec<Load>>,
    /// Indices into [`Scenario::tasks`], and the tasks there from then on.
    pub tasks: Vec<(usize, PriorityLevel)>,
}

/// A complete experiment.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The name of the experiment.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Muscles that give groups of the body strength and its coordinates passive torque, those of each sample's posture.
    pub muscles: Option<JointMuscles>,
    /// Groups whose strength is the muscles' tire as these muscles do, each of which tires on its own; else by the law of their joint.
    pub muscles_tire: bool,
    /// The posture at the start, inside all ranges.
    pub start: Posture,
    /// Whether each coordinate may move.
    pub free: Vec<bool>,
    /// Loads besides the weight of the body.
    pub loads: Vec<Load>,
    /// Supports of the body, those of [`Scenario::rests`] last. Without supports the root is held as if by hand.
    pub supports: Vec<Support>,
    /// The supports that are not in use at the start: a run puts them on their planes, and takes them off, to relieve a tired group.
    pub rests: Vec<Rest>,
    /// Inequalities above all tasks.
    pub limits: Vec<Task>,
    /// Tasks, the most important first.
    pub tasks: Vec<TaskSettings>,
    /// Changes during the run, the earliest first.
    pub events: Vec<Event>,
    /// The kind of relief.
    pub strategy: StrategySettings,
    /// Strategy of every coordinate at the start, where it is another than [`Scenario::strategy`]; empty for none.
    pub strategies: Vec<Strategy>,
    /// Step sizes and tolerances of relief.
    pub relief: ReliefSettings,
    /// Fatigue at which relief begins and ends.
    pub hysteresis: Hysteresis,
    /// Fatigue at the start of the positive and negative group of every coordinate, 0..=1.
    pub start_fatigue: Vec<[f64; 2]>,
    /// Duration and time step.
    pub run: RunSettings,
}

/// The reason for which an experiment was refused or a run ended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The start does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
    /// A load does not fit the model.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A task does not fit the model.
    #[error("task {}: {error}", task + 1)]
    Task {
        /// Place of the task in the list.
        task: usize,
        /// The reason.
        error: TaskError,
    },
    /// No posture was found near the start in which the supports hold the body.
    #[error("the supports cannot hold the body near the start: {0}")]
    CannotStand(Missing),
    /// An event has thrown the body off balance, and no posture near was found in which the supports hold it.
    #[error("{0}")]
    Falls(Fall),
    /// A posture, a load or a passive law was refused while torques were computed.
    #[error(transparent)]
    Torques(#[from] JointTorquesError),
    /// Muscles cannot tire one by one.
    #[error(transparent)]
    MuscleShare(#[from] MuscleShareError),
    /// Torques could not be shared among the muscles.
    #[error(transparent)]
    Sharing(#[from] SharingError),
    /// The body cannot be moved toward its tasks.
    #[error(transparent)]
    Relax(#[from] EngineError),
    /// A snapshot is of another body or run.
    #[error("the snapshot does not fit this scenario")]
    Snapshot,
    /// A coordinate starts outside its range.
    #[error("`{coordinate}` starts at {value}, outside its range {}..{} (rad or m)", range.0, range.1)]
    OutsideRange {
        /// Name of the coordinate.
        coordinate: String,
        /// Value of the coordinate, rad or m.
        value: f64,
        /// Range of the coordinate.
        range: (f64, f64),
    },
    /// A setting is outside the values that it may have.
    #[error("{setting} is {value}; it must be {accepted}")]
    Setting {
        /// The setting.
        setting: Setting,
        /// The value.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
    /// A coordinate is free but has no passive curve, so that no relief can be computed for it.
    #[error("`{0}` is free, but has no passive curve to find relief with; lock it or give it one")]
    NoPassiveCurve(String),
}

/// Most steps of one run: 30 steps a second for four days.
const MOST_STEPS: f64 = 1e7;

/// Whether two levels hold tasks of the same kinds.
fn alike(a: &PriorityLevel, b: &PriorityLevel) -> bool {
    let kinds = |goal: &PriorityLevel| goal.tasks.iter().map(Task::kind).collect::<Vec<_>>();
    kinds(a) == kinds(b)
}

impl Scenario {
    /// Rates of the coordinates that may not move.
    pub(crate) fn locked_rates(&self) -> impl Iterator<Item = usize> {
        let rates = self.model.rates().iter().enumerate();
        rates.filter(|(_, rate)| rate.coordinate.is_some_and(|c| !self.free[c])).map(|(i, _)| i)
    }

    /// The supports in use at the start.
    pub fn supports_at_start(&self) -> &[Support] {
        &self.supports[..self.supports.len() - self.rests.len().min(self.supports.len())]
    }

    /// The inequalities above all tasks while the supports with these numbers are in use.
    pub(crate) fn limits_with(&self, in_use: &[usize]) -> Vec<Task> {
        limits_with(&self.limits, (&self.rests, &self.supports), &self.model, in_use)
    }

    /// The tasks of a level, one of [`Scenario::tasks`] or one that an event puts in its place, while the supports with these numbers are in use.
    pub(crate) fn goal_with(&self, goal: &PriorityLevel, in_use: &[usize]) -> PriorityLevel {
        goal_with(goal, (&self.rests, &self.supports), &self.model, in_use)
    }

    /// Whether the body has supports or tasks. Without them each coordinate finds relief on its own.
    pub fn has_supports_or_tasks(&self) -> bool {
        !self.supports.is_empty() || !self.tasks.is_empty()
    }

    /// Number of muscles that tire one by one.
    pub fn tiring_muscles(&self) -> usize {
        let muscles = self.muscles.as_ref().filter(|_| self.muscles_tire);
        muscles.map_or(0, |muscles| muscles.musculature().muscles.len())
    }

    /// Checks that all parts fit the model and each other.
    ///
    /// # Errors
    /// [`ScenarioError`] names the first thing that is not.
    pub fn check(&self) -> Result<(), ScenarioError> {
        self.start.check(&self.model)?;
        for load in &self.loads {
            load.check(&self.model)?;
        }
        self.supports.iter().try_for_each(|support| support.check(&self.model))?;
        check_rests(&self.rests, &self.supports, &self.model)?;
        self.tasks.iter().enumerate().try_for_each(|(i, task)| self.check_task(i, &task.goal))?;
        let count = self.model.coordinates().len() as f64;
        check_setting(self.free.len() as f64 == count, Setting::FreeFlags, self.free.len() as f64, "one a coordinate")?;
        let given = self.strategies.len() as f64;
        check_setting(given == 0.0 || given == count, Setting::Strategies, given, "none, or one a coordinate")?;
        self.check_events(count)?;
        let given = self.start_fatigue.len() as f64;
        check_setting(given == count, Setting::FatiguePairs, given, "one a coordinate")?;
        self.check_coordinates()?;
        self.check_settings()
    }

    fn check_task(&self, task: usize, goal: &PriorityLevel) -> Result<(), ScenarioError> {
        let refused = |error| ScenarioError::Task { task, error };
        goal.tasks.iter().try_for_each(|given| given.check(&self.model)).map_err(refused)
    }

    /// `count`: number of coordinates.
    fn check_events(&self, count: f64) -> Result<(), ScenarioError> {
        let mut before = 0.0;
        for event in &self.events {
            let accepted = "finite, not negative, and not before the event before it";
            check_setting(event.time >= before && event.time.is_finite(), Setting::EventTime, event.time, accepted)?;
            before = event.time;
            event.loads.iter().flatten().try_for_each(|load| load.check(&self.model))?;
            let given = event.strategies.as_ref().map_or(count, |list| list.len() as f64);
            check_setting(given == count, Setting::Strategies, given, "none, or one a coordinate")?;
            for (i, goal) in &event.tasks {
                let fits = self.tasks.get(*i).is_some_and(|task| alike(&task.goal, goal));
                check_setting(fits, Setting::EventTask, *i as f64, "that of a task of the same kinds")?;
                self.check_task(*i, goal)?;
            }
        }
        Ok(())
    }

    fn check_coordinates(&self) -> Result<(), ScenarioError> {
        for ((coordinate, &value), &free) in self.model.coordinates().iter().zip(self.start.values()).zip(&self.free) {
            let range = coordinate.range;
            if value < range.0 || value > range.1 {
                return Err(ScenarioError::OutsideRange { coordinate: coordinate.name.clone(), value, range });
            }
            if free && !self.has_supports_or_tasks() && !coordinate.can_be_relieved() {
                return Err(ScenarioError::NoPassiveCurve(coordinate.name.clone()));
            }
        }
        Ok(())
    }

    fn check_settings(&self) -> Result<(), ScenarioError> {
        for &value in self.start_fatigue.iter().flatten() {
            check_setting((0.0..=1.0).contains(&value), Setting::StartFatigue, value, "in 0..1")?;
        }
        let ratio = self.strategy.minimum_decrease_ratio;
        check_setting((0.0..=1.0).contains(&ratio), Setting::MinimumDecreaseRatio, ratio, "in 0..1")?;
        let ReliefSettings { step_gain, max_step, torque_tolerance, effort_factor, .. } = self.relief;
        check_setting(step_gain > 0.0 && step_gain < 1.0, Setting::StepGain, step_gain, "above 0 and below 1")?;
        check_setting(max_step > 0.0 && max_step.is_finite(), Setting::MaxStep, max_step, "positive")?;
        let tolerable = torque_tolerance >= 0.0 && torque_tolerance.is_finite();
        check_setting(tolerable, Setting::TorqueTolerance, torque_tolerance, "finite and not negative")?;
        let rises = effort_factor >= 1.0 && effort_factor.is_finite();
        check_setting(rises, Setting::EffortFactor, effort_factor, "finite, at least 1")?;
        let Hysteresis { critical_level, recovery_level } = self.hysteresis;
        let rising = 0.0 < critical_level && critical_level <= 1.0;
        check_setting(rising, Setting::CriticalLevel, critical_level, "above 0, at most 1")?;
        let below = 0.0 <= recovery_level && recovery_level < critical_level;
        check_setting(below, Setting::RecoveryLevel, recovery_level, "not negative, below the critical level")?;
        let RunSettings { duration, step, .. } = self.run;
        check_setting(duration >= 0.0 && duration.is_finite(), Setting::Duration, duration, "finite and not negative")?;
        check_setting(step > 0.0 && step <= 60.0, Setting::TimeStep, step, "above 0, at most 60")?;
        check_setting(duration / step <= MOST_STEPS, Setting::Steps, duration / step, "ten million at most")
    }
}

fn check_setting(ok: bool, setting: Setting, value: f64, accepted: &'static str) -> Result<(), ScenarioError> {
    if ok { Ok(()) } else { Err(ScenarioError::Setting { setting, value, accepted }) }
}
