//! Progress on standard error; invisible when that is no terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Simulated time on standard error; invisible when that is no terminal.
pub(crate) fn progress_bar(duration: f64) -> ProgressBar {
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} s simulated") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Something that turns on standard error; invisible when that is no terminal.
pub(crate) fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {spinner} trying starts") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
