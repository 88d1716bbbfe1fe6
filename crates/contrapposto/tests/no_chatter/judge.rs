//! Finds goals that are taken up again, from the samples of a run and the thresholds of its scenario alone.

use contrapposto::hybrid::{Outcome, Strategy};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::Side;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Attempt, Relief, Sample, Scenario};

/// A turn of a joint below this angle is not counted, rad.
const LEAST_TURN: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Sums over all coordinates of one or more runs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// Runs.
    pub(crate) runs: u64,
    /// Goals that were taken up, the first of each recovery included.
    pub(crate) goals: u64,
    /// Goals that were left for another one.
    pub(crate) changes: u64,
    /// Goals that were taken up again although the group that had left them had not rested, and nothing had changed.
    pub(crate) violations: u64,
    /// Runs with a violation.
    pub(crate) runs_with_violations: u64,
    /// Most changes of goal in one recovery of one coordinate.
    pub(crate) most_changes: u64,
    /// Attempts at relief: by the strategy, by the other strategy, by another joint, given up.
    pub(crate) attempts: [u64; 4],
    /// Samples in which an attempt went back to one before it, or another joint was tired or turned round.
    pub(crate) wrong_attempts: u64,
    /// Samples in which a step of relief had raised effort above the stated factor.
    pub(crate) efforts_above: u64,
    /// Turns of more than two degrees that joints make while their groups request relief.
    pub(crate) turns: u64,
}

impl Findings {
    pub(crate) fn add(&mut self, other: &Self) {
        self.runs += other.runs;
        self.goals += other.goals;
        self.changes += other.changes;
        self.violations += other.violations;
        self.runs_with_violations += other.runs_with_violations;
        self.most_changes = self.most_changes.max(other.most_changes);
        self.attempts.iter_mut().zip(other.attempts).for_each(|(sum, count)| *sum += count);
        self.wrong_attempts += other.wrong_attempts;
        self.efforts_above += other.efforts_above;
        self.turns += other.turns;
    }
}

/// A goal as a viewer sees it: whether it is an active one, and whether it lies above the present angle.
type Goal = (bool, bool);

/// One coordinate in its present recovery.
#[derive(Clone, Default)]
struct Course {
    /// By group: the group recovers.
    recovering: [bool; 2],
    /// The last goal, and the group that followed it last.
    last: Option<(Goal, Side)>,
    /// Goals that were left, and the groups that had followed them.
    left: Vec<(Goal, Side)>,
    changes: u64,
    /// The last attempt of each group.
    attempts: [Option<Attempt>; 2],
    /// One of its groups has requested relief.
    asked: bool,
    /// While it requests relief: the last extreme of its angle, rad, and the sign of the motion that led there.
    way: Option<(f64, f64)>,
}

/// Reads one run.
pub(crate) struct Judge<'a> {
    scenario: &'a Scenario,
    torques: JointTorques,
    courses: Vec<Course>,
    next_event: usize,
    strategies: Vec<Strategy>,
    /// Effort before all present reliefs, and in the last sample.
    efforts: (f64, f64),
    findings: Findings,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(scenario: &'a Scenario) -> Self {
        let n = scenario.model.coordinates().len();
        Self {
            scenario,
            torques: JointTorques::new(&scenario.model),
            courses: vec![Course::default(); n],
            next_event: 0,
            strategies: vec![],
            efforts: (f64::INFINITY, f64::INFINITY),
            findings: Findings { runs: 1, ..Findings::default() },
        }
    }

    pub(crate) fn findings(mut self) -> Findings {
        self.findings.runs_with_violations = u64::from(self.findings.violations > 0);
        self.findings
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        self.note_events(sample);
        let posture = Posture::new(sample.posture.to_vec());
        self.torques.update(&self.scenario.model, &posture, &[], Quantities::TORQUES).unwrap();
        (0..self.courses.len()).for_each(|i| self.note_rest(i, sample.fatigue[i]));
        self.note_effort(sample);
        for i in 0..self.courses.len() {
            self.note_attempt(i, sample);
            let angle = self.torques.angles()[i];
            self.note_turn(i, angle, sample.asking[i].is_some());
            let (Some(decision), Some(side)) = (sample.decisions[i], sample.asking[i]) else { continue };
            let active = match decision.outcome {
                Outcome::Active | Outcome::LeastTorque => true,
                Outcome::Passive | Outcome::AtLimit => false,
                Outcome::Stay | Outcome::None => continue,
            };
            let way = decision.goal.unwrap() - angle;
            if way.abs() > self.scenario.relief.max_step {
                self.note_goal(i, (active, way > 0.0), side);
            }
        }
    }

    /// Another load or task frees every coordinate, another strategy those that it concerns.
    fn note_events(&mut self, sample: &Sample) {
        while self.scenario.events.get(self.next_event).is_some_and(|event| event.time <= sample.time + 1e-9) {
            let event = &self.scenario.events[self.next_event];
            if event.loads.is_some() || !event.tasks.is_empty() {
                self.courses.iter_mut().for_each(Course::free);
                self.efforts.1 = f64::INFINITY;
            }
            self.next_event += 1;
        }
        for (i, course) in self.courses.iter_mut().enumerate() {
            if self.strategies.get(i).is_some_and(|before| *before != sample.strategies[i]) {
                course.free();
            }
        }
        self.strategies = sample.strategies.to_vec();
        // So does a support that is put elsewhere.
        if sample.stepping {
            self.courses.iter_mut().for_each(Course::free);
            self.efforts.1 = f64::INFINITY;
        }
    }

    /// Follows the thresholds of fatigue; a group that has rested may take up again what it had left.
    fn note_rest(&mut self, i: usize, fatigue: [f64; 2]) {
        let course = &mut self.courses[i];
        for side in Side::BOTH {
            let recovering = &mut course.recovering[side.index()];
            *recovering = self.scenario.hysteresis.recovering(*recovering, fatigue[side.index()]);
            if !*recovering {
                course.attempts[side.index()] = None;
                course.left.retain(|(_, owner)| *owner != side);
            }
        }
        if course.recovering == [false; 2] {
            course.free();
        }
    }

    /// A step of relief may raise effort to a factor of the effort before all present reliefs. Tasks that a relief has let go may raise it
    /// farther.
    fn note_effort(&mut self, sample: &Sample) {
        let effort = sample.standing.unwrap().effort;
        let (before, last) = self.efforts;
        let limit = (self.scenario.relief.effort_factor * before).max(last);
        let steps =
            |relief: &Option<Relief>| matches!(relief, Some(Relief::Done { predicted, .. }) if *predicted != 0.0);
        let rises = effort > limit * (1.0 + 1e-9) && sample.reliefs.iter().any(steps);
        self.findings.efforts_above += u64::from(rises);
        let relieved = self.courses.iter().any(|course| course.asked);
        self.efforts = (if relieved { before } else { effort }, effort);
        for (course, asking) in self.courses.iter_mut().zip(sample.asking) {
            course.asked |= asking.is_some();
        }
    }

    fn note_attempt(&mut self, i: usize, sample: &Sample) {
        let (Some(attempt), Some(side)) = (sample.attempts[i], sample.asking[i]) else { return };
        let last = self.courses[i].attempts[side.index()].replace(attempt);
        if last != Some(attempt) {
            self.findings.attempts[rank(attempt)] += 1;
        }
        let other_is_tired = match attempt {
            Attempt::OtherJoint { coordinate, .. } => self.courses[coordinate].recovering != [false; 2],
            _ => false,
        };
        // Another rank, or another joint or direction in the same rank.
        let goes_back = last.is_some_and(|last| last != attempt && rank(attempt) <= rank(last));
        self.findings.wrong_attempts += u64::from(other_is_tired || goes_back);
    }

    fn note_goal(&mut self, i: usize, goal: Goal, side: Side) {
        let course = &mut self.courses[i];
        if let Some((last, owner)) = course.last.filter(|(last, _)| *last != goal) {
            course.left.push((last, owner));
            course.changes += 1;
            self.findings.changes += 1;
            self.findings.most_changes = self.findings.most_changes.max(course.changes);
        }
        if course.last.is_none_or(|(last, _)| last != goal) {
            self.findings.goals += 1;
            self.findings.violations += u64::from(course.left.iter().any(|(left, _)| *left == goal));
        }
        course.last = Some((goal, side));
    }

    fn note_turn(&mut self, i: usize, angle: f64, asks: bool) {
        let course = &mut self.courses[i];
        let Some((extreme, direction)) = course.way.filter(|_| asks) else {
            course.way = asks.then_some((angle, 0.0));
            return;
        };
        let way = angle - extreme;
        if way * direction > 0.0 {
            course.way = Some((angle, direction));
        } else if way.abs() > LEAST_TURN {
            course.way = Some((angle, way.signum()));
            self.findings.turns += u64::from(direction != 0.0);
        }
    }
}

impl Course {
    /// Goals that were left may be taken up again.
    fn free(&mut self) {
        (self.last, self.changes, self.attempts, self.asked) = (None, 0, [None; 2], false);
        self.left.clear();
    }
}

fn rank(attempt: Attempt) -> usize {
    match attempt {
        Attempt::Strategy => 0,
        Attempt::OtherStrategy => 1,
        Attempt::OtherJoint { .. } => 2,
        Attempt::GivenUp => 3,
    }
}
