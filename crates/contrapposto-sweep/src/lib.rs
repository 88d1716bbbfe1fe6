//! Computes the rows of a plan of many runs: which values every parameter has in every row, the answer of its run, and the bytes of
//! a part, some rows together. Counts the answers of a population of women and men.
//!
//! A row depends on the plan, the scenario and its own number alone, so any thread or machine can compute any part, with the same bytes.

mod interval;
mod outcome;
mod part;
mod part_file;
mod population;
mod random;
mod rank_regression;
mod sampler;
mod sensitivity;
mod sobol;
mod sobol_table;
mod table;
mod thrift;

pub use interval::{CONFIDENCE, wilson};
pub use outcome::Outcome;
pub use part::Study;
pub use population::{MOST_BODIES, People, Population, QUANTILES, SEXES, population};
pub use rank_regression::{RankCoefficient, RankRegression, ranks};
pub use sampler::Sampler;
pub use sensitivity::{LEAST_FOR_SENSITIVITY, NoSensitivity, PARAMETERS, Sensitivity};
pub use sobol::{MOST_DIMENSIONS, sobol};
pub use table::{Answer, COLUMNS};
