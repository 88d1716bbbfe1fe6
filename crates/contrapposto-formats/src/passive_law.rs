//! Passive laws as TOML files write them: tables of scenarios and overlays become curves over a coordinate's range.

use contrapposto::model::{Coordinate, data};
use contrapposto::passive::{CoordinateLimitForce, DoubleExponential, End, PassiveCurve, PassiveError, Tabulated};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::input_error::{InputError, suggestion};
use crate::toml_file::{Located, rows};

/// A passive curve: one of `curve`, `double_exponential`, `coordinate_limit_force`, `table`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PassiveText {
    /// Name of a built-in curve, in that curve's own direction.
    pub(crate) curve: Option<String>,
    /// The canonical double exponential.
    pub(crate) double_exponential: Option<DoubleExponentialText>,
    /// OpenSim's CoordinateLimitForce.
    pub(crate) coordinate_limit_force: Option<CoordinateLimitForceText>,
    /// Measured points `[angle in deg, torque in N m]`, torques falling.
    #[serde(default, deserialize_with = "rows")]
    pub(crate) table_deg_nm: Option<Vec<[f64; 2]>>,
    /// Linear terms near both limits: `true`, or zone and torque.
    pub(crate) reshape: Option<ReshapeText>,
}

/// `lower.torque exp(-lower.rate (q - lower.angle)) - upper.torque exp(upper.rate (q - upper.angle)) - stiffness (q - neutral)`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DoubleExponentialText {
    /// Resists at the lower end.
    pub(crate) lower: EndText,
    /// Resists at the upper end.
    pub(crate) upper: EndText,
    /// Mid-range stiffness, N m/rad; 0 when left out.
    #[serde(default)]
    pub(crate) stiffness_nm_per_rad: f64,
    /// Angle at which the linear term is zero, deg; 0 when left out.
    #[serde(default)]
    pub(crate) neutral_deg: f64,
}

/// One end of the double exponential.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EndText {
    /// Size of the torque at `angle_deg`, N m, not negative.
    pub(crate) torque_nm: f64,
    /// Growth toward the end, 1/rad, positive.
    pub(crate) rate_per_rad: f64,
    /// Angle at which the torque has this size, deg.
    pub(crate) angle_deg: f64,
}

/// OpenSim's CoordinateLimitForce in its own units.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoordinateLimitForceText {
    /// N m/deg above the upper limit.
    pub(crate) upper_stiffness_nm_per_deg: f64,
    /// deg.
    pub(crate) upper_limit_deg: f64,
    /// N m/deg below the lower limit.
    pub(crate) lower_stiffness_nm_per_deg: f64,
    /// deg.
    pub(crate) lower_limit_deg: f64,
    /// Width of the transition, deg.
    pub(crate) transition_deg: f64,
}

/// Linear terms near both limits.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ReshapeText {
    /// The default zone and torque, or none.
    Default(bool),
    /// Stated.
    Stated(ReshapeStated),
}

/// Zone and torque of the linear terms.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReshapeStated {
    /// Width of each zone, deg.
    pub(crate) zone_deg: f64,
    /// Torque that passive tissue reaches at the limits at least, N m.
    pub(crate) end_torque_nm: f64,
}

impl From<DoubleExponentialText> for DoubleExponential {
    fn from(text: DoubleExponentialText) -> Self {
        let end =
            |end: EndText| End { torque: end.torque_nm, rate: end.rate_per_rad, angle: end.angle_deg.to_radians() };
        Self {
            lower: end(text.lower),
            upper: end(text.upper),
            stiffness: text.stiffness_nm_per_rad,
            neutral: text.neutral_deg.to_radians(),
        }
    }
}

impl From<CoordinateLimitForceText> for CoordinateLimitForce {
    fn from(text: CoordinateLimitForceText) -> Self {
        Self {
            upper_stiffness: text.upper_stiffness_nm_per_deg.to_degrees(),
            upper_limit: text.upper_limit_deg.to_radians(),
            lower_stiffness: text.lower_stiffness_nm_per_deg.to_degrees(),
            lower_limit: text.lower_limit_deg.to_radians(),
            transition: text.transition_deg.to_radians(),
        }
    }
}

/// The curve that the table at `path` describes, over the coordinate's range. `sign` -1: the coordinate runs against the named
/// curve. Without `sign`, a named curve runs as in the built-in coordinate of the same name.
pub(crate) fn passive_curve(
    at: &Located,
    path: &[&str],
    coordinate: &Coordinate,
    sign: Option<f64>,
    text: &PassiveText,
) -> Result<PassiveCurve, InputError> {
    let refuse = |key: &str, error: &PassiveError| at.error(&below(path, key), in_degrees(error), None);
    let (key, curve) = unshaped(at, path, coordinate, sign, text)?;
    let curve = curve.map_err(|error| refuse(key, &error))?;
    let (zone, end_torque) = match text.reshape {
        None | Some(ReshapeText::Default(false)) => return Ok(curve),
        Some(ReshapeText::Default(true)) => {
            let (zone, torque, _) = data::library().reshape();
            (zone, torque)
        }
        Some(ReshapeText::Stated(stated)) => (stated.zone_deg.to_radians(), stated.end_torque_nm),
    };
    data::reshaped(&curve, zone, end_torque).map_err(|error| refuse("reshape", &error))
}

/// The key of the one law of the table, and the curve of this law before it is reshaped. Without a law: the coordinate's own curve.
fn unshaped(
    at: &Located,
    path: &[&str],
    coordinate: &Coordinate,
    sign: Option<f64>,
    text: &PassiveText,
) -> Result<(&'static str, Result<PassiveCurve, PassiveError>), InputError> {
    let over_range = |form| PassiveCurve::new(form, coordinate.range, None);
    Ok(match (&text.curve, text.double_exponential, text.coordinate_limit_force, &text.table_deg_nm) {
        (Some(name), None, None, None) => ("curve", named(at, path, coordinate, sign, name)?),
        (None, Some(law), None, None) => {
            ("double_exponential", DoubleExponential::from(law).form().and_then(over_range))
        }
        (None, None, Some(law), None) => {
            ("coordinate_limit_force", CoordinateLimitForce::from(law).form().and_then(over_range))
        }
        (None, None, None, Some(rows)) => {
            let rows: Vec<(f64, f64)> = rows.iter().map(|[deg, nm]| (deg.to_radians(), *nm)).collect();
            ("table_deg_nm", Tabulated::new(&rows).and_then(|table| over_range(table.form())))
        }
        (None, None, None, None) => match coordinate.curve() {
            Some(curve) => ("reshape", Ok(curve.clone())),
            None => return Err(at.error(path, "no curve is given", None)),
        },
        _ => {
            let help = "keep one of curve, double_exponential, coordinate_limit_force, table_deg_nm";
            return Err(at.error(path, "more than one curve is given", Some(help.to_owned())));
        }
    })
}

/// A built-in curve by its name.
fn named(
    at: &Located,
    path: &[&str],
    coordinate: &Coordinate,
    sign: Option<f64>,
    curve: &str,
) -> Result<Result<PassiveCurve, PassiveError>, InputError> {
    let library = data::library();
    let Some(row) = library.curve(curve) else {
        let help = suggestion(curve, library.curve_names().collect::<Vec<_>>());
        return Err(at.error(&below(path, "curve"), format!("there is no passive curve `{curve}`"), help));
    };
    // The built-in curve of this coordinate may run against its direction; all other curves run along.
    let own = library.sources(&coordinate.name).filter(|s| s.curve == Some(curve));
    let sign = sign.or(own.map(|s| s.curve_sign)).unwrap_or(1.0);
    Ok(row.over(coordinate.range, sign))
}

/// The error's message, with angles in degrees as in the file.
fn in_degrees(error: &PassiveError) -> String {
    if let PassiveError::Parameter { parameter, value, accepted } = error
        && let (name, "rad") = parameter.name_and_unit()
    {
        return format!("{name} (deg) is {:.6}; it must be {accepted}", value.to_degrees());
    }
    error.to_string()
}

/// The path of a key of the table at `path`.
fn below<'a>(path: &[&'a str], key: &'a str) -> Vec<&'a str> {
    path.iter().copied().chain([key]).collect()
}
