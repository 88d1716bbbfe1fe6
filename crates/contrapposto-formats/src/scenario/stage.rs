//! Holds the body at the start: the posture with its kinematics, and what tasks refer to.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;

use crate::input_error::InputError;
use crate::toml_file::Located;

/// The start, which supports may move before tasks refer to it.
pub(super) struct Start {
    pub(super) posture: Posture,
    pub(super) kinematics: Kinematics,
}

impl Start {
    /// The start in `posture`.
    pub(super) fn new(at: &Located, model: &Model, posture: Posture) -> Result<Self, InputError> {
        let mut start = Self { posture, kinematics: Kinematics::new(model) };
        start.update(at, model)?;
        Ok(start)
    }

    /// Moves by a step of rates.
    pub(super) fn displace(&mut self, at: &Located, model: &Model, step: &[f64]) -> Result<(), InputError> {
        self.posture.displace(model, step);
        self.update(at, model)
    }

    /// Kinematics of the posture.
    pub(super) fn update(&mut self, at: &Located, model: &Model) -> Result<(), InputError> {
        let updated = self.kinematics.update(model, &self.posture);
        updated.map_err(|error| at.error(&["posture"], error.to_string(), None))
    }
}

/// The body as it starts, to which tasks refer.
pub(super) struct Stage<'a> {
    pub(super) at: &'a Located<'a>,
    pub(super) model: &'a Model,
    pub(super) start: &'a Posture,
    pub(super) kinematics: &'a Kinematics,
    /// Segments that carry weight.
    pub(super) supports: &'a [usize],
    /// The same with their patches; empty where the patch of one is not known.
    pub(super) patches: &'a [Support],
}
