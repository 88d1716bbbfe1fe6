//! Answers requests natively, one line each from standard input, for comparison with the module in a browser.

use std::io::{BufRead, Write};

use contrapposto_web::Studio;

fn main() -> std::io::Result<()> {
    let mut studio = Studio::new();
    let mut out = std::io::stdout().lock();
    for request in std::io::stdin().lock().lines() {
        writeln!(out, "{}", studio.call(&request?))?;
    }
    Ok(())
}
