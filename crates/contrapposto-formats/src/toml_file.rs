//! Reads the TOML files of this project: known keys and finite numbers only; every error names its line and column.

use std::ops::Range;

use contrapposto::toml_value::{Misfit, typed};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::input_error::{InputError, Source, suggestion, utf8};

/// Reads a file and converts it. `convert` checks everything that the grammar and the keys leave open.
pub(crate) fn read_toml<T: serde::de::DeserializeOwned, R>(
    name: &str,
    bytes: &[u8],
    convert: impl FnOnce(&Located, &T) -> Result<R, InputError>,
) -> Result<R, InputError> {
    let text = utf8(name, bytes)?;
    let (source, tree) = parse_toml(name, text)?;
    let parsed: T = typed(tree.get_ref()).map_err(|error| reworded(&source, &error))?;
    convert(&Located { source, tree: tree.get_ref(), aliases: vec![] }, &parsed)
}

/// Most commas, equals signs and opening brackets of a file without other lines: every value has one, and needs up to 650 bytes of memory, 64 MiB at
/// most (a table of 20,000 points has 60,000).
const MOST_VALUES: usize = 62_000;
/// Lines that need as much memory as a value.
const LINES_FOR_A_VALUE: usize = 20;

/// The keys and values of a text, all numbers finite, and where they stand.
pub(crate) fn parse_toml<'a>(name: &'a str, text: &'a str) -> Result<(Source<'a>, Spanned<DeTable<'a>>), InputError> {
    let source = Source { name, text };
    let values = text.bytes().filter(|byte| b",=[".contains(byte)).count();
    let lines = text.bytes().filter(|byte| *byte == b'\n').count();
    let most = MOST_VALUES.saturating_sub(lines / LINES_FOR_A_VALUE);
    if values > most {
        let message = format!("the file has {values} commas, equals signs and opening brackets in {lines} lines");
        let help = Some(format!("in so many lines {most} at most are accepted: write fewer values"));
        return Err(source.error(placed(None), message, "here", help));
    }
    let tree = DeTable::parse(text).map_err(|error| not_toml(&source, &error))?;
    refuse_non_finite(&source, tree.get_ref())?;
    Ok((source, tree))
}

/// An error of the grammar; where the line has a decimal comma, the help says so.
fn not_toml(source: &Source, error: &toml::de::Error) -> InputError {
    let start = error.span().map_or(0, |span| span.start);
    let before = source.text.get(..start).and_then(|text| text.rfind('\n')).map_or(0, |at| at + 1);
    let line = source.text.get(before..).and_then(|text| text.lines().next()).unwrap_or_default();
    let help = decimal_comma(line).map(|number| format!("the decimal mark is a point: {number}"));
    source.error(placed(error.span()), format!("not TOML: {}", error.message()), "here", help)
}

/// The first value of a line that has a decimal comma, with a point: `1.75` for `stature_m = 1,75`.
fn decimal_comma(line: &str) -> Option<String> {
    let number = |value: &str| {
        let value = value.trim_start();
        let (whole, rest) = value.split_once(',')?;
        let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
        let written = whole.strip_prefix('-').unwrap_or(whole);
        let is_number = !written.is_empty() && written.chars().all(|c| c.is_ascii_digit()) && !digits.is_empty();
        is_number.then(|| format!("{whole}.{digits}"))
    };
    line.split('=').skip(1).find_map(number)
}

/// The place of an error; an error without one is placed at the beginning of the file, so that the file is named.
fn placed(span: Option<Range<usize>>) -> Option<Range<usize>> {
    span.or(Some(0..0))
}

/// A parsed file in which the place of a value is looked up by its path: keys and array indices.
pub(crate) struct Located<'a> {
    source: Source<'a>,
    tree: &'a DeTable<'a>,
    /// Entries of tables that the file does not write, and the tables of the file that they come from.
    aliases: Vec<Alias>,
}

/// An entry, by its table and number, and the path of the file's table that it comes from.
pub(crate) struct Alias {
    pub(crate) entry: (&'static str, String),
    pub(crate) from: Vec<String>,
}

impl<'a> Located<'a> {
    /// The same file, in which errors of entries that the file does not write are placed at the tables that they come from.
    pub(crate) fn with_aliases(&self, aliases: Vec<Alias>) -> Located<'a> {
        Located { source: self.source, tree: self.tree, aliases }
    }

    /// An error at the value at `path`, or at the innermost table of the path that exists.
    pub(crate) fn error(&self, path: &[&str], message: impl Into<String>, help: Option<String>) -> InputError {
        let (_, value) = self.find(path);
        self.source.error(placed(value.map(Spanned::span)), message, "here", help)
    }

    /// An error at the key at the end of `path`.
    pub(crate) fn key_error(&self, path: &[&str], message: impl Into<String>, help: Option<String>) -> InputError {
        let (key, value) = self.find(path);
        self.source.error(placed(key.or(value.map(Spanned::span))), message, "here", help)
    }

    /// Whether the file has a value at `path`.
    pub(crate) fn holds(&self, path: &[&str]) -> bool {
        self.find(path).0.is_some()
    }

    /// Whether the file has a table of this name with keys beside `keys`.
    pub(crate) fn holds_beside(&self, table: &str, keys: &[&str]) -> bool {
        let table = self.tree.get(table).and_then(|value| value.get_ref().as_table());
        table.is_some_and(|table| table.keys().any(|key| !keys.contains(&key.get_ref().as_ref())))
    }

    /// Keys and tables of the file's outermost level, in the order of the file.
    pub(crate) fn outermost(&self) -> Vec<&str> {
        let mut keys: Vec<(usize, &str)> =
            self.tree.keys().map(|key| (key.span().start, key.get_ref().as_ref())).collect();
        keys.sort_unstable();
        keys.into_iter().map(|(_, key)| key).collect()
    }

    /// Keys of the table at `path`, in the order of the file.
    pub(crate) fn keys(&self, path: &[&str]) -> Vec<&str> {
        let (Some(_), Some(value)) = self.find(path) else { return vec![] };
        let Some(table) = value.get_ref().as_table() else { return vec![] };
        let mut keys: Vec<(usize, &str)> = table.keys().map(|key| (key.span().start, key.get_ref().as_ref())).collect();
        keys.sort_unstable();
        keys.into_iter().map(|(_, key)| key).collect()
    }

    /// The span of the key at `path`, and its value. Where the path ends early: no key, and the innermost table.
    fn find(&self, path: &[&str]) -> (Option<Range<usize>>, Option<&Spanned<DeValue<'_>>>) {
        if let [table, number, ..] = path
            && let Some(alias) = self.aliases.iter().find(|alias| alias.entry.0 == *table && alias.entry.1 == *number)
        {
            let from: Vec<&str> = alias.from.iter().map(String::as_str).collect();
            return (None, self.find(&from).1);
        }
        let Some((first, rest)) = path.split_first() else { return (None, None) };
        let Some((name, mut value)) = self.tree.get_key_value(*first) else { return (None, None) };
        let mut key = name.span();
        for step in rest {
            let Some((next_key, next)) = entry(value, step) else { return (None, Some(value)) };
            (key, value) = (next_key, next);
        }
        (Some(key), Some(value))
    }
}

/// The span of a key and its value in a table, or of an array's entry by its index.
fn entry<'a>(value: &'a Spanned<DeValue<'a>>, key: &str) -> Option<(Range<usize>, &'a Spanned<DeValue<'a>>)> {
    match value.get_ref() {
        DeValue::Table(table) => table.get_key_value(key).map(|(key, value)| (key.span(), value)),
        DeValue::Array(array) => key.parse().ok().and_then(|i: usize| array.get(i)).map(|value| (value.span(), value)),
        _ => None,
    }
}

/// An error of the TOML reader in the words of the file formats, with a suggestion where the reader lists what it expected.
fn reworded(source: &Source, error: &Misfit) -> InputError {
    let message = error.message.as_str();
    let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let all_keys = || Some("`contrapposto schema` lists all keys".to_owned());
    let (message, help) = match words.split_first() {
        Some((given, expected)) if message.starts_with("unknown") => {
            let kind = if message.starts_with("unknown variant") { "value" } else { "key" };
            (format!("unknown {kind} `{given}`"), suggestion(given, expected.iter().copied()))
        }
        Some((key, _)) if message.starts_with("missing field") => (format!("the key `{key}` is missing"), all_keys()),
        _ if message.ends_with("untagged enum ReshapeText") => {
            let help = "write true, false, or { zone_deg = 5, end_torque_nm = 20 }".to_owned();
            ("not a way to reshape".to_owned(), Some(help))
        }
        _ if message.ends_with("untagged enum OnText") => {
            let help = Some("write \"floor\", \"ground\", or { normal = [x, y, z], point_m = [x, y, z] }".to_owned());
            ("neither the floor nor the ground nor a plane".to_owned(), help)
        }
        _ => {
            let plain =
                [("expected f64", "expected a number"), ("expected u32", "expected a whole number, not negative")];
            (plain.iter().fold(message.to_owned(), |text, (from, to)| text.replace(from, to)), None)
        }
    };
    source.error(placed(error.span.clone()), message, "here", help)
}

/// Refuses `nan` and `inf`, which TOML has and these files have not.
fn refuse_non_finite(source: &Source, table: &DeTable) -> Result<(), InputError> {
    let mut open: Vec<&Spanned<DeValue>> = table.values().collect();
    while let Some(value) = open.pop() {
        match value.get_ref() {
            DeValue::Table(table) => open.extend(table.values()),
            DeValue::Array(array) => open.extend(array.iter()),
            DeValue::Float(float) => check_finite(source, float.as_str(), value.span())?,
            _ => {}
        }
    }
    Ok(())
}

fn check_finite(source: &Source, written: &str, span: Range<usize>) -> Result<(), InputError> {
    if written.replace('_', "").parse::<f64>().is_ok_and(f64::is_finite) {
        return Ok(());
    }
    let message = format!("`{written:.40}` is not a finite number");
    Err(source.error(Some(span), message, "here", Some("write a finite number".into())))
}

/// Reads an array of exactly `N` numbers; the TOML reader itself passes over surplus ones.
pub(crate) fn numbers<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<[f64; N]>, D::Error> {
    let list = Vec::<f64>::deserialize(from)?;
    let given = list.len();
    list.try_into().map(Some).map_err(|_| D::Error::custom(format!("{given} numbers are given; {N} are due")))
}

/// As [`numbers`], for a key that is not left out.
pub(crate) fn exactly<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
    numbers(from)?.ok_or_else(|| D::Error::custom(format!("{N} numbers are due")))
}

/// Reads rows of exactly `N` numbers each.
pub(crate) fn rows<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<Vec<[f64; N]>>, D::Error> {
    let rows = Vec::<Vec<f64>>::deserialize(from)?;
    let row = |row: Vec<f64>| {
        let given = row.len();
        row.try_into().map_err(|_| D::Error::custom(format!("a row of {given} numbers; {N} are due in each")))
    };
    rows.into_iter().map(row).collect::<Result<_, _>>().map(Some)
}

/// A number for a message: with an exponent where it would need many digits.
pub(crate) fn shown(x: f64) -> String {
    if x != 0.0 && !(1e-6..1e9).contains(&x.abs()) { format!("{x:e}") } else { x.to_string() }
}
