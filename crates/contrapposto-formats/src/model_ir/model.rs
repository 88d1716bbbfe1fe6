//! Builds the [`Model`] of an intermediate representation.

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::{
    CoordinateSpec, JointKind, Model, ModelBuilder, ModelError, Motion, MuscleGroup, SegmentSpec, Side,
};
use contrapposto::muscle::Musculature;
use contrapposto::passive::{PassiveError, PassiveLaw, Term};
use contrapposto::strength::Strength;
use nalgebra::Unit;

use super::sole::with_soles;
use super::{CoordinateIr, CoordinateKind, Drive, ModelIr, MotionIr, MuscleTally, PassiveLawIr, SegmentIr, StrengthIr};
use crate::markers::ModelMarker;

/// A model, and notes on its file.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// Markers and sites of the file.
    pub markers: Vec<ModelMarker>,
    /// Coordinates of the model whose range is a hard limit of the file, with it, rad or m.
    pub hard_limits: Vec<(usize, (f64, f64))>,
    /// Muscles of the model.
    pub muscles: Musculature,
    /// Numbers of the file's muscles that were read, left out and refused.
    pub muscle_tally: MuscleTally,
    /// The kinds of things in the file that the model does not have, with their numbers: [`ModelIr::ignored`].
    pub left_out: Vec<(String, usize)>,
    /// The words of the file about its origin: [`ModelIr::credits`].
    pub credits: Option<String>,
    /// Changes, one plain sentence each.
    pub notes: Vec<String>,
}

/// The reason for which an intermediate representation is no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelIrError {
    /// The model refuses it.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A passive law has no meaning.
    #[error("`{force}`: {problem}")]
    Passive {
        /// Name of the force in the file.
        force: String,
        /// The reason.
        problem: PassiveError,
    },
}

impl ModelIr {
    /// The model. Where the file gives the strength of motors, every joint is judged by its coordinates ([`Model::by_coordinates`]).
    ///
    /// # Errors
    /// [`ModelIrError`] when the model refuses a name or number.
    pub fn model(&self) -> Result<Imported, ModelIrError> {
        let mut notes = vec![];
        let mut builder = ModelBuilder::new(&self.name, self.gravity);
        for segment in &self.segments {
            builder.segment(self.spec(segment, &mut notes)?)?;
        }
        for coupling in &self.couplings {
            let name = |i: usize| self.coordinates[i].name.as_str();
            builder.couple(name(coupling.dependent), name(coupling.independent), coupling.function.clone())?;
        }
        let model = builder.build();
        let model = if self.strength.is_empty() { model } else { model.by_coordinates() };
        let (muscles, muscle_tally) = (self.musculature(&model), self.muscles.tally.clone());
        let model = with_soles(model, &self.solids);
        let (markers, hard_limits) = (self.markers(), self.hard_limits(&model));
        Ok(Imported {
            model,
            markers,
            hard_limits,
            muscles,
            muscle_tally,
            left_out: self.ignored.clone(),
            credits: self.credits.clone(),
            notes,
        })
    }

    fn markers(&self) -> Vec<ModelMarker> {
        let marker = |(name, segment, point): &(String, usize, _)| ModelMarker {
            name: name.clone(),
            segment: *segment,
            point: *point,
        };
        self.stations.iter().map(marker).collect()
    }

    fn hard_limits(&self, model: &Model) -> Vec<(usize, (f64, f64))> {
        let limited = self.coordinates.iter().filter(|c| c.clamped && c.kind != CoordinateKind::Quaternion);
        limited.filter_map(|c| Some((model.coordinate(&c.name)?, c.range))).collect()
    }

    /// The two groups of a coordinate that a motor drives; none of one that follows another coordinate.
    fn motors(&self, index: usize) -> Option<[MuscleGroup; 2]> {
        let StrengthIr { torque, .. } = self.strength.iter().find(|strength| strength.coordinate == index)?;
        let own = self.couplings.iter().all(|coupling| coupling.dependent != index);
        let group = |side: Side| MuscleGroup {
            name: format!("{}, {}", self.coordinates[index].name, side.word()),
            strength: Strength::constant(torque[side.index()]),
            fatigue: FatigueLaw::Tireless,
        };
        own.then(|| Side::BOTH.map(group))
    }

    fn spec(&self, segment: &SegmentIr, notes: &mut Vec<String>) -> Result<SegmentSpec, ModelIrError> {
        // The joint's own coordinates, in the file's order.
        let mut own: Vec<usize> = vec![];
        for motion in &segment.motions {
            match motion {
                MotionIr::Hinge { drive, .. } | MotionIr::Slide { drive, .. } => match drive {
                    Drive::Coordinate(c) | Drive::Function(_, c) => own.push(*c),
                    Drive::Fixed(_) => {}
                },
                MotionIr::Ball { first } => own.extend(*first..first + 4),
            }
        }
        own.sort_unstable();
        own.dedup();
        let local = |c: usize| own.iter().position(|&o| o == c).unwrap_or(0);
        let motions: Vec<_> = segment.motions.iter().map(|motion| motion_and_drive(motion, local)).collect();
        // Every motion its own coordinates, in order: a plain chain.
        let mut next = 0;
        let plain = motions.iter().all(|(motion, drive)| {
            next += motion.coordinates();
            *drive == Drive::Coordinate(next - motion.coordinates())
        });
        let kind = match motions.as_slice() {
            [] => JointKind::Weld,
            [(Motion::Hinge(axis), Drive::Coordinate(_))] => JointKind::Hinge(*axis),
            [(Motion::Slide(axis), Drive::Coordinate(_))] => JointKind::Slide(*axis),
            _ if plain => JointKind::Chain(motions.iter().map(|(motion, _)| *motion).collect()),
            _ => JointKind::Driven(motions),
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

    fn coordinate(&self, index: usize, notes: &mut Vec<String>) -> Result<CoordinateSpec, ModelIrError> {
        let CoordinateIr { name, kind, range, default, locked, .. } = &self.coordinates[index];
        if *kind == CoordinateKind::Quaternion {
            let mut component = CoordinateSpec::new(name, (-1.0, 1.0));
            component.default = default.clamp(-1.0, 1.0);
            return Ok(component);
        }
        let wide = (range.0.min(*default), range.1.max(*default));
        if wide != *range {
            notes.push(format!("`{name}`: its default {default} lies outside its range, which is widened to hold it"));
        }
        let mut terms = vec![];
        for passive in self.passive.iter().filter(|passive| passive.coordinate == index) {
            let refuse = |problem| ModelIrError::Passive { force: passive.name.clone(), problem };
            terms.push(match &passive.law {
                PassiveLawIr::CoordinateLimitForce(law) => {
                    law.form().map_err(refuse)?;
                    Term::CoordinateLimitForce(*law)
                }
                PassiveLawIr::DoubleExponential(law) => Term::double_exponential(*law).map_err(refuse)?,
                PassiveLawIr::Spring { stiffness, rest } => Term::Spring { stiffness: *stiffness, rest: *rest },
                PassiveLawIr::Polynomial { coefficients, rest } => {
                    Term::Polynomial { coefficients: coefficients.clone(), rest: *rest }
                }
                PassiveLawIr::Expression(formula) => Term::Expression(formula.clone()),
            });
        }
        let mut spec = CoordinateSpec::new(name, wide);
        spec.default = *default;
        spec.kind = *kind;
        spec.locked = *locked;
        spec.groups = self.motors(index);
        spec.passive = (!terms.is_empty()).then_some(PassiveLaw::Sum(terms));
        Ok(spec)
    }
}

/// The motion and its drive, coordinates counted as `local` does; a ball is driven by its own.
fn motion_and_drive(motion: &MotionIr, local: impl Fn(usize) -> usize) -> (Motion, Drive) {
    let drive = |drive: &Drive| match drive {
        Drive::Coordinate(c) => Drive::Coordinate(local(*c)),
        Drive::Function(function, c) => Drive::Function(function.clone(), local(*c)),
        Drive::Fixed(value) => Drive::Fixed(*value),
    };
    match motion {
        MotionIr::Hinge { axis, drive: by } => (Motion::Hinge(Unit::new_normalize(*axis)), drive(by)),
        MotionIr::Slide { axis, drive: by } => (Motion::Slide(Unit::new_normalize(*axis)), drive(by)),
        MotionIr::Ball { first } => (Motion::Ball, Drive::Coordinate(local(*first))),
    }
}
