//! Computes the torque of tensions along paths, and how it changes with every coordinate, by the geodesic rule.
//!
//! A tension `T(L)` along a path of length `L(q)` gives the torque `tau_i = -T dL/dq_i`, which has a potential. With moment arms
//! `R_i = -dL/dq_i`:
//!
//! ```text
//! d tau_i/dq_j = -T' R_i R_j - T d2L/dq_i dq_j
//! ```
//!
//! The second derivative has one part of the second derivatives of the corners with the forces on them held, which is the gradient
//! of external torque of these forces, and one of the forces' own changes ([`super::path_curvature`]).

use super::path_curvature::{PathCurvature, Posed, Rates};
use super::{ExternalTorque, FixedIn, Gradient, Load, LoadError, LoadKind};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::muscle::{PathGeometry, PathRule, Paths, Tension};

/// The reason for which tensions have no torque, or no gradient.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathTensionError {
    /// A tension is no number to calculate with.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The path of this index is a tendon of MuJoCo.
    #[error(
        "path {0} is a tendon of MuJoCo, for which no gradient of its torque is known; paths of OpenSim files have one, and the torque alone \
         is the tension times the moment arms"
    )]
    Tendon(usize),
}

/// Torque of tensions along paths by rate, and its gradient. Filled by [`PathTension::update`].
#[derive(Clone, Debug)]
pub struct PathTension {
    torques: Vec<f64>,
    /// Row after row.
    gradient: Vec<f64>,
    rates: Rates,
    /// By path: the independent rates that move any part of it.
    moving: Vec<Vec<usize>>,
    curvature: PathCurvature,
    loads: Vec<Load>,
    held: ExternalTorque,
    held_gradient: Gradient,
}

impl PathTension {
    /// Space for the paths of a model.
    pub fn new(model: &Model, paths: &Paths) -> Self {
        let n = model.rates().len();
        let rates = Rates::new(model);
        let moving: Vec<_> = paths.paths.iter().map(|path| rates.moving(model, paths, path)).collect();
        let most = moving.iter().map(Vec::len).max().unwrap_or(0);
        let corners = paths.paths.iter().map(|path| path.points.len() + 2 * path.wraps.len()).sum::<usize>();
        Self {
            torques: vec![0.0; n],
            gradient: vec![0.0; n * n],
            rates,
            moving,
            curvature: PathCurvature::new(model, paths, most),
            loads: Vec::with_capacity(2 * corners),
            held: ExternalTorque::new(model),
            held_gradient: Gradient::new(model),
        }
    }

    /// Computes torque and gradient of one tension a path, in the posture of `kinematics` and `geometry`. Does not allocate.
    ///
    /// # Errors
    /// [`PathTensionError`] for a tension that is not finite or above [`crate::model::LARGEST`], and for a tendon of MuJoCo; torque and
    /// gradient are then unknown.
    ///
    /// # Panics
    /// Unless there is one tension a path, and `geometry` was filled by [`PathRule::Geodesic`]: no other rule has a gradient.
    pub fn update(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        paths: &Paths,
        geometry: &PathGeometry,
        tensions: &[Tension],
    ) -> Result<(), PathTensionError> {
        assert_eq!(tensions.len(), paths.paths.len(), "one tension a path");
        assert_eq!(geometry.rule(), PathRule::Geodesic, "the rule of the paths");
        if let Some(tendon) = paths.paths.iter().position(|path| path.tendon.is_some()) {
            return Err(PathTensionError::Tendon(tendon));
        }
        let n = self.torques.len();
        self.torques.fill(0.0);
        self.gradient.fill(0.0);
        self.loads.clear();
        self.rates.update(model, kinematics);
        for (index, tension) in tensions.iter().enumerate().filter(|(_, t)| t.force != 0.0 || t.stiffness != 0.0) {
            let arms = geometry.moment_arms(index);
            self.torques.iter_mut().zip(arms).for_each(|(torque, arm)| *torque += tension.force * arm);
            let moving = &self.moving[index];
            for &i in moving {
                for &j in moving {
                    self.gradient[i * n + j] -= tension.stiffness * arms[i] * arms[j];
                }
            }
            let at = Posed { model, kinematics, paths, path: &paths.paths[index], geometry, rates: &self.rates };
            self.curvature.update(&at, geometry.line(index), moving);
            for (row, &i) in moving.iter().enumerate() {
                for (column, &j) in moving.iter().enumerate() {
                    self.gradient[i * n + j] -= tension.force * self.curvature.get(row, column);
                }
            }
            for &(segment, point, force) in self.curvature.pulls() {
                let (axes, origin) = geometry.segment_frame(segment);
                let kind = LoadKind::Force(tension.force * force, FixedIn::World);
                self.loads.push(Load { segment, point: axes.tr_mul(&(point - origin)), kind });
            }
        }
        self.held.update_weightless(model, kinematics, &self.loads)?;
        self.held.gradient(model, kinematics, &mut self.held_gradient);
        for (row, entries) in self.gradient.chunks_exact_mut(n.max(1)).enumerate() {
            entries.iter_mut().zip(self.held_gradient.row(row)).for_each(|(entry, held)| *entry += held);
        }
        Ok(())
    }

    /// Torque by rate, N m (N for slides); that of dependent coordinates is folded into their independent ones.
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// `d tau_row / d q` by every rate, N m/rad.
    pub fn gradient_row(&self, row: usize) -> &[f64] {
        let n = self.torques.len();
        &self.gradient[row * n..(row + 1) * n]
    }
}
