//! Changes the working set of a quadratic program until its solution is found.

use hierarchical_least_squares::linalg::{dot, norm, padded_width};

use super::dual_active_set::Constraints;
use super::qp::QuadraticProgram;
use super::tolerances::{JOINING_SHARE, LEAVING_MULTIPLIER, QP_VIOLATION, QP_ZERO, WORKING_SET_CHANGES};

impl QuadraticProgram {
    /// Solves, and changes many constraints at once, until nothing changes; returns the regularisation that the last solution needed, `None` after
    /// [`WORKING_SET_CHANGES`].
    pub(super) fn change_many(&mut self, regularisation: f64) -> Option<f64> {
        for _ in 0..WORKING_SET_CHANGES {
            self.list_working_set();
            let needed = self.factorise_regularised(regularisation)?;
            self.back_substitute();
            if !self.change_working_set() {
                return Some(needed);
            }
        }
        None
    }

    /// Solves with the working set that a dual method finds, where the squares of the equations alone were added; returns the regularisation that was
    /// needed.
    ///
    /// Where the squares of the equations alone need more of it, those of the bounds and limits that the solution meets are added, too, and the program
    /// is solved once more with less. If that meets all of them, they change nothing in it; if not, those that it leaves are taken away again.
    pub(super) fn find_working_set(&mut self, regularisation: f64) -> Option<f64> {
        let alone = self.find_by_dual(regularisation)?;
        let mut needed = alone;
        if regularisation < alone {
            needed = match self.find_with_less(regularisation, alone) {
                Some(less) => less,
                None => {
                    self.stiffen(false);
                    self.find_by_dual(alone)?
                }
            };
        }
        self.list_constraints();
        needed = self.factorise_regularised(needed)?;
        self.back_substitute();
        Some(needed)
    }

    /// Finds the working set of `M` with the squares that were added; returns the regularisation that was needed.
    fn find_by_dual(&mut self, regularisation: f64) -> Option<f64> {
        let n = self.n;
        self.working_set.clear();
        self.free.clear();
        self.free.extend(0..n);
        self.at_bound.fill(0);
        let needed = self.factorise_regularised(regularisation)?;
        let width = padded_width(n + 1);
        self.of_unknowns.clear();
        self.of_unknowns.extend((0..n).map(|i| self.factor[i * width + n]));
        let Self { factor, rows, lower, upper, lower_bounds, upper_bounds, dual, .. } = self;
        dual.solve(&Constraints { factor, width, rows, lower, upper, lower_bounds, upper_bounds }, &self.of_unknowns);
        self.dual.write(&mut self.at_bound, &mut self.at_limit);
        Some(needed)
    }

    /// Finds the working set with less regularisation than `most`, from `least` on, where there is one; returns it.
    fn find_with_less(&mut self, least: f64, most: f64) -> Option<f64> {
        for _ in 0..WORKING_SET_CHANGES {
            self.known_bound.clone_from(&self.at_bound);
            self.known_limit.clone_from(&self.at_limit);
            self.stiffen(true);
            let needed = self.find_by_dual(least).filter(|needed| *needed < most)?;
            if self.meets_known() {
                return Some(needed);
            }
            let bounds = self.at_bound.iter_mut().zip(&self.known_bound);
            for (side, known) in bounds.chain(self.at_limit.iter_mut().zip(&self.known_limit)) {
                if side != known {
                    *side = 0;
                }
            }
        }
        None
    }

    /// Whether the solution of the dual method meets all bounds and limits whose squares were added.
    fn meets_known(&self) -> bool {
        let d = self.dual.solution();
        let limit = |side: i8, lower: f64, upper: f64| if side > 0 { upper } else { lower };
        let mut bounds = self.known_bound.iter().enumerate().filter(|(_, side)| **side != 0);
        let mut rows = self.known_limit.iter().enumerate().filter(|(_, side)| **side != 0);
        bounds.all(|(i, side)| (d[i] - limit(*side, self.lower_bounds[i], self.upper_bounds[i])).abs() <= QP_VIOLATION)
            && rows.all(|(r, side)| {
                let row = &self.rows[r * self.n..(r + 1) * self.n];
                let missing = dot(row, d) - limit(*side, self.lower[r], self.upper[r]);
                missing.abs() <= QP_VIOLATION * norm(row)
            })
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
