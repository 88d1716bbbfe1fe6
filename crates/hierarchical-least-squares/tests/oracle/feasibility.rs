//! Checks hard levels: certificates of infeasibility, and the level that a status names.

use crate::conditions::{RESIDUAL, products, residual};
use crate::double_double::Double;
use crate::generator::{DrawOptions, Scaling, draw, random};
use crate::{all_problems, largest, seed};
use hierarchical_least_squares::{Problem, Solver, Status};

#[test]
fn infeasible_hard_first_level_has_a_certificate() {
    let seed = seed() ^ 5;
    let impossible = std::sync::atomic::AtomicUsize::new(0);
    let tally = all_problems(2000, |index, _| {
        let scaling = Scaling::ByLevel;
        let options =
            DrawOptions { conflicting: true, scaling, bounds: index & 1 == 0, inequalities: true, largest: 60 };
        let (draw, _) = draw(&mut random(seed, index), options);
        let mut problem = draw.problem();
        problem.levels[0].hard = true;
        let mut solver = Solver::new();
        let status = solver.solve(&problem).map_err(|e| e.to_string())?;
        let scale = draw.levels[0][0].scale;
        match status {
            Status::Solved => {
                let level = &problem.levels[0];
                let values = products(&problem, 0, solver.solution()).into_iter().zip(&level.lower).zip(&level.upper);
                let left = largest(values.map(|((value, lower), upper)| residual(value, *lower, *upper).value()));
                if left > RESIDUAL * scale {
                    return Err(format!("{}: status Solved, residual {left:.1e}", draw.describe()));
                }
            }
            Status::Infeasible { level: 0 } => {
                impossible.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                let bounds = solver.multipliers(0).bounds;
                let reach = no_solution_within(&problem, solver.residual(0), bounds);
                if reach.is_nan() || reach < 1e6 {
                    return Err(format!("{}: excludes solutions up to {reach:.1e} only", draw.describe()));
                }
            }
            other => return Err(format!("{}: {other:?}", draw.describe())),
        }
        Ok(())
    });
    println!("impossible: {impossible:?}");
    assert!(impossible.into_inner() > 300);
    tally.close();
}

/// Farkas: were there an `x` between the bounds with `lower <= A x <= upper`, then
/// `y A x + z x <= sum of y_i (its upper side, or lower where y_i < 0) + the same of z`, for any `y`, `z`. With
/// `A^T y + z = 0` the left is zero, and the right is negative: there is none. Rounding leaves a little of the left; so no
/// `x` of a sum of sizes below what is returned.
fn no_solution_within(problem: &Problem, y: &[f64], z: &[f64]) -> f64 {
    let n = problem.unknowns();
    let level = &problem.levels[0];
    let side = |factor: f64, lower: f64, upper: f64| if factor > 0.0 { upper } else { lower };
    let mut left = vec![Double::ZERO; n];
    let mut right = Double::ZERO;
    for ((y, lower), upper) in y.iter().zip(&level.lower).zip(&level.upper).filter(|((y, _), _)| **y != 0.0) {
        right += Double::product(*y, side(*y, *lower, *upper));
    }
    for (((z, lower), upper), left) in z.iter().zip(&problem.lower).zip(&problem.upper).zip(&mut left) {
        // A multiplier of a limit that does not exist is rounding: taken as zero.
        let side = side(*z, *lower, *upper);
        if side.is_finite() {
            right += Double::product(*z, side);
            *left = Double::from(*z);
        }
    }
    for (a, y) in level.matrix.chunks(n).zip(y) {
        for (left, a) in left.iter_mut().zip(a) {
            *left += Double::product(*a, *y);
        }
    }
    -right.value() / largest(left.iter().map(|l| l.value())).max(f64::MIN_POSITIVE)
}

/// With all levels hard, the status names the first one with a residual.
#[test]
fn first_infeasible_hard_level_is_named() {
    let seed = seed() ^ 6;
    let tally = all_problems(1000, |index, tally| {
        let scaling = if index & 2 == 0 { Scaling::ByLevel } else { Scaling::ByRow };
        let options =
            DrawOptions { conflicting: index & 1 == 0, scaling, bounds: true, inequalities: true, largest: 40 };
        let (draw, _) = draw(&mut random(seed, index), options);
        tally.conflicting += usize::from(draw.conflicting);
        let mut problem = draw.problem();
        for level in &mut problem.levels {
            level.hard = true;
        }
        let mut solver = Solver::new();
        let status = solver.solve(&problem).map_err(|e| e.to_string())?;
        let failed = problem.levels.iter().enumerate().position(|(k, level)| {
            let sides = level.lower.iter().zip(&level.upper).zip(&draw.levels[k]);
            let values = products(&problem, k, solver.solution());
            let left = values.into_iter().zip(sides);
            largest(left.map(|(v, ((l, u), row))| residual(v, *l, *u).value() / row.scale)) > RESIDUAL
        });
        let expected = failed.map_or(Status::Solved, |level| Status::Infeasible { level });
        if !draw.conflicting && expected != Status::Solved {
            return Err(format!("{}: feasible, but {expected:?}", draw.describe()));
        }
        if status == expected { Ok(()) } else { Err(format!("{}: {status:?}, not {expected:?}", draw.describe())) }
    });
    tally.close();
}
