//! Shapes of results for readers: recordings, moments, drawings, charts, pages, tables and texts.

pub(crate) mod animation;
pub(crate) mod answer;
pub(crate) mod axes;
pub(crate) mod body;
pub(crate) mod body_map;
pub(crate) mod charts;
pub(crate) mod decision;
pub(crate) mod excerpt;
pub(crate) mod figures;
pub(crate) mod frame;
pub(crate) mod held;
pub(crate) mod moment;
pub(crate) mod muscles;
pub(crate) mod pose_picture;
pub(crate) mod recording;
pub(crate) mod report;
pub(crate) mod residual;
pub(crate) mod scene;
pub(crate) mod selection;
mod solid;
pub(crate) mod stage;
mod surfaces;
pub(crate) mod tables;
pub(crate) mod text;
pub(crate) mod three_axis;
pub(crate) mod torque_rows;
pub(crate) mod words;
