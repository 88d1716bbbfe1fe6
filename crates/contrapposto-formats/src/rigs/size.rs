//! Finds the unit of a rig by the length of its legs, and the adult that has its bones.

use contrapposto::model::{Adult, AdultError, Model, Placement, Sex, adult};

use super::names::Assignment;

/// Length of a CMU capture's unit, m: inches over 0.45 (the captures' `length 0.45` in their .asf files).
const CMU_UNIT: f64 = 0.0254 / 0.45;
/// Statures of captured adults, m, by which a unit is recognised (assumed; between two units lies a factor of 1.7 or more).
const LIKELY_STATURES: std::ops::RangeInclusive<f64> = 1.4..=2.1;

/// Adult that a rig moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizing {
    /// One with the bones of the rig.
    ToRig(Sex),
    /// This one.
    Given(Adult),
}

/// Unit of a rig's lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigUnit {
    /// A known unit with its name, in which the legs are an adult's.
    Found(&'static str),
    /// The caller's.
    Given,
    /// None that is known: the legs are those of the adult.
    Legs,
}

/// Units of rigs: name, and length in m.
const UNITS: [(&str, f64); 5] =
    [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("in", 0.0254), ("units of CMU captures (56.4 mm)", CMU_UNIT)];

/// Length of both bones of the legs, of the upper arms and of the forearms of a pose: means of both sides, units of the placements.
pub(super) fn bones(assignment: &Assignment, placed: &[Placement]) -> [f64; 4] {
    let ankle = if assignment.joint("talus_r").is_some() { "talus" } else { "calcn" };
    let pairs = [("femur", "tibia"), ("tibia", ankle), ("humerus", "ulna"), ("ulna", "hand")];
    pairs.map(|(from, to)| {
        let of = |side: &str| {
            let at = |segment: &str| placed[assignment.needed(&format!("{segment}{side}"))].translation.vector;
            (at(to) - at(from)).norm()
        };
        (of("_r") + of("_l")) / 2.0
    })
}

/// Length of a leg from hip to ankle, m.
pub(super) fn leg(model: &Model) -> f64 {
    let of = |name: &str| model.segment(name).map_or(0.0, |s| model.segments()[s].in_parent.translation.vector.norm());
    of("tibia_r") + of("talus_r")
}

/// Unit and its length (m) of a rig with legs of this length; `given`: the caller's unit.
pub(super) fn unit(leg_length: f64, sizing: &Sizing, given: Option<f64>) -> Result<(RigUnit, f64), AdultError> {
    let (Sizing::ToRig(sex), None) = (sizing, given) else {
        return match (sizing, given) {
            (Sizing::Given(size), _) => Ok((RigUnit::Legs, leg(&adult(size)?) / leg_length)),
            (Sizing::ToRig(_), given) => Ok((RigUnit::Given, given.unwrap_or(1.0))),
        };
    };
    let reference = Adult::reference(*sex);
    let own = leg(&adult(&reference)?);
    let likely = |metres: &f64| LIKELY_STATURES.contains(&(reference.stature * leg_length * metres / own));
    let found = UNITS.iter().find(|(_, metres)| likely(metres));
    Ok(found.map_or((RigUnit::Legs, own / leg_length), |(name, metres)| (RigUnit::Found(name), *metres)))
}

/// The adult with these bones (m): stature from the legs, and the body mass index of the reference adult (assumed).
pub(super) fn sized(sex: Sex, bones: [f64; 4]) -> Result<Adult, AdultError> {
    let reference = Adult::reference(sex);
    let stature = reference.stature * (bones[0] + bones[1]) / leg(&adult(&reference)?);
    let mass = reference.mass * (stature / reference.stature).powi(2);
    let names = ["femur", "tibia", "humerus", "radius"];
    let lengths = names.into_iter().map(str::to_owned).zip(bones).collect();
    // Of stature and mass a millimetre and 10 g are enough for the reader of a file.
    let rounded = |value: f64, parts: f64| (value * parts).round() / parts;
    Ok(Adult { stature: rounded(stature, 1e3), mass: rounded(mass, 1e2), lengths, ..reference })
}
