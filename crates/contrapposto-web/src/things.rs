//! Puts things into a scenario file, and takes them away, by its tables.

use toml::{Table, Value};

use crate::error::Refusal;
use crate::message::ThingTable;

/// Words of things of which there may be several, and of those of which there is one.
const LISTS: [&str; 8] = ["box", "tool", "bag", "handle", "step", "table", "counter", "wall"];
const SINGLE: [&str; 2] = ["floor", "seat"];

/// All things of a file.
pub(crate) fn all(table: &Table) -> Vec<ThingTable> {
    let new = |word: &str, number, keys: &Table| ThingTable { word: word.to_owned(), number, keys: keys.clone() };
    let single = SINGLE.iter().filter_map(|word| table.get(*word)?.as_table().map(|keys| new(word, 0, keys)));
    let lists = LISTS.iter().flat_map(|word| {
        let list = table.get(*word).and_then(Value::as_array).into_iter().flatten();
        list.filter_map(Value::as_table).enumerate().map(move |(number, keys)| new(word, number, keys))
    });
    single.chain(lists).collect()
}

/// Adds a thing, or replaces the only one of its word.
pub(crate) fn put(table: &mut Table, word: &str, keys: Table) -> Result<(), Refusal> {
    if SINGLE.contains(&word) {
        table.insert(word.to_owned(), Value::Table(keys));
        return Ok(());
    }
    list(table, word)?.push(Value::Table(keys));
    Ok(())
}

/// Takes a thing away.
pub(crate) fn take_away(table: &mut Table, word: &str, number: usize) -> Result<(), Refusal> {
    let none = || Refusal(format!("there is no thing `{word}` number {}", number + 1));
    if word == "floor" {
        // Without what was said of them both feet stand on it, side by side.
        table.insert(word.to_owned(), Value::Table(Table::new()));
        return Ok(());
    }
    if SINGLE.contains(&word) {
        return table.remove(word).map(|_| ()).ok_or_else(none);
    }
    let things = list(table, word)?;
    if number >= things.len() {
        return Err(none());
    }
    things.remove(number);
    if things.is_empty() {
        table.remove(word);
    }
    Ok(())
}

/// Whether the body stays as it is where a thing is put: the thing asks for no place of it.
pub(crate) fn is_only_carried(word: &str, keys: &Table) -> bool {
    word == "bag" || (word == "tool" && !keys.contains_key("at_m"))
}

fn list<'a>(table: &'a mut Table, word: &str) -> Result<&'a mut Vec<Value>, Refusal> {
    if !LISTS.contains(&word) {
        let words = SINGLE.iter().chain(&LISTS).copied().collect::<Vec<_>>().join(", ");
        return Err(Refusal(format!("`{word}` is no thing; there are {words}")));
    }
    let things = table.entry(word).or_insert_with(|| Value::Array(vec![]));
    things.as_array_mut().ok_or_else(|| Refusal(format!("[[{word}]] is no list of tables")))
}
