//! Reads and writes tables of postures: OpenSim's `.mot` and `.sto`, and `.csv`.

use std::path::Path;

use contrapposto::model::Model;
use contrapposto_formats::write::osim_motion;

use super::failure::{Failure, Note, with_notes};
use crate::args::FrameArgs;
use crate::fail::Fail;
use crate::motion_file::read_whole_motion;
use crate::output::{Folder, folder_and_name};

/// Times (s), and the values of all coordinates (rad, m) at each of them, row after row.
pub type MotionRows = (Vec<f64>, Vec<f64>);

/// The postures of a table. `degrees`: whether its angles are degrees, whatever the file says.
///
/// # Errors
/// [`Failure`] as the program prints it.
pub fn read_motion(model: &Model, path: &Path, degrees: Option<bool>) -> Result<(MotionRows, Vec<Note>), Failure> {
    with_notes(|| {
        let units = FrameArgs { from: None, to: None, degrees: degrees == Some(true), radians: degrees == Some(false) };
        let mut notes = vec![];
        let accepted = "a motion is a .mot, .sto or .csv file";
        let frames = read_whole_motion(path, accepted, &units, model, &mut notes)?;
        notes.iter().for_each(|note| crate::output::print_note("note", note));
        let (times, postures): (Vec<f64>, Vec<_>) = frames.into_iter().unzip();
        Ok((times, postures.iter().flat_map(|posture| posture.values().iter().copied()).collect()))
    })
}

/// Writes postures as a `.mot` table that OpenSim plays, whole or not at all.
///
/// # Errors
/// [`Failure`] of postures that are no motion of the model, and of a file that cannot be written.
pub fn write_motion(model: &Model, path: &Path, times: &[f64], values: &[f64]) -> Result<(), Failure> {
    let rows: Vec<&[f64]> = values.chunks_exact(model.coordinates().len().max(1)).collect();
    let text = osim_motion(model, model.name(), times, &rows);
    let text = text.map_err(|error| Failure::refused(format!("{}: {error}", path.display())))?;
    let write = || -> Result<(), Fail> {
        let (folder, name) = folder_and_name(path)?;
        Folder::open(&folder)?.write(&[(name.as_str(), text)])
    };
    Ok(write()?)
}
