//! Names a scenario: a file, or its text.

use std::path::PathBuf;

use crate::fail::Fail;
use crate::scenario_file::ScenarioFile;

/// A scenario: a file, or its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScenarioSource {
    /// A file; the files that it names are beside it.
    File(PathBuf),
    /// A text; the files that it names are in the present folder.
    Text(String),
}

impl ScenarioSource {
    /// The bytes of the scenario, and the model that the scenario names.
    pub(crate) fn open(&self) -> Result<ScenarioFile, Fail> {
        match self {
            Self::File(path) => ScenarioFile::read(path),
            Self::Text(text) => ScenarioFile::of_text(text),
        }
    }
}
