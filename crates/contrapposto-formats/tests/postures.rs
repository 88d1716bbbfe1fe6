//! Solves the published peer problem (`common/peer.rs`): targets within reach are reached, others are met at their nearest.

use crate::common::peer;

use contrapposto::posture_solver::{Engine, Options, Reason};
use nalgebra::Vector3;
use peer::{Peer, target};
use rand::SeedableRng;
use rand_pcg::Pcg64;

#[test]
#[ignore = "needs ../shared: the published peer problem"]
fn every_reachable_target_is_reached() {
    let peer = Peer::read();
    let mut steps_to_success = vec![];
    for (i, case) in peer.file["tuning"].as_array().unwrap().iter().enumerate() {
        let mut engine =
            Engine::new(&peer.model, peer.goals(target(case)), &[], Options::inverse_kinematics()).unwrap();
        let mut success = None;
        let mut posture = peer.rest.clone();
        for step in 0..60 {
            let levels = engine.report(&posture).unwrap();
            let within = |level: usize| levels[level].length < 1e-3;
            if within(0) && within(1) && within(2) && peer.excess(&posture) <= 0.0 {
                success = Some(step);
                break;
            }
            engine.step(&mut posture).unwrap();
        }
        steps_to_success.push(success.unwrap_or_else(|| panic!("target {i} is not reached")));
        let pose = engine.solve(&peer.rest).unwrap();
        let levels = &pose.levels;
        assert!(levels[..3].iter().all(|level| level.length < 1e-9), "target {i}: {levels:?}");
        assert!(pose.reason == Reason::Converged, "target {i}: {:?} after {} steps", pose.reason, pose.steps);
    }
    steps_to_success.sort_unstable();
    println!("{} targets, steps to success: {steps_to_success:?}", steps_to_success.len());
}

#[test]
#[ignore = "needs ../shared: the published peer problem"]
fn out_of_reach_the_hand_settles_at_its_nearest_and_nothing_above_gives() {
    let peer = Peer::read();
    let mut near = 0;
    let cases = peer.file["unreachable"].as_array().unwrap();
    for (i, case) in cases.iter().enumerate() {
        let options = Options { step_tolerance: 1e-12, ..Options::inverse_kinematics() };
        let mut engine = Engine::new(&peer.model, peer.goals(target(case)), &[], options).unwrap();
        let mut trail = vec![];
        let pose = engine.solve_watched(&peer.rest, |_, posture| trail.push(posture.clone())).unwrap();
        let mut step = vec![0.0; peer.model.rates().len()];
        let mut last = 0f64;
        for pair in trail.windows(2).rev().take(30) {
            pair[0].difference(&peer.model, &pair[1], &mut step);
            last = step.iter().fold(last, |most, s| most.max(s.abs()));
        }
        let levels = &pose.levels;
        let excess = levels[2].length - case["best_feasible_hand_distance_m"].as_f64().unwrap();
        let gain = peer.gain(&pose.posture, target(case), 1e-3);
        println!(
            "target {i}: {} steps, feet {:.1e}, centre {:.1e}, hand {:+.3} mm from the best known, still to gain {:.1e} m, last moves {last:.1e} rad",
            pose.steps,
            levels[0].length,
            levels[1].length,
            1e3 * excess,
            gain
        );
        assert!(levels[0].length < 1e-6 && levels[1].length < 1e-6 && peer.excess(&pose.posture) < 1e-9, "target {i}");
        assert!(last < 1e-6, "target {i}: still moving by {last:.1e} rad");
        assert!(gain < 1e-6, "target {i}: a step of 0.001 rad would bring the hand {gain:.1e} m nearer");
        near += usize::from(excess < 1e-3);
    }
    assert!(near >= 7 && cases.len() == 8, "{near} of {} within 1 mm of the best known distance", cases.len());
}

fn seed() -> u64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("seed {seed}");
    seed
}

#[test]
#[ignore = "needs ../shared: the published peer problem"]
fn other_targets_within_reach_are_reached_too() {
    let peer = Peer::read();
    let rng = &mut Pcg64::seed_from_u64(seed());
    let mut steps_to_success = vec![];
    // One of seed 1, where the last level swings ever wider if it is not bent.
    let swing = Vector3::new(0.48315487357555337, 0.42526972032297927, 1.425907949471182);
    for i in 0..200 {
        let target = if i == 0 { swing } else { peer.reachable(rng).0 };
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let mut posture = peer.rest.clone();
        let mut success = None;
        for step in 0..300 {
            let levels = engine.report(&posture).unwrap();
            if levels[..3].iter().all(|level| level.length < 1e-3) && peer.excess(&posture) <= 0.0 {
                success = Some(step);
                break;
            }
            engine.step(&mut posture).unwrap();
        }
        let mut left = || engine.report(&posture).unwrap()[2].length;
        steps_to_success.push(success.unwrap_or_else(|| panic!("target {i}: the hand stays {:.3} m off", left())));
    }
    steps_to_success.sort_unstable();
    println!("{} targets, steps to success: {steps_to_success:?}", steps_to_success.len());
}

#[test]
#[ignore = "needs ../shared: the published peer problem"]
fn other_targets_out_of_reach_are_met_at_their_nearest_too() {
    let peer = Peer::read();
    let rng = &mut Pcg64::seed_from_u64(seed() ^ 1);
    let mut near = 0;
    for i in 0..8 {
        let target = peer.out_of_reach(i, rng);
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let pose = engine.solve(&peer.rest).unwrap();
        let levels = &pose.levels;
        assert!(levels[0].length < 1e-6 && levels[1].length < 1e-6 && peer.excess(&pose.posture) < 1e-9, "target {i}");
        let gain = peer.gain(&pose.posture, target, 1e-3);
        assert!(gain < 1e-6, "target {i}: a step of 0.001 rad would bring the hand {gain:.1e} m nearer");
        // The best of four starts is the best known.
        let mut best = levels[2].length;
        for _ in 0..3 {
            let (_, start) = peer.reachable(rng);
            best = best.min(engine.solve(&start).unwrap().levels[2].length);
        }
        let excess = levels[2].length - best;
        println!("target {i}: {:+.3} mm from the best of four starts, still to gain {gain:.1e} m", 1e3 * excess);
        near += usize::from(excess < 1e-3);
    }
    assert!(near >= 6, "{near} of 8 within 1 mm of the best known distance");
}

/// Plain steps are those of the first start.
#[test]
#[ignore = "needs ../shared: the published peer problem"]
fn some_targets_out_of_reach_are_nearer_from_another_start_and_none_is_farther() {
    let peer = Peer::read();
    let rng = &mut Pcg64::seed_from_u64(seed() ^ 2);
    let mut nearer = 0;
    for i in 0..20 {
        let target = peer.out_of_reach(i, rng);
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let mut posture = peer.rest.clone();
        for _ in 0..Options::inverse_kinematics().max_steps {
            engine.step(&mut posture).unwrap();
        }
        let plain = engine.report(&posture).unwrap()[2].length;
        let gain = plain - engine.solve(&peer.rest).unwrap().levels[2].length;
        assert!(gain > -1e-4, "target {i}: {gain} m");
        nearer += usize::from(gain > 1e-3);
    }
    println!("{nearer} of 20 nearer by over 1 mm");
    assert!(nearer > 0, "no other start gains anything");
}
