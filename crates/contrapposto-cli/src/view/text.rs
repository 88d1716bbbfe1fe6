//! Terminal tables and JSON files, one module a command.

pub(crate) mod assess;
pub(crate) mod capacity;
pub(crate) mod compare;
mod cycles;
mod group;
pub(crate) mod inspect;
mod joint;
pub(crate) mod muscle;
pub(crate) mod muscle_hold;
pub(crate) mod muscles;
pub(crate) mod population;
pub(crate) mod pose;
pub(crate) mod reactions;
pub(crate) mod relax;
pub(crate) mod simulate;
pub(crate) mod sources;
pub(crate) mod torques;

use comfy_table::Table;
use serde::{Serialize, Serializer};

/// A table without lines.
pub(crate) fn plain_table() -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table
}

/// An object whose keys keep their order.
pub(crate) struct Named<'a, T>(pub(crate) Vec<(&'a str, T)>);

impl<T: Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}
