//! Writes chains of motions as OpenSim's joints: three translations along axes of the parent's frame, then three rotations.

use contrapposto::math::Function;
use contrapposto::model::{Motion, Segment};
use nalgebra::{Unit, Vector3};

use super::steps::{By, steps};

/// The drive of one of the six axes.
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
    /// The piece's hinges are the angles of the ball with this first coordinate.
    pub(super) ball: Option<usize>,
    /// The joint is written from the segment to its parent: all of its motions in reverse.
    pub(super) turned: bool,
}

impl<'m> Driver<'m> {
    fn new(by: By<'m>) -> Self {
        match by {
            By::Coordinate(c) => Self::Linear(vec![(c, 1.0)], 0.0),
            By::Function(Function::Linear { slope, intercept }, c) => Self::Linear(vec![(c, *slope)], *intercept),
            By::Function(function, c) => Self::Function(function, c),
            By::Fixed(value) => Self::Constant(value),
        }
    }

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
        let parts = |driver: &Self| match driver {
            Self::Linear(terms, sum) => Some((terms.clone(), *sum)),
            Self::Constant(value) => Some((vec![], *value)),
            Self::Function(..) => None,
        };
        let (Some((mut terms, sum)), Some((more, by))) = (parts(self), parts(other)) else { return false };
        if more.iter().any(|(c, _)| terms.iter().any(|(own, _)| own == c)) {
            return false;
        }
        terms.extend(more);
        *self = if terms.is_empty() { Self::Constant(sum + by) } else { Self::Linear(terms, sum + by) };
        true
    }
}

/// Nearer to each other than this (sine of the angle) axes are one to OpenSim.
const APART: f64 = 1e-3;

fn apart(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() > APART
}

impl<'m> Piece<'m> {
    /// Takes in a motion; gives it back if it does not fit.
    fn add(&mut self, rotates: bool, axis: Axis<'m>) -> Option<Axis<'m>> {
        if self.ball.is_some() || (!rotates && !self.hinges.is_empty()) {
            return Some(axis);
        }
        let list = if rotates { &mut self.hinges } else { &mut self.slides };
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

    /// All axes.
    pub(super) fn axes(&self) -> impl Iterator<Item = &Axis<'m>> {
        self.slides.iter().chain(&self.hinges)
    }

    /// Coordinates of the piece, in the model's order.
    pub(super) fn coordinates(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.axes().flat_map(|axis| axis.driver.coordinates()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether OpenSim calls the coordinate rotational: it takes the kind from the last axis, rotations first, that the coordinate
    /// drives by a linear function whose first slope is 1.
    pub(super) fn in_degrees(&self, coordinate: usize) -> bool {
        let gives_kind = |axis: &Axis<'_>| match &axis.driver {
            Driver::Linear(terms, _) => {
                terms.first().is_some_and(|first| first.1 == 1.0) && terms.iter().any(|(c, _)| *c == coordinate)
            }
            _ => false,
        };
        !self.slides.iter().any(gives_kind) && self.hinges.iter().any(gives_kind)
    }
}

/// The joints that a segment's motions need, nearest the parent first; one without motions for a weld.
pub(super) fn pieces(segment: &Segment) -> Vec<Piece<'_>> {
    let steps = steps(segment);
    let straight = split(steps.iter().copied());
    if straight.len() > 1 && steps.iter().all(|(motion, _)| *motion != Motion::Ball) {
        let back = |motion| match motion {
            Motion::Hinge(axis) => Motion::Hinge(-axis),
            Motion::Slide(axis) => Motion::Slide(-axis),
            Motion::Ball => Motion::Ball,
        };
        let mut turned = split(steps.into_iter().rev().map(|(motion, by)| (back(motion), by)));
        if let [piece] = &mut turned[..] {
            piece.turned = true;
            return turned;
        }
    }
    straight
}

fn split<'m>(steps: impl Iterator<Item = (Motion, By<'m>)>) -> Vec<Piece<'m>> {
    let mut all = vec![];
    let mut piece = Piece::default();
    for (motion, by) in steps {
        let (rotates, direction) = match motion {
            Motion::Hinge(axis) => (true, axis),
            Motion::Slide(axis) => (false, axis),
            Motion::Ball => {
                if !piece.hinges.is_empty() {
                    all.push(std::mem::take(&mut piece));
                }
                let By::Coordinate(first) = by else { continue };
                let angles = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
                // The first three of the ball's four coordinates stand for the angles.
                let axis = |(c, direction)| Axis { direction, driver: Driver::new(By::Coordinate(c)) };
                piece.hinges = (first..).zip(angles).map(axis).collect();
                piece.ball = Some(first);
                continue;
            }
        };
        if let Some(axis) = piece.add(rotates, Axis { direction, driver: Driver::new(by) }) {
            all.push(std::mem::take(&mut piece));
            piece.add(rotates, axis);
        }
    }
    all.push(piece);
    all
}

/// An axis for a place among three that nothing uses, such that no two of them are one.
pub(super) fn filler(used: &[Vector3<f64>]) -> Vector3<f64> {
    let free = |axis: &Vector3<f64>| used.iter().all(|u| apart(u, axis));
    [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().find(free).unwrap_or(Vector3::x())
}
