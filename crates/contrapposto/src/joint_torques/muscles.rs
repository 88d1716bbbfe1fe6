//! Computes the passive torque and the strength that the muscles of a body give its joints in a posture.
//!
//! With moment arms `R` by the geodesic rule, fibres' passive forces at rest `F_p`, tendons' forces at rest `F_0` and at full activation
//! `F_1`, the muscles give a rate `i`
//!
//! ```text
//! tau_p,i = sum_m R_mi F_p,m                                             and that of ligaments, path springs and bushings
//! S_i     = | sum_m R_mi F_m - sum_m R_mi F_p,m |                        F_m = F_1,m where the muscle pulls that way, else F_0,m
//! ```
//!
//! Strength is that beyond passive torque, for active torque is (Eq. 1), and a plain sum: dynamometers measure a joint while straps
//! hold the others, so that two-joint muscles pull as they can. It is isometric: fibres stand still, whatever the motion. All arms
//! are taken twice: about coordinates, and about the axes of three-axis joints, by the body that has a ball for each.

use super::JointTorquesError;
use super::muscle_laws::{MuscleLaws, MusclesAtRest, TorqueRise};
use super::muscle_tables::RESTING_ACTIVATION;
use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::muscle::{
    FiberState, Musculature, PathGeometry, PathRule, Sharing, bushing_torque, passive_fiber_torque, passive_torque,
    strength,
};
use crate::passive::PassiveLaw;
use crate::posture::{Posture, PostureError};
use crate::statics::{PassiveTorque, PathTensionError};
use crate::strength::Strength;

/// Least strength that muscles give, N m (N for slides): where none pulls, relative load stays finite (assumed).
pub const LEAST_MUSCLE_STRENGTH: f64 = 1e-3;
/// Least strength that changes of strength and of passive torque are a share of, N m.
const LEAST_CHANGE_OF: f64 = 1.0;

/// Passive torque and strength of a body from its muscles. Depend on the posture; filled by [`JointMuscles::update`].
#[derive(Clone, Debug)]
pub struct JointMuscles {
    muscles: Musculature,
    geometry: PathGeometry,
    /// The same about axes, for a body with three-axis joints.
    axes: Option<(Kinematics, PathGeometry)>,
    rest: Vec<FiberState>,
    full: Vec<FiberState>,
    /// By rate: whether passive torque counts there.
    passive: Vec<bool>,
    /// The rates at which strength counts.
    strong: Vec<usize>,
    /// By rate, N m: of coordinates, and about axes; zero where passive torque does not count.
    torques: [Vec<f64>; 2],
    /// By rate, N m, about axes.
    fibers: Vec<f64>,
    sums: Vec<[f64; 2]>,
    scratch: Vec<f64>,
    /// Passive laws of the coordinates at which passive torque counts, for a body that has them.
    laws: Option<Box<MuscleLaws>>,
}

/// The reason for which muscles do not fit a posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointMusclesError {
    /// The posture does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
    /// The tensions have no gradient.
    #[error(transparent)]
    Tension(#[from] PathTensionError),
}

impl From<JointMusclesError> for JointTorquesError {
    fn from(error: JointMusclesError) -> Self {
        match error {
            JointMusclesError::Posture(error) => Self::Posture(error),
            JointMusclesError::Tension(error) => Self::Muscles(error),
        }
    }
}

impl JointMuscles {
    /// Space for the muscles of `model`. Passive torque counts at the rates `passive`, strength at the rates `strong`.
    pub fn new(model: &Model, muscles: Musculature, passive: &[usize], strong: &[usize]) -> Self {
        let n = model.rates().len();
        let about = |balls: &Model| (Kinematics::new(balls), PathGeometry::new(balls, &muscles.paths));
        Self {
            geometry: PathGeometry::new(model, &muscles.paths),
            axes: (!model.three_axis_joints().is_empty()).then(|| about(model.by_axes())),
            rest: vec![FiberState::default(); muscles.muscles.len()],
            full: vec![FiberState::default(); muscles.muscles.len()],
            passive: (0..n).map(|rate| passive.contains(&rate)).collect(),
            strong: strong.to_vec(),
            torques: [vec![0.0; n], vec![0.0; n]],
            fibers: vec![0.0; n],
            sums: vec![[0.0; 2]; n],
            scratch: vec![0.0; n],
            muscles,
            laws: None,
        }
    }

    /// The same, whose passive torque becomes laws of the body near each posture that it is given ([`JointMuscles::pose`]): of the coordinates
    /// at which it counts, each with the range over which its table is made, rad.
    ///
    /// # Errors
    /// [`PathTensionError::Tendon`] for a tendon of MuJoCo, whose torque has no known gradient.
    pub fn with_laws(self, model: &Model, coordinates: &[(usize, (f64, f64))]) -> Result<Self, PathTensionError> {
        let laws = MuscleLaws::new(model, &self.muscles, coordinates)?;
        Ok(Self { laws: Some(Box::new(laws)), ..self })
    }

    /// The same, whose muscles share torques by a measure.
    #[must_use]
    pub fn with_sharing(mut self, sharing: Sharing) -> Self {
        self.muscles.sharing = sharing;
        self
    }

    /// The rises of the passive torque in the posture of the last [`JointMuscles::pose`], by coordinate with a law.
    pub fn rises(&mut self, model: &Model, posture: &Posture) -> Vec<TorqueRise> {
        let mut angles = posture.values().to_vec();
        for joint in model.three_axis_joints() {
            let about = joint.orientation(posture.values()).angles.values;
            joint.coordinates.into_iter().zip(about).for_each(|(i, angle)| angles[i] = angle);
        }
        self.laws.as_mut().map_or_else(Vec::new, |laws| laws.rises(model, &angles))
    }

    /// Leaves the passive torque of coordinates to these laws.
    pub fn leave_passive(&mut self, model: &mut Model, laws: Vec<(usize, Option<PassiveLaw>)>) {
        let coordinates: Vec<usize> = laws.iter().map(|(coordinate, _)| *coordinate).collect();
        for rate in coordinates.iter().filter_map(|&coordinate| model.coordinates[coordinate].rate) {
            self.passive[rate] = false;
        }
        self.laws.iter_mut().for_each(|of_muscles| of_muscles.leave(&coordinates));
        laws.into_iter().for_each(|(coordinate, law)| model.coordinates[coordinate].passive = law);
    }

    /// Whether the muscles give the passive torque of a rate.
    pub fn gives_passive(&self, rate: usize) -> bool {
        self.passive[rate]
    }

    /// The muscles.
    pub fn musculature(&self) -> &Musculature {
        &self.muscles
    }

    /// Paths of the last update, with moment arms about axes.
    pub fn about_axes(&self) -> &PathGeometry {
        self.axes.as_ref().map_or(&self.geometry, |(_, geometry)| geometry)
    }

    /// The rates at which strength counts.
    pub fn strong(&self) -> &[usize] {
        &self.strong
    }

    /// Tension of every muscle in the last update at full activation beyond that of its passive fibres, N; 0 where it would be less.
    pub fn forces(&self) -> impl Iterator<Item = f64> {
        self.rest.iter().zip(&self.full).map(|(rest, full)| (full.tendon_force - rest.passive_force).max(0.0))
    }

    /// Tension of the passive fibres of every muscle in the last update, N.
    pub fn passive_forces(&self) -> impl Iterator<Item = f64> {
        self.rest.iter().map(|rest| rest.passive_force)
    }

    /// Computes passive torque and strength in `posture`, which `kinematics` hold. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model.
    pub fn update(&mut self, model: &Model, posture: &Posture, kinematics: &Kinematics) -> Result<(), PostureError> {
        let paths = &self.muscles.paths;
        self.geometry.update(model, kinematics, paths, PathRule::Geodesic);
        if let Some((balls, geometry)) = &mut self.axes {
            balls.update(model.by_axes(), posture)?;
            geometry.update(model.by_axes(), balls, paths, PathRule::Geodesic);
        }
        for (muscle, (rest, full)) in self.muscles.muscles.iter().zip(self.rest.iter_mut().zip(&mut self.full)) {
            let length = self.geometry.lengths()[muscle.spec().path];
            *rest = muscle.at_rest(length, RESTING_ACTIVATION);
            if !self.strong.is_empty() {
                *full = muscle.at_rest(length, 1.0);
            }
        }
        let (balls, about_axes) = self.axes.as_ref().map_or((kinematics, &self.geometry), |(k, g)| (k, g));
        let bodies = [(model, kinematics, &self.geometry), (model.by_axes(), balls, about_axes)];
        for ((body, at, geometry), torques) in bodies.into_iter().zip(&mut self.torques) {
            passive_torque(&self.muscles, geometry, &self.rest, torques);
            bushing_torque(&self.muscles.bushings, body, at, &mut self.scratch);
            for ((torque, more), counts) in torques.iter_mut().zip(&self.scratch).zip(&self.passive) {
                *torque = if *counts { *torque + more } else { 0.0 };
            }
        }
        passive_fiber_torque(&self.muscles, about_axes, &self.rest, &mut self.fibers);
        strength(&self.muscles, about_axes, &self.rest, &self.full, &mut self.sums);
        Ok(())
    }

    /// Passive torque by rate in the posture of the last update, N m: of coordinates, and about axes.
    pub fn passive_torques(&self) -> [&[f64]; 2] {
        self.torques.each_ref().map(Vec::as_slice)
    }

    /// The muscles at rest in the posture of `kinematics`, about axes.
    fn at_rest<'a>(&'a self, kinematics: &'a Kinematics) -> MusclesAtRest<'a> {
        let about_axes = self.axes.as_ref().map(|(balls, geometry)| (balls, geometry));
        let (balls, geometry) = about_axes.unwrap_or((kinematics, &self.geometry));
        MusclesAtRest { muscles: &self.muscles, states: &self.rest, balls, geometry, torques: &self.torques[1] }
    }

    /// Gives the muscle groups of `model` the strength that they have in `posture`, and its coordinates their passive laws near it
    /// ([`JointMuscles::with_laws`]). Returns the greatest change of a strength, or of a passive torque there, as a share of the strength (of
    /// 1 N m without one, and at least).
    ///
    /// # Errors
    /// [`JointMusclesError`] when the posture does not fit the model, or a tension is no number to calculate with.
    pub fn pose(&mut self, model: &mut Model, posture: &Posture) -> Result<f64, JointMusclesError> {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture)?;
        self.update(model, posture, &kinematics)?;
        let known = self.known_passive(model, &kinematics);
        if let Some(mut laws) = self.laws.take() {
            let written = laws.write(model, posture, &kinematics, self.at_rest(&kinematics));
            self.laws = Some(laws);
            written?;
        }
        let strengths = |model: &Model| -> Vec<f64> {
            let coordinates = self.strong.iter().filter_map(|&rate| model.rates[rate].coordinate);
            let groups = coordinates.filter_map(|coordinate| model.coordinates[coordinate].groups.as_ref());
            groups.flatten().map(|group| group.strength.peak).collect()
        };
        let before = strengths(model);
        self.write_strength(model);
        let changes = before
            .iter()
            .zip(strengths(model))
            .map(|(before, after)| (before - after).abs() / after.max(LEAST_CHANGE_OF));
        let change = changes.fold(0.0, f64::max);
        let of_passive = known.into_iter().map(|(rate, known)| {
            let strength = |coordinate: usize| model.coordinates[coordinate].groups.as_ref();
            let groups = model.rates[rate].coordinate.and_then(strength);
            let weaker = groups.map_or(1.0, |groups| groups[0].strength.peak.min(groups[1].strength.peak));
            (known - self.torques[1][rate]).abs() / weaker.max(LEAST_CHANGE_OF)
        });
        Ok(of_passive.fold(change, f64::max))
    }

    /// Passive torque by the laws that the body has, about axes, N m, by rate with a law.
    fn known_passive(&self, model: &Model, kinematics: &Kinematics) -> Vec<(usize, f64)> {
        let coordinates = self.laws.iter().flat_map(|laws| laws.coordinates());
        let rates: Vec<(usize, usize)> = coordinates.filter_map(|i| Some((i, model.coordinates[i].rate?))).collect();
        if rates.is_empty() {
            return vec![];
        }
        let mut passive = PassiveTorque::new(model);
        if passive.update(model, kinematics).is_err() {
            return vec![];
        }
        rates.into_iter().map(|(i, rate)| (rate, passive.law_about_axis(model, i))).collect()
    }

    /// Gives the muscle groups of the coordinates at which strength counts the strength of the last update.
    pub fn write_strength(&self, model: &mut Model) {
        for &rate in &self.strong {
            let ([positive, negative], passive) = (self.sums[rate], self.fibers[rate]);
            let Some(coordinate) = model.rates[rate].coordinate else { continue };
            let Some(groups) = model.coordinates[coordinate].groups.as_mut() else { continue };
            for (side, beyond) in [(Side::Positive, positive - passive), (Side::Negative, passive - negative)] {
                groups[side.index()].strength = Strength::constant(beyond.max(LEAST_MUSCLE_STRENGTH));
            }
        }
    }
}
