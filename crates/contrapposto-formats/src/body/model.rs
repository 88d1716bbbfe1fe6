//! A resolved body becomes a [`Model`].

use contrapposto::model::{
    CoordinateKind, CoordinateSpec, Drive as ModelDrive, JointKind, Model, ModelBuilder, ModelError, Motion,
    SegmentSpec,
};
use contrapposto::passive::{PassiveError, PassiveLaw, Term};
use nalgebra::Unit;

use super::{Body, BodyCoordinate, BodyCoordinateKind, BodyMotion, BodySegment, Drive, PassiveLawText};

/// A model, and what its file needed to be told about it.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// What was changed or read past, one plain sentence each.
    pub notes: Vec<String>,
}

/// Why a resolved body is no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// The model refuses it.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A passive law has no meaning.
    #[error("`{force}`: {problem}")]
    Passive {
        /// Name of the force in the file.
        force: String,
        /// What is wrong.
        problem: PassiveError,
    },
}

impl Body {
    /// The model of this body.
    ///
    /// # Errors
    /// [`BodyError`] when the model refuses a name or number.
    pub fn model(&self) -> Result<Imported, BodyError> {
        let mut notes: Vec<String> =
            self.ignored.iter().map(|(kind, count)| format!("{count} {kind} ignored")).collect();
        let mut builder = ModelBuilder::new(&self.name, self.gravity);
        for segment in &self.segments {
            builder.segment(self.spec(segment, &mut notes)?)?;
        }
        for coupling in &self.couplings {
            let name = |i: usize| self.coordinates[i].name.as_str();
            builder.couple(name(coupling.dependent), name(coupling.independent), coupling.function.clone())?;
        }
        Ok(Imported { model: builder.build(), notes })
    }

    fn spec(&self, segment: &BodySegment, notes: &mut Vec<String>) -> Result<SegmentSpec, BodyError> {
        // The joint's own coordinates, in the file's order.
        let mut own: Vec<usize> = vec![];
        let mut balls = false;
        for motion in &segment.motions {
            match motion {
                BodyMotion::Hinge { drive, .. } | BodyMotion::Slide { drive, .. } => match drive {
                    Drive::Coordinate(c) | Drive::Function(_, c) => own.push(*c),
                    Drive::Constant(_) => {}
                },
                BodyMotion::Ball { .. } => balls = true,
            }
        }
        own.sort_unstable();
        own.dedup();
        let local = |c: usize| own.iter().position(|&o| o == c).unwrap_or(0);
        let motions: Vec<_> = segment.motions.iter().map(motion_and_drive).collect();
        // Every motion its own coordinate, in order: a plain chain. Balls only come so.
        let plain = motions.iter().filter_map(|(_, drive)| *drive).zip(0..).all(|(drive, i)| match drive {
            Drive::Coordinate(c) => local(*c) == i,
            _ => false,
        });
        let kind = match motions.as_slice() {
            [] => JointKind::Weld,
            [(Motion::Hinge(axis), Some(Drive::Coordinate(_)))] => JointKind::Hinge(*axis),
            [(Motion::Slide(axis), Some(Drive::Coordinate(_)))] => JointKind::Slide(*axis),
            _ if balls || (plain && own.len() == motions.len()) => {
                JointKind::Chain(motions.iter().map(|(motion, _)| *motion).collect())
            }
            _ => JointKind::Driven(
                motions
                    .iter()
                    .map(|(motion, drive)| {
                        let drive = match drive {
                            Some(Drive::Coordinate(c)) => ModelDrive::Coordinate(local(*c)),
                            Some(Drive::Function(function, c)) => ModelDrive::Function(function.clone(), local(*c)),
                            Some(Drive::Constant(value)) => ModelDrive::Fixed(*value),
                            None => ModelDrive::Fixed(0.0),
                        };
                        (*motion, drive)
                    })
                    .collect(),
            ),
        };
        let coordinates = own.iter().map(|&c| self.coordinate(c, notes)).collect::<Result<_, _>>()?;
        Ok(SegmentSpec {
            name: segment.name.clone(),
            parent: segment.parent.map(|p| self.segments[p].name.clone()),
            mass: segment.mass,
            center_of_mass: segment.center_of_mass,
            inertia: segment.inertia,
            joint: segment.joint.clone(),
            kind,
            in_parent: segment.in_parent,
            in_segment: segment.in_segment,
            coordinates,
        })
    }

    fn coordinate(&self, index: usize, notes: &mut Vec<String>) -> Result<CoordinateSpec, BodyError> {
        let BodyCoordinate { name, kind, range, default, locked, .. } = &self.coordinates[index];
        let wide = (range.0.min(*default), range.1.max(*default));
        if wide != *range {
            notes.push(format!("`{name}`: its default {default} lies outside its range, which is widened to hold it"));
        }
        let mut terms = vec![];
        for passive in self.passive.iter().filter(|passive| passive.coordinate == index) {
            let refuse = |problem| BodyError::Passive { force: passive.name.clone(), problem };
            terms.push(match &passive.law {
                PassiveLawText::CoordinateLimitForce(law) => {
                    law.form().map_err(refuse)?;
                    Term::CoordinateLimitForce(*law)
                }
                PassiveLawText::DoubleExponential(law) => Term::double_exponential(*law).map_err(refuse)?,
                PassiveLawText::Spring { stiffness, rest } => Term::Spring { stiffness: *stiffness, rest: *rest },
                PassiveLawText::Polynomial { coefficients, rest } => {
                    Term::Polynomial { coefficients: coefficients.clone(), rest: *rest }
                }
                PassiveLawText::Expression(formula) => Term::Expression(formula.clone()),
            });
        }
        let mut spec = CoordinateSpec::new(name, wide);
        spec.default = *default;
        spec.kind = match kind {
            BodyCoordinateKind::Rotation => CoordinateKind::Rotation,
            BodyCoordinateKind::Translation => CoordinateKind::Translation,
            BodyCoordinateKind::Quaternion => CoordinateKind::Quaternion,
        };
        spec.locked = *locked;
        spec.passive = (!terms.is_empty()).then_some(PassiveLaw::Sum(terms));
        Ok(spec)
    }
}

/// The motion, and what drives it; a ball is driven by its own coordinates.
fn motion_and_drive(motion: &BodyMotion) -> (Motion, Option<&Drive>) {
    match motion {
        BodyMotion::Hinge { axis, drive } => (Motion::Hinge(Unit::new_normalize(*axis)), Some(drive)),
        BodyMotion::Slide { axis, drive } => (Motion::Slide(Unit::new_normalize(*axis)), Some(drive)),
        BodyMotion::Ball { .. } => (Motion::Ball, None),
    }
}
