//! The page of the postures of least effort.

use std::f64::consts::LN_2;

use contrapposto::equilibria::{Direction, Equilibria, RelaxedPosture};
use contrapposto::hybrid::{Carrier, Equilibrium};
use contrapposto::model::Model;
use contrapposto_formats::RelaxScenario;
use contrapposto_report::{Entry, Fact, List, Moments, Table};

use super::figure::{carriers, figure, figures_of, weight};
use super::page;
use crate::fail::Fail;
use crate::view::answer::Answer;
use crate::view::figures::figures_of_postures;
use crate::view::frame::Frame;
use crate::view::muscle_work::MusclesAtWork;
use crate::view::muscles::{fails_first, hardest};
use crate::view::scene::Scene;
use crate::view::scene::hazard::hazards;
use crate::view::selection::shown;
use crate::view::stage::Stage;
use crate::view::text::relax::number_in_words;
use crate::view::words::{MOST_JOINTS_SHOWN, how_long, list, percent, plain, value};

/// `--figures` of all postures of least effort.
pub(crate) fn figures_of_equilibria(
    scenario: &RelaxScenario,
    frames: &[Frame],
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    figures_of_postures(&scenario.title, &scenario.model, frames, &numbered(frames.len()))
}

/// `posture 1`, `posture 2`, ...
fn numbered(count: usize) -> Vec<String> {
    (1..=count).map(|number| format!("posture {number}")).collect()
}

/// The page of all postures of least effort.
pub(crate) fn report_of_equilibria(
    scenario: &RelaxScenario,
    found: &Equilibria,
    (frames, muscles): (&[Frame], Option<&MusclesAtWork<'_>>),
    Answer { verdict, advice, .. }: &Answer,
) -> Result<String, Fail> {
    let model = &scenario.model;
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let scene = Scene { muscles, ..Scene::of(&scenario.title, model, scenario.start.values(), frames, stage) };
    let shown = shown(model);
    let first = found.postures.first().map_or(0, main_coordinate_of);
    let mut report = scene.report(Moments::Postures(numbered(frames.len())), first)?;
    let supports = carriers(&scene);
    let entry = |(frame, posture): (usize, &RelaxedPosture)| Entry {
        frame,
        time: None,
        joint: shown.iter().position(|&i| i == main_coordinate_of(posture)),
        text: description(model, posture, &frames[frame], &supports),
    };
    report.list = List {
        heading: "Postures of least effort".to_owned(),
        entries: found.postures.iter().enumerate().map(entry).collect(),
        none: String::new(),
    };
    let Some((best, frame)) = found.postures.first().zip(frames.first()) else {
        return Ok(page(model, report));
    };
    let more = found.postures.get(1).map(|next| percent(next.relaxed.effort / best.relaxed.effort - 1.0));
    super::answer(&mut report, verdict, advice);
    report.reasons.push(match (found.postures.len(), &more) {
        (n, Some(more)) => {
            format!(
                "{n} resting postures. The first takes the least effort: {}; the next one takes {more} more.",
                hanging_in_words(model, best)
            )
        }
        _ => format!("One resting posture: {}.", hanging_in_words(model, best)),
    });
    report.reasons.push(stability_in_words(model, best));
    report.reasons.push(searched(found));
    let note =
        more.map_or_else(|| "sum of squared relative loads".to_owned(), |more| format!("the next takes {more} more"));
    report.figures.push(figure("Least effort", format!("{:.4}", best.relaxed.effort), &note));
    figures_of(model, frame, &supports, &mut report);
    let row = |(i, (posture, frame)): (usize, (&RelaxedPosture, &Frame))| {
        let hardest = hardest(model, frame).map(|(name, load)| format!("{name}, {}", percent(load)));
        let effort = format!("{:.4}", posture.relaxed.effort);
        let number = number_in_words(i, posture.mirrored);
        vec![number, effort, weight(frame, &supports), held_by(posture), hardest.unwrap_or_default()]
    };
    report.table = Table {
        heading: "Side by side".to_owned(),
        columns: ["Posture", "Effort", "Weight on", "Held by", "Highest load"].map(str::to_owned).to_vec(),
        rows: found.postures.iter().zip(frames).enumerate().map(row).collect(),
    };
    let others = hazards(model, &frames[1..], false);
    report.facts.extend(others.into_iter().map(|text| Fact { name: "Hazard in others".to_owned(), text }));
    Ok(page(model, report))
}

/// The fate of the starts.
fn searched(found: &Equilibria) -> String {
    let mut searched = format!("{} starts were tried", found.starts);
    for (count, what) in [
        (found.fell, "fell"),
        (found.yielded, "were left out because tasks or supports were kept less well"),
        (found.alike, "were left out as the same way to stand as a better one, or too heavy"),
    ] {
        if count > 0 {
            searched += &format!(", {count} {what}");
        }
    }
    searched + "."
}

/// The coordinate that says most of a posture: the one that hangs on its ligaments, else the hardest worked.
fn main_coordinate_of(found: &RelaxedPosture) -> usize {
    let hanging = found.hanging.first().map(|hanging| hanging.coordinate);
    hanging.or_else(|| found.work.first().map(|work| work.coordinate)).unwrap_or(0)
}

/// `hanging on the ligaments of right hip adduction`.
fn hanging_in_words(model: &Model, found: &RelaxedPosture) -> String {
    match found.hanging.first() {
        Some(joint) => format!("hanging on the ligaments of {}", plain(&model.coordinates()[joint.coordinate].name)),
        None => "no joint hangs on its ligaments".to_owned(),
    }
}

fn held_by(found: &RelaxedPosture) -> String {
    match found.stability.equilibrium {
        None => "its supports alone".to_owned(),
        Some(Equilibrium::Stable(Carrier::Ligaments)) => "ligaments".to_owned(),
        Some(Equilibrium::Stable(Carrier::Gravity)) => "its own weight".to_owned(),
        Some(Equilibrium::Unstable) => match found.stability.unstable {
            1 => "attention, in 1 direction".to_owned(),
            n => format!("attention, in {n} directions"),
        },
    }
}

fn stability_in_words(model: &Model, found: &RelaxedPosture) -> String {
    match found.stability.equilibrium {
        None => "Its supports leave nothing free to move.".to_owned(),
        Some(Equilibrium::Stable(Carrier::Ligaments)) => {
            "It is stable: after a push, ligaments bring it back.".to_owned()
        }
        Some(Equilibrium::Stable(Carrier::Gravity)) => {
            "It is stable: after a push, its weight brings it back.".to_owned()
        }
        Some(Equilibrium::Unstable) => {
            let name = |&(i, _): &(usize, f64)| plain(&model.coordinates()[i].name);
            let direction = |direction: &Direction| {
                let joints: Vec<String> = direction.joints.iter().take(MOST_JOINTS_SHOWN).map(name).collect();
                let grows =
                    direction.growth_time().map(|time| format!(" (a small sway doubles in {:.2} s)", LN_2 * time));
                format!("{}{}", list(&joints), grows.unwrap_or_default())
            };
            let worst: Vec<String> = found.stability.unstable().iter().take(1).map(direction).collect();
            format!("It is unstable; the direction that needs most attention: {}.", worst.join(""))
        }
    }
}

fn description(model: &Model, found: &RelaxedPosture, frame: &Frame, supports: &[String]) -> String {
    let mut sentences = vec![format!("Effort {:.4}; weight on {}.", found.relaxed.effort, weight(frame, supports))];
    if supports.is_empty() {
        sentences = vec![format!("Effort {:.4}.", found.relaxed.effort)];
    }
    let hanging = found.hanging.iter().take(MOST_JOINTS_SHOWN).map(|joint| {
        let i = joint.coordinate;
        let at = value(model, i, frame.angles[i]);
        format!(
            "{} at {at} ({} of {:.1} N m)",
            plain(&model.coordinates()[i].name),
            percent(joint.share()),
            joint.external.abs()
        )
    });
    let hanging: Vec<String> = hanging.collect();
    sentences.push(if hanging.is_empty() {
        "No joint hangs on its ligaments.".to_owned()
    } else {
        format!("Hangs on ligaments: {}.", list(&hanging))
    });
    sentences.push(stability_in_words(model, found));
    if let Some((name, load)) = hardest(model, frame) {
        sentences.push(format!("Highest load: {name}, {}.", percent(load)));
    }
    sentences.push(match fails_first(model, frame) {
        Some((name, time)) => format!("Endurance: {}, then {name} fails.", how_long(time)),
        None => "Endurance: no limit by muscles.".to_owned(),
    });
    sentences.join(" ")
}
