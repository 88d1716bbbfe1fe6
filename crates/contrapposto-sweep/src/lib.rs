//! Computes the rows of a plan of many runs: which values every parameter has in every row, the answer of its run, and the text of a
//! part, some rows together.
//!
//! A row depends on the plan, the scenario and its own number alone, so any thread or machine can compute any part, with the same bytes.

mod normal;
mod outcome;
mod part;
mod random;
mod sampler;
mod sobol;
mod sobol_table;

pub use normal::{cumulative, quantile};
pub use outcome::Outcome;
pub use part::{COLUMNS, Study};
pub use sampler::Sampler;
pub use sobol::{MOST_DIMENSIONS, sobol};
