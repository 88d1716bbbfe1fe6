//! Lists every tolerance and limit of the crate, with its meaning and unit.
//!
//! | Constant | Value | Unit | Compared with |
//! |---|---|---|---|
//! | `ROUNDING` | 1e-12 | share of `max(|limit|) + |a| |x|` of a row | difference of two values of the row that rounding explains |
//! | `REACHED` | 0.1 | share of that rounding | distance of a residual from its predicted value after a full step |
//! | `LIGHT_ROW` | 10 | that rounding | residual below which a row beside much larger rows has no multiplier |
//! | `LAST_DIGITS` | 1e-3 | share of that rounding | residuals of a damped level, which are small everywhere |
//! | `INDEPENDENT` | 1e-10 | share of the norm of a row | part of the row outside the span of the rows before it |
//! | `MULTIPLIER` | 1e-11 | share of `sum |r_i| |a_i|` of the level | multiplier times norm of its row |
//! | `NO_MOTION` | 1e-14 | share of the norm of the step | change of an unknown or of a row of unit norm |
//! | `ZERO_ROW` | 1e-60 | that of the coefficients | norm of a row |
//! | `LARGEST_NUMBER` | 1e60 | that of the coefficients | coefficient, finite limit, damping: their squares and products stay finite |
//! | `SINGULAR` | 1e-6 | none (eigenvalues lie in 0..1) | pivot of the Gram matrix of a level of single unknowns |
//! | `NORM_UPDATE` | 1e-3 | share of a squared norm | updated squared norm below which it is computed anew |
//! | `DEPENDENT_COLUMN` | 1e-14 | share of the first pivot | remainder of a column in a least-squares problem |
//! | `OFF_DIAGONAL` | 1e-17 | share of the largest entry | off-diagonal entry of a matrix whose eigenvalues are sought |
//! | `REFINEMENTS` | 3 | steps | steps to one minimum, with the residual computed anew each time |
//! | `SWEEPS` | 30 | sweeps of Jacobi's method | five or six are enough in practice |
//! | `CHANGES`, `CHANGES_PER_ROW` | 100, 10 | changes of the working set | changes after which the solver stops: the first plus the second per row and unknown |
//! | `CYCLING` | 4 | divides that limit | changes after which light rows are judged by the level's scale, not by their own |
//! | `MANY_UNKNOWNS` | 32 | unknowns | size from which the unknowns of the first level come first |

pub(crate) const ROUNDING: f64 = 1e-12;
pub(crate) const REACHED: f64 = 0.1;
pub(crate) const LIGHT_ROW: f64 = 10.0;
pub(crate) const LAST_DIGITS: f64 = 1e-3;
pub(crate) const INDEPENDENT: f64 = 1e-10;
pub(crate) const MULTIPLIER: f64 = 1e-11;
pub(crate) const NO_MOTION: f64 = 1e-14;
pub(crate) const ZERO_ROW: f64 = 1e-60;
pub(crate) const LARGEST_NUMBER: f64 = 1e60;
pub(crate) const SINGULAR: f64 = 1e-6;
pub(crate) const NORM_UPDATE: f64 = 1e-3;
pub(crate) const DEPENDENT_COLUMN: f64 = 1e-14;
pub(crate) const OFF_DIAGONAL: f64 = 1e-17;
pub(crate) const REFINEMENTS: usize = 3;
pub(crate) const SWEEPS: usize = 30;
pub(crate) const CHANGES: usize = 100;
pub(crate) const CHANGES_PER_ROW: usize = 10;
pub(crate) const CYCLING: usize = 4;
pub(crate) const MANY_UNKNOWNS: usize = 32;
