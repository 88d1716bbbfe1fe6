//! A motion that is assessed, as figures show it: some hundred frames, and that of most effort.

use contrapposto::model::Model;
use contrapposto::simulation::Instant;

use super::film::Frame;
use crate::held::frame_of_instant;

/// Most frames besides the hardest and the last one.
const MOST: usize = 600;

/// Frames of a motion in the order of time.
pub(crate) struct Moments<'a> {
    model: &'a Model,
    every: usize,
    frames: Vec<Frame>,
    hardest: Option<Frame>,
    last: Option<Frame>,
}

impl<'a> Moments<'a> {
    /// Of a motion of `count` instants.
    pub(crate) fn new(model: &'a Model, count: usize) -> Self {
        Self { model, every: count.div_ceil(MOST).max(1), frames: vec![], hardest: None, last: None }
    }

    pub(crate) fn take(&mut self, instant: &Instant) {
        let frame = frame_of_instant(self.model, instant);
        if self.hardest.as_ref().is_none_or(|hardest| frame.effort() > hardest.effort()) {
            self.hardest = Some(frame.clone());
        }
        if instant.index.is_multiple_of(self.every) {
            self.frames.push(frame.clone());
        }
        self.last = Some(frame);
    }

    pub(super) fn frames(self) -> Vec<Frame> {
        let mut frames = self.frames;
        frames.extend(self.hardest.into_iter().chain(self.last));
        // Of several at one time the first; sorting keeps their order.
        frames.sort_by(|a, b| a.time.total_cmp(&b.time));
        frames.dedup_by(|b, a| a.time == b.time && a.posture == b.posture);
        frames
    }
}
