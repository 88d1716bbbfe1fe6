//! Writes a body in motion for programs that draw: glTF for viewers and modellers, of rigid segments ([`glb`]) or with a skin
//! ([`skinned_glb`]), BVH for animation programs ([`bvh`]).
//!
//! All stand upright with y up, look along z and have their left at x, as those programs expect. In all a segment is a node
//! at the centre of its joint: the origin of the joint's moved frame, the point about which the segment turns.

mod buffer;
mod bvh;
mod course;
mod euler;
mod glb;
mod hull;
mod scenery;
mod skin;
mod skinned;
mod solid;
mod thickness;
mod track;
mod tubes;

pub use bvh::bvh;
pub(crate) use euler::zyx;
pub use glb::{glb, glb_with_tubes};
pub use hull::Solid;
pub use scenery::Arrow;
pub use skin::{Bone, Skeleton, Skin};
pub use skinned::skinned_glb;
pub use solid::{joined_by, solids};
pub use tubes::Tube;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Placement};
use contrapposto::posture::{Posture, PostureError};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::Thing;

/// Right, ahead and up in ground: up is against gravity (y without any), ahead the ground's x axis, or z where x is upright.
pub fn directions(model: &Model) -> [Vector3<f64>; 3] {
    let up = (-model.gravity()).try_normalize(0.0).unwrap_or_else(Vector3::y);
    let x = if up.x.abs() > 0.9 { Vector3::z() } else { Vector3::x() };
    let ahead = (x - up * up.dot(&x)).normalize();
    [ahead.cross(&up), ahead, up]
}

/// A motion to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Clip<'a> {
    /// The body.
    pub model: &'a Model,
    /// Name of the motion.
    pub title: &'a str,
    /// Left, up and ahead: unit vectors in ground axes, at right angles, right-handed in this order.
    pub directions: [Vector3<f64>; 3],
    /// Times, s, rising. The first one becomes time 0 of the file.
    pub times: &'a [f64],
    /// A posture for every time: values in the model's order, rad and m.
    pub postures: &'a [&'a [f64]],
    /// Whether the body stands in each posture until the next one, and in the last one for 1 s, instead of moving between them. BVH, which
    /// knows frames only, has one for each posture.
    pub steps: bool,
    /// Things around the body and in its hands; for glTF.
    pub things: &'a [Thing],
    /// Forces, with a point and an arrow for every posture; for glTF.
    pub arrows: &'a [Arrow],
}

/// The reason for which a motion was not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// Nothing to write.
    #[error("a motion needs a posture, and a body a segment")]
    Empty,
    /// Times and postures are not equally many.
    #[error("{times} times and {postures} postures: there must be one posture for every time")]
    Ragged {
        /// Times given.
        times: usize,
        /// Postures given.
        postures: usize,
    },
    /// A time is not after the one before it, or the format asks for even steps.
    #[error("time {time} s of posture {index} {problem}")]
    Time {
        /// The posture, counted from 0.
        index: usize,
        /// Time of the posture, s.
        time: f64,
        /// The reason.
        problem: &'static str,
    },
    /// The directions are no axes.
    #[error("left, up and ahead must be unit vectors at right angles, right-handed in this order")]
    Directions,
    /// A posture does not fit the model.
    #[error("posture {index}: {source}")]
    Posture {
        /// The posture, counted from 0.
        index: usize,
        /// The reason.
        source: PostureError,
    },
}

impl Clip<'_> {
    /// The rotation from ground to the file's axes.
    fn drawn(&self) -> Rotation3<f64> {
        Rotation3::from_matrix_unchecked(Matrix3::from_rows(&self.directions.map(|d| d.transpose())))
    }

    fn check(&self) -> Result<(), AnimationError> {
        let (times, postures) = (self.times.len(), self.postures.len());
        if times != postures {
            return Err(AnimationError::Ragged { times, postures });
        }
        if times == 0 || self.model.segments().is_empty() {
            return Err(AnimationError::Empty);
        }
        let rises = |i: usize| self.times[i].is_finite() && (i == 0 || self.times[i] > self.times[i - 1]);
        if let Some(index) = (0..times).find(|&i| !rises(i)) {
            let problem = "must be finite and after the one before it";
            return Err(AnimationError::Time { index, time: self.times[index], problem });
        }
        let drawn = self.drawn().into_inner();
        let off = (drawn * drawn.transpose() - Matrix3::identity()).norm();
        if off < 1e-9 && drawn.determinant() > 0.0 { Ok(()) } else { Err(AnimationError::Directions) }
    }

    /// Gives the index and the joint frames of every posture to `take`.
    fn play(&self, mut take: impl FnMut(usize, &[Placement])) -> Result<(), AnimationError> {
        self.check()?;
        let mut kinematics = Kinematics::new(self.model);
        for (index, values) in self.postures.iter().enumerate() {
            let posture = Posture::new(values.to_vec());
            kinematics.update(self.model, &posture).map_err(|source| AnimationError::Posture { index, source })?;
            take(index, &joint_frames(self.model, &kinematics));
        }
        Ok(())
    }
}

/// Of every segment the centre of its joint and the direction of its axes, in ground.
fn joint_frames(model: &Model, kinematics: &Kinematics) -> Vec<Placement> {
    let frame = |s: usize| {
        let center = kinematics.station(model, s, model.segments()[s].in_segment.translation.vector);
        Placement::from_parts(center.into(), kinematics.placement(model, s).rotation)
    };
    (0..model.segments().len()).map(frame).collect()
}
