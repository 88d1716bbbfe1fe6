//! Lists what the muscles of a body can give about the joints whose strength they give.

use super::available::Demand;
use crate::joint_torques::{JointMuscles, works_for};
use crate::model::{Model, Side};

/// A muscle among the unknowns of the program, from 0 to its capacity.
#[derive(Clone, Debug)]
pub(super) struct Pull {
    /// Coordinate and side of the group that it works for; `None` of one that turns no joint.
    pub(super) works_for: Option<(usize, Side)>,
    /// Share of its tension at full activation that it can give.
    pub(super) capacity: f64,
    /// By equation: torque at full activation, times the factor of the equation.
    pub(super) column: Vec<f64>,
}

/// All muscles in the posture of their last update; `equations`: rate and factor of each. A muscle has strength and law of fatigue of the group that it works for.
pub(super) fn pulls(model: &Model, muscles: &JointMuscles, demand: Demand, equations: &[(usize, f64)]) -> Vec<Pull> {
    let strong = muscles.strong();
    if strong.is_empty() {
        return vec![];
    }
    let all = muscles.musculature().muscles.iter().zip(muscles.forces()).zip(works_for(model, muscles));
    let pull = |((muscle, force), works_for): ((&crate::muscle::Muscle, f64), Option<(usize, Side)>)| {
        let arms = muscles.about_axes().moment_arms(muscle.spec().path);
        let entry =
            |&(rate, scale): &(usize, f64)| if strong.contains(&rate) { scale * arms[rate] * force } else { 0.0 };
        let group = works_for.and_then(|(coordinate, side)| {
            let groups = model.coordinates()[coordinate].groups.as_ref()?;
            Some(&groups[side.index()])
        });
        let capacity = group.map_or(1.0, |group| demand.share(group));
        Pull { works_for, capacity, column: equations.iter().map(entry).collect() }
    };
    all.map(pull).collect()
}
