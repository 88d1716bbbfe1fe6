//! Compares effort and time of least-effort postures with SLSQP on Pinocchio's derivatives. For each target of a file of the
//! peer's answers: one solve from rest, the sum of squared active torques against the peer's, and the times of both.
//!
//! `cargo bench -p contrapposto-formats --bench relax -- FILE [local minima]`, FILE the answers that `50_posture_pinocchio.py` of the
//! peers' bench wrote a moment ago on the same core; see docs/benchmarks.md.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a table for people to read")]

#[path = "../tests/effort/problem.rs"]
#[allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests use other parts")]
mod problem;
#[path = "../tests/common/shared.rs"]
#[allow(unreachable_pub, reason = "tests include this file as a module")]
mod shared;

use std::path::Path;
use std::time::Instant;

use contrapposto::posture_solver::Options;

/// Solves of each target; the median time counts.
const REPEATS: usize = 5;
/// An effort counts as no worse up to this share above the peer's.
const SAME: f64 = 1e-4;

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn run(file: &Path, name: &str, standing: bool, options: Options) {
    let problem = problem::Problem::read(standing);
    let (mut ours, mut peers, mut shares, mut steps) = (vec![], vec![], vec![], vec![]);
    let (mut no_worse, mut held, mut worst) = (0, 0, 0f64);
    let targets = problem::targets(file, name);
    for (i, target) in targets.iter().enumerate() {
        let mut engine = problem.engine(target.target, options);
        let mut times = vec![];
        let mut last = None;
        for _ in 0..REPEATS {
            let start = Instant::now();
            last = Some(engine.solve(&problem.rest).unwrap());
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        let pose = last.unwrap();
        let ratio = pose.effort / target.effort;
        no_worse += usize::from(ratio <= 1.0 + SAME);
        held += usize::from(problem::holds(&pose));
        worst = worst.max(pose.levels[0].length).max(pose.slip.length());
        println!(
            "{i:2} effort {:9.3} peer {:9.3} ratio {ratio:6.3}  hand {:.0e} m  slip {:.0e}  {:?} {:?}, {} steps, {:.2} ms",
            pose.effort,
            target.effort,
            pose.levels[0].length,
            pose.slip.length(),
            pose.balance,
            pose.reason,
            pose.steps,
            median(&times),
        );
        ours.push(median(&times));
        peers.push(target.ms);
        shares.push(ratio);
        steps.push(pose.steps as f64);
    }
    let (ours, peers) = (median(&ours), median(&peers));
    println!(
        "{name}: no worse {no_worse} of {}, held {held}, worst error {worst:.0e}; effort by the peer's, median {:.3}; {:.2} ms \
         by {peers:.1} ms = {:.3}; {} steps",
        targets.len(),
        median(&shares),
        ours,
        ours / peers,
        median(&steps),
    );
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let Some(file) = arguments.first() else {
        println!("left out: no file of the peer's answers was named");
        return;
    };
    let local_minima = arguments.get(1).map_or(Options::least_effort().local_minima, |n| n.parse().unwrap());
    let options = Options { local_minima, ..Options::least_effort() };
    run(Path::new(file), "A_upper_body_fixed_pelvis_30dof", false, options);
    run(Path::new(file), "B_standing_66_unknowns", true, options);
}
