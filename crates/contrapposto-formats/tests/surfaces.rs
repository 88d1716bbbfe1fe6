//! Patches lie on their surfaces at the start: feet on the floor or on a step, palms flat, soft parts in the shape of the seat; or
//! they are refused with distance and angle.

use crate::common;

use common::complaint;
use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto_formats::{RelaxScenario, read_pose, read_relax};

const FEET: &str = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
/// One thigh raised until its foot stands 0.1817 m above the other.
const RAISED: &str = "[posture]\nhip_flexion_r_deg = 55\nknee_angle_r_deg = 60\nankle_angle_r_deg = 5\n";
/// A palm forward of the body, on edge.
const PALM: &str = "[posture]\narm_flex_l_deg = 35\nelbow_flex_l_deg = 40\nwrist_flex_l_deg = -60\n";

fn read(rest: &str) -> RelaxScenario {
    let text = format!("format = 1\n{rest}");
    read_relax("a.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}\n{text}", complaint(&error)))
}

fn refused(rest: &str) -> String {
    let text =
        complaint(&read_relax("a.toml", format!("format = 1\n{rest}").as_bytes(), None).map(|_| ()).unwrap_err());
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Heights of the corners of every patch at the start, m.
fn heights(scenario: &RelaxScenario) -> Vec<Vec<f64>> {
    let mut kinematics = Kinematics::new(&scenario.model);
    kinematics.update(&scenario.model, &scenario.start).unwrap();
    let of = |support: &Support| {
        let height = |corner| kinematics.station(&scenario.model, support.segment, corner).y;
        support.corners.iter().map(|corner| height(*corner)).collect()
    };
    scenario.supports.iter().map(of).collect()
}

fn assert_at(heights: &[f64], expected: f64) {
    assert!(heights.iter().all(|height| (height - expected).abs() < 1e-6), "{heights:?}, expected {expected}");
}

fn note(scenario: &RelaxScenario, part: &str) -> bool {
    scenario.notes.iter().any(|note| note.contains(part))
}

#[test]
fn feet_above_or_below_the_floor_are_put_on_it() {
    for (height, way) in [(1.5, "moved down by 0.56"), (0.9, "moved up by 0.03")] {
        let scenario = read(&format!("[posture]\npelvis_ty_m = {height}\n{FEET}"));
        assert_at(&heights(&scenario).concat(), 0.0);
        assert!(note(&scenario, way), "{:?}", scenario.notes);
    }
    // The default posture stands on the floor as it is; `ground` is where the patch is.
    let scenario = read(&format!("upright = false\narms_hang = false\n{FEET}"));
    assert!(scenario.notes.is_empty(), "{:?}", scenario.notes);
    let ground = FEET.replace("\"\n", "\"\non = \"ground\"\n");
    let scenario = read(&format!("upright = false\narms_hang = false\n[posture]\npelvis_ty_m = 1.5\n{ground}"));
    assert!(scenario.notes.is_empty() && heights(&scenario)[0][0] > 0.5, "{:?}", scenario.notes);
}

#[test]
fn a_raised_foot_needs_a_step_and_stands_on_it() {
    let text = refused(&format!("{RAISED}{FEET}"));
    for part in [
        "the patch of `calcn_r` is 0.1817 m above its floor or step and tilted by 0 degrees",
        "0.05 m and 30 degrees at most",
        "add `step_m = 0.1817`",
        "line 7, columns 11 to 19",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let on_step = FEET.replacen("\"\n", "\"\nstep_m = 0.2\n", 1);
    let scenario = read(&format!("{RAISED}{on_step}"));
    let [right, left] = &heights(&scenario)[..] else { panic!() };
    assert_at(right, 0.2);
    assert_at(left, 0.0);
    assert!(note(&scenario, "the patch of `calcn_r` was laid on its surface"), "{:?}", scenario.notes);
}

#[test]
fn a_tilted_sole_is_laid_flat_and_a_steep_one_refused() {
    let tilted = |degrees: f64| format!("[posture]\nankle_angle_r_deg = {degrees}\n{FEET}");
    let scenario = read(&tilted(12.0));
    assert_at(&heights(&scenario).concat(), 0.0);
    assert!(note(&scenario, "tilted by 12 degrees"), "{:?}", scenario.notes);
    let text = refused(&tilted(-38.0));
    assert!(text.contains("tilted by 38 degrees") && text.contains("change [posture]"), "{text}");
}

#[test]
fn a_palm_on_edge_is_laid_flat_by_the_arm() {
    let scenario = read(&format!("{PALM}{FEET}[[support]]\nsegment = \"hand_l\"\n"));
    let palm = &heights(&scenario)[2];
    assert_at(palm, palm.iter().sum::<f64>() / 4.0);
    assert!(
        note(&scenario, "the patch of `hand_l` was laid on its surface: it was tilted by 7"),
        "{:?}",
        scenario.notes
    );
    let value = |name: &str| scenario.start.values()[scenario.model.coordinate(name).unwrap()].to_degrees();
    assert!(value("lumbar_bending").abs() < 5.0, "the trunk stays: {}", value("lumbar_bending"));
    // Locked joints stay; nothing else turns the palm far enough.
    let locked = "[coordinates]\nfree = [\"pelvis_ty\", \"wrist_dev_l\"]\n";
    let text = refused(&format!("{PALM}{locked}{FEET}[[support]]\nsegment = \"hand_l\"\n"));
    assert!(text.contains("cannot be laid flat within the ranges of the joints"), "{text}");
    assert!(text.contains("line 13, columns 11 to 18"), "{text}");
}

#[test]
fn a_plane_by_a_point_is_reached_and_a_far_one_refused() {
    let palm = |height: f64| {
        format!(
            "{PALM}{FEET}[[support]]\nsegment = \"hand_l\"\non = {{ normal = [0, 1, 0], point_m = [0, {height}, 0] }}\n"
        )
    };
    let free = read(&format!("{PALM}{FEET}[[support]]\nsegment = \"hand_l\"\n"));
    let height = heights(&free)[2][0];
    let scenario = read(&palm(height + 0.03));
    assert_at(&heights(&scenario)[2], height + 0.03);
    let text = refused(&palm(height + 0.2));
    assert!(text.contains("m below its plane and tilted by") && text.contains("line 12, columns 6"), "{text}");
}

/// The pelvis keeps its tilt; its patch becomes level.
#[test]
fn the_seat_takes_the_shape_of_its_surface() {
    let sitting = "[posture]\npelvis_ty_m = 0.512\npelvis_tilt_deg = 15\nhip_flexion_r_deg = 70\nhip_flexion_l_deg = 70\n\
                   knee_angle_r_deg = 85\nknee_angle_l_deg = 85\n[[support]]\nsegment = \"pelvis\"\n";
    let scenario = read(&format!("{sitting}{FEET}"));
    let seat = &heights(&scenario)[0];
    assert_at(seat, seat[0]);
    let tilt = scenario.start.values()[scenario.model.coordinate("pelvis_tilt").unwrap()].to_degrees();
    assert!((tilt - 15.0).abs() < 3.0, "{tilt}");
    assert!(note(&scenario, "takes the shape of its surface"), "{:?}", scenario.notes);
}

#[test]
fn wrong_steps_are_refused_where_they_stand() {
    for (keys, place, part) in [
        ("step_m = 2.5", "line 4, columns 10 to 12", "step_m is 2.5 m; it must lie in 0..2, above the floor"),
        ("step_m = -0.1", "line 4, columns 10 to 13", "step_m is -0.1 m"),
        ("step_m = \"high\"", "line 4, columns 10", "number"),
        ("on = \"ground\"\nstep_m = 0.2", "line 5, columns 1 to 6", "`step_m` goes with `on = \"floor\"`"),
        ("on = \"flor\"", "line 4, columns 6", "write \"floor\", \"ground\", or { normal = [x, y, z]"),
    ] {
        let text =
            refused(&format!("[[support]]\nsegment = \"calcn_r\"\n{keys}\n[[support]]\nsegment = \"calcn_l\"\n"));
        assert!(text.contains(place) && text.contains(part), "{keys}: {text}");
    }
}

/// Of a pose an unknown patch is no error, a floating foot is.
#[test]
fn a_pose_stands_on_the_floor_as_well() {
    let pose = |rest: &str| read_pose("a.toml", format!("format = 1\n{rest}").as_bytes(), None);
    assert!(pose("[[support]]\nsegment = \"head\"\n").is_ok());
    assert!(pose(&format!("{RAISED}{FEET}")).is_err());
    let scenario = pose(&format!("[posture]\npelvis_ty_m = 1.5\n{FEET}")).unwrap();
    assert!(scenario.start.values()[scenario.model.coordinate("pelvis_ty").unwrap()] < 1.0);
}
