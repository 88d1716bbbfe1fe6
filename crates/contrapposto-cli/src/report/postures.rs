//! The pages of `pose` and `relax`: one posture, or a few to choose between.

use contrapposto::contact::root_rates;
use contrapposto::equilibria::{Direction, Equilibria, RelaxedPosture};
use contrapposto::hybrid::{Carrier, Equilibrium};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture_solver::inverse_kinematics::{Pose, Reason};
use contrapposto::simulation::{Contact, Standing};
use contrapposto_formats::{PoseLevelText, PoseScenario, PoseText, RelaxScenario};
use contrapposto_report::{Entry, Figure, List, Moments, Report, Table};

use super::figures::figures_of_postures;
use super::film::Frame;
use super::story::hardest;
use super::words::{fails_first, how_long, list, percent, plain, sentence, value};
use super::{Scene, shown, turn};
use crate::fail::Fail;
use crate::held::{Held, held};
use crate::pose::drawing::targets;
use crate::pose::{reached, tasks};

/// So many joints and directions are told of each posture.
const SHOWN: usize = 3;

/// The page of a solved pose.
pub(crate) fn report_of_pose(scenario: &PoseScenario, pose: &Pose, text: &PoseText) -> Result<String, Fail> {
    let model = &scenario.model;
    let Held { frame, holds } = held(model, &pose.posture, &scenario.loads, &scenario.supports)?;
    let frames = [frame];
    let supported = scenario.goals.iter().any(|goal| goal.hard);
    let scene = Scene {
        held: (!supported).then_some(scenario.loads.as_slice()),
        ..Scene::of(&scenario.title, model, scenario.start.values(), &frames, &scenario.supports)
    };
    let [frame] = &frames;
    let worst = (0..frame.load.len()).max_by(|&a, &b| frame.load[a].total_cmp(&frame.load[b]));
    let mut report = scene.report(Moments::Postures(vec!["the posture".to_owned()]), worst.unwrap_or(0))?;
    let turn = turn(model);
    report.targets = targets(scenario, pose)?.into_iter().map(|target| turn.point(target)).collect();
    let all: Vec<_> = tasks(text).collect();
    let done = all.iter().filter(|entries| reached(entries)).count();
    // What is asked of the rest of the body is left by as much as everything above it needs.
    let rest = |task: &str| task.starts_with("posture") || task.starts_with("effort");
    let missing = all.iter().filter(|entries| !reached(entries) && !rest(&entries[0].task));
    let missing: Vec<String> =
        missing.map(|entries| format!("{} by {}", plain_task(&entries[0].task), left(entries))).collect();
    report.headline = match (missing.is_empty(), done == all.len()) {
        (true, true) => "Everything is reached.".to_owned(),
        (true, false) => "All is reached; the rest of the body is as near to what is asked as that allows.".to_owned(),
        _ => format!("Not everything is reached: {}.", list(&missing)),
    };
    report.reasons = match pose.reason {
        Reason::Reached => vec![],
        Reason::Closest if missing.is_empty() => vec![],
        Reason::Closest => vec!["What is left is as near as the tasks above it allow.".to_owned()],
        Reason::Steps => vec!["The largest number of steps was made, and the body still moves.".to_owned()],
    };
    if !text.supports_hold {
        report.reasons.push("The supports do not stay where they are.".to_owned());
    }
    let free = !root_rates(model).is_empty();
    report.reasons.extend(if !holds {
        Some("Supports that only push cannot hold the body in this posture: it would fall; torques are those of a body that is held at its root besides.".to_owned())
    } else {
        let nothing = scenario.supports.is_empty() && free;
        nothing.then(|| "Where supports touch is not known, so torques are those of a body that is held at its root.".to_owned())
    });
    report.figures.push(figure("Tasks reached", format!("{done} of {}", all.len()), "supports among them"));
    figures_of(model, frame, &carriers(&scene), &mut report);
    let row = |entries: &&[PoseLevelText]| {
        let mark = if reached(entries) { "reached" } else { "as near as those above allow" };
        vec![entries[0].priority.to_string(), plain_task(&entries[0].task), left(entries), mark.to_owned()]
    };
    report.table = Table {
        heading: "What is left of the tasks, the most important first".to_owned(),
        columns: ["Priority", "Task", "What is left", ""].map(str::to_owned).to_vec(),
        rows: all.iter().map(row).collect(),
    };
    Ok(contrapposto_report::write(&report))
}

/// `--figures` of a solved pose.
pub(crate) fn figures_of_pose(scenario: &PoseScenario, pose: &Pose) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let held = held(&scenario.model, &pose.posture, &scenario.loads, &scenario.supports)?;
    figures_of_postures(&scenario.title, &scenario.model, &[held.frame], &["the posture".to_owned()])
}

/// `look_at head` is `look at head`, `point hand_r` is `point right hand`.
fn plain_task(task: &str) -> String {
    let words: Vec<String> =
        task.split(' ').map(|word| if word == "look_at" { "look at".to_owned() } else { plain(word) }).collect();
    words.join(" ")
}

/// `12.3 mm, 4.5°`; `nothing` where it is reached.
fn left(entries: &[PoseLevelText]) -> String {
    let text = |level: &PoseLevelText| match level.unit {
        "m" => format!("{:.1} mm", 1e3 * level.residual),
        "rad" => format!("{:.1}°", level.residual.to_degrees()),
        _ => format!("{} of strength", percent(level.residual)),
    };
    if reached(entries) { "nothing".to_owned() } else { entries.iter().map(text).collect::<Vec<_>>().join(", ") }
}

/// `--figures` of all postures of least effort.
pub(crate) fn figures_of_equilibria(
    scenario: &RelaxScenario,
    found: &Equilibria,
) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let frames = frames_of_postures(&scenario.model, &found.postures)?;
    figures_of_postures(&scenario.title, &scenario.model, &frames, &numbered(frames.len()))
}

fn frames_of_postures(model: &Model, postures: &[RelaxedPosture]) -> Result<Vec<Frame>, Fail> {
    postures.iter().map(|posture| frame_of_posture(model, posture)).collect()
}

/// `posture 1`, `posture 2`, ...
fn numbered(count: usize) -> Vec<String> {
    (1..=count).map(|number| format!("posture {number}")).collect()
}

/// The page of all postures of least effort.
pub(crate) fn report_of_equilibria(scenario: &RelaxScenario, found: &Equilibria) -> Result<String, Fail> {
    let model = &scenario.model;
    let frames = frames_of_postures(model, &found.postures)?;
    let scene = Scene::of(&scenario.title, model, scenario.start.values(), &frames, &scenario.supports);
    let shown = shown(model);
    let first = found.postures.first().map_or(0, speaking);
    let mut report = scene.report(Moments::Postures(numbered(frames.len())), first)?;
    let supports = carriers(&scene);
    let entry = |(frame, posture): (usize, &RelaxedPosture)| Entry {
        frame,
        joint: shown.iter().position(|&i| i == speaking(posture)).unwrap_or(0),
        text: told(model, posture, &frames[frame], &supports),
    };
    report.list = List {
        heading: "Postures of least effort".to_owned(),
        entries: found.postures.iter().enumerate().map(entry).collect(),
        none: String::new(),
    };
    let Some((best, frame)) = found.postures.first().zip(frames.first()) else {
        return Ok(contrapposto_report::write(&report));
    };
    let more = found.postures.get(1).map(|next| percent(next.relaxed.effort / best.relaxed.effort - 1.0));
    report.headline = match (found.postures.len(), &more) {
        (n, Some(more)) => {
            format!("{n} ways to rest: {} takes the least effort, the next {more} more.", hangs(model, best))
        }
        _ => format!("One way to rest: {}.", hangs(model, best)),
    };
    report.reasons.push(verdict(model, best));
    let mut searched = format!("{} starts were tried", found.starts);
    for (count, what) in
        [(found.fell, "fell"), (found.yielded, "kept tasks or supports less well than these and are left out")]
    {
        if count > 0 {
            searched += &format!(", {count} {what}");
        }
    }
    report.reasons.push(searched + ".");
    let note = more.map_or_else(|| "sum of squared loads".to_owned(), |more| format!("the next takes {more} more"));
    report.figures.push(figure("Least effort", format!("{:.4}", best.relaxed.effort), &note));
    figures_of(model, frame, &supports, &mut report);
    let row = |(i, (posture, frame)): (usize, (&RelaxedPosture, &Frame))| {
        let hardest = hardest(model, frame).map(|(name, load)| format!("{name}, {}", percent(load)));
        let effort = format!("{:.4}", posture.relaxed.effort);
        vec![(i + 1).to_string(), effort, weight(frame, &supports), held_by(posture), hardest.unwrap_or_default()]
    };
    report.table = Table {
        heading: "Side by side".to_owned(),
        columns: ["Posture", "Effort", "Weight on", "Held by", "Hardest worked"].map(str::to_owned).to_vec(),
        rows: found.postures.iter().zip(&frames).enumerate().map(row).collect(),
    };
    Ok(contrapposto_report::write(&report))
}

/// As it was found: contact forces and torques are not computed anew.
pub(crate) fn frame_of_posture(model: &Model, found: &RelaxedPosture) -> Result<Frame, Fail> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &found.relaxed.posture).map_err(|error| Fail::job("report", error))?;
    let contacts = found.supports.iter().map(|carried| Contact {
        force: carried.force,
        share: carried.share,
        center_of_pressure: carried.center_of_pressure,
        couple: nalgebra::Vector3::zeros(),
    });
    let standing = (!found.supports.is_empty()).then(|| Standing {
        contacts: contacts.collect(),
        center_of_mass: kinematics.center_of_mass(model).unwrap_or_default(),
        ..Standing::default()
    });
    let [external, passive] = &found.torques;
    Ok(Frame { standing, ..Frame::at(model, 0.0, found.relaxed.posture.values(), [external, passive]) })
}

/// The coordinate that says most of a posture: the one that hangs on its ligaments, else the hardest worked.
fn speaking(found: &RelaxedPosture) -> usize {
    let hanging = found.hanging.first().map(|hanging| hanging.coordinate);
    hanging.or_else(|| found.work.first().map(|work| work.coordinate)).unwrap_or(0)
}

/// `hanging on the ligaments of right hip adduction`.
fn hangs(model: &Model, found: &RelaxedPosture) -> String {
    match found.hanging.first() {
        Some(joint) => format!("hanging on the ligaments of {}", plain(&model.coordinates()[joint.coordinate].name)),
        None => "a posture without ligaments that carry".to_owned(),
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

fn verdict(model: &Model, found: &RelaxedPosture) -> String {
    match found.stability.equilibrium {
        None => "Its supports leave nothing free to move.".to_owned(),
        Some(Equilibrium::Stable(Carrier::Ligaments)) => {
            "Pushed, it comes back by itself: ligaments hold it.".to_owned()
        }
        Some(Equilibrium::Stable(Carrier::Gravity)) => {
            "Pushed, it comes back by itself: its weight holds it.".to_owned()
        }
        Some(Equilibrium::Unstable) => {
            let name = |&(i, _): &(usize, f64)| plain(&model.coordinates()[i].name);
            let direction = |direction: &Direction| {
                let joints: Vec<String> = direction.joints.iter().take(SHOWN).map(name).collect();
                let grows = direction.growth_time().map(|time| format!(" (a sway grows e-fold in {time:.2} s)"));
                format!("{}{}", list(&joints), grows.unwrap_or_default())
            };
            let worst: Vec<String> = found.stability.unstable().iter().take(1).map(direction).collect();
            format!("It does not stay by itself; what must be attended to most: {}.", worst.join(""))
        }
    }
}

fn told(model: &Model, found: &RelaxedPosture, frame: &Frame, supports: &[String]) -> String {
    let mut told = vec![format!("Effort {:.4}; weight on {}.", found.relaxed.effort, weight(frame, supports))];
    if supports.is_empty() {
        told = vec![format!("Effort {:.4}.", found.relaxed.effort)];
    }
    let hanging = found.hanging.iter().take(SHOWN).map(|joint| {
        let i = joint.coordinate;
        let at = value(model, i, frame.posture[i]);
        format!(
            "{} at {at} ({} of {:.1} N m)",
            plain(&model.coordinates()[i].name),
            percent(joint.share()),
            joint.external.abs()
        )
    });
    let hanging: Vec<String> = hanging.collect();
    told.push(if hanging.is_empty() {
        "No joint hangs on its ligaments.".to_owned()
    } else {
        format!("Hangs on ligaments: {}.", list(&hanging))
    });
    told.push(verdict(model, found));
    if let Some((name, load)) = hardest(model, frame) {
        told.push(format!("Works hardest: {name}, {}.", percent(load)));
    }
    told.push(match fails_first(model, frame) {
        Some((name, time)) => format!("Can be held: {}, then {name} gives up.", how_long(time)),
        None => "Can be held for ever, as far as muscles go.".to_owned(),
    });
    told.join(" ")
}

/// Names of what carries the body.
fn carriers(scene: &Scene<'_>) -> Vec<String> {
    scene.carried.iter().map(|&segment| plain(&scene.model.segments()[segment].name)).collect()
}

/// `right foot 85 %, left foot 15 %`.
fn weight(frame: &Frame, supports: &[String]) -> String {
    let contacts = frame.standing.iter().flat_map(|standing| &standing.contacts);
    let shares = contacts.zip(supports).map(|(contact, name)| format!("{name} {}", percent(contact.share)));
    shares.collect::<Vec<_>>().join(", ")
}

fn figure(label: &str, value: String, note: &str) -> Figure {
    Figure { label: label.to_owned(), value, note: note.to_owned() }
}

/// Who carries, and who works hardest.
fn figures_of(model: &Model, frame: &Frame, supports: &[String], report: &mut Report) {
    let contacts = frame.standing.iter().flat_map(|standing| &standing.contacts);
    for (contact, name) in contacts.zip(supports).take(4) {
        report.figures.push(figure(&format!("Weight on {name}"), percent(contact.share), ""));
    }
    if let Some((name, load)) = hardest(model, frame).filter(|(_, load)| *load > 0.0) {
        report.figures.push(figure("Hardest worked", percent(load), &sentence(&name)));
    }
    if let Some((name, time)) = fails_first(model, frame) {
        report.figures.push(figure("Can be held", how_long(time), &format!("then {name} gives up")));
    }
}
