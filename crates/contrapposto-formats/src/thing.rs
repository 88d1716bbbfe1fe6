//! Holds a thing of a scenario as a box, for drawings: a table, a held box, a wall.

use contrapposto::model::Placement;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

/// A box that stands in ground, or that a segment carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// Name of the thing.
    pub name: String,
    /// Full lengths along its own axes, m.
    pub size: Vector3<f64>,
    /// Middle and axes of the thing, in ground or in the frame of the segment.
    pub place: Isometry3<f64>,
    /// Index of the segment that carries it; `None` for a thing in ground.
    pub segment: Option<usize>,
    /// Of a thing that does not turn with its segment: the point about which it swings.
    pub swing: Option<Swing>,
    /// Of a carried thing that is put down in a run: the time from which on it is not there, s.
    pub until: Option<f64>,
}

/// A thing is put down at times from so long before `until` on, s.
const PUT_DOWN_TOLERANCE: f64 = 1e-9;

/// A thing that keeps a direction while its segment carries it: a bag that hangs, a tool that is pressed against something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// The point about which it swings, in the frame of the segment, m.
    pub at: Vector3<f64>,
    /// Direction of ground that its own y axis keeps.
    pub up: Vector3<f64>,
}

impl Thing {
    /// A box in ground, or in the frame of a segment.
    pub fn new(name: &str, size: [f64; 3], place: Isometry3<f64>, segment: Option<usize>) -> Self {
        Self { name: name.to_owned(), size: size.into(), place, segment, swing: None, until: None }
    }

    /// Whether it is not yet put down at a time of a run, s.
    pub fn is_there(&self, time: f64) -> bool {
        self.until.is_none_or(|until| time < until - PUT_DOWN_TOLERANCE)
    }

    /// Placement in ground, given that of the segment which carries it.
    pub fn place_by(&self, segment: impl FnOnce(usize) -> Placement) -> Isometry3<f64> {
        let Some(carrier) = self.segment.map(segment) else { return self.place };
        let rigid = carrier * self.place;
        let Some(Swing { at, up }) = self.swing else { return rigid };
        let turn = UnitQuaternion::rotation_between(&(rigid.rotation * Vector3::y()), &up).unwrap_or_default();
        let about = carrier * Point3::from(at);
        let middle = about + turn * (Point3::from(rigid.translation.vector) - about);
        Isometry3::from_parts(middle.coords.into(), turn * rigid.rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_that_swings_keeps_its_direction_and_its_distance_from_the_segment() {
        let at = Vector3::new(0.0, -0.07, 0.0);
        let swing = Some(Swing { at, up: Vector3::y() });
        let place = Isometry3::translation(0.0, -0.27, 0.0);
        let bag = Thing { swing, ..Thing::new("bag", [0.3, 0.2, 0.1], place, Some(0)) };
        for angle in [-1.2, 0.0, 0.4, 2.0] {
            let hand = Placement::new(Vector3::new(0.3, 1.0, 0.2), Vector3::new(angle, 0.0, 0.3 * angle));
            let found = bag.place_by(|_| hand);
            let below = found.translation.vector - (hand * Point3::from(at)).coords;
            assert!((below - Vector3::new(0.0, -0.2, 0.0)).norm() < 1e-12, "{below}");
            assert!((found.rotation * Vector3::y() - Vector3::y()).norm() < 1e-12);
            let rigid = Thing { swing: None, ..bag.clone() }.place_by(|_| hand);
            assert!((rigid.translation.vector - hand.translation.vector).norm() > 0.26);
        }
    }
}
