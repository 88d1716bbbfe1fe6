//! Compares torques, gradients and Jacobians with numbers of Pinocchio, MuJoCo and OpenSim: of small models that our writers
//! wrote (`written/`, made by `scripts/written_models.py`) and of published models (`../shared`).
//!
//! The tools print the torques that actuators must supply; our external torque is minus that.

use crate::common::shared;

use std::path::Path;

use contrapposto::kinematics::{CenterOfMass, Kinematics};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{mjcf, osim, urdf};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

/// A file of `written/` beside this one or, with a folder in its path, of `../shared`.
fn bytes(path: &str) -> Vec<u8> {
    let written = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written").join(path);
    std::fs::read(if path.contains('/') { shared::shared(path) } else { written }).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

/// Greatest difference over the greatest size.
fn relative(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let size = theirs.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
    ours.iter().zip(theirs).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / size
}

struct Body {
    model: Model,
    kinematics: Kinematics,
    external: ExternalTorque,
}

impl Body {
    fn new(model: Model) -> Self {
        let (kinematics, external) = (Kinematics::new(&model), ExternalTorque::new(&model));
        Self { model, kinematics, external }
    }

    fn set(&mut self, values: Vec<f64>, loads: &[Load]) {
        self.kinematics.update(&self.model, &Posture::new(values)).unwrap();
        self.external.update(&self.model, &self.kinematics, loads).unwrap();
    }

    /// Rows of a Jacobian that `fill` writes.
    fn jacobian(&self, fill: impl Fn(&Model, &Kinematics, &mut [f64])) -> Vec<Vec<f64>> {
        let n = self.model.rates().len();
        let mut rows = vec![f64::NAN; 3 * n];
        fill(&self.model, &self.kinematics, &mut rows);
        rows.chunks(n).map(<[f64]>::to_vec).collect()
    }

    fn center_jacobian(&self) -> Vec<Vec<f64>> {
        let mut center = CenterOfMass::new(&self.model);
        center.update(&self.model, &self.kinematics);
        self.jacobian(|model, kinematics, rows| center.jacobian(model, kinematics, rows))
    }

    fn origin_jacobian(&self, segment: usize) -> Vec<Vec<f64>> {
        self.jacobian(|model, kinematics, rows| kinematics.point_jacobian(model, segment, Vector3::zeros(), rows))
    }

    fn rotation_jacobian(&self, segment: usize) -> Vec<Vec<f64>> {
        self.jacobian(|model, kinematics, rows| kinematics.rotation_jacobian(model, segment, rows))
    }

    fn gradient(&self) -> Vec<Vec<f64>> {
        let mut gradient = Gradient::new(&self.model);
        self.external.gradient(&self.model, &self.kinematics, &mut gradient);
        (0..gradient.size()).map(|row| gradient.row(row).to_vec()).collect()
    }
}

/// Generalised forces of a freed root, or a row of derivatives by its rates, ours (translations in world axes) to Pinocchio's
/// (in the root's own).
fn to_local(rotation: &Matrix3<f64>, ours: &[f64]) -> Vec<f64> {
    let linear = rotation.transpose() * Vector3::from_column_slice(&ours[..3]);
    linear.iter().chain(&ours[3..]).copied().collect()
}

/// The same for a gradient: rows and columns turn, and turning the root turns the axes of its own force.
fn gradient_to_local(rotation: &Matrix3<f64>, torque: &[f64], ours: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = ours.len();
    let columns: Vec<Vec<f64>> = (0..n).map(|j| ours.iter().map(|row| row[j]).collect()).collect();
    let turned_rows: Vec<Vec<f64>> = columns.iter().map(|column| to_local(rotation, column)).collect();
    let mut result: Vec<Vec<f64>> =
        (0..n).map(|i| to_local(rotation, &turned_rows.iter().map(|column| column[i]).collect::<Vec<_>>())).collect();
    let force = rotation.transpose() * Vector3::from_column_slice(&torque[..3]);
    for j in 0..3 {
        let axis = Vector3::from_fn(|i, _| f64::from(u8::from(i == j)));
        let change = -axis.cross(&force);
        for i in 0..3 {
            result[i][3 + j] += change[i];
        }
    }
    result
}

fn pinocchio(vectors: &str, file: &str, root: RootAttachment) {
    let (vectors, file_bytes) = (bytes(vectors), bytes(file));
    let vectors: Value = serde_json::from_slice(&vectors).unwrap();
    let options = urdf::Options { root, ..urdf::Options::default() };
    let imported = urdf::read(&file_bytes, file, &options).unwrap().model().unwrap();
    let free = root == RootAttachment::Free;
    let names: Vec<&str> = vectors["joint_names"]
        .as_array()
        .unwrap()
        .iter()
        .skip(if free { 2 } else { 1 })
        .map(|x| x.as_str().unwrap())
        .collect();
    let mut body = Body::new(imported.model);
    let model = body.model.clone();
    // Our rate of each of Pinocchio's.
    let rates: Vec<usize> = (0..if free { 6 } else { 0 })
        .chain(names.iter().map(|name| model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap()))
        .collect();
    assert_eq!(rates.len(), vectors["nv"].as_u64().unwrap() as usize);
    let pick = |row: &[f64]| -> Vec<f64> { rates.iter().map(|&rate| row[rate]).collect() };
    let hand = model.segment(vectors["force_frame"].as_str().unwrap()).unwrap();
    let (mut torque, mut slope, mut mass, mut frame, mut moves) = (0f64, 0f64, 0f64, 0f64, 0f64);
    for case in vectors["cases"].as_array().unwrap() {
        let q = numbers(&case["q"]);
        let mut values = model.default_posture().values().to_vec();
        let angles = if free {
            values[..3].copy_from_slice(&q[..3]);
            values[3..7].copy_from_slice(&[q[6], q[3], q[4], q[5]]);
            &q[7..]
        } else {
            &q[..]
        };
        for (name, &angle) in names.iter().zip(angles) {
            values[model.coordinate(name).unwrap()] = angle;
        }
        body.set(values.clone(), &[]);
        let rotation = if free {
            let moved = (0..model.segments().len()).find(|&s| model.segments()[s].parent.is_none()).unwrap();
            body.kinematics.placement(&model, moved).rotation.to_rotation_matrix().into_inner()
        } else {
            Matrix3::identity()
        };
        let convert = |torque: &[f64]| -> Vec<f64> {
            let picked: Vec<f64> = pick(torque).iter().map(|x| -x).collect();
            if free { to_local(&rotation, &picked) } else { picked }
        };
        let convert_gradient = |torque: &[f64], gradient: &[Vec<f64>]| -> Vec<f64> {
            let picked: Vec<Vec<f64>> =
                rates.iter().map(|&rate| pick(&gradient[rate]).iter().map(|x| -x).collect()).collect();
            let negative: Vec<f64> = pick(torque).iter().map(|x| -x).collect();
            let picked = if free { gradient_to_local(&rotation, &negative, &picked) } else { picked };
            picked.concat()
        };
        torque = torque.max(relative(&convert(body.external.torques()), &numbers(&case["g"])));
        let ours = convert_gradient(body.external.torques(), &body.gradient());
        slope = slope.max(relative(&ours, &matrix(&case["dg_dq"]).concat()));
        // Centre of mass; Pinocchio leaves out what is fixed to the ground.
        let total = model.mass();
        let root_mass = vectors["root_link_mass_at_universe"].as_f64().unwrap();
        let root = &model.segments()[0];
        let mut center = body.kinematics.center_of_mass(&model).unwrap() * total;
        if root_mass > 0.0 {
            let fixed = &vectors["center_of_mass_at_universe"];
            let station = body.kinematics.station(&model, 0, root.center_of_mass);
            center -= root_mass * if fixed.is_null() { station } else { vector(fixed) };
        }
        center /= total - root_mass;
        mass = mass.max((center - vector(&case["com"])).norm());
        let right = model.segment(vectors["right_hand_frame"].as_str().unwrap()).unwrap();
        let position = body.kinematics.placement(&model, right).translation.vector;
        frame = frame.max((position - vector(&case["right_hand_pos"])).norm());
        let convert_rows = |rows: &[Vec<f64>]| -> Vec<f64> {
            let picked = rows.iter().map(|row| pick(row));
            picked.flat_map(|row| if free { to_local(&rotation, &row) } else { row }).collect()
        };
        let mut ours = convert_rows(&body.center_jacobian());
        ours.iter_mut().for_each(|entry| *entry *= total / (total - root_mass));
        moves = moves.max(relative(&ours, &matrix(&case["J_com"]).concat()));
        for side in ["right", "left"] {
            let segment = model.segment(vectors[format!("{side}_hand_frame")].as_str().unwrap()).unwrap();
            let theirs = matrix(&case[format!("J_{side}_hand")]);
            let (linear, angular) = (body.origin_jacobian(segment), body.rotation_jacobian(segment));
            moves = moves.max(relative(&convert_rows(&linear), &theirs[..3].concat()));
            moves = moves.max(relative(&convert_rows(&angular), &theirs[3..].concat()));
        }
        // Static torque with a wrench at the hand, turning with it or not.
        let (force, couple) = (vector(&case["f_world"]), vector(&case["m_world"]));
        let back = body.kinematics.placement(&model, hand).rotation.inverse();
        for (fixed_in, key) in [
            (FixedIn::World, "dtau_static_dq_wrench_const_in_world"),
            (FixedIn::Segment, "dtau_static_dq_wrench_const_in_body"),
        ] {
            let turn = |v: Vector3<f64>| if fixed_in == FixedIn::World { v } else { back * v };
            let load = |kind| Load { segment: hand, point: Vector3::zeros(), kind };
            let loads = [load(LoadKind::Force(turn(force), fixed_in)), load(LoadKind::Couple(turn(couple), fixed_in))];
            body.set(values.clone(), &loads);
            torque = torque.max(relative(&convert(body.external.torques()), &numbers(&case["tau_static"])));
            let ours = convert_gradient(body.external.torques(), &body.gradient());
            slope = slope.max(relative(&ours, &matrix(&case[key]).concat()));
        }
    }
    println!(
        "{file}, {root:?}: torque {torque:.1e}, gradient {slope:.1e}, centre of mass {mass:.1e} m, hand {frame:.1e} m, \
         Jacobians {moves:.1e}"
    );
    assert!(torque < 1e-9 && slope < 1e-9 && mass < 1e-9 && frame < 1e-9 && moves < 1e-12);
}

#[test]
fn written_models_with_a_fixed_root_are_pinocchios() {
    pinocchio("right_arm_pinocchio_fixed.json", "right_arm.urdf", RootAttachment::Fixed);
    pinocchio("hinges_and_slides_pinocchio_fixed.json", "hinges_and_slides.urdf", RootAttachment::Fixed);
}

#[test]
fn written_models_with_a_free_root_are_pinocchios() {
    pinocchio("right_arm_pinocchio_free.json", "right_arm.urdf", RootAttachment::Free);
    pinocchio("hinges_and_slides_pinocchio_free.json", "hinges_and_slides.urdf", RootAttachment::Free);
}

#[test]
fn written_models_are_mujocos() {
    mujoco("right_arm_mujoco.json", "right_arm.xml");
    mujoco("hinges_and_slides_mujoco.json", "hinges_and_slides.xml");
}

#[test]
fn written_models_are_opensims() {
    opensim("right_arm_opensim.json", "right_arm.osim");
    opensim("hinges_and_slides_opensim.json", "hinges_and_slides.osim");
}

#[test]
#[ignore = "needs ../shared: published models with torques by Pinocchio"]
fn pinocchio_human48_fixed() {
    pinocchio(
        "vectors/pinocchio_human48_fixed_first5.json",
        "models/human-gazebo/humanSubject01_48dof.urdf",
        RootAttachment::Fixed,
    );
}

#[test]
#[ignore = "needs ../shared: published models with torques by Pinocchio"]
fn pinocchio_human48_free() {
    pinocchio(
        "vectors/pinocchio_human48_free_first5.json",
        "models/human-gazebo/humanSubject01_48dof.urdf",
        RootAttachment::Free,
    );
}

#[test]
#[ignore = "needs ../shared: published models with torques by Pinocchio"]
fn pinocchio_human66_free() {
    pinocchio(
        "vectors/pinocchio_human66_free_first5.json",
        "models/human-gazebo/humanSubject01_66dof.urdf",
        RootAttachment::Free,
    );
}

fn mujoco(vectors: &str, file: &str) {
    let (vectors, file_bytes) = (bytes(vectors), bytes(file));
    let vectors: Value = serde_json::from_slice(&vectors).unwrap();
    let mut include = |_: &str| Err("no includes here".to_owned());
    let read = mjcf::read(&file_bytes, file, &mut include, &mjcf::Options::default()).unwrap();
    let mut body = Body::new(read.model().unwrap().model);
    let model = body.model.clone();
    let joints = vectors["joints"].as_array().unwrap();
    // Coordinates and rates of a free root.
    let (free, root) = if joints[0]["type"] == "free" { (7, 6) } else { (0, 0) };
    let names = joints.iter().filter(|j| j["type"] != "free").map(|j| j["name"].as_str().unwrap());
    let joints: Vec<&str> = names.collect();
    let (mut worst, mut springs, mut mass, mut moves) = (0f64, 0f64, 0f64, 0f64);
    for case in vectors["cases"].as_array().unwrap() {
        let q = numbers(&case["qpos"]);
        let mut values = model.default_posture().values().to_vec();
        values[..free].copy_from_slice(&q[..free]);
        for (name, &angle) in joints.iter().zip(&q[free..]) {
            values[model.coordinate(name).unwrap()] = angle;
        }
        body.set(values.clone(), &[]);
        let rate = |name: &str| model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap();
        let rates: Vec<usize> = (0..root).chain(joints.iter().map(|name| rate(name))).collect();
        let ours: Vec<f64> = rates.iter().map(|&rate| -body.external.torques()[rate]).collect();
        worst = worst.max(relative(&ours, &numbers(&case["qfrc_bias"])));
        let passive: Vec<f64> = (0..root)
            .map(|_| 0.0)
            .chain(joints.iter().map(|name| {
                let i = model.coordinate(name).unwrap();
                model.coordinates()[i].passive.as_ref().map_or(0.0, |law| law.torque(i, &values))
            }))
            .collect();
        springs = springs.max(relative(&passive, &numbers(&case["qfrc_passive"])));
        mass = mass.max((body.kinematics.center_of_mass(&model).unwrap() - vector(&case["com"])).norm());
        let mut compare = |ours: Vec<Vec<f64>>, theirs: &Value| {
            let ours: Vec<f64> = ours.iter().flat_map(|row| rates.iter().map(|&rate| row[rate])).collect();
            moves = moves.max(relative(&ours, &matrix(theirs).concat()));
        };
        compare(body.center_jacobian(), &case["J_com"]);
        for side in ["right", "left"] {
            let hand = model.segment(vectors[format!("{side}_hand_body")].as_str().unwrap()).unwrap();
            compare(body.origin_jacobian(hand), &case[format!("J_{side}_hand_pos")]);
            compare(body.rotation_jacobian(hand), &case[format!("J_{side}_hand_rot")]);
        }
    }
    println!("{file}: torque {worst:.1e}, springs {springs:.1e}, centre of mass {mass:.1e} m, Jacobians {moves:.1e}");
    assert!(worst < 1e-9 && springs < 1e-9 && mass < 1e-9 && moves < 1e-12);
}

#[test]
#[ignore = "needs ../shared: published models with torques by MuJoCo"]
fn mujoco_cmu_suite() {
    mujoco("vectors/mujoco_cmu_suite_free_first5.json", "models/cmu/cmu_suite_free_saved.xml");
}

fn opensim(vectors: &str, file: &str) {
    let vectors: Value = serde_json::from_slice(&bytes(vectors)).unwrap();
    let mut body = Body::new(osim::read(&bytes(file), file).unwrap().model().unwrap().model);
    let model = body.model.clone();
    let names: Vec<&str> = vectors["coordinates"].as_array().unwrap().iter().map(|x| x.as_str().unwrap()).collect();
    let (mut worst, mut limits, mut mass, mut moves) = (0f64, 0f64, 0f64, 0f64);
    let parameters = &vectors["coordinate_limit_force"]["parameters"];
    for case in vectors["cases"].as_array().unwrap() {
        let mut values = model.default_posture().values().to_vec();
        for name in &names {
            values[model.coordinate(name).unwrap()] = case["q"][name].as_f64().unwrap();
        }
        body.set(values, &[]);
        for name in &names {
            let i = model.coordinate(name).unwrap();
            let ours = -body.external.uncoupled_torques(&model)[model.coordinates()[i].rate.unwrap()];
            worst = worst.max((ours - case["tau_id"][name].as_f64().unwrap()).abs());
            // The limit forces of the vectors are not in the file: two degrees' worth of stiffness, inside the range.
            let Some(theirs) = case["limit_torque"][name].as_f64() else { continue };
            let range = numbers(&vectors["range"][name]);
            let law = contrapposto::passive::CoordinateLimitForce {
                upper_stiffness: parameters["upper_stiffness_Nm_per_deg"].as_f64().unwrap().to_degrees(),
                lower_stiffness: parameters["lower_stiffness_Nm_per_deg"].as_f64().unwrap().to_degrees(),
                upper_limit: range[1] - 15f64.to_radians(),
                lower_limit: range[0] + 15f64.to_radians(),
                transition: 10f64.to_radians(),
            };
            let q = case["q"][name].as_f64().unwrap();
            let ours = contrapposto::passive::Term::CoordinateLimitForce(law).torque_and_slope(q).0;
            limits = limits.max((ours - theirs).abs());
        }
        mass = mass.max((body.kinematics.center_of_mass(&model).unwrap() - vector(&case["com"])).norm());
        let rates: Vec<usize> =
            names.iter().map(|name| model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap()).collect();
        let ours = body.center_jacobian();
        let ours: Vec<f64> = ours.iter().flat_map(|row| rates.iter().map(|&rate| row[rate])).collect();
        moves = moves.max(relative(&ours, &matrix(&case["J_com_central_difference"]).concat()));
    }
    println!(
        "{file}: torque {worst:.1e} N m, limit forces {limits:.1e} N m, centre of mass {mass:.1e} m, Jacobian {moves:.1e}"
    );
    // Their Jacobian is a central difference of step 1e-6.
    assert!(worst < 1e-6 && limits < 1e-6 && mass < 1e-9 && moves < 1e-7);
}

#[test]
#[ignore = "needs ../shared: published models with torques by OpenSim"]
fn opensim_gait2392() {
    opensim("vectors/opensim_gait2392_first5.json", "models/opensim/gait2392_thelen2003muscle.osim");
}

#[test]
#[ignore = "needs ../shared: published models with torques by OpenSim"]
fn opensim_arm26() {
    opensim("vectors/opensim_arm26.json", "models/opensim/arm26.osim");
}
