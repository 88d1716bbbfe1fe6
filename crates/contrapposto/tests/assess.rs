//! Tests the assessment of a given motion: rates of sampling, mirrored bodies, peaks, supports, and refused motions.

use contrapposto::assessment::{AssessError, AssessSettings, Assessment, GroupAssessment, PeakKind, assess};
use contrapposto::contact::Support;
use contrapposto::hybrid::Strategy;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::verdict::{Verdict, VerdictKind};
use nalgebra::Vector3;

fn body() -> Model {
    adult(&Adult::default()).unwrap()
}

/// The default posture with some angles, deg.
fn bent(model: &Model, angles: &[(&str, f64)]) -> Posture {
    let mut posture = model.default_posture();
    for (name, angle) in angles {
        posture.values_mut()[model.coordinate(name).unwrap()] = angle.to_radians();
    }
    posture
}

/// Three kilograms in one hand.
fn holding(model: &Model, hand: &str, motion: &[(f64, Posture)]) -> Assessment {
    let load = Load::weight(model, model.segment(hand).unwrap(), 3.0);
    assess(model, motion, |_, _, loads| loads.push(load), &AssessSettings::default(), |_| {}).unwrap()
}

fn group<'a>(model: &Model, found: &'a Assessment, name: &str, side: Side) -> &'a GroupAssessment {
    let coordinate = model.coordinate(name).unwrap();
    found.groups.iter().find(|group| (group.coordinate, group.side) == (coordinate, side)).unwrap()
}

/// A posture held for ten minutes is the same in two rows as in six hundred, and torques that change in a straight line between
/// two rows are those of rows between them.
#[test]
fn a_held_posture_in_2_rows_and_in_600_gives_the_same_assessment() {
    let model = body();
    let level = bent(&model, &[("elbow_flex_r", 90.0)]);
    let two = holding(&model, "hand_r", &[(0.0, level.clone()), (600.0, level.clone())]);
    let many: Vec<_> = (0..=600).map(|second| (f64::from(second), level.clone())).collect();
    let many = holding(&model, "hand_r", &many);
    for (a, b) in two.groups.iter().zip(&many.groups) {
        assert_eq!((a.coordinate, a.side), (b.coordinate, b.side));
        assert!((a.fatigue - b.fatigue).abs() < 1e-5, "{a:?} {b:?}");
        match (a.exhausted_at, b.exhausted_at) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-3 * a, "{a} {b}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}

#[test]
fn the_same_motion_of_left_and_right_arm_gives_the_same_load_and_fatigue() {
    let model = body();
    let of = |side: &str| {
        let elbow = format!("elbow_flex_{side}");
        let motion = [(0.0, bent(&model, &[(&elbow, 90.0)])), (300.0, bent(&model, &[(&elbow, 60.0)]))];
        let found = holding(&model, &format!("hand_{side}"), &motion);
        group(&model, &found, &elbow, Side::Positive).clone()
    };
    let (right, left) = (of("r"), of("l"));
    assert!((right.peak_load.value - left.peak_load.value).abs() < 1e-12 && right.peak_load.value > 0.1);
    assert!((right.fatigue - left.fatigue).abs() < 1e-9 && right.fatigue > 0.1);
    assert_eq!(right.proposals.len(), left.proposals.len());
    assert!(right.proposals.iter().zip(&left.proposals).all(|(r, l)| r.sentence == l.sentence));
}

/// The load is greatest in the middle, where the forearm is nearer to level; fatigue at the end.
#[test]
fn load_peaks_in_the_middle_and_fatigue_at_the_end() {
    let model = body();
    let angles = [10.0, 20.0, 60.0, 20.0, 10.0];
    let motion: Vec<_> = angles
        .iter()
        .zip(0..)
        .map(|(&angle, i)| (60.0 * f64::from(i), bent(&model, &[("elbow_flex_r", angle)])))
        .collect();
    let found = holding(&model, "hand_r", &motion);
    let elbow = group(&model, &found, "elbow_flex_r", Side::Positive);
    assert_eq!((elbow.peak_load.index, elbow.peak_load.time), (2, 120.0));
    let asked: Vec<_> = elbow.proposals.iter().map(|p| (p.at, p.strategy)).collect();
    assert_eq!(asked[..2], [(PeakKind::Load, Strategy::Active), (PeakKind::Load, Strategy::Passive)]);
    for proposal in &elbow.proposals {
        let decision = &proposal.decision;
        assert!(decision.active_torque_at_goal.unwrap().abs() <= decision.active_torque.abs(), "{proposal:?}");
    }
    assert!((elbow.proposals[0].angle.to_degrees() - 60.0).abs() < 1e-9);
    // The group that never works neither tires nor asks.
    let rests = group(&model, &found, "knee_angle_r", Side::Positive);
    assert!(rests.peak_load.value > 0.0 || (rests.fatigue == 0.0 && rests.proposals.is_empty()));
}

/// Without supports the root lacks the whole weight; on both feet nothing.
#[test]
fn the_root_lacks_the_whole_weight_without_supports_and_nothing_on_two_feet() {
    let model = body();
    let motion = [(0.0, model.default_posture()), (1.0, bent(&model, &[("arm_flex_r", 40.0)]))];
    let weight = model.mass() * model.gravity().norm();
    let nothing = |_: f64, _: &contrapposto::kinematics::Kinematics, _: &mut Vec<Load>| {};
    let alone = assess(&model, &motion, nothing, &AssessSettings::default(), |_| {}).unwrap();
    assert!((alone.residual_force.value - weight).abs() < 1e-9 * weight && alone.unheld == 0);
    let support = |name: &str| {
        let segment = model.segment(name).unwrap();
        let corners = model.segments()[segment].patch.clone();
        Support {
            segment,
            corners,
            normal: Vector3::y(),
            friction: 0.6,
            share_max: 1.0,
            place: contrapposto::contact::Place::Fixed,
        }
    };
    let settings =
        AssessSettings { supports: vec![support("calcn_r"), support("calcn_l")], ..AssessSettings::default() };
    let mut largest = 0.0_f64;
    let held = assess(&model, &motion, nothing, &settings, |instant| {
        for name in ["pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_tilt", "pelvis_list", "pelvis_rotation"] {
            let rate = model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap();
            largest = largest.max(instant.torques.active_torque()[rate].abs());
        }
    });
    let held = held.unwrap();
    assert!(largest < 1e-8 * weight && held.residual_force.value < 1e-8 * weight && held.unheld == 0, "{largest}");
    // A hand in the air holds nobody: the answer says so.
    let settings = AssessSettings {
        supports: vec![Support { normal: -Vector3::y(), ..support("calcn_r") }],
        ..AssessSettings::default()
    };
    let falls = assess(&model, &motion, nothing, &settings, |_| {}).unwrap();
    assert!(falls.unheld == 2 && falls.residual_force.value > 0.9 * weight);
}

/// A pelvis that goes up as a parabola accelerates by twice its coefficient, whatever the rate of frames.
#[test]
fn a_pelvis_that_rises_as_a_parabola_accelerates_by_twice_its_coefficient() {
    let model = body();
    let height = model.coordinate("pelvis_ty").unwrap();
    for rate in [20.0, 100.0, 1000.0] {
        let motion: Vec<_> = (0..=(rate as usize))
            .map(|i| {
                let time = i as f64 / rate;
                let mut posture = model.default_posture();
                posture.values_mut()[height] += 0.75 * time * time;
                (time, posture)
            })
            .collect();
        let found = assess(&model, &motion, |_, _, _| {}, &AssessSettings::default(), |_| {}).unwrap();
        assert!((found.acceleration.value - 1.5).abs() < 1e-6, "{rate}: {:?}", found.acceleration);
        assert!(found.fast_share > 0.85, "{rate}: {}", found.fast_share);
    }
}

#[test]
fn motions_too_long_out_of_order_or_of_another_model_are_refused() {
    let model = body();
    let at = |time: f64| (time, model.default_posture());
    let try_it = |motion: &[(f64, Posture)]| assess(&model, motion, |_, _, _| {}, &AssessSettings::default(), |_| {});
    assert!(matches!(try_it(&[at(0.0), at(2e5)]), Err(AssessError::TooLong(_))));
    assert!(matches!(try_it(&[at(1.0), at(2.0), at(1.5)]), Err(AssessError::Order { index: 2, .. })));
    assert!(matches!(try_it(&[at(f64::NAN), at(2.0)]), Err(AssessError::Order { index: 0, .. })));
    for none in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(try_it(&[at(1.0), at(none), at(2.0)]), Err(AssessError::Order { index: 1, .. })));
    }
    assert!(matches!(try_it(&[at(0.0), (1.0, Posture::new(vec![0.0]))]), Err(AssessError::Torques { index: 1, .. })));
    assert_eq!(try_it(&[]).unwrap().groups.iter().filter(|group| group.peak_load.value > 0.0).count(), 0);
}

#[test]
fn a_motion_whose_time_begins_at_3_s_has_the_minutes_of_one_that_begins_at_0() {
    let model = body();
    let load = Load::weight(&model, model.segment("hand_r").unwrap(), 3.0);
    let level = bent(&model, &[("elbow_flex_r", 90.0)]);
    let hang = Load { kind: LoadKind::Force(-model.mass() * model.gravity(), FixedIn::World), ..load };
    let [early, late] = [0.0, 3.0].map(|start| {
        let motion = [(start, level.clone()), (start + 600.0, level.clone())];
        let both = |_: f64, _: &Kinematics, loads: &mut Vec<Load>| loads.extend([load, hang_at_pelvis(&model, hang)]);
        let found = assess(&model, &motion, both, &AssessSettings::default(), |_| {}).unwrap();
        Verdict::of_motion(&model, &found, 600.0)
    });
    assert!(early.range.is_some(), "{}", early.sentence);
    assert_eq!(early.sentence, late.sentence);
}

/// The same load on the pelvis.
fn hang_at_pelvis(model: &Model, load: Load) -> Load {
    let segment = model.segment("pelvis").unwrap();
    Load { segment, point: model.segments()[segment].center_of_mass, ..load }
}

#[test]
fn a_motion_that_swings_the_trunk_twice_a_second_is_said_to_be_judged_at_rest() {
    let model = body();
    let motion: Vec<_> = (0..=200)
        .map(|i| {
            let time = f64::from(i) / 100.0;
            (time, bent(&model, &[("lumbar_extension", -20.0 - 15.0 * libm::cos(4.0 * std::f64::consts::PI * time))]))
        })
        .collect();
    let hang = hang_at_pelvis(&model, Load::weight(&model, 0, 0.0));
    let hang = Load { kind: LoadKind::Force(-model.mass() * model.gravity(), FixedIn::World), ..hang };
    let found = assess(&model, &motion, |_, _, loads| loads.push(hang), &AssessSettings::default(), |_| {}).unwrap();
    let verdict = Verdict::of_motion(&model, &found, 2.0);
    assert!(found.fast_share > 0.2, "{}", found.fast_share);
    let words = format!("judged at rest; the motion is fast in {:.0}\u{a0}% of its frames.", 100.0 * found.fast_share);
    assert!(verdict.sentence.ends_with(&words), "{}", verdict.sentence);
    assert!(!verdict.in_words().contains("Fails first"), "{}", verdict.in_words());
}

/// Two minutes of the default posture under a force that pulls the pelvis up with a share of the body's weight.
fn pulled_up(model: &Model, share: f64, root_held: bool) -> Verdict {
    let weight = model.mass() * model.gravity().norm();
    let force = LoadKind::Force(-share * model.gravity().normalize() * weight, FixedIn::World);
    let pelvis = model.segment("pelvis").unwrap();
    let load = Load { segment: pelvis, point: model.segments()[pelvis].center_of_mass, kind: force };
    let motion = [(3.0, model.default_posture()), (123.0, model.default_posture())];
    let loads = |_: f64, _: &Kinematics, loads: &mut Vec<Load>| loads.extend((share > 0.0).then_some(load));
    let settings = AssessSettings { root_held, ..AssessSettings::default() };
    let found = assess(model, &motion, loads, &settings, |_| {}).unwrap();
    Verdict::of_motion(model, &found, 120.0)
}

#[test]
fn a_body_that_nothing_carries_lacks_its_weight_and_one_that_forces_nearly_carry_is_judged_by_its_muscles() {
    let model = body();
    let weight = model.mass() * model.gravity().norm();
    let falls = pulled_up(&model, 0.0, false);
    assert_eq!(falls.kind, VerdictKind::CannotStand, "{}", falls.sentence);
    assert!(falls.sentence.contains(&format!("{weight:.0} N and ")), "{weight} N: {}", falls.sentence);
    assert!(falls.sentence.contains("its root is free to fall"), "{}", falls.sentence);
    let lacks = pulled_up(&model, 0.4, false);
    assert_eq!(lacks.kind, VerdictKind::CannotStand, "{}", lacks.sentence);
    assert!(lacks.sentence.contains(&format!("{:.0} N and ", 0.6 * weight)), "{}", lacks.sentence);
    for (share, root_held) in [(0.6, false), (0.9, false), (1.0, false), (0.0, true), (0.4, true)] {
        let nearly = pulled_up(&model, share, root_held);
        assert!(nearly.kind.is_done(), "{share}: {}", nearly.sentence);
    }
}
