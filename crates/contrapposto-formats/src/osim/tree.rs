//! Orders joints to a tree that begins at ground.
//!
//! A joint that is written from the outer body to the inner one is turned round: its motions in reverse order about reversed axes.

use super::attributes::Reader;
use super::coordinates::Coordinates;
use super::error::OsimProblem;
use super::joint;
use super::sets::{Scene, SceneBody};
use crate::model_ir::{Ignored, ModelIr, MotionIr, SegmentIr};
use nalgebra::Isometry3;

/// Builds the segments and the list of coordinates.
pub(super) fn assemble<'a>(
    reader: &Reader<'a>,
    scene: &Scene<'a>,
    body: &mut ModelIr,
    ignored: &mut Ignored,
) -> Result<Coordinates, OsimProblem> {
    let mut coordinates = Coordinates::default();
    let mut motions = Vec::with_capacity(scene.joints.len());
    for joint in &scene.joints {
        motions.push(joint::motions(reader, joint, &mut coordinates, ignored)?);
    }
    let ground = scene.bodies.len();
    let (joints_at, is_child) = joints_of_bodies(scene);
    let mut segment_of: Vec<Option<usize>> = vec![None; ground];
    let mut used = vec![false; scene.joints.len()];
    let mut waiting: Vec<usize> = Vec::new();
    let mut next_base = 0;
    let mut at = ground;
    loop {
        // Joints of this body whose other body is not reached yet, the first of the file on top.
        waiting.extend(joints_at[at].iter().rev().filter(|&&number| !used[number]));
        while let Some(number) = waiting.pop() {
            if std::mem::replace(&mut used[number], true) {
                continue;
            }
            let joint = &scene.joints[number];
            let reached = |body: Option<usize>| body.is_none_or(|b| segment_of[b].is_some());
            let (inner, outer, turned) = match (reached(joint.parent.body), joint.child.body, joint.parent.body) {
                (true, Some(outer), _) if segment_of[outer].is_none() => (joint.parent, (outer, joint.child), false),
                (false, _, Some(outer)) => (joint.child, (outer, joint.parent), true),
                _ => {
                    let accepted = "joints that form a tree";
                    return Err(OsimProblem::unsupported(joint.node.place(), "a joint that closes a loop", accepted));
                }
            };
            let mut chain = std::mem::take(&mut motions[number]);
            if turned {
                turn_round(&mut chain);
            }
            let (outer, frame) = outer;
            let source = &scene.bodies[outer];
            segment_of[outer] = Some(body.segments.len());
            let parent = inner.body.and_then(|b| segment_of[b]);
            let segment = segment(source, joint.name.clone(), chain);
            body.segments.push(SegmentIr { parent, in_parent: inner.pose, in_segment: frame.pose, ..segment });
            waiting.extend(joints_at[outer].iter().rev().filter(|&&number| !used[number]));
        }
        // A body that nothing joins to ground: OpenSim gives the innermost one a free joint.
        while next_base < ground && (segment_of[next_base].is_some() || is_child[next_base]) {
            next_base += 1;
        }
        let Some(base) = scene.bodies.get(next_base) else { break };
        let (name, chain) = joint::free(reader, &base.name, base.node, &mut coordinates)?;
        segment_of[next_base] = Some(body.segments.len());
        body.segments.push(segment(base, name, chain));
        at = next_base;
    }
    check_that_all_are_reached(scene, &segment_of)?;
    Ok(coordinates)
}

fn check_that_all_are_reached(scene: &Scene<'_>, segment_of: &[Option<usize>]) -> Result<(), OsimProblem> {
    let Some(lost) = segment_of.iter().position(Option::is_none) else { return Ok(()) };
    let accepted = "bodies that joints connect to ground";
    let what = format!("body {}, in a loop of joints apart from ground,", scene.bodies[lost].name);
    Err(OsimProblem::unsupported(scene.bodies[lost].node.place(), &what, accepted))
}

/// Numbers of the joints at each body, and whether a body is the child of one; ground is the last.
fn joints_of_bodies(scene: &Scene<'_>) -> (Vec<Vec<usize>>, Vec<bool>) {
    let ground = scene.bodies.len();
    let index = |body: Option<usize>| body.unwrap_or(ground);
    let mut joints_at = vec![Vec::new(); ground + 1];
    let mut is_child = vec![false; ground + 1];
    for (number, joint) in scene.joints.iter().enumerate() {
        joints_at[index(joint.parent.body)].push(number);
        joints_at[index(joint.child.body)].push(number);
        is_child[index(joint.child.body)] = true;
    }
    (joints_at, is_child)
}

/// The segment of a body whose joint lies at ground's origin and its own.
fn segment(body: &SceneBody<'_>, joint: String, motions: Vec<MotionIr>) -> SegmentIr {
    SegmentIr {
        name: body.name.clone(),
        parent: None,
        mass: body.mass,
        center_of_mass: body.center_of_mass,
        inertia: body.inertia,
        joint,
        in_parent: Isometry3::identity(),
        in_segment: Isometry3::identity(),
        motions,
    }
}

fn turn_round(motions: &mut [MotionIr]) {
    motions.reverse();
    for motion in motions {
        match motion {
            MotionIr::Hinge { axis, .. } | MotionIr::Slide { axis, .. } => *axis = -*axis,
            MotionIr::Ball { .. } => {}
        }
    }
}
