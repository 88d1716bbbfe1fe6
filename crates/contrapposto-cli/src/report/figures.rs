//! `--figures`: what the page shows, as pictures for paper. The body at the start, at its hardest and at the end; torques and
//! course of the joints that matter.

use contrapposto::model::CoordinateKind;
use contrapposto::simulation::{Scenario, Summary};
use contrapposto_plot::{BodyFigure, BodyPosture, Figure, TorqueBalance, body_figure, time_line, torque_balance};

use super::film::{Film, Frame};
use super::{ANGLES, body, main_coordinate, shown, visible, words};
use crate::chart::{Sweep, angle_label, course};
use crate::fail::Fail;
use crate::simulate::{Recording, story};

/// The folder of all of them, in that of the results.
pub(crate) const FOLDER: &str = "figures";
/// Charts are drawn of so many joints at most: the main one, and of the others those that worked hardest.
const MOST_JOINTS: usize = 5;
/// Joints that never worked harder than this share of their strength are left out.
const IDLE: f64 = 0.05;
/// The hardest moment is one of its own if effort is so many times that of the start and of the end.
const HARDER: f64 = 1.05;

/// Names, in [`FOLDER`], and contents of all figures of a run.
pub(crate) fn figures_of_run(
    scenario: &Scenario,
    recording: &Recording,
    summary: &Summary,
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let film = Film::new(scenario, recording, summary);
    let mut figures = vec![("body".to_owned(), body_figure(&moments(scenario, &film)?))];
    for (number, i) in joints(scenario, summary).into_iter().enumerate() {
        let coordinate = &scenario.model.coordinates()[i];
        let named = |chart: &str| format!("{chart}-{}-{}", number + 1, plain_name(&coordinate.name));
        let mut line = course(recording, &summary.reliefs, i);
        line.title.clone_from(&scenario.title);
        line.subtitle = format!("{}, {}", words::plain(&coordinate.name), story(scenario, &summary.coordinates[i]));
        line.coordinate.clone_from(&coordinate.name);
        line.critical_level = scenario.hysteresis.critical_level;
        line.recovery_level = scenario.hysteresis.recovery_level;
        let mut balance = balance(scenario, &film, i)?;
        (balance.title, balance.subtitle) = (line.title.clone(), line.subtitle.clone());
        figures.push((named("torque-balance"), torque_balance(&[balance])));
        figures.push((named("time-line"), time_line(&line)));
    }
    let mut files = vec![];
    for (name, figure) in figures {
        files.extend(both(&format!("{FOLDER}/{name}"), &figure)?);
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
pub(crate) fn before_and_after(scenario: &Scenario, recording: &Recording, subtitle: &str) -> Result<BodyFigure, Fail> {
    let rows = recording.times().len();
    let [first, last] = [0, rows.saturating_sub(1)].map(|row| Frame::new(recording.row(row)));
    let mut posture = body::body(&scenario.model, &scenario.supports, &last)?;
    posture.start = body::parts(&scenario.model, &first.posture, None)?;
    posture.notes = vec![body::key_numbers(&scenario.model, &scenario.supports, &last).join("; ")];
    Ok(BodyFigure {
        title: scenario.title.clone(),
        subtitle: subtitle.to_owned(),
        postures: vec![posture],
        ..BodyFigure::default()
    })
}

/// The body at the start, at its hardest if that is another moment, and at the end.
fn moments(scenario: &Scenario, film: &Film) -> Result<BodyFigure, Fail> {
    let mut postures: Vec<BodyPosture> = vec![];
    let mut show = |title: String, frame: &Frame| -> Result<(), Fail> {
        let mut posture = body::body(&scenario.model, &scenario.supports, frame)?;
        posture.title = title;
        posture.notes = body::key_numbers(&scenario.model, &scenario.supports, frame);
        postures.push(posture);
        Ok(())
    };
    if let (Some(first), Some(last)) = (film.frames.first(), film.frames.last()) {
        show("start".to_owned(), first)?;
        let hardest = film.frames.iter().max_by(|a, b| a.effort().total_cmp(&b.effort()));
        if let Some(hardest) = hardest.filter(|h| h.effort() > HARDER * first.effort().max(last.effort())) {
            show(format!("hardest moment, {}", seconds(hardest.time)), hardest)?;
        }
        if last.time > first.time {
            show(format!("end, {}", seconds(last.time)), last)?;
        }
    }
    Ok(BodyFigure { title: scenario.title.clone(), postures, ..BodyFigure::default() })
}

fn seconds(time: f64) -> String {
    if time < 10.0 { format!("{time:.1} s") } else { format!("{time:.0} s") }
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

/// Torques of a joint over its range, and how they went. Under a body that stands external torque is known only where it has been.
fn balance(scenario: &Scenario, film: &Film, i: usize) -> Result<TorqueBalance, Fail> {
    let Some(last) = film.frames.last() else { return Ok(TorqueBalance::default()) };
    let coordinate = &scenario.model.coordinates()[i];
    let at = |frame: &Frame, torque: f64| (visible(coordinate, frame.posture[i]), torque);
    let path: Vec<(f64, f64)> = film.frames.iter().map(|frame| at(frame, frame.active(i))).collect();
    let mut chart = if scenario.is_whole() {
        let mut chart = TorqueBalance {
            angle_label: angle_label(&coordinate.name, &coordinate.positive),
            tolerance_nm: scenario.relief.torque_tolerance,
            external_path: film.frames.iter().map(|frame| at(frame, frame.external[i])).collect(),
            ..TorqueBalance::default()
        };
        let ((min, max), mut values) = (coordinate.range, last.posture.clone());
        for k in 0..ANGLES {
            values[i] = min + (max - min) * k as f64 / (ANGLES - 1) as f64;
            chart.angles_deg.push(visible(coordinate, values[i]));
            chart.minus_passive_nm.push(-coordinate.passive.as_ref().map_or(0.0, |law| law.torque(i, &values)));
        }
        chart
    } else {
        Sweep::new(scenario, i, &last.posture).balance("", "")?
    };
    (chart.start, chart.goal) = (path.first().copied(), path.last().copied());
    chart.path = path;
    Ok(chart)
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
