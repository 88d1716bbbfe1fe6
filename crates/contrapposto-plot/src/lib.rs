//! Draws torques, postures and fatigue as pictures: plain numbers in, a [`Figure`] out, which is SVG text or PNG bytes.
//!
//! | Picture | Function | Contents |
//! |---|---|---|
//! | Torque balance | [`torque_balance()`] | Figures 1 and 7-14 of Rodriguez & Boulic (2007): torques against the angle, the path of the active torque, the arm |
//! | Passive curve | [`passive_curve()`] | passive torque and its slope over the range of a coordinate |
//! | Bodies | [`body_figure()`] | one posture from three sides, or several side by side: load colours, contact forces, loads, centre of mass, targets, surfaces and things, the start as a ghost |
//! | Body with names | [`body_map()`] | joints with their coordinates, frames of segments, patches |
//! | Greatest forces | [`force_figure()`] | the greatest forces at a point of a body in three sections, coloured by their limits |
//! | Fibres | [`force_length()`] | active and passive force of a muscle's fibres against their length, and the states that the muscle is in |
//! | People | [`holding_curve()`], [`bar_chart()`] | the share of people who still hold a posture against time; shares as bars |
//! | Time line | [`time_line()`] | angle, torques and fatigue of one coordinate against time |
//!
//! Every function takes any input without panicking: numbers that are not finite (or beyond 1e9 in size) leave a gap
//! in their curve, lists of unequal length are read up to the shortest, and a picture of nothing says so.
//! The same input gives the same bytes. Texts may come from strangers: they are escaped, and cut where they would overlap.
//!
//! Inside, a file uses only those above it in this list: `geometry` (clipping, dashes, spreading), `style` (colours, pens, sizes),
//! `path`, `shape` (the marks), `svg` and `font`, `png` (the two forms of a picture), `figure`, `canvas` (collects marks), `text`
//! (estimated widths), `axes` (data to paper), `captions`, `tags` (notes and postures above a frame), `outline` (hulls of circles),
//! `depth` (order of drawing), `body` (numbers), `body_view` (directions of view), `body_paper` (shapes), `body_legend`, then one
//! file for each picture.

mod axes;
mod bar_chart;
mod body;
mod body_figure;
mod body_legend;
mod body_map;
mod body_paper;
mod body_view;
mod canvas;
mod captions;
mod depth;
mod figure;
mod font;
mod force_figure;
mod force_length;
mod geometry;
mod holding_curve;
mod outline;
mod passive_chart;
mod path;
mod png;
mod shape;
mod style;
mod svg;
mod tags;
mod text;
mod time_line;
mod torque_balance;

pub use bar_chart::{BarChart, bar_chart};
pub use body::{BodyFigure, BodyForce, BodyMuscle, BodyPart, BodyPosture, BodyThing};
pub use body_figure::body_figure;
pub use body_map::{BodyMap, MapFrame, MapJoint, body_map};
pub use figure::{Figure, PlotError};
pub use force_figure::{ForceFigure, Spoke, force_figure};
pub use force_length::{ForceLength, force_length};
pub use holding_curve::{HoldingCurve, holding_curve};
pub use passive_chart::{PassiveChart, passive_curve};
pub use style::load_color;
pub use tags::{PostureSketch, SketchRole};
pub use time_line::{TimeLine, time_line};
pub use torque_balance::{TorqueBalance, torque_balance};
