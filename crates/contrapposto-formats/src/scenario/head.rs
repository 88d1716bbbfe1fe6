//! Checks format, title and the number of tables of a kind, which every scenario has.

use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::toml_file::Located;

/// Longest title, characters: the title stands above the pictures.
const LONGEST_TITLE: usize = 200;

/// Most tasks: the memory of the solver grows with their square.
const MOST_TASKS: usize = 80;
/// Most supports, loads, events, obstacles and things of a kind.
const MOST_TABLES: usize = 1000;

/// Checks format, title and counts.
pub(super) fn check_head(at: &Located, text: &ScenarioText) -> Result<(), InputError> {
    if text.format != 1 {
        let message = format!("format is {}; this program reads format 1", text.format);
        return Err(at.error(&["format"], message, None));
    }
    check_counts(at, text)?;
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

fn check_counts(at: &Located, text: &ScenarioText) -> Result<(), InputError> {
    let counts = [
        ("task", text.task.len(), MOST_TASKS),
        ("support", text.support.len(), MOST_TABLES),
        ("load", text.load.len(), MOST_TABLES),
        ("event", text.event.len(), MOST_TABLES),
        ("obstacle", text.obstacle.len(), MOST_TABLES),
    ];
    let most = counts.iter().find(|(_, count, most)| count > most);
    most.map_or(Ok(()), |(key, count, most)| {
        Err(at.error(&[key], format!("{count} tables [[{key}]]; {most} at most"), None))
    })
}
