//! The body of a run for other programs: `motion.glb`, `motion.bvh`, `model.osim`.

use contrapposto::simulation::Scenario;
use contrapposto_formats::animation::{Clip, bvh, glb, solids};
use contrapposto_formats::write;

use super::axes::directions;
use super::recording::Recording;
use crate::fail::Fail;
use crate::output::print_note;

/// Name and content of every file; one that a body cannot be written as is missing, and standard error says why.
pub(crate) fn bodies(scenario: &Scenario, recording: &Recording) -> Result<Vec<(&'static str, Vec<u8>)>, Fail> {
    let model = &scenario.model;
    let [right, ahead, up] = directions(model);
    let postures: Vec<&[f64]> = recording.rows().map(|row| row.posture).collect();
    let clip = Clip {
        model,
        title: &scenario.title,
        directions: [-right, up, ahead],
        times: recording.times(),
        postures: &postures,
    };
    let solids: Vec<_> = (0..model.segments().len()).map(|s| solids(model, s)).collect();
    let mut files = vec![
        ("motion.glb", glb(&clip, &solids).map_err(|error| Fail::job("motion.glb", error))?),
        ("motion.bvh", bvh(&clip).map_err(|error| Fail::job("motion.bvh", error))?.into_bytes()),
    ];
    match write::osim(model) {
        Ok(written) => files.push(("model.osim", written.text.into_bytes())),
        Err(error) => print_note("note", &format!("no model.osim: {error}")),
    }
    Ok(files)
}
