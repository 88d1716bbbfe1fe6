//! Ten minutes of quiet standing: adults of five sizes and published models at their natural posture, no muscle group tired.
//!
//! The natural posture is that of least effort with the chest upright: both soles on the ground, the pelvis level and straight
//! ahead, the centre of mass midway between the feet, the head level where there is one, the arms hanging. The table of all bodies is in `docs/strength.md`.

use contrapposto::equilibria::{Work, equilibria};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::data::library;
use contrapposto::model::{Model, Side};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Options;
use contrapposto_formats::read_relax;
use contrapposto_formats::tissue::{Person, SourcedModel};

use crate::common::shared;

/// Corners of the sole in the axes of `calcn` of OpenSim's models, m: heel and ball of the foot.
const SOLE: &str = "[[0, -0.0282, -0.03], [0, -0.0282, 0.03], [0.179, -0.0282, 0.0495], [0.179, -0.0282, -0.0495]]";

/// Duration of standing, s.
const TEN_MINUTES: f64 = 600.0;

/// Fatigue at which a person shifts, as in the scenarios.
const CRITICAL: f64 = 0.6;

/// Greatest lean of a chest that counts as upright, rad: 20 deg.
const UPRIGHT: f64 = 0.35;

/// The muscle group that is most tired after standing at the natural posture.
struct Tired {
    group: String,
    fatigue: f64,
    work: Work,
    angle: f64,
    passive: f64,
    status: String,
}

/// The scenario of a body with these coordinates and segments.
fn scenario(model: &str, known: &Model, sole: Option<&str>) -> String {
    let mut text = format!("format = 1\n[model]\n{model}\n[posture]\n");
    for (coordinate, degrees) in [("elbow_flex", 20), ("arm_add", -8)] {
        for side in ["r", "l"] {
            if known.coordinate(&format!("{coordinate}_{side}")).is_some() {
                text += &format!("{coordinate}_{side}_deg = {degrees}\n");
            }
        }
    }
    text += "[coordinates]\nlocked = [\"pelvis_rotation\", \"pelvis_list\", \"pelvis_tz\"]\n";
    let corners = sole.map_or(String::new(), |corners| format!("corners_m = {corners}\n"));
    for side in ["r", "l"] {
        text += &format!("[[support]]\nsegment = \"calcn_{side}\"\n{corners}");
    }
    if known.segment("head").is_some() {
        text += "[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget = \"start\"\n";
    }
    text += "[[task]]\nkind = \"center_of_mass\"\naxes = \"z\"\ntarget_m = [0, 0, 0]\n";
    text + "[[task]]\nkind = \"effort\"\n"
}

/// The group that is most tired after ten minutes at the natural posture; its angle, load and sources.
fn most_tired(text: &str, model: Option<Model>) -> Tired {
    let read = read_relax("standing.toml", text.as_bytes(), model);
    let scenario = read.unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)));
    let search = scenario.search();
    let options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };
    let found = equilibria(&search, options).unwrap();
    let natural =
        found.postures.iter().find(|posture| lean(&scenario.model, &posture.relaxed.posture) < UPRIGHT).unwrap();
    let tired = natural.work.iter().map(|&work| {
        let coordinate = &scenario.model.coordinates()[work.coordinate];
        let side = usize::from(work.side == Side::Negative);
        let group = &coordinate.groups.as_ref().unwrap()[side];
        let load = work.relative_load();
        let state = group.fatigue.advance(group.fatigue.start(0.0, load), load, TEN_MINUTES);
        let angle = natural.relaxed.posture.values()[work.coordinate];
        let sources = library().sources(&coordinate.name).and_then(|sources| sources.strength);
        let status = sources.map_or(String::new(), |both| both[side].status_at(&group.strength, angle).to_string());
        let passive = natural.torques[1][coordinate.rate.unwrap()];
        let name = format!("{} of {}", group.name, coordinate.name);
        Tired { group: name, fatigue: state.level(load), work, angle, passive, status }
    });
    tired.max_by(|a, b| a.fatigue.total_cmp(&b.fatigue)).unwrap()
}

/// Angle between the chest's long axis and the vertical, rad.
fn lean(model: &Model, posture: &Posture) -> f64 {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    let up = kinematics.placement(model, model.segment("torso").unwrap()).rotation * nalgebra::Vector3::y();
    libm::acos(up.y)
}

/// One row of the table in `docs/strength.md`.
fn print(body: &str, tired: &Tired) {
    println!(
        "\n| {body} | {} | {:.0} | {:.1} | {:.1} % | {:.0} | {} | {:.1} | {:.2} |",
        tired.group,
        tired.angle.to_degrees(),
        tired.work.active,
        100.0 * tired.work.relative_load(),
        tired.work.strength,
        tired.status,
        tired.passive,
        tired.fatigue
    );
}

#[test]
fn adults_of_five_sizes_stand_for_ten_minutes() {
    let sizes =
        [("female", 1.52, 48), ("female", 1.65, 60), ("female", 1.78, 80), ("male", 1.63, 58), ("male", 1.88, 95)];
    let mut tired = vec![];
    for (sex, stature, mass) in sizes {
        let model = format!("adult = {{ sex = \"{sex}\", stature_m = {stature}, mass_kg = {mass} }}");
        let known = contrapposto::model::adult(&contrapposto::model::Adult::default()).unwrap();
        let most = most_tired(&scenario(&model, &known, None), None);
        print(&format!("{sex}, {stature} m, {mass} kg"), &most);
        tired.push(most.fatigue);
    }
    assert!(tired.iter().all(|&fatigue| fatigue < CRITICAL), "{tired:?}");
}

/// The most tired group of a published model.
fn most_tired_of(bytes: &[u8]) -> Tired {
    let file = SourcedModel::read("body.osim", bytes, None, &mut |_: &str| Err("none".to_owned())).unwrap();
    let body = file.fill(&Person::default()).unwrap();
    let text = scenario("file = \"body.osim\"", &body.model, Some(SOLE));
    most_tired(&text, Some(body.model))
}

#[test]
#[ignore = "needs ../shared: published models"]
fn a_published_body_stands_for_ten_minutes() {
    let tired = most_tired_of(&std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap());
    print("gait2392", &tired);
    assert!(tired.fatigue < CRITICAL, "{}", tired.fatigue);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn published_full_bodies_stand_for_ten_minutes() {
    let folder = std::env::var("CONTRAPPOSTO_OPENSIM_MODELS").unwrap();
    for name in ["Rajagopal2016", "RajagopalLaiUhlrich2023", "FullBodyModel_Hamner2010_v2_0"] {
        let bytes = std::fs::read(std::path::Path::new(&folder).join(format!("{name}.osim"))).unwrap();
        let tired = most_tired_of(&bytes);
        print(name, &tired);
        assert!(tired.fatigue < CRITICAL, "{name}: {}", tired.fatigue);
    }
}
