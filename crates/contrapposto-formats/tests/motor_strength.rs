//! Strength of motors: `effort` of URDF, limits of actuators and joints of MJCF, and models without them.

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::{Model, Side};
use contrapposto_formats::tissue::{FatigueChoice, Person, SourcedModel};
use contrapposto_formats::write;

fn read(name: &str, text: &str) -> SourcedModel {
    let no_includes = &mut |_: &str| Err("none".to_owned());
    SourcedModel::read(name, text.as_bytes(), None, no_includes).unwrap()
}

/// Greatest torque in the positive and negative sense, N m.
fn strength(model: &Model, name: &str) -> Option<[f64; 2]> {
    let coordinate = &model.coordinates()[model.coordinate(name).unwrap()];
    let groups = coordinate.groups.as_ref()?;
    assert!(groups.iter().all(|group| group.strength.torque(-3.0) == group.strength.torque(2.0)));
    assert!(groups.iter().all(|group| group.fatigue == FatigueLaw::Tireless));
    Some(Side::BOTH.map(|side| groups[side.index()].strength.torque(0.3)))
}

fn urdf(joints: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" \
             iyz=\"0\" izz=\"0.1\"/></inertial></link>"
        )
    };
    format!("<robot name=\"r\">{}{}{}{joints}</robot>", link("base"), link("a"), link("b"))
}

fn joint(name: &str, kind: &str, ends: (&str, &str), limit: &str) -> String {
    let (parent, child) = ends;
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 1 0\"/>\
         <limit lower=\"-1\" upper=\"1\" velocity=\"1\" {limit}/></joint>"
    )
}

#[test]
fn effort_of_a_urdf_hinge_is_its_strength_at_every_angle_and_is_counted() {
    let hip = joint("hip", "revolute", ("base", "a"), "effort=\"88\"");
    let knee = joint("knee", "revolute", ("a", "b"), "effort=\"139.5\"");
    let file = read("r.urdf", &urdf(&(hip + &knee)));
    assert_eq!(strength(&file.model, "hip"), Some([88.0, 88.0]));
    assert_eq!(strength(&file.model, "knee"), Some([139.5, 139.5]));
    assert!(
        file.notes.iter().any(|note| note.starts_with("strength of 2 joints from the file (`effort`)")),
        "{:?}",
        file.notes
    );
    assert!(file.model.three_axis_joints().is_empty());
    let without = file.without_strength();
    assert_eq!(strength(&without.model, "hip"), None);
    assert!(without.notes.is_empty(), "{:?}", without.notes);
}

#[test]
fn effort_zero_without_a_number_or_of_a_slide_is_no_strength_and_is_counted() {
    for (kind, effort, counted) in [
        ("revolute", "effort=\"0\"", "1 effort that is no torque above 0"),
        ("revolute", "effort=\"-5\"", "1 effort that is no torque above 0"),
        ("revolute", "effort=\"1e300\"", "1 effort that is no torque above 0"),
        ("prismatic", "effort=\"20\"", "1 effort of a slide"),
        ("revolute", "", ""),
    ] {
        let joints = joint("j", kind, ("base", "a"), effort) + &joint("k", "revolute", ("a", "b"), "effort=\"7\"");
        let file = read("r.urdf", &urdf(&joints));
        assert_eq!(strength(&file.model, "j"), None, "{effort}");
        assert_eq!(strength(&file.model, "k"), Some([7.0, 7.0]), "{effort}");
        assert!(file.notes.iter().any(|note| note.contains(counted)), "{effort}: {:?}", file.notes);
    }
}

#[test]
fn a_joint_that_mimics_another_has_no_strength_of_its_own() {
    let leader = joint("leader", "revolute", ("base", "a"), "effort=\"9\"");
    let mimic = joint("follower", "revolute", ("a", "b"), "effort=\"9\"");
    let mimic = mimic.replace("</joint>", "<mimic joint=\"leader\" multiplier=\"2\"/></joint>");
    let model = read("r.urdf", &urdf(&(leader + &mimic))).model;
    assert_eq!((strength(&model, "leader"), strength(&model, "follower")), (Some([9.0, 9.0]), None));
}

/// A chain of hinges `a`, `b`, ... with an attribute each, and actuators.
fn mjcf(hinges: &[&str], defaults: &str, actuators: &str) -> String {
    let bodies: String = hinges
        .iter()
        .zip('a'..)
        .map(|(extra, name)| {
            format!(
                "<body pos=\"0 0 1\"><joint name=\"{name}\" axis=\"0 1 0\" {extra}/><geom size=\"0.1\" mass=\"1\"/>"
            )
        })
        .collect();
    let ends = "</body>".repeat(hinges.len());
    format!(
        "<mujoco><default>{defaults}</default><worldbody>{bodies}{ends}</worldbody><actuator>{actuators}</actuator></mujoco>"
    )
}

#[test]
fn forces_of_mjcf_actuators_times_gear_are_the_strength_of_hinges() {
    for (hinge, defaults, actuator, expected) in [
        // Force range, by gear, also a negative one and one of a class.
        ("", "", "<position joint='a' forcerange='-10 20' gear='2'/>", Some([40.0, 20.0])),
        ("", "", "<position joint='a' forcerange='-10 20' gear='-2 0 0 0 0 0'/>", Some([20.0, 40.0])),
        ("", "<motor forcerange='-3 3'/>", "<general joint='a' gear='5'/>", Some([15.0, 15.0])),
        (
            "",
            "<default class='m'><position forcerange='-4 4'/></default>",
            "<position class='m' joint='a'/>",
            Some([4.0; 2]),
        ),
        // A motor's force is its control.
        ("", "", "<motor joint='a' ctrlrange='-0.4 0.4' gear='100'/>", Some([40.0, 40.0])),
        ("", "", "<motor joint='a' ctrlrange='-9 9' forcerange='-5 20'/>", Some([9.0, 5.0])),
        ("", "", "<general joint='a' ctrlrange='-1 1' gainprm='30'/>", Some([30.0, 30.0])),
        ("", "", "<position joint='a' ctrlrange='-1 1'/>", None),
        ("", "", "<motor joint='a' ctrlrange='-1 1' ctrllimited='false'/>", None),
        // The joint limits the sum of its actuators, and stands alone where the file has none.
        ("", "", "<motor joint='a' ctrlrange='-1 1'/><motor joint='a' ctrlrange='-2 2'/>", Some([3.0, 3.0])),
        ("actuatorfrcrange='-2 1'", "", "<motor joint='a' ctrlrange='-5 5'/>", Some([1.0, 2.0])),
        ("actuatorfrcrange='-2 1'", "", "<motor joint='a'/>", Some([1.0, 2.0])),
        ("actuatorfrcrange='-88 88'", "", "", Some([88.0, 88.0])),
        ("actuatorfrcrange='-88 88' actuatorfrclimited='false'", "", "", None),
        // One sense only, no gear, and kinds that do not hold a posture.
        ("", "", "<motor joint='a' ctrlrange='0 5'/>", None),
        ("", "", "<motor joint='a' ctrlrange='-5 5' gear='0'/>", None),
        ("", "", "<muscle joint='a' forcerange='-5 5'/>", None),
        ("", "", "<damper joint='a' forcerange='-5 5' kv='1' ctrlrange='0 1'/>", None),
        ("", "", "", None),
    ] {
        let file = read("r.xml", &mjcf(&[hinge], defaults, actuator));
        let found = strength(&file.model, "a");
        let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(found.zip(expected).map_or(found == expected, |(a, b)| close(a, b)), "{hinge} {actuator}: {found:?}");
    }
}

#[test]
fn strength_of_motors_survives_urdf_and_mjcf() {
    let file = read("r.xml", &mjcf(&["actuatorfrcrange='-2 1'", "actuatorfrcrange='-3 3'"], "", ""));
    let written = write::mjcf(&file.model).unwrap();
    let back = read("r.xml", &written.text).model;
    assert_eq!((strength(&back, "a"), strength(&back, "b")), (Some([1.0, 2.0]), Some([3.0, 3.0])));
    assert!(!written.lost.iter().any(|lost| lost.contains("Strength")), "{:?}", written.lost);
    let written = write::urdf(&file.model).unwrap();
    assert_eq!(strength(&read("r.urdf", &written.text).model, "b"), Some([3.0, 3.0]));
    let lost = "Strength and fatigue of the muscle groups of 1 coordinates are not written.";
    assert!(written.lost.iter().any(|message| message == lost), "{:?}", written.lost);
}

#[test]
fn motors_keep_their_law_when_a_scenario_chooses_a_fatigue_law() {
    let file = read("r.xml", &mjcf(&["actuatorfrcrange='-8 8'", ""], "", ""));
    let filled = file.fill(&Person::default()).unwrap();
    for choice in [FatigueChoice::default(), FatigueChoice::Endurance(None)] {
        assert_eq!(strength(&filled.clone().with_fatigue(&choice).model, "a"), Some([8.0, 8.0]));
    }
}
