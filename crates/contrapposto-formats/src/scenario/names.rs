//! Finds coordinates and segments by their names in a file.

use contrapposto::model::Model;

use crate::input_error::{InputError, suggestion};
use crate::toml_file::Located;

/// The coordinate of this name; the error points at the key at the end of `path`.
pub(super) fn coordinate(at: &Located, model: &Model, path: &[&str], name: &str) -> Result<usize, InputError> {
    model.coordinate(name).ok_or_else(|| {
        let help = suggestion(name, model.coordinates().iter().map(|c| c.name.as_str()));
        at.key_error(path, format!("the body has no coordinate `{name}`"), help)
    })
}

/// The segment of this name; the error points at the value at `path`.
pub(super) fn segment(at: &Located, model: &Model, path: &[&str], name: &str) -> Result<usize, InputError> {
    model.segment(name).ok_or_else(|| {
        let help = suggestion(name, model.segments().iter().map(|s| s.name.as_str()));
        at.error(path, format!("the body has no segment `{name}`"), help)
    })
}
