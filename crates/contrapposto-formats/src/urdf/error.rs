//! Errors of URDF files.

use crate::numbers::NumberError;
use crate::xml::{Place, XmlError};

/// The reason for which a URDF file is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// Not acceptable XML.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// A number is none.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The outermost element is another one.
    #[error("{place}: a URDF file's outermost element is <robot>")]
    Root {
        /// Of the outermost element.
        place: Place,
    },
    /// An attribute is missing.
    #[error("{place}: the attribute is missing")]
    Missing {
        /// Of the element, with the attribute's name.
        place: Place,
    },
    /// A child element is missing.
    #[error("{place}: <{element}> is missing inside")]
    MissingElement {
        /// Of the element.
        place: Place,
        /// The missing part.
        element: &'static str,
    },
    /// A joint's type is unknown.
    #[error("{place}: `{value}` is no joint type; there are revolute, continuous, prismatic, fixed, floating, planar")]
    JointType {
        /// Of the attribute.
        place: Place,
        /// As written.
        value: String,
    },
    /// Two links or two joints have one name.
    #[error("{place}: a second <{tag}> is called `{value}`; names must differ", tag = place.tag)]
    DuplicateName {
        /// Of the second one.
        place: Place,
        /// The name.
        value: String,
    },
    /// A joint names a link that is not there.
    #[error("{place}: there is no link `{value}`{}", nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
    UnknownName {
        /// Of the attribute.
        place: Place,
        /// The name.
        value: String,
        /// The nearest name there is.
        nearest: Option<String>,
    },
    /// A rule of the format is broken.
    #[error("{place}: `{value}`: {needs}")]
    Invalid {
        /// Of the element or attribute.
        place: Place,
        /// As written, or the name of the part.
        value: String,
        /// The accepted alternative.
        needs: UrdfRule,
    },
    /// More coordinates than the cap.
    #[error("{place}: the model has more than {cap} coordinates")]
    TooManyCoordinates {
        /// Of the first joint too many.
        place: Place,
        /// The cap.
        cap: usize,
    },
}

/// Demands on parts of a URDF file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfRule {
    /// Mass.
    #[error("a mass is zero or more, kg")]
    MassNotNegative,
    /// Moments of inertia.
    #[error("a moment of inertia is zero or more, kg m2")]
    InertiaNotNegative,
    /// One inertial a link.
    #[error("a link has at most one <inertial>")]
    OneInertial,
    /// Axis length.
    #[error("an axis is longer than zero")]
    AxisLength,
    /// Limits in order.
    #[error("the lower limit is at most the upper one")]
    LimitOrder,
    /// Only one joint moves a link.
    #[error("a link is the child of at most one joint")]
    OneParent,
    /// No loops.
    #[error("links form a tree; this one is its own ancestor")]
    NoCycle,
    /// One root.
    #[error("exactly one link is no joint's child; this is a second one")]
    OneRoot,
    /// At least one link.
    #[error("a robot has at least one link")]
    SomeLink,
    /// Coupling to a joint with one coordinate.
    #[error("a joint mimics a revolute, continuous or prismatic joint and is one itself")]
    MimicKind,
    /// Numbers too large to calculate with.
    #[error("a number is beyond 1e30, too large to calculate with")]
    Overflow,
    /// Coupling in a circle.
    #[error("joints mimic each other in a circle")]
    MimicCircle,
}
