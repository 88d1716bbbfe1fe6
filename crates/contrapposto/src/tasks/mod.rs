//! Computes the error of every kind of task, its derivative by the generalised speeds, and its second derivative.
//!
//! Every kind has its errors in their own units (m, rad, shares of strength). An equation asks for error zero: its rows
//! are `J step = -error`. An inequality allows a range: `lower - value <= J step <= upper - value`. To first order a
//! step that satisfies the rows reaches the target; rows keep the scale of their unit (1 m counts as much as 1 rad).

mod bounds;
mod center_of_mass;
mod check;
mod clearance;
mod clearance_pairs;
mod distance;
mod effort;
mod error_hessian;
mod height;
mod look_at;
mod orientation;
mod place;
mod placement;
mod point;
mod polygon;
mod posture;
mod priority_level;
mod rows;
mod task;
mod thing;
mod unit;

pub use bounds::{Bounds, Carried, Component};
pub use center_of_mass::{CenterOfMass, CenterOfMassGoal};
pub use check::{TaskError, TaskPart};
pub use clearance::{Clearance, ClearancePair, Obstacle};
pub use distance::Distance;
pub use effort::Effort;
pub(crate) use effort::{for_each_angle_slope, share_of_strength};
pub(crate) use error_hessian::ErrorHessian;
pub use height::Height;
pub use look_at::{LookAt, LookAtGoal};
pub use orientation::Orientation;
pub(crate) use place::within_region;
pub use place::{free_place, held_place, turned_since};
pub use placement::Placement;
pub use point::Point;
pub use polygon::{HalfPlane, half_planes};
pub use posture::Posture;
pub use priority_level::PriorityLevel;
pub use task::Task;
pub use thing::Thing;
pub use unit::Unit;
