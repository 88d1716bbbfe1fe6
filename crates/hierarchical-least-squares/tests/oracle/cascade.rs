//! Solves a problem by a cascade of quadratic programs, each solved by Clarabel.
//!
//! A level minimises `|v|` with `lower <= A x - v <= upper`, the levels above unchanged: equations and rows with a residual keep
//! their values (they are eliminated: `x = x0 + Z y`), satisfied rows stay satisfied. Scales are in the objective, not in the
//! rows.

use crate::generator::{Draw, Row, matrix_of};
use crate::linear::{least_squares, null_space};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use nalgebra::{DMatrix, DVector};

/// A residual above this fixes the value of its row.
const KEPT: f64 = 1e-6;
/// A row whose part in the null space is below this does not change any more.
const STILL: f64 = 1e-9;

/// State of a cascade: a point, and the directions that the levels so far leave free.
pub struct Cascade<'a> {
    draw: &'a Draw,
    pub x: DVector<f64>,
    free: DMatrix<f64>,
    /// Satisfied rows, which must stay satisfied.
    holding: Vec<&'a Row>,
}

#[derive(Debug)]
pub enum CascadeError {
    /// Clarabel's status is not `Solved`.
    Unsolved,
    /// The fixed rows have no clear rank.
    Unclear,
}

impl<'a> Cascade<'a> {
    pub fn new(draw: &'a Draw) -> Self {
        let n = draw.n;
        let fixed: Vec<usize> = (0..n).filter(|i| draw.lower[*i] == draw.upper[*i]).collect();
        let loose: Vec<usize> = (0..n).filter(|i| !fixed.contains(i)).collect();
        let free = DMatrix::from_fn(n, loose.len(), |i, j| if loose[j] == i { 1.0 } else { 0.0 });
        let x = DVector::from_fn(n, |i, _| 0.0_f64.max(draw.lower[i]).min(draw.upper[i]));
        Self { draw, x, free, holding: vec![] }
    }

    /// Takes a level to its optimum, and returns its residuals (of rows before scaling).
    pub fn optimum(&mut self, k: usize) -> Result<Vec<f64>, CascadeError> {
        let rows = &self.draw.levels[k];
        if self.free.ncols() > 0 {
            let y = self.solve(rows)?;
            self.x += &self.free * y;
        }
        Ok(rows.iter().map(|row| row.outside(row.dot(&self.x))).collect())
    }

    /// Fixes the residuals of a level for the levels below.
    pub fn keep(&mut self, k: usize, residuals: &[f64]) -> Result<(), CascadeError> {
        let rows = &self.draw.levels[k];
        let kept = |i: usize| rows[i].equation() || residuals[i].abs() > KEPT;
        let matrix = matrix_of(self.draw.n, (0..rows.len()).filter(|i| kept(*i)).map(|i| &rows[i]));
        self.free = null_space(&matrix, &self.free, 1e-5, 1e-9).ok_or(CascadeError::Unclear)?;
        self.holding.extend((0..rows.len()).filter(|i| !kept(*i)).map(|i| &rows[i]));
        Ok(())
    }

    /// The step to the optimum of a level, by Clarabel, then polished.
    fn solve(&self, rows: &[Row]) -> Result<DVector<f64>, CascadeError> {
        let (p, m) = (self.free.ncols(), rows.len());
        // Where every residual can be zero, weights do not change the answer and spoil its digits.
        let largest = rows.iter().map(|row| row.scale).fold(0.0, f64::max);
        let weight = |row: &Row| if self.draw.conflicting { row.scale / largest } else { 1.0 };
        let weights: Vec<f64> = rows.iter().map(weight).collect();
        let lines = self.lines(rows);
        let equations = lines.iter().filter(|line| line.equation).count();
        let (mut places, mut columns, mut values) = (vec![], vec![], vec![]);
        for (at, line) in lines.iter().enumerate() {
            let entries = line.direction.iter().copied().enumerate();
            for (column, value) in entries.chain(line.residual.map(|i| (p + i, -line.sign))) {
                places.push(at);
                columns.push(column);
                values.push(value);
            }
        }
        let a = CscMatrix::new_from_triplets(lines.len(), p + m, places, columns, values);
        let right: Vec<f64> = lines.iter().map(|line| line.room).collect();
        let diagonal: Vec<usize> = (p..p + m).collect();
        let squares = weights.iter().map(|w| w * w).collect();
        let objective = CscMatrix::new_from_triplets(p + m, p + m, diagonal.clone(), diagonal, squares);
        let cones = [ZeroConeT(equations), NonnegativeConeT(lines.len() - equations)];
        let attempt = |tolerance: f64, regularization: f64| {
            let settings = DefaultSettings {
                verbose: false,
                tol_gap_abs: tolerance,
                tol_gap_rel: tolerance,
                tol_feas: 10.0 * tolerance,
                static_regularization_constant: regularization,
                max_threads: 1,
                ..DefaultSettings::default()
            };
            let mut solver = DefaultSolver::new(&objective, &vec![0.0; p + m], &a, &right, &cones, settings).unwrap();
            solver.solve();
            solver.solution
        };
        let mut answer = attempt(1e-12, 1e-10);
        if answer.status != SolverStatus::Solved {
            answer = attempt(1e-10, 1e-8);
        }
        if answer.status != SolverStatus::Solved {
            return Err(CascadeError::Unsolved);
        }
        let y = DVector::from_column_slice(&answer.x[..p]);
        let zero_multiplier = |i: usize, _: f64| lines[i].equation || answer.z[i] > answer.s[i];
        let near = |i: usize, room: f64| lines[i].equation || room < 1e-5;
        let y = polish(&lines, &weights, y, zero_multiplier);
        Ok(polish(&lines, &weights, y, near))
    }

    /// All constraints on a step `y`, equations first.
    fn lines(&self, rows: &[Row]) -> Vec<Line> {
        let mut lines = vec![];
        // A row that does not change must not change by rounding in its direction either, however long the step.
        let direction = |a: &[f64]| {
            let direction = self.free.tr_mul(&DVector::from_column_slice(a));
            if direction.norm() > STILL { direction } else { 0.0 * direction }
        };
        for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.equation()) {
            let room = row.upper - row.dot(&self.x);
            lines.push(Line { direction: direction(&row.a), sign: 1.0, residual: Some(i), room, equation: true });
        }
        let mut two_sided = |direction: DVector<f64>, at: f64, lower: f64, upper: f64, residual: Option<usize>| {
            if upper.is_finite() {
                let direction = direction.clone();
                lines.push(Line { direction, sign: 1.0, residual, room: upper - at, equation: false });
            }
            if lower.is_finite() {
                lines.push(Line { direction: -direction, sign: -1.0, residual, room: at - lower, equation: false });
            }
        };
        for (i, row) in rows.iter().enumerate().filter(|(_, row)| !row.equation()) {
            two_sided(direction(&row.a), row.dot(&self.x), row.lower, row.upper, Some(i));
        }
        for row in &self.holding {
            let g = direction(&row.a);
            if g.norm() > STILL {
                two_sided(g, row.dot(&self.x), row.lower, row.upper, None);
            }
        }
        for i in 0..self.draw.n {
            let g = self.free.row(i).transpose();
            if g.norm() > STILL {
                two_sided(g, self.x[i], self.draw.lower[i], self.draw.upper[i], None);
            }
        }
        lines
    }
}

/// `direction y - sign v <= room`, `v` the residual of a row of the level.
struct Line {
    direction: DVector<f64>,
    sign: f64,
    residual: Option<usize>,
    room: f64,
    equation: bool,
}

/// Moves an interior point exactly to the `active` limits, in the sense of least squares; the result counts if no violation and
/// no residual is larger than before.
fn polish(lines: &[Line], weights: &[f64], y: DVector<f64>, active: impl Fn(usize, f64) -> bool) -> DVector<f64> {
    let p = y.len();
    let room = |i: usize, y: &DVector<f64>| lines[i].room - lines[i].direction.dot(y);
    let (mut firm, mut soft) = (vec![], vec![]);
    for i in (0..lines.len()).filter(|i| active(*i, room(*i, &y))) {
        if lines[i].residual.is_some() { soft.push(i) } else { firm.push(i) }
    }
    if firm.is_empty() && soft.is_empty() {
        return y;
    }
    let weight = |i: usize| lines[i].residual.map_or(1.0, |row| weights[row]);
    let stack =
        |which: &[usize]| DMatrix::from_fn(which.len(), p, |i, j| weight(which[i]) * lines[which[i]].direction[j]);
    let rooms = |which: &[usize], y: &DVector<f64>| {
        DVector::from_iterator(which.len(), which.iter().map(|i| weight(*i) * room(*i, y)))
    };
    let hard = stack(&firm);
    let Some(free) = null_space(&hard, &DMatrix::identity(p, p), 1e-7, 1e-9) else { return y };
    let mut next = &y + least_squares(&hard, &rooms(&firm, &y), 1e-9);
    let step = least_squares(&(stack(&soft) * &free), &rooms(&soft, &next), 1e-13);
    next += free * step;
    // The largest violation of another level, and the objective of the level.
    let merit = |y: &DVector<f64>| {
        let (mut passed, mut sum) = (0.0_f64, 0.0);
        for (i, line) in lines.iter().enumerate() {
            let over = if line.equation { room(i, y) } else { room(i, y).min(0.0) };
            if line.residual.is_some() {
                sum += (weight(i) * over).powi(2);
            } else {
                passed = passed.max(-over);
            }
        }
        (passed, sum)
    };
    let (before, after) = (merit(&y), merit(&next));
    if after.0 <= before.0.max(1e-14) && after.1 <= before.1 * (1.0 + 1e-15) + 1e-30 { next } else { y }
}
