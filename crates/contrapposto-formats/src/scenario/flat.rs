//! Lays the patches of supports flat on their surfaces before the start.
//!
//! A common distance of all feet from the floor is a move of the whole body. Inverse kinematics takes out the rest of distances and
//! angles: patches on their planes first, then the middle of each patch above the same place of its plane, then all coordinates
//! as near to the start as that allows. Soft patches (pelvis, trunk, thighs) take the shape of their surface instead of turning.
//! Distances and angles beyond the limits below are refused: nobody can say where the patch was meant to be.

use contrapposto::contact::{Support, root_rates};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{Bounds, Carried, Component, LookAt, LookAtGoal, Posture as NearTo, PriorityLevel, Task};
use nalgebra::{Unit, UnitVector3, Vector3};

use super::posture::rates;
use super::stage::Start;
use super::surface::{Fit, Resting, Shape};
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// m. A patch that is nearer to its plane lies on it; positions in files are rounded to millimetres.
const ON_PLANE: f64 = 1e-3;
/// rad, 0.1 degrees. A patch that is less tilted lies flat.
const FLAT: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// m. A patch that is farther from its plane, after the move of the whole body, is refused.
const FARTHEST: f64 = 0.05;
/// rad, 30 degrees. A patch that is tilted more is refused.
const STEEPEST: f64 = std::f64::consts::FRAC_PI_6;
/// rad, 100 degrees: the same for hands, which turn easily; the back of the hand, 180 degrees off, is refused.
const STEEPEST_HAND: f64 = 100.0 * std::f64::consts::PI / 180.0;
/// Share of the body's mass. Coordinates that carry more are those of root and trunk.
const HEAVY: f64 = 0.25;
/// Weight of such a coordinate beside 1 for all others: limbs move before the trunk does.
const HEAVY_WEIGHT: f64 = 10.0;
/// rad, 60 degrees: the same for soft patches; a slumped pelvis is tilted back by 40 degrees.
const STEEPEST_SOFT: f64 = std::f64::consts::FRAC_PI_3;
/// Segments of palms.
const PALMS: [&str; 2] = ["hand_r", "hand_l"];

/// Lays all patches flat, and returns the supports. `free`: one flag a rate; other rates stay. Sentences on moved patches go to `notes`.
pub(super) fn lay_flat(
    at: &Located,
    model: &Model,
    free: &[bool],
    start: &mut Start,
    mut resting: Vec<Resting>,
    notes: &mut Vec<String>,
) -> Result<Vec<Support>, InputError> {
    let inside = |(coordinate, value): (&contrapposto::model::Coordinate, &f64)| {
        (coordinate.range.0..=coordinate.range.1).contains(value)
    };
    // A start outside its ranges is refused later, or moved by the solver of poses.
    if model.coordinates().iter().zip(start.posture.values()).all(inside) {
        move_to_floor(at, model, free, start, &resting, notes)?;
        for (i, support) in resting.iter().enumerate() {
            check(at, model, i, support, &support.fit(model, &start.kinematics))?;
        }
        bring(at, model, free, start, &resting, notes)?;
        for support in resting.iter_mut().filter(|support| support.soft) {
            let tilt = support.fit(model, &start.kinematics).tilt;
            if tilt > FLAT {
                support.flatten(model, &start.kinematics);
                let name = &model.segments()[support.support.segment].name;
                let degrees = rounded(tilt.to_degrees(), 1);
                notes.push(format!(
                    "the patch of `{name}`, tilted by {degrees} degrees, takes the shape of its surface"
                ));
            }
        }
    }
    Ok(resting.into_iter().map(|resting| resting.support).collect())
}

/// Takes out the distance that all patches on the floor have in common, by the slides of the root.
pub(super) fn move_to_floor(
    at: &Located,
    model: &Model,
    free: &[bool],
    start: &mut Start,
    resting: &[Resting],
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let gaps = resting.iter().filter(|resting| resting.on_floor).map(|r| r.fit(model, &start.kinematics).gap);
    let (low, high) = gaps.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), gap| (a.min(gap), b.max(gap)));
    // The nearest to zero between them; none without a patch on the floor.
    let common = if low > ON_PLANE { low } else { high.min(0.0) };
    let (Some(up), true) = (Unit::try_new(-model.gravity(), 1e-9), common.abs() > ON_PLANE && common.is_finite())
    else {
        return Ok(());
    };
    let slides = root_rates(model).into_iter().filter(|&rate| {
        let coordinate = model.rates()[rate].coordinate;
        free[rate] && coordinate.is_some_and(|i| model.coordinates()[i].kind == CoordinateKind::Translation)
    });
    let feet = resting.iter().find(|resting| resting.on_floor).map_or(0, |resting| resting.support.segment);
    let mut jacobian = vec![0.0; 3 * model.rates().len()];
    start.kinematics.point_jacobian(model, feet, Vector3::zeros(), &mut jacobian);
    let n = model.rates().len();
    let rise = |rate: usize| (0..3).map(|axis| up[axis] * jacobian[axis * n + rate]).sum::<f64>();
    let slides: Vec<(usize, f64)> = slides.map(|rate| (rate, rise(rate))).filter(|slide| slide.1 != 0.0).collect();
    let square: f64 = slides.iter().map(|(_, rise)| rise * rise).sum();
    if square < 1e-12 {
        return Ok(());
    }
    let mut step = vec![0.0; n];
    slides.iter().for_each(|&(rate, rise)| step[rate] = -common * rise / square);
    start.displace(at, model, &step)?;
    let (way, before) = if common > 0.0 { ("down", "above") } else { ("up", "below") };
    let distance = rounded(common.abs(), 4);
    notes.push(format!("the start was moved {way} by {distance} m: the feet stood {before} the floor (y = 0)"));
    Ok(())
}

/// Greatest angle between a patch and its surface, rad.
fn steepest(name: &str, soft: bool) -> f64 {
    match soft {
        true => STEEPEST_SOFT,
        false if PALMS.contains(&name) => STEEPEST_HAND,
        false => STEEPEST,
    }
}

/// Whether a patch is so near its surface that it is laid on it.
pub(super) fn near(model: &Model, resting: &Resting, fit: &Fit) -> bool {
    let name = &model.segments()[resting.support.segment].name;
    fit.gap.abs() <= FARTHEST && fit.tilt <= steepest(name, resting.soft)
}

/// Refuses a patch that is too far off its surface, or too tilted.
fn check(at: &Located, model: &Model, i: usize, resting: &Resting, fit: &Fit) -> Result<(), InputError> {
    if near(model, resting, fit) {
        return Ok(());
    }
    let name = &model.segments()[resting.support.segment].name;
    let steepest = steepest(name, resting.soft);
    let (gap, tilt) = (rounded(fit.gap.abs(), 4), rounded(fit.tilt.to_degrees(), 1));
    let (surface, side) =
        (if resting.on_floor { "floor or step" } else { "plane" }, if fit.gap < 0.0 { "below" } else { "above" });
    let message = format!(
        "at the start the patch of `{name}` is {gap} m {side} its {surface} and tilted by {tilt} degrees; {FARTHEST} m and {} degrees \
         at most are taken out",
        rounded(steepest.to_degrees(), 1)
    );
    let number = i.to_string();
    let on = ["support", &number, "on"];
    let help = if !at.holds(&["support", &number]) {
        "no start was found in which all parts rest on their things: bring the things nearer to each other (`edge_m`, `height_m`), or let fewer parts \
         rest on them (`carries`, `backrest`)"
            .to_owned()
    } else if resting.on_floor && fit.tilt <= STEEPEST && fit.gap > 0.0 {
        format!("add `step_m = {gap}` for a step under it, or change [posture]")
    } else {
        "change [posture], or the surface in `on`; a support stays where it is at the start".to_owned()
    };
    let path = if at.holds(&on) { on } else { ["support", &number, "segment"] };
    Err(at.error(&path, message, Some(help)))
}

/// Moves the start so that all patches touch their planes, the rigid ones flat.
fn bring(
    at: &Located,
    model: &Model,
    free: &[bool],
    start: &mut Start,
    resting: &[Resting],
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let fits: Vec<Fit> = resting.iter().map(|resting| resting.fit(model, &start.kinematics)).collect();
    let off = |(resting, fit): (&Resting, &Fit)| fit.gap.abs() > ON_PLANE || (!resting.soft && fit.tilt > FLAT);
    if !resting.iter().zip(&fits).any(off) {
        return Ok(());
    }
    let level = |tasks: fn(&Resting, &Fit, &Model, &Kinematics) -> Vec<Task>| {
        let tasks = resting.iter().zip(&fits).flat_map(|(resting, fit)| tasks(resting, fit, model, &start.kinematics));
        PriorityLevel { tasks: tasks.collect(), ..PriorityLevel::default() }
    };
    let near = near_to(model, &start.posture);
    let levels = vec![level(on_plane), level(in_place), near.into()];
    let failed = |message: String| at.error(&["support"], message, None);
    let mut engine =
        Engine::new(model, levels, &[], Options::inverse_kinematics()).map_err(|error| failed(error.to_string()))?;
    (0..free.len()).filter(|&rate| !free[rate]).for_each(|rate| engine.lock(rate));
    let solved = engine.solve(&start.posture).map_err(|error| failed(error.to_string()))?;
    let before = std::mem::replace(&mut start.posture, solved.posture);
    start.update(at, model)?;
    for (i, support) in resting.iter().enumerate() {
        let fit = support.fit(model, &start.kinematics);
        if off((support, &fit)) {
            let name = &model.segments()[support.support.segment].name;
            let (gap, tilt) = (rounded(fit.gap.abs(), 4), rounded(fit.tilt.to_degrees(), 1));
            let message = format!(
                "the patch of `{name}` cannot be laid flat within the ranges of the joints: {gap} m and {tilt} degrees are left"
            );
            let help = Some("change [posture], or the surface in `on`".to_owned());
            return Err(at.error(&["support", &i.to_string(), "segment"], message, help));
        }
        if off((support, &fits[i])) {
            let (name, fit) = (&model.segments()[support.support.segment].name, &fits[i]);
            let (gap, tilt) = (rounded(fit.gap, 4), rounded(fit.tilt.to_degrees(), 1));
            let gap = if fit.gap.abs() > ON_PLANE { format!(" and {gap} m above it") } else { String::new() };
            notes.push(format!("the patch of `{name}` was laid on its surface: it was tilted by {tilt} degrees{gap}"));
        }
    }
    notes.extend(largest_change(model, &before, &start.posture));
    Ok(())
}

/// All coordinates as near to the start as possible. Those that carry much of the body, root and trunk, count more than limbs.
pub(super) fn near_to(model: &Model, start: &Posture) -> Task {
    let mut task = NearTo::whole(model, start.clone());
    let segments = model.segments();
    let mut carried: Vec<f64> = segments.iter().map(|segment| segment.mass).collect();
    // A parent stands before its children.
    for (child, segment) in segments.iter().enumerate().rev() {
        if let Some(parent) = segment.parent {
            carried[parent] += carried[child];
        }
    }
    for (segment, _) in segments.iter().zip(&carried).filter(|(_, mass)| **mass > HEAVY * model.mass()) {
        let moved = segment.coordinates.clone().flat_map(|coordinate| rates(model, coordinate));
        moved.for_each(|rate| task.weights[rate] = HEAVY_WEIGHT);
    }
    Task::Posture(task)
}

/// A sentence on the joint that moved most.
fn largest_change(model: &Model, before: &Posture, after: &Posture) -> Option<String> {
    let change = |i: usize| (after.values()[i] - before.values()[i]).to_degrees();
    let turning = (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].kind == CoordinateKind::Rotation);
    let most = turning.max_by(|&a, &b| change(a).abs().total_cmp(&change(b).abs()))?;
    let (name, degrees) = (&model.coordinates()[most].name, rounded(change(most), 1));
    Some(format!("the start was moved for that; most of all `{name}`, by {degrees} degrees"))
}

/// The middle at the height of the plane, and a rigid patch flat on it.
pub(super) fn on_plane(resting: &Resting, fit: &Fit, model: &Model, kinematics: &Kinematics) -> Vec<Task> {
    let segment = resting.support.segment;
    let normal = Unit::new_normalize(resting.support.normal);
    let height = normal.dot(&resting.middle(model, kinematics)) - fit.gap;
    let row = |of, value| Component { of, along: normal, limits: (value, value) };
    let mut components = vec![row(Carried::Point(resting.support.middle()), height)];
    let mut tasks = vec![];
    match fit.shape {
        Shape::Line(line) if !resting.soft => components.push(row(Carried::Direction(line), 0.0)),
        Shape::Flat(direction) if !resting.soft => {
            let (eye, goal) = (Vector3::zeros(), LookAtGoal::Direction(normal));
            tasks.push(Task::LookAt(LookAt { segment, eye, direction, goal }));
        }
        _ => {}
    }
    tasks.push(Task::Bounds(Bounds { segment, components }));
    tasks
}

/// The middle above the same place of the plane.
fn in_place(resting: &Resting, _: &Fit, model: &Model, kinematics: &Kinematics) -> Vec<Task> {
    let middle = resting.middle(model, kinematics);
    let stays = |along: UnitVector3<f64>| {
        let value = along.dot(&middle);
        Component { of: Carried::Point(resting.support.middle()), along, limits: (value, value) }
    };
    let components = across(&Unit::new_normalize(resting.support.normal)).map(stays).into();
    vec![Task::Bounds(Bounds { segment: resting.support.segment, components })]
}

/// Two directions of a plane.
pub(super) fn across(normal: &UnitVector3<f64>) -> [UnitVector3<f64>; 2] {
    let first = normal.cross(&Vector3::ith(normal.iamin(), 1.0));
    [Unit::new_normalize(first), Unit::new_normalize(normal.cross(&first))]
}

/// A number with so many decimals at most.
fn rounded(value: f64, decimals: i32) -> String {
    let scale = 10f64.powi(decimals);
    shown((value * scale).round() / scale)
}
