//! Solves least squares in strict order of priority, with bounds and inequalities at every level (hierarchical, or
//! lexicographic, least squares).
//!
//! For levels `k = 1..p` in turn:
//!
//! ```text
//! minimise  |r_k|^2 + mu_k^2 |x|^2     with  r_k = the distance of A_k x from  lower_k <= A_k x <= upper_k
//! subject to  lower <= x <= upper,  and the rows of the levels before k at the values those levels have reached
//! ```
//!
//! An inequality that a level satisfies stays satisfied, and may be inactive; a residual that a level keeps stays as it is
//! (Escande, Mansard & Wieber 2014, "Hierarchical quadratic programming: fast online humanoid-robot motion generation"). With
//! equations alone the answer is that of the recursion of Baerlocher & Boulic (2004).
//!
//! [`Solver`] solves the levels in one pass. Each is a least-squares problem, solved by a primal active-set method in the null
//! space of the levels above; one orthogonal factorisation of rows is carried from level to level (as in Dimitrov, Sherikov &
//! Wieber 2015, "Efficient resolution of potentially conflicting linear constraints in robotics"). It is meant for dense
//! problems of up to a few hundred unknowns, and allocates nothing when a problem of the same size is solved again.
//!
//! ```
//! use hierarchical_least_squares::{Level, Problem, Solver, Status};
//!
//! // First x + y = 2, then x = 5, then y = 5, with y at least -1.
//! let mut problem = Problem::new(2);
//! problem.lower[1] = -1.0;
//! for row in [[1.0, 1.0, 2.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]] {
//!     let mut level = Level::default();
//!     level.push(&row[..2], row[2], row[2]);
//!     problem.levels.push(level);
//! }
//! let mut solver = Solver::new();
//! assert_eq!(solver.solve(&problem)?, Status::Solved);
//! assert!((solver.solution()[0] - 3.0).abs() < 1e-14 && solver.solution()[1] == -1.0);
//! assert!((solver.residual(1)[0] + 2.0).abs() < 1e-14); // the bound on y keeps x from 5
//! # Ok::<(), hierarchical_least_squares::ProblemError>(())
//! ```
//!
//! [`linalg`] holds the dense linear algebra of the solver, for other solvers to use.

mod active_set;
mod blocking;
mod dropped;
mod factor;
mod identity_level;
mod level_solver;
pub mod linalg;
mod multipliers;
mod problem;
mod residual_rows;
mod rows;
mod solver;
mod tolerances;
mod triangular_level;
mod working_set;

pub use multipliers::Multipliers;
pub use problem::{Level, Problem, ProblemError};
pub use solver::{Solver, Status};

/// The example of the README, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
