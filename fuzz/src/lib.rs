//! Attacks the readers with bytes: each function takes any bytes, and panics where a promise is broken.
//!
//! The promises: no input ends in a panic; what is read gives finite numbers or an error; a model that a writer takes is read again
//! with the same torques.

use std::sync::LazyLock;

use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::muscle::{PathGeometry, PathRule};
use contrapposto::posture_solver::Engine;
use contrapposto::simulation::{Run, Scenario, Snapshot, Tables};
use contrapposto_formats::loads::{GroundReaction, external_loads};
use contrapposto_formats::markers::{marker_set, read_force_plates, read_markers, scale_setup, tracking_tasks};
use contrapposto_formats::motion::{Units, postures, read_table};
use contrapposto_formats::rigs::{Rig, read_bvh, read_gltf, read_rig_names};
use contrapposto_formats::write;
use contrapposto_formats::{
    minimize_line, overlay, read_model, read_plan, read_pose, read_relax, read_scenario, scenario_model,
};
use contrapposto_sweep::Study;

/// Samples of a run that are computed.
const SAMPLES: usize = 4;
/// Steps of a posture solver that are taken.
const STEPS: usize = 6;
/// Largest difference of external torques of a model that was written and read again, as a share of the greatest, or N m.
const ALIKE: f64 = 1e-9;

/// A model file: torques of its default posture, its muscles there, and each writer's file read again.
pub fn model(bytes: &[u8]) {
    let Some((read, torques)) = torques_of(bytes) else { return };
    let model = &read;
    for written in [write::osim(model), write::urdf(model), write::mjcf(model)].into_iter().flatten() {
        let Some((again, anew)) = torques_of(written.text.as_bytes()) else {
            panic!("a written file is refused or has no finite torques:\n{}", written.text);
        };
        for coordinate in model.coordinates() {
            let twin = again.coordinate(&coordinate.name).and_then(|other| again.coordinates()[other].rate);
            let Some((torque, other)) = coordinate.rate.zip(twin).map(|(own, twin)| (torques[own], anew[twin])) else {
                continue;
            };
            // A writer that loses something says so, and the bodies may differ.
            let close = (torque - other).abs() <= ALIKE * torque.abs().max(1.0);
            assert!(close || !written.lost.is_empty(), "{}: {torque} and {other}", coordinate.name);
        }
    }
}

/// Reads a model, and computes its external torques and paths in its default posture.
fn torques_of(bytes: &[u8]) -> Option<(Model, Vec<f64>)> {
    let (imported, _) = read_model("model.xml", bytes, None, &mut |_| Err("no file".to_owned())).ok()?;
    let posture = imported.model.default_posture();
    let mut body = JointTorques::new(&imported.model);
    body.update(&imported.model, &posture, &[], Quantities::TORQUES).ok()?;
    // By rate.
    let torques = body.external_torque().torques().to_vec();
    finite("external torque", &torques);
    let mut kinematics = Kinematics::new(&imported.model);
    kinematics.update(&imported.model, &posture).ok()?;
    let paths = &imported.muscles.paths;
    let mut geometry = PathGeometry::new(&imported.model, paths);
    for rule in [PathRule::Geodesic, PathRule::OpenSim] {
        geometry.update(&imported.model, &kinematics, paths, rule);
        finite("length of a path", geometry.lengths());
        for muscle in &imported.muscles.muscles {
            let state = muscle.at_rest(geometry.lengths()[muscle.spec().path], 0.01);
            finite("force of a muscle", &[state.tendon_force]);
        }
    }
    Some((imported.model, torques))
}

/// The right arm of the built-in adult.
static ARM: LazyLock<Model> = LazyLock::new(|| adult(&Adult::right_arm()).expect("it is built in"));

/// A table of motion, the postures of an arm in it, and the forces on a hand.
pub fn motion(bytes: &[u8]) {
    let Ok(table) = read_table("motion.mot", bytes) else { return };
    finite("time", &table.times);
    for row in &table.rows {
        assert_eq!(row.len(), table.columns.len());
        finite("row", row);
    }
    for units in [Units::FromFile, Units::Degrees, Units::Radians] {
        for (_, posture) in
            postures(&table, "motion.mot", bytes, &ARM, units).into_iter().flat_map(|read| read.postures)
        {
            finite("posture", posture.values());
        }
    }
    let Ok(ground) = GroundReaction::read("motion.mot", bytes, &["hand_r"], &ARM) else { return };
    let (kinematics, mut loads) = (Kinematics::new(&ARM), vec![]);
    for time in ground.span().into_iter().flat_map(|(first, last)| [first, 0.5 * first + 0.5 * last, last]) {
        ground.loads(time, &ARM, &kinematics, &mut loads);
    }
    loads.iter().for_each(|load| finite("point of a load", load.point.as_slice()));
}

/// Markers of a trial (`.trc`, C3D) and its force plates.
pub fn markers(bytes: &[u8]) {
    if let Ok(markers) = read_markers("markers.trc", bytes, None) {
        finite("time", &markers.times);
        assert_eq!(markers.places.len(), markers.times.len());
        for frame in &markers.places {
            assert_eq!(frame.len(), markers.names.len());
            frame.iter().flatten().for_each(|place| finite("place", place.as_slice()));
        }
    }
    let Ok(read) = read_force_plates("markers.c3d", bytes, None) else { return };
    finite("time", &read.times);
    for plate in &read.plates {
        assert_eq!((plate.forces.len(), plate.moments.len()), (read.times.len(), read.times.len()));
        let vectors = plate.corners.iter().chain([&plate.up, &plate.center]).chain(&plate.forces).chain(&plate.moments);
        vectors.for_each(|vector| finite("force plate", vector.as_slice()));
    }
}

/// A rig and its motion, BVH or glTF; the names of a rig's joints.
pub fn rig(bytes: &[u8]) {
    static RIG: LazyLock<Rig> =
        LazyLock::new(|| read_bvh("two.bvh", include_bytes!("../corpus/rig/two.bvh")).expect("it is in order"));
    let _ = read_rig_names("names.toml", bytes, &RIG);
    read_bvh("rig.bvh", bytes).iter().for_each(finite_rig);
    read_gltf("rig.glb", bytes).iter().for_each(finite_rig);
}

fn finite_rig(rig: &Rig) {
    finite("time between frames", &[rig.frame_time]);
    for (i, joint) in rig.joints.iter().enumerate() {
        assert!(joint.parent.is_none_or(|parent| parent < i), "a parent comes before its child");
        finite("offset", joint.offset.as_slice());
        finite("rest", joint.rest.coords.as_slice());
    }
    rig.frames.iter().for_each(|frame| finite("frame", frame));
}

/// Setup files of OpenSim's tools: marker sets, tasks, scale setups, external loads.
pub fn setup(bytes: &[u8]) {
    let bodies = ["pelvis".to_owned(), "torso".to_owned()];
    for marker in marker_set("set.xml", bytes, &bodies).into_iter().flatten() {
        finite("place of a marker", marker.location.as_slice());
    }
    if let Ok(tasks) = tracking_tasks("tasks.xml", bytes) {
        finite("weight", &tasks.markers.iter().map(|task| task.weight).collect::<Vec<_>>());
        finite("weight", &tasks.coordinates.iter().map(|task| task.weight).collect::<Vec<_>>());
    }
    if let Ok(setup) = scale_setup("scale.xml", bytes) {
        finite("mass", setup.mass.as_slice());
    }
    let _ = external_loads(bytes);
}

/// A plan of a sweep: where its parameters are keys of the base, the scenario of its last row is read.
pub fn plan(bytes: &[u8]) {
    let Ok(plan) = read_plan("plan.toml", bytes) else { return };
    assert!(plan.rows_of(plan.parts() - 1).end == plan.rows, "the parts are all rows");
    plan.mixing.iter().flatten().for_each(|row| finite("mixing", row));
    if let Ok(study) = Study::new("scenario.toml", ONE_JOINT.as_bytes(), &plan) {
        let last = study.rows() - 1;
        finite("point", &study.point(last));
        let _ = read_scenario("scenario.toml", study.scenario(last).as_bytes(), None);
    }
}

/// A part of a sweep that was kept: its bytes are those of the part, or it is none.
pub fn part(bytes: &[u8]) {
    static STUDY: LazyLock<Study> = LazyLock::new(|| {
        let plan = read_plan("lists.toml", include_bytes!("../corpus/plan/lists.toml")).expect("it is in order");
        Study::new("scenario.toml", ONE_JOINT.as_bytes(), &plan).expect("it is in order")
    });
    if let Some(answers) = STUDY.read(0, bytes) {
        assert_eq!(answers.len(), STUDY.rows_of(0).len());
    }
}

/// A scenario: the first samples of its run, where that has no supports and no tasks. The search for the start of a whole body takes
/// seconds; random worlds (`tests/worlds.rs`) are its attack.
pub fn scenario(bytes: &[u8]) {
    let _ = scenario_model("scenario.toml", bytes);
    let Ok(scenario) = read_scenario("scenario.toml", bytes, None) else { return };
    finite("start", scenario.start.values());
    if scenario.has_supports_or_tasks() {
        return;
    }
    let Ok(run) = Run::new(&scenario) else { return };
    samples(run);
}

/// Takes the first samples of a run.
fn samples(mut run: Run<'_>) {
    for _ in 0..SAMPLES {
        let Ok(Some(sample)) = run.next_sample() else { return };
        finite("posture", sample.posture);
        finite("external torque", sample.external);
        finite("passive torque", sample.passive);
        finite("load", sample.load);
        assert!(sample.fatigue.iter().flatten().all(|fatigue| (0.0..=1.0).contains(fatigue)));
        for ((external, passive), active) in sample.external.iter().zip(sample.passive).zip(sample.active) {
            assert_eq!(*active, -(passive + external), "Eq. 1");
        }
    }
}

/// The scenario of a pose: the first steps of its solver.
pub fn pose(bytes: &[u8]) {
    let Ok(mut scenario) = read_pose("pose.toml", bytes, None) else { return };
    scenario.options.max_steps = scenario.options.max_steps.min(STEPS);
    let (levels, _) = scenario.levels();
    let Ok(mut engine) = Engine::new(&scenario.model, levels, &scenario.loads, scenario.options) else { return };
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    let Ok(pose) = engine.solve(&scenario.start) else { return };
    finite("posture", pose.posture.values());
    for level in &pose.levels {
        finite("error of a level", &[level.length]);
    }
}

/// The scenario of `relax`, read only: a search takes seconds.
pub fn relax(bytes: &[u8]) {
    if let Ok(scenario) = read_relax("relax.toml", bytes, None) {
        finite("start", scenario.start.values());
    }
}

/// An overlay on the adult's right arm: passive torques over each range stay finite.
pub fn overlay_on_an_arm(bytes: &[u8]) {
    let Ok(arm) = adult(&Adult::right_arm()) else { return };
    let Ok(laid) = overlay("overlay.toml", bytes, arm) else { return };
    let mut posture = laid.model.default_posture();
    for (i, coordinate) in laid.model.coordinates().iter().enumerate() {
        let Some(curve) = &coordinate.passive else { continue };
        let (least, greatest) = coordinate.range;
        for part in 0..=8 {
            posture.values_mut()[i] = least + (greatest - least) * f64::from(part) / 8.0;
            finite("passive torque", &[curve.torque(i, posture.values())]);
        }
    }
}

/// A formula of a passive torque.
pub fn expression(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = contrapposto_formats::osim::expression::parse(text);
}

/// A line of a problem of hybrid minimisation.
pub fn minimize(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    // A torque that is not finite would be written as `null`.
    if let Ok(line) = minimize_line(text, Tables::Total) {
        let written = serde_json::to_value(&line).expect("a decision is JSON");
        assert!(written["active_nm"].is_f64(), "{written}");
    }
}

/// A snapshot of a run of one joint.
pub fn snapshot(bytes: &[u8]) {
    let Ok(snapshot) = serde_json::from_slice::<Snapshot>(bytes) else { return };
    let scenario: Scenario = read_scenario("scenario.toml", ONE_JOINT.as_bytes(), None).expect("it is in order");
    if let Ok(run) = Run::resume(&scenario, snapshot) {
        samples(run);
    }
}

/// The scenario whose snapshots and parts of sweeps are attacked.
pub const ONE_JOINT: &str = include_str!("../one-joint.toml");

fn finite(name: &str, values: &[f64]) {
    assert!(values.iter().all(|value| value.is_finite()), "{name} is not finite: {values:?}");
}
