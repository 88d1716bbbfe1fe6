//! Chooses the size of the adult whose strength and passive torque a model file gets.
//!
//! Mass is that of the model, where it is an adult's; stature is that of the reference man or woman times the cube root of the ratio
//! of the masses (equal shape and density). Sex is male. Each of them can be given.

use contrapposto::model::{Adult, Model, Sex};

/// The person whom a model file stands for, as far as is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Person {
    /// Sex; male when left out.
    pub sex: Option<Sex>,
    /// Stature, m; in proportion to the mass when left out.
    pub stature: Option<f64>,
    /// Mass, kg; the model's when left out, or the reference mass where the model's is no adult's.
    pub mass: Option<f64>,
}

impl Person {
    /// The adult of this size.
    pub fn size(&self, model: &Model) -> Adult {
        let reference = Adult::reference(self.sex.unwrap_or(Sex::Male));
        let whole = Some(model.mass()).filter(|mass| Adult::MASSES.contains(mass));
        let mass = self.mass.or(whole).unwrap_or(reference.mass);
        let (least, greatest) = (*Adult::STATURES.start(), *Adult::STATURES.end());
        let in_proportion = (reference.stature * libm::cbrt(mass / reference.mass)).clamp(least, greatest);
        Adult { stature: self.stature.unwrap_or(in_proportion), mass, ..reference }
    }

    /// The origin of the size, for the reader of the notes.
    pub(super) fn said(&self, model: &Model, size: &Adult) -> String {
        let word = if size.sex == Sex::Female { "woman" } else { "man" };
        let from = |given: bool, otherwise: &'static str| if given { "given" } else { otherwise };
        let whole = Adult::MASSES.contains(&model.mass());
        let mass = from(
            self.mass.is_some(),
            if whole { "the model's" } else { "the reference, for the model's is no adult's" },
        );
        let stature = from(self.stature.is_some(), "in proportion to the mass");
        let sex = from(self.sex.is_some(), "assumed");
        format!(
            "built-in strength and passive torque are those of a {word} ({sex}) of {:.1} kg ({mass}) and {:.2} m ({stature}); \
             `person` says otherwise",
            size.mass, size.stature
        )
    }
}
