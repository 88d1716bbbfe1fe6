//! Changes elements of an XML text; all other bytes stay as they are.

use std::ops::Range;

use nalgebra::Vector3;

use crate::xml::Node;

/// Changes of one text. Those of single elements must not overlap.
pub(super) struct Edits<'s> {
    source: &'s str,
    changes: Vec<(Range<usize>, String)>,
}

impl<'s> Edits<'s> {
    pub(super) fn new(source: &'s str) -> Self {
        Self { source, changes: vec![] }
    }

    /// Replaces the content of an element.
    pub(super) fn set(&mut self, node: Node<'_>, content: &str) {
        match node.content() {
            Some(range) => self.changes.push((range, content.to_owned())),
            None => self.fill(node, content),
        }
    }

    /// Sets child elements of an object that hold one value each; those that are missing are added.
    pub(super) fn set_properties(&mut self, object: Node<'_>, properties: &[(&str, String)]) {
        let mut missing = String::new();
        for (name, value) in properties {
            match object.child(name) {
                Some(child) => self.set(child, value),
                None => missing.push_str(&format!("<{name}>{value}</{name}>")),
            }
        }
        match object.content() {
            _ if missing.is_empty() => {}
            Some(content) => self.changes.push((content.start..content.start, missing)),
            None => self.fill(object, &missing),
        }
    }

    /// Puts text before and after an element.
    pub(super) fn wrap(&mut self, node: Node<'_>, before: &str, after: &str) {
        let range = node.whole();
        self.changes.push((range.start..range.start, before.to_owned()));
        self.changes.push((range.end..range.end, after.to_owned()));
    }

    /// Adds text at the end of an element's content.
    pub(super) fn append(&mut self, node: Node<'_>, text: &str) {
        match node.content() {
            Some(content) => self.changes.push((content.end..content.end, text.to_owned())),
            None => self.fill(node, text),
        }
    }

    pub(super) fn remove(&mut self, node: Node<'_>) {
        self.changes.push((node.whole(), String::new()));
    }

    /// Sets an attribute that is there.
    pub(super) fn set_attribute(&mut self, node: Node<'_>, name: &str, value: &str) {
        let start = node.whole().start;
        let tag = &self.source[start..node.content().map_or(node.whole().end, |content| content.start)];
        if let Some(old) = attribute(tag, name) {
            self.changes.push((start + old.start..start + old.end, format!("\"{}\"", escaped(value))));
        }
    }

    /// The text with all changes.
    pub(super) fn apply(mut self) -> String {
        self.changes.sort_by_key(|(range, _)| (range.start, range.end));
        let mut text = String::with_capacity(self.source.len() + self.source.len() / 8);
        let mut at = 0;
        for (range, new) in &self.changes {
            text.push_str(&self.source[at.min(range.start)..range.start]);
            text.push_str(new);
            at = range.end.max(at);
        }
        text.push_str(&self.source[at..]);
        text
    }

    /// Gives an element of a single tag a content.
    fn fill(&mut self, node: Node<'_>, content: &str) {
        let range = node.whole();
        let tag = self.source[range.clone()].trim_end_matches('>').trim_end_matches('/');
        let text = format!("{tag}>{content}</{}>", node.name());
        self.changes.push((range, text));
    }
}

/// Place of an attribute's value in a tag, quotes counted.
fn attribute(tag: &str, name: &str) -> Option<Range<usize>> {
    let mut at = tag.find(char::is_whitespace)?;
    loop {
        let equals = at + tag[at..].find('=')?;
        let open = equals + tag[equals..].find(['"', '\''])?;
        let quote = &tag[open..=open];
        let end = open + 1 + tag[open + 1..].find(quote)? + 1;
        if tag[at..equals].trim() == name {
            return Some(open..end);
        }
        at = end;
    }
}

/// The shortest text of a number that gives the same number again.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Three numbers.
pub(super) fn vector(value: Vector3<f64>) -> String {
    format!("{:?} {:?} {:?}", value.x, value.y, value.z)
}

/// Text for an attribute or an element.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::attribute;

    #[test]
    fn attributes_are_found_by_their_names() {
        let tag = "<Model type=\"gait\" note='name=\"a\" >'\n name = \"gait &amp; more\">";
        let value = |name| attribute(tag, name).map(|range| &tag[range]);
        assert_eq!(value("name"), Some("\"gait &amp; more\""));
        assert_eq!(value("note"), Some("'name=\"a\" >'"));
        assert_eq!((value("type"), value("gait")), (Some("\"gait\""), None));
    }
}
