//! URDF models as bodies: a hand-made one by hand, published ones against Pinocchio's order and their MJCF twins.

use crate::common;

use common::{center_of_mass, difference, frames, hammer, here, shared};
use contrapposto_formats::model_ir::{CoordinateKind, Function, ModelIr, MotionIr, RootAttachment};
use contrapposto_formats::xml::Limits;
use contrapposto_formats::{mjcf, urdf};
use nalgebra::{Matrix3, Rotation3, Vector3};

fn read(text: &[u8], root: RootAttachment) -> Result<ModelIr, urdf::UrdfError> {
    urdf::read(text, "file.urdf", &urdf::Options { root, ..Default::default() })
}

fn file(path: &std::path::Path, root: RootAttachment) -> ModelIr {
    read(&std::fs::read(path).unwrap(), root).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_joint_type_is_read() {
    let body = file(&here().join("tests/models/arm.urdf"), RootAttachment::Fixed);
    assert_eq!(body.name, "arm");
    assert_eq!(body.gravity, Vector3::new(0.0, 0.0, -9.81));
    // Depth first, children by the name of their joint.
    let names: Vec<&str> = body.segments.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["base", "kite", "puck", "upper", "lower", "finger_a", "finger_b", "finger_c", "tip"]);
    let coordinates: Vec<&str> = body.coordinates.iter().map(|c| c.name.as_str()).collect();
    let kite = ["kite_tx", "kite_ty", "kite_tz", "kite_qw", "kite_qx", "kite_qy", "kite_qz"];
    let rest = ["puck_tx", "puck_ty", "puck_rz", "z_shoulder", "elbow", "finger_a", "finger_b", "finger_c"];
    assert_eq!(coordinates, [&kite[..], &rest[..]].concat());
    let shoulder = &body.coordinates[10];
    assert_eq!((shoulder.range, shoulder.clamped), ((-1.0, 2.0), true));
    assert_eq!(body.coordinates[11].range, (f64::NEG_INFINITY, f64::INFINITY));
    assert_eq!(body.coordinates[12].kind, CoordinateKind::Translation);
    // Mimics of mimics end at the joint that moves by itself: c = 3 (-2 a + 0.01) + 0.5.
    let couplings: Vec<_> = body.couplings.iter().map(|c| (c.dependent, c.independent)).collect();
    assert_eq!(couplings, [(13, 12), (14, 12)]);
    assert_eq!(body.couplings[0].function, Function::Linear { slope: -2.0, intercept: 0.01 });
    assert_eq!(body.couplings[1].function, Function::Linear { slope: -6.0, intercept: 0.53 });
    let upper = &body.segments[3];
    assert_eq!(upper.center_of_mass, Vector3::new(0.1, 0.2, 0.3));
    // Roll, pitch, yaw about fixed axes: Rz(0.5) Ry(-0.2) Rx(0.3).
    let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
    let r = turn(Vector3::z_axis(), 0.5) * turn(Vector3::y_axis(), -0.2) * turn(Vector3::x_axis(), 0.3);
    let own = Matrix3::new(0.1, 0.01, 0.02, 0.01, 0.2, -0.03, 0.02, -0.03, 0.15);
    assert!((upper.inertia - r * own * r.inverse()).amax() < 1e-16);
    assert!(
        matches!(&upper.motions[..], [MotionIr::Hinge { axis, .. }] if (axis - Vector3::new(0.0, 0.6, 0.8)).amax() < 1e-16)
    );
    let ignored: Vec<_> = body.ignored.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(
        ignored,
        [("dynamics", 1), ("gazebo", 1), ("material", 1), ("safety_controller", 1), ("transmission", 1), ("visual", 1)]
    );
    let freed = file(&here().join("tests/models/arm.urdf"), RootAttachment::Free);
    assert_eq!(freed.coordinates[0].name, "root_tx");
    assert_eq!(freed.coordinates[6].name, "root_qz");
    assert_eq!(freed.coordinates.len(), body.coordinates.len() + 7);
    assert!(matches!(
        freed.segments[0].motions[..],
        [MotionIr::Slide { .. }, MotionIr::Slide { .. }, MotionIr::Slide { .. }, MotionIr::Ball { first: 3 }]
    ));
}

#[test]
#[ignore = "needs ../shared: a published human model, with Pinocchio's order of its joints"]
fn order_is_pinocchios() {
    let model = shared("models/human-gazebo/humanSubject01_48dof.urdf");
    let vectors = shared("vectors/pinocchio_human48_fixed_first5.json");
    let body = file(&model, RootAttachment::Fixed);
    let vectors: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(vectors).unwrap()).unwrap();
    let expected: Vec<&str> =
        vectors["joint_names"].as_array().unwrap().iter().skip(1).map(|n| n.as_str().unwrap()).collect();
    let found: Vec<&str> = body.coordinates.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(found, expected);
    let moving: f64 = body.segments.iter().map(|s| s.mass).sum();
    let mass = |key: &str| vectors[key].as_f64().unwrap();
    assert!((moving - mass("total_mass_moving") - mass("root_link_mass_at_universe")).abs() < 1e-12);
}

/// The MJCF twins have the same bodies, with massless links merged: same centre of mass and hand wherever they move.
#[test]
#[ignore = "needs ../shared: published human models in both formats"]
fn urdf_and_mjcf_twins_agree() {
    for (size, root) in [
        (48, RootAttachment::Fixed),
        (48, RootAttachment::Free),
        (66, RootAttachment::Fixed),
        (66, RootAttachment::Free),
    ] {
        let ending = if root == RootAttachment::Free { "free" } else { "fixed" };
        let urdf_path = shared(&format!("models/human-gazebo/humanSubject01_{size}dof.urdf"));
        let mjcf_path = shared(&format!("models/human-gazebo/human{size}_{ending}.mjcf.xml"));
        let first = file(&urdf_path, root);
        let no_include = &mut |name: &str| Err(name.to_owned());
        let second = mjcf::read(&std::fs::read(mjcf_path).unwrap(), "f", no_include, &Default::default()).unwrap();
        let mut state = 7;
        let mut worst = [0.0_f64; 2];
        for _ in 0..20 {
            let mut q: Vec<f64> =
                first.coordinates.iter().map(|_| common::next(&mut state) as f64 / (1u64 << 31) as f64 - 0.5).collect();
            if root == RootAttachment::Free {
                let norm = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
                q[3..7].iter_mut().for_each(|x| *x /= norm);
            }
            let of = |name: &str| first.coordinates.iter().position(|c| c.name == name);
            let other: Vec<f64> =
                second.coordinates.iter().enumerate().map(|(i, c)| q[of(&c.name).unwrap_or(i)]).collect();
            let hand = first.segments.iter().position(|s| s.name == "RightHand").unwrap();
            let (_, segment, at) = second.stations.iter().find(|s| s.0 == "RightHand").unwrap();
            let there = frames(&second, &other)[*segment] * nalgebra::Point3::from(*at);
            worst[0] = worst[0]
                .max(difference(frames(&first, &q)[hand].translation.vector.as_slice(), there.coords.as_slice()));
            worst[1] = worst[1].max((center_of_mass(&first, &q) - center_of_mass(&second, &other)).amax());
            // The tree's frames are whole: a turned quaternion root turns everything.
        }
        println!("human{size} {ending}: hand {:.1e} m, centre of mass {:.1e} m over 20 postures", worst[0], worst[1]);
        assert!(worst.iter().all(|w| *w < 1e-12), "{worst:?}");
    }
}

#[test]
#[ignore = "needs ../shared: a published human model"]
fn other_published_models_are_read() {
    let body = file(&shared("models/gepetto/human.urdf"), RootAttachment::Free);
    assert_eq!(body.coordinates.len(), 7 + 36);
    assert_eq!(body.segments.len(), 37);
}

/// Mistakes that Pinocchio accepts and published robots hold are read past: mimics that mean nothing, moments that rounding left below zero.
#[test]
fn small_mistakes_are_read_past_and_counted() {
    let body = file(&here().join("tests/models/humanoid.urdf"), RootAttachment::Fixed);
    let count = |kind: &str| body.ignored.iter().find(|(k, _)| k == kind).map(|(_, n)| *n);
    assert_eq!(count("mimic of a fixed joint"), Some(1));
    assert_eq!(count("mimic of a joint that is not there"), Some(1));
    assert_eq!(body.couplings.len(), 2);
    assert!(body.segments.iter().all(|s| s.inertia.diagonal().min() >= 0.0));
}

#[test]
fn refusals_say_where() {
    let robot = |inside: &str| format!("<robot name='r'>\n{inside}\n</robot>");
    let joint = |inside: &str| {
        robot(&format!("<link name='a'/><link name='b'/>\n<joint name='j' type='revolute'>{inside}</joint>"))
    };
    let ends = "<parent link='a'/><child link='b'/>";
    for (text, expected) in [
        ("<mujoco/>".to_owned(), "<mujoco> at line 1, column 1: a URDF file's outermost element is <robot>"),
        (robot(""), "<robot> at line 1, column 1: `r`: a robot has at least one link"),
        (robot("<link/>"), "<link name> at line 2, column 1: the attribute is missing"),
        (
            robot("<link name='a'/>\n<link name='a'/>"),
            "<link name> at line 3, column 7: a second <link> is called `a`; names must differ",
        ),
        (
            robot("<link name='a'/>\n<link name='b'/>"),
            "<link name> at line 3, column 7: `b`: exactly one link is no joint's child; this is a second one",
        ),
        (joint(ends), "<joint> at line 3, column 1: <limit> is missing inside"),
        (joint("<parent link='a'/>"), "<joint> at line 3, column 1: <child> is missing inside"),
        (
            joint("<parent link='a'/><child link='bb'/><limit/>"),
            "<child link> at line 3, column 58: there is no link `bb`; did you mean `b`?",
        ),
        (
            joint(&format!("{ends}<limit lower='1' upper='0'/>")),
            "<limit lower> at line 3, column 75: `1 0`: the lower limit is at most the upper one",
        ),
        (
            joint(&format!("{ends}<limit/><axis xyz='0 0 0'/>")),
            "<axis xyz> at line 3, column 82: `0 0 0`: an axis is longer than zero",
        ),
        (
            joint(&format!("{ends}<limit/><axis xyz='0 0'/>")),
            "<axis xyz> at line 3, column 82: 2 numbers; exactly 3 accepted",
        ),
        (
            joint(&format!("{ends}<limit/><origin rpy='0 nan 0'/>")),
            "<origin rpy> at line 3, column 84: `nan` is not a finite number",
        ),
        (
            joint(&format!("{ends}<limit upper='1e999'/>")),
            "<limit upper> at line 3, column 75: `1e999` is not a finite number",
        ),
        (
            joint(&format!("{ends}<limit upper='${{pi}}'/>")),
            "<limit upper> at line 3, column 75: `${pi}` is not a number",
        ),
        (
            joint(&format!("{ends}<limit/><mimic joint='j'/>")),
            "<mimic joint> at line 3, column 83: `j`: joints mimic each other in a circle",
        ),
        (
            joint(ends).replace("revolute", "hinge"),
            "<joint type> at line 3, column 17: `hinge` is no joint type; there are revolute, continuous, prismatic, fixed, floating, planar",
        ),
        (
            robot(
                "<link name='a'/><link name='b'/><link name='c'/>\n<joint name='1' type='fixed'><parent link='b'/><child link='c'/></joint><joint name='2' type='fixed'><parent link='c'/><child link='b'/></joint>",
            ),
            "<link name> at line 2, column 23: `b`: links form a tree; this one is its own ancestor",
        ),
        (
            robot("<link name='a'><inertial><mass value='-1'/></inertial></link>"),
            "<mass value> at line 2, column 32: `-1`: a mass is zero or more, kg",
        ),
        (
            robot(
                "<link name='a'><inertial><mass value='1'/><inertia ixx='-1e-9' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>",
            ),
            "<inertia ixx> at line 2, column 52: `-0.000000001`: a moment of inertia is zero or more, kg m2",
        ),
        (robot("<link name='a'><inertial/></link>"), "<inertial> at line 2, column 16: <mass> is missing inside"),
    ] {
        assert_eq!(read(text.as_bytes(), RootAttachment::Fixed).expect_err(&text).to_string(), expected, "{text}");
    }
}

#[test]
fn coordinates_are_capped() {
    let chain = |n: usize| {
        let links: String = (0..=n).map(|i| format!("<link name='l{i}'/>")).collect();
        let joints: String = (0..n)
            .map(|i| {
                format!(
                    "<joint name='j{i:05}' type='continuous'><parent link='l{i}'/><child link='l{}'/></joint>",
                    i + 1
                )
            })
            .collect();
        format!("<robot name='r'>{links}{joints}</robot>")
    };
    let cap = Limits::default().coordinates;
    assert_eq!(read(chain(cap).as_bytes(), RootAttachment::Fixed).unwrap().coordinates.len(), cap);
    let error = read(chain(cap + 1).as_bytes(), RootAttachment::Fixed).unwrap_err().to_string();
    assert!(error.ends_with("the model has more than 512 coordinates"), "{error}");
    // A chain as long as the elements allow needs no deep stack.
    let long = chain(39_999).replace("continuous", "fixed");
    let work = move || read(long.as_bytes(), RootAttachment::Fixed).unwrap().segments.len();
    let small = std::thread::Builder::new().stack_size(256 << 10).spawn(work).unwrap();
    assert_eq!(small.join().unwrap(), 40_000);
}

#[test]
fn mutated_files_never_panic_and_give_finite_numbers() {
    let bases =
        ["arm", "humanoid"].map(|name| std::fs::read(here().join(format!("tests/models/{name}.urdf"))).unwrap());
    let parts = [
        "<joint name='x' type='fixed'>",
        "</joint>",
        "<link name='",
        "<mimic joint='",
        "1e308",
        "nan",
        "-",
        "0",
        "<inertial>",
        "<mass value='",
        "<origin rpy='1e308 0 0'/>",
        "'",
        "\"",
        "/>",
    ];
    hammer("URDF", 48, 100_000, &bases.each_ref().map(Vec::as_slice), &parts, |text| {
        let Ok(body) = read(text, RootAttachment::Free) else { return false };
        assert!(body.segments.iter().all(|s| s.mass.is_finite() && s.inertia.iter().all(|x| x.is_finite())));
        true
    });
}
