//! Counts the elements of a file that are ignored, by kind.

use std::collections::BTreeMap;

/// Ignored elements: kind and count.
#[derive(Debug, Default)]
pub(crate) struct Ignored(BTreeMap<String, usize>);

impl Ignored {
    pub(crate) fn add(&mut self, kind: &str, count: usize) {
        if count > 0 {
            *self.0.entry(kind.to_owned()).or_default() += count;
        }
    }

    /// Kinds and counts, sorted by kind.
    pub(crate) fn into_list(self) -> Vec<(String, usize)> {
        self.0.into_iter().collect()
    }
}
