//! Files of `../shared`: published models and numbers of other tools that are not copied into the project.

use std::path::PathBuf;

/// Path of a file or folder of `../shared`. Panics without it: tests that need it are `#[ignore = "needs ../shared: ..."]`.
pub fn shared(path: &str) -> PathBuf {
    let full = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path);
    assert!(full.exists(), "{} is missing; this test needs the folder `shared` beside the repository", full.display());
    full
}
