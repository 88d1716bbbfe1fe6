//! Built-in strength and passive torque of a model file are those of a person of its mass, or of the person that is given.

use contrapposto::model::{Adult, Model, Sex, adult};
use contrapposto_formats::person;
use contrapposto_formats::tissue::{Person, SourcedModel};

/// A body of 60 kg with the names of the adult, but another pelvis, so that it is no export of the adult; the file has no passive torque of the legs' flexion.
fn filled(person: &Person) -> SourcedModel {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let own = std::fs::read_to_string(path).unwrap();
    let other = own.replace("<mass>7.482</mass>", "<mass>7.483</mass>");
    assert_ne!(own, other);
    let file = SourcedModel::read("body.osim", other.as_bytes(), None, &mut |_: &str| Err("none".to_owned())).unwrap();
    file.fill(person).unwrap()
}

/// Strength of both groups of a knee bent by 40 deg, and its passive torque with all other joints at zero.
fn knee(model: &Model) -> [f64; 3] {
    let index = model.coordinate("knee_angle_r").unwrap();
    let coordinate = &model.coordinates()[index];
    let mut values = vec![0.0; model.default_posture().values().len()];
    values[index] = 40f64.to_radians();
    let [positive, negative] = coordinate.groups.as_ref().unwrap();
    let law = coordinate.passive.as_ref().unwrap();
    [positive.strength.torque(values[index]), negative.strength.torque(values[index]), law.torque(index, &values)]
}

fn close(a: [f64; 3], b: [f64; 3]) {
    let far = a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.abs()).fold(0.0, f64::max);
    assert!(far < 1e-9, "{a:?} and {b:?}");
}

#[test]
fn a_file_has_the_strength_and_the_passive_torque_of_its_own_mass() {
    let body = filled(&Person::default());
    assert!((body.model.mass() - 60.0).abs() < 0.01);
    let stature = 1.741 * libm::cbrt(body.model.mass() / 73.0);
    let man = adult(&Adult { stature, mass: body.model.mass(), ..Adult::default() }).unwrap();
    close(knee(&body.model), knee(&man));
    assert!(
        body.notes.iter().any(|note| note.contains("a man (assumed) of 60.0 kg (the model's)")),
        "{:?}",
        body.notes
    );
}

#[test]
fn the_person_that_is_given_counts() {
    let body = filled(&person("female,1.70m,75kg").unwrap());
    let size = Adult { sex: Sex::Female, stature: 1.70, mass: 75.0, ..Adult::default() };
    close(knee(&body.model), knee(&adult(&size).unwrap()));
    assert_eq!(body.sex, Some(Sex::Female));
    // Strength and passive torque in proportion to mass.
    let lighter = knee(&filled(&person("female,1.70m,50kg").unwrap()).model);
    close(lighter.map(|torque| torque * 1.5), knee(&body.model));
    let man = knee(&filled(&person("male,1.70m,75kg").unwrap()).model);
    assert!(man[0] > knee(&body.model)[0] && man[1] > knee(&body.model)[1], "{man:?}");
    let shorter = knee(&filled(&person("female,1.53m,75kg").unwrap()).model);
    assert!(
        (shorter[1] / knee(&body.model)[1] - 0.9).abs() < 1e-9,
        "the strength of Anderson et al. grows with stature"
    );
}

#[test]
fn nobody_of_an_impossible_size_is_taken() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let bytes = std::fs::read(path).unwrap();
    let file = SourcedModel::read("body.osim", &bytes, None, &mut |_: &str| Err("none".to_owned())).unwrap();
    let error = file.fill(&person("500kg").unwrap()).unwrap_err().to_string();
    assert!(error.starts_with("mass (kg) of the adult is 500"), "{error}");
    for (text, problem) in [("tall", "tall"), ("female,male", "repeats"), ("", "")] {
        let error = person(text).unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains("female,1.65m,60kg"), "{error}");
    }
}

#[test]
fn a_file_of_the_built_in_adult_is_that_adult_again() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/models/adult-female.osim");
    let bytes = std::fs::read(path).unwrap();
    let file = SourcedModel::read("body.osim", &bytes, None, &mut |_: &str| Err("none".to_owned())).unwrap();
    assert!(file.is_exported_adult() && !filled(&Person::default()).is_exported_adult());
    let body = file.fill(&Person::default()).unwrap();
    let own = adult(&Adult::of(&body.model).unwrap()).unwrap();
    assert_eq!((Adult::of(&own).unwrap().sex, body.sex), (Sex::Female, Some(Sex::Female)));
    close(knee(&body.model), knee(&own));
    for segment in own.segments() {
        let there = &body.model.segments()[body.model.segment(&segment.name).unwrap()];
        assert_eq!(there.patch.len(), segment.patch.len(), "{}", segment.name);
    }
    assert_eq!(body.model.three_axis_joints().len(), own.three_axis_joints().len());
    assert!(body.notes.iter().any(|note| note.contains("is the built-in adult, a woman")), "{:?}", body.notes);
}
