//! Defines a support: a patch of a segment that rests on a plane.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Unit, UnitVector3, Vector3};

use crate::model::{LARGEST, Model, Motion};

/// Faces of the pyramid that stands for the cone of friction. Its edges lie on the cone, so every force it allows holds:
/// along each of two axes of the plane, square to each other, friction is at most `friction / sqrt(2)` times the normal force.
pub const FACES: usize = 4;

/// Smallest area of a patch that has a normal, m².
const LEAST_AREA: f64 = 1e-6;
/// The outer side of a patch that is nearer than this, m, to the segment's centre of mass is not known.
const THROUGH_THE_MIDDLE: f64 = 5e-3;

/// A patch of a segment that rests on a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// Index of the segment.
    pub segment: usize,
    /// Corners of the patch, segment frame, m. The centre of pressure stays within their convex hull.
    pub corners: Vec<Vector3<f64>>,
    /// The direction in which the plane pushes, ground axes, of unit length.
    pub normal: Vector3<f64>,
    /// Coefficient of friction, not negative; infinite for a patch that cannot slip.
    pub friction: f64,
    /// Greatest share of the whole weight, loads included, that the normal force should carry; 1 or more for no limit.
    pub share_max: f64,
    /// Whether the patch stays where it is at the start.
    pub place: Place,
}

/// Whether a patch stays where it is at the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// The support stays.
    Fixed,
    /// The support lies flat on the plane of its start, and may shift and turn on this plane.
    Free(Region),
}

/// The places that a free support may take on its plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Corners of a convex polygon in which the middle of the patch stays, ground, m; seen along the normal. Empty for no limit.
    pub corners: Vec<Vector3<f64>>,
    /// Least and greatest turn about the normal from the start, rad, within a quarter turn.
    pub turn: (f64, f64),
}

/// The reason for which a support was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SupportError {
    /// There is no such segment.
    #[error("support on segment number {segment}; the model has {count} segments")]
    Segment {
        /// The index given.
        segment: usize,
        /// Number of segments.
        count: usize,
    },
    /// The rests are not the last supports, in their order.
    #[error("rest of support number {support}; the rests are the last of the {count} supports, in their order")]
    Rest {
        /// The number given.
        support: usize,
        /// Number of supports.
        count: usize,
    },
    /// A number has no meaning.
    #[error("{what} of the support on `{segment}` is {value}; it must be {accepted}")]
    Number {
        /// Name of the segment.
        segment: String,
        /// The quantity with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// The values that would be accepted.
        accepted: &'static str,
    },
}

impl Support {
    /// Whether the support fits `model`.
    ///
    /// # Errors
    /// [`SupportError`] names the first thing that does not.
    pub fn check(&self, model: &Model) -> Result<(), SupportError> {
        let count = model.segments().len();
        let Some(segment) = model.segments().get(self.segment) else {
            return Err(SupportError::Segment { segment: self.segment, count });
        };
        let check = |ok: bool, what, value, accepted| {
            let segment = segment.name.clone();
            if ok { Ok(()) } else { Err(SupportError::Number { segment, what, value, accepted }) }
        };
        let corners = self.corners.len();
        check((1..=64).contains(&corners), "number of corners", corners as f64, "from 1 to 64")?;
        for &value in self.corners.iter().flatten() {
            check(value.abs() <= LARGEST, "a corner (m)", value, "finite and at most 1e9 in size")?;
        }
        let length = self.normal.norm();
        check((length - 1.0).abs() <= 1e-6, "length of the normal", length, "1")?;
        check(self.friction >= 0.0, "friction", self.friction, "not negative")?;
        check(self.share_max >= 0.0, "greatest share of weight", self.share_max, "not negative")?;
        let Place::Free(Region { corners, turn: (least, greatest) }) = &self.place else { return Ok(()) };
        for &value in corners.iter().flatten() {
            check(value.abs() <= LARGEST, "a corner of the region (m)", value, "finite and at most 1e9 in size")?;
        }
        check((-FRAC_PI_2..=0.0).contains(least), "least turn (rad)", *least, "from a quarter turn back to 0")?;
        check((0.0..=FRAC_PI_2).contains(greatest), "greatest turn (rad)", *greatest, "from 0 to a quarter turn")
    }

    /// The middle of the patch, segment frame, m.
    pub fn middle(&self) -> Vector3<f64> {
        self.corners.iter().sum::<Vector3<f64>>() / self.corners.len() as f64
    }

    /// Normal of the patch toward the body, segment frame: that of its largest triangle, on the side of the segment's centre of mass. `None` for a
    /// point or a line, and where the centre of mass is too near to tell.
    pub fn inward(&self, model: &Model) -> Option<UnitVector3<f64>> {
        let from_first = |corner: &Vector3<f64>| corner - self.corners[0];
        let triangles =
            self.corners.iter().flat_map(|a| self.corners.iter().map(move |b| from_first(a).cross(&from_first(b))));
        let normal = triangles.max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let normal = Unit::try_new(normal, LEAST_AREA)?;
        let depth = normal.dot(&(model.segments()[self.segment].center_of_mass - self.middle()));
        (depth.abs() > THROUGH_THE_MIDDLE).then(|| if depth < 0.0 { -normal } else { normal })
    }

    /// Normal, and two axes of the plane.
    pub(crate) fn axes(&self) -> [Vector3<f64>; 3] {
        let across = self.normal.cross(&Vector3::ith(self.normal.iamin(), 1.0)).normalize();
        [self.normal, across, self.normal.cross(&across)]
    }
}

/// By rate: it moves a support, or is the independent rate of a coupling whose dependent one does.
pub(crate) fn rates_that_move(model: &Model, supports: &[Support]) -> Vec<bool> {
    let mut moves = vec![false; model.rates().len()];
    for support in supports {
        let mut carrier = model.segments()[support.segment].mobility;
        while let Some(mobility) = carrier {
            model.rates_of(mobility).for_each(|rate| moves[rate] = true);
            carrier = model.mobilities[mobility].parent;
        }
    }
    let rate = |coordinate: usize| model.coordinates()[coordinate].rate;
    for coupling in model.couplings().iter().rev() {
        if let (Some(independent), Some(dependent)) = (rate(coupling.independent), rate(coupling.dependent)) {
            moves[independent] |= moves[dependent];
        }
    }
    moves
}

/// The rates at which the body as a whole moves against ground, moved by no muscle: those of joints to ground that slide along
/// two axes at least (or turn and slide freely) and have no muscle groups. Their torques must come from supports.
pub fn root_rates(model: &Model) -> Vec<usize> {
    let mut found = vec![];
    for segment in model.segments().iter().filter(|segment| segment.parent.is_none()) {
        let slides = segment.joint_kind.motions().iter().filter(|motion| matches!(motion, Motion::Slide(_))).count();
        if slides < 2 {
            continue;
        }
        let coordinates = segment.coordinates.clone();
        let loose = coordinates.clone().filter(|&i| model.coordinates()[i].groups.is_none() && !model.is_dependent(i));
        found.extend(loose.filter_map(|i| model.coordinates()[i].rate));
        let quaternions = coordinates.filter(|&i| model.coordinates()[i].rate.is_none()).count();
        if quaternions > 0 {
            // The ball's rates follow one another; they have no coordinate of their own.
            let before = model.coordinates()[..segment.coordinates.start].iter();
            let balls = before.filter(|c| c.rate.is_none()).count() / 4;
            let turning = (0..model.rates().len()).filter(|&i| model.rates()[i].coordinate.is_none());
            found.extend(turning.skip(3 * balls).take(3 * quaternions / 4));
        }
    }
    found.sort_unstable();
    found
}
