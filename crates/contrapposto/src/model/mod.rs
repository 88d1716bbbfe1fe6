//! Defines the body: an immutable tree of rigid segments, joined at coordinates with a range and two muscle groups.
//!
//! Ground axes of the built-in adult: x forward, y up, z right (ISB). Units: m, kg, rad, N m. A [`Model`] is built once
//! with a [`ModelBuilder`] and never changes; everything computed lives elsewhere.

mod adult;
mod adult_match;
mod adult_shapes;
mod adult_size;
mod builder;
mod coordinate;
mod coordinate_specs;
pub mod data;
mod error;
mod joint;
mod names;
mod reduced;
mod segment_spec;
mod shape;
mod shared;
mod three_axis;

pub use adult::{AdultError, AdultMeasure, CoordinateSources, adult};
pub use adult_size::{Adult, Part, Sex};
pub use builder::ModelBuilder;
pub use coordinate::{Coordinate, CoordinateKind, CoordinateSpec, MuscleGroup, Side};
pub use error::ModelError;
pub use joint::{Drive, JointKind, Motion};
pub use names::{movements_in_words, plain_group_name, plain_name};
pub(crate) use reduced::reduced;
pub use segment_spec::SegmentSpec;
pub use shape::{Capsule, Shape};
pub use shared::SharedModel;
pub use three_axis::{Orientation, ThreeAxisJoint};

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::fatigue::FatigueLaw;
use crate::math::Function;
use crate::passive::{PassiveCurve, PassiveLaw};

/// Largest size of any number of a model, posture or load, in SI units. Far beyond every body, and small enough that no
/// product of them overflows: what is accepted gives finite torques and gradients.
pub const LARGEST: f64 = 1e9;

/// Pose of one frame in another: rotation, then translation (m).
pub type Placement = Isometry3<f64>;

/// A rigid part of the body.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Unique name, e.g. `hand_r`.
    pub name: String,
    /// Index of the segment it is joined to; `None` for ground.
    pub parent: Option<usize>,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the segment's frame, m.
    pub center_of_mass: Vector3<f64>,
    /// Inertia about the centre of mass in the segment's axes, kg m^2 (statics does not need it; writers do).
    pub inertia: Matrix3<f64>,
    /// Name of the joint to the parent.
    pub joint: String,
    /// Kind of that joint.
    pub joint_kind: JointKind,
    /// The joint's coordinates, in [`Model::coordinates`].
    pub coordinates: std::ops::Range<usize>,
    /// The joint's resting frame in the parent's frame (in ground where there is no parent).
    pub in_parent: Placement,
    /// The joint's moved frame in this segment's frame.
    pub in_segment: Placement,
    /// Corners of the patch that can rest on something (sole, palm, seat), segment frame, m; empty where none is known.
    pub patch: Vec<Vector3<f64>>,
    /// The mobility that carries the segment; `None` when it is fixed to ground.
    pub(crate) mobility: Option<usize>,
    /// The segment's frame in the frame of that mobility (or in ground).
    pub(crate) offset: Placement,
}

/// One elementary motion: a hinge or slide axis, or a ball. Joints are chains of them, welded segments share one.
#[derive(Clone, Debug)]
pub(crate) struct Mobility {
    pub(crate) parent: Option<usize>,
    /// Resting frame in the parent mobility's frame.
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) translation: Vector3<f64>,
    pub(crate) motion: Motion,
    /// The ground-axis-like axis of a hinge, where it is one: which, and its sign.
    pub(crate) principal: Option<(usize, f64)>,
    /// The resting frame is turned against the parent's.
    pub(crate) turned: bool,
    /// Source of its value; for a ball the first of its four coordinates.
    pub(crate) drive: Drive,
    /// The three-axis joint whose three coordinates, not a quaternion, turn a ball.
    pub(crate) angles: Option<usize>,
    /// First elementary rate: one for a hinge or slide, three for a ball.
    pub(crate) rate: usize,
    /// Mass of the segments fixed to it, and mass times their centre in the mobility's frame.
    pub(crate) mass: f64,
    pub(crate) first_moment: Vector3<f64>,
}

/// One direction of motion, and so one torque: hinges and slides have one, balls three.
#[derive(Clone, Debug)]
pub struct Rate {
    /// The coordinate's name, or `{joint}_mx` and so on for a ball.
    pub name: String,
    /// Whether it turns (N m) or slides (N).
    pub rotational: bool,
    /// The coordinate it changes, for hinges and slides.
    pub coordinate: Option<usize>,
}

/// An immutable body.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) name: String,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) segments: Vec<Segment>,
    pub(crate) coordinates: Vec<Coordinate>,
    pub(crate) mobilities: Vec<Mobility>,
    pub(crate) rates: Vec<Rate>,
    /// For every elementary rate the rate that it belongs to; `None` for a fixed motion.
    pub(crate) elements: Vec<Option<usize>>,
    /// Coordinates that follow another one.
    pub(crate) couplings: Vec<Coupling>,
    /// First coordinate of every ball.
    pub(crate) balls: Vec<usize>,
    /// Elementary rates of the hinges and balls nearer the root, for every mobility, one list after the other.
    pub(crate) ancestors: Vec<usize>,
    /// Index at which the list of each mobility begins; one more at the end.
    pub(crate) ancestor_starts: Vec<usize>,
    /// Mass fixed in ground, and mass times position.
    pub(crate) fixed: (f64, Vector3<f64>),
    /// Joints of three hinges through one point.
    pub(crate) three_axis: Vec<ThreeAxisJoint>,
    /// The same body with a ball for each of them; `None` without such joints, and in that body itself.
    pub(crate) by_axes: Option<Box<Self>>,
    /// Shapes of its parts, and the pairs of them that may meet, by index.
    pub(crate) shapes: Vec<Shape>,
    pub(crate) meeting: Vec<(usize, usize)>,
    /// Some mobility is a ball: its axes turn with it.
    pub(crate) has_balls: bool,
    /// Every motion is a coordinate of its own and nothing is coupled: torques need no folding.
    pub(crate) direct: bool,
}

/// `dependent = function(independent)`, both coordinates by index.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// The coordinate that the function gives.
    pub dependent: usize,
    /// The argument of the function.
    pub independent: usize,
    /// The function.
    pub function: Function,
}

impl Model {
    /// Name of the body.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Acceleration of gravity in ground axes, m/s^2.
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// All segments, parents before children.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// All coordinates, in the order of [`crate::posture::Posture`] values.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// All rates, in the order of torques and gradients.
    pub fn rates(&self) -> &[Rate] {
        &self.rates
    }

    /// Index of the coordinate of that name.
    pub fn coordinate(&self, name: &str) -> Option<usize> {
        self.coordinates.iter().position(|c| c.name == name)
    }

    /// Index of the segment of that name.
    pub fn segment(&self, name: &str) -> Option<usize> {
        self.segments.iter().position(|s| s.name == name)
    }

    /// The same body with another passive curve at one coordinate.
    #[must_use]
    pub fn with_passive(mut self, coordinate: usize, curve: PassiveCurve) -> Self {
        self.coordinates[coordinate].passive = Some(PassiveLaw::Curve(curve));
        self
    }

    /// The same body with another passive law at one coordinate, or none. A joint with a sum of a file's terms on a coordinate is
    /// judged by its coordinates.
    #[must_use]
    pub fn with_passive_law(mut self, coordinate: usize, law: Option<PassiveLaw>) -> Self {
        let of_file = matches!(law, Some(PassiveLaw::Sum(_)));
        self.coordinates[coordinate].passive = law;
        if of_file && self.three_axis_joint_of(coordinate).is_some() {
            self.three_axis.retain(|joint| joint.place(coordinate).is_none());
            self.build_by_axes();
        }
        self
    }

    /// The same body with its three-axis joints found anew: for a body some of whose passive laws are no longer those of a file.
    #[must_use]
    pub fn with_three_axis_joints(mut self) -> Self {
        self.find_three_axis_joints();
        self
    }

    /// The same body with another word for the positive sense of one coordinate ([`Coordinate::positive`]).
    #[must_use]
    pub fn with_positive(mut self, coordinate: usize, word: &str) -> Self {
        word.clone_into(&mut self.coordinates[coordinate].positive);
        self
    }

    /// The same body with all joints judged by their coordinates: a robot with a motor at each hinge.
    #[must_use]
    pub fn by_coordinates(mut self) -> Self {
        self.three_axis.clear();
        self.build_by_axes();
        self
    }

    /// The same body without muscle groups, its joints judged as those of a body of which no strength is known.
    #[must_use]
    pub fn without_groups(mut self) -> Self {
        self.coordinates.iter_mut().for_each(|coordinate| coordinate.groups = None);
        self.find_three_axis_joints();
        self
    }

    /// The same body with other muscle groups, positive first, at one coordinate.
    #[must_use]
    pub fn with_groups(mut self, coordinate: usize, groups: [MuscleGroup; 2]) -> Self {
        self.coordinates[coordinate].groups = Some(groups);
        self
    }

    /// The same body with another range (rad or m) of one coordinate; its default moves to the nearest limit if it must. A
    /// passive curve keeps the range that it was made for.
    ///
    /// # Errors
    /// [`ModelError::Number`] unless both limits are at most [`LARGEST`] in size and the lower one lies at or below the upper.
    pub fn with_range(mut self, coordinate: usize, range: (f64, f64)) -> Result<Self, ModelError> {
        let found = &mut self.coordinates[coordinate];
        let refuse =
            |what, value, accepted| Err(ModelError::Number { name: found.name.clone(), what, value, accepted });
        for (what, limit) in [("lower limit of the range", range.0), ("upper limit of the range", range.1)] {
            if limit.is_nan() || limit.abs() > LARGEST {
                return refuse(what, limit, "finite and at most 1e9 in size");
            }
        }
        if range.0 > range.1 {
            return refuse("lower limit of the range", range.0, "at or below the upper limit");
        }
        found.range = range;
        found.default = found.default.max(range.0).min(range.1);
        Ok(self)
    }

    /// The same body with another contact patch of one segment (corners in its frame, m).
    #[must_use]
    pub fn with_patch(mut self, segment: usize, corners: Vec<Vector3<f64>>) -> Self {
        self.segments[segment].patch = corners;
        self
    }

    /// The same body with shapes of its parts, and the pairs of them that may meet.
    #[must_use]
    pub(crate) fn with_shapes(mut self, shapes: Vec<Shape>, meeting: Vec<(usize, usize)>) -> Self {
        (self.shapes, self.meeting) = (shapes, meeting);
        self
    }

    /// Shapes of its parts; empty where none are known.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// Pairs of shapes that may meet, by index in [`Model::shapes`].
    pub fn meeting_shapes(&self) -> &[(usize, usize)] {
        &self.meeting
    }

    /// The same body with another fatigue law in both groups of one coordinate, if it has groups.
    #[must_use]
    pub fn with_fatigue(mut self, coordinate: usize, law: &FatigueLaw) -> Self {
        for group in self.coordinates[coordinate].groups.iter_mut().flatten() {
            group.fatigue = law.clone();
        }
        self
    }

    /// Rates that move a mobility: none if it is fixed, three of a ball; its own where a coordinate follows another one.
    pub(crate) fn rates_of(&self, mobility: usize) -> impl Iterator<Item = usize> {
        let end = self.mobilities.get(mobility + 1).map_or(self.elements.len(), |next| next.rate);
        self.elements[self.mobilities[mobility].rate..end].iter().flatten().copied()
    }

    /// Couplings of dependent coordinates; the coupling of a coordinate stands before the couplings that depend on it.
    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// Whether the coordinate depends on another one.
    pub fn is_dependent(&self, coordinate: usize) -> bool {
        self.couplings.iter().any(|coupling| coupling.dependent == coordinate)
    }

    /// Whether the coordinate turns segments only by functions of it that are no straight lines: OpenSim's motion type "coupled", whose values its
    /// files have in radians even where angles are in degrees.
    pub fn turns_by_curves(&self, coordinate: usize) -> bool {
        let by_curve = |mobility: &Mobility| match (&mobility.motion, &mobility.drive) {
            (Motion::Slide(_), _) => None,
            (_, Drive::Coordinate(c)) => (*c == coordinate).then_some(false),
            (_, Drive::Function(function, c)) => {
                (*c == coordinate).then_some(!matches!(function, Function::Linear { .. }))
            }
            (_, Drive::Fixed(_)) => None,
        };
        let mut turns = self.mobilities.iter().filter_map(by_curve).peekable();
        turns.peek().is_some() && turns.all(|by_curve| by_curve)
    }

    /// Total mass, kg.
    pub fn mass(&self) -> f64 {
        self.segments.iter().map(|s| s.mass).sum()
    }
}
