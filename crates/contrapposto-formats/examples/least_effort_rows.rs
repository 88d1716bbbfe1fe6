//! Evaluates the quantities of which a problem of least effort is made, for an optimiser outside: `scripts/effort_by_slsqp.py`.
//!
//! `least_effort_rows SCENARIO.toml` reads the scenario as `relax` does and prints one line of JSON: names, ranges, supports, tasks above
//! effort. Then, for every request on standard input (the values of all coordinates in rad and m, then the force of every corner of every
//! support along the axes of ground in N; little-endian numbers of 8 bytes), it writes to standard output, in the same form:
//!
//! 1. active torque of every rate about its axis, N m (N for slides);
//! 2. relative load of every coordinate whose effort counts, and its derivatives by the rates, row after row;
//! 3. strength of the muscle group that works there, N m;
//! 4. derivatives of the external torque of the root's rates by the rates, row after row;
//! 5. torque of every rate about its axis by 1 N along each axis of ground at each corner, one row a force;
//! 6. of every row of every task: lower and upper limit of the change that it asks for, and its derivatives by the rates.
//!
//! The objective, the constraints and all that is known of contact are put together by the optimiser.

#![allow(clippy::print_stdout)]

use std::io::{Read, Write};

use contrapposto::contact::{Place, root_rates};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Side;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::tasks::{Effort, Task, free_place, held_place};
use contrapposto_formats::{RelaxScenario, read_relax};
use hierarchical_least_squares::Level;
use nalgebra::Vector3;
use serde_json::json;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

/// A task above effort: where it stands, its name, and itself.
struct Above {
    place: String,
    label: String,
    task: Task,
}

struct Problem {
    scenario: RelaxScenario,
    effort: Effort,
    root: Vec<usize>,
    above: Vec<Above>,
    /// Segment and point of every corner.
    corners: Vec<(usize, Vector3<f64>)>,
}

fn main() -> Fallible<()> {
    let path = std::env::args().nth(1).ok_or("the file of a scenario is missing")?;
    let scenario = read_relax(&path, &std::fs::read(&path)?, None)?;
    let problem = Problem::new(scenario)?;
    println!("{}", problem.header());
    problem.serve()
}

impl Problem {
    fn new(scenario: RelaxScenario) -> Fallible<Self> {
        let model = &scenario.model;
        if !model.couplings().is_empty() || model.rates().len() != model.coordinates().len() {
            return Err("coordinates that follow others, and balls, are not known to the optimiser".into());
        }
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, &scenario.start)?;
        let mut above: Vec<Above> = vec![];
        for support in &scenario.supports {
            let label = model.segments()[support.segment].name.clone();
            let task = held_place(support, model, &kinematics);
            if above.iter().all(|known| known.task != task) {
                let region = free_place(support, model, &kinematics);
                let region = region.map(|task| Above { place: "region".into(), label: label.clone(), task });
                above.push(Above { place: "support".into(), label, task });
                above.extend(region);
            }
        }
        let limits = scenario.limits.iter().cloned();
        above.extend(limits.map(|task| Above { place: "limit".into(), label: task.label(model), task }));
        let mut effort = None;
        for (i, (goal, labels)) in scenario.goals.iter().zip(&scenario.labels).enumerate() {
            if !goal.half_spaces.is_empty() {
                return Err("half-spaces above effort are not known to the optimiser".into());
            }
            match goal.tasks.as_slice() {
                [Task::Effort(task)] => effort = Some(task.clone()),
                tasks if tasks.iter().any(|task| matches!(task, Task::Effort(_))) => {
                    return Err("effort shares its level with other tasks".into());
                }
                tasks => above.extend(tasks.iter().zip(labels).map(|(task, label)| Above {
                    place: format!("level {i}"),
                    label: label.clone(),
                    task: task.clone(),
                })),
            }
            if effort.is_some() {
                break;
            }
        }
        let corners =
            scenario.supports.iter().flat_map(|support| support.corners.iter().map(|point| (support.segment, *point)));
        let corners = corners.collect();
        let root = root_rates(model).into_iter().filter(|rate| !scenario.locked.contains(rate)).collect();
        Ok(Self { effort: effort.ok_or("no level asks for effort")?, root, above, corners, scenario })
    }

    fn header(&self) -> serde_json::Value {
        let RelaxScenario { model, supports, .. } = &self.scenario;
        let coordinates = model.coordinates();
        let supports = supports.iter().map(|support| {
            json!({
                "segment": model.segments()[support.segment].name,
                "corners": support.corners.len(),
                "normal": support.normal.as_slice(),
                "friction": support.friction.is_finite().then_some(support.friction),
                "share_max": support.share_max,
                "free": support.place != Place::Fixed,
            })
        });
        let tasks = self
            .above
            .iter()
            .map(|above| json!({ "place": above.place, "label": above.label, "rows": above.task.rows() }));
        let locked = |i: usize| coordinates[i].locked || self.scenario.locked.contains(&i);
        json!({
            "title": self.scenario.title,
            "coordinates": coordinates.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
            "low": coordinates.iter().map(|c| c.range.0).collect::<Vec<_>>(),
            "high": coordinates.iter().map(|c| c.range.1).collect::<Vec<_>>(),
            "locked": (0..coordinates.len()).map(locked).collect::<Vec<_>>(),
            "start": self.scenario.start.values(),
            "root": self.root,
            "effort": self.effort.coordinates,
            "weight_n": model.mass() * model.gravity().norm(),
            "supports": supports.collect::<Vec<_>>(),
            "tasks": tasks.collect::<Vec<_>>(),
        })
    }

    fn serve(&self) -> Fallible<()> {
        let model = &self.scenario.model;
        let (mut body, mut posture) = (JointTorques::new(model), self.scenario.start.clone());
        let mut request = vec![0; 8 * (posture.values().len() + 3 * self.corners.len())];
        let (mut input, mut output) = (std::io::stdin().lock(), std::io::stdout().lock());
        let needs = Quantities { gradient: true, ..Quantities::ALL };
        while input.read_exact(&mut request).is_ok() {
            let mut numbers =
                request.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap_or_default()));
            posture.values_mut().iter_mut().zip(&mut numbers).for_each(|(value, given)| *value = given);
            let forces: Vec<f64> = numbers.collect();
            let mut loads = self.scenario.loads.clone();
            loads.extend(self.corners.iter().zip(forces.chunks_exact(3)).map(|(&(segment, point), force)| {
                let kind = LoadKind::Force(Vector3::from_column_slice(force), FixedIn::World);
                Load { segment, point, kind }
            }));
            body.update(model, &posture, &loads, needs)?;
            let answer: Vec<u8> = self.answer(&body).into_iter().flat_map(f64::to_le_bytes).collect();
            output.write_all(&answer)?;
            output.flush()?;
        }
        Ok(())
    }

    fn answer(&self, body: &JointTorques) -> Vec<f64> {
        let model = &self.scenario.model;
        let n = model.rates().len();
        let mut answer = body.active_torque().to_vec();
        let mut level = Level::default();
        Task::Effort(self.effort.clone()).evaluate(model, body, &mut level);
        answer.extend(level.upper.iter().map(|upper| -upper));
        answer.extend_from_slice(&level.matrix);
        for &i in &self.effort.coordinates {
            let side = Side::of(model.coordinates()[i].rate.map_or(0.0, |rate| body.active_torque()[rate]));
            let groups = model.coordinates()[i].groups.as_ref();
            answer.push(groups.map_or(f64::INFINITY, |groups| groups[side.index()].strength.torque(body.angles()[i])));
        }
        for &rate in &self.root {
            answer.extend_from_slice(body.gradient().row(rate));
        }
        let mut jacobian = vec![0.0; 3 * n];
        for &(segment, point) in &self.corners {
            body.kinematics_by_axes().point_jacobian(model.by_axes(), segment, point, &mut jacobian);
            answer.extend_from_slice(&jacobian);
        }
        for above in &self.above {
            level.clear();
            above.task.evaluate(model, body, &mut level);
            for (i, row) in level.matrix.chunks_exact(n).enumerate() {
                answer.extend([level.lower[i], level.upper[i]]);
                answer.extend_from_slice(row);
            }
        }
        answer
    }
}
