//! Hostile and broken model files: each is refused with the message that `attacks/expected.txt` has for it.

use crate::common;

use common::here;
use contrapposto_formats::{mjcf, urdf};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

fn message(name: &str, bytes: &[u8]) -> Option<String> {
    let folder = here().join("tests/attacks");
    let mut include = |file: &str| {
        let up = file.matches("..").count();
        assert!(up <= 2 && !file.starts_with('/') && !file.contains(':'), "asked for {file}");
        std::fs::read(folder.join(file)).map_err(|_| "the file is missing".to_owned())
    };
    if name.ends_with(".urdf") {
        urdf::read(bytes, name, &urdf::Options::default()).err().map(|e| e.to_string())
    } else {
        mjcf::read(bytes, name, &mut include, &mjcf::Options::default()).err().map(|e| e.to_string())
    }
}

#[test]
fn attacks_are_refused_as_expected() {
    let folder = here().join("tests/attacks");
    let text = std::fs::read_to_string(folder.join("expected.txt")).unwrap_or_default();
    let expected: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(": ")).collect();
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if !name.ends_with(".xml") && !name.ends_with(".urdf") {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        let (sender, receiver) = std::sync::mpsc::channel();
        let start = Instant::now();
        let small = std::thread::Builder::new().stack_size(256 << 10);
        let inner = name.clone();
        let work = small.spawn(move || sender.send(message(&inner, &bytes)).unwrap()).unwrap();
        let said = receiver.recv_timeout(Duration::from_secs(10)).unwrap_or_else(|e| panic!("{name}: {e}"));
        work.join().unwrap();
        assert!(start.elapsed() < Duration::from_secs(1), "{name} took {:?}", start.elapsed());
        found.insert(name, said.unwrap_or_else(|| "accepted".to_owned()));
    }
    let mut wrong = vec![];
    for (name, said) in &found {
        assert!(!said.chars().any(char::is_control), "{name}: {said:?}");
        if expected.get(name.as_str()) != Some(&said.as_str()) {
            wrong.push(format!("{name}: {said}"));
        }
    }
    assert!(wrong.is_empty(), "these differ from expected.txt:\n{}", wrong.join("\n"));
    assert!(found.len() >= 40 && expected.len() == found.len());
}
