//! Defines a problem: bounds on the unknowns, which always hold, and levels of rows in strict order of priority.

use crate::tolerances::LARGEST_NUMBER;

/// One level of priority: `lower <= A x <= upper`, as nearly as every level above allows.
///
/// The residual, `a_i x - upper_i` above the upper limit, `a_i x - lower_i` below the lower one, 0 between, has the least
/// Euclidean norm. An equation has `lower == upper`. Rows keep the scale they are given in: a row multiplied by 10 weighs 100
/// times as much against the others of its level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// `A`, row after row, each as long as there are unknowns.
    pub matrix: Vec<f64>,
    /// Lower limit of each row; may be minus infinity.
    pub lower: Vec<f64>,
    /// Upper limit of each row, not below the lower one; may be infinite.
    pub upper: Vec<f64>,
    /// `mu >= 0`: the level minimises `|residual|^2 + mu^2 |x|^2`; 0 for none. The levels below keep the values of its rows
    /// only: directions that no row contains are left to them. Damping does not change the levels above.
    pub damping: f64,
    /// The level must be satisfied: a residual makes the answer [`crate::Status::Infeasible`].
    pub hard: bool,
}

impl Level {
    /// A level without rows, with space for `rows` of `unknowns`.
    pub fn with_capacity(rows: usize, unknowns: usize) -> Self {
        Self {
            matrix: Vec::with_capacity(rows * unknowns),
            lower: Vec::with_capacity(rows),
            upper: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.lower.len()
    }

    /// Removes all rows and keeps the space.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.lower.clear();
        self.upper.clear();
        self.damping = 0.0;
        self.hard = false;
    }

    /// Adds the row `lower <= row . x <= upper`.
    pub fn push(&mut self, row: &[f64], lower: f64, upper: f64) {
        self.matrix.extend_from_slice(row);
        self.lower.push(lower);
        self.upper.push(upper);
    }
}

/// Bounds and levels over a number of unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problem {
    /// Lower bound of each unknown; may be minus infinity.
    pub lower: Vec<f64>,
    /// Upper bound of each unknown, not below the lower one; may be infinite.
    pub upper: Vec<f64>,
    /// The first is the most important.
    pub levels: Vec<Level>,
}

impl Problem {
    /// A problem of `n` unknowns without bounds or levels.
    pub fn new(n: usize) -> Self {
        Self { lower: vec![f64::NEG_INFINITY; n], upper: vec![f64::INFINITY; n], levels: vec![] }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.lower.len()
    }
}

/// The reason for which a problem was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// A list has another length than it must have.
    #[error("{what} has {given} numbers; it must have {needed}")]
    Length {
        /// Name of the list.
        what: String,
        /// Length of the list.
        given: usize,
        /// The length it must have.
        needed: usize,
    },
    /// A number that is not accepted.
    #[error("{what} is {value:e}; it must be {accepted}")]
    Number {
        /// Name of the number.
        what: String,
        /// The number.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
}

impl Problem {
    /// Checks that all lengths fit and that all numbers are accepted.
    ///
    /// # Errors
    /// [`ProblemError`] names the first list or number that does not.
    pub(crate) fn check(&self) -> Result<(), ProblemError> {
        self.check_limits()?;
        for (k, level) in self.levels.iter().enumerate() {
            if let Some(&value) = level.matrix.iter().find(|a| a.is_nan() || a.abs() > LARGEST_NUMBER) {
                let what = format!("coefficient of level {k}");
                return Err(ProblemError::Number { what, value, accepted: "finite and at most 1e60 in size" });
            }
        }
        Ok(())
    }

    /// Checks everything but the coefficients.
    pub(crate) fn check_limits(&self) -> Result<(), ProblemError> {
        let n = self.unknowns();
        check_limits(&self.lower, &self.upper, n, &|| "bound of an unknown".to_owned())?;
        for (k, level) in self.levels.iter().enumerate() {
            let (given, needed) = (level.matrix.len(), level.rows() * n);
            if given != needed {
                return Err(ProblemError::Length { what: format!("matrix of level {k}"), given, needed });
            }
            check_limits(&level.lower, &level.upper, level.rows(), &|| format!("limit of a row of level {k}"))?;
            if !(0.0..=LARGEST_NUMBER).contains(&level.damping) {
                let what = format!("damping of level {k}");
                return Err(ProblemError::Number { what, value: level.damping, accepted: "between 0 and 1e60" });
            }
        }
        Ok(())
    }
}

fn check_limits(lower: &[f64], upper: &[f64], needed: usize, what: &dyn Fn() -> String) -> Result<(), ProblemError> {
    if upper.len() != needed || lower.len() != needed {
        let given = if upper.len() == needed { lower.len() } else { upper.len() };
        return Err(ProblemError::Length { what: format!("list of the {}s", what()), given, needed });
    }
    for (&lower, &upper) in lower.iter().zip(upper) {
        let number =
            |side, value, accepted| Err(ProblemError::Number { what: format!("{side} {}", what()), value, accepted });
        if lower.is_nan() || lower == f64::INFINITY || (lower.is_finite() && lower.abs() > LARGEST_NUMBER) {
            return number("lower", lower, "at most 1e60 in size, or minus infinity");
        }
        if upper.is_nan() || upper == f64::NEG_INFINITY || (upper.is_finite() && upper.abs() > LARGEST_NUMBER) {
            return number("upper", upper, "at most 1e60 in size, or infinity");
        }
        if lower > upper {
            return number("lower", lower, "not above the upper one");
        }
    }
    Ok(())
}
