//! Refuses data of a model that are out of range, and says why.

use super::LARGEST;
use super::coordinate::CoordinateSpec;
use super::joint::{Drive, Motion};
use super::segment_spec::SegmentSpec;

/// The reason for which a model was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two things have one name.
    #[error("two {what}s are named `{name}`; names must be unique")]
    Duplicate {
        /// Segment or coordinate.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A parent does not come before its child.
    #[error("segment `{segment}` has parent `{parent}`, which is not among the segments before it")]
    Parent {
        /// The child.
        segment: String,
        /// The missing parent.
        parent: String,
    },
    /// A number has no meaning.
    #[error("{what} of `{name}` is {value}; it must be {accepted}")]
    Number {
        /// Segment, coordinate or model.
        name: String,
        /// The quantity with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// The values that would be accepted.
        accepted: &'static str,
    },
    /// Two coordinates cannot be coupled.
    #[error("`{dependent}` cannot follow `{independent}`: {problem}")]
    Coupling {
        /// The coordinate that should depend on the other one.
        dependent: String,
        /// The other one.
        independent: String,
        /// The reason.
        problem: &'static str,
    },
    /// The joint has another number of hinges and slides.
    #[error("joint `{joint}` has {given} coordinates; its kind needs {needed}, one for each hinge and slide")]
    Coordinates {
        /// The joint.
        joint: String,
        /// Number given.
        given: usize,
        /// Number needed.
        needed: usize,
    },
}

pub(super) fn check_segment(spec: &SegmentSpec, motions: &[Motion]) -> Result<(), ModelError> {
    let refuse = |what, value, accepted| Err(ModelError::Number { name: spec.name.clone(), what, value, accepted });
    if !(0.0..=LARGEST).contains(&spec.mass) {
        return refuse("mass (kg)", spec.mass, "between 0 and 1e9");
    }
    for (what, values) in [
        ("centre of mass (m)", spec.center_of_mass.as_slice()),
        ("inertia (kg m^2)", spec.inertia.as_slice()),
        ("joint's place in the parent (m)", spec.in_parent.translation.vector.as_slice()),
        ("joint's place in the segment (m)", spec.in_segment.translation.vector.as_slice()),
    ] {
        check_size(&spec.name, what, values)?;
    }
    let rotations = [&spec.in_parent, &spec.in_segment].map(|p| p.rotation.coords.norm());
    let axes = motions.iter().filter_map(|motion| match motion {
        Motion::Hinge(axis) | Motion::Slide(axis) => Some(axis.norm()),
        Motion::Ball => None,
    });
    let lengths = rotations.map(|length| ("length of a joint frame's quaternion", length));
    for (what, length) in lengths.into_iter().chain(axes.map(|length| ("length of a joint axis", length))) {
        if length.is_nan() || (length - 1.0).abs() > 1e-6 {
            return refuse(what, length, "1");
        }
    }
    Ok(())
}

pub(super) fn check_drive(joint: &str, drive: &Drive) -> Result<(), ModelError> {
    match drive {
        Drive::Coordinate(_) => Ok(()),
        Drive::Function(function, _) => check_size(joint, "number of a function of the joint", &function.numbers()),
        Drive::Fixed(value) => check_size(joint, "fixed angle or distance (rad or m)", &[*value]),
    }
}

pub(super) fn check_size(name: &str, what: &'static str, values: &[f64]) -> Result<(), ModelError> {
    match values.iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
        Some(&value) => {
            Err(ModelError::Number { name: name.to_owned(), what, value, accepted: "finite and at most 1e9 in size" })
        }
        None => Ok(()),
    }
}

pub(super) fn check_coordinate(spec: &CoordinateSpec) -> Result<(), ModelError> {
    let refuse = |what, value, accepted| Err(ModelError::Number { name: spec.name.clone(), what, value, accepted });
    let (min, max) = spec.range;
    if min.is_nan() || max.is_nan() || min > max {
        return refuse("lower limit of the range", min, "at or below the upper limit");
    }
    if !(min..=max).contains(&spec.default) {
        return refuse("default", spec.default, "inside the range");
    }
    check_size(&spec.name, "default", &[spec.default])
}
