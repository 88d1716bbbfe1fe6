//! Names the files of a setup file in whose place those of the command line are read.

use std::path::Path;

use crate::xml::shorten;

/// A file that a setup file names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Element that names it: `model_file` or `marker_file`.
    pub element: &'static str,
    /// Name in the setup file.
    pub name: String,
}

impl NamedFile {
    /// The sentence that `setup` names another file than `given`; `None` where the names are the same, whatever their folders.
    pub fn note(&self, setup: &str, given: &Path) -> Option<String> {
        let name = self.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let same = given.file_name().is_some_and(|given| given.to_string_lossy() == name);
        let said = "is not used: model and markers are those of the command line";
        (!same).then(|| format!("{setup}: <{}> {} {said}", self.element, shorten(&self.name)))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::NamedFile;

    #[test]
    fn a_file_of_the_same_name_is_no_other_one() {
        let named = |name: &str| NamedFile { element: "model_file", name: name.to_owned() };
        for same in ["walk.osim", "../models/walk.osim", "..\\models\\walk.osim"] {
            assert_eq!(named(same).note("setup.xml", Path::new("here/walk.osim")), None, "{same}");
        }
        let other = named("../run.osim").note("setup.xml", Path::new("walk.osim"));
        let expected =
            "setup.xml: <model_file> ../run.osim is not used: model and markers are those of the command line";
        assert_eq!(other.as_deref(), Some(expected));
    }
}
