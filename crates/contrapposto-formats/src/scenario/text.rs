//! The scenario file as it is written: one struct a table, unknown keys refused. See `docs/scenario.md`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::task_text::{SolverText, SupportText, TaskText};

/// An experiment: a body, its posture, loads, supports and tasks; for `simulate` the relief wanted and how long.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioText {
    /// Version of this format; 1.
    pub format: u32,
    /// What the experiment is called.
    #[serde(default)]
    pub title: String,
    /// The body; the built-in reference man when left out.
    #[serde(default)]
    pub model: ModelText,
    /// Passive curves by coordinate; the built-in curve of each coordinate when left out.
    #[serde(default)]
    pub passive: BTreeMap<String, PassiveText>,
    /// Start: `NAME_deg` for rotations, `NAME_m` for slides, bare names for quaternions. What is not named is at its default.
    #[serde(default)]
    pub posture: BTreeMap<String, f64>,
    /// Which coordinates may move; all when left out.
    #[serde(default)]
    pub coordinates: CoordinatesText,
    /// Held weights and forces.
    #[serde(default)]
    pub load: Vec<LoadText>,
    /// What carries weight.
    #[serde(default)]
    pub support: Vec<SupportText>,
    /// What the body should do, in order of priority.
    #[serde(default)]
    pub task: Vec<TaskText>,
    /// How a pose is solved (`pose`).
    pub solver: Option<SolverText>,
    /// What kind of relief is wanted; `simulate` needs it.
    pub strategy: Option<StrategyText>,
    /// How relief is carried out (`simulate`).
    #[serde(default)]
    pub relief: ReliefText,
    /// How muscle groups tire (`simulate`).
    #[serde(default)]
    pub fatigue: FatigueText,
    /// What changes on the way (`simulate`).
    #[serde(default)]
    pub event: Vec<EventText>,
    /// How long; `simulate` needs it.
    pub run: Option<RunText>,
}

/// Something that changes during a run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EventText {
    /// When, s; by the last step of the run.
    pub at_s: f64,
    /// Strategy of the whole body from then on.
    pub strategy: Option<StrategyKindText>,
    /// Strategy of regions (`spine`, `neck`, `arms`, `legs`) or coordinates from then on.
    #[serde(default)]
    pub strategy_of: BTreeMap<String, StrategyKindText>,
    /// Loads from then on, in place of those before; empty to put everything down.
    pub load: Option<Vec<LoadText>>,
    /// Which `[[task]]` of the file (1 is the first) gets a new target.
    pub task: Option<usize>,
    /// The new target, ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub target_m: Option<[f64; 3]>,
}

/// Which body: a file, or the built-in adult.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelText {
    /// The built-in adult.
    pub adult: Option<AdultText>,
    /// Model file (.osim, .urdf, MJCF .xml), its path as seen from the scenario's folder.
    pub file: Option<String>,
    /// Ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the file; its path as that of `file`.
    pub overlay: Option<String>,
    /// How the root of a URDF or MJCF file is attached; as the file says when left out.
    pub root: Option<RootText>,
}

/// How a root is attached.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RootText {
    /// Fixed to ground.
    Fixed,
    /// Free: coordinates root_tx .. root_qz.
    Free,
}

/// Size of the built-in adult.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdultText {
    /// Whose proportions.
    pub sex: SexText,
    /// Stature, m, 1.2 to 2.3.
    pub stature_m: f64,
    /// Mass, kg, 30 to 250.
    pub mass_kg: f64,
    /// `whole`, or `right_arm` on a trunk that is fixed in ground.
    #[serde(default)]
    pub part: PartText,
    /// Measured segment lengths, m, by segment name without side (`femur`, `humerus`, ...).
    #[serde(default)]
    pub lengths_m: BTreeMap<String, f64>,
}

/// How much of the body.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PartText {
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
pub enum SexText {
    /// De Leva's women.
    Female,
    /// De Leva's men.
    Male,
}

/// A passive curve: one of `curve`, `double_exponential`, `coordinate_limit_force`, `table`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PassiveText {
    /// Name of a built-in curve, in that curve's own direction.
    pub curve: Option<String>,
    /// The canonical double exponential.
    pub double_exponential: Option<DoubleExponentialText>,
    /// OpenSim's CoordinateLimitForce.
    pub coordinate_limit_force: Option<CoordinateLimitForceText>,
    /// Measured points `[angle in deg, torque in N m]`, torques falling.
    #[serde(default, deserialize_with = "rows")]
    pub table_deg_nm: Option<Vec<[f64; 2]>>,
    /// Linear terms near both limits: `true`, or zone and torque.
    pub reshape: Option<ReshapeText>,
}

/// `lower.torque exp(-lower.rate (q - lower.angle)) - upper.torque exp(upper.rate (q - upper.angle)) - stiffness (q - neutral)`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DoubleExponentialText {
    /// Resists at the lower end.
    pub lower: EndText,
    /// Resists at the upper end.
    pub upper: EndText,
    /// Mid-range stiffness, N m/rad; 0 when left out.
    #[serde(default)]
    pub stiffness_nm_per_rad: f64,
    /// Where the linear term is zero, deg; 0 when left out.
    #[serde(default)]
    pub neutral_deg: f64,
}

/// One end of the double exponential.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EndText {
    /// Size of the torque at `angle_deg`, N m, not negative.
    pub torque_nm: f64,
    /// Growth toward the end, 1/rad, positive.
    pub rate_per_rad: f64,
    /// Where the torque has this size, deg.
    pub angle_deg: f64,
}

/// OpenSim's CoordinateLimitForce in its own units.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CoordinateLimitForceText {
    /// N m/deg above the upper limit.
    pub upper_stiffness_nm_per_deg: f64,
    /// deg.
    pub upper_limit_deg: f64,
    /// N m/deg below the lower limit.
    pub lower_stiffness_nm_per_deg: f64,
    /// deg.
    pub lower_limit_deg: f64,
    /// Width of the transition, deg.
    pub transition_deg: f64,
}

/// Linear terms near both limits.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ReshapeText {
    /// The default zone and torque, or none.
    Default(bool),
    /// Stated.
    Stated(ReshapeStated),
}

/// Zone and torque of the linear terms.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReshapeStated {
    /// Width of each zone, deg.
    pub zone_deg: f64,
    /// Torque that passive tissue reaches at the limits at least, N m.
    pub end_torque_nm: f64,
}

/// Which coordinates may move: one of the two lists.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CoordinatesText {
    /// Only these.
    pub free: Option<Vec<String>>,
    /// All but these.
    pub locked: Option<Vec<String>>,
}

/// Something held or pulling: `mass_kg` or `force_n`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadText {
    /// Which segment.
    pub segment: String,
    /// A weight, kg.
    pub mass_kg: Option<f64>,
    /// A force, N.
    #[serde(default, deserialize_with = "numbers")]
    pub force_n: Option<[f64; 3]>,
    /// Where, in the segment's frame, m; its centre of mass when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub at_m: Option<[f64; 3]>,
    /// Whether the force keeps its direction in the world or in the segment; world when left out.
    pub fixed_in: Option<FixedInText>,
}

/// Axes that a force keeps.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FixedInText {
    /// Ground axes: x forward, y up, z right.
    World,
    /// The segment's axes.
    Segment,
}

/// What kind of relief is wanted.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StrategyText {
    /// Ready or relaxed.
    pub kind: StrategyKindText,
    /// `R_min`: share of the torque that an active solution must remove, 0 to 1; 0.9 when left out.
    #[serde(default = "default_ratio")]
    pub minimum_decrease_ratio: f64,
    /// Other strategies for regions (`spine`, `neck`, `arms`, `legs`) or coordinates; `by_region` is the same.
    #[serde(default, alias = "by_region")]
    pub of: BTreeMap<String, StrategyKindText>,
}

fn default_ratio() -> f64 {
    0.9
}

/// Active or passive.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StrategyKindText {
    /// Stay where muscles work well.
    Active,
    /// Let ligaments carry the load.
    Passive,
}

/// How relief is carried out.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ReliefText {
    /// Share of the way to the goal in one step (beta), above 0, below 1.
    pub step_gain: f64,
    /// Greatest step, deg; 2 when left out, half a degree for a body with supports or tasks.
    pub max_step_deg: Option<f64>,
    /// Active torque that counts as none (eps), N m; 0.05 when left out, 0.5 for a body with supports or tasks.
    pub torque_tolerance_nm: Option<f64>,
    /// `total`, or `literal` for the paper's tables as printed.
    pub tables: TablesText,
}

impl Default for ReliefText {
    fn default() -> Self {
        Self { step_gain: 0.3, max_step_deg: None, torque_tolerance_nm: None, tables: TablesText::Total }
    }
}

/// Reading of the paper's Tables 1 and 2.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TablesText {
    /// Gaps closed, an accepted strategy kept.
    Total,
    /// As printed.
    Literal,
}

/// How muscle groups tire.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FatigueText {
    /// `three_compartment` (3CC-r) or `endurance`.
    pub law: LawText,
    /// Endurance curve of every group, by name; each joint's own of Frey-Law & Avin 2010 when left out.
    pub curve: Option<String>,
    /// Fatigue at which a group asks for relief, above 0, at most 1.
    pub critical_level: f64,
    /// Fatigue below which it no longer does.
    pub recovery_level: f64,
    /// Fatigue at the start, 0 rested to 1 exhausted; rested when left out.
    pub start: BTreeMap<String, StartText>,
}

impl Default for FatigueText {
    fn default() -> Self {
        let start = BTreeMap::new();
        Self { law: LawText::ThreeCompartment, curve: None, critical_level: 0.6, recovery_level: 0.3, start }
    }
}

/// Fatigue law.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LawText {
    /// Three-compartment controller with rest recovery.
    ThreeCompartment,
    /// Integral of time over endurance time.
    Endurance,
}

/// Fatigue of the two groups of a coordinate at the start.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StartText {
    /// Group that pulls toward larger values.
    pub positive: f64,
    /// Group that pulls toward smaller values.
    pub negative: f64,
}

/// How long, and how finely.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunText {
    /// Simulated time, s.
    pub duration_s: f64,
    /// Time step, s; a thirtieth when left out.
    #[serde(default = "default_step")]
    pub step_s: f64,
    /// End as soon as relief no longer moves anything and no event is to come.
    #[serde(default)]
    pub stop_when_settled: bool,
}

fn default_step() -> f64 {
    1.0 / 30.0
}

/// Exactly so many numbers: the TOML reader itself passes over surplus ones.
pub(super) fn numbers<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<[f64; N]>, D::Error> {
    let list = Vec::<f64>::deserialize(from)?;
    let given = list.len();
    list.try_into().map(Some).map_err(|_| D::Error::custom(format!("{given} numbers are given; {N} are due")))
}

/// Rows of exactly so many numbers.
pub(super) fn rows<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<Vec<[f64; N]>>, D::Error> {
    let rows = Vec::<Vec<f64>>::deserialize(from)?;
    let row = |row: Vec<f64>| {
        let given = row.len();
        row.try_into().map_err(|_| D::Error::custom(format!("a row of {given} numbers; {N} are due in each")))
    };
    rows.into_iter().map(row).collect::<Result<_, _>>().map(Some)
}
