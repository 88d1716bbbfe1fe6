//! Gives the torques of a posture to the muscles of the body, each with the law by which it tires.
//!
//! Active torque (Eq. 1) is what muscles give beyond their passive torque. So a muscle's load is its tension beyond that of its passive fibres, over
//! the same at full activation, `F = F_1 - F_p`: of a joint with one muscle that is the relative load of the joint. A muscle without load has
//! no tone.
//!
//! Parameters of fatigue belong to muscle groups of joints. A muscle takes those of the group that it works for: of all joints whose strength
//! muscles give, the one about which its moment arm is greatest in the default posture, and there the sense in which it turns. A two-joint
//! muscle has the parameters of one of its two joints, not a mixture: nobody has measured them for muscles.

use super::JointTorques;
use super::muscles::JointMuscles;
use crate::fatigue::{FatigueLaw, ThreeCompartment};
use crate::kinematics::Kinematics;
use crate::model::{Model, MuscleGroup, Side};
use crate::muscle::SharedTorques;

/// The torques of a posture that muscles share, with the laws by which the muscles tire.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleShare {
    /// The rates at which muscles give the strength.
    pub rates: Vec<usize>,
    /// Active torque of each of them about its axis, N m.
    pub torques: Vec<f64>,
    /// Tension of every muscle at full activation beyond that of its passive fibres, N.
    pub forces: Vec<f64>,
    /// The coordinate and the side of the group that each muscle works for; `None` of a muscle that turns none of these joints.
    pub works_for: Vec<Option<(usize, Side)>>,
    /// The law of every muscle: that of this group.
    pub laws: Vec<ThreeCompartment>,
}

/// The reason for which muscles do not share the torques of a posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MuscleShareError {
    /// No joint has its strength from muscles.
    #[error("no joint has its strength from the model's muscles")]
    NoMuscles,
    /// A group tires by another law.
    #[error("{group} tires by {law}; muscles need the three-compartment law (3CC-r)")]
    Law {
        /// Name of the group and of its coordinate.
        group: String,
        /// Name of the law.
        law: String,
    },
}

impl MuscleShare {
    /// The torques, in the posture for which they were computed.
    pub fn asked<'a>(&'a self, muscles: &'a JointMuscles) -> SharedTorques<'a> {
        SharedTorques {
            muscles: muscles.musculature(),
            geometry: muscles.about_axes(),
            rates: &self.rates,
            torques: &self.torques,
            forces: &self.forces,
        }
    }
}

impl MuscleShare {
    /// The share of `muscles` that were last computed in a posture in which the body gives the torque `active` at each rate, N m.
    ///
    /// # Errors
    /// [`MuscleShareError`] of muscles that give no strength, and of groups that tire by another law.
    pub(crate) fn new(
        model: &Model,
        muscles: &JointMuscles,
        active: impl Fn(usize) -> f64,
    ) -> Result<Self, MuscleShareError> {
        if muscles.strong().is_empty() {
            return Err(MuscleShareError::NoMuscles);
        }
        let rates = muscles.strong().to_vec();
        let torques = rates.iter().map(|&rate| active(rate)).collect();
        let works_for = works_for(model, muscles);
        let first = rates.first().and_then(|&rate| Some((model.rates[rate].coordinate?, Side::Positive)));
        let law = |of: &Option<(usize, Side)>| {
            // A muscle that turns no joint has no load, whatever its law.
            let (coordinate, side) = of.or(first).ok_or(MuscleShareError::NoMuscles)?;
            let groups = model.coordinates[coordinate].groups.as_ref().ok_or(MuscleShareError::NoMuscles)?;
            law_of(&groups[side.index()], &model.coordinates[coordinate].name)
        };
        let laws = works_for.iter().map(law).collect::<Result<_, _>>()?;
        Ok(Self { rates, torques, forces: muscles.forces().collect(), works_for, laws })
    }
}

impl JointMuscles {
    /// Whether muscles can tire one by one.
    ///
    /// # Errors
    /// [`MuscleShareError`] of muscles that give no strength, and of groups that tire by another law.
    pub fn can_tire(&self, model: &Model) -> Result<(), MuscleShareError> {
        MuscleShare::new(model, self, |_| 0.0).map(|_| ())
    }

    /// The coordinate and the side of the group that each muscle works for in the posture of the last update: of all joints whose strength
    /// muscles give, the one about which its moment arm is greatest, and the sense in which it turns there; `None` of one that turns none.
    pub(crate) fn works_for_now(&self, model: &Model) -> Vec<Option<(usize, Side)>> {
        let of_muscle = |path: usize| {
            let arms = self.about_axes().moment_arms(path);
            let turned = self.strong().iter().filter(|&&rate| arms[rate] != 0.0);
            let rate = *turned.max_by(|&&a, &&b| arms[a].abs().total_cmp(&arms[b].abs()))?;
            Some((model.rates[rate].coordinate?, Side::of(arms[rate])))
        };
        self.musculature().muscles.iter().map(|muscle| of_muscle(muscle.spec().path)).collect()
    }
}

impl JointTorques {
    /// The torques of the last update that the muscles share.
    ///
    /// # Errors
    /// [`MuscleShareError`] of a body without muscles that give strength, and of groups that tire by another law.
    ///
    /// # Panics
    /// When the last update did not compute active torque.
    pub fn muscle_share(&self, model: &Model) -> Result<MuscleShare, MuscleShareError> {
        let muscles = self.muscles().ok_or(MuscleShareError::NoMuscles)?;
        MuscleShare::new(model, muscles, |rate| self.active_torque()[rate])
    }
}

/// The group that each muscle works for: in the default posture.
pub(crate) fn works_for(model: &Model, muscles: &JointMuscles) -> Vec<Option<(usize, Side)>> {
    let mut at_default = muscles.clone();
    // A new body is in its default posture, which fits it.
    let _ = at_default.update(model, &model.default_posture(), &Kinematics::new(model));
    at_default.works_for_now(model)
}

fn law_of(group: &MuscleGroup, coordinate: &str) -> Result<ThreeCompartment, MuscleShareError> {
    match &group.fatigue {
        FatigueLaw::ThreeCompartment(law) => Ok(law.clone()),
        other => {
            Err(MuscleShareError::Law { group: format!("{} ({coordinate})", group.name), law: other.name().to_owned() })
        }
    }
}
