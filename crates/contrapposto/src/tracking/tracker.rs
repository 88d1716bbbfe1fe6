//! Solves the frames of a motion one after the other, each from the posture of the one before.

use nalgebra::Vector3;

use super::goals::{Goals, GoalsError};
use super::limited_step::LimitedStep;
use super::objective::Objective;
use super::tolerances::{
    ACCEPTED_DECREASE, DAMPING_FACTOR, FIRST_DAMPING, GOOD_DECREASE, LEAST_DAMPING, LEAST_DIAGONAL, LEAST_RESIDUAL,
    LONGEST_TURN, MOST_DAMPING, MOST_STEPS_A_FRAME, NO_CHANGE, OPTIMALITY, PREDICTED_DECREASE, ROUNDED_CHANGE,
};
use crate::model::Model;
use crate::posture::{Part, Posture, PostureError, parts};

/// The answer of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// The objective: half of the weighted mean of squared distances (m^2), and of the weighted squares of coordinate errors.
    pub objective: f64,
    /// First-order optimality: the greatest cosine between the weighted residual and its change along a coordinate that is not held at
    /// a limit. Residuals below 1e-5 m count as 1e-5 m.
    pub optimality: f64,
    /// Steps that were tried.
    pub steps: usize,
    /// The optimality is 1e-8 or less.
    pub converged: bool,
}

/// Solver of frames. Filled by [`Tracker::solve`].
#[derive(Clone, Debug)]
pub struct Tracker {
    goals: Goals,
    objective: Objective,
    quadratic: LimitedStep,
    /// Hard limits by coordinate.
    limits: Vec<Option<(f64, f64)>>,
    /// Limits of the step by free rate.
    room: Vec<(f64, f64)>,
    /// Matrix of the quadratic function.
    matrix: Vec<f64>,
    /// Step of all rates.
    step: Vec<f64>,
    trial: Posture,
}

/// The way to the next posture.
enum Move {
    /// A better posture was taken.
    Taken,
    /// No step is better, or the one that was taken changes rounding only.
    Last,
    /// The predicted decrease is nothing.
    Done,
}

impl Tracker {
    /// Space for `model` and goals.
    ///
    /// # Errors
    /// [`GoalsError`] when goals do not fit the model.
    pub fn new(model: &Model, goals: Goals) -> Result<Self, GoalsError> {
        goals.check(model)?;
        let fixed = |coordinate: usize| goals.fixed.contains(&coordinate) || model.is_dependent(coordinate);
        let mut free = vec![];
        for part in parts(model) {
            match part {
                Part::Axis { rate, coordinate } if !fixed(coordinate) => free.push(rate),
                Part::Ball { rate, first } if !fixed(first) => free.extend(rate..rate + 3),
                Part::Axis { .. } | Part::Ball { .. } => {}
            }
        }
        let n = free.len();
        let mut limits = vec![None; model.coordinates().len()];
        for &(coordinate, limit) in goals.limits.iter().filter(|(coordinate, _)| !fixed(*coordinate)) {
            limits[coordinate] = Some(limit);
        }
        Ok(Self {
            objective: Objective::new(model, &goals, free),
            goals,
            quadratic: LimitedStep::new(n),
            limits,
            room: vec![(0.0, 0.0); n],
            matrix: vec![0.0; n * n],
            step: vec![0.0; model.rates().len()],
            trial: model.default_posture(),
        })
    }

    /// The goals.
    pub fn goals(&self) -> &Goals {
        &self.goals
    }

    /// Moves `posture` to one where the objective of a frame is least, nearest by descent. `observed`: markers in ground, m, in the order of
    /// the goals; `None` for a gap. Coordinates out of their limits come to them first. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model.
    ///
    /// # Panics
    /// Unless there is one observation a marker.
    pub fn solve(
        &mut self,
        model: &Model,
        posture: &mut Posture,
        observed: &[Option<Vector3<f64>>],
    ) -> Result<Solved, PostureError> {
        assert_eq!(observed.len(), self.goals.markers.len(), "one observation a marker");
        posture.check(model)?;
        self.clamp(posture);
        self.step.fill(0.0);
        posture.displace(model, &self.step);
        self.objective.observe(&self.goals, observed);
        self.objective.evaluate(model, &self.goals, posture, observed)?;
        let (mut steps, mut damping) = (0, LEAST_DAMPING);
        loop {
            self.objective.derive(model, &self.goals);
            self.measure_room(model, posture);
            match self.improve(model, posture, observed, &mut steps, &mut damping)? {
                Move::Taken if steps < MOST_STEPS_A_FRAME => {}
                Move::Done => break,
                Move::Taken | Move::Last => {
                    self.objective.derive(model, &self.goals);
                    self.measure_room(model, posture);
                    break;
                }
            }
        }
        let optimality = self.optimality();
        let objective = self.objective.value;
        Ok(Solved { objective, optimality, steps, converged: optimality <= OPTIMALITY })
    }

    /// The answer of a frame that keeps its posture. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model.
    ///
    /// # Panics
    /// Unless there is one observation a marker.
    pub fn stay(
        &mut self,
        model: &Model,
        posture: &Posture,
        observed: &[Option<Vector3<f64>>],
    ) -> Result<Solved, PostureError> {
        assert_eq!(observed.len(), self.goals.markers.len(), "one observation a marker");
        posture.check(model)?;
        self.objective.observe(&self.goals, observed);
        let objective = self.objective.evaluate(model, &self.goals, posture, observed)?;
        Ok(Solved { objective, optimality: 0.0, steps: 0, converged: true })
    }

    /// Error of each marker in the posture of the last frame, m; `None` for gaps.
    pub fn errors(&self) -> impl Iterator<Item = Option<f64>> {
        self.objective.errors.iter().map(|error| error.map(|error| error.norm()))
    }

    /// Tries steps with more and more damping until one decreases the objective.
    fn improve(
        &mut self,
        model: &Model,
        posture: &mut Posture,
        observed: &[Option<Vector3<f64>>],
        steps: &mut usize,
        damping: &mut f64,
    ) -> Result<Move, PostureError> {
        let before = self.objective.value;
        let at_end = self.optimality() <= OPTIMALITY;
        while *steps < MOST_STEPS_A_FRAME && *damping <= MOST_DAMPING {
            let Some(predicted) = self.quadratic_step(*damping) else {
                *steps += 1;
                *damping = (*damping * DAMPING_FACTOR).max(FIRST_DAMPING);
                continue;
            };
            if predicted <= 0.0 || (at_end && predicted <= PREDICTED_DECREASE * before) {
                return Ok(Move::Done);
            }
            *steps += 1;
            self.trial.values_mut().copy_from_slice(posture.values());
            for (step, &rate) in self.quadratic.step.iter().zip(&self.objective.free) {
                self.step[rate] = *step;
            }
            self.trial.displace(model, &self.step);
            self.clamp_trial();
            // A trial too far away to have a place is refused as one that is no better.
            let after = self.objective.evaluate(model, &self.goals, &self.trial, observed).unwrap_or(f64::INFINITY);
            let tiny = predicted <= ROUNDED_CHANGE * before.max(LEAST_RESIDUAL * LEAST_RESIDUAL);
            let share = (before - after) / predicted;
            if share >= ACCEPTED_DECREASE || (tiny && after <= before * (1.0 + ROUNDED_CHANGE)) {
                posture.values_mut().copy_from_slice(self.trial.values());
                if share >= GOOD_DECREASE {
                    *damping = if *damping <= FIRST_DAMPING { LEAST_DAMPING } else { *damping / DAMPING_FACTOR };
                }
                return Ok(if tiny { Move::Last } else { Move::Taken });
            }
            *damping = (*damping * DAMPING_FACTOR).max(FIRST_DAMPING);
        }
        self.objective.evaluate(model, &self.goals, posture, observed)?;
        Ok(Move::Last)
    }

    /// The step to the least point of the damped quadratic function; answers the predicted decrease, `None` where the matrix is singular.
    fn quadratic_step(&mut self, damping: f64) -> Option<f64> {
        self.fill_matrix(damping, 1.0);
        let objective = &self.objective;
        if let Some(predicted) = self.quadratic.solve(&self.matrix, &objective.gradient, &self.room) {
            return Some(predicted);
        }
        self.fill_matrix(damping, 0.0);
        self.quadratic.solve(&self.matrix, &self.objective.gradient, &self.room)
    }

    /// `J^T W J + share curvature + damping`.
    fn fill_matrix(&mut self, damping: f64, share: f64) {
        let n = self.objective.free.len();
        let diagonal = |i: usize| self.objective.matrix[i * n + i];
        // A coordinate with a task of great weight must not set the scale of all others.
        let most = self.objective.scale;
        let entries = self.objective.matrix.iter().zip(&self.objective.curvature);
        self.matrix.iter_mut().zip(entries).for_each(|(to, (first, second))| *to = first + share * second);
        for i in 0..n {
            // A body that no marker holds has no diagonal at all.
            let least = if most > 0.0 { LEAST_DIAGONAL * most } else { 1.0 };
            self.matrix[i * n + i] += damping * diagonal(i).max(least);
        }
    }

    /// The steps that limits allow.
    fn measure_room(&mut self, model: &Model, posture: &Posture) {
        for (room, &rate) in self.room.iter_mut().zip(&self.objective.free) {
            let limited = model.rates()[rate].coordinate.and_then(|c| self.limits[c].map(|limits| (c, limits)));
            let longest = if model.rates()[rate].rotational { LONGEST_TURN } else { f64::INFINITY };
            *room = match limited {
                Some((c, (low, high))) => {
                    let at = posture.values()[c];
                    ((low - at).max(-longest), (high - at).min(longest))
                }
                None => (-longest, longest),
            };
        }
    }

    fn clamp(&self, posture: &mut Posture) {
        for (value, limits) in posture.values_mut().iter_mut().zip(&self.limits) {
            if let Some((low, high)) = limits {
                *value = value.max(*low).min(*high);
            }
        }
    }

    /// Rounding may have left a limit by a bit.
    fn clamp_trial(&mut self) {
        let mut trial = std::mem::replace(&mut self.trial, Posture::new(vec![]));
        self.clamp(&mut trial);
        self.trial = trial;
    }

    /// See [`Solved::optimality`], with the derivatives of the last posture.
    fn optimality(&self) -> f64 {
        let n = self.objective.free.len();
        let residual = (2.0 * self.objective.value).sqrt().max(LEAST_RESIDUAL);
        let change = |i: usize| self.objective.matrix[i * n + i].sqrt();
        let greatest = self.objective.scale.sqrt();
        let mut worst: f64 = 0.0;
        for (i, (slope, (low, high))) in self.objective.gradient.iter().zip(&self.room).enumerate() {
            let held = (*low >= 0.0 && *slope >= 0.0) || (*high <= 0.0 && *slope <= 0.0);
            if !held && change(i) > NO_CHANGE * greatest {
                worst = worst.max(slope.abs() / (change(i) * residual));
            }
        }
        worst
    }
}
