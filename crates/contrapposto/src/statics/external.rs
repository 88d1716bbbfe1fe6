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

use nalgebra::{Matrix3, Vector3};

use super::{FixedIn, Load, LoadError, LoadKind};
use crate::kinematics::Kinematics;
use crate::model::{Model, Motion};

/// What is carried at and beyond one mobility, in ground axes.
#[derive(Clone, Copy, Debug, Default)]
struct Carried {
    mass: f64,
    /// Mass times position, kg m.
    first_moment: Vector3<f64>,
    /// World-fixed forces without gravity: sum, and sum of `x f^T`.
    force: Vector3<f64>,
    virial: Matrix3<f64>,
    /// World-fixed couples.
    couple: Vector3<f64>,
    /// Body-fixed wrench: force, and moment about the ground origin.
    body_force: Vector3<f64>,
    body_moment: Vector3<f64>,
}

impl Carried {
    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first_moment += other.first_moment;
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
    torques: Vec<f64>,
    carried: Vec<Carried>,
    /// `v_d` of the module's text, gravity and world-fixed forces.
    bends: Vec<Vector3<f64>>,
}

/// `d external_i / d q_j`, N m/rad (or per m), rows and columns in the order of the model's rates.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    n: usize,
    entries: Vec<f64>,
}

impl Gradient {
    /// Space for a model with `n` rates.
    pub fn new(n: usize) -> Self {
        Self { n, entries: vec![0.0; n * n] }
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// `d external_row / d q_column`.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.n + column]
    }

    /// Row `J tau_e,l` of Eq. 7.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.n..(row + 1) * self.n]
    }
}

impl ExternalTorque {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            torques: vec![0.0; model.rates.len()],
            carried: vec![Carried::default(); model.mobilities.len()],
            bends: vec![Vector3::zeros(); model.rates.len()],
        }
    }

    /// Computes gravity and `loads` in the posture that `kinematics` holds. Does not allocate.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the model; nothing is changed then.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics, loads: &[Load]) -> Result<(), LoadError> {
        for load in loads {
            load.check(model)?;
        }
        for (i, (carried, mobility)) in self.carried.iter_mut().zip(&model.mobilities).enumerate() {
            *carried = Carried {
                mass: mobility.mass,
                first_moment: kinematics.rotations[i] * mobility.first_moment + mobility.mass * kinematics.origins[i],
                ..Carried::default()
            };
        }
        for load in loads {
            self.add_load(model, kinematics, load);
        }
        for i in (0..model.mobilities.len()).rev() {
            let mobility = &model.mobilities[i];
            let carried = self.carried[i];
            if let Some(parent) = mobility.parent {
                self.carried[parent].add(&carried);
            }
            let gravity = model.gravity;
            let point = kinematics.origins[i];
            let force = carried.mass * gravity + carried.force;
            let lever = carried.first_moment - carried.mass * point;
            let virial = carried.virial - point * carried.force.transpose();
            let moment = lever.cross(&gravity)
                + axial(&virial)
                + carried.couple
                + (carried.body_moment - point.cross(&carried.body_force));
            for rate in mobility.rate..mobility.rate + mobility.motion.rates() {
                let axis = kinematics.axes[rate];
                if let Motion::Slide(_) = mobility.motion {
                    self.torques[rate] = axis.dot(&(force + carried.body_force));
                    self.bends[rate] = axis.cross(&force);
                } else {
                    self.torques[rate] = axis.dot(&moment);
                    self.bends[rate] =
                        lever * gravity.dot(&axis) + virial * axis - (lever.dot(&gravity) + virial.trace()) * axis;
                }
            }
        }
        Ok(())
    }

    fn add_load(&mut self, model: &Model, kinematics: &Kinematics, load: &Load) {
        let Some(mobility) = model.segments[load.segment].mobility else { return };
        let carried = &mut self.carried[mobility];
        let point = kinematics.station(model, load.segment, load.point);
        let mut world = |force: Vector3<f64>| {
            carried.force += force;
            carried.virial += point * force.transpose();
        };
        match load.kind {
            LoadKind::Weight(mass) => world(mass * model.gravity),
            LoadKind::Force(force, FixedIn::World) => world(force),
            LoadKind::Force(force, FixedIn::Segment) => {
                let force = kinematics.direction(model, load.segment, force);
                carried.body_force += force;
                carried.body_moment += point.cross(&force);
            }
            LoadKind::Couple(couple, FixedIn::World) => carried.couple += couple,
            LoadKind::Couple(couple, FixedIn::Segment) => {
                carried.body_moment += kinematics.direction(model, load.segment, couple);
            }
        }
    }

    /// External torque of every rate, N m (N for slides), in the model's order.
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// `d tau_e,l / d theta_l` of a hinge or slide: the slope that Table 1 extrapolates, N m/rad.
    ///
    /// Couples and body-fixed forces do not change a joint's own torque when that joint alone moves.
    pub fn own_slope(&self, kinematics: &Kinematics, model: &Model, rate: usize) -> f64 {
        if model.rates[rate].rotational { kinematics.axes[rate].dot(&self.bends[rate]) } else { 0.0 }
    }

    /// The full matrix of Eq. 7, all pairs right. Does not allocate.
    pub fn gradient(&self, model: &Model, kinematics: &Kinematics, gradient: &mut Gradient) {
        assert_eq!(gradient.n, model.rates.len(), "gradient was made for another model");
        gradient.entries.fill(0.0);
        for far in 0..model.mobilities.len() {
            self.pairs_within(model, kinematics, far, gradient);
            let mut ancestor = model.mobilities[far].parent;
            while let Some(near) = ancestor {
                self.pairs_between(model, kinematics, near, far, gradient);
                ancestor = model.mobilities[near].parent;
            }
        }
    }

    /// Entries of one mobility with itself. A ball's three axes turn with every motion of the ball.
    fn pairs_within(&self, model: &Model, kinematics: &Kinematics, own: usize, gradient: &mut Gradient) {
        let mobility = &model.mobilities[own];
        if let Motion::Slide(_) = mobility.motion {
            return;
        }
        let rates = mobility.rate..mobility.rate + mobility.motion.rates();
        for row in rates.clone() {
            let turned = self.bends[row] + kinematics.axes[row].cross(&self.carried[own].couple);
            for column in rates.clone() {
                gradient.entries[row * gradient.n + column] = kinematics.axes[column].dot(&turned);
            }
        }
    }

    /// Entries of two mobilities of one chain, `near` nearer the root.
    fn pairs_between(&self, model: &Model, kinematics: &Kinematics, near: usize, far: usize, gradient: &mut Gradient) {
        let n = gradient.n;
        let (a, d) = (&model.mobilities[near], &model.mobilities[far]);
        let carried = &self.carried[far];
        let near_slides = matches!(a.motion, Motion::Slide(_));
        for rate_d in d.rate..d.rate + d.motion.rates() {
            let axis = kinematics.axes[rate_d];
            let far_slides = matches!(d.motion, Motion::Slide(_));
            // What the far motion does to the body-fixed wrench it carries (moment about the ground origin).
            let (turned_force, turned_moment) = if far_slides {
                (Vector3::zeros(), axis.cross(&carried.body_force))
            } else {
                let velocity = kinematics.origins[far].cross(&axis);
                let moment = axis.cross(&carried.body_moment) + velocity.cross(&carried.body_force);
                (axis.cross(&carried.body_force), moment)
            };
            for rate_a in a.rate..a.rate + a.motion.rates() {
                let near_axis = kinematics.axes[rate_a];
                let (mut row_far, mut row_near) = (0.0, 0.0);
                if near_slides {
                    row_near += near_axis.dot(&turned_force);
                } else {
                    let both = near_axis.dot(&self.bends[rate_d]);
                    row_far += both;
                    row_near += both;
                    if !far_slides {
                        row_far += near_axis.dot(&axis.cross(&carried.couple));
                    }
                    row_near += near_axis.dot(&(turned_moment - kinematics.origins[near].cross(&turned_force)));
                }
                gradient.entries[rate_d * n + rate_a] = row_far;
                gradient.entries[rate_a * n + rate_d] = row_near;
            }
        }
    }
}

/// `sum x_i x f_i` from `sum x_i f_i^T`.
fn axial(virial: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(virial[(1, 2)] - virial[(2, 1)], virial[(2, 0)] - virial[(0, 2)], virial[(0, 1)] - virial[(1, 0)])
}
