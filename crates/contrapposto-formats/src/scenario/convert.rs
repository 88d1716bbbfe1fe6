//! Names become indices, degrees radians, and every number is checked where it stands.

use std::collections::BTreeMap;

use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, AdultError, Coordinate, CoordinateKind, Model, Part, Sex, adult, data};
use contrapposto::passive::{CoordinateLimitForce, DoubleExponential, End, PassiveCurve, PassiveError, Tabulated};
use contrapposto::simulation::{
    Event, ReliefSettings, RunSettings, Scenario, ScenarioError, StrategySettings, Tables, TaskSettings,
};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::tasks::PriorityLevel;
use nalgebra::Vector3;

use super::pose::{Ranked, ranked, set};
use super::task::Stage;
use super::task_text::TaskText;
use super::text::{
    AdultText, DoubleExponentialText, EndText, EventText, FixedInText, LawText, LoadText, PartText, PassiveText,
    ReshapeText, RunText, ScenarioText, SexText, StrategyKindText, StrategyText, TablesText,
};
use super::{Located, support};
use crate::input_error::{InputError, suggestion};

pub(super) fn scenario(at: &Located, text: &ScenarioText, model: Option<Model>) -> Result<Scenario, InputError> {
    check_head(at, text)?;
    let (strategy, run) = simulated(at, text)?;
    let model = body(at, text, model)?;
    let mut start = model.default_posture();
    set(at, &model, &["posture"], &text.posture, &mut start)?;
    start.displace(&model, &vec![0.0; model.rates().len()]);
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &start).map_err(|error| at.error(&["posture"], error.to_string(), None))?;
    let supports = support::supports(at, &model, &text.support, &kinematics)?;
    let standing = supports.iter().map(|support| support.segment).collect();
    let stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: standing };
    let ranked = ranked(&stage, &text.task)?;
    let tasks: Vec<TaskSettings> =
        ranked.into_iter().map(|Ranked { goal, above_relief, .. }| TaskSettings { goal, above_relief }).collect();
    let whole = !supports.is_empty() || !tasks.is_empty();
    let free = free(at, &model, text, |coordinate| whole || coordinate.can_be_relieved())?;
    let strategies = vec![kind(strategy.kind); model.coordinates().len()];
    let strategies = change_strategies(at, &model, &["strategy", "of"], strategies, &strategy.of)?;
    let goals = tasks.iter().map(|task| task.goal.clone()).collect();
    let events = events(at, &model, text, goals, strategies.clone())?;
    let loads =
        text.load.iter().enumerate().map(|(i, load)| self::load(at, &model, i, load)).collect::<Result<_, _>>()?;
    let mut start_fatigue = vec![[0.0; 2]; model.coordinates().len()];
    for (name, start) in &text.fatigue.start {
        let index = coordinate(at, &model, &["fatigue", "start", name], name)?;
        for (side, level) in [("positive", start.positive), ("negative", start.negative)] {
            if !(0.0..=1.0).contains(&level) {
                let message =
                    format!("fatigue at the start is {}; it must lie in 0 (rested) to 1 (exhausted)", shown(level));
                return Err(at.error(&["fatigue", "start", name, side], message, None));
            }
        }
        start_fatigue[index] = [start.positive, start.negative];
    }
    // A joint on its own as in the paper; a whole body must be able to follow.
    let (max_step_deg, torque_tolerance) =
        if supports.is_empty() && tasks.is_empty() { (2.0, 0.05) } else { (0.5, 0.5) };
    let scenario = Scenario {
        title: text.title.clone(),
        model,
        start,
        free,
        loads,
        supports,
        tasks,
        events,
        strategies,
        strategy: StrategySettings {
            kind: kind(strategy.kind),
            minimum_decrease_ratio: strategy.minimum_decrease_ratio,
        },
        relief: ReliefSettings {
            step_gain: text.relief.step_gain,
            max_step: text.relief.max_step_deg.unwrap_or(max_step_deg).to_radians(),
            torque_tolerance: text.relief.torque_tolerance_nm.unwrap_or(torque_tolerance),
            tables: match text.relief.tables {
                TablesText::Total => Tables::Total,
                TablesText::Literal => Tables::Literal,
            },
        },
        hysteresis: Hysteresis {
            critical_level: text.fatigue.critical_level,
            recovery_level: text.fatigue.recovery_level,
        },
        start_fatigue,
        run: RunSettings { duration: run.duration_s, step: run.step_s, stop_when_settled: run.stop_when_settled },
    };
    scenario.check().map_err(|error| at.error(&place(&error), told(&error, text, run), None))?;
    check_events_happen(at, text, &scenario.run)?;
    Ok(scenario)
}

/// An event after the last step of the run would be passed over in silence.
fn check_events_happen(at: &Located, text: &ScenarioText, run: &RunSettings) -> Result<(), InputError> {
    for (i, event) in text.event.iter().enumerate() {
        if event.at_s > run.end() + 1e-9 {
            let (time, end) = (shown(event.at_s), shown((run.end() * 1e9).round() / 1e9));
            let message =
                format!("event {} would never happen: it is at {time} s, the last step of the run at {end} s", i + 1);
            let help = Some("lengthen `duration_s` of [run], or leave the event out".to_owned());
            return Err(at.error(&["event", &i.to_string(), "at_s"], message, help));
        }
    }
    Ok(())
}

/// Format and title, which every scenario has.
pub(super) fn check_head(at: &Located, text: &ScenarioText) -> Result<(), InputError> {
    if text.format != 1 {
        let message = format!("format is {}; this program reads format 1", text.format);
        return Err(at.error(&["format"], message, None));
    }
    check_title(at, &text.title)
}

/// What `simulate` needs; what only `pose` can do is refused, not passed over.
fn simulated<'a>(at: &Located, text: &'a ScenarioText) -> Result<(&'a StrategyText, &'a RunText), InputError> {
    if text.solver.is_some() {
        let help = Some("leave it out; `contrapposto pose` takes it".to_owned());
        return Err(at.error(&["solver"], "[solver] is for poses, not for simulations", help));
    }
    let missing = |key: &str| {
        let help = Some("`contrapposto schema` lists all keys".to_owned());
        at.error(&[], format!("the key `{key}` is missing"), help)
    };
    Ok((text.strategy.as_ref().ok_or_else(|| missing("strategy"))?, text.run.as_ref().ok_or_else(|| missing("run"))?))
}

fn kind(text: StrategyKindText) -> Strategy {
    match text {
        StrategyKindText::Active => Strategy::Active,
        StrategyKindText::Passive => Strategy::Passive,
    }
}

/// Strategies of all coordinates, changed for the regions and coordinates named.
fn change_strategies(
    at: &Located,
    model: &Model,
    path: &[&str],
    mut all: Vec<Strategy>,
    of: &BTreeMap<String, StrategyKindText>,
) -> Result<Vec<Strategy>, InputError> {
    let region = |name: &str| data::library().sources(name).map(|sources| sources.region);
    // Regions first, so that a coordinate that is named itself has the last word.
    let (single, regions): (Vec<_>, Vec<_>) = of.iter().partition(|(name, _)| model.coordinate(name).is_some());
    for (name, &text) in regions {
        let within: Vec<usize> = (0..all.len())
            .filter(|&i| region(&model.coordinates()[i].name).is_some_and(|region| region == name))
            .collect();
        if within.is_empty() {
            let path: Vec<&str> = path.iter().copied().chain([name.as_str()]).collect();
            let names = ["spine", "neck", "arms", "legs"]
                .into_iter()
                .chain(model.coordinates().iter().map(|c| c.name.as_str()));
            let help = suggestion(name, names);
            return Err(at.key_error(&path, format!("the body has no region or coordinate `{name}`"), help));
        }
        within.into_iter().for_each(|i| all[i] = kind(text));
    }
    for (name, &text) in single {
        if let Some(i) = model.coordinate(name) {
            all[i] = kind(text);
        }
    }
    Ok(all)
}

/// The events, the earliest first. `goals` and `strategies` are those of the start; each event changes what the ones before it
/// left.
fn events(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    mut goals: Vec<PriorityLevel>,
    mut strategies: Vec<Strategy>,
) -> Result<Vec<Event>, InputError> {
    let mut order: Vec<(usize, &EventText)> = text.event.iter().enumerate().collect();
    order.sort_by(|a, b| a.1.at_s.total_cmp(&b.1.at_s));
    let mut events = vec![];
    for (i, event_text) in order {
        let number = i.to_string();
        let path = |key| ["event", &number, key];
        if event_text.at_s < 0.0 {
            let message = format!("at_s is {}; it must not be negative", shown(event_text.at_s));
            return Err(at.error(&path("at_s"), message, None));
        }
        let mut event = Event { time: event_text.at_s, ..Event::default() };
        if let Some(all) = event_text.strategy {
            strategies.fill(kind(all));
        }
        if event_text.strategy.is_some() || !event_text.strategy_of.is_empty() {
            strategies = change_strategies(at, model, &path("strategy_of"), strategies, &event_text.strategy_of)?;
            event.strategies = Some(strategies.clone());
        }
        if let Some(loads) = &event_text.load {
            let loads = loads.iter().enumerate();
            let loads = loads.map(|(j, load)| load_at(at, model, &["event", &number, "load", &j.to_string()], load));
            event.loads = Some(loads.collect::<Result<_, _>>()?);
        }
        match (event_text.task, event_text.target_m) {
            (Some(task), Some(target)) => {
                let at_place = task.checked_sub(1).and_then(|i| places(&text.task).get(i).copied());
                let Some((priority, place)) = at_place else {
                    let message = format!("there is no task {task}; the scenario has {} of them", text.task.len());
                    return Err(at.error(&path("task"), message, Some("1 is the first".to_owned())));
                };
                let moved = &mut goals[priority].tasks[place];
                if !moved.retarget(Vector3::from(target)) {
                    let message = format!("task {task} ({}) has no place as its target", moved.kind());
                    return Err(at.error(&path("task"), message, None));
                }
                moved.check(model).map_err(|error| at.error(&path("target_m"), error.to_string(), None))?;
                event.tasks.push((priority, goals[priority].clone()));
            }
            (None, None) => {}
            (Some(_), None) => return Err(at.error(&path("task"), "a new target is missing: `target_m`", None)),
            (None, Some(_)) => {
                return Err(at.error(&path("target_m"), "which task is meant? `task = 1` is the first", None));
            }
        }
        if event.strategies.is_none() && event.loads.is_none() && event.tasks.is_empty() {
            let help = Some("give it `strategy`, `strategy_of`, `load`, or `task` and `target_m`".to_owned());
            return Err(at.error(&["event", &number], "nothing changes at this event", help));
        }
        events.push(event);
    }
    Ok(events)
}

/// Where each task of the file stands: its priority, and its place among the tasks of that priority.
fn places(texts: &[TaskText]) -> Vec<(usize, usize)> {
    let mut places: Vec<(usize, usize)> = vec![];
    for text in texts {
        places.push(match places.last() {
            Some(&(priority, place)) if text.same_priority => (priority, place + 1),
            Some(&(priority, _)) => (priority + 1, 0),
            None => (0, 0),
        });
    }
    places
}

/// Longest title, characters: it stands above the pictures.
const LONGEST_TITLE: usize = 200;

fn check_title(at: &Located, title: &str) -> Result<(), InputError> {
    let length = title.chars().count();
    let message = if length > LONGEST_TITLE {
        format!("the title has {length} characters; {LONGEST_TITLE} at most")
    } else if title.chars().any(char::is_control) {
        "the title holds control characters (line breaks, escapes)".to_owned()
    } else {
        return Ok(());
    };
    Err(at.error(&["title"], message, Some("give it one short line".into())))
}

/// The complaint in the words and units of the file.
fn told(error: &ScenarioError, text: &ScenarioText, run: &RunText) -> String {
    let ScenarioError::Setting { name, value, accepted } = error else { return error.to_string() };
    match (*name, place(error).last()) {
        ("number of steps", _) => {
            let (duration, step) = (shown(run.duration_s), shown(run.step_s));
            format!("{duration} s in steps of {step} s are {} steps; ten million at most", shown(*value))
        }
        ("greatest step (rad)", Some(key)) => {
            format!("{key} is {}; it must be {accepted}", shown(text.relief.max_step_deg.unwrap_or(value.to_degrees())))
        }
        (_, Some(key)) => format!("{key} is {}; it must be {accepted}", shown(*value)),
        _ => error.to_string(),
    }
}

/// A number without a row of three hundred digits.
pub(super) fn shown(x: f64) -> String {
    if x != 0.0 && !(1e-6..1e9).contains(&x.abs()) { format!("{x:e}") } else { x.to_string() }
}

/// Where a setting stands in the file.
fn place(error: &ScenarioError) -> Vec<&'static str> {
    let name = match error {
        ScenarioError::Setting { name, .. } => *name,
        ScenarioError::NoPassiveCurve(_) => return vec!["coordinates", "free"],
        _ => return vec![],
    };
    match name {
        "minimum decrease ratio" => vec!["strategy", "minimum_decrease_ratio"],
        "time of an event (s)" => vec!["event"],
        "step gain" => vec!["relief", "step_gain"],
        "greatest step (rad)" => vec!["relief", "max_step_deg"],
        "torque tolerance (N m)" => vec!["relief", "torque_tolerance_nm"],
        "critical level" => vec!["fatigue", "critical_level"],
        "recovery level" => vec!["fatigue", "recovery_level"],
        "duration (s)" | "number of steps" => vec!["run", "duration_s"],
        "time step (s)" => vec!["run", "step_s"],
        _ => vec![],
    }
}

/// The body: that of the model file if there is one, else the built-in adult, with its own passive curves and fatigue laws.
pub(super) fn body(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Model, InputError> {
    let mut model = match (file, &text.model.file) {
        (Some(model), _) => model,
        (None, Some(_)) => return Err(at.key_error(&["model", "file"], "the model file was not opened", None)),
        (None, None) => built_in(at, text)?,
    };
    for (name, passive) in &text.passive {
        let index = coordinate(at, &model, &["passive", name], name)?;
        let curve = passive_curve(at, &["passive", name], &model.coordinates()[index], None, passive)?;
        model = model.with_passive(index, curve);
    }
    Ok(model)
}

fn built_in(at: &Located, text: &ScenarioText) -> Result<Model, InputError> {
    let default = AdultText::default();
    let size = text.model.adult.as_ref().unwrap_or(&default);
    let sex = match size.sex {
        SexText::Female => Sex::Female,
        SexText::Male => Sex::Male,
    };
    let part = match size.part {
        PartText::Whole => Part::Whole,
        PartText::RightArm => Part::RightArm,
    };
    let lengths = size.lengths_m.iter().map(|(name, length)| (name.clone(), *length)).collect();
    let size = Adult { sex, stature: size.stature_m, mass: size.mass_kg, part, lengths };
    let mut model = adult(&size).map_err(|error| {
        let key = match &error {
            AdultError::Size { what: "mass (kg)", .. } => "mass_kg",
            AdultError::Size { what: "stature (m)", .. } => "stature_m",
            _ => "lengths_m",
        };
        at.error(&["model", "adult", key], error.to_string(), None)
    })?;
    if text.fatigue.law == LawText::Endurance {
        for index in 0..model.coordinates().len() {
            let sources = data::library().sources(&model.coordinates()[index].name);
            let class = sources.and_then(|sources| sources.fatigue_class).unwrap_or("general");
            let name = text.fatigue.curve.clone().unwrap_or_else(|| data::library().default_endurance(class));
            let Some((law, _)) = data::library().endurance(&name) else {
                let help = suggestion(&name, data::library().endurance_names().collect::<Vec<_>>());
                return Err(at.error(&["fatigue", "curve"], format!("there is no endurance curve `{name}`"), help));
            };
            model = model.with_fatigue(index, &law);
        }
    } else if text.fatigue.curve.is_some() {
        let help = Some("add `law = \"endurance\"`, or leave `curve` out".to_owned());
        return Err(at.key_error(&["fatigue", "curve"], "an endurance curve needs the endurance law", help));
    }
    Ok(model)
}

pub(super) fn coordinate(at: &Located, model: &Model, path: &[&str], name: &str) -> Result<usize, InputError> {
    model.coordinate(name).ok_or_else(|| {
        let help = suggestion(name, model.coordinates().iter().map(|c| c.name.as_str()));
        at.key_error(path, format!("the body has no coordinate `{name}`"), help)
    })
}

/// Index and value of the coordinate that the key at the end of `path` names: `NAME_deg`, `NAME_m`, or a quaternion's bare
/// name.
pub(super) fn posture_value(
    at: &Located,
    model: &Model,
    path: &[&str],
    value: f64,
) -> Result<(usize, f64), InputError> {
    const ENDINGS: &str = "rotations end in _deg, slides in _m";
    /// Beyond a limit by so little is rounding of degrees, rad or m.
    const ROUNDING: f64 = 1e-9;
    let key = path.last().copied().unwrap_or_default();
    let (name, unit) = match key.rsplit_once('_') {
        _ if model.coordinate(key).is_some_and(|i| model.coordinates()[i].kind == CoordinateKind::Quaternion) => {
            (key, CoordinateKind::Quaternion)
        }
        Some((name, "deg")) => (name, CoordinateKind::Rotation),
        Some((name, "m")) => (name, CoordinateKind::Translation),
        _ => {
            let message = format!("posture key `{key}` names no unit; {ENDINGS}");
            return Err(at.key_error(path, message, suggestion(key, keys(model).iter().map(String::as_str))));
        }
    };
    let index = model.coordinate(name).ok_or_else(|| {
        let help = suggestion(key, keys(model).iter().map(String::as_str));
        at.key_error(path, format!("the body has no coordinate `{name}`"), help)
    })?;
    let found = &model.coordinates()[index];
    if found.kind != unit {
        let message = format!("`{name}` is not measured in the unit that `{key}` names");
        return Err(at.key_error(path, message, Some(ENDINGS.into())));
    }
    let inside = if unit == CoordinateKind::Rotation { value.to_radians() } else { value };
    let (min, max) = found.range;
    if inside < min - ROUNDING || inside > max + ROUNDING {
        let show = |x: f64| if unit == CoordinateKind::Rotation { x.to_degrees() } else { x };
        let word = if unit == CoordinateKind::Rotation { "deg" } else { "m" };
        let (min, max) = (show(min), show(max));
        let message = format!("`{name}` is {} {word}, outside its range {min:.4}..{max:.4} {word}", shown(value));
        return Err(at.error(path, message, Some(format!("give an angle from {min:.4} to {max:.4} {word}"))));
    }
    Ok((index, inside.max(min).min(max)))
}

/// What keys of postures may be.
fn keys(model: &Model) -> Vec<String> {
    let key = |c: &Coordinate| match c.kind {
        CoordinateKind::Rotation => format!("{}_deg", c.name),
        CoordinateKind::Translation => format!("{}_m", c.name),
        CoordinateKind::Quaternion => c.name.clone(),
    };
    model.coordinates().iter().map(key).collect()
}

pub(super) fn free(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    otherwise: impl Fn(&Coordinate) -> bool,
) -> Result<Vec<bool>, InputError> {
    let n = model.coordinates().len();
    let (list, key, listed) = match (&text.coordinates.free, &text.coordinates.locked) {
        (Some(_), Some(_)) => {
            let help = Some("keep one of the two lists".to_owned());
            return Err(at.key_error(&["coordinates", "locked"], "both `free` and `locked` are given", help));
        }
        (Some(list), None) => (list, "free", true),
        (None, Some(list)) => (list, "locked", false),
        (None, None) => return Ok(model.coordinates().iter().map(otherwise).collect()),
    };
    let mut flags = vec![!listed; n];
    for (i, name) in list.iter().enumerate() {
        flags[coordinate(at, model, &["coordinates", key, &i.to_string()], name)?] = listed;
    }
    Ok(flags)
}

pub(super) fn load(at: &Located, model: &Model, i: usize, text: &LoadText) -> Result<Load, InputError> {
    load_at(at, model, &["load", &i.to_string()], text)
}

fn load_at(at: &Located, model: &Model, table: &[&str], text: &LoadText) -> Result<Load, InputError> {
    let path = |key| table.iter().copied().chain([key]).collect::<Vec<&str>>();
    let Some(segment) = model.segment(&text.segment) else {
        let help = suggestion(&text.segment, model.segments().iter().map(|s| s.name.as_str()));
        return Err(at.error(&path("segment"), format!("the body has no segment `{}`", text.segment), help));
    };
    let point = text.at_m.map_or(model.segments()[segment].center_of_mass, Vector3::from);
    let kind = match (text.mass_kg, text.force_n) {
        (Some(mass), None) if text.fixed_in.is_none() => LoadKind::Weight(mass),
        (Some(_), None) => {
            let help = Some("leave `fixed_in` out".to_owned());
            return Err(at.key_error(&path("fixed_in"), "a weight always pulls along gravity", help));
        }
        (None, Some(force)) => {
            let fixed_in = match text.fixed_in {
                Some(FixedInText::Segment) => FixedIn::Segment,
                _ => FixedIn::World,
            };
            LoadKind::Force(Vector3::from(force), fixed_in)
        }
        _ => {
            let help = Some("give one of `mass_kg` and `force_n`".to_owned());
            return Err(at.error(table, "a load is either a weight or a force", help));
        }
    };
    let load = Load { segment, point, kind };
    load.check(model).map_err(|error| {
        let message = error.to_string();
        let keys = [("mass", "mass_kg"), ("force", "force_n"), ("point", "at_m")];
        let key = keys.iter().find(|(word, _)| message.starts_with(word)).map_or("", |(_, key)| key);
        at.error(&path(key), message, None)
    })?;
    Ok(load)
}

/// The curve that the table at `path` describes, over the coordinate's range. `sign` -1: the coordinate runs against a named
/// curve; when left out, as the built-in coordinate of that name does.
pub(crate) fn passive_curve(
    at: &Located,
    path: &[&str],
    coordinate: &Coordinate,
    sign: Option<f64>,
    text: &PassiveText,
) -> Result<PassiveCurve, InputError> {
    let (name, range) = (&coordinate.name, coordinate.range);
    let refuse = |key: &str, error: PassiveError| {
        let message = match &error {
            PassiveError::Parameter { name, value, accepted } if name.ends_with("(rad)") => {
                let name = name.replace("(rad)", "(deg)");
                format!("{name} is {:.6}; it must be {accepted}", value.to_degrees())
            }
            _ => error.to_string(),
        };
        at.error(&below(path, key), message, None)
    };
    let given = [
        text.curve.is_some(),
        text.double_exponential.is_some(),
        text.coordinate_limit_force.is_some(),
        text.table_deg_nm.is_some(),
    ];
    if given.iter().filter(|given| **given).count() > 1 {
        let help = Some("keep one of curve, double_exponential, coordinate_limit_force, table_deg_nm".to_owned());
        return Err(at.error(path, "more than one curve is given", help));
    }
    let (key, curve) = if let Some(curve) = &text.curve {
        let Some(row) = data::library().curve(curve) else {
            let help = suggestion(curve, data::library().curve_names().collect::<Vec<_>>());
            return Err(at.error(&below(path, "curve"), format!("there is no passive curve `{curve}`"), help));
        };
        // The built-in curve of this coordinate may run against its direction; others are taken as they are.
        let own = data::library().sources(name).filter(|s| s.curve == Some(curve.as_str()));
        let sign = sign.or(own.map(|s| s.curve_sign)).unwrap_or(1.0);
        ("curve", row.over(range, sign))
    } else if let Some(law) = &text.double_exponential {
        let form = double_exponential(law).form();
        ("double_exponential", form.and_then(|form| PassiveCurve::new(form, range, None)))
    } else if let Some(law) = &text.coordinate_limit_force {
        let law = CoordinateLimitForce {
            upper_stiffness: law.upper_stiffness_nm_per_deg.to_degrees(),
            upper_limit: law.upper_limit_deg.to_radians(),
            lower_stiffness: law.lower_stiffness_nm_per_deg.to_degrees(),
            lower_limit: law.lower_limit_deg.to_radians(),
            transition: law.transition_deg.to_radians(),
        };
        ("coordinate_limit_force", law.form().and_then(|form| PassiveCurve::new(form, range, None)))
    } else if let Some(rows) = &text.table_deg_nm {
        let rows: Vec<(f64, f64)> = rows.iter().map(|[deg, nm]| (deg.to_radians(), *nm)).collect();
        ("table_deg_nm", Tabulated::new(&rows).and_then(|table| PassiveCurve::new(table.form(), range, None)))
    } else {
        match coordinate.curve() {
            Some(curve) => ("reshape", Ok(curve.clone())),
            None => return Err(at.error(path, "no curve is given", None)),
        }
    };
    let curve = curve.map_err(|error| refuse(key, error))?;
    let (zone, end_torque) = match text.reshape {
        None | Some(ReshapeText::Default(false)) => return Ok(curve),
        Some(ReshapeText::Default(true)) => {
            let (zone, torque, _) = data::library().reshape();
            (zone, torque)
        }
        Some(ReshapeText::Stated(stated)) => (stated.zone_deg.to_radians(), stated.end_torque_nm),
    };
    data::reshaped(&curve, zone, end_torque).map_err(|error| refuse("reshape", error))
}

/// The path of a key of the table at `path`.
fn below<'a>(path: &[&'a str], key: &'a str) -> Vec<&'a str> {
    path.iter().copied().chain([key]).collect()
}

/// The law in rad.
pub(crate) fn double_exponential(text: &DoubleExponentialText) -> DoubleExponential {
    let end = |end: &EndText| End { torque: end.torque_nm, rate: end.rate_per_rad, angle: end.angle_deg.to_radians() };
    DoubleExponential {
        lower: end(&text.lower),
        upper: end(&text.upper),
        stiffness: text.stiffness_nm_per_rad,
        neutral: text.neutral_deg.to_radians(),
    }
}
