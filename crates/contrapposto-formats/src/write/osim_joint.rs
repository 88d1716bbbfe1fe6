//! Chains of motions as OpenSim's joints: three translations along axes of the parent's frame, then three rotations.

use std::borrow::Cow;

use contrapposto::math::Function;
use contrapposto::model::{Drive, JointKind, Motion, Segment};
use nalgebra::{Unit, Vector3};

/// What drives one of the six axes.
pub(super) enum Driver<'m> {
    /// The sum of coordinates times slopes, plus a number.
    Linear(Vec<(usize, f64)>, f64),
    /// A function of one coordinate.
    Function(&'m Function, usize),
    /// Always the same.
    Constant(f64),
}

/// One axis.
pub(super) struct Axis<'m> {
    pub(super) direction: Unit<Vector3<f64>>,
    pub(super) driver: Driver<'m>,
}

/// One of OpenSim's joints.
#[derive(Default)]
pub(super) struct Piece<'m> {
    pub(super) slides: Vec<Axis<'m>>,
    pub(super) hinges: Vec<Axis<'m>>,
    /// Its hinges are the angles of a ball, and there is nothing else.
    pub(super) ball: bool,
}

/// A segment's motions with the coordinates they follow, by their index in the model.
pub(super) fn steps(segment: &Segment) -> Vec<(Motion, Cow<'_, Drive>)> {
    let first = segment.coordinates.start;
    if let JointKind::Driven(motions) = &segment.joint_kind {
        let counted = |drive: &'_ Drive| match drive {
            Drive::Coordinate(c) => Drive::Coordinate(first + c),
            Drive::Function(function, c) => Drive::Function(function.clone(), first + c),
            Drive::Fixed(value) => Drive::Fixed(*value),
        };
        return motions.iter().map(|(motion, drive)| (*motion, Cow::Owned(counted(drive)))).collect();
    }
    let mut next = first;
    let numbered = segment.joint_kind.motions().into_iter().map(|motion| {
        let own = next;
        next += motion.coordinates();
        (motion, Cow::Owned(Drive::Coordinate(own)))
    });
    numbered.collect()
}

impl<'m> Driver<'m> {
    /// Coordinates that move it.
    pub(super) fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Linear(terms, _) => terms.iter().map(|(c, _)| *c).collect(),
            Self::Function(_, c) => vec![*c],
            Self::Constant(_) => vec![],
        }
    }

    /// Takes in a further motion along the same axis, if both are linear.
    fn join(&mut self, other: &Self) -> bool {
        let (mut terms, mut sum) = match self {
            Self::Linear(terms, sum) => (terms.clone(), *sum),
            Self::Constant(value) => (vec![], *value),
            Self::Function(..) => return false,
        };
        match other {
            Self::Linear(more, by) => {
                if more.iter().any(|(c, _)| terms.iter().any(|(own, _)| own == c)) {
                    return false;
                }
                terms.extend(more);
                sum += by;
            }
            Self::Constant(by) => sum += by,
            Self::Function(..) => return false,
        }
        *self = if terms.is_empty() { Self::Constant(sum) } else { Self::Linear(terms, sum) };
        true
    }
}

/// Nearer to each other than this (sine of the angle) axes are one to OpenSim.
const APART: f64 = 1e-3;

fn apart(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() > APART
}

/// Puts an axis into the list if OpenSim can take it there.
fn place<'m>(list: &mut Vec<Axis<'m>>, axis: Axis<'m>) -> Option<Axis<'m>> {
    if let Some(last) = list.last_mut()
        && last.direction == axis.direction
        && last.driver.join(&axis.driver)
    {
        return None;
    }
    if list.len() == 3 || list.iter().any(|other| !apart(&other.direction, &axis.direction)) {
        return Some(axis);
    }
    list.push(axis);
    None
}

/// The joints that a segment's motions need, nearest the parent first; one without motions for a weld.
pub(super) fn pieces(segment: &Segment) -> Vec<Piece<'_>> {
    let first = segment.coordinates.start;
    let mut all = vec![Piece::default()];
    let mut add = |rotates: bool, axis: Axis<'_>| {
        let last = all.len() - 1;
        let piece: &mut Piece<'_> = &mut all[last];
        let refused = match rotates {
            true => place(&mut piece.hinges, axis),
            false if piece.hinges.is_empty() => place(&mut piece.slides, axis),
            false => Some(axis),
        };
        if let Some(axis) = refused {
            let mut next = Piece::default();
            if rotates { next.hinges.push(axis) } else { next.slides.push(axis) }
            all.push(next);
        }
    };
    let _ = (&mut add, first);
    todo!()
}
