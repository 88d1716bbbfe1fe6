//! Compares the tables of endurance by fatigue parameters in docs/holding-times.md with the embedded data; to write them anew:
//! `CONTRAPPOSTO_WRITE_DOCS=1 cargo test -p contrapposto fatigue_tables`.

use std::path::Path;

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::Sex;
use contrapposto::model::data::{FatigueSet, library};

const LOADS: [f64; 3] = [0.2, 0.3, 0.5];
const BEGIN: &str = "<!-- fatigue parameters -->\n";
const END: &str = "<!-- /fatigue parameters -->\n";

/// Seconds at the three loads, without decimals.
fn times(law: &FatigueLaw) -> [f64; 3] {
    LOADS.map(|load| law.endurance_time(load))
}

fn seconds(times: [f64; 3]) -> String {
    times.map(|time| if time.is_finite() { format!("{time:.0}") } else { "∞".to_owned() }).join(" / ")
}

/// Percent by which `times` differ from those of the endurance curve.
fn errors(times: [f64; 3], curve: [f64; 3]) -> String {
    let error = |i: usize| {
        let share = times[i] / curve[i] - 1.0;
        // Adding zero takes the sign of a rounded -0 away.
        if share.is_finite() { format!("{:+.0}", (100.0 * share).round() + 0.0) } else { "∞".to_owned() }
    };
    [0, 1, 2].map(error).join(" / ")
}

fn curve(class: &str) -> [f64; 3] {
    times(&library().endurance(&library().default_endurance(class)).unwrap().0)
}

/// One row a class: 3CC-r, the endurance curve, and their difference.
fn classes() -> String {
    let mut text = "| class | 3CC-r, s | endurance curve, s | difference, % |\n|---|---|---|---|\n".to_owned();
    for class in library().fatigue_classes() {
        let given = times(&library().three_compartment(class).unwrap().0);
        text += &format!(
            "| {class} | {} | {} | {} |\n",
            seconds(given),
            seconds(curve(class)),
            errors(given, curve(class))
        );
    }
    text
}

/// The knee's fit, which hips had before, beside the general one and the endurance curves.
fn hip() -> String {
    let mut text = "| hip | 3CC-r, s | endurance curve, s |\n|---|---|---|\n".to_owned();
    for (name, class) in [("knee's class, before", "knee"), ("general class, now", "general")] {
        let law = library().three_compartment(class).unwrap().0;
        text += &format!("| {name} | {} | {} |\n", seconds(times(&law)), seconds(curve(class)));
    }
    text
}

/// One row for movements with the same muscle group: both sets, and by how much the set by groups differs from the endurance curve of the joint.
fn groups() -> String {
    let mut text = "| movement | `joint`, s | `muscle_group`, female, s | male, s | any sex, s | against the curve, %: female | male | \
        any sex |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let mut rows: Vec<(String, String)> = vec![];
    let law = |movement: &str, set, sex| library().fatigue_law(movement, set, sex).unwrap();
    for movement in library().movements() {
        let joint = law(movement, FatigueSet::Joint, None);
        let by_group =
            [Some(Sex::Female), Some(Sex::Male), None].map(|sex| law(movement, FatigueSet::MuscleGroup, sex));
        if by_group.iter().all(|law| *law == joint) {
            continue;
        }
        let curve = curve(library().fatigue_class(movement).unwrap());
        let cells = by_group.iter().map(|law| seconds(times(law)));
        let cells = cells.chain(by_group.iter().map(|law| errors(times(law), curve))).collect::<Vec<_>>().join(" | ");
        let cells = format!("{} | {cells}", seconds(times(&joint)));
        let movement = movement.replace('_', " ");
        match rows.iter_mut().find(|(_, same)| *same == cells) {
            Some((movements, _)) => *movements += &format!(", {movement}"),
            None => rows.push((movement, cells)),
        }
    }
    text.extend(rows.iter().map(|(movements, cells)| format!("| {movements} | {cells} |\n")));
    text
}

#[test]
fn the_tables_of_the_page_are_those_of_the_data() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/holding-times.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (given, after) = rest.split_once(END).unwrap();
    let expected = format!("\n{}\n{}\n{}\n", hip(), classes(), groups());
    if std::env::var_os("CONTRAPPOSTO_WRITE_DOCS").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{expected}{END}{after}")).unwrap();
    } else {
        assert_eq!(given, expected, "CONTRAPPOSTO_WRITE_DOCS=1 writes the tables anew");
    }
}
