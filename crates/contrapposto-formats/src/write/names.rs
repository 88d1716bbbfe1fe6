//! Makes names that a format accepts, each once.

use std::collections::BTreeSet;

/// Names given so far.
pub(crate) struct Names {
    taken: BTreeSet<String>,
    accepts: fn(char) -> bool,
}

impl Names {
    /// `reserved` are never given.
    pub(crate) fn new(reserved: &[&str], accepts: fn(char) -> bool) -> Self {
        Self { taken: reserved.iter().map(|&name| name.to_owned()).collect(), accepts }
    }

    /// Whether the name can stand as it is, if it is free.
    pub(super) fn fits(&self, name: &str) -> bool {
        !name.is_empty() && name.chars().all(self.accepts)
    }

    /// The name, or the nearest one that is accepted and free.
    pub(crate) fn take(&mut self, name: &str) -> String {
        let mut made: String = name.chars().map(|c| if (self.accepts)(c) { c } else { '_' }).collect();
        if made.is_empty() {
            made.push('_');
        }
        if self.taken.contains(&made) {
            // Numbers are few: each name in use makes one of them unfit.
            made = (2..=self.taken.len() + 2)
                .map(|n| format!("{made}_{n}"))
                .find(|other| !self.taken.contains(other))
                .unwrap_or(made);
        }
        self.taken.insert(made.clone());
        made
    }

    /// [`Names::take`]; says so if the name had to change.
    pub(super) fn keep(&mut self, what: &str, name: &str, lost: &mut Vec<String>) -> String {
        let made = self.take(name);
        if made != name {
            lost.push(format!("The {what} {name:?} is named `{made}` in the file."));
        }
        made
    }
}
