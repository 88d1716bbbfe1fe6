//! Computes the greatest torque about a joint that muscles can give while they hold given torques at all other joints.
//!
//! The tension of every muscle is taken as linear in its activation, `F0 + a (F1 - F0)` with `0 <= a <= 1`, between its equilibria at rest
//! and at full activation. With moment arms `R` and the torques `tau_j` that are held, a linear program:
//!
//! ```text
//! greatest of  R_i (F0 + a (F1 - F0))   subject to   R_j (F0 + a (F1 - F0)) = tau_j  for all other muscled rates j
//! ```
//!
//! It is never above the plain sum ([`super::strength`]), which holds nothing.

use super::Musculature;
use super::fiber::FiberState;
use super::geometry::PathGeometry;
use crate::math::LinearProgram;

/// The greatest torques about one rate with all others held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoupledStrength {
    /// The rate.
    pub rate: usize,
    /// Greatest and least torque of the tensions, N m.
    pub torque: [f64; 2],
    /// Torque that the muscles lack to hold the other rates, summed over these, N m; 0 where they hold them.
    pub missing: f64,
    /// Greatest gap between primal and dual program, N m: zero but for rounding.
    pub gap: f64,
}

/// Coupled strength about each of `rates` (usually [`PathGeometry::crossed`]) while the others carry the torques `held`, one entry a rate
/// of the model.
///
/// # Panics
/// Unless there are two states for every muscle and a torque for every rate.
pub fn coupled_strength(
    muscles: &Musculature,
    geometry: &PathGeometry,
    rest: &[FiberState],
    full: &[FiberState],
    rates: &[usize],
    held: &[f64],
) -> Vec<CoupledStrength> {
    let count = muscles.muscles.len();
    assert!(rest.len() == count && full.len() == count, "two states a muscle");
    let arms = |rate: usize| muscles.muscles.iter().map(move |muscle| geometry.moment_arms(muscle.spec().path)[rate]);
    let rows: Vec<Vec<f64>> = rates
        .iter()
        .map(|&rate| {
            let forces = rest.iter().zip(full).map(|(rest, full)| full.tendon_force - rest.tendon_force);
            arms(rate).zip(forces).map(|(arm, force)| arm * force).collect()
        })
        .collect();
    let base: Vec<f64> =
        rates.iter().map(|&rate| arms(rate).zip(rest).map(|(arm, rest)| arm * rest.tendon_force).sum()).collect();
    let held: Vec<f64> = rates.iter().map(|&rate| held[rate]).collect();
    coupled_within(&rows, &base, &held, &vec![1.0; count], rates)
}

/// The same of muscles with the torques `rows` at full activation beyond those `base` at none, of activations up to `upper`, while the
/// others carry the torques `held`; one row, base and torque a rate.
pub(super) fn coupled_within(
    rows: &[Vec<f64>],
    base: &[f64],
    held: &[f64],
    upper: &[f64],
    rates: &[usize],
) -> Vec<CoupledStrength> {
    let one = |k: usize| {
        let others = (0..rates.len()).filter(|&other| other != k);
        let matrix = others.clone().flat_map(|other| rows[other].iter().copied()).collect();
        let right = others.map(|other| held[other] - base[other]).collect();
        let mut program = LinearProgram::new(matrix, right, upper);
        let [greatest, least] = [1.0, -1.0].map(|sign| {
            let cost: Vec<f64> = rows[k].iter().map(|entry| sign * entry).collect();
            program.maximise(&cost)
        });
        CoupledStrength {
            rate: rates[k],
            torque: [base[k] + greatest.value, base[k] - least.value],
            missing: program.residual(),
            gap: greatest.gap.max(least.gap),
        }
    };
    (0..rates.len()).map(one).collect()
}
