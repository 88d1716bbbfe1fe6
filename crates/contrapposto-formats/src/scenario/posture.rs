//! Reads values of coordinates (keys `NAME_deg`, `NAME_m` and the bare names of quaternions), and which of them may move.

use std::collections::BTreeMap;

use contrapposto::model::{Coordinate, CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::tasks::Height;

use super::names::coordinate;
use super::text::ScenarioText;
use crate::input_error::{InputError, suggestion};
use crate::toml_file::{Located, shown};

/// Farthest a quaternion may be from unit length.
pub(super) const UNIT: f64 = 1e-3;

/// Sets coordinates from the table at `path`; its keys are as in `[posture]`.
pub(super) fn set(
    at: &Located,
    model: &Model,
    path: &[&str],
    table: &BTreeMap<String, f64>,
    posture: &mut Posture,
) -> Result<(), InputError> {
    let mut quaternions: Vec<(usize, &str)> = vec![];
    for (key, &value) in table {
        let path: Vec<&str> = path.iter().copied().chain([key.as_str()]).collect();
        let (index, value) = posture_value(at, model, &path, value)?;
        if let Some(coupling) = model.couplings().iter().find(|coupling| coupling.dependent == index) {
            let independent = &model.coordinates()[coupling.independent].name;
            let message = format!("`{}` follows `{independent}`", model.coordinates()[index].name);
            return Err(at.key_error(&path, message, Some(format!("set `{independent}` and leave this out"))));
        }
        if let Some(first) = ball(model, index) {
            quaternions.push((first, key));
        }
        posture.values_mut()[index] = value;
    }
    for (first, key) in quaternions {
        let length = posture.values()[first..first + 4].iter().map(|v| v * v).sum::<f64>().sqrt();
        if length.is_nan() || (length - 1.0).abs() > UNIT {
            let path: Vec<&str> = path.iter().copied().chain([key]).collect();
            let message = format!(
                "the quaternion that begins with `{}` has length {}; it must have length 1",
                model.coordinates()[first].name,
                shown(length)
            );
            let help = Some("give all four of its coordinates; what is left out is at its default".to_owned());
            return Err(at.error(&path, message, help));
        }
    }
    Ok(())
}

/// Sets coordinates as a result has them: by name, rad, m or components of quaternions. Dependent ones follow the others.
pub(super) fn set_result(
    at: &Located,
    model: &Model,
    table: &BTreeMap<String, f64>,
    posture: &mut Posture,
) -> Result<(), InputError> {
    for (name, &value) in table {
        let index = coordinate(at, model, &["start_from", name], name)?;
        let (low, high) = model.coordinates()[index].range;
        let inside = value.max(low).min(high);
        // A result may lie outside of a range by the rounding of its text.
        posture.values_mut()[index] = if (value - inside).abs() < UNIT { inside } else { value };
    }
    Ok(())
}

/// First coordinates of all balls.
pub(super) fn balls(model: &Model) -> Vec<usize> {
    let quaternions =
        (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].kind == CoordinateKind::Quaternion);
    quaternions.step_by(4).collect()
}

/// First coordinate of the ball that a coordinate belongs to.
fn ball(model: &Model, coordinate: usize) -> Option<usize> {
    balls(model).into_iter().find(|first| (*first..first + 4).contains(&coordinate))
}

/// The rates that a coordinate moves: its own, or the three of its ball.
pub(super) fn rates(model: &Model, coordinate: usize) -> Vec<usize> {
    if let Some(rate) = model.coordinates()[coordinate].rate {
        return vec![rate];
    }
    let place = balls(model).into_iter().position(|first| (first..first + 4).contains(&coordinate));
    let turning: Vec<usize> = (0..model.rates().len()).filter(|&i| model.rates()[i].coordinate.is_none()).collect();
    place.and_then(|place| turning.get(3 * place..3 * place + 3)).map_or(vec![], <[usize]>::to_vec)
}

/// Index and value of the coordinate that the key at the end of `path` names: `NAME_deg`, `NAME_m`, or a quaternion's bare
/// name.
fn posture_value(at: &Located, model: &Model, path: &[&str], value: f64) -> Result<(usize, f64), InputError> {
    const ENDINGS: &str = "rotations end in _deg, slides in _m";
    /// Beyond a limit by so little is rounding of degrees, rad or m.
    const ROUNDING: f64 = 1e-9;
    let key = path.last().copied().unwrap_or_default();
    let (name, unit) = match key.rsplit_once('_') {
        _ if model.coordinate(key).is_some_and(|i| model.coordinates()[i].kind == CoordinateKind::Quaternion) => {
            (key, CoordinateKind::Quaternion)
        }
        Some((name, "deg")) => (name, CoordinateKind::Rotation),
        Some((name, "m")) => (name, CoordinateKind::Translation),
        _ => {
            let message = format!("posture key `{key}` names no unit; {ENDINGS}");
            return Err(at.key_error(path, message, suggestion(key, keys(model).iter().map(String::as_str))));
        }
    };
    let index = model.coordinate(name).ok_or_else(|| {
        let help = suggestion(key, keys(model).iter().map(String::as_str));
        at.key_error(path, format!("the body has no coordinate `{name}`"), help)
    })?;
    let found = &model.coordinates()[index];
    if found.kind != unit {
        let message = format!("`{name}` is not measured in the unit that `{key}` names");
        return Err(at.key_error(path, message, Some(ENDINGS.into())));
    }
    let inside = if unit == CoordinateKind::Rotation { value.to_radians() } else { value };
    let (min, max) = found.range;
    if inside < min - ROUNDING || inside > max + ROUNDING {
        let show = |x: f64| if unit == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let word = if unit == CoordinateKind::Rotation { "deg" } else { "m" };
        let (min, max) = (show(min), show(max));
        let message = format!("`{name}` is {} {word}, outside its range {min:.4}..{max:.4} {word}", shown(value));
        return Err(at.error(path, message, Some(format!("give an angle from {min:.4} to {max:.4} {word}"))));
    }
    Ok((index, inside.max(min).min(max)))
}

/// All keys that a posture may have.
fn keys(model: &Model) -> Vec<String> {
    let key = |c: &Coordinate| match c.kind {
        CoordinateKind::Rotation => format!("{}_deg", c.name),
        CoordinateKind::Translation => format!("{}_m", c.name),
        CoordinateKind::Quaternion => c.name.clone(),
    };
    model.coordinates().iter().map(key).collect()
}

/// One flag a coordinate: the coordinate may move. `otherwise` decides where the file has neither list.
pub(super) fn free(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    otherwise: impl Fn(&Coordinate) -> bool,
) -> Result<Vec<bool>, InputError> {
    let (list, key, listed) = match (&text.coordinates.free, &text.coordinates.locked) {
        (Some(_), Some(_)) => {
            let help = Some("keep one of the two lists".to_owned());
            return Err(at.key_error(&["coordinates", "locked"], "both `free` and `locked` are given", help));
        }
        (Some(list), None) => (list, "free", true),
        (None, Some(list)) => (list, "locked", false),
        (None, None) => return Ok(model.coordinates().iter().map(otherwise).collect()),
    };
    let mut flags = vec![!listed; model.coordinates().len()];
    for (i, name) in list.iter().enumerate() {
        flags[coordinate(at, model, &["coordinates", key, &i.to_string()], name)?] = listed;
    }
    Ok(flags)
}

/// One flag a rate: its coordinate may move to bring supports and things together. Shoulders do not shrug for that.
pub(super) fn free_rates(at: &Located, model: &Model, text: &ScenarioText) -> Result<Vec<bool>, InputError> {
    let mut free = free(at, model, text, |_| true)?;
    Height::shoulder_rhythm(model).into_iter().for_each(|(rise, _)| free[rise] = false);
    let mut flags = vec![true; model.rates().len()];
    for coordinate in (0..free.len()).filter(|&coordinate| !free[coordinate]) {
        rates(model, coordinate).into_iter().for_each(|rate| flags[rate] = false);
    }
    Ok(flags)
}
