//! Computes the sum of second derivatives of the errors of tasks, `sum_i w_i r_i''`.
//!
//! Loads whose generalised forces are `sum_i w_i grad r_i` change with the posture as that sum does: it is their
//! gradient of external torque (Eqs. 7, 8).

use nalgebra::Vector3;

use super::bounds::Carried;
use super::center_of_mass::CenterOfMassGoal;
use super::height::Height;
use super::look_at::LookAtGoal;
use super::task::Task;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};

/// Workspace of the sum. Filled by [`ErrorHessian::add`], one task at a time.
#[derive(Clone, Debug)]
pub(crate) struct ErrorHessian {
    loads: Vec<Load>,
    /// Heights, whose axes turn with a segment as no load does, and their weights.
    heights: Vec<(Height, f64)>,
    torque: ExternalTorque,
    gradient: Gradient,
}

impl ErrorHessian {
    /// Space for `tasks`: the loads of each act at two places a pair at most, or at all segments.
    pub(crate) fn new<'t>(model: &Model, tasks: impl Iterator<Item = &'t Task>) -> Self {
        let tasks: Vec<&Task> = tasks.collect();
        let heights = tasks.iter().filter(|task| matches!(task, Task::Height(_))).count();
        let loads = tasks.iter().map(|task| match task {
            Task::Clearance(task) => 2 * task.pairs.len(),
            Task::Bounds(task) => 2 * task.components.len(),
            _ => 2 + model.segments().len(),
        });
        Self {
            loads: Vec::with_capacity(loads.sum()),
            heights: Vec::with_capacity(heights),
            torque: ExternalTorque::new(model),
            gradient: Gradient::new(model),
        }
    }

    /// Takes all tasks away.
    pub(crate) fn clear(&mut self) {
        self.loads.clear();
        self.heights.clear();
    }

    /// Adds the errors of a task, one weight each, in the posture of `kinematics`.
    pub(crate) fn add(&mut self, model: &Model, kinematics: &Kinematics, task: &Task, weights: &[f64]) {
        if let (Task::Height(height), [weight, ..]) = (task, weights) {
            self.heights.push((*height, *weight));
        }
        add_gradient_loads(task, model, kinematics, weights, &mut self.loads);
    }

    /// The sum in the posture of `kinematics`; its symmetric part counts. `None` for weights beyond the loads that a
    /// model accepts (1e9).
    pub(crate) fn evaluate(&mut self, model: &Model, kinematics: &Kinematics) -> Option<&Gradient> {
        self.torque.update_weightless(model, kinematics, &self.loads).ok()?;
        self.torque.gradient(model, kinematics, &mut self.gradient);
        for (height, weight) in &self.heights {
            height.add_second_derivative(model, kinematics, *weight, &mut self.gradient);
        }
        Some(&self.gradient)
    }
}

/// Adds the loads whose generalised forces are `sum weights_i grad r_i` of its rows, exact where the errors of rotations are zero.
/// Tasks of directions toward a place, distances, postures and effort are left out: their second derivatives are not known here.
/// Of a clearance the loads stay at the points that are closest now, along the line between them: the turning of that line, and the
/// motion of the closest points in their segments, are left out.
fn add_gradient_loads(task: &Task, model: &Model, kinematics: &Kinematics, weights: &[f64], loads: &mut Vec<Load>) {
    let world = |segment, point, force| Load { segment, point, kind: LoadKind::Force(force, FixedIn::World) };
    let couple = |segment, v| Load { segment, point: Vector3::zeros(), kind: LoadKind::Couple(v, FixedIn::World) };
    let vector = |v: &[f64]| Vector3::new(v[0], v[1], v[2]);
    match task {
        Task::Point(task) => loads.push(world(task.segment, task.point, spread(task.axes, weights))),
        Task::Orientation(task) => loads.push(couple(task.segment, vector(weights))),
        Task::Placement(task) => {
            loads.push(world(task.segment, task.point, vector(weights)));
            loads.push(couple(task.segment, vector(&weights[3..])));
        }
        Task::Bounds(task) => {
            for (component, w) in task.components.iter().zip(weights) {
                let force = *w * component.along.into_inner();
                match component.of {
                    Carried::Point(point) => loads.push(world(task.segment, point, force)),
                    Carried::Direction(direction) => {
                        loads.push(world(task.segment, direction.into_inner(), force));
                        loads.push(world(task.segment, Vector3::zeros(), -force));
                    }
                }
            }
        }
        Task::CenterOfMass(task) => {
            let force = match &task.goal {
                CenterOfMassGoal::At { axes, .. } => spread(*axes, weights),
                CenterOfMassGoal::Inside { polygon, .. } => {
                    polygon.iter().zip(weights).map(|(edge, w)| edge.normal * *w).sum()
                }
            };
            let mass = model.mass();
            for (i, segment) in model.segments().iter().enumerate().filter(|(_, segment)| segment.mass > 0.0) {
                loads.push(world(i, segment.center_of_mass, force * (segment.mass / mass)));
            }
        }
        Task::Clearance(task) => {
            for (pair, weight) in task.pairs.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                if let Some(nearest) = pair.nearest(model, kinematics, task.activation) {
                    let stations = nearest.stations(pair);
                    loads.extend(stations.map(|(segment, point, along)| world(segment, point, *weight * along)));
                }
            }
        }
        Task::LookAt(task) => {
            // At error zero the rows are `-d . v` and `d . u`, with `d` fixed in ground and `u`, `v` in the segment: the distance
            // along `d` of one point of the segment from another.
            let LookAtGoal::Direction(wanted) = task.goal else { return };
            let [u, v, _] = task.axes();
            let span = u * weights[1] - v * weights[0];
            let size = span.norm();
            if size > 0.0 {
                let force = wanted.into_inner() * size;
                loads.push(world(task.segment, span / size, force));
                loads.push(world(task.segment, Vector3::zeros(), -force));
            }
        }
        Task::Height(_) | Task::Distance(_) | Task::Posture(_) | Task::Effort(_) => {}
    }
}

/// A vector with the given entries on the asked axes, 0 on the others.
fn spread(axes: [bool; 3], weights: &[f64]) -> Vector3<f64> {
    let mut weights = weights.iter();
    Vector3::from_fn(|k, _| if axes[k] { weights.next().copied().unwrap_or(0.0) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Unit, UnitQuaternion, Vector3};
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::joint_torques::{JointTorques, Quantities};
    use crate::model::{Adult, adult};
    use crate::tasks::{self, Task};

    /// Along a random direction, where the errors of the rotations are zero.
    #[test]
    fn weighted_sum_of_errors_has_second_differences_equal_to_the_hessian() {
        let mut random = Pcg64Mcg::new(11);
        let model = adult(&Adult::default()).unwrap();
        let n = model.rates().len();
        let mut worst = 0f64;
        for _ in 0..20 {
            let mut posture = model.default_posture();
            for (value, coordinate) in posture.values_mut().iter_mut().zip(model.coordinates()) {
                *value += random.random_range(-0.3..0.3) * (coordinate.range.1 - coordinate.range.0).min(1.0);
            }
            let mut body = JointTorques::new(&model);
            let needs = Quantities { center_of_mass: true, ..Quantities::default() };
            body.update(&model, &posture, &[], needs).unwrap();
            let hand = model.segment("hand_r").unwrap();
            let head = model.segment("head").unwrap();
            let foot = model.segment("calcn_l").or_else(|| model.segment("foot_l")).unwrap();
            let tasks = [
                Task::Point(tasks::Point {
                    segment: hand,
                    point: Vector3::new(0.01, -0.1, 0.02),
                    target: Vector3::new(1.0, 2.0, 0.5),
                    axes: [true, false, true],
                }),
                Task::Placement(tasks::Placement {
                    segment: foot,
                    point: Vector3::zeros(),
                    target: body.kinematics().placement(&model, foot),
                }),
                Task::CenterOfMass(tasks::CenterOfMass {
                    goal: tasks::CenterOfMassGoal::At { target: Vector3::zeros(), axes: [true, false, true] },
                }),
                Task::Bounds(tasks::Bounds {
                    segment: foot,
                    components: [
                        Carried::Point(Vector3::new(0.1, 0.02, -0.03)),
                        Carried::Direction(Vector3::x_axis()),
                        Carried::Direction(Vector3::y_axis()),
                    ]
                    .map(|of| tasks::Component { of, along: Vector3::z_axis(), limits: (0.0, 0.0) })
                    .to_vec(),
                }),
                Task::Orientation(tasks::Orientation {
                    segment: hand,
                    target: UnitQuaternion::from(body.kinematics().placement(&model, hand).rotation),
                }),
                Task::LookAt(tasks::LookAt {
                    segment: head,
                    eye: Vector3::zeros(),
                    direction: Vector3::y_axis(),
                    goal: LookAtGoal::Direction(Unit::new_normalize(body.kinematics().direction(
                        &model,
                        head,
                        Vector3::y(),
                    ))),
                }),
                Task::Height(tasks::Height {
                    segment: hand,
                    point: Vector3::new(0.02, -0.1, 0.03),
                    above: model.segment("torso").unwrap(),
                    along: Unit::new_normalize(Vector3::new(0.3, 0.9, -0.2)),
                    height: 0.1,
                }),
                // Of spheres above a floor nothing is left out.
                Task::Clearance(tasks::Clearance {
                    activation: 10.0,
                    pairs: (tasks::Clearance::of_body(&model, &[tasks::Thing::floor(3.0)], &[]).unwrap().pairs)
                        .into_iter()
                        .filter(|pair| matches!(pair.other, tasks::Obstacle::Thing(_)))
                        .collect(),
                    margin: 0.0,
                }),
            ];
            let weights: Vec<f64> =
                (0..tasks.iter().map(Task::rows).sum()).map(|_| random.random_range(-1.0..1.0)).collect();
            let direction: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut along = |h: f64| {
                let mut moved = posture.clone();
                moved.displace(&model, &direction.iter().map(|d| d * h).collect::<Vec<_>>());
                body.update(&model, &moved, &[], needs).unwrap();
                let mut errors = vec![];
                tasks.iter().for_each(|task| task.residual(&model, &body, &mut errors));
                errors.iter().zip(&weights).map(|(e, w)| e * w).sum::<f64>()
            };
            let h = 1e-3;
            let (a, c, b) = (along(-h), along(h), along(0.0));
            let numeric = (a - 2.0 * b + c) / (h * h);
            let mut hessian = ErrorHessian::new(&model, tasks.iter());
            let mut rest = &weights[..];
            for task in &tasks {
                let (own, others) = rest.split_at(task.rows());
                hessian.add(&model, body.kinematics(), task, own);
                rest = others;
            }
            body.update(&model, &posture, &[], needs).unwrap();
            let matrix = hessian.evaluate(&model, body.kinematics()).unwrap();
            let exact: f64 =
                (0..n).map(|i| (0..n).map(|j| direction[i] * matrix.get(i, j) * direction[j]).sum::<f64>()).sum();
            worst = worst.max((numeric - exact).abs() / (1.0 + exact.abs()));
        }
        assert!(worst < 1e-4, "{worst}");
    }
}
