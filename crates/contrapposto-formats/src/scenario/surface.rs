//! Computes how a patch lies on its surface: the distance of its middle and the angle between both.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use nalgebra::{Unit, UnitVector3, Vector3};

/// A support with the plane that it rests on.
pub(super) struct Resting {
    pub(super) support: Support,
    /// `normal . p` of the points `p` of the plane, m; `None` for a plane through the middle of the patch, wherever this is.
    pub(super) height: Option<f64>,
    /// The plane is the floor or a step on it.
    pub(super) on_floor: bool,
    /// Flesh that takes the shape of its surface: pelvis, trunk, thigh. Other patches are rigid.
    pub(super) soft: bool,
}

/// Something that a plane through a rigid patch contains or is square to, in the segment's frame.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    /// The patch is one point.
    Point,
    /// Direction of a patch whose corners lie on a line.
    Line(UnitVector3<f64>),
    /// Normal of a patch, toward the body.
    Flat(UnitVector3<f64>),
}

/// Position of a patch relative to its surface.
pub(super) struct Fit {
    /// Distance of the middle above the plane, m.
    pub(super) gap: f64,
    /// Angle between patch and plane, rad.
    pub(super) tilt: f64,
    pub(super) shape: Shape,
}

/// Patches smaller than this, m, or across their length (m), count as a point or a line.
const THIN: f64 = 1e-3;
/// The outer side of a patch that is nearer than this, m, to the segment's centre of mass is not known.
const THROUGH_THE_MIDDLE: f64 = 5e-3;

impl Resting {
    /// Middle of the patch, ground, m.
    pub(super) fn middle(&self, model: &Model, kinematics: &Kinematics) -> Vector3<f64> {
        kinematics.station(model, self.support.segment, self.support.middle())
    }

    /// Position of the patch relative to its surface in the posture of `kinematics`.
    pub(super) fn fit(&self, model: &Model, kinematics: &Kinematics) -> Fit {
        let (normal, segment) = (self.support.normal, self.support.segment);
        let gap = self.height.map_or(0.0, |height| normal.dot(&self.middle(model, kinematics)) - height);
        let turned = |direction: UnitVector3<f64>| {
            normal.dot(&kinematics.direction(model, segment, direction.into_inner())).clamp(-1.0, 1.0)
        };
        let (shape, tilt) = match self.shape() {
            Shape::Point => (Shape::Point, 0.0),
            Shape::Line(line) => (Shape::Line(line), libm::asin(turned(line)).abs()),
            Shape::Flat(inner) => {
                let center = model.segments()[segment].center_of_mass;
                let depth = inner.dot(&(center - self.support.middle()));
                // Toward the body where the side is known, else the nearer side.
                let side = if depth.abs() > THROUGH_THE_MIDDLE { depth } else { turned(inner) };
                let inner = if side < 0.0 { -inner } else { inner };
                (Shape::Flat(inner), libm::acos(turned(inner)))
            }
        };
        Fit { gap, tilt, shape }
    }

    /// Shape of the patch by the largest triangle on its first corner; of a plane, either side.
    fn shape(&self) -> Shape {
        let corners = &self.support.corners;
        let from_first = |corner: &Vector3<f64>| corner - corners[0];
        let longest = corners.iter().map(from_first).max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default();
        let across = corners.iter().map(|corner| longest.cross(&from_first(corner)));
        let across = across.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default();
        if longest.norm() < THIN {
            Shape::Point
        } else if across.norm() < THIN * longest.norm() {
            Shape::Line(Unit::new_normalize(longest))
        } else {
            Shape::Flat(Unit::new_normalize(across))
        }
    }

    /// Moves the corners of a soft patch along the normal onto the plane through its middle.
    pub(super) fn flatten(&mut self, model: &Model, kinematics: &Kinematics) {
        let (normal, middle) = (self.support.normal, self.support.middle());
        let rotation = kinematics.placement(model, self.support.segment).rotation;
        let normal = rotation.inverse() * normal;
        for corner in &mut self.support.corners {
            *corner -= normal * normal.dot(&(*corner - middle));
        }
    }
}
