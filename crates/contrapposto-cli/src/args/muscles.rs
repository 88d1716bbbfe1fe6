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
    /// Leaves to the muscles of a model what is asked of them.
    pub(crate) fn apply(&self, opened: &mut SourcedModel) -> Result<(), Fail> {
        let uses = match self.muscles {
            None => opened.default_muscle_use(),
            Some(MuscleChoice::Off) => MuscleUse::Off,
            Some(MuscleChoice::Strength) => MuscleUse::Strength,
            Some(MuscleChoice::Passive) => MuscleUse::Passive,
            Some(MuscleChoice::Both) => MuscleUse::Both,
        };
        if opened.use_muscles(uses) || uses == MuscleUse::Off {
            return Ok(());
        }
        let why = "no muscle could be read from MODEL; it must be an OpenSim or MJCF file with muscles, and `contrapposto inspect` counts them";
        Err(Fail::Refused(format!("--muscles: {why}")))
    }
}
