//! Computes stiffness from a time constant and a damping ratio as MuJoCo does: from the inertia that the joint's coordinate feels
//! at the file's configuration when all others are free.

use super::built::{Built, Motion};
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::geom::point_inertia;
use super::item::Item;

use crate::model_ir::{ModelIr, PassiveLawIr};
use crate::xml::Place;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Mass, first moment and inertia about the world's origin.
#[derive(Clone, Copy, Default)]
struct Composite {
    mass: f64,
    moment: Vector3<f64>,
    inertia: Matrix3<f64>,
}

pub(super) fn apply(body: &mut ModelIr, built: &Built<'_>, root: Item<'_>) -> Result<(), MjcfError> {
    let Some(first) = built.pending.first() else { return Ok(()) };
    armature_elsewhere(root)?;
    let invalid = |place: &Place| MjcfError::Invalid {
        place: place.clone(),
        value: "springdamper".to_owned(),
        needs: MjcfRule::SpringdamperInertia,
    };
    let inverse = mass_matrix(body, built).cholesky().ok_or_else(|| invalid(&first.place))?.inverse();
    for pending in &built.pending {
        let inertia = 1.0 / inverse[(pending.freedom, pending.freedom)];
        let [time, ratio] = pending.wanted;
        let found = inertia / (time * time * ratio * ratio);
        if !found.is_finite() || found <= 0.0 {
            return Err(invalid(&pending.place));
        }
        match body.passive.get_mut(pending.spring).map(|p| &mut p.law) {
            Some(PassiveLawIr::Spring { stiffness, .. }) => *stiffness = found,
            Some(PassiveLawIr::Polynomial { coefficients, .. }) => coefficients[0] = found,
            _ => {}
        }
    }
    Ok(())
}

/// Tendons' and actuators' armature adds to joint inertia.
fn armature_elsewhere(root: Item<'_>) -> Result<(), MjcfError> {
    let mut waiting: Vec<Item<'_>> =
        root.children().into_iter().filter(|c| matches!(c.name(), "tendon" | "actuator" | "default")).collect();
    while let Some(item) = waiting.pop() {
        for child in item.children() {
            let own = child.name() != "joint" && child.attribute("armature").is_some_and(|a| a.trim() != "0");
            if own {
                return Err(Unsupported::SpringdamperArmature.at_attribute(child, "armature"));
            }
            waiting.push(child);
        }
    }
    Ok(())
}

/// The joint-space inertia at the file's configuration, from each subtree's inertia as one body.
fn mass_matrix(body: &ModelIr, built: &Built<'_>) -> DMatrix<f64> {
    let count = body.segments.len();
    let mut composites = vec![Composite::default(); count];
    for index in (0..count).rev() {
        let (segment, pose) = (&body.segments[index], &built.poses[index]);
        let center = (pose * nalgebra::Point3::from(segment.center_of_mass)).coords;
        let turn = pose.rotation.to_rotation_matrix();
        let own = turn * segment.inertia * turn.inverse() + point_inertia(segment.mass, center);
        let sum = &mut composites[index];
        sum.mass += segment.mass;
        sum.moment += center * segment.mass;
        sum.inertia += own;
        let sum = *sum;
        if let Some(parent) = segment.parent {
            let above = &mut composites[parent];
            above.mass += sum.mass;
            above.moment += sum.moment;
            above.inertia += sum.inertia;
        }
    }
    let n = built.freedoms.len();
    let mut matrix = DMatrix::zeros(n, n);
    for (i, freedom) in built.freedoms.iter().enumerate() {
        matrix[(i, i)] = freedom.armature;
        // Momentum of the subtree that this freedom moves at unit rate, and its moment about the origin.
        let moved = &composites[freedom.segment];
        let (linear, angular) = match freedom.motion {
            Motion::Slide(axis) => (axis * moved.mass, moved.moment.cross(&axis)),
            Motion::Turn(axis, point) => {
                let back = point.cross(&axis); // velocity of the point at the origin
                (axis.cross(&moved.moment) + back * moved.mass, moved.inertia * axis + moved.moment.cross(&back))
            }
        };
        for (j, other) in built.freedoms.iter().enumerate().take(i + 1) {
            if !above(body, other.segment, freedom.segment) {
                continue;
            }
            let value = match other.motion {
                Motion::Slide(axis) => axis.dot(&linear),
                Motion::Turn(axis, point) => axis.dot(&(angular - point.cross(&linear))),
            };
            matrix[(i, j)] += value;
            if i != j {
                matrix[(j, i)] += value;
            }
        }
    }
    matrix
}

/// Whether `segment` is `ancestor` or lies beyond it.
fn above(body: &ModelIr, ancestor: usize, segment: usize) -> bool {
    let chain = std::iter::successors(Some(segment), |&s| body.segments[s].parent);
    chain.take_while(|&s| s >= ancestor).any(|s| s == ancestor)
}
