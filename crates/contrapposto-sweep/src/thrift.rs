//! Writes structures of Thrift in its compact protocol, as many kinds of fields as the description of a Parquet file has.

/// Kinds of fields.
const INT32: u8 = 5;
const INT64: u8 = 6;
const TEXT: u8 = 8;
const LIST: u8 = 9;
const STRUCTURE: u8 = 12;

/// A structure under way. Fields follow with rising numbers, each at most 15 above the last one.
pub(crate) struct Structure {
    bytes: Vec<u8>,
    last: u8,
}

impl Structure {
    pub(crate) fn new() -> Self {
        Self { bytes: vec![], last: 0 }
    }

    pub(crate) fn int32(self, number: u8, value: i64) -> Self {
        self.field(number, INT32, &zigzag(value))
    }

    pub(crate) fn int64(self, number: u8, value: i64) -> Self {
        self.field(number, INT64, &zigzag(value))
    }

    pub(crate) fn text(self, number: u8, text: &str) -> Self {
        self.field(number, TEXT, &sized(text))
    }

    /// A structure that has ended.
    pub(crate) fn structure(self, number: u8, structure: Vec<u8>) -> Self {
        self.field(number, STRUCTURE, &structure)
    }

    pub(crate) fn int32s(self, number: u8, values: &[i64]) -> Self {
        self.list(number, INT32, values.iter().map(|value| zigzag(*value)).collect())
    }

    pub(crate) fn texts(self, number: u8, texts: &[&str]) -> Self {
        self.list(number, TEXT, texts.iter().map(|text| sized(text)).collect())
    }

    pub(crate) fn structures(self, number: u8, structures: Vec<Vec<u8>>) -> Self {
        self.list(number, STRUCTURE, structures)
    }

    /// The bytes of the whole structure.
    pub(crate) fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }

    fn list(self, number: u8, kind: u8, items: Vec<Vec<u8>>) -> Self {
        let size = match u8::try_from(items.len()) {
            Ok(few @ 0..=14) => vec![few << 4 | kind],
            _ => [vec![15 << 4 | kind], varint_bytes(items.len() as u64)].concat(),
        };
        self.field(number, LIST, &[size, items.concat()].concat())
    }

    fn field(mut self, number: u8, kind: u8, bytes: &[u8]) -> Self {
        self.bytes.push((number - self.last) << 4 | kind);
        self.bytes.extend_from_slice(bytes);
        self.last = number;
        self
    }
}

/// A text, its length before it.
fn sized(text: &str) -> Vec<u8> {
    [varint_bytes(text.len() as u64).as_slice(), text.as_bytes()].concat()
}

/// A whole number, so that small ones of both signs are short: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
fn zigzag(value: i64) -> Vec<u8> {
    varint_bytes((value << 1 ^ value >> 63) as u64)
}

/// Seven bits a byte, the lowest first; all bytes but the last one have the highest bit set.
pub(crate) fn varint_bytes(mut value: u64) -> Vec<u8> {
    let mut bytes = vec![];
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// The number at the beginning of `bytes`; `None` where they end before it, or it has more than 63 bits.
pub(crate) fn varint(bytes: &[u8]) -> Option<u64> {
    let end = bytes.iter().take(9).position(|byte| byte & 0x80 == 0)?;
    Some(bytes[..=end].iter().rev().fold(0, |value, byte| value << 7 | u64::from(byte & 0x7f)))
}

#[cfg(test)]
mod tests {
    use super::{varint, varint_bytes, zigzag};

    #[test]
    fn numbers_are_those_of_the_protocol() {
        // Examples of thrift-compact-protocol.md and of protocol buffers, which have the same numbers.
        assert_eq!(varint_bytes(300), [0xac, 0x02]);
        assert_eq!(varint_bytes(50399), [0xdf, 0x89, 0x03]);
        assert_eq!([0, -1, 1, -2, 2].map(|value| zigzag(value)[0]), [0, 1, 2, 3, 4]);
        for value in [0, 1, 127, 128, 16_383, 16_384, (1 << 62) + 12_345] {
            assert_eq!(varint(&varint_bytes(value)), Some(value));
        }
        assert_eq!(varint(&[0x80; 20]), None);
        assert_eq!(varint(&[]), None);
    }
}
