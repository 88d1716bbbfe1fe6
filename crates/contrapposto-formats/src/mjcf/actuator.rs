//! Reads the strength of hinges: the greatest torques of their actuators, and of all actuators of a joint together.
//!
//! An actuator's force lies within `forcerange`; that of a motor (gain 1, no bias) is its control, which lies within `ctrlrange`. A
//! hinge feels it times the first number of `gear`. `actuatorfrcrange` of the joint limits the sum.

use super::attributes::Attributes;
use super::built::Built;
use super::compiler::Settings;
use super::defaults::Classes;
use super::error::MjcfError;
use super::item::Item;
use super::schema::{ACTUATORS, Tag};
use crate::model_ir::{CoordinateKind, Ignored, MOST_STRENGTH, ModelIr, StrengthIr};
use std::collections::BTreeMap;

/// Greatest torque of the actuators of a hinge so far, in its positive and negative sense, N m; infinite where one has no limit.
pub(super) type Motors = BTreeMap<usize, [f64; 2]>;

/// Adds the actuators of one section to `motors`; those on anything but a hinge are counted.
pub(super) fn read<'a>(
    section: Item<'a>,
    body: &ModelIr,
    settings: &Settings,
    classes: &Classes<'a>,
    built: &Built<'a>,
    motors: &mut Motors,
    ignored: &mut Ignored,
) -> Result<(), MjcfError> {
    for item in section.children() {
        let joint = item.attribute("joint").or_else(|| item.attribute("jointinparent"));
        let hinge = joint.and_then(|name| built.joints.get(name)).map(|(coordinate, _)| *coordinate);
        let hinge = hinge.filter(|&coordinate| body.coordinates[coordinate].kind == CoordinateKind::Rotation);
        let pulls = ACTUATORS.contains(&item.name()) && !["muscle", "damper"].contains(&item.name());
        let Some(hinge) = hinge.filter(|_| pulls) else {
            ignored.add("actuator that is no motor of a hinge", 1);
            continue;
        };
        let attributes = Attributes::new(item, Tag::Actuator, classes, classes.main())?;
        let [low, high] = forces(&attributes, settings)?;
        let gear = attributes.get("gear").map_or(Ok(1.0), |gear| {
            let mut numbers = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            gear.prefix(&mut numbers).map(|()| numbers[0])
        })?;
        let (low, high) = if gear < 0.0 { (high, low) } else { (low, high) };
        let sum = motors.entry(hinge).or_insert([0.0; 2]);
        if gear != 0.0 {
            sum[0] += (gear * high).max(0.0);
            sum[1] += (-gear * low).max(0.0);
        }
    }
    Ok(())
}

/// Least and greatest force of an actuator; infinite without a limit.
fn forces(actuator: &Attributes<'_, '_>, settings: &Settings) -> Result<[f64; 2], MjcfError> {
    let unlimited = [f64::NEG_INFINITY, f64::INFINITY];
    let limits = |range, limited| actuator.limits(range, limited, settings.automatic_limits);
    let force = limits("forcerange", "forcelimited")?.unwrap_or(unlimited);
    let plain = |name: &'static str, word: &str| actuator.get(name).is_none_or(|value| value.text == word);
    let gain = match actuator.item.name() {
        "motor" => Some(1.0),
        "general" if plain("gaintype", "fixed") && plain("biastype", "none") && plain("dyntype", "none") => {
            let mut gain = [1.0; 10];
            actuator.get("gainprm").map_or(Ok(()), |value| value.prefix(&mut gain))?;
            Some(gain[0])
        }
        _ => None,
    };
    let control = limits("ctrlrange", "ctrllimited")?;
    let Some(([low, high], gain)) = control.zip(gain) else { return Ok(force) };
    let (low, high) = (f64::min(gain * low, gain * high), f64::max(gain * low, gain * high));
    Ok([low.max(force[0]), high.min(force[1])])
}

/// Writes the strength of all hinges whose torque is limited in both senses.
pub(super) fn finish(body: &mut ModelIr, built: &Built<'_>, mut motors: Motors, ignored: &mut Ignored) {
    for &coordinate in built.torques.keys() {
        motors.entry(coordinate).or_insert([f64::INFINITY; 2]);
    }
    for (coordinate, sum) in motors {
        let [low, high] = built.torques.get(&coordinate).copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let torque = [sum[0].min(high.max(0.0)), sum[1].min((-low).max(0.0))];
        if torque.iter().all(|&torque| torque > 0.0 && torque <= MOST_STRENGTH) {
            body.strength.push(StrengthIr { coordinate, torque });
        } else {
            ignored.add("hinge whose motor has no limit in both senses", 1);
        }
    }
}
