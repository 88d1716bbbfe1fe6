//! Relief does not return to a goal that it has left: random whole-body scenarios, judged by their samples alone.
//!
//! The long test takes pieces: `CONTRAPPOSTO_SEED` is the seed of its first scenario, `CONTRAPPOSTO_SCENARIOS` their number. It prints the
//! sums after every 50 scenarios.

mod judge;
mod scenarios;

use contrapposto::simulation::{Scenario, ScenarioError, run};
use judge::{Findings, Judge};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Seed of the first scenario; each scenario has a seed of its own.
const FIRST_SEED: u64 = 1_600;
/// Scenarios of the suite.
const SUITE: u64 = 50;
/// Scenarios of the long test.
const FULL_COUNT: u64 = 2_000;

/// Findings of the judge in one run; `None` for a scenario whose supports cannot hold its body.
fn judged(scenario: &Scenario) -> Option<Findings> {
    let mut judge = Judge::new(scenario);
    match run(scenario, |sample| judge.take(sample)) {
        Ok(_) => Some(judge.findings()),
        Err(ScenarioError::CannotStand(_) | ScenarioError::Falls(_)) => None,
        Err(error) => panic!("{error}"),
    }
}

/// Runs `count` scenarios, each from its seed, and adds up what the judge finds; prints the seed of each violation.
fn judge_many(first: u64, count: u64) -> (Findings, u64) {
    let (mut all, mut cannot_stand) = (Findings::default(), 0);
    for seed in first..first + count {
        let scenario = scenarios::random(&mut Pcg64Mcg::seed_from_u64(seed));
        match judged(&scenario) {
            Some(findings) => {
                if findings.violations + findings.wrong_attempts + findings.efforts_above > 0 {
                    println!("seed {seed}: {findings:?}");
                }
                all.add(&findings);
            }
            None => cannot_stand += 1,
        }
        let done = seed + 1 - first;
        if done.is_multiple_of(SUITE) || done == count {
            println!("{done} scenarios from seed {first}, {cannot_stand} without balance; {all:?}");
        }
    }
    (all, cannot_stand)
}

fn environment(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap())
}

fn assert_kept(findings: &Findings, cannot_stand: u64, count: u64) {
    assert_eq!(findings.violations, 0, "goals that had been left were taken up again");
    assert_eq!((findings.wrong_attempts, findings.efforts_above), (0, 0), "{findings:?}");
    // The judge had something to judge.
    assert!(4 * cannot_stand < 3 * count, "{cannot_stand} of {count} scenarios without balance");
    assert!(findings.goals > count && findings.changes > count / 10, "{findings:?}");
    assert!(findings.attempts.iter().all(|&attempts| attempts > count / 10), "{findings:?}");
}

#[test]
fn fifty_random_scenarios_take_up_no_goal_again() {
    let (findings, cannot_stand) = judge_many(FIRST_SEED, SUITE);
    assert_kept(&findings, cannot_stand, SUITE);
}

#[test]
#[ignore = "needs half an hour: 2,000 random scenarios"]
fn two_thousand_random_scenarios_take_up_no_goal_again() {
    let first = environment("CONTRAPPOSTO_SEED").unwrap_or(FIRST_SEED);
    let count = environment("CONTRAPPOSTO_SCENARIOS").unwrap_or(FULL_COUNT);
    let (findings, cannot_stand) = judge_many(first, count);
    assert_kept(&findings, cannot_stand, count);
}
