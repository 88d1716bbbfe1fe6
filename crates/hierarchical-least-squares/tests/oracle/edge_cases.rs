//! Checks refused, empty and badly scaled problems, and the oracle itself on answers that are known to be wrong.

use crate::conditions::{Answer, violations};
use crate::generator;
use crate::generator::{DrawOptions, Scaling, draw, empty_level, random};
use crate::seed;
use hierarchical_least_squares::{Level, Problem, Solver, Status};
use rand::RngExt;

fn level(rows: &[(&[f64], f64, f64)]) -> Level {
    let mut level = empty_level();
    for (row, lower, upper) in rows {
        level.push(row, *lower, *upper);
    }
    level
}

fn problem(n: usize, levels: Vec<Level>) -> Problem {
    Problem { levels, ..Problem::new(n) }
}

#[test]
fn wrong_lengths_and_numbers_are_refused() {
    let good = || problem(2, vec![level(&[(&[1.0, 2.0], 0.0, 1.0), (&[0.0, 1.0], 1.0, 1.0)])]);
    assert_eq!(Solver::new().solve(&good()), Ok(Status::Solved));
    type Spoil = fn(&mut Problem);
    let spoils: [Spoil; 20] = [
        |p| p.levels[0].matrix.truncate(3),
        |p| p.levels[0].matrix.push(0.0),
        |p| p.levels[0].matrix.clear(),
        |p| p.levels[0].lower.truncate(1),
        |p| p.levels[0].upper.push(1.0),
        |p| p.levels[0].lower.clear(),
        |p| p.lower.truncate(1),
        |p| p.upper.truncate(1),
        |p| p.upper.push(1.0),
        |p| p.levels[0].matrix[1] = f64::NAN,
        |p| p.levels[0].matrix[1] = f64::INFINITY,
        |p| p.levels[0].lower[1] = f64::NAN,
        |p| p.levels[0].upper[0] = f64::NAN,
        |p| p.levels[0].lower[0] = 2.0,
        |p| p.levels[0].damping = f64::NAN,
        |p| p.levels[0].damping = f64::INFINITY,
        |p| p.levels[0].damping = -1.0,
        |p| p.lower[0] = f64::NAN,
        |p| (p.lower[1], p.upper[1]) = (1.0, 0.5),
        |p| (p.lower[1], p.upper[1]) = (f64::INFINITY, f64::INFINITY),
    ];
    for (i, spoil) in spoils.iter().enumerate() {
        let mut bad = good();
        spoil(&mut bad);
        let mut solver = Solver::new();
        assert!(solver.solve(&bad).is_err(), "case {i}");
        assert!(solver.solve_next(&bad).is_err(), "case {i}");
        // A refused problem leaves the last answer and its working set unchanged.
        assert_eq!(solver.solve(&good()), Ok(Status::Solved));
        let mut same = solver.clone();
        assert!(solver.solve_next(&bad).is_err(), "case {i}");
        assert_eq!(solver.solution(), same.solution(), "case {i}");
        assert_eq!(solver.solve_next(&good()), same.solve_next(&good()));
        assert_eq!(solver.solution(), same.solution(), "case {i}");
    }
}

#[test]
fn empty_levels_and_rows_of_zeros_are_solved() {
    let mut solver = Solver::new();
    for n in 0..3 {
        let zeros = vec![0.0; n];
        for levels in [
            vec![],
            vec![level(&[])],
            vec![level(&[]), level(&[])],
            vec![level(&[(&zeros, 0.0, 0.0)])],
            vec![level(&[(&zeros, f64::NEG_INFINITY, f64::INFINITY)])],
            vec![level(&[(&zeros, 1.0, 1.0), (&zeros, -1.0, f64::INFINITY)]), level(&[]), level(&[(&zeros, 2.0, 3.0)])],
        ] {
            let mut problem = problem(n, levels);
            for _ in 0..2 {
                assert_eq!(solver.solve(&problem), Ok(Status::Solved));
                assert_eq!(solver.solve_next(&problem), Ok(Status::Solved));
                assert_eq!(solver.solution().len(), n);
                for (k, level) in problem.levels.iter().enumerate() {
                    let expected: Vec<f64> =
                        level.lower.iter().zip(&level.upper).map(|(l, u)| generator::outside(0.0, *l, *u)).collect();
                    assert_eq!(solver.residual(k), expected);
                    assert_eq!(solver.multipliers(k).bounds.len(), n);
                }
                problem.lower.fill(-1.0);
            }
        }
    }
    // Equal bounds determine the unknown; a row of zeros cannot be satisfied.
    let mut fixed = problem(1, vec![level(&[(&[1.0], 5.0, 5.0)]), level(&[(&[0.0], 1.0, 2.0)])]);
    (fixed.lower[0], fixed.upper[0]) = (2.0, 2.0);
    fixed.levels[1].hard = true;
    assert_eq!(solver.solve(&fixed), Ok(Status::Infeasible { level: 1 }));
    assert_eq!((solver.solution(), solver.residual(0), solver.residual(1)), (&[2.0][..], &[-3.0][..], &[-1.0][..]));
}

/// Coefficients far from one give an answer or an error: no panic, no NaN, and bounds satisfied.
#[test]
fn extreme_scales_give_finite_answers_or_errors() {
    let seed = seed() ^ 7;
    let mut refused = 0;
    let mut stopped = 0;
    for index in 0..3000 {
        let rng = &mut random(seed, index);
        let scaling = Scaling::ByRow;
        let options =
            DrawOptions { conflicting: index & 1 == 0, scaling, bounds: true, inequalities: true, largest: 12 };
        let (draw, _) = draw(rng, options);
        let mut problem = draw.problem();
        let (exponent, scattered) = ([10, 50, 150, 300][index / 2 % 4], index / 8 % 2 == 0);
        let common = 10.0_f64.powi(rng.random_range(-exponent..=exponent));
        let mut factor = || {
            if scattered { 10.0_f64.powi(rng.random_range(-exponent..=exponent)) } else { common }
        };
        for level in &mut problem.levels {
            level.matrix.iter_mut().for_each(|a| *a *= factor());
            for (lower, upper) in level.lower.iter_mut().zip(&mut level.upper) {
                let factor = factor();
                (*lower, *upper) = (*lower * factor, *upper * factor);
            }
            level.damping = if index / 16 % 2 == 0 { factor() } else { 0.0 };
        }
        let mut solver = Solver::new();
        for warm in [false, true] {
            match if warm { solver.solve_next(&problem) } else { solver.solve(&problem) } {
                Ok(status) => {
                    stopped += usize::from(status == Status::Stopped);
                    for ((x, lower), upper) in solver.solution().iter().zip(&problem.lower).zip(&problem.upper) {
                        assert!(x.is_finite() && lower <= x && x <= upper, "problem {index}: {x}");
                    }
                    let rows = (0..problem.levels.len()).flat_map(|k| solver.residual(k));
                    assert!(rows.into_iter().all(|r| !r.is_nan()), "problem {index}");
                }
                Err(_) => refused += 1,
            }
        }
    }
    println!("of 6000: {refused} refused, {stopped} stopped");
}

/// First `x <= 1`, then `x = 3`: only `x = 1` with a multiplier of 2 satisfies the conditions.
#[test]
fn optimality_conditions_reject_wrong_answers() {
    let problem = problem(1, vec![level(&[(&[1.0], f64::NEG_INFINITY, 1.0)]), level(&[(&[1.0], 3.0, 3.0)])]);
    let judge = |x: f64, push: f64| {
        let residuals = vec![vec![(x - 1.0).max(0.0)], vec![x - 3.0]];
        let multipliers = vec![(vec![0.0], vec![]), (vec![0.0], vec![push])];
        violations(&problem, &[vec![1.0], vec![1.0]], &Answer { x: vec![x], residuals, multipliers })
    };
    assert!(judge(1.0, 2.0).are_rounding());
    // Below the limit; above it; without multiplier; off the limit by a residual.
    for (x, push) in [(0.5, 2.5), (3.0, 0.0), (1.0, 0.0), (1.0 - 1e-8, 2.0 + 1e-8), (1.0 + 1e-8, 2.0 - 1e-8)] {
        assert!(!judge(x, push).are_rounding(), "{x} {push}");
    }
    // A multiplier of the wrong sign: `x = 0` would be better and satisfies the first level.
    let mut pulled = problem.clone();
    (pulled.levels[1].lower[0], pulled.levels[1].upper[0]) = (0.0, 0.0);
    let multipliers = vec![(vec![0.0], vec![]), (vec![0.0], vec![-1.0])];
    let answer = Answer { x: vec![1.0], residuals: vec![vec![0.0], vec![1.0]], multipliers };
    assert!(!violations(&pulled, &[vec![1.0], vec![1.0]], &answer).are_rounding());
}

#[test]
fn limits_met_at_once_are_taken_in_their_order_whatever_their_last_digits() {
    // Two equal unknowns fall to their lower bounds together; the bound that enters first makes the other one dependent.
    let ulp = f64::EPSILON / 4.0;
    for lower in [[-0.3, -0.3], [-0.3 - ulp, -0.3], [-0.3, -0.3 - ulp]] {
        let levels = vec![level(&[(&[1.0, -1.0], 0.0, 0.0)]), level(&[(&[1.0, 1.0], -2.0, -2.0)])];
        let mut symmetric = problem(2, levels);
        symmetric.lower.copy_from_slice(&lower);
        let mut solver = Solver::new();
        assert_eq!(solver.solve(&symmetric), Ok(Status::Solved));
        let bounds = solver.multipliers(1).bounds;
        assert!(bounds[0] < -2.0 && bounds[1] == 0.0, "lower bounds {lower:?}: multipliers {bounds:?}");
    }
}

/// Rounding moves an unknown along a row that all but holds it, down to its bound. The bound then holds it, too, when a level below drops the row.
#[test]
fn a_bound_that_depends_on_a_row_holds_once_that_row_is_dropped() {
    let rounding = 1e-12;
    let beside = |goal: f64, below: &[(&[f64], f64, f64)]| {
        let at_most: &[f64] = &[1.0, 0.0, rounding];
        let levels =
            vec![level(&[(at_most, f64::NEG_INFINITY, 0.0)]), level(&[(&[0.0, 0.0, 1.0], goal, goal)]), level(below)];
        Problem { lower: vec![0.0, -9.0, -9.0], ..problem(3, levels) }
    };
    let (mut solver, unknown) = (Solver::new(), [1.0, 0.0, 0.0]);
    let first = beside(0.0, &[(&unknown, 1.0, 1.0)]);
    assert_eq!(solver.solve(&first), Ok(Status::Solved));
    // The row is active now; the next goal moves the first unknown by 1e-12 below its bound.
    let next = beside(1.0, &[(&unknown, -1.0, -1.0), (&[1.0, 1.0, 0.0], 0.0, 0.0)]);
    assert_eq!(solver.solve_next(&next), Ok(Status::Solved));
    for (x, expected) in solver.solution().iter().zip([0.0, 0.0, 1.0]) {
        assert!((x - expected).abs() < 1e-9, "{:?}", solver.solution());
    }
}
