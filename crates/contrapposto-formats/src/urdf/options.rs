//! Options of the URDF reader.

use crate::model_ir::RootAttachment;
use crate::xml::Limits;

/// Options of the reader that the file does not give.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Attachment of the root link to the ground. `Free` adds `root_tx` ... `root_qz`.
    pub root: RootAttachment,
    /// Caps.
    pub limits: Limits,
}
