//! Finds rows and cells of a table of text. Reading and errors share this, so a table need not remember places.

use std::ops::Range;

use crate::input_error::{InputError, Source};

/// Longest stretch of text (the line of an error and its neighbours) that is shown with a caret, bytes. Wide tables have
/// lines of kilobytes, in which a caret is hard to find: their errors give line and column in words.
const WIDEST_SHOWN: usize = 1200;

/// A table's text, divided into header and body.
#[derive(Clone, Debug)]
pub(super) struct Layout<'a> {
    name: &'a str,
    text: &'a str,
    header: Range<usize>,
    body: usize,
    /// OpenSim's form: cells are separated by tabs or spaces, not by commas.
    pub(super) storage: bool,
}

impl<'a> Layout<'a> {
    /// A line `endheader` decides: OpenSim's form, or commas.
    pub(super) fn new(name: &'a str, text: &'a str) -> Self {
        let start = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let mut at = start;
        for line in text[start..].split_inclusive('\n') {
            let header = start..at;
            at += line.len();
            if trimmed(line) == "endheader" {
                return Self { name, text, header, body: at, storage: true };
            }
        }
        Self { name, text, header: start..start, body: start, storage: false }
    }

    /// The file's name for messages.
    pub(super) fn name(&self) -> &'a str {
        self.name
    }

    /// Lines of the header that are not empty, without blanks around them.
    pub(super) fn header(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        lines(&self.text[self.header.clone()])
    }

    /// The labels' line and the rows, without empty lines and without blanks around them.
    pub(super) fn body(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        lines(&self.text[self.body..])
    }

    /// The labels of a line. OpenSim's may hold spaces where tabs separate them; those of CSV may stand in quotes.
    pub(super) fn labels(&self, line: &'a str) -> Box<dyn Iterator<Item = &'a str> + 'a> {
        if !self.storage {
            return Box::new(line.split(',').map(|cell| unquoted(trimmed(cell))));
        }
        if line.contains('\t') { Box::new(line.split('\t').map(trimmed)) } else { self.cells(line) }
    }

    /// The numbers of a line, as text.
    pub(super) fn cells(&self, line: &'a str) -> Box<dyn Iterator<Item = &'a str> + 'a> {
        if self.storage {
            Box::new(line.split([' ', '\t']).filter(|cell| !cell.is_empty()))
        } else {
            Box::new(line.split(',').map(trimmed))
        }
    }

    /// The label of a column and, if a row is asked for, its cell there.
    pub(super) fn find(&self, column: &str, row: Option<usize>) -> Option<&'a str> {
        let mut body = self.body();
        let (at, label) = self.labels(body.next()?).enumerate().find(|(_, label)| *label == column)?;
        match row {
            None => Some(label),
            Some(row) => self.cells(body.nth(row)?).nth(at),
        }
    }

    /// An error in a part of the text, or in the whole file.
    pub(super) fn error(
        &self,
        part: Option<&str>,
        message: String,
        label: impl Into<String>,
        help: impl Into<Option<String>>,
    ) -> InputError {
        let source = Source { name: self.name, text: self.text };
        let Some(span) = part.and_then(|part| self.span(part)) else {
            return Source { text: "", ..source }.error(None, format!("{}: {message}", self.name), label, help.into());
        };
        if self.shown(&span) <= WIDEST_SHOWN {
            return source.error(Some(span), message, label, help.into());
        }
        let before = &self.text[..span.start];
        let (above, left) = before.rsplit_once('\n').map_or((0, before), |(above, left)| (line_ends(above) + 1, left));
        let place = format!("{}:{}:{}", self.name, above + 1, left.chars().count() + 1);
        Source { text: "", ..source }.error(None, format!("{place}: {message}"), label, help.into())
    }

    /// Number of the line on which a part of the text begins.
    pub(super) fn line_number(&self, part: &str) -> Option<usize> {
        Some(line_ends(&self.text[..self.span(part)?.start]) + 1)
    }

    /// Bytes of a part of the text.
    fn span(&self, part: &str) -> Option<Range<usize>> {
        let start = (part.as_ptr() as usize).checked_sub(self.text.as_ptr() as usize)?;
        let span = start..start.checked_add(part.len())?;
        self.text.get(span.clone()).is_some().then_some(span)
    }

    /// Length of the lines of `span` with one more above and below, as an error shows them.
    fn shown(&self, span: &Range<usize>) -> usize {
        let (before, after) = (&self.text[..span.start], &self.text[span.end..]);
        let above = before.rsplitn(3, '\n').take(2).map(str::len).sum::<usize>();
        let below = after.splitn(3, '\n').take(2).map(str::len).sum::<usize>();
        above + span.len() + below
    }
}

/// Without blanks and line ends around it.
pub(super) fn trimmed(text: &str) -> &str {
    text.trim_matches([' ', '\t', '\r', '\n'])
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.split('\n').map(trimmed).filter(|line| !line.is_empty())
}

fn line_ends(text: &str) -> usize {
    text.bytes().filter(|byte| *byte == b'\n').count()
}

fn unquoted(label: &str) -> &str {
    label.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(label)
}
