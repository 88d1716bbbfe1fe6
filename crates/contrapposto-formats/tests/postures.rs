//! Does the prioritised solver reach the targets of the published peer problem (`common/peer.rs`), and hold on where they are
//! out of reach? Skips where it is not beside the project.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

#[path = "common/peer.rs"]
mod peer;

use contrapposto::ik::{Engine, Options, Reason};
use peer::{Peer, target};

#[test]
fn every_reachable_target_is_reached() {
    let Some(peer) = Peer::read() else { return };
    let mut steps_to_success = vec![];
    for (i, case) in peer.file["tuning"].as_array().unwrap().iter().enumerate() {
        let mut engine = Engine::new(&peer.model, peer.goals(target(case)), &[], Options::default()).unwrap();
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
        assert!(pose.reason == Reason::Closest, "target {i}: {:?} after {} steps", pose.reason, pose.steps);
    }
    steps_to_success.sort_unstable();
    println!("{} targets, steps to success: {steps_to_success:?}", steps_to_success.len());
}

#[test]
fn out_of_reach_the_hand_settles_at_its_nearest_and_nothing_above_gives() {
    let Some(peer) = Peer::read() else { return };
    let mut near = 0;
    let cases = peer.file["unreachable"].as_array().unwrap();
    for (i, case) in cases.iter().enumerate() {
        let options = Options { still: 1e-12, ..Options::default() };
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
    assert!(near >= 6 && cases.len() == 8, "{near} of {} within 1 mm of the best known distance", cases.len());
}
