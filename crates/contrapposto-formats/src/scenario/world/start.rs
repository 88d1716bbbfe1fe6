//! Moves the start until it fits the things of the world, by inverse kinematics.
//!
//! Patches lie on their surfaces first, then at their places (feet where they are or a stride apart, hands behind the edge of a
//! table), then the centre of mass is over the feet of who stands, then hands are at their places, and last all coordinates are as near
//! to the guess as that allows. Without things, or where `[posture]` says how the body starts and every patch is near its surface,
//! nothing is moved here.

use contrapposto::model::Model;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{
    Bounds, Carried, CenterOfMass, CenterOfMassGoal, Component, Point, PriorityLevel, Task, half_planes,
};
use nalgebra::{UnitVector3, Vector3};

use super::plan::{World, grip};
use super::seed::targets;
use crate::input_error::InputError;
use crate::scenario::flat::{move_to_floor, near, near_to, on_plane};
use crate::scenario::stage::Start;
use crate::scenario::surface::Resting;
use crate::scenario::text::ScenarioText;
use crate::toml_file::Located;

/// Distance of the centre of mass from the edges of the feet, m (assumed).
const INSIDE_FEET: f64 = 0.02;

/// Moves the start; says so in `notes`. `free`: one flag a rate.
pub(in crate::scenario) fn fit_things(
    at: &Located,
    model: &Model,
    free: &[bool],
    start: &mut Start,
    resting: &[Resting],
    (world, text): (&World, &ScenarioText),
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    if world.is_empty() {
        return Ok(());
    }
    move_to_floor(at, model, free, start, resting, &mut vec![])?;
    let all_near = resting.iter().all(|resting| near(model, resting, &resting.fit(model, &start.kinematics)));
    if all_near && text.has_posture() {
        return Ok(());
    }
    let levels = levels(model, start, resting, world);
    let failed = |message: String| at.error(&["posture"], message, None);
    let mut engine =
        Engine::new(model, levels, &[], Options::inverse_kinematics()).map_err(|error| failed(error.to_string()))?;
    (0..free.len()).filter(|&rate| !free[rate]).for_each(|rate| engine.lock(rate));
    let solved = engine.solve(&start.posture).map_err(|error| failed(error.to_string()))?;
    start.posture = solved.posture;
    start.update(at, model)?;
    notes.push(
        "the start was computed to fit the things of the world; what [posture] names was kept where it fits".into(),
    );
    Ok(())
}

fn levels(model: &Model, start: &Start, resting: &[Resting], world: &World) -> Vec<PriorityLevel> {
    let level = |tasks: Vec<Task>| PriorityLevel { tasks, ..PriorityLevel::default() };
    let fits = resting.iter().map(|resting| (resting, resting.fit(model, &start.kinematics)));
    let planes = fits.flat_map(|(resting, fit)| on_plane(resting, &fit, model, &start.kinematics)).collect();
    let places: Vec<Task> = resting.iter().map(|resting| in_place(model, start, resting, world)).collect();
    let hands = targets(world)
        .map(|(segment, target)| Task::Point(Point { segment, point: grip(model, segment), target, axes: [true; 3] }));
    let mut levels = vec![level(planes), level(places)];
    levels.extend(over_feet(model, start, resting, world).map(|task| level(vec![task])));
    levels.push(level(hands.collect()));
    levels.retain(|level| !level.tasks.is_empty());
    levels.push(near_to(model, &start.posture).into());
    levels
}

/// Wanted place of the middle of a patch, ground, m; its height has no part in it.
fn wanted(model: &Model, start: &Start, resting: &Resting, world: &World) -> Vector3<f64> {
    let name = model.segments()[resting.support.segment].name.as_str();
    let middle = resting.middle(model, &start.kinematics);
    let stride = world.strides.iter().find(|(foot, _)| *foot == name).map_or(0.0, |(_, ahead)| *ahead);
    match world.places.iter().find(|(segment, _)| *segment == name) {
        Some((_, [ahead, aside])) => Vector3::new(*ahead, middle.y, *aside),
        None => middle + Vector3::new(stride, 0.0, 0.0),
    }
}

/// The middle of a patch at its place, in the directions of its plane.
fn in_place(model: &Model, start: &Start, resting: &Resting, world: &World) -> Task {
    let target = wanted(model, start, resting, world);
    let normal = UnitVector3::new_normalize(resting.support.normal);
    let stays = |along: UnitVector3<f64>| {
        let value = along.dot(&target);
        Component { of: Carried::Point(resting.support.middle()), along, limits: (value, value) }
    };
    let components = crate::scenario::flat::across(&normal).map(stays).into();
    Task::Bounds(Bounds { segment: resting.support.segment, components })
}

/// The centre of mass over the feet, for who stands on nothing else.
fn over_feet(model: &Model, start: &Start, resting: &[Resting], world: &World) -> Option<Task> {
    if world.sits || resting.is_empty() || !resting.iter().all(|resting| resting.on_floor) {
        return None;
    }
    let corners = |resting: &Resting| {
        let moved = wanted(model, start, resting, world) - resting.middle(model, &start.kinematics);
        let station = |corner: &Vector3<f64>| start.kinematics.station(model, resting.support.segment, *corner) + moved;
        resting.support.corners.iter().map(station).collect::<Vec<_>>()
    };
    let points: Vec<Vector3<f64>> = resting.iter().flat_map(corners).collect();
    let polygon = half_planes(&points, model.gravity());
    let goal = CenterOfMassGoal::Inside { polygon, margin: INSIDE_FEET };
    Some(Task::CenterOfMass(CenterOfMass { goal }))
}
