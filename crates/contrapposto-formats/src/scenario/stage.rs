//! Holds the body at the start, to which tasks refer.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;

use crate::toml_file::Located;

/// The body as it starts, to which tasks refer.
pub(super) struct Stage<'a> {
    pub(super) at: &'a Located<'a>,
    pub(super) model: &'a Model,
    pub(super) start: &'a Posture,
    pub(super) kinematics: &'a Kinematics,
    /// Segments that carry weight.
    pub(super) supports: &'a [usize],
}
