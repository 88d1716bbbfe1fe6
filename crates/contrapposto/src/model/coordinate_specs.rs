//! Fills in the coordinates of a joint: their kinds, and the components of balls.

use super::coordinate::{CoordinateKind, CoordinateSpec};
use super::error::ModelError;
use super::joint::{Drive, JointKind, Motion};
use super::segment_spec::SegmentSpec;

/// The coordinates with their kinds, balls filled in.
pub(super) fn coordinate_specs(
    spec: &SegmentSpec,
    motions: &[Motion],
) -> Result<Vec<(CoordinateSpec, CoordinateKind)>, ModelError> {
    if let JointKind::Driven(motions) = &spec.kind {
        return driven_specs(spec, motions);
    }
    let mut given = spec.coordinates.iter().cloned();
    let axes = motions.iter().filter(|m| **m != Motion::Ball).count();
    let full = motions.iter().map(|m| m.coordinates()).sum::<usize>() == spec.coordinates.len();
    if spec.coordinates.len() != axes && !full {
        return Err(ModelError::Coordinates { joint: spec.joint.clone(), given: spec.coordinates.len(), needed: axes });
    }
    let mut all = vec![];
    for motion in motions {
        match motion {
            Motion::Hinge(_) => all.extend(given.next().map(|c| (c, CoordinateKind::Rotation))),
            Motion::Slide(_) => all.extend(given.next().map(|c| (c, CoordinateKind::Translation))),
            Motion::Ball if full => all.extend(quaternion(&spec.joint, given.by_ref().map(|c| c.default))),
            Motion::Ball => all.extend(quaternion(&spec.joint, [1.0, 0.0, 0.0, 0.0].into_iter())),
        }
    }
    Ok(all)
}

/// The components of a ball at these defaults.
fn quaternion(
    joint: &str,
    defaults: impl Iterator<Item = f64>,
) -> impl Iterator<Item = (CoordinateSpec, CoordinateKind)> {
    ["qw", "qx", "qy", "qz"].into_iter().zip(defaults).map(move |(axis, default)| {
        let mut component = CoordinateSpec::new(&format!("{joint}_{axis}"), (-1.0, 1.0));
        component.default = default;
        (component, CoordinateKind::Quaternion)
    })
}

/// The coordinates of a joint driven by functions: as many as were given, each of the kind that was given; those of a ball
/// are its components.
fn driven_specs(
    spec: &SegmentSpec,
    motions: &[(Motion, Drive)],
) -> Result<Vec<(CoordinateSpec, CoordinateKind)>, ModelError> {
    let given = spec.coordinates.len();
    let mut all: Vec<_> = spec.coordinates.iter().map(|c| (c.clone(), c.kind)).collect();
    for (motion, drive) in motions {
        let needed = match (motion, drive) {
            (_, Drive::Coordinate(c)) => c + motion.coordinates(),
            (Motion::Ball, _) => given + 1,
            (_, Drive::Function(_, c)) => c + 1,
            (_, Drive::Fixed(_)) => 0,
        };
        if needed > given {
            return Err(ModelError::Coordinates { joint: spec.joint.clone(), given, needed });
        }
        if let (Motion::Ball, Drive::Coordinate(c)) = (motion, drive) {
            let defaults: Vec<f64> = all[*c..].iter().map(|(component, _)| component.default).collect();
            all.splice(*c..c + 4, quaternion(&spec.joint, defaults.into_iter()));
        }
    }
    Ok(all)
}
