//! Progress on standard error: a bar on a terminal; elsewhere a line after ten seconds, and then one a minute.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle, WeakProgressBar};

/// Time to the first line where standard error is no terminal, and between two lines.
const WAITS: [Duration; 2] = [Duration::from_secs(10), Duration::from_secs(60)];

/// Words for trials of changes of a job.
pub(crate) const TRYING_CHANGES: &str = "trying changes of the job";

/// Simulated time on standard error.
pub(crate) fn progress_bar(duration: f64) -> ProgressBar {
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} s simulated") {
        bar.set_style(style);
    }
    shown(bar, |bar| format!("{} of {} s simulated", bar.position(), bar.length().unwrap_or_default()))
}

/// Finished runs on standard error, with the time that is left.
pub(crate) fn rows_bar(rows: u64) -> ProgressBar {
    let bar = ProgressBar::new(rows);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} runs, {eta} left") {
        bar.set_style(style);
    }
    shown(bar, |bar| {
        let (done, all, left) = (bar.position(), bar.length().unwrap_or_default(), bar.eta().as_secs());
        format!("{done} of {all} runs, about {left} s left,")
    })
}

/// Something that turns on standard error, with words for what is done.
pub(crate) fn spinner(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {spinner} {msg}") {
        bar.set_style(style);
    }
    shown(bar, ProgressBar::message)
}

/// Draws the bar on a terminal; elsewhere a thread writes lines until the bar is finished or dropped.
fn shown(bar: ProgressBar, line: fn(&ProgressBar) -> String) -> ProgressBar {
    if std::io::stderr().is_terminal() {
        bar.enable_steady_tick(Duration::from_millis(200));
        return bar;
    }
    let weak = bar.downgrade();
    // Nothing is left to try when standard error is closed.
    std::thread::spawn(move || tell(&weak, line, WAITS, |text| drop(writeln!(std::io::stderr(), "{text}"))));
    bar
}

/// Tells how far the bar is: after the first wait, and then after each second one, until the bar is finished or dropped.
fn tell(bar: &WeakProgressBar, line: fn(&ProgressBar) -> String, waits: [Duration; 2], mut write: impl FnMut(String)) {
    let start = Instant::now();
    let [mut wait, then] = waits;
    loop {
        std::thread::sleep(std::mem::replace(&mut wait, then));
        let Some(bar) = bar.upgrade().filter(|bar| !bar.is_finished()) else { return };
        write(format!("progress: {} after {} s", line(&bar), start.elapsed().as_secs()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_told_after_the_first_wait_and_then_after_each_second_one_until_it_is_finished() {
        let bar = ProgressBar::hidden();
        bar.set_length(7200);
        let mut lines = vec![];
        let words: fn(&ProgressBar) -> String = |bar| format!("{} done", bar.position());
        let (weak, start) = (bar.downgrade(), Instant::now());
        let waits = [30, 200].map(Duration::from_millis);
        tell(&weak, words, waits, |line| {
            lines.push((line, start.elapsed()));
            bar.inc(5);
            if lines.len() == 3 {
                bar.finish();
            }
        });
        let told: Vec<&str> = lines.iter().map(|(line, _)| line.as_str()).collect();
        assert_eq!(told, ["progress: 0 done after 0 s", "progress: 5 done after 0 s", "progress: 10 done after 0 s"]);
        assert!(lines[0].1 < waits[1] && lines[1].1 > waits[1] && lines[2].1 > 2 * waits[1], "{lines:?}");
    }
}
