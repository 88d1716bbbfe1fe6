//! Computes everything that is shown of one posture: torques, loads, contact forces, verdict.

use contrapposto::contact::{ContactForces, Slip};
use contrapposto::joint_torques::{GroupLoad, Hazard, JointTorques, active_torque, relative_load};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Side;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Engine;
use contrapposto::simulation::Contact;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::verdict::{HandLoad, HeldPosture, Missed, Verdict};
use contrapposto_formats::VerdictText;

use crate::body::{Body, place};
use crate::error::Refusal;
use crate::message::{ContactShown, Push, Shown};
use crate::mover::Moved;
use crate::sample::LastSample;

/// A posture that is held still, by the engine that moves it. `recorded`: supports are where it has them, and it has nothing to reach.
pub(crate) fn held(
    body: &Body,
    engine: &mut Engine<'_>,
    posture: &Posture,
    recorded: bool,
    moved: Moved,
) -> Result<Shown, Refusal> {
    let levels = engine.report(posture).map_err(Refusal::of)?;
    let targets = engine.levels().iter().zip(levels.iter().map(|level| level.length));
    let missed = if recorded { vec![] } else { Missed::of_levels(&body.model, posture, targets) };
    let (torques, contact) = (engine.torques(), engine.contact());
    let numbers = Numbers::of(body, torques);
    let start = body.kinematics(if recorded { posture } else { &body.scenario.start })?;
    let verdict = Verdict::of_posture(
        &body.model,
        &HeldPosture {
            groups: numbers.groups(body),
            missing: contact.missing(&body.model, torques.kinematics()),
            slip: slip(body, &start, torques.kinematics()),
            missed,
            hazards: Hazard::all(&body.model, &numbers.angles, &numbers.external, &numbers.passive),
            hands: HandLoad::all(&body.model, &body.scenario.loads),
            loads: body.scenario.loads.clone(),
        },
    );
    let contacts = (0..contact.supports().len()).map(|i| force(body, contact, torques.kinematics(), i)).collect();
    let verdict = VerdictText::new(&body.model, &verdict);
    Ok(numbers.shown(body, posture, torques.kinematics(), (contacts, &body.scenario.loads), verdict, moved))
}

/// One sample of a run, under the loads that it has then.
pub(crate) fn sample(body: &Body, sample: &LastSample, loads: &[Load], verdict: VerdictText) -> Result<Shown, Refusal> {
    let posture = Posture::new(sample.posture.clone());
    let numbers = Numbers {
        angles: angles(body, &sample.posture),
        external: sample.external.clone(),
        passive: sample.passive.clone(),
        load: sample.load.clone(),
    };
    let contact = |contact: &Contact| ContactShown {
        force: contact.force.into(),
        share: contact.share,
        at: contact.center_of_pressure.map(Into::into),
    };
    let contacts = sample.standing.iter().flat_map(|standing| &standing.contacts).map(contact).collect();
    let kinematics = body.kinematics(&posture)?;
    let moved = Moved { miss: None, settled: sample.settled };
    Ok(numbers.shown(body, &posture, &kinematics, (contacts, loads), verdict, moved))
}

/// By coordinate: angle, torques and load, of three-axis joints about their axes.
struct Numbers {
    angles: Vec<f64>,
    external: Vec<f64>,
    passive: Vec<f64>,
    load: Vec<f64>,
}

impl Numbers {
    fn of(body: &Body, torques: &JointTorques) -> Self {
        let coordinates = body.model.coordinates();
        let of = |torques: &[f64]| -> Vec<f64> {
            coordinates.iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
        };
        let (external, passive) = (of(torques.external_about_axes()), of(torques.passive_torque().about_axes()));
        let angles = torques.angles().to_vec();
        let load = |(i, coordinate)| relative_load(coordinate, angles[i], active_torque(external[i], passive[i]));
        let load = coordinates.iter().enumerate().map(load).collect();
        Self { angles, external, passive, load }
    }

    /// Groups at work.
    fn groups(&self, body: &Body) -> Vec<GroupLoad> {
        let works = |i: &usize| body.model.coordinates()[*i].groups.is_some() && self.load[*i] > 0.0;
        let group = |coordinate: usize| {
            let torque = active_torque(self.external[coordinate], self.passive[coordinate]);
            GroupLoad { coordinate, side: Side::of(torque), torque, load: self.load[coordinate] }
        };
        (0..self.load.len()).filter(works).map(group).collect()
    }

    fn shown(
        self,
        body: &Body,
        posture: &Posture,
        kinematics: &Kinematics,
        (contacts, loads): (Vec<ContactShown>, &[Load]),
        verdict: VerdictText,
        moved: Moved,
    ) -> Shown {
        let model = &body.model;
        let patch = |support: &contrapposto::contact::Support| {
            let segment = support.segment;
            let corners = support.corners.iter();
            corners.map(move |corner| kinematics.station(model, segment, *corner).into()).collect::<Vec<_>>()
        };
        // Adding 0 turns -0, the active torque of no torques, into 0.
        let active = self.external.iter().zip(&self.passive).map(|(e, p)| active_torque(*e, *p) + 0.0).collect();
        Shown {
            q: posture.values().to_vec(),
            angles: self.angles,
            active,
            external: self.external,
            passive: self.passive,
            load: self.load,
            places: (0..model.segments().len()).map(|s| place(&kinematics.placement(model, s))).collect(),
            bones: body.bones(kinematics),
            center: kinematics.center_of_mass(model).unwrap_or_default().into(),
            contacts,
            patches: body.scenario.supports.iter().flat_map(patch).collect(),
            pushes: loads.iter().filter_map(|load| push(body, kinematics, load)).collect(),
            verdict,
            miss: moved.miss,
            settled: moved.settled,
        }
    }
}

/// The angles of all coordinates, of a three-axis joint about its axes.
fn angles(body: &Body, posture: &[f64]) -> Vec<f64> {
    let mut angles = posture.to_vec();
    for joint in body.model.three_axis_joints() {
        let about_axes = joint.orientation(posture).angles.values;
        joint.coordinates.into_iter().zip(about_axes).for_each(|(i, angle)| angles[i] = angle);
    }
    angles
}

/// The farthest way of a corner of a patch that is to stay in its place.
fn slip(body: &Body, start: &Kinematics, now: &Kinematics) -> Slip {
    let fixed = body.scenario.supports.iter().filter(|support| support.place == contrapposto::contact::Place::Fixed);
    let ways = fixed.flat_map(|support| {
        let station = |kinematics: &Kinematics, corner| kinematics.station(&body.model, support.segment, corner);
        support.corners.iter().map(move |corner| (station(now, *corner) - station(start, *corner)).norm())
    });
    Slip { distance: ways.fold(0.0, f64::max), angle: 0.0 }
}

fn force(body: &Body, contact: &ContactForces, kinematics: &Kinematics, i: usize) -> ContactShown {
    ContactShown {
        force: contact.force(i).into(),
        share: contact.share(i),
        at: contact.center_of_pressure(&body.model, kinematics, i).map(Into::into),
    }
}

/// Point and force of a load in ground, m and N; `None` of a couple.
fn push(body: &Body, kinematics: &Kinematics, load: &Load) -> Option<Push> {
    let force = match load.kind {
        LoadKind::Weight(mass) => mass * body.model.gravity(),
        LoadKind::Force(force, FixedIn::World) => force,
        LoadKind::Force(force, FixedIn::Segment) => kinematics.placement(&body.model, load.segment).rotation * force,
        LoadKind::Couple(..) => return None,
    };
    Some(Push { at: kinematics.station(&body.model, load.segment, load.point).into(), force: force.into() })
}
