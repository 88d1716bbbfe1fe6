//! Computes torques, contact forces and loads of a posture that is held still.

use contrapposto::assessment::{AssessSettings, GroupAssessment, assess};
use contrapposto::contact::{Missing, Support};
use contrapposto::joint_torques::{GroupLoad, Hazard};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;

use super::frame::Frame;
use crate::fail::Fail;

/// A posture that is held still.
pub(crate) struct Held {
    /// Torques, loads and contact forces. Where the supports cannot hold the posture, those of a body whose root is held too.
    pub(crate) frame: Frame,
    /// The force and moment that the supports lack; `None` where they hold it, and without supports.
    pub(crate) missing: Option<Missing>,
    /// Groups at work.
    pub(crate) groups: Vec<GroupLoad>,
    /// Coordinates in hazard.
    pub(crate) hazards: Vec<Hazard>,
}

impl Held {
    /// The frame, where the supports hold the posture.
    pub(crate) fn known(self) -> Option<Frame> {
        self.missing.is_none().then_some(self.frame)
    }
}

/// Without supports the root is held as if by hand.
pub(crate) fn held(model: &Model, posture: &Posture, loads: &[Load], supports: &[Support]) -> Result<Held, Fail> {
    let settings = AssessSettings { supports: supports.to_vec(), ..AssessSettings::default() };
    let mut frame = None;
    let found = assess(
        model,
        &[(0.0, posture.clone())],
        |_, _, all| all.extend_from_slice(loads),
        &settings,
        |instant| frame = Some(Frame::of_instant(model, instant)),
    )
    .map_err(|error| Fail::job("posture", error))?;
    let frame = frame.ok_or_else(|| Fail::job("posture", "it has no torques"))?;
    let groups = found.groups.iter().filter(|group| group.peak_load.value > 0.0).map(|group| {
        let GroupAssessment { coordinate, side, peak_torque: torque, .. } = *group;
        GroupLoad { coordinate, side, torque, load: group.peak_load.value }
    });
    Ok(Held {
        frame,
        missing: found.missing.map(|(missing, _)| missing),
        groups: groups.collect(),
        hazards: found.hazards.clone(),
    })
}
