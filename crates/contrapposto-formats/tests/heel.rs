//! Feet whose heel is free to rise: the weight is on the ball of the foot, the toes lie flat, and the heel is where the joint of the toes has it.
//!
//! Balance is computed anew from weights and contact forces; heights of the heel by plane geometry.

use std::path::Path;

use contrapposto::contact::{Balance, ContactForces};
use contrapposto::equilibria::equilibria;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Options;
use contrapposto::simulation::run;
use contrapposto_formats::{RelaxScenario, read_pose, read_relax, read_scenario};
use nalgebra::Vector3;

/// The options of the program's `relax`.
const OPTIONS: Options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };

/// `stand-relaxed` with other lines for the resting foot.
fn text(foot: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/stand-relaxed.toml");
    let text = std::fs::read_to_string(file).unwrap();
    let own = "segment = \"calcn_l\"\nplace = \"free\"\n";
    assert!(text.contains(own));
    text.replace(own, foot)
}

fn relax(foot: &str) -> RelaxScenario {
    read_relax("heel.toml", text(foot).as_bytes(), None).unwrap()
}

/// Corners of the sole of the left foot, in the frame of `calcn_l`, m, from the data of a body 1.65 m tall.
const STATURE: f64 = 1.65;
const HEEL_X: f64 = -0.0271 * STATURE;
const BALL_X: f64 = 0.0722 * STATURE;
const SOLE_Y: f64 = -0.0157 * STATURE;
const HALF_BREADTH: f64 = 0.0275 * STATURE;

/// Weight, place and heights of the left foot in a posture.
struct Foot {
    /// Weight on it, N.
    weight: f64,
    /// The place where its force meets the floor, from the balance of all other forces, in the frame of the toes, m.
    center: Vector3<f64>,
    /// Heights of the two corners of the heel, and of two places at the tips of the toes, m.
    heel: [f64; 2],
    tips: [f64; 2],
    /// Extension of the toes, rad.
    toes: f64,
}

fn foot(scenario: &RelaxScenario, posture: &Posture) -> Foot {
    let model = &scenario.model;
    let [calcn, toes] = ["calcn_l", "toes_l"].map(|name| model.segment(name).unwrap());
    let mut body = JointTorques::new(model);
    let mut contact = ContactForces::new(model, scenario.supports.clone()).unwrap();
    body.update_with_contact(model, posture, &scenario.loads, &mut contact, Quantities::TORQUES).unwrap();
    assert_eq!(contact.balance(), Balance::Held);
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    // Weight at the centre of mass and the force of the right foot leave the force of the left one.
    let weight = Vector3::new(0.0, -contact.weight(), 0.0);
    let mass = kinematics.center_of_mass(model).unwrap();
    let right = contact.force(0);
    let at_right = contact.center_of_pressure(model, &kinematics, 0).unwrap();
    let force = -weight - right;
    let moment = -mass.cross(&weight) - at_right.cross(&right);
    // On the floor: `moment = at x force` about the two level axes, without the couple about the vertical.
    let center = Vector3::new(moment.z / force.y, 0.0, -moment.x / force.y);
    let place = kinematics.placement(model, toes);
    let height = |segment, x, y, z| kinematics.station(model, segment, Vector3::new(x, y, z)).y;
    Foot {
        weight: force.y,
        center: place.inverse_transform_point(&center.into()).coords,
        heel: [-0.6, 0.6].map(|share| height(calcn, HEEL_X, SOLE_Y, share * HALF_BREADTH)),
        tips: [-1.0, 1.0].map(|share| height(toes, 0.05 * STATURE, 0.0, share * HALF_BREADTH)),
        toes: posture.values()[model.coordinate("mtp_angle_l").unwrap()],
    }
}

/// In every answer of `relax`: the force is inside the ball of the foot, the toes are on the floor, and the heel is as high as the turn of the
/// sole about its front edge has it.
#[test]
fn a_free_heel_rises_about_the_toes_and_the_ball_has_the_weight() {
    let scenario = relax("segment = \"calcn_l\"\nplace = \"free\"\nheel = \"free\"\n");
    let found = equilibria(&scenario.search(), OPTIONS).unwrap();
    let mut highest = 0.0f64;
    for posture in &found.postures {
        let foot = foot(&scenario, &posture.relaxed.posture);
        let (x, z) = (foot.center.x, foot.center.z);
        println!(
            "effort {:.5}: {:.1} N at {x:.4} {z:.4} m of the toes, heel {:.4} m, toes {:.2} deg",
            posture.relaxed.effort,
            foot.weight,
            foot.heel[0],
            foot.toes.to_degrees()
        );
        let long = 0.25 * (BALL_X - HEEL_X);
        assert!(foot.weight > 1.0 && foot.weight <= 0.15 * 60.0 * 9.81 + 0.1, "{}", foot.weight);
        assert!((-1e-4..=long + 1e-4).contains(&x) && z.abs() <= HALF_BREADTH + 1e-4, "{x} {z}");
        assert!(foot.tips.iter().all(|tip| tip.abs() < 1e-5), "{:?}", foot.tips);
        let height = (BALL_X - HEEL_X) * libm::sin(foot.toes);
        assert!(foot.heel.iter().all(|heel| (heel - height).abs() < 1e-5), "{:?} {height}", foot.heel);
        assert!(height >= -1e-9, "{height}");
        highest = highest.max(height);
    }
    // The slouch, which bends the knee of the resting leg, lifts its heel.
    assert!(highest > 0.01, "{highest}");
}

/// A heel that may rise asks no more effort than one that stays down, with the same ball under the weight and the same region.
#[test]
fn a_heel_that_may_rise_needs_no_more_effort_than_one_that_stays_down() {
    let region = "place = { corners_m = [[-0.2, 0, -0.12], [0.5, 0, -0.12], [0.5, 0, -0.45], [-0.2, 0, -0.45]], turn_deg = [-40, 10] }\n";
    let long = 0.25 * (BALL_X - HEEL_X);
    let corner = |x: f64, z: f64| format!("[{x}, {SOLE_Y}, {z}]");
    let ball = [(0.0, -1.0), (0.0, 1.0), (long, 1.0), (long, -1.0)];
    let ball = ball.map(|(x, side)| corner(BALL_X + x, side * HALF_BREADTH)).join(", ");
    let free = relax(&format!("segment = \"calcn_l\"\nheel = \"free\"\n{region}"));
    let down = relax(&format!("segment = \"calcn_l\"\ncorners_m = [{ball}]\n{region}"));
    let [free, down] = [free, down].map(|scenario| {
        let found = equilibria(&scenario.search(), OPTIONS).unwrap();
        found.postures[0].relaxed.effort
    });
    println!("least effort: heel free {free:.6}, heel down {down:.6}");
    assert!(free <= down * 1.0001, "{free} {down}");
}

#[test]
fn a_run_on_a_free_heel_keeps_its_balance_and_its_toes_on_the_floor() {
    let text = text("segment = \"calcn_l\"\nplace = \"free\"\nheel = \"free\"\n")
        .replace("duration_s = 120", "duration_s = 20");
    let scenario = read_scenario("heel.toml", text.as_bytes(), None).unwrap();
    let model = &scenario.model;
    let toes = model.segment("toes_l").unwrap();
    assert_eq!(scenario.supports[1].segment, toes);
    let joint = model.coordinate("mtp_angle_l").unwrap();
    assert_eq!(model.coordinates()[joint].range.0, 0.0);
    let mut kinematics = Kinematics::new(model);
    let (mut samples, mut highest) = (0, 0.0f64);
    run(&scenario, |sample| {
        let posture = Posture::new(sample.posture.to_vec());
        kinematics.update(model, &posture).unwrap();
        samples += 1;
        highest = highest.max(posture.values()[joint]);
        let tip = kinematics.station(model, toes, Vector3::new(0.05 * STATURE, 0.0, 0.0));
        assert!(tip.y > -1e-3, "{tip}");
    })
    .unwrap();
    println!("{samples} samples, toes extended by {:.2} deg at most", highest.to_degrees());
    assert!(samples > 500);
}

#[test]
fn a_heel_without_a_foot_is_refused() {
    for (foot, words) in [
        ("segment = \"pelvis\"\nheel = \"free\"\n", "`pelvis` has no heel that rises"),
        ("segment = \"toes_l\"\nheel = \"free\"\n", "`toes_l` has no heel that rises"),
        ("segment = \"calcn_l\"\nheel = \"free\"\ncorners_m = [[0, 0, 0]]\n", "does not go with `corners_m`"),
        ("segment = \"calcn_l\"\nheel = \"up\"\n", "up"),
    ] {
        let error = read_pose("heel.toml", text(foot).as_bytes(), None).err().unwrap();
        let message = format!("{error:?}");
        assert!(message.contains(words), "{foot}: {message}");
    }
}
