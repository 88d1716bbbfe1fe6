//! A model as a drawing with names: joints with coordinates and their positive senses, frames of segments, patches.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto_plot::{BodyMap, MapFrame, MapJoint};
use nalgebra::Vector3;

use super::axes::turn;
use super::body::parts;
use crate::fail::Fail;

/// The body in its default posture. Of the left side only what has no twin on the right is named.
pub(crate) fn map_of_body(model: &Model) -> Result<BodyMap, Fail> {
    let (kinematics, turn) = (Kinematics::new(model), turn(model));
    let segments = model.segments();
    let twin = |name: &str| {
        let right = name.strip_suffix("_l").map(|stem| format!("{stem}_r"));
        right.is_some_and(|right| segments.iter().any(|segment| segment.name == right))
    };
    let (mut joints, mut frames, mut patches) = (vec![], vec![], vec![]);
    let mut left_out = false;
    for (s, segment) in segments.iter().enumerate() {
        let station = |point: &Vector3<f64>| turn.point(kinematics.station(model, s, *point));
        if !segment.patch.is_empty() {
            patches.push(segment.patch.iter().map(station).collect());
        }
        if twin(&segment.name) {
            left_out = true;
            continue;
        }
        let place = kinematics.placement(model, s);
        let at = turn.point(place.translation.vector);
        let axis = |axis: Vector3<f64>| turn.point(place.rotation * axis);
        frames.push(MapFrame {
            name: segment.name.clone(),
            at,
            axes: [axis(Vector3::x()), axis(Vector3::y()), axis(Vector3::z())],
        });
        let coordinates = &model.coordinates()[segment.coordinates.clone()];
        if !coordinates.is_empty() {
            let line = |c: &contrapposto::model::Coordinate| match c.positive.as_str() {
                "" => c.name.clone(),
                positive => format!("{}: {positive}", c.name),
            };
            let at = turn.point((place * segment.in_segment).translation.vector);
            joints.push(MapJoint { at, name: segment.joint.clone(), lines: coordinates.iter().map(line).collect() });
        }
    }
    let left = if left_out { "; the left side has the same names with _l" } else { "" };
    Ok(BodyMap {
        title: format!("{}: joints, coordinates and segments", model.name()),
        subtitle: format!("default posture; a coordinate grows in the sense that is written{left}"),
        parts: parts(model, model.default_posture().values(), None)?,
        joints,
        frames,
        patches,
    })
}
