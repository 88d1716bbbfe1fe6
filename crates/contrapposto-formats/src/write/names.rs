//! Makes names that a format accepts, each once.

use std::collections::BTreeSet;

use crate::xml::NAME_BYTES;

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
        (1..=NAME_BYTES).contains(&name.len()) && name.chars().all(self.accepts)
    }

    /// The name, or the nearest one that is accepted, free and of [`NAME_BYTES`] at most.
    pub(crate) fn take(&mut self, name: &str) -> String {
        let accepted: String = name.chars().map(|c| if (self.accepts)(c) { c } else { '_' }).collect();
        let mut made = ending_in(if accepted.is_empty() { "_" } else { &accepted }, "");
        if self.taken.contains(&made) {
            // Numbers are few: each name in use makes one of them unfit.
            made = (2..=self.taken.len() + 2)
                .map(|n| ending_in(&made, &format!("_{n}")))
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

/// The name with an ending, shortened before the ending to [`NAME_BYTES`] at most.
fn ending_in(name: &str, ending: &str) -> String {
    name[..name.floor_char_boundary(NAME_BYTES - ending.len())].to_owned() + ending
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_as_many_bytes_as_readers_take_and_differ() {
        let mut names = Names::new(&[], |_| true);
        let long = "é".repeat(NAME_BYTES);
        let made: Vec<_> = (0..12).map(|_| names.take(&long)).collect();
        assert_eq!(made[0], "é".repeat(NAME_BYTES / 2));
        assert!(made.iter().all(|name| name.len() <= NAME_BYTES), "{made:?}");
        assert_eq!(made.iter().collect::<BTreeSet<_>>().len(), made.len(), "{made:?}");
        assert!(made[11].ends_with("é_12") && !names.fits(&long) && names.fits(&made[11]));
    }
}
