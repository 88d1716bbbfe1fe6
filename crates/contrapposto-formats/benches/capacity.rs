//! Measures the greatest forces at a hand in 642 directions, and prints problems for another program.
//! Processor time of the thread, from `/proc/thread-self/schedstat`.
//! `cargo bench -p contrapposto-formats --bench capacity -- time COUNT` or `-- problems COUNT`; `scripts/compare_capacity.py` calls both.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark prints")]

#[path = "../tests/common/hands.rs"]
#[allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests use other parts")]
mod hands;

use std::hint::black_box;

use hands::{arm, exerted, standing};

/// Processor time of this thread, ms.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    1e-6 * text.split_whitespace().next().unwrap().parse::<f64>().unwrap()
}

/// Runs between two looks at the clock, which moves on once in a few milliseconds.
const RUNS: usize = 20;

/// Least and median of times, ms.
fn measured(count: usize, mut run: impl FnMut(u64)) -> [f64; 2] {
    let mut times: Vec<f64> = (0..count as u64)
        .map(|number| {
            let start = cpu();
            (0..RUNS).for_each(|_| run(number));
            (cpu() - start) / RUNS as f64
        })
        .collect();
    times.sort_unstable_by(f64::total_cmp);
    [times[0], times[times.len() / 2]]
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["time", count] => time(count.parse().unwrap()),
        ["problems", count] => problems(count.parse().unwrap()),
        _ => println!("time COUNT | problems COUNT"),
    }
}

/// From a posture to all forces: torques, contact forces, the program, and 642 directions with the weakest and the strongest.
fn time(count: usize) {
    let body = standing();
    let [least, median] = measured(count, |_| drop(black_box(body.capacity().unwrap().solid())));
    println!("{{\"what\": \"adult on both feet\", \"least_ms\": {least:.3}, \"median_ms\": {median:.3}}}");
    let arms: Vec<_> = (0..count as u64).map(arm).filter(|arm| arm.capacity().is_some()).collect();
    let [least, median] = measured(arms.len(), |i| drop(black_box(arms[i as usize].capacity().unwrap().solid())));
    println!("{{\"what\": \"right arm, fixed\", \"least_ms\": {least:.3}, \"median_ms\": {median:.3}}}");
}

/// Jacobian, limits and bias of fixed arms, one JSON object a line.
fn problems(count: u64) {
    for (number, arm) in
        (0..).map(|number| (number, arm(number))).filter(|(_, arm)| arm.capacity().is_some()).take(count as usize)
    {
        let (jacobian, least, greatest, bias) = exerted(&arm);
        println!(
            "{{\"number\": {number}, \"posture\": {:?}, \"jacobian\": {jacobian:?}, \"least\": {least:?}, \"greatest\": {greatest:?}, \
             \"bias\": {bias:?}}}",
            arm.posture.values()
        );
    }
}
