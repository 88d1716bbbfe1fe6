//! Solves for a posture, and on supports for the contact forces, by steps of prioritised least squares.
//!
//! ```text
//! repeat
//!   evaluate the posture                      iterate.rs
//!   write the rows of all levels              linearisation.rs
//!   reject the last step if it raised the merit, and go back
//!   complete the problem: bounds, damping, Newton level       step_rule.rs
//!   solve it, and move the posture            hierarchical_least_squares
//!   in a run: halve a step that leaves much of second order           halved_step.rs
//! until steps are short or idle
//! ```

use super::error::EngineError;
use super::iterate::Iterate;
use super::linearisation::Linearisation;
use super::merit_rule::MeritRule;
use super::options::{Options, Reason, Step};
use super::priority_rule::PriorityRule;
use super::report::{LevelError, SolvedPosture};
use super::settings::Settings;
use super::slope::SlopeAlongMotion;
use super::step_rule::StepRule;
use super::tolerances::{OTHER_STARTS, STEPS_BEFORE_DESCENT};
use crate::contact::{ContactForces, Slip, Support};
use crate::effort::basin_hopping::BasinHopping;
use crate::effort::hessian::HessianModel;
use crate::joint_torques::JointTorques;
use crate::model::SharedModel;
use crate::posture::Posture;
use crate::statics::Load;
use crate::tasks::{PriorityLevel, Task};
use hierarchical_least_squares::Solver;

/// Brings a body toward priority levels. Nothing is allocated after the first step.
#[derive(Clone, Debug)]
pub struct Engine<'a> {
    pub(super) settings: Settings<'a>,
    pub(super) iterate: Iterate,
    pub(super) linearisation: Linearisation,
    pub(super) solver: Solver,
    rule: StepRule,
    /// The posture in which the last step began.
    pub(super) last: Posture,
    /// The change of that step, by rate, or the part of it that was taken.
    pub(super) part: Vec<f64>,
    slope: SlopeAlongMotion,
    pub(super) basin_hopping: BasinHopping,
    /// Work of the steps so far, without descents.
    work: usize,
}

impl<'a> Engine<'a> {
    /// For a body without supports (inverse kinematics): checks the levels, the most important first. Locked and
    /// dependent coordinates do not change on their own.
    ///
    /// # Errors
    /// [`EngineError`] names the first thing that does not fit the model.
    pub fn new(
        model: impl Into<SharedModel<'a>>,
        levels: Vec<PriorityLevel>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, EngineError> {
        let settings = Settings::new(model.into(), levels, loads, options)?;
        let rule = StepRule::Priorities(Box::new(PriorityRule::new(&settings)));
        let contact = ContactForces::without_supports(&settings.model);
        Ok(Self::with_rule(settings, contact, rule))
    }

    /// For a body on supports, in equilibrium, or with a fixed root: supports keep the placements that they have in
    /// `start`; contact forces are found with the posture. One level may be effort.
    ///
    /// # Errors
    /// As [`Engine::new`].
    pub fn with_supports(
        model: impl Into<SharedModel<'a>>,
        start: &Posture,
        supports: Vec<Support>,
        levels: Vec<PriorityLevel>,
        loads: &[Load],
        options: Options,
    ) -> Result<Self, EngineError> {
        let mut settings = Settings::new(model.into(), levels, loads, options)?;
        supports.iter().try_for_each(|support| support.check(&settings.model))?;
        settings.place_supports(start, &supports)?;
        let contact = ContactForces::new(&settings.model, supports)?;
        let rule = StepRule::Merit(Box::new(MeritRule::new(&settings, contact.forces().len())));
        Ok(Self::with_rule(settings, contact, rule))
    }

    fn with_rule(settings: Settings<'a>, contact: ContactForces, rule: StepRule) -> Self {
        let linearisation = Linearisation::new(&settings, contact.forces().len());
        Self {
            solver: linearisation.new_solver(),
            linearisation,
            rule,
            last: settings.model.default_posture(),
            part: vec![0.0; settings.model.rates().len()],
            slope: SlopeAlongMotion::new(&settings, &contact),
            basin_hopping: BasinHopping::new(&settings.model),
            work: 0,
            iterate: Iterate::new(&settings.model, contact),
            settings,
        }
    }

    /// Locks a rate, besides those of locked coordinates. On supports a body stays in equilibrium with a locked root; without
    /// supports the lock holds it.
    pub fn lock(&mut self, rate: usize) {
        self.settings.lock(rate);
        if self.iterate.contact.supports().is_empty() {
            self.iterate.hold_root(rate);
            self.slope.hold_root(rate);
        }
    }

    /// Adds an inequality, of a body on supports: below the places of the supports, above all levels.
    ///
    /// # Errors
    /// [`EngineError::Limit`] for a task that does not fit the model.
    pub fn limit(&mut self, task: Task) -> Result<(), EngineError> {
        self.settings.limit(task)?;
        self.linearisation = Linearisation::new(&self.settings, self.iterate.contact.forces().len());
        self.solver = self.linearisation.new_solver();
        Ok(())
    }

    /// The levels.
    pub fn levels(&self) -> &[PriorityLevel] {
        &self.settings.levels
    }

    /// The loads besides weight and contact forces.
    pub fn loads(&self) -> &[Load] {
        &self.settings.loads
    }

    /// The levels, to move targets between steps. A changed level must still fit the model; effort must stay where it
    /// is.
    pub fn levels_mut(&mut self) -> &mut [PriorityLevel] {
        &mut self.settings.levels
    }

    /// Replaces the model by the same body with other strength and passive torque.
    pub(crate) fn set_model(&mut self, model: impl Into<SharedModel<'a>>) {
        self.iterate.invalidate();
        self.settings.model = model.into();
    }

    /// Replaces the loads.
    ///
    /// # Errors
    /// [`EngineError::Body`] for a load that does not fit the model; nothing is changed then.
    pub fn set_loads(&mut self, loads: &[Load]) -> Result<(), EngineError> {
        self.iterate.invalidate();
        self.settings.set_loads(loads)
    }

    /// Leaves terms out of the second derivative of effort, to pass over shallow minima.
    pub(crate) fn set_hessian_model(&mut self, hessian_model: HessianModel) {
        if let StepRule::Merit(rule) = &mut self.rule {
            rule.hessian_model = hessian_model;
        }
    }

    /// Contact forces need no longer be those of least effort, only keep the body in equilibrium: for postures of which nobody is told the forces.
    pub(crate) fn leave_effort_of_forces_out(&mut self) {
        self.iterate.contact.leave_effort_out();
        self.iterate.invalidate();
    }

    /// Torques of the posture that was evaluated last, contact forces included.
    pub fn torques(&self) -> &JointTorques {
        &self.iterate.torques
    }

    /// Contact forces of the posture that was evaluated last.
    pub fn contact(&self) -> &ContactForces {
        &self.iterate.contact
    }

    /// Length of the error of each level in the posture where the last step began.
    pub fn errors(&self) -> &[f64] {
        &self.linearisation.lengths
    }

    /// Length of the error of a level in the posture that was evaluated last.
    pub(crate) fn error(&self, level: usize) -> f64 {
        self.error_of(&self.settings.levels[level]).length
    }

    /// Distance of the supports from their places.
    pub(crate) fn slip(&self) -> Slip {
        self.settings.placements.as_ref().map_or_else(Slip::default, |placements| self.error_of(placements).slip())
    }

    fn error_of(&self, level: &PriorityLevel) -> LevelError {
        LevelError::of(level, &self.settings.model, &self.iterate.torques)
    }

    /// The error of each level at a posture.
    ///
    /// # Errors
    /// As [`Engine::evaluate`].
    pub fn report(&mut self, posture: &Posture) -> Result<Vec<LevelError>, EngineError> {
        self.evaluate(posture)?;
        Ok(self.settings.levels.iter().map(|level| self.error_of(level)).collect())
    }

    /// Computes everything that depends on the posture; on supports contact forces, too.
    ///
    /// # Errors
    /// [`EngineError::Body`] when the posture does not fit the model, or a passive law gives no torque in it.
    pub fn evaluate(&mut self, posture: &Posture) -> Result<(), EngineError> {
        Ok(self.iterate.evaluate(&self.settings, posture)?)
    }

    /// One step: moves `posture` toward the levels, within ranges and [`Options::max_step`]. Where the last step is
    /// rejected, this one begins where that one had begun.
    ///
    /// # Errors
    /// [`EngineError`] when the posture does not fit the model; it is not moved then.
    pub fn step(&mut self, posture: &mut Posture) -> Result<Step, EngineError> {
        let rejected_previous = self.linearise_or_go_back(posture)?;
        self.rule.prepare(&self.settings, &self.iterate, &mut self.linearisation, &self.solver);
        self.last.values_mut().copy_from_slice(posture.values());
        let status = self.solver.solve_next(&self.linearisation.problem)?;
        let change = &self.solver.solution()[..self.settings.model.rates().len()];
        let largest = change.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        posture.displace(&self.settings.model, change);
        self.settings.keep_ranges(posture);
        let step = Step { largest, rejected_previous, status, changes: self.solver.changes() };
        self.work += step.work();
        self.rule.finish(&self.settings, &mut self.iterate, &self.solver, posture, &step)?;
        Ok(step)
    }

    /// Linearises at `posture`, or, if the step that led there is rejected, at the posture before; returns whether it
    /// was rejected.
    fn linearise_or_go_back(&mut self, posture: &mut Posture) -> Result<bool, EngineError> {
        self.linearise(posture)?;
        let merit_rose = self.rule.merit_rose(&self.settings, &self.solver);
        self.rule.adapt(&self.settings, merit_rose);
        let rejected = merit_rose && self.settings.options.reject_steps;
        if rejected {
            self.rule.take_back();
            posture.values_mut().copy_from_slice(self.last.values());
            self.linearise(posture)?;
        }
        Ok(rejected)
    }

    fn linearise(&mut self, posture: &Posture) -> Result<(), EngineError> {
        self.iterate.evaluate(&self.settings, posture)?;
        self.linearisation.write(&self.settings, &self.iterate);
        self.rule.record(&self.settings, &self.linearisation);
        Ok(())
    }

    /// Work of all steps so far, [`Step::work`], and of descents to local minima of effort: a measure of the time that they took, which is the same
    /// on every machine.
    pub fn work(&self) -> usize {
        self.work + self.basin_hopping.work()
    }

    /// Replaces [`Options::max_step`], rad or m.
    pub(crate) fn set_max_step(&mut self, max_step: f64) {
        self.settings.options.max_step = max_step;
    }

    /// Lets the next step be as long as the first one: for new targets.
    pub fn widen_trust_region(&mut self) {
        self.rule.widen_trust_region(&self.settings.options);
    }

    /// Forgets the steps so far: the next one is that of a new engine, to the bit.
    pub fn restart(&mut self) {
        self.iterate.forget();
        self.rule.restart(&self.settings.options);
        self.solver.forget();
        self.slope.forget();
    }

    /// Steps until they are short or change the merit little. With effort, [`Options::local_minima`] are compared
    /// first; where that leaves steps to be made, a descent to the nearest one is tried again and again between them, and a last one where they have
    /// ended without reaching all levels above effort. Without supports the largest step shrinks after a fifth of the largest number of steps, so that the body
    /// comes to rest whatever it is asked; and where a level other than a rest posture is not reached, two other starts
    /// are tried, and the posture whose first differing level is nearer is kept.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn solve(&mut self, start: &Posture) -> Result<SolvedPosture, EngineError> {
        self.solve_watched(start, |_, _| {})
    }

    /// As [`Engine::solve`]; `watch` is given every step of every start and the posture after it.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub fn solve_watched(
        &mut self,
        start: &Posture,
        mut watch: impl FnMut(&Step, &Posture),
    ) -> Result<SolvedPosture, EngineError> {
        let mut best = self.solve_from(start, &mut watch)?;
        if self.settings.on_supports() || !self.settings.is_out_of_reach(&best.levels) {
            return Ok(best);
        }
        let first = best.posture.clone();
        let mut steps = best.steps;
        for share in OTHER_STARTS {
            let other = self.solve_from(&self.settings.other_start(&first, share), &mut watch)?;
            steps += other.steps;
            if other.is_nearer_than(&best) {
                best = other;
            }
        }
        self.evaluate(&best.posture)?;
        Ok(SolvedPosture { steps, ..best })
    }

    fn solve_from(
        &mut self,
        start: &Posture,
        watch: &mut impl FnMut(&Step, &Posture),
    ) -> Result<SolvedPosture, EngineError> {
        self.restart();
        self.rule.begin_solve(&self.settings.options);
        let mut posture = start.clone();
        let minima = self.settings.options.local_minima;
        let (mut converged, mut steps) = self.compare_local_minima(&mut posture, minima)?;
        let mut descended = converged;
        let most = steps + self.settings.options.max_steps;
        let mut descent_at = steps + STEPS_BEFORE_DESCENT;
        while steps < most && !converged {
            let step = self.step(&mut posture)?;
            watch(&step, &posture);
            steps += 1;
            converged = step.largest <= self.settings.options.step_tolerance || self.rule.is_idle();
            if steps >= descent_at && !converged {
                let (at_rest, made) = self.compare_local_minima(&mut posture, minima.min(1))?;
                (converged, steps) = (at_rest, steps + made);
                descended = at_rest;
                descent_at = steps + STEPS_BEFORE_DESCENT;
            }
        }
        self.linearise_or_go_back(&mut posture)?;
        if !descended {
            steps += self.descend_as_near(&mut posture)?;
        }
        self.describe(posture, converged, steps)
    }

    /// Describes a posture in which solving has ended after so many steps.
    ///
    /// # Errors
    /// As [`Engine::evaluate`].
    pub(crate) fn describe(
        &mut self,
        posture: Posture,
        converged: bool,
        steps: usize,
    ) -> Result<SolvedPosture, EngineError> {
        let levels = self.report(&posture)?;
        let reached = levels.iter().all(|level| level.length <= self.settings.options.level_tolerance);
        let reason = match (reached, converged) {
            (true, _) => Reason::Reached,
            (false, true) => Reason::Converged,
            (false, false) => Reason::StepLimit,
        };
        let effort = self.settings.effort_level.map_or(0.0, |level| levels[level].effort());
        let (slip, balance) = (self.slip(), self.iterate.contact.balance());
        Ok(SolvedPosture { posture, levels, effort, slip, balance, reason, steps })
    }

    /// Slope of the external torque of `rate`, N m/rad, along the least motion that moves it while supports stay where
    /// they are and the first `above` levels keep their values; contact forces are solved anew along it. `None` where
    /// the rate cannot move so.
    ///
    /// # Errors
    /// [`EngineError`] when the posture does not fit the model.
    pub fn slope_along(&mut self, posture: &Posture, rate: usize, above: usize) -> Result<Option<f64>, EngineError> {
        self.evaluate(posture)?;
        self.slope.slope(&self.settings, &self.iterate, rate, above)
    }
}
