//! Hostile scenarios: every one is refused with exit code 2, file, line, column and what would be right, in a moment, and
//! nothing is written. `attacks/*.toml` say in their first line: what they attack | a part of the answer | line:column.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod support;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::{Run, contents, contrapposto};

/// Longest answer to bad input, s. Machines that do other things besides get the rest.
const MOMENT: f64 = 2.0;

/// Longest complaint, bytes: an attack must not fill the terminal.
const MOST_SAID: usize = 6000;

/// Refused, and nothing written. Gives the complaint on one line.
fn refused(path: &Path) -> String {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = contrapposto(["simulate", "--json", "--out"]).arg(&out).arg(path).run();
    assert!(!out.exists(), "{} wrote something", path.display());
    complaint(&path.display().to_string(), run)
}

fn complaint(name: &str, run: Run) -> String {
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{name}: {}", run.stderr);
    assert!(run.seconds < MOMENT, "{name} took {} s", run.seconds);
    assert!(!run.stderr.trim().is_empty() && run.stderr.len() < MOST_SAID, "{name}: {} bytes", run.stderr.len());
    let stray = run.stderr.chars().find(|&c| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c));
    assert_eq!(stray, None, "{name}: a terminal would obey this");
    // The complaint is wrapped at the width of a terminal.
    run.stderr.replace("│ ", " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn with(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    refused(&path)
}

#[test]
fn every_attack_gets_its_answer() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/attacks");
    let mut count = 0;
    for (name, bytes) in contents(&folder) {
        let text = String::from_utf8_lossy(&bytes);
        let first = text.trim_start_matches('\u{feff}').lines().next().unwrap();
        let [what, part, place] = first.strip_prefix("# ").unwrap().split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{name}: {first}");
        };
        let said = refused(&folder.join(&name));
        assert!(said.contains(part.trim()), "{name}, {what}: `{part}` is not in\n{said}");
        let place = format!("attacks/{name}:{}", place.trim());
        assert!(said.contains(&place), "{name}, {what}: `{place}` is not in\n{said}");
        count += 1;
    }
    println!("{count} files refused");
    assert!(count >= 70);
}

/// The same text without the attack is a good scenario: what is refused is refused for the attack.
#[test]
fn without_the_attack_it_runs() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate", "-", "--out"]).arg(folder.path()).stdin(GOOD).run();
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
}

const GOOD: &str = "format = 1\ntitle = \"attack\"\n[coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n\
    [run]\nduration_s = 1\nstep_s = 0.1\n";

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    assert!(refused(&at("missing.toml")).contains("No such file"));
    assert!(refused(folder.path()).contains("is not a regular file"));
    assert!(refused(Path::new("")).contains("a value is required"));
    #[cfg(unix)]
    {
        assert!(refused(Path::new("/dev/zero")).contains("is not a regular file"));
        assert!(refused(Path::new("/dev/null")).contains("is not a regular file"));
        assert!(Command::new("mkfifo").arg(at("fifo")).status().unwrap().success());
        assert!(refused(&at("fifo")).contains("is not a regular file"));
        std::os::unix::fs::symlink(at("loop"), at("loop")).unwrap();
        assert!(refused(&at("loop")).contains("symbolic links"));
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
        assert!(refused(&at("socket")).contains("is not a regular file"));
    }
}

#[test]
fn files_of_any_size_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("100-mb.toml", 100 << 20), ("5-gb.toml", 5 << 30), ("cap-and-one.toml", (1 << 20) + 1)] {
        let path = folder.path().join(name);
        File::create(&path).unwrap().set_len(bytes).unwrap();
        let said = refused(&path);
        assert!(said.contains(&format!("{bytes} bytes long; 1048576 bytes at most are read")), "{said}");
    }
    // At the cap it is read, and refused for what it says.
    let path = folder.path().join("cap.toml");
    File::create(&path).unwrap().set_len(1 << 20).unwrap();
    assert!(refused(&path).contains("not TOML"));
}

/// Standard input has no size to look at: reading stops at the cap.
#[test]
fn endless_standard_input_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = contrapposto(["simulate", "-", "--out"]).arg(&out).stdin(vec![b'#'; 3 << 20]).run();
    assert!(complaint("-", run).contains("longer than 1048576 bytes"));
    assert!(!out.exists());
}

#[test]
fn great_files_are_refused_with_a_short_answer() {
    let long = "x".repeat(1_000_000);
    let names: Vec<String> = (0..65_000).map(|i| format!("k{i} = {i}")).collect();
    let passive: Vec<String> = (0..40_000).map(|i| format!("passive.j{i} = {{}}")).collect();
    let nested = format!("format = 1\n[{}]\n", vec!["a"; 100_000].join("."));
    let inline = format!("a = {}", "{ a = ".repeat(100_000));
    for (name, text, part) in [
        ("empty.toml", String::new(), "the key `format` is missing"),
        ("blank.toml", "\n\n  \n".into(), "the key `format` is missing"),
        ("only-a-bom.toml", "\u{feff}".into(), "the key `format` is missing"),
        ("brackets.toml", format!("a = {}", "[".repeat(100_000)), "not TOML: cannot recurse further"),
        ("closed-brackets.toml", format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000)), "cannot recurse"),
        ("dots.toml", nested, "recursion limit"),
        ("inline-tables.toml", inline, "not TOML: "),
        ("many-keys.toml", names.join("\n"), "unknown key `k0`"),
        ("many-joints.toml", "format = 1\n".to_owned() + &passive.join("\n"), ""),
        ("long-title.toml", GOOD.replace("attack", &long), "the title has 1000000 characters; 200 at most"),
        ("long-key.toml", format!("format = 1\n{long} = 2\n"), "unknown key `xxx"),
        ("long-name.toml", GOOD.replace("elbow_flex_r", &long), "the body has no coordinate `xxx"),
        ("long-comment.toml", format!("# {long}\nformat = 3\n"), ":2:10]"),
        ("long-number.toml", GOOD.replace("0.1", &("1".repeat(400_000) + ".0")), "is not a finite number"),
        ("long-line.toml", format!("title = \"{long}\" format = 1"), "long-line.toml:1:1000012]"),
        ("no-end.toml", format!("title = \"{long}"), "no-end.toml:1:1000010]"),
        ("wide-letters.toml", format!("title = \"{}\" x", "\u{1f9ba}".repeat(200_000)), "not TOML: "),
        ("combining.toml", format!("title = \"e{}\" x", "\u{301}".repeat(400_000)), "not TOML: "),
    ] {
        let said = with(name, text);
        assert!(said.contains(part), "{name}: `{part}` is not in\n{said:.2000}");
        assert!(said.contains(&format!("{name}:")), "{name}: no place in\n{said:.2000}");
    }
}

/// A title may hold anything printable; in the pictures it is text.
#[test]
fn a_hostile_title_is_text() {
    let title = r#"<script>alert(1)</script> ]]> &amp; <!-- ' </text><image href='x' onerror='y'/> \" \U0001F9BA"#;
    let folder = tempfile::tempdir().unwrap();
    let scenario = GOOD.replace("\"attack\"", &format!("\"{title}\""));
    let run = contrapposto(["simulate", "-", "--json", "--out"]).arg(folder.path()).stdin(scenario).run();
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(summary["title"].as_str().unwrap().starts_with("<script>"));
    for (name, bytes) in contents(folder.path()) {
        if name.ends_with(".svg") {
            let text = String::from_utf8(bytes.clone()).unwrap();
            for tag in ["<script", "<image", "<!-- '", "]]>"] {
                assert!(!text.contains(tag), "{tag} in {name}");
            }
            assert!(text.contains("&lt;script"), "the title is there, as text, {name}");
            // Words of the title are text there; no element carries them.
            support::assert_svg(text.replace(" onerror=", "").as_bytes());
        }
    }
}
