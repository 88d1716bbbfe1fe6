//! Computes the line of a path in a posture: its points, and where it touches its surfaces.

use nalgebra::{Matrix3, Vector3};

use super::path::{Location, Path, PathWrap, Paths};
use super::rule::PathRule;
use super::tolerances::{GEODESIC_AT_REST, GEODESIC_ROUNDS, OPENSIM_AT_REST, OPENSIM_ROUNDS, RANGE_SLACK};
use super::wrap::{Contact, WrapSettings, Wrapping};

/// Origin and axes of a frame in ground.
pub(crate) type FrameInGround = (Matrix3<f64>, Vector3<f64>);

/// A corner of a path's line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// Place of the corner in ground, m.
    pub(crate) place: Vector3<f64>,
    /// The place from which lengths and directions are taken. By OpenSim's rule that is the first place of this corner in the posture: OpenSim
    /// keeps a point's place in ground when surfaces move the point on their surface again.
    pub(super) reference: Vector3<f64>,
    /// The segment that carries it.
    pub(crate) segment: Option<usize>,
    /// Origin of the corner.
    pub(crate) kind: CornerOrigin,
    /// Factor of tension and length of the line behind it: below 1 behind a pulley, 0 between its branches.
    pub(crate) weight: f64,
}

/// Origin of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerOrigin {
    /// The path's point of this number.
    Point(usize),
    /// The line touches the surface of the path's wrap, or of the tendon's part, of this number.
    On(usize),
    /// The line leaves that surface.
    Off(usize),
}

/// Space for the line of one path; no memory from one posture to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Routing {
    /// The corners.
    pub(super) nodes: Vec<Node>,
    /// Length on the surface, by wrap of the path, or by part of the tendon, m.
    pub(super) lengths: Vec<f64>,
    /// The first places of both corners on the surface in the posture, by wrap of the path; for OpenSim's rule.
    first_references: Vec<[Option<Vector3<f64>>; 2]>,
    /// Order in which the wraps are applied.
    order: Vec<usize>,
    /// The corners of the round before.
    before: Vec<Vector3<f64>>,
}

/// Coordinates, frames and rule that a path's line depends on.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) paths: &'a Paths,
    /// Value of every coordinate.
    pub(super) values: &'a [f64],
    /// Every segment's frame.
    pub(super) segments: &'a [FrameInGround],
    /// Every wrap object's frame.
    pub(super) objects: &'a [FrameInGround],
    pub(super) rule: PathRule,
}

/// The result of one wrap in one round.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Found {
    Inside,
    Free,
    Touches,
}

impl Routing {
    /// Space for the largest of the paths.
    pub(super) fn new(paths: &Paths) -> Self {
        let wraps = paths.paths.iter().map(Path::surfaces).max().unwrap_or(0);
        let nodes = paths.paths.iter().map(|path| path.points.len() + 2 * path.surfaces()).max().unwrap_or(0);
        Self {
            nodes: Vec::with_capacity(nodes),
            lengths: Vec::with_capacity(wraps),
            first_references: Vec::with_capacity(wraps),
            order: Vec::with_capacity(wraps),
            before: Vec::with_capacity(nodes),
        }
    }

    /// Lays the path; returns its length, m.
    pub(super) fn lay(&mut self, scene: Scene<'_>, path: &Path) -> f64 {
        self.nodes.clear();
        for (index, point) in path.points.iter().enumerate() {
            let place = match &point.location {
                Location::Fixed(place) => *place,
                Location::Conditional { place, coordinate, range } => {
                    let value = scene.values[*coordinate];
                    if value < range.0 - RANGE_SLACK || value > range.1 + RANGE_SLACK {
                        continue;
                    }
                    *place
                }
                Location::Moving(point) => point.place_and_slope(scene.values).0,
            };
            let place = point.segment.map_or(place, |s| scene.segments[s].0 * place + scene.segments[s].1);
            self.nodes.push(Node {
                place,
                reference: place,
                segment: point.segment,
                kind: CornerOrigin::Point(index),
                weight: 1.0,
            });
        }
        self.lengths.clear();
        self.lengths.resize(path.wraps.len(), 0.0);
        self.first_references.clear();
        self.first_references.resize(path.wraps.len(), [None; 2]);
        if !path.wraps.is_empty() {
            self.wrap(scene, path);
        }
        self.length(scene.rule)
    }

    /// The straight parts and those on surfaces, m.
    fn length(&mut self, rule: PathRule) -> f64 {
        (0..self.nodes.len()).for_each(|at| self.set_reference(at, rule));
        let part = |pair: &[Node]| match pair[0].kind {
            CornerOrigin::On(wrap) => self.lengths[wrap],
            _ => (pair[1].reference - pair[0].reference).norm(),
        };
        self.nodes.windows(2).map(part).sum()
    }

    /// Fills in the place from which lengths are taken.
    fn set_reference(&mut self, at: usize, rule: PathRule) {
        let node = &mut self.nodes[at];
        let first = match (rule, node.kind) {
            (PathRule::OpenSim, CornerOrigin::On(wrap)) => Some(&mut self.first_references[wrap][0]),
            (PathRule::OpenSim, CornerOrigin::Off(wrap)) => Some(&mut self.first_references[wrap][1]),
            _ => None,
        };
        node.reference = first.map_or(node.place, |first| *first.get_or_insert(node.place));
    }

    /// Applies all wraps, round after round, until the line rests.
    fn wrap(&mut self, scene: Scene<'_>, path: &Path) {
        let count = path.wraps.len();
        self.order.clear();
        self.order.extend(0..count);
        let rounds = match scene.rule {
            _ if count < 2 => 1,
            PathRule::Geodesic => GEODESIC_ROUNDS,
            PathRule::OpenSim => OPENSIM_ROUNDS,
        };
        self.before.clear();
        let mut before = f64::INFINITY;
        for round in 0..rounds {
            let mut first_two = [Found::Free; 2];
            for i in 0..count {
                let Some(found) = self.apply(scene, path, self.order[i]) else { return };
                if let Some(slot) = first_two.get_mut(i) {
                    *slot = found;
                }
            }
            let length = self.length(scene.rule);
            let at_rest = match scene.rule {
                PathRule::Geodesic => self.has_come_to_rest(),
                PathRule::OpenSim => (length - before).abs() < OPENSIM_AT_REST,
            };
            if at_rest {
                break;
            }
            before = length;
            // With the second surface inside of the first one's way, OpenSim takes them in the other order.
            if round == 0 && count > 1 && first_two == [Found::Free, Found::Inside] {
                self.order.swap(0, 1);
                self.remove(0);
            }
        }
    }

    /// Whether no corner has moved since the last call by more than rounding. The length is at rest long before the corners are, because
    /// it is the least.
    fn has_come_to_rest(&mut self) -> bool {
        let places = self.nodes.iter().map(|node| node.place);
        let stays = |(place, before): (Vector3<f64>, &Vector3<f64>)| (place - before).amax() < GEODESIC_AT_REST;
        let at_rest = self.nodes.len() == self.before.len() && places.clone().zip(&self.before).all(stays);
        self.before.clear();
        self.before.extend(places);
        at_rest
    }

    /// Removes the corners of a wrap.
    fn remove(&mut self, wrap: usize) {
        self.nodes.retain(|node| node.kind != CornerOrigin::On(wrap) && node.kind != CornerOrigin::Off(wrap));
    }

    /// Wraps the part of the line that suits best over the surface of one wrap; `None` where no point of the wrap's range is there.
    fn apply(&mut self, scene: Scene<'_>, path: &Path, wrap: usize) -> Option<Found> {
        self.remove(wrap);
        let PathWrap { object: index, method, range } = &path.wraps[wrap];
        let object = &scene.paths.wrap_objects[*index];
        if !object.active {
            return Some(Found::Free);
        }
        let first = range.0.unwrap_or(0);
        let last = range.1.unwrap_or(path.points.len() - 1);
        let within = |node: &Node| matches!(node.kind, CornerOrigin::Point(p) if p >= first && p <= last);
        let start = self.nodes.iter().position(within)?;
        let end = self.nodes.iter().rposition(within)?;
        let (axes, origin) = &scene.objects[*index];
        let settings = WrapSettings { rule: scene.rule, method: *method, single: path.wraps.len() == 1 };
        let mut found = Found::Free;
        let mut best: Option<(usize, Contact, f64)> = None;
        for at in start..end {
            let (from, to) = (&self.nodes[at], &self.nodes[at + 1]);
            if matches!(from.kind, CornerOrigin::On(_)) {
                continue;
            }
            let local = |place: &Vector3<f64>| axes.tr_mul(&(place - origin));
            let (from, to) = (local(&from.place), local(&to.place));
            match object.wrap(&from, &to, settings) {
                Wrapping::Inside => found = Found::Inside,
                Wrapping::Free => found = Found::Free,
                Wrapping::WithoutLine => found = Found::Touches,
                Wrapping::Crosses(contact) => {
                    found = Found::Touches;
                    best = Some((at, contact, f64::NEG_INFINITY));
                    break;
                }
                Wrapping::Touches(contact) => {
                    found = Found::Touches;
                    self.set_reference(at, scene.rule);
                    self.set_reference(at + 1, scene.rule);
                    let longer = self.longer(at, &contact, (axes, origin));
                    if best.as_ref().is_none_or(|(_, _, least)| longer < *least) {
                        best = Some((at, contact, longer));
                    }
                }
            }
        }
        if let Some((at, contact, _)) = best {
            let node = |place: Vector3<f64>, kind| {
                let place = axes * place + origin;
                Node { place, reference: place, segment: object.segment, kind, weight: 1.0 }
            };
            self.lengths[wrap] = contact.length;
            self.nodes.insert(at + 1, node(contact.first, CornerOrigin::On(wrap)));
            self.nodes.insert(at + 2, node(contact.second, CornerOrigin::Off(wrap)));
        }
        Some(found)
    }

    /// By how much a contact makes the part of the line behind a corner longer, m.
    fn longer(&self, at: usize, contact: &Contact, (axes, origin): (&Matrix3<f64>, &Vector3<f64>)) -> f64 {
        let (from, to) = (self.nodes[at].reference, self.nodes[at + 1].reference);
        let [first, second] = [contact.first, contact.second].map(|place| axes * place + origin);
        (first - from).norm() + contact.length + (to - second).norm() - (to - from).norm()
    }
}
