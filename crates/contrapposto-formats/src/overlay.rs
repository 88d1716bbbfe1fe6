//! Reads an overlay, a TOML file with range, passive law, strength and fatigue of some coordinates, and lays it over a model.
//!
//! Published models hold no passive torque of joints, and their knees stop at 0 deg. A value of the overlay replaces that of
//! the model; all others stay. See `docs/formats.md`.

use std::collections::BTreeMap;

use contrapposto::model::{CoordinateKind, LARGEST, Model, MuscleGroup, data};
use contrapposto::passive::{PassiveCurve, PassiveLaw};
use contrapposto::strength::Strength;
use serde::Deserialize;

use crate::input_error::{InputError, suggestion};
use crate::model_ir::MOST_STRENGTH;
use crate::passive_law::{CoordinateLimitForceText, DoubleExponentialText, PassiveText, ReshapeText, passive_curve};
use crate::toml_file::{Located, read_toml, rows};

/// Fatigue class of a group that is given a strength and nothing else, and of a movement that the built-in data do not know.
pub(crate) const GENERAL: &str = "general";

/// Greatest passive torque of a named curve that anybody can have meant, N m.
const MOST_NM: f64 = 1e4;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OverlayText {
    coordinates: BTreeMap<String, CoordinateText>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CoordinateText {
    range_deg: Option<[f64; 2]>,
    range_m: Option<[f64; 2]>,
    passive: Option<OverlayPassiveText>,
    strength: Option<StrengthText>,
    fatigue: Option<String>,
}

/// As in a scenario, with the sign of a named curve.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OverlayPassiveText {
    curve: Option<String>,
    /// -1 where the coordinate runs against the curve's own direction.
    sign: Option<f64>,
    double_exponential: Option<DoubleExponentialText>,
    coordinate_limit_force: Option<CoordinateLimitForceText>,
    table_deg_nm: Option<Vec<[f64; 2]>>,
    reshape: Option<ReshapeText>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StrengthText {
    positive_nm: Option<f64>,
    negative_nm: Option<f64>,
    /// Measured rows: angle, deg, and the sizes of both senses, N m.
    #[serde(default, deserialize_with = "rows")]
    table_deg_nm: Option<Vec<[f64; 3]>>,
}

impl StrengthText {
    fn in_words(&self) -> String {
        match (self.positive_nm, self.negative_nm, &self.table_deg_nm) {
            (Some(positive), Some(negative), _) => format!("strength {positive} / {negative} N m"),
            (.., rows) => format!("strength of a table of {} rows", rows.as_ref().map_or(0, Vec::len)),
        }
    }
}

/// A model with an overlay laid over it.
#[derive(Clone, Debug)]
pub struct Overlaid {
    /// The model.
    pub model: Model,
    /// All changes, in the order of the coordinates' names.
    pub changes: Vec<OverlayChange>,
}

/// The changes of one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayChange {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Whether the range is changed.
    pub range: bool,
    /// Whether the passive law is changed.
    pub passive: bool,
    /// The strength of its groups.
    pub strength: bool,
    /// The fatigue of its groups.
    pub fatigue: bool,
    /// The same in a plain sentence.
    pub note: String,
}

/// Lays the overlay in `bytes` over `model`. `name` is the file's name for messages.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn overlay(name: &str, bytes: &[u8], model: Model) -> Result<Overlaid, InputError> {
    read_toml(name, bytes, |at: &Located, text: &OverlayText| {
        let mut laid = Overlaid { model, changes: vec![] };
        for (name, text) in &text.coordinates {
            let table = Table { at, path: ["coordinates", name] };
            let change = table.lay(&mut laid.model, text)?;
            laid.changes.push(change);
        }
        Ok(laid)
    })
}

/// The table of one coordinate.
struct Table<'a> {
    at: &'a Located<'a>,
    path: [&'a str; 2],
}

impl Table<'_> {
    fn lay(&self, model: &mut Model, text: &CoordinateText) -> Result<OverlayChange, InputError> {
        let Some(index) = model.coordinate(self.path[1]) else {
            let help = suggestion(self.path[1], model.coordinates().iter().map(|c| c.name.as_str()));
            let message = format!("the model has no coordinate `{}`", self.path[1]);
            return Err(self.at.key_error(&self.path, message, help));
        };
        let kind = model.coordinates()[index].kind;
        let mut said = vec![];
        let range = self.range(model, index, text, &mut said)?;
        if kind != CoordinateKind::Rotation {
            let given = [("passive", text.passive.is_some()), ("strength", text.strength.is_some())];
            let given = given.into_iter().chain([("fatigue", text.fatigue.is_some())]);
            if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
                let message = format!("`{}` is no angle; only angles take a {key}", self.path[1]);
                return Err(self.key_error(key, message, Some("leave it out".to_owned())));
            }
        }
        self.passive(model, index, text, range, &mut said)?;
        let had_groups = model.coordinates()[index].groups.is_some();
        self.groups(model, index, text, &mut said)?;
        if said.is_empty() {
            let help = Some("give range_deg, passive, strength or fatigue".to_owned());
            return Err(self.at.error(&self.path, "nothing is laid over this coordinate", help));
        }
        Ok(OverlayChange {
            coordinate: index,
            range,
            passive: text.passive.is_some(),
            strength: text.strength.is_some(),
            fatigue: text.fatigue.is_some() || (text.strength.is_some() && !had_groups),
            note: format!("`{}`: {} from the overlay", self.path[1], said.join(", ")),
        })
    }

    fn range(
        &self,
        model: &mut Model,
        index: usize,
        text: &CoordinateText,
        said: &mut Vec<String>,
    ) -> Result<bool, InputError> {
        let (key, [min, max], unit) = match (text.range_deg, text.range_m) {
            (None, None) => return Ok(false),
            (Some(range), None) => ("range_deg", range, CoordinateKind::Rotation),
            (None, Some(range)) => ("range_m", range, CoordinateKind::Translation),
            (Some(_), Some(_)) => {
                let help = Some("angles have range_deg, slides range_m".to_owned());
                return Err(self.key_error("range_m", "both ranges are given", help));
            }
        };
        let found = &model.coordinates()[index];
        if found.kind != unit {
            let right = match found.kind {
                CoordinateKind::Rotation => "it is an angle: give range_deg",
                CoordinateKind::Translation => "it is a slide: give range_m",
                CoordinateKind::Quaternion => "a component of a quaternion has no range of its own: leave it out",
            };
            let message = format!("`{}` is not measured in the unit of `{key}`", self.path[1]);
            return Err(self.key_error(key, message, Some(right.to_owned())));
        }
        if min >= max {
            let message = format!("the range {min} .. {max} is empty");
            return Err(self.value_error(key, message, Some("give the lower limit first".to_owned())));
        }
        let rad = |x: f64| if unit == CoordinateKind::Rotation { x.to_radians() } else { x };
        let range = (rad(min), rad(max));
        if let Some(limit) = [min, max].into_iter().find(|limit| rad(*limit).abs() > LARGEST) {
            let message = format!("a limit of the range is {limit:e}; it must be at most 1e9 rad or m in size");
            return Err(self.value_error(key, message, None));
        }
        let before = found.default;
        let changed = model.clone().with_range(index, range);
        *model = changed.map_err(|error| self.value_error(key, error.to_string(), None))?;
        let word = if unit == CoordinateKind::Rotation { "deg" } else { "m" };
        said.push(format!("range {min} .. {max} {word}"));
        let after = model.coordinates()[index].default;
        if after != before {
            said.push(format!(
                "default moved into it, to {} {word}",
                if word == "deg" { after.to_degrees() } else { after }
            ));
        }
        Ok(true)
    }

    fn passive(
        &self,
        model: &mut Model,
        index: usize,
        text: &CoordinateText,
        new_range: bool,
        said: &mut Vec<String>,
    ) -> Result<(), InputError> {
        let coordinate = &model.coordinates()[index];
        let Some(passive) = &text.passive else {
            // A curve belongs to a range: it goes with the new one.
            if let Some(curve) = coordinate.curve().filter(|_| new_range) {
                let curve = PassiveCurve::new(curve.form().clone(), coordinate.range, curve.reshape().copied());
                let refuse = |error: contrapposto::passive::PassiveError| {
                    let help = Some("give a passive law that suits this range".to_owned());
                    self.value_error("range_deg", format!("the passive curve does not suit it: {error}"), help)
                };
                *model = model.clone().with_passive(index, curve.map_err(refuse)?);
            }
            return Ok(());
        };
        self.check_sign(passive)?;
        let as_scenario = PassiveText {
            curve: passive.curve.clone(),
            double_exponential: passive.double_exponential,
            coordinate_limit_force: passive.coordinate_limit_force,
            table_deg_nm: passive.table_deg_nm.clone(),
            reshape: passive.reshape,
        };
        let path = [self.path[0], self.path[1], "passive"];
        let sign = Some(passive.sign.unwrap_or(1.0));
        let curve = passive_curve(self.at, &path, coordinate, sign, &as_scenario)?;
        let (lower, upper) = curve.limit_torques();
        if passive.curve.is_some() && lower.abs().max(upper.abs()) > MOST_NM {
            let message = format!("the curve reaches {lower:.3e} and {upper:.3e} N m at the limits of the range");
            let help = "does the coordinate run the other way (sign = -1)? or does the range leave the curve's own?";
            return Err(self.at.error(
                &[self.path[0], self.path[1], "passive", "curve"],
                message,
                Some(help.to_owned()),
            ));
        }
        said.push(law_sentence(passive, sign));
        *model = model.clone().with_passive_law(index, Some(PassiveLaw::Curve(curve)));
        Ok(())
    }

    fn check_sign(&self, passive: &OverlayPassiveText) -> Result<(), InputError> {
        if let Some(sign) = passive.sign {
            let path = [self.path[0], self.path[1], "passive", "sign"];
            if passive.curve.is_none() {
                let help = Some("leave it out: only a named curve has a direction of its own".to_owned());
                return Err(self.at.key_error(&path, "`sign` goes with `curve`", help));
            }
            if sign.abs() != 1.0 {
                let help = Some("give 1, or -1 where the coordinate runs against the curve".to_owned());
                return Err(self.at.error(&path, format!("sign is {sign}"), help));
            }
        }
        Ok(())
    }

    fn groups(
        &self,
        model: &mut Model,
        index: usize,
        text: &CoordinateText,
        said: &mut Vec<String>,
    ) -> Result<(), InputError> {
        if text.strength.is_none() && text.fatigue.is_none() {
            return Ok(());
        }
        let coordinate = &model.coordinates()[index];
        let class = text.fatigue.as_deref();
        let law = |class: &str| {
            data::library().three_compartment(class).map(|(law, _)| law).ok_or_else(|| {
                let help = suggestion(class, data::library().fatigue_classes().collect::<Vec<_>>());
                self.value_error("fatigue", format!("there is no fatigue class `{class}`"), help)
            })
        };
        let mut groups = match (&coordinate.groups, &text.strength) {
            (Some(groups), _) => groups.clone(),
            (None, Some(_)) => {
                let fatigue = law(class.unwrap_or(GENERAL))?;
                ["positive", "negative"].map(|side| MuscleGroup {
                    name: format!("{}, {side}", coordinate.name),
                    strength: Strength::constant(0.0),
                    fatigue: fatigue.clone(),
                })
            }
            (None, None) => {
                let help = Some("add strength = { positive_nm = ..., negative_nm = ... }".to_owned());
                return Err(self.key_error("fatigue", "this coordinate has no muscle groups yet", help));
            }
        };
        if let Some(strength) = &text.strength {
            let both = self.strengths(strength)?;
            for (group, strength) in groups.iter_mut().zip(both) {
                group.strength = strength;
            }
            said.push(strength.in_words());
        }
        if let Some(class) = class {
            let fatigue = law(class)?;
            groups.iter_mut().for_each(|group| group.fatigue = fatigue.clone());
            said.push(format!("fatigue class `{class}`"));
        } else if coordinate.groups.is_none() {
            said.push(format!("fatigue class `{GENERAL}`"));
        }
        *model = model.clone().with_groups(index, groups);
        Ok(())
    }

    /// Strength of the positive and the negative sense.
    fn strengths(&self, text: &StrengthText) -> Result<[Strength; 2], InputError> {
        let path = |key: &'static str| [self.path[0], self.path[1], "strength", key];
        let refuse = |key: &'static str, message: String| {
            let help = Some("both sizes are positive, at most 1e6 N m".to_owned());
            self.at.error(&path(key), message, help)
        };
        let is_one = |peak: f64| peak > 0.0 && peak <= MOST_STRENGTH;
        let rows = match (text.positive_nm, text.negative_nm, &text.table_deg_nm) {
            (Some(positive), Some(negative), None) => {
                let sides = [("positive_nm", positive), ("negative_nm", negative)];
                return match sides.into_iter().find(|(_, peak)| !is_one(*peak)) {
                    Some((key, peak)) => Err(refuse(key, format!("{key} is {peak}"))),
                    None => Ok(sides.map(|(_, peak)| Strength::constant(peak))),
                };
            }
            (None, None, Some(rows)) => rows,
            _ => {
                let help = Some("give positive_nm and negative_nm, or table_deg_nm alone".to_owned());
                return Err(self.key_error("strength", "strength has two sizes, or one table", help));
            }
        };
        if let Some([angle, positive, negative]) = rows.iter().find(|[_, a, b]| !is_one(*a) || !is_one(*b)) {
            return Err(refuse("table_deg_nm", format!("at {angle} deg the sizes are {positive} and {negative}")));
        }
        let side = |side: usize| {
            let rows: Vec<(f64, f64)> = rows.iter().map(|row| (row[0].to_radians(), row[1 + side])).collect();
            let help = Some("give two rows or more whose angles rise".to_owned());
            let message = "these rows are no table of strength";
            Strength::tabulated(&rows).ok_or_else(|| self.at.error(&path("table_deg_nm"), message, help))
        };
        Ok([side(0)?, side(1)?])
    }

    fn key_error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.at.key_error(&[self.path[0], self.path[1], key], message, help)
    }

    fn value_error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.at.error(&[self.path[0], self.path[1], key], message, help)
    }
}

/// The passive law in words, for the list of changes.
fn law_sentence(passive: &OverlayPassiveText, sign: Option<f64>) -> String {
    match passive.curve.as_deref().and_then(|name| data::library().curve(name)) {
        None => "passive law".to_owned(),
        Some(row) => {
            let against = if sign == Some(-1.0) { "negative" } else { "positive" };
            let held = if row.coupled().is_some() { ", neighbouring joints held at zero" } else { "" };
            format!("passive curve `{}` with {} {against}{held} ({})", row.name, row.positive, row.reference.status)
        }
    }
}
