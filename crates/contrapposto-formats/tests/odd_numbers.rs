//! Puts NaN, infinities, the ends of the doubles, negative zero, a subnormal and nonsense in every number of every kind of file,
//! one after the other: a number that is not finite is refused where it stands, or has no part in the result; and all numbers
//! computed from an accepted file are finite. Scenarios of runs: `scenario.rs`; decisions a line: `contrapposto-cli/tests/minimize.rs`.

use crate::common;

use std::fmt::Debug;

use common::toml::ODD;
use common::{complaint, here};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::statics::{ExternalTorque, Gradient, PassiveTorque};
use contrapposto_formats::model_ir::Imported;
use contrapposto_formats::motion::{Units, postures, read_table};
use contrapposto_formats::{mjcf, osim, overlay, read_pose, read_relax, urdf};

/// Places of all numbers that stand by themselves.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | '_');
    let mut found = vec![];
    let mut from = None;
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (part(c), from) {
            (true, None) => from = Some(at),
            (false, Some(start)) => {
                found.extend(text[start..at].parse::<f64>().is_ok_and(f64::is_finite).then_some((start, at)));
                from = None;
            }
            _ => {}
        }
    }
    found
}

/// Puts every odd number in every place. `read` gives the contents of a text, or the message; `sound`: whether everything is finite
/// that can be computed from the contents. A number that is not finite is refused with its line, or changes nothing; lines that hold
/// one of `without_end` may say for ever.
fn odd_in_every_place<T: Debug>(
    name: &str,
    text: &str,
    without_end: &[&str],
    read: impl Fn(&str) -> Result<T, String>,
    sound: impl Fn(&T) -> bool,
) {
    let meant = read(text).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(sound(&meant), "{name}");
    let meant = format!("{meant:?}");
    let places = numbers(text);
    let (mut refused, mut accepted, mut past) = (0, 0, 0);
    for &(from, to) in &places {
        let number = text[..from].matches('\n').count();
        for odd in ODD {
            let changed = format!("{}{odd}{}", &text[..from], &text[to..]);
            let line = changed.lines().nth(number).unwrap();
            let message = || format!("{name}: {odd} for {} in line {}: {line}", &text[from..to], number + 1);
            let finite = !["nan", "inf", "-inf", "1e999"].contains(&odd);
            match read(&changed) {
                Err(error) => {
                    refused += 1;
                    assert!(finite || error.contains(&format!("line {}", number + 1)), "{}: {error}", message());
                }
                Ok(read) if finite => {
                    accepted += 1;
                    assert!(sound(&read), "{}: something is not finite", message());
                }
                Ok(read) => {
                    past += 1;
                    let may = without_end.iter().any(|word| line.contains(word)) || format!("{read:?}") == meant;
                    assert!(may && sound(&read), "{}: accepted", message());
                }
            }
        }
    }
    println!(
        "{name}: {} numbers; {refused} refused, {accepted} accepted and computed with, {past} read past",
        places.len()
    );
    assert!(places.len() > 5 && refused > 0 && accepted > 0);
}

/// Torques and their derivatives at the default and in two postures beside it.
fn computable(model: &Model) -> bool {
    let mut kinematics = Kinematics::new(model);
    let mut external = ExternalTorque::new(model);
    let (mut passive, mut gradient) = (PassiveTorque::new(model), Gradient::new(model));
    [0.0, 0.01, -0.3].into_iter().all(|shift| {
        let mut posture = model.default_posture();
        posture.displace(model, &vec![shift; model.rates().len()]);
        if kinematics.update(model, &posture).is_err() {
            return true; // refused by name
        }
        external.update(model, &kinematics, &[]).unwrap();
        external.gradient(model, &kinematics, &mut gradient);
        if passive.update(model, &kinematics).is_err() {
            return true; // refused by name
        }
        let rows = (0..gradient.size()).flat_map(|row| gradient.row(row));
        let center = kinematics.center_of_mass(model).unwrap_or_default();
        external.torques().iter().chain(passive.torques()).chain(rows).chain(&center).all(|x| x.is_finite())
    })
}

fn file(name: &str) -> String {
    std::fs::read_to_string(here().join("tests/models").join(name)).unwrap()
}

/// Torques can be computed, and nothing that is kept of muscles is not finite.
fn sound(imported: &Imported) -> bool {
    let muscles = format!("{:?}", imported.muscles);
    computable(&imported.model) && !muscles.contains("NaN") && !muscles.contains("inf")
}

/// Ranges may be open; inertias that are not finite are listed and left out, as OpenSim itself makes such files; wrap objects
/// and muscles are refused by name and counted.
const OPENSIM_WITHOUT_END: &[&str] = &["<range>", "inertia", "<WrapCylinder", "<PathPoint", "max_isometric_force"];

#[test]
fn opensim_models() {
    for name in ["joints_4x.osim", "joints_3x.osim", "joints_loose.osim", "coupled.osim"] {
        let read = |text: &str| {
            let body = osim::read(text.as_bytes(), name).map_err(|error| error.to_string())?;
            body.model().map_err(|error| error.to_string())
        };
        odd_in_every_place(name, &file(name), OPENSIM_WITHOUT_END, read, sound);
    }
}

#[test]
fn urdf_models() {
    for name in ["arm.urdf", "humanoid.urdf"] {
        let read = |text: &str| {
            let body =
                urdf::read(text.as_bytes(), name, &urdf::Options::default()).map_err(|error| error.to_string())?;
            body.model().map_err(|error| error.to_string())
        };
        odd_in_every_place(name, &file(name), &[], read, |imported| computable(&imported.model));
    }
}

/// Tendons are refused by name and counted.
const MUJOCO_WITHOUT_END: &[&str] = &["<tendon>"];

#[test]
fn mjcf_models() {
    for name in ["features.xml", "compiler.xml", "from_geoms.xml"] {
        let read = |text: &str| {
            let mut include =
                |part: &str| std::fs::read(here().join("tests/models").join(part)).map_err(|e| e.to_string());
            let body = mjcf::read(text.as_bytes(), name, &mut include, &mjcf::Options::default());
            body.map_err(|error| error.to_string())?.model().map_err(|error| error.to_string())
        };
        odd_in_every_place(name, &file(name), MUJOCO_WITHOUT_END, read, sound);
    }
}

#[test]
fn overlays() {
    let text = "[coordinates.knee_angle_r]\nrange_deg = [-5, 120]\npassive = { double_exponential = { lower = { torque_nm = 2, \
                rate_per_rad = 8, angle_deg = -4 }, upper = { torque_nm = 2, rate_per_rad = 6, angle_deg = 110 }, \
                stiffness_nm_per_rad = 0.4, neutral_deg = 30 }, reshape = { zone_deg = 5, end_torque_nm = 20 } }\n\
                strength = { positive_nm = 100, negative_nm = 200 }\nfatigue = \"knee\"\n[coordinates.elbow_flex_r]\n\
                passive = { curve = \"elbow_neutral\", sign = 1 }\n[coordinates.ankle_angle_r]\nrange_deg = [-40, 30]\n\
                passive = { coordinate_limit_force = { upper_stiffness_nm_per_deg = 1.5, upper_limit_deg = 20, \
                lower_stiffness_nm_per_deg = 1.2, lower_limit_deg = -30, transition_deg = 8 } }\n\
                [coordinates.wrist_flex_r]\nrange_deg = [-70, 70]\npassive = { table_deg_nm = [[-70, 13.2], [-15, 0.5], \
                [20, -1.6], [70, -9.9]], reshape = true }\n[coordinates.pelvis_ty]\nrange_m = [-1, 2.5]\n";
    let model = adult(&Adult::default()).unwrap();
    let read = |text: &str| overlay("odd.toml", text.as_bytes(), model.clone()).map_err(|error| complaint(&error));
    odd_in_every_place("overlay", text, &[], read, |laid| computable(&laid.model));
}

#[test]
fn tables_of_motion() {
    let model = adult(&Adult::default()).unwrap();
    for (name, text) in [
        (
            "table.mot",
            "motion\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\ntime\thip_flexion_r\tpelvis_ty\n0.25\t30\t0.95\n0.5\t-45\t0.96\n",
        ),
        (
            "table.sto",
            "DataType=double\nversion=3\ninDegrees=no\nendheader\ntime\t/jointset/hip_r/hip_flexion_r/value\tpelvis_ty\n0.25\t0.1\t0.95\n0.5\t-0.4\t0.96\n",
        ),
        (
            "table.csv",
            "time,hip_flexion_r.angle_deg,pelvis_ty.position_m,elbow_flex_r.angle_deg\n0.25,30,0.95,12.5\n0.5,-45,0.96,13\n",
        ),
    ] {
        let read = |text: &str| {
            let refused = |error| complaint(&error);
            let table = read_table(name, text.as_bytes()).map_err(refused)?;
            postures(&table, name, text.as_bytes(), &model, Units::FromFile).map_err(refused)
        };
        odd_in_every_place(name, text, &[], read, |found| {
            found.postures.iter().all(|(time, posture)| time.is_finite() && posture.check(&model).is_ok())
        });
    }
}

/// Keys that may stand in a pose, and in a search for postures of least effort.
const POSE: &str = r#"format = 1
[model]
adult = { sex = "female", stature_m = 1.65, mass_kg = 60, lengths_m = { humerus = 0.31 } }
[posture]
elbow_flex_r_deg = 60
pelvis_ty_m = 0.01
[[load]]
segment = "hand_r"
force_n = [3, -20, 1]
at_m = [0.01, -0.08, 0.02]
[[support]]
segment = "calcn_r"
friction = 0.8
[[support]]
segment = "calcn_l"
share_max = 0.4
corners_m = [[-0.04, -0.02, -0.03], [-0.04, -0.02, 0.03], [0.12, -0.02, 0.04], [0.12, -0.02, -0.04]]
[[task]]
kind = "center_of_mass"
margin_m = 0.01
[[task]]
kind = "look_at"
target_m = [2, 1.4, 0.1]
[[task]]
kind = "point"
segment = "hand_r"
at_m = [0.01, -0.05, 0.02]
target_m = [0.35, 1.1, 0.25]
"#;

#[test]
fn poses() {
    let read = |text: &str| read_pose("pose.toml", text.as_bytes(), None).map_err(|error| complaint(&error));
    odd_in_every_place("pose", POSE, &[], read, |pose| {
        let options = contrapposto::posture_solver::Options { max_steps: 3, ..pose.options };
        let mut engine =
            contrapposto::posture_solver::Engine::new(&pose.model, pose.goals.clone(), &pose.loads, options).unwrap();
        let ended = engine.solve(&pose.start);
        ended.map_or(true, |pose| pose.posture.values().iter().all(|value| value.is_finite()))
    });
}

#[test]
fn searches_for_rest() {
    let read = |text: &str| read_relax("relax.toml", text.as_bytes(), None).map_err(|error| complaint(&error));
    odd_in_every_place("relax", POSE, &[], read, |relax| {
        let options = contrapposto::posture_solver::Options {
            max_steps: 2,
            ..contrapposto::posture_solver::Options::least_effort()
        };
        let supports = relax.supports.clone();
        let engine = contrapposto::posture_solver::Engine::with_supports(
            &relax.model,
            &relax.start,
            supports,
            relax.goals.clone(),
            &relax.loads,
            options,
        );
        let Ok(relaxed) = engine.unwrap().solve(&relax.start) else { return true };
        relaxed.effort.is_finite() && relaxed.posture.values().iter().all(|value| value.is_finite())
    });
}
