//! Finds the fatigue law of a movement in the embedded data, and the source of its parameters.
//!
//! A movement is named as in `data/strength.toml` (`knee_extension`) or as a muscle group prints it (`knee extension`).

use super::fatigue_rows::{MuscleGroupRow, MuscleGroupUseRow, SexOfRow};
use super::{Library, Reference};
use crate::fatigue::{Endurance, EnduranceCurve, FatigueLaw, ThreeCompartment};
use crate::model::adult_size::Sex;

/// A published set of parameters of the three-compartment controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FatigueSet {
    /// One fit a joint: Frey-Law, Looft & Heitsman 2012.
    #[default]
    Joint,
    /// One fit a functional muscle group and sex: Rakshit, Xiang & Yang 2021. Movements without a group keep the fit of the joint.
    MuscleGroup,
}

impl Library {
    /// 3CC-r of a fatigue class (`elbow`, `shoulder`, ...), with the reference of its fatigue and recovery rates.
    pub fn three_compartment(&self, class: &str) -> Option<(FatigueLaw, &Reference)> {
        let row = self.fatigue.three_compartment.iter().find(|row| row.class == class)?;
        let law = ThreeCompartment {
            name: row.class.clone(),
            fatigue_rate: row.fatigue_per_s,
            recovery_rate: row.recovery_per_s,
            rest_multiplier: row.rest_multiplier,
        };
        Some((FatigueLaw::ThreeCompartment(law), &row.reference))
    }

    /// Names of all fatigue classes, in the file's order.
    pub fn fatigue_classes(&self) -> impl Iterator<Item = &str> {
        self.fatigue.three_compartment.iter().map(|row| row.class.as_str())
    }

    /// Names of all movements with a fatigue class, in the file's order.
    pub fn movements(&self) -> impl Iterator<Item = &str> {
        self.fatigue.joint_use.iter().flat_map(|row| &row.movements).map(String::as_str)
    }

    /// The fatigue class of a movement.
    pub fn fatigue_class(&self, movement: &str) -> Option<&str> {
        let mut rows = self.fatigue.joint_use.iter();
        rows.find(|row| lists(&row.movements, movement)).map(|row| row.class.as_str())
    }

    /// 3CC-r of a movement with the parameters of `set`. `sex`: that of the body; `None` takes the fit to both sexes. A group
    /// without a fit to that sex has the fit to both.
    pub fn fatigue_law(&self, movement: &str, set: FatigueSet, sex: Option<Sex>) -> Option<FatigueLaw> {
        let group = self.muscle_group_use(movement).filter(|_| set == FatigueSet::MuscleGroup);
        let Some(group) = group else {
            return self.fatigue_class(movement).and_then(|class| self.three_compartment(class)).map(|(law, _)| law);
        };
        let of = |sex| self.fatigue.muscle_group.iter().find(|row| row.group == group.group && row.sex == sex);
        let row = of(SexOfRow::of(sex)).or_else(|| of(SexOfRow::Any))?;
        Some(FatigueLaw::ThreeCompartment(ThreeCompartment {
            name: row.name(),
            fatigue_rate: row.fatigue_per_s,
            recovery_rate: row.recovery_per_s,
            rest_multiplier: row.rest_multiplier.unwrap_or(self.fatigue.muscle_group_set.rest_multiplier),
        }))
    }

    /// Source of the parameters of a law of these data, and of their use for `movement`. The status is the weakest of them.
    /// `None` for a law of other data.
    pub fn fatigue_reference(&self, movement: &str, law: &FatigueLaw) -> Option<Reference> {
        let name = law.name();
        if let FatigueLaw::Endurance(_) = law {
            return self.endurance(name).map(|(_, reference)| reference.clone());
        }
        if let Some(row) = self.fatigue.three_compartment.iter().find(|row| row.class == name) {
            let mut uses = self.fatigue.joint_use.iter();
            let assigned = uses.find(|row| row.class == name && lists(&row.movements, movement));
            let rest = Reference { status: row.rest_multiplier_status, source: String::new(), note: String::new() };
            return Some(together(&row.reference, &rest, assigned.map(|row| &row.reference)));
        }
        let row = self.fatigue.muscle_group.iter().find(|row| row.name() == name)?;
        let set = &self.fatigue.muscle_group_set;
        let rest = match row.rest_multiplier {
            Some(_) => Reference { status: set.reference.status, source: String::new(), note: String::new() },
            None => Reference {
                status: set.rest_multiplier_status,
                source: set.rest_multiplier_source.clone(),
                note: String::new(),
            },
        };
        let assigned = self.muscle_group_use(movement).filter(|assigned| assigned.group == row.group);
        Some(together(&set.reference, &rest, assigned.map(|row| &row.reference)))
    }

    /// Published laws of a movement's class with a checked source: the controller's, the endurance curve of Frey-Law & Avin 2010 of the
    /// class and their general one.
    pub fn published_laws(&self, movement: &str) -> Vec<FatigueLaw> {
        let Some(class) = self.fatigue_class(movement) else { return vec![] };
        let curves = [class, "general"].map(|class| self.endurance(&self.default_endurance(class)));
        let curves = curves.into_iter().flatten().map(|(law, _)| law);
        self.three_compartment(class).map(|(law, _)| law).into_iter().chain(curves).collect()
    }

    /// Standard deviation of a movement's strength between people over its mean, and where that comes from.
    pub fn strength_variation(&self, movement: &str) -> Option<(f64, &Reference)> {
        let row = self.strength.variation.iter().find(|row| lists(&row.movements, movement))?;
        Some((row.coefficient, &row.reference))
    }

    fn muscle_group_use(&self, movement: &str) -> Option<&MuscleGroupUseRow> {
        self.fatigue.muscle_group_use.iter().find(|row| lists(&row.movements, movement))
    }

    /// The endurance integral with the curve of that name, with the curve's reference.
    pub fn endurance(&self, name: &str) -> Option<(FatigueLaw, &Reference)> {
        let row = self.fatigue.endurance.iter().find(|row| row.name == name)?;
        let curve = EnduranceCurve { name: row.name.clone(), form: row.form()? };
        let law = Endurance { curve, recovery_rate: self.fatigue.recovery.rate_per_s };
        Some((FatigueLaw::Endurance(law), &row.reference))
    }

    /// Names of all endurance curves.
    pub fn endurance_names(&self) -> impl Iterator<Item = &str> {
        self.fatigue.endurance.iter().map(|row| row.name.as_str())
    }

    /// The default endurance curve of a fatigue class: Frey-Law & Avin 2010.
    pub fn default_endurance(&self, class: &str) -> String {
        format!("freylaw_avin_2010_{class}")
    }
}

impl MuscleGroupRow {
    /// Group and sex: `knee_extensor, male`.
    fn name(&self) -> String {
        format!("{}, {}", self.group, self.sex.word())
    }
}

fn lists(movements: &[String], movement: &str) -> bool {
    let id = movement.replace(' ', "_");
    movements.contains(&id)
}

/// One reference for the rates, the rest multiplier and their use.
fn together(rates: &Reference, rest: &Reference, assigned: Option<&Reference>) -> Reference {
    let mut status = rates.status.max(rest.status);
    let from = if rest.source.is_empty() { String::new() } else { format!(" ({})", rest.source) };
    let mut parts = vec![format!("F and R {}, r {}{from}", rates.status, rest.status)];
    if let Some(Reference { status: used, source, note }) = assigned {
        status = status.max(*used);
        parts.push(format!("use for this movement {used}: {source}"));
        parts.extend((!note.is_empty()).then(|| note.clone()));
    }
    parts.extend((!rates.note.is_empty()).then(|| rates.note.clone()));
    Reference { status, source: rates.source.clone(), note: parts.join("; ") }
}

#[cfg(test)]
mod tests {
    use super::super::library;
    use super::FatigueSet;
    use crate::model::adult_size::Sex;

    #[test]
    fn every_movement_of_the_adult_has_one_class_and_every_use_names_a_row() {
        let library = library();
        let mut used: Vec<&String> = library
            .adult
            .coordinate
            .iter()
            .filter_map(|c| c.strength.as_ref())
            .flat_map(|s| [&s.positive, &s.negative])
            .collect();
        used.sort();
        used.dedup();
        let mut listed: Vec<&str> = library.movements().collect();
        listed.sort_unstable();
        assert_eq!(used, listed);
        for movement in listed {
            let class = library.fatigue_class(movement).unwrap();
            assert!(library.endurance(&library.default_endurance(class)).is_some(), "no curve for {class}");
            assert_eq!(library.published_laws(movement).len(), 3, "{movement}");
            assert!(
                library.strength_variation(movement).is_some_and(|(share, _)| share > 0.0 && share < 1.0),
                "{movement}"
            );
            for sex in [None, Some(Sex::Female), Some(Sex::Male)] {
                for set in [FatigueSet::Joint, FatigueSet::MuscleGroup] {
                    let law = library.fatigue_law(movement, set, sex).unwrap();
                    assert!(library.fatigue_reference(movement, &law).is_some(), "{movement} {set:?} {sex:?}");
                }
            }
        }
        for assigned in &library.fatigue.muscle_group_use {
            for movement in &assigned.movements {
                assert!(library.fatigue_class(movement).is_some(), "{movement} is no movement");
            }
        }
        for row in &library.fatigue.muscle_group {
            let mut uses = library.fatigue.muscle_group_use.iter();
            assert!(uses.any(|assigned| assigned.group == row.group), "{} has no use", row.name());
        }
    }
}
