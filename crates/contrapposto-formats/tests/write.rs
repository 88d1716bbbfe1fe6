//! Tests the writers: our readers read the written files as the same model, and other programs give the same torques.
//!
//! `write/laws.rs`: passive laws. `write/imported.rs`: model files survive their own format. `write/muscles.rs`: muscles, too.
//! `write/peers.rs`: what other programs say.
//! `write/motion.rs`: a body in motion, read back by the readers of `write/players.rs`. `write/skin.rs`: the adult's skin;
//! `write/skinned.rs`: its glTF.

use crate::common;
mod imported;
mod laws;
mod motion;
mod muscles;
mod peers;
mod players;
mod skin;
mod skinned;
mod tubes;

use std::collections::BTreeMap;

use common::next;
use contrapposto::kinematics::Kinematics;
use contrapposto::math::{Function, Spline};
use contrapposto::model::{
    Adult, CoordinateKind, CoordinateSpec, Drive, JointKind, Model, ModelBuilder, Motion, Placement, SegmentSpec, Sex,
    adult,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, Gradient};
use contrapposto_formats::write::{self, WriteError, Written};
use contrapposto_formats::{mjcf, osim, urdf};
use nalgebra::{Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Osim,
    Urdf,
    Mjcf,
}

use Format::{Mjcf, Osim, Urdf};

fn write(model: &Model, format: Format) -> Result<Written, WriteError> {
    match format {
        Osim => write::osim(model),
        Urdf => write::urdf(model),
        Mjcf => write::mjcf(model),
    }
}

fn read(text: &str, format: Format) -> Model {
    let body = match format {
        Osim => osim::read(text.as_bytes(), "test").map_err(|e| e.to_string()),
        Urdf => urdf::read(text.as_bytes(), "test", &urdf::Options::default()).map_err(|e| e.to_string()),
        Mjcf => {
            let mut none = |_: &str| Err("no includes".to_owned());
            mjcf::read(text.as_bytes(), "test", &mut none, &mjcf::Options::default()).map_err(|e| e.to_string())
        }
    };
    body.unwrap_or_else(|e| panic!("{e}\n{text}")).model().unwrap_or_else(|e| panic!("{e}\n{text}")).model
}

/// A number in 0..1 from a seeded generator.
fn random(state: &mut u64) -> f64 {
    next(state) as f64 / (1u64 << 31) as f64
}

/// Values inside the ranges, by name; quaternions of unit length.
fn posture(model: &Model, state: &mut u64) -> BTreeMap<String, f64> {
    let mut values = BTreeMap::new();
    let mut squares = 0.0;
    for coordinate in model.coordinates() {
        let (low, high) = (coordinate.range.0.max(-1.5), coordinate.range.1.min(1.5));
        let value = low + (high - low).max(0.0) * random(state);
        squares += if coordinate.kind == CoordinateKind::Quaternion { value * value } else { 0.0 };
        values.insert(coordinate.name.clone(), value);
    }
    let length = squares.sqrt();
    for coordinate in model.coordinates().iter().filter(|c| c.kind == CoordinateKind::Quaternion) {
        *values.get_mut(&coordinate.name).unwrap() /= length;
    }
    values
}

/// By rate: external and passive torque, and the gradient's row by rate.
type Torques = BTreeMap<String, (f64, f64, BTreeMap<String, f64>)>;

fn torques(model: &Model, values: &BTreeMap<String, f64>) -> Torques {
    let q: Vec<f64> = model.coordinates().iter().map(|c| values[&c.name]).collect();
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(q.clone())).unwrap();
    let (mut external, mut gradient) = (ExternalTorque::new(model), Gradient::new(model));
    external.update(model, &kinematics, &[]).unwrap();
    external.gradient(model, &kinematics, &mut gradient);
    let rates = model.rates();
    let row = |i: usize| (0..rates.len()).map(|j| (rates[j].name.clone(), gradient.get(i, j))).collect();
    let passive = |i: usize| {
        let law = rates[i].coordinate.and_then(|c| model.coordinates()[c].passive.as_ref().map(|law| (c, law)));
        law.map_or(0.0, |(c, law)| law.torque(c, kinematics.values()))
    };
    (0..rates.len()).map(|i| (rates[i].name.clone(), (external.torques()[i], passive(i), row(i)))).collect()
}

/// Greatest difference of torques and gradients on random postures, relative to their size.
fn difference(ours: &Model, theirs: &Model, with_passive: bool) -> f64 {
    let mut state = 7;
    let mut worst: f64 = 0.0;
    for _ in 0..20 {
        let values = posture(ours, &mut state);
        let (a, b) = (torques(ours, &values), torques(theirs, &values));
        assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
        let size = a.values().fold(1.0_f64, |s, (e, p, _)| s.max(e.abs()).max(p.abs()));
        let steep = a.values().flat_map(|r| r.2.values()).fold(size, |s, v| s.max(v.abs()));
        for (name, (external, passive, row)) in &a {
            let (e, p, r) = &b[name];
            worst = worst.max((external - e).abs() / size);
            if with_passive {
                worst = worst.max((passive - p).abs() / size);
            }
            worst = row.iter().fold(worst, |w, (other, value)| w.max((value - r[other]).abs() / steep));
        }
    }
    worst
}

fn adults() -> Vec<Adult> {
    let woman = Adult { sex: Sex::Female, stature: 1.52, mass: 50.0, ..Adult::default() };
    vec![Adult::default(), woman, Adult::right_arm()]
}

#[test]
fn adult_is_the_same_body_in_every_format() {
    for size in adults() {
        let model = adult(&size).unwrap();
        for format in [Osim, Urdf, Mjcf] {
            let written = write(&model, format).unwrap();
            assert_eq!(written, write(&model, format).unwrap(), "the same text every time");
            let back = read(&written.text, format);
            assert!((back.mass() - model.mass()).abs() < 1e-12 * model.mass());
            for coordinate in model.coordinates() {
                let found = &back.coordinates()[back.coordinate(&coordinate.name).unwrap()];
                assert_eq!((found.range, found.kind), (coordinate.range, coordinate.kind), "{}", coordinate.name);
                if format != Urdf {
                    assert_eq!(found.default, coordinate.default, "{}", coordinate.name);
                }
                if format == Osim && coordinate.curve().is_some() {
                    let q = coordinate.range.0 + 0.37 * (coordinate.range.1 - coordinate.range.0);
                    let own = back.coordinate(&coordinate.name).unwrap();
                    let mut values = vec![0.0; back.coordinates().len()];
                    values[own] = q;
                    let torque = found.passive.as_ref().unwrap().torque(own, &values);
                    let wanted = coordinate.curve().unwrap().torque(q);
                    assert!((torque - wanted).abs() <= 1e-12 * wanted.abs().max(1.0), "{}", coordinate.name);
                }
            }
            let worst = difference(&model, &back, false);
            assert!(worst < 1e-12, "{format:?}: {worst:e}");
            assert!(!written.lost.is_empty());
        }
    }
}

fn axis(x: f64, y: f64, z: f64) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::new(x, y, z))
}

fn pose(x: f64, y: f64, z: f64, turn: [f64; 3]) -> Placement {
    Placement::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]))
}

/// A segment of 2 kg with a skew inertia, joined at a skew place.
fn segment(name: &str, parent: Option<&str>, kind: JointKind, coordinates: Vec<CoordinateSpec>) -> SegmentSpec {
    SegmentSpec {
        name: name.to_owned(),
        parent: parent.map(str::to_owned),
        mass: 2.0,
        center_of_mass: Vector3::new(0.1, -0.3, 0.05),
        inertia: Matrix3::new(0.05, 0.001, 0.002, 0.001, 0.04, 0.003, 0.002, 0.003, 0.03),
        joint: format!("{name}_joint"),
        kind,
        in_parent: pose(0.1, -0.4, 0.2, [0.3, -0.2, 0.5]),
        in_segment: pose(0.02, 0.03, -0.01, [0.1, 0.7, -0.4]),
        coordinates,
    }
}

fn named(names: &[&str]) -> Vec<CoordinateSpec> {
    names.iter().map(|name| CoordinateSpec::new(name, (-1.2, 1.1))).collect()
}

fn build(segments: Vec<SegmentSpec>) -> Model {
    let mut builder = ModelBuilder::new("made", Vector3::new(0.5, -9.5, 1.0).normalize() * 9.81);
    segments.into_iter().for_each(|s| builder.segment(s).unwrap());
    builder.build()
}

/// Every kind of joint without balls, with long and mixed chains.
fn hinges_and_slides() -> Vec<SegmentSpec> {
    let (x, y, z, skew) = (axis(1.0, 0.0, 0.0), axis(0.0, 1.0, 0.0), axis(0.0, 0.0, 1.0), axis(0.3, -0.5, 0.8));
    let mut chain = named(&["c1", "c2", "c3", "c4", "c5", "c6"]);
    chain[1].default = 0.25;
    chain[4].default = -0.3;
    chain[5].locked = true;
    let mixed = vec![
        Motion::Hinge(x),
        Motion::Slide(skew),
        Motion::Slide(y),
        Motion::Hinge(z),
        Motion::Hinge(y),
        Motion::Hinge(z),
    ];
    vec![
        segment("a", None, JointKind::Weld, vec![]),
        segment("b", Some("a"), JointKind::Hinge(skew), named(&["h"])),
        segment("c", Some("b"), JointKind::Slide(skew), named(&["s"])),
        segment("d", Some("b"), JointKind::Universal([x, skew]), named(&["u1", "u2"])),
        segment("e", Some("c"), JointKind::Gimbal([z, x, y]), named(&["g1", "g2", "g3"])),
        segment("f", Some("d"), JointKind::Chain(mixed), chain),
        SegmentSpec {
            mass: 0.0,
            inertia: Matrix3::zeros(),
            ..segment("g", Some("f"), JointKind::Hinge(y), named(&["m"]))
        },
        segment("h", Some("g"), JointKind::Hinge(z), named(&["n"])),
        segment("i", Some("h"), JointKind::Weld, vec![]),
    ]
}

#[test]
fn every_joint_of_hinges_and_slides_in_every_format() {
    let model = build(hinges_and_slides());
    for format in [Osim, Urdf, Mjcf] {
        let written = write(&model, format).unwrap();
        let back = read(&written.text, format);
        let worst = difference(&model, &back, false);
        assert!(worst < 1e-12, "{format:?}: {worst:e}\n{}", written.text);
        let named =
            |m: &Model| m.coordinates().iter().map(|c| (c.name.clone(), c.range.0, c.range.1)).collect::<Vec<_>>();
        let sorted = |m: &Model| {
            let mut all = named(m);
            all.sort_by(|a, b| a.0.cmp(&b.0));
            all
        };
        assert_eq!(sorted(&back), sorted(&model));
        if format != Urdf {
            for c in model.coordinates() {
                let found = &back.coordinates()[back.coordinate(&c.name).unwrap()];
                assert_eq!((found.default, found.locked), (c.default, c.locked), "{format:?} {}", c.name);
            }
        }
        println!("{format:?}: {worst:e}\n{}", written.lost.join("\n"));
    }
}

#[test]
fn driven_joints_and_couplings_in_osim() {
    let (x, y, z) = (axis(1.0, 0.0, 0.0), axis(0.0, 1.0, 0.0), axis(0.1, 0.2, 1.0));
    let spline = Spline::simm(&[-1.0, -0.2, 0.4, 1.3, 2.0], &[0.1, 0.3, -0.2, 0.0, 0.4]).unwrap();
    let straight = Spline::piecewise_linear(&[-1.0, 0.1, 1.3], &[0.1, 0.3, -0.2]).unwrap();
    let motions = vec![
        (Motion::Slide(x), Drive::Function(Function::Spline(spline), 0)),
        (Motion::Slide(y), Drive::Function(Function::Polynomial(vec![0.1, 0.2, -0.05]), 0)),
        (Motion::Hinge(z), Drive::Coordinate(0)),
        (Motion::Hinge(x), Drive::Function(Function::Sine { amplitude: 0.2, omega: 1.5, phase: 0.1, offset: 0.3 }, 1)),
        (Motion::Hinge(y), Drive::Fixed(0.2)),
    ];
    let mut builder = ModelBuilder::new("driven", Vector3::new(0.0, -9.81, 0.0));
    builder.segment(segment("a", None, JointKind::Driven(motions), named(&["p", "q"]))).unwrap();
    builder.segment(segment("b", Some("a"), JointKind::Universal([x, y]), named(&["r", "s"]))).unwrap();
    builder.couple("s", "r", Function::Spline(straight)).unwrap();
    let model = builder.build();
    let written = write::osim(&model).unwrap();
    let back = read(&written.text, Osim);
    assert!(difference(&model, &back, false) < 1e-12, "{}", written.text);
    assert_eq!(back.couplings(), model.couplings());
    let urdf = write::urdf(&model).unwrap_err();
    assert_eq!(urdf.to_string(), "joint `a_joint`: URDF has no joint that a function drives");
    assert!(matches!(write::mjcf(&model), Err(WriteError::Joint { .. })));
}

/// OpenSim's GCVSpline, as a joint's drive and as a coupling: what is read back is what was written, and so is its text.
#[test]
fn natural_splines_in_osim() {
    let spline = |scale: f64| {
        let y = [0.1, 0.3, -0.2, 1.0 / 3.0, 0.4].map(|y| scale * y);
        Function::NaturalSpline(Spline::natural(&[-1.0, -0.2, 0.4, 1.3, 2.0], &y).unwrap())
    };
    let (x, z) = (axis(1.0, 0.0, 0.0), axis(0.0, 0.0, 1.0));
    // Frames that turn nothing are written to the last digit.
    let segment = |name: &str, parent: Option<&str>, kind, names: &[&str]| SegmentSpec {
        in_parent: Placement::identity(),
        in_segment: Placement::identity(),
        ..segment(name, parent, kind, named(names))
    };
    let motions = vec![(Motion::Slide(x), Drive::Function(spline(0.5), 0)), (Motion::Hinge(z), Drive::Coordinate(0))];
    let mut builder = ModelBuilder::new("natural", Vector3::new(0.0, -9.81, 0.0));
    builder.segment(segment("a", None, JointKind::Driven(motions), &["p"])).unwrap();
    builder.segment(segment("b", Some("a"), JointKind::Hinge(x), &["q"])).unwrap();
    builder.couple("q", "p", spline(1.0)).unwrap();
    let model = builder.build();
    let written = write::osim(&model).unwrap();
    assert_eq!((written.text.matches("<GCVSpline").count(), written.lost.len()), (2, 0), "{}", written.text);
    let back = read(&written.text, Osim);
    assert_eq!(back.couplings(), model.couplings());
    assert!(difference(&model, &back, false) < 1e-12, "{}", written.text);
    assert_eq!(write::osim(&back).unwrap().text, written.text);
}

#[test]
fn linear_couplings_in_urdf_and_polynomials_in_mjcf() {
    let x = axis(1.0, 0.0, 0.0);
    let make = |function: Function| {
        let mut builder = ModelBuilder::new("coupled", Vector3::new(0.0, 0.0, -9.81));
        let mut hinge = named(&["r"]);
        hinge[0].default = 0.5;
        builder.segment(segment("a", None, JointKind::Hinge(x), hinge)).unwrap();
        builder.segment(segment("b", Some("a"), JointKind::Hinge(x), named(&["s"]))).unwrap();
        builder.couple("s", "r", function).unwrap();
        builder.build()
    };
    let linear = make(Function::Linear { slope: 0.5, intercept: 0.1 });
    let back = read(&write::urdf(&linear).unwrap().text, Urdf);
    assert_eq!(back.couplings(), linear.couplings());
    assert!(difference(&linear, &back, false) < 1e-12);
    let cubic = make(Function::Polynomial(vec![0.1, 0.2, -0.3, 0.04]));
    let back = read(&write::mjcf(&cubic).unwrap().text, Mjcf);
    assert!(difference(&cubic, &back, false) < 1e-12);
    assert!(write::urdf(&cubic).unwrap().lost.iter().any(|l| l.contains("`s` follows `r` by a curve")));
}

#[test]
fn balls_and_free_joints() {
    let ball = || segment("b", Some("a"), JointKind::Ball, vec![]);
    let free = |joint: &str| SegmentSpec {
        joint: joint.to_owned(),
        in_parent: Placement::identity(),
        in_segment: Placement::identity(),
        ..segment(
            "a",
            None,
            JointKind::Free,
            ["tx", "ty", "tz"]
                .iter()
                .map(|e| CoordinateSpec::new(&format!("{joint}_{e}"), (f64::NEG_INFINITY, f64::INFINITY)))
                .collect(),
        )
    };
    let mut lifted = free("root");
    lifted.coordinates[1].default = 0.9;
    let model = build(vec![lifted, ball()]);
    let written = write::mjcf(&model).unwrap();
    assert!(written.text.contains("<freejoint name=\"root\"/>"), "{}", written.text);
    let back = read(&written.text, Mjcf);
    assert!(difference(&model, &back, false) < 1e-12, "{}", written.text);
    assert_eq!(back.default_posture(), model.default_posture());
    // Elsewhere than at the world's origin it is three slides and a ball.
    let skew = SegmentSpec { joint: "r".to_owned(), ..segment("a", None, JointKind::Free, named(&["x", "y", "z"])) };
    let skew = build(vec![skew, ball()]);
    let back = read(&write::mjcf(&skew).unwrap().text, Mjcf);
    assert!(difference(&skew, &back, false) < 1e-12);
    let alone = build(vec![segment("a", None, JointKind::Free, free("a_joint").coordinates)]);
    let back = read(&write::urdf(&alone).unwrap().text, Urdf);
    assert!(difference(&alone, &back, false) < 1e-12);
    assert_eq!(write::urdf(&model).unwrap_err().to_string(), "joint `b_joint`: URDF has no ball joint");
    let written = write::osim(&skew).unwrap();
    let back = read(&written.text, Osim);
    assert_eq!(back.rates().len(), 9);
    assert!(
        back.coordinate("b_joint_rx").is_some()
            && written.lost.iter().any(|l| l.contains("quaternion of joint `b_joint`"))
    );
}

#[test]
fn odd_names_and_what_programs_refuse() {
    let mut odd = segment("a<b> & \"c\"", None, JointKind::Hinge(axis(1.0, 0.0, 0.0)), named(&["it's\tq"]));
    odd.joint = "j/k l".to_owned();
    let model = build(vec![odd.clone()]);
    let back = read(&write::urdf(&model).unwrap().text, Urdf);
    assert!(back.coordinate("it's\tq").is_some() && back.segment("a<b> & \"c\"").is_some());
    assert!(read(&write::mjcf(&model).unwrap().text, Mjcf).coordinate("it's\tq").is_some());
    let written = write::osim(&model).unwrap();
    assert!(read(&written.text, Osim).coordinate("it's_q").is_some());
    assert!(
        written.lost.iter().any(|l| l == "The coordinate \"it's\\tq\" is named `it's_q` in the file."),
        "{:?}",
        written.lost
    );
    // The comment with the lost parts stays one comment.
    let arrow = build(vec![segment("s", None, JointKind::Hinge(axis(1.0, 0.0, 0.0)), named(&["a --> b"]))]);
    let written = write::osim(&arrow).unwrap();
    assert!(written.text.contains("<!-- Lost: The coordinate \"a \u{2010}\u{2010}> b\" is named"), "{}", written.text);
    assert!(read(&written.text, Osim).coordinate("a_-->_b").is_some());
    odd.name.push('\u{1}');
    for format in [Osim, Urdf, Mjcf] {
        assert!(matches!(write(&build(vec![odd.clone()]), format), Err(WriteError::Name { .. })));
    }
    let light =
        SegmentSpec { mass: 0.0, ..segment("light", None, JointKind::Hinge(axis(1.0, 0.0, 0.0)), named(&["l"])) };
    let written = write::mjcf(&build(vec![light])).unwrap();
    assert!(written.lost[0].starts_with("Segment `light` has no mass, which MuJoCo refuses"), "{:?}", written.lost);
    let seven = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from).map(Unit::new_normalize).map(Motion::Hinge);
    let seven = JointKind::Chain(seven.into_iter().cycle().take(7).collect());
    let long = segment("long", None, seven, named(&["a", "b", "c", "d", "e", "f", "g"]));
    let error = write::mjcf(&build(vec![long])).unwrap_err().to_string();
    assert_eq!(error, "segment `long`: more than six motions before the next mass; MuJoCo's bodies have six at most");
}

/// A URDF or MJCF reader takes names of any length, and writes control characters as escapes, which makes them longer.
#[test]
fn names_longer_than_readers_take_are_shortened_and_it_is_said() {
    let long = "\\u007f".repeat(50);
    let hinge = JointKind::Hinge(axis(1.0, 0.0, 0.0));
    let model = build(vec![segment(&long, None, hinge, named(&[&long]))]);
    for format in [Osim, Urdf, Mjcf] {
        let written = write(&model, format).unwrap();
        let back = read(&written.text, format);
        let name = &back.coordinates()[0].name;
        assert!((200..=256).contains(&name.len()) && back.segments()[0].name.len() <= 256, "{name}");
        let said = format!("The coordinate {long:?} is named `{name}` in the file.");
        assert!(written.lost.contains(&said), "{said}\n{:?}", written.lost);
    }
}

/// MuJoCo's body of both joints has its own frame, which the ball turns.
#[test]
fn a_ball_whose_segment_has_no_mass_and_a_hinge_behind_it() {
    let light = SegmentSpec {
        mass: 0.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::zeros(),
        ..segment("b", Some("a"), JointKind::Ball, vec![])
    };
    let model = build(vec![
        segment("a", None, JointKind::Hinge(axis(0.0, 1.0, 0.0)), named(&["q"])),
        light,
        segment("c", Some("b"), JointKind::Hinge(axis(1.0, 0.0, 0.0)), named(&["h"])),
    ]);
    let written = write::mjcf(&model).unwrap();
    let back = read(&written.text, Mjcf);
    assert!(difference(&model, &back, false) < 1e-12, "{}", written.text);
}

/// Turned by its own frame, an inertia that no solid body has gets a moment below 0, which a URDF file may not hold.
#[test]
fn an_inertia_of_no_body_is_written_as_one_that_urdf_readers_take() {
    let text = r#"<robot name="r"><link name="base"/><link name="a"><inertial><origin rpy="0 0.8 0"/><mass value="1"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="5" iyz="0"/></inertial></link>
        <joint name="j" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#;
    let written = write::urdf(&read(text, Urdf)).unwrap();
    assert!(written.lost.iter().any(|lost| lost.starts_with("The inertia of `a` is not that of a solid body")));
    let back = read(&written.text, Urdf);
    assert!((back.segments()[1].inertia - nalgebra::Matrix3::from_diagonal_element(0.1)).amax() < 1e-12);
}
