//! Lists the attributes and elements that MuJoCo 4.0 knows, so that a misspelt name is not taken for a default.

/// MuJoCo takes a smaller mass (kg) or moment of inertia (kg m^2) for none.
pub(crate) const LEAST_MASS: f64 = 1e-15;

/// Kinds of elements that take defaults and are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Tag {
    Joint,
    Geom,
    Site,
    Equality,
    Tendon,
    /// Every kind of actuator: they share their defaults.
    Actuator,
}

impl Tag {
    pub(super) fn of(name: &str) -> Option<Self> {
        match name {
            "joint" => Some(Self::Joint),
            "geom" => Some(Self::Geom),
            "site" => Some(Self::Site),
            "equality" => Some(Self::Equality),
            "tendon" => Some(Self::Tendon),
            _ if ACTUATORS.contains(&name) => Some(Self::Actuator),
            _ => None,
        }
    }

    /// The attributes that are accepted; `None` where they are not checked, for only some of them are read.
    pub(super) fn attributes(self) -> Option<&'static [&'static str]> {
        match self {
            Self::Joint => Some(JOINT),
            Self::Geom => Some(GEOM),
            Self::Site => Some(SITE),
            Self::Equality => Some(EQUALITY),
            Self::Tendon => Some(TENDON),
            Self::Actuator => None,
        }
    }
}

/// Kinds of actuators.
pub(super) const ACTUATORS: &[&str] = &[
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];

/// The five ways to give an orientation.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Sections that are counted only, and those that `read` treats itself.
pub(super) const SECTIONS: &[&str] = &[
    "compiler",
    "option",
    "size",
    "statistic",
    "visual",
    "default",
    "extension",
    "custom",
    "asset",
    "worldbody",
    "deformable",
    "contact",
    "tendon",
    "equality",
    "actuator",
    "sensor",
    "keyframe",
];

/// Elements in a body.
pub(super) const BODY_CHILDREN: &[&str] = &[
    "inertial",
    "joint",
    "freejoint",
    "geom",
    "site",
    "camera",
    "light",
    "body",
    "frame",
    "attach",
    "replicate",
    "composite",
    "flexcomp",
    "plugin",
];

/// Elements in a default besides those of [`Tag`].
pub(super) const DEFAULT_CHILDREN: &[&str] = &[
    "default",
    "mesh",
    "texture",
    "material",
    "joint",
    "geom",
    "site",
    "camera",
    "light",
    "pair",
    "equality",
    "tendon",
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "plugin",
    "skin",
    "flex",
];

/// `fitaabb`, `convexhull` and `exactmeshinertia` only concern meshes; older files still have the latter two.
pub(super) const COMPILER: &[&str] = &[
    "alignfree",
    "angle",
    "assetdir",
    "autolimits",
    "balanceinertia",
    "boundinertia",
    "boundmass",
    "conflict",
    "coordinate",
    "discardvisual",
    "eulerseq",
    "fitaabb",
    "fusestatic",
    "inertiafromgeom",
    "inertiagrouprange",
    "meshdir",
    "passthrough",
    "savecanonical",
    "savecompiled",
    "saveinertial",
    "settotalmass",
    "strippath",
    "texturedir",
    "usethread",
    "convexhull",
    "exactmeshinertia",
];

pub(super) const BODY: &[&str] = &[
    "name",
    "childclass",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "gravcomp",
    "mocap",
    "sleep",
    "simple",
    "fuse",
    "user",
];

pub(super) const FRAME: &[&str] =
    &["name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "scale", "scaling", "massscale"];

pub(super) const INERTIAL: &[&str] =
    &["pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mass", "diaginertia", "fullinertia"];

pub(super) const FREE_JOINT: &[&str] = &["name", "group", "align"];

const JOINT: &[&str] = &[
    "name",
    "class",
    "type",
    "group",
    "pos",
    "axis",
    "springdamper",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "stiffness",
    "range",
    "limited",
    "actuatorfrcrange",
    "actuatorfrclimited",
    "actuatorgravcomp",
    "margin",
    "ref",
    "springref",
    "springyield",
    "armature",
    "damping",
    "frictionloss",
    "user",
];

const GEOM: &[&str] = &[
    "name",
    "class",
    "type",
    "contype",
    "conaffinity",
    "condim",
    "group",
    "priority",
    "size",
    "material",
    "rgba",
    "castshadow",
    "friction",
    "mass",
    "density",
    "shellinertia",
    "solmix",
    "solref",
    "solimp",
    "margin",
    "gap",
    "fromto",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "hfield",
    "mesh",
    "fitscale",
    "fluidshape",
    "fluidcoef",
    "adhesion",
    "surfacevel",
    "user",
];

const SITE: &[&str] = &[
    "name",
    "class",
    "type",
    "group",
    "material",
    "rgba",
    "size",
    "fromto",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "mesh",
    "user",
];

const EQUALITY: &[&str] = &[
    "name",
    "class",
    "active",
    "solref",
    "solimp",
    "body1",
    "body2",
    "site1",
    "site2",
    "anchor",
    "relpose",
    "torquescale",
    "joint1",
    "joint2",
    "tendon1",
    "tendon2",
    "polycoef",
    "flex",
    "cell",
];

const TENDON: &[&str] = &[
    "name",
    "class",
    "group",
    "limited",
    "range",
    "actuatorfrclimited",
    "actuatorfrcrange",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "frictionloss",
    "margin",
    "springlength",
    "springyield",
    "stiffness",
    "damping",
    "armature",
    "width",
    "material",
    "rgba",
    "user",
];
