//! Arguments about the use of a model's muscles.

use clap::ValueEnum;
use contrapposto::joint_torques::JointMuscles;
use contrapposto::muscle::Sharing;
use contrapposto_formats::tissue::{MuscleUse, SourcedModel};

use crate::fail::Fail;

/// The use of the muscles of a model file.
#[derive(Debug, clap::Args)]
pub(crate) struct MuscleArgs {
    /// The muscles of MODEL give strength, passive torque, both or nothing to the joints that they cross, in each posture and in place
    /// of the built-in data; without it `both` for an OpenSim file with muscles, else `off`.
    #[arg(long, value_enum, value_name = "USE")]
    pub(crate) muscles: Option<MuscleChoice>,
    #[command(flatten)]
    pub(crate) sharing: SharingArgs,
}

/// The measure by which muscles share the torques of joints.
#[derive(Debug, clap::Args)]
pub(crate) struct SharingArgs {
    /// Muscles that give strength share active torques at the least sum of squared or of cubed activations; cubes let more muscles work, each less.
    #[arg(long, value_enum, value_name = "MEASURE", default_value = "squares")]
    pub(crate) sharing: SharingChoice,
}

/// A sum that is least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SharingChoice {
    /// Of squared activations, as in OpenSim by default.
    Squares,
    /// Of cubed activations.
    Cubes,
}

impl SharingArgs {
    /// The muscles, sharing torques by the measure.
    pub(crate) fn of(&self, muscles: Option<JointMuscles>) -> Option<JointMuscles> {
        let sharing = match self.sharing {
            SharingChoice::Squares => Sharing::Squares,
            SharingChoice::Cubes => Sharing::Cubes,
        };
        muscles.map(|muscles| muscles.with_sharing(sharing))
    }
}

/// The quantities that muscles give.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MuscleChoice {
    /// Nothing.
    Off,
    /// Strength: the greatest torque beyond passive torque, a plain sum over muscles.
    Strength,
    /// Passive torque: that of resting fibres, ligaments and springs.
    Passive,
    /// Strength and passive torque.
    Both,
}

impl MuscleArgs {
    /// The use that is asked of muscles, and the name of the key that asks; without a use the default of the model.
    pub(crate) fn asked(&self) -> (Option<MuscleUse>, &'static str) {
        let uses = self.muscles.map(|choice| match choice {
            MuscleChoice::Off => MuscleUse::Off,
            MuscleChoice::Strength => MuscleUse::Strength,
            MuscleChoice::Passive => MuscleUse::Passive,
            MuscleChoice::Both => MuscleUse::Both,
        });
        (uses, "--muscles")
    }
}

/// Leaves to the muscles of a model what is asked of them under the name `key`.
pub(crate) fn use_muscles(opened: &mut SourcedModel, (uses, key): (Option<MuscleUse>, &str)) -> Result<(), Fail> {
    let uses = uses.unwrap_or_else(|| opened.default_muscle_use());
    if opened.use_muscles(uses) || uses == MuscleUse::Off {
        return Ok(());
    }
    let why = "no muscle could be read from the model; it must be an OpenSim or MJCF file with muscles, and `contrapposto \
        inspect` counts them";
    Err(Fail::Refused(format!("{key}: {why}")))
}
