//! Motions for other programs: glTF and BVH files, read by a reader of the test's own, place segments where our kinematics does;
//! OpenSim plays `.mot` on `.osim` to the same places (`scripts/compare_motion.py` asks it).

use contrapposto::kinematics::Kinematics;
use contrapposto::math::{Function, Spline};
use contrapposto::model::{Adult, CoordinateKind, Drive, JointKind, Model, ModelBuilder, Motion, adult};
use contrapposto::posture::Posture;
use contrapposto_formats::animation::{AnimationError, Clip, Solid, bvh, glb};
use contrapposto_formats::motion::{Units, postures, read_table};
use contrapposto_formats::write::{osim, osim_motion};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::common::here;
use super::players::{Bvh, Glb};
use super::{Osim, axis, build, hinges_and_slides, named, read, segment};

/// Greatest distance of places that agree, m.
const AGREEMENT: f64 = 1e-5;
/// Postures of a motion, and every so many of them OpenSim is asked about.
const ROWS: usize = 61;
const ASKED: usize = 15;

/// A free root, a ball, joints and couplings that functions drive, names that no program likes.
fn everything() -> Model {
    let spline = Spline::simm(&[-1.0, -0.2, 0.4, 1.3, 2.0], &[0.1, 0.3, -0.2, 0.0, 0.4]).unwrap();
    let motions = vec![
        (Motion::Slide(axis(1.0, 0.0, 0.0)), Drive::Function(Function::Spline(spline), 0)),
        (Motion::Hinge(axis(0.1, 0.2, 1.0)), Drive::Coordinate(0)),
        (Motion::Hinge(axis(1.0, 0.0, 0.0)), Drive::Function(Function::Polynomial(vec![0.1, 0.2, -0.05]), 1)),
    ];
    let (x, y) = (axis(1.0, 0.0, 0.0), axis(0.0, 1.0, 0.0));
    let parts = [
        segment("root", None, JointKind::Free, named(&["tx", "ty", "tz"])),
        segment("driven", Some("root"), JointKind::Driven(motions), named(&["p", "q"])),
        segment("ball", Some("driven"), JointKind::Ball, vec![]),
        segment("odd", Some("ball"), JointKind::Universal([y, x]), named(&["a/b", "a_b"])),
        segment("after", Some("root"), JointKind::Hinge(axis(1.0, 0.0, 1.0)), named(&["r"])),
        segment("fixed", Some("after"), JointKind::Weld, vec![]),
    ];
    let mut builder = ModelBuilder::new("every thing", Vector3::new(0.0, -9.81, 0.0));
    parts.into_iter().for_each(|part| builder.segment(part).unwrap());
    builder.couple("r", "p", Function::Linear { slope: 0.5, intercept: 0.1 }).unwrap();
    builder.build()
}

fn bodies() -> Vec<(&'static str, Model)> {
    let file = std::fs::read_to_string(here().join("../../scenarios/models/adult-female.osim")).unwrap();
    vec![
        ("adult", adult(&Adult::default()).unwrap()),
        ("right arm", adult(&Adult::right_arm()).unwrap()),
        ("adult-female.osim", read(&file, Osim)),
        ("hinges and slides", build(hinges_and_slides())),
        ("everything", everything()),
    ]
}

/// Every coordinate swings, balls turn round and round.
fn swinging(model: &Model) -> (Vec<f64>, Vec<Vec<f64>>) {
    let times: Vec<f64> = (0..ROWS).map(|row| 2.0 + 0.05 * row as f64).collect();
    let row = |t: &f64| {
        let mut values = vec![];
        while let Some(c) = model.coordinates().get(values.len()) {
            let n = values.len() as f64;
            let swing = libm::sin(1.3 * t + n);
            if c.kind == CoordinateKind::Quaternion {
                let spin = Vector3::new(2.0 * t + n, libm::sin(1.1 * t), libm::cos(0.8 * t));
                let q = UnitQuaternion::from_scaled_axis(spin);
                values.extend([q.w, q.i, q.j, q.k]);
            } else {
                let (low, high) = (c.range.0.max(-2.0), c.range.1.min(2.0));
                values.push(0.5 * (low + high) + 0.5 * (high - low) * swing);
            }
        }
        for coupling in model.couplings() {
            values[coupling.dependent] = coupling.function.value(values[coupling.independent]);
        }
        values
    };
    let rows = times.iter().map(row).collect();
    (times, rows)
}

/// Of every segment its joint's centre, its centre of mass, and the point as far beyond, in ground.
fn places(model: &Model, kinematics: &mut Kinematics, values: &[f64]) -> Vec<[Vector3<f64>; 3]> {
    kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
    let place = |s: usize| {
        let segment = &model.segments()[s];
        let joint = segment.in_segment.translation.vector;
        let at = |point| kinematics.station(model, s, point);
        [at(joint), at(segment.center_of_mass), at(2.0 * segment.center_of_mass - joint)]
    };
    (0..model.segments().len()).map(place).collect()
}

/// Left, up and ahead of the adult, turned a little for others.
fn directions(name: &str) -> [Vector3<f64>; 3] {
    let turn = if name == "everything" { Rotation3::from_euler_angles(0.4, -1.1, 2.0) } else { Rotation3::identity() };
    [-Vector3::z(), Vector3::y(), Vector3::x()].map(|d| turn * d)
}

fn clip<'a>(name: &str, model: &'a Model, times: &'a [f64], rows: &'a [&'a [f64]]) -> Clip<'a> {
    Clip {
        model,
        title: "swing",
        directions: directions(name),
        times,
        postures: rows,
        steps: false,
        things: &[],
        arrows: &[],
    }
}

fn drawn(clip: &Clip<'_>, p: Vector3<f64>) -> Vector3<f64> {
    Vector3::from(clip.directions.map(|d| d.dot(&p)))
}

#[test]
fn gltf_is_where_kinematics_is() {
    for (name, model) in bodies() {
        let (times, rows) = swinging(&model);
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let clip = clip(name, &model, &times, &rows);
        let ball = |s: &contrapposto::model::Segment| -> Vec<Solid> {
            vec![vec![[s.center_of_mass.x, s.center_of_mass.y, s.center_of_mass.z, 0.05]]]
        };
        let solids: Vec<Vec<Solid>> = model.segments().iter().map(ball).collect();
        let bytes = glb(&clip, &solids).unwrap();
        assert_eq!(bytes, glb(&clip, &solids).unwrap());
        let file = Glb::read(&bytes);
        let mut kinematics = Kinematics::new(&model);
        let mut worst = [0.0_f64; 2];
        for (time, row) in times.iter().zip(&rows) {
            let frames = file.frames(time - times[0]);
            for (s, [joint, center, _]) in places(&model, &mut kinematics, row).into_iter().enumerate() {
                let frame = &frames[&model.segments()[s].name];
                let at = Vector3::new(frame[(0, 3)], frame[(1, 3)], frame[(2, 3)]);
                worst[0] = worst[0].max((at - drawn(&clip, joint)).norm());
                for corner in file.corners(&model.segments()[s].name) {
                    let corner = frame.transform_point(&corner.into()).coords;
                    worst[1] = worst[1].max(((corner - drawn(&clip, center)).norm() - 0.05).abs());
                }
            }
        }
        println!("{name}: joints {:.1e} m, meshes {:.1e} m, {} bytes", worst[0], worst[1], bytes.len());
        assert!(worst.iter().all(|w| *w < AGREEMENT), "{name}: {worst:?}");
    }
}

#[test]
fn bvh_is_where_kinematics_is() {
    for (name, model) in bodies() {
        let (times, rows) = swinging(&model);
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let clip = clip(name, &model, &times, &rows);
        let text = bvh(&clip).unwrap();
        // Some programs add the places of channels to a joint's offset, others put them in its place.
        for replaces in [false, true] {
            let file = Bvh::read(&text);
            assert_eq!(file.rows.len(), ROWS);
            assert!((file.step - 0.05).abs() < 1e-12);
            let mut kinematics = Kinematics::new(&model);
            let mut worst = 0.0_f64;
            for (row, values) in rows.iter().zip(&file.rows) {
                let found = file.places(values, replaces);
                for (s, [joint, center, end]) in places(&model, &mut kinematics, row).into_iter().enumerate() {
                    let name = &model.segments()[s].name;
                    worst = worst.max((found[name] / 100.0 - drawn(&clip, joint)).norm());
                    let Some(tip) = found.get(&format!("{name} end")) else { continue };
                    if center == joint {
                        assert!(((found[name] - tip).norm() - 5.0).abs() < 1e-3, "{name} has no length");
                    } else {
                        worst = worst.max((tip / 100.0 - drawn(&clip, end)).norm());
                    }
                }
            }
            println!("{name}: {worst:.1e} m, {} bytes", text.len());
            assert!(worst < AGREEMENT, "{name}: {worst:e}");
            let jump = file.rows.windows(2).flat_map(|pair| pair[0].iter().zip(&pair[1])).map(|(a, b)| (a - b).abs());
            assert!(jump.fold(0.0, f64::max) < 120.0, "{name}: an angle jumps");
        }
    }
}

/// Nothing that moves, one posture, two roots, no solids: files all the same. Postures that do not fit are refused with the reason.
#[test]
fn little_and_wrong_motions() {
    let model = build(vec![
        segment("one", None, JointKind::Weld, vec![]),
        segment("two", None, JointKind::Hinge(axis(0.0, 0.0, 1.0)), named(&["h"])),
    ]);
    let (rest, up): (&[f64], &[f64]) = (&[0.0], &[0.5]);
    let still = Clip { times: &[0.0], ..clip("", &model, &[], &[]) };
    let file = Glb::read(&glb(&Clip { postures: &[rest], ..still }, &[]).unwrap());
    assert!(file.json.get("animations").is_none() && file.json.get("buffers").is_none());
    let text = bvh(&Clip { postures: &[rest], ..still }).unwrap();
    assert!(text.starts_with("HIERARCHY\nROOT ground\n{\n\tOFFSET 0 0 0\n\tCHANNELS 6 "), "{text}");
    // A rest of an hour between two moves costs two keys.
    let times: Vec<f64> = (0..1000).map(f64::from).collect();
    let rows: Vec<&[f64]> = (0..1000).map(|i| if i == 0 || i == 999 { up } else { rest }).collect();
    let long = Clip { times: &times, postures: &rows, ..still };
    let file = Glb::read(&glb(&long, &[]).unwrap());
    assert_eq!(file.json["animations"][0]["channels"].as_array().unwrap().len(), 1);
    assert!(file.json["accessors"].as_array().unwrap().iter().all(|accessor| accessor["count"] == 4));
    let wrong = |clip: Clip<'_>| (glb(&clip, &[]).unwrap_err(), bvh(&clip).unwrap_err());
    let both = |clip: Clip<'_>| {
        let (one, other) = wrong(clip);
        assert_eq!(one, other);
        one.to_string()
    };
    assert_eq!(both(still), "1 times and 0 postures: there must be one posture for every time");
    assert_eq!(both(Clip { times: &[], ..still }), "a motion needs a posture, and a body a segment");
    let falls = Clip { times: &[0.0, 0.0], postures: &[rest, rest], ..still };
    assert_eq!(both(falls), "time 0 s of posture 1 must be finite and after the one before it");
    assert!(both(Clip { postures: &[&[]], ..still }).contains("posture 0: posture has 0 values"));
    let [left, up, ahead] = still.directions;
    let mirrored = Clip { postures: &[rest], directions: [-left, up, ahead], ..still };
    assert_eq!(wrong(mirrored).0, AnimationError::Directions);
    let uneven = Clip { times: &[0.0, 1.0, 2.5], postures: &[rest; 3], ..still };
    assert_eq!(bvh(&uneven).unwrap_err().to_string(), "time 1 s of posture 1 breaks the even steps of BVH");
}

/// Names with blanks and braces stay one word each; a chain as deep as files may be neither recurses nor grows without bound.
#[test]
fn names_and_depth_in_bvh() {
    let mut parts = vec![segment("a {b}", None, JointKind::Weld, vec![])];
    for depth in 1..300 {
        let (name, parent) = (format!("s{depth}"), parts[depth - 1].name.clone());
        parts.push(segment(&name, Some(&parent), JointKind::Weld, vec![]));
    }
    let model = build(parts);
    let text = bvh(&Clip { times: &[0.0], postures: &[&[]], ..clip("", &model, &[], &[]) }).unwrap();
    assert!(text.contains("ROOT a__b_\n"));
    assert_eq!(Bvh::read(&text).rows[0].len(), 3 + 3 * 300);
}

/// The table of a motion gives our own reader the same postures, in degrees or not, whatever OpenSim calls the coordinates.
#[test]
fn a_motion_for_opensim_is_ours_too() {
    for (name, model) in bodies() {
        let (times, rows) = swinging(&model);
        let text = osim_motion(&model, "swing", &times, &rows).unwrap();
        let table = read_table(name, text.as_bytes()).unwrap();
        // What a function alone drives is no angle to OpenSim.
        assert_eq!(table.in_degrees, Some(name != "everything"), "{name}");
        let back = postures(&table, name, text.as_bytes(), &model, Units::FromFile).unwrap();
        let expected: &[&str] = if name == "everything" {
            &[
                "a_b_2",
                "root_joint_rx",
                "root_joint_ry",
                "root_joint_rz",
                "ball_joint_rx",
                "ball_joint_ry",
                "ball_joint_rz",
            ]
        } else {
            &[]
        };
        assert_eq!(back.unknown, expected, "{name}");
        for (row, (_, posture)) in rows.iter().zip(&back.postures) {
            let off = row.iter().zip(posture.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{name}: {off:e}");
        }
        // The file's own columns alone: as the model file reads.
        let file = read(&osim(&model).unwrap().text, Osim);
        // The angles of a ball that turns round and round go beyond a full turn.
        let units = if name == "everything" { Units::Radians } else { Units::FromFile };
        let back = postures(&table, name, text.as_bytes(), &file, units).unwrap();
        assert!(back.missing.is_empty(), "{name}: {:?}", back.missing);
        let (mut ours, mut theirs) = (Kinematics::new(&model), Kinematics::new(&file));
        for (row, (_, posture)) in rows.iter().zip(&back.postures) {
            let ours = places(&model, &mut ours, row);
            theirs.update(&file, posture).unwrap();
            for (s, segment) in model.segments().iter().enumerate() {
                let at = theirs.station(&file, file.segment(&segment.name).unwrap(), segment.center_of_mass);
                assert!((at - ours[s][1]).norm() < 1e-9, "{name}: {}", segment.name);
            }
        }
    }
}

/// Joint centres and centres of mass in some of the postures, one after the other.
fn points(model: &Model, rows: &[Vec<f64>]) -> Vec<Vec<[f64; 3]>> {
    let mut kinematics = Kinematics::new(model);
    let row = |row: &Vec<f64>| {
        places(model, &mut kinematics, row)
            .into_iter()
            .flat_map(|[joint, center, _]| [joint.into(), center.into()])
            .collect()
    };
    rows.iter().step_by(ASKED).map(row).collect()
}

/// For `scripts/compare_motion.py` and `compare_blender.py`: model, motion and points into the folder that `CONTRAPPOSTO_EXCHANGE` names.
#[test]
#[ignore = "needs CONTRAPPOSTO_EXCHANGE: a folder for scripts/compare_motion.py and compare_blender.py"]
fn exchange_motion() {
    let folder = std::env::var("CONTRAPPOSTO_EXCHANGE").expect("CONTRAPPOSTO_EXCHANGE: a folder to write to");
    let folder = std::path::Path::new(&folder);
    let mut all = vec![];
    for (i, (name, model)) in bodies().iter().enumerate() {
        let (times, rows) = swinging(model);
        std::fs::write(folder.join(format!("model_{i}.osim")), osim(model).unwrap().text).unwrap();
        std::fs::write(folder.join(format!("motion_{i}.mot")), osim_motion(model, name, &times, &rows).unwrap())
            .unwrap();
        let borrowed: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let clip = clip(name, model, &times, &borrowed);
        std::fs::write(folder.join(format!("motion_{i}.glb")), glb(&clip, &[]).unwrap()).unwrap();
        std::fs::write(folder.join(format!("motion_{i}.bvh")), bvh(&clip).unwrap()).unwrap();
        let stations = model.segments().iter().flat_map(|s| {
            let point = |p: Vector3<f64>| json!([s.name, [p.x, p.y, p.z]]);
            [point(s.in_segment.translation.vector), point(s.center_of_mass)]
        });
        all.push(json!({ "name": name, "every": ASKED, "step": times[1] - times[0], "directions": clip.directions.map(<[f64; 3]>::from), "stations": stations.collect::<Vec<_>>(), "points": points(model, &rows) }));
    }
    std::fs::write(folder.join("answers.json"), json!({ "models": all }).to_string()).unwrap();
}

#[test]
fn opensim_plays_the_motion_to_the_same_places() {
    let text = std::fs::read_to_string(here().join("tests/data/motion_peers.json")).unwrap();
    let kept: Value = serde_json::from_str(&text).unwrap();
    let (bodies, kept) = (bodies(), kept["models"].as_array().unwrap());
    assert_eq!(bodies.len(), kept.len());
    for ((name, model), kept) in bodies.iter().zip(kept) {
        let again = "has changed: run scripts/compare_motion.py again";
        assert_eq!(kept["name"], *name, "{again}");
        let theirs: Vec<Vec<[f64; 3]>> = serde_json::from_value(kept["points"].clone()).unwrap();
        let ours = points(model, &swinging(model).1);
        assert_eq!((theirs.len(), theirs[0].len()), (ours.len(), 2 * model.segments().len()), "{name} {again}");
        let pairs = ours.iter().flatten().zip(theirs.iter().flatten());
        let worst = pairs.map(|(a, b)| (Vector3::from(*a) - Vector3::from(*b)).norm()).fold(0.0, f64::max);
        println!("{name}: {worst:.1e} m");
        assert!(worst < AGREEMENT, "{name} differs from OpenSim by {worst:e} m and perhaps {again}");
    }
}
