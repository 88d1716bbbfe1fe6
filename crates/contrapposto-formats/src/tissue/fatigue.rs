//! Gives the muscle groups of a model the fatigue law that a file or a command asks for.
//!
//! A group is known by its movement (`knee extension`). Laws of an overlay stay three-compartment laws with their own parameters,
//! because the overlay names them; the endurance law replaces them by the curve of their class.

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::data::{self, FatigueSet};
use contrapposto::model::{Model, MuscleGroup, Sex};
use serde::Serialize;

use super::origin::Origin;
use super::{Origins, SourcedModel};
use crate::overlay::GENERAL;

/// Sex whose parameters are taken, where a set distinguishes the sexes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FatigueSex {
    /// The sex of the body; both together where the body has none, as models of other programs.
    #[default]
    OfBody,
    /// Women's.
    Female,
    /// Men's.
    Male,
    /// Both together.
    Any,
}

/// The fatigue law of all muscle groups.
#[derive(Clone, Debug, PartialEq)]
pub enum FatigueChoice {
    /// Three-compartment controller with the parameters of a published set.
    ThreeCompartment(FatigueSet, FatigueSex),
    /// Endurance integral: this law for every group, or the curve of each group's class (Frey-Law & Avin 2010).
    Endurance(Option<FatigueLaw>),
}

impl Default for FatigueChoice {
    fn default() -> Self {
        Self::ThreeCompartment(FatigueSet::default(), FatigueSex::default())
    }
}

impl SourcedModel {
    /// The model with this fatigue law in all muscle groups that there are now.
    #[must_use]
    pub fn with_fatigue(mut self, choice: &FatigueChoice) -> Self {
        for index in 0..self.origins.len() {
            let Some(mut groups) = self.model.coordinates()[index].groups.clone() else { continue };
            for group in &mut groups {
                group.fatigue = chosen(choice, group, &self.origins[index], self.sex);
            }
            self.model = self.model.with_groups(index, groups);
        }
        self
    }
}

fn chosen(choice: &FatigueChoice, group: &MuscleGroup, origins: &Origins, of_body: Option<Sex>) -> FatigueLaw {
    // The file gives the strength of motors, which do not tire.
    if origins.fatigue == Origin::File {
        return group.fatigue.clone();
    }
    let library = data::library();
    let law = match choice {
        FatigueChoice::ThreeCompartment(..) if origins.fatigue != Origin::Library => None,
        FatigueChoice::ThreeCompartment(set, sex) => {
            let sex = match sex {
                FatigueSex::OfBody => of_body,
                FatigueSex::Female => Some(Sex::Female),
                FatigueSex::Male => Some(Sex::Male),
                FatigueSex::Any => None,
            };
            library.fatigue_law(&group.name, *set, sex)
        }
        FatigueChoice::Endurance(Some(law)) => Some(law.clone()),
        FatigueChoice::Endurance(None) => {
            let named = Some(group.fatigue.name()).filter(|_| origins.fatigue == Origin::Overlay);
            let class = named.or_else(|| library.fatigue_class(&group.name)).unwrap_or(GENERAL);
            library.endurance(&library.default_endurance(class)).map(|(law, _)| law)
        }
    };
    law.unwrap_or_else(|| group.fatigue.clone())
}

/// The parameters of one muscle group, as result files name them.
#[derive(Clone, Debug, Serialize)]
pub struct FatigueParametersText {
    /// Name of the parameters or of the endurance curve; `inspect` gives the numbers and the source.
    pub parameters: String,
    /// Status of the weakest part: the numbers, the rest multiplier, or their use for this movement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<String>,
}

impl FatigueParametersText {
    /// Of one muscle group.
    pub fn new(group: &MuscleGroup) -> Self {
        let reference = data::library().fatigue_reference(&group.name, &group.fatigue);
        Self {
            parameters: group.fatigue.name().to_owned(),
            status: reference.map(|reference| reference.status.to_string()),
        }
    }
}

/// One sentence for each row of the set by muscle groups that is in use, and one for the movements that keep the fit of their
/// joint; none where all groups have the fits of joints or endurance curves.
pub fn fatigue_notes(model: &Model) -> Vec<String> {
    let library = data::library();
    let mut rows: Vec<(&str, Vec<&str>)> = vec![];
    for group in model.coordinates().iter().filter_map(|c| c.groups.as_ref()).flatten() {
        let law = match &group.fatigue {
            FatigueLaw::ThreeCompartment(law) => law,
            FatigueLaw::Tireless => continue,
            FatigueLaw::Endurance(_) => return vec![],
        };
        let at = rows.iter().position(|(name, _)| *name == law.name).unwrap_or_else(|| {
            rows.push((&law.name, vec![]));
            rows.len() - 1
        });
        if !rows[at].1.contains(&group.name.as_str()) {
            rows[at].1.push(&group.name);
        }
    }
    let of_joint = |name: &str| library.three_compartment(name).is_some();
    if rows.iter().all(|(name, _)| of_joint(name)) {
        return vec![];
    }
    let sentence = |(name, movements): (&str, Vec<&str>)| {
        let mut groups = model.coordinates().iter().filter_map(|c| c.groups.as_ref()).flatten();
        let group = groups.find(|group| group.fatigue.name() == name)?;
        let FatigueLaw::ThreeCompartment(law) = &group.fatigue else { return None };
        let status = library.fatigue_reference(&group.name, &group.fatigue).map(|r| format!("; {}", r.status));
        let fit = if of_joint(name) { "no muscle group of its own, the joint fit " } else { "" };
        Some(format!(
            "fatigue of {}: {fit}`{name}`, F {} /s, R {} /s, r {}{}",
            movements.join(", "),
            law.fatigue_rate,
            law.recovery_rate,
            law.rest_multiplier,
            status.unwrap_or_default()
        ))
    };
    rows.into_iter().filter_map(sentence).collect()
}
