//! Computes the line of a tendon of MuJoCo: from site to site, round at most one sphere or cylinder between two sites, in parts that
//! pulleys divide.
//!
//! Each part between two sites is independent of the others, so that no search for rest is needed. The rules are those of MuJoCo's
//! `mj_tendon` and `mju_wrap` (engine sources, read for the facts).

mod around;
mod circle;
mod inside;

use nalgebra::Vector3;

use super::path::{Location, Path};
use super::routing::{FrameInGround, Node, NodeKind, Routing, Scene};
use crate::model::Placement;

/// A sphere or cylinder that tendons pass round.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonGeom {
    /// Its name.
    pub name: String,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Its axes in the segment's frame.
    pub pose: Placement,
    /// Its shape.
    pub shape: RoundShape,
    /// Its radius, m.
    pub radius: f64,
}

/// Shapes that tendons pass round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundShape {
    /// A sphere about the origin.
    Sphere,
    /// A cylinder without ends along z through the origin.
    Cylinder,
}

/// The parts of a path between its points, by MuJoCo's rule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tendon {
    /// What lies between each point of the path and the next one.
    pub parts: Vec<TendonPart>,
    /// Coordinates that lengthen the tendon directly: index, and length for each rad or m.
    pub coordinates: Vec<(usize, f64)>,
}

/// The line between two points of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonPart {
    /// Factor of its length and tension: 1 over the divisor of its pulley; 0 where one branch ends and the next one begins.
    pub weight: f64,
    /// The surface that it may pass round.
    pub around: Option<Around>,
}

/// A surface that a part of a tendon may pass round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Index in [`super::Paths::geoms`].
    pub geom: usize,
    /// The point on whose side the line passes; if it is inside of the surface, so is the line.
    pub side: Option<SidePoint>,
}

/// A point fixed in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidePoint {
    /// Index of the segment; `None` for ground.
    pub segment: Option<usize>,
    /// In the segment's frame, m.
    pub place: Vector3<f64>,
}

impl Routing {
    /// Lays a tendon; returns its length, m. Does not allocate.
    pub(super) fn lay_tendon(
        &mut self,
        scene: Scene<'_>,
        geoms: &[FrameInGround],
        path: &Path,
        tendon: &Tendon,
    ) -> f64 {
        self.nodes.clear();
        self.lengths.clear();
        self.lengths.resize(tendon.parts.len(), 0.0);
        let mut length: f64 = tendon.coordinates.iter().map(|&(c, factor)| factor * scene.values[c]).sum();
        for (index, point) in path.points.iter().enumerate() {
            let Location::Fixed(place) = point.location else { continue };
            let place = in_ground(scene, point.segment, &place);
            if let (Some(part), Some(from)) =
                (index.checked_sub(1).and_then(|i| tendon.parts.get(i)), self.nodes.last())
            {
                let from = from.place;
                length += self.pass(scene, geoms, (index - 1, part), &from, &place);
            }
            let weight = tendon.parts.get(index).map_or(0.0, |part| part.weight);
            let kind = NodeKind::Point(index);
            self.nodes.push(Node { place, seen: place, segment: point.segment, kind, weight });
        }
        length
    }

    /// Adds the corners of a part on its surface, if it touches it; returns the part's share of the length, m.
    fn pass(
        &mut self,
        scene: Scene<'_>,
        geoms: &[FrameInGround],
        (index, part): (usize, &TendonPart),
        from: &Vector3<f64>,
        to: &Vector3<f64>,
    ) -> f64 {
        let straight = part.weight * (to - from).norm();
        let Some(Around { geom, side }) = part.around else { return straight };
        let (axes, origin) = &geoms[geom];
        let own = |place: &Vector3<f64>| axes.tr_mul(&(place - origin));
        let side = side.map(|side| own(&in_ground(scene, side.segment, &side.place)));
        let geom = &scene.paths.geoms[geom];
        let Some(contact) = around::around(geom, &own(from), &own(to), side.as_ref()) else { return straight };
        let [first, second] = [contact.first, contact.second].map(|place| axes * place + origin);
        self.lengths[index] = contact.length;
        for (place, kind) in [(first, NodeKind::On(index)), (second, NodeKind::Off(index))] {
            self.nodes.push(Node { place, seen: place, segment: geom.segment, kind, weight: part.weight });
        }
        part.weight * ((first - from).norm() + contact.length + (to - second).norm())
    }
}

fn in_ground(scene: Scene<'_>, segment: Option<usize>, place: &Vector3<f64>) -> Vector3<f64> {
    segment.map_or(*place, |s| scene.segments[s].0 * place + scene.segments[s].1)
}
