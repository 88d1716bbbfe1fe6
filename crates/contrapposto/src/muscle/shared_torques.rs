//! States the torques that muscles share in a posture, and the greatest multiple of them that they can give.
//!
//! With moment arms `R` and the tension `F` of full activation beyond that of none, muscles of capacities `c` (1 rested) hold torques `tau` if
//! `sum_m R_km F_m a_m = tau_k` for some `0 <= a_m <= c_m`. The greatest multiple, a linear program, and its dual:
//!
//! ```text
//! greatest lambda   subject to   sum_m R_km F_m a_m = lambda tau_k,   0 <= a_m <= c_m
//! least sum_m d_m c_m   subject to   d_m >= sum_k y_k R_km F_m,   d_m >= 0,   sum_k y_k tau_k = 1
//! ```
//!
//! Where it is 1 the torques are at their limit, and the shares `y_k tau_k` of torques and `d_m c_m` of muscles, which both add up to it, name
//! the torques that fail and the muscles that limit them.

use super::Musculature;
use super::coupled_strength::{CoupledStrength, coupled_within};
use super::geometry::PathGeometry;
use super::static_optimisation::Recruitment;
use super::tolerances::MOST_TIMES;
use crate::math::LinearProgram;

/// Torques that muscles share in a posture.
#[derive(Clone, Copy, Debug)]
pub struct SharedTorques<'a> {
    /// The muscles.
    pub muscles: &'a Musculature,
    /// Paths of the muscles in the posture.
    pub geometry: &'a PathGeometry,
    /// The rates at which torque is asked for.
    pub rates: &'a [usize],
    /// Torque at each of them, N m.
    pub torques: &'a [f64],
    /// Tension of every muscle at full activation beyond that at none, N, not negative.
    pub forces: &'a [f64],
}

/// The greatest multiple of torques that muscles can give.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueLimit {
    /// Multiple: from 1 on the torques can be held. At most 1e6, for torques that are almost none.
    pub times: f64,
    /// Share of each torque in the limit, by rate asked for; they add up to 1. Negative for a torque without which the limit would be lower.
    pub of_torques: Vec<f64>,
    /// Share of every muscle in the limit; they add up to `times`. Zero for a muscle that could give more, or would not help.
    pub of_muscles: Vec<f64>,
}

impl SharedTorques<'_> {
    /// Torque about each asked rate of every muscle at full activation, N m.
    fn columns(&self) -> impl Iterator<Item = Vec<f64>> {
        let Self { muscles, geometry, forces, .. } = *self;
        self.rates.iter().map(move |&rate| {
            let arms = muscles.muscles.iter().map(|muscle| geometry.moment_arms(muscle.spec().path)[rate]);
            arms.zip(forces).map(|(arm, force)| arm * force).collect()
        })
    }

    /// The problem of static optimisation within bounds of activation.
    pub(super) fn recruitment<'a>(&'a self, none: &'a [f64], bounds: &'a [(f64, f64)]) -> Recruitment<'a> {
        let Self { rates, torques, forces, .. } = *self;
        Recruitment { rates, torques, reserves: none, forces, bounds }
    }

    /// The greatest multiple of the torques that muscles of given capacities (0 to 1) can give.
    ///
    /// # Panics
    /// Unless there is a force and a capacity for every muscle, and a torque for every rate.
    pub fn limit(&self, capacities: &[f64]) -> TorqueLimit {
        self.check(capacities);
        let rows: Vec<Vec<f64>> = self.columns().collect();
        let matrix = rows.iter().zip(self.torques).flat_map(|(row, torque)| row.iter().copied().chain([-torque]));
        let upper: Vec<f64> = capacities.iter().copied().chain([MOST_TIMES]).collect();
        let mut program = LinearProgram::new(matrix.collect(), vec![0.0; rows.len()], &upper);
        let mut cost = vec![0.0; upper.len()];
        cost[capacities.len()] = 1.0;
        let found = program.maximise(&cost);
        // The equations are those of the muscles less the multiple of the torques: their multipliers are `-y`.
        let of_torques = found.multipliers.iter().zip(self.torques).map(|(y, torque)| -y * torque).collect();
        let of_muscle = |(m, capacity): (usize, &f64)| {
            let gain: f64 = found.multipliers.iter().zip(&rows).map(|(y, row)| -y * row[m]).sum();
            gain.max(0.0) * capacity
        };
        let of_muscles = capacities.iter().enumerate().map(of_muscle).collect();
        TorqueLimit { times: found.value, of_torques, of_muscles }
    }

    /// Greatest and least torque about each asked rate that muscles of given capacities (0 to 1) can give while they give the asked torques
    /// about all others.
    ///
    /// # Panics
    /// As [`SharedTorques::limit`].
    pub fn strengths(&self, capacities: &[f64]) -> Vec<CoupledStrength> {
        self.strengths_beside(self.torques, capacities)
    }

    /// The same while the others give `held`, N m, by rate asked for.
    pub(crate) fn strengths_beside(&self, held: &[f64], capacities: &[f64]) -> Vec<CoupledStrength> {
        self.check(capacities);
        let rows: Vec<Vec<f64>> = self.columns().collect();
        coupled_within(&rows, &vec![0.0; rows.len()], held, capacities, self.rates)
    }

    /// Fatigue of the groups of each asked rate, of the positive and the negative sense: `(S0 - S) / (S0 - T)` with the strength `S0` of
    /// `rested` muscles, that of `tired` ones, `S`, both by [`SharedTorques::strengths`], and the torque `T` that is asked of the group. 0
    /// rested, 1 when the torque can no longer be held, as everywhere; 1 too where the rested group cannot hold it.
    ///
    /// # Panics
    /// Unless there are two strengths for every rate.
    pub fn group_fatigue(&self, rested: &[CoupledStrength], tired: &[CoupledStrength]) -> Vec<[f64; 2]> {
        assert!(rested.len() == self.rates.len() && tired.len() == rested.len(), "two strengths for every rate");
        let of_rate = |k: usize| {
            [(0, 1.0), (1, -1.0)].map(|(side, sense)| {
                let [rested, tired] = [rested, tired].map(|of| sense * of[k].torque[side]);
                let asked = (sense * self.torques[k]).max(0.0);
                match rested - asked {
                    spare if spare > 0.0 => ((rested - tired) / spare).clamp(0.0, 1.0),
                    _ if asked > 0.0 => 1.0,
                    _ => 0.0,
                }
            })
        };
        (0..self.rates.len()).map(of_rate).collect()
    }

    fn check(&self, capacities: &[f64]) {
        let count = self.muscles.muscles.len();
        assert!(self.forces.len() == count && capacities.len() == count, "a force and a capacity for every muscle");
        assert_eq!(self.rates.len(), self.torques.len(), "a torque for every rate");
    }
}
