//! Chains the joints of one body: anchors that differ are joined by fixed slides.

use crate::model_ir::{Drive, MotionIr, SegmentIr};
use nalgebra::{Isometry3, Translation3, Vector3};

/// The joints of one body so far.
pub(super) struct Chain {
    /// The body's frame, moved to the first anchor.
    pub(super) pose: Isometry3<f64>,
    /// Anchor of the last turning joint, in the body's frame.
    pub(super) at: Vector3<f64>,
    pub(super) turned: bool,
}

impl Chain {
    /// Moves on to the anchor of a turning joint, by a fixed slide unless the joint is the first that turns.
    pub(super) fn go_to(&mut self, anchor: Vector3<f64>, segment: &mut SegmentIr) {
        let shift = anchor - self.at;
        if !self.turned {
            self.pose *= Translation3::from(shift);
            segment.in_parent = self.pose;
        } else if shift != Vector3::zeros() {
            let length = shift.norm();
            segment.motions.push(MotionIr::Slide { axis: shift / length, drive: Drive::Fixed(length) });
        }
        (self.at, self.turned) = (anchor, true);
    }
}
