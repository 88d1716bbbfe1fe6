//! Signals: Ctrl-C and SIGTERM end a run with what is done; a limit on file sizes becomes an error of the write.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use crate::output::print_note;

/// Set when a signal asks the program to end.
static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Whether someone has asked the program to end.
pub(crate) fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// From here on the first Ctrl-C or SIGTERM is a request, and the second one ends the program.
pub(crate) fn watch() {
    // A second handler is refused, which only happens if there is one already.
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
        print_note("interrupted", "the results so far are being written; Ctrl-C again leaves without them");
    });
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGTERM;
        // In this order: the first signal finds no request yet. Where a handler is refused, the signal ends the program at once.
        let _ = signal_hook::flag::register_conditional_shutdown(SIGTERM, 1, Arc::clone(&REQUESTED));
        let _ = signal_hook::flag::register(SIGTERM, Arc::clone(&REQUESTED));
    }
}

/// From here on a write beyond the limit on file sizes (`ulimit -f`) fails with an error, which is reported, instead of ending the
/// program without a word.
pub(crate) fn tell_file_size_limit() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}
