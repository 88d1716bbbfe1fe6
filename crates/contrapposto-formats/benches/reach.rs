//! Measures the posture solver on targets drawn anew: out of reach, and within reach of the published peer problem.
//! Times by the wall clock: pin it to a core that nothing else uses. Needs the problem in `../shared`.
//! `cargo bench -p contrapposto-formats --bench reach -- solve|plain|starts|within|targets SEED COUNT`; `targets` prints the targets alone, as JSON, for
//! `scripts/ik_beside_peers.py`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark prints")]

#[path = "../tests/common/peer.rs"]
#[allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests use other parts")]
mod peer;
#[path = "../tests/common/shared.rs"]
#[allow(unreachable_pub, reason = "tests include this file as a module")]
mod shared;

use std::time::Instant;

use contrapposto::posture_solver::{Engine, Options};
use peer::Peer;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Plain steps of a run out of reach, and the last of them that are to be short.
const STEPS: usize = 300;
const LAST: usize = 50;

/// Runs of each target within reach, of which the least time of every step counts.
const RUNS: usize = 3;

/// Time since a moment, ms.
fn since(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

fn share(sorted: &mut [f64], share: f64) -> f64 {
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn describe(what: &str, values: &mut [f64]) {
    let (total, n) = (values.iter().sum::<f64>(), values.len() as f64);
    let [median, p90, p99, most] = [0.5, 0.9, 0.99, 1.0].map(|part| share(values, part));
    println!(
        "{what}: total {total:.4}, mean {:.4}, median {median:.4}, p90 {p90:.4}, p99 {p99:.4}, max {most:.4}",
        total / n
    );
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [mode, seed, count] = &args[..] else { return println!("solve|plain|starts|within|targets SEED COUNT") };
    let (peer, count) = (Peer::read(), count.parse().unwrap());
    let seed: u64 = seed.parse().unwrap();
    if mode == "targets" {
        return targets(&peer, seed, count);
    }
    println!("{mode}, seed {seed}, {count} targets");
    match mode.as_str() {
        "solve" => solve(&peer, seed, count),
        "plain" => plain(&peer, seed, count),
        "starts" => starts(&peer, seed, count),
        "within" => within(&peer, seed, count),
        mode => panic!("`{mode}`"),
    }
}

/// The targets of `within` and of the other modes with the same seed.
fn targets(peer: &Peer, seed: u64, count: usize) {
    let rng = || Pcg64::seed_from_u64(seed);
    let (mut of_within, mut of_others) = (rng(), rng());
    let within: Vec<Vec<f64>> = (0..count).map(|_| peer.reachable(&mut of_within).0.as_slice().to_vec()).collect();
    let beyond: Vec<Vec<f64>> = (0..count).map(|i| peer.out_of_reach(i, &mut of_others).as_slice().to_vec()).collect();
    println!("{}", serde_json::json!({ "within": within, "beyond": beyond }));
}

fn solve(peer: &Peer, seed: u64, count: usize) {
    let rng = &mut Pcg64::seed_from_u64(seed);
    let (mut times, mut steps) = (vec![], vec![]);
    for i in 0..count {
        let target = peer.out_of_reach(i, rng);
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let start = Instant::now();
        let pose = engine.solve(&peer.rest).unwrap();
        let time = since(start);
        let [feet, com, hand] = [0, 1, 2].map(|k| pose.levels[k].length);
        let gain = peer.gain(&pose.posture, target, 1e-3);
        println!(
            "target {i}: {} steps {time:.2} ms, hand {hand:.7} feet {feet:.1e} com {com:.1e} gain {gain:.1e} {:?}",
            pose.steps, pose.reason
        );
        times.push(time);
        steps.push(pose.steps as f64);
    }
    describe("steps", &mut steps);
    describe("ms a target", &mut times);
}

fn plain(peer: &Peer, seed: u64, count: usize) {
    let rng = &mut Pcg64::seed_from_u64(seed);
    let (mut times, mut moves, mut worst, mut changes) = (vec![], vec![], vec![], 0);
    let verbose = std::env::var("TRACE").ok().and_then(|t| t.parse::<usize>().ok());
    for i in 0..count {
        let target = peer.out_of_reach(i, rng);
        if verbose.is_some_and(|v| v != i) {
            continue;
        }
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let (mut posture, mut before, mut last, mut all) = (peer.rest.clone(), peer.rest.clone(), 0f64, 0f64);
        let mut step = vec![0.0; peer.model.rates().len()];
        let mut quiet = 0;
        for s in 0..STEPS {
            let start = Instant::now();
            let made = engine.step(&mut posture).unwrap();
            times.push(since(start));
            before.difference(&peer.model, &posture, &mut step);
            let largest = step.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
            if verbose.is_some() {
                println!("{s}: {largest:.2e} {:?} {} {:.1e}", made.status, made.changes, made.largest);
                println!("    {:?}", engine.errors());
            }
            if s + LAST >= STEPS {
                last = last.max(largest);
            }
            if largest > 1e-6 {
                quiet = s + 1;
            }
            all = all.max(largest);
            changes += made.changes;
            before.clone_from(&posture);
        }
        println!("target {i}: last {LAST} moves {last:.1e} rad, quiet after {quiet}, hand {:.7}", engine.errors()[2]);
        moves.push(last);
        worst.push(all);
    }
    for v in moves.iter_mut() {
        *v *= 1e6;
    }
    describe("ms a step", &mut times);
    describe("largest of the last moves, microrad", &mut moves);
    describe("largest of all moves, rad", &mut worst);
    println!("changes of the working set a step {:.1}", changes as f64 / times.len() as f64);
}

fn starts(peer: &Peer, seed: u64, count: usize) {
    let rng = &mut Pcg64::seed_from_u64(seed);
    let other = &mut Pcg64::seed_from_u64(seed ^ 0x5eed);
    let (mut excesses, mut near) = (vec![], 0);
    for i in 0..count {
        let target = peer.out_of_reach(i, rng);
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let own = engine.solve(&peer.rest).unwrap().levels[2].length;
        let mut found: Vec<f64> = (0..20)
            .map(|_| peer.reachable(other).1)
            .map(|start| engine.solve(&start).unwrap())
            .filter(|pose| pose.levels[..2].iter().all(|level| level.length < 1e-6))
            .map(|pose| pose.levels[2].length)
            .collect();
        found.sort_unstable_by(f64::total_cmp);
        let excess = 1e3 * (own - found.first().unwrap_or(&own).min(own));
        println!("target {i}: {excess:.3} mm, own {own:.7}, best {:.7} {:?}", found[0], target.as_slice());
        excesses.push(excess);
        near += usize::from(excess <= 1.0);
    }
    describe("excess, mm", &mut excesses);
    println!("{near} of {count} within 1 mm");
}

fn within(peer: &Peer, seed: u64, count: usize) {
    let rng = &mut Pcg64::seed_from_u64(seed);
    let (mut made, mut times, mut each, mut failed) = (vec![], vec![], vec![], 0);
    for i in 0..count {
        let target = peer.reachable(rng).0;
        let mut engine = Engine::new(&peer.model, peer.goals(target), &[], Options::inverse_kinematics()).unwrap();
        let (mut least, mut steps) = (vec![f64::INFINITY; STEPS], 0);
        for _ in 0..RUNS {
            engine.restart();
            let mut posture = peer.rest.clone();
            steps = 0;
            loop {
                let start = Instant::now();
                engine.step(&mut posture).unwrap();
                let time = since(start);
                // The errors of a step are those of its start: success shows in the step after the last.
                if steps == STEPS || engine.errors()[..3].iter().all(|error| *error < 1e-3) {
                    break;
                }
                least[steps] = time.min(least[steps]);
                steps += 1;
            }
        }
        if steps == STEPS {
            let solved = engine.solve(&peer.rest).unwrap();
            let solved: Vec<String> = solved.levels[..3].iter().map(|level| format!("{:.1e}", level.length)).collect();
            println!("target {i} is not reached by plain steps: {:?}; errors of `solve` {solved:?}", target.as_slice());
            failed += 1;
        }
        let total: f64 = least[..steps].iter().sum();
        each.extend_from_slice(&least[..steps]);
        if steps > 20 {
            println!("target {i}: {steps} steps");
        }
        made.push(steps as f64);
        times.push(total);
    }
    describe("steps", &mut made);
    describe("ms a step", &mut each);
    describe("ms a target", &mut times);
    println!("{failed} of {count} not reached");
}
