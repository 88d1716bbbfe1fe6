//! Writes a motion as BVH: a skeleton of joints, and three angles of each for every posture.

use std::fmt::Write;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model, Motion, Placement};
use contrapposto::posture::Posture;
use nalgebra::{Rotation3, Vector3};

use super::{AnimationError, Clip, joint_frames, zyx};
use crate::write::Names;

/// Animation programs count in centimetres.
const CENTIMETRES: f64 = 100.0;
/// Greatest difference between steps of time, as a part of one step.
const UNEVEN: f64 = 1e-3;
/// Time of one frame where there is only one, s.
const ONE_FRAME: f64 = 1.0 / 30.0;
/// Points nearer than this, m, are one.
const NEAR: f64 = 1e-6;
/// Length of a last segment without any, m.
const STUB: f64 = 0.05;
/// Deeper joints are not indented any further.
const DEEPEST: usize = 40;

/// The motion of a joint of the file.
#[derive(Clone, Copy, PartialEq)]
enum Does {
    /// The root: place and turn.
    Both,
    /// Place only, against the joint's rest.
    Slides,
    Turns,
}

/// A joint of the file.
struct Joint {
    name: String,
    /// `None` for a root that is the ground.
    segment: Option<usize>,
    depth: usize,
    does: Does,
}

/// Writes a motion as `.bvh`.
///
/// Axes: y up, z ahead, x left. Lengths are in cm, angles in degrees, channels in the order z, y, x: a joint's rotation is
/// `Rz Ry Rx`, and its angles run on without jumps. At rest (all angles 0) the body stands in its zero posture: all coordinates 0, balls
/// unturned. Angles turn a segment against its parent about the file's axes as they stand in that rest, not about the axes of
/// the model's joints. The root has place and turn; if several segments hang on the ground, the root is `ground` and rests. A segment
/// whose joint slides hangs on a joint `NAME_slide` with three places, which are how far it has left its rest.
///
/// Numbers have six decimals.
///
/// # Errors
/// [`AnimationError`] says which time or posture does not fit; times must be evenly spaced.
pub fn bvh(clip: &Clip<'_>) -> Result<String, AnimationError> {
    clip.check()?;
    let step = step(clip.times)?;
    let model = clip.model;
    let drawn = clip.drawn();
    let rest = rest(model)?;
    let joints = joints(model);
    let mut text = String::from("HIERARCHY\n");
    hierarchy(model, &joints, &rest, &drawn, &mut text);
    let _ = write!(text, "MOTION\nFrames: {}\nFrame Time: {step:?}\n", clip.times.len());
    let mut before = vec![[0.0; 3]; joints.len()];
    clip.play(|_, frames| {
        let turn =
            |s: usize| drawn * (frames[s].rotation * rest[s].rotation.inverse()).to_rotation_matrix() * drawn.inverse();
        let place = |s: usize| drawn * frames[s].translation.vector;
        let mut separator = "";
        for (joint, before) in joints.iter().zip(&mut before) {
            let parent = joint.segment.and_then(|s| model.segments()[s].parent);
            let (held, from) = parent.map_or((Rotation3::identity(), Vector3::zeros()), |p| (turn(p), place(p)));
            let mut numbers: Vec<f64> = vec![];
            if joint.does != Does::Turns {
                let own = joint.segment.map_or_else(Vector3::zeros, |s| held.inverse() * (place(s) - from));
                let resting = joint.segment.map_or_else(Vector3::zeros, |s| drawn * offset(model, &rest, s));
                let at = if joint.does == Does::Both { own } else { own - resting };
                numbers.extend((CENTIMETRES * at).iter());
            }
            if joint.does != Does::Slides {
                let own = joint.segment.map_or_else(Rotation3::identity, |s| held.inverse() * turn(s));
                *before = zyx(own.matrix(), *before);
                numbers.extend(before.map(f64::to_degrees));
            }
            for value in numbers {
                let _ = write!(text, "{separator}{}", number(value));
                separator = " ";
            }
        }
        text.push('\n');
    })?;
    Ok(text)
}

/// The time between two postures, s.
fn step(times: &[f64]) -> Result<f64, AnimationError> {
    let [first, .., last] = times else { return Ok(ONE_FRAME) };
    let step = (last - first) / (times.len() - 1) as f64;
    let even = |i: &usize| (times[*i] - (first + step * *i as f64)).abs() <= UNEVEN * step;
    match (0..times.len()).find(|i| !even(i)) {
        None => Ok(step),
        Some(index) => Err(AnimationError::Time { index, time: times[index], problem: "breaks the even steps of BVH" }),
    }
}

/// Joint frames of the zero posture.
fn rest(model: &Model) -> Result<Vec<Placement>, AnimationError> {
    let mut zero = vec![0.0; model.coordinates().len()];
    let mut next = 0;
    while let Some(coordinate) = model.coordinates().get(next) {
        // The first of the four components is the cosine.
        let ball = coordinate.kind == CoordinateKind::Quaternion;
        zero[next] = f64::from(u8::from(ball));
        next += if ball { 4 } else { 1 };
    }
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(zero)).map_err(|source| AnimationError::Posture { index: 0, source })?;
    Ok(joint_frames(model, &kinematics))
}

/// From the parent's joint to a segment's, at rest, ground axes, m.
fn offset(model: &Model, rest: &[Placement], segment: usize) -> Vector3<f64> {
    let from = model.segments()[segment].parent.map_or_else(Vector3::zeros, |p| rest[p].translation.vector);
    rest[segment].translation.vector - from
}

/// All joints of the file, parents before children.
fn joints(model: &Model) -> Vec<Joint> {
    let segments = model.segments();
    let mut children: Vec<Vec<usize>> = vec![vec![]; segments.len()];
    let mut roots = vec![];
    for (s, segment) in segments.iter().enumerate() {
        segment.parent.map_or(&mut roots, |parent| &mut children[parent]).push(s);
    }
    let mut names = Names::new(&[], |c| !(c.is_whitespace() || c.is_control() || "{}".contains(c)));
    let mut list = vec![];
    let mut open: Vec<(usize, usize)> = vec![];
    if let [root] = roots[..] {
        list.push(Joint { name: names.take(&segments[root].name), segment: Some(root), depth: 0, does: Does::Both });
        open.extend(children[root].iter().rev().map(|&child| (child, 1)));
    } else {
        list.push(Joint { name: names.take("ground"), segment: None, depth: 0, does: Does::Both });
        open.extend(roots.iter().rev().map(|&root| (root, 1)));
    }
    while let Some((s, mut depth)) = open.pop() {
        let name = names.take(&segments[s].name);
        if segments[s].joint_kind.motions().iter().any(|motion| matches!(motion, Motion::Slide(_))) {
            list.push(Joint {
                name: names.take(&format!("{name}_slide")),
                segment: Some(s),
                depth,
                does: Does::Slides,
            });
            depth += 1;
        }
        list.push(Joint { name, segment: Some(s), depth, does: Does::Turns });
        open.extend(children[s].iter().rev().map(|&child| (child, depth + 1)));
    }
    list
}

fn hierarchy(model: &Model, joints: &[Joint], rest: &[Placement], drawn: &Rotation3<f64>, text: &mut String) {
    let indent = |depth: usize| "\t".repeat(depth.min(DEEPEST));
    let triple = |v: Vector3<f64>| (CENTIMETRES * (drawn * v)).iter().map(|v| number(*v)).collect::<Vec<_>>().join(" ");
    for (i, joint) in joints.iter().enumerate() {
        let (word, tabs) = (if i == 0 { "ROOT" } else { "JOINT" }, indent(joint.depth));
        let channels = match joint.does {
            Does::Both => "6 Xposition Yposition Zposition Zrotation Yrotation Xrotation",
            Does::Slides => "3 Xposition Yposition Zposition",
            Does::Turns => "3 Zrotation Yrotation Xrotation",
        };
        // Places of the root are from the ground, and what slides has its rest in the joint below.
        let rests = joint.segment.filter(|_| joint.does == Does::Turns);
        let offset = rests.map_or_else(Vector3::zeros, |s| offset(model, rest, s));
        let _ = write!(text, "{tabs}{word} {}\n{tabs}{{\n", joint.name);
        let _ = write!(text, "{tabs}\tOFFSET {}\n{tabs}\tCHANNELS {channels}\n", triple(offset));
        let next = joints.get(i + 1).map_or(0, |next| next.depth);
        if next <= joint.depth {
            let end = triple(joint.segment.map_or_else(Vector3::zeros, |s| reach(model, rest, s)));
            let _ = write!(text, "{tabs}\tEnd Site\n{tabs}\t{{\n{tabs}\t\tOFFSET {end}\n{tabs}\t}}\n");
            for depth in (next..=joint.depth).rev() {
                let _ = writeln!(text, "{}}}", indent(depth));
            }
        }
    }
}

/// From a last segment's joint through its centre of mass as far beyond, at rest, ground axes, m. Where that is no length, which
/// some programs do not like, a little farther on from the joint before.
fn reach(model: &Model, rest: &[Placement], s: usize) -> Vector3<f64> {
    let segment = &model.segments()[s];
    let reach = rest[s].rotation * (2.0 * (segment.center_of_mass - segment.in_segment.translation.vector));
    let on = || STUB * offset(model, rest, s).try_normalize(NEAR).unwrap_or_else(Vector3::y);
    if reach.norm() > NEAR { reach } else { on() }
}

/// Six decimals, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
