//! Tells the compiler where the scenarios are that the program carries: in the crate's folder `scenarios`, a link to that of the
//! repository which is a folder in the published crate, or in the repository's own, where a clone has no links (Windows).

use std::path::Path;

fn main() {
    let own = Path::new("scenarios");
    let folder = if own.is_dir() { "scenarios" } else { "../../scenarios" };
    println!("cargo::rustc-env=CONTRAPPOSTO_SCENARIOS=/{folder}/");
    println!("cargo::rerun-if-changed=build.rs");
}
