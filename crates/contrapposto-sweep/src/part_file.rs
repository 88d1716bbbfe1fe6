//! Writes the columns of a part as the bytes of a Parquet file, and reads the values of such a file back.
//!
//! One row group, plain values, no compression: what every reader of Parquet takes. Page, chunk and file are described by structures of
//! Thrift in its compact protocol. The bytes depend on the columns and the facts alone. Source: Apache Parquet, `parquet.thrift` and
//! `Encodings.md`; Apache Thrift, `thrift-compact-protocol.md`.

use super::thrift::{Structure, varint, varint_bytes};

/// The program that writes a part, with its version.
pub(crate) const PROGRAM: &str = concat!("contrapposto ", env!("CARGO_PKG_VERSION"));

/// First and last bytes of a file.
const MAGIC: &[u8] = b"PAR1";
/// Rows of a page: the length of a page has 31 bits, and a text of the file of a plan at most 1 MiB.
const ROWS_PER_PAGE: usize = 1000;
/// `Encoding` of values, and of the bits that say which rows have one.
const PLAIN: i64 = 0;
const RLE: i64 = 3;

/// A column; `None` is no value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Column {
    /// Whole numbers, each of which has a value.
    Whole(Vec<i64>),
    Number(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
    Truth(Vec<Option<bool>>),
}

/// The bytes of a file with these columns of equally many rows, and facts as its metadata.
pub(crate) fn write(columns: &[(String, Column)], facts: &[(String, String)]) -> Vec<u8> {
    let rows = columns.first().map_or(0, |(_, column)| column.len()) as i64;
    let mut bytes = MAGIC.to_vec();
    let chunks: Vec<Vec<u8>> = columns.iter().map(|(name, column)| column.write(name, &mut bytes)).collect();
    let size = (bytes.len() - MAGIC.len()) as i64;
    let group = Structure::new().structures(1, chunks).int64(2, size).int64(3, rows).end();
    let root = Structure::new().text(4, "part").int32(5, columns.len() as i64).end();
    let schema = std::iter::once(root).chain(columns.iter().map(|(name, column)| column.schema(name)));
    let fact = |(key, value): &(String, String)| Structure::new().text(1, key).text(2, value).end();
    let file = Structure::new().int32(1, 1).structures(2, schema.collect()).int64(3, rows).structures(4, vec![group]);
    let footer = file.structures(5, facts.iter().map(fact).collect()).text(6, PROGRAM).end();
    bytes.extend_from_slice(&footer);
    bytes.extend_from_slice(&(footer.len() as u32).to_le_bytes());
    bytes.extend_from_slice(MAGIC);
    bytes
}

/// The columns of a file that [`write`] made, each of the kind of its `pattern`, with so many rows; `None` of other bytes. The facts are
/// not read: where they matter the columns are written again and the bytes compared.
pub(crate) fn read(bytes: &[u8], patterns: &[(String, Column)], rows: usize) -> Option<Vec<Column>> {
    let mut rest = bytes.strip_prefix(MAGIC)?;
    patterns.iter().map(|(_, pattern)| pattern.read(&mut rest, rows)).collect()
}

impl Column {
    fn len(&self) -> usize {
        match self {
            Self::Whole(values) => values.len(),
            Self::Number(values) => values.len(),
            Self::Text(values) => values.len(),
            Self::Truth(values) => values.len(),
        }
    }

    /// The `Type` of its values.
    fn kind(&self) -> i64 {
        match self {
            Self::Truth(_) => 0,
            Self::Whole(_) => 2,
            Self::Number(_) => 5,
            Self::Text(_) => 6,
        }
    }

    /// Gives its `SchemaElement`: each row has a value (0), or may have none (1); a text is `UTF8` in the old words, `STRING` in the new ones.
    fn schema(&self, name: &str) -> Vec<u8> {
        let optional = i64::from(!matches!(self, Self::Whole(_)));
        let element = Structure::new().int32(1, self.kind()).int32(3, optional).text(4, name);
        match self {
            Self::Text(_) => {
                let string = Structure::new().structure(1, Structure::new().end()).end();
                element.int32(6, 0).structure(10, string).end()
            }
            _ => element.end(),
        }
    }

    /// Adds its pages to the file; gives its `ColumnChunk`.
    fn write(&self, name: &str, bytes: &mut Vec<u8>) -> Vec<u8> {
        let start = bytes.len();
        for first in (0..self.len()).step_by(ROWS_PER_PAGE) {
            let rows = ROWS_PER_PAGE.min(self.len() - first);
            let page = self.page(first, rows);
            bytes.extend_from_slice(&header(page.len(), rows));
            bytes.extend_from_slice(&page);
        }
        let (start, size) = (start as i64, (bytes.len() - start) as i64);
        let data = Structure::new().int32(1, self.kind()).int32s(2, &[PLAIN, RLE]).texts(3, &[name]).int32(4, 0);
        let data = data.int64(5, self.len() as i64).int64(6, size).int64(7, size).int64(9, start).end();
        Structure::new().int64(2, 0).structure(3, data).end()
    }

    /// Rows as the bytes of a page.
    fn page(&self, first: usize, rows: usize) -> Vec<u8> {
        match self {
            Self::Whole(values) => values[first..first + rows].iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Number(values) => optional(&values[first..first + rows], |values| {
                values.iter().flat_map(|value| value.to_le_bytes()).collect()
            }),
            Self::Text(values) => optional(&values[first..first + rows], |values| {
                let sized = |text: &&String| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
                values.iter().flat_map(sized).collect()
            }),
            Self::Truth(values) => optional(&values[first..first + rows], |values| {
                bits(&values.iter().map(|value| **value).collect::<Vec<_>>())
            }),
        }
    }

    /// The column of this kind at the beginning of `rest`, which is moved behind it.
    fn read(&self, rest: &mut &[u8], rows: usize) -> Option<Self> {
        let pages: Vec<(&[u8], usize)> = (0..rows)
            .step_by(ROWS_PER_PAGE)
            .map(|first| take_page(rest, ROWS_PER_PAGE.min(rows - first)))
            .collect::<Option<_>>()?;
        let pages = pages.into_iter();
        Some(match self {
            Self::Whole(_) => Self::Whole(joined(
                pages.map(|(mut page, rows)| (0..rows).map(|_| take(&mut page).map(i64::from_le_bytes)).collect()),
            )?),
            Self::Number(_) => Self::Number(joined(
                pages.map(|(page, rows)| read_optional(page, rows, |rest, _| take(rest).map(f64::from_le_bytes))),
            )?),
            Self::Text(_) => {
                Self::Text(joined(pages.map(|(page, rows)| read_optional(page, rows, |rest, _| take_text(rest))))?)
            }
            Self::Truth(_) => {
                Self::Truth(joined(pages.map(|(page, rows)| read_optional(page, rows, |bytes, i| bit(bytes, i))))?)
            }
        })
    }
}

/// `PageHeader` of a page of so many bytes and rows.
fn header(size: usize, rows: usize) -> Vec<u8> {
    let data = Structure::new().int32(1, rows as i64).int32(2, PLAIN).int32(3, RLE).int32(4, RLE).end();
    Structure::new().int32(1, 0).int32(2, size as i64).int32(3, size as i64).structure(5, data).end()
}

/// The page at the beginning of `rest`, which is moved behind it, and its rows.
fn take_page<'a>(rest: &mut &'a [u8], rows: usize) -> Option<(&'a [u8], usize)> {
    // The first field is 0, the second one is the size; both have a byte before them that says their number and kind.
    let size = usize::try_from(varint(rest.get(3..)?)? / 2).ok()?;
    let (page, after) = rest.strip_prefix(header(size, rows).as_slice())?.split_at_checked(size)?;
    *rest = after;
    Some((page, rows))
}

fn joined<T>(pages: impl Iterator<Item = Option<Vec<T>>>) -> Option<Vec<T>> {
    pages.collect::<Option<Vec<_>>>().map(|pages| pages.into_iter().flatten().collect())
}

/// A page of rows that may have no value: a run of one bit a row, with its length before it, then the values.
fn optional<T>(values: &[Option<T>], plain: impl Fn(&[&T]) -> Vec<u8>) -> Vec<u8> {
    let run = run(&values.iter().map(Option::is_some).collect::<Vec<_>>());
    let there: Vec<&T> = values.iter().flatten().collect();
    [&(run.len() as u32).to_le_bytes(), run.as_slice(), &plain(&there)].concat()
}

/// The rows of such a page; `value` takes the next value, which has that number, from its bytes.
fn read_optional<T>(
    page: &[u8],
    rows: usize,
    value: impl Fn(&mut &[u8], usize) -> Option<T>,
) -> Option<Vec<Option<T>>> {
    let mut rest = page;
    let size = u32::from_le_bytes(take(&mut rest)?) as usize;
    let (levels, mut rest) = rest.split_at_checked(size)?;
    let bits = levels.get(size.checked_sub(rows.div_ceil(8))?..)?;
    let mut number = 0..;
    let row =
        |row| bit(bits, row)?.then(|| value(&mut rest, number.next()?)).map_or(Some(None), |value| value.map(Some));
    (0..rows).map(row).collect()
}

/// Truths as one bit-packed run of the hybrid encoding.
fn run(truths: &[bool]) -> Vec<u8> {
    let mut bytes = varint_bytes((truths.len().div_ceil(8) as u64) << 1 | 1);
    bytes.extend(bits(truths));
    bytes
}

/// Truths as bits, the first one the lowest bit of the first byte.
fn bits(truths: &[bool]) -> Vec<u8> {
    let byte = |eight: &[bool]| eight.iter().rev().fold(0, |byte, truth| byte << 1 | u8::from(*truth));
    truths.chunks(8).map(byte).collect()
}

fn bit(bytes: &[u8], number: usize) -> Option<bool> {
    bytes.get(number / 8).map(|byte| byte >> (number % 8) & 1 == 1)
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*first)
}

fn take_text(rest: &mut &[u8]) -> Option<String> {
    let size = u32::from_le_bytes(take(rest)?) as usize;
    let (text, after) = rest.split_at_checked(size)?;
    *rest = after;
    String::from_utf8(text.to_vec()).ok()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::{Column, ROWS_PER_PAGE, read, write};

    /// Columns of so many rows, with odd numbers and texts, and rows without a value.
    fn columns(rows: usize) -> Vec<(String, Column)> {
        let numbers = [Some(0.1), None, Some(f64::MIN_POSITIVE), Some(-0.0), Some(-1e300)];
        let texts = [Some("a, \"b\"\n=1+1"), Some(""), None, Some("ü 🧍"), None, Some("PAR1")];
        let truths = [Some(true), None, Some(false), Some(true), Some(true), Some(true), None];
        [
            ("row", Column::Whole((7..).take(rows).collect())),
            ("load.0.mass_kg", Column::Number(numbers.into_iter().cycle().take(rows).collect())),
            ("who", Column::Text(texts.map(|text| text.map(str::to_owned)).into_iter().cycle().take(rows).collect())),
            ("cut", Column::Truth(truths.into_iter().cycle().take(rows).collect())),
            ("none", Column::Truth(vec![None; rows])),
        ]
        .map(|(name, column)| (name.to_owned(), column))
        .to_vec()
    }

    fn facts() -> Vec<(String, String)> {
        vec![("key".to_owned(), "12".to_owned())]
    }

    #[test]
    fn columns_come_back_as_they_were_written() {
        for rows in [0, 1, 7, 8, 9, ROWS_PER_PAGE, ROWS_PER_PAGE + 1, 2 * ROWS_PER_PAGE + 13] {
            let columns = columns(rows);
            let read = read(&write(&columns, &facts()), &self::columns(0), rows).unwrap();
            assert!(read.iter().eq(columns.iter().map(|(_, column)| column)), "{rows}");
        }
    }

    #[test]
    fn a_file_that_is_cut_off_is_none_and_no_change_of_a_bit_ends_in_a_panic() {
        let (rows, patterns) = (11, columns(0));
        let bytes = write(&columns(rows), &facts());
        let footer = u32::from_le_bytes(*bytes[..bytes.len() - 4].last_chunk().unwrap()) as usize;
        for place in 0..bytes.len() - 8 - footer {
            assert!(read(&bytes[..place], &patterns, rows).is_none(), "{place}");
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[place] ^= 1 << bit;
                let read = read(&changed, &patterns, rows);
                assert!(read.is_none_or(|columns| columns.iter().all(|column| column.len() == rows)));
            }
        }
        assert!(read(&bytes, &patterns, rows + 1).is_none() && read(&bytes, &patterns, rows - 1).is_none());
    }
}
