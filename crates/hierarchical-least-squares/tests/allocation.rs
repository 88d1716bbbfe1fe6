//! Counts allocations of the solver: once its workspace is as large as the problem, it allocates nothing.

use hierarchical_least_squares::{Level, Problem, Solver, Status};
use rand::RngExt;
use rand_pcg::Pcg64;

const PROBLEMS: usize = 50;

/// Damped levels of random equations and inequalities, one level of single unknowns, and bounds that become active.
fn problem(random: &mut Pcg64) -> Problem {
    let n = 40;
    let mut problem = Problem::new(n);
    problem.lower.fill(-0.25);
    problem.upper.fill(0.25);
    for rows in [9, 2, 3] {
        let mut level = Level::default();
        for _ in 0..rows {
            let row: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let right = random.random_range(-0.2..0.2);
            level.push(&row, right, if random.random_range(0..4) == 0 { right + 0.1 } else { right });
        }
        level.damping = random.random_range(0.0..0.01);
        problem.levels.push(level);
    }
    let mut single = Level::default();
    for i in 0..n {
        let mut row = vec![0.0; n];
        row[i] = 1.0;
        let right = random.random_range(-0.3..0.3);
        single.push(&row, right, right);
    }
    problem.levels.push(single);
    problem
}

/// Solves every problem `warm` times before allocations count.
fn assert_no_allocation(problems: &[Problem], warm: usize, mut solver: Solver, next: bool) {
    for round in 0..=warm {
        for (index, problem) in problems.iter().enumerate() {
            let solve = || {
                let status = if next { solver.solve_next(problem) } else { solver.solve(problem) };
                assert_eq!(status, Ok(Status::Solved));
            };
            let made = allocation_counter::measure(solve).count_total;
            assert!(made == 0 || round < warm, "problem {index} allocates {made} times (warm start: {next})");
        }
    }
    assert!(solver.changes() > 0);
}

#[test]
fn solver_that_has_seen_every_problem_allocates_nothing() {
    let mut random = Pcg64::new(20_070_902, 0);
    let problems: Vec<Problem> = (0..PROBLEMS).map(|_| problem(&mut random)).collect();
    assert_no_allocation(&problems, 1, Solver::new(), false);
    assert_no_allocation(&problems, 1, Solver::new(), true);
}

#[test]
fn solver_with_capacity_allocates_nothing_at_once() {
    let mut random = Pcg64::new(20_070_902, 0);
    let problems: Vec<Problem> = (0..PROBLEMS).map(|_| problem(&mut random)).collect();
    assert_no_allocation(&problems, 0, Solver::with_capacity(40, 4, 40, 54), false);
}
