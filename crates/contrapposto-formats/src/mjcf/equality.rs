//! Reads equality constraints between joints as couplings.

use super::attributes::Attributes;
use super::built::Built;
use super::compiler::Settings;
use super::defaults::Classes;
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::item::Item;
use super::schema::Tag;
use super::value::Value;
use crate::model_ir::{Coupling, Ignored, ModelIr, compose_couplings, near, polynomial};
use crate::xml::{Place, shorten};

const EQUALITY_KINDS: &[&str] = &["connect", "weld", "joint", "tendon", "flex", "flexvert", "flexstrain"];

pub(super) fn read<'a>(
    section: Item<'a>,
    body: &mut ModelIr,
    settings: &Settings,
    classes: &Classes<'a>,
    built: &Built<'a>,
    couplings: &mut Vec<(Coupling, Place)>,
    ignored: &mut Ignored,
) -> Result<(), MjcfError> {
    for item in section.children() {
        if !EQUALITY_KINDS.contains(&item.name()) {
            return Err(MjcfError::unknown_element(item, EQUALITY_KINDS));
        }
        let attributes = Attributes::new(item, Tag::Equality, classes, classes.main())?;
        let active = attributes.get("active").map_or(Ok(true), |v| v.flag())?;
        if !active || !settings.equality {
            ignored.add("equality (inactive)", 1);
        } else if item.name() == "joint" {
            couple(item, body, built, couplings)?;
        } else {
            return Err(Unsupported::Equality.at(item));
        }
    }
    Ok(())
}

fn couple<'a>(
    item: Item<'a>,
    body: &mut ModelIr,
    built: &Built<'a>,
    couplings: &mut Vec<(Coupling, Place)>,
) -> Result<(), MjcfError> {
    let joint = |attribute: &'static str| -> Result<Option<(usize, f64)>, MjcfError> {
        let Some(name) = item.attribute(attribute) else { return Ok(None) };
        built.joints.get(name).copied().map(Some).ok_or_else(|| MjcfError::UnknownName {
            place: item.attribute_place(attribute),
            kind: "hinge or slide joint",
            value: shorten(name),
            nearest: near(name, built.joints.keys().copied()),
        })
    };
    let (dependent, y) =
        joint("joint1")?.ok_or_else(|| MjcfError::Missing { place: item.attribute_place("joint1") })?;
    let mut shifted = [0.0, 1.0, 0.0, 0.0, 0.0];
    if let Some(value) = Value::of(item, "polycoef") {
        value.prefix(&mut shifted)?;
    }
    let taken = couplings.iter().any(|(c, _)| c.dependent == dependent) || body.coordinates[dependent].locked;
    let Some((independent, x)) = joint("joint2")? else {
        if taken {
            return Err(MjcfError::invalid(item, "joint1", MjcfRule::Coupling));
        }
        body.coordinates[dependent].locked = true;
        body.coordinates[dependent].default = y + shifted[0];
        return Ok(());
    };
    if taken || dependent == independent {
        return Err(MjcfError::invalid(item, "joint1", MjcfRule::Coupling));
    }
    // y - y0 = sum a_k (x - x0)^k, expanded in x.
    let mut powers = vec![0.0; 5];
    for &coefficient in shifted.iter().rev() {
        for k in (1..5).rev() {
            powers[k] = powers[k - 1] - x * powers[k];
        }
        powers[0] = coefficient - x * powers[0];
    }
    powers[0] += y;
    couplings.push((Coupling { dependent, independent, function: polynomial(powers) }, item.place()));
    Ok(())
}

/// Composes couplings of couplings.
pub(super) fn close(body: &mut ModelIr, mut couplings: Vec<(Coupling, Place)>) -> Result<(), MjcfError> {
    couplings.sort_by_key(|(coupling, _)| coupling.dependent);
    let (mut couplings, places): (Vec<_>, Vec<_>) = couplings.into_iter().unzip();
    compose_couplings(&mut couplings, body.coordinates.len()).map_err(|index| MjcfError::Invalid {
        place: places[index].clone(),
        value: body.coordinates[couplings[index].dependent].name.clone(),
        needs: MjcfRule::Coupling,
    })?;
    body.couplings = couplings;
    Ok(())
}
