//! Computes torques by rate from the tensions of muscles and their moment arms.

use super::Musculature;
use super::fiber::FiberState;
use super::geometry::PathGeometry;

/// The tension of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tension {
    /// N.
    pub force: f64,
    /// Derivative of the tension by the path's length, N/m.
    pub stiffness: f64,
}

/// Tensions of paths from the fibres' passive forces and those of ligaments, overwritten; one state a muscle, one tension a path. Does not allocate.
///
/// # Panics
/// Unless there is a state for every muscle and a tension for every path.
pub fn passive_tensions(
    muscles: &Musculature,
    geometry: &PathGeometry,
    states: &[FiberState],
    tensions: &mut [Tension],
) {
    assert_eq!(states.len(), muscles.muscles.len(), "one state a muscle");
    assert_eq!(tensions.len(), muscles.paths.paths.len(), "one tension a path");
    tensions.fill(Tension::default());
    for (muscle, state) in muscles.muscles.iter().zip(states) {
        let tension = &mut tensions[muscle.spec().path];
        tension.force += state.passive_force;
        tension.stiffness += state.passive_stiffness;
    }
    for ligament in &muscles.ligaments {
        let (force, slope) = ligament.law.tension_and_slope(geometry.lengths()[ligament.path]);
        let tension = &mut tensions[ligament.path];
        tension.force += force;
        tension.stiffness += slope;
    }
}

/// Torque of the fibres' passive forces by rate, N m (N for slides), overwritten; one state a muscle. Does not allocate.
///
/// # Panics
/// Unless there is a state for every muscle and room for every rate.
pub fn passive_fiber_torque(muscles: &Musculature, geometry: &PathGeometry, states: &[FiberState], torque: &mut [f64]) {
    assert_eq!(states.len(), muscles.muscles.len(), "one state a muscle");
    torque.fill(0.0);
    for (muscle, state) in muscles.muscles.iter().zip(states) {
        let arms = geometry.moment_arms(muscle.spec().path);
        assert_eq!(arms.len(), torque.len(), "one torque a rate");
        torque.iter_mut().zip(arms).for_each(|(torque, arm)| *torque += arm * state.passive_force);
    }
}

/// Torque of the fibres' passive forces and of ligaments by rate, N m (N for slides), overwritten; one state a muscle. That of bushings
/// is [`super::bushing_torque`]. Does not allocate.
///
/// # Panics
/// As [`passive_fiber_torque`].
pub fn passive_torque(muscles: &Musculature, geometry: &PathGeometry, states: &[FiberState], torque: &mut [f64]) {
    passive_fiber_torque(muscles, geometry, states, torque);
    for ligament in &muscles.ligaments {
        let (tension, _) = ligament.law.tension_and_slope(geometry.lengths()[ligament.path]);
        let arms = geometry.moment_arms(ligament.path);
        torque.iter_mut().zip(arms).for_each(|(torque, arm)| *torque += arm * tension);
    }
}

/// Greatest torque by rate in the positive and in the negative sense, N m (N for slides), overwritten: the muscles that pull that way at
/// the forces of `full`, all others at those of `rest`, as a plain sum that minds no other joint. Does not allocate.
///
/// # Panics
/// Unless there are two states for every muscle and room for every rate.
pub fn strength(
    muscles: &Musculature,
    geometry: &PathGeometry,
    rest: &[FiberState],
    full: &[FiberState],
    strength: &mut [[f64; 2]],
) {
    assert!(rest.len() == muscles.muscles.len() && full.len() == rest.len(), "two states a muscle");
    strength.fill([0.0; 2]);
    for (muscle, (rest, full)) in muscles.muscles.iter().zip(rest.iter().zip(full)) {
        let arms = geometry.moment_arms(muscle.spec().path);
        assert_eq!(arms.len(), strength.len(), "one strength a rate");
        for (strength, arm) in strength.iter_mut().zip(arms) {
            let (positive, negative) = if *arm > 0.0 { (full, rest) } else { (rest, full) };
            strength[0] += arm * positive.tendon_force;
            strength[1] += arm * negative.tendon_force;
        }
    }
}
