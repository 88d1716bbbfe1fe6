//! SCENARIO on the command line: its bytes, its name, and the model file that it names.

use std::path::{Path, PathBuf};

use contrapposto::model::Model;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{MOST_BYTES, ModelFile, scenario_model};

use crate::args::{ModelArgs, RootChoice};
use crate::fail::Fail;
use crate::input::read;
use crate::model_file::open;
use crate::output::print_note;

/// A scenario file that was read, not yet understood.
pub(crate) struct ScenarioFile {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    /// The model that it names, if it names one.
    pub(crate) model: Option<Model>,
}

impl ScenarioFile {
    pub(crate) fn read(path: &Path) -> Result<Self, Fail> {
        let bytes = read(path, MOST_BYTES)?;
        let name = path.display().to_string();
        let model = model_of(path, &name, &bytes)?;
        Ok(Self { name, bytes, model })
    }
}

/// The model file that a scenario names, if it names one.
fn model_of(scenario: &Path, name: &str, bytes: &[u8]) -> Result<Option<Model>, Fail> {
    let Some(file) = scenario_model(name, bytes)? else { return Ok(None) };
    let opened = open(&model_args(scenario, &file), true)?.with_fatigue(&file.fatigue);
    opened.notes.iter().for_each(|note| print_note("note", note));
    Ok(Some(opened.model))
}

/// How the scenario's model file is opened: its paths are seen from the scenario's folder.
fn model_args(scenario: &Path, file: &ModelFile) -> ModelArgs {
    let folder = scenario.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = |name: &String| -> PathBuf { folder.join(name) };
    ModelArgs {
        model: path(&file.file),
        overlay: file.overlay.as_ref().map(path),
        root: file.root.map(|root| match root {
            RootAttachment::Fixed => RootChoice::Fixed,
            RootAttachment::Free => RootChoice::Free,
        }),
        passive: None,
        no_strength: !file.strength,
        person: Some(file.person),
    }
}
