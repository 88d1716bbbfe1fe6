//! A good adult for whoever has no model: by sex, stature and mass.
//!
//! Masses, centres and inertias from de Leva 1996; joints, ranges, passive curves, strengths and fatigue classes from
//! `data/adult.toml`. Today: trunk fixed in ground, right arm in full detail.

use nalgebra::{Matrix3, Unit, Vector3};
use serde::Deserialize;

use super::data::{Along, CoordinateRow, Library, Reference, SegmentRow, library};
use super::{CoordinateSpec, JointKind, Model, ModelBuilder, ModelError, Motion, MuscleGroup, Placement, SegmentSpec};
use crate::passive::{PassiveError, PassiveLaw};

/// Standard gravity of the built-in adult, m/s^2 along -y.
const GRAVITY: f64 = 9.81;

/// Sex, as the body tables distinguish it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sex {
    /// De Leva's women.
    Female,
    /// De Leva's men.
    Male,
}

/// Size of the built-in adult.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adult {
    /// Whose proportions.
    pub sex: Sex,
    /// Stature, m, 1.2..=2.3.
    pub stature: f64,
    /// Mass, kg, 30..=250.
    pub mass: f64,
}

impl Default for Adult {
    /// De Leva's reference man, 73.0 kg and 1.741 m.
    fn default() -> Self {
        Self { sex: Sex::Male, stature: 1.741, mass: 73.0 }
    }
}

/// Why an adult was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AdultError {
    /// Not the size of an adult.
    #[error("{what} of the adult is {value}; it must lie in {min}..{max}")]
    Size {
        /// Stature or mass with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// Least accepted.
        min: f64,
        /// Greatest accepted.
        max: f64,
    },
    /// The embedded data name something that is not there (a test reads all of them).
    #[error("the body data name `{0}`, which is not there")]
    Data(String),
    /// The embedded curves do not fit.
    #[error(transparent)]
    Passive(#[from] PassiveError),
    /// The embedded segments do not fit.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Builds the adult.
///
/// ```
/// use contrapposto::model::{Adult, adult};
/// let model = adult(&Adult::default())?;
/// let elbow = &model.coordinates()[model.coordinate("elbow_flex_r").unwrap()];
/// assert_eq!(elbow.range.1.to_degrees(), 150.0);
/// # Ok::<(), contrapposto::model::AdultError>(())
/// ```
///
/// # Errors
/// [`AdultError::Size`] for a stature or mass that is no adult's.
pub fn adult(size: &Adult) -> Result<Model, AdultError> {
    for (what, value, min, max) in [("stature (m)", size.stature, 1.2, 2.3), ("mass (kg)", size.mass, 30.0, 250.0)] {
        if !(min..=max).contains(&value) {
            return Err(AdultError::Size { what, value, min, max });
        }
    }
    let library = library();
    let name = match size.sex {
        Sex::Female => "adult, female",
        Sex::Male => "adult, male",
    };
    let mut builder = ModelBuilder::new(name, Vector3::new(0.0, -GRAVITY, 0.0));
    for row in &library.adult.segment {
        builder.segment(segment(library, size, row)?)?;
    }
    Ok(builder.build())
}

fn segment(library: &Library, size: &Adult, row: &SegmentRow) -> Result<SegmentSpec, AdultError> {
    let missing = |name: &str| AdultError::Data(name.to_owned());
    let parent = match &row.parent {
        None => None,
        Some(name) => Some(library.adult.segment.iter().find(|s| &s.name == name).ok_or_else(|| missing(name))?),
    };
    let mut at = size.stature * Vector3::from(row.at_stature);
    if let Some(parent) = parent {
        at += row.at_parent * length(library, size, parent)? * direction(parent);
    }
    let length = length(library, size, row)?;
    let (mut mass, mut center_of_mass, mut inertia) = (0.0, Vector3::zeros(), Matrix3::zeros());
    if let Some(id) = &row.anthropometry {
        let shares =
            library.anthropometry.segment.iter().find(|r| &r.id == id).ok_or_else(|| missing(id))?.of(size.sex);
        mass = shares.mass * size.mass;
        // The data count from the proximal (cranial) end; a segment that points up has its joint at the other one.
        let share = if row.along == Along::Up { 1.0 - shares.com } else { shares.com };
        center_of_mass = share * length * direction(row);
        let radius2 = |r: f64| mass * (r * length).powi(2);
        let moments = Vector3::new(radius2(shares.r_ap), radius2(shares.r_long), radius2(shares.r_ml));
        inertia = Matrix3::from_diagonal(&moments);
    }
    let mut motions = vec![];
    let mut coordinates = vec![];
    for motion in &row.motions {
        motions.push(Motion::Hinge(Unit::new_normalize(Vector3::from(motion.axis))));
        let name = &motion.coordinate;
        let found = library.adult.coordinate.iter().find(|c| &c.name == name).ok_or_else(|| missing(name))?;
        coordinates.push(coordinate(library, size.sex, found)?);
    }
    Ok(SegmentSpec {
        name: row.name.clone(),
        parent: row.parent.clone(),
        mass,
        center_of_mass,
        inertia,
        joint: row.joint.clone(),
        kind: if motions.is_empty() { JointKind::Weld } else { JointKind::Chain(motions) },
        in_parent: Placement::translation(at.x, at.y, at.z),
        in_segment: Placement::identity(),
        coordinates,
    })
}

fn direction(row: &SegmentRow) -> Vector3<f64> {
    if row.along == Along::Up { Vector3::y() } else { -Vector3::y() }
}

fn length(library: &Library, size: &Adult, row: &SegmentRow) -> Result<f64, AdultError> {
    let id = row.length_of.as_ref().or(row.anthropometry.as_ref()).ok_or_else(|| AdultError::Data(row.name.clone()))?;
    let found = library.anthropometry.segment.iter().find(|r| &r.id == id);
    Ok(found.ok_or_else(|| AdultError::Data(id.clone()))?.of(size.sex).length * size.stature)
}

fn coordinate(library: &Library, sex: Sex, row: &CoordinateRow) -> Result<CoordinateSpec, AdultError> {
    let missing = |name: &str| AdultError::Data(name.to_owned());
    let range = (row.range_deg[0].to_radians(), row.range_deg[1].to_radians());
    let curve = library.curve(&row.passive.curve).ok_or_else(|| missing(&row.passive.curve))?;
    let (fatigue, _) = library.three_compartment(&row.fatigue).ok_or_else(|| missing(&row.fatigue))?;
    let group = |id: &str| -> Result<MuscleGroup, AdultError> {
        let (strength, _) = library.strength(id, sex, row.strength.sign).ok_or_else(|| missing(id))?;
        Ok(MuscleGroup { name: id.replace('_', " "), strength, fatigue: fatigue.clone() })
    };
    Ok(CoordinateSpec {
        positive: row.positive.clone(),
        passive: Some(PassiveLaw::Curve(curve.over(range, row.passive.sign)?)),
        groups: Some([group(&row.strength.positive)?, group(&row.strength.negative)?]),
        ..CoordinateSpec::new(&row.name, range)
    })
}

/// What the body data say of a coordinate of the adult: its row's names and references.
#[derive(Clone, Debug)]
pub struct CoordinateSources<'a> {
    /// Name of the passive curve.
    pub curve: &'a str,
    /// +1, or -1 where the coordinate runs against the curve's own direction.
    pub curve_sign: f64,
    /// Class of the fatigue data.
    pub fatigue_class: &'a str,
    /// Region of the body, for strategies by region.
    pub region: &'a str,
    /// Of the range of motion.
    pub range: &'a Reference,
    /// Of the strength of the positive and negative group.
    pub strength: [&'a Reference; 2],
}

impl Library {
    /// Where the numbers of one of the adult's coordinates come from.
    pub fn sources(&self, coordinate: &str) -> Option<CoordinateSources<'_>> {
        let row = self.adult.coordinate.iter().find(|row| row.name == coordinate)?;
        let reference = |id: &str| self.strength(id, Sex::Male, 1.0).map(|(_, reference)| reference);
        Some(CoordinateSources {
            curve: &row.passive.curve,
            curve_sign: row.passive.sign,
            fatigue_class: &row.fatigue,
            region: &row.region,
            range: &row.range_reference,
            strength: [reference(&row.strength.positive)?, reference(&row.strength.negative)?],
        })
    }

    /// Names of the adult's coordinates.
    pub fn coordinate_names(&self) -> impl Iterator<Item = &str> {
        self.adult.coordinate.iter().map(|row| row.name.as_str())
    }
}
