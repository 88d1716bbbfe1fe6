//! Reads the parameters of a C3D file: groups of named values.

use std::collections::HashMap;

use super::numbers::Processor;
use super::refusal::C3dError;

/// Bytes of a block.
pub(super) const BLOCK: usize = 512;
/// Most parameters and groups of a file (assumed: files of laboratories have some hundred).
const MOST_ENTRIES: usize = 10_000;

/// A value.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parameter<'a> {
    /// Bytes of a number; -1 for characters.
    kind: i8,
    /// The first dimension: characters of a text.
    length: usize,
    data: &'a [u8],
    /// Place of the data in the file.
    byte: usize,
}

/// All values, by `GROUP:NAME`.
pub(super) struct Parameters<'a> {
    pub(super) processor: Processor,
    /// Place of the parameters in the file.
    start: usize,
    values: HashMap<String, Parameter<'a>>,
}

impl<'a> Parameters<'a> {
    /// Reads the parameters that the header's first byte points to.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, C3dError> {
        let start = bytes.first().map_or(0, |block| usize::from(*block).saturating_sub(1) * BLOCK);
        let Some(&[_, _, _, processor]) = bytes.get(start..start + 4) else {
            let message = format!("the file ends before its parameters, which begin at byte {start}");
            return Err(C3dError::at(0, message, "was it cut off?"));
        };
        let processor = Processor::of(processor).ok_or_else(|| {
            let message = format!("the number of the processor is {processor}");
            C3dError::at(start + 3, message, "84 (Intel), 85 (DEC) and 86 (MIPS) are accepted")
        })?;
        let values = values(bytes, start + 4, processor)?;
        Ok(Self { processor, start, values })
    }

    /// Place of a value in the file, or of the parameters where it is missing.
    pub(super) fn byte(&self, name: &str) -> usize {
        self.values.get(name).map_or(self.start, |value| value.byte)
    }

    /// The first numbers of a value; those of 8 and 16 bits without a sign.
    pub(super) fn numbers<const COUNT: usize>(&self, name: &str) -> Option<[f64; COUNT]> {
        let value = self.values.get(name)?;
        let mut numbers = [0.0; COUNT];
        let size = usize::try_from(value.kind).ok().filter(|size| *size > 0)?;
        for (number, bytes) in numbers.iter_mut().zip(value.data.get(..COUNT * size)?.chunks_exact(size)) {
            *number = match *bytes {
                [a] => f64::from(a),
                [a, b] => f64::from(self.processor.word([a, b])),
                [a, b, c, d] => self.processor.float([a, b, c, d]),
                _ => return None,
            };
        }
        numbers.iter().all(|number| number.is_finite()).then_some(numbers)
    }

    /// Numbers of a value, `most` at most; those of 16 bits with a sign where `signed` is true.
    pub(super) fn list(&self, name: &str, signed: bool, most: usize) -> Option<Vec<f64>> {
        let value = self.values.get(name)?;
        let word = |bytes: [u8; 2]| match (self.processor.word(bytes), signed) {
            (word, true) => f64::from(word as i16),
            (word, false) => f64::from(word),
        };
        Some(match value.kind {
            1 => value.data.iter().take(most).map(|byte| f64::from(*byte)).collect(),
            2 => value.data.as_chunks().0.iter().take(most).map(|bytes| word(*bytes)).collect(),
            4 => value.data.as_chunks().0.iter().take(most).map(|bytes| self.processor.float(*bytes)).collect(),
            _ => return None,
        })
    }

    /// The first dimension of a value; 0 where it is missing.
    pub(super) fn first_dimension(&self, name: &str) -> usize {
        self.values.get(name).map_or(0, |value| value.length)
    }

    /// The first number of a value.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name).map(|[number]| number)
    }

    /// Texts, blanks at their ends taken away, `most` at most; `None` where the parameter is missing.
    pub(super) fn texts(&self, name: &str, most: usize) -> Option<Vec<String>> {
        let value = self.values.get(name).filter(|value| value.kind == -1)?;
        Some(value.data.chunks_exact(value.length.max(1)).take(most).map(text).collect())
    }
}

/// All values from a byte on. A section that breaks off ends there.
fn values(bytes: &[u8], mut at: usize, processor: Processor) -> Result<HashMap<String, Parameter<'_>>, C3dError> {
    let mut groups: HashMap<i8, String> = HashMap::new();
    let mut found: Vec<(i8, String, Parameter<'_>)> = vec![];
    // Every entry moves on by its own header at least: the loop ends with the file.
    for count in 0.. {
        let Some(&[length, id]) = bytes.get(at..at + 2) else { break };
        // Lengths of locked entries are negative.
        let length = usize::from((length as i8).unsigned_abs());
        let id = id as i8;
        let pointer = at + 2 + length;
        let (Some(name), Some(&[a, b])) = (bytes.get(at + 2..pointer), bytes.get(pointer..pointer + 2)) else { break };
        if length == 0 || id == 0 {
            break;
        }
        if count == MOST_ENTRIES {
            let message = format!("more than {MOST_ENTRIES} parameters");
            return Err(C3dError::at(at, message, "a smaller number is accepted"));
        }
        let name = text(name).to_ascii_uppercase();
        if id < 0 {
            groups.entry(id.saturating_neg()).or_insert(name);
        } else if let Some(parameter) = parameter(bytes, pointer + 2) {
            found.push((id, name, parameter));
        }
        let offset = usize::from(processor.word([a, b]));
        if offset < 2 {
            break;
        }
        at = pointer + offset;
    }
    let mut values = HashMap::new();
    for (id, name, parameter) in found {
        let group = groups.get(&id).map_or("", String::as_str);
        values.entry(format!("{group}:{name}")).or_insert(parameter);
    }
    Ok(values)
}

/// The parameter at a place; `None` where the file is cut off.
fn parameter(bytes: &[u8], at: usize) -> Option<Parameter<'_>> {
    let &[kind, count] = bytes.get(at..at + 2)? else { return None };
    let kind = kind as i8;
    let begin = at + 2 + usize::from(count);
    let dimensions = bytes.get(at + 2..begin)?;
    let numbers = dimensions.iter().try_fold(1usize, |product, &d| product.checked_mul(usize::from(d)))?;
    let size = numbers.checked_mul(usize::from(kind.unsigned_abs()))?;
    let data = bytes.get(begin..begin.checked_add(size)?)?;
    let length = dimensions.first().map_or(1, |length| usize::from(*length));
    Some(Parameter { kind, length, data, byte: begin })
}

/// Text of bytes: UTF-8, or else Latin 1.
fn text(bytes: &[u8]) -> String {
    let latin = |_| bytes.iter().map(|byte| char::from(*byte)).collect();
    let text = std::str::from_utf8(bytes).map_or_else(latin, str::to_owned);
    text.trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()
}
