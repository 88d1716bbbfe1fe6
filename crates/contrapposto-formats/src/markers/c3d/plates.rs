//! Computes the forces of force plates from the analog channels of a C3D file (The C3D File Format, User Guide, 2008, group FORCE_PLATFORM).
//!
//! A plate has its origin in the middle of its surface; `x` points from corner 2 to corner 1, `y` from corner 4 to corner 1, `z` is normal to
//! both, mostly into the floor. Its channels give, in these axes, by its type:
//!
//! 1. force, centre of pressure `(x, y)`, couple about `z`;
//! 2. force and moment about the sensors, which lie at `-ORIGIN`;
//! 3. `Fx12, Fx34, Fy14, Fy23, Fz1 .. Fz4` of four sensors at `(+-a, +-b)`, `ORIGIN = (a, b, az0)`;
//! 4. six voltages, which `CAL_MATRIX` turns into those of type 2.
//!
//! The moment about the middle of the surface is `M + F x ORIGIN`.

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use super::analog::{Analog, no_value};
use super::layout::Layout;
use super::parameters::Parameters;
use super::refusal::C3dError;
use super::trial::{axes, trial, up};
use crate::markers::trc::MarkerUnit;
use crate::motion::MOST_NUMBERS;

/// Least force along the normal of a plate that carries something, N: amplifiers of plates drift by some newtons (assumed).
pub(crate) const LEAST_FORCE: f64 = 20.0;
/// Most plates of a file (assumed).
const MOST_PLATES: usize = 64;

/// Forces of the plates of a C3D file.
#[derive(Clone, Debug, PartialEq)]
pub struct ForcePlates {
    /// Times of the analog samples, s.
    pub times: Vec<f64>,
    /// All plates.
    pub plates: Vec<ForcePlate>,
    /// The axis of the laboratory that points up.
    pub up: Vector3<f64>,
    /// Faults of the file that do not keep it from being read.
    pub warnings: Vec<String>,
}

/// Forces and moments of one plate on the body, in the axes of the laboratory.
#[derive(Clone, Debug, PartialEq)]
pub struct ForcePlate {
    /// Corners of the surface, m.
    pub corners: [Vector3<f64>; 4],
    /// Normal of the surface, out of the floor.
    pub up: Vector3<f64>,
    /// Middle of the surface, m.
    pub center: Vector3<f64>,
    /// Force at each time, N.
    pub forces: Vec<Vector3<f64>>,
    /// Moment about the middle of the surface at each time, N m.
    pub moments: Vec<Vector3<f64>>,
}

/// Type, channels and place of a plate.
struct Plate {
    kind: usize,
    /// Number of each channel, from 0.
    channels: Vec<usize>,
    /// From the plate's axes to the laboratory's.
    axes: Matrix3<f64>,
    corners: [Vector3<f64>; 4],
    /// `ORIGIN`, m.
    origin: Vector3<f64>,
    calibration: Matrix6<f64>,
    /// Length of the unit of moments and centres of pressure, m.
    metres: f64,
    /// Length of the unit of the couple of type 1, m.
    metres_of_couple: f64,
}

/// Reads the force plates of a C3D file. `name` stands in errors and warnings only. Time of analog sample `k` of frame `n`, both counted from 0, is
/// `(n + k / samples) / rate` with the samples of a frame.
///
/// # Errors
/// [`C3dError`] says what is wrong, at which byte, and what would be accepted.
pub fn read_force_plates(name: &str, bytes: &[u8], unit: Option<MarkerUnit>) -> Result<ForcePlates, C3dError> {
    let mut read = force_plates(bytes, unit).map_err(|error| error.of(name))?;
    for warning in &mut read.warnings {
        *warning = format!("{name}: {warning}");
    }
    Ok(read)
}

fn force_plates(bytes: &[u8], unit: Option<MarkerUnit>) -> Result<ForcePlates, C3dError> {
    let mut warnings = vec![];
    let (parameters, layout, frames) = trial(bytes, unit, &mut warnings)?;
    let analog = Analog::new(&parameters, &layout);
    let byte = parameters.byte("FORCE_PLATFORM:USED");
    let count = parameters.number("FORCE_PLATFORM:USED").map_or(0, |count| count.max(0.0) as usize);
    if count == 0 || analog.channels == 0 {
        let message = "the file has no force plate (FORCE_PLATFORM:USED)";
        return Err(C3dError::at(byte, message, "a file with force plates is accepted"));
    }
    let samples = frames.len() / layout.frame * analog.per_frame;
    let numbers = samples.saturating_mul(count).saturating_mul(6);
    let most = MOST_PLATES.min(analog.channels);
    if count > most || numbers > MOST_NUMBERS {
        let message = format!("{count} force plates with {} channels and {numbers} numbers", analog.channels);
        let accepted =
            format!("{most} plates, no more than there are channels, and {MOST_NUMBERS} numbers are accepted");
        return Err(C3dError::at(byte, message, accepted));
    }
    let plates: Vec<Plate> =
        (0..count).map(|i| Plate::new(&parameters, &layout, &analog, i)).collect::<Result<_, _>>()?;
    let mut found: Vec<ForcePlate> = plates.iter().map(|plate| plate.empty(samples)).collect();
    let mut times = Vec::with_capacity(samples);
    for (number, frame) in frames.chunks_exact(layout.frame).enumerate() {
        for sample in 0..analog.per_frame {
            let share = sample as f64 / analog.per_frame as f64;
            times.push(((layout.first + number) as f64 + share) / layout.rate);
            for (plate, found) in plates.iter().zip(&mut found) {
                let (force, moment) = plate.wrench(&analog, &layout, (number, frame), sample)?;
                found.forces.push(force);
                found.moments.push(moment);
            }
        }
    }
    for (number, plate) in found.iter_mut().enumerate() {
        warnings.extend(
            plate.push_up().then(|| {
                format!("force plate {} gives the forces of the body on it; they are turned round", number + 1)
            }),
        );
    }
    let up = up(&parameters).unwrap_or_else(Vector3::z);
    Ok(ForcePlates { times, plates: found, up, warnings })
}

impl ForcePlate {
    /// Turns forces and moments round where the plate pulls the body into the floor: some laboratories record what acts on the plate.
    fn push_up(&mut self) -> bool {
        let along = self.forces.iter().map(|force| force.dot(&self.up));
        let pull = along.filter(|force| force.abs() >= LEAST_FORCE).sum::<f64>() < 0.0;
        if pull {
            self.forces.iter_mut().chain(&mut self.moments).for_each(|vector| *vector = -*vector);
        }
        pull
    }

    /// Centre of pressure at a time, where the plate pushes; m.
    pub fn center_of_pressure(&self, index: usize) -> Option<Vector3<f64>> {
        let (force, moment) = (self.forces.get(index)?, self.moments.get(index)?);
        let pushes = force.dot(&self.up);
        (pushes > 0.0).then(|| self.center + self.up.cross(moment) / pushes)
    }
}

impl Plate {
    fn new(parameters: &Parameters<'_>, layout: &Layout, analog: &Analog, i: usize) -> Result<Self, C3dError> {
        let named = |name: &str| format!("FORCE_PLATFORM:{name}");
        let numbers = |name: &str, count: usize| -> Result<Vec<f64>, C3dError> {
            let all = parameters.list(&named(name), true, count * (i + 1)).unwrap_or_default();
            let own = all.get(count * i..count * (i + 1)).filter(|own| own.iter().all(|value| value.is_finite()));
            own.map(<[f64]>::to_vec).ok_or_else(|| {
                let message = format!("FORCE_PLATFORM:{name} holds no {count} numbers of plate {}", i + 1);
                C3dError::at(parameters.byte(&named(name)), message, format!("{count} for each plate are accepted"))
            })
        };
        let kind = numbers("TYPE", 1)?[0];
        let kind = [1, 2, 3, 4].into_iter().find(|known| f64::from(*known) == kind).ok_or_else(|| {
            let message = format!("force plate {} is of type {kind}", i + 1);
            C3dError::at(parameters.byte(&named("TYPE")), message, "types 1, 2, 3 and 4 are accepted")
        })? as usize;
        let channels = channels(parameters, analog, (i, if kind == 3 { 8 } else { 6 }))?;
        let unit = layout.unit();
        let corners = numbers("CORNERS", 12)?;
        let corners = [0, 3, 6, 9].map(|at| unit * Vector3::new(corners[at], corners[at + 1], corners[at + 2]));
        let axes = axes(&corners).ok_or_else(|| {
            let message = format!("the corners of force plate {} span no area", i + 1);
            C3dError::at(parameters.byte(&named("CORNERS")), message, "four corners in their order are accepted")
        })?;
        let origin = unit * Vector3::from_vec(numbers("ORIGIN", 3)?);
        let origin = match kind {
            1 => Vector3::zeros(),
            // Distances of the sensors.
            3 => Vector3::new(origin.x.abs(), origin.y.abs(), -origin.z.abs()),
            // The sensors lie below the surface; many programs write the vector the other way round.
            _ if origin.z > 0.0 => -origin,
            _ => origin,
        };
        let calibration = if kind == 4 { Matrix6::from_vec(numbers("CAL_MATRIX", 36)?) } else { Matrix6::identity() };
        // Of the centre of pressure, or of a moment.
        let metres = match (kind, analog.unit(channels[3]).as_str()) {
            (1, "m") | (2, "nm" | "ntm") => 1.0,
            (1, "mm") | (2, "nmm" | "ntmm") => 1e-3,
            _ => unit,
        };
        let metres_of_couple = match analog.unit(channels[5]).as_str() {
            "nm" | "ntm" => 1.0,
            "nmm" | "ntmm" => 1e-3,
            _ => unit,
        };
        Ok(Self { kind, channels, axes, corners, origin, calibration, metres, metres_of_couple })
    }

    /// The plate without forces, with room for those of so many samples.
    fn empty(&self, samples: usize) -> ForcePlate {
        let center = self.corners.iter().sum::<Vector3<f64>>() / 4.0;
        let normal = self.axes.column(2).into_owned();
        // Laboratories count upwards along the axis that is nearest to the normal.
        let up = normal * normal[normal.iamax()].signum();
        let [forces, moments] = [(); 2].map(|()| Vec::with_capacity(samples));
        ForcePlate { corners: self.corners, up, center, forces, moments }
    }

    /// Force (N) and moment about the middle of the surface (N m) of a sample, in the axes of the laboratory.
    fn wrench(
        &self,
        analog: &Analog,
        layout: &Layout,
        (number, frame): (usize, &[u8]),
        sample: usize,
    ) -> Result<(Vector3<f64>, Vector3<f64>), C3dError> {
        let mut c = [0.0; 8];
        for (value, &channel) in c.iter_mut().zip(&self.channels) {
            *value = analog
                .value(layout, frame, (channel, sample))
                .map_err(|value| no_value(layout, (number, channel), value))?;
        }
        let (force, moment) = match self.kind {
            1 => {
                let force = Vector3::new(c[0], c[1], c[2]);
                let at = self.metres * Vector3::new(c[3], c[4], 0.0);
                (force, at.cross(&force) + Vector3::new(0.0, 0.0, self.metres_of_couple * c[5]))
            }
            3 => {
                let [a, b, depth] = [self.origin.x, self.origin.y, self.origin.z];
                let force = Vector3::new(c[0] + c[1], c[2] + c[3], c[4] + c[5] + c[6] + c[7]);
                let moment = Vector3::new(
                    b * (c[4] + c[5] - c[6] - c[7]),
                    a * (c[5] + c[6] - c[4] - c[7]),
                    b * (c[1] - c[0]) + a * (c[2] - c[3]),
                );
                (force, moment + force.cross(&Vector3::new(0.0, 0.0, depth)))
            }
            _ => {
                let six = self.calibration * Vector6::new(c[0], c[1], c[2], c[3], c[4], c[5]);
                let (force, moment) = (six.fixed_rows::<3>(0).into_owned(), six.fixed_rows::<3>(3).into_owned());
                (force, self.metres * moment + force.cross(&self.origin))
            }
        };
        Ok((self.axes * force, self.axes * moment))
    }
}

/// Numbers of the first channels of a plate, from 0.
fn channels(parameters: &Parameters<'_>, analog: &Analog, (i, count): (usize, usize)) -> Result<Vec<usize>, C3dError> {
    const NAME: &str = "FORCE_PLATFORM:CHANNEL";
    let width = parameters.first_dimension(NAME);
    let all = parameters.list(NAME, false, width * (i + 1)).unwrap_or_default();
    let own = all.get(width * i..width * (i + 1)).and_then(|own| own.get(..count));
    let known = |own: &&[f64]| own.iter().all(|channel| (1.0..=analog.channels as f64).contains(channel));
    own.filter(known).map(|own| own.iter().map(|channel| *channel as usize - 1).collect()).ok_or_else(|| {
        let message = format!("{NAME} names no {count} channels of plate {}", i + 1);
        let accepted = format!("numbers from 1 to {}, that of analog channels, are accepted", analog.channels);
        C3dError::at(parameters.byte(NAME), message, accepted)
    })
}
