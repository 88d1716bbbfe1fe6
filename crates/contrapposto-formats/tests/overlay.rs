//! The overlay reader is total: any bytes give a model with finite torques, or an error that names the file. The meaning of
//! an overlay is tested with the program (`contrapposto-cli/tests/torques.rs`).

use crate::common;

use common::toml::hammer_toml;
use contrapposto::model::{Adult, Model, adult};
use contrapposto_formats::overlay;

/// Every kind of law, on angles and a slide.
const FULL: &str = r#"[coordinates.knee_angle_r]
range_deg = [-5, 120]
passive = { double_exponential = { lower = { torque_nm = 2, rate_per_rad = 8, angle_deg = -4 }, upper = { torque_nm = 2, rate_per_rad = 6, angle_deg = 110 }, stiffness_nm_per_rad = 0.4, neutral_deg = 30 }, reshape = { zone_deg = 5, end_torque_nm = 20 } }
strength = { positive_nm = 100, negative_nm = 200 }
fatigue = "knee"
[coordinates.elbow_flex_r]
passive = { curve = "elbow_neutral", sign = 1 }
[coordinates.ankle_angle_r]
range_deg = [-40, 30]
passive = { coordinate_limit_force = { upper_stiffness_nm_per_deg = 1.5, upper_limit_deg = 20, lower_stiffness_nm_per_deg = 1.2, lower_limit_deg = -30, transition_deg = 8 } }
[coordinates.wrist_flex_r]
range_deg = [-70, 70]
passive = { table_deg_nm = [[-70, 13.2], [-15, 0.5], [20, -1.6], [70, -9.9]], reshape = true }
fatigue = "grip"
[coordinates.pelvis_ty]
range_m = [-1, 2.5]
"#;

#[test]
fn mutated_overlays_never_panic() {
    let model = adult(&Adult::default()).unwrap();
    if let Err(error) = overlay("full.toml", FULL.as_bytes(), model.clone()) {
        panic!("{error:?}");
    }
    hammer_toml("overlay", 20_070_904, 5_000, &[FULL.to_owned()], |bytes| {
        let message = || String::from_utf8_lossy(bytes).into_owned();
        match overlay("mutant.toml", bytes, model.clone()) {
            Ok(laid) => {
                assert!(!laid.changes.is_empty() && sound(&laid.model), "{}", message());
                true
            }
            Err(error) => {
                let mut text = String::new();
                miette::NarratableReportHandler::new().render_report(&mut text, &error).unwrap();
                assert!(text.contains("mutant.toml") && !text.contains('\u{1b}'), "{text:?}\n{}", message());
                false
            }
        }
    });
}

/// No product of accepted numbers overflows: limits are at most 1e9 rad or m in size.
#[test]
fn ranges_without_end_are_refused_where_they_stand() {
    let model = adult(&Adult::default()).unwrap();
    let lay = |lines: &str| {
        let laid = overlay("wide.toml", format!("[coordinates.{lines}\n").as_bytes(), model.clone());
        let mut text = String::new();
        if let Err(error) = laid {
            miette::NarratableReportHandler::new().render_report(&mut text, &error).unwrap();
        }
        text
    };
    for (lines, limit) in [
        ("knee_angle_r]\nrange_deg = [0x7fff, 1e308]", "1e308"),
        ("knee_angle_r]\nrange_deg = [-6e10, 0]", "-6e10"),
        ("pelvis_ty]\nrange_m = [0, 1.1e9]", "1.1e9"),
    ] {
        let text = lay(lines);
        assert!(
            text.contains("line 2, column") && text.contains(&format!("is {limit}; it must be at most 1e9")),
            "{text}"
        );
    }
    assert_eq!(lay("pelvis_ty]\nrange_m = [0, 1e9]"), "");
    assert!(
        model.clone().with_range(0, (0.0, 1.0000001e9)).is_err()
            && model.clone().with_range(0, (f64::NEG_INFINITY, 0.0)).is_err()
    );
    assert_eq!(model.with_range(0, (-1e9, 1e9)).unwrap().coordinates()[0].range, (-1e9, 1e9));
}

/// A table of strength has its values at its angles, for each sense its own, and between them none beyond these.
#[test]
fn strength_comes_from_a_table_over_the_angle() {
    let model = adult(&Adult::default()).unwrap();
    let knee = model.coordinate("knee_angle_r").unwrap();
    let lay = |strength: &str| {
        let text = format!("[coordinates.knee_angle_r]\nstrength = {{ {strength} }}\n");
        let laid = overlay("knee.toml", text.as_bytes(), model.clone());
        laid.map_err(|error| {
            let mut text = String::new();
            miette::NarratableReportHandler::new().render_report(&mut text, &error).unwrap();
            text
        })
    };
    let laid = lay("table_deg_nm = [[0, 80, 150], [60, 100, 210], [120, 60, 90]]").unwrap();
    assert!(laid.changes[0].note.contains("strength of a table of 3 rows"), "{}", laid.changes[0].note);
    let groups = laid.model.coordinates()[knee].groups.as_ref().unwrap();
    let torques = |degrees: f64| [0, 1].map(|side| groups[side].strength.torque(degrees.to_radians()));
    for (angle, expected) in [(0.0, [80.0, 150.0]), (60.0, [100.0, 210.0]), (120.0, [60.0, 90.0])] {
        let found = torques(angle);
        assert!(
            found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9),
            "{angle}: {found:?}"
        );
    }
    for (angle, low, high) in [(30.0, [80.0, 150.0], [100.0, 210.0]), (90.0, [60.0, 90.0], [100.0, 210.0])] {
        let found = torques(angle);
        assert!((0..2).all(|side| low[side] < found[side] && found[side] < high[side]), "{angle}: {found:?}");
    }
    for (strength, words) in [
        ("positive_nm = 100", "give positive_nm and negative_nm, or table_deg_nm alone"),
        ("positive_nm = 100, negative_nm = 0", "negative_nm is 0"),
        ("table_deg_nm = [[0, 80, 150], [60, 100, -1]]", "at 60 deg the sizes are 100 and -1"),
        ("table_deg_nm = [[60, 80, 150], [0, 100, 200]]", "give two rows or more whose angles rise"),
        ("table_deg_nm = [[0, 80, 150]]", "these rows are no table of strength"),
    ] {
        let message = lay(strength).map(|_| ()).unwrap_err();
        assert!(message.contains(words) && message.contains("line 2, column"), "{message}");
    }
}

/// Ranges are ranges, defaults lie in them, and every torque in them is a number.
fn sound(model: &Model) -> bool {
    let mut values = model.default_posture().values().to_vec();
    (0..values.len()).all(|i| {
        let coordinate = &model.coordinates()[i];
        let (min, max) = coordinate.range;
        let inside = min < max && (min..=max).contains(&coordinate.default);
        let torques = (0..=8).all(|k| {
            values[i] = min + (max - min) * f64::from(k) / 8.0;
            coordinate.passive.as_ref().is_none_or(|law| law.torque(i, &values).is_finite())
        });
        values[i] = coordinate.default;
        inside && torques
    })
}
