//! Measures one hierarchical least-squares problem of 54 unknowns, and problems growing from 10 to 200 unknowns and 1 to 8
//! levels. With `CONTRAPPOSTO_EXCHANGE` set to a folder, the growing problems are only written there, with answers and least
//! times, for `scripts/compare_growth.py`.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hierarchical_least_squares::{Level, Problem, Solver};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Levels of so many random equations each, then a level of single unknowns; unknowns within `room`.
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
    let mut single = Level::default();
    for i in 6.min(n / 4)..n {
        let mut row = vec![0.0; n];
        row[i] = 1.0;
        let right = random.random_range(-0.3..0.3);
        single.push(&row, right, right);
    }
    problem.levels.push(single);
    problem
}

fn solve(c: &mut Criterion) {
    let mut random = Pcg64Mcg::new(1);
    let mut group = c.benchmark_group("solve/54 unknowns, levels of 12, 2, 3, 3 and 48 rows");
    for (name, room) in [("no bound active", 1e3), ("bounds active", 0.25)] {
        let problem = problem(&mut random, 54, &[12, 2, 3, 3], room);
        let mut solver = Solver::new();
        solver.solve(&problem).expect("a problem");
        let changes = solver.changes();
        group.bench_function(format!("{name}, cold ({changes} changes)"), |b| {
            b.iter(|| solver.solve(black_box(&problem)));
        });
        group.bench_function(format!("{name}, warm start"), |b| {
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
        let mut group = c.benchmark_group(format!("solve/growth, {levels} levels and one of single unknowns"));
        let mut solver = Solver::new();
        group.bench_with_input(BenchmarkId::from_parameter(n), &n, |b, _| {
            b.iter(|| solver.solve_next(black_box(&problem)));
        });
        group.finish();
    }
}

/// The least time of `run`, repeated for half a second, microseconds.
fn least(mut run: impl FnMut()) -> f64 {
    let (start, mut least) = (Instant::now(), Duration::MAX);
    while start.elapsed() < Duration::from_millis(500) {
        let before = Instant::now();
        run();
        least = least.min(before.elapsed());
    }
    least.as_secs_f64() * 1e6
}

/// Writes one JSON file a problem: the problem, the norm of each residual, and the times of a cold and a warm start.
fn exchange(folder: &std::path::Path) {
    for (count, n, problem) in growing() {
        let (mut cold, mut warm) = (Solver::new(), Solver::new());
        let cold = least(|| drop(black_box(cold.solve(black_box(&problem)))));
        let time = least(|| drop(black_box(warm.solve_next(black_box(&problem)))));
        let levels: Vec<String> = problem
            .levels
            .iter()
            .enumerate()
            .map(|(k, level)| {
                let (matrix, right, residual) = (&level.matrix, &level.upper, warm.residual_norm(k));
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
