//! Moves a body in balance by single steps: a point that is dragged, or toward the posture of least effort.
//!
//! The levels of a step, the most important first: equilibrium with friction, places of the supports, limits, hands on things of the scenario, points
//! that are held, the point that is dragged, the tasks of the scenario, effort.

use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{Point, PriorityLevel, Task};
use nalgebra::Vector3;

use crate::body::Body;
use crate::error::Refusal;
use crate::message::Handle;

/// Largest change of a joint in one step, rad or m.
const STEP: f64 = 0.1;
/// Farthest way of a dragged point in one step, m: the first derivatives of a step are good for no more.
const REACH: f64 = 0.08;
/// A step in which nothing changes by more has settled, rad or m.
const SETTLED: f64 = 1e-6;

/// A body under way.
#[derive(Debug)]
pub(crate) struct Mover {
    pub(crate) engine: Engine<'static>,
    dragged: Option<Dragged>,
}

/// The point that is dragged.
#[derive(Clone, Copy, Debug)]
struct Dragged {
    level: usize,
    segment: usize,
    point: Vector3<f64>,
    /// Only along the ground.
    sliding: bool,
}

/// The outcome of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moved {
    /// Distance of the dragged point from its target after the step, m.
    pub(crate) miss: Option<f64>,
    /// The step moved next to nothing.
    pub(crate) settled: bool,
}

impl Mover {
    /// Toward least effort.
    pub(crate) fn settling(body: &Body, posture: &Posture) -> Result<Self, Refusal> {
        Self::new(body, posture, body.scenario.goals.clone(), true, None)
    }

    /// With a point that is dragged: a task of the body's scenario holds it at a place in ground, m. `sliding`: its height is that of its support.
    pub(crate) fn dragging(
        body: &Body,
        posture: &Posture,
        (handle, place): (&Handle, [f64; 3]),
        sliding: bool,
    ) -> Result<Self, Refusal> {
        let segment = body.segment(&handle.segment)?;
        let (point, target) = (Vector3::from(handle.point), Vector3::from(place));
        let task = Task::Point(Point { segment, point, target, axes: [true; 3] });
        let mut levels = body.scenario.goals.clone();
        let level = levels.iter().position(|level| level.tasks.first() == Some(&task));
        let level = level.ok_or_else(|| Refusal(format!("the {} cannot be dragged", handle.label)))?;
        if let Some(Task::Point(task)) = levels[level].tasks.first_mut() {
            task.axes[1] = !sliding;
        }
        Self::new(body, posture, levels, false, Some(Dragged { level, segment, point, sliding }))
    }

    fn new(
        body: &Body,
        posture: &Posture,
        levels: Vec<PriorityLevel>,
        reject_steps: bool,
        dragged: Option<Dragged>,
    ) -> Result<Self, Refusal> {
        let options = Options { reject_steps, max_step: STEP, local_minima: 0, ..Options::least_effort() };
        let scenario = &body.scenario;
        let supports = scenario.supports.clone();
        let mut engine = Engine::with_supports(body.model.clone(), posture, supports, levels, &scenario.loads, options)
            .map_err(Refusal::of)?;
        scenario.locked.iter().for_each(|&rate| engine.lock(rate));
        scenario.limits.iter().try_for_each(|task| engine.limit(task.clone())).map_err(Refusal::of)?;
        Ok(Self { engine, dragged })
    }

    /// One step of the dragged point toward a place in ground, m.
    pub(crate) fn drag(&mut self, body: &Body, posture: &mut Posture, target: Vector3<f64>) -> Result<Moved, Refusal> {
        let Some(Dragged { level, segment, point, sliding }) = self.dragged else {
            return Err(Refusal::of("nothing is grabbed; `grab` comes before `drag`"));
        };
        let at = body.kinematics(posture)?.station(&body.model, segment, point);
        let target = if sliding { Vector3::new(target.x, at.y, target.z) } else { target };
        let way = target - at;
        let near = at + way * (REACH / way.norm()).min(1.0);
        if let Some(Task::Point(task)) = self.engine.levels_mut()[level].tasks.first_mut() {
            task.target = if near.iter().all(|x| x.is_finite()) { near } else { at };
        }
        self.engine.widen_trust_region();
        let step = self.engine.step(posture).map_err(Refusal::of)?;
        let at = body.kinematics(posture)?.station(&body.model, segment, point);
        Ok(Moved { miss: Some((target - at).norm()), settled: step.largest <= SETTLED })
    }

    /// One step toward least effort.
    pub(crate) fn settle(&mut self, posture: &mut Posture) -> Result<Moved, Refusal> {
        let step = self.engine.step(posture).map_err(Refusal::of)?;
        Ok(Moved { miss: None, settled: step.largest <= SETTLED && !step.rejected_previous })
    }
}
