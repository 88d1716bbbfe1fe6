//! Hostile scenarios: every one is refused with exit code 2, file, line, column and what would be right, in a moment, and
//! nothing is written. `attacks/*.toml` say in their first line: what they attack | a part of the answer | line:column.

use crate::support;

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
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
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
    let names: Vec<String> = (0..55_000).map(|i| format!("k{i} = {i}")).collect();
    let passive: Vec<String> = (0..40_000).map(|i| format!("passive.j{i} = {{}}")).collect();
    let nested = format!("format = 1\n[{}]\n", vec!["a"; 100_000].join("."));
    let inline = format!("a = {}", "{ a = ".repeat(60_000));
    for (name, text, part) in [
        ("empty.toml", String::new(), "the key `format` is missing"),
        ("blank.toml", "\n\n  \n".into(), "the key `format` is missing"),
        ("only-a-bom.toml", "\u{feff}".into(), "the key `format` is missing"),
        ("brackets.toml", format!("a = {}", "[".repeat(60_000)), "not TOML: cannot recurse further"),
        (
            "more-brackets.toml",
            format!("a = {}", "[".repeat(100_000)),
            "100001 commas, equals signs and opening brackets",
        ),
        ("closed-brackets.toml", format!("a = {}{}", "[".repeat(60_000), "]".repeat(60_000)), "cannot recurse"),
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
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
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

/// Two hinges and three links whose names are made for terminals, tables and pages.
const HOSTILE_NAMES: &str = r#"<robot name="r&#x202e;x">
<link name="base"/>
<link name="a&#10;b"><inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="c"><inertial><origin xyz="0.2 0 0"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="=cmd|'/C calc'!A0" type="revolute"><parent link="base"/><child link="a&#10;b"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="100" velocity="1"/></joint>
<joint name="d&#x202e;e&#13;f" type="revolute"><parent link="a&#10;b"/><child link="c"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="100" velocity="1"/></joint>
</robot>"#;

/// Whether a terminal obeys the character: a control character, or one that turns the reading direction.
fn is_obeyed(c: char) -> bool {
    (c.is_control() && c != '\n') || ('\u{202a}'..='\u{202e}').contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c)
}

#[test]
fn names_reach_terminals_and_tables_without_power() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.urdf"), HOSTILE_NAMES).unwrap();
    let scenario = folder.path().join("job.toml");
    let text = "format = 1\ntitle = \"A turned \u{202e}title\"\n[model]\nfile = \"robot.urdf\"\n[fatigue.start]\n\
                \"=cmd|'/C calc'!A0\" = { positive = 0.8, negative = 0.8 }\n[strategy]\nkind = \"active\"\n[run]\n\
                duration_s = 2\nstep_s = 0.1\n";
    std::fs::write(&scenario, text).unwrap();
    let out = folder.path().join("out");
    let run = contrapposto(["simulate"]).arg(&scenario).arg("--out").arg(&out).run();
    assert!(run.code < 2, "{}", run.stderr);
    for words in [&run.stdout, &run.stderr] {
        assert_eq!(words.chars().find(|&c| is_obeyed(c)), None, "{words:?}");
    }
    assert!(run.stdout.contains(r"A turned \u202etitle"), "{}", run.stdout);
    for (name, bytes) in contents(&out) {
        let text = String::from_utf8_lossy(&bytes);
        if name.ends_with(".csv") {
            for cell in text.split([',', '\n']) {
                let cell = cell.trim_start_matches('"');
                let number = cell.parse::<f64>().is_ok();
                assert!(number || !cell.starts_with(['=', '+', '-', '@']), "{name}: {cell}");
            }
        }
        if !name.ends_with(".png") && !name.ends_with(".glb") {
            assert_eq!(text.chars().find(|&c| is_obeyed(c) && !matches!(c, '\t' | '\r')), None, "{name}");
        }
    }
    // The table is read back by its own names.
    let table = out.join("trajectory.csv");
    let run = contrapposto(["torques"]).arg(folder.path().join("robot.urdf")).arg(&table).arg("--json").run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(!run.stderr.contains("not in the model"), "{}", run.stderr);
}

#[test]
fn a_scenario_names_files_in_its_own_folder_only_unless_others_are_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let (own, other) = (folder.path().join("own"), folder.path().join("other"));
    std::fs::create_dir_all(own.join("below")).unwrap();
    std::fs::create_dir(&other).unwrap();
    std::fs::write(other.join("secret.toml"), "a secret line").unwrap();
    for place in [own.join("below"), other.clone()] {
        std::fs::write(place.join("robot.urdf"), HOSTILE_NAMES).unwrap();
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink(other.join("robot.urdf"), own.join("link.urdf")).unwrap();
    let inspected = |model: &str, arguments: &[&str]| {
        let scenario = own.join("job.toml");
        let text = format!("format = 1\n[model]\n{model}\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n");
        std::fs::write(&scenario, text).unwrap();
        contrapposto(["inspect"]).arg(&scenario).args(arguments).run()
    };
    let below = inspected("file = \"below/robot.urdf\"", &[]);
    assert_eq!(below.code, 0, "{}", below.stderr);
    let absolute = format!("file = {:?}", other.join("robot.urdf"));
    let overlay = format!("file = \"below/robot.urdf\"\noverlay = {:?}", other.join("secret.toml"));
    let mut outside = vec!["file = \"../other/robot.urdf\"", &absolute, &overlay];
    if cfg!(unix) {
        outside.push("file = \"link.urdf\"");
    }
    for model in outside {
        let run = inspected(model, &[]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{model}: {}", run.stderr);
        assert!(run.stderr.contains("--allow-path DIR") && !run.stderr.contains("secret line"), "{}", run.stderr);
    }
    let allowed = inspected("file = \"../other/robot.urdf\"", &["--allow-path", other.to_str().unwrap()]);
    assert_eq!(allowed.code, 0, "{}", allowed.stderr);
}

#[test]
fn too_many_tables_are_refused_by_name_at_once() {
    let head = "format = 1\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";
    let tables = [
        ("task", "[[task]]\nkind = \"posture\"\n", 80),
        ("load", "[[load]]\nsegment = \"hand_r\"\nmass_kg = 0.001\n", 1000),
        ("event", "[[event]]\nat_s = 0.5\nload = []\n", 1000),
    ];
    for (name, table, most) in tables {
        let said = with("many.toml", head.to_owned() + &table.repeat(most + 1));
        let words = format!("{} tables [[{name}]]; {most} at most", most + 1);
        assert!(said.contains(&words), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("most.toml");
    std::fs::write(&path, head.to_owned() + &tables[0].1.repeat(80)).unwrap();
    let run = contrapposto(["inspect"]).arg(&path).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
}

#[test]
fn a_motion_where_a_scenario_is_due_is_refused_by_what_it_is() {
    for name in ["walk.mot", "walk.sto", "walk.trc"] {
        let said = with(name, "walk\nversion=1\n");
        assert!(said.contains("is a motion, not a scenario") && said.contains("assess MODEL MOTION"), "{said}");
    }
}
