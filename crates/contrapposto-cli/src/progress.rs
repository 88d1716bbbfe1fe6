//! Progress on standard error: a bar on a terminal; elsewhere a line after ten seconds, and then one a minute.

use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::ops::Deref;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// Time to the first line where standard error is no terminal, and between two lines.
const WAITS: [Duration; 2] = [Duration::from_secs(10), Duration::from_secs(60)];

/// Words for trials of changes of a job.
pub(crate) const TRYING_CHANGES: &str = "trying changes of the job";

/// A bar on standard error, until it is finished or dropped. The thread that writes its lines ends with it, so that the next one takes its memory.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// The sender whose end is the end of the thread.
    _lines: Option<Sender<()>>,
}

impl Progress {
    /// Removes the bar.
    pub(crate) fn finish(self) {
        self.bar.finish_and_clear();
    }
}

impl Deref for Progress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

/// Simulated time on standard error.
pub(crate) fn progress_bar(duration: f64) -> Progress {
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} s simulated") {
        bar.set_style(style);
    }
    shown(bar, |bar| format!("{} of {} s simulated", bar.position(), bar.length().unwrap_or_default()))
}

/// Finished runs on standard error, with the time that is left.
pub(crate) fn rows_bar(rows: u64) -> Progress {
    let bar = ProgressBar::new(rows);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} runs, {left}") {
        let left = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // A bar that cannot be drawn is no reason to end.
            let _ = out.write_str(&time_left(state.elapsed(), state.pos(), state.len().unwrap_or_default()));
        };
        bar.set_style(style.with_key("left", left));
    }
    shown(bar, |bar| {
        let (done, all) = (bar.position(), bar.length().unwrap_or_default());
        format!("{done} of {all} runs, {},", time_left(bar.elapsed(), done, all))
    })
}

/// The time that is left if all runs take the mean time of those that are done.
fn time_left(elapsed: Duration, done: u64, all: u64) -> String {
    if done == 0 {
        return "the time left is not yet known".to_owned();
    }
    let left = elapsed.as_secs_f64() / done as f64 * all.saturating_sub(done) as f64;
    format!("about {left:.0} s left")
}

/// Frames of a motion on standard error.
pub(crate) fn frames_bar(frames: usize) -> Progress {
    let bar = ProgressBar::new(frames as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} instants, {eta} left") {
        bar.set_style(style);
    }
    shown(bar, |bar| format!("{} of {} instants", bar.position(), bar.length().unwrap_or_default()))
}

/// Something that turns on standard error, with words for what is done, as far as a line holds them.
pub(crate) fn spinner(what: impl Into<Cow<'static, str>>) -> Progress {
    let bar = ProgressBar::new_spinner().with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {spinner} {wide_msg}") {
        bar.set_style(style);
    }
    shown(bar, ProgressBar::message)
}

/// Draws the bar on a terminal; elsewhere a thread writes lines until the bar is finished or dropped.
fn shown(bar: ProgressBar, line: fn(&ProgressBar) -> String) -> Progress {
    if std::io::stderr().is_terminal() {
        bar.enable_steady_tick(Duration::from_millis(200));
        return Progress { bar, _lines: None };
    }
    let (lines, end) = channel();
    let told = bar.clone();
    // Nothing is left to try when standard error is closed.
    std::thread::spawn(move || tell(&told, &end, line, WAITS, |text| drop(writeln!(std::io::stderr(), "{text}"))));
    Progress { bar, _lines: Some(lines) }
}

/// Tells how far the bar is: after the first wait, and then after each second one, until the sender of `end` is dropped.
fn tell(
    bar: &ProgressBar,
    end: &Receiver<()>,
    line: fn(&ProgressBar) -> String,
    waits: [Duration; 2],
    mut write: impl FnMut(String),
) {
    let start = Instant::now();
    let [mut wait, then] = waits;
    while end.recv_timeout(std::mem::replace(&mut wait, then)) == Err(RecvTimeoutError::Timeout) {
        write(format!("progress: {} after {} s", line(bar), start.elapsed().as_secs()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_runs_of_the_mean_time() {
        let seconds = Duration::from_secs;
        assert_eq!(time_left(seconds(730), 126, 2000), "about 10857 s left");
        assert_eq!(time_left(seconds(10), 0, 2000), "the time left is not yet known");
        assert_eq!(time_left(seconds(10), 5, 5), "about 0 s left");
    }

    #[test]
    fn a_bar_is_told_after_the_first_wait_and_then_after_each_second_one_until_it_is_dropped() {
        let bar = ProgressBar::hidden();
        bar.set_length(7200);
        let mut lines = vec![];
        let words: fn(&ProgressBar) -> String = |bar| format!("{} done", bar.position());
        let ((lines_end, end), start) = (channel(), Instant::now());
        let mut lines_end = Some(lines_end);
        let waits = [30, 200].map(Duration::from_millis);
        tell(&bar, &end, words, waits, |line| {
            lines.push((line, start.elapsed()));
            bar.inc(5);
            if lines.len() == 3 {
                lines_end.take();
            }
        });
        let told: Vec<&str> = lines.iter().map(|(line, _)| line.as_str()).collect();
        assert_eq!(told, ["progress: 0 done after 0 s", "progress: 5 done after 0 s", "progress: 10 done after 0 s"]);
        assert!(lines[0].1 < waits[1] && lines[1].1 > waits[1] && lines[2].1 > 2 * waits[1], "{lines:?}");
    }
}
