//! Holds the settings of relief as a scenario file writes them.

use schemars::JsonSchema;
use serde::Deserialize;

/// Settings of relief.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ReliefText {
    /// Share of the way to the goal in one step (beta), above 0, below 1.
    pub(crate) step_gain: f64,
    /// Greatest step, deg; 2 when left out, half a degree for a body with supports or tasks.
    pub(crate) max_step_deg: Option<f64>,
    /// Active torque that counts as none (eps), N m; 0.05 when left out, 0.5 for a body with supports or tasks.
    pub(crate) torque_tolerance_nm: Option<f64>,
    /// Relief may raise the effort of a body with supports or tasks to so many times the effort before all present reliefs, at
    /// least 1.
    pub(crate) effort_factor: f64,
    /// `total`, or `literal` for the paper's tables as printed.
    pub(crate) tables: TablesText,
}

impl Default for ReliefText {
    fn default() -> Self {
        Self {
            step_gain: 0.3,
            max_step_deg: None,
            torque_tolerance_nm: None,
            effort_factor: 1.25,
            tables: TablesText::Total,
        }
    }
}

/// Reading of the paper's Tables 1 and 2.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TablesText {
    /// Gaps closed, an accepted strategy kept.
    Total,
    /// As printed.
    Literal,
}
