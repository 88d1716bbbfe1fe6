//! Computes the activations by which muscles give asked torques at the least sum of squares or cubes (static optimisation; Crowninshield &
//! Brand 1981 and Kaufman et al. 1991, recalled).
//!
//! ```text
//! minimise  sum |a_m|^p + sum |x_k|^p     subject to   sum_m R_km F_m a_m + f_k x_k = tau_k,   lower_m <= a_m <= upper_m
//! ```
//!
//! with moment arms `R`, the tension `F` of full activation beyond that of none, and reserve actuators of a force or torque `f`.
//! Squares under equations and bounds are two levels of strict priority ([`hierarchical_least_squares`]): the equations, then
//! all unknowns at zero. Cubes are found from there by Newton's method: each step is the least sum of squares of the second-order model
//! `3 |a_m| (a - a_m / 2)^2` under the same equations and bounds, and is halved until the sum of cubes falls. Where the muscles cannot give the
//! torques, the first level keeps the least sum of squared residuals.

use hierarchical_least_squares::{Level, Problem, ProblemError, Solver, Status};

use super::Musculature;
use super::geometry::PathGeometry;

/// Largest number of steps toward the least sum of cubes.
const CUBE_STEPS: usize = 60;
/// A step toward the least sum of cubes that changes no activation by more is the last.
const SAME_ACTIVATION: f64 = 1e-10;
/// Most halvings of such a step.
const MOST_CUBE_HALVINGS: i32 = 30;
/// A step that changes no activation by more is not halved.
const SMALL_STEP: f64 = 1e-5;
/// Least curvature of a cube, at the first step: an unknown at zero has none. A quarter of it at each further step, down to the second number.
const LEAST_CURVATURE: [f64; 2] = [1e-3, 1e-8];

/// The measure by which muscles share torques.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sharing {
    /// Least sum of squared activations: OpenSim's default.
    #[default]
    Squares,
    /// Least sum of cubed activations: more muscles work, each less.
    Cubes,
}

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
    sharing: Sharing,
    /// Activations, then uses of reserves.
    found: Vec<f64>,
    step: Vec<f64>,
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
        self.sharing = muscles.sharing;
        let mut status = self.solver.solve_next(&self.problem)?;
        self.found.clear();
        self.found.extend_from_slice(self.solver.solution());
        if self.sharing == Sharing::Cubes && status == Status::Solved {
            status = self.refine()?;
        }
        Ok(status)
    }

    /// Goes from the activations found on to those of the least sum of cubes.
    fn refine(&mut self) -> Result<Status, ProblemError> {
        let count = self.found.len();
        let mut least = LEAST_CURVATURE[0];
        for _ in 0..CUBE_STEPS {
            let model = &mut self.problem.levels[1];
            for (j, x) in self.found.iter().enumerate() {
                let curvature = (6.0 * x.abs()).max(least);
                let weight = curvature.sqrt();
                let target = weight * (x - 3.0 * x * x.abs() / curvature);
                model.matrix[j * count + j] = weight;
                (model.lower[j], model.upper[j]) = (target, target);
            }
            let status = self.solver.solve_next(&self.problem)?;
            if status != Status::Solved {
                return Ok(status);
            }
            self.step.clear();
            self.step.extend(self.solver.solution().iter().zip(&self.found).map(|(next, x)| next - x));
            let cubes = |share: f64| -> f64 {
                self.found.iter().zip(&self.step).map(|(x, step)| (x + share * step).abs().powi(3)).sum()
            };
            let change = self.step.iter().fold(0.0f64, |most, step| most.max(step.abs()));
            // Near the end the sum falls by less than its rounding.
            let before = if change <= SMALL_STEP { f64::INFINITY } else { cubes(0.0) };
            let share = (0..MOST_CUBE_HALVINGS).map(|k| 0.5f64.powi(k)).find(|share| cubes(*share) < before);
            let Some(share) = share else { break };
            self.found.iter_mut().zip(&self.step).for_each(|(x, step)| *x += share * step);
            if change <= SAME_ACTIVATION {
                break;
            }
            least = (0.25 * least).max(LEAST_CURVATURE[1]);
        }
        Ok(Status::Solved)
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
        let rest = &mut problem.levels[1];
        (0..unknowns).for_each(|j| rest.matrix[j * unknowns + j] = 1.0);
        rest.lower.fill(0.0);
        rest.upper.fill(0.0);
        problem.levels[0].clear();
        problem.levels[0].hard = true;
        self.muscles = muscles;
    }

    /// Activation of every muscle.
    pub fn activations(&self) -> &[f64] {
        self.found.get(..self.muscles).unwrap_or_default()
    }

    /// Use of the reserve actuators, as shares of their torques.
    pub fn reserves(&self) -> &[f64] {
        self.found.get(self.muscles..).unwrap_or_default()
    }

    /// Torque given less torque asked, by rate asked for, N m.
    pub fn residual(&self) -> &[f64] {
        self.solver.residual(0)
    }

    /// Largest violation of the conditions of optimality: with the slope `g` of the sum (`a` of squares, halved; `3 a |a|` of cubes) and
    /// multipliers `y` of the equations, every unknown is `a - g + A^T y` moved to its nearest bound. Infinite where no unknown is between its
    /// bounds: it determines no multipliers.
    pub fn optimality(&self) -> f64 {
        let (problem, found) = (&self.problem, &self.found);
        let slope = |j: usize| match self.sharing {
            Sharing::Squares => found[j],
            Sharing::Cubes => 3.0 * found[j] * found[j].abs(),
        };
        let (n, matrix) = (problem.unknowns(), &problem.levels[0].matrix);
        let rows = problem.levels[0].rows();
        let free: Vec<usize> = (0..n).filter(|&j| found[j] > problem.lower[j] && found[j] < problem.upper[j]).collect();
        if free.is_empty() || rows == 0 {
            return f64::INFINITY;
        }
        let columns = nalgebra::DMatrix::from_fn(free.len(), rows, |k, row| matrix[row * n + free[k]]);
        let right = nalgebra::DVector::from_fn(free.len(), |k, _| slope(free[k]));
        let greatest = columns.amax();
        let multipliers = columns.svd(true, true).solve(&right, super::tolerances::LEAST_SINGULAR * greatest);
        let Ok(multipliers) = multipliers else { return f64::INFINITY };
        let wanted = |j: usize| (0..rows).map(|row| matrix[row * n + j] * multipliers[row]).sum::<f64>();
        let moved = |j: usize| found[j] - slope(j) + wanted(j);
        let off = (0..n).map(|j| (moved(j).max(problem.lower[j]).min(problem.upper[j]) - found[j]).abs());
        off.fold(0.0, f64::max)
    }
}
