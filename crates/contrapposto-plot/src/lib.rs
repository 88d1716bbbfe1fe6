//! How are torques, postures and fatigue shown as pictures? Plain numbers in, a [`Figure`] out.
//!
//! | Picture | Function | What it shows |
//! |---|---|---|
//! | Torque balance | [`torque_balance()`] | Figures 1 and 7-14 of Rodriguez & Boulic (2007): torques against the angle, the path of the active torque, the arm |
//! | Passive curve | [`passive_curve()`] | passive torque and its slope over the range of a coordinate |
//! | Pose | [`pose_views()`] | a stick figure from several sides: start, result, targets, centre of mass |
//! | Poses | [`pose_grid()`] | several postures side by side, each from several sides, in one scale |
//! | Time line | [`time_line()`] | angle, torques and fatigue of one coordinate against time |
//!
//! Every function takes any input without panicking: numbers that are not finite (or beyond 1e9 in size) leave a gap
//! in their curve, lists of unequal length are read up to the shortest, and a picture of nothing says so.
//! The same input gives the same bytes. Texts may come from strangers: they are escaped, and cut where they would overlap.
//!
//! Inside, every file stands on those above it in this list:
//! `style` (colours, pens, sizes), `canvas` (the only file that knows the drawing library), `geometry` (clipping, dashes, spreading),
//! `axes` (data to paper), `captions`, `tags` (notes and postures above a frame), then one file for each picture.

mod axes;
mod canvas;
mod captions;
mod figure;
mod geometry;
mod passive_chart;
mod pose_grid;
mod pose_views;
mod style;
mod tags;
mod time_line;
mod torque_balance;

pub use figure::{Figure, PlotError};
pub use passive_chart::{PassiveChart, passive_curve};
pub use pose_grid::{PoseColumn, PoseGrid, pose_grid};
pub use pose_views::{PoseView, PoseViews, pose_views};
pub use tags::{PostureSketch, SketchRole};
pub use time_line::{TimeLine, time_line};
pub use torque_balance::{TorqueBalance, torque_balance};
