//! Times every instant of marker tracking and of inverse dynamics on a file of the reader's own, for scripts/opensim_times.py:
//! `opensim_times MODEL.osim MARKERS.trc SETUP.xml` prints a line `track` or `dynamics` with a time in microseconds for each of them.
//! The first instant of tracking, in which the body is sought in several directions, is left out.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a measurement without its files has nothing to measure")]

use std::collections::HashMap;
use std::hint::black_box;
use std::time::Instant;

use contrapposto::dynamics::Inertia;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::ExternalTorque;
use contrapposto::tracking::{CoordinateGoal, Goals, MarkerGoal, track};
use contrapposto_formats::markers::{Markers, TaskValue, TrackingTasks, read_trc, tracking_tasks};
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;

/// The goals of a setup file, and the places of their markers at all times.
fn goals(opened: &SourcedModel, markers: &Markers, tasks: &TrackingTasks) -> (Goals, Vec<Vec<Option<Vector3<f64>>>>) {
    let weights: HashMap<&str, f64> = tasks.markers.iter().map(|task| (task.name.as_str(), task.weight)).collect();
    let (mut goals, mut columns) = (Goals { limits: opened.hard_limits.clone(), ..Goals::default() }, vec![]);
    for marker in &opened.markers {
        let column = markers.names.iter().position(|name| *name == marker.name);
        if let Some((column, weight)) = column.zip(weights.get(marker.name.as_str())) {
            goals.markers.push(MarkerGoal { segment: marker.segment, point: marker.point, weight: *weight });
            columns.push(column);
        }
    }
    for task in &tasks.coordinates {
        let coordinate = opened.model.coordinate(&task.name).unwrap();
        let value = match task.value {
            TaskValue::Default => opened.model.coordinates()[coordinate].default,
            TaskValue::Manual(value) => value,
        };
        goals.coordinates.push(CoordinateGoal { coordinate, value, weight: task.weight });
    }
    let locked = opened.model.coordinates().iter().enumerate().filter(|(_, coordinate)| coordinate.locked);
    goals.fixed = locked.map(|(index, _)| index).collect();
    let inside = |time: f64| tasks.time_range.is_none_or(|(from, to)| (from - 5e-4..=to + 5e-4).contains(&time));
    let rows = markers.times.iter().zip(&markers.places).filter(|(time, _)| inside(**time));
    (goals, rows.map(|(_, row)| columns.iter().map(|column| row[*column]).collect()).collect())
}

fn microseconds(from: Instant, to: Instant) -> f64 {
    1e6 * to.duration_since(from).as_secs_f64()
}

fn main() {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [model, markers, setup] = &files[..] else { panic!("MODEL.osim MARKERS.trc SETUP.xml are needed") };
    let bytes = std::fs::read(model).unwrap();
    let opened = SourcedModel::read(model, &bytes, None, &mut |_| Err(String::new())).unwrap();
    let markers = read_trc(markers, &std::fs::read(markers).unwrap(), None).unwrap();
    let tasks = tracking_tasks(setup, &std::fs::read(setup).unwrap()).unwrap();
    let (goals, rows) = goals(&opened, &markers, &tasks);
    let model = &opened.model;
    let mut marks = Vec::with_capacity(rows.len() + 1);
    let timed = rows.iter().map(Vec::as_slice).inspect(|_| marks.push(Instant::now()));
    let tracked = track(model, goals, &model.default_posture(), timed).unwrap();
    marks.push(Instant::now());
    marks.windows(2).skip(1).for_each(|pair| println!("track {:.3}", microseconds(pair[0], pair[1])));
    dynamics(model, tracked.iter().map(|instant| &instant.posture));
}

/// Inverse dynamics of each posture with speeds and accelerations that are given.
#[inline(never)]
fn dynamics<'p>(model: &Model, postures: impl Iterator<Item = &'p Posture>) {
    let (mut kinematics, mut external) = (Kinematics::new(model), ExternalTorque::new(model));
    let mut inertia = Inertia::new(model);
    let rates = (vec![0.3; model.rates().len()], vec![0.1; model.rates().len()]);
    let mut spent = vec![];
    for posture in postures {
        let start = Instant::now();
        kinematics.update(model, posture).unwrap();
        inertia.update(model, &kinematics, (&rates.0, &rates.1), &[]).unwrap();
        inertia.external_torque(model, &kinematics, &[], &mut external).unwrap();
        black_box(external.torques());
        spent.push(microseconds(start, Instant::now()));
    }
    // Printed at the end: a write between two postures would be timed as cold memory.
    spent.iter().for_each(|spent| println!("dynamics {spent:.3}"));
}
