//! Errors of XML texts.

use super::Position;

/// The reason for which a text is not accepted as XML.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum XmlError {
    /// The file is larger than accepted.
    #[error("the file has {bytes} bytes; at most {cap} are read")]
    FileTooLarge {
        /// Size of the file.
        bytes: usize,
        /// The cap.
        cap: usize,
    },
    /// A byte that does not belong to UTF-8.
    #[error("{position}: byte {byte:#04x} is not UTF-8; save the file as UTF-8")]
    NotUtf8 {
        /// Place in the text.
        position: Position,
        /// The first wrong byte.
        byte: u8,
    },
    /// The XML declaration names another encoding and the text is not plain ASCII.
    #[error("{position}: the file says its encoding is `{encoding}`; only UTF-8 is read")]
    Encoding {
        /// Of the declaration.
        position: Position,
        /// As declared.
        encoding: String,
    },
    /// A control character.
    #[error("{position}: character U+{code:04X} is not allowed in XML")]
    Character {
        /// Place in the text.
        position: Position,
        /// Code of the character.
        code: u32,
    },
    /// A DOCTYPE, with which a small file can grow without bound.
    #[error("{position}: <!DOCTYPE> is not accepted; delete it (nothing of it is needed)")]
    Doctype {
        /// Place in the text.
        position: Position,
    },
    /// An entity that is not `lt`, `gt`, `amp`, `quot`, `apos` or a character reference.
    #[error("{position}: `&{entity};` is unknown; accepted are &lt; &gt; &amp; &quot; &apos; and &#...;")]
    Entity {
        /// Place in the text.
        position: Position,
        /// Without `&` and `;`, shortened.
        entity: String,
    },
    /// Elements inside each other beyond the cap.
    #[error("{position}: <{tag}> lies {depth} elements deep; at most {cap} are read")]
    TooDeep {
        /// Of the first element too deep.
        position: Position,
        /// Name of the element.
        tag: String,
        /// Depth of the element.
        depth: usize,
        /// The cap.
        cap: usize,
    },
    /// More elements than the cap.
    #[error("{position}: <{tag}> is one element too many; at most {cap} are read")]
    TooManyElements {
        /// Of the first element too many.
        position: Position,
        /// Name of the element.
        tag: String,
        /// The cap.
        cap: usize,
    },
    /// More attributes on one element than the cap.
    #[error("{position}: <{tag}> has more than {cap} attributes")]
    TooManyAttributes {
        /// Of the element.
        position: Position,
        /// Name of the element.
        tag: String,
        /// The cap.
        cap: usize,
    },
    /// A name longer than the cap.
    #[error("{position}: a name of {bytes} bytes; at most {cap} are read")]
    NameTooLong {
        /// Place in the text.
        position: Position,
        /// Length of the name.
        bytes: usize,
        /// The cap.
        cap: usize,
    },
    /// A name that XML does not allow.
    #[error("{position}: `{name}` is not a name; a letter or `_`, then letters, digits, `_`, `-`, `.`, `:`")]
    Name {
        /// Place in the text.
        position: Position,
        /// As written, shortened.
        name: String,
    },
    /// An attribute twice on one element.
    #[error("{position}: <{tag}> has the attribute `{attribute}` twice")]
    DuplicateAttribute {
        /// Of the second one.
        position: Position,
        /// Element.
        tag: String,
        /// Attribute.
        attribute: String,
    },
    /// A start tag without its end.
    #[error("{position}: <{tag}> is never closed; `</{tag}>` is missing")]
    Unclosed {
        /// Of the start tag.
        position: Position,
        /// Name of the element.
        tag: String,
    },
    /// An end tag that does not belong to the open element.
    #[error("{position}: `</{found}>` {}", match expected.as_str() {
        "" => "closes nothing: no element is open here; remove it".to_owned(),
        expected => format!("where `</{expected}>` is needed"),
    })]
    Mismatched {
        /// Of the end tag.
        position: Position,
        /// As written, shortened.
        found: String,
        /// The tag that would close the open element; empty if none is open.
        expected: String,
    },
    /// Another breach of XML's grammar.
    #[error("{position}: {what}")]
    Malformed {
        /// Place in the text.
        position: Position,
        /// The breach.
        what: Malformed,
    },
}

/// A breach of XML's grammar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Malformed {
    /// No element at all.
    #[error("the file has no element")]
    Empty,
    /// A second outermost element.
    #[error("a second outermost element; one is allowed")]
    SecondRoot,
    /// Text outside the outermost element.
    #[error("text outside the outermost element")]
    StrayText,
    /// A tag, comment, CDATA section or instruction that the end of the file cuts off.
    #[error("begins here and never ends")]
    CutOff,
    /// An attribute that is not `name="value"`.
    #[error("attributes are written name=\"value\"")]
    Attribute,
    /// `&` without `;`.
    #[error("`&` starts a reference and `;` is missing; write &amp;")]
    Reference,
    /// Something else that the grammar does not know.
    #[error("not XML")]
    Other,
}
