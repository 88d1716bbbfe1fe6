//! Parses bytes to the tree.

use std::borrow::Cow;

use super::error::{Malformed, XmlError};
use super::{Attribute, Document, Element, Limits, NONE, Position, Span, Text};
use crate::escaped;
use quick_xml::Reader;
use quick_xml::errors::{Error, IllFormedError};
use quick_xml::events::{BytesStart, Event};

/// Reads a file's bytes into a tree.
///
/// # Errors
/// [`XmlError`] with the place.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<Document, XmlError> {
    let cap = limits.file_bytes.min(NONE as usize - 1);
    if bytes.len() > cap {
        return Err(XmlError::FileTooLarge { bytes: bytes.len(), cap });
    }
    let source = match std::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text),
        Err(error) => {
            let valid = error.valid_up_to();
            let before = std::str::from_utf8(&bytes[..valid]).unwrap_or_default();
            let position = Cursor::new(before.strip_prefix('\u{feff}').unwrap_or(before)).end();
            return Err(XmlError::NotUtf8 { position, byte: bytes[valid] });
        }
    };
    if let Some(at) = source.bytes().position(|b| b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r')) {
        let position = Cursor::new(source).at(at);
        return Err(XmlError::Character { position, code: source.as_bytes()[at].into() });
    }
    Builder::new(source, limits).run()
}

/// Turns growing byte offsets into positions in one pass.
struct Cursor<'a> {
    source: &'a str,
    offset: usize,
    position: Position,
}

impl<'a> Cursor<'a> {
    fn new(source: &'a str) -> Self {
        Self { source, offset: 0, position: Position { line: 1, column: 1 } }
    }

    /// Position of `offset`, which must not lie before the last one asked for.
    fn at(&mut self, offset: usize) -> Position {
        let bytes = self.source.as_bytes();
        let end = offset.min(bytes.len());
        while self.offset < end {
            match bytes[self.offset] {
                b'\n' => self.position = Position { line: self.position.line + 1, column: 1 },
                0x80..0xC0 => {} // continues a character
                _ => self.position.column += 1,
            }
            self.offset += 1;
        }
        self.position
    }

    fn end(&mut self) -> Position {
        self.at(self.source.len())
    }
}

/// Bytes that were read.
fn offset(reader: &Reader<&[u8]>) -> usize {
    usize::try_from(reader.buffer_position()).unwrap_or(usize::MAX)
}

struct Builder<'a> {
    source: &'a str,
    limits: &'a Limits,
    cursor: Cursor<'a>,
    document: Document,
    open: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(source: &'a str, limits: &'a Limits) -> Self {
        let document = Document { pool: String::new(), elements: vec![], attributes: vec![], texts: vec![] };
        Self { source, limits, cursor: Cursor::new(source), document, open: vec![] }
    }

    fn run(mut self) -> Result<Document, XmlError> {
        let mut reader = Reader::from_str(self.source);
        loop {
            let start = offset(&reader);
            match reader.read_event() {
                Err(error) => {
                    let at = usize::try_from(reader.error_position()).unwrap_or(0);
                    return Err(self.grammar_error(&error, at));
                }
                Ok(Event::Start(tag)) => self.start_tag(&tag, (start, offset(&reader)), true)?,
                Ok(Event::Empty(tag)) => self.start_tag(&tag, (start, offset(&reader)), false)?,
                Ok(Event::End(_)) => {
                    if let Some(index) = self.open.pop() {
                        let element = &mut self.document.elements[index as usize];
                        element.content.end = start as u32;
                        element.whole.end = offset(&reader) as u32;
                    }
                }
                Ok(Event::Text(text)) => self.text(&text.xml10_content(), start)?,
                Ok(Event::CData(text)) => self.text(&text.xml10_content(), start)?,
                Ok(Event::GeneralRef(name)) => {
                    let c = resolve(&name).ok_or_else(|| self.entity(&name, start))?;
                    self.text(c.encode_utf8(&mut [0; 4]), start)?;
                }
                Ok(Event::Decl(declaration)) => {
                    if let Some(Ok(encoding)) = declaration.encoding()
                        && !matches!(encoding.to_ascii_lowercase().as_str(), "utf-8" | "utf8")
                        && !self.source.is_ascii()
                    {
                        let position = self.cursor.at(start);
                        return Err(XmlError::Encoding { position, encoding: shorten(&encoding) });
                    }
                }
                Ok(Event::DocType(_)) => return Err(XmlError::Doctype { position: self.cursor.at(start) }),
                Ok(Event::Comment(_) | Event::PI(_)) => {}
                Ok(Event::Eof) => break,
            }
        }
        if let Some(&index) = self.open.last() {
            let element = &self.document.elements[index as usize];
            let tag = self.document.slice(element.name).to_owned();
            return Err(XmlError::Unclosed { position: element.position, tag });
        }
        if self.document.elements.is_empty() {
            return Err(self.malformed(Malformed::Empty, self.source.len()));
        }
        Ok(self.document)
    }

    fn malformed(&mut self, what: Malformed, at: usize) -> XmlError {
        XmlError::Malformed { position: self.cursor.at(at), what }
    }

    fn entity(&mut self, name: &str, at: usize) -> XmlError {
        XmlError::Entity { position: self.cursor.at(at), entity: shorten(name) }
    }

    /// Translates the errors of the tokenizer, whose own texts name its own types.
    fn grammar_error(&mut self, error: &Error, at: usize) -> XmlError {
        let rest = self.source.get(at..).unwrap_or_default();
        if rest.get(..9).is_some_and(|s| s.eq_ignore_ascii_case("<!doctype")) {
            return XmlError::Doctype { position: self.cursor.at(at) };
        }
        match error {
            Error::IllFormed(IllFormedError::MismatchedEndTag { expected, found }) => XmlError::Mismatched {
                position: self.cursor.at(at),
                found: shorten(found),
                expected: shorten(expected),
            },
            Error::IllFormed(IllFormedError::UnmatchedEndTag(found)) => {
                XmlError::Mismatched { position: self.cursor.at(at), found: shorten(found), expected: String::new() }
            }
            Error::IllFormed(IllFormedError::UnclosedReference) => self.malformed(Malformed::Reference, at),
            Error::Syntax(_) => self.malformed(Malformed::CutOff, at),
            Error::InvalidAttr(_) => self.malformed(Malformed::Attribute, at),
            _ => self.malformed(Malformed::Other, at),
        }
    }

    fn push(&mut self, text: &str) -> Span {
        let start = self.document.pool.len() as u32;
        self.document.pool.push_str(text);
        Span { start, end: self.document.pool.len() as u32 }
    }

    fn name(&mut self, name: &str, at: usize) -> Result<Span, XmlError> {
        let cap = self.limits.name_bytes;
        if name.len() > cap {
            return Err(XmlError::NameTooLong { position: self.cursor.at(at), bytes: name.len(), cap });
        }
        let first = |c: char| c.is_ascii_alphabetic() || matches!(c, '_' | ':') || !c.is_ascii();
        let later = |c: char| first(c) || c.is_ascii_digit() || matches!(c, '-' | '.');
        if !name.starts_with(first) || !name.chars().all(later) {
            return Err(XmlError::Name { position: self.cursor.at(at), name: shorten(name) });
        }
        Ok(self.push(name))
    }

    fn start_tag(
        &mut self,
        tag: &BytesStart<'_>,
        (start, end): (usize, usize),
        stays_open: bool,
    ) -> Result<(), XmlError> {
        let position = self.cursor.at(start);
        let parent = self.open.last().copied();
        if parent.is_none() && !self.document.elements.is_empty() {
            return Err(self.malformed(Malformed::SecondRoot, start));
        }
        let written = tag.name().into_inner();
        let name = self.name(written, start)?;
        let depth = self.open.len() + 1;
        if depth > self.limits.depth {
            return Err(XmlError::TooDeep { position, tag: written.to_owned(), depth, cap: self.limits.depth });
        }
        if self.document.elements.len() >= self.limits.elements {
            let cap = self.limits.elements;
            return Err(XmlError::TooManyElements { position, tag: written.to_owned(), cap });
        }
        let attributes = self.attributes(tag, start + 1, position)?;
        let index = self.document.elements.len() as u32;
        self.document.elements.push(Element {
            name,
            attributes,
            position,
            whole: Span { start: start as u32, end: end as u32 },
            content: Span { start: end as u32, end: end as u32 },
            first_child: NONE,
            last_child: NONE,
            next_sibling: NONE,
            first_text: NONE,
            last_text: NONE,
        });
        if let Some(parent) = parent {
            let elements = &mut self.document.elements;
            match std::mem::replace(&mut elements[parent as usize].last_child, index) {
                NONE => elements[parent as usize].first_child = index,
                last => elements[last as usize].next_sibling = index,
            }
        }
        if stays_open {
            self.open.push(index);
        }
        Ok(())
    }

    /// Attributes of a tag whose content (after `<`) starts at `base`.
    fn attributes(&mut self, tag: &BytesStart<'_>, base: usize, position: Position) -> Result<(u32, u32), XmlError> {
        let first = self.document.attributes.len();
        let content: &str = tag;
        let mut attributes = tag.attributes();
        attributes.with_checks(false); // its check for duplicates is quadratic and comes before our cap
        for attribute in attributes {
            let Ok(attribute) = attribute else {
                return Err(XmlError::Malformed { position, what: Malformed::Attribute });
            };
            let offset = |part: &str| base + (part.as_ptr() as usize).saturating_sub(content.as_ptr() as usize);
            let key = attribute.key.into_inner();
            let at = offset(key);
            let cap = self.limits.attributes;
            if self.document.attributes.len() - first >= cap {
                return Err(XmlError::TooManyAttributes { position, tag: tag.name().into_inner().to_owned(), cap });
            }
            let name = self.name(key, at)?;
            let key_position = self.cursor.at(at);
            if self.document.attributes[first..].iter().any(|a| self.document.slice(a.name) == key) {
                return Err(XmlError::DuplicateAttribute {
                    position: key_position,
                    tag: tag.name().into_inner().to_owned(),
                    attribute: key.to_owned(),
                });
            }
            let value = self.value(&attribute.value, offset(&attribute.value))?;
            self.document.attributes.push(Attribute { name, value, position: key_position });
        }
        Ok((first as u32, self.document.attributes.len() as u32))
    }

    /// An attribute's value: references resolved, each line end or tab a space, as XML says, and what a terminal obeys [`escaped`].
    fn value(&mut self, raw: &str, base: usize) -> Result<Span, XmlError> {
        let start = self.document.pool.len() as u32;
        let mut rest = raw;
        while let Some(at) = rest.find(['&', '\t', '\n', '\r']) {
            self.document.pool.push_str(&rest[..at]);
            let here = base + (raw.len() - rest.len()) + at;
            let after = &rest[at..];
            if let Some(reference) = after.strip_prefix('&') {
                let end = reference.bytes().take(16).position(|b| b == b';');
                let Some(end) = end else {
                    let closed = reference.contains(';');
                    return Err(if closed {
                        self.entity(reference, here)
                    } else {
                        self.malformed(Malformed::Reference, here)
                    });
                };
                let name = &reference[..end];
                let resolved = resolve(name).ok_or_else(|| self.entity(name, here))?;
                self.document.pool.push(resolved);
                rest = &reference[end + 1..];
            } else {
                self.document.pool.push(' ');
                rest = after.strip_prefix("\r\n").unwrap_or(&after[1..]);
            }
        }
        self.document.pool.push_str(rest);
        // Names reach terminals, tables and pages.
        if let Cow::Owned(shown) = escaped(&self.document.pool[start as usize..]) {
            self.document.pool.truncate(start as usize);
            self.document.pool.push_str(&shown);
        }
        Ok(Span { start, end: self.document.pool.len() as u32 })
    }

    fn text(&mut self, text: &str, at: usize) -> Result<(), XmlError> {
        let blank = text.trim_ascii().is_empty();
        let Some(&owner) = self.open.last() else {
            return if blank { Ok(()) } else { Err(self.malformed(Malformed::StrayText, at)) };
        };
        let owner = owner as usize;
        if text.is_empty() || blank && self.document.elements[owner].first_text == NONE {
            return Ok(());
        }
        let span = self.push(text);
        let index = self.document.texts.len() as u32;
        self.document.texts.push(Text { span, next: NONE });
        match std::mem::replace(&mut self.document.elements[owner].last_text, index) {
            NONE => self.document.elements[owner].first_text = index,
            last => self.document.texts[last as usize].next = index,
        }
        Ok(())
    }
}

/// One of the five entities or a character reference, without `&` and `;`.
fn resolve(name: &str) -> Option<char> {
    let code = match name {
        "lt" => return Some('<'),
        "gt" => return Some('>'),
        "amp" => return Some('&'),
        "quot" => return Some('"'),
        "apos" => return Some('\''),
        _ => name.strip_prefix('#')?,
    };
    let digits = |s: &str, radix| s.chars().all(|c| c.is_digit(radix)).then(|| u32::from_str_radix(s, radix).ok())?;
    let code = match code.strip_prefix('x') {
        Some(hex) => digits(hex, 16)?,
        None => digits(code, 10)?,
    };
    char::from_u32(code).filter(|&c| c >= ' ' || matches!(c, '\t' | '\n' | '\r'))
}

/// At most 40 characters of foreign text for a message, control characters escaped.
pub(crate) fn shorten(text: &str) -> String {
    shorten_to(text, 40)
}

/// At most so many characters of text with foreign names for a message, control characters escaped.
pub(crate) fn shorten_to(text: &str, most: usize) -> String {
    let mut short: String = text
        .chars()
        .take(most)
        .flat_map(|c| if c.is_control() { c.escape_default().collect::<Vec<_>>() } else { vec![c] })
        .collect();
    if text.chars().nth(most).is_some() {
        short.push_str("...");
    }
    short
}
