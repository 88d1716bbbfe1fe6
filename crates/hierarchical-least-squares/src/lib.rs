//! Least squares in strict order of priority, with inequalities at every level.
//!
//! A [`Problem`] has bounds that always hold and [`Level`]s. The first level is brought as near to its rows as the bounds
//! allow; each further one as near as the levels above allow without giving up anything of theirs (Escande, Mansard &
//! Wieber 2014, "Hierarchical quadratic programming: fast online humanoid-robot motion generation"). With equations alone
//! the answer is that of the recursion of Baerlocher & Boulic (2004).
//!
//! [`Solver`] goes down the levels once. At each it solves a least-squares problem by a primal active-set method in the
//! null space of what is already fixed, which one orthogonal factorisation of rows (`factor.rs`) carries from level to
//! level (as in Dimitrov, Sherikov & Wieber 2015, "Efficient resolution of potentially conflicting linear constraints in
//! robotics").
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
//! assert!((solver.residual(1)[0] + 2.0).abs() < 1e-14); // the bound on y stands in the way of x
//! # Ok::<(), hierarchical_least_squares::ProblemError>(())
//! ```

mod certificate;
mod diagonal;
mod factor;
mod level;
pub mod linalg;
mod multipliers;
mod problem;
mod solver;
mod space;

pub use multipliers::Multipliers;
pub use problem::{Level, Problem, ProblemError};
pub use solver::{Solver, Status};
