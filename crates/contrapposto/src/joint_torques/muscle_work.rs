//! Finds how hard every muscle works in a posture: the activations of the least sum of squares that give the active torques of the joints
//! whose strength is the muscles' ([`StaticOptimisation`]).
//!
//! Activation `a` is 0 at rest and 1 at full effort; the tension of a muscle is `F_p + a F`, with that of its passive fibres, `F_p`, and that of full
//! activation beyond it, `F`. Muscles are rested: [`crate::muscle::MuscleFatigue`] has those that tire.

use hierarchical_least_squares::{ProblemError, Status};

use super::muscle_share::works_for;
use super::muscles::JointMuscles;
use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::muscle::{DrawnPoint, Recruitment, StaticOptimisation};
use crate::posture::{Posture, PostureError};

/// Torque that muscles may lack and still count as giving it, N m.
const LACKS_NOTHING: f64 = 1e-6;

/// The work of muscles. Depends on posture and torques; filled by [`MuscleWork::update`].
#[derive(Clone, Debug)]
pub struct MuscleWork {
    muscles: JointMuscles,
    kinematics: Kinematics,
    optimisation: StaticOptimisation,
    works_for: Vec<Option<(usize, Side)>>,
    torques: Vec<f64>,
    none: Vec<f64>,
    bounds: Vec<(f64, f64)>,
    forces: Vec<f64>,
    tensions: Vec<f64>,
}

/// A torque that muscles lack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissingTorque {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Torque, N m, not negative.
    pub torque: f64,
}

/// The reason for which the work of muscles is not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MuscleWorkError {
    /// The posture does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
    /// The problem is none.
    #[error("muscles cannot share these torques: {0}")]
    Problem(#[from] ProblemError),
    /// The search did not end.
    #[error("the activations of least effort were not found: the solver's working set changed too often")]
    Stopped,
}

impl MuscleWork {
    /// Space for the muscles of a model; `None` where they give no joint its strength.
    pub fn new(model: &Model, muscles: &JointMuscles) -> Option<Self> {
        let (count, rates) = (muscles.musculature().muscles.len(), muscles.strong().len());
        (rates > 0).then(|| Self {
            kinematics: Kinematics::new(model),
            optimisation: StaticOptimisation::default(),
            works_for: works_for(model, muscles),
            torques: vec![0.0; rates],
            none: vec![0.0; rates],
            bounds: vec![(0.0, 1.0); count],
            forces: vec![0.0; count],
            tensions: vec![0.0; count],
            muscles: muscles.clone(),
        })
    }

    /// Finds the activations in a posture for the active torque of every coordinate about its axis, N m. Where the muscles cannot give it, those
    /// of the least sum of squares of what is missing.
    ///
    /// # Errors
    /// [`MuscleWorkError`] for a posture that does not fit the model, and numbers that cannot be calculated with.
    ///
    /// # Panics
    /// Unless `active` has a torque for every coordinate.
    pub fn update(&mut self, model: &Model, posture: &Posture, active: &[f64]) -> Result<(), MuscleWorkError> {
        self.kinematics.update(model, posture)?;
        self.muscles.update(model, posture, &self.kinematics)?;
        for (torque, &rate) in self.torques.iter_mut().zip(self.muscles.strong()) {
            *torque = model.rates[rate].coordinate.map_or(0.0, |coordinate| active[coordinate]);
        }
        for (force, of_muscle) in self.forces.iter_mut().zip(self.muscles.forces()) {
            *force = of_muscle;
        }
        let problem = Recruitment {
            rates: self.muscles.strong(),
            torques: &self.torques,
            reserves: &self.none,
            forces: &self.forces,
            bounds: &self.bounds,
        };
        let solved = self.optimisation.solve(self.muscles.musculature(), self.muscles.about_axes(), &problem)?;
        if let Status::Stopped = solved {
            return Err(MuscleWorkError::Stopped);
        }
        let fibers = self.muscles.passive_forces().zip(&self.forces).zip(self.optimisation.activations());
        for (tension, ((passive, force), activation)) in self.tensions.iter_mut().zip(fibers) {
            *tension = passive + activation * force;
        }
        Ok(())
    }

    /// The muscles, in the posture of the last update.
    pub fn muscles(&self) -> &JointMuscles {
        &self.muscles
    }

    /// The frames of the last update.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Activation of every muscle, 0 to 1.
    pub fn activations(&self) -> &[f64] {
        self.optimisation.activations()
    }

    /// Tension of every muscle, that of its passive fibres included, N.
    pub fn tensions(&self) -> &[f64] {
        &self.tensions
    }

    /// The coordinate and the side of the group that each muscle works for.
    pub fn works_for(&self) -> &[Option<(usize, Side)>] {
        &self.works_for
    }

    /// The greatest torque that the muscles lack; `None` where they give all.
    pub fn missing(&self, model: &Model) -> Option<MissingTorque> {
        let lacks = self.muscles.strong().iter().zip(self.optimisation.residual());
        let (&rate, residual) = lacks.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let coordinate = model.rates[rate].coordinate?;
        (residual.abs() > LACKS_NOTHING).then_some(MissingTorque { coordinate, torque: residual.abs() })
    }

    /// Points along the line of a muscle, in ground.
    pub fn line(&self, muscle: usize) -> Vec<DrawnPoint> {
        let musculature = self.muscles.musculature();
        self.muscles.about_axes().drawn(&musculature.paths, musculature.muscles[muscle].spec().path)
    }
}
