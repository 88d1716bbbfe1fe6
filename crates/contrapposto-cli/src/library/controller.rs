//! Steps a posture toward targets that move: the tasks of a scenario in strict order of priority, one step a call.

use std::sync::Arc;

use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, EngineError};
use contrapposto::tasks::Task;
use contrapposto_formats::PoseScenario;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::failure::{Failure, Note, with_notes};
use super::jobs::ScenarioSource;
use crate::commands::pose::read;

/// Shortest quaternion that is a rotation.
const SHORTEST_QUATERNION: f64 = 1e-6;

/// The tasks of a scenario, ready to step.
pub struct Controller {
    engine: Engine<'static>,
    start: Posture,
    names: Vec<String>,
    /// By task: its label, its level and its place in it.
    tasks: Vec<(String, usize, usize)>,
    /// Place of the limits among the levels, which are no task of the scenario.
    limits: Option<usize>,
}

impl Controller {
    /// The tasks of a scenario, as those of `contrapposto pose`; `max_step`: largest change of a coordinate in one step, rad or m.
    ///
    /// # Errors
    /// [`Failure`] for a scenario that is refused.
    pub fn new(source: &ScenarioSource, max_step: Option<f64>) -> Result<(Self, Vec<Note>), Failure> {
        let (scenario, notes) = with_notes(|| read(source.open()?))?;
        let mut options = scenario.options;
        if let Some(max_step) = max_step {
            options.max_step = max_step;
        }
        let (levels, limits) = scenario.levels();
        let PoseScenario { model, start, locked, loads, labels, .. } = scenario;
        let refused = |error: EngineError| Failure::refused(error.to_string());
        let names = model.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let mut engine = Engine::new(Arc::new(model), levels, &loads, options).map_err(refused)?;
        locked.iter().for_each(|&rate| engine.lock(rate));
        let mut tasks = vec![];
        for (goal, labels) in labels.into_iter().enumerate() {
            let level = goal + usize::from(limits.is_some_and(|limits| limits <= goal));
            tasks.extend(labels.into_iter().enumerate().map(|(place, label)| (label, level, place)));
        }
        Ok((Self { engine, start, names, tasks, limits }, notes))
    }

    /// Names of the coordinates.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The posture in which the scenario starts.
    pub fn start(&self) -> &[f64] {
        self.start.values()
    }

    /// Names of the tasks: `point hand_r`.
    pub fn tasks(&self) -> impl Iterator<Item = &str> {
        self.tasks.iter().map(|(label, ..)| label.as_str())
    }

    /// Moves the target of a task: three numbers (m) of a point, three or seven (m, then a quaternion w, x, y, z) of a placement, four of
    /// an orientation.
    ///
    /// # Errors
    /// [`Failure`] for a task that is not there, or whose target has another number of values.
    pub fn set_target(&mut self, label: &str, values: &[f64]) -> Result<(), Failure> {
        let mut named = self.tasks.iter().filter(|(task, ..)| task == label);
        let (Some(&(_, level, place)), others) = (named.next(), named.count()) else {
            let all = self.tasks().collect::<Vec<_>>().join(", ");
            return Err(Failure::refused(format!("there is no task `{label}`; there are: {all}")));
        };
        if others > 0 {
            return Err(Failure::refused(format!("{} tasks are named `{label}`; a target needs one", others + 1)));
        }
        if let Some(odd) = values.iter().find(|value| !value.is_finite()) {
            return Err(Failure::refused(format!("target of `{label}` has a value {odd}; it must be finite")));
        }
        let task = &mut self.engine.levels_mut()[level].tasks[place];
        let needed = match (task, values) {
            (Task::Point(task), &[x, y, z]) => {
                task.target = Vector3::new(x, y, z);
                return self.moved();
            }
            (Task::Placement(task), &[x, y, z]) => {
                task.target.translation.vector = Vector3::new(x, y, z);
                return self.moved();
            }
            (Task::Placement(task), &[x, y, z, w, i, j, k]) => {
                task.target.rotation = rotation(label, [w, i, j, k])?;
                task.target.translation.vector = Vector3::new(x, y, z);
                return self.moved();
            }
            (Task::Orientation(task), &[w, i, j, k]) => {
                task.target = rotation(label, [w, i, j, k])?;
                return self.moved();
            }
            (Task::Point(_), _) => "3 (m)",
            (Task::Placement(_), _) => "3 (m), or 7 (m, then a quaternion w, x, y, z)",
            (Task::Orientation(_), _) => "4 (a quaternion w, x, y, z)",
            _ => "none: only tasks of kind point, placement and orientation can be moved",
        };
        Err(Failure::refused(format!("target of `{label}` has {} values; it needs {needed}", values.len())))
    }

    fn moved(&mut self) -> Result<(), Failure> {
        self.engine.widen_trust_region();
        Ok(())
    }

    /// Makes one step from `values`; gives the length of the error of every task level before the step.
    ///
    /// # Errors
    /// [`Failure`] for a posture that does not fit the model.
    pub fn step(&mut self, values: &mut [f64]) -> Result<Vec<f64>, Failure> {
        let mut posture = Posture::new(values.to_vec());
        self.engine.step(&mut posture).map_err(|error| Failure::refused(error.to_string()))?;
        values.copy_from_slice(posture.values());
        Ok(self.without_limits(self.engine.errors().to_vec()))
    }

    /// Steps from `values` until the posture is solved; gives the length of the error of every task level.
    ///
    /// # Errors
    /// As [`Controller::step`].
    pub fn solve(&mut self, values: &mut [f64]) -> Result<Vec<f64>, Failure> {
        let start = Posture::new(values.to_vec());
        let solved = self.engine.solve(&start).map_err(|error| Failure::refused(error.to_string()))?;
        values.copy_from_slice(solved.posture.values());
        Ok(self.without_limits(solved.levels.iter().map(|level| level.length).collect()))
    }

    fn without_limits(&self, mut errors: Vec<f64>) -> Vec<f64> {
        self.limits.map(|place| errors.remove(place));
        errors
    }
}

/// A rotation of a quaternion w, x, y, z of any length.
fn rotation(label: &str, [w, i, j, k]: [f64; 4]) -> Result<UnitQuaternion<f64>, Failure> {
    let length = [w, i, j, k].iter().map(|part| part * part).sum::<f64>().sqrt();
    if length < SHORTEST_QUATERNION {
        let message = format!("target of `{label}` has a quaternion of length {length}; it must not be zero");
        return Err(Failure::refused(message));
    }
    Ok(UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)))
}
