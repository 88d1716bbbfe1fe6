//! Replaces a column of a solved linear program and goes from its basis to the new optimum.
//!
//! A column whose unknown alone has a cost keeps the signs of all other reduced costs when it is replaced (they are scaled by one number),
//! so that the basis stays dual feasible: steps of the dual simplex method for bounded variables (Lemke 1954, Wagner 1958; recalled) put
//! the values back inside their bounds. A program of the next direction of a sweep needs few of them, often none.

use super::tolerances::{DUAL_STEPS, INSIDE, LEAST_PIVOT, REDUCED_COST};
use super::{LinearProgram, Optimum, Place};

impl LinearProgram {
    /// The greatest value of `cost x` with another column of the matrix for one unknown. `None` where the present basis does not lead
    /// to it: the caller then starts from a basis that is feasible with that unknown at zero.
    ///
    /// # Panics
    /// Unless `column` has an entry for every equation.
    pub(crate) fn maximise_with_column(&mut self, cost: &[f64], unknown: usize, column: &[f64]) -> Option<Optimum> {
        self.replace_column(unknown, column);
        if let Some(row) = self.basis.iter().position(|basic| *basic == unknown) {
            let pivot = self.tableau[row * (self.unknowns + self.rows) + unknown];
            if pivot.abs() < LEAST_PIVOT {
                return None;
            }
            self.pivot(row, unknown);
        }
        self.update_values();
        let all: Vec<f64> = cost.iter().copied().chain(std::iter::repeat_n(0.0, self.rows)).collect();
        self.reduce(&all);
        if !self.put_inside(&all) {
            return None;
        }
        self.climb(&all);
        Some(self.optimum(&all))
    }

    /// Writes a column into the matrix, and `B^-1` times it into the tableau.
    pub(crate) fn replace_column(&mut self, unknown: usize, column: &[f64]) {
        assert_eq!(column.len(), self.rows, "an entry for every equation");
        let width = self.unknowns + self.rows;
        for (row, entry) in column.iter().enumerate() {
            self.matrix[row * self.unknowns + unknown] = *entry;
        }
        for line in self.tableau.chunks_exact_mut(width) {
            // The columns of the artificial unknowns are B^-1 up to their signs.
            let of_inverse = line[self.unknowns..].iter().zip(&self.signs).zip(column);
            line[unknown] = of_inverse.map(|((inverse, sign), entry)| inverse * sign * entry).sum();
        }
    }

    /// Values of the basic unknowns from the right side and the unknowns at their upper bounds.
    fn update_values(&mut self) {
        let mut rest = self.right.clone();
        for j in (0..self.unknowns).filter(|&j| self.places[j] == Place::Upper) {
            for (row, rest) in rest.iter_mut().enumerate() {
                *rest -= self.matrix[row * self.unknowns + j] * self.upper[j];
            }
        }
        let lines = self.tableau.chunks_exact(self.unknowns + self.rows);
        for (value, line) in self.values.iter_mut().zip(lines) {
            let of_inverse = line[self.unknowns..].iter().zip(&self.signs).zip(&rest);
            *value = of_inverse.map(|((inverse, sign), rest)| inverse * sign * rest).sum();
        }
    }

    /// Steps of the dual simplex method until all values are inside their bounds; `false` where the basis is not dual feasible, or after
    /// too many steps.
    fn put_inside(&mut self, cost: &[f64]) -> bool {
        let greatest = cost.iter().fold(0.0f64, |greatest, c| greatest.max(c.abs()));
        for step in 0..DUAL_STEPS {
            let Some((row, place)) = self.outside() else { return true };
            if step == 0 && self.entering(REDUCED_COST * greatest, true).is_some() {
                return false;
            }
            let Some(entering) = self.entering_for(row, place) else { return false };
            let leaving = self.basis[row];
            self.places[leaving] = place;
            self.places[entering] = Place::Basic;
            self.basis[row] = entering;
            self.pivot(row, entering);
            self.update_values();
        }
        false
    }

    /// The row whose value is farthest outside its bounds, and the bound that it is beyond.
    fn outside(&self) -> Option<(usize, Place)> {
        let mut worst: Option<(usize, Place, f64)> = None;
        for (row, (&value, &basic)) in self.values.iter().zip(&self.basis).enumerate() {
            let upper = self.upper[basic];
            let (place, by) = if value < 0.0 { (Place::Lower, -value) } else { (Place::Upper, value - upper) };
            let scale = if upper.is_finite() { 1.0 + upper } else { 1.0 };
            if by > INSIDE * scale && worst.is_none_or(|(_, _, most)| by > most) {
                worst = Some((row, place, by));
            }
        }
        worst.map(|(row, place, _)| (row, place))
    }

    /// The unknown that enters for the one of `row`, which goes to the bound `place`: the first whose reduced cost changes its sign, and
    /// of several the one with the largest entry.
    fn entering_for(&self, row: usize, place: Place) -> Option<usize> {
        let width = self.unknowns + self.rows;
        let line = &self.tableau[row * width..(row + 1) * width];
        let sign = if place == Place::Lower { 1.0 } else { -1.0 };
        let mut best: Option<(usize, f64, f64)> = None;
        for (j, entry) in line.iter().enumerate() {
            let helps = match self.places[j] {
                Place::Lower => self.upper[j] > 0.0 && sign * entry < -LEAST_PIVOT,
                Place::Upper => self.upper[j] > 0.0 && sign * entry > LEAST_PIVOT,
                Place::Basic => false,
            };
            if !helps {
                continue;
            }
            let (ratio, size) = (self.reduced[j].abs() / entry.abs(), entry.abs());
            if best.is_none_or(|(_, least, largest)| ratio < least || (ratio == least && size > largest)) {
                best = Some((j, ratio, size));
            }
        }
        best.map(|(j, _, _)| j)
    }
}
