//! Solves small linear programs with bounds: maximise `c x` subject to `A x = b` and `0 <= x <= u`.
//!
//! Primal simplex method in two phases on a dense tableau, for bounded variables (Dantzig 1955; recalled); the variable that enters is that
//! of the largest reduced cost, and the first one after many steps without progress (Bland 1977; recalled), so that no cycle goes on. At the
//! end unknowns and multipliers are computed anew from the basis, which removes the rounding of the steps. Equations that cannot be
//! met keep the residual of the least sum of sizes.

use nalgebra::{DMatrix, DVector};

use tolerances::{LEAST_PIVOT, REDUCED_COST, SIMPLEX_STEPS, STEPS_TO_BLAND};

mod replaced_column;
mod tolerances;

/// The place of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Lower,
    Upper,
    Basic,
}

/// The equations and bounds of a program, and its present basis.
#[derive(Clone, Debug)]
pub(crate) struct LinearProgram {
    rows: usize,
    unknowns: usize,
    /// `A`, row after row, and `b`; `b` less the residual that cannot be avoided once the program is feasible.
    matrix: Vec<f64>,
    right: Vec<f64>,
    /// `u`, then the bounds of one artificial unknown a row.
    upper: Vec<f64>,
    /// Sign of each artificial unknown in its row.
    signs: Vec<f64>,
    /// Rows of `B^-1 [A, artificial]`.
    tableau: Vec<f64>,
    basis: Vec<usize>,
    values: Vec<f64>,
    places: Vec<Place>,
    /// Reduced costs.
    reduced: Vec<f64>,
    /// Least sum of the sizes of residuals of the equations.
    residual: f64,
}

/// A greatest value.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Optimum {
    /// `c x`.
    pub(crate) value: f64,
    /// Value of the dual program less that.
    pub(crate) gap: f64,
    /// The unknowns.
    pub(crate) unknowns: Vec<f64>,
    /// Multipliers of the equations: how much the value grows with each right side.
    pub(crate) multipliers: Vec<f64>,
}

impl LinearProgram {
    /// The program of a matrix, row after row, with the basis of a feasible point (phase 1).
    pub(crate) fn new(matrix: Vec<f64>, right: Vec<f64>, upper: &[f64]) -> Self {
        let (rows, unknowns) = (right.len(), upper.len());
        let signs: Vec<f64> = right.iter().map(|b| if *b < 0.0 { -1.0 } else { 1.0 }).collect();
        let width = unknowns + rows;
        let mut tableau = vec![0.0; rows * width];
        for row in 0..rows {
            let line = &mut tableau[row * width..(row + 1) * width];
            for (entry, a) in line.iter_mut().zip(&matrix[row * unknowns..]).take(unknowns) {
                *entry = signs[row] * a;
            }
            line[unknowns + row] = 1.0;
        }
        let mut program = Self {
            rows,
            unknowns,
            values: right.iter().map(|b| b.abs()).collect(),
            matrix,
            right,
            upper: upper.iter().copied().chain(std::iter::repeat_n(f64::INFINITY, rows)).collect(),
            signs,
            tableau,
            basis: (unknowns..width).collect(),
            places: (0..width).map(|j| if j < unknowns { Place::Lower } else { Place::Basic }).collect(),
            reduced: vec![0.0; width],
            residual: 0.0,
        };
        let artificial: Vec<f64> = (0..width).map(|j| if j < unknowns { 0.0 } else { -1.0 }).collect();
        program.climb(&artificial);
        program.settle();
        program
    }

    /// Least sum of the sizes of residuals of the equations; 0 where they can be met.
    pub(crate) fn residual(&self) -> f64 {
        self.residual
    }

    /// Moves what the equations miss to their right side and fixes all artificial unknowns at zero.
    fn settle(&mut self) {
        for row in 0..self.rows {
            if let Some(artificial) = self.basis[row].checked_sub(self.unknowns) {
                let missed = std::mem::take(&mut self.values[row]);
                self.residual += missed;
                self.right[artificial] -= self.signs[artificial] * missed;
            }
        }
        self.upper[self.unknowns..].fill(0.0);
    }

    /// The greatest value of `cost x`, from the present basis.
    pub(crate) fn maximise(&mut self, cost: &[f64]) -> Optimum {
        let all: Vec<f64> = cost.iter().copied().chain(std::iter::repeat_n(0.0, self.rows)).collect();
        self.climb(&all);
        self.optimum(&all)
    }

    /// Steps of the simplex method until no unknown can raise the value.
    fn climb(&mut self, cost: &[f64]) {
        self.reduce(cost);
        let greatest = cost.iter().fold(0.0f64, |greatest, c| greatest.max(c.abs()));
        for step in 0..SIMPLEX_STEPS {
            let Some(entering) = self.entering(REDUCED_COST * greatest, step > STEPS_TO_BLAND) else { return };
            self.enter(entering);
        }
    }

    /// The reduced costs of the present basis.
    fn reduce(&mut self, cost: &[f64]) {
        let width = self.unknowns + self.rows;
        self.reduced.copy_from_slice(cost);
        for (row, &basic) in self.basis.iter().enumerate() {
            let line = &self.tableau[row * width..(row + 1) * width];
            if cost[basic] != 0.0 {
                self.reduced.iter_mut().zip(line).for_each(|(d, t)| *d -= cost[basic] * t);
            }
        }
    }

    /// The unknown that raises the value: that of the largest reduced cost, or the first.
    fn entering(&self, least: f64, first: bool) -> Option<usize> {
        let gain = |j: usize| match self.places[j] {
            Place::Lower if self.upper[j] > 0.0 => self.reduced[j],
            Place::Upper => -self.reduced[j],
            _ => 0.0,
        };
        let mut gains = (0..self.places.len()).filter(|&j| gain(j) > least);
        if first { gains.next() } else { gains.max_by(|&a, &b| gain(a).total_cmp(&gain(b))) }
    }

    /// Moves an unknown from its bound as far as the others allow.
    fn enter(&mut self, entering: usize) {
        let width = self.unknowns + self.rows;
        let sign = if self.places[entering] == Place::Lower { 1.0 } else { -1.0 };
        let mut way = self.upper[entering];
        let mut leaving: Option<(usize, Place, f64)> = None;
        for row in 0..self.rows {
            let pivot = self.tableau[row * width + entering];
            if pivot.abs() < LEAST_PIVOT {
                continue;
            }
            let falls = sign * pivot > 0.0;
            let room = if falls { self.values[row] } else { self.upper[self.basis[row]] - self.values[row] };
            let limit = room.max(0.0) / pivot.abs();
            let same = limit == way && leaving.is_some_and(|(_, _, size)| pivot.abs() > size);
            if limit < way || same {
                way = limit;
                leaving = Some((row, if falls { Place::Lower } else { Place::Upper }, pivot.abs()));
            }
        }
        for row in 0..self.rows {
            self.values[row] -= sign * way * self.tableau[row * width + entering];
        }
        let Some((row, place, _)) = leaving else {
            self.places[entering] = if sign > 0.0 { Place::Upper } else { Place::Lower };
            return;
        };
        let from = if sign > 0.0 { 0.0 } else { self.upper[entering] };
        self.places[self.basis[row]] = place;
        self.places[entering] = Place::Basic;
        self.basis[row] = entering;
        self.values[row] = from + sign * way;
        self.pivot(row, entering);
    }

    /// Makes the column of an unknown a unit vector.
    fn pivot(&mut self, row: usize, entering: usize) {
        let width = self.unknowns + self.rows;
        let inverse = 1.0 / self.tableau[row * width + entering];
        self.tableau[row * width..(row + 1) * width].iter_mut().for_each(|entry| *entry *= inverse);
        let line = self.tableau[row * width..(row + 1) * width].to_vec();
        let clear = |other: &mut [f64]| {
            let share = other[entering];
            if share != 0.0 {
                other.iter_mut().zip(&line).for_each(|(entry, a)| *entry -= share * a);
            }
        };
        self.tableau.chunks_exact_mut(width).enumerate().filter(|(other, _)| *other != row).for_each(|(_, l)| clear(l));
        clear(&mut self.reduced);
    }

    /// Unknowns and multipliers computed from the basis, and the gap between them.
    fn optimum(&self, cost: &[f64]) -> Optimum {
        let column = |j: usize, row: usize| match j.checked_sub(self.unknowns) {
            None => self.matrix[row * self.unknowns + j],
            Some(artificial) if artificial == row => self.signs[row],
            Some(_) => 0.0,
        };
        let mut unknowns: Vec<f64> =
            (0..self.unknowns).map(|j| if self.places[j] == Place::Upper { self.upper[j] } else { 0.0 }).collect();
        let rest = |row: usize| {
            let line = &self.matrix[row * self.unknowns..(row + 1) * self.unknowns];
            self.right[row] - line.iter().zip(&unknowns).map(|(a, x)| a * x).sum::<f64>()
        };
        let basic = DMatrix::from_fn(self.rows, self.rows, |row, k| column(self.basis[k], row));
        let right = DVector::from_fn(self.rows, |row, _| rest(row));
        let of_basis = DVector::from_fn(self.rows, |k, _| cost[self.basis[k]]);
        let values = solved(basic.clone(), &right).unwrap_or_else(|| DVector::from_column_slice(&self.values));
        let multipliers = solved(basic.transpose(), &of_basis);
        for (&j, value) in self.basis.iter().zip(values.iter()).filter(|(j, _)| **j < self.unknowns) {
            unknowns[j] = value.max(0.0).min(self.upper[j]);
        }
        let value = cost.iter().zip(&unknowns).map(|(c, x)| c * x).sum();
        let dual = multipliers.as_ref().map_or(f64::INFINITY, |y| {
            let of_rows: f64 = y.iter().zip(&self.right).map(|(y, b)| y * b).sum();
            let of_bounds = (0..self.unknowns).map(|j| {
                let priced: f64 = (0..self.rows).map(|row| y[row] * column(j, row)).sum();
                self.upper[j] * (cost[j] - priced).max(0.0)
            });
            of_rows + of_bounds.sum::<f64>()
        });
        let multipliers = multipliers.map_or_else(|| vec![0.0; self.rows], |y| y.as_slice().to_vec());
        Optimum { value, gap: dual - value, unknowns, multipliers }
    }
}

/// The solution of square equations; `None` where they determine none.
fn solved(matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    if right.is_empty() {
        return Some(DVector::zeros(0));
    }
    matrix.lu().solve(right).filter(|values| values.iter().all(|x| x.is_finite()))
}

#[cfg(test)]
mod tests;
