//! Holds all states of the document of a session, for undo and redo, each with the posture in which it was left.

use contrapposto::posture::Posture;

use crate::document::Document;
use crate::error::Refusal;

/// Most changes that can be undone.
const MOST_CHANGES: usize = 200;

/// A document, and the posture that was shown when another state replaced it.
#[derive(Debug)]
struct State {
    document: Document,
    left: Option<Posture>,
}

/// All states of a document, the oldest first.
#[derive(Debug)]
pub(crate) struct History {
    opened: Document,
    states: Vec<State>,
    present: usize,
}

impl History {
    /// Of a document that was opened.
    pub(crate) fn new(document: Document) -> Self {
        Self { opened: document.clone(), states: vec![State { document, left: None }], present: 0 }
    }

    /// The document as it was opened.
    pub(crate) fn opened(&self) -> &Document {
        &self.opened
    }

    /// The present document.
    pub(crate) fn document(&self) -> &Document {
        &self.states[self.present].document
    }

    /// Whether there is a state before the present one, and one after it.
    pub(crate) fn can(&self) -> (bool, bool) {
        self.can_at(self.present)
    }

    /// The same of the state at a place.
    pub(crate) fn can_at(&self, at: usize) -> (bool, bool) {
        (at > 0, at + 1 < self.states.len())
    }

    /// Adds a state after the present one, which is left in a posture. States after it go.
    pub(crate) fn push(&mut self, document: Document, left: Posture) {
        self.states[self.present].left = Some(left);
        self.states.truncate(self.present + 1);
        self.states.push(State { document, left: None });
        let surplus = self.states.len().saturating_sub(MOST_CHANGES + 1);
        self.states.drain(..surplus);
        self.present = self.states.len() - 1;
    }

    /// The state before or after the present one: its place, its document, and the posture in which it was left.
    pub(crate) fn neighbour(&self, after: bool) -> Result<(usize, &Document, Option<&Posture>), Refusal> {
        let at = self.at(after)?;
        Ok((at, &self.states[at].document, self.states[at].left.as_ref()))
    }

    /// Goes to a state that [`History::neighbour`] gave. The present one is left in a posture.
    pub(crate) fn go_to(&mut self, at: usize, left: Posture) {
        self.states[self.present].left = Some(left);
        self.present = at;
    }

    fn at(&self, after: bool) -> Result<usize, Refusal> {
        let at = if after { Some(self.present + 1) } else { self.present.checked_sub(1) };
        let nothing = if after { "there is no change to redo" } else { "there is no change to undo" };
        at.filter(|at| *at < self.states.len()).ok_or_else(|| Refusal::of(nothing))
    }
}
