//! Builds the adult by sex, stature and mass, or by measured segment lengths.
//!
//! Masses, centres and inertias from de Leva 1996; joints, ranges, passive curves, strengths and fatigue classes from
//! `data/adult.toml`. The shoulder girdle moves the shoulder joints along the thorax; the pelvis stands on six ordinary root
//! coordinates.

use nalgebra::{Matrix3, Unit, Vector3};

use super::adult_size::{Adult, Part, Sex};
use super::data::{
    Along, CoordinateRow, FatigueSet, GRAVITY, InRightArm, Library, Reference, SegmentRow, StrengthSources, library,
};
use super::{
    CoordinateKind, CoordinateSpec, JointKind, Model, ModelBuilder, ModelError, Motion, MuscleGroup, Placement,
    SegmentSpec,
};
use crate::passive::{Coupled, PassiveError, PassiveLaw};

/// A measure of the built-in adult; prints as its name with its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AdultMeasure {
    /// Standing height.
    Stature,
    /// Body mass.
    Mass,
    /// Length of the segment of this name, without its side.
    SegmentLength(String),
}

impl std::fmt::Display for AdultMeasure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stature => f.write_str("stature (m)"),
            Self::Mass => f.write_str("mass (kg)"),
            Self::SegmentLength(name) => write!(f, "length of `{name}` (m)"),
        }
    }
}

/// The reason for which an adult was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AdultError {
    /// Not the size of an adult.
    #[error("{measure} of the adult is {value}; it must lie in {min}..{max}")]
    Size {
        /// The measure.
        measure: AdultMeasure,
        /// The value.
        value: f64,
        /// Least accepted.
        min: f64,
        /// Greatest accepted.
        max: f64,
    },
    /// A length is given for something that has none.
    #[error("the adult has no segment `{name}` with a length; there are: {accepted}")]
    Length {
        /// The name given.
        name: String,
        /// Names that would be accepted.
        accepted: String,
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
/// let knee = &model.coordinates()[model.coordinate("knee_angle_l").unwrap()];
/// assert_eq!(knee.range.1.to_degrees(), 130.0);
/// assert!((model.mass() - 73.0).abs() < 1e-9);
/// # Ok::<(), contrapposto::model::AdultError>(())
/// ```
///
/// # Errors
/// [`AdultError::Size`] for a stature, mass or length that is no adult's.
pub fn adult(size: &Adult) -> Result<Model, AdultError> {
    for (measure, value, sizes) in
        [(AdultMeasure::Stature, size.stature, Adult::STATURES), (AdultMeasure::Mass, size.mass, Adult::MASSES)]
    {
        if !sizes.contains(&value) {
            return Err(AdultError::Size { measure, value, min: *sizes.start(), max: *sizes.end() });
        }
    }
    let recipe = Recipe { library: library(), size };
    recipe.check_lengths()?;
    let name = match size.sex {
        Sex::Female => "adult, female",
        Sex::Male => "adult, male",
    };
    let mut builder = ModelBuilder::new(name, Vector3::new(0.0, -GRAVITY, 0.0));
    let mut patches = vec![];
    for left in [false, true] {
        for row in &recipe.library.adult.segment {
            let wanted = size.part == Part::Whole || (row.right_arm.is_some() && !left);
            if wanted && (row.mirrored || !left) {
                builder.segment(recipe.segment(row, left)?)?;
                patches.push(recipe.patch(row, left));
            }
        }
    }
    let mut model = builder.build();
    recipe.couple_legs(&mut model);
    for (segment, patch) in patches.into_iter().enumerate() {
        model = model.with_patch(segment, patch);
    }
    recipe.with_shapes(model)
}

/// `hand_r` on the right, `hand_l` on the left.
pub(super) fn sided(name: &str, left: bool) -> String {
    match name.strip_suffix("_r") {
        Some(stem) if left => format!("{stem}_l"),
        _ => name.to_owned(),
    }
}

/// The data, and whom to make of them.
pub(super) struct Recipe<'a> {
    pub(super) library: &'static Library,
    pub(super) size: &'a Adult,
}

impl Recipe<'_> {
    fn check_lengths(&self) -> Result<(), AdultError> {
        for (name, value) in &self.size.lengths {
            let stem = |row: &SegmentRow| row.name.trim_end_matches("_r").to_owned();
            let rows = self.library.adult.segment.iter().filter(|row| row.anthropometry.is_some());
            let known: Vec<String> = rows.map(stem).collect();
            if !known.contains(name) {
                return Err(AdultError::Length { name: name.clone(), accepted: known.join(", ") });
            }
            if !(0.02..=1.0).contains(value) {
                let measure = AdultMeasure::SegmentLength(name.clone());
                return Err(AdultError::Size { measure, value: *value, min: 0.02, max: 1.0 });
            }
        }
        Ok(())
    }

    /// Length of the segment that a row of the anthropometry describes, m: measured, or a share of stature.
    fn length(&self, id: &str) -> Result<f64, AdultError> {
        let segment = self.library.adult.segment.iter().find(|row| row.anthropometry.as_deref() == Some(id));
        let stem = segment.map(|row| row.name.trim_end_matches("_r"));
        if let Some((_, measured)) = self.size.lengths.iter().find(|(name, _)| Some(name.as_str()) == stem) {
            return Ok(*measured);
        }
        let found = self.library.anthropometry.segment.iter().find(|row| row.id == id);
        let lying = found.ok_or_else(|| AdultError::Data(id.to_owned()))?.of(self.size.sex).length * self.size.stature;
        Ok(lying * segment.map_or(1.0, |row| self.length_share(row)))
    }

    pub(super) fn length_of(&self, row: &SegmentRow) -> Result<f64, AdultError> {
        row.length_of.as_ref().or(row.anthropometry.as_ref()).map_or(Ok(0.0), |id| self.length(id))
    }

    /// Length of a standing body's segment as a share of the one that was measured lying down.
    fn length_share(&self, row: &SegmentRow) -> f64 {
        row.length_share.map_or(1.0, |share| share.of(self.size.sex))
    }

    fn segment(&self, row: &SegmentRow, left: bool) -> Result<SegmentSpec, AdultError> {
        let missing = |name: &str| AdultError::Data(name.to_owned());
        let stature = self.size.stature;
        let side = if left { -1.0 } else { 1.0 };
        let mut at = stature * Vector3::from(row.at_stature);
        if let Some(name) = &row.parent {
            let parent = self.library.adult.segment.iter().find(|s| &s.name == name).ok_or_else(|| missing(name))?;
            at += row.at_parent.of(self.size.sex) * self.length_of(parent)? * direction(parent);
        }
        at.z *= side;
        // A right arm alone has its shoulder joint where it is with a hanging arm.
        let alone = self.size.part == Part::RightArm;
        let mut motions = vec![];
        let mut coordinates = vec![];
        for motion in &row.motions {
            let name = &motion.coordinate;
            let found = self.library.adult.coordinate.iter().find(|c| &c.name == name).ok_or_else(|| missing(name))?;
            // Mirrored in the sagittal plane, the axis of a turn keeps its z part only, that of a slide the other two.
            let [x, y, z] = motion.axis;
            let axis = if motion.slide { Vector3::new(x, y, side * z) } else { Vector3::new(side * x, side * y, z) };
            let spec = self.coordinate(found, left)?;
            if alone && (motion.slide || row.right_arm == Some(InRightArm::Fixed)) {
                // Held at its default: the root's slides lift the body onto its feet.
                at += if motion.slide { spec.default * axis } else { Vector3::zeros() };
                continue;
            }
            let axis = Unit::new_normalize(axis);
            motions.push(if motion.slide { Motion::Slide(axis) } else { Motion::Hinge(axis) });
            coordinates.push(spec);
        }
        let mut spec = SegmentSpec {
            name: sided(&row.name, left),
            parent: row.parent.as_ref().map(|name| sided(name, left)),
            mass: 0.0,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::zeros(),
            joint: sided(&row.joint, left),
            kind: if motions.is_empty() { JointKind::Weld } else { JointKind::Chain(motions) },
            in_parent: Placement::translation(at.x, at.y, at.z),
            in_segment: Placement::identity(),
            coordinates,
        };
        if let Some(id) = &row.anthropometry {
            self.weigh(row, id, &mut spec)?;
        }
        Ok(spec)
    }

    /// Corners of the contact patch, m.
    fn patch(&self, row: &SegmentRow, left: bool) -> Vec<Vector3<f64>> {
        let side = if left { -1.0 } else { 1.0 };
        let corners = row.patch.iter().flat_map(|patch| &patch.at_stature);
        corners.map(|at| self.size.stature * Vector3::new(at[0], at[1], side * at[2])).collect()
    }

    /// Mass, centre and inertia from the anthropometry.
    fn weigh(&self, row: &SegmentRow, id: &str, spec: &mut SegmentSpec) -> Result<(), AdultError> {
        let found = self.library.anthropometry.segment.iter().find(|r| r.id == id);
        let shares = found.ok_or_else(|| AdultError::Data(id.to_owned()))?.of(self.size.sex);
        let length = self.length_of(row)?;
        spec.mass = shares.mass * self.size.mass;
        // The data count from the proximal (cranial) end; a segment that points up has its joint at the other one.
        let share = if row.along == Along::Up { 1.0 - shares.com } else { shares.com };
        spec.center_of_mass =
            self.size.stature * Vector3::from(row.proximal_at_stature) + share * length * direction(row);
        let lying = length / self.length_share(row);
        let about = |radius: f64| spec.mass * (radius * lying).powi(2);
        let (ap, ml, long) = (about(shares.r_ap), about(shares.r_ml), about(shares.r_long));
        // Of a foot the longitudinal axis lies along x, and the antero-posterior column is the one across it (de Leva: sagittal).
        let moments = if row.along == Along::Forward { [long, ap, ml] } else { [ap, long, ml] };
        spec.inertia = Matrix3::from_diagonal(&Vector3::from(moments));
        Ok(())
    }

    fn coordinate(&self, row: &CoordinateRow, left: bool) -> Result<CoordinateSpec, AdultError> {
        let missing = |name: &str| AdultError::Data(name.to_owned());
        let range = match (row.range_deg, row.range_m, row.range_stature) {
            (Some([min, max]), ..) => (min.to_radians(), max.to_radians()),
            (_, Some([min, max]), _) => (min, max),
            (_, _, Some(shares)) => (shares[0] * self.size.stature, shares[1] * self.size.stature),
            _ => return Err(missing(&row.name)),
        };
        let mut spec = CoordinateSpec::new(&sided(&row.name, left), range);
        spec.positive.clone_from(&row.positive);
        spec.kind = if row.range_deg.is_some() { CoordinateKind::Rotation } else { CoordinateKind::Translation };
        if let Some(default) = &row.default {
            spec.default = default.stature * self.size.stature;
            for (id, share) in &default.lengths {
                spec.default += share * self.length(id)?;
            }
        }
        if let (Some(angle), Part::Whole) = (row.default_deg, self.size.part) {
            spec.default = angle.to_radians();
        }
        if let Some(passive) = &row.passive {
            let female = passive.female_curve.as_ref().filter(|_| self.size.sex == Sex::Female);
            let name = female.unwrap_or(&passive.curve);
            let curve = self.library.curve_of_size(name, self.size).ok_or_else(|| missing(name))?;
            spec.passive = Some(match curve.coupled() {
                Some(law) => PassiveLaw::Coupled(Coupled { law, neighbours: [None; 3] }), // see `couple_legs`
                None => PassiveLaw::Curve(curve.over(range, passive.sign)?),
            });
        }
        if let Some(strength) = &row.strength {
            let group = |id: &str| -> Result<MuscleGroup, AdultError> {
                let found = self.library.strength(id, self.size, strength.sign);
                let (strength, _) = found.ok_or_else(|| missing(id))?;
                let fatigue = self.library.fatigue_law(id, FatigueSet::default(), Some(self.size.sex));
                Ok(MuscleGroup { name: id.replace('_', " "), strength, fatigue: fatigue.ok_or_else(|| missing(id))? })
            };
            spec.groups = Some([group(&strength.positive)?, group(&strength.negative)?]);
        }
        Ok(spec)
    }

    /// Hip, knee and ankle of a leg meet in the laws of Riener & Edrich; the ankle counts dorsiflexion positive.
    fn couple_legs(&self, model: &mut Model) {
        for side in ["_r", "_l"] {
            let index = |stem: &str| model.coordinate(&format!("{stem}{side}"));
            let neighbours = [
                index("hip_flexion").map(|i| (i, 1.0)),
                index("knee_angle").map(|i| (i, 1.0)),
                index("ankle_angle").map(|i| (i, -1.0)),
            ];
            for (own, _) in neighbours.into_iter().flatten() {
                if let Some(PassiveLaw::Coupled(coupled)) = &mut model.coordinates[own].passive {
                    coupled.neighbours = neighbours;
                }
            }
        }
    }
}

pub(super) fn direction(row: &SegmentRow) -> Vector3<f64> {
    match row.along {
        Along::Up => Vector3::y(),
        Along::Down => -Vector3::y(),
        Along::Forward => Vector3::x(),
    }
}

/// The row of the body data for a coordinate of the adult: its names and references.
#[derive(Clone, Debug)]
pub struct CoordinateSources<'a> {
    /// Name of the passive curve (a man's, where the sexes differ); `None` for the root.
    pub curve: Option<&'a str>,
    /// Name of a woman's passive curve, where the sexes differ.
    pub female_curve: Option<&'a str>,
    /// +1, or -1 where the coordinate runs against the curve's own direction.
    pub curve_sign: f64,
    /// Region of the body, for strategies by region.
    pub region: &'a str,
    /// Source of the range of motion.
    pub range: &'a Reference,
    /// Sources of the strength of the positive and the negative group.
    pub strength: Option<[StrengthSources<'a>; 2]>,
}

impl<'a> CoordinateSources<'a> {
    /// Name of the passive curve of that sex.
    pub fn curve_of(&self, sex: Sex) -> Option<&'a str> {
        self.female_curve.filter(|_| sex == Sex::Female).or(self.curve)
    }
}

impl Library {
    /// Sources of the numbers of one of the adult's coordinates.
    pub fn sources(&self, coordinate: &str) -> Option<CoordinateSources<'_>> {
        let left = coordinate.ends_with("_l");
        let row = self.adult.coordinate.iter().find(|row| sided(&row.name, left && row.mirrored) == coordinate)?;
        let size = Adult::default();
        let sources = |id: &str| self.strength(id, &size, 1.0).map(|(_, sources)| sources);
        let strength = row.strength.as_ref().and_then(|s| Some([sources(&s.positive)?, sources(&s.negative)?]));
        Some(CoordinateSources {
            curve: row.passive.as_ref().map(|passive| passive.curve.as_str()),
            female_curve: row.passive.as_ref().and_then(|passive| passive.female_curve.as_deref()),
            curve_sign: row.passive.as_ref().map_or(1.0, |passive| passive.sign),
            region: &row.region,
            range: &row.range_reference,
            strength,
        })
    }

    /// Names of the adult's coordinates, the right side's before the left side's.
    pub fn coordinate_names(&self) -> impl Iterator<Item = String> {
        let rows = &self.adult.coordinate;
        let left = rows.iter().filter(|row| row.mirrored).map(|row| sided(&row.name, true));
        rows.iter().map(|row| row.name.clone()).chain(left)
    }
}
