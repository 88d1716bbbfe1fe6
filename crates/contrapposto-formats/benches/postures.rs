//! Measures a step of the published peer problem, and a posture of each of its targets until the success rule of its file
//! holds. Thread time by the wall clock, the least of several runs. Needs the problem in `../shared`.
//! `cargo bench -p contrapposto-formats --bench postures [-- TARGET]`; with a target, only its runs, for a profiler.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark prints")]

#[path = "../tests/common/peer.rs"]
#[allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests use other parts")]
mod peer;
#[path = "../tests/common/shared.rs"]
#[allow(unreachable_pub, reason = "tests include this file as a module")]
mod shared;

use std::time::Instant;

use contrapposto::posture_solver::{Engine, Options};
use peer::{Peer, target};

/// Runs of each target.
const RUNS: usize = 30;
/// Most steps of a run.
const STEPS: usize = 60;

fn main() {
    let peer = Peer::read();
    let only: Option<usize> = std::env::args().find_map(|a| a.parse().ok());
    let (mut times, mut steps, mut all) = (vec![], vec![], vec![]);
    for (i, case) in peer.file["tuning"].as_array().unwrap().iter().enumerate() {
        if only.is_some_and(|only| only != i) {
            continue;
        }
        let mut engine =
            Engine::new(&peer.model, peer.goals(target(case)), &[], Options::inverse_kinematics()).unwrap();
        let mut least = vec![f64::INFINITY; STEPS];
        let (mut total, mut made, mut changes) = (f64::INFINITY, 0, vec![]);
        for _ in 0..RUNS {
            let mut posture = peer.rest.clone();
            engine.restart();
            (made, changes) = (0, vec![]);
            let mut run = 0.0;
            // The errors of a step are those of its start: success shows in the step after the last.
            while made < STEPS {
                let start = Instant::now();
                let step = engine.step(&mut posture).unwrap();
                let time = 1e6 * start.elapsed().as_secs_f64();
                if engine.errors()[..3].iter().all(|error| *error < 1e-3) {
                    break;
                }
                (least[made], run) = (time.min(least[made]), run + time);
                changes.push(step.changes);
                made += 1;
            }
            total = total.min(run);
        }
        println!("target {i}: {made} steps, {total:.0} us; by step {:.0?}, changes {changes:?}", &least[..made]);
        times.push(total);
        steps.push(made);
        all.extend_from_slice(&least[..made]);
    }
    let median = |v: &mut Vec<f64>| {
        v.sort_unstable_by(f64::total_cmp);
        (v[v.len() / 2] + v[(v.len() - 1) / 2]) / 2.0
    };
    steps.sort_unstable();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    println!(
        "steps to success {steps:?}\nposture: median {:.0} us, worst {:.0}",
        median(&mut times),
        times[times.len() - 1]
    );
    println!(
        "step: least {:.1} us, median {:.1}, mean {mean:.1}",
        all.iter().copied().fold(f64::INFINITY, f64::min),
        median(&mut all)
    );
}
