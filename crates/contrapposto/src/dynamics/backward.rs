//! Carries forces of inertia from the ends to the root, and gives the torques of every rate: the backward pass of recursive Newton-Euler.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::{Model, Motion};

/// The force (N) on a segment, and its moment about the ground origin (N m), ground axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench {
    pub(super) segment: usize,
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
}

/// Torques that wrenches on segments give. Depends on posture and wrenches; filled by [`WrenchTorques::update`].
#[derive(Clone, Debug)]
pub(super) struct WrenchTorques {
    /// Force and moment at and beyond each mobility.
    sums: Vec<(Vector3<f64>, Vector3<f64>)>,
    /// By elementary rate.
    pub(super) elements: Vec<f64>,
    /// By rate, nothing coupled.
    pub(super) raw: Vec<f64>,
    /// By rate, dependent coordinates folded into their independent ones.
    pub(super) torques: Vec<f64>,
}

impl WrenchTorques {
    pub(super) fn new(model: &Model) -> Self {
        let rates = vec![0.0; model.rates.len()];
        let sums = vec![(Vector3::zeros(), Vector3::zeros()); model.mobilities.len()];
        Self { sums, elements: vec![0.0; model.elements.len()], raw: rates.clone(), torques: rates }
    }

    /// Computes them in the posture that `kinematics` holds. Does not allocate.
    pub(super) fn update(&mut self, model: &Model, kinematics: &Kinematics, wrenches: &[Wrench]) {
        self.sums.fill((Vector3::zeros(), Vector3::zeros()));
        for wrench in wrenches {
            let Some(mobility) = model.segments[wrench.segment].mobility else { continue };
            let (force, moment) = &mut self.sums[mobility];
            *force += wrench.force;
            *moment += wrench.moment;
        }
        for (i, mobility) in model.mobilities.iter().enumerate().rev() {
            let (force, moment) = self.sums[i];
            if let Some(parent) = mobility.parent {
                let sum = &mut self.sums[parent];
                sum.0 += force;
                sum.1 += moment;
            }
            let turning = match mobility.motion {
                Motion::Slide(_) => force,
                _ => moment - kinematics.origins[i].cross(&force),
            };
            for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                self.elements[element] = kinematics.axes[element].dot(&turning);
            }
        }
        if model.direct {
            self.raw.copy_from_slice(&self.elements);
        } else {
            kinematics.fold_elements(model, &self.elements, &mut self.raw);
        }
        kinematics.fold_couplings(model, &self.raw, &mut self.torques);
    }
}
