//! The snapshot that attacks on snapshots begin with (`fuzz/`) is one of today: of an old one every input is refused in its first lines.
//! `CONTRAPPOSTO_WRITE_DOCS=1 cargo test -p contrapposto-formats fuzz_seeds` writes it anew.

use crate::common::here;
use contrapposto::simulation::{Run, Snapshot};
use contrapposto_formats::read_scenario;

#[test]
fn the_snapshot_that_attacks_begin_with_is_that_of_today() {
    let fuzz = here().join("../../fuzz");
    let text = std::fs::read(fuzz.join("one-joint.toml")).unwrap();
    let scenario = read_scenario("scenario.toml", &text, None).unwrap();
    let run = Run::new(&scenario).unwrap();
    let today = serde_json::to_string(run.snapshot()).unwrap();
    let file = fuzz.join("corpus/snapshot/start.json");
    if std::env::var_os("CONTRAPPOSTO_WRITE_DOCS").is_some() {
        std::fs::write(&file, format!("{today}\n")).unwrap();
    }
    let kept = std::fs::read_to_string(&file).unwrap();
    assert_eq!(kept.trim_end(), today, "CONTRAPPOSTO_WRITE_DOCS=1 writes it anew");
    let kept: Snapshot = serde_json::from_str(&kept).unwrap();
    assert!(Run::resume(&scenario, kept).is_ok());
}
