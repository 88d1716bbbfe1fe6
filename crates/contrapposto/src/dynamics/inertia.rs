//! Computes the inertia of a moving body as loads, and the torques that they give.

use nalgebra::{Matrix3, Vector3};

use super::acceleration::{Acceleration, SpeedError};
use super::backward::{Wrench, WrenchTorques};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::statics::{ExternalTorque, FixedIn, Load, LoadError, LoadKind};

/// The reason for which the inertia of a body is not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InertiaError {
    /// Speeds or accelerations do not fit the model.
    #[error(transparent)]
    Speed(#[from] SpeedError),
    /// A held weight does not fit the model, or the force of inertia is beyond every body's.
    #[error("inertia: {0}")]
    Load(#[from] LoadError),
}

/// Segments with inertia that are fixed to each other, in the frame of the mobility that carries them.
#[derive(Clone, Debug)]
struct Body {
    /// The first of them.
    segment: usize,
    mobility: usize,
    mass: f64,
    center: Vector3<f64>,
    /// About the centre.
    inertia: Matrix3<f64>,
}

/// Inertia of a moving body: its loads and their torques. Depends on posture, speeds, accelerations and held weights; filled by
/// [`Inertia::update`].
#[derive(Clone, Debug)]
pub struct Inertia {
    /// One a segment.
    segments: Vec<Body>,
    /// One a mobility: its segments as one body, which has the same torques.
    bodies: Vec<Body>,
    acceleration: Acceleration,
    /// Forces of inertia of held weights.
    held: Vec<Load>,
    /// Forces and couples of `bodies` and `held` about the ground origin.
    wrenches: Vec<Wrench>,
    torque: WrenchTorques,
    /// About the axes of three-axis joints, for a body with such joints.
    about_axes: Option<WrenchTorques>,
}

impl Inertia {
    /// Space for `model`, at rest.
    pub fn new(model: &Model) -> Self {
        let body = |segment: usize| {
            let of = &model.segments[segment];
            let mobility = of.mobility?;
            let rotation = of.offset.rotation.to_rotation_matrix().into_inner();
            let inertia = rotation * of.inertia * rotation.transpose();
            let center = (of.offset * nalgebra::Point3::from(of.center_of_mass)).coords;
            let counts = of.mass > 0.0 || inertia != Matrix3::zeros();
            counts.then_some(Body { segment, mobility, mass: of.mass, center, inertia })
        };
        let segments: Vec<Body> = (0..model.segments.len()).filter_map(body).collect();
        let mut bodies: Vec<Body> = vec![];
        for segment in &segments {
            match bodies.iter_mut().find(|body| body.mobility == segment.mobility) {
                Some(body) => body.join(segment),
                None => bodies.push(segment.clone()),
            }
        }
        Self {
            held: vec![],
            segments,
            bodies,
            acceleration: Acceleration::new(model),
            wrenches: vec![],
            torque: WrenchTorques::new(model),
            about_axes: (!model.three_axis_joints().is_empty()).then(|| WrenchTorques::new(model.by_axes())),
        }
    }

    /// Computes it in the posture that `kinematics` holds, for speeds (rad/s or m/s) and accelerations (rad/s^2 or m/s^2), one a rate.
    /// The weights among `held` move with the body; other loads have no inertia. Does not allocate once it has had as many weights.
    ///
    /// # Errors
    /// [`InertiaError`] when speeds, accelerations or loads do not fit the model.
    pub fn update(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        (speeds, accelerations): (&[f64], &[f64]),
        held: &[Load],
    ) -> Result<(), InertiaError> {
        self.acceleration.update(model, kinematics, speeds, accelerations)?;
        self.wrenches.clear();
        for body in &self.bodies {
            let (force, couple, arm) = self.acceleration.inertia(kinematics, body);
            body.loads(model, force, couple).iter().try_for_each(|load| load.check(model))?;
            let moment = (kinematics.origins[body.mobility] + arm).cross(&force) + couple;
            self.wrenches.push(Wrench { segment: body.segment, force, moment });
        }
        self.held.clear();
        for load in held {
            load.check(model)?;
            if let LoadKind::Weight(mass) = load.kind {
                let force = -mass * self.acceleration.station(model, kinematics, load.segment, load.point);
                let inertia = Load { kind: LoadKind::Force(force, FixedIn::World), ..*load };
                inertia.check(model)?;
                self.held.push(inertia);
                let moment = kinematics.station(model, load.segment, load.point).cross(&force);
                self.wrenches.push(Wrench { segment: load.segment, force, moment });
            }
        }
        self.torque.update(model, kinematics, &self.wrenches);
        Ok(())
    }

    /// Computes the torques about axes that the loads of the last update give; `kinematics` are the frames of [`Model::by_axes`] in the
    /// same posture. Does not allocate.
    pub fn update_about_axes(&mut self, model: &Model, kinematics: &Kinematics) {
        if let Some(torque) = &mut self.about_axes {
            torque.update(model.by_axes(), kinematics, &self.wrenches);
        }
    }

    /// As [`Inertia::torques`], with the torques of three-axis joints about the axes that stand for their coordinates, from the last
    /// [`Inertia::update_about_axes`].
    pub fn about_axes(&self) -> &[f64] {
        &self.about_axes.as_ref().unwrap_or(&self.torque).torques
    }

    /// Forces and couples of inertia of the last update, one of both a segment, then the forces of held weights, behind the other `loads` of the
    /// same posture. Does not allocate where `loads` has the space.
    pub fn add_loads(&self, model: &Model, kinematics: &Kinematics, loads: &mut Vec<Load>) {
        for segment in &self.segments {
            let (force, couple, _) = self.acceleration.inertia(kinematics, segment);
            loads.extend(segment.loads(model, force, couple));
        }
        loads.extend_from_slice(&self.held);
    }

    /// Torque of inertia alone, by rate: the part of the external torque that the body at rest would not have, N m (N for slides).
    /// Dependent coordinates are folded into their independent ones.
    pub fn torques(&self) -> &[f64] {
        &self.torque.torques
    }

    /// Inverse dynamics: external torque of gravity, `loads` and the inertia of the last update, in the same posture. Gradient and slopes of
    /// `external` are those of gravity and `loads` alone. Does not allocate.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the model; nothing is changed then.
    pub fn external_torque(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        loads: &[Load],
        external: &mut ExternalTorque,
    ) -> Result<(), LoadError> {
        external.update_with(model, kinematics, loads, &self.torque.elements)
    }

    /// As [`Inertia::torques`], but as if no coordinate followed another one.
    pub fn uncoupled_torques<'a>(&'a self, model: &Model) -> &'a [f64] {
        if model.direct { &self.torque.torques } else { &self.torque.raw }
    }

    /// Velocities and accelerations of the segments.
    pub fn acceleration(&self) -> &Acceleration {
        &self.acceleration
    }
}

impl Body {
    /// Takes a segment in that is fixed to this body, by the parallel axis theorem.
    fn join(&mut self, other: &Self) {
        let mass = self.mass + other.mass;
        let apart = other.center - self.center;
        // A part without mass has its inertia about any point.
        let share = if mass > 0.0 { other.mass / mass } else { 0.0 };
        let squares = Matrix3::from_diagonal_element(apart.norm_squared()) - apart * apart.transpose();
        self.inertia += other.inertia + share * self.mass * squares;
        self.center += share * apart;
        self.mass = mass;
    }

    /// Force (N) and couple (N m) of a segment's inertia, ground axes.
    fn loads(&self, model: &Model, force: Vector3<f64>, couple: Vector3<f64>) -> [Load; 2] {
        let point = model.segments[self.segment].center_of_mass;
        [LoadKind::Force(force, FixedIn::World), LoadKind::Couple(couple, FixedIn::World)].map(|kind| Load {
            segment: self.segment,
            point,
            kind,
        })
    }
}

impl Acceleration {
    /// Force (N) and couple (N m) of the inertia of a body, and its centre seen from the mobility's origin (m), ground axes.
    fn inertia(&self, kinematics: &Kinematics, body: &Body) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let Body { mobility, mass, center, inertia, .. } = body;
        let rotation = &kinematics.rotations[*mobility];
        let (omega, alpha) = (self.omega[*mobility], self.alpha[*mobility]);
        let arm = rotation * center;
        let force = -*mass * (self.origin[*mobility] + alpha.cross(&arm) + omega.cross(&omega.cross(&arm)));
        // The couple in the axes of the mobility, in which the inertia stays.
        let (turn, change) = (rotation.tr_mul(&omega), rotation.tr_mul(&alpha));
        let couple = inertia * change + turn.cross(&(inertia * turn));
        (force, -(rotation * couple), arm)
    }
}
