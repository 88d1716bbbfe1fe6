//! Reads XML of unknown origin as a small tree: bounded, linear in time, and dropped without recursion.
//!
//! No namespaces, no DOCTYPE, no entities but the five of XML and character references. Elements lie in one arena, their
//! names, values and text in one string.

mod error;
mod parse;

pub use error::{Malformed, XmlError};
pub use parse::parse;
pub(crate) use parse::{shorten, shorten_to};

/// Largest sizes that a reader accepts. One struct for the model formats; each cap is tested at its value and one above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file.
    pub file_bytes: usize,
    /// Elements inside each other; the root counts as one.
    pub depth: usize,
    /// Elements of one file.
    pub elements: usize,
    /// Attributes of one element.
    pub attributes: usize,
    /// Bytes of an element's or attribute's name.
    pub name_bytes: usize,
    /// Numbers in one list that is read.
    pub numbers: usize,
    /// Coordinates of one body.
    pub coordinates: usize,
    /// Included files, and how deep they include each other.
    pub includes: usize,
    /// Depth of includes: 1 is a file included by the main file.
    pub include_depth: usize,
}

/// Bytes of a name that readers take and writers give, at most.
pub(crate) const NAME_BYTES: usize = 256;

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 16 << 20,
            depth: 64,
            elements: 200_000,
            attributes: 64,
            name_bytes: NAME_BYTES,
            numbers: 4096,
            coordinates: 512,
            includes: 16,
            include_depth: 4,
        }
    }
}

/// A place in a text, as editors count: both from 1, columns in characters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl std::fmt::Display for Position {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// Place of an element or attribute in a model file, for messages: `<joint range> at line 3, column 9`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Included file, as the include names it; empty for the file itself.
    pub file: Box<str>,
    /// Of the attribute if there is one, of the element otherwise.
    pub position: Position,
    /// Element name.
    pub tag: Box<str>,
    /// Attribute name; empty for the element or its text.
    pub attribute: Box<str>,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let gap = if self.attribute.is_empty() { "" } else { " " };
        write!(f, "<{}{gap}{}> at {}", self.tag, self.attribute, self.position)?;
        if self.file.is_empty() { Ok(()) } else { write!(f, " of `{}`", self.file) }
    }
}

/// A range of the text pool.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    start: u32,
    end: u32,
}

const NONE: u32 = u32::MAX;

#[derive(Clone, Debug)]
struct Element {
    name: Span,
    attributes: (u32, u32),
    position: Position,
    /// Bytes of the source: all of it with its tags, and the content between them.
    whole: Span,
    content: Span,
    first_child: u32,
    last_child: u32,
    next_sibling: u32,
    first_text: u32,
    last_text: u32,
}

#[derive(Clone, Debug)]
struct Attribute {
    name: Span,
    value: Span,
    position: Position,
}

#[derive(Clone, Debug)]
struct Text {
    span: Span,
    next: u32,
}

/// A parsed file.
#[derive(Clone, Debug)]
pub struct Document {
    pool: String,
    elements: Vec<Element>,
    attributes: Vec<Attribute>,
    texts: Vec<Text>,
}

impl Document {
    /// The outermost element.
    #[must_use]
    pub fn root(&self) -> Node<'_> {
        Node { document: self, index: 0 }
    }

    /// Number of elements of the file.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.elements.len()
    }

    /// All elements in the file's order.
    pub fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.elements.len() as u32).map(|index| Node { document: self, index })
    }

    fn slice(&self, span: Span) -> &str {
        &self.pool[span.start as usize..span.end as usize]
    }
}

/// One element.
#[derive(Clone, Copy)]
pub struct Node<'a> {
    document: &'a Document,
    index: u32,
}

impl std::fmt::Debug for Node<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "<{}> at {}", self.name(), self.position())
    }
}

impl PartialEq for Node<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.document, other.document) && self.index == other.index
    }
}

impl<'a> Node<'a> {
    fn element(self) -> &'a Element {
        &self.document.elements[self.index as usize]
    }

    /// Tag name, prefix included.
    #[must_use]
    pub fn name(self) -> &'a str {
        self.document.slice(self.element().name)
    }

    /// Position of the `<` of the start tag.
    #[must_use]
    pub fn position(self) -> Position {
        self.element().position
    }

    /// A number that is the element's alone in its document, growing in document order.
    #[must_use]
    pub fn index(self) -> usize {
        self.index as usize
    }

    /// Bytes of the source, without a byte order mark, from the start tag to the end tag.
    #[must_use]
    pub fn whole(self) -> std::ops::Range<usize> {
        range(self.element().whole)
    }

    /// Bytes of the source between the tags; `None` for an element of a single tag.
    #[must_use]
    pub fn content(self) -> Option<std::ops::Range<usize>> {
        let (whole, content) = (range(self.element().whole), range(self.element().content));
        (content.end < whole.end).then_some(content)
    }

    /// Value of an attribute, references resolved.
    #[must_use]
    pub fn attribute(self, name: &str) -> Option<&'a str> {
        self.find(name).map(|a| self.document.slice(a.value))
    }

    /// Position of the attribute's name.
    #[must_use]
    pub fn attribute_position(self, name: &str) -> Option<Position> {
        self.find(name).map(|a| a.position)
    }

    /// Names and values in the file's order.
    pub fn attributes(self) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
        self.attribute_slice().iter().map(move |a| (self.document.slice(a.name), self.document.slice(a.value)))
    }

    /// Child elements in the file's order.
    pub fn children(self) -> impl Iterator<Item = Node<'a>> + use<'a> {
        let document = self.document;
        let node = move |index: u32| (index != NONE).then_some(Node { document, index });
        std::iter::successors(node(self.element().first_child), move |n| node(n.element().next_sibling))
    }

    /// Child elements of one name.
    pub fn children_named<'n>(self, name: &'n str) -> impl Iterator<Item = Node<'a>> + use<'a, 'n> {
        self.children().filter(move |n| n.name() == name)
    }

    /// The first child of that name.
    #[must_use]
    pub fn child(self, name: &str) -> Option<Node<'a>> {
        self.children().find(|n| n.name() == name)
    }

    /// Own text, pieces between children joined, trimmed.
    #[must_use]
    pub fn text(self) -> String {
        let mut joined = String::new();
        let mut next = self.element().first_text;
        while let Some(text) = self.document.texts.get(next as usize) {
            joined.push_str(self.document.slice(text.span));
            next = text.next;
        }
        joined.trim().to_owned()
    }

    /// The element as a place for messages.
    #[must_use]
    pub fn place(self) -> Place {
        Place { file: "".into(), position: self.position(), tag: self.name().into(), attribute: "".into() }
    }

    /// An attribute as a place for messages; the element's position if the attribute is missing.
    #[must_use]
    pub fn attribute_place(self, name: &str) -> Place {
        let position = self.attribute_position(name).unwrap_or(self.position());
        Place { position, attribute: name.into(), ..self.place() }
    }

    fn attribute_slice(self) -> &'a [Attribute] {
        let (start, end) = self.element().attributes;
        &self.document.attributes[start as usize..end as usize]
    }

    fn find(self, name: &str) -> Option<&'a Attribute> {
        self.attribute_slice().iter().find(|a| self.document.slice(a.name) == name)
    }
}

fn range(span: Span) -> std::ops::Range<usize> {
    span.start as usize..span.end as usize
}
