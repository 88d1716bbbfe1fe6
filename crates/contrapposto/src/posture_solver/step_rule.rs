//! The two rules by which steps are completed, judged and ended.
//!
//! | Rule | For | A step is rejected where it raises | Levels out of reach |
//! |---|---|---|---|
//! | [`PriorityRule`] | tasks without supports | the error of the Newton level and of the levels above | become a Newton level |
//! | [`MeritRule`] | supports and effort | effort and the errors of the levels above | are damped |
//!
//! All else (settings, iterate, linearisation, solver, Newton level, multipliers) is common to both.

use super::error::EngineError;
use super::iterate::Iterate;
use super::linearisation::Linearisation;
use super::merit_rule::MeritRule;
use super::options::{Options, Step};
use super::priority_rule::PriorityRule;
use super::settings::Settings;
use crate::posture::Posture;
use hierarchical_least_squares::Solver;

/// See the module's text.
#[derive(Clone, Debug)]
pub(super) enum StepRule {
    Priorities(Box<PriorityRule>),
    Merit(Box<MeritRule>),
}

impl StepRule {
    /// Forgets the steps so far.
    pub(super) fn restart(&mut self, options: &Options) {
        match self {
            Self::Priorities(rule) => rule.restart(options),
            Self::Merit(rule) => rule.restart(options),
        }
    }

    /// A solve begins, which ends after the largest number of steps.
    pub(super) fn begin_solve(&mut self, options: &Options) {
        match self {
            Self::Priorities(rule) => rule.cool_toward_rest(options),
            Self::Merit(_) => {}
        }
    }

    /// The next step may be as long as the first one.
    pub(super) fn widen_trust_region(&mut self, options: &Options) {
        match self {
            Self::Priorities(rule) => rule.widen_trust_region(options),
            Self::Merit(rule) => rule.widen_trust_region(options),
        }
    }

    /// Records the errors of a posture that has just been linearised.
    pub(super) fn record(&mut self, settings: &Settings<'_>, linearisation: &Linearisation) {
        match self {
            Self::Priorities(rule) => rule.record(linearisation),
            Self::Merit(rule) => rule.record(settings, linearisation),
        }
    }

    /// Whether the step that led to the recorded posture raised the merit.
    pub(super) fn merit_rose(&self, settings: &Settings<'_>, solver: &Solver) -> bool {
        match self {
            Self::Priorities(rule) => rule.merit_rose(solver),
            Self::Merit(rule) => rule.merit_rose(settings),
        }
    }

    /// Adapts the trust region to the last step.
    pub(super) fn adapt(&mut self, settings: &Settings<'_>, merit_rose: bool) {
        match self {
            Self::Priorities(rule) => rule.adapt(&settings.options, merit_rose),
            Self::Merit(rule) => rule.adapt(settings, merit_rose),
        }
    }

    /// The posture before is the present one again, and is linearised next.
    pub(super) fn take_back(&mut self) {
        match self {
            Self::Priorities(rule) => rule.take_back(),
            Self::Merit(rule) => rule.take_back(),
        }
    }

    /// Completes the problem of a step.
    pub(super) fn prepare(
        &mut self,
        settings: &Settings<'_>,
        iterate: &Iterate,
        linearisation: &mut Linearisation,
        solver: &Solver,
    ) {
        match self {
            Self::Priorities(rule) => rule.prepare(settings, iterate, linearisation, solver),
            Self::Merit(rule) => rule.prepare(settings, iterate, linearisation, solver),
        }
    }

    /// Completes a `step` that led to `posture`.
    pub(super) fn finish(
        &mut self,
        settings: &Settings<'_>,
        iterate: &mut Iterate,
        solver: &Solver,
        posture: &mut Posture,
        step: &Step,
    ) -> Result<(), EngineError> {
        match self {
            Self::Priorities(rule) => rule.finish(settings, iterate, posture, step.largest)?,
            Self::Merit(rule) => rule.finish(settings, solver, step),
        }
        Ok(())
    }

    /// Whether further steps are not worth while, long as they may be.
    pub(super) fn is_idle(&self) -> bool {
        match self {
            Self::Priorities(_) => false,
            Self::Merit(rule) => rule.is_idle(),
        }
    }
}
