//! Reads a model file of any format: OpenSim, URDF or MJCF.

use std::path::Path;

use crate::mjcf::{self, MjcfError};
use crate::model_ir::{Imported, ModelIr, ModelIrError, RootAttachment};
use crate::osim::{self, OsimError};
use crate::urdf::{self, UrdfError};
use crate::xml::{self, Limits, XmlError};

/// Format of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelFormat {
    /// OpenSim's `.osim`.
    OpenSim,
    /// URDF.
    Urdf,
    /// MuJoCo's MJCF.
    Mjcf,
    /// None: the built-in adult.
    Adult,
}

impl ModelFormat {
    /// `OpenSim`, `URDF`, `MJCF`, `built-in adult`.
    pub fn word(self) -> &'static str {
        match self {
            Self::OpenSim => "OpenSim",
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Adult => "built-in adult",
        }
    }

    /// The format of a file: by the ending of its name (`.osim`, `.urdf`, `.mjcf`), else by its outermost element.
    ///
    /// # Errors
    /// [`ModelFileError::Xml`] and [`ModelFileError::Root`].
    pub fn of(name: &str, bytes: &[u8], limits: &Limits) -> Result<Self, ModelFileError> {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("osim") => return Ok(Self::OpenSim),
            Some("urdf") => return Ok(Self::Urdf),
            Some("mjcf") => return Ok(Self::Mjcf),
            _ => {}
        }
        match xml::parse(bytes, limits)?.root().name() {
            "OpenSimDocument" => Ok(Self::OpenSim),
            "robot" => Ok(Self::Urdf),
            // An MJCF file that is included elsewhere may begin otherwise; it is no model on its own.
            "mujoco" => Ok(Self::Mjcf),
            other => Err(ModelFileError::Root(other.to_owned())),
        }
    }
}

/// The reason for which a file is no model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// Not XML.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// The outermost element belongs to no known format.
    #[error("the outermost element is <{0}>; a model is <OpenSimDocument> (.osim), <robot> (.urdf) or <mujoco> (MJCF)")]
    Root(String),
    /// A root was given for a file that says itself how its root is attached.
    #[error("a root can be chosen for URDF and MJCF files only; {0}")]
    RootGiven(&'static str),
    /// An OpenSim file; the error names the file itself.
    #[error(transparent)]
    OpenSim(#[from] OsimError),
    /// A URDF file.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// An MJCF file.
    #[error(transparent)]
    Mjcf(#[from] MjcfError),
    /// The resolved body is no model.
    #[error(transparent)]
    ModelIr(#[from] ModelIrError),
}

/// Reads a model file named `name`. `root`: how the root of a URDF or MJCF model is attached; as the file says (URDF: fixed) for
/// `None`. `include` gives the bytes of a file that an MJCF file includes, by its name relative to the model's folder, which leads
/// at most two folders up, and there to an `.xml`.
///
/// # Errors
/// [`ModelFileError`] says what is wrong, with the place where the format's reader gives one.
pub fn read_model(
    name: &str,
    bytes: &[u8],
    root: Option<RootAttachment>,
    include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<(Imported, ModelFormat), ModelFileError> {
    read_model_with(name, bytes, (root, false), include)
}

/// Reads a model file; `omit_mesh_mass` as in [`mjcf::Options`].
pub(crate) fn read_model_with(
    name: &str,
    bytes: &[u8],
    (root, omit_mesh_mass): (Option<RootAttachment>, bool),
    include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<(Imported, ModelFormat), ModelFileError> {
    let limits = Limits::default();
    let format = ModelFormat::of(name, bytes, &limits)?;
    let own =
        |part: Option<&std::ffi::OsStr>| part.map_or_else(String::new, |part| part.to_string_lossy().into_owned());
    let body: ModelIr = match format {
        ModelFormat::OpenSim if root.is_some() => {
            return Err(ModelFileError::RootGiven("an OpenSim model's root is what its joint to ground says"));
        }
        ModelFormat::OpenSim => osim::read(bytes, name)?,
        ModelFormat::Urdf => {
            let options = urdf::Options { root: root.unwrap_or(RootAttachment::Fixed), limits };
            urdf::read(bytes, &own(Path::new(name).file_stem()), &options)?
        }
        ModelFormat::Mjcf | ModelFormat::Adult => {
            let options = mjcf::Options { root, omit_mesh_mass, limits };
            mjcf::read(bytes, &own(Path::new(name).file_name()), include, &options)?
        }
    };
    Ok((body.model()?, format))
}
