//! Bytes of files that users name: regular files only, and never more than a stated size.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::fail::Fail;

/// Reads a regular file (or standard input for `-`) of `most` bytes at most.
pub(crate) fn read(path: &Path, most: u64) -> Result<Vec<u8>, Fail> {
    let shown = path.display();
    let refuse = |why: String| Fail::Refused(format!("{shown}: {why}"));
    let mut bytes = vec![];
    if path == Path::new("-") {
        read_at_most(std::io::stdin().lock(), most, &mut bytes).map_err(|error| refuse(error.to_string()))?;
    } else {
        let kind = std::fs::metadata(path).map_err(|error| refuse(error.to_string()))?;
        if !kind.is_file() {
            return Err(refuse("is not a regular file".into()));
        }
        if kind.len() <= most {
            let file = File::open(path).map_err(|error| refuse(error.to_string()))?;
            read_at_most(file, most, &mut bytes).map_err(|error| refuse(error.to_string()))?;
        } else {
            return Err(refuse(format!("is {} bytes long; {most} bytes at most are read", kind.len())));
        }
    }
    if bytes.len() as u64 > most {
        return Err(refuse(format!("is longer than {most} bytes, the most that is read")));
    }
    Ok(bytes)
}

fn read_at_most(from: impl Read, most: u64, bytes: &mut Vec<u8>) -> std::io::Result<usize> {
    from.take(most + 1).read_to_end(bytes)
}
