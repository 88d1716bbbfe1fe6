//! Writes the tasks that keep a support where it belongs: at its placement of the start, or flat on its plane within a region.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Rotation3, Unit, UnitVector3, Vector3};

use super::bounds::{Bounds, Carried, Component};
use super::placement::Placement;
use super::polygon::half_planes;
use super::task::Task;
use crate::contact::{Place, Region, Support};
use crate::kinematics::Kinematics;
use crate::model::Model;

/// The equations that a support keeps: six of its placement in the posture of `kinematics`, or, where its place is free, three: the
/// height of the middle of its patch, and the two tilts of the patch.
pub fn held_place(support: &Support, model: &Model, kinematics: &Kinematics) -> Task {
    let segment = support.segment;
    let target = kinematics.placement(model, segment);
    if support.place == Place::Fixed {
        return Task::Placement(Placement { segment, point: Vector3::zeros(), target });
    }
    let [normal, across, along] = support.axes().map(Unit::new_normalize);
    let middle = support.middle();
    let height = normal.dot(&kinematics.station(model, segment, middle));
    let upright = Unit::new_normalize(target.rotation.inverse() * normal.into_inner());
    let tilt = |along| Component { of: Carried::Direction(upright), along, limits: (0.0, 0.0) };
    let at_height = Component { of: Carried::Point(middle), along: normal, limits: (height, height) };
    Task::Bounds(Bounds { segment, components: vec![at_height, tilt(across), tilt(along)] })
}

/// The support with the limits of its turn counted from the posture of `now`, where they are counted from that of `start`.
#[must_use]
pub fn turned_since(support: &Support, model: &Model, start: &Kinematics, now: &Kinematics) -> Support {
    let mut support = support.clone();
    let [normal, ahead, _] = support.axes();
    let rotation = |kinematics: &Kinematics| kinematics.placement(model, support.segment).rotation;
    let turned = rotation(now) * rotation(start).inverse() * ahead;
    let turn = libm::atan2(normal.dot(&ahead.cross(&turned)), ahead.dot(&turned));
    if let Place::Free(Region { turn: (least, greatest), .. }) = &mut support.place {
        // The posture itself is within them but for rounding; a limit is a quarter turn away at most.
        *least = (*least - turn).clamp(-FRAC_PI_2, 0.0);
        *greatest = (*greatest - turn).clamp(0.0, FRAC_PI_2);
    }
    support
}

/// The inequalities of a support whose place is free: the middle of its patch in its region, its turn about the normal within its
/// limits. `None` for a support that stays.
pub fn free_place(support: &Support, model: &Model, kinematics: &Kinematics) -> Option<Task> {
    let Place::Free(Region { turn: (least, greatest), .. }) = &support.place else { return None };
    let segment = support.segment;
    let rotation = kinematics.placement(model, segment).rotation;
    let [normal, ahead, _] = support.axes().map(Unit::new_normalize);
    let carried = Carried::Direction(Unit::new_normalize(rotation.inverse() * ahead.into_inner()));
    // Square to the direction ahead after a turn: the component along it is the sine of what is left of the turn.
    let square = |turn: f64| -> UnitVector3<f64> {
        Unit::new_normalize(normal.cross(&(Rotation3::from_axis_angle(&normal, turn) * ahead.into_inner())))
    };
    let turned = [
        Component { of: carried, along: square(*least), limits: (0.0, f64::INFINITY) },
        Component { of: carried, along: square(*greatest), limits: (f64::NEG_INFINITY, 0.0) },
    ];
    Some(Task::Bounds(Bounds { segment, components: within_region(support).chain(turned).collect() }))
}

/// The inequalities of the region of a support whose place is free; none for one that stays.
pub(crate) fn within_region(support: &Support) -> impl Iterator<Item = Component> {
    let corners = match &support.place {
        Place::Free(region) => region.corners.as_slice(),
        Place::Fixed => &[],
    };
    let middle = Carried::Point(support.middle());
    half_planes(corners, -support.normal).into_iter().map(move |edge| Component {
        of: middle,
        along: Unit::new_normalize(edge.normal),
        limits: (f64::NEG_INFINITY, edge.offset),
    })
}
