//! Evaluates one instant of a motion: torques, what the root lacks, and where relief would lie.

use super::error::AssessError;
use super::result::{GroupAssessment, LIGAMENT_RATIO, PeakKind, Proposal};
use super::settings::AssessSettings;
use crate::contact::{Balance, ContactForces, Missing, SupportError, root_rates};
use crate::dynamics::{Inertia, Rates};
use crate::hybrid::{Problem, Strategy, explain, minimise};
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::posture::Posture;
use crate::statics::Load;

/// Torques and contact forces of one instant.
pub(super) struct Evaluation<'a> {
    /// With the strength of the last update, where muscles give it.
    pub(super) model: Model,
    ranges: &'a [Option<(f64, f64)>],
    pub(super) torques: JointTorques,
    pub(super) contact: Option<ContactForces>,
    rates: &'a [Rates],
    /// None of postures at rest.
    pub(super) inertia: Option<Inertia>,
    root: Vec<usize>,
    loads: Vec<Load>,
    angle_error: f64,
    /// Space for the angles of all coordinates.
    values: Vec<f64>,
}

impl<'a> Evaluation<'a> {
    pub(super) fn new(model: &Model, settings: &'a AssessSettings) -> Result<Self, SupportError> {
        let supports = &settings.supports;
        let contact = (!supports.is_empty()).then(|| ContactForces::new(model, supports.clone())).transpose()?;
        Ok(Self {
            model: model.clone(),
            ranges: &settings.passive_ranges,
            torques: JointTorques::with_passive_ranges(model, &settings.passive_ranges)
                .with_muscles(settings.muscles.clone()),
            contact,
            rates: &settings.rates,
            inertia: (!settings.rates.is_empty()).then(|| Inertia::new(model)),
            root: root_rates(model),
            loads: vec![],
            angle_error: settings.angle_error,
            values: vec![0.0; model.coordinates().len()],
        })
    }

    /// Computes all torques of one instant.
    pub(super) fn update(
        &mut self,
        index: usize,
        time: f64,
        posture: &Posture,
        loads: &mut impl FnMut(f64, &Kinematics, &mut Vec<Load>),
    ) -> Result<(), AssessError> {
        let Self { model, torques, .. } = self;
        let refused = |error: JointTorquesError| AssessError::Torques { index, error };
        torques.place(model, posture).map_err(|error| refused(error.into()))?;
        if let Some(muscles) = torques.muscles() {
            muscles.write_strength(model);
        }
        self.loads.clear();
        loads(time, torques.kinematics(), &mut self.loads);
        if let Some(inertia) = &mut self.inertia {
            let Rates { speeds, accelerations } = &self.rates[index];
            let update = inertia.update(model, torques.kinematics(), (speeds, accelerations), &self.loads);
            update.map_err(|error| AssessError::Inertia { index, error })?;
            inertia.add_loads(model, torques.kinematics(), &mut self.loads);
        }
        match &mut self.contact {
            Some(contact) => torques.apply_with_contact(model, &self.loads, contact, Quantities::TORQUES),
            None => torques.apply(model, &self.loads, Quantities::TORQUES),
        }
        .map_err(refused)?;
        if let Some(inertia) = &mut self.inertia {
            inertia.update_about_axes(model, torques.kinematics_by_axes());
        }
        Ok(())
    }

    /// Torque of inertia of a rate about its axis, N m.
    pub(super) fn inertia_about_axis(&self, rate: usize) -> f64 {
        self.inertia.as_ref().map_or(0.0, |inertia| inertia.about_axes()[rate])
    }

    /// Active torque of a rate, N m.
    pub(super) fn active(&self, rate: usize) -> f64 {
        self.torques.active_torque()[rate]
    }

    /// The change of the passive torque of a coordinate within the error of its angle that most eases a group which works against it, N m. At the
    /// most the passive torque vanishes, and with it the active torque that it asks for. Where the external torque is the larger one the load
    /// decides, and nothing changes; from twice the external torque on the whole change counts, between them a part in proportion.
    pub(super) fn eased_passive(&mut self, coordinate: usize) -> f64 {
        let Some(rate) = self.model.coordinates()[coordinate].rate.filter(|_| self.angle_error > 0.0) else {
            return 0.0;
        };
        let (active, (external, passive)) = (self.active(rate), self.torques.external_and_passive(rate));
        // Muscles of several joints have no passive torque of one joint alone.
        let of_muscles = self.torques.muscles().is_some_and(|muscles| muscles.gives_passive(rate));
        if active * passive >= 0.0 || of_muscles || !self.model.rates()[rate].rotational {
            return 0.0;
        }
        let Self { model, torques, values, angle_error: error, .. } = self;
        let at = (&*model, torques.kinematics());
        let mut law = |turn: f64| torques.passive_torque().torque_after_turn(at, coordinate, turn, values);
        let here = law(0.0);
        // Against `active` from the side of `passive`: at the most by as much as either has.
        let most = active.abs().min(passive.abs());
        let eased = [-*error, *error].map(|turn| (here - law(turn)) * passive.signum());
        let share = (passive.abs() / external.abs() - 1.0).clamp(0.0, LIGAMENT_RATIO - 1.0);
        -passive.signum() * share * eased[0].max(eased[1]).clamp(0.0, most)
    }

    /// Force (N) and moment (N m) that the root lacks: its active torque, for which it has no muscles.
    pub(super) fn residual(&self) -> (f64, f64) {
        let size = |turns: bool| {
            let rates = self.root.iter().filter(|&&rate| self.model.rates()[rate].rotational == turns);
            rates.map(|&rate| self.active(rate).powi(2)).sum::<f64>().sqrt()
        };
        (size(false), size(true))
    }

    /// Whether the body has loads beside its weight.
    pub(super) fn is_loaded(&self) -> bool {
        !self.loads.is_empty()
    }

    /// Whether the supports cannot hold the root.
    pub(super) fn is_out_of_balance(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.balance() != Balance::Held)
    }

    /// Force and torque that the supports lack in the posture of the last update.
    pub(super) fn missing(&self) -> Option<Missing> {
        self.contact.as_ref()?.missing(&self.model, self.torques.kinematics())
    }

    /// Adds what both strategies propose to a group in the posture of the last update.
    pub(super) fn propose(&self, group: &mut GroupAssessment, at: PeakKind, time: f64, settings: &AssessSettings) {
        let i = group.coordinate;
        let coordinate = &self.model.coordinates()[i];
        let Some(rate) = coordinate.rate else { return };
        // Muscles of several joints need not give a falling curve, which the tables need.
        let of_muscles = self.torques.muscles().is_some_and(|muscles| muscles.gives_passive(rate));
        if of_muscles || Side::of(self.active(rate)) != group.side {
            return;
        }
        let range = proposed_range(coordinate.range, self.ranges.get(i).copied().flatten());
        let (passive, kinematics) = (self.torques.passive_torque(), self.torques.kinematics());
        let Some(curve) = passive.curve_about_axis(&self.model, kinematics, i, range) else { return };
        let value = passive.values()[i];
        let slope = self.torques.own_slope_about_axis(&self.model, rate);
        for strategy in [Strategy::Active, Strategy::Passive] {
            let problem = Problem {
                curve: &curve,
                angle: value.max(curve.range().0).min(curve.range().1),
                external_torque: self.torques.external_about_axes()[rate],
                external_slope: slope,
                strategy,
                minimum_decrease_ratio: settings.minimum_decrease_ratio,
                torque_tolerance: settings.torque_tolerance,
                accepted: None,
            };
            if let Ok(decision) = minimise(&problem) {
                let (angle, sentence) = (value, explain(&problem, &decision));
                group.proposals.push(Proposal { at, time, angle, strategy, decision, sentence });
            }
        }
    }
}

/// The angles in which relief is sought: those of the model's own range for which the passive law is meant, too. A goal outside of the
/// model's own range could not be taken. The own range alone where the two have no angle in common.
fn proposed_range(own: (f64, f64), meant: Option<(f64, f64)>) -> (f64, f64) {
    let Some(meant) = meant else { return own };
    let both = (own.0.max(meant.0), own.1.min(meant.1));
    if both.0 < both.1 { both } else { own }
}

#[cfg(test)]
mod tests {
    use super::proposed_range;

    #[test]
    fn relief_is_sought_inside_the_models_own_range() {
        assert_eq!(proposed_range((0.0, 2.0), None), (0.0, 2.0));
        assert_eq!(proposed_range((0.0, 2.0), Some((-0.2, 1.5))), (0.0, 1.5));
        assert_eq!(proposed_range((f64::NEG_INFINITY, f64::INFINITY), Some((-0.2, 1.5))), (-0.2, 1.5));
        assert_eq!(proposed_range((0.0, 1.0), Some((2.0, 3.0))), (0.0, 1.0), "nothing in common");
    }
}
