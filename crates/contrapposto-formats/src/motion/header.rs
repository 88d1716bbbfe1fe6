//! Reads the header of an OpenSim table.

use super::MOST_NAME_BYTES;
use super::layout::{Layout, trimmed};
use crate::input_error::InputError;

/// The entries of the header that matter here.
#[derive(Debug, Default)]
pub(super) struct Header<'a> {
    pub(super) name: &'a str,
    pub(super) in_degrees: Option<bool>,
    /// Rows it promises, and where.
    pub(super) rows: Option<(usize, &'a str)>,
    /// Columns it promises, time counted, and where.
    pub(super) columns: Option<(usize, &'a str)>,
}

/// Reads OpenSim's header and the old one of SIMM, with the keys that OpenSim 4.6's `Storage` knows; other lines are
/// comments. OpenSim 4 writes no name line: its first line is already `key=value`.
pub(super) fn read<'a>(layout: &Layout<'a>) -> Result<Header<'a>, InputError> {
    let mut header = Header::default();
    let (mut words, mut simm, mut version) = (None, false, 0u64);
    for (i, line) in layout.header().enumerate() {
        let (key, rest) = line.split_at(line.find([' ', '\t', '=']).unwrap_or(line.len()));
        let rest = rest.trim_matches([' ', '\t', '=']);
        match key {
            "name" if !rest.is_empty() => header.name = rest,
            "nRows" | "datarows" => promise(layout, &mut header.rows, line, key, rest)?,
            "nColumns" => promise(layout, &mut header.columns, line, key, rest)?,
            "datacolumns" => {
                simm = true;
                promise(layout, &mut header.columns, line, key, rest)?;
            }
            // Short keys, which a comment may begin with too.
            "nr" if rest.parse::<usize>().is_ok() => promise(layout, &mut header.rows, line, key, rest)?,
            "nc" if rest.parse::<usize>().is_ok() => promise(layout, &mut header.columns, line, key, rest)?,
            "inDegrees" => degrees(layout, &mut header.in_degrees, line, rest)?,
            "Angles" if trimmed(line) == "Angles are in degrees." => words = Some(true),
            "Angles" if trimmed(line) == "Angles are in radians." => words = Some(false),
            "version" => version = rest.parse().unwrap_or(0),
            "DataType" if !rest.eq_ignore_ascii_case("double") => {
                let message = "the table does not hold plain numbers".to_owned();
                let help = "only DataType=double is read: one number a cell".to_owned();
                return Err(layout.error(Some(line), message, "this type", help));
            }
            _ if i == 0 && !line.contains('=') => header.name = line,
            _ => {}
        }
    }
    if header.name.len() > MOST_NAME_BYTES {
        let message = format!("the table's name has {} bytes", header.name.len());
        return Err(layout.error(Some(header.name), message, "here", format!("at most {MOST_NAME_BYTES}")));
    }
    // SIMM's own motions hold degrees; OpenSim 4.6 takes them so as well.
    header.in_degrees = header.in_degrees.or(words).or((simm && version == 0).then_some(true));
    Ok(header)
}

fn promise<'a>(
    layout: &Layout<'a>,
    promised: &mut Option<(usize, &'a str)>,
    line: &'a str,
    key: &str,
    rest: &str,
) -> Result<(), InputError> {
    let help = || format!("write `{key}=` and a whole number");
    let Ok(number) = rest.parse() else {
        return Err(layout.error(Some(line), format!("`{key}` is not a whole number"), "here", help()));
    };
    match promised {
        Some((earlier, _)) if *earlier != number => {
            let message = format!("the header says {key}={number} and, further up, {earlier}");
            Err(layout.error(Some(line), message, "here", "keep one of them".to_owned()))
        }
        _ => {
            *promised = Some((number, line));
            Ok(())
        }
    }
}

fn degrees(layout: &Layout<'_>, stated: &mut Option<bool>, line: &str, rest: &str) -> Result<(), InputError> {
    let value = match rest.to_ascii_lowercase().as_str() {
        "yes" | "y" => true,
        "no" | "n" => false,
        _ => {
            let message = "`inDegrees` is neither yes nor no".to_owned();
            return Err(layout.error(
                Some(line),
                message,
                "here",
                "write `inDegrees=yes` or `inDegrees=no`".to_owned(),
            ));
        }
    };
    if stated.is_some_and(|earlier| earlier != value) {
        let message = "the header says both inDegrees=yes and inDegrees=no".to_owned();
        return Err(layout.error(Some(line), message, "here", "keep one of them".to_owned()));
    }
    *stated = Some(value);
    Ok(())
}
