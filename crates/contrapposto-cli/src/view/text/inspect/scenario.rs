//! A scenario as it was understood: supports, loads, tasks and obstacles with their numbers, as `inspect SCENARIO` prints them.

use std::fmt::Write;

use contrapposto::contact::{Place, Support};
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::tasks::{CenterOfMassGoal, LookAtGoal, Task, Thing};
use contrapposto_formats::ScenarioContents;
use nalgebra::Vector3;
use serde::Serialize;

use crate::view::text::plain_table;
use crate::view::words::value;

#[derive(Serialize)]
pub(crate) struct ScenarioReport<'a> {
    file: &'a str,
    title: &'a str,
    model: &'a str,
    supports: Vec<SupportLine<'a>>,
    loads: Vec<LoadLine<'a>>,
    tasks: Vec<TaskLine<'a>>,
    obstacles: Vec<ObstacleLine<'a>>,
    /// Values at the start that are not at their default: rad, m, components of quaternions.
    start: Vec<(&'a str, f64)>,
    notes: &'a [String],
    #[serde(skip)]
    start_words: Vec<String>,
}

#[derive(Serialize)]
struct SupportLine<'a> {
    segment: &'a str,
    /// Middle of the patch at the start, ground.
    at_m: [f64; 3],
    /// The direction in which it pushes.
    normal: [f64; 3],
    friction: f64,
    share_max: f64,
    /// `start`: it stays; `free`: it may be put elsewhere on its plane.
    place: &'static str,
}

#[derive(Serialize)]
struct LoadLine<'a> {
    segment: &'a str,
    /// In ground, at the start.
    at_m: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    force_n: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    couple_nm: Option<[f64; 3]>,
    fixed_in: &'static str,
}

#[derive(Serialize)]
struct TaskLine<'a> {
    priority: usize,
    above_relief: bool,
    task: &'a str,
    target: String,
}

#[derive(Serialize)]
struct ObstacleLine<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    middle_m: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    size_m: Option<[f64; 3]>,
    /// Of a wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<[f64; 3]>,
    /// Of a wall: its distance from the origin along the normal.
    #[serde(skip_serializing_if = "Option::is_none")]
    offset_m: Option<f64>,
}

/// Everything about a scenario.
pub(crate) fn scenario_report<'a>(contents: &'a ScenarioContents, file: &'a str) -> ScenarioReport<'a> {
    let model = &contents.model;
    let name = |segment: usize| model.segments()[segment].name.as_str();
    let supports = contents.supports.iter().map(|support| SupportLine {
        segment: name(support.segment),
        at_m: contents.kinematics.station(model, support.segment, support.middle()).into(),
        normal: support.normal.into(),
        friction: support.friction,
        share_max: support.share_max,
        place: if support.place == Place::Fixed { "start" } else { "free" },
    });
    let rests = contents.rests.iter().map(|support| SupportLine {
        segment: name(support.segment),
        at_m: middle_of_region(support),
        normal: support.normal.into(),
        friction: support.friction,
        share_max: support.share_max,
        place: "when tired",
    });
    let tasks = contents.tasks.iter().map(|task| TaskLine {
        priority: task.priority,
        above_relief: task.above_relief,
        task: &task.label,
        target: target(&task.task),
    });
    let values = model.coordinates().iter().zip(contents.start.values()).enumerate();
    let moved: Vec<(usize, &str, f64)> = values
        .filter(|(_, (coordinate, value))| (**value - coordinate.default).abs() > 1e-6)
        .map(|(i, (coordinate, value))| (i, coordinate.name.as_str(), *value))
        .collect();
    ScenarioReport {
        file,
        title: &contents.title,
        model: model.name(),
        supports: supports.chain(rests).collect(),
        loads: contents.loads.iter().map(|load| load_line(contents, load)).collect(),
        tasks: tasks.collect(),
        obstacles: contents.obstacles.iter().map(|(name, thing)| obstacle_line(name, thing)).collect(),
        start: moved.iter().map(|(_, name, value)| (*name, *value)).collect(),
        notes: &contents.notes,
        start_words: moved.iter().map(|(i, name, value)| start_word(model, *i, name, *value)).collect(),
    }
}

/// The middle of the places that a support may have, ground, m.
fn middle_of_region(support: &Support) -> [f64; 3] {
    match &support.place {
        Place::Free(region) => (region.corners.iter().sum::<Vector3<f64>>() / region.corners.len() as f64).into(),
        Place::Fixed => [0.0; 3],
    }
}

/// A coordinate at the start, with its unit.
fn start_word(model: &Model, i: usize, name: &str, at: f64) -> String {
    match model.coordinates()[i].kind {
        CoordinateKind::Translation => format!("{name} {at:.3} m"),
        _ => format!("{name} {}", value(model, i, at)),
    }
}

fn load_line<'a>(contents: &'a ScenarioContents, load: &Load) -> LoadLine<'a> {
    let model = &contents.model;
    let (mut mass_kg, mut force_n, mut couple_nm) = (None, None, None);
    let fixed_in = match load.kind {
        LoadKind::Weight(mass) => {
            mass_kg = Some(mass);
            FixedIn::World
        }
        LoadKind::Force(force, fixed_in) => {
            force_n = Some(force.into());
            fixed_in
        }
        LoadKind::Couple(couple, fixed_in) => {
            couple_nm = Some(couple.into());
            fixed_in
        }
    };
    LoadLine {
        segment: &model.segments()[load.segment].name,
        at_m: contents.kinematics.station(model, load.segment, load.point).into(),
        mass_kg,
        force_n,
        couple_nm,
        fixed_in: if fixed_in == FixedIn::World { "world" } else { "segment" },
    }
}

fn obstacle_line<'a>(name: &'a str, thing: &Thing) -> ObstacleLine<'a> {
    let (mut middle_m, mut size_m, mut wall, mut offset_m) = (None, None, None, None);
    match thing {
        Thing::Block { placement, half } => {
            middle_m = Some(placement.translation.vector.into());
            size_m = Some((2.0 * half).into());
        }
        Thing::HalfSpace { normal, offset } => {
            wall = Some((*normal).into());
            offset_m = Some(*offset);
        }
    }
    ObstacleLine { name, middle_m, size_m, normal: wall, offset_m }
}

/// The aim of a task in a few words.
fn target(task: &Task) -> String {
    let at = |place: &Vector3<f64>| format!("at {}", three((*place).into()));
    match task {
        Task::Point(task) => {
            let axes: String =
                ["x", "y", "z"].iter().zip(task.axes).filter(|(_, asked)| *asked).map(|(a, _)| *a).collect();
            let only = if axes == "xyz" { String::new() } else { format!(" (only {axes})") };
            at(&task.target) + &only
        }
        Task::Placement(task) => at(&task.target.translation.vector),
        Task::LookAt(task) => match task.goal {
            LookAtGoal::Place(place) => format!("toward {}", three(place.into())),
            LookAtGoal::Direction(direction) => format!("along {}", three(direction.into_inner().into())),
        },
        Task::Distance(task) => format!("{:.3} to {:.3} m", task.lower, task.upper),
        Task::CenterOfMass(task) => match &task.goal {
            CenterOfMassGoal::At { target, .. } => at(target),
            CenterOfMassGoal::Inside { margin, .. } => format!("over the supports, {margin:.3} m inside"),
        },
        _ => String::new(),
    }
}

/// Three numbers to the millimetre.
fn three(numbers: [f64; 3]) -> String {
    // Plus zero, so that no number is minus zero.
    numbers.map(|x| format!("{:.3}", (1e3 * x).round() / 1e3 + 0.0)).join("  ")
}

/// The same as text.
pub(crate) fn readable_scenario(report: &ScenarioReport<'_>) -> String {
    let title = if report.title.is_empty() { String::new() } else { format!(": {}", report.title) };
    let mut text = format!("{}{title}\nbody: {}; ground: x forward, y up, z right, m\n", report.file, report.model);
    let mut section = |name: &str, header: &[&str], rows: Vec<Vec<String>>| {
        if rows.is_empty() {
            let _ = writeln!(text, "\n{name}: none");
            return;
        }
        let mut table = plain_table();
        table.set_header(header);
        rows.into_iter().for_each(|row| {
            table.add_row(row);
        });
        let _ = writeln!(text, "\n{name}\n{table}");
    };
    let supports = report.supports.iter().map(|s| {
        let share = if s.share_max < 1.0 { format!("{} of the weight at most", s.share_max) } else { String::new() };
        vec![s.segment.to_owned(), three(s.at_m), three(s.normal), s.friction.to_string(), s.place.to_owned(), share]
    });
    section("supports", &["segment", "at", "pushes along", "friction", "place", ""], supports.collect());
    let loads = report.loads.iter().map(|load| {
        let size = match (load.mass_kg, load.force_n, load.couple_nm) {
            (Some(mass), ..) => format!("{mass} kg"),
            (_, Some(force), _) => format!("{} N ({})", three(force), load.fixed_in),
            (.., couple) => format!("{} N m ({})", three(couple.unwrap_or_default()), load.fixed_in),
        };
        vec![load.segment.to_owned(), size, three(load.at_m)]
    });
    section("loads", &["segment", "load", "at the start at"], loads.collect());
    let tasks = report.tasks.iter().map(|task| {
        let rank = if task.above_relief { "above relief" } else { "" };
        vec![task.priority.to_string(), task.task.to_owned(), task.target.clone(), rank.to_owned()]
    });
    section("tasks, the most important first", &["", "task", "", ""], tasks.collect());
    let obstacles = report.obstacles.iter().map(|thing| {
        let what = match (thing.middle_m, thing.size_m, thing.normal, thing.offset_m) {
            (Some(middle), Some(size), ..) => format!("block, middle {}, size {}", three(middle), three(size)),
            (.., normal, offset) => {
                format!("wall, normal {}, offset {:.3}", three(normal.unwrap_or_default()), offset.unwrap_or_default())
            }
        };
        vec![thing.name.to_owned(), what]
    });
    section("obstacles", &["name", ""], obstacles.collect());
    let _ = writeln!(
        text,
        "\nstart: {}",
        if report.start_words.is_empty() { "default".to_owned() } else { report.start_words.join(", ") }
    );
    if !report.notes.is_empty() {
        text.push_str("\nnotes:\n");
        report.notes.iter().for_each(|note| {
            let _ = writeln!(text, "  {note}");
        });
    }
    text
}
