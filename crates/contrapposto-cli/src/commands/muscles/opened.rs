//! Opens a model with muscles, and reads the one posture that a command about them wants.

use std::path::Path;

use contrapposto::model::Model;
use contrapposto::muscle::PathRule;
use contrapposto::posture::Posture;
use contrapposto_formats::tissue::SourcedModel;

use crate::args::{FrameArgs, ModelArgs, RuleChoice};
use crate::fail::Fail;
use crate::model_file::open_without_mesh_mass;
use crate::motion_file::read_motion;

/// MODEL with its muscles, and notes about it.
pub(super) fn opened_muscles(args: &ModelArgs) -> Result<(SourcedModel, Vec<String>), Fail> {
    let mut opened = open_without_mesh_mass(args, false)?;
    if opened.muscles.muscles.is_empty() {
        let file = args.model.display();
        let why = "no muscle could be read from it; MODEL is an OpenSim or MJCF file with muscles, and `contrapposto inspect` counts them";
        return Err(Fail::Refused(format!("{file}: {why}")));
    }
    let mut notes = std::mem::take(&mut opened.notes);
    notes.retain(|note| !note.starts_with("in the file and not used"));
    for (kind, tally) in opened.muscle_tally.0.iter().filter(|(_, tally)| tally.left_out + tally.refused > 0) {
        let missing = tally.left_out + tally.refused;
        notes.push(format!(
            "{missing} of {} {kind} are left out; `contrapposto inspect` says why",
            missing + tally.read
        ));
    }
    Ok((opened, notes))
}

/// The one posture of a file, or the default one, with its time.
pub(super) fn held_posture(
    path: &Path,
    frames: &FrameArgs,
    model: &Model,
    notes: &mut Vec<String>,
) -> Result<(f64, Posture), Fail> {
    if path == Path::new("default") {
        return Ok((0.0, model.default_posture()));
    }
    let accepted = "POSTURES is a .mot, .sto or .csv file, or `default`";
    let mut all = read_motion(path, accepted, frames, model, notes)?;
    match (all.len(), all.pop()) {
        (1, Some(frame)) => Ok(frame),
        (count, _) => {
            let why = "one posture is wanted; --from S and --to S select one";
            Err(Fail::Refused(format!("{}: has {count} postures, and {why}", path.display())))
        }
    }
}

pub(super) fn path_rule(choice: RuleChoice) -> PathRule {
    match choice {
        RuleChoice::Geodesic => PathRule::Geodesic,
        RuleChoice::Opensim => PathRule::OpenSim,
    }
}
