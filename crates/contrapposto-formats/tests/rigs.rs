//! Animations of rigs: the reader of BVH, names, units and axes, and motions that come back as the adult's angles.

mod rig_text;

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Sex, adult};
use contrapposto::posture::Posture;
use contrapposto::tasks::Height;
use contrapposto::tracking::track;
use contrapposto_formats::animation::{Clip, bvh};
use contrapposto_formats::rigs::{
    Assignment, Channel, Fitted, MissingJoints, RigError, RigUnit, Sizing, Targets, names_template, read_bvh,
    read_rig_names, settle_branches,
};
use nalgebra::{UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;
use rig_text::{CMU, MIXAMO, RigText};

/// Tracks an animation; answers the adult and its postures.
fn tracked(text: &str, sizing: &Sizing) -> (Fitted, Vec<Posture>) {
    let rig = read_bvh("a.bvh", text.as_bytes()).unwrap();
    let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
    let fitted = Fitted::new(&rig, &assignment, sizing, None).unwrap();
    let frames: Vec<usize> = (0..rig.frames.len()).collect();
    let targets = Targets::new(&rig, &assignment, &fitted, &frames);
    let places: Vec<_> = frames.iter().map(|&frame| targets.places(frame)).collect();
    let start = fitted.model.default_posture();
    let answer = track(&fitted.model, targets.goals.clone(), &start, places.iter().map(Vec::as_slice)).unwrap();
    let mut postures: Vec<Posture> = answer.into_iter().map(|frame| frame.posture).collect();
    let before: Vec<Vec<_>> = postures.iter().map(|posture| turns(&fitted.model, posture)).collect();
    settle_branches(&fitted.model, &mut postures);
    for (posture, before) in postures.iter().zip(before) {
        let after = turns(&fitted.model, posture);
        assert!(after.iter().zip(&before).all(|(a, b)| a.angle_to(b) < 1e-9), "the posture stays what it is");
    }
    (fitted, postures)
}

/// Rotations of all segments.
fn turns(model: &Model, posture: &Posture) -> Vec<UnitQuaternion<f64>> {
    let mut body = Kinematics::new(model);
    body.update(model, posture).unwrap();
    (0..model.segments().len()).map(|s| body.placement(model, s).rotation).collect()
}

fn angle(model: &Model, posture: &Posture, name: &str) -> f64 {
    posture.values()[model.coordinate(name).unwrap()].to_degrees()
}

/// A motion through random postures within the ranges, a third of them at most, with the arms away from the sides.
fn motion(model: &Model, seed: u128) -> Vec<Posture> {
    let mut rng = Pcg64::new(seed, 0);
    let n = model.coordinates().len();
    let mut at = || -> Vec<f64> { (0..n).map(|_| rng.random_range(0.0..1.0)).collect() };
    let ends = [at(), at(), at()];
    let value = |c: usize, share: f64| {
        let coordinate = &model.coordinates()[c];
        let (low, high) = coordinate.range;
        let most = if coordinate.name.starts_with("pelvis") { 0.5 } else { 2.0 };
        coordinate.default
            + ((low - coordinate.default).max(-most) * (1.0 - share) + (high - coordinate.default).min(most) * share)
                / 3.0
    };
    let frame = |k: usize| {
        let (part, rest) = (k / 10, (k % 10) as f64 / 10.0);
        let share = |c: usize| ends[part][c] * (1.0 - rest) + ends[(part + 1).min(2)][c] * rest;
        let mut posture = Posture::new((0..n).map(|c| value(c, share(c))).collect());
        Height::raise_shoulders(model, [&mut posture]);
        posture
    };
    (0..21).map(frame).collect()
}

#[test]
fn a_motion_of_the_adult_comes_back_from_its_own_bvh() {
    for (seed, sex, stature) in [(1, Sex::Male, 1.741), (2, Sex::Female, 1.58), (3, Sex::Male, 1.95)] {
        println!("seed {seed}");
        let size = Adult { sex, stature, mass: 70.0, ..Adult::default() };
        let model = adult(&size).unwrap();
        let motion = motion(&model, seed);
        let times: Vec<f64> = (0..motion.len()).map(|k| k as f64 * 0.05).collect();
        let postures: Vec<&[f64]> = motion.iter().map(Posture::values).collect();
        let directions = [-Vector3::z(), Vector3::y(), Vector3::x()];
        let clip = Clip {
            model: &model,
            title: "t",
            directions,
            times: &times,
            postures: &postures,
            steps: false,
            things: &[],
            arrows: &[],
        };
        let text = bvh(&clip).unwrap();
        for sizing in [Sizing::Given(size.clone()), Sizing::ToRig(Sex::Male)] {
            let (fitted, found) = tracked(&text, &sizing);
            assert!(!fitted.from_first_frame && fitted.feet_point_ahead);
            // Shoulders rise by the size that was found.
            let mut motion = motion.clone();
            Height::raise_shoulders(&fitted.model, &mut motion);
            for (found, wanted) in found.iter().zip(&motion) {
                for (c, coordinate) in model.coordinates().iter().enumerate() {
                    let off = (found.values()[c] - wanted.values()[c]).abs();
                    assert!(off < 1e-6, "{seed} {sizing:?}: {} is off by {off}", coordinate.name);
                }
            }
        }
        // The bones are found to the digits of the file.
        let (fitted, _) = tracked(&text, &Sizing::ToRig(sex));
        for name in ["tibia_r", "talus_l", "ulna_r", "hand_l"] {
            let length =
                |model: &Model| model.segments()[model.segment(name).unwrap()].in_parent.translation.vector.norm();
            assert!((length(&model) - length(&fitted.model)).abs() < 1e-7, "{name}");
        }
        assert_eq!(fitted.unit, RigUnit::Found("cm"));
        assert!((fitted.size.stature - stature).abs() < 1e-3);
    }
}

/// Turns (deg) of joints of a rig about the directions of a body, and the angles (deg) of the adult that they are by their definitions.
const TURNS: [(&str, [f64; 3], f64, &str, f64); 12] = [
    // Joint, axis (left, up, ahead), turn; coordinate and its value.
    ("LeftUpLeg", [-1.0, 0.0, 0.0], 40.0, "hip_flexion_l", 40.0),
    ("RightUpLeg", [0.0, 0.0, 1.0], -15.0, "hip_adduction_r", -15.0),
    ("LeftLeg", [1.0, 0.0, 0.0], 55.0, "knee_angle_l", 55.0),
    ("RightLeg", [1.0, 0.0, 0.0], 20.0, "knee_angle_r", 20.0),
    ("LeftFoot", [-1.0, 0.0, 0.0], 12.0, "ankle_angle_l", 12.0),
    // In T-pose the elbow bends about the vertical.
    ("LeftForeArm", [0.0, 1.0, 0.0], -70.0, "elbow_flex_l", 70.0),
    ("RightForeArm", [0.0, 1.0, 0.0], 35.0, "elbow_flex_r", 35.0),
    // From T-pose 60 deg down.
    ("LeftArm", [0.0, 0.0, 1.0], -60.0, "arm_add_l", -30.0),
    ("RightArm", [0.0, 0.0, 1.0], 50.0, "arm_add_r", -40.0),
    ("Head", [-1.0, 0.0, 0.0], 25.0, "neck_extension", 25.0),
    ("Hips", [1.0, 0.0, 0.0], 10.0, "pelvis_tilt", -10.0),
    ("Spine1", [0.0, 1.0, 0.0], 9.0, "", 9.0),
];

#[test]
fn turns_of_mixamo_and_cmu_rigs_are_the_angles_that_they_mean() {
    // Mixamo in cm with y up; CMU in its own unit with z up; the same in a unit that nobody knows.
    for (names, metres, up) in [(MIXAMO, 0.01, "y"), (CMU, 0.0254 / 0.45, "z"), (CMU, 7.7, "-y")] {
        let text =
            RigText { names, metres, up, splayed: names.legs_apart, bent: 0.0 }.text(&TURNS.map(|t| (t.0, t.1, t.2)));
        let (fitted, found) = tracked(&text, &Sizing::ToRig(Sex::Male));
        let model = &fitted.model;
        assert_eq!(fitted.axes.up_word(), up);
        let known = (metres == 7.7) ^ matches!(fitted.unit, RigUnit::Found(_));
        assert!(known, "{:?}", fitted.unit);
        for (_, _, _, coordinate, wanted) in TURNS.iter().filter(|turn| !turn.3.is_empty()) {
            // Legs that stand apart in the rest pose begin there; the knee then bends in another plane than the body's.
            let apart = names.legs_apart;
            let wanted = match *coordinate {
                "hip_adduction_r" => wanted - apart,
                _ => *wanted,
            };
            let tolerance = if apart > 0.0 && ["hip", "knee", "ankle"].iter().any(|j| coordinate.starts_with(j)) {
                9.0
            } else {
                0.6
            };
            let value = angle(model, &found[1], coordinate);
            assert!((value - wanted).abs() < tolerance, "{up} {coordinate}: {value} against {wanted}");
        }
        // The trunk turns where the rig's spine does.
        let turned = angle(model, &found[1], "lumbar_rotation") + angle(model, &found[1], "thoracic_rotation");
        let tolerance = if names.legs_apart > 0.0 { 0.6 } else { 1e-3 };
        assert!((turned - 9.0).abs() < tolerance, "{turned}");
        // The first frame is the rest pose: arms sideways.
        for (coordinate, wanted) in
            [("arm_add_l", -90.0), ("elbow_flex_r", 0.0), ("knee_angle_l", 0.0), ("neck_extension", 0.0)]
        {
            let value = angle(model, &found[0], coordinate);
            assert!((value - wanted).abs() < 0.5, "{coordinate}: {value} against {wanted}");
        }
        let stature = if metres == 7.7 { Adult::default().stature } else { 1.741 };
        assert!((fitted.size.stature - stature).abs() < 2e-3, "{}", fitted.size.stature);
        // The hips lie where the rig's are.
        let mut body = Kinematics::new(model);
        body.update(model, &found[0]).unwrap();
        let hips = body.station(model, 0, Vector3::zeros());
        assert!((hips - Vector3::new(0.0, 1.0 * stature / 1.741, 0.0)).norm() < 0.01, "{hips}");
    }
}

#[test]
fn elbows_that_are_bent_in_the_rest_pose_are_bent_in_the_body() {
    let rig = RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 25.0 };
    let (fitted, found) = tracked(&rig.text(&[("LeftForeArm", [0.0, 1.0, 0.0], -30.0)]), &Sizing::ToRig(Sex::Male));
    for (frame, coordinate, wanted) in [
        (0, "elbow_flex_l", 25.0),
        (0, "elbow_flex_r", 25.0),
        (0, "arm_add_l", -90.0),
        (0, "pro_sup_l", 0.0),
        (0, "wrist_flex_r", 0.0),
        (0, "wrist_dev_l", 0.0),
        (1, "elbow_flex_l", 55.0),
        (1, "pro_sup_l", 0.0),
    ] {
        let value = angle(&fitted.model, &found[frame], coordinate);
        assert!((value - wanted).abs() < 1e-3, "{frame} {coordinate}: {value} against {wanted}");
    }
}

#[test]
fn channels_stand_in_any_order_and_places_instead_of_offsets() {
    let text = "HIERARCHY\r\nROOT My Hips {\n OFFSET 1 2 3 CHANNELS 4 Yposition Xrotation Zrotation Yrotation\njoint a:b\n{\nOFFSET 0 2 0\n\
                CHANNELS 1 zROTATION\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\nMOTION\nFrames:2\nFrame Time: .5\n5 90 0 0 90\n\n5 0 90 90 0\n";
    let rig = read_bvh("a.bvh", text.as_bytes()).unwrap();
    assert_eq!((rig.joints[0].name.as_str(), rig.joints[1].name.as_str()), ("My Hips", "a:b"));
    assert!(rig.warnings.is_empty() && rig.frame_time == 0.5, "{:?}", rig.warnings);
    let end = |frame: Option<usize>| {
        let mut placed = vec![];
        rig.place(frame, &mut placed);
        placed[rig.ends[0].0].transform_point(&rig.ends[0].1.into()).coords
    };
    let near = |a: Vector3<f64>, x: f64, y: f64, z: f64| assert!((a - Vector3::new(x, y, z)).norm() < 1e-12, "{a}");
    near(end(None), 1.0, 5.0, 3.0);
    // Rx(90): the second joint lies at z + 2; its own Rz(90) turns y to -x.
    near(end(Some(0)), 0.0, 5.0, 5.0);
    // Rz(90) Ry(90): y to -x.
    near(end(Some(1)), -2.0, 5.0, 3.0);
}

#[test]
fn faults_are_refused_with_their_place() {
    let good = RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 0.0 }.text(&[]);
    for (from, to, said) in [
        ("HIERARCHY", "HIERARCHIE", "`HIERARCHIE` stands where `HIERARCHY` is due"),
        ("MOTION", "", "stands where `MOTION` is due"),
        ("Frame Time: 0.0333", "Frame Time: -1", "the time of a frame is -1.0 s"),
        ("Frame Time: 0.0333", "Frame Time: NaN", "`NaN` is no number"),
        ("Zrotation", "Wrotation", "`Wrotation` is no known channel"),
        ("CHANNELS 3", "CHANNELS 99", "`99` is no number of channels"),
        ("OFFSET 0 ", "OFFSET zero ", "`zero` is no number"),
        ("OFFSET 0 ", "OFSET 0 ", "`OFSET` is unknown here"),
        ("End Site", "Joint", "the joint's name cannot be read"),
    ] {
        let error = read_bvh("a.bvh", good.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert!(error.to_string().contains(said), "{from}: {error}");
    }
    let cut = read_bvh("a.bvh", &good.as_bytes()[..good.len() - 40]).unwrap_err();
    assert!(cut.to_string().contains("numbers, the channels need"), "{cut}");
    let warned = read_bvh("a.bvh", good.replace("Frames: 2", "Frames: 7").as_bytes()).unwrap();
    assert!(warned.warnings[0].contains("says 7 frames"), "{:?}", warned.warnings);
    // A rig that lies in its rest pose and in its frames stands nowhere.
    let rig = read_bvh("a.bvh", good.as_bytes()).unwrap();
    let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
    let mut lying = rig.clone();
    lying.joints.iter_mut().filter(|joint| joint.name.contains("Up")).for_each(|joint| joint.offset.y = 400.0);
    lying.frames.iter_mut().for_each(|frame| frame.fill(0.0));
    let refused = Fitted::new(&lying, &assignment, &Sizing::ToRig(Sex::Male), None).unwrap_err();
    assert_eq!(refused, RigError::Standing);
    let small = Fitted::new(&rig, &assignment, &Sizing::ToRig(Sex::Male), Some(1e-3)).unwrap_err();
    assert!(small.to_string().contains("--units says their unit"), "{small}");
}

#[test]
fn names_of_other_programs_are_known_and_missing_ones_are_listed() {
    let text = RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 0.0 }.text(&[]);
    let mixamo = read_bvh("a.bvh", text.as_bytes()).unwrap();
    let renamed = |names: &[(&str, &str)]| {
        let mut rig = mixamo.clone();
        for joint in &mut rig.joints {
            let own = joint.name.trim_start_matches("mixamorig:").to_owned();
            let new = names.iter().find(|(from, _)| *from == own).map_or(own.clone(), |(_, to)| (*to).to_owned());
            joint.name = new;
        }
        rig
    };
    let sided = |parts: [(&str, &str, &str); 7]| -> Vec<(String, String)> {
        parts
            .iter()
            .flat_map(|(own, l, r)| [(format!("Left{own}"), (*l).to_owned()), (format!("Right{own}"), (*r).to_owned())])
            .collect()
    };
    let unreal = sided([
        ("UpLeg", "thigh_l", "thigh_r"),
        ("Leg", "calf_l", "calf_r"),
        ("Foot", "foot_l", "foot_r"),
        ("Shoulder", "clavicle_l", "clavicle_r"),
        ("Arm", "upperarm_l", "upperarm_r"),
        ("ForeArm", "lowerarm_l", "lowerarm_r"),
        ("Hand", "hand_l", "hand_r"),
    ]);
    let daz = sided([
        ("UpLeg", "lThigh", "rThigh"),
        ("Leg", "lShin", "rShin"),
        ("Foot", "lFoot", "rFoot"),
        ("Shoulder", "lCollar", "rCollar"),
        ("Arm", "lShldr", "rShldr"),
        ("ForeArm", "lForeArm", "rForeArm"),
        ("Hand", "lHand", "rHand"),
    ]);
    let biovision = sided([
        ("UpLeg", "LeftHip", "RightHip"),
        ("Leg", "LeftKnee", "RightKnee"),
        ("Foot", "LeftAnkle", "RightAnkle"),
        ("Shoulder", "LeftCollar", "RightCollar"),
        ("Arm", "LeftShoulder", "RightShoulder"),
        ("ForeArm", "LeftElbow", "RightElbow"),
        ("Hand", "LeftWrist", "RightWrist"),
    ]);
    let blender = sided([
        ("UpLeg", "upperleg01.L", "upperleg01.R"),
        ("Leg", "lowerleg01.L", "lowerleg01.R"),
        ("Foot", "foot.L", "foot.R"),
        ("Shoulder", "clavicle.L", "clavicle.R"),
        ("Arm", "upperarm01.L", "upperarm01.R"),
        ("ForeArm", "lowerarm01.L", "lowerarm01.R"),
        ("Hand", "wrist.L", "wrist.R"),
    ]);
    let wanted = Assignment::find(&mixamo, &BTreeMap::new()).unwrap();
    for names in [unreal, daz, biovision, blender] {
        let names: Vec<(&str, &str)> = names.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
        assert_eq!(Assignment::find(&renamed(&names), &BTreeMap::new()).unwrap(), wanted, "{names:?}");
    }
    let rig = renamed(&[("LeftForeArm", "Tentacle"), ("RightFoot", "Hoof")]);
    let missing = Assignment::find(&rig, &BTreeMap::new()).unwrap_err();
    let MissingJoints::Unknown { segments, template } = &missing else { panic!("{missing}") };
    assert_eq!(segments, &["ulna_l", "calcn_r"]);
    assert!(template.contains("ulna_l = \"\"   # needed") && template.contains("hand_r = \"RightHand\""), "{template}");
    // The template, filled in, is read, and the rig is known.
    let filled =
        template.replace("ulna_l = \"\"", "ulna_l = \"Tentacle\"").replace("calcn_r = \"\"", "calcn_r = \"Hoof\"");
    let given = read_rig_names("n.toml", filled.as_bytes(), &rig).unwrap();
    let found = Assignment::find(&rig, &given).unwrap();
    assert_eq!(found, wanted);
    assert!(names_template(&rig, &found).contains("calcn_r = \"Hoof\""));
    let refused = read_rig_names("n.toml", b"ulna_l = \"Tentacel\"", &rig).unwrap_err();
    assert!(refused.to_string().contains("the rig has no joint `Tentacel`"), "{refused}");
    let refused = read_rig_names("n.toml", b"forearm_l = \"Tentacle\"", &rig).unwrap_err();
    assert!(refused.to_string().contains("`forearm_l` is no segment"), "{refused}");
    let wrong = BTreeMap::from([("ulna_l".to_owned(), "Hoof".to_owned()), ("calcn_r".to_owned(), "Hoof".to_owned())]);
    let elsewhere = Assignment::find(&rig, &wrong).unwrap_err();
    assert!(elsewhere.to_string().contains("the joint `Hoof` (ulna_l) does not hang on `LeftArm`"), "{elsewhere}");
}

#[test]
fn swapped_sides_a_first_frame_apart_and_bodies_that_turn_round_are_noticed() {
    let text =
        RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 0.0 }.text(&TURNS.map(|t| (t.0, t.1, t.2)));
    let swapped = text.replace("Left", "Lxft").replace("Right", "Left").replace("Lxft", "Right");
    let (fitted, _) = tracked(&swapped, &Sizing::ToRig(Sex::Male));
    assert!(!fitted.feet_point_ahead);
    let last = text.lines().last().unwrap();
    let more = text.replace("Frames: 2", "Frames: 4") + last + "\n" + last + "\n";
    let rig = read_bvh("a.bvh", more.as_bytes()).unwrap();
    let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
    let fitted = Fitted::new(&rig, &assignment, &Sizing::ToRig(Sex::Male), None).unwrap();
    let all = [0, 1, 2, 3];
    assert!(!Targets::new(&rig, &assignment, &fitted, &all[1..]).first_frame_jumps());
    let targets = Targets::new(&rig, &assignment, &fitted, &all);
    assert!(targets.first_frame_jumps() && !targets.is_moved() && targets.turned() == 0.0);
    // Turned by 170 deg about the vertical and 8 m away; the adult faces ahead at the origin.
    let mut away = rig.clone();
    let root = away.joints[0].channels.clone();
    for frame in &mut away.frames {
        frame[root.iter().position(|channel| *channel == Channel::Turn(1)).unwrap()] += 170_f64.to_radians();
        frame[0] += 800.0;
    }
    let targets = Targets::new(&away, &assignment, &fitted, &all);
    assert!(targets.is_moved() && (targets.turned().to_degrees().abs() - 170.0).abs() < 1.0, "{}", targets.turned());
    let hips = targets.places(0)[0].unwrap();
    assert!(libm::hypot(hips.x, hips.z) < 1e-9 && (hips.y - 1.0).abs() < 0.01, "{hips}");
    // The second point of the pelvis lies 0.1 m ahead of the first.
    let ahead = targets.places(0)[1].unwrap() - hips;
    assert!(ahead.x > 0.099, "{ahead}");
}

#[test]
fn mutated_files_give_finite_points_or_a_refusal() {
    const SEED: u64 = 7;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let plain =
        RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 0.0 }.text(&TURNS.map(|t| (t.0, t.1, t.2)));
    let (mut answered, mut refused) = (0, 0);
    for round in 0..2000 {
        let mut bytes = plain.clone().into_bytes();
        for _ in 0..rng.random_range(1..4) {
            // Half of the faults stand among the frames.
            let from = if rng.random_bool(0.5) { plain.find("MOTION").unwrap_or(0).min(bytes.len() - 1) } else { 0 };
            let at = rng.random_range(from..bytes.len());
            match rng.random_range(0..5) {
                0 | 4 => bytes[at] = b" 1-e9N.05"[rng.random_range(0..9)],
                1 => drop(bytes.drain(at..(at + 30).min(bytes.len()))),
                2 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, b" \n-e9N.{}"[rng.random_range(0..9)]),
            }
        }
        let points = read_bvh("m.bvh", &bytes).ok().and_then(|rig| {
            let assignment = Assignment::find(&rig, &BTreeMap::new()).ok()?;
            let fitted = Fitted::new(&rig, &assignment, &Sizing::ToRig(Sex::Female), None).ok()?;
            let frames: Vec<usize> = (0..rig.frames.len()).collect();
            let targets = Targets::new(&rig, &assignment, &fitted, &frames);
            Some(frames.iter().flat_map(|&frame| targets.places(frame)).flatten().collect::<Vec<_>>())
        });
        match points {
            Some(points) => {
                answered += 1;
                assert!(points.iter().all(|p| p.iter().all(|x| x.is_finite())), "round {round}");
            }
            None => refused += 1,
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered > 100 && refused > 100, "{answered}, {refused}");
}

/// The direction of the toes of a rig that stands is that of the adult's feet, up to 60 degrees outwards.
#[test]
fn feet_that_point_outwards_in_the_rest_pose_point_there_in_the_body() {
    let plain = RigText { names: MIXAMO, metres: 0.01, up: "y", splayed: 0.0, bent: 0.0 }.text(&[]);
    for (turned, expected) in [(0.0, 0.0), (20.0, 20.0), (-10.0, -10.0), (75.0, 0.0)] {
        // Left, up, ahead in cm; the ends of the toes turn with them.
        let (sin, cos) = libm::sincos(f64::to_radians(turned));
        let mut text = plain.clone();
        for (word, side) in [("Left", 1.0), ("Right", -1.0)] {
            let head = text.find(&format!("{word}ToeBase\n")).unwrap();
            let (before, after) = text.split_at(head);
            let line = |ahead: f64, up: &str| format!("OFFSET {} {up} {}", side * ahead * sin, ahead * cos);
            let after =
                after.replacen("OFFSET 0 -5 13", &line(13.0, "-5"), 1).replacen("OFFSET 0 0 6", &line(6.0, "0"), 1);
            assert!(turned == 0.0 || after.contains(&line(13.0, "-5")) && after.contains(&line(6.0, "0")), "{after}");
            text = format!("{before}{after}");
        }
        let rig = read_bvh("a.bvh", text.as_bytes()).unwrap();
        let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
        let fitted = Fitted::new(&rig, &assignment, &Sizing::ToRig(Sex::Male), None).unwrap();
        let targets = Targets::new(&rig, &assignment, &fitted, &[0]);
        let places = targets.places(0);
        for (name, side) in [("calcn_r", 1.0), ("calcn_l", -1.0)] {
            let foot = fitted.model.segment(name).unwrap();
            let of = targets.goals.markers.iter().zip(&places).filter(|(marker, _)| marker.segment == foot);
            let [(middle, at), (ahead, there)] = [0.0, 0.1].map(|x| {
                let found = of.clone().find(|(marker, _)| (marker.point - Vector3::x() * x).norm() < 1e-12);
                found.map(|(marker, place)| (marker.point, place.unwrap())).unwrap()
            });
            let way = (there - at) / (ahead - middle).norm();
            let outwards = libm::atan2(side * way.z, way.x).to_degrees();
            assert!((outwards - expected).abs() < 0.01 && way.y.abs() < 1e-6, "{name}: {outwards} for {turned}");
        }
    }
}
