//! Reads a recorded motion, an OpenSim table, as postures of the body of a session.

use contrapposto::model::Model;
use contrapposto_formats::motion::{Units, postures, read_table};

use crate::error::Refusal;
use crate::message::{Answer, Course};

/// Most names in a sentence.
const MOST_NAMES: usize = 6;

/// The motion of a file.
pub(crate) fn motion(model: &Model, name: &str, text: &str) -> Result<Answer, Refusal> {
    let table = read_table(name, text.as_bytes())?;
    let found = postures(&table, name, text.as_bytes(), model, Units::FromFile)?;
    let mut notes = table.warnings;
    for (names, about) in [
        (&found.missing, "have no column and stand at their default"),
        (&found.unknown, "are columns that this body does not have; they were left out"),
    ] {
        if !names.is_empty() {
            let more = names.len().saturating_sub(MOST_NAMES);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            notes.push(format!("{}{more} {about}", names[..names.len().min(MOST_NAMES)].join(", ")));
        }
    }
    let (times, postures) = found.postures.into_iter().map(|(time, posture)| (time, posture.values().to_vec())).unzip();
    Ok(Answer::Motion { course: Course { times, postures }, notes })
}
