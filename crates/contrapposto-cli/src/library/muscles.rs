//! Computes the muscles of a model in postures at rest, with the numbers of `contrapposto muscles`.

use contrapposto::posture::Posture;
use contrapposto_formats::tissue::SourcedModel;

use super::failure::Failure;
use crate::args::RuleChoice;
use crate::commands::muscles::each_frame;
use crate::fail::Fail;
use crate::view::text::muscles::json;

/// A line of `contrapposto muscles --json` for each posture (rad, m), while `go_on` says yes. `opensim`: paths lie as OpenSim lays them, else
/// as shortest lines; `activation`: that of all muscles, 0 to 1.
///
/// # Errors
/// [`Failure`] of a model without muscles, an activation that is none, and a posture that does not fit the model.
pub fn muscle_lines(
    opened: &SourcedModel,
    postures: &[Posture],
    (opensim, activation): (bool, f64),
    go_on: impl Fn() -> bool,
) -> Result<Vec<String>, Failure> {
    if opened.muscles.muscles.is_empty() {
        return Err(Failure::refused("the model has no muscles that could be read; Model.notes counts those left out"));
    }
    if !(0.0..=1.0).contains(&activation) {
        return Err(Failure::refused(format!("activation is {activation}; it must lie in 0..1")));
    }
    let rule = if opensim { RuleChoice::Opensim } else { RuleChoice::Geodesic };
    let frames: Vec<(f64, Posture)> = postures.iter().map(|posture| (0.0, posture.clone())).collect();
    let mut lines = vec![];
    each_frame(opened, &frames, (rule, activation), |frame| {
        if !go_on() {
            return Err(Fail::Told);
        }
        lines.push(json(opened, frame)?);
        Ok(())
    })?;
    Ok(lines)
}
