//! Gives each stance on a force plate of a C3D file to the foot that stands on it.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use nalgebra::{Rotation3, Vector3};

use super::ground_reaction::{GroundReaction, Plate};
use crate::markers::{ForcePlate, ForcePlates, LEAST_FORCE};
use crate::motion::Table;

/// Greatest mean distance of the centre of pressure from the centre of mass of the foot that stands on the plate, measured along the floor, m (assumed: a long foot).
pub(super) const GREATEST_DISTANCE: f64 = 0.3;
/// Pauses in a stance up to this, s, do not end it (assumed).
const SHORT: f64 = 0.05;
/// Names of feet.
const NAMES_OF_FEET: [&str; 8] =
    ["calcn_r", "calcn_l", "foot_r", "foot_l", "right_foot", "left_foot", "r_foot", "l_foot"];

/// The segment that a plate acts on; `None` for a plate that does not act on the body.
pub type PlateOn = (usize, Option<usize>);

/// The reason for which it is not known what a force plate acts on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ForcePlateError {
    /// A plate is named that the file does not have.
    #[error("{file} has {count} force plates, no number {number}")]
    Number {
        /// Name of the file.
        file: String,
        /// Number of plates.
        count: usize,
        /// The number that is given, from 1.
        number: usize,
    },
    /// The model has no segment that is known to be a foot.
    #[error("{file}: no segment of the model is named like a foot ({}); name a segment for each plate", NAMES_OF_FEET.join(", "))]
    NoFeet {
        /// Name of the file.
        file: String,
    },
    /// No foot is near to a plate while it is loaded.
    #[error(
        "{file}: force plate {number} is loaded from {from} s to {to} s, and the nearest foot, `{segment}`, is {distance:.2} m away from \
         where it acts: are motion and forces in the same axes, and of one trial?"
    )]
    Far {
        /// Name of the file.
        file: String,
        /// Number of the plate, from 1.
        number: usize,
        /// Begin of the stance, s.
        from: f64,
        /// End of the stance, s.
        to: f64,
        /// Name of the nearest foot.
        segment: String,
        /// Distance of that foot, m.
        distance: f64,
    },
}

/// From the first to the last sample of a stance.
type Stance = std::ops::RangeInclusive<usize>;

impl ForcePlates {
    /// Turns all vectors.
    pub fn turn(&mut self, turn: &Rotation3<f64>) {
        self.up = turn * self.up;
        for plate in &mut self.plates {
            let one = [&mut plate.up, &mut plate.center];
            let all = plate.corners.iter_mut().chain(&mut plate.forces).chain(&mut plate.moments).chain(one);
            all.for_each(|vector| *vector = turn * *vector);
        }
    }
}

impl ForcePlate {
    /// The times in which the plate pushes up with [`LEAST_FORCE`] or more, as numbers of samples.
    fn stances(&self, times: &[f64]) -> Vec<Stance> {
        let mut found: Vec<Stance> = vec![];
        for (i, force) in self.forces.iter().enumerate() {
            if force.dot(&self.up) < LEAST_FORCE {
                continue;
            }
            match found.last_mut() {
                Some(last) if times[i] - times[*last.end()] <= SHORT => *last = *last.start()..=i,
                _ => found.push(i..=i),
            }
        }
        found
    }
}

/// The feet of a model over a motion.
struct Feet<'a> {
    model: &'a Model,
    motion: &'a [(f64, Posture)],
    segments: Vec<usize>,
    kinematics: Kinematics,
}

impl Feet<'_> {
    /// The foot nearest to the centres of pressure of a stance, and its mean distance along the floor, m. `None` where the motion has no frame in it.
    fn nearest(&mut self, times: &[f64], plate: &ForcePlate, stance: &Stance) -> Option<(usize, f64)> {
        let (from, to) = (times[*stance.start()], times[*stance.end()]);
        let mut sums = vec![0.0; self.segments.len()];
        let mut frames = 0.0;
        for (time, posture) in self.motion.iter().filter(|(time, _)| (from..=to).contains(time)) {
            let sample = times.partition_point(|other| other < time).min(times.len() - 1);
            let Some(at) = plate.center_of_pressure(sample) else { continue };
            if self.kinematics.update(self.model, posture).is_err() {
                continue;
            }
            for (sum, &segment) in sums.iter_mut().zip(&self.segments) {
                let center = self.model.segments()[segment].center_of_mass;
                let away = self.kinematics.station(self.model, segment, center) - at;
                *sum += (away - plate.up * away.dot(&plate.up)).norm();
            }
            frames += 1.0;
        }
        let least = sums.iter().zip(&self.segments).min_by(|a, b| a.0.total_cmp(b.0));
        least.filter(|_| frames > 0.0).map(|(sum, segment)| (*segment, sum / frames))
    }
}

impl GroundReaction {
    /// The forces of force plates, each stance on the foot that is nearest to it in the motion, but for plates that are `given`. Stances outside of the
    /// motion's time are left out. Force and moment act at the middle of the plate's surface.
    ///
    /// # Errors
    /// [`ForcePlateError`] names the plate.
    pub fn of_force_plates(
        name: &str,
        read: &ForcePlates,
        given: &[PlateOn],
        (model, motion): (&Model, &[(f64, Posture)]),
    ) -> Result<Self, ForcePlateError> {
        let (file, count) = (|| name.to_owned(), read.plates.len());
        if let Some((number, _)) = given.iter().find(|(plate, _)| !(1..=count).contains(plate)) {
            return Err(ForcePlateError::Number { file: file(), count, number: *number });
        }
        let segments: Vec<usize> = NAMES_OF_FEET.iter().filter_map(|foot| model.segment(foot)).collect();
        let mut feet = Feet { model, motion, segments, kinematics: Kinematics::new(model) };
        let mut table = Table { times: read.times.clone(), warnings: read.warnings.clone(), ..Table::default() };
        table.rows = vec![vec![]; read.times.len()];
        let (mut plates, mut said) = (vec![], vec![]);
        for (i, plate) in read.plates.iter().enumerate() {
            let mut of_segments: Vec<(usize, Vec<Stance>)> = vec![];
            for stance in plate.stances(&read.times) {
                let on = match given.iter().find(|(number, _)| *number == i + 1) {
                    Some((_, segment)) => *segment,
                    None if feet.segments.is_empty() => return Err(ForcePlateError::NoFeet { file: file() }),
                    None => match feet.nearest(&read.times, plate, &stance) {
                        Some((segment, distance)) if distance > GREATEST_DISTANCE => {
                            let [from, to] = [stance.start(), stance.end()].map(|sample| read.times[*sample]);
                            let segment = model.segments()[segment].name.clone();
                            return Err(ForcePlateError::Far {
                                file: file(),
                                number: i + 1,
                                from,
                                to,
                                segment,
                                distance,
                            });
                        }
                        found => found.map(|(segment, _)| segment),
                    },
                };
                let Some(on) = on else { continue };
                match of_segments.iter_mut().find(|(segment, _)| *segment == on) {
                    Some((_, stances)) => stances.push(stance),
                    None => of_segments.push((on, vec![stance])),
                }
            }
            said.push(in_words(model, (i + 1, &of_segments), &read.times));
            for (segment, stances) in of_segments {
                plates.push(Plate::of_columns(segment, table.rows.first().map_or(0, Vec::len)));
                append(&mut table.rows, plate, &stances);
            }
        }
        Ok(Self::of_table(name, table, plates, said))
    }
}

/// Appends force, point and moment of a plate, each 0 outside of the stances, to the rows of all times.
fn append(rows: &mut [Vec<f64>], plate: &ForcePlate, stances: &[Stance]) {
    for (i, row) in rows.iter_mut().enumerate() {
        let acts = stances.iter().any(|stance| stance.contains(&i));
        let [force, moment] = [&plate.forces, &plate.moments].map(|all| if acts { all[i] } else { Vector3::zeros() });
        row.extend(force.iter().chain(plate.center.iter()).chain(moment.iter()));
    }
}

/// `force plate 1 acts on calcn_r (0.52 s to 1.14 s)`.
fn in_words(model: &Model, (number, on): (usize, &[(usize, Vec<Stance>)]), times: &[f64]) -> String {
    let one = |(segment, stances): &(usize, Vec<Stance>)| {
        let name = &model.segments()[*segment].name;
        let spans = stances.iter().map(|stance| format!("{} s to {} s", times[*stance.start()], times[*stance.end()]));
        format!("`{name}` ({})", spans.collect::<Vec<_>>().join(", "))
    };
    match on {
        [] => format!("force plate {number} does not act on the body in the time of the motion"),
        on => format!("force plate {number} acts on {}", on.iter().map(one).collect::<Vec<_>>().join(" and on ")),
    }
}
