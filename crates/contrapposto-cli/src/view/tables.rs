//! The tables of a run, for spreadsheets, OpenSim and `torques --grf`.

use std::fmt::Display;

use contrapposto::joint_torques::active_torque;
use contrapposto::model::{Coordinate, CoordinateKind};
use contrapposto::simulation::Scenario;
use contrapposto_formats::motion::write_sto;
use contrapposto_formats::write::osim_motion;
use contrapposto_formats::{TableRow, csv_header, csv_row};

use super::recording::{Recording, Row};
use super::three_axis::of_coordinates;
use crate::fail::Fail;

/// `trajectory.csv`.
pub(crate) fn trajectory(scenario: &Scenario, recording: &Recording) -> String {
    let mut text = csv_header(&scenario.model);
    text.push('\n');
    for row in recording.rows() {
        let Row { time, posture, external, passive, fatigue, asked, .. } = row;
        csv_row(&scenario.model, &TableRow { time, posture, external, passive, fatigue, asked }, &mut text);
    }
    text
}

/// `motion.mot`: every coordinate, in degrees where OpenSim agrees on what is an angle; it plays `model.osim`.
pub(crate) fn motion(scenario: &Scenario, recording: &Recording) -> Result<String, Fail> {
    let rows: Vec<&[f64]> = recording.rows().map(|row| row.posture).collect();
    osim_motion(&scenario.model, title(scenario), recording.times(), &rows).map_err(failed("motion.mot"))
}

/// `torques.sto`: external, passive and active torque of every coordinate, N m (N for slides), those of OpenSim's generalised forces.
pub(crate) fn torques(scenario: &Scenario, recording: &Recording) -> Result<String, Fail> {
    let names = ["external", "passive", "active"];
    let row = |row: Row| {
        let of = |torques| of_coordinates(&scenario.model, row.posture, torques);
        let torques = of(row.external).into_iter().zip(of(row.passive));
        torques.flat_map(|(external, passive)| [external, passive, active_torque(external, passive)]).collect()
    };
    table("torques.sto", scenario, recording, &names, row)
}

/// `fatigue.sto`: of the positive and negative muscle group of every coordinate, 0 to 1.
pub(crate) fn fatigue(scenario: &Scenario, recording: &Recording) -> Result<String, Fail> {
    let row = |row: Row| row.fatigue.iter().flatten().copied().collect();
    table("fatigue.sto", scenario, recording, &["positive", "negative"], row)
}

/// `ground_reaction.mot`: force on the body, where it acts and the couple about that point, for every support.
pub(crate) fn ground_reaction(scenario: &Scenario, recording: &Recording) -> Result<String, Fail> {
    let segments = scenario.model.segments();
    let mut labels: Vec<String> = vec![];
    for (i, support) in scenario.supports.iter().enumerate() {
        let name = &segments[support.segment].name;
        let shared = scenario.supports.iter().filter(|other| other.segment == support.segment).count() > 1;
        let plate = if shared { format!("{}_{name}", i + 1) } else { name.clone() };
        for part in ["force_v", "force_p", "torque_"] {
            labels.extend(["x", "y", "z"].map(|axis| format!("{plate}_ground_{part}{axis}")));
        }
    }
    let rows: Vec<Vec<f64>> =
        recording.rows().map(|row| row.contacts.iter().flat_map(|contact| contact[1..].to_vec()).collect()).collect();
    write("ground_reaction.mot", scenario, recording, &labels, &rows)
}

/// A table with one column for each part of each coordinate, `NAME_external` and so on.
fn table(
    file: &'static str,
    scenario: &Scenario,
    recording: &Recording,
    parts: &[&str],
    row: impl Fn(Row) -> Vec<f64>,
) -> Result<String, Fail> {
    let labels = |c: &Coordinate| parts.iter().map(|part| format!("{}_{part}", c.name)).collect::<Vec<_>>();
    let labels: Vec<String> = scenario.model.coordinates().iter().flat_map(labels).collect();
    let rows: Vec<Vec<f64>> = recording.rows().map(row).collect();
    write(file, scenario, recording, &labels, &rows)
}

fn write(
    file: &'static str,
    scenario: &Scenario,
    recording: &Recording,
    labels: &[String],
    rows: &[Vec<f64>],
) -> Result<String, Fail> {
    let columns: Vec<_> = labels.iter().map(|label| (label.as_str(), CoordinateKind::Translation)).collect();
    write_sto(title(scenario), &columns, false, recording.times(), rows).map_err(failed(file))
}

fn title(scenario: &Scenario) -> &str {
    if scenario.title.is_empty() { "run" } else { &scenario.title }
}

fn failed<E: Display>(file: &'static str) -> impl Fn(E) -> Fail {
    move |error| Fail::job(file, error)
}
