//! Changes the table `[strategy]` of a scenario file by regions of the body, and tells the strategies of the regions.

use contrapposto::model::Model;
use contrapposto::model::data::library;
use toml::{Table, Value};

use crate::error::Refusal;
use crate::message::RegionScene;

/// Regions of the body that a scenario file knows.
const REGIONS: [&str; 4] = ["arms", "spine", "neck", "legs"];

/// The strategies that there are.
const KINDS: [&str; 2] = ["passive", "active"];

/// The region of a coordinate.
fn region_of(coordinate: &str) -> Option<&'static str> {
    library().sources(coordinate).map(|sources| sources.region)
}

/// Sets the strategy of a region, or of the whole body, whose other strategies of regions then go.
pub(crate) fn set(table: &mut Table, kind: &str, region: Option<&str>) -> Result<(), Refusal> {
    if !KINDS.contains(&kind) {
        return Err(Refusal(format!("`{kind}` is no strategy; there are {}", KINDS.join(", "))));
    }
    let Some(Value::Table(strategy)) = table.get_mut("strategy") else { return Ok(()) };
    let word = Value::String(kind.to_owned());
    let Some(region) = region else {
        strategy.insert("kind".to_owned(), word);
        strategy.remove("of");
        return Ok(());
    };
    if !REGIONS.contains(&region) {
        return Err(Refusal(format!("`{region}` is no region of the body; there are {}", REGIONS.join(", "))));
    }
    let is_kind_of_all = strategy.get("kind") == Some(&word);
    let of = strategy.entry("of").or_insert_with(|| Value::Table(Table::new()));
    let Value::Table(of) = of else { return Err(Refusal::of("of in [strategy] is no table")) };
    of.retain(|name, _| name != region && region_of(name) != Some(region));
    if !is_kind_of_all {
        of.insert(region.to_owned(), word);
    }
    if of.is_empty() {
        strategy.remove("of");
    }
    Ok(())
}

/// The strategies of the regions that a body has.
pub(crate) fn by_region(table: &Table, model: &Model) -> Vec<RegionScene> {
    let Some(Value::Table(strategy)) = table.get("strategy") else { return vec![] };
    let of = strategy.get("of").and_then(Value::as_table);
    let given = |name: &str| of.and_then(|of| of.get(name)?.as_str());
    let whole = strategy.get("kind").and_then(Value::as_str).unwrap_or_default();
    let scene = |region: &'static str| {
        let named =
            model.coordinates().iter().filter(|one| one.groups.is_some() && region_of(&one.name) == Some(region));
        let mut kinds = named.map(|one| given(&one.name).or(given(region)).unwrap_or(whole));
        let first = kinds.next()?;
        let one = KINDS.into_iter().find(|kind| *kind == first).filter(|_| kinds.all(|kind| kind == first));
        Some(RegionScene { name: region, strategy: one.unwrap_or("mixed") })
    };
    REGIONS.into_iter().filter_map(scene).collect()
}
