//! Reads the things of the world: named things become loads, supports, tasks and obstacles, and a start that fits them.
//!
//! `text` holds the things as they are written, `word` reads the numbers of one table, `held` boxes, tools, bags and handles, `carriers`
//! floor, steps, tables, seat and walls; `plan` holds the result. `seed` gives the first guess of a start, `start` moves it until it
//! fits, and `drawn` gives the boxes of drawings.

mod carriers;
mod drawn;
mod held;
mod plan;
mod seed;
mod start;
pub(super) mod text;
mod word;

use contrapposto::model::Model;

use super::stage::Stage;
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::thing::Thing;
use crate::toml_file::Located;

pub(super) use drawn::weights;
pub(super) use plan::World;
pub(super) use start::fit_things;

/// Reads all things of the file.
pub(super) fn read_world(at: &Located, text: &ScenarioText, model: &Model) -> Result<World, InputError> {
    let mut world = World::default();
    held::read(&mut world, at, text, model)?;
    carriers::read(&mut world, at, text, model)?;
    seed::set(&mut world, text, model);
    Ok(world)
}

/// Things that are drawn and are no obstacles.
pub(super) fn drawn_things(world: &World, stage: &Stage<'_>) -> Vec<Thing> {
    let between = world.tasks.iter().filter_map(|task| drawn::between_hands(task, stage));
    let steps = world.supports.iter().filter_map(|support| drawn::step(support, stage));
    let rests = drawn::rests(stage, &world.rests);
    world.drawn.iter().cloned().chain(between).chain(steps).chain(rests).collect()
}
