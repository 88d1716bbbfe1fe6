//! Dense linear algebra for matrices of tens to a few hundred rows, in slices that the caller keeps.
//!
//! | File | Computes |
//! |---|---|
//! | `vector` | sums over rows in a fixed order, four numbers at a time |
//! | `cholesky` | Cholesky factors: plain, pivoted, and of positive semidefinite matrices |
//! | `blocked_cholesky` | Cholesky factors of larger matrices, four rows at a time |
//! | `triangular` | solutions of triangular systems |
//! | `symmetric_eigen` | eigenvalues and eigenvectors of a symmetric matrix (Jacobi) |
//! | `least_squares` | least squares by Householder QR with row and column exchange |
//!
//! Matrices are stored row after row. Every sum has an order that does not depend on the machine.

mod blocked_cholesky;
mod cholesky;
mod least_squares;
mod symmetric_eigen;
mod triangular;
mod vector;

pub use blocked_cholesky::{block_start, blocked_cholesky, padded_width};
pub use cholesky::{cholesky, pivoted_cholesky, semidefinite_cholesky};
pub(crate) use least_squares::LeastSquares;
pub use symmetric_eigen::SymmetricEigen;
pub use triangular::{solve_lower, solve_lower_transposed, solve_upper, solve_upper_transposed};
pub use vector::{
    add_outer_product, add_outer_products, add_scaled, add_symmetric_column, dot, norm, rotate, rotation,
};
pub(crate) use vector::{add_scaled_pair, dot_pair, norm_and_nonzeros};
