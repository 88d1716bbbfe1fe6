//! The problem as it is given: model, priority levels, supports, loads, locked coordinates and options. A step changes
//! nothing here.

use super::error::EngineError;
use super::options::Options;
use super::report::LevelError;
use super::tolerances::{RANGE_ROUNDING, WIDEST_RANGE};
use crate::constraint::HalfSpace;
use crate::contact::{ContactForces, Support};
use crate::effort::problem::EffortProblem;
use crate::joint_torques::{JointTorquesError, Quantities};
use crate::kinematics::Kinematics;
use crate::model::{LARGEST, Model, SharedModel};
use crate::posture::Posture;
use crate::statics::Load;
use crate::tasks::{PriorityLevel, Task, free_place, held_place};

/// Levels of a problem on supports before those of the caller: friction and equilibrium, places of the supports, limits,
/// shares.
const CONTACT_LEVELS: usize = 4;

/// See the module's text.
#[derive(Clone, Debug)]
pub(super) struct Settings<'a> {
    pub(super) model: SharedModel<'a>,
    /// The caller's levels, the most important first.
    pub(super) levels: Vec<PriorityLevel>,
    /// Placements that the supported segments keep; `None` without equilibrium.
    pub(super) placements: Option<PriorityLevel>,
    /// Inequalities below the placements and above the caller's levels.
    pub(super) limits: PriorityLevel,
    pub(super) loads: Vec<Load>,
    pub(super) options: Options,
    /// By rate: it does not change.
    locked: Vec<bool>,
    /// Rates that are not locked.
    free: Vec<usize>,
    /// All rates.
    rates: Vec<usize>,
    /// Quantities that the tasks need in a posture.
    pub(super) quantities: Quantities,
    /// Index of the first level with an effort task.
    pub(super) effort_level: Option<usize>,
}

impl<'a> Settings<'a> {
    /// Checks levels, loads and options. Locked and dependent coordinates do not change on their own.
    pub(super) fn new(
        model: SharedModel<'a>,
        levels: Vec<PriorityLevel>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, EngineError> {
        check_options(&options)?;
        let mut quantities = Quantities::default();
        for (k, level) in levels.iter().enumerate() {
            for task in &level.tasks {
                task.check(&model).map_err(|error| EngineError::Task { level: k, error })?;
                quantities = quantities.with(task.quantities());
            }
            for space in &level.half_spaces {
                check_half_space(&model, space).map_err(|problem| EngineError::HalfSpace { level: k, problem })?;
            }
        }
        let effort = |task: &Task| matches!(task, Task::Effort(_));
        let locked = model
            .rates()
            .iter()
            .map(|rate| rate.coordinate.is_some_and(|c| model.coordinates()[c].locked || model.is_dependent(c)))
            .collect();
        let mut settings = Self {
            effort_level: levels.iter().position(|level| level.tasks.iter().any(effort)),
            levels,
            placements: None,
            limits: PriorityLevel::default(),
            loads: vec![],
            options,
            locked,
            free: vec![],
            rates: (0..model.rates().len()).collect(),
            quantities,
            model,
        };
        settings.list_free_rates();
        settings.set_loads(loads)?;
        Ok(settings)
    }

    /// Supported segments keep the placements that they have in `start`, free ones lie flat within their regions.
    pub(super) fn place_supports(&mut self, start: &Posture, supports: &[Support]) -> Result<(), EngineError> {
        let mut kinematics = Kinematics::new(&self.model);
        kinematics.update(&self.model, start).map_err(JointTorquesError::from)?;
        let mut placements = PriorityLevel { hard: true, ..PriorityLevel::default() };
        for support in supports {
            let place = held_place(support, &self.model, &kinematics);
            if !placements.tasks.contains(&place) {
                placements.tasks.push(place);
                self.limits.tasks.extend(free_place(support, &self.model, &kinematics));
            }
        }
        self.placements = Some(placements);
        Ok(())
    }

    /// Adds an inequality above the caller's levels.
    pub(super) fn limit(&mut self, task: Task) -> Result<(), EngineError> {
        task.check(&self.model).map_err(EngineError::Limit)?;
        self.quantities = self.quantities.with(task.quantities());
        self.limits.tasks.push(task);
        Ok(())
    }

    /// Replaces the loads.
    pub(super) fn set_loads(&mut self, loads: &[Load]) -> Result<(), EngineError> {
        loads.iter().try_for_each(|load| load.check(&self.model)).map_err(JointTorquesError::from)?;
        self.loads = loads.to_vec();
        Ok(())
    }

    /// Locks a rate.
    pub(super) fn lock(&mut self, rate: usize) {
        self.locked[rate] = true;
        self.list_free_rates();
    }

    fn list_free_rates(&mut self) {
        self.free.clear();
        self.free.extend(self.rates.iter().filter(|rate| !self.locked[**rate]));
    }

    /// By rate: it does not change.
    pub(super) fn locked(&self) -> &[bool] {
        &self.locked
    }

    /// Whether contact forces are unknowns beside the posture.
    pub(super) fn on_supports(&self) -> bool {
        self.placements.is_some()
    }

    /// Index of the caller's first level among the levels of the linearised problem.
    pub(super) fn first_level(&self) -> usize {
        if self.on_supports() { CONTACT_LEVELS } else { 0 }
    }

    /// The least-effort problem over all rates, or over those that are not locked; `None` without an effort level.
    pub(super) fn effort_problem<'b>(&'b self, contact: &'b ContactForces, rates: Rates) -> Option<EffortProblem<'b>> {
        let (level, places) = (self.effort_level?, self.placements.as_ref()?);
        Some(EffortProblem {
            model: &self.model,
            places,
            limits: &self.limits,
            above: &self.levels[..level],
            shortfall: &[],
            effort: &self.levels[level],
            loads: &self.loads,
            free: match rates {
                Rates::All => &self.rates,
                Rates::Free => &self.free,
            },
            contact,
        })
    }

    /// Whether a descent can lower effort: some rate is free, and the effort level asks for nothing else.
    pub(super) fn can_descend(&self) -> bool {
        let effort = |task: &Task| matches!(task, Task::Effort(_));
        let alone = |level: &PriorityLevel| level.half_spaces.is_empty() && level.tasks.iter().all(effort);
        !self.free.is_empty() && self.effort_level.is_some_and(|level| alone(&self.levels[level]))
    }

    /// Whether effort is the last level: nothing below it is passed over by a descent.
    pub(super) fn effort_is_last(&self) -> bool {
        self.effort_level.is_some_and(|level| level + 1 == self.levels.len())
    }

    /// Whether a level other than a rest posture is not reached.
    pub(super) fn is_out_of_reach(&self, levels: &[LevelError]) -> bool {
        let asks = |level: &PriorityLevel| {
            !(level.half_spaces.is_empty() && level.tasks.iter().all(|task| matches!(task, Task::Posture(_))))
        };
        self.levels.iter().zip(levels).any(|(level, error)| asks(level) && error.length > self.options.level_tolerance)
    }

    /// A start beside the `first` solution: every coordinate that is not locked and has a range of at most [`WIDEST_RANGE`],
    /// at this share of the way from the middle of its range to there. With a negative share elbows and knees are bent on the
    /// other side of the middle of their ranges.
    pub(super) fn other_start(&self, first: &Posture, share: f64) -> Posture {
        let mut start = first.clone();
        for (rate, locked) in self.model.rates().iter().zip(&self.locked) {
            if let (Some(c), false) = (rate.coordinate, *locked) {
                let (lower, upper) = self.model.coordinates()[c].range;
                let (middle, width) = (0.5 * (lower + upper), upper - lower);
                if width < WIDEST_RANGE {
                    start.values_mut()[c] = (middle + share * (first.values()[c] - middle)).clamp(lower, upper);
                }
            }
        }
        start
    }

    /// Takes back what rounding has carried out of the ranges.
    pub(super) fn keep_ranges(&self, posture: &mut Posture) {
        for (rate, locked) in self.model.rates().iter().zip(&self.locked) {
            if let (Some(c), false) = (rate.coordinate, *locked) {
                let (lower, upper) = self.model.coordinates()[c].range;
                let value = &mut posture.values_mut()[c];
                let inside = value.clamp(lower, upper);
                if (*value - inside).abs() < RANGE_ROUNDING {
                    *value = inside;
                }
            }
        }
    }
}

/// Rates that a least-effort problem may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rates {
    /// All of them; bounds keep the locked ones.
    All,
    /// Rates that are not locked.
    Free,
}

fn check_options(options: &Options) -> Result<(), EngineError> {
    for (what, value) in [
        ("max_step (rad, m)", options.max_step),
        ("step_tolerance (rad, m)", options.step_tolerance),
        ("level_tolerance", options.level_tolerance),
        ("merit_tolerance", options.merit_tolerance),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(EngineError::Option { what, value, accepted: "greater than 0 and finite" });
        }
    }
    Ok(())
}

fn check_half_space(model: &Model, space: &HalfSpace) -> Result<(), String> {
    let (given, needed) = (space.normal.len(), model.coordinates().len());
    if given != needed {
        return Err(format!("has {given} entries; the model has {needed} coordinates"));
    }
    let finite = |v: &f64| v.abs() <= LARGEST;
    if !(space.normal.iter().all(finite) && finite(&space.offset)) {
        return Err("has a number that is not finite, or beyond 1e9".to_owned());
    }
    let moves = |c: usize| model.coordinates()[c].rate.is_some();
    match (0..needed).find(|&c| space.normal[c] != 0.0 && !moves(c)) {
        Some(c) => Err(format!("is on `{}`, which is no angle or distance", model.coordinates()[c].name)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use nalgebra::Vector3;

    use super::*;
    use crate::model::{Adult, adult};
    use crate::tasks::{Point, Posture as RestPosture};

    /// A hand and, below it, a rest posture.
    #[test]
    fn out_of_reach_is_a_level_that_is_not_reached_unless_it_asks_for_a_rest_posture_alone() {
        let model = adult(&Adult::default()).unwrap();
        let segment = model.segment("hand_r").unwrap();
        let hand = Point { segment, point: Vector3::zeros(), target: Vector3::zeros(), axes: [true; 3] };
        let rest = RestPosture::whole(&model, model.default_posture());
        let levels = vec![Task::Point(hand).into(), Task::Posture(rest).into()];
        let options = Options::inverse_kinematics();
        let settings = Settings::new(SharedModel::Borrowed(&model), levels, &[], options).unwrap();
        let is_out_of_reach =
            |lengths: [f64; 2]| settings.is_out_of_reach(&lengths.map(|length| LevelError { rows: vec![], length }));
        let tolerance = options.level_tolerance;
        assert!(!is_out_of_reach([0.0, 0.0]) && !is_out_of_reach([0.5 * tolerance, 0.0]));
        assert!(is_out_of_reach([2.0 * tolerance, 0.0]) && is_out_of_reach([0.3, 0.3]));
        assert!(!is_out_of_reach([0.0, 0.3]), "nobody asks for the rest posture as for a target");
    }
}
