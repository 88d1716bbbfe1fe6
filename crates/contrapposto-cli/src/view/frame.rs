//! One moment of a body: posture, torques, loads, fatigue and contact forces.

use contrapposto::assessment::Instant;
use contrapposto::contact::ContactForces;
use contrapposto::equilibria::RelaxedPosture;
use contrapposto::joint_torques::{active_torque, carried, effort, relative_load};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::simulation::{Contact, Sample, Standing};
use contrapposto::statics::Load;
use nalgebra::Vector3;

use super::recording::{Row, load_and_tension};
use super::three_axis::angles;
use super::words::shares_of_all;
use crate::fail::Fail;

/// Passive tissue gives more than the external torque from this share of it on.
const MORE_THAN_ALL: f64 = 1.005;

/// One moment.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) time: f64,
    pub(crate) posture: Vec<f64>,
    /// By coordinate, rad or m: of a three-axis joint the angles about the axes that stand for its coordinates.
    pub(crate) angles: Vec<f64>,
    /// By coordinate, N m: of a three-axis joint about these axes.
    pub(crate) external: Vec<f64>,
    pub(crate) passive: Vec<f64>,
    pub(crate) load: Vec<f64>,
    /// Fatigue of both groups of each coordinate, where the source of the frame knows fatigue.
    pub(crate) fatigue: Option<Vec<[f64; 2]>>,
    /// Load and tension (N) of every muscle that tires by itself.
    pub(crate) muscles: Vec<[f64; 2]>,
    pub(crate) standing: Option<Standing>,
    /// Loads with contact forces and inertia, where the source of the frame knows them.
    pub(crate) loads: Option<Vec<Load>>,
}

impl Frame {
    pub(crate) fn of_row(model: &Model, row: Row) -> Self {
        let contact = |numbers: &[f64; 10]| {
            let [share, fx, fy, fz, px, py, pz, cx, cy, cz] = *numbers;
            let (force, at, couple) = ([fx, fy, fz].into(), [px, py, pz].into(), [cx, cy, cz].into());
            Contact { force, share, center_of_pressure: (share > 0.0).then_some(at), couple }
        };
        let standing = row.center_of_mass.map(|center| Standing {
            contacts: row.contacts.iter().map(contact).collect(),
            center_of_mass: center.into(),
            ..Standing::default()
        });
        Self {
            time: row.time,
            posture: row.posture.to_vec(),
            angles: angles(model, row.posture),
            external: row.external.to_vec(),
            passive: row.passive.to_vec(),
            load: row.load.to_vec(),
            fatigue: Some(row.fatigue.to_vec()),
            muscles: row.muscles.to_vec(),
            standing,
            loads: None,
        }
    }

    /// One sample of a run.
    pub(crate) fn of_sample(model: &Model, sample: &Sample) -> Self {
        Self {
            time: sample.time,
            posture: sample.posture.to_vec(),
            angles: angles(model, sample.posture),
            external: sample.external.to_vec(),
            passive: sample.passive.to_vec(),
            load: sample.load.to_vec(),
            fatigue: Some(sample.fatigue.to_vec()),
            muscles: load_and_tension(sample).collect(),
            standing: sample.standing.cloned(),
            loads: None,
        }
    }

    /// A posture with its torques by rate, about axes.
    pub(crate) fn at(model: &Model, time: f64, posture: &[f64], [external, passive]: [&[f64]; 2]) -> Self {
        let of = |torques: &[f64]| -> Vec<f64> {
            model.coordinates().iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
        };
        let (external, passive) = (of(external), of(passive));
        let angles = angles(model, posture);
        let load = |(i, coordinate)| relative_load(coordinate, angles[i], active_torque(external[i], passive[i]));
        let load = model.coordinates().iter().enumerate().map(load).collect();
        Self {
            time,
            posture: posture.to_vec(),
            angles,
            external,
            passive,
            load,
            fatigue: None,
            muscles: vec![],
            standing: None,
            loads: None,
        }
    }

    /// A posture that was given, held at rest.
    pub(crate) fn of_instant(model: &Model, instant: &Instant) -> Self {
        let values = instant.torques.kinematics().values();
        let torques = [instant.torques.external_about_axes(), instant.torques.passive_torque().about_axes()];
        let contact = |contact: &ContactForces, i: usize| Contact {
            force: contact.force(i),
            share: contact.share(i),
            center_of_pressure: contact.center_of_pressure(model, instant.torques.kinematics(), i),
            couple: Vector3::zeros(),
        };
        let standing = instant.contact.map(|forces| Standing {
            contacts: (0..forces.supports().len()).map(|i| contact(forces, i)).collect(),
            center_of_mass: instant.torques.kinematics().center_of_mass(model).unwrap_or_default(),
            ..Standing::default()
        });
        let loads = Some(instant.torques.loads().to_vec());
        Self { standing, loads, ..Self::at(model, instant.time, values, torques) }
    }

    /// Active torque of a coordinate about its axis, N m.
    pub(crate) fn active(&self, i: usize) -> f64 {
        active_torque(self.external[i], self.passive[i])
    }

    /// Effort: the sum of squares of relative loads.
    pub(crate) fn effort(&self) -> f64 {
        effort(&self.load)
    }

    /// Shares of the weight of body and loads that the supports carry, each a share of what all of them carry upwards.
    pub(crate) fn shares(&self) -> Vec<f64> {
        let contacts = self.standing.iter().flat_map(|standing| &standing.contacts);
        shares_of_all(&contacts.map(|contact| contact.share).collect::<Vec<_>>())
    }

    /// Whether passive tissue gives more than the external torque of a coordinate, so that muscles hold the rest against it.
    pub(crate) fn against_muscles(&self, i: usize) -> bool {
        -self.passive[i] * self.external[i].signum() > MORE_THAN_ALL * self.external[i].abs()
    }

    /// Share of the external torque of a coordinate that passive tissue carries, 0..=1; `None` below 0.5 N m.
    pub(crate) fn carried(&self, i: usize) -> Option<f64> {
        carried(self.external[i], self.passive[i])
    }
}

/// The frame of a posture of least effort, with the contact forces and torques that the search found.
pub(crate) fn frame_of_posture(model: &Model, found: &RelaxedPosture) -> Result<Frame, Fail> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &found.relaxed.posture).map_err(|error| Fail::job("report", error))?;
    let contacts = found.supports.iter().map(|carried| Contact {
        force: carried.force,
        share: carried.share,
        center_of_pressure: carried.center_of_pressure,
        couple: nalgebra::Vector3::zeros(),
    });
    let standing = (!found.supports.is_empty()).then(|| Standing {
        contacts: contacts.collect(),
        center_of_mass: kinematics.center_of_mass(model).unwrap_or_default(),
        ..Standing::default()
    });
    let [external, passive] = &found.torques;
    let mut frame = Frame::at(model, 0.0, found.relaxed.posture.values(), [external, passive]);
    // By the strength that muscles had in this posture, not in that of the model.
    found.work.iter().for_each(|work| frame.load[work.coordinate] = work.relative_load());
    Ok(Frame { standing, ..frame })
}
