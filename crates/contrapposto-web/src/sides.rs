//! Exchanges left and right in the document of a session.

use contrapposto::equilibria::Mirror;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, plain_name};
use contrapposto::posture::Posture;
use nalgebra::Vector3;
use toml::{Table, Value};

use crate::document::{Document, numbers, vector};
use crate::error::Refusal;
use crate::message::Handle;

/// Tables without left and right.
const EVEN: [&str; 10] =
    ["format", "title", "model", "passive", "strength", "floor", "start_from", "solver", "run", "limits"];

/// The point of the other side that is where the mirror image of a point of a segment is, each in the frame of its segment.
type Point<'a> = dyn Fn(usize, [f64; 3]) -> Vector3<f64> + 'a;

/// The document of the mirror image of a body in a posture.
pub(crate) fn exchanged(document: &Document, model: &Model, posture: &Posture) -> Result<Document, Refusal> {
    let none = || Refusal::of("this body has no mirror image: its left and its right side differ");
    let mirror = Mirror::of(model).ok_or_else(none)?;
    let image = mirror.posture(posture);
    let [before, kinematics] = [posture, &image].map(|posture| {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).map(|()| kinematics)
    });
    let (before, kinematics) = (before.map_err(Refusal::of)?, kinematics.map_err(Refusal::of)?);
    // A point of ground in the frame of a segment of the other side.
    let inside = |segment, place: Vector3<f64>| {
        kinematics.placement(model, segment).inverse_transform_point(&place.into()).coords
    };
    let mut other = document.clone();
    let names = model.coordinates().iter().map(|coordinate| coordinate.name.clone());
    other.posture = names.zip(image.values().iter().copied()).collect();
    other.held.clear();
    for (handle, place) in &document.held {
        let Some(segment) = model.segment(&handle.segment).map(|segment| mirror.segment(segment)) else { continue };
        let place = mirror.vector(Vector3::from(*place));
        // Where a posture leaves a held point is where the point is told to be, so the point of the other side is found there.
        let at = inside(segment, place);
        let name = model.segments()[segment].name.clone();
        other.held.push((Handle { label: plain_name(&name), segment: name, point: at.into() }, place.into()));
    }
    let point = |segment, point: [f64; 3]| {
        inside(mirror.segment(segment), mirror.vector(before.station(model, segment, point.into())))
    };
    other.exchange(|table| tables(table, model, &mirror, &point))?;
    Ok(other)
}

/// Exchanges the sides of weights, fatigue and strategies; refuses other tables that tell left from right.
fn tables(table: &mut Table, model: &Model, mirror: &Mirror, point: &Point) -> Result<(), Refusal> {
    for (key, value) in table.iter_mut() {
        match key.as_str() {
            "load" => loads(value, model, mirror, point)?,
            "fatigue" | "strategy" => names(value, model, mirror),
            "task" if only_effort(value) => {}
            other if EVEN.contains(&other) => {}
            other => {
                return Err(Refusal(format!(
                    "[{other}] of the scenario tells left from right; the page mirrors a posture, held points, hung weights, forces, \
                     fatigue and strategies alone"
                )));
            }
        }
    }
    Ok(())
}

fn only_effort(tasks: &Value) -> bool {
    let effort = |task: &Value| {
        task.as_table()
            .is_some_and(|task| task.len() == 1 && task.get("kind").and_then(Value::as_str) == Some("effort"))
    };
    tasks.as_array().is_some_and(|tasks| tasks.iter().all(effort))
}

/// Weights that hang on segments, and forces in ground that push on points of them, with nothing else to say.
fn loads(loads: &mut Value, model: &Model, mirror: &Mirror, point: &Point) -> Result<(), Refusal> {
    for load in loads.as_array_mut().into_iter().flatten().filter_map(Value::as_table_mut) {
        let segment = load.get("segment").and_then(Value::as_str).and_then(|name| model.segment(name));
        let given = |key: &str| load.get(key).and_then(vector);
        let is_weight = load.len() == 2 && load.contains_key("mass_kg");
        let force = given("at_m").zip(given("force_n")).filter(|_| load.len() == 3);
        let Some(segment) = segment.filter(|_| is_weight || force.is_some()) else {
            return Err(Refusal::of(
                "a [[load]] of the scenario is more than a hung weight or a force in ground; the page does not mirror it",
            ));
        };
        if let Some((at, force)) = force {
            load.insert("at_m".to_owned(), numbers(point(segment, at).into()));
            load.insert("force_n".to_owned(), numbers(mirror.vector(force.into()).into()));
        }
        let name = model.segments()[mirror.segment(segment)].name.clone();
        load.insert("segment".to_owned(), Value::String(name));
    }
    Ok(())
}

/// Tables by the names of coordinates, in a table. A group on the positive side stays on it where the coordinate keeps its sign.
fn names(value: &mut Value, model: &Model, mirror: &Mirror) {
    for of in
        value.as_table_mut().into_iter().flat_map(|table| table.iter_mut()).filter_map(|(_, of)| of.as_table_mut())
    {
        let image = std::mem::take(of).into_iter().map(|(name, mut level)| {
            let Some(index) = model.coordinate(&name) else { return (name, level) };
            let (partner, sign) = mirror.coordinate(index);
            if let Some(sides) = level.as_table_mut().filter(|_| sign < 0.0) {
                let [positive, negative] = ["positive", "negative"].map(|side| sides.remove(side));
                for (side, level) in [("positive", negative), ("negative", positive)] {
                    level.and_then(|level| sides.insert(side.to_owned(), level));
                }
            }
            (model.coordinates()[partner].name.clone(), level)
        });
        *of = image.collect();
    }
}
