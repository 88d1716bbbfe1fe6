//! MJCF models as bodies: against MuJoCo's own numbers, and what is refused where.

use crate::common;

use common::{center_of_mass, difference, frames, hammer, here, shared};
use contrapposto_formats::mjcf::{self, MjcfError, Options};
use contrapposto_formats::model_ir::{CoordinateIr, CoordinateKind, ModelIr, PassiveLawIr, RootAttachment};
use contrapposto_formats::xml::Limits;
use serde_json::Value;
use std::path::Path;

fn read_with(text: &[u8], options: &Options) -> Result<ModelIr, MjcfError> {
    mjcf::read(text, "file.xml", &mut |name| Err(format!("no file {name}")), options)
}

fn read(text: &str) -> Result<ModelIr, MjcfError> {
    read_with(text.as_bytes(), &Options::default())
}

fn read_file(path: &Path, options: &Options) -> ModelIr {
    let folder = path.parent().unwrap().to_owned();
    let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
    mjcf::read(&std::fs::read(path).unwrap(), "file.xml", &mut include, options).unwrap_or_else(|e| panic!("{e}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Models of the project with MuJoCo's numbers.
fn ours() -> Vec<(ModelIr, Value)> {
    references(&here().join("tests/models"), |name| !name.starts_with("cmu_"))
}

/// Published models with MuJoCo's numbers.
fn published() -> Vec<(ModelIr, Value)> {
    references(&shared("models/cmu"), |name| name.starts_with("cmu_"))
}

fn references(folder: &Path, wanted: impl Fn(&str) -> bool) -> Vec<(ModelIr, Value)> {
    let text = std::fs::read_to_string(here().join("tests/data/mujoco_reference.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    let mut found = vec![];
    for reference in all["models"].as_array().unwrap() {
        let name = reference["model"].as_str().unwrap();
        if wanted(name) {
            found.push((read_file(&folder.join(name), &Options::default()), reference.clone()));
        }
    }
    assert!(found.len() >= 2);
    found
}

#[test]
fn masses_are_mujocos() {
    compare_masses(ours());
}

#[test]
fn joints_are_mujocos() {
    compare_joints(ours());
}

#[test]
fn poses_springs_and_sites_are_mujocos() {
    compare_poses(ours());
}

#[test]
#[ignore = "needs ../shared: published humanoids of dm_control"]
fn published_humanoids_are_mujocos() {
    compare_masses(published());
    compare_joints(published());
    compare_poses(published());
}

fn compare_masses(references: Vec<(ModelIr, Value)>) {
    for (body, reference) in references {
        let bodies = reference["bodies"].as_array().unwrap();
        assert_eq!(body.segments.len(), bodies.len());
        let mut worst = [0.0_f64; 3];
        for (segment, expected) in body.segments.iter().zip(bodies) {
            let name = expected["name"].as_str().unwrap();
            assert!(segment.name == name || name.is_empty());
            assert_eq!(segment.parent.map_or(0, |p| p as u64 + 1), expected["parent"].as_u64().unwrap());
            let mass = expected["mass"].as_f64().unwrap();
            worst[0] = worst[0].max((segment.mass - mass).abs() / mass.max(1.0));
            worst[1] = worst[1].max(difference(segment.center_of_mass.as_slice(), &numbers(&expected["center"])));
            worst[2] = worst[2].max(difference(segment.inertia.as_slice(), &numbers(&expected["inertia"])));
        }
        println!("{}: mass {:.1e}, centre {:.1e} m, inertia {:.1e}", reference["model"], worst[0], worst[1], worst[2]);
        assert!(worst.iter().all(|w| *w < 1e-12), "{}: {worst:?}", reference["model"]);
        assert!(difference(body.gravity.as_slice(), &numbers(&reference["gravity"])) == 0.0);
    }
}

fn compare_joints(references: Vec<(ModelIr, Value)>) {
    for (body, reference) in references {
        let off = |name: &str| reference[name].as_bool().unwrap();
        let mut at = 0;
        for expected in reference["joints"].as_array().unwrap() {
            let kind = expected["type"].as_str().unwrap();
            let coordinate = &body.coordinates[at];
            let name = expected["name"].as_str().unwrap();
            let limited = expected["limited"].as_bool().unwrap() && !off("limits_disabled");
            at += match kind {
                "free" => 7,
                "ball" => 4,
                _ => 1,
            };
            if matches!(kind, "free" | "ball") {
                let ending = if kind == "free" { "_tx" } else { "_qw" };
                assert!(coordinate.name.ends_with(ending) && coordinate.name.starts_with(name));
                let high = numbers(&expected["range"])[1];
                assert!(!limited || (coordinate.range.0 - libm::cos(high / 2.0)).abs() < 1e-15);
                continue;
            }
            assert!(coordinate.name == name || name.is_empty());
            let slide = coordinate.kind == CoordinateKind::Translation;
            assert_eq!(slide, kind == "slide");
            assert_eq!(coordinate.clamped, limited);
            if limited {
                assert!(difference(&[coordinate.range.0, coordinate.range.1], &numbers(&expected["range"])) < 1e-15);
            } else {
                assert_eq!(coordinate.range, (f64::NEG_INFINITY, f64::INFINITY));
            }
            // A joint that an equality fixes rests where the equality says.
            if !coordinate.locked {
                assert!((coordinate.default - expected["qpos0"].as_f64().unwrap()).abs() < 1e-15);
            }
            let spring = body.passive.iter().find(|p| p.coordinate == at - 1);
            let (found, rest) = match spring.map(|s| &s.law) {
                None => (vec![0.0; 3], None),
                Some(PassiveLawIr::Spring { stiffness, rest }) => (vec![*stiffness, 0.0, 0.0], Some(*rest)),
                Some(PassiveLawIr::Polynomial { coefficients, rest }) => (coefficients.clone(), Some(*rest)),
                Some(law) => panic!("{law:?}"),
            };
            let stiffness = if off("springs_disabled") { vec![0.0; 3] } else { numbers(&expected["stiffness"]) };
            assert!(difference(&found, &stiffness) < 1e-12, "{name}: {found:?}, MuJoCo {stiffness:?}");
            assert!(rest.is_none_or(|r| (r - expected["rest"].as_f64().unwrap()).abs() < 1e-15));
        }
        assert_eq!(at, body.coordinates.len());
    }
}

fn compare_poses(references: Vec<(ModelIr, Value)>) {
    for (body, reference) in references {
        let sites: Vec<_> = reference["sites"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
        let mut worst = [0.0_f64; 5];
        for pose in reference["poses"].as_array().unwrap() {
            let q = numbers(&pose["qpos"]);
            let found = frames(&body, &q);
            let positions: Vec<f64> =
                found.iter().flat_map(|f| f.translation.vector.iter().copied().collect::<Vec<_>>()).collect();
            let turn = |f: &nalgebra::Isometry3<f64>| f.rotation.to_rotation_matrix().matrix().transpose();
            let rotations: Vec<f64> = found.iter().flat_map(|f| turn(f).iter().copied().collect::<Vec<_>>()).collect();
            // A mocap body's rotation is its own; all others follow.
            worst[0] = worst[0].max(difference(&positions, &numbers(&pose["positions"])));
            worst[1] = worst[1].max(difference(&rotations, &numbers(&pose["rotations"])));
            let center = center_of_mass(&body, &q);
            worst[2] = worst[2].max(difference(center.as_slice(), &numbers(&pose["center_of_mass"])));
            let site_positions = numbers(&pose["sites"]);
            for (name, segment, at) in &body.stations {
                let index = sites.iter().position(|s| s == name).unwrap();
                let world = found[*segment] * nalgebra::Point3::from(*at);
                worst[3] = worst[3].max(difference(world.coords.as_slice(), &site_positions[3 * index..3 * index + 3]));
            }
            let mut springs = numbers(&pose["spring"]).into_iter();
            let single = |c: &&contrapposto_formats::model_ir::CoordinateIr| c.kind != CoordinateKind::Quaternion;
            let free = body.coordinates.iter().filter(|c| c.name.starts_with("root_t")).count();
            for (index, _) in body.coordinates.iter().enumerate().filter(|(_, c)| single(c)).skip(free) {
                let torque: f64 = body
                    .passive
                    .iter()
                    .filter(|p| p.coordinate == index)
                    .map(|p| match &p.law {
                        PassiveLawIr::Spring { stiffness, rest } => -stiffness * (q[index] - rest),
                        PassiveLawIr::Polynomial { coefficients, rest } => {
                            let x = q[index] - rest;
                            -coefficients.iter().rev().fold(0.0, |sum, k| (sum + k) * x)
                        }
                        law => panic!("{law:?}"),
                    })
                    .sum();
                worst[4] = worst[4].max(difference(&[torque], &[springs.next().unwrap()]));
            }
        }
        println!(
            "{}: position {:.1e} m, rotation {:.1e}, centre of mass {:.1e} m, sites {:.1e} m, springs {:.1e} N m",
            reference["model"], worst[0], worst[1], worst[2], worst[3], worst[4]
        );
        assert!(worst.iter().all(|w| *w < 1e-12), "{}: {worst:?}", reference["model"]);
    }
}

const G: &str = "<geom size='0.1'/>";

fn world(inside: &str) -> String {
    format!("<mujoco><worldbody>{inside}</worldbody></mujoco>")
}

fn in_body(inside: &str) -> String {
    world(&format!("<body name='b'>{inside}{G}</body>"))
}

/// Files that MuJoCo refuses are refused; files with parts that matter at rest and are not represented, too.
#[test]
fn refusals_say_where() {
    let with = |head: &str, inside: &str| {
        format!("<mujoco>{head}<worldbody><body name='b'>{inside}{G}</body></worldbody></mujoco>")
    };
    let after = |tail: &str| in_body("<joint name='j'/>").replace("</mujoco>", &format!("{tail}</mujoco>"));
    let cases = [
        (with("<compiler coordinate='global'/>", ""), "line 1, column 19: `global`: global coordinates are not read"),
        (with("<compiler angle='grad'/>", ""), "line 1, column 19: `grad` is not accepted; there are radian, degree"),
        (with("<compiler eulerseq='xy'/>", ""), "`xy`: three letters of x, y, z, X, Y, Z"),
        (with("<compiler alignfree='true'/>", ""), "`true`: moving the frame of free bodies"),
        (with("<option wind='1 0 0' density='1.2'/>", ""), "`1 0 0`: wind in a fluid presses"),
        (with("<default class='other'/>", ""), "`other`: the outermost default class is called main"),
        (with("<default><default/></default>", ""), "<default class> at line 1, column 18: the attribute is missing"),
        (with("<size/><foo/>", ""), "<foo> at line 1, column 16: unknown element"),
        (in_body("<joint class='no'/>"), "there is no class `no`"),
        (in_body("<joint type='screw'/>"), "`screw` is not accepted; there are free, ball, slide, hinge"),
        (in_body("<joint axis='0 0 0'/>"), "`0 0 0`: an axis is longer than zero"),
        (in_body("<joint range='1 0' limited='true'/>"), "`1 0`: the first number of a range is smaller"),
        (
            in_body("<joint type='ball' range='1 2'/>"),
            "`1 2`: the first number of a range is smaller than the second, and zero for a ball joint",
        ),
        (
            with("<compiler autolimits='false'/>", "<joint range='0 1'/>"),
            "`0 1`: with autolimits=\"false\", a range needs limited",
        ),
        (in_body("<joint springdamper='1 0'/>"), "`1 0`: both numbers of springdamper are positive"),
        (in_body("<joint stiffness='1' springyield='2'/>"), "`2`: springs that yield are not supported"),
        (in_body("<joint type='ball' stiffness='1'/>"), "`1`: springs of ball and free joints are not supported"),
        (in_body("<freejoint/><joint/>"), "`b`: a free joint belongs to a body of the world and is its only joint"),
        (in_body("<freejoint align='true'/>"), "`true`: moving the frame of free bodies"),
        (in_body("<joint type='ball'/><joint type='ball'/><joint/>"), "`b`: a body has at most six degrees of freedom"),
        (in_body("<joint name='a'/><joint name='a'/>"), "<joint name> at line 1, column 59: `a` is there already"),
        (world("<body name='world'/>"), "`world` is there already"),
        (world("<joint/>"), "`worldbody`: the world has no joints"),
        (world("<body mocap='true'><joint/></body>"), "`true`: a mocap body is a child of the world without joints"),
        (world("<body><joint/></body>"), "`body_1`: a body that moves has mass and inertia"),
        (world("<body gravcomp='1'/>"), "`1`: gravity compensation is not supported"),
        (
            world("<body quat='1 0 0 0' euler='0 0 0'/>"),
            "<body euler> at line 1, column 41: `0 0 0`: one of quat, axisangle",
        ),
        (world("<body quat='0 0 0 0'/>"), "`0 0 0 0`: a direction or quaternion is longer than zero"),
        (world("<body xyaxes='1 0 0 2 0 0'/>"), "axes are not parallel"),
        (world("<frame scale='2'/>"), "`2`: scaled frames are not supported"),
        (world("<replicate count='2'/>"), "`replicate`: parts made from other parts are not read"),
        (world("<attach model='m' prefix='p'/>"), "`attach`: parts made from other parts are not read"),
        (world("<flexcomp/>"), "`flexcomp`: deformable parts are not supported"),
        (in_body("<plugin/>"), "`plugin`: plugins are not supported"),
        (in_body("<geom type='capsule' size='0.1'/>"), "`0.1`: the sizes that the shape needs are positive"),
        (in_body("<geom size='0.1' mass='-1'/>"), "`-1`: mass and density are zero or more"),
        (in_body("<geom size='0.1' group='1.5'/>"), "`1.5`: a whole number"),
        (in_body("<geom size='0.1' shellinertia='true'/>"), "`true`: mass on the surface of a geom"),
        (
            in_body("<geom type='sphere' size='1' fromto='0 0 0 1 1 1'/>"),
            "fromto belongs to capsule, cylinder, box or ellipsoid",
        ),
        (in_body("<geom type='box' size='1' fromto='1 1 1 1 1 1'/>"), "the two points of fromto differ"),
        (
            in_body("<geom type='box' size='1' pos='1 0 0' fromto='0 0 0 1 1 1'/>"),
            "`1 0 0`: either pos or fromto, not both",
        ),
        (in_body("<joint/><geom type='plane' size='1 1 1'/>"), "`plane`: planes and height fields do not move"),
        (
            in_body("<inertial pos='0 0 0' mass='1' diaginertia='1 1 3'/>"),
            "`b`: each moment of inertia is at most the sum of the others",
        ),
        (in_body("<inertial pos='0 0 0' mass='1' fullinertia='1 1 1 2 0 0'/>"), "an inertia is positive definite"),
        (
            in_body("<inertial pos='0 0 0' mass='1' quat='1 0 0 0' fullinertia='1 1 1 0 0 0'/>"),
            "fullinertia stands without",
        ),
        (
            in_body("<inertial pos='0 0 0' diaginertia='1 1 1'/>"),
            "<inertial mass> at line 1, column 35: the attribute is missing",
        ),
        (
            in_body("<inertial pos='0 0 0' mass='1'/><inertial pos='0 0 0' mass='1'/>"),
            "a body has at most one <inertial>",
        ),
        (after("<equality><weld body1='b'/></equality>"), "`weld`: only equality constraints between joints"),
        (after("<equality><joint joint1='k'/></equality>"), "there is no hinge or slide joint `k`; did you mean `j`?"),
        (after("<equality><joint joint1='j' joint2='j'/></equality>"), "`j`: a joint follows one other joint"),
        (after("<tendon><fixed stiffness='1'/></tendon>"), "`1`: springs of tendons are not supported"),
        (after("<deformable><flex name='f'/></deformable>"), "`f`: deformable parts are not supported"),
        (
            in_body("<joint springdamper='1 1'/>")
                .replace("</mujoco>", "<tendon><fixed armature='1'/></tendon></mujoco>"),
            "`1`: springdamper takes its stiffness",
        ),
    ];
    let mut wrong = vec![];
    for (text, expected) in cases {
        let said = read(&text).expect_err(&text).to_string();
        if !said.contains(expected) {
            wrong.push(format!("{text}\n{said}\n{expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn depth_counts_includes_and_frames() {
    let cap = Limits::default().depth;
    // Frames inside each other within one file are stopped by the XML depth; includes add to it.
    let nest = |n: usize, inside: &str| "<frame>".repeat(n) + inside + &"</frame>".repeat(n);
    let main = world(&nest(40, "<include file='a.xml'/>"));
    let part = |n| format!("<x>{}</x>", nest(n, "<frame/>"));
    for (n, fits) in [(cap - 43, true), (cap - 42, false)] {
        let inner = part(n);
        let read = mjcf::read(main.as_bytes(), "m", &mut |_| Ok(inner.clone().into_bytes()), &Options::default());
        assert_eq!(read.is_ok(), fits, "{n}: {read:?}");
    }
}

#[test]
fn includes_are_capped() {
    let caps = Limits::default();
    let includes = |n: usize| {
        format!("<mujoco>{}</mujoco>", (0..n).map(|i| format!("<include file='f{i}'/>")).collect::<String>())
    };
    let read = |text: &str, chain: bool| {
        let mut next = 0;
        let mut include = |_: &str| {
            next += 1;
            Ok(if chain { format!("<x><include file='c{next}'/><size/></x>") } else { "<x><size/></x>".to_owned() }
                .into_bytes())
        };
        mjcf::read(text.as_bytes(), "m", &mut include, &Options::default()).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(read(&includes(caps.includes), false), Ok(()));
    assert!(read(&includes(caps.includes + 1), false).unwrap_err().contains("more than 16 files are included"));
    assert!(read(&includes(1), true).unwrap_err().contains("includes lie more than 4 files deep"));
}

#[test]
fn roots_are_freed_and_fixed() {
    let option = |root| Options { root, ..Options::default() };
    let fixed = in_body("");
    let body = read_with(fixed.as_bytes(), &option(Some(RootAttachment::Free))).unwrap();
    let names: Vec<_> = body.coordinates.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["root_tx", "root_ty", "root_tz", "root_qw", "root_qx", "root_qy", "root_qz"]);
    let free = world(&format!("<body pos='1 2 3' euler='90 0 0'><freejoint/>{G}</body>"));
    let body = read(&free).unwrap();
    assert_eq!(body.coordinates[2].default, 3.0);
    assert!((body.coordinates[4].default - 0.5_f64.sqrt()).abs() < 1e-15);
    let body = read_with(free.as_bytes(), &option(Some(RootAttachment::Fixed))).unwrap();
    assert!(body.coordinates.is_empty());
    assert_eq!(body.segments[0].in_parent.translation.vector.z, 3.0);
    let two = world(&format!("<body>{G}</body><body name='second'>{G}</body>"));
    let said = read_with(two.as_bytes(), &option(Some(RootAttachment::Free))).unwrap_err().to_string();
    assert!(said.contains("`second`: a root can be freed if the world has exactly one body"), "{said}");
}

#[test]
fn couplings_end_at_leaders_and_fixed_joints_are_locked() {
    let path = here().join("tests/models/from_geoms.xml");
    let body = read_file(&path, &Options::default());
    let index = |name: &str| body.coordinates.iter().position(|c| c.name == name).unwrap();
    assert!(body.coordinates[index("d")].locked);
    assert!((body.coordinates[index("d")].default - 0.8).abs() < 1e-15);
    // b + 0.1 = 0.5 (a - 0.2) + 0.25 (a - 0.2)^2, c = 0.1 + 2 (b + 0.1): MuJoCo's constraint, worked by hand at a = 0.7.
    for (name, value) in [("b", -0.1 + 0.25 + 0.0625), ("c", 0.1 + 2.0 * (0.25 + 0.0625))] {
        let coupling = body.couplings.iter().find(|c| c.dependent == index(name)).unwrap();
        assert_eq!(coupling.independent, index("a"));
        assert!((coupling.function.value(0.7) - value).abs() < 1e-15, "{name}");
    }
    let found: Vec<_> = body.ignored.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(found, [("equality (inactive)", 1)]);
}

#[test]
fn mutated_files_never_panic_and_give_finite_numbers() {
    let text = std::fs::read_to_string(here().join("tests/models/features.xml")).unwrap();
    let spring = std::fs::read_to_string(here().join("tests/models/compiler.xml")).unwrap();
    let parts = [
        "<body>",
        "</body>",
        "<frame pos='1e308 0 0'>",
        "</frame>",
        "<joint springdamper='1 1'/>",
        "1e308",
        "1e-320",
        "nan",
        "-",
        "0",
        "<inertial pos='0 0 0' mass='1e300' diaginertia='1 1 1'/>",
        "<geom size='1e200'/>",
        "'",
        "\"",
        "/>",
        "<include file='x'/>",
        "mass='0'",
    ];
    hammer("MJCF", 62, 40_000, &[text.as_bytes(), spring.as_bytes()], &parts, |text| {
        let Ok(body) = read_with(text, &Options::default()) else { return false };
        assert!(body.segments.iter().all(|s| s.mass.is_finite() && s.inertia.iter().all(|x| x.is_finite())));
        let sound = |c: &CoordinateIr| c.default.is_finite() && !c.range.0.is_nan() && !c.range.1.is_nan();
        assert!(body.coordinates.iter().all(sound));
        true
    });
}

#[test]
fn balls_have_their_own_names_and_free_joints_their_orientation() {
    let joints = "<joint name='up' type='slide' ref='0.2'/><joint name='tilt' axis='1 0 0' pos='0 0.1 0'/>\
                  <joint name='shoulder' type='ball' pos='0.3 0 0'/>";
    let body = read(&in_body(joints)).unwrap();
    let model = body.model().unwrap().model;
    let names: Vec<_> = model.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["up", "tilt", "shoulder_qw", "shoulder_qx", "shoulder_qy", "shoulder_qz"]);
    let rates: Vec<_> = model.rates().iter().map(|r| r.name.as_str()).collect();
    assert_eq!(rates, ["up", "tilt", "shoulder_mx", "shoulder_my", "shoulder_mz"]);
    assert!(names.iter().zip(&body.coordinates).all(|(name, c)| *name == c.name), "readers and models agree");
    // At the file's configuration the body stands where the file has it, a slide's reference taken off.
    let mut values = model.default_posture().values().to_vec();
    assert_eq!(values, [0.2, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let mut kinematics = contrapposto::kinematics::Kinematics::new(&model);
    assert!(kinematics.placement(&model, 0).translation.vector.norm() < 1e-15);
    // A half turn about the ball's own z, through its anchor, after a quarter turn of the hinge.
    (values[1], values[2], values[5]) = (std::f64::consts::FRAC_PI_2, 0.0, 1.0);
    kinematics.update(&model, &contrapposto::posture::Posture::new(values.clone())).unwrap();
    let (ours, readers) = (kinematics.placement(&model, 0), frames(&body, &values)[0]);
    assert!((ours.to_homogeneous() - readers.to_homogeneous()).amax() < 1e-15);
    let expected = [0.6, 0.1, -0.1];
    assert!(difference(ours.translation.vector.as_slice(), &expected) < 1e-15, "{ours}");

    let free = world(&format!("<body pos='1 2 3' quat='0.5 -0.5 0.5 0.5'><freejoint name='f'/>{G}</body>"));
    let model = read(&free).unwrap().model().unwrap().model;
    assert_eq!(model.default_posture().values(), [1.0, 2.0, 3.0, 0.5, -0.5, 0.5, 0.5]);
    let written = contrapposto_formats::write::mjcf(&model).unwrap().text;
    let back = read(&written).unwrap().model().unwrap().model;
    assert_eq!(back.default_posture(), model.default_posture(), "{written}");
    // As three angles in OpenSim: the same pose.
    let osim = contrapposto_formats::write::osim(&model).unwrap().text;
    let turned = contrapposto_formats::osim::read(osim.as_bytes(), "m").unwrap().model().unwrap().model;
    let pose = |model| contrapposto::kinematics::Kinematics::new(model).placement(model, 0).to_homogeneous();
    assert!((pose(&turned) - pose(&model)).amax() < 1e-14, "{osim}");
}
