//! Adds capsule and iliotibial tract to hips whose passive torque is that of a model's muscles.

use contrapposto::joint_torques::{HipTract, hip_tract};
use contrapposto::model::Side;
use schemars::JsonSchema;
use serde::Deserialize;

use super::SourcedModel;
use super::origin::Origin;

/// Capsule and iliotibial tract of the hips beside the muscles of a model file: of a person whose relaxed leg sinks as far in the modified Ober test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HipTissue {
    /// None.
    Off,
    /// To 24.6 degrees, the mean.
    Mean,
    /// To 17.3 degrees, a standard deviation less.
    Stiff,
    /// To 31.9 degrees, a standard deviation more.
    Flexible,
}

impl HipTissue {
    /// Standard deviations by which the leg sinks farther than the mean; `None` without tissue.
    fn deviations(self) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::Mean => Some(0.0),
            Self::Stiff => Some(-1.0),
            Self::Flexible => Some(1.0),
        }
    }
}

impl SourcedModel {
    /// Adds capsule and iliotibial tract beside the muscles to which [`SourcedModel::use_muscles`] left the passive torque of a hip's adduction, with
    /// a note of their size. `library` is the same model without its muscles: it knows which coordinate is the adduction of a hip.
    ///
    /// # Errors
    /// Says that no muscles give a hip its passive torque.
    pub fn add_hip_tracts(&mut self, library: &Self, tissue: HipTissue) -> Result<(), String> {
        let Some(deviations) = tissue.deviations() else { return Ok(()) };
        let is_hip = |i: &usize| {
            library.origins[*i].twin.as_deref().is_some_and(|twin| twin.starts_with("hip_adduction"))
                && self.origins[*i].passive == Origin::Muscles
        };
        let hips: Vec<usize> = (0..self.model.coordinates().len()).filter(is_hip).collect();
        let (mut added, mut said) = (vec![], vec![]);
        for hip in hips {
            let sense = if library.origins[hip].turned { Side::Negative } else { Side::Positive };
            let tract = hip_tract(&self.model, &self.muscles, (hip, sense), deviations);
            let Some(tract) = tract.map_err(|error| error.to_string())? else { continue };
            said.push(in_words(&self.model.coordinates()[hip].name, &tract));
            added.push(tract.bushing);
        }
        if added.is_empty() {
            return Err(
                "no hip has its passive torque from muscles: leave `hip_tract` out, or write muscles = \"both\""
                    .to_owned(),
            );
        }
        self.muscles.bushings.extend(added);
        self.notes.push(format!(
            "capsule and iliotibial tract beside the muscles (derived from the modified Ober test, Ferber 2010; rate assumed): {}",
            said.join(", ")
        ));
        Ok(())
    }
}

/// `` `hip_adduction_r` 21.3 N m at 24.6°, where its muscles have 8.0 N m``.
fn in_words(name: &str, tract: &HipTract) -> String {
    let (torque, degrees) = (tract.torque(), tract.angle.to_degrees());
    format!(
        "`{name}` {torque:.1} N m at {degrees:.1}° of adduction, where its muscles have {:.1} N m",
        tract.of_muscles
    )
}
