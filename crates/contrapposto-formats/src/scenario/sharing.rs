//! The measure by which muscles share torques, in the words of a scenario.

use contrapposto::muscle::Sharing;
use schemars::JsonSchema;
use serde::Deserialize;

/// The sum of activations that is least where muscles share torques.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SharingText {
    /// Of squares, as in OpenSim by default.
    Squares,
    /// Of cubes: more muscles work, each less.
    Cubes,
}

impl From<SharingText> for Sharing {
    fn from(text: SharingText) -> Self {
        match text {
            SharingText::Squares => Self::Squares,
            SharingText::Cubes => Self::Cubes,
        }
    }
}
