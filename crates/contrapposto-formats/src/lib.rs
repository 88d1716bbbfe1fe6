//! Text from outside, text to outside: scenario files, models, motion, decision lines, tables and summaries.
//!
//! Everything here reads bytes of strangers and is total: any input gives a value or an [`InputError`] with its place. The
//! crate opens no files; the program does.

pub mod animation;
pub mod body;
pub use contrapposto::math::expression;
pub mod loads;
pub mod mjcf;
pub mod motion;
pub mod numbers;
pub mod osim;
pub mod tissue;
pub mod urdf;
pub mod write;
pub mod xml;

mod adult_text;
mod decisions_csv;
mod input_error;
mod minimize;
mod model_file;
mod overlay;
mod pose;
mod scenario;
mod summary;
mod trajectory_csv;

pub use adult_text::{AdultTextError, adult_size};
pub use decisions_csv::{decisions_csv, relief_sentence};
pub use input_error::{InputError, nearest, utf8};
pub use minimize::{DecisionLine, MOST_LINE_BYTES, minimize_line};
pub use model_file::{ModelFileError, ModelFormat, read_model};
pub use overlay::{Overlaid, OverlayChange, overlay};
pub use pose::{PoseLevelText, PoseText};
pub use scenario::{
    MOST_BYTES, ModelFile, PoseScenario, RelaxScenario, ScenarioText, read_pose, read_relax, read_scenario,
    scenario_model, scenario_runs, scenario_schema,
};
pub use summary::{CoordinateText, GroupText, SummaryText, iterations};
pub use trajectory_csv::{TableRow, csv_header, csv_row};
