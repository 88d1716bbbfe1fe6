//! How long does one lexicographic least-squares problem take? As large and as layered as inverse kinematics of a whole body
//! makes them, and growing from 10 to 200 unknowns and 1 to 8 levels. With `CONTRAPPOSTO_EXCHANGE` set to a folder, the
//! growing problems are written there with our answers and least times, for `scripts/compare_growth.py`, and that is all.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hierarchical_least_squares::{Level, Problem, Solver};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Levels of so many random equations each, then a rest posture; unknowns within `room`.
fn problem(random: &mut Pcg64Mcg, n: usize, rows: &[usize], room: f64) -> Problem {
    let mut problem = Problem::new(n);
    problem.lower.fill(-room);
    problem.upper.fill(room);
    for &rows in rows {
        let mut level = Level::default();
        for _ in 0..rows {
            let row: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let right = random.random_range(-0.2..0.2);
            level.push(&row, right, right);
        }
        problem.levels.push(level);
    }
    let mut rest = Level::default();
    for i in 6.min(n / 4)..n {
        let mut row = vec![0.0; n];
        row[i] = 1.0;
        let right = random.random_range(-0.3..0.3);
        rest.push(&row, right, right);
    }
    problem.levels.push(rest);
    problem
}

fn solve(c: &mut Criterion) {
    let mut random = Pcg64Mcg::new(1);
    let mut group = c.benchmark_group("lexicographic/54 unknowns, levels of 12, 2, 3, 3 and 48 rows");
    for (name, room) in [("no bound active", 1e3), ("bounds active", 0.25)] {
        let problem = problem(&mut random, 54, &[12, 2, 3, 3], room);
        let mut solver = Solver::new();
        solver.solve(&problem).expect("a problem");
        let changes = solver.changes();
        group.bench_function(format!("{name}, cold ({changes} changes)"), |b| {
            b.iter(|| solver.solve(black_box(&problem)));
        });
        group.bench_function(format!("{name}, active set known"), |b| {
            b.iter(|| solver.solve_next(black_box(&problem)));
        });
    }
    group.finish();
}

/// Levels, unknowns, problem.
fn growing() -> Vec<(usize, usize, Problem)> {
    let mut random = Pcg64Mcg::new(2);
    let sizes = [1, 2, 4, 8].into_iter().flat_map(|levels| [10, 20, 50, 100, 200].map(|n| (levels, n)));
    sizes.map(|(levels, n)| (levels, n, problem(&mut random, n, &vec![n / 2 / levels; levels], 0.5))).collect()
}

fn growth(c: &mut Criterion) {
    if let Some(folder) = std::env::var_os("CONTRAPPOSTO_EXCHANGE") {
        return exchange(folder.as_ref());
    }
    for (levels, n, problem) in growing() {
        let mut group = c.benchmark_group(format!("lexicographic/growth, {levels} levels and a rest posture"));
        let mut solver = Solver::new();
        group.bench_with_input(BenchmarkId::from_parameter(n), &n, |b, _| {
            b.iter(|| solver.solve_next(black_box(&problem)));
        });
        group.finish();
    }
}

/// The least time of what is run for half a second, microseconds.
fn least(mut run: impl FnMut()) -> f64 {
    let (start, mut least) = (Instant::now(), Duration::MAX);
    while start.elapsed() < Duration::from_millis(500) {
        let before = Instant::now();
        run();
        least = least.min(before.elapsed());
    }
    least.as_secs_f64() * 1e6
}

/// One JSON file a problem: what is asked, how long each level's residual is, how long it took with nothing known and with the
/// active set known.
fn exchange(folder: &std::path::Path) {
    for (count, n, problem) in growing() {
        let (mut cold, mut known) = (Solver::new(), Solver::new());
        let cold = least(|| drop(black_box(cold.solve(black_box(&problem)))));
        let time = least(|| drop(black_box(known.solve_next(black_box(&problem)))));
        let levels: Vec<String> = problem
            .levels
            .iter()
            .enumerate()
            .map(|(k, level)| {
                let (matrix, right, residual) = (&level.matrix, &level.upper, known.residual_norm(k));
                format!(r#"{{"matrix": {matrix:?}, "right": {right:?}, "residual": {residual:?}}}"#)
            })
            .collect();
        let (lower, upper) = (&problem.lower, &problem.upper);
        let text = format!(
            r#"{{"count": {count}, "lower": {lower:?}, "upper": {upper:?}, "cold": {cold:?}, "known": {time:?}, "levels": [{}]}}"#,
            levels.join(", ")
        );
        std::fs::write(folder.join(format!("{count}_{n}.json")), text).expect("a folder to write to");
    }
}

criterion_group!(benches, solve, growth);
criterion_main!(benches);
