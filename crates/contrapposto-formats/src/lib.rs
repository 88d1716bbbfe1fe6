//! Reads and writes text: scenario files, model files, motion, decision lines, tables and summaries.
//!
//! The readers take bytes of unknown origin and are total: any input gives a value or an error with its place. The crate opens no
//! files; the program does.

pub mod animation;
pub mod loads;
pub mod markers;
pub mod mjcf;
pub mod model_ir;
pub mod motion;
pub mod osim;
pub mod rigs;
pub mod tissue;
pub mod urdf;
pub mod write;
pub mod xml;

mod adult_text;
mod capacity;
mod decisions_csv;
mod escaped;
mod input_error;
mod minimize;
mod model_file;
mod muscle_work;
mod numbers;
mod overlay;
mod passive_law;
mod pose;
mod reaction;
mod scenario;
mod summary;
mod sweep;
mod thing;
mod toml_file;
mod trajectory_csv;
mod verdict;

pub use adult_text::{AdultTextError, adult_size, person};
pub use capacity::{AtText, CapacityText, ForceText, LimitText};
pub use decisions_csv::{decisions_csv, relief_sentence};
pub use escaped::{escaped, escaped_lines};
pub use input_error::{InputError, nearest};
pub use minimize::{DecisionLine, MOST_LINE_BYTES, minimize_line};
pub use model_file::{ModelFileError, ModelFormat, read_model};
pub use muscle_work::{
    LEAST_ACTIVATION_SAID, LackText, MuscleWorkText, MusclesFailText, PeakReactionText, TiredMuscleText,
    WorkedMuscleText, WorksForText,
};
pub use numbers::NumberError;
pub use overlay::{Overlaid, OverlayChange, overlay};
pub use pose::{PoseLevelText, PoseText};
pub use reaction::ReactionText;
pub use scenario::{
    ContentsTask, MOST_BYTES, ModelFile, PoseScenario, RelaxScenario, RunScenario, STRENGTH_DEVIATIONS,
    ScenarioContents, read_contents, read_pose, read_relax, read_run, read_scenario, scenario_adult, scenario_model,
    scenario_runs, scenario_schema,
};
pub use summary::{CoordinateText, GroupText, SlipText, SummaryText, iterations};
pub use sweep::{Design, Distribution, Parameter, Plan, Template, Value, read_plan};
pub use thing::{Swing, Thing};
pub use trajectory_csv::{TableRow, csv_header, csv_row};
pub use verdict::{AdviceText, LargestLoadText, MissedText, SuggestionText, VerdictText};
