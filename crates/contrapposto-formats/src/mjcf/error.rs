//! Errors of MJCF files.

use super::item::Item;
use crate::model_ir::near;
use crate::numbers::NumberError;
use crate::xml::{Place, XmlError, shorten};
use contrapposto::muscle::MuscleError;

/// The reason for which an MJCF file is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MjcfError {
    /// Not acceptable XML.
    #[error("{}{error}", of_file(file))]
    Xml {
        /// Included file; empty for the main file.
        file: String,
        /// The kind.
        error: XmlError,
    },
    /// A number is none.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The outermost element is another one.
    #[error("{place}: an MJCF file's outermost element is <mujoco>")]
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
    /// An element that the format does not know at this place.
    #[error("{place}: unknown element{}", did_you_mean(nearest))]
    UnknownElement {
        /// Of the element.
        place: Place,
        /// The nearest that is known.
        nearest: Option<String>,
    },
    /// An attribute that the format does not know on this element.
    #[error("{place}: unknown attribute{}", did_you_mean(nearest))]
    UnknownAttribute {
        /// Of the attribute.
        place: Place,
        /// The nearest that is known.
        nearest: Option<String>,
    },
    /// A value that is none of the keywords.
    #[error("{place}: `{value}` is not accepted; there are {}", accepted.join(", "))]
    Keyword {
        /// Of the attribute.
        place: Place,
        /// As written.
        value: String,
        /// The keywords.
        accepted: &'static [&'static str],
    },
    /// One name twice.
    #[error("{place}: `{value}` is there already; names of one kind must differ")]
    DuplicateName {
        /// Of the second one.
        place: Place,
        /// The name.
        value: String,
    },
    /// A name that nothing has.
    #[error("{place}: there is no {kind} `{value}`{}", did_you_mean(nearest))]
    UnknownName {
        /// Of the attribute.
        place: Place,
        /// "class" or "hinge or slide joint".
        kind: &'static str,
        /// As written.
        value: String,
        /// The nearest there is.
        nearest: Option<String>,
    },
    /// An include that is not followed.
    #[error("{place}: `{value}`: {why}")]
    Include {
        /// Of the attribute with the file's name.
        place: Place,
        /// The file as named.
        value: String,
        /// The rule that the include breaks.
        why: IncludeRule,
    },
    /// Something that matters at rest and is not represented.
    #[error("{place}: `{value}`: {what}")]
    Unsupported {
        /// Of the element or attribute.
        place: Place,
        /// As written, or the element's name.
        value: String,
        /// The demand, and the accepted alternative.
        what: Unsupported,
    },
    /// A rule of the format is broken.
    #[error("{place}: `{value}`: {needs}")]
    Invalid {
        /// Of the element or attribute.
        place: Place,
        /// As written, or the name of the part.
        value: String,
        /// The accepted alternative.
        needs: MjcfRule,
    },
    /// Numbers of a muscle without a meaning.
    #[error("{place}: {why}")]
    Muscle {
        /// Of its element.
        place: Place,
        /// The number.
        why: MuscleError,
    },
    /// Bodies, frames, defaults inside each other beyond the cap, includes counted.
    #[error("{place}: lies more than {cap} elements deep")]
    TooDeep {
        /// Of the first element too deep.
        place: Place,
        /// The cap.
        cap: usize,
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

fn of_file(file: &str) -> String {
    if file.is_empty() { String::new() } else { format!("`{file}`: ") }
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}

impl MjcfError {
    pub(super) fn unknown_element(item: Item<'_>, known: &[&'static str]) -> Self {
        Self::UnknownElement { place: item.place(), nearest: near(item.name(), known.iter().copied()) }
    }

    pub(super) fn invalid(item: Item<'_>, attribute: &str, needs: MjcfRule) -> Self {
        let value = item.attribute(attribute).or(item.attribute("name")).unwrap_or_default();
        Self::Invalid { place: item.attribute_place(attribute), value: shorten(value.trim()), needs }
    }
}

/// The rule by which an include is not followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum IncludeRule {
    /// Empty or not a plain relative path.
    #[error("name a file by a relative path with `/`, without `:` or `\\`")]
    Plain,
    /// An absolute path.
    #[error("absolute paths are not followed; name a file inside the model's folder")]
    Absolute,
    /// A path that leads too far up.
    #[error(
        "a path leads at most two folders up (`../../`), and there to an .xml; name a file in or beside the model's folder"
    )]
    Outside,
    /// The same file again, or the main file.
    #[error("this file is part of the model already; a file is included once")]
    Repeated,
    /// The include has children.
    #[error("<include> has no elements inside")]
    Childless,
    /// The included file has nothing below its outermost element.
    #[error("the included file's outermost element has no elements inside")]
    Empty,
    /// Too many files.
    #[error("more than {cap} files are included")]
    TooMany {
        /// The cap.
        cap: usize,
    },
    /// Includes inside includes.
    #[error("includes lie more than {cap} files deep")]
    TooDeep {
        /// The cap.
        cap: usize,
    },
    /// The file cannot be had; the reason is the caller's.
    #[error("{reason}")]
    NotRead {
        /// As the caller said it.
        reason: String,
    },
}

/// Parts of a file that matter at rest and are not represented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unsupported {
    /// coordinate="global".
    #[error("global coordinates are not read; MuJoCo 2.3.3 or older converts the file to local ones")]
    GlobalCoordinates,
    /// alignfree, align.
    #[error("moving the frame of free bodies to their centre of mass is not supported; write false")]
    AlignFree,
    /// Wind in a fluid.
    #[error(
        "wind in a fluid presses on bodies at rest and is not supported; set wind, or density and viscosity, to zero"
    )]
    Wind,
    /// gravcomp.
    #[error("gravity compensation is not supported; write 0 or remove the body's mass")]
    GravityCompensation,
    /// Springs of ball and free joints.
    #[error("springs of ball and free joints are not supported; write stiffness=\"0\" or use hinges")]
    BallSpring,
    /// springyield.
    #[error("springs that yield are not supported; write springyield=\"0\"")]
    SpringYield,
    /// Springs of tendons.
    #[error("springs of tendons are not supported; write stiffness=\"0\"")]
    TendonSpring,
    /// Surfaces of tendons.
    #[error("a tendon passes round geoms of type sphere and cylinder, with sizes in the file")]
    TendonShape,
    /// Muscles on sites and the like.
    #[error("a muscle pulls on a tendon, hinge or slide; other transmissions are not supported")]
    MuscleTransmission,
    /// A muscle's gain without its bias.
    #[error("gaintype=\"muscle\" goes with biastype \"muscle\" or \"none\", and with no other")]
    HalfMuscle,
    /// Active and passive curves of different muscles.
    #[error("the first three numbers of gainprm and biasprm, and lmax, must be the same")]
    MuscleBias,
    /// forcerange.
    #[error("a muscle with a forcerange is not supported; write forcelimited=\"false\"")]
    MuscleForceRange,
    /// force.
    #[error("no force is given; MuJoCo takes it from scale and inertia as it compiles the model: write the force")]
    MuscleForce,
    /// lengthrange.
    #[error("no lengthrange is given; MuJoCo finds it as it compiles the model: write the one of the compiled model")]
    MuscleLengthRange,
    /// springdamper and armature that depends on tendons or actuators.
    #[error("springdamper takes its stiffness from an inertia that this armature changes; write stiffness instead")]
    SpringdamperArmature,
    /// Mass of a mesh.
    #[error(
        "this body's mass comes from a mesh, which is not read; give the body an <inertial>, or this geom mass=\"0\""
    )]
    MeshMass,
    /// shellinertia.
    #[error("mass on the surface of a geom is not supported; give the body an <inertial>")]
    ShellInertia,
    /// Equality constraints other than joint.
    #[error("only equality constraints between joints are supported; write active=\"false\" or remove it")]
    Equality,
    /// flex, composite and the like.
    #[error("deformable parts are not supported")]
    Deformable,
    /// replicate, attach.
    #[error("parts made from other parts are not read; MuJoCo writes the model without them when it saves it")]
    Generated,
    /// Scaled frames.
    #[error("scaled frames are not supported; MuJoCo writes the model without them when it saves it")]
    FrameScale,
    /// Plugins.
    #[error("plugins are not supported, as their forces are unknown")]
    Plugin,
}

impl Unsupported {
    pub(super) fn at(self, item: Item<'_>) -> MjcfError {
        let value = item.attribute("name").unwrap_or(item.name());
        MjcfError::Unsupported { place: item.place(), value: shorten(value), what: self }
    }

    pub(super) fn at_attribute(self, item: Item<'_>, attribute: &str) -> MjcfError {
        let value = item.attribute(attribute).or(item.attribute("name")).unwrap_or_default();
        MjcfError::Unsupported { place: item.attribute_place(attribute), value: shorten(value.trim()), what: self }
    }
}

/// Demands on parts of an MJCF file; the rules are MuJoCo's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MjcfRule {
    /// Orientation given once.
    #[error("one of quat, axisangle, xyaxes, zaxis, euler gives the orientation, not several")]
    OneOrientation,
    /// Orientation without direction.
    #[error("a direction or quaternion is longer than zero, and axes are not parallel")]
    Direction,
    /// eulerseq.
    #[error("three letters of x, y, z, X, Y, Z")]
    EulerSequence,
    /// Name of the outermost class.
    #[error("the outermost default class is called main")]
    MainClass,
    /// Number of outermost defaults.
    #[error("a model has at most 64 outermost <default> sections; write them as one")]
    DefaultSections,
    /// fromto and pos.
    #[error("either pos or fromto, not both")]
    PosOrFromto,
    /// fromto on shapes without length.
    #[error("fromto belongs to capsule, cylinder, box or ellipsoid")]
    FromtoShape,
    /// fromto of no length.
    #[error("the two points of fromto differ")]
    FromtoLength,
    /// Sizes.
    #[error("the sizes that the shape needs are positive")]
    Size,
    /// Geom mass.
    #[error("mass and density are zero or more")]
    MassNotNegative,
    /// Planes.
    #[error("planes and height fields do not move")]
    StaticShape,
    /// Whole numbers.
    #[error("a whole number")]
    Whole,
    /// Mass of moving bodies.
    #[error("a body that moves has mass and inertia, its own or of a body fixed to it")]
    MovingMass,
    /// Inertia and triangle inequality.
    #[error("each moment of inertia is at most the sum of the others; balanceinertia=\"true\" makes them equal")]
    Triangle,
    /// fullinertia.
    #[error("an inertia is positive definite")]
    PositiveDefinite,
    /// diaginertia.
    #[error("moments of inertia are zero or more")]
    InertiaNotNegative,
    /// fullinertia with something else.
    #[error("fullinertia stands without diaginertia and without an orientation")]
    FullInertiaAlone,
    /// Two of them.
    #[error("a body has at most one <inertial>")]
    OneInertial,
    /// World.
    #[error("the world has no joints, no inertia and no attributes")]
    World,
    /// Free joints.
    #[error("a free joint belongs to a body of the world and is its only joint")]
    FreeJoint,
    /// Freedoms.
    #[error("a body has at most six degrees of freedom")]
    Freedoms,
    /// Mocap.
    #[error("a mocap body is a child of the world without joints")]
    Mocap,
    /// Range.
    #[error("the first number of a range is smaller than the second, and zero for a ball joint")]
    Range,
    /// autolimits="false".
    #[error("with autolimits=\"false\", a range needs limited=\"true\" or \"false\"")]
    RangeWithoutLimited,
    /// Axis.
    #[error("an axis is longer than zero")]
    AxisLength,
    /// springdamper.
    #[error("both numbers of springdamper are positive")]
    Springdamper,
    /// springdamper without inertia.
    #[error("springdamper needs a body with inertia about every joint")]
    SpringdamperInertia,
    /// Elements of a spatial tendon.
    #[error("geoms and pulleys of a spatial tendon stand between two sites")]
    BetweenSites,
    /// Length of a tendon.
    #[error("a tendon has at least two sites, or a joint")]
    TwoSites,
    /// divisor.
    #[error("a divisor is from 1e-9 to 1e9")]
    Divisor,
    /// Places and factors of tendons.
    #[error("at most 1e9 in size")]
    TooFar,
    /// range and lengthrange.
    #[error("the first number of range and lengthrange is smaller than the second")]
    MuscleRange,
    /// Couplings.
    #[error(
        "a joint follows one other joint, by a polynomial of at most 32 powers, and no joints follow each other in a circle"
    )]
    Coupling,
    /// Options::root free.
    #[error("a root can be freed if the world has exactly one body and that has no joint, or a free one")]
    Root,
    /// Numbers too large to calculate with.
    #[error("a number is beyond 1e30, too large to calculate with")]
    Overflow,
}
