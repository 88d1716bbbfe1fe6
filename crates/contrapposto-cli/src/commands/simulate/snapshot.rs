//! An interrupted run as a file: `snapshot.json`.

use std::path::Path;

use contrapposto::simulation::{Run, Scenario, Snapshot};
use serde::{Deserialize, Serialize};

use crate::fail::Fail;
use crate::input::read;
use crate::output::ResultSet;
use crate::view::recording::Recording;

/// Name of the snapshot's file.
pub(super) const SNAPSHOT: &str = "snapshot.json";

/// Largest snapshot that is read, bytes; a run writes far smaller ones.
const MOST_BYTES: u64 = 256 << 20;

/// The program with its version: the next version may compute other bytes.
const PROGRAM: &str = concat!("contrapposto ", env!("CARGO_PKG_VERSION"));

/// The state from which a run continues.
#[derive(Serialize, Deserialize)]
struct Saved<R, S> {
    program: String,
    /// Fingerprint of scenario and body.
    scenario: String,
    run: S,
    /// Rows up to the present; later ones are ignored.
    recording: R,
}

/// Writes where a run is.
pub(super) fn save(scenario: &Scenario, run: &Run, recording: &Recording, folder: &ResultSet) -> Result<(), Fail> {
    let saved = Saved { program: PROGRAM.to_owned(), scenario: fingerprint(scenario), run: run.snapshot(), recording };
    let bytes = serde_json::to_vec(&saved).map_err(|error| Fail::job(SNAPSHOT, error))?;
    folder.write_apart(SNAPSHOT, &bytes)
}

/// The run that was left in `folder`, and its recording.
pub(super) fn go_on<'a>(scenario: &'a Scenario, path: &Path) -> Result<(Run<'a>, Recording), Fail> {
    let shown = path.display();
    let bytes = read(path, MOST_BYTES)?;
    let refused = |why: &dyn std::fmt::Display| Fail::Refused(format!("{shown}: {why}"));
    let saved: Saved<Recording, Snapshot> = serde_json::from_slice(&bytes).map_err(|error| refused(&error))?;
    if saved.program != PROGRAM {
        return Err(refused(&format!("was written by `{}`, and this is `{PROGRAM}`", saved.program)));
    }
    if saved.scenario != fingerprint(scenario) {
        return Err(refused(&"is of another scenario or body, or of one that was changed since"));
    }
    let recording = saved.recording.up_to(scenario, saved.run.samples);
    let recording = recording.ok_or_else(|| refused(&"its recording does not fit the scenario"))?;
    let run = Run::resume(scenario, saved.run).map_err(|error| refused(&error))?;
    Ok((run, recording))
}

/// Tells one scenario from another: FNV-1a over all that is known of it, the body included, but the number of threads, which changes nothing.
fn fingerprint(scenario: &Scenario) -> String {
    let mut told = scenario.clone();
    told.run.threads = 1;
    let text = format!("{told:?}");
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    format!("{hash:016x}")
}
