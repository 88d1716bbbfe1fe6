//! Lists the places of free supports from which a search starts: corners of their regions and middles of the edges.

use nalgebra::{Unit, Vector3};

use crate::contact::{Place, Support};
use crate::model::Model;
use crate::tasks::{Bounds, Carried, Component, Task};

/// A task that puts the middle of a free support's patch at a place, and the place in words.
pub(super) fn other_places(model: &Model, supports: &[Support]) -> Vec<(Task, String)> {
    let mut found = vec![];
    for support in supports {
        let Place::Free(region) = &support.place else { continue };
        let corners = &region.corners;
        let middles = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| 0.5 * (a + b));
        for target in corners.iter().copied().chain(middles) {
            let name = &model.segments()[support.segment].name;
            let label = format!("{name} put at ({:.2}, {:.2}, {:.2}) m", target.x, target.y, target.z);
            found.push((at_place(support, target), label));
        }
    }
    found
}

fn at_place(support: &Support, target: Vector3<f64>) -> Task {
    let [_, u, v] = support.axes();
    let at = |along: Vector3<f64>| Component {
        of: Carried::Point(support.middle()),
        along: Unit::new_normalize(along),
        limits: (along.dot(&target), along.dot(&target)),
    };
    Task::Bounds(Bounds { segment: support.segment, components: vec![at(u), at(v)] })
}
