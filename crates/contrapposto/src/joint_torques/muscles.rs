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

use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::muscle::{
    FiberState, Musculature, PathGeometry, PathRule, bushing_torque, passive_fiber_torque, passive_torque, strength,
};
use crate::posture::{Posture, PostureError};
use crate::strength::Strength;

/// Activation of a muscle at rest: the least of OpenSim's muscles.
pub const RESTING_ACTIVATION: f64 = 0.01;
/// Least strength that muscles give, N m (N for slides): where none pulls, relative load stays finite (assumed).
pub const LEAST_MUSCLE_STRENGTH: f64 = 1e-3;

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
        }
    }

    /// Whether the muscles give the passive torque of a rate.
    pub fn gives_passive(&self, rate: usize) -> bool {
        self.passive[rate]
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

    /// Gives the muscle groups of `model` the strength that they have in `posture`, and returns the greatest change of one, as a share
    /// of the new strength.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model.
    pub fn pose(&mut self, model: &mut Model, posture: &Posture) -> Result<f64, PostureError> {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture)?;
        self.update(model, posture, &kinematics)?;
        let strengths = |model: &Model| -> Vec<f64> {
            let coordinates = self.strong.iter().filter_map(|&rate| model.rates[rate].coordinate);
            let groups = coordinates.filter_map(|coordinate| model.coordinates[coordinate].groups.as_ref());
            groups.flatten().map(|group| group.strength.peak).collect()
        };
        let before = strengths(model);
        self.write_strength(model);
        let changes = before.iter().zip(strengths(model)).map(|(before, after)| (before / after - 1.0).abs());
        Ok(changes.fold(0.0, f64::max))
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
