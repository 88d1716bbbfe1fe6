//! The pages of `simulate` through the real program: title, tiles, text and terminal name the same numbers, and a job that cannot be
//! done is nowhere said to hold.

use crate::support;

use serde_json::Value;
use support::{column, contrapposto, page, scenarios};

/// A target that is above the reach of the body.
const TOO_HIGH: &str = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75 }\n\
    [[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n\
    [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 2.6, 0.2]\nabove_relief = true\n\
    [[task]]\nkind = \"effort\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 2\n";

fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

fn texts(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

/// The figure of a label: value and note.
fn figure<'a>(page: &'a Value, label: &str) -> Option<[&'a str; 2]> {
    let found = page["figures"].as_array().unwrap().iter().find(|figure| figure[0] == label)?;
    Some([found[1].as_str().unwrap(), found[2].as_str().unwrap()])
}

/// The page opens at the end, from which its minutes are counted, and with the joint of its title, where text and tile have the title's load.
#[test]
fn the_title_of_a_lift_its_tile_and_its_text_have_one_load_and_the_terminal_names_the_hazard() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate"]).arg(scenarios().join("lift-box.toml")).arg("--out").arg(folder.path()).run();
    let summary: Value = serde_json::from_slice(&std::fs::read(folder.path().join("summary.json")).unwrap()).unwrap();
    let (page, verdict) = (page(folder.path()), &summary["verdict"]);
    assert!(
        run.stdout.lines().next().unwrap().ends_with("Hazard for ligaments: low back bent forward by 60°."),
        "{}",
        run.stdout
    );
    assert!(run.stdout.lines().any(|line| line.starts_with("Hazard: ")), "{}", run.stdout);
    let fact = |name: &str| {
        let facts = page["facts"].as_array().unwrap().iter();
        facts.filter(|fact| fact[0] == name).map(|fact| fact[1].as_str().unwrap()).collect::<Vec<_>>()
    };
    assert!(matches!(fact("Hazard")[..], [one] if one.starts_with("low back bent forward by 60°: ligaments carry ")));
    assert!(fact("Hazard")[0].ends_with("; discs and discomfort are not judged"), "{:?}", fact("Hazard"));
    let rows = page["changes"]["rows"].to_string();
    assert!(rows.contains("\"low back bent forward by 60°\"") && !rows.contains("joint"), "{rows}");
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    for words in ["about its axis", "that stands for this coordinate", "in the files", "minus passive"] {
        assert!(!html.contains(words), "{words}");
    }
    assert!(html.contains("from 14 to\n        50&nbsp;% for minutes only"));
    let (load, who) = (verdict["hardest"]["load"].as_f64().unwrap(), &verdict["hardest"]["who"]);
    assert!(fact("Hardest worked")[0].contains(&format!(", {} of its strength", percent(load))));
    assert_eq!(figure(&page, "Highest load").unwrap()[0], percent(load));
    let shown = &page["joints"][page["main"].as_u64().unwrap() as usize];
    let groups = shown["groups"].as_array().unwrap();
    assert!(groups.iter().any(|group| group["label"] == *who), "{shown}");
    let (frames, open) = (page["frames"].as_u64().unwrap() as usize, page["open"].as_u64().unwrap() as usize);
    let at = column(&shown["load"], frames)[open];
    assert_eq!(percent(at), percent(load), "{at} {load}");
    assert_eq!(open + 1, frames);
    let group = groups.iter().find(|group| group["label"] == verdict["who"]).unwrap();
    let left = column(&group["left"], frames)[open];
    assert!((60.0 + left - 60.0 * verdict["minutes"].as_f64().unwrap()).abs() < 1.0, "{left} {verdict}");
    // A lift relieves no pelvis.
    let all = texts(&page["reasons"]);
    assert!(all.iter().all(|reason| !reason.to_lowercase().contains("slouch")), "{all:?}");
    assert!(figure(&page, "Pelvis drops").is_none());
}

#[test]
fn the_page_of_a_target_out_of_reach_says_nowhere_that_anything_holds() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate", "-", "--no-suggest", "--out"]).arg(folder.path()).stdin(TOO_HIGH).run();
    assert_eq!(run.code, 1, "{}", run.stderr);
    let page = page(folder.path());
    let headline = page["headline"].as_str().unwrap();
    assert!(headline.starts_with("Not reached: point right hand is missed by "), "{headline}");
    let reasons = texts(&page["reasons"]);
    for word in ["hold", "slouch", "relief", "tired"] {
        assert!(reasons.iter().all(|reason| !reason.to_lowercase().contains(word)), "{word}: {reasons:?}");
    }
    assert!(reasons.iter().all(|reason| *reason != headline), "{reasons:?}");
    // The target is drawn, so far from the hand as the title says.
    let frames = page["frames"].as_u64().unwrap() as usize;
    let target = &page["targets"].as_array().unwrap()[0];
    assert_eq!(target["label"], "right hand");
    let miss = |frame: usize| {
        let at = |place: &Value, k: usize| column(&place[k], frames)[frame];
        (0..3).map(|k| (at(&target["at"], k) - at(&target["from"], k)).powi(2)).sum::<f64>().sqrt()
    };
    let message = headline.split("missed by ").nth(1).and_then(|rest| rest.split_once(" cm")).unwrap().0;
    let (message, drawn) = (message.parse::<f64>().unwrap(), 100.0 * miss(0).max(miss(frames - 1)));
    assert!((message - drawn).abs() < 0.1, "{message} {drawn}");
}

/// A foot is in the air for two seconds; the other knee is not said to be exhausted for it.
#[test]
fn the_peak_of_fatigue_at_the_bus_stop_leaves_out_the_step() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate"]).arg(scenarios().join("bus-stop.toml")).arg("--out").arg(folder.path()).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let summary: Value = serde_json::from_slice(&std::fs::read(folder.path().join("summary.json")).unwrap()).unwrap();
    assert!(!summary["steps"].as_array().unwrap().is_empty());
    for (name, coordinate) in summary["coordinates"].as_object().unwrap() {
        for side in ["positive", "negative"] {
            assert!(coordinate[side]["peak_fatigue"].as_f64().unwrap() < 0.95, "{name} {side}");
        }
    }
    assert!(!run.stdout.contains("1.00"), "{}", run.stdout);
}

#[test]
fn weights_of_a_sitter_are_named_by_seat_and_backrest() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(scenarios().join("sit-slumped.toml")).unwrap();
    let short = text.replace("duration_s = 1800", "duration_s = 2");
    let run = contrapposto(["simulate", "-", "--out"]).arg(folder.path()).stdin(short.as_str()).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = page(folder.path());
    for label in ["Weight on seat (pelvis)", "Weight on backrest (torso)", "Weight on right foot"] {
        assert!(figure(&page, label).is_some(), "{label}: {}", page["figures"]);
    }
    let surfaces = page["surfaces"].as_array().unwrap();
    assert!(surfaces.iter().all(|surface| surface["label"] == "backrest"), "{surfaces:?}");
    let supports: Vec<&Value> = page["supports"].as_array().unwrap().iter().map(|support| &support["label"]).collect();
    assert_eq!(supports, ["right foot", "left foot", "seat (pelvis)", "backrest (torso)"]);
}
