//! Progress on standard error: a bar on a terminal, a line a minute elsewhere.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines where standard error is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(60);

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

/// Something that turns on standard error.
pub(crate) fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {spinner} trying starts") {
        bar.set_style(style);
    }
    shown(bar, |_| "trying starts".to_owned())
}

/// Draws the bar on a terminal; elsewhere a thread writes a line a minute until the bar is finished or dropped.
fn shown(bar: ProgressBar, line: fn(&ProgressBar) -> String) -> ProgressBar {
    if std::io::stderr().is_terminal() {
        bar.enable_steady_tick(Duration::from_millis(200));
        return bar;
    }
    let (weak, start) = (bar.downgrade(), Instant::now());
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(BETWEEN_LINES);
            let Some(bar) = weak.upgrade().filter(|bar| !bar.is_finished()) else { return };
            // Nothing is left to try when standard error is closed.
            let _ = writeln!(std::io::stderr(), "progress: {} after {} s", line(&bar), start.elapsed().as_secs());
        }
    });
    bar
}
