//! Changes the events of a scenario file where the file begins later, ends sooner, or gets tasks before its own.

use toml::{Table, Value};

/// Tables whose things are loads, too: an event replaces their loads with all others, which no other table can say.
const THINGS: [&str; 4] = ["box", "tool", "bag", "handle"];
/// An event happens at a sample that is earlier by less, s.
const TOLERANCE: f64 = 1e-9;

/// The time of an event, s.
fn time(event: &Value) -> f64 {
    let at = event.get("at_s");
    at.and_then(|at| at.as_float().or(at.as_integer().map(|at| at as f64))).unwrap_or_default()
}

fn events(table: &Table) -> Vec<Value> {
    table.get("event").and_then(Value::as_array).cloned().unwrap_or_default()
}

fn put(table: &mut Table, events: Vec<Value>) {
    if events.is_empty() {
        table.remove("event");
    } else {
        table.insert("event".to_owned(), Value::Array(events));
    }
}

/// Counts so many tasks before those of the file: the tasks that events name.
pub(crate) fn count_on(table: &mut Table, before: usize) {
    let Some(Value::Array(events)) = table.get_mut("event") else { return };
    for event in events {
        if let Some(Value::Integer(task)) = event.get_mut("task")
            && *task >= 1
        {
            *task += before as i64;
        }
    }
}

/// Leaves out events later than `end`, s.
pub(crate) fn end_at(table: &mut Table, end: f64) {
    let mut events = events(table);
    events.retain(|event| time(event) <= end + TOLERANCE);
    put(table, events);
}

/// Moves the start to `begin`, s: what events have changed by then becomes part of the tables, and later events come as much sooner.
/// Strategies are left to the caller, who knows those of all coordinates.
pub(crate) fn begin_at(table: &mut Table, begin: f64) {
    let mut events = events(table);
    events.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let things = THINGS.iter().any(|thing| table.contains_key(*thing));
    let (mut left, mut put_down) = (vec![], None);
    for mut event in events {
        let later = time(&event) - begin;
        let Value::Table(keys) = &mut event else { continue };
        if later > TOLERANCE {
            keys.insert("at_s".to_owned(), Value::Float(later));
            left.push(event);
            continue;
        }
        move_target(table, keys);
        match keys.remove("load") {
            Some(load) if things => put_down = Some(load),
            Some(load) => {
                table.insert("load".to_owned(), load);
            }
            None => {}
        }
    }
    if let Some(load) = put_down {
        let keys = [("at_s".to_owned(), Value::Float(0.0)), ("load".to_owned(), load)];
        left.insert(0, Value::Table(keys.into_iter().collect()));
    }
    put(table, left);
}

/// Gives the task that an event names its new target.
fn move_target(table: &mut Table, event: &Table) {
    let number = event.get("task").and_then(Value::as_integer).and_then(|task| usize::try_from(task - 1).ok());
    let (Some(number), Some(target)) = (number, event.get("target_m")) else { return };
    if let Some(Value::Array(tasks)) = table.get_mut("task")
        && let Some(Value::Table(task)) = tasks.get_mut(number)
    {
        task.insert("target_m".to_owned(), target.clone());
    }
}
