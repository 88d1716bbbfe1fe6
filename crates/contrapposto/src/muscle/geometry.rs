//! Computes lengths and moment arms of paths in a posture.
//!
//! The moment arm is the torque about a coordinate for each newton of tension: by virtual work, the sum over the line's corners
//! of the forces of the straight parts on the segments that carry them, times the motion of the corner with the coordinate. By the
//! geodesic rule that is minus the derivative of the length (Sherman, Seth & Delp 2013 derive it; recalled).

use nalgebra::{Matrix3, Vector3};

use super::path::{Location, MovingPoint, Path, PathPoint, Paths};
use super::routing::{CornerOrigin, FrameInGround, Node, Routing, Scene};
use super::rule::PathRule;
use crate::kinematics::Kinematics;
use crate::model::{Model, Motion};

/// Lengths and moment arms. Depend on posture and rule; filled by [`PathGeometry::update`].
#[derive(Clone, Debug)]
pub struct PathGeometry {
    lengths: Vec<f64>,
    /// One row a path, one column a rate.
    moment_arms: Vec<f64>,
    rates: usize,
    /// Segments' frames in that of their mobility.
    offsets: Vec<FrameInGround>,
    segments: Vec<FrameInGround>,
    objects: Vec<FrameInGround>,
    geoms: Vec<FrameInGround>,
    /// By path: the mobilities that move some of its points and not all, outermost first.
    moving: Vec<Vec<usize>>,
    /// By path over several surfaces: all mobilities that move any of its points; empty for other paths. The forces of OpenSim's rule are
    /// not in balance there ([`super::routing::Node::reference`]), so that it has moment arms about joints that the path does not cross.
    carrying: Vec<Vec<usize>>,
    /// By path: the coordinates that change its length by themselves.
    driving: Vec<Vec<usize>>,
    /// Force and moment about ground's origin on each mobility, N for each newton of tension and m.
    wrenches: Vec<(Vector3<f64>, Vector3<f64>)>,
    routing: Routing,
    /// By path: its line.
    lines: Vec<Line>,
    /// The rule of the last update.
    rule: PathRule,
}

/// A corner of the line of a path in a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathCorner {
    /// Place of the corner in ground, m.
    pub place: Vector3<f64>,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// A point of the path, or where the line meets a surface.
    pub origin: CornerOrigin,
}

/// Force of a path on a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPull {
    /// Index of the segment; `None` for ground.
    pub segment: Option<usize>,
    /// Place at which it acts, in ground, m.
    pub place: Vector3<f64>,
    /// The force in ground axes, N for each newton of tension.
    pub force: Vector3<f64>,
}

/// The line of a path in a posture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Line {
    /// Corners of the line.
    pub(crate) nodes: Vec<Node>,
    /// Length on the surface, by wrap of the path, m.
    pub(crate) on_surface: Vec<f64>,
}

impl PathGeometry {
    /// Space for the paths of a model.
    pub fn new(model: &Model, paths: &Paths) -> Self {
        let frame =
            |pose: &crate::model::Placement| (pose.rotation.to_rotation_matrix().into_inner(), pose.translation.vector);
        let rates = model.rates().len();
        Self {
            lengths: vec![0.0; paths.paths.len()],
            moment_arms: vec![0.0; paths.paths.len() * rates],
            rates,
            offsets: model.segments.iter().map(|segment| frame(&segment.offset)).collect(),
            segments: model.segments.iter().map(|segment| frame(&segment.offset)).collect(),
            objects: paths.wrap_objects.iter().map(|object| frame(&object.pose)).collect(),
            geoms: paths.geoms.iter().map(|geom| frame(&geom.pose)).collect(),
            moving: (0..paths.paths.len()).map(|path| moving(model, paths, path, false)).collect(),
            carrying: (0..paths.paths.len())
                .map(|path| if paths.paths[path].wraps.len() > 1 { moving(model, paths, path, true) } else { vec![] })
                .collect(),
            driving: paths.paths.iter().map(|path| driving(path).collect()).collect(),
            wrenches: vec![(Vector3::zeros(), Vector3::zeros()); model.mobilities.len()],
            routing: Routing::new(paths),
            lines: paths.paths.iter().map(Line::new).collect(),
            rule: PathRule::default(),
        }
    }

    /// Lengths of all paths, m.
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Moment arms of one path: torque by rate for each newton of tension, m (N/N for slides). Those of dependent coordinates
    /// are folded into those of their independent ones.
    pub fn moment_arms(&self, path: usize) -> &[f64] {
        &self.moment_arms[path * self.rates..(path + 1) * self.rates]
    }

    /// The rates about which paths can turn a body: all that move some part of a path against another, or change its length by
    /// themselves, but for slides, locked coordinates and dependent coordinates, which count as their independent ones.
    pub fn crossed(&self, model: &Model) -> Vec<usize> {
        self.crossed_by(model, 0..self.lengths.len())
    }

    /// As [`PathGeometry::crossed`], for some of the paths, by index.
    pub fn crossed_by(&self, model: &Model, paths: impl Iterator<Item = usize> + Clone) -> Vec<usize> {
        let mut lead: Vec<Option<usize>> = (0..model.rates.len()).map(Some).collect();
        for coupling in &model.couplings {
            let [dependent, independent] =
                [coupling.dependent, coupling.independent].map(|coordinate| model.coordinates[coordinate].rate);
            if let Some(dependent) = dependent {
                lead[dependent] = independent.and_then(|independent| lead[independent]);
            }
        }
        let mut crossed = vec![false; model.rates.len()];
        let moving = paths.clone().flat_map(|path| &self.moving[path]);
        let moved = moving.flat_map(|&mobility| model.rates_of(mobility));
        let driving = paths.flat_map(|path| &self.driving[path]);
        let driven = driving.filter_map(|&coordinate| model.coordinates[coordinate].rate);
        for rate in moved.chain(driven) {
            lead[rate].into_iter().for_each(|rate| crossed[rate] = true);
        }
        let free = |rate: &usize| {
            let of = &model.rates[*rate];
            of.rotational && of.coordinate.is_none_or(|coordinate| !model.coordinates[coordinate].locked)
        };
        (0..crossed.len()).filter(|&rate| crossed[rate]).filter(free).collect()
    }

    /// Whether a coordinate changes the length of some path by itself: it moves a point in its segment, or is part of a tendon.
    pub fn drives(&self, coordinate: usize) -> bool {
        self.driving.iter().flatten().any(|driving| *driving == coordinate)
    }

    /// The corners of the line of a path, from its first point to its last one.
    pub fn corners(&self, path: usize) -> impl ExactSizeIterator<Item = PathCorner> {
        let corner = |node: &Node| PathCorner { place: node.place, segment: node.segment, origin: node.kind };
        self.lines[path].nodes.iter().map(corner)
    }

    /// Forces of a tension of 1 N along a path on the segments that carry its corners, in the posture of the last update. The two forces of
    /// a straight part within one segment, which cancel, are left out.
    pub fn pulls(&self, path: usize) -> impl Iterator<Item = PathPull> {
        let apart = pulls(&self.lines[path].nodes).filter(|(_, _, same)| !same);
        apart.map(|(node, force, _)| PathPull { segment: node.segment, place: node.place, force })
    }

    /// The line of a path.
    pub(crate) fn line(&self, path: usize) -> &Line {
        &self.lines[path]
    }

    /// The frames of segments in ground.
    pub(crate) fn segment_frame(&self, segment: usize) -> &FrameInGround {
        &self.segments[segment]
    }

    /// The frame of a surface in ground.
    pub(crate) fn object_frame(&self, object: usize) -> &FrameInGround {
        &self.objects[object]
    }

    /// The frame of a tendon's surface in ground.
    pub(super) fn geom_frame(&self, geom: usize) -> &FrameInGround {
        &self.geoms[geom]
    }

    /// The rule of the last update.
    pub(crate) fn rule(&self) -> PathRule {
        self.rule
    }

    /// Lays all paths anew. Does not allocate.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics, paths: &Paths, rule: PathRule) {
        self.place(model, kinematics, paths);
        self.rule = rule;
        self.moment_arms.fill(0.0);
        for (index, path) in paths.paths.iter().enumerate() {
            // MuJoCo's tendons have one rule.
            let rule = if path.tendon.is_some() { PathRule::Geodesic } else { rule };
            let scene =
                Scene { paths, values: kinematics.values(), segments: &self.segments, objects: &self.objects, rule };
            let arms = &mut self.moment_arms[index * self.rates..(index + 1) * self.rates];
            self.lengths[index] = match &path.tendon {
                None => self.routing.lay(scene, path),
                Some(tendon) => {
                    let drives = tendon.coordinates.iter();
                    let rate = |coordinate: usize| model.coordinates[coordinate].rate;
                    drives.filter_map(|&(c, by)| Some((rate(c)?, by))).for_each(|(rate, by)| arms[rate] -= by);
                    self.routing.lay_tendon(scene, &self.geoms, path, tendon)
                }
            };
            self.lines[index].nodes.clone_from(&self.routing.nodes);
            self.lines[index].on_surface.clone_from(&self.routing.lengths);
            let mut tension = Tension { model, kinematics, points: &path.points, segments: &self.segments, rule, arms };
            let unbalanced = rule == PathRule::OpenSim && path.wraps.len() > 1;
            let moving = if unbalanced { &self.carrying[index] } else { &self.moving[index] };
            moving.iter().for_each(|&m| self.wrenches[m] = Default::default());
            tension.pull(&self.routing.nodes, moving, &mut self.wrenches);
            tension.turn(moving, &mut self.wrenches);
        }
        kinematics.fold_columns(model, &mut self.moment_arms);
    }

    /// Brings the frames of segments and surfaces to the posture.
    fn place(&mut self, model: &Model, kinematics: &Kinematics, paths: &Paths) {
        for ((segment, offset), frame) in model.segments.iter().zip(&self.offsets).zip(&mut self.segments) {
            if let Some(m) = segment.mobility {
                let rotation = &kinematics.rotations[m];
                *frame = (rotation * offset.0, rotation * offset.1 + kinematics.origins[m]);
            }
        }
        let objects = paths.wrap_objects.iter().map(|object| (object.segment, &object.pose));
        let geoms = paths.geoms.iter().map(|geom| (geom.segment, &geom.pose));
        for ((segment, pose), frame) in objects.chain(geoms).zip(self.objects.iter_mut().chain(&mut self.geoms)) {
            let own: Matrix3<f64> = pose.rotation.to_rotation_matrix().into_inner();
            let at = pose.translation.vector;
            *frame = segment.map_or((own, at), |s| {
                let (axes, origin) = &self.segments[s];
                (axes * own, axes * at + origin)
            });
        }
    }
}

impl Line {
    /// Space for the longest line of a path.
    fn new(path: &Path) -> Self {
        let (points, surfaces) = (path.points.len(), path.surfaces());
        Self { nodes: Vec::with_capacity(points + 2 * surfaces), on_surface: Vec::with_capacity(surfaces) }
    }
}

/// The coordinates that change a path's length by themselves: those of a tendon, and those that move points in their segments.
fn driving(path: &Path) -> impl Iterator<Item = usize> {
    let of_points = path.points.iter().filter_map(|point| match &point.location {
        Location::Moving(moving) => moving.coordinate,
        _ => None,
    });
    path.tendon.iter().flat_map(|tendon| &tendon.coordinates).map(|(coordinate, _)| *coordinate).chain(of_points)
}

/// The mobilities that move some of a path's points and not all, outermost first: those of other coordinates do not change it. `any`: also
/// those that move all of them.
fn moving(model: &Model, paths: &Paths, path: usize, any: bool) -> Vec<usize> {
    let path = &paths.paths[path];
    let of_wraps = path.wraps.iter().map(|wrap| paths.wrap_objects[wrap.object].segment);
    let parts = path.tendon.iter().flat_map(|tendon| &tendon.parts);
    let of_geoms = parts.filter_map(|part| Some(paths.geoms[part.around?.geom].segment));
    let carriers: Vec<_> = path.points.iter().map(|point| point.segment).chain(of_wraps).chain(of_geoms).collect();
    let mut counts = vec![0; model.mobilities.len()];
    for carrier in &carriers {
        let mut next = carrier.and_then(|segment| model.segments[segment].mobility);
        while let Some(m) = next {
            counts[m] += 1;
            next = model.mobilities[m].parent;
        }
    }
    (0..counts.len()).rev().filter(|&m| counts[m] > 0 && (any || counts[m] < carriers.len())).collect()
}

/// Forces of a tension of 1 N on the corners of a line, those of a straight part one after the other, and whether one segment carries both
/// ends of the part.
fn pulls(nodes: &[Node]) -> impl Iterator<Item = (&Node, Vector3<f64>, bool)> {
    nodes.windows(2).flat_map(|pair| {
        let [from, to] = [&pair[0], &pair[1]];
        let straight = to.reference - from.reference;
        let length = straight.norm();
        let pulls = !matches!(from.kind, CornerOrigin::On(_)) && from.weight != 0.0 && length != 0.0;
        let force = if pulls { straight * (from.weight / length) } else { Vector3::zeros() };
        let same = from.segment == to.segment;
        [(from, force, same), (to, -force, same)].into_iter().filter(move |_| pulls)
    })
}

/// A tension of 1 N along a line, and the row of moment arms that it fills.
struct Tension<'a> {
    model: &'a Model,
    kinematics: &'a Kinematics,
    points: &'a [PathPoint],
    segments: &'a [FrameInGround],
    rule: PathRule,
    arms: &'a mut [f64],
}

impl Tension<'_> {
    /// Adds the forces of all straight parts to the mobilities that carry their ends, and the work of points that move in their segment.
    fn pull(&mut self, nodes: &[Node], moving: &[usize], wrenches: &mut [(Vector3<f64>, Vector3<f64>)]) {
        for (node, force, same) in pulls(nodes) {
            // OpenSim leaves out the work of points that move against another point of the same segment.
            if same && self.rule == PathRule::OpenSim {
                continue;
            }
            self.slide(node, &force);
            let mobility = node.segment.and_then(|segment| self.model.segments[segment].mobility);
            if let Some(m) = mobility.filter(|m| !same && moving.contains(m)) {
                wrenches[m].0 += force;
                wrenches[m].1 += node.place.cross(&force);
            }
        }
    }

    /// The work of a force on a point that moves in its segment.
    fn slide(&mut self, node: &Node, force: &Vector3<f64>) {
        let CornerOrigin::Point(index) = node.kind else { return };
        let Location::Moving(point) = &self.points[index].location else { return };
        let MovingPoint { coordinate: Some(coordinate), .. } = **point else { return };
        let Some(rate) = self.model.coordinates[coordinate].rate else { return };
        let values = self.kinematics.values();
        let slope = match self.rule {
            PathRule::Geodesic if point.stays(values) => return,
            PathRule::Geodesic => point.place_and_slope(values).1,
            PathRule::OpenSim => point.slope_beyond_range(values),
        };
        let slope = node.segment.map_or(slope, |s| self.segments[s].0 * slope);
        self.arms[rate] += force.dot(&slope);
    }

    /// Torques of the forces about all axes, from the outermost mobility inward.
    fn turn(&mut self, moving: &[usize], wrenches: &mut [(Vector3<f64>, Vector3<f64>)]) {
        for &m in moving {
            let mobility = &self.model.mobilities[m];
            let (force, moment) = wrenches[m];
            let about = moment - self.kinematics.origins[m].cross(&force);
            for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                let axis = &self.kinematics.axes[element];
                let torque = if let Motion::Slide(_) = mobility.motion { axis.dot(&force) } else { axis.dot(&about) };
                if let Some(rate) = self.model.elements[element] {
                    self.arms[rate] += self.kinematics.drives[element].0 * torque;
                }
            }
            if let Some(parent) = mobility.parent {
                wrenches[parent].0 += force;
                wrenches[parent].1 += moment;
            }
        }
    }
}
