//! The fatigue law that a scenario names reaches every muscle group, of the built-in adult and of a model file, and no group whose
//! law an overlay names.

use contrapposto::model::{Model, Sex};
use contrapposto_formats::tissue::{FatigueChoice, SourcedModel, fatigue_notes};
use contrapposto_formats::{read_relax, scenario_model};

/// A model that is no export of the adult: its pelvis has another mass.
fn other_model() -> String {
    let own = include_str!("../../../scenarios/models/adult-female.osim");
    let other = own.replace("<mass>7.482</mass>", "<mass>7.483</mass>");
    assert_ne!(own, other);
    other
}

const ADULT: &str = "adult = { sex = \"female\", stature_m = 1.65, mass_kg = 60 }";

/// The model that `relax` gets from a scenario with this body and these lines of `[fatigue]`.
fn model(body: &str, fatigue: &str, overlay: Option<&str>) -> Model {
    let text = format!(
        "format = 1\n[model]\n{body}\n[fatigue]\n{fatigue}\n[[support]]\nsegment = \"calcn_r\"\n\
        corners_m = [[0.1, -0.05, 0.04], [0.1, -0.05, -0.04], [-0.1, -0.05, 0]]\n[[task]]\nkind = \"effort\"\n"
    );
    let file = scenario_model("scenario.toml", text.as_bytes()).unwrap().map(|file| {
        let no_includes = &mut |_: &str| Err("none".to_owned());
        let mut model = SourcedModel::read("adult.osim", other_model().as_bytes(), None, no_includes).unwrap();
        assert_eq!(model.sex, None);
        if let Some(overlay) = overlay {
            model = model.lay_over("overlay.toml", overlay.as_bytes()).unwrap();
        }
        model.fill(&file.person).unwrap().with_fatigue(&file.fatigue).model
    });
    read_relax("scenario.toml", text.as_bytes(), file).unwrap().model
}

/// Names of the laws of the positive and the negative group.
fn laws(model: &Model, coordinate: &str) -> [String; 2] {
    let groups = model.coordinates()[model.coordinate(coordinate).unwrap()].groups.as_ref().unwrap();
    [0, 1].map(|side| groups[side].fatigue.name().to_owned())
}

#[test]
fn joints_by_default_and_muscle_groups_by_name() {
    for body in [ADULT, "file = \"adult.osim\""] {
        for fatigue in ["", "parameters = \"joint\""] {
            let model = model(body, fatigue, None);
            assert_eq!(laws(&model, "hip_flexion_r"), ["general"; 2]);
            assert_eq!(laws(&model, "knee_angle_l"), ["knee"; 2]);
            assert_eq!(laws(&model, "lumbar_extension"), ["trunk"; 2]);
            assert_eq!(fatigue_notes(&model), [""; 0]);
        }
    }
    let sexes = [
        (ADULT, "", "female"),
        (ADULT, "sex = \"male\"", "male"),
        (ADULT, "sex = \"any\"", "any sex"),
        ("file = \"adult.osim\"", "", "any sex"),
        ("file = \"adult.osim\"", "sex = \"female\"", "female"),
    ];
    for (body, sex, word) in sexes {
        let model = model(body, &format!("parameters = \"muscle_group\"\n{sex}"), None);
        assert_eq!(laws(&model, "knee_angle_r"), ["knee".to_owned(), format!("knee_extensor, {word}")]);
        assert_eq!(
            laws(&model, "ankle_angle_l"),
            [format!("ankle_dorsiflexor, {word}"), format!("ankle_plantarflexor, {word}")]
        );
        assert_eq!(laws(&model, "wrist_dev_r"), ["hand, any sex"; 2]);
        assert_eq!(laws(&model, "hip_flexion_r"), ["general"; 2]);
        let notes = fatigue_notes(&model).join("\n");
        assert!(notes.contains(&format!("knee extension: `knee_extensor, {word}`")), "{notes}");
        assert!(notes.contains("r 15; assumed") && notes.contains("the joint fit `trunk`"), "{notes}");
    }
}

#[test]
fn endurance_curves_reach_model_files_too() {
    for body in [ADULT, "file = \"adult.osim\""] {
        let own = model(body, "law = \"endurance\"", None);
        assert_eq!(laws(&own, "hip_adduction_l"), ["freylaw_avin_2010_general"; 2]);
        assert_eq!(laws(&own, "ankle_angle_r"), ["freylaw_avin_2010_ankle"; 2]);
        let one = model(body, "law = \"endurance\"\ncurve = \"rohmert_general\"", None);
        assert_eq!(laws(&one, "ankle_angle_r"), ["rohmert_general"; 2]);
    }
}

/// The overlay names a class for the knee, and a strength alone for the ankle, which keeps its own law.
#[test]
fn a_class_of_an_overlay_stays() {
    let overlay = "[coordinates.knee_angle_r]\nstrength = { positive_nm = 90, negative_nm = 150 }\nfatigue = \"elbow\"\n\
        [coordinates.ankle_angle_r]\nstrength = { positive_nm = 40, negative_nm = 120 }\n";
    let body = "file = \"adult.osim\"\noverlay = \"overlay.toml\"";
    let by_group = model(body, "parameters = \"muscle_group\"", Some(overlay));
    assert_eq!(laws(&by_group, "knee_angle_r"), ["elbow"; 2]);
    assert_eq!(laws(&by_group, "ankle_angle_r"), ["general"; 2], "without a class: general, as the overlay says");
    assert_eq!(laws(&by_group, "knee_angle_l")[1], "knee_extensor, any sex");
    let curves = model(body, "law = \"endurance\"", Some(overlay));
    assert_eq!(laws(&curves, "knee_angle_r"), ["freylaw_avin_2010_elbow"; 2]);
}

/// An overlay that changes the strength of groups which are there leaves their fatigue law what it was: that of the built-in data.
#[test]
fn strength_alone_leaves_the_law() {
    let adult = contrapposto_formats::adult_size("adult:male,1.8m,80kg").unwrap().unwrap();
    assert_eq!(adult.sex, Sex::Male);
    let overlay = "[coordinates.knee_angle_r]\nstrength = { positive_nm = 90, negative_nm = 150 }\n";
    let model = SourcedModel::adult(&adult).unwrap().lay_over("overlay.toml", overlay.as_bytes()).unwrap();
    let model = model.with_fatigue(&FatigueChoice::default()).model;
    assert_eq!(laws(&model, "knee_angle_r"), ["knee"; 2]);
}
