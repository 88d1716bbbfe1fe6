//! Makes starts of a search from goal angles: those of both strategies of the tables, all together and one by one.

use super::description::work_of;
use super::finder::Finder;
use super::search::SearchError;
use super::search::Stage;
use super::solvers::{Start, Way};
use crate::constraint::HalfSpace;
use crate::hybrid::{Problem, Strategy, minimise};
use crate::model::CoordinateKind;
use crate::posture::Posture;
use crate::tasks::PriorityLevel;

/// Coordinates whose goal angles are starts of their own.
const SINGLE_GOALS: usize = 6;
/// Distance of a goal angle below which it is no start, rad or m.
const LEAST_GOAL_DISTANCE: f64 = 0.01;
/// `R_min` of the tables: every active goal that lessens torque is a start.
const MINIMUM_DECREASE_RATIO: f64 = 0.0;
/// `eps` of the tables, N m.
const TORQUE_TOLERANCE: f64 = 0.05;

/// A goal angle of a coordinate.
#[derive(Clone, Debug)]
struct Goal {
    /// About the axis of the coordinate, rad.
    angle: f64,
    /// The least step of all coordinates that turns the joint so far.
    step: Vec<f64>,
}

impl Finder<'_> {
    /// The start that turns joints to goal angles first.
    fn at_goals(&self, from: &Posture, goals: &[&Goal], label: String) -> Start {
        let n = self.search.model.coordinates().len();
        let spaces = goals.iter().filter_map(|goal| {
            let mut space = HalfSpace::new(n);
            space.ask_for(from.values(), &goal.step).then_some(space)
        });
        let level = PriorityLevel { half_spaces: spaces.collect(), ..PriorityLevel::default() };
        self.exploratory(from, Way::To(level), label)
    }

    /// Searches from goal angles of both strategies in a posture: from all goals of a strategy together, then from each goal of the
    /// coordinates with the greatest relative loads alone.
    pub(super) fn explore_goals(&mut self, posture: &Posture) -> Result<(), SearchError> {
        let model = self.search.model;
        self.solvers.engine(Stage::Exploratory).restart();
        let mut asked: Vec<(f64, usize, [Option<Goal>; 2])> = vec![];
        for i in 0..model.coordinates().len() {
            let goals = self.goals_of(posture, i)?;
            if goals.iter().any(Option::is_some) {
                let load =
                    work_of(model, self.solvers.engine(Stage::Exploratory), i).map_or(0.0, |work| work.relative_load());
                asked.push((load, i, goals));
            }
        }
        let mut starts = vec![];
        for (k, word) in ["active", "passive"].into_iter().enumerate() {
            let all: Vec<&Goal> = asked.iter().filter_map(|(_, _, goals)| goals[k].as_ref()).collect();
            if !all.is_empty() {
                starts.push(self.at_goals(posture, &all, format!("all {word} goals")));
            }
        }
        if self.is_told() {
            asked.clear();
        }
        // A stable sort: of equals the first of the model.
        asked.sort_by(|a, b| b.0.total_cmp(&a.0));
        asked.truncate(SINGLE_GOALS);
        for (_, i, goals) in asked {
            for (goal, word) in goals.into_iter().zip(["active", "passive"]) {
                let Some(goal) = goal else { continue };
                let coordinate = &model.coordinates()[i];
                let value = match coordinate.kind {
                    CoordinateKind::Rotation => format!("{:.1} deg", goal.angle.to_degrees()),
                    _ => format!("{:.3} m", goal.angle),
                };
                let label = format!("{word} goal of {}, {value}", coordinate.name);
                starts.push(self.at_goals(posture, &[&goal], label));
            }
        }
        self.solve_all(starts);
        Ok(())
    }

    /// Active and passive goal of a coordinate that are not reached yet.
    fn goals_of(&mut self, posture: &Posture, i: usize) -> Result<[Option<Goal>; 2], SearchError> {
        const NONE: [Option<Goal>; 2] = [None, None];
        let coordinate = &self.search.model.coordinates()[i];
        let (Some(rate), true) = (coordinate.rate, coordinate.groups.is_some()) else { return Ok(NONE) };
        if self.search.locked.contains(&rate) || coordinate.locked || self.search.model.is_dependent(i) {
            return Ok(NONE);
        }
        let slot = self.solvers.slot;
        let engine = self.solvers.engine(Stage::Exploratory);
        let Some(external_slope) = engine.slope_along(posture, rate, slot)? else { return Ok(NONE) };
        let (model, body) = (self.search.model, engine.torques());
        let passive_torque = body.passive_torque();
        let Some(curve) = passive_torque.curve_about_axis(model, body.kinematics(), i, coordinate.range) else {
            return Ok(NONE);
        };
        let goal = |strategy: Strategy| {
            let problem = Problem {
                curve: &curve,
                angle: passive_torque.angles()[i],
                external_torque: body.external_about_axes()[rate],
                external_slope,
                strategy,
                minimum_decrease_ratio: MINIMUM_DECREASE_RATIO,
                torque_tolerance: TORQUE_TOLERANCE,
                accepted: None,
            };
            let angle = minimise(&problem).ok()?.goal?;
            let turn = angle - problem.angle;
            let mut step = vec![0.0; model.coordinates().len()];
            body.write_turn(model, i, turn, &mut step);
            (turn.abs() > LEAST_GOAL_DISTANCE).then_some(Goal { angle, step })
        };
        let (active, passive) = (goal(Strategy::Active), goal(Strategy::Passive));
        // The tables give both strategies the same answer where there is only one.
        let same = active.as_ref().map(|goal| goal.angle) == passive.as_ref().map(|goal| goal.angle);
        Ok([active.filter(|_| !same), passive])
    }
}
