//! `contrapposto convert`: the same body in another format.

use std::path::Path;

use contrapposto::model::Model;
use contrapposto_formats::tissue::SourcedModel;
use contrapposto_formats::write::{self, WriteError, Written};

use crate::args::ConvertArgs;
use crate::fail::Fail;
use crate::model_file::open;
use crate::output::{Folder, folder_and_name, print, print_note};

/// The start of the note about things of a file that a model does not use.
const NOT_USED: &str = "in the file and not used";

/// Writes a model as text, with the kinds of things of its file that the text lacks, and their numbers.
type Writer = fn(&SourcedModel) -> Result<(Written, Vec<(String, usize)>), WriteError>;

pub(crate) fn convert(args: &ConvertArgs) -> Result<(), Fail> {
    let shown = args.out.display();
    let writer = writer(&args.out)?;
    let same = |a: &Path, b: &Path| a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b);
    if same(&args.model.model, &args.out) {
        return Err(Fail::Refused(format!("{shown}: is the model file itself; give another name")));
    }
    // Passive torque and strength that the file does not have are not added, unless --passive library is given.
    let opened = open(&args.model, false)?;
    let (written, left_out) = writer(&opened).map_err(|error| Fail::Refused(format!("{shown}: {error}")))?;
    let (folder, name) = folder_and_name(&args.out)?;
    Folder::open(&folder)?.write(&[(&name, written.text.as_bytes())])?;
    // The last line tells of things that are not used and carried over all the same.
    let carried = left_out != opened.left_out;
    let notes = opened.notes.iter().filter(|note| !(carried && note.starts_with(NOT_USED)));
    notes.for_each(|note| print_note("note", note));
    written.lost.iter().for_each(|lost| print_note("lost", lost));
    let model = &opened.model;
    print(&format!(
        "{shown}: {} segments, {} coordinates, {:.4} kg; {}\n",
        model.segments().len(),
        model.coordinates().len(),
        model.mass(),
        not_carried_over(&left_out, written.lost.len())
    ))
}

/// `80 muscles, 66 markers not carried over`: parts of the file that the model does not have, and parts of the model that the format
/// cannot hold.
fn not_carried_over(left_out: &[(String, usize)], lost: usize) -> String {
    let mut all: Vec<String> = left_out.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    match lost {
        0 => {}
        1 => all.push("1 property that is named as lost".to_owned()),
        more => all.push(format!("{more} properties that are named as lost")),
    }
    if all.is_empty() { "everything carried over".to_owned() } else { format!("{} not carried over", all.join(", ")) }
}

/// The body in a format that has no muscles and markers.
fn body_alone(
    writer: fn(&Model) -> Result<Written, WriteError>,
    opened: &SourcedModel,
) -> Result<(Written, Vec<(String, usize)>), WriteError> {
    writer(&opened.model).map(|written| (written, opened.left_out.clone()))
}

fn writer(out: &Path) -> Result<Writer, Fail> {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("osim") => Ok(write::osim_again),
        Some("urdf") => Ok(|opened| body_alone(write::urdf, opened)),
        Some("xml" | "mjcf") => Ok(|opened| body_alone(write::mjcf, opened)),
        _ => {
            let shown = out.display();
            Err(Fail::Refused(format!("{shown}: the name must end in .osim, .urdf, or .xml or .mjcf (MJCF)")))
        }
    }
}
