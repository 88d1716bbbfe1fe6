//! Reads scenario files: text becomes a checked experiment, or an error with file, line and column.
//!
//! `text`, `task_text` and `obstacle_text` hold the file as it is written; `setup` reads what all experiments share; `simulate`,
//! `pose` and `relax` complete it for one command each. `world` reads things by name: box, tool, seat, table.

mod ball;
mod contents;
mod error_keys;
mod events;
mod fatigue_choice;
mod fatigue_text;
mod flat;
mod hanging_arms;
mod head;
mod least_effort;
mod levels;
mod load;
mod model;
mod names;
mod obstacle;
mod obstacle_text;
mod place;
mod polygon;
mod pose;
mod posture;
mod relax;
mod relief_text;
mod rest;
mod rest_text;
mod setup;
mod sharing;
mod shoulder_rhythm;
mod simulate;
mod spread;
mod stage;
mod support;
mod surface;
mod task;
mod task_text;
mod text;
mod upright;
mod world;

pub use contents::{ContentsTask, ScenarioContents, read_contents};
pub use model::{ModelFile, scenario_adult, scenario_model};
pub use pose::{PoseScenario, read_pose};
pub use relax::{RelaxScenario, read_relax};
pub use simulate::{RunScenario, read_run, read_scenario, scenario_runs};
pub use spread::STRENGTH_DEVIATIONS;
pub(crate) use text::StrategyKindText;
pub use text::scenario_schema;

/// Largest scenario file, bytes.
pub const MOST_BYTES: u64 = 1 << 20;
