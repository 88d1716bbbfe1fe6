//! Fills in passive laws and muscle groups of the built-in adult where a model has none, by the standard OpenSim names.
//!
//! A name alone is not trusted: older lower-limb models count the knee the other way round. The turning axis of the
//! coordinate must lie along that of the adult's, or against it, and then its curve runs the other way. Both are taken in
//! ground axes at zero angles, which both must have as OpenSim does: x forward, y up, z right.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Coordinate, CoordinateKind, Model, MuscleGroup, data};
use contrapposto::passive::{Coupled, PassiveLaw};
use nalgebra::Vector3;

use super::built_in;
use super::origin::{Origin, Origins};
use crate::model_file::ModelFormat;

/// Names of published models that differ from those of Rajagopal2016, which the adult has.
const OTHER_NAMES: [(&str, &str); 3] =
    [("r_elbow_flex", "elbow_flex_r"), ("r_shoulder_elev", "arm_flex_r"), ("elbow_flexion", "elbow_flex_r")];

/// Coordinates that published models count from another zero than the adult: from full supination, not from mid-way.
const OTHER_ZERO: [&str; 2] = ["pro_sup_r", "pro_sup_l"];

/// Least |cosine| between two axes that agree: that of 60 deg.
const AGREE: f64 = 0.5;

/// Largest excess of a range over that of its curve for which no note is given, rad.
const BEYOND: f64 = 0.1;

/// Fills in unknown passive laws, strength and positive senses; a note says of each joint what was done. With `is_own` the body is the
/// adult itself, whose passive laws the file could write as forces on coordinates only.
pub(super) fn fill(
    model: Model,
    (format, is_own): (ModelFormat, bool),
    size: &Adult,
    twin: &Model,
    origins: &mut [Origins],
    notes: &mut Vec<String>,
) -> Model {
    let signs = Signs::new(&model, format, size, twin);
    let mut changed = model.clone();
    let mut unknown = vec![];
    for (index, (coordinate, origins)) in model.coordinates().iter().zip(origins).enumerate() {
        if coordinate.kind != CoordinateKind::Rotation || model.is_dependent(index) {
            continue;
        }
        let Some((own, found)) = known(twin, &coordinate.name) else {
            if coordinate.passive.is_none() && origins.passive != Origin::Muscles {
                unknown.push(format!("`{}`", coordinate.name));
            }
            continue;
        };
        let filling = Filling { signs: &signs, index, own, found, coordinate };
        if let Some(word) = filling.positive() {
            changed = changed.with_positive(index, &word);
        }
        let replaced = is_own && origins.passive == Origin::File && built_in::is_own_law(coordinate, found);
        changed = if (coordinate.passive.is_some() && !replaced) || origins.passive == Origin::Muscles {
            filling.strength(changed, origins, notes)
        } else {
            filling.tissue(changed, origins, notes)
        };
    }
    if !unknown.is_empty() {
        let all = unknown.len();
        unknown.truncate(12);
        let more = if all > 12 { ", ..." } else { "" };
        let list = unknown.join(", ");
        notes.push(format!("no passive torque is known for {all} coordinates, which have none: {list}{more}"));
    }
    changed
}

/// A coordinate of the model, and the adult's of that name.
struct Filling<'a> {
    signs: &'a Signs<'a>,
    index: usize,
    /// Index of the adult's coordinate.
    own: usize,
    found: &'a Coordinate,
    coordinate: &'a Coordinate,
}

impl Filling<'_> {
    /// The word for the positive sense of a coordinate that has none: that of the adult's, or its opposite.
    fn positive(&self) -> Option<String> {
        if !self.coordinate.positive.is_empty() {
            return None;
        }
        let sign = self.signs.sign(self.index, self.own).ok()?;
        if sign > 0.0 { Some(self.found.positive.clone()) } else { opposite(self.found) }
    }

    /// Muscle groups only: the file's own tissue stays.
    fn strength(&self, model: Model, origins: &mut Origins, notes: &mut Vec<String>) -> Model {
        let of_muscles = origins.strength == Origin::Muscles;
        if self.coordinate.groups.is_some() && !of_muscles {
            return model;
        }
        let (Some(groups), Ok(sign)) = (self.found.groups.clone(), self.signs.sign(self.index, self.own)) else {
            return model;
        };
        if !of_muscles {
            let name = &self.coordinate.name;
            let passive = if origins.passive == Origin::Muscles { "its muscles" } else { "the file" };
            notes.push(format!("`{name}`: strength from the built-in data, passive torque from {passive}"));
            origins.strength = Origin::Library;
        }
        origins.fatigue = Origin::Library;
        (origins.twin, origins.turned) = (Some(self.found.name.clone()), sign < 0.0);
        model.with_groups(self.index, turned(groups, sign))
    }

    /// Passive law, and muscle groups where there are none.
    fn tissue(&self, model: Model, origins: &mut Origins, notes: &mut Vec<String>) -> Model {
        let Self { signs, index, own, found, coordinate } = *self;
        // The root has no tissue.
        let Some(law) = &found.passive else { return model };
        let filled = signs.sign(index, own).and_then(|sign| {
            let law = law_for(law, signs, coordinate, found, sign)?;
            Ok((law, sign))
        });
        let (law, sign) = match filled {
            Ok(filled) => filled,
            Err(why) => {
                let name = &coordinate.name;
                notes.push(format!(
                    "`{name}`: no passive torque in the file, and the built-in one is not applied: {why}"
                ));
                return model;
            }
        };
        let of_muscles = origins.strength == Origin::Muscles;
        notes.push(said(coordinate, found, signs.size, (sign, of_muscles)));
        origins.passive = Origin::Library;
        (origins.twin, origins.turned) = (Some(found.name.clone()), sign < 0.0);
        origins.meant = Some(mirrored(found.range, sign));
        let model = model.with_passive_law(index, Some(law));
        let Some(groups) = found.groups.clone().filter(|_| coordinate.groups.is_none() || of_muscles) else {
            return model;
        };
        origins.strength = if of_muscles { Origin::Muscles } else { Origin::Library };
        origins.fatigue = Origin::Library;
        model.with_groups(index, turned(groups, sign))
    }
}

/// The adult's coordinate of that name.
fn known<'a>(twin: &'a Model, name: &str) -> Option<(usize, &'a Coordinate)> {
    let other = OTHER_NAMES.iter().find(|(other, _)| *other == name).map(|(_, ours)| *ours);
    let index = twin.coordinate(other.unwrap_or(name))?;
    Some((index, &twin.coordinates()[index]))
}

/// `extension` of a coordinate whose positive sense is flexion: by the names of its groups, `knee flexion` and `knee extension`.
fn opposite(of: &Coordinate) -> Option<String> {
    let [positive, negative] = of.groups.as_ref()?;
    let joint = positive.name.strip_suffix(of.positive.as_str())?;
    negative.name.strip_prefix(joint).map(str::to_owned)
}

/// The senses in which coordinates turn, against those of the built-in adult.
struct Signs<'a> {
    model: &'a Model,
    /// Size of the twin.
    size: &'a Adult,
    twin: &'a Model,
    /// The model's ground axes are not known to be the adult's: why.
    elsewhere: Option<String>,
}

impl<'a> Signs<'a> {
    fn new(model: &'a Model, format: ModelFormat, size: &'a Adult, twin: &'a Model) -> Self {
        let down = model.gravity();
        let along = down.dot(&-Vector3::y()) / down.norm();
        let upright = if down.norm() > 0.0 { along > 0.99 } else { format == ModelFormat::OpenSim };
        let elsewhere = "its direction cannot be verified, for gravity does not act along -y, so that the file's axes are not \
            OpenSim's (x forward, y up, z right)";
        Self { model, size, twin, elsewhere: (!upright).then(|| elsewhere.to_owned()) }
    }

    /// +1 where both turn the same way, -1 where they turn against each other.
    fn sign(&self, index: usize, own: usize) -> Result<f64, String> {
        if let Some(why) = &self.elsewhere {
            return Err(why.clone());
        }
        let (theirs, ours) = (turning(self.model, index), turning(self.twin, own));
        let (Some(theirs), Some(ours)) = (theirs, ours) else {
            return Err("its turning axis cannot be determined".to_owned());
        };
        let along = theirs.dot(&ours);
        if along.abs() < AGREE {
            let degrees = libm::acos(along).to_degrees();
            return Err(format!(
                "its direction cannot be verified, for its axis stands at {degrees:.0} deg to the expected one"
            ));
        }
        let coordinate = &self.model.coordinates()[index];
        if OTHER_ZERO.contains(&coordinate.name.as_str()) && coordinate.range.0.abs() < BEYOND {
            return Err("the file counts it from full supination, the built-in data from mid-way".to_owned());
        }
        Ok(along.signum())
    }
}

/// Direction about which a segment turns in ground when a coordinate grows, all angles zero.
fn turning(model: &Model, coordinate: usize) -> Option<Vector3<f64>> {
    const STEP: f64 = 1e-4;
    let segment = model.segments().iter().position(|segment| segment.coordinates.contains(&coordinate))?;
    let mut posture = model.default_posture();
    for (value, about) in posture.values_mut().iter_mut().zip(model.coordinates()) {
        if about.kind == CoordinateKind::Rotation {
            *value = 0.0;
        }
    }
    let mut kinematics = Kinematics::new(model);
    let mut at = |value: f64| {
        posture.values_mut()[coordinate] = value;
        kinematics.update(model, &posture).ok()?;
        Some(kinematics.placement(model, segment).rotation)
    };
    let turn = at(STEP)? * at(-STEP)?.inverse();
    let rate = turn.scaled_axis() / (2.0 * STEP);
    (rate.norm() > AGREE).then(|| rate.normalize())
}

/// The adult's law in the coordinate's direction and over its range.
fn law_for(
    law: &PassiveLaw,
    signs: &Signs<'_>,
    coordinate: &Coordinate,
    found: &Coordinate,
    sign: f64,
) -> Result<PassiveLaw, String> {
    match law {
        PassiveLaw::Curve(_) => {
            let missing = || "the built-in data have no curve for it".to_owned();
            let sources = data::library().sources(&found.name).ok_or_else(missing)?;
            let name = sources.curve_of(signs.size.sex).ok_or_else(missing)?;
            let row = data::library().curve_of_size(name, signs.size).ok_or_else(missing)?;
            let (min, max) = coordinate.range;
            let own = min < max && min.is_finite() && max.is_finite();
            let range = if own { coordinate.range } else { mirrored(found.range, sign) };
            row.over(range, sign * sources.curve_sign).map(PassiveLaw::Curve).map_err(|error| error.to_string())
        }
        PassiveLaw::Coupled(coupled) => {
            let mut neighbours = [None; 3];
            for (slot, neighbour) in neighbours.iter_mut().zip(coupled.neighbours) {
                let Some((theirs, their_sign)) = neighbour else { continue };
                let name = &signs.twin.coordinates()[theirs].name;
                let index = signs
                    .model
                    .coordinates()
                    .iter()
                    .position(|c| known(signs.twin, &c.name).is_some_and(|(index, _)| index == theirs));
                // The neighbouring joint must be there, and turn the way the law says.
                let index = index.ok_or_else(|| format!("its law needs `{name}`, which the model does not have"))?;
                let turned = signs.sign(index, theirs).map_err(|why| format!("its law needs `{name}`, but {why}"))?;
                *slot = Some((index, turned * their_sign));
            }
            Ok(PassiveLaw::Coupled(Coupled { law: coupled.law.clone(), neighbours }))
        }
        PassiveLaw::Sum(_) if sign > 0.0 => Ok(law.clone()),
        PassiveLaw::Sum(_) | PassiveLaw::Slice(_) => {
            Err("it turns the other way round, and its law cannot be mirrored".to_owned())
        }
    }
}

fn mirrored((min, max): (f64, f64), sign: f64) -> (f64, f64) {
    if sign < 0.0 { (-max, -min) } else { (min, max) }
}

/// The groups in the coordinate's direction.
fn turned(groups: [MuscleGroup; 2], sign: f64) -> [MuscleGroup; 2] {
    if sign > 0.0 {
        return groups;
    }
    let [positive, negative] = groups.map(|group| MuscleGroup { strength: group.strength.mirrored(), ..group });
    [negative, positive]
}

/// The note about a filled coordinate; with `of_muscles` its strength is not filled.
fn said(coordinate: &Coordinate, found: &Coordinate, size: &Adult, (sign, of_muscles): (f64, bool)) -> String {
    let sources = data::library().sources(&found.name);
    let row = sources.and_then(|sources| sources.curve_of(size.sex)).and_then(|name| data::library().curve(name));
    let curve = row.map_or(String::new(), |row| format!(", curve `{}` ({})", row.name, row.reference.status));
    let way = if sign < 0.0 { format!(", turned round: {} is negative here", found.positive) } else { String::new() };
    let (min, max) = coordinate.range;
    let (low, high) = mirrored(found.range, sign);
    let beyond = if min < low - BEYOND || max > high + BEYOND {
        let [min, max, low, high] = [min, max, low, high].map(f64::to_degrees);
        format!(
            "; the file's range {min:.0} .. {max:.0} deg goes beyond {low:.0} .. {high:.0} deg, at whose ends its torque stays"
        )
    } else {
        String::new()
    };
    let what = if of_muscles { "passive torque" } else { "passive torque and strength" };
    format!("`{}`: {what} from the built-in data{curve}{way}{beyond}", coordinate.name)
}
