//! Compares the solver with a cascade of quadratic programs solved by Clarabel, with the optimality conditions in 32 digits,
//! and with the recursion of Baerlocher & Boulic. `CONTRAPPOSTO_SEED` chooses another seed, `CONTRAPPOSTO_PROBLEM` a single
//! problem of the first test, which is printed, `CONTRAPPOSTO_FAILURES` the number of failures that are shown.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    unreachable_pub,
    reason = "tests: helpers outside #[test] functions too"
)]

mod cascade;
mod conditions;
mod damping;
mod double_double;
mod edge_cases;
mod feasibility;
mod generator;
mod linear;
mod residuals;

use crate::conditions::{Answer, Violations};
use crate::generator::Draw;
use std::fmt::Write as _;

const SAME: f64 = 1e-8;

fn seed() -> u64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("seed {seed}");
    seed
}

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |most, x| if x.is_nan() { f64::INFINITY } else { most.max(x.abs()) })
}

/// Residuals as if no row were scaled.
fn unscaled(draw: &Draw, residuals: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let level = |(rows, residuals): (&Vec<generator::Row>, &Vec<f64>)| {
        rows.iter().zip(residuals).map(|(row, r)| r / row.scale).collect()
    };
    draw.levels.iter().zip(residuals).map(level).collect()
}

/// Length of a level's scaled residuals, relative to its largest scale.
fn length(draw: &Draw, k: usize, residuals: &[f64]) -> f64 {
    let most = largest(draw.levels[k].iter().map(|row| row.scale));
    let squares = draw.levels[k].iter().zip(residuals).map(|(row, r)| (row.scale / most * r).powi(2));
    squares.sum::<f64>().sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// Solution and residuals, bit for bit.
fn bits(answer: &Answer) -> Vec<u64> {
    answer.x.iter().chain(answer.residuals.iter().flatten()).map(|x| x.to_bits()).collect()
}

/// Counts and largest differences of many problems. Only problems that pass count in the differences.
#[derive(Debug, Default)]
struct Tally {
    problems: usize,
    conflicting: usize,
    /// Draws thrown away because their ranks are not clear.
    thrown: usize,
    /// Same as Clarabel.
    compared: usize,
    /// Decided in 32 digits: where Clarabel does not call itself `Solved`,
    unsolved: usize,
    /// where the rows it keeps have no clear rank,
    unclear: usize,
    /// where it says something else (too long by its tolerance, most often).
    decided: usize,
    /// Difference to Clarabel, or to another thing a test compares with.
    worst: f64,
    /// Difference to the residuals in 32 digits, where those decide.
    worst_reference: f64,
    violations: Violations,
    failures: Vec<String>,
}

impl Tally {
    fn add(&mut self, other: Self) {
        self.problems += other.problems;
        self.thrown += other.thrown;
        self.conflicting += other.conflicting;
        self.compared += other.compared;
        self.unsolved += other.unsolved;
        self.unclear += other.unclear;
        self.decided += other.decided;
        self.worst = self.worst.max(other.worst);
        self.worst_reference = self.worst_reference.max(other.worst_reference);
        self.violations.largest(&other.violations);
        self.failures.extend(other.failures);
    }

    /// Prints what was seen, fails if anything failed.
    fn close(mut self) {
        let failures = std::mem::take(&mut self.failures);
        println!("{self:?}\n{} failures", failures.len());
        let shown = std::env::var("CONTRAPPOSTO_FAILURES").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
        let first = failures.iter().take(shown).fold(String::new(), |mut all, f| {
            writeln!(all, "{f}").unwrap();
            all
        });
        println!("{first}");
        assert!(failures.is_empty(), "{} failures; the first:\n{first}", failures.len());
    }
}

/// Checks `count` problems on two threads.
fn all_problems(count: usize, check: impl Fn(usize, &mut Tally) -> Result<(), String> + Sync) -> Tally {
    const THREADS: usize = 2;
    let part = |thread| {
        let mut tally = Tally::default();
        for index in (thread..count).step_by(THREADS) {
            tally.problems += 1;
            if let Err(failure) = check(index, &mut tally) {
                tally.failures.push(format!("problem {index}: {failure}"));
            }
        }
        tally
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..THREADS).map(|thread| scope.spawn(move || part(thread))).collect();
        let mut tally = part(0);
        for other in others {
            tally.add(other.join().unwrap());
        }
        tally
    })
}
