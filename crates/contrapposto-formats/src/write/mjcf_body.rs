//! Groups segments to MuJoCo's bodies: segments that must be one body, and the joints of each body.

use contrapposto::model::{Model, Motion, Placement};
use nalgebra::{Matrix3, SymmetricEigen, Translation3, Unit, UnitQuaternion, Vector3};

use super::steps::{By, moved, steps};
use super::{WriteError, exact};
use crate::mjcf::LEAST_MASS;

/// Degrees of freedom of one body.
const MOST_FREEDOMS: usize = 6;

/// One link of a chain.
pub(super) enum Moves {
    /// A motion that stays as it is.
    Fixed(Placement),
    /// A motion with a coordinate; at `reference` the body stands as in the file.
    Joint { motion: Motion, coordinate: usize, reference: f64, segment: usize },
}

/// Segments that are one body.
pub(super) struct Group {
    /// The innermost one.
    pub(super) first: usize,
    /// The one whose body it is.
    pub(super) segment: usize,
    /// Segments without mass before that one.
    pub(super) merged: Vec<usize>,
    /// The segment moves, has no mass, and does not carry exactly one segment that could have its motions.
    pub(super) feather: bool,
    /// All motions, nearest the parent first.
    pub(super) moves: Vec<Moves>,
    in_parent: Placement,
    in_segment: Placement,
}

/// A joint in the frame of its body.
pub(super) struct Joint {
    pub(super) motion: Motion,
    pub(super) anchor: Vector3<f64>,
    pub(super) coordinate: usize,
    pub(super) reference: f64,
    /// The segment of the joint.
    pub(super) segment: usize,
}

/// The body that begins with this segment; `children` of each segment, the last one first.
pub(super) fn group(model: &Model, children: &[Vec<usize>], first: usize) -> Result<Group, WriteError> {
    let mut segment = first;
    let (mut merged, mut feather) = (vec![], false);
    let mut moves = motions(model, first)?;
    loop {
        let own = &model.segments()[segment];
        let moving = moves.iter().any(|m| matches!(m, Moves::Joint { .. }));
        if !moving || has_mass(model, children, segment) {
            break;
        }
        let [child] = children[segment][..] else {
            feather = true;
            break;
        };
        moves.push(Moves::Fixed(own.in_segment.inverse() * model.segments()[child].in_parent));
        moves.extend(motions(model, child)?);
        merged.push(segment);
        segment = child;
    }
    let freedoms = |m: &Moves| if let Moves::Joint { motion, .. } = m { motion.rates() } else { 0 };
    if moves.iter().map(freedoms).sum::<usize>() > MOST_FREEDOMS {
        let problem = "more than six motions before the next mass; MuJoCo's bodies have six at most";
        return Err(WriteError::Segment { segment: model.segments()[segment].name.clone(), problem });
    }
    let (in_parent, in_segment) = (model.segments()[first].in_parent, model.segments()[segment].in_segment);
    Ok(Group { first, segment, merged, feather, moves, in_parent, in_segment })
}

/// Whether MuJoCo finds mass in the segment or in segments welded to it.
fn has_mass(model: &Model, children: &[Vec<usize>], segment: usize) -> bool {
    let mut waiting = vec![segment];
    while let Some(at) = waiting.pop() {
        if model.segments()[at].mass >= LEAST_MASS {
            return true;
        }
        waiting.extend(children[at].iter().filter(|&&s| model.segments()[s].coordinates.is_empty()));
    }
    false
}

fn motions(model: &Model, index: usize) -> Result<Vec<Moves>, WriteError> {
    let segment = &model.segments()[index];
    let mut moves: Vec<Moves> = vec![];
    let mut before: Option<(Motion, f64)> = None;
    for (motion, by) in steps(segment) {
        match by {
            By::Function(..) => {
                let problem = "MJCF has no joint that a function drives";
                return Err(WriteError::Joint { joint: segment.joint.clone(), problem });
            }
            By::Fixed(value) => {
                moves.push(Moves::Fixed(moved(motion, value)));
                before = Some((motion, value));
                continue;
            }
            By::Coordinate(coordinate) => {
                // What is turned back first and then turned by a coordinate has a reference.
                let mut reference = 0.0;
                if let Some((_, value)) = before.filter(|(b, _)| *b == motion) {
                    moves.pop();
                    reference = -value;
                }
                // The file stands at the default: M(q) = M(default) M(q - default). A lock has its value elsewhere.
                let default = model.coordinates()[coordinate].default;
                let locked = model.coordinates()[coordinate].locked && !model.is_dependent(coordinate);
                if motion != Motion::Ball && default != reference && !locked {
                    moves.push(Moves::Fixed(moved(motion, default - reference)));
                    reference = default;
                }
                moves.push(Moves::Joint { motion, coordinate, reference, segment: index });
            }
        }
        before = None;
    }
    Ok(moves)
}

impl Group {
    /// Pose of the body in its parent, its joints, and the body's frame in the segment's: that of a ball, if there is one.
    ///
    /// `parent` takes from the parent segment's frame to its body's.
    pub(super) fn placed(&self, parent: &Placement) -> (Placement, Vec<Joint>, Placement) {
        let mut frame = Placement::identity();
        let mut after = self.in_segment.inverse();
        for step in self.moves.iter().rev() {
            match step {
                Moves::Fixed(placement) => after = placement * after,
                Moves::Joint { motion: Motion::Ball, .. } => {
                    frame = Placement::from_parts(Translation3::identity(), after.rotation.inverse());
                    break;
                }
                Moves::Joint { .. } => {}
            }
        }
        // From each joint's frame to the body's, without what moves.
        let mut after = self.in_segment.inverse() * frame;
        let mut joints = vec![];
        for step in self.moves.iter().rev() {
            match step {
                Moves::Fixed(placement) => after = placement * after,
                &Moves::Joint { motion, coordinate, reference, segment } => {
                    let own = after.inverse();
                    let turned = |axis: Unit<Vector3<f64>>| match own.rotation == UnitQuaternion::identity() {
                        true => axis,
                        false => own.rotation * axis,
                    };
                    let motion = match motion {
                        Motion::Hinge(axis) => Motion::Hinge(turned(axis)),
                        Motion::Slide(axis) => Motion::Slide(turned(axis)),
                        Motion::Ball => Motion::Ball,
                    };
                    joints.push(Joint { motion, anchor: own.translation.vector, coordinate, reference, segment });
                }
            }
        }
        joints.reverse();
        let wanted = parent * self.in_parent;
        let mut pose = wanted * after;
        let turning = joints.iter().find(|j| !matches!(j.motion, Motion::Slide(_)));
        if let Some(joint) = turning.filter(|_| self.in_segment.rotation == UnitQuaternion::identity()) {
            // So that the reader finds the joint's place with the same bits.
            let shift = pose.rotation * joint.anchor;
            for k in 0..3 {
                let target = wanted.translation.vector[k];
                let at = &mut pose.translation.vector[k];
                *at = exact::near(*at, |v| v + shift[k] == target);
            }
        }
        (pose, joints, frame)
    }
}

/// An inertia that MuJoCo accepts, and whether it had to be another one.
pub(super) fn solid(inertia: &Matrix3<f64>) -> (Matrix3<f64>, bool) {
    let size = inertia.amax();
    let moments = SymmetricEigen::try_new(*inertia / size.max(1e-300), 1e-15, 1000).map(|e| e.eigenvalues * size);
    let fits = moments.is_some_and(|m| {
        let largest = m.max();
        m.min() > LEAST_MASS && largest <= (m.sum() - largest) * (1.0 + 1e-9)
    });
    if fits {
        return (*inertia, false);
    }
    (ball_of_size(inertia), true)
}

/// The inertia of a ball in place of one that no solid body has.
pub(super) fn ball_of_size(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element((inertia.trace() / 3.0).abs().max(1e-6))
}
