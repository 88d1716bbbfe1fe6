//! Checks format and title, which every scenario has.

use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::toml_file::Located;

/// Longest title, characters: the title stands above the pictures.
const LONGEST_TITLE: usize = 200;

/// Checks format and title.
pub(super) fn check_head(at: &Located, text: &ScenarioText) -> Result<(), InputError> {
    if text.format != 1 {
        let message = format!("format is {}; this program reads format 1", text.format);
        return Err(at.error(&["format"], message, None));
    }
    let length = text.title.chars().count();
    let message = if length > LONGEST_TITLE {
        format!("the title has {length} characters; {LONGEST_TITLE} at most")
    } else if text.title.chars().any(char::is_control) {
        "the title holds control characters (line breaks, escapes)".to_owned()
    } else {
        return Ok(());
    };
    Err(at.error(&["title"], message, Some("give it one short line".into())))
}
