//! `--grf FILE.mot`: what the ground pushes with, as OpenSim's tables hold it.
//!
//! Force and point in ground axes, and a couple about that point, for every plate: `ground_force_vx`, `ground_force_px`,
//! `ground_torque_x` and so on, with anything before `ground` or after `force` to tell the plates apart (`1_ground_force_vx`,
//! `ground_force_r_vx`).

use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_formats::motion::{self, Table, read_table};
use nalgebra::{Point3, Vector3};

use super::loads::no_segment;
use crate::fail::Fail;
use crate::input::read;

/// Time beyond the table's ends that rounding may give, s.
const SLACK: f64 = 1e-6;

/// Ground reactions over time.
pub(crate) struct GroundReaction {
    name: String,
    table: Table,
    plates: Vec<Plate>,
}

struct Plate {
    segment: usize,
    /// First columns of force, point and couple; their y and z by the same label.
    columns: [[usize; 3]; 3],
    coupled: bool,
}

impl GroundReaction {
    /// Reads the file; `on` names the segments, in the order of the plates. Notes say what was guessed.
    pub(crate) fn read(path: &Path, on: &[String], model: &Model, notes: &mut Vec<String>) -> Result<Self, Fail> {
        let name = path.display().to_string();
        let table = read_table(&name, &read(path, motion::MOST_BYTES as u64)?)?;
        let refuse = |why: String| Fail::Refused(format!("{name}: {why}"));
        let labels: Vec<String> = table.columns.iter().map(|label| label.to_ascii_lowercase()).collect();
        let found: Vec<Columns> = labels
            .iter()
            .filter_map(|label| Columns::find(label, &labels))
            .collect::<Result<_, _>>()
            .map_err(refuse)?;
        if found.is_empty() {
            let why =
                "no column is named like `ground_force_vx` (with ground_force_px and, if wanted, ground_torque_x)";
            return Err(refuse(why.to_owned()));
        }
        if !on.is_empty() && on.len() != found.len() {
            let stems: Vec<&str> = found.iter().map(|columns| columns.label.as_str()).collect();
            let (given, needed) = (on.len(), found.len());
            return Err(Fail::Refused(format!(
                "--grf-on names {given} segments; {name} has {needed} ground reactions ({})",
                stems.join(", ")
            )));
        }
        let mut plates = vec![];
        for (i, columns) in found.into_iter().enumerate() {
            let segment = match on.get(i) {
                Some(segment) => model
                    .segment(segment)
                    .ok_or_else(|| Fail::Refused(format!("--grf-on: {}", no_segment(model, segment))))?,
                None => {
                    let guess = columns.guess(i);
                    let segment = model.segment(guess).ok_or_else(|| {
                        let label = &columns.label;
                        refuse(format!(
                            "the segment that `{label}` acts on is not known: name one a plate with --grf-on SEG,SEG"
                        ))
                    })?;
                    notes.push(format!(
                        "`{}` of {name} is taken to act on `{guess}`; --grf-on says otherwise",
                        columns.label
                    ));
                    segment
                }
            };
            plates.push(Plate { segment, columns: columns.columns, coupled: columns.coupled });
        }
        Ok(Self { name, table, plates })
    }

    /// Are there forces at all these times?
    pub(crate) fn check(&self, times: impl Iterator<Item = f64>) -> Result<(), Fail> {
        let all = &self.table.times;
        let (Some(first), Some(last)) = (all.first(), all.last()) else {
            return Err(Fail::Refused(format!("{}: holds no rows", self.name)));
        };
        for (frame, time) in times.enumerate() {
            if time < first - SLACK || time > last + SLACK {
                let name = &self.name;
                return Err(Fail::Refused(format!(
                    "frame {frame} at {time} s has no ground reaction: {name} goes from {first} s to {last} s"
                )));
            }
        }
        Ok(())
    }

    /// Adds the loads at `time` in the posture that `kinematics` holds: world-fixed forces at the points of the segments that
    /// now lie where the ground pushes.
    pub(crate) fn loads(&self, time: f64, model: &Model, kinematics: &Kinematics, loads: &mut Vec<Load>) {
        let Table { times, rows, .. } = &self.table;
        let after = times.partition_point(|t| *t <= time).min(times.len() - 1);
        let before = after.saturating_sub(1);
        let span = times[after] - times[before];
        let share = if span > 0.0 { ((time - times[before]) / span).clamp(0.0, 1.0) } else { 0.0 };
        let value = |column: usize| rows[before][column] + share * (rows[after][column] - rows[before][column]);
        for plate in &self.plates {
            let [force, point, couple] = plate.columns.map(|columns| Vector3::from(columns.map(value)));
            let segment = plate.segment;
            let at = kinematics.placement(model, segment).inverse() * Point3::from(point);
            loads.push(Load { segment, point: at.coords, kind: LoadKind::Force(force, FixedIn::World) });
            if plate.coupled {
                loads.push(Load { segment, point: at.coords, kind: LoadKind::Couple(couple, FixedIn::World) });
            }
        }
    }
}

/// The columns of one plate.
struct Columns {
    label: String,
    /// What tells the plate from others.
    marks: String,
    columns: [[usize; 3]; 3],
    coupled: bool,
}

impl Columns {
    /// The plate whose `ground_force_vx` this is.
    fn find(label: &str, labels: &[String]) -> Option<Result<Self, String>> {
        let (before, rest) = label.split_once("ground_force")?;
        let between = rest.strip_suffix("_vx")?;
        let column = |label: String| labels.iter().position(|other| *other == label).ok_or(label);
        let three = |stem: &str, kind: &str| -> Result<[usize; 3], String> {
            let label = |axis| format!("{before}ground_{stem}{between}_{kind}{axis}");
            Ok([column(label("x"))?, column(label("y"))?, column(label("z"))?])
        };
        let missing = |other: String| format!("there is `{label}`, but no `{other}`");
        let (force, point) = match (three("force", "v"), three("force", "p")) {
            (Ok(force), Ok(point)) => (force, point),
            (Err(other), _) | (_, Err(other)) => return Some(Err(missing(other))),
        };
        let couple = three("torque", "").or_else(|_| three("moment", "m")).or_else(|_| three("moment", ""));
        let marks = format!("{before}{between}");
        let coupled = couple.is_ok();
        let columns = [force, point, couple.unwrap_or(point)];
        Some(Ok(Self { label: label.to_owned(), marks, columns, coupled }))
    }

    /// The foot it probably acts on: by a side in the label, else right, then left.
    fn guess(&self, i: usize) -> &'static str {
        let mut words = self.marks.split(|c: char| !c.is_ascii_alphanumeric());
        match words.find_map(|word| match word {
            "r" | "right" => Some(0),
            "l" | "left" => Some(1),
            _ => None,
        }) {
            Some(0) => "calcn_r",
            Some(_) => "calcn_l",
            None => ["calcn_r", "calcn_l"].get(i).copied().unwrap_or_default(),
        }
    }
}
