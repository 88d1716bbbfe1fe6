//! Tests linear programs against all their vertices, against an independent solver, and their gap.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, ZeroConeT};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;

fn random() -> Pcg64 {
    println!("linear programs: seed 20261122");
    Pcg64::seed_from_u64(20_261_122)
}

/// Equations that some point inside the bounds meets; some entries are zero, so that vertices are degenerate.
fn feasible(rng: &mut Pcg64, rows: usize, unknowns: usize) -> (Vec<f64>, Vec<f64>) {
    let matrix: Vec<f64> = (0..rows * unknowns)
        .map(|_| if rng.random_range(0.0..1.0) < 0.3 { 0.0 } else { rng.random_range(-1.0..1.0) })
        .collect();
    let inside: Vec<f64> = (0..unknowns).map(|_| f64::from(rng.random_range(0..3u8)) / 2.0).collect();
    let right = matrix.chunks(unknowns).map(|row| row.iter().zip(&inside).map(|(a, x)| a * x).sum()).collect();
    (matrix, right)
}

/// Greatest value over all vertices: some unknowns at bounds, the others solved for; `None` without any.
fn over_vertices(matrix: &[f64], right: &[f64], cost: &[f64]) -> Option<f64> {
    let (rows, unknowns) = (right.len(), cost.len());
    let mut best: Option<f64> = None;
    for code in 0..3usize.pow(u32::try_from(unknowns).ok()?) {
        let digits: Vec<usize> = (0..unknowns).map(|j| code / 3usize.pow(j as u32) % 3).collect();
        let free: Vec<usize> = (0..unknowns).filter(|&j| digits[j] == 2).collect();
        if free.len() > rows {
            continue;
        }
        let mut x: Vec<f64> = digits.iter().map(|&d| if d == 1 { 1.0 } else { 0.0 }).collect();
        let at = |x: &[f64], row: usize| -> f64 { (0..unknowns).map(|j| matrix[row * unknowns + j] * x[j]).sum() };
        let rest = DVector::from_fn(rows, |row, _| right[row] - at(&x, row));
        let columns = DMatrix::from_fn(rows, free.len(), |row, k| matrix[row * unknowns + free[k]]);
        if !free.is_empty() {
            let Ok(solved) = columns.svd(true, true).solve(&rest, 1e-9) else { continue };
            free.iter().zip(solved.iter()).for_each(|(&j, value)| x[j] = *value);
        }
        let meets = (0..rows).all(|row| (at(&x, row) - right[row]).abs() < 1e-9);
        if meets && x.iter().all(|x| (-1e-9..=1.0 + 1e-9).contains(x)) {
            let value = cost.iter().zip(&x).map(|(c, x)| c * x).sum::<f64>();
            best = Some(best.map_or(value, |best: f64| best.max(value)));
        }
    }
    best
}

#[test]
fn small_programs_reach_the_best_of_all_vertices() {
    let mut rng = random();
    for number in 0..300 {
        let (rows, unknowns) = (rng.random_range(1..4usize), rng.random_range(3..7usize));
        let (matrix, right) = feasible(&mut rng, rows, unknowns);
        let cost: Vec<f64> = (0..unknowns).map(|_| rng.random_range(-1.0..1.0)).collect();
        let mut program = LinearProgram::new(matrix.clone(), right.clone(), &vec![1.0; unknowns]);
        assert!(program.residual() < 1e-9, "{number}: {}", program.residual());
        let found = program.maximise(&cost);
        let best = over_vertices(&matrix, &right, &cost).unwrap();
        assert!((found.value - best).abs() < 1e-9 && found.gap.abs() < 1e-9, "{number}: {found:?} for {best}");
        let least = program.maximise(&cost.iter().map(|c| -c).collect::<Vec<_>>());
        let worst = -over_vertices(&matrix, &right, &cost.iter().map(|c| -c).collect::<Vec<_>>()).unwrap();
        assert!((-least.value - worst).abs() < 1e-9, "{number}: {least:?} for {worst}");
    }
}

/// The value of an interior-point method.
fn by_interior_point(matrix: &[f64], right: &[f64], cost: &[f64]) -> f64 {
    let (rows, n) = (right.len(), cost.len());
    let line = |row: usize, j: usize| match row {
        row if row < rows => matrix[row * n + j],
        row if row < rows + n => {
            if row - rows == j {
                1.0
            } else {
                0.0
            }
        }
        row => {
            if row - rows - n == j {
                -1.0
            } else {
                0.0
            }
        }
    };
    let dense: Vec<Vec<f64>> = (0..rows + 2 * n).map(|row| (0..n).map(|j| line(row, j)).collect()).collect();
    let a = CscMatrix::from(&dense);
    let b: Vec<f64> = right.iter().copied().chain(vec![1.0; n]).chain(vec![0.0; n]).collect();
    let q: Vec<f64> = cost.iter().map(|c| -c).collect();
    let cones = [ZeroConeT(rows), NonnegativeConeT(2 * n)];
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let mut solver = DefaultSolver::new(&CscMatrix::zeros((n, n)), &q, &a, &b, &cones, settings).unwrap();
    solver.solve();
    cost.iter().zip(&solver.solution.x).map(|(c, x)| c * x).sum()
}

#[test]
fn programs_of_the_size_of_a_body_have_no_gap_and_agree_with_an_interior_point_method() {
    let mut rng = random();
    for number in 0..40 {
        let (matrix, right) = feasible(&mut rng, 20, 90);
        let cost: Vec<f64> = (0..90).map(|_| rng.random_range(-1.0..1.0)).collect();
        let mut program = LinearProgram::new(matrix.clone(), right.clone(), &[1.0; 90]);
        let found = program.maximise(&cost);
        assert!(program.residual() < 1e-9 && found.gap.abs() < 1e-9, "{number}: {}", found.gap);
        let theirs = by_interior_point(&matrix, &right, &cost);
        assert!((found.value - theirs).abs() < 1e-6, "{number}: {} for {theirs}", found.value);
        for (row, b) in matrix.chunks(90).zip(&right) {
            let off = row.iter().zip(&found.unknowns).map(|(a, x)| a * x).sum::<f64>() - b;
            assert!(off.abs() < 1e-9, "{number}: {off}");
        }
    }
}

#[test]
fn equations_out_of_reach_keep_the_least_residual() {
    // x + y = 3 with both at most 1 misses by 1; x - y = 0 is met.
    let mut program = LinearProgram::new(vec![1.0, 1.0, 1.0, -1.0], vec![3.0, 0.0], &[1.0, 1.0]);
    assert!((program.residual() - 1.0).abs() < 1e-12);
    let found = program.maximise(&[1.0, 0.0]);
    assert!((found.value - 1.0).abs() < 1e-12 && found.gap.abs() < 1e-12, "{found:?}");
}

#[test]
fn a_program_without_equations_takes_every_bound_that_pays() {
    let found = LinearProgram::new(vec![], vec![], &[1.0, 2.0, 3.0]).maximise(&[1.0, -1.0, 2.0]);
    assert_eq!((found.value, found.gap, found.unknowns), (7.0, 0.0, vec![1.0, 0.0, 3.0]));
}

#[test]
fn a_replaced_column_gives_the_optimum_of_a_program_built_with_it() {
    let mut rng = random();
    let (mut warm, mut cold, mut slopes) = (0, 0, 0);
    for number in 0..100 {
        let (rows, unknowns) = (rng.random_range(2..9usize), rng.random_range(8..30usize));
        // The last unknown alone has a cost; with it at zero the program is feasible.
        let (mut matrix, right) = feasible(&mut rng, rows, unknowns);
        let mut column: Vec<f64> = (0..rows).map(|_| rng.random_range(-1.0..1.0)).collect();
        let mut upper = vec![1.0; unknowns];
        matrix = matrix.chunks(unknowns).flat_map(|row| row.iter().copied().chain([0.0])).collect();
        upper.push(1e3);
        let cost: Vec<f64> = (0..=unknowns).map(|j| if j == unknowns { 1.0 } else { 0.0 }).collect();
        let base = LinearProgram::new(matrix.clone(), right.clone(), &upper);
        assert!(base.residual() < 1e-9, "{number}");
        let mut program = base.clone();
        for turn in 0..30 {
            column.iter_mut().for_each(|entry| *entry += rng.random_range(-0.2..0.2));
            for (row, entry) in column.iter().enumerate() {
                matrix[row * (unknowns + 1) + unknowns] = *entry;
            }
            let found = program.maximise_with_column(&cost, unknowns, &column).inspect(|_| warm += 1);
            let found = found.unwrap_or_else(|| {
                cold += 1;
                program = base.clone();
                program.maximise_with_column(&cost, unknowns, &column).unwrap()
            });
            let anew = LinearProgram::new(matrix.clone(), right.clone(), &upper).maximise(&cost);
            assert!(
                (found.value - anew.value).abs() < 1e-9 * (1.0 + anew.value),
                "{number} {turn}: {} {}",
                found.value,
                anew.value
            );
            assert!(found.gap.abs() < 1e-9 * (1.0 + found.value), "{number} {turn}: {}", found.gap);
            // The value is concave in the right side, with the multipliers as slope.
            let (row, by) = (rng.random_range(0..rows), rng.random_range(-1e-2..1e-2));
            let mut moved = right.clone();
            moved[row] += by;
            let mut other = LinearProgram::new(matrix.clone(), moved, &upper);
            if other.residual() < 1e-12 {
                slopes += 1;
                let bound = found.value + by * found.multipliers[row];
                let value = other.maximise(&cost).value;
                assert!(value <= bound + 1e-9 * (1.0 + bound.abs()), "{number} {turn}: {value} above {bound}");
            }
        }
    }
    println!("{warm} from the basis before, {cold} anew");
    assert!(cold < warm / 4 && slopes > 1000, "{cold} of {warm}; {slopes} slopes");
}
