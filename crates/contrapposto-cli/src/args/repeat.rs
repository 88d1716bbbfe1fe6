//! Arguments of a motion that is repeated.

use contrapposto::fatigue::{Breaks, Repetition};

use super::time::time;

/// Time, pauses and breaks of a motion that is repeated.
#[derive(Debug, clap::Args)]
pub(crate) struct RepeatArgs {
    /// Repeat the motion for this time, breaks included: 30min, 2h, 8h. The motion is one whole cycle, such as a step or a lift, whose end meets
    /// its start.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) repeat: Option<f64>,
    /// Time from the start of a cycle to the start of the next, such as 12s; the muscles rest between them. Without it one cycle follows the other.
    #[arg(long, value_name = "TIME", value_parser = time, requires = "repeat")]
    pub(crate) every: Option<f64>,
    /// Work before each break, such as 50min: as many whole cycles as it holds.
    #[arg(long, value_name = "TIME", value_parser = time, requires_all = ["repeat", "rest"])]
    pub(crate) work: Option<f64>,
    /// Length of a break, such as 10min, in which the muscles rest.
    #[arg(long = "break", id = "rest", value_name = "TIME", value_parser = time, requires_all = ["repeat", "work"])]
    pub(crate) rest: Option<f64>,
}

impl RepeatArgs {
    /// The repetition of a motion of `cycle` seconds; `None` where it is not asked for.
    ///
    /// # Errors
    /// The sentence that names the time which the motion does not fit into.
    pub(crate) fn repetition(&self, cycle: f64) -> Result<Option<Repetition>, String> {
        let Some(seconds) = self.repeat else { return Ok(None) };
        if cycle <= 0.0 {
            return Err("--repeat: a motion of one instant has no cycle; a posture that is held needs no repeats: give its time twice, from \
                        start to end"
                .to_owned());
        }
        let every = self.every.unwrap_or(cycle);
        let longer =
            |name: &str, time: f64| format!("{name} is {time} s, less than the motion, which lasts {cycle:.6} s");
        if every < cycle {
            return Err(longer("--every", every));
        }
        let breaks = self.work.zip(self.rest).map(|(work, rest)| Breaks { work, rest });
        for (name, time) in [("--repeat", Some(seconds)), ("--work", self.work)] {
            if let Some(time) = time.filter(|time| *time < every) {
                let why = format!("{name} is {time} s, less than one cycle of {every:.6} s");
                return Err(if self.every.is_some() { why } else { longer(name, time) });
            }
        }
        Ok(Some(Repetition { seconds, every, breaks }))
    }
}
