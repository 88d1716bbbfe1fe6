//! Computes the second derivative of a path's length by coordinates, but for the part that belongs to the forces held: how the
//! forces along a line change.
//!
//! A straight part between two points changes its direction `u` by their velocity across it: `w_i . (1 - u u^T) w_j / l`. A line
//! from `a` over a surface to `b`, in the surface's frame, is a part of one plane and of a strip of neighbouring lines: with the normal
//! `n` and `e` across the line in the surface at its first and last touch, the lengths `l1`, `l2` of the straight ends, and
//! `(A B; C D)` the product of the matrices by which neighbouring lines spread over the whole of it,
//!
//! ```text
//! L_aa = n1 n1^T / l1 + e1 e1^T A / B      L_ab = -e1 e2^T / B      L_bb = n2 n2^T / l2 + e2 e2^T D / B
//! ```
//!
//! A straight part between two surfaces is cut in its middle by a free point, which is eliminated: the line is the shortest.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::{Model, Motion};
use crate::muscle::{CornerOrigin, Line, Location, Node, Path, PathGeometry, Paths, Spread};

type V = Vector3<f64>;

/// Shortest straight part that is counted, m: an end of a path on its surface has no direction.
const LEAST_STRAIGHT: f64 = 1e-9;

/// The independent rate of every rate, with first and second derivative of the one by the other.
#[derive(Clone, Debug)]
pub(super) struct Rates(Vec<(Option<usize>, f64, f64)>);

impl Rates {
    pub(super) fn new(model: &Model) -> Self {
        let mut rates = Self(vec![(None, 1.0, 0.0); model.rates.len()]);
        rates.0.iter_mut().enumerate().for_each(|(rate, independent)| independent.0 = Some(rate));
        for coupling in &model.couplings {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let Some(d) = rate(coupling.dependent) {
                rates.0[d].0 = rate(coupling.independent).and_then(|i| rates.0[i].0);
            }
        }
        rates
    }

    /// Brings the derivatives to the posture.
    pub(super) fn update(&mut self, model: &Model, kinematics: &Kinematics) {
        for (coupling, &(slope, curvature)) in model.couplings.iter().zip(&kinematics.couplings) {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) {
                let (_, first, second) = self.0[i];
                (self.0[d].1, self.0[d].2) = (slope * first, slope * second + curvature * first * first);
            }
        }
    }

    /// The independent rates that move any part of a path.
    pub(super) fn moving(&self, model: &Model, paths: &Paths, path: &Path) -> Vec<usize> {
        let mut found = vec![false; self.0.len()];
        let of_wraps = path.wraps.iter().map(|wrap| paths.wrap_objects[wrap.object].segment);
        for carrier in path.points.iter().map(|point| point.segment).chain(of_wraps) {
            let mut next = carrier.and_then(|segment| model.segments[segment].mobility);
            while let Some(m) = next {
                let elements = model.mobilities[m].rate..model.mobilities[m].rate + model.mobilities[m].motion.rates();
                for rate in model.elements[elements].iter().flatten() {
                    self.0[*rate].0.into_iter().for_each(|independent| found[independent] = true);
                }
                next = model.mobilities[m].parent;
            }
        }
        for point in &path.points {
            let rate = moving_coordinate(&point.location).and_then(|c| model.coordinates[c].rate);
            rate.and_then(|rate| self.0[rate].0).into_iter().for_each(|independent| found[independent] = true);
        }
        (0..found.len()).filter(|&rate| found[rate]).collect()
    }
}

fn moving_coordinate(location: &Location) -> Option<usize> {
    if let Location::Moving(point) = location { point.coordinate } else { None }
}

/// A force (N for each newton of tension) on a segment, at a point in ground: segment, point, force.
pub(super) type Pull = (usize, V, V);

/// The second derivatives of one path, and the forces on its corners. Filled by [`PathCurvature::update`].
#[derive(Clone, Debug)]
pub(super) struct PathCurvature {
    /// Place in the path's list of rates, by rate; `usize::MAX` for none.
    place: Vec<usize>,
    /// Number of the path's rates.
    count: usize,
    /// Square matrix of `width` rows: the path's rates, then two directions of every free point.
    block: Vec<f64>,
    width: usize,
    /// Velocities of the ends of a part and turning of its surface, by column.
    ends: [Vec<V>; 2],
    turning: Vec<V>,
    pulls: Vec<Pull>,
}

impl PathCurvature {
    /// Space for paths that at most `most` rates move.
    pub(super) fn new(model: &Model, paths: &Paths, most: usize) -> Self {
        let wraps = paths.paths.iter().map(|path| path.wraps.len()).max().unwrap_or(0);
        let nodes = paths.paths.iter().map(|path| path.points.len() + 2 * path.wraps.len()).max().unwrap_or(0);
        let width = most + 2 * wraps;
        Self {
            place: vec![usize::MAX; model.rates.len()],
            count: 0,
            block: Vec::with_capacity(width * width),
            width: 0,
            ends: [vec![V::zeros(); width], vec![V::zeros(); width]],
            turning: vec![V::zeros(); width],
            pulls: Vec::with_capacity(2 * nodes),
        }
    }

    /// The second derivative by two of the path's rates.
    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.block[row * self.width + column]
    }

    /// Forces of a tension of 1 N on segments.
    pub(super) fn pulls(&self) -> &[Pull] {
        &self.pulls
    }

    /// Computes second derivatives and forces for a line and the independent rates `moving` that move the line. Does not allocate.
    pub(super) fn update(&mut self, at: &Posed<'_>, line: &Line, moving: &[usize]) {
        self.place.fill(usize::MAX);
        moving.iter().enumerate().for_each(|(place, &rate)| self.place[rate] = place);
        self.count = moving.len();
        let on = |node: &Node| matches!(node.kind, CornerOrigin::On(_));
        let off = |node: &Node| matches!(node.kind, CornerOrigin::Off(_));
        let free = line.nodes.windows(2).filter(|pair| off(&pair[0]) && on(&pair[1])).count();
        self.width = self.count + 2 * free;
        self.block.clear();
        self.block.resize(self.width * self.width, 0.0);
        self.pulls.clear();
        let mut next_free = self.count;
        let mut start = End::Corner(0);
        for k in 0..line.nodes.len().saturating_sub(1) {
            match (line.nodes[k].kind, line.nodes[k + 1].kind) {
                (CornerOrigin::Point(_), CornerOrigin::Point(_)) => {
                    self.straight(at, [&line.nodes[k], &line.nodes[k + 1]])
                }
                (CornerOrigin::Point(_), CornerOrigin::On(_)) => start = End::Corner(k),
                (CornerOrigin::Off(wrap), CornerOrigin::Point(_)) => {
                    self.surface(at, line, wrap, k, [start, End::Corner(k + 1)]);
                }
                (CornerOrigin::Off(wrap), _) => {
                    let end = End::between(&line.nodes[k], &line.nodes[k + 1], next_free);
                    next_free += 2;
                    self.surface(at, line, wrap, k, [start, end]);
                    start = end;
                }
                _ => {}
            }
        }
        self.eliminate();
    }

    /// Adds a straight part between two corners.
    fn straight(&mut self, at: &Posed<'_>, [from, to]: [&Node; 2]) {
        let straight = to.place - from.place;
        let length = straight.norm();
        if length < LEAST_STRAIGHT {
            return;
        }
        let u = straight / length;
        for (side, node) in [(0, from), (1, to)] {
            self.ends[side].fill(V::zeros());
            self.corner(at, side, node);
        }
        for i in 0..self.count {
            let wi = self.ends[1][i] - self.ends[0][i];
            for j in 0..self.count {
                let wj = self.ends[1][j] - self.ends[0][j];
                self.block[i * self.width + j] += (wi.dot(&wj) - u.dot(&wi) * u.dot(&wj)) / length;
            }
        }
        self.pull(at, from, u);
        self.pull(at, to, -u);
    }

    /// Adds a line over the surface that it leaves at corner `off`.
    fn surface(&mut self, at: &Posed<'_>, line: &Line, wrap: usize, off: usize, ends: [End; 2]) {
        let index = at.path.wraps[wrap].object;
        let (object, (axes, origin)) = (&at.paths.wrap_objects[index], at.geometry.object_frame(index));
        let touches = [line.nodes[off - 1].place, line.nodes[off].place];
        let places = ends.map(|end| end.place(line));
        let parts = [touches[0] - places[0], places[1] - touches[1]];
        let lengths = parts.map(|part| part.norm());
        if lengths.iter().any(|length| *length < LEAST_STRAIGHT) {
            return;
        }
        let directions = [parts[0] / lengths[0], parts[1] / lengths[1]];
        let normals = touches.map(|place| axes * object.normal(&axes.tr_mul(&(place - origin))));
        self.turning.fill(V::zeros());
        self.turn(at, object.segment);
        for side in 0..2 {
            self.ends[side].fill(V::zeros());
            match ends[side] {
                End::Corner(node) => self.corner(at, side, &line.nodes[node]),
                End::Free { slot, across, .. } => self.ends[side][slot..slot + 2].copy_from_slice(&across),
            }
            self.carry(at, side, object.segment, places[side], -1.0);
        }
        let local = [touches[0] - origin, directions[0]].map(|v| axes.tr_mul(&v));
        self.strip(lengths, directions, normals, object.spread(&local[0], &local[1], line.on_surface[wrap]));
        for side in 0..2 {
            let force = if side == 0 { directions[0] } else { -directions[1] };
            self.pulls.extend(object.segment.map(|segment| (segment, places[side], -force)));
            if let End::Corner(node) = ends[side] {
                self.pull(at, &line.nodes[node], force);
            }
        }
    }

    /// Adds the second derivatives of a line over a surface, from the velocities of its ends against the surface and its turning.
    fn strip(&mut self, [l1, l2]: [f64; 2], [t1, t2]: [V; 2], normals: [V; 2], spread: Spread) {
        let [[m00, m01], [m10, m11]] = spread;
        let (a, d) = (m00 + l2 * m10, m10 * l1 + m11);
        let b = m00 * l1 + m01 + l2 * d;
        let [n1, n2] = normals;
        let [e1, e2] = [t1.cross(&n1), t2.cross(&n2)];
        let across = |w: &V, v: &V| [n1.dot(w), e1.dot(w), n2.dot(v), e2.dot(v)];
        for i in 0..self.width {
            let (wi, vi, turning) = (self.ends[0][i], self.ends[1][i], self.turning[i]);
            let of_i = across(&wi, &vi);
            for j in 0..self.width {
                let (wj, vj) = (self.ends[0][j], self.ends[1][j]);
                let of_j = across(&wj, &vj);
                let planes = of_i[0] * of_j[0] / l1 + of_i[2] * of_j[2] / l2;
                let strip = a * of_i[1] * of_j[1] - of_i[1] * of_j[3] - of_i[3] * of_j[1] + d * of_i[3] * of_j[3];
                let turned = |w: &V, v: &V| turning.cross(w).dot(&t1) - turning.cross(v).dot(&t2);
                let back = t1.dot(&self.turning[j].cross(&wi)) - t2.dot(&self.turning[j].cross(&vi));
                // Between conjugate points, which no shortest line has, the strip's share has no number.
                let strip = if b == 0.0 { 0.0 } else { strip / b };
                self.block[i * self.width + j] += planes + strip + turned(&wj, &vj) + back;
            }
        }
    }

    /// Eliminates the free points, from the last to the first.
    fn eliminate(&mut self) {
        let width = self.width;
        for p in (self.count..width).rev() {
            let pivot = self.block[p * width + p];
            for i in (0..p).filter(|_| pivot != 0.0) {
                let share = self.block[i * width + p] / pivot;
                for j in 0..p {
                    self.block[i * width + j] -= share * self.block[p * width + j];
                }
            }
        }
    }

    /// Adds a force on a corner, and the work of its change where the corner moves in its segment.
    fn pull(&mut self, at: &Posed<'_>, node: &Node, force: V) {
        self.pulls.extend(node.segment.map(|segment| (segment, node.place, force)));
        let Some(Slide { place, slope: [c1, c2], moves: [x1, x2] }) = self.slide(at, node) else { return };
        self.turning.fill(V::zeros());
        self.turn(at, node.segment);
        for i in 0..self.count {
            let mixed = force.dot(&self.turning[i].cross(&x1)) * c1;
            self.block[i * self.width + place] -= mixed;
            self.block[place * self.width + i] -= mixed;
        }
        self.block[place * self.width + place] -= force.dot(&(x2 * (c1 * c1) + x1 * c2));
    }

    /// Adds the velocity of a corner to one end.
    fn corner(&mut self, at: &Posed<'_>, side: usize, node: &Node) {
        self.carry(at, side, node.segment, node.place, 1.0);
        if let Some(Slide { place, slope, moves }) = self.slide(at, node) {
            self.ends[side][place] += moves[0] * slope[0];
        }
    }

    /// Motion of a corner in its segment; `None` for a fixed one.
    fn slide(&self, at: &Posed<'_>, node: &Node) -> Option<Slide> {
        let CornerOrigin::Point(index) = node.kind else { return None };
        let Location::Moving(point) = &at.path.points[index].location else { return None };
        let rate = at.model.coordinates[point.coordinate?].rate?;
        let (independent, first, second) = at.rates.0[rate];
        let place = self.place[independent?];
        let moves = point.slope_and_curvature(at.kinematics.values());
        let moves = moves.map(|by| node.segment.map_or(by, |s| at.geometry.segment_frame(s).0 * by));
        Some(Slide { place, slope: [first, second], moves })
    }

    /// Adds `sign` times the velocity of a point (ground) carried by a segment to one end.
    fn carry(&mut self, at: &Posed<'_>, side: usize, segment: Option<usize>, point: V, sign: f64) {
        let Self { ends, place, .. } = self;
        at.motions(segment, |m, element, rate, slope| {
            let (axis, origin) = (at.kinematics.axes[element], at.kinematics.origins[m]);
            let slides = matches!(at.model.mobilities[m].motion, Motion::Slide(_));
            let velocity = if slides { axis } else { axis.cross(&(point - origin)) };
            ends[side][place[rate]] += velocity * (sign * slope);
        });
    }

    /// Adds the turning of a segment.
    fn turn(&mut self, at: &Posed<'_>, segment: Option<usize>) {
        let Self { turning, place, .. } = self;
        at.motions(segment, |m, element, rate, slope| {
            if !matches!(at.model.mobilities[m].motion, Motion::Slide(_)) {
                turning[place[rate]] += at.kinematics.axes[element] * slope;
            }
        });
    }
}

/// A path in a posture.
pub(super) struct Posed<'a> {
    pub(super) model: &'a Model,
    pub(super) kinematics: &'a Kinematics,
    pub(super) paths: &'a Paths,
    pub(super) path: &'a Path,
    pub(super) geometry: &'a PathGeometry,
    pub(super) rates: &'a Rates,
}

impl Posed<'_> {
    /// Calls `visit` with every elementary motion that moves a segment: its mobility, itself, the independent rate that drives it, and its
    /// derivative by that rate.
    fn motions(&self, segment: Option<usize>, mut visit: impl FnMut(usize, usize, usize, f64)) {
        let mut next = segment.and_then(|segment| self.model.segments[segment].mobility);
        while let Some(m) = next {
            let mobility = &self.model.mobilities[m];
            for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                let Some(rate) = self.model.elements[element] else { continue };
                if let (Some(independent), first, _) = self.rates.0[rate] {
                    visit(m, element, independent, self.kinematics.drives[element].0 * first);
                }
            }
            next = mobility.parent;
        }
    }
}

/// A corner that moves in its segment with a coordinate.
struct Slide {
    /// Place of the coordinate's independent rate in the path's list.
    place: usize,
    /// First and second derivative of the coordinate by it.
    slope: [f64; 2],
    /// First and second derivative of the corner by the coordinate, in ground axes.
    moves: [V; 2],
}

/// An end of a line over a surface.
#[derive(Clone, Copy, Debug)]
enum End {
    /// A corner of the path, by number.
    Corner(usize),
    /// A free point between two surfaces: its place, two directions across the line, and the column of the first.
    Free { place: V, across: [V; 2], slot: usize },
}

impl End {
    fn between(off: &Node, on: &Node, slot: usize) -> Self {
        let straight = on.place - off.place;
        let least = straight.abs().imin();
        let first = straight.cross(&V::ith(least, 1.0)).try_normalize(0.0).unwrap_or_else(V::x);
        let second = straight.cross(&first).try_normalize(0.0).unwrap_or_else(V::y);
        Self::Free { place: (off.place + on.place) / 2.0, across: [first, second], slot }
    }

    fn place(&self, line: &Line) -> V {
        match self {
            Self::Corner(node) => line.nodes[*node].place,
            Self::Free { place, .. } => *place,
        }
    }
}
