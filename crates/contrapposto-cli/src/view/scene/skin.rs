//! The skin of the body of a page, with the places of the segments that move it.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_formats::animation::{Skin, joined_by};
use contrapposto_report as page;

use super::closed_hand::closed;
use crate::fail::Fail;
use crate::view::axes::Turn;
use crate::view::frame::Frame;

/// Places of a body: in all frames, and before anything happened.
pub(super) struct Course<'a> {
    pub(super) model: &'a Model,
    pub(super) start: &'a [f64],
    pub(super) frames: &'a [Frame],
    /// Hands that hold something.
    pub(super) closed: &'a [usize],
}

/// The skin; `None` for a body without one. `shown`: the coordinates of the page's joints.
pub(super) fn skin(course: &Course<'_>, shown: &[usize], turn: &Turn) -> Result<Option<page::Skin>, Fail> {
    let Some(skin) = Skin::of(course.model) else { return Ok(None) };
    let bones = skin.skeleton.bones();
    let mut segments: Vec<usize> = bones.iter().flat_map(|bone| [bone.from, bone.segment]).collect();
    segments.sort_unstable();
    segments.dedup();
    let index = |segment: usize| segments.iter().position(|other| *other == segment).unwrap_or(0);
    let bone = |bone: &contrapposto_formats::animation::Bone| page::Bone {
        from: index(bone.from),
        to: index(bone.segment),
        axis: turn.point(bone.axis),
        shares: bone.shares,
    };
    Ok(Some(page::Skin {
        vertices: closed(&skin, course.model, course.closed).into_iter().map(|vertex| turn.point(vertex)).collect(),
        triangles: skin.triangles.clone(),
        light: skin.light(),
        bones: skin.bones.clone(),
        weights: skin.weights.clone(),
        nodes: bones.iter().map(bone).collect(),
        segments: followed(course, &skin, &segments, shown, turn)?,
    }))
}

/// Segments in all frames.
fn followed(
    course: &Course<'_>,
    skin: &Skin,
    segments: &[usize],
    shown: &[usize],
    turn: &Turn,
) -> Result<Vec<page::Followed>, Fail> {
    let model = course.model;
    let new = |&segment: &usize| {
        let coordinates = joined_by(model, segment);
        let joints = shown.iter().enumerate().filter(|(_, i)| coordinates.contains(i)).map(|(place, _)| place);
        page::Followed {
            joints: joints.collect(),
            rest: turn.place(&skin.skeleton.rest[segment]),
            ..page::Followed::default()
        }
    };
    let mut list: Vec<page::Followed> = segments.iter().map(new).collect();
    let mut kinematics = Kinematics::new(model);
    let mut places = |posture: &[f64]| -> Result<Vec<[f64; 7]>, Fail> {
        kinematics.update(model, &Posture::new(posture.to_vec())).map_err(|error| Fail::job("report", error))?;
        Ok(segments.iter().map(|&segment| turn.place(&kinematics.placement(model, segment))).collect())
    };
    for frame in course.frames {
        list.iter_mut().zip(places(&frame.posture)?).for_each(|(followed, place)| followed.places.push(place));
    }
    list.iter_mut().zip(places(course.start)?).for_each(|(followed, place)| followed.start = place);
    Ok(list)
}
