//! Writes the model of an OpenSim file in its own format again, with its muscles and markers.

use super::osim::{document, osim};
use super::{WriteError, Written};
use crate::ModelFormat;
use crate::tissue::SourcedModel;

/// Writes the model of an OpenSim file as an `.osim` document, with the muscles, ligaments, springs, surfaces and markers that were
/// read of it, and the kinds of things of the file that this one lacks, with their numbers. Of another format the body alone ([`osim`]).
///
/// # Errors
/// As [`osim`].
pub fn osim_again(opened: &SourcedModel) -> Result<(Written, Vec<(String, usize)>), WriteError> {
    if opened.format != ModelFormat::OpenSim {
        return osim(&opened.model).map(|written| (written, opened.left_out.clone()));
    }
    let (written, carried) = document(&opened.model, &opened.muscles, &opened.markers)?;
    let has = |kind: &str| match kind {
        "muscles" => carried.muscles,
        "ligaments, path springs and bushings" => carried.springs,
        "wrap objects" => carried.wrap_objects,
        "markers" => carried.markers,
        _ => 0,
    };
    let lacking = opened.left_out.iter().map(|(kind, count)| (kind.clone(), count.saturating_sub(has(kind))));
    Ok((written, lacking.filter(|(_, count)| *count > 0).collect()))
}
