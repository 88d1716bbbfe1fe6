//! Computes the torque of bushings: linear springs between two frames, and bands that stretch as one frame turns.
//!
//! With the second frame in the first at body-fixed rotations a, b, c about x, y, z and at d, the energy is half the sum of stiffness times
//! square of these six numbers, and the torque by rate is minus its derivative (OpenSim's `BushingForce`, Simbody's `LinearBushing`).
//! In the first frame the angular velocity is x a' + R_x y b' + R_x R_y z c', which turns moments by angle into a couple.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::kinematics::Kinematics;
use crate::model::{Model, Motion, Placement};

/// Tissue that resists turning about one axis of a bushing in its positive sense, with the torque `-torque exp(rate (x - angle))` at the angle `x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The angle that stretches it: 0 about x, 1 about y, 2 about z.
    pub axis: usize,
    /// Size of the torque at `angle`, N m.
    pub torque: f64,
    /// Angle, rad.
    pub angle: f64,
    /// Rate of the exponential, 1/rad, positive.
    pub rate: f64,
}

impl Band {
    /// Size of the torque at an angle about its axis, rad: N m.
    fn at(&self, angle: f64) -> f64 {
        self.torque * libm::exp(self.rate * (angle - self.angle))
    }
}

/// A linear spring between two frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Bushing {
    /// Name of the bushing.
    pub name: String,
    /// Indices of the segments that carry its frames; `None` for ground.
    pub segments: [Option<usize>; 2],
    /// The frames, each in its segment's.
    pub frames: [Placement; 2],
    /// Against turning about x, y and z, N m/rad.
    pub rotational_stiffness: Vector3<f64>,
    /// Against moving along x, y and z of the first frame, N/m.
    pub translational_stiffness: Vector3<f64>,
    /// Bands beside it.
    pub bands: Vec<Band>,
}

/// Placement of the second frame in the first one.
struct Deflection {
    angles: Vector3<f64>,
    offset: Vector3<f64>,
    /// Rotation of the first frame in ground, and origin of the second one there.
    axes: Matrix3<f64>,
    at: Vector3<f64>,
}

impl Bushing {
    fn deflection(&self, model: &Model, kinematics: &Kinematics) -> Deflection {
        let place = |i: usize| match self.segments[i] {
            Some(segment) => kinematics.placement(model, segment) * self.frames[i],
            None => self.frames[i],
        };
        let (first, second) = (place(0), place(1));
        let axes = first.rotation.to_rotation_matrix().into_inner();
        let turned = axes.transpose() * second.rotation.to_rotation_matrix().into_inner();
        // R = R_x(a) R_y(b) R_z(c).
        let angles = Vector3::new(
            libm::atan2(-turned[(1, 2)], turned[(2, 2)]),
            libm::asin(turned[(0, 2)].clamp(-1.0, 1.0)),
            libm::atan2(-turned[(0, 1)], turned[(0, 0)]),
        );
        let at = second.translation.vector;
        Deflection { angles, offset: axes.transpose() * (at - first.translation.vector), axes, at }
    }

    /// Energy of the bushing, J.
    pub fn energy(&self, model: &Model, kinematics: &Kinematics) -> f64 {
        let Deflection { angles, offset, .. } = self.deflection(model, kinematics);
        let of_bands: f64 = self.bands.iter().map(|band| band.at(angles[band.axis]) / band.rate).sum();
        let of_springs = self.rotational_stiffness.dot(&angles.component_mul(&angles))
            + self.translational_stiffness.dot(&offset.component_mul(&offset));
        0.5 * of_springs + of_bands
    }

    /// Adds the torque of the bushing to `torque` by rate, as if no coordinates were coupled, N m (N for slides).
    fn add(&self, model: &Model, kinematics: &Kinematics, torque: &mut [f64]) {
        let Deflection { angles, offset, axes, at } = self.deflection(model, kinematics);
        let force = -(axes * self.translational_stiffness.component_mul(&offset));
        let mut by_angle = -self.rotational_stiffness.component_mul(&angles);
        self.bands.iter().for_each(|band| by_angle[band.axis] -= band.at(angles[band.axis]));
        let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), angles.x);
        let middle = about_x * Vector3::y();
        let last = about_x * (Rotation3::from_axis_angle(&Vector3::y_axis(), angles.y) * Vector3::z());
        // The rows are the axes of the three angles in the first frame: rows times couple are the moments by angle. Where the second
        // angle is a right one, the other two axes coincide, no couple is determined, and none is added.
        let couple = Matrix3::from_rows(&[Vector3::x().transpose(), middle.transpose(), last.transpose()])
            .try_inverse()
            .map_or_else(Vector3::zeros, |inverse| axes * (inverse * by_angle));
        for (segment, sign) in [(self.segments[1], 1.0), (self.segments[0], -1.0)] {
            let mut next = segment.and_then(|segment| model.segments[segment].mobility);
            while let Some(m) = next {
                let mobility = &model.mobilities[m];
                let moment = couple + (at - kinematics.origins[m]).cross(&force);
                for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                    let Some(rate) = model.elements[element] else { continue };
                    let along = if let Motion::Slide(_) = mobility.motion { &force } else { &moment };
                    torque[rate] += sign * kinematics.drives[element].0 * kinematics.axes[element].dot(along);
                }
                next = mobility.parent;
            }
        }
    }
}

/// Torque of bushings by rate, N m (N for slides), overwritten. Does not allocate.
///
/// # Panics
/// Unless there is room for every rate.
pub fn bushing_torque(bushings: &[Bushing], model: &Model, kinematics: &Kinematics, torque: &mut [f64]) {
    assert_eq!(torque.len(), model.rates().len(), "one torque a rate");
    torque.fill(0.0);
    bushings.iter().for_each(|bushing| bushing.add(model, kinematics, torque));
    kinematics.fold_columns(model, torque);
}
