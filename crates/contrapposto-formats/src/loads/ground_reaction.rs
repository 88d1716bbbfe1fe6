//! Reads ground reactions from tables as OpenSim writes them, and gives their loads at a time.
//!
//! Force and point in ground axes, and a couple about that point, for every force plate: `ground_force_vx`, `ground_force_px`,
//! `ground_torque_x` and so on, with anything before `ground` or after `force` to tell the plates apart (`1_ground_force_vx`,
//! `ground_force_r_vx`).

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::{Point3, Vector3};

use super::external_loads::{ExternalForce, ExternalLoads};
use super::ground_reaction_error::GroundReactionError;
use super::interpolation::Interpolation;
use super::text::no_segment;
use crate::motion::{Table, read_table};

/// Time beyond the table's ends that rounding may give, s.
const SLACK: f64 = 1e-6;

/// Ground reactions over time.
#[derive(Clone, Debug)]
pub struct GroundReaction {
    name: String,
    table: Table,
    plates: Vec<Plate>,
    /// Column label and segment name of every plate whose segment was guessed.
    guessed: Vec<(String, &'static str)>,
    /// Sentences that say what force plates act on.
    assigned: Vec<String>,
    interpolation: Interpolation,
}

/// Columns x, y and z.
type Three = [usize; 3];

#[derive(Clone, Debug)]
pub(super) struct Plate {
    pub(super) segment: usize,
    force: Option<Three>,
    /// None: the segment's origin.
    pub(super) point: Option<Three>,
    couple: Option<Three>,
    /// The segment in whose axes force and couple are measured, and the one in whose frame the point is; ground where there is none.
    force_in: Option<usize>,
    pub(super) point_in: Option<usize>,
}

impl Plate {
    /// Force, point and couple in nine columns from `first` on.
    pub(super) fn of_columns(segment: usize, first: usize) -> Self {
        let [force, point, couple] = [0, 3, 6].map(|at| Some([first + at, first + at + 1, first + at + 2]));
        Self { segment, force, point, couple, force_in: None, point_in: None }
    }
}

impl GroundReaction {
    /// Reads a table (`.mot`, `.sto` or CSV) of the name `name`. `segments` names the segments that the plates act on, in the order
    /// of their columns; where it is empty they are guessed: by a side in the label, else the right foot, then the left one.
    ///
    /// ```
    /// use contrapposto::kinematics::Kinematics;
    /// use contrapposto::model::{Adult, adult};
    /// use contrapposto_formats::loads::GroundReaction;
    /// let table = "time,ground_force_vx,ground_force_vy,ground_force_vz,ground_force_px,ground_force_py,ground_force_pz\n\
    ///     0,0,600,0,0.1,0,0.1\n1,0,700,0,0.1,0,0.1\n";
    /// let model = adult(&Adult::default())?;
    /// let ground = GroundReaction::read("forces.csv", table.as_bytes(), &["calcn_r"], &model)?;
    /// ground.check([0.5])?;
    /// let mut loads = vec![];
    /// ground.loads(0.5, &model, &Kinematics::new(&model), &mut loads);
    /// assert_eq!(loads.len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`GroundReactionError`] when the bytes are no table, a column of a plate is missing, or a segment is not known.
    pub fn read<S: AsRef<str>>(
        name: &str,
        bytes: &[u8],
        segments: &[S],
        model: &Model,
    ) -> Result<Self, GroundReactionError> {
        let table = read_table(name, bytes)?;
        let labels: Vec<String> = table.columns.iter().map(|label| label.to_ascii_lowercase()).collect();
        let found: Vec<Columns> =
            labels.iter().filter_map(|label| Columns::find(name, label, &labels)).collect::<Result<_, _>>()?;
        let table_name = || name.to_owned();
        if found.is_empty() {
            return Err(GroundReactionError::NoPlates { table: table_name() });
        }
        if table.times.is_empty() {
            return Err(GroundReactionError::Empty { table: table_name() });
        }
        if !segments.is_empty() && segments.len() != found.len() {
            let plates = found.into_iter().map(|columns| columns.label).collect();
            return Err(GroundReactionError::Count { table: table_name(), given: segments.len(), plates });
        }
        let (mut plates, mut guessed) = (vec![], vec![]);
        for (i, columns) in found.into_iter().enumerate() {
            let segment = match segments.get(i).map(AsRef::as_ref) {
                Some(given) => {
                    model.segment(given).ok_or_else(|| GroundReactionError::Segment(no_segment(model, given)))?
                }
                None => {
                    let guess = columns.guess(i);
                    let unknown = || GroundReactionError::Unknown { table: table_name(), label: columns.label.clone() };
                    let segment = model.segment(guess).ok_or_else(unknown)?;
                    guessed.push((columns.label.clone(), guess));
                    segment
                }
            };
            let [force, point, couple] = columns.columns;
            plates.push(Plate {
                segment,
                force: Some(force),
                point: Some(point),
                couple: columns.coupled.then_some(couple),
                force_in: None,
                point_in: None,
            });
        }
        Ok(Self { guessed, ..Self::of_table(name, table, plates, vec![]) })
    }

    /// Reads a table of the name `name` with the segments and columns that an ExternalLoads file names.
    ///
    /// # Errors
    /// As [`GroundReaction::read`].
    pub fn of_external_loads(
        name: &str,
        bytes: &[u8],
        loads: &ExternalLoads,
        model: &Model,
    ) -> Result<Self, GroundReactionError> {
        let table = read_table(name, bytes)?;
        if table.times.is_empty() {
            return Err(GroundReactionError::Empty { table: name.to_owned() });
        }
        let three = |stem: &String| named_columns(name, &table, stem);
        let segment =
            |name: &String| model.segment(name).ok_or_else(|| GroundReactionError::Segment(no_segment(model, name)));
        let plate = |force: &ExternalForce| -> Result<Plate, GroundReactionError> {
            Ok(Plate {
                segment: segment(&force.segment)?,
                force: force.force.as_ref().map(three).transpose()?,
                point: force.point.as_ref().map(three).transpose()?,
                couple: force.torque.as_ref().map(three).transpose()?,
                force_in: force.force_in.as_ref().map(segment).transpose()?,
                point_in: force.point_in.as_ref().map(segment).transpose()?,
            })
        };
        let plates = loads.forces.iter().map(plate).collect::<Result<_, _>>()?;
        Ok(Self::of_table(name, table, plates, vec![]))
    }

    pub(super) fn of_table(name: &str, table: Table, plates: Vec<Plate>, assigned: Vec<String>) -> Self {
        Self { name: name.to_owned(), table, plates, guessed: vec![], assigned, interpolation: Interpolation::Lines }
    }

    /// The same with natural cubic splines between the rows, as OpenSim has them: they ring where a foot lands, and differ from straight lines where the
    /// rows are far apart.
    ///
    /// # Errors
    /// [`GroundReactionError::Spline`] for fewer than four rows, or two of one time.
    pub fn with_splines(self) -> Result<Self, GroundReactionError> {
        match Interpolation::splines(&self.table) {
            Ok(interpolation) => Ok(Self { interpolation, ..self }),
            Err(why) => Err(GroundReactionError::Spline { table: self.name, why }),
        }
    }

    /// Sentences that say what the force plates of a C3D file act on.
    pub fn assigned(&self) -> &[String] {
        &self.assigned
    }

    pub(super) fn plates(&self) -> &[Plate] {
        &self.plates
    }

    /// Faults of a table that can be read nevertheless.
    pub fn warnings(&self) -> &[String] {
        &self.table.warnings
    }

    /// First column and segment of every plate whose segment was guessed.
    pub fn guessed(&self) -> &[(String, &'static str)] {
        &self.guessed
    }

    /// Name of the table.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// First and last time of the table, s.
    pub fn span(&self) -> Option<(f64, f64)> {
        let times = &self.table.times;
        Some((*times.first()?, *times.last()?))
    }

    /// Whether the table has forces at a time, s.
    pub fn covers(&self, time: f64) -> bool {
        self.span().is_some_and(|(first, last)| (first - SLACK..=last + SLACK).contains(&time))
    }

    /// Checks that the table has forces at all `times` (s).
    ///
    /// # Errors
    /// [`GroundReactionError::Outside`] names the first time that lies outside of the table.
    pub fn check(&self, times: impl IntoIterator<Item = f64>) -> Result<(), GroundReactionError> {
        let all = &self.table.times;
        let table = || self.name.clone();
        let (Some(&first), Some(&last)) = (all.first(), all.last()) else {
            return Err(GroundReactionError::Empty { table: table() });
        };
        match times.into_iter().enumerate().find(|(_, time)| !self.covers(*time)) {
            Some((frame, time)) => Err(GroundReactionError::Outside { table: table(), frame, time, first, last }),
            None => Ok(()),
        }
    }

    /// Adds the loads at `time` (s), interpolated, in the posture that `kinematics` holds: forces (N) and couples (N m) at the
    /// points of the segments that coincide with the measured points.
    pub fn loads(&self, time: f64, model: &Model, kinematics: &Kinematics, loads: &mut Vec<Load>) {
        let value = self.interpolation.at(&self.table, time);
        let three = |columns: Three| Vector3::from(columns.map(value));
        for plate in &self.plates {
            let segment = plate.segment;
            let point = plate.point.map(three).map_or_else(Vector3::zeros, |point| match plate.point_in {
                Some(own) if own == segment => point,
                other => {
                    let in_ground = other.map_or(point, |other| kinematics.station(model, other, point));
                    (kinematics.placement(model, segment).inverse() * Point3::from(in_ground)).coords
                }
            });
            // Measured in the axes of the segment itself they turn with it.
            let turned = |v: Vector3<f64>| match plate.force_in {
                Some(own) if own == segment => (v, FixedIn::Segment),
                Some(other) => (kinematics.direction(model, other, v), FixedIn::World),
                None => (v, FixedIn::World),
            };
            if let Some((force, fixed_in)) = plate.force.map(three).map(turned) {
                loads.push(Load { segment, point, kind: LoadKind::Force(force, fixed_in) });
            }
            if let Some((couple, fixed_in)) = plate.couple.map(three).map(turned) {
                loads.push(Load { segment, point, kind: LoadKind::Couple(couple, fixed_in) });
            }
        }
    }
}

/// The three columns that an identifier stands for: with x, y and z behind it, or else the only three that begin with it, in their order.
fn named_columns(name: &str, table: &Table, stem: &str) -> Result<Three, GroundReactionError> {
    let column = |axis: &str| {
        let label = format!("{stem}{axis}");
        let found = table.columns.iter().position(|other| other.eq_ignore_ascii_case(&label));
        found.ok_or(GroundReactionError::Named { table: name.to_owned(), missing: label })
    };
    let begins = |(_, label): &(usize, &String)| label.starts_with(stem);
    let found: Vec<usize> = table.columns.iter().enumerate().filter(begins).map(|(i, _)| i).collect();
    match (column("x"), column("y"), column("z"), found.as_slice()) {
        (Ok(x), Ok(y), Ok(z), _) => Ok([x, y, z]),
        (_, _, _, &[x, y, z]) => Ok([x, y, z]),
        (Err(error), ..) | (_, Err(error), ..) | (_, _, Err(error), _) => Err(error),
    }
}

/// The columns of one plate.
struct Columns {
    label: String,
    /// The text that tells the plate from others.
    marks: String,
    columns: [[usize; 3]; 3],
    coupled: bool,
}

impl Columns {
    /// The plate whose `ground_force_vx` this is.
    fn find(table: &str, label: &str, labels: &[String]) -> Option<Result<Self, GroundReactionError>> {
        let (before, rest) = label.split_once("ground_force")?;
        let between = rest.strip_suffix("_vx")?;
        let column = |label: String| labels.iter().position(|other| *other == label).ok_or(label);
        let three = |stem: &str, kind: &str| -> Result<[usize; 3], String> {
            let label = |axis| format!("{before}ground_{stem}{between}_{kind}{axis}");
            Ok([column(label("x"))?, column(label("y"))?, column(label("z"))?])
        };
        let missing = |missing: String| {
            let (table, label) = (table.to_owned(), label.to_owned());
            GroundReactionError::Column { table, label, missing }
        };
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
