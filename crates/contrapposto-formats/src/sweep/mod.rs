//! Reads plans of many runs, and sets the keys of a scenario file to the values of one run.

mod plan;
mod plan_text;
mod template;

pub use plan::{Design, Distribution, Parameter, Plan, Value, read_plan};
pub use template::Template;
