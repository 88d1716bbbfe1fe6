//! When does the engine go down into valleys of effort, and what are they asked?

use super::super::EngineError;
use super::Engine;
use crate::contact::Balance;
use crate::effort::basin_hopping::BasinHopping;
use crate::effort::problem::EffortProblem;
use crate::posture::Posture;
use crate::tasks::PriorityLevel;
use crate::tasks::Task;

impl Engine<'_> {
    /// Moves to the lowest bottom of the valleys; is that the answer, and after how many steps?
    pub(super) fn look_into_valleys(&mut self, posture: &mut Posture) -> Result<(bool, usize), EngineError> {
        if self.options.local_minima == 0 || !self.can_descend() {
            return Ok((false, 0));
        }
        self.evaluate(posture)?;
        let count = self.options.local_minima;
        let (ask, valleys) = self.ask();
        let Some(bottom) = valleys.minimise(&ask, posture, count)? else { return Ok((false, 0)) };
        self.evaluate(posture)?;
        let held = self.contact.balance() == Balance::Held;
        Ok((bottom.converged && held && self.effort_goal == Some(self.goals.len() - 1), bottom.steps))
    }

    /// Moves `posture` to the bottom of the valley of effort in which it lies, while supports and the goals above effort hold, and
    /// says whether it did: not if that lies farther away than the largest step, or goals below effort would be passed over.
    ///
    /// # Errors
    /// [`EngineError::Body`] when the posture does not fit the model.
    pub fn descend(&mut self, posture: &mut Posture) -> Result<bool, EngineError> {
        if self.effort_goal != Some(self.goals.len().wrapping_sub(1)) || !self.can_descend() {
            return Ok(false);
        }
        self.evaluate(posture)?;
        let most = self.options.max_step;
        let (ask, valleys) = self.ask();
        let there = valleys.descend(&ask, posture, most)?;
        self.keep_ranges(posture);
        Ok(there)
    }

    /// Is there an effort level that a descent can lower?
    fn can_descend(&mut self) -> bool {
        self.free.clear();
        self.free.extend((0..self.locked.len()).filter(|rate| !self.locked[*rate]));
        let alone = |goal: &PriorityLevel| {
            goal.half_spaces.is_empty() && goal.tasks.iter().all(|task| matches!(task, Task::Effort(_)))
        };
        !self.free.is_empty() && self.effort_goal.is_some_and(|goal| alone(&self.goals[goal]))
    }

    /// What a descent is to do.
    fn ask(&mut self) -> (EffortProblem<'_>, &mut BasinHopping) {
        let goal = self.effort_goal.unwrap_or_default();
        let ask = EffortProblem {
            model: self.model,
            places: &self.places,
            above: &self.goals[..goal],
            effort: &self.goals[goal],
            loads: &self.loads,
            free: &self.free,
            contact: &self.contact,
        };
        (ask, &mut self.valleys)
    }
}
