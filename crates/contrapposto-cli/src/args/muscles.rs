//! Arguments about the use of a model's muscles.

use clap::ValueEnum;
use contrapposto_formats::tissue::{MuscleUse, SourcedModel};

use crate::fail::Fail;

/// The use of the muscles of a model file.
#[derive(Debug, clap::Args)]
pub(crate) struct MuscleArgs {
    /// The muscles of MODEL give strength, passive torque, both or nothing to the joints that they cross, in each posture and in place
    /// of the built-in data; without it `both` for an OpenSim file with muscles, else `off`.
    #[arg(long, value_enum, value_name = "USE")]
    pub(crate) muscles: Option<MuscleChoice>,
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
