//! Maps an error of the science crate to the path of the key whose value was refused.

use contrapposto::model::{AdultError, AdultMeasure};
use contrapposto::simulation::{ScenarioError, Setting};
use contrapposto::statics::{LoadError, LoadQuantity};
use contrapposto::tasks::{TaskError, TaskPart};

/// The path of a number of the built-in adult.
pub(super) fn adult_path(error: &AdultError) -> Vec<&str> {
    let size = |key| vec!["model", "adult", key];
    match error {
        AdultError::Size { measure: AdultMeasure::Stature, .. } => size("stature_m"),
        AdultError::Size { measure: AdultMeasure::Mass, .. } => size("mass_kg"),
        AdultError::Size { measure: AdultMeasure::SegmentLength(name), .. } | AdultError::Length { name, .. } => {
            vec!["model", "adult", "lengths_m", name]
        }
        _ => vec!["model", "adult"],
    }
}

/// The key of a number in the table of a load.
pub(super) fn load_key(error: &LoadError) -> &'static str {
    match error {
        LoadError::Number { quantity, .. } => match quantity {
            LoadQuantity::Point => "at_m",
            LoadQuantity::Force | LoadQuantity::Couple => "force_n",
            LoadQuantity::Mass => "mass_kg",
        },
        _ => "segment",
    }
}

/// The path of a number in the table of a task; `kind` for an error that concerns the task as a whole.
pub(super) fn task_path(error: &TaskError) -> &'static [&'static str] {
    match error {
        TaskError::Number { part, .. } | TaskError::Empty { part, .. } => part_path(*part),
        TaskError::Unable { .. } => &["coordinates"],
        TaskError::Posture(_) => &["values"],
        _ => &["kind"],
    }
}

fn part_path(part: TaskPart) -> &'static [&'static str] {
    match part {
        TaskPart::Point => &["at_m"],
        TaskPart::PointA => &["a", "at_m"],
        TaskPart::PointB => &["b", "at_m"],
        TaskPart::Target => &["target_m"],
        TaskPart::TargetDirection => &["target_direction"],
        TaskPart::TargetQuaternion => &["target_quaternion"],
        TaskPart::Eye => &["eye_m"],
        TaskPart::Direction => &["direction"],
        TaskPart::LowerLimit | TaskPart::UpperLimit => &["range_m"],
        TaskPart::Margin => &["margin_m"],
        TaskPart::EdgeOffset | TaskPart::EdgeNormal | TaskPart::Edge => &["polygon_m"],
        TaskPart::Weight | TaskPart::WeightedCoordinate => &["weights"],
        TaskPart::LeastStrength | TaskPart::Coordinate => &["coordinates"],
        TaskPart::Axis => &["axes"],
        // No file writes limits or shapes of its own.
        TaskPart::Limit
        | TaskPart::Pair
        | TaskPart::Activation
        | TaskPart::CapsuleEnd
        | TaskPart::Radius
        | TaskPart::SurfaceNormal
        | TaskPart::SurfaceOffset
        | TaskPart::BlockMiddle
        | TaskPart::BlockLength => &["kind"],
    }
}

/// The path of a setting of a simulation; empty for an error that concerns no single key.
pub(super) fn scenario_path(error: &ScenarioError) -> &'static [&'static str] {
    match error {
        ScenarioError::Setting { setting, .. } => setting_path(*setting),
        ScenarioError::NoPassiveCurve(_) => &["coordinates", "free"],
        ScenarioError::OutsideRange { .. } => &["posture"],
        _ => &[],
    }
}

fn setting_path(setting: Setting) -> &'static [&'static str] {
    match setting {
        Setting::MinimumDecreaseRatio => &["strategy", "minimum_decrease_ratio"],
        Setting::EventTime => &["event"],
        Setting::StepGain => &["relief", "step_gain"],
        Setting::MaxStep => &["relief", "max_step_deg"],
        Setting::TorqueTolerance => &["relief", "torque_tolerance_nm"],
        Setting::EffortFactor => &["relief", "effort_factor"],
        Setting::CriticalLevel => &["fatigue", "critical_level"],
        Setting::RecoveryLevel => &["fatigue", "recovery_level"],
        Setting::StartFatigue => &["fatigue", "start"],
        Setting::Duration | Setting::Steps => &["run", "duration_s"],
        Setting::TimeStep => &["run", "step_s"],
        // The reader makes these lists as long as the model asks, and counts tasks itself.
        Setting::FreeFlags | Setting::Strategies | Setting::FatiguePairs | Setting::EventTask => &[],
    }
}
