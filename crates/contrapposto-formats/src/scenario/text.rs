//! Holds the scenario file as it is written: one struct a table, unknown keys refused. See `docs/scenario.md`.

use std::collections::BTreeMap;

use contrapposto::hybrid::Strategy;
use schemars::JsonSchema;
use serde::Deserialize;

use super::fatigue_text::FatigueText;
use super::obstacle_text::ObstacleText;
use super::relief_text::ReliefText;
use super::rest_text::RestText;
use super::sharing::SharingText;
use super::spread::{PassiveTable, StrengthText};
use super::task_text::{SolverText, SupportText, TaskText};
use super::world::text::{BagText, BoxText, FloorText, HandleText, SeatText, StepText, TableText, ToolText, WallText};
use crate::escaped::{escaped, turns_direction};
use crate::tissue::HipTissue;
use crate::toml_file::numbers;

/// An experiment: a body, its posture, loads, supports and tasks; for `simulate` the relief wanted and how long.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ScenarioText {
    /// Version of this format; 1.
    pub(crate) format: u32,
    /// Name of the experiment.
    #[serde(default, deserialize_with = "title")]
    pub(crate) title: String,
    /// The body; the built-in reference man when left out.
    #[serde(default)]
    pub(crate) model: ModelText,
    /// Passive curves by coordinate, the built-in curve of each coordinate when left out; and a factor of passive torque.
    #[serde(default)]
    pub(crate) passive: PassiveTable,
    /// Strength of the person beside the mean of people of that sex and size.
    #[serde(default)]
    pub(crate) strength: StrengthText,
    /// Start: `NAME_deg` for rotations, `NAME_m` for slides, bare names for quaternions. Other coordinates are at their defaults.
    #[serde(default)]
    pub(crate) posture: BTreeMap<String, f64>,
    /// Start as a result has it, over `[posture]`: the `coordinates` of `pose.json`, rad or m. `--start-from pose.json` gives it.
    #[serde(default)]
    pub(crate) start_from: BTreeMap<String, f64>,
    /// Coordinates that may move; all when left out.
    #[serde(default)]
    pub(crate) coordinates: CoordinatesText,
    /// Held weights and forces.
    #[serde(default)]
    pub(crate) load: Vec<LoadText>,
    /// The supports, which carry weight.
    #[serde(default)]
    pub(crate) support: Vec<SupportText>,
    /// Places where a hand may be put when a muscle group is tired (`simulate`).
    #[serde(default)]
    pub(crate) rest: Vec<RestText>,
    /// Boxes held in both hands.
    #[serde(default, rename = "box")]
    pub(crate) boxes: Vec<BoxText>,
    /// Tools, each in one hand.
    #[serde(default)]
    pub(crate) tool: Vec<ToolText>,
    /// Bags that are carried.
    #[serde(default)]
    pub(crate) bag: Vec<BagText>,
    /// Handles that are pushed or pulled.
    #[serde(default)]
    pub(crate) handle: Vec<HandleText>,
    /// The floor, y = 0, and the feet on it. When left out beside any other thing of the world: both feet stand on it.
    pub(crate) floor: Option<FloorText>,
    /// Steps, each under one foot.
    #[serde(default)]
    pub(crate) step: Vec<StepText>,
    /// Tables.
    #[serde(default)]
    pub(crate) table: Vec<TableText>,
    /// Counters: as tables, of another size.
    #[serde(default)]
    pub(crate) counter: Vec<TableText>,
    /// The seat.
    pub(crate) seat: Option<SeatText>,
    /// Walls.
    #[serde(default)]
    pub(crate) wall: Vec<WallText>,
    /// Things that no part of the body passes through.
    #[serde(default)]
    pub(crate) obstacle: Vec<ObstacleText>,
    /// The tasks of the body, in order of priority.
    #[serde(default)]
    pub(crate) task: Vec<TaskText>,
    /// The head's up axis points up, just above effort. When left out: `true` for the built-in adult on supports, where no task names
    /// head or trunk.
    pub(crate) upright: Option<bool>,
    /// Arms without work hang, just above effort. When left out: `true` for the built-in adult on supports.
    pub(crate) arms_hang: Option<bool>,
    /// The shoulder joints rise as the arms are raised, just above effort. When left out: `true` for a body that has their coordinates
    /// and supports or tasks.
    pub(crate) shoulder_rhythm: Option<bool>,
    /// Little effort of all muscles is the last task. When left out: `true` in a run of the built-in adult on supports without a task of
    /// kind `effort`.
    pub(crate) least_effort: Option<bool>,
    /// Settings of the solver (`pose`).
    pub(crate) solver: Option<SolverText>,
    /// The kind of relief that is wanted; `simulate` needs it.
    pub(crate) strategy: Option<StrategyText>,
    /// Settings of relief (`simulate`).
    #[serde(default)]
    pub(crate) relief: ReliefText,
    /// Law of fatigue of muscle groups (`simulate`).
    #[serde(default)]
    pub(crate) fatigue: FatigueText,
    /// Changes during a run (`simulate`).
    #[serde(default)]
    pub(crate) event: Vec<EventText>,
    /// Duration and time step; `simulate` needs them.
    pub(crate) run: Option<RunText>,
}

impl ScenarioText {
    /// Whether the file says how the body starts.
    pub(crate) fn has_posture(&self) -> bool {
        !self.posture.is_empty() || !self.start_from.is_empty()
    }
}

/// Something that changes during a run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EventText {
    /// Time of the event, s; by the last step of the run.
    pub(crate) at_s: f64,
    /// Strategy of the whole body from then on.
    pub(crate) strategy: Option<StrategyKindText>,
    /// Strategy of regions (`spine`, `neck`, `arms`, `legs`) or coordinates from then on.
    #[serde(default)]
    pub(crate) strategy_of: BTreeMap<String, StrategyKindText>,
    /// Loads from then on, in place of those before; empty to put everything down.
    pub(crate) load: Option<Vec<LoadText>>,
    /// Number of the `[[task]]` of the file (1 is the first) that gets a new target.
    pub(crate) task: Option<usize>,
    /// The new target, ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) target_m: Option<[f64; 3]>,
}

/// The body: a file, or the built-in adult.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelText {
    /// The built-in adult.
    pub(crate) adult: Option<AdultText>,
    /// Whether the parts of the built-in adult keep off each other, the floor and obstacles; true when left out.
    pub(crate) clearance: Option<bool>,
    /// Model file (.osim, .urdf, MJCF .xml), its path as seen from the scenario's folder.
    pub(crate) file: Option<String>,
    /// Ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the file; its path as that of `file`.
    pub(crate) overlay: Option<String>,
    /// Attachment of the root of a URDF or MJCF file; as the file says when left out.
    pub(crate) root: Option<RootText>,
    /// Whether the joints of a URDF or MJCF file have the strength that it gives to their motors; true when left out.
    pub(crate) file_strength: Option<bool>,
    /// The use of the muscles of a model file; when left out `both` for an OpenSim file with muscles, else `off`.
    pub(crate) muscles: Option<MusclesText>,
    /// Capsule and iliotibial tract of the hips beside these muscles; `off` when left out.
    pub(crate) hip_tract: Option<HipTissue>,
    /// The measure by which these muscles share torques; `squares` when left out.
    pub(crate) sharing: Option<SharingText>,
    /// The person whom a model file stands for: size of the built-in strength and passive torque.
    pub(crate) person: Option<PersonText>,
}

/// The person whom a model file stands for; what is left out comes from the model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PersonText {
    /// Sex; male when left out.
    pub(crate) sex: Option<SexText>,
    /// Stature, m, 1.2 to 2.3; in proportion to the mass when left out.
    pub(crate) stature_m: Option<f64>,
    /// Mass, kg, 30 to 250; the model's when left out.
    pub(crate) mass_kg: Option<f64>,
}

/// The use of the muscles of a model file.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MusclesText {
    /// None.
    Off,
    /// Strength of the joints that they cross, in each posture.
    Strength,
    /// Passive torque of the joints that they cross, in each posture.
    Passive,
    /// Strength and passive torque.
    Both,
}

/// Attachment of a root.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RootText {
    /// Fixed to ground.
    Fixed,
    /// Free: coordinates root_tx .. root_qz.
    Free,
}

/// Size of the built-in adult.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AdultText {
    /// The sex whose proportions count.
    pub(crate) sex: SexText,
    /// Stature, m, 1.2 to 2.3.
    pub(crate) stature_m: f64,
    /// Mass, kg, 30 to 250.
    pub(crate) mass_kg: f64,
    /// `whole`, or `right_arm` on a trunk that is fixed in ground.
    #[serde(default)]
    pub(crate) part: PartText,
    /// Measured segment lengths, m, by segment name without side (`femur`, `humerus`, ...).
    #[serde(default)]
    pub(crate) lengths_m: BTreeMap<String, f64>,
}

/// Part of the body that is modelled.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PartText {
    /// All of it.
    #[default]
    Whole,
    /// The right arm.
    RightArm,
}

impl Default for AdultText {
    fn default() -> Self {
        let adult = contrapposto::model::Adult::default();
        Self {
            sex: SexText::Male,
            stature_m: adult.stature,
            mass_kg: adult.mass,
            part: PartText::Whole,
            lengths_m: BTreeMap::new(),
        }
    }
}

/// Sex, as the body tables distinguish it.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SexText {
    /// De Leva's women.
    Female,
    /// De Leva's men.
    Male,
}

impl SexText {
    pub(crate) fn sex(self) -> contrapposto::model::Sex {
        match self {
            Self::Female => contrapposto::model::Sex::Female,
            Self::Male => contrapposto::model::Sex::Male,
        }
    }
}

/// Coordinates that may move: one of the two lists.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoordinatesText {
    /// Only these.
    pub(crate) free: Option<Vec<String>>,
    /// All but these.
    pub(crate) locked: Option<Vec<String>>,
}

/// Something held or pulling: `mass_kg` or `force_n`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LoadText {
    /// The segment that the load acts on.
    pub(crate) segment: String,
    /// A weight, kg.
    pub(crate) mass_kg: Option<f64>,
    /// A force, N.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) force_n: Option<[f64; 3]>,
    /// The point in the segment's frame, m; the segment's centre of mass when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) at_m: Option<[f64; 3]>,
    /// Whether the force keeps its direction in the world or in the segment; world when left out.
    pub(crate) fixed_in: Option<FixedInText>,
}

/// Axes that a force keeps.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FixedInText {
    /// Ground axes: x forward, y up, z right.
    World,
    /// The segment's axes.
    Segment,
}

/// The kind of relief that is wanted.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StrategyText {
    /// Ready or relaxed.
    pub(crate) kind: StrategyKindText,
    /// `R_min`: share of the torque that an active solution must remove, 0 to 1; 0.9 when left out.
    #[serde(default = "default_ratio")]
    pub(crate) minimum_decrease_ratio: f64,
    /// Other strategies for regions (`spine`, `neck`, `arms`, `legs`) or coordinates; `by_region` is the same.
    #[serde(default, alias = "by_region")]
    pub(crate) of: BTreeMap<String, StrategyKindText>,
}

fn title<'de, D: serde::Deserializer<'de>>(text: D) -> Result<String, D::Error> {
    let mut title = String::deserialize(text)?;
    if title.contains(turns_direction) {
        title = escaped(&title).into_owned();
    }
    Ok(title)
}

fn default_ratio() -> f64 {
    0.9
}

/// Active or passive.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StrategyKindText {
    /// Stay where muscles work well.
    Active,
    /// Let ligaments carry the load.
    Passive,
}

impl From<StrategyKindText> for Strategy {
    fn from(text: StrategyKindText) -> Self {
        match text {
            StrategyKindText::Active => Self::Active,
            StrategyKindText::Passive => Self::Passive,
        }
    }
}

/// Duration and time step of a run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunText {
    /// Simulated time, s.
    pub(crate) duration_s: f64,
    /// Time step, s; a thirtieth when left out.
    #[serde(default = "default_step")]
    pub(crate) step_s: f64,
    /// End as soon as relief no longer moves anything and no event is to come.
    #[serde(default)]
    pub(crate) stop_when_settled: bool,
}

fn default_step() -> f64 {
    1.0 / 30.0
}

/// JSON Schema of the scenario file.
pub fn scenario_schema() -> serde_json::Value {
    schemars::schema_for!(ScenarioText).to_value()
}
