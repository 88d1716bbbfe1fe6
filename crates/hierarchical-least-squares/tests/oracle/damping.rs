//! Compares equations and damped levels with the recursion of Baerlocher & Boulic, with rows towards zero, and with the
//! optimality conditions.

use crate::conditions::{Answer, violations};
use crate::generator;
use crate::generator::{Draw, DrawOptions, Scaling, draw, empty_level, normal, random};
use crate::linear;
use crate::{SAME, Tally, all_problems, difference, largest, seed, unscaled};
use hierarchical_least_squares::{Problem, Solver, Status};
use nalgebra::{DMatrix, DVector};
use rand::RngExt;

/// Baerlocher & Boulic's recursion, each level in the null space of those above, singular values `s` inverted to
/// `s / (s^2 + damping^2)`. Returns the step after each level.
fn recursion(problem: &Problem) -> Vec<DVector<f64>> {
    let n = problem.unknowns();
    let (mut x, mut null) = (DVector::zeros(n), DMatrix::identity(n, n));
    let mut steps = vec![];
    for level in &problem.levels {
        let a = DMatrix::from_row_slice(level.rows(), n, &level.matrix);
        let projected = &a * &null;
        let largest = largest(a.iter().copied());
        let svd = linear::svd(&projected);
        let missing = DVector::from_column_slice(&level.upper) - &a * &x;
        for (i, &s) in svd.values.iter().enumerate().filter(|(_, s)| **s > 1e-9 * largest) {
            let v = svd.v.column(i);
            x += v * (s / (s * s + level.damping * level.damping) * svd.u.column(i).dot(&missing));
            null -= v * v.transpose();
        }
        steps.push(x.clone());
    }
    steps
}

/// Equations only, without bounds; each level scaled as a whole.
fn equations(seed: u64, index: usize) -> Draw {
    let scaling = Scaling::ByLevel;
    let options = DrawOptions { conflicting: index & 1 == 0, scaling, bounds: false, inequalities: false, largest: 60 };
    draw(&mut random(seed, index), options).0
}

#[test]
fn equations_alone_follow_the_recursion_of_baerlocher_and_boulic() {
    let seed = seed() ^ 2;
    let tally = all_problems(2000, |index, tally| {
        let draw = equations(seed, index);
        let problem = draw.problem();
        let mut solver = Solver::new();
        let status = solver.solve(&problem);
        if status != Ok(Status::Solved) {
            return Err(format!("{}: {status:?}", draw.describe()));
        }
        let expected = recursion(&problem).pop().unwrap();
        tally.worst = tally.worst.max(compare(&draw, &solver, &expected)?);
        Ok(())
    });
    tally.close();
}

/// Greatest difference of the solver's answer from `expected`, in `a x` and in residuals; an error beyond 1e-9.
fn compare(draw: &Draw, solver: &Solver, expected: &DVector<f64>) -> Result<f64, String> {
    let x = DVector::from_column_slice(solver.solution());
    let mut worst: f64 = 0.0;
    for (k, rows) in draw.levels.iter().enumerate() {
        for (row, residual) in rows.iter().zip(solver.residual(k)) {
            let value = (row.dot(&x) - row.dot(expected)).abs();
            let residual = (residual / row.scale - (row.dot(expected) - row.upper)).abs();
            worst = worst.max(value).max(residual);
            if worst.is_nan() || worst > 1e-9 {
                return Err(format!("{}: level {k} differs by {worst:.1e}", draw.describe()));
            }
        }
    }
    Ok(worst)
}

/// Damped levels take the damped step of the recursion in their own row space. The residuals of the levels above are those
/// without the damped level.
#[test]
fn damped_equations_follow_the_recursion_and_leave_levels_above_unchanged() {
    let seed = seed() ^ 3;
    let tally = all_problems(2000, |index, tally| {
        let draw = equations(seed, index);
        let mut problem = draw.problem();
        let rng = &mut random(seed, index + 1_000_000);
        for (level, rows) in problem.levels.iter_mut().zip(&draw.levels) {
            if rng.random_bool(0.5) {
                level.damping = rows[0].scale * generator::log_uniform(rng, 1e-3, 1.0);
            }
        }
        let mut solver = Solver::new();
        let status = solver.solve(&problem);
        if status != Ok(Status::Solved) {
            return Err(format!("{}: {status:?}", draw.describe()));
        }
        let steps = recursion(&problem);
        tally.worst = tally.worst.max(compare(&draw, &solver, steps.last().unwrap())?);
        let residuals: Vec<Vec<f64>> = (0..draw.levels.len()).map(|k| solver.residual(k).to_vec()).collect();
        for count in 1..draw.levels.len() {
            let mut above = problem.clone();
            above.levels.truncate(count);
            solver.solve(&above).map_err(|e| e.to_string())?;
            for (k, residuals) in residuals.iter().enumerate().take(count) {
                let change = difference(solver.residual(k), residuals) / draw.levels[k][0].scale;
                if change > 1e-10 {
                    return Err(format!(
                        "{}: level {k} changes with those below {count}: {change:.1e}",
                        draw.describe()
                    ));
                }
            }
        }
        Ok(())
    });
    tally.close();
}

/// With inequalities and bounds: a damped last level of full rank equals an undamped one with the rows `damping x = 0` beside
/// its own.
#[test]
fn damping_equals_rows_towards_zero() {
    let seed = seed() ^ 4;
    let tally = all_problems(1000, |index, tally| {
        let rng = &mut random(seed, index);
        let scaling = Scaling::ByLevel;
        let options =
            DrawOptions { conflicting: index & 1 == 0, scaling, bounds: true, inequalities: true, largest: 20 };
        let (draw, _) = draw(rng, options);
        let n = draw.n;
        let mut problem = draw.problem();
        problem.levels.truncate(2);
        let mut last = empty_level();
        let rotation = generator::orthonormal(rng, n);
        for direction in rotation.row_iter() {
            let a: Vec<f64> = direction.iter().map(|a| a * rng.random_range(0.9..1.1)).collect();
            let target = normal(rng);
            let upper = if rng.random_bool(0.5) { target } else { target + 1.0 };
            last.push(&a, target, upper);
        }
        // Equations only where inequalities could let go of a direction.
        last.upper.clone_from(&last.lower);
        let damping = generator::log_uniform(rng, 1e-3, 1.0);
        let mut stacked = last.clone();
        for i in 0..n {
            let unit: Vec<f64> = (0..n).map(|j| if i == j { damping } else { 0.0 }).collect();
            stacked.push(&unit, 0.0, 0.0);
        }
        last.damping = damping;
        let mut other = problem.clone();
        problem.levels.push(last);
        other.levels.push(stacked);
        let (mut solver, mut reference) = (Solver::new(), Solver::new());
        let statuses = (solver.solve(&problem), reference.solve(&other));
        if statuses != (Ok(Status::Solved), Ok(Status::Solved)) {
            return Err(format!("{}: {statuses:?}", draw.describe()));
        }
        let worst = difference(solver.solution(), reference.solution());
        tally.worst = tally.worst.max(worst);
        if worst > 1e-9 { Err(format!("{}: differs by {worst:.1e}", draw.describe())) } else { Ok(()) }
    });
    tally.close();
}

/// Damped levels between others, with inequalities, bounds and often a level of single unknowns at the end: every level
/// satisfies the optimality conditions in 32 digits of the problem that ends with it, the levels above do not change, nor does
/// any residual with another start. Half have so little damping that signs and residuals are rounding: those must converge,
/// with a gradient of the Lagrangian below 1e-10.
#[test]
fn damped_levels_are_optimal_from_any_start() {
    let seed = seed() ^ 8;
    let tally = all_problems(5000, |index, tally| {
        let rng = &mut random(seed, index);
        let options = DrawOptions {
            conflicting: index & 1 == 0,
            scaling: Scaling::ByLevel,
            bounds: index & 2 == 0,
            inequalities: true,
            largest: 40,
        };
        let (mut draw, _) = draw(rng, options);
        if index & 12 != 0 {
            draw.levels.push(rest(rng, draw.n));
        }
        let little = index & 16 != 0;
        let mut problem = draw.problem();
        for (k, rows) in draw.levels.iter().enumerate() {
            let damped = rng.random_bool(0.5) && (k + 1 < draw.levels.len() || index & 12 == 0);
            let (from, to) = if little { (1e-9, 1e-2) } else { (1e-2, 1.0) };
            problem.levels[k].damping =
                if damped { rows[0].scale * generator::log_uniform(rng, from, to) } else { 0.0 };
        }
        let mut moved = problem.clone();
        for level in &mut moved.levels {
            let shift = 0.1 * normal(rng) * largest(level.matrix.iter().copied());
            level.lower.iter_mut().chain(&mut level.upper).for_each(|side| *side += shift);
        }
        let about = |what: String| Err(format!("{}: {what}", draw.describe()));
        let mut warm = Solver::new();
        let mut known: Vec<Vec<f64>> = vec![];
        for count in 1..=problem.levels.len() {
            let mut part = problem.clone();
            part.levels.truncate(count);
            let mut other = moved.clone();
            other.levels.truncate(count);
            for start in 0..3 {
                if start != 2 {
                    warm.solve(&other).map_err(|e| e.to_string())?;
                }
                let status = match start {
                    0 => warm.solve(&part),
                    _ => warm.solve_next(&part),
                };
                if status != Ok(Status::Solved) {
                    return about(format!("{count} levels, start {start}: {status:?}"));
                }
                let answer = Answer::of(&warm, count);
                let seen = violations(&part, &draw.scales()[..count], &answer);
                let fine = if little { seen.bounds == 0.0 && seen.stationarity < 1e-10 } else { seen.are_rounding() };
                if !fine {
                    return about(format!("{count} levels, start {start}: {seen:?}"));
                }
                if little {
                    continue;
                }
                tally.violations.largest(&seen);
                let residuals = unscaled(&draw, &answer.residuals);
                if start == 0 && known.len() < count {
                    known.push(residuals[count - 1].clone());
                }
                for (k, (residuals, known)) in residuals.iter().zip(&known).enumerate() {
                    let worst = difference(residuals, known);
                    if worst > SAME {
                        return about(format!("level {k} of {count}, start {start}: differs by {worst:.1e}"));
                    }
                    tally.worst = tally.worst.max(worst);
                }
            }
        }
        Ok(())
    });
    tally.close();
}

/// The steps of a trust region. In the first problem the same changes of the working set once followed each other without end.
#[test]
fn steps_within_small_bounds_are_solved() {
    small_bounds(7 ^ 32, 1318, &mut Tally::default()).unwrap();
    let seed = seed() ^ 32;
    let tally = all_problems(2000, |index, tally| small_bounds(seed, index, tally));
    tally.close();
}

/// Every unknown within the same small bounds, and levels far from their targets, so that most unknowns are at a bound and more constraints are
/// active than are independent: every level satisfies the optimality conditions, also from the working set of the problem with other bounds.
fn small_bounds(seed: u64, index: usize, tally: &mut Tally) -> Result<(), String> {
    let rng = &mut random(seed, index);
    let (scaling, inequalities) = (Scaling::ByLevel, index & 1 == 0);
    let options = DrawOptions { conflicting: true, scaling, bounds: false, inequalities, largest: 60 };
    let (mut draw, _) = draw(rng, options);
    draw.levels.push(rest(rng, draw.n));
    let mut problem = draw.problem();
    for (k, rows) in draw.levels.iter().enumerate() {
        let damped = k > 0 && k + 1 < draw.levels.len();
        problem.levels[k].damping = if damped { rows[0].scale * generator::log_uniform(rng, 1e-2, 1.0) } else { 0.0 };
    }
    let about = |what: String| Err(format!("{}: {what}", draw.describe()));
    let mut solver = Solver::new();
    for _ in 0..4 {
        let most = generator::log_uniform(rng, 1e-7, 1e-1);
        problem.lower.fill(-most);
        problem.upper.fill(most);
        let status = solver.solve_next(&problem);
        if status != Ok(Status::Solved) {
            return about(format!("within {most:.1e}: {status:?} after {} changes", solver.changes()));
        }
        let seen = violations(&problem, &draw.scales(), &Answer::of(&solver, problem.levels.len()));
        if !seen.are_rounding() {
            return about(format!("within {most:.1e}: {seen:?}"));
        }
        tally.violations.largest(&seen);
    }
    Ok(())
}

/// Equations for most single unknowns, all with the same weight.
fn rest(rng: &mut rand_pcg::Pcg64, n: usize) -> Vec<generator::Row> {
    let unknowns = (0..n).filter(|_| rng.random_range(0..8) > 0).collect::<Vec<_>>();
    let asked = unknowns.into_iter().map(|i| {
        let side = normal(rng);
        let a = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        generator::Row { a, lower: side, upper: side, scale: 1.0 }
    });
    asked.collect()
}

/// A planar chain of three links keeps the direction of its last link; its end moves towards a point out of reach. In the
/// straight chain no row contains the direction towards the point: undamped steps grow without limit, damped ones do not.
#[test]
fn damped_steps_towards_a_point_out_of_reach_stay_short() {
    let walk = |damping: f64| {
        let mut angles = [0.4_f64, 0.5, -0.2];
        let direction: f64 = angles.iter().sum();
        let (mut longest, mut distance): (f64, f64) = (0.0, 0.0);
        let mut solver = Solver::new();
        for _ in 0..300 {
            let (mut a, mut sum) = ([0.0; 3], 0.0);
            for (a, angle) in a.iter_mut().zip(angles) {
                sum += angle;
                *a = sum;
            }
            let end = a.iter().fold((0.0, 0.0), |(x, y), &a| (x + libm::cos(a), y + libm::sin(a)));
            let mut reach = empty_level();
            let missing = (4.0 * libm::cos(0.8_) - end.0, 4.0 * libm::sin(0.8_) - end.1);
            let x: Vec<f64> = (0..3).map(|i| -a[i..].iter().map(|&a| libm::sin(a)).sum::<f64>()).collect();
            let y: Vec<f64> = (0..3).map(|i| a[i..].iter().map(|&a| libm::cos(a)).sum::<f64>()).collect();
            reach.push(&x, missing.0, missing.0);
            reach.push(&y, missing.1, missing.1);
            reach.damping = damping;
            let mut last_link = empty_level();
            last_link.push(&[1.0; 3], direction - a[2], direction - a[2]);
            let mut problem = Problem::new(3);
            problem.levels = vec![last_link, reach];
            assert_eq!(solver.solve(&problem), Ok(Status::Solved));
            assert!(solver.residual_norm(0) < 1e-12);
            let step = solver.solution();
            longest = longest.max(step.iter().map(|s| s * s).sum::<f64>().sqrt());
            for (angle, step) in angles.iter_mut().zip(step) {
                *angle += step;
            }
            assert!((angles.iter().sum::<f64>() - direction).abs() < 1e-9);
            distance = libm::hypot(missing.0, missing.1);
        }
        (longest, distance)
    };
    let (damped, undamped) = (walk(0.5), walk(0.0));
    println!("longest step and distance left: damped {damped:?}, undamped {undamped:?}");
    assert!(damped.0 < 2.0 && undamped.0 > 5.0);
    // Two straight links in the direction of the target are the nearest the end can come.
    assert!((damped.1 - nearest(0.7)).abs() < 1e-3, "{} {}", damped.1, nearest(0.7));
}

/// The least distance of two links from the point at 4 in direction 0.8, from the third link fixed in `direction`.
fn nearest(direction: f64) -> f64 {
    let (x, y) = (4.0 * libm::cos(0.8_) - libm::cos(direction), 4.0 * libm::sin(0.8_) - libm::sin(direction));
    libm::hypot(x, y) - 2.0
}
