//! Pictures of results: the body at the start, at its highest effort and at the end; torques and
//! course of the joints that matter.

use contrapposto::model::{Coordinate, CoordinateKind, Model};
use contrapposto::simulation::{Scenario, Summary};
use contrapposto_formats::Thing;
use contrapposto_plot::{
    BodyFigure, BodyPosture, Figure, SketchRole, TimeLine, TorqueBalance, body_figure, time_line, torque_balance,
};

use super::axes::visible;
use super::charts::{Sweep, angle_label, course};
use super::excerpt::RunExcerpt;
use super::frame::Frame;
use super::muscle_work::MusclesAtWork;
use super::recording::Recording;
use super::scene::ANGLES;
use super::selection::{main_coordinate, shown};
use super::stage::Stage;
use super::text::simulate::strategy_in_words;
use super::words::how_long;
use super::{body, words};
use crate::fail::Fail;

/// The folder of all of them, in that of the results.
pub(crate) const FOLDER: &str = "figures";
/// Charts are drawn of so many joints at most: the main one, and of the others those that worked hardest.
const MOST_JOINTS: usize = 5;
/// Joints that never worked harder than this share of their strength are left out.
const IDLE: f64 = 0.05;
/// The hardest moment is one of its own if effort is so many times that of the start and of the end.
const HARDER: f64 = 1.05;
/// A coordinate that moves less, rad or m, is at rest.
const STILL: f64 = 1e-3;

/// Names, in [`FOLDER`], and contents of all figures of a run.
pub(crate) fn figures_of_run(
    scenario: &Scenario,
    things: &[Thing],
    (recording, muscles): (&Recording, Option<&MusclesAtWork<'_>>),
    summary: &Summary,
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let model = &scenario.model;
    let excerpt = RunExcerpt::new(scenario, recording, summary);
    let mut figures = vec![(
        "body".to_owned(),
        moments(&scenario.title, model, &Stage::of_run(scenario, things), (&excerpt.frames, muscles))?,
    )];
    for (number, i) in joints(scenario, summary).into_iter().enumerate() {
        let mut line = course(model, recording, &summary.reliefs, i);
        line.subtitle = strategy_in_words(scenario, &summary.coordinates[i]);
        line.critical_level = scenario.hysteresis.critical_level;
        line.recovery_level = scenario.hysteresis.recovery_level;
        let balance = match scenario.has_supports_or_tasks() {
            true => visited_torques(model, &excerpt.frames, i)?,
            false => swept_torques(scenario, &excerpt.frames, i)?,
        };
        let balance = TorqueBalance { tolerance_nm: scenario.relief.torque_tolerance, ..balance };
        charts(&mut figures, &scenario.title, (number, &model.coordinates()[i]), balance, line);
    }
    files(&figures)
}

/// The same of a motion that was assessed; `moving`: inertia counts. `worst`: coordinates of its groups, the first to fail first.
pub(crate) fn figures_of_assessment(
    (title, moving): (&str, bool),
    model: &Model,
    stage: &Stage<'_>,
    (frames, muscles): (&[Frame], Option<&MusclesAtWork<'_>>),
    worst: impl Iterator<Item = usize>,
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let mut figures = vec![("body".to_owned(), moments(title, model, stage, (frames, muscles))?)];
    let mut shown: Vec<usize> = vec![];
    for i in worst.filter(|&i| model.coordinates()[i].kind == CoordinateKind::Rotation) {
        if !shown.contains(&i) && shown.len() < MOST_JOINTS {
            shown.push(i);
        }
    }
    for (number, i) in shown.into_iter().enumerate() {
        let over = |value: &dyn Fn(&Frame) -> f64| frames.iter().map(value).collect::<Vec<f64>>();
        let line = TimeLine {
            subtitle: (if moving { "inertia counts" } else { "every posture held at rest" }).to_owned(),
            time_s: over(&|frame| frame.time),
            angle_deg: over(&|frame| frame.angles[i].to_degrees()),
            external_nm: over(&|frame| frame.external[i]),
            passive_nm: over(&|frame| frame.passive[i]),
            active_nm: over(&|frame| frame.active(i)),
            fatigue_positive: over(&|frame| tired(frame, i, 0)),
            fatigue_negative: over(&|frame| tired(frame, i, 1)),
            critical_level: f64::NAN,
            recovery_level: f64::NAN,
            ..TimeLine::default()
        };
        charts(&mut figures, title, (number, &model.coordinates()[i]), visited_torques(model, frames, i)?, line);
    }
    files(&figures)
}

/// Torque balances of postures that stand for themselves, one panel each, of the joints that work hardest in any of them.
pub(crate) fn figures_of_postures(
    title: &str,
    model: &Model,
    frames: &[Frame],
    names: &[String],
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let hardest = |i: usize| frames.iter().fold(0.0, |most: f64, frame| most.max(frame.load[i]));
    let turns = |i: &usize| model.coordinates()[*i].kind == CoordinateKind::Rotation;
    let mut joints: Vec<usize> = shown(model).into_iter().filter(turns).filter(|&i| hardest(i) >= IDLE).collect();
    joints.sort_by(|&a, &b| hardest(b).total_cmp(&hardest(a)));
    let mut figures = vec![];
    for (number, i) in joints.into_iter().take(MOST_JOINTS).enumerate() {
        let coordinate = &model.coordinates()[i];
        let panel = |(frame, name): (&Frame, &String)| {
            let subtitle = format!("{}, {name}", words::plain(&coordinate.name));
            let balance = visited_torques(model, std::slice::from_ref(frame), i)?;
            Ok(TorqueBalance { title: title.to_owned(), subtitle, goal: None, ..balance })
        };
        let panels = frames.iter().zip(names).map(panel).collect::<Result<Vec<_>, Fail>>()?;
        let name = format!("torque-balance-{}-{}", number + 1, plain_name(&coordinate.name));
        figures.push((name, torque_balance(&panels)));
    }
    files(&figures)
}

/// Fatigue of a group; NaN where it is not known.
fn tired(frame: &Frame, i: usize, side: usize) -> f64 {
    frame.fatigue.as_ref().map_or(f64::NAN, |fatigue| fatigue[i][side])
}

/// Both charts of joint `number`, counted from 0.
fn charts(
    figures: &mut Vec<(String, Figure)>,
    title: &str,
    (number, coordinate): (usize, &Coordinate),
    mut balance: TorqueBalance,
    mut line: TimeLine,
) {
    title.clone_into(&mut line.title);
    line.subtitle = format!("{}, {}", words::plain(&coordinate.name), line.subtitle);
    line.coordinate.clone_from(&coordinate.name);
    (balance.title, balance.subtitle) = (line.title.clone(), line.subtitle.clone());
    let named = |chart: &str| format!("{chart}-{}-{}", number + 1, plain_name(&coordinate.name));
    figures.push((named("torque-balance"), torque_balance(&[balance])));
    figures.push((named("time-line"), time_line(&line)));
}

fn files(figures: &[(String, Figure)]) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let mut files = vec![];
    for (name, figure) in figures {
        files.extend(both(&format!("{FOLDER}/{name}"), figure)?);
    }
    Ok(files)
}

/// A figure as SVG and PNG.
pub(crate) fn both(name: &str, figure: &Figure) -> Result<[(String, Vec<u8>); 2], Fail> {
    let [svg, png] = ["svg", "png"].map(|ending| format!("{name}.{ending}"));
    let bytes = figure.png().map_err(|error| Fail::job(&png, error))?;
    Ok([(svg, figure.svg().into_bytes()), (png, bytes)])
}

/// The body as a run leaves it, and pale as it began.
fn before_and_after(
    scenario: &Scenario,
    things: &[Thing],
    (recording, muscles): (&Recording, Option<&MusclesAtWork<'_>>),
    subtitle: &str,
) -> Result<BodyFigure, Fail> {
    let rows = recording.times().len();
    let [first, last] = [0, rows.saturating_sub(1)].map(|row| Frame::of_row(&scenario.model, recording.row(row)));
    let mut posture = body::body(&scenario.model, &Stage::of_run(scenario, things), &last)?;
    posture.start = body::parts(&scenario.model, &first.posture, None)?;
    posture.notes = vec![body::key_numbers(&scenario.model, &scenario.supports, &last).join("; ")];
    if let Some(muscles) = muscles {
        posture.muscles = muscles.drawn(muscles.moments.len().saturating_sub(1), &last.posture)?;
    }
    Ok(BodyFigure {
        title: scenario.title.clone(),
        subtitle: subtitle.to_owned(),
        postures: vec![posture],
        ..BodyFigure::default()
    })
}

/// The pictures of a run: the body before and after (one joint: its torques over angle), and the main coordinate over time.
pub(crate) fn pictures_of_run(
    scenario: &Scenario,
    things: &[Thing],
    summary: &Summary,
    (recording, muscles): (&Recording, Option<&MusclesAtWork<'_>>),
) -> Result<[Figure; 2], Fail> {
    let main = main_coordinate(scenario, summary);
    let coordinate = &scenario.model.coordinates()[main];
    let subtitle = strategy_in_words(scenario, &summary.coordinates[main]);
    let mut line = course(&scenario.model, recording, &summary.reliefs, main);
    line.title = scenario.title.clone();
    line.subtitle.clone_from(&subtitle);
    line.coordinate.clone_from(&coordinate.name);
    line.critical_level = scenario.hysteresis.critical_level;
    line.recovery_level = scenario.hysteresis.recovery_level;
    if scenario.has_supports_or_tasks() {
        return Ok([
            body_figure(&before_and_after(scenario, things, (recording, muscles), &subtitle)?),
            time_line(&line),
        ]);
    }
    let posture: Vec<f64> = summary.coordinates.iter().map(|c| c.final_value).collect();
    let mut sweep = Sweep::new(&scenario.model, &scenario.loads, main, &posture)?;
    let mut balance = sweep.balance(&scenario.title, &subtitle, scenario.relief.torque_tolerance)?;
    balance.path = line.angle_deg.iter().copied().zip(line.active_nm.iter().copied()).collect();
    balance.start = balance.path.first().copied();
    balance.goal = balance.path.last().copied();
    if let (Some(start), Some(goal)) = (balance.start, balance.goal) {
        balance.postures.push(sweep.sketch("start", start.0, SketchRole::Start)?);
        balance.postures.push(sweep.sketch("end", goal.0, SketchRole::Goal)?);
    }
    Ok([torque_balance(&[balance]), time_line(&line)])
}

/// The body at the start, at its hardest if that is another moment, and at the end.
fn moments(
    title: &str,
    model: &Model,
    stage: &Stage<'_>,
    (frames, muscles): (&[Frame], Option<&MusclesAtWork<'_>>),
) -> Result<Figure, Fail> {
    let mut postures: Vec<BodyPosture> = vec![];
    let mut show = |title: String, number: usize| -> Result<(), Fail> {
        let frame = &frames[number];
        let mut posture = body::body(model, stage, frame)?;
        posture.muscles = muscles.map_or(Ok(vec![]), |muscles| muscles.drawn(number, &frame.posture))?;
        posture.title = title;
        posture.notes = body::key_numbers(model, stage.supports, frame);
        postures.push(posture);
        Ok(())
    };
    if let (Some(first), Some(last)) = (frames.first(), frames.last()) {
        let still = |frame: &Frame| frame.posture.iter().zip(&first.posture).all(|(a, b)| (a - b).abs() < STILL);
        let throughout = last.time > first.time && frames.iter().all(still);
        show(if throughout { format!("throughout, {}", how_long(last.time)) } else { "start".to_owned() }, 0)?;
        let hardest = (0..frames.len()).max_by(|&a, &b| frames[a].effort().total_cmp(&frames[b].effort()));
        let harder = HARDER * first.effort().max(last.effort());
        if let Some(hardest) = hardest.filter(|&number| frames[number].effort() > harder) {
            show(format!("hardest moment, {}", how_long(frames[hardest].time)), hardest)?;
        }
        if last.time > first.time && !throughout {
            show(format!("end, {}", how_long(last.time)), frames.len() - 1)?;
        }
    }
    Ok(body_figure(&BodyFigure { title: title.to_owned(), postures, ..BodyFigure::default() }))
}

/// The joints of which charts are drawn.
fn joints(scenario: &Scenario, summary: &Summary) -> Vec<usize> {
    let main = main_coordinate(scenario, summary);
    let peak = |i: usize| summary.coordinates[i].peak_load;
    let turns = |i: &usize| scenario.model.coordinates()[*i].kind == CoordinateKind::Rotation;
    let mut others: Vec<usize> = shown(&scenario.model).into_iter().filter(|&i| i != main && peak(i) >= IDLE).collect();
    others.sort_by(|&a, &b| peak(b).total_cmp(&peak(a)));
    std::iter::once(main).chain(others).filter(turns).take(MOST_JOINTS).collect()
}

/// Torques of a joint over its range while all other coordinates are held, and its active torque in the frames.
fn swept_torques(scenario: &Scenario, frames: &[Frame], i: usize) -> Result<TorqueBalance, Fail> {
    let Some(last) = frames.last() else { return Ok(TorqueBalance::default()) };
    let chart = Sweep::new(&scenario.model, &scenario.loads, i, &last.posture)?.balance("", "", 0.0)?;
    Ok(with_path(chart, &scenario.model.coordinates()[i], frames, i))
}

/// Torques of a joint of a body on supports: passive torque over its range, external torque in the frames.
fn visited_torques(model: &Model, frames: &[Frame], i: usize) -> Result<TorqueBalance, Fail> {
    let Some(last) = frames.last() else { return Ok(TorqueBalance::default()) };
    let coordinate = &model.coordinates()[i];
    let mut sweep = Sweep::new(model, &[], i, &last.posture)?;
    let (min, max) = sweep.range();
    let mut chart = TorqueBalance {
        angle_label: angle_label(&coordinate.name, &coordinate.positive),
        external_path: frames.iter().map(|frame| (visible(coordinate, frame.angles[i]), frame.external[i])).collect(),
        ..TorqueBalance::default()
    };
    for k in 0..ANGLES {
        let angle = min + (max - min) * k as f64 / (ANGLES - 1) as f64;
        chart.angles_deg.push(visible(coordinate, angle));
        chart.minus_passive_nm.push(-sweep.passive(angle));
    }
    Ok(with_path(chart, coordinate, frames, i))
}

/// Adds the active torque of the frames.
fn with_path(mut chart: TorqueBalance, coordinate: &Coordinate, frames: &[Frame], i: usize) -> TorqueBalance {
    chart.path = frames.iter().map(|frame| (visible(coordinate, frame.angles[i]), frame.active(i))).collect();
    (chart.start, chart.goal) = (chart.path.first().copied(), chart.path.last().copied());
    chart
}

/// A name that every file system takes.
fn plain_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    name.chars().take(60).map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::plain_name;

    #[test]
    fn names_of_files_stay_in_their_folder() {
        assert_eq!(plain_name("hip_adduction_r"), "hip_adduction_r");
        assert_eq!(plain_name("../../etc/\u{0} é"), "------etc----");
        assert_eq!(plain_name(&"x".repeat(1000)).len(), 60);
    }
}
