//! Options of the MJCF reader.

use crate::model_ir::RootAttachment;
use crate::xml::Limits;

/// Options of the reader that the file does not give.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Attachment of the outermost body to the ground; `None`: as the file says. `Free` adds `root_tx` ... `root_qz`.
    pub root: Option<RootAttachment>,
    /// Bodies whose mass comes from a mesh have none, and are counted: for questions in which mass has no part. Else they are refused.
    pub omit_mesh_mass: bool,
    /// Caps.
    pub limits: Limits,
}
