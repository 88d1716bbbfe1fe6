//! Collects the placements of nodes over time, and writes them as an animation of glTF.

use std::collections::BTreeMap;

use contrapposto::model::Placement;
use serde_json::{Value, json};

use super::buffer::Buffer;
use super::track::Track;
use super::{AnimationError, Clip};

/// Time for which the last posture of steps is held, s.
const HELD: f32 = 1.0;

/// Placement of a node in its parent, over time.
pub(super) struct Course {
    pub(super) place: Track<3>,
    /// x, y, z, w.
    pub(super) turn: Track<4>,
    /// Size of the node, the same along its three axes.
    pub(super) size: Track<3>,
}

/// Indices of times and values of place, turn and size, each unless it stays.
pub(super) type Moving = [Option<(Vec<usize>, Vec<f32>)>; 3];

impl Course {
    /// Unless it is the same all the time.
    pub(super) fn moving(&self) -> Moving {
        [self.place.moving(), self.turn.moving(), self.size.moving()]
    }

    /// Unless it is the one given all the time.
    pub(super) fn off(&self, place: [f32; 3], turn: [f32; 4]) -> Moving {
        [self.place.off(place), self.turn.off(turn), None]
    }

    fn push(&mut self, index: usize, (local, size): &(Placement, f64)) {
        self.place.push(index, local.translation.vector.into());
        self.turn.push_nearer(index, local.rotation.coords.into());
        self.size.push(index, [*size; 3]);
    }
}

/// Times from 0, and the course of every node, of which `locals` gives the placements in their parents and their sizes, by the number of the
/// posture and the joint frames of all segments.
pub(super) fn courses(
    clip: &Clip<'_>,
    count: usize,
    mut locals: impl FnMut(usize, &[Placement]) -> Vec<(Placement, f64)>,
) -> Result<(Vec<f32>, Vec<Course>), AnimationError> {
    let new = || Course { place: Track::new(), turn: Track::new(), size: Track::new() };
    let mut courses: Vec<Course> = (0..count).map(|_| new()).collect();
    let mut times: Vec<f32> = vec![];
    let mut last = vec![];
    clip.play(|index, frames| {
        // Times so near each other that they are one in f32 would be refused by every reader.
        let time = (clip.times[index] - clip.times[0]) as f32;
        if times.last().is_some_and(|last| *last >= time) {
            return;
        }
        last = locals(index, frames);
        courses.iter_mut().zip(&last).for_each(|(course, local)| course.push(times.len(), local));
        times.push(time);
    })?;
    if let (true, Some(end)) = (clip.steps, times.last()) {
        courses.iter_mut().zip(&last).for_each(|(course, local)| course.push(times.len(), local));
        times.push(end + HELD);
    }
    Ok((times, courses))
}

/// One channel for everything that moves, by node; `None` where nothing does.
pub(super) fn animation(
    clip: &Clip<'_>,
    nodes: &[(usize, Moving)],
    times: &[f32],
    buffer: &mut Buffer,
) -> Option<Value> {
    let interpolation = if clip.steps { "STEP" } else { "LINEAR" };
    let (mut channels, mut samplers) = (vec![], vec![]);
    let mut inputs: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for (node, moving) in nodes {
        let [place, turn, size] = moving;
        let paths = [("translation", "VEC3", 3, place), ("rotation", "VEC4", 4, turn), ("scale", "VEC3", 3, size)];
        for (path, kind, width, moving) in paths {
            let Some((keys, values)) = moving else { continue };
            let input = *inputs.entry(keys.clone()).or_insert_with_key(|keys| {
                let times: Vec<f32> = keys.iter().map(|&key| times[key]).collect();
                buffer.course("SCALAR", 1, &times)
            });
            let output = buffer.course(kind, width, values);
            channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        }
    }
    let name = if clip.title.is_empty() { "motion" } else { clip.title };
    (!channels.is_empty()).then(|| json!({ "name": name, "channels": channels, "samplers": samplers }))
}
