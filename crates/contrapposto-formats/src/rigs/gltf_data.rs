//! Reads the container, the buffers and the numbers of glTF 2.0 files (Khronos Group, glTF 2.0 Specification, sections 3.6 and 4.4).

use std::borrow::Cow;

use super::json::Json;
use crate::motion::MOST_NUMBERS;
use crate::xml::shorten;

/// First bytes of a binary file.
const MAGIC: &[u8; 4] = b"glTF";
/// Kinds of chunks.
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";
/// Numbers of keys that a file may have beside one for each of its bytes: keys may share the bytes of an accessor (assumed).
const MORE_NUMBERS_OF_KEYS: usize = 1_000_000;

/// The reason for which a glTF file is no animation that can be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {at}: {message}; {accepted}")]
pub struct GltfError {
    pub(super) file: String,
    /// Place in the JSON of the file, such as `/nodes/3`.
    pub(super) at: String,
    pub(super) message: String,
    pub(super) accepted: String,
}

impl GltfError {
    pub(super) fn at(at: impl Into<String>, message: impl Into<String>, accepted: impl Into<String>) -> Self {
        Self { file: String::new(), at: at.into(), message: message.into(), accepted: accepted.into() }
    }
}

/// A file with its buffers.
pub(super) struct Document<'a> {
    pub(super) json: Json,
    /// Most numbers of all keys.
    pub(super) most_numbers: usize,
    buffers: Vec<Cow<'a, [u8]>>,
}

/// Numbers of 32 bits in a row.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word) as usize)
}

impl<'a> Document<'a> {
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, GltfError> {
        let (text, binary) = if bytes.starts_with(MAGIC) { chunks(bytes)? } else { (bytes, None) };
        let json: Json = serde_json::from_slice(text)
            .map_err(|error| GltfError::at("JSON", error.to_string(), "a glTF 2.0 file is accepted (.glb, .gltf)"))?;
        let version = json["asset"]["version"].as_str().unwrap_or_default();
        if version.split('.').next() != Some("2") {
            let message = format!("the version is `{}`", shorten(version));
            return Err(GltfError::at("/asset/version", message, "glTF 2.0 is accepted"));
        }
        let list = json["buffers"].as_list().unwrap_or_default();
        let buffer = |(index, buffer): (usize, &Json)| match buffer["uri"].as_str() {
            None => Ok(Cow::Borrowed(binary.filter(|_| index == 0).unwrap_or_default())),
            Some(uri) => embedded(uri).map(Cow::Owned).ok_or_else(|| {
                let message = format!("the buffer is in another file (`{}`)", shorten(uri));
                GltfError::at(
                    format!("/buffers/{index}"),
                    message,
                    "a .glb, or buffers in base64, are accepted: export as one file",
                )
            }),
        };
        let buffers = list.iter().enumerate().map(buffer).collect::<Result<_, _>>()?;
        let most_numbers = bytes.len().saturating_add(MORE_NUMBERS_OF_KEYS).min(MOST_NUMBERS);
        Ok(Self { json, most_numbers, buffers })
    }

    /// A list of the file; empty where there is none.
    pub(super) fn list(&self, name: &str) -> &[Json] {
        self.json[name].as_list().unwrap_or_default()
    }

    /// Numbers of an accessor with `width` of them an element; `at` is the place that names it.
    pub(super) fn numbers(&self, accessor: &Json, width: usize, at: &str) -> Result<Vec<f64>, GltfError> {
        let broken =
            |message: &str| GltfError::at(at, message, "an accessor whose numbers lie in its buffer is accepted");
        let index = accessor.as_u64().ok_or_else(|| broken("names no accessor"))? as usize;
        let accessor =
            self.list("accessors").get(index).ok_or_else(|| broken("names an accessor that is not there"))?;
        if !accessor["sparse"].is_null() {
            return Err(broken("the accessor is sparse"));
        }
        let width_of = [("SCALAR", 1), ("VEC3", 3), ("VEC4", 4)];
        let kind = accessor["type"].as_str().unwrap_or_default();
        if !width_of.contains(&(kind, width)) {
            return Err(broken(&format!("the accessor is of type `{}`, {width} numbers are needed", shorten(kind))));
        }
        let number = |value: &Json| value.as_u64().unwrap_or(0) as usize;
        let (count, component) = (number(&accessor["count"]), accessor["componentType"].as_u64().unwrap_or(0));
        let view = self.list("bufferViews").get(number(&accessor["bufferView"]));
        let view = view.filter(|_| !accessor["bufferView"].is_null()).ok_or_else(|| broken("has no buffer"))?;
        let size = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5126 => 4,
            _ => return Err(broken(&format!("the accessor has components of type {component}"))),
        };
        if count.saturating_mul(width) > self.most_numbers {
            return Err(broken(&format!("more than {} numbers", self.most_numbers)));
        }
        let buffer = self.buffers.get(number(&view["buffer"])).ok_or_else(|| broken("has no buffer"))?;
        let stride = if view["byteStride"].is_null() { size * width } else { number(&view["byteStride"]) };
        let start = number(&view["byteOffset"]).saturating_add(number(&accessor["byteOffset"]));
        let mut numbers = Vec::with_capacity(count.saturating_mul(width).min(buffer.len()));
        for element in 0..count {
            let first = start.saturating_add(element.saturating_mul(stride));
            let bytes = buffer.get(first..first.saturating_add(size * width));
            let bytes =
                bytes.ok_or_else(|| broken("its numbers lie beyond the end of the buffer; was the file cut off?"))?;
            numbers.extend(bytes.chunks_exact(size).map(|bytes| component_value(bytes, component)));
        }
        if numbers.iter().all(|number| number.abs() <= contrapposto::model::LARGEST) {
            Ok(numbers)
        } else {
            Err(broken("holds numbers that are none or too large"))
        }
    }
}

/// The value of a component; integers are normalised.
fn component_value(bytes: &[u8], component: u64) -> f64 {
    match (component, bytes) {
        (5120, [a]) => (f64::from(*a as i8) / 127.0).max(-1.0),
        (5121, [a]) => f64::from(*a) / 255.0,
        (5122, [a, b]) => (f64::from(i16::from_le_bytes([*a, *b])) / 32767.0).max(-1.0),
        (5123, [a, b]) => f64::from(u16::from_le_bytes([*a, *b])) / 65535.0,
        (_, [a, b, c, d]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
        _ => f64::NAN,
    }
}

/// JSON and buffer of a binary file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), GltfError> {
    let (mut text, mut binary, mut at) = (None, None, 12);
    while let (Some(length), Some(kind)) = (word(bytes, at), bytes.get(at + 4..at + 8)) {
        let end = (at + 8).saturating_add(length);
        let Some(data) = bytes.get(at + 8..end) else { break };
        match kind {
            kind if kind == JSON && text.is_none() => text = Some(data),
            kind if kind == BIN && binary.is_none() => binary = Some(data),
            _ => {}
        }
        at = end;
    }
    let text = text.ok_or_else(|| {
        GltfError::at(
            "header",
            "the binary file holds no whole JSON chunk",
            "a .glb of glTF 2.0 is accepted; was it cut off?",
        )
    })?;
    Ok((text, binary))
}

/// The bytes of a `data:` address in base64; `None` of another address.
fn embedded(uri: &str) -> Option<Vec<u8>> {
    let text = uri.strip_prefix("data:")?.split_once(";base64,")?.1.trim_end_matches('=');
    let (mut bytes, mut bits, mut held) = (Vec::with_capacity(text.len() / 4 * 3), 0_u32, 0);
    for letter in text.bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::{component_value, embedded};

    /// The formulas of the specification (glTF 2.0, section 3.11, "Animations").
    #[test]
    fn integers_are_shares_of_their_greatest_value() {
        let near = |bytes: &[u8], component: u64, expected: f64| {
            let found = component_value(bytes, component);
            assert!((found - expected).abs() < 1e-15, "{component}: {found} is not {expected}");
        };
        near(&127_i8.to_le_bytes(), 5120, 1.0);
        near(&(-128_i8).to_le_bytes(), 5120, -1.0);
        near(&51_u8.to_le_bytes(), 5121, 0.2);
        near(&(-32_767_i16).to_le_bytes(), 5122, -1.0);
        near(&i16::MIN.to_le_bytes(), 5122, -1.0);
        near(&13_107_u16.to_le_bytes(), 5123, 0.2);
        near(&0.75_f32.to_le_bytes(), 5126, 0.75);
    }

    #[test]
    fn base64_is_read() {
        let text = |uri: &str| embedded(uri).and_then(|bytes| String::from_utf8(bytes).ok());
        // RFC 4648, section 10.
        for (code, plain) in
            [("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE=", "fooba"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(text(&format!("data:application/octet-stream;base64,{code}")).as_deref(), Some(plain));
        }
        assert_eq!(text("walk.bin"), None);
        assert_eq!(text("data:;base64,Z*"), None);
    }
}
