//! The part of a sweep that attacks on parts begin with (`fuzz/`) is one of today: of an old one every input is refused in its first lines.
//! `CONTRAPPOSTO_WRITE_DOCS=1 cargo test -p contrapposto-sweep --test seeds` writes it anew.

use std::path::Path;

use contrapposto_formats::read_plan;
use contrapposto_sweep::Study;

#[test]
fn the_part_that_attacks_begin_with_is_that_of_today() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let [text, plan] = ["one-joint.toml", "corpus/plan/lists.toml"].map(|name| std::fs::read(fuzz.join(name)).unwrap());
    let plan = read_plan("lists.toml", &plan).unwrap();
    let study = Study::new("scenario.toml", &text, &plan).unwrap();
    let today = study.part(0, || true, || ()).unwrap();
    let file = fuzz.join("corpus/part/lists.parquet");
    if std::env::var_os("CONTRAPPOSTO_WRITE_DOCS").is_some() {
        std::fs::write(&file, &today).unwrap();
    }
    let kept = std::fs::read(&file).unwrap();
    assert!(kept == today, "CONTRAPPOSTO_WRITE_DOCS=1 writes it anew");
    assert_eq!(study.read(0, &kept).unwrap().len(), study.rows_of(0).len());
}
