//! Writes the passive torque of muscles into a body as laws near its posture ([`Slice`]), with the whole gradient there.
//!
//! Solvers that evaluate many postures, and the tables of goal angles, need a law of every coordinate. Moments about the axes of a
//! three-axis joint and derivatives by rotations about them become torques by its angles `x` and derivatives by them:
//!
//! ```text
//! m_k     = sum_j tau_j E_k x_j                                                     tau = F^-T m,  F_jk = E_k x_j
//! E_m m_k = sum_jl (d tau_j/dx_l) (E_m x_l)(E_k x_j) + sum_j tau_j E_m E_k x_j      d tau/dx = F^-T (G - C) F^-1
//! ```
//!
//! Paths have their gradient by [`PathTension`], bushings by central differences, which need no paths.

use nalgebra::Vector3;

use super::muscle_tables::{Table, TableMaker, by_angles};
use crate::kinematics::Kinematics;
use crate::model::{Model, Orientation};
use crate::muscle::{Bushing, FiberState, Musculature, PathGeometry, Tension, bushing_torque, passive_tensions};
use crate::passive::{PassiveLaw, Slice};
use crate::posture::Posture;
use crate::statics::{PathTension, PathTensionError};

/// Step of central differences of bushings, rad (m for slides).
const BUSHING_STEP: f64 = 1e-5;
/// Rises of the torque that are levelled: share of its span, and N m. Assumed (see docs/formats.md).
pub const MOST_LEVELLED: (f64, f64) = (0.05, 2.0);
/// Rises that are levelled, whatever their share, N m: the default tolerance of relief.
const LEAST_RISE: f64 = 0.05;

/// A rise of the passive torque of muscles with the angle, where passive torque falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueRise {
    /// The coordinate.
    pub coordinate: usize,
    /// The rise, N m; infinite where no table could be made.
    pub rise: f64,
    /// Greatest less least torque over the range, N m.
    pub span: f64,
}

impl TorqueRise {
    /// Whether it is small enough to be levelled.
    pub fn is_small(&self) -> bool {
        self.rise < LEAST_RISE || (self.rise < MOST_LEVELLED.0 * self.span && self.rise < MOST_LEVELLED.1)
    }
}

/// Muscles at rest in a posture, about axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct MusclesAtRest<'a> {
    pub(super) muscles: &'a Musculature,
    /// One a muscle.
    pub(super) states: &'a [FiberState],
    /// The body that has a ball for each three-axis joint, and the paths in it.
    pub(super) balls: &'a Kinematics,
    pub(super) geometry: &'a PathGeometry,
    /// Passive torque by rate, N m.
    pub(super) torques: &'a [f64],
}

/// Makes the laws.
#[derive(Clone, Debug)]
pub(super) struct MuscleLaws {
    makers: Vec<TableMaker>,
    tension: PathTension,
    tensions: Vec<Tension>,
    /// By rate, about axes, row after row, N m/rad; then by angle.
    gradient: Vec<f64>,
    bushings: BushingGradient,
}

impl MuscleLaws {
    /// For coordinates, each with the range of its table, rad.
    ///
    /// # Errors
    /// [`PathTensionError::Tendon`] for a tendon of MuJoCo.
    pub(super) fn new(
        model: &Model,
        muscles: &Musculature,
        coordinates: &[(usize, (f64, f64))],
    ) -> Result<Self, PathTensionError> {
        if let Some(tendon) = muscles.paths.paths.iter().position(|path| path.tendon.is_some()) {
            return Err(PathTensionError::Tendon(tendon));
        }
        let maker = |&(coordinate, range): &(usize, (f64, f64))| TableMaker::new(model, muscles, coordinate, range);
        let n = model.rates().len();
        Ok(Self {
            makers: coordinates.iter().map(maker).collect(),
            tension: PathTension::new(model.by_axes(), &muscles.paths),
            tensions: vec![Tension::default(); muscles.paths.paths.len()],
            gradient: vec![0.0; n * n],
            bushings: BushingGradient::new(model),
        })
    }

    /// Gives the coordinates of `model` their laws near `posture`, in which `kinematics` and the muscles are.
    pub(super) fn write(
        &mut self,
        model: &mut Model,
        posture: &Posture,
        kinematics: &Kinematics,
        at_rest: MusclesAtRest<'_>,
    ) -> Result<(), PathTensionError> {
        self.fill_gradient(model, posture, at_rest)?;
        let orientations: Vec<Orientation> =
            model.three_axis_joints().iter().map(|joint| joint.orientation(kinematics.values())).collect();
        let mut torques = at_rest.torques.to_vec();
        let mut angles = kinematics.values().to_vec();
        for (joint, orientation) in model.three_axis_joints().iter().zip(&orientations) {
            let about = orientation.angles.values;
            joint.coordinates.into_iter().zip(about).for_each(|(i, angle)| angles[i] = angle);
            self.by_angles_of(model, joint.coordinates, orientation, &mut torques);
        }
        for maker in &mut self.makers {
            let own = maker.coordinate();
            let Some(rate) = model.coordinates()[own].rate else { continue };
            let Some(Table { curve, .. }) = maker.table(model, &angles) else { continue };
            let row = &self.gradient[rate * torques.len()..(rate + 1) * torques.len()];
            // Laws of three-axis joints go on along their tangents beyond ranges.
            let inside = |i: usize| {
                let (low, high) = model.coordinates()[i].range;
                if model.three_axis_joint_of(i).is_some() { angles[i].max(low).min(high) } else { angles[i] }
            };
            let mut derivatives = vec![];
            for (i, coordinate) in model.coordinates().iter().enumerate() {
                let slope = coordinate.rate.map_or(0.0, |rate| row[rate]);
                if i == own || slope != 0.0 {
                    derivatives.push((i, inside(i), slope));
                }
            }
            let torque = torques[rate] - row[rate] * (angles[own] - inside(own));
            let law = Slice::new(curve.clone(), own, torque, &derivatives);
            model.coordinates[own].passive = Some(PassiveLaw::Slice(law));
        }
        Ok(())
    }

    /// The coordinates with laws.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = usize> {
        self.makers.iter().map(TableMaker::coordinate)
    }

    /// The rise of every table at the posture of the last laws.
    pub(super) fn rises(&mut self, model: &Model, angles: &[f64]) -> Vec<TorqueRise> {
        let rise = |maker: &mut TableMaker| {
            let coordinate = maker.coordinate();
            let (rise, span) =
                maker.table(model, angles).map_or((f64::INFINITY, f64::INFINITY), |table| (table.rise, table.span));
            TorqueRise { coordinate, rise, span }
        };
        self.makers.iter_mut().map(rise).collect()
    }

    /// Makes no more laws of these coordinates.
    pub(super) fn leave(&mut self, coordinates: &[usize]) {
        self.makers.retain(|maker| !coordinates.contains(&maker.coordinate()));
    }

    /// The gradient of the torque about axes, by rotations about axes.
    fn fill_gradient(
        &mut self,
        model: &Model,
        posture: &Posture,
        at_rest: MusclesAtRest<'_>,
    ) -> Result<(), PathTensionError> {
        let MusclesAtRest { muscles: all, states, balls, geometry, .. } = at_rest;
        passive_tensions(all, geometry, states, &mut self.tensions);
        self.tension.update(model.by_axes(), balls, &all.paths, geometry, &self.tensions)?;
        let n = model.rates().len();
        for (row, entries) in self.gradient.chunks_exact_mut(n.max(1)).enumerate() {
            entries.copy_from_slice(self.tension.gradient_row(row));
        }
        self.bushings.add(model, posture, &all.bushings, &mut self.gradient);
        Ok(())
    }

    /// Changes torques about the axes of one joint and their gradient into those by its angles.
    fn by_angles_of(&mut self, model: &Model, coordinates: [usize; 3], orientation: &Orientation, torques: &mut [f64]) {
        let n = torques.len();
        let rates = coordinates.map(|i| model.coordinates()[i].rate.unwrap_or_default());
        let first = &orientation.angles.first;
        let moment = Vector3::from(rates.map(|rate| torques[rate]));
        let Some(by_angle) = by_angles(first, &moment) else { return };
        // C, with the derivative of row k by column m.
        for (k, row) in rates.into_iter().enumerate() {
            for (m, column) in rates.into_iter().enumerate() {
                let turned: f64 = (0..3).map(|j| by_angle[j] * orientation.angles.second[j][(m, k)]).sum();
                self.gradient[row * n + column] -= turned;
            }
        }
        for row in self.gradient.chunks_exact_mut(n) {
            let entries = Vector3::from(rates.map(|rate| row[rate]));
            let Some(entries) = by_angles(first, &entries) else { return };
            rates.into_iter().zip(entries.iter()).for_each(|(rate, entry)| row[rate] = *entry);
        }
        for column in 0..n {
            let entries = Vector3::from(rates.map(|rate| self.gradient[rate * n + column]));
            let Some(entries) = by_angles(first, &entries) else { return };
            rates.into_iter().zip(entries.iter()).for_each(|(rate, entry)| self.gradient[rate * n + column] = *entry);
        }
        rates.into_iter().zip(by_angle.iter()).for_each(|(rate, torque)| torques[rate] = *torque);
    }
}

/// The gradient of the torque of bushings about axes.
#[derive(Clone, Debug)]
struct BushingGradient {
    kinematics: Kinematics,
    moved: Posture,
    step: Vec<f64>,
    turn: Vec<f64>,
    torques: [Vec<f64>; 2],
}

impl BushingGradient {
    fn new(model: &Model) -> Self {
        let zeros = || vec![0.0; model.rates().len()];
        Self {
            kinematics: Kinematics::new(model.by_axes()),
            moved: model.default_posture(),
            step: zeros(),
            turn: zeros(),
            torques: [zeros(), zeros()],
        }
    }

    fn add(&mut self, model: &Model, posture: &Posture, bushings: &[Bushing], gradient: &mut [f64]) {
        let n = self.step.len();
        for by in (0..n).filter(|_| !bushings.is_empty()) {
            for side in 0..2 {
                let h = if side == 0 { BUSHING_STEP } else { -BUSHING_STEP };
                self.step.fill(0.0);
                self.turn.fill(0.0);
                let of_joint = model.rates()[by].coordinate.and_then(|c| model.three_axis_joint_of(c));
                *(if of_joint.is_some() { &mut self.turn[by] } else { &mut self.step[by] }) = h;
                self.moved.values_mut().copy_from_slice(posture.values());
                self.moved.displace(model, &self.step);
                // A posture near one that fits.
                let _ = self.kinematics.update_turned(model.by_axes(), &self.moved, &self.turn);
                bushing_torque(bushings, model.by_axes(), &self.kinematics, &mut self.torques[side]);
            }
            for row in 0..n {
                gradient[row * n + by] += (self.torques[0][row] - self.torques[1][row]) / (2.0 * BUSHING_STEP);
            }
        }
    }
}
