//! Sets keys of a scenario file to other values, in its text, so that the reader of scenarios reads every run as if it had been written.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::plan::Value;
use crate::input_error::{InputError, utf8};
use crate::toml_file::parse_toml;

/// The text of a scenario with gaps for the values of its parameters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    pieces: Vec<Piece>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// The value of the parameter of this number.
    Value(usize),
}

/// A place of the text that a parameter changes.
struct Change {
    /// Bytes that are replaced; empty for an insertion.
    at: Range<usize>,
    before: String,
    parameter: usize,
    after: &'static str,
}

impl Template {
    /// The scenario with gaps for `keys`, paths of keys and of places in arrays: `model.adult.stature_m`, `load.0.mass_kg`. A key
    /// that the file does not have is added. `name` is the file's name for messages.
    ///
    /// # Errors
    /// [`InputError`] where the file is not TOML, and where a path leads through a value that is no table, or past the end of an array.
    pub fn new<'k>(name: &str, bytes: &[u8], keys: impl IntoIterator<Item = &'k str>) -> Result<Self, InputError> {
        let text = utf8(name, bytes)?;
        let (source, tree) = parse_toml(name, text)?;
        let mut changes = vec![];
        let mut tables: Vec<(String, Vec<(String, usize)>)> = vec![];
        for (parameter, key) in keys.into_iter().enumerate() {
            let path: Vec<&str> = key.split('.').collect();
            let place = find(text, tree.get_ref(), &path);
            let place = place.map_err(|(span, why)| source.error(Some(span), why, "here", None))?;
            match place {
                Place::Value(at) => changes.push(Change { at, before: String::new(), parameter, after: "" }),
                Place::Inline { after, empty, rest } => {
                    let before = format!(" {} = ", dotted(rest));
                    let at = after..after;
                    changes.push(Change { at, before, parameter, after: if empty { " " } else { "," } });
                }
                Place::Header { end, rest } => {
                    let line = text[end..].find('\n').map(|line| end + line + 1);
                    let before = format!("{}{} = ", if line.is_none() { "\n" } else { "" }, dotted(rest));
                    let at = line.unwrap_or(text.len());
                    changes.push(Change { at: at..at, before, parameter, after: "\n" });
                }
                Place::Root { key } => {
                    changes.push(Change { at: 0..0, before: format!("{} = ", dotted(&[key])), parameter, after: "\n" });
                }
                Place::NewTable { table, key } => {
                    let (table, line) = (dotted(table), (dotted(&[key]), parameter));
                    match tables.iter_mut().find(|(name, _)| *name == table) {
                        Some((_, lines)) => lines.push(line),
                        None => tables.push((table, vec![line])),
                    }
                }
            }
        }
        Ok(Self { pieces: pieces(text, changes, tables) })
    }

    /// The text with these values, one for each key.
    pub fn text(&self, values: &[Value]) -> String {
        let mut text = String::new();
        for piece in &self.pieces {
            match piece {
                Piece::Text(piece) => text += piece,
                Piece::Value(parameter) => text += &values.get(*parameter).map_or(String::new(), Value::to_string),
            }
        }
        text
    }
}

/// Place of a key, or the place at which a key can be added.
enum Place<'p> {
    /// The bytes of its value.
    Value(Range<usize>),
    /// After the brace that opens an inline table.
    Inline { after: usize, empty: bool, rest: &'p [&'p str] },
    /// Below the header of a table, which ends there.
    Header { end: usize, rest: &'p [&'p str] },
    /// At the top of the file.
    Root { key: &'p str },
    /// In a table that the file does not have.
    NewTable { table: &'p [&'p str], key: &'p str },
}

/// Walks down the file along a path. The error is the place and the reason.
fn find<'p>(text: &str, tree: &DeTable<'_>, path: &'p [&'p str]) -> Result<Place<'p>, (Range<usize>, String)> {
    let (Some((first, rest)), Some((key, table))) = (path.split_first(), path.split_last()) else {
        return Err((0..0, "a parameter has no path".to_owned()));
    };
    let Some(mut value) = tree.get(*first) else {
        return Ok(if table.is_empty() { Place::Root { key } } else { Place::NewTable { table, key } });
    };
    let whole = path.join(".");
    for (depth, step) in rest.iter().enumerate() {
        let next = match value.get_ref() {
            DeValue::Table(entries) => entries.get(*step),
            DeValue::Array(entries) => {
                // One way to write a place: neither `00` nor `+0`.
                let place = step.parse::<usize>().ok().filter(|place| place.to_string() == **step);
                let entry = place.and_then(|place| entries.get(place));
                let why = || format!("`{step}` of `{whole}`: there are {} entries, counted from 0", entries.len());
                Some(entry.ok_or_else(|| (value.span(), why()))?)
            }
            _ => return Err((value.span(), format!("`{whole}` leads through a value that is no table"))),
        };
        let Some(next) = next else {
            // An inline table spans its braces, a table with a header that header; one that only longer headers name spans a name.
            let (span, rest) = (value.span(), &rest[depth..]);
            let empty = value.get_ref().as_table().is_some_and(DeTable::is_empty);
            return Ok(match text.get(span.clone()).and_then(|text| text.chars().next()) {
                Some('{') => Place::Inline { after: span.start + 1, empty, rest },
                Some('[') => Place::Header { end: span.end, rest },
                _ => Place::NewTable { table, key },
            });
        };
        value = next;
    }
    match value.get_ref() {
        DeValue::Table(_) => Err((value.span(), format!("`{whole}` is a table, not a value"))),
        DeValue::Array(_) => Err((value.span(), format!("`{whole}` is an array; `{whole}.0` is its first entry"))),
        _ => Ok(Place::Value(value.span())),
    }
}

/// The text cut at its changes, with new tables at its end.
fn pieces(text: &str, mut changes: Vec<Change>, tables: Vec<(String, Vec<(String, usize)>)>) -> Vec<Piece> {
    // Stable: changes at one place keep the order of the parameters.
    changes.sort_by_key(|change| change.at.start);
    let mut pieces = vec![];
    let mut done = 0;
    for change in changes {
        // The plan's keys differ, and each has one way to be written, so that no value has two parameters.
        let start = change.at.start.max(done);
        pieces.push(Piece::Text(text[done..start].to_owned() + &change.before));
        pieces.push(Piece::Value(change.parameter));
        pieces.push(Piece::Text(change.after.to_owned()));
        done = change.at.end.max(start);
    }
    pieces.push(Piece::Text(text[done..].to_owned()));
    for (table, lines) in tables {
        pieces.push(Piece::Text(format!("\n[{table}]\n")));
        for (key, parameter) in lines {
            pieces.push(Piece::Text(format!("{key} = ")));
            pieces.push(Piece::Value(parameter));
            pieces.push(Piece::Text("\n".to_owned()));
        }
    }
    pieces
}

/// Keys as TOML writes them: `adult.lengths_m`, with quotes where a name needs them.
fn dotted(keys: &[&str]) -> String {
    let is_bare = |key: &str| key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    let written = keys.iter().map(|key| match is_bare(key) {
        true => (*key).to_owned(),
        false => serde_json::Value::String((*key).to_owned()).to_string(),
    });
    written.collect::<Vec<_>>().join(".")
}
