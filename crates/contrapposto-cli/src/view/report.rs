//! `report.html`, one module a command.

pub(crate) mod assessment;
pub(crate) mod capacity;
pub(crate) mod comparison;
pub(crate) mod equilibria;
mod figure;
mod narrative;
pub(crate) mod pose;
pub(crate) mod run;
