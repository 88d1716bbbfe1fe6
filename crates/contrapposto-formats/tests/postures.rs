//! Solves the published peer problem (`common/peer.rs`): targets within reach are reached, others are met at their nearest.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

#[path = "common/peer.rs"]
mod peer;

use contrapposto::kinematics::Kinematics;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options, Reason};
use contrapposto::tasks::{self, Task};
use nalgebra::Vector3;
use peer::{Peer, target};
use rand::{RngExt, SeedableRng};
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

/// A random posture that keeps feet, centre of mass and ranges, and where its right hand is: surely within reach. Drawn as the
/// published targets are: right arm anywhere, spine and left arm in half their ranges, hips and knees bent up to 1.3 rad.
fn reachable(peer: &Peer, rng: &mut Pcg64) -> (Vector3<f64>, Posture) {
    let mut kinematics = Kinematics::new(&peer.model);
    loop {
        let mut wish = peer.rest.clone();
        for (i, coordinate) in peer.model.coordinates().iter().enumerate() {
            let (name, (lower, upper)) = (coordinate.name.as_str(), coordinate.range);
            let named = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
            let (lower, upper) = if named(&["jRightC7", "jRightShoulder", "jRightElbow", "jRightWrist"]) {
                (lower, upper)
            } else if named(&["jLeftC7", "jLeftShoulder", "jLeftElbow", "jLeftWrist", "jL5", "jL4", "jL1", "jT9"]) {
                (0.5 * lower, 0.5 * upper)
            } else if named(&["Hip_roty", "Knee_roty"]) {
                if -lower > upper { (lower.max(-1.3), 0.0) } else { (0.0, upper.min(1.3)) }
            } else {
                continue;
            };
            wish.values_mut()[i] = lower + (upper - lower) * rng.random::<f64>();
        }
        // Feet and centre of mass as asked, and everything else as near to the wish as that allows.
        let mut goals = peer.goals(Vector3::zeros());
        goals.drain(2..4);
        let Some([Task::Posture(tasks::Posture { target, .. })]) = goals.last_mut().map(|goal| &mut goal.tasks[..])
        else {
            panic!("the last goal is a posture");
        };
        target.clone_from(&wish);
        let pose = Engine::new(&peer.model, goals, &[], Options::inverse_kinematics()).unwrap().solve(&wish).unwrap();
        if pose.levels[..2].iter().all(|level| level.length < 1e-9) && peer.excess(&pose.posture) == 0.0 {
            kinematics.update(&peer.model, &pose.posture).unwrap();
            return (kinematics.station(&peer.model, peer.hand(), Vector3::zeros()), pose.posture);
        }
    }
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
        let target = if i == 0 { swing } else { reachable(&peer, rng).0 };
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
        // Overhead, or far in front and beside, as the published ones.
        let mut within = |lower: f64, upper: f64| lower + (upper - lower) * rng.random::<f64>();
        let target = if i % 2 == 0 {
            Vector3::new(within(-0.4, 0.4), within(-0.5, 0.0), within(2.4, 3.2))
        } else {
            let (distance, angle) = (within(1.8, 2.8), within(-0.6, 0.6));
            Vector3::new(distance * angle.cos(), distance * angle.sin(), within(0.5, 1.6))
        };
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let pose = engine.solve(&peer.rest).unwrap();
        let levels = &pose.levels;
        assert!(levels[0].length < 1e-6 && levels[1].length < 1e-6 && peer.excess(&pose.posture) < 1e-9, "target {i}");
        let gain = peer.gain(&pose.posture, target, 1e-3);
        assert!(gain < 1e-6, "target {i}: a step of 0.001 rad would bring the hand {gain:.1e} m nearer");
        // The best of four starts is the best known.
        let mut best = levels[2].length;
        for _ in 0..3 {
            let (_, start) = reachable(&peer, rng);
            best = best.min(engine.solve(&start).unwrap().levels[2].length);
        }
        let excess = levels[2].length - best;
        println!("target {i}: {:+.3} mm from the best of four starts, still to gain {gain:.1e} m", 1e3 * excess);
        near += usize::from(excess < 1e-3);
    }
    assert!(near >= 6, "{near} of 8 within 1 mm of the best known distance");
}
