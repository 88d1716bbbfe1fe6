//! Terminal tables and JSON files, one module a command.

pub(crate) mod assess;
pub(crate) mod compare;
mod group;
pub(crate) mod inspect;
mod joint;
pub(crate) mod pose;
pub(crate) mod relax;
pub(crate) mod simulate;
pub(crate) mod sources;
pub(crate) mod torques;

use comfy_table::Table;

/// A table without lines.
pub(crate) fn plain_table() -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table
}
