//! Prints what the fatigue parameters change in scenarios of the built-in adult, as a table of docs/holding-times.md:
//! `cargo run --release -p contrapposto-formats --example fatigue_sets -- scenarios/crouch.toml scenarios/overhead.toml`.
//!
//! Each scenario runs three times: with the knee's fit for hips, with the fits of joints, and with those of muscle groups and the sex of
//! the body. A scenario that needs a model file is left out, and standard error says so.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use contrapposto::model::{Side, data};
use contrapposto::simulation::{Scenario, Summary, run};
use contrapposto_formats::read_scenario;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    println!("| scenario | hips like the knee | `joint` | `muscle_group` |\n|---|---|---|---|");
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path)?;
        let given = |text: &str| read_scenario(&path, text.as_bytes(), None);
        let (joint, by_group) = match (given(&text), given(&with_muscle_groups(&text))) {
            (Ok(joint), Ok(by_group)) => (joint, by_group),
            (Err(error), _) | (_, Err(error)) => {
                eprintln!("{path} is left out: {error}");
                continue;
            }
        };
        let mut cells = vec![];
        for scenario in [hips_like_the_knee(joint.clone()), joint, by_group] {
            cells.push(in_words(&scenario, &run(&scenario, |_| {})?));
        }
        let name = std::path::Path::new(&path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        println!("| `{name}` | {} |", cells.join(" | "));
    }
    Ok(())
}

/// The same file with the parameters of muscle groups.
fn with_muscle_groups(text: &str) -> String {
    let set = "[fatigue]\nparameters = \"muscle_group\"";
    if text.contains("[fatigue]") { text.replacen("[fatigue]", set, 1) } else { format!("{text}\n{set}\n") }
}

fn hips_like_the_knee(mut scenario: Scenario) -> Scenario {
    let Some((knee, _)) = data::library().three_compartment("knee") else { return scenario };
    for index in 0..scenario.model.coordinates().len() {
        if scenario.model.coordinates()[index].name.starts_with("hip_") {
            scenario.model = scenario.model.with_fatigue(index, &knee);
        }
    }
    scenario
}

/// The group that fails first, or the most tired one; and the number of reliefs.
fn in_words(scenario: &Scenario, summary: &Summary) -> String {
    let coordinates = scenario.model.coordinates();
    let groups = (0..coordinates.len()).flat_map(|i| Side::BOTH.map(|side| (i, side.index())));
    let named = groups.filter_map(|(i, side)| Some((coordinates[i].groups.as_ref()?[side].name.clone(), i, side)));
    let named: Vec<_> = named.collect();
    let failed = named.iter().filter_map(|(name, i, side)| Some((summary.coordinates[*i].exhausted_at[*side]?, name)));
    let fatigue = |(_, i, side): &&(String, usize, usize)| summary.coordinates[*i].peak_fatigue[*side];
    let tired = named.iter().max_by(|a, b| fatigue(a).total_cmp(&fatigue(b)));
    let reliefs = match summary.reliefs.count {
        1 => "1 relief".to_owned(),
        count => format!("{count} reliefs"),
    };
    match (failed.min_by(|a, b| a.0.total_cmp(&b.0)), tired) {
        (Some((time, name)), _) => format!("{name} fails at {time:.0} s, {reliefs}"),
        (None, Some(tired)) => format!("{} tires to {:.0} %, {reliefs}", tired.0, 100.0 * fatigue(&tired)),
        (None, None) => "no muscle group".to_owned(),
    }
}
