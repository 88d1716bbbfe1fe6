//! Lays a tendon in a posture: part after part, from each point to the next one.

use nalgebra::Vector3;

use super::around::around;
use super::parts::{Around, Tendon, TendonPart};
use crate::muscle::path::{Location, Path};
use crate::muscle::routing::{CornerOrigin, FrameInGround, Node, Routing, Scene};

impl Routing {
    /// Lays a tendon; returns its length, m. Does not allocate.
    pub(in crate::muscle) fn lay_tendon(
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
            let kind = CornerOrigin::Point(index);
            self.nodes.push(Node { place, reference: place, segment: point.segment, kind, weight });
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
        let Some(contact) = around(geom, &own(from), &own(to), side.as_ref()) else { return straight };
        let [first, second] = [contact.first, contact.second].map(|place| axes * place + origin);
        self.lengths[index] = contact.length;
        for (place, kind) in [(first, CornerOrigin::On(index)), (second, CornerOrigin::Off(index))] {
            self.nodes.push(Node { place, reference: place, segment: geom.segment, kind, weight: part.weight });
        }
        part.weight * ((first - from).norm() + contact.length + (to - second).norm())
    }
}

fn in_ground(scene: Scene<'_>, segment: Option<usize>, place: &Vector3<f64>) -> Vector3<f64> {
    segment.map_or(*place, |s| scene.segments[s].0 * place + scene.segments[s].1)
}
