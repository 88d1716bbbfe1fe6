//! External torque by virtual work, and how it changes with every coordinate.
//!
//! Torque of rate `d` with unit axis `r_d` through `p_d` (Rodriguez & Boulic 2007, section 3): with `F` the sum of the
//! forces carried beyond `d` and `M` their moment about the ground origin, `tau_d = r_d . (M - p_d x F)` for a hinge and
//! `r_d . F` for a slide.
//!
//! Gradient. Eq. 8 as printed holds for joints between `l` and the root only. For world-fixed forces and a pair with `a`
//! the nearer and `d` the farther from the root on one chain, the second derivative of a carried point is
//! `r_a x (r_d x (x - p_d))`, so both entries of the pair are `r_a . v_d` with
//! `v_d = sum_i (f_i . r_d)(x_i - p_d) - (f_i . (x_i - p_d)) r_d` (hinge) or `r_d x F` (slide): one vector a rate, one dot
//! product a pair. Entries on different branches, and of a slide nearer the root, are zero. Couples and body-fixed
//! forces are not symmetric and have their own terms below. See docs/deviations.md, D1.
//!
//! All of this is done for elementary motions. Where functions drive them, or coordinates follow others, torques and
//! gradient are folded by the chain rule at the end (`fold.rs`).

use nalgebra::{Matrix3, Vector3};

use super::{FixedIn, Gradient, Load, LoadError, LoadKind};
use crate::kinematics::{Carried, CenterOfMass, Kinematics};
use crate::model::{Model, Motion};

/// The loads at and beyond one mobility, in ground axes.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    /// World-fixed forces: sum, and sum of `x f^T`.
    force: Vector3<f64>,
    virial: Matrix3<f64>,
    /// World-fixed couples.
    couple: Vector3<f64>,
    /// Body-fixed wrench: force, and moment about the ground origin.
    body_force: Vector3<f64>,
    body_moment: Vector3<f64>,
    /// There are any.
    any: bool,
}

impl Pull {
    fn add(&mut self, other: &Self) {
        self.any = true;
        self.force += other.force;
        self.virial += other.virial;
        self.couple += other.couple;
        self.body_force += other.body_force;
        self.body_moment += other.body_moment;
    }
}

/// External torque of every rate. Depends on posture and loads; filled by [`ExternalTorque::update`].
#[derive(Clone, Debug)]
pub struct ExternalTorque {
    /// By rate, dependent coordinates folded into their independent ones.
    torques: Vec<f64>,
    /// By rate, nothing coupled.
    raw: Vec<f64>,
    /// By elementary rate.
    pub(super) elements: Vec<f64>,
    center_of_mass: CenterOfMass,
    pulls: Vec<Pull>,
    /// Some load is a couple or fixed in a segment.
    twisted: bool,
    /// `v_d` of the module's text, by elementary rate: gravity and world-fixed forces.
    bends: Vec<Vector3<f64>>,
}

impl ExternalTorque {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            torques: vec![0.0; model.rates.len()],
            raw: vec![0.0; model.rates.len()],
            elements: vec![0.0; model.elements.len()],
            center_of_mass: CenterOfMass::new(model),
            pulls: vec![Pull::default(); model.mobilities.len()],
            twisted: false,
            bends: vec![Vector3::zeros(); model.elements.len()],
        }
    }

    /// Computes gravity and `loads` in the posture that `kinematics` holds. Does not allocate.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the model; nothing is changed then.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics, loads: &[Load]) -> Result<(), LoadError> {
        self.update_with(model, kinematics, loads, &[])
    }

    /// As [`ExternalTorque::update`], with torques of elementary motions that are added to those of weight and `loads`. They have no part in
    /// gradient and slopes.
    ///
    /// # Errors
    /// As [`ExternalTorque::update`].
    pub(crate) fn update_with(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        loads: &[Load],
        more: &[f64],
    ) -> Result<(), LoadError> {
        self.pull(model, kinematics, loads)?;
        self.center_of_mass.gather(model, kinematics);
        for i in (0..model.mobilities.len()).rev() {
            let carried = self.center_of_mass.carry(model, i);
            self.torques_of_weight(model, kinematics, i, carried);
            self.torques_of_loads(model, kinematics, i);
        }
        self.elements.iter_mut().zip(more).for_each(|(torque, more)| *torque += more);
        self.fold(model, kinematics);
        Ok(())
    }

    /// Computes `loads` alone, as if the body had no weight; where its centre of mass is stays unknown. Does not allocate.
    ///
    /// # Errors
    /// As [`ExternalTorque::update`].
    pub(crate) fn update_weightless(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        loads: &[Load],
    ) -> Result<(), LoadError> {
        self.pull(model, kinematics, loads)?;
        self.elements.fill(0.0);
        self.bends.fill(Vector3::zeros());
        for i in (0..model.mobilities.len()).rev() {
            self.torques_of_loads(model, kinematics, i);
        }
        self.fold(model, kinematics);
        Ok(())
    }

    /// Loads on each mobility itself.
    fn pull(&mut self, model: &Model, kinematics: &Kinematics, loads: &[Load]) -> Result<(), LoadError> {
        for load in loads {
            load.check(model)?;
        }
        self.pulls.iter_mut().filter(|pull| pull.any).for_each(|pull| *pull = Pull::default());
        self.twisted = false;
        for load in loads {
            self.add_load(model, kinematics, load);
        }
        Ok(())
    }

    /// Torques of elementary motions become torques of rates.
    fn fold(&mut self, model: &Model, kinematics: &Kinematics) {
        if model.direct {
            self.torques.copy_from_slice(&self.elements);
        } else {
            kinematics.fold_elements(model, &self.elements, &mut self.raw);
            kinematics.fold_couplings(model, &self.raw, &mut self.torques);
        }
    }

    fn add_load(&mut self, model: &Model, kinematics: &Kinematics, load: &Load) {
        let Some(mobility) = model.segments[load.segment].mobility else { return };
        let pull = &mut self.pulls[mobility];
        pull.any = true;
        let station = || kinematics.station(model, load.segment, load.point);
        let mut world = |force: Vector3<f64>| {
            pull.force += force;
            pull.virial += station() * force.transpose();
        };
        match load.kind {
            LoadKind::Weight(mass) => world(mass * model.gravity),
            LoadKind::Force(force, FixedIn::World) => world(force),
            LoadKind::Force(force, FixedIn::Segment) => {
                let force = kinematics.direction(model, load.segment, force);
                pull.body_force += force;
                pull.body_moment += station().cross(&force);
                self.twisted = true;
            }
            LoadKind::Couple(couple, FixedIn::World) => {
                pull.couple += couple;
                self.twisted = true;
            }
            LoadKind::Couple(couple, FixedIn::Segment) => {
                pull.body_moment += kinematics.direction(model, load.segment, couple);
                self.twisted = true;
            }
        }
    }

    /// Torques and `v_d` that weight gives one mobility, whose carried sums are complete.
    fn torques_of_weight(&mut self, model: &Model, kinematics: &Kinematics, i: usize, carried: Carried) {
        let mobility = &model.mobilities[i];
        let gravity = model.gravity;
        let Carried { mass, first_moment } = carried;
        let point = kinematics.origins[i];
        let lever = first_moment - mass * point;
        let along = lever.dot(&gravity);
        if let Motion::Slide(_) = mobility.motion {
            let axis = kinematics.axes[mobility.rate];
            let force = mass * gravity;
            self.elements[mobility.rate] = axis.dot(&force);
            self.bends[mobility.rate] = axis.cross(&force);
        } else {
            let moment = lever.cross(&gravity);
            for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                let axis = kinematics.axes[element];
                self.elements[element] = axis.dot(&moment);
                self.bends[element] = lever * gravity.dot(&axis) - along * axis;
            }
        }
    }

    /// Adds what loads give to torques and `v_d` of one mobility, and hands them on to its parent.
    fn torques_of_loads(&mut self, model: &Model, kinematics: &Kinematics, i: usize) {
        if !self.pulls[i].any {
            return;
        }
        let mobility = &model.mobilities[i];
        if let Some(parent) = mobility.parent {
            let (near, far) = self.pulls.split_at_mut(i);
            near[parent].add(&far[0]);
        }
        let pull = &self.pulls[i];
        if let Motion::Slide(_) = mobility.motion {
            let axis = kinematics.axes[mobility.rate];
            self.elements[mobility.rate] += axis.dot(&(pull.force + pull.body_force));
            self.bends[mobility.rate] += axis.cross(&pull.force);
            return;
        }
        let point = kinematics.origins[i];
        let virial = pull.virial - point * pull.force.transpose();
        let moment = axial(&virial) + pull.couple + (pull.body_moment - point.cross(&pull.body_force));
        for element in mobility.rate..mobility.rate + mobility.motion.rates() {
            let axis = kinematics.axes[element];
            self.elements[element] += axis.dot(&moment);
            self.bends[element] += virial * axis - virial.trace() * axis;
        }
    }

    /// External torque of every rate, N m (N for slides), in the model's order. The torque of a dependent coordinate
    /// is folded into the independent one, and the entry of the dependent one is zero.
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// As [`ExternalTorque::torques`], but as if no coordinate followed another one.
    pub fn uncoupled_torques<'a>(&'a self, model: &Model) -> &'a [f64] {
        if model.direct { &self.torques } else { &self.raw }
    }

    /// `d tau_e,l / d theta_l` of a hinge or slide: the slope that Table 1 extrapolates, N m/rad.
    ///
    /// Couples and body-fixed forces do not change a joint's own torque when that joint alone moves. Where functions
    /// drive the body the whole gradient is computed for it.
    pub fn own_slope(&self, kinematics: &Kinematics, model: &Model, rate: usize) -> f64 {
        if !model.direct {
            let mut gradient = Gradient::new(model);
            self.gradient(model, kinematics, &mut gradient);
            return gradient.get(rate, rate);
        }
        if model.rates[rate].rotational { kinematics.axes[rate].dot(&self.bends[rate]) } else { 0.0 }
    }

    /// The full matrix of Eq. 7, all pairs right, coupled coordinates folded. Does not allocate.
    pub fn gradient(&self, model: &Model, kinematics: &Kinematics, gradient: &mut Gradient) {
        assert_eq!(gradient.size(), model.rates.len(), "gradient was made for another model");
        let n = model.elements.len();
        let matrix = gradient.begin(model, self.twisted);
        for (far, range) in model.mobilities.iter().zip(model.ancestor_starts.windows(2)) {
            let nearer = &model.ancestors[range[0]..range[1]];
            let elements = far.rate..far.rate + far.motion.rates();
            for element in elements.clone() {
                let bend = self.bends[element];
                if !matches!(far.motion, Motion::Slide(_)) {
                    for other in elements.clone() {
                        matrix[element * n + other] = kinematics.axes[other].dot(&bend);
                    }
                }
                for &other in nearer {
                    let entry = kinematics.axes[other].dot(&bend);
                    matrix[element * n + other] = entry;
                    matrix[other * n + element] = entry;
                }
            }
        }
        if self.twisted {
            self.add_twists(model, kinematics, matrix);
        }
        gradient.fold(model, kinematics, &self.elements, &self.raw);
    }

    /// Centre of mass of the whole body, from the sums that the last update carried to the root.
    pub fn center_of_mass(&self) -> &CenterOfMass {
        &self.center_of_mass
    }

    /// Adds the terms of couples and body-fixed forces to the gradient; neither is symmetric.
    fn add_twists(&self, model: &Model, kinematics: &Kinematics, matrix: &mut [f64]) {
        let n = model.elements.len();
        for (i, far) in model.mobilities.iter().enumerate() {
            let pull = &self.pulls[i];
            let far_slides = matches!(far.motion, Motion::Slide(_));
            for element in far.rate..far.rate + far.motion.rates() {
                let axis = kinematics.axes[element];
                if !far_slides {
                    // A ball's three axes turn with every motion of the ball.
                    for other in far.rate..far.rate + far.motion.rates() {
                        matrix[element * n + other] += kinematics.axes[other].dot(&axis.cross(&pull.couple));
                    }
                }
                // Change of the carried body-fixed wrench by the far motion (moment about the ground origin).
                let (force, moment) = if far_slides {
                    (Vector3::zeros(), axis.cross(&pull.body_force))
                } else {
                    let velocity = kinematics.origins[i].cross(&axis);
                    (axis.cross(&pull.body_force), axis.cross(&pull.body_moment) + velocity.cross(&pull.body_force))
                };
                let couple = if far_slides { Vector3::zeros() } else { axis.cross(&pull.couple) };
                let twist = Twist { element, slides: far_slides, couple, force, moment };
                let mut ancestor = far.parent;
                while let Some(j) = ancestor {
                    twist.add(model, kinematics, j, matrix);
                    ancestor = model.mobilities[j].parent;
                }
            }
        }
    }
}

/// Changes of the couple and of the body-fixed wrench that one elementary motion carries, by that motion.
struct Twist {
    /// The elementary motion.
    element: usize,
    slides: bool,
    couple: Vector3<f64>,
    force: Vector3<f64>,
    /// About the ground origin.
    moment: Vector3<f64>,
}

impl Twist {
    /// Adds the entries of the motion and those of mobility `near`, one of its ancestors.
    fn add(&self, model: &Model, kinematics: &Kinematics, near: usize, matrix: &mut [f64]) {
        let (n, element) = (model.elements.len(), self.element);
        let mobility = &model.mobilities[near];
        for other in mobility.rate..mobility.rate + mobility.motion.rates() {
            let axis = kinematics.axes[other];
            if matches!(mobility.motion, Motion::Slide(_)) {
                matrix[other * n + element] += axis.dot(&self.force);
                continue;
            }
            if !self.slides {
                matrix[element * n + other] += axis.dot(&self.couple);
            }
            matrix[other * n + element] += axis.dot(&(self.moment - kinematics.origins[near].cross(&self.force)));
        }
    }
}

/// `sum x_i x f_i` from `sum x_i f_i^T`.
fn axial(virial: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(virial[(1, 2)] - virial[(2, 1)], virial[(2, 0)] - virial[(0, 2)], virial[(0, 1)] - virial[(1, 0)])
}
