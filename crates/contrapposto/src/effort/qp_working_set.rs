//! Changes the working set of a quadratic program until its solution is found.

use hierarchical_least_squares::linalg::{dot, padded_width};

use super::dual_active_set::Constraints;
use super::qp::QuadraticProgram;
use super::tolerances::{JOINING_SHARE, LEAVING_MULTIPLIER, QP_ZERO, WORKING_SET_CHANGES};

impl QuadraticProgram {
    /// Solves, and changes many constraints at once, until nothing changes; `false` after [`WORKING_SET_CHANGES`].
    pub(super) fn change_many(&mut self, regularisation: &mut f64) -> Option<bool> {
        for _ in 0..WORKING_SET_CHANGES {
            self.list_working_set();
            self.factorise_regularised(regularisation)?;
            self.back_substitute();
            if !self.change_working_set() {
                return Some(true);
            }
        }
        Some(false)
    }

    /// Solves with the working set that a dual method finds, or, where the squares of its inequalities do with less regularisation than the
    /// equations alone, with the one that few changes of it lead to.
    pub(super) fn find_working_set(&mut self, regularisation: &mut f64) -> Option<()> {
        let (n, mut less) = (self.n, *regularisation);
        self.at_bound.fill(0);
        self.working_set.clear();
        self.free.clear();
        self.free.extend(0..n);
        self.factorise_regularised(regularisation)?;
        let width = padded_width(n + 1);
        self.of_unknowns.clear();
        self.of_unknowns.extend((0..n).map(|i| self.factor[i * width + n]));
        let Self { factor, rows, lower, upper, lower_bounds, upper_bounds, dual, .. } = self;
        dual.solve(&Constraints { factor, width, rows, lower, upper, lower_bounds, upper_bounds }, &self.of_unknowns);
        self.dual.write(&mut self.at_bound, &mut self.at_limit);
        if less < *regularisation {
            let found = self.change_many(&mut less) == Some(true);
            if found && less < *regularisation {
                *regularisation = less;
                return Some(());
            }
        }
        self.dual.write(&mut self.at_bound, &mut self.at_limit);
        self.list_constraints();
        self.factorise_regularised(regularisation)?;
        self.back_substitute();
        Some(())
    }

    /// Lists free unknowns and working-set rows. Where most unknowns lie at bounds all are freed: changes of many at once seldom find such a
    /// solution.
    fn list_working_set(&mut self) {
        if 2 * self.at_bound.iter().filter(|side| **side == 0).count() < self.n {
            self.at_bound.fill(0);
        }
        self.list_constraints();
    }

    /// Lists free unknowns and working-set rows; sets the other unknowns to their bounds.
    fn list_constraints(&mut self) {
        self.free.clear();
        self.free.extend((0..self.n).filter(|i| self.at_bound[*i] == 0));
        for (i, side) in self.at_bound.iter().enumerate() {
            self.step[i] = match side {
                0 => 0.0,
                -1 => self.lower_bounds[i],
                _ => self.upper_bounds[i],
            };
        }
        self.working_set.clear();
        for row in 0..self.lower.len() {
            if self.lower[row] == self.upper[row] || self.at_limit[row] != 0 {
                self.working_set.push(row);
            }
        }
    }

    /// Changes the working set and the unknowns at bounds; returns whether anything changed.
    fn change_working_set(&mut self) -> bool {
        let left = self.leave_bounds();
        let joined = self.join_bounds();
        self.change_rows() || left || joined
    }

    /// Frees unknowns whose bound has a multiplier of the wrong sign.
    fn leave_bounds(&mut self) -> bool {
        let n = self.n;
        let mut changed = false;
        for i in 0..n {
            if self.at_bound[i] == 0 {
                continue;
            }
            let above: f64 = (0..i).map(|j| self.matrix[j * n + i] * self.step[j]).sum();
            let mut multiplier = self.gradient[i] + above + dot(&self.matrix[i * n + i..(i + 1) * n], &self.step[i..]);
            for &row in &self.working_set {
                multiplier += self.multipliers[row] * self.rows[row * n + i];
            }
            if multiplier * f64::from(self.at_bound[i]) > LEAVING_MULTIPLIER * self.gradient[i].abs() {
                self.at_bound[i] = 0;
                changed = true;
            }
        }
        changed
    }

    /// Holds the unknowns at the bounds that they violate most.
    fn join_bounds(&mut self) -> bool {
        let violation = |i: usize| (self.lower_bounds[i] - self.step[i]).max(self.step[i] - self.upper_bounds[i]);
        let worst = self.free.iter().fold(0.0, |worst: f64, i| worst.max(violation(*i)));
        if worst <= QP_ZERO {
            return false;
        }
        let mut changed = false;
        for &i in &self.free {
            let violation = (self.lower_bounds[i] - self.step[i]).max(self.step[i] - self.upper_bounds[i]);
            if violation >= JOINING_SHARE * worst {
                self.at_bound[i] = if self.step[i] < self.lower_bounds[i] { -1 } else { 1 };
                changed = true;
            }
        }
        changed
    }

    /// Lets rows leave whose multiplier has the wrong sign, and violated rows join.
    fn change_rows(&mut self) -> bool {
        let n = self.n;
        let mut changed = false;
        for row in 0..self.lower.len() {
            if self.lower[row] == self.upper[row] {
                continue;
            }
            if self.at_limit[row] != 0 {
                if self.multipliers[row] * f64::from(self.at_limit[row]) < 0.0 {
                    self.at_limit[row] = 0;
                    changed = true;
                }
                continue;
            }
            let value = dot(&self.rows[row * n..(row + 1) * n], &self.step);
            let side = i8::from(value > self.upper[row] + QP_ZERO) - i8::from(value < self.lower[row] - QP_ZERO);
            changed |= side != 0;
            self.at_limit[row] = side;
        }
        changed
    }
}
