//! The published peer problem: `ik_targets_human48.json` beside the project, a 48-joint human on a free root, both feet placed,
//! the centre of mass over them, the right hand on a target, the head upright, the rest posture: five strict levels.

use contrapposto::kinematics::{self, Kinematics};
use contrapposto::model::{Model, Placement};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{self, CenterOfMass, Orientation, Point, Task};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::urdf;
use hierarchical_least_squares::{Level, Problem, Solver};
use nalgebra::{Matrix3, Translation3, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;
use serde_json::Value;

use super::shared::shared;

pub struct Peer {
    pub model: Model,
    pub file: Value,
    pub rest: Posture,
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn rotation(value: &Value) -> UnitQuaternion<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    UnitQuaternion::from_matrix(&Matrix3::from_fn(|i, j| rows[i][j]))
}

impl Peer {
    /// Reads the problem from `../shared`.
    pub fn read() -> Self {
        let bytes = std::fs::read(shared("models/human-gazebo/humanSubject01_48dof.urdf")).unwrap();
        let text = std::fs::read(shared("vectors/ik_targets_human48.json")).unwrap();
        let options = urdf::Options { root: RootAttachment::Free, ..urdf::Options::default() };
        let model = urdf::read(&bytes, "human48", &options).unwrap().model().unwrap().model;
        let file: Value = serde_json::from_slice(&text).unwrap();
        // x y z, quaternion x y z w, then the joints by name.
        let names: Vec<&str> =
            file["joint_names"].as_array().unwrap()[2..].iter().map(|n| n.as_str().unwrap()).collect();
        let q = numbers(&file["rest_q"]);
        let place = |name: &str| match name {
            "root_tx" => 0,
            "root_ty" => 1,
            "root_tz" => 2,
            "root_qx" => 3,
            "root_qy" => 4,
            "root_qz" => 5,
            "root_qw" => 6,
            joint => 7 + names.iter().position(|n| *n == joint).unwrap(),
        };
        let rest = Posture::new(model.coordinates().iter().map(|c| q[place(&c.name)]).collect());
        Self { model, file, rest }
    }

    fn segment(&self, name: &str) -> usize {
        self.model.segment(name).unwrap()
    }

    /// The segment that is to reach the target.
    pub fn hand(&self) -> usize {
        self.segment("RightHandCOM")
    }

    fn foot(&self, segment: &str, side: &str) -> Task {
        let feet = &self.file["feet"];
        let place = Vector3::from_vec(numbers(&feet[format!("{side}_pos")]));
        let target = Placement::from_parts(Translation3::from(place), rotation(&feet[format!("{side}_rot")]));
        Task::Placement(tasks::Placement { segment: self.segment(segment), point: Vector3::zeros(), target })
    }

    pub fn goals(&self, target: Vector3<f64>) -> Vec<PriorityLevel> {
        let com = numbers(&self.file["com_xy_target"]);
        let com = tasks::CenterOfMassGoal::At { target: Vector3::new(com[0], com[1], 0.0), axes: [true, true, false] };
        let joint = |rate: &contrapposto::model::Rate| rate.coordinate.is_some() && !rate.name.starts_with("root_");
        let weights = self.model.rates().iter().map(|rate| f64::from(joint(rate))).collect();
        let feet = vec![self.foot("LeftFoot", "left"), self.foot("RightFoot", "right")];
        let hand = Point { segment: self.hand(), point: Vector3::zeros(), target, axes: [true; 3] };
        let head = Orientation { segment: self.segment("Head"), target: rotation(&self.file["head_rot_target"]) };
        vec![
            PriorityLevel { tasks: feet, hard: true, ..PriorityLevel::default() },
            Task::CenterOfMass(CenterOfMass { goal: com }).into(),
            Task::Point(hand).into(),
            Task::Orientation(head).into(),
            Task::Posture(tasks::Posture { target: self.rest.clone(), weights }).into(),
        ]
    }

    /// Greatest distance of a joint from its range, rad.
    pub fn excess(&self, posture: &Posture) -> f64 {
        let out = |(c, v): (&contrapposto::model::Coordinate, &f64)| (c.range.0 - v).max(v - c.range.1);
        self.model.coordinates().iter().zip(posture.values()).map(out).fold(0.0, f64::max)
    }

    /// Distance by which the hand comes nearer to first order, m, by the best step of at most `room` that keeps feet, centre of mass
    /// and ranges.
    pub fn gain(&self, posture: &Posture, target: Vector3<f64>, room: f64) -> f64 {
        let model = &self.model;
        let n = model.rates().len();
        let mut body = Kinematics::new(model);
        body.update(model, posture).unwrap();
        let mut problem = Problem::new(n);
        let mut rows = vec![0.0; 3 * n];
        let mut level = Level::default();
        for foot in ["LeftFoot", "RightFoot"] {
            body.point_jacobian(model, self.segment(foot), Vector3::zeros(), &mut rows);
            rows.chunks_exact(n).for_each(|row| level.push(row, 0.0, 0.0));
            body.rotation_jacobian(model, self.segment(foot), &mut rows);
            rows.chunks_exact(n).for_each(|row| level.push(row, 0.0, 0.0));
        }
        let mut center = kinematics::CenterOfMass::new(model);
        center.update(model, &body);
        center.jacobian(model, &body, &mut rows);
        rows.chunks_exact(n).take(2).for_each(|row| level.push(row, 0.0, 0.0));
        problem.levels.push(level);
        let hand = self.hand();
        let error = target - body.station(model, hand, Vector3::zeros());
        body.point_jacobian(model, hand, Vector3::zeros(), &mut rows);
        let mut level = Level::default();
        rows.chunks_exact(n).zip(error.iter()).for_each(|(row, e)| level.push(row, *e, *e));
        problem.levels.push(level);
        for (i, rate) in model.rates().iter().enumerate() {
            let (mut lower, mut upper) = (-room, room);
            if let Some(c) = rate.coordinate {
                let (range, value) = (model.coordinates()[c].range, posture.values()[c]);
                (lower, upper) = ((range.0 - value).clamp(-room, 0.0), (range.1 - value).clamp(0.0, room));
            }
            (problem.lower[i], problem.upper[i]) = (lower, upper);
        }
        let mut solver = Solver::new();
        solver.solve(&problem).unwrap();
        assert!(solver.residual_norm(0) < 1e-12);
        error.norm() - solver.residual_norm(1)
    }

    /// A random posture that keeps feet, centre of mass and ranges, and where its right hand is: surely within reach. Drawn as the
    /// published targets are: right arm anywhere, spine and left arm in half their ranges, hips and knees bent up to 1.3 rad.
    pub fn reachable(&self, rng: &mut Pcg64) -> (Vector3<f64>, Posture) {
        let mut kinematics = Kinematics::new(&self.model);
        loop {
            let mut wanted = self.rest.clone();
            for (i, coordinate) in self.model.coordinates().iter().enumerate() {
                let (name, (lower, upper)) = (coordinate.name.as_str(), coordinate.range);
                let named = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
                let (lower, upper) = if named(&["jRightC7", "jRightShoulder", "jRightElbow", "jRightWrist"]) {
                    (lower, upper)
                } else if named(&["jLeftC7", "jLeftShoulder", "jLeftElbow", "jLeftWrist", "jL5", "jL4", "jL1", "jT9"]) {
                    (0.5 * lower, 0.5 * upper)
                } else if named(&["Hip_roty", "Knee_roty"]) {
                    if -lower > upper { (lower.max(-1.3), 0.0) } else { (0.0, upper.min(1.3)) }
                } else {
                    continue;
                };
                wanted.values_mut()[i] = lower + (upper - lower) * rng.random::<f64>();
            }
            // Feet and centre of mass as asked, and everything else as near to the wanted posture as that allows.
            let mut goals = self.goals(Vector3::zeros());
            goals.drain(2..4);
            let Some([Task::Posture(tasks::Posture { target, .. })]) = goals.last_mut().map(|goal| &mut goal.tasks[..])
            else {
                panic!("the last goal is a posture");
            };
            target.clone_from(&wanted);
            let pose =
                Engine::new(&self.model, goals, &[], Options::inverse_kinematics()).unwrap().solve(&wanted).unwrap();
            if pose.levels[..2].iter().all(|level| level.length < 1e-9) && self.excess(&pose.posture) == 0.0 {
                kinematics.update(&self.model, &pose.posture).unwrap();
                return (kinematics.station(&self.model, self.hand(), Vector3::zeros()), pose.posture);
            }
        }
    }

    /// A target out of reach: overhead for an even `i`, far in front and beside for an odd one, as the published ones.
    pub fn out_of_reach(&self, i: usize, rng: &mut Pcg64) -> Vector3<f64> {
        let mut within = |lower: f64, upper: f64| lower + (upper - lower) * rng.random::<f64>();
        if i.is_multiple_of(2) {
            return Vector3::new(within(-0.4, 0.4), within(-0.5, 0.0), within(2.4, 3.2));
        }
        let (distance, angle) = (within(1.8, 2.8), within(-0.6, 0.6));
        Vector3::new(distance * libm::cos(angle), distance * libm::sin(angle), within(0.5, 1.6))
    }
}

pub fn target(case: &Value) -> Vector3<f64> {
    Vector3::from_vec(numbers(&case["target"]))
}
