//! Computes the activations by which muscles give asked torques at the least sum of squares (static optimisation; Crowninshield & Brand
//! 1981 and Kaufman et al. 1991, recalled).
//!
//! ```text
//! minimise  sum a_m^2 + sum x_k^2     subject to   sum_m R_km F_m a_m + f_k x_k = tau_k,   lower_m <= a_m <= upper_m
//! ```
//!
//! with moment arms `R`, the tension `F` of full activation beyond that of none, and reserve actuators of a force or torque `f`.
//! Squares under equations and bounds are two levels of strict priority ([`hierarchical_least_squares`]): the equations, then
//! all unknowns at zero. Where the muscles cannot give the torques, the first level keeps the least sum of squared residuals.

use hierarchical_least_squares::{Level, Problem, ProblemError, Solver, Status};

use super::Musculature;
use super::geometry::PathGeometry;

/// The torques that muscles have to give in a posture, and the limits within which they give them.
#[derive(Clone, Copy, Debug)]
pub struct Recruitment<'a> {
    /// The rates at which torque is asked for.
    pub rates: &'a [usize],
    /// Torque at each of them, N m.
    pub torques: &'a [f64],
    /// Torque of a reserve actuator at full use at each of them, N m; 0 for none.
    pub reserves: &'a [f64],
    /// Tension of every muscle at full activation beyond that at none, N.
    pub forces: &'a [f64],
    /// Least and greatest activation of every muscle.
    pub bounds: &'a [(f64, f64)],
}

/// Finds activations; allocates nothing once it has had a problem of the size.
#[derive(Clone, Debug, Default)]
pub struct StaticOptimisation {
    problem: Problem,
    solver: Solver,
    muscles: usize,
}

impl StaticOptimisation {
    /// Solves from the last answer's bounds, for the next of a sequence of postures.
    ///
    /// # Errors
    /// [`ProblemError`] for numbers that are not finite, or a lower bound above the upper one.
    ///
    /// # Panics
    /// Unless there is a force and a pair of bounds for every muscle, and a torque and a reserve for every rate.
    pub fn solve(
        &mut self,
        muscles: &Musculature,
        geometry: &PathGeometry,
        asked: &Recruitment<'_>,
    ) -> Result<Status, ProblemError> {
        let Recruitment { rates, torques, reserves, forces, bounds } = *asked;
        let count = muscles.muscles.len();
        assert!(forces.len() == count && bounds.len() == count, "a force and bounds for every muscle");
        assert!(torques.len() == rates.len() && reserves.len() == rates.len(), "a torque and a reserve for every rate");
        let helping = reserves.iter().filter(|reserve| **reserve != 0.0).count();
        let unknowns = count + helping;
        self.prepare(count, unknowns);
        for (unknown, (lower, upper)) in bounds.iter().enumerate() {
            (self.problem.lower[unknown], self.problem.upper[unknown]) = (*lower, *upper);
        }
        let level = &mut self.problem.levels[0];
        let mut helper = count;
        for ((&rate, &torque), &reserve) in rates.iter().zip(torques).zip(reserves) {
            let start = level.matrix.len();
            let arms = muscles.muscles.iter().map(|muscle| geometry.moment_arms(muscle.spec().path)[rate]);
            level.matrix.extend(arms.zip(forces).map(|(arm, force)| arm * force));
            level.matrix.resize(start + unknowns, 0.0);
            if reserve != 0.0 {
                level.matrix[start + helper] = reserve;
                helper += 1;
            }
            level.lower.push(torque);
            level.upper.push(torque);
        }
        self.solver.solve_next(&self.problem)
    }

    /// Empty equations, free reserves, and a last level of all unknowns at zero.
    fn prepare(&mut self, muscles: usize, unknowns: usize) {
        let problem = &mut self.problem;
        if problem.unknowns() != unknowns || problem.levels.len() != 2 {
            *problem = Problem::new(unknowns);
            let mut rest = Level::with_capacity(unknowns, unknowns);
            let mut row = vec![0.0; unknowns];
            for unknown in 0..unknowns {
                row[unknown] = 1.0;
                rest.push(&row, 0.0, 0.0);
                row[unknown] = 0.0;
            }
            problem.levels = vec![Level::default(), rest];
        }
        problem.lower[muscles..].fill(f64::NEG_INFINITY);
        problem.upper[muscles..].fill(f64::INFINITY);
        problem.levels[0].clear();
        problem.levels[0].hard = true;
        self.muscles = muscles;
    }

    /// Activation of every muscle.
    pub fn activations(&self) -> &[f64] {
        self.solver.solution().get(..self.muscles).unwrap_or_default()
    }

    /// Use of the reserve actuators, as shares of their torques.
    pub fn reserves(&self) -> &[f64] {
        self.solver.solution().get(self.muscles..).unwrap_or_default()
    }

    /// Torque given less torque asked, by rate asked for, N m.
    pub fn residual(&self) -> &[f64] {
        self.solver.residual(0)
    }

    /// Largest violation of the conditions of optimality, as a change of activation: with multipliers `y` of the equations, every
    /// unknown is `A^T y` moved to its nearest bound. Infinite where no unknown is between its bounds: it determines no multipliers.
    pub fn optimality(&self) -> f64 {
        let (problem, found) = (&self.problem, self.solver.solution());
        let (n, matrix) = (problem.unknowns(), &problem.levels[0].matrix);
        let rows = problem.levels[0].rows();
        let free: Vec<usize> = (0..n).filter(|&j| found[j] > problem.lower[j] && found[j] < problem.upper[j]).collect();
        if free.is_empty() || rows == 0 {
            return f64::INFINITY;
        }
        let columns = nalgebra::DMatrix::from_fn(free.len(), rows, |k, row| matrix[row * n + free[k]]);
        let right = nalgebra::DVector::from_fn(free.len(), |k, _| found[free[k]]);
        let greatest = columns.amax();
        let multipliers = columns.svd(true, true).solve(&right, super::tolerances::LEAST_SINGULAR * greatest);
        let Ok(multipliers) = multipliers else { return f64::INFINITY };
        let wanted = |j: usize| (0..rows).map(|row| matrix[row * n + j] * multipliers[row]).sum::<f64>();
        let off = (0..n).map(|j| (wanted(j).max(problem.lower[j]).min(problem.upper[j]) - found[j]).abs());
        off.fold(0.0, f64::max)
    }
}
