//! Arguments of a motion that is repeated, or that has cycles.

use contrapposto::assessment::Cycles;
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

/// The cycles of a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CyclesChoice {
    /// No curves over cycles.
    None,
    /// Those that are found; none is an error.
    Find,
    /// Length of every cycle from the start of the motion on, s; above 0.
    Length(f64),
    /// The start of every cycle, and the end of the last one, s; rising.
    Bounds(Vec<f64>),
}

/// The cycles that a text names.
pub(super) fn cycles(text: &str) -> Result<CyclesChoice, String> {
    match text {
        "none" => return Ok(CyclesChoice::None),
        "find" => return Ok(CyclesChoice::Find),
        _ => (),
    }
    let numbers: Vec<f64> = text.split(',').map(|time| time.trim().parse().unwrap_or(f64::NAN)).collect();
    let rising = numbers.windows(2).all(|pair| pair[0] < pair[1]) && numbers.iter().all(|s| s.is_finite());
    match numbers[..] {
        [length] if rising && length > 0.0 => Ok(CyclesChoice::Length(length)),
        [_, _, ..] if rising => Ok(CyclesChoice::Bounds(numbers)),
        _ => Err("`find`, `none`, the length of a cycle in s, such as 1.12, or two or more rising times in s, such as 0.62,1.74,2.85, are accepted".to_owned()),
    }
}

impl CyclesChoice {
    /// Checks that all cycles lie within a motion from `first` to `last`, s.
    ///
    /// # Errors
    /// The sentence that names the time outside of it, or the length that is longer than the motion.
    pub(crate) fn check(&self, (first, last): (f64, f64)) -> Result<(), String> {
        match self {
            Self::None | Self::Find => Ok(()),
            Self::Length(length) => Cycles::of_length(*length, (first, last)).map(|_| ()).ok_or_else(|| {
                format!("--cycles: {length} s is no length of a cycle of a motion from {first} s to {last} s; one to a million cycles are accepted")
            }),
            Self::Bounds(bounds) => {
                let outside = bounds.iter().find(|time| !(first..=last).contains(*time));
                outside.map_or(Ok(()), |time| {
                    Err(format!("--cycles: {time} s lies outside of the motion, which goes from {first} s to {last} s"))
                })
            }
        }
    }
}
