//! `contrapposto minimize`: one joint decision a line.

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;

use contrapposto::simulation::Tables;
use contrapposto_formats::{MOST_LINE_BYTES, escaped, minimize_line};
use serde::Serialize;

use crate::args::MinimizeArgs;
use crate::fail::Fail;
use crate::output::stdout_failed;

/// The answer to a bad line.
#[derive(Serialize)]
struct BadLine {
    error: String,
    line: u64,
}

pub(crate) fn minimize(args: &MinimizeArgs) -> Result<(), Fail> {
    let tables = if args.literal { Tables::Literal } else { Tables::Total };
    let mut input: Box<dyn BufRead> = match &args.file {
        None => Box::new(std::io::stdin().lock()),
        Some(path) if path == Path::new("-") => Box::new(std::io::stdin().lock()),
        Some(path) => {
            let refuse = |error: String| Fail::Refused(format!("{}: {error}", path.display()));
            let kind = std::fs::metadata(path).map_err(|error| refuse(error.to_string()))?;
            if kind.is_dir() {
                return Err(refuse("is a folder".into()));
            }
            Box::new(BufReader::new(File::open(path).map_err(|error| refuse(error.to_string()))?))
        }
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut all_good = true;
    let mut bytes = vec![];
    for line in 1.. {
        bytes.clear();
        let limit = MOST_LINE_BYTES as u64 + 1;
        let read = input.by_ref().take(limit).read_until(b'\n', &mut bytes);
        if read.map_err(|error| Fail::job("reading", error))? == 0 {
            break;
        }
        let too_long = bytes.len() > MOST_LINE_BYTES;
        if too_long && !bytes.ends_with(b"\n") {
            skip_line(&mut input)?;
        }
        let Ok(text) = std::str::from_utf8(&bytes) else {
            all_good = false;
            answer(&mut out, &BadLine { error: "the line is not UTF-8".into(), line })?;
            continue;
        };
        // Some editors begin a file with a byte order mark.
        let text = if line == 1 { text.strip_prefix('\u{feff}').unwrap_or(text) } else { text }.trim();
        if text.is_empty() {
            continue;
        }
        let decision = if too_long {
            Err(format!("the line is longer than {MOST_LINE_BYTES} bytes"))
        } else {
            minimize_line(text, tables)
        };
        match decision {
            Ok(decision) => answer(&mut out, &decision)?,
            Err(error) => {
                all_good = false;
                answer(&mut out, &BadLine { error, line })?;
            }
        }
    }
    out.flush().map_err(stdout_failed)?;
    if all_good { Ok(()) } else { Err(Fail::Told) }
}

fn answer(out: &mut impl Write, value: &impl Serialize) -> Result<(), Fail> {
    let text = serde_json::to_string(value).map_err(|error| Fail::job("JSON", error))?;
    // A name that a problem has, and should not, may have letters that a terminal obeys.
    writeln!(out, "{}", escaped(&text)).map_err(stdout_failed)
}

/// Reads past the rest of an overlong line without keeping it.
fn skip_line(input: &mut impl BufRead) -> Result<(), Fail> {
    loop {
        let buffer = input.fill_buf().map_err(|error| Fail::job("reading", error))?;
        let (used, done) = match buffer.iter().position(|&b| b == b'\n') {
            Some(end) => (end + 1, true),
            None => (buffer.len(), buffer.is_empty()),
        };
        input.consume(used);
        if done {
            return Ok(());
        }
    }
}
