//! Ready and relaxed human postures.
pub mod hybrid;
pub mod math;
pub mod passive;
