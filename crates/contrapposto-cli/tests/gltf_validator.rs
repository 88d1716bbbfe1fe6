//! Checks `motion.glb` with the glTF validator of Khronos, which npm installs (`gltf-validator`) into a temporary folder.

use crate::support;

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use support::{contrapposto, scenarios};

/// Script that prints the validator's reports, one for every file.
const ASK: &str = "
const validator = require('gltf-validator'), fs = require('fs');
Promise.all(process.argv.slice(1).map((file) => validator.validateBytes(new Uint8Array(fs.readFileSync(file)))))
  .then((reports) => console.log(JSON.stringify(reports)));";

/// Installs the validator; whether that went well.
fn install(folder: &Path) -> bool {
    let mut npm = Command::new("npm");
    npm.args([
        "install",
        "--silent",
        "--no-audit",
        "--no-fund",
        "--no-save",
        "--fetch-retries=1",
        "gltf-validator@2.0.0-dev.3.10",
    ]);
    let done = npm.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    done.is_ok_and(|status| status.success())
}

fn validate(folder: &Path, files: &[std::path::PathBuf]) -> Vec<Value> {
    let answer = Command::new("node").args(["-e", ASK]).args(files).current_dir(folder).output().unwrap();
    assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
    serde_json::from_slice(&answer.stdout).unwrap()
}

#[test]
#[ignore = "needs npm: the Khronos glTF validator from its registry"]
fn khronos_finds_nothing_wrong() {
    let folder = tempfile::tempdir().unwrap();
    assert!(install(folder.path()), "npm cannot install the glTF validator");
    let mut files = vec![];
    for name in ["figure-08", "stand-relaxed", "stand-osim", "sit-and-type"] {
        let out = folder.path().join(name);
        let run = contrapposto(["simulate"]).arg(scenarios().join(format!("{name}.toml"))).arg("--out").arg(&out).run();
        assert_eq!(run.code, 0, "{}", run.stderr);
        files.push(out.join("motion.glb"));
    }
    // And one that is wrong, lest the validator sleep: a normal too long.
    let mut bytes = std::fs::read(&files[0]).unwrap();
    let end = bytes.windows(4).position(|four| four == b"BIN\0").unwrap();
    let triangles = 2 * 6 * 16 * 11;
    let normal = end + 4 + triangles + 12;
    bytes[normal + 4..normal + 8].copy_from_slice(&2f32.to_le_bytes());
    files.push(folder.path().join("wrong.glb"));
    std::fs::write(files.last().unwrap(), bytes).unwrap();
    let reports = validate(folder.path(), &files);
    assert_eq!(reports.len(), files.len());
    for (report, file) in reports.iter().zip(&files) {
        let issues = &report["issues"];
        println!("{}: {issues}", file.display());
        let found = ["numErrors", "numWarnings"].map(|kind| issues[kind].as_u64().unwrap());
        if file.ends_with("wrong.glb") {
            assert!(found[0] > 0, "{issues}");
        } else {
            assert_eq!(found, [0, 0], "{issues}");
            assert!(report["info"]["totalTriangleCount"].as_u64() > Some(0), "{}", report["info"]);
        }
    }
}
