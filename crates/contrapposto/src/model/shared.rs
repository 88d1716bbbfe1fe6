//! Holds a model that is borrowed, or shared by count.

use std::ops::Deref;
use std::sync::Arc;

use super::Model;

/// The model of an engine: borrowed, or shared where the engine is to have no lifetime (in a language without any).
#[derive(Clone, Debug)]
pub enum SharedModel<'a> {
    /// A borrowed model, whose owner keeps it for as long.
    Borrowed(&'a Model),
    /// One of several owners.
    Counted(Arc<Model>),
}

impl Deref for SharedModel<'_> {
    type Target = Model;

    fn deref(&self) -> &Model {
        match self {
            Self::Borrowed(model) => model,
            Self::Counted(model) => model,
        }
    }
}

impl<'a> From<&'a Model> for SharedModel<'a> {
    fn from(model: &'a Model) -> Self {
        Self::Borrowed(model)
    }
}

impl From<Arc<Model>> for SharedModel<'_> {
    fn from(model: Arc<Model>) -> Self {
        Self::Counted(model)
    }
}
