//! `compare.json`, and the terminal tables of postures side by side. Bodies are compared by names of coordinates and muscle groups.

use std::collections::BTreeMap;

use contrapposto::contact::Support;
use contrapposto::joint_torques::JointMuscles;
use contrapposto::model::{Coordinate, CoordinateKind, Model, Side};
use contrapposto::statics::Load;
use contrapposto::verdict::{Verdict, VerdictKind};
use contrapposto_formats::{Thing, VerdictText};
use serde::Serialize;

use super::group::GroupName;
use super::plain_table;
use crate::view::axes::pelvis_list;
use crate::view::frame::Frame;
use crate::view::words::{MOST_ROWS, group as group_in_words, how_long, plain, shares_of_all};

/// Least differences, as shares of strength and in degrees, that have a line.
const SAME: f64 = 5e-4;
const SAME_ANGLE: f64 = 0.05;

/// A scenario carried out.
pub(crate) struct ComparedPosture {
    /// `A`, `B` and so on.
    pub(crate) letter: char,
    pub(crate) file: String,
    pub(crate) title: String,
    /// Origin of the posture: `simulated, 120 s`, `posed`.
    pub(crate) how: String,
    pub(crate) verdict: Verdict,
    pub(crate) model: Model,
    /// Muscles that give joints passive torque or strength.
    pub(crate) muscles: Option<JointMuscles>,
    pub(crate) supports: Vec<Support>,
    /// Things around the body and in its hands.
    pub(crate) things: Vec<Thing>,
    /// Loads in force.
    pub(crate) loads: Vec<Load>,
    /// Value of every coordinate.
    pub(crate) posture: Vec<f64>,
    /// Torques and loads; `None` where the supports cannot hold the posture.
    pub(crate) frame: Option<Frame>,
}

impl ComparedPosture {
    /// Whether muscles share torques of joints.
    pub(crate) fn shares(&self) -> bool {
        self.muscles.as_ref().is_some_and(|muscles| !muscles.strong().is_empty())
    }
}

/// The whole file.
#[derive(Serialize)]
pub(crate) struct CompareText {
    /// The answer: who can go on longest.
    pub(crate) sentence: String,
    postures: Vec<ComparedPostureText>,
    /// Muscle groups that all bodies have, those that differ most first.
    groups: Vec<GroupDifferenceText>,
    /// Coordinates that all bodies have, those that differ most first.
    coordinates: Vec<CoordinateDifferenceText>,
    /// Coordinates that some body does not have.
    not_in_all: Vec<String>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct ComparedPostureText {
    file: String,
    title: String,
    model: String,
    verdict: VerdictText,
    /// `simulated, 120 s`, or `posed`.
    how: String,
    /// Sum of (active torque / strength)^2; `null` where the supports cannot hold it.
    effort: Option<f64>,
    supports: Vec<SupportShareText>,
    /// Angle by which the pelvis hangs down to its right.
    pelvis_list_deg: Option<f64>,
    /// rad, m, components of quaternions.
    coordinates: BTreeMap<String, f64>,
}

#[derive(Serialize)]
struct SupportShareText {
    segment: String,
    /// Of the weight of the body.
    share: Option<f64>,
}

/// A muscle group; numbers by posture.
#[derive(Serialize)]
struct GroupDifferenceText {
    #[serde(flatten)]
    name: GroupName,
    /// Active torque over strength.
    relative_load: Vec<Option<f64>>,
    /// The torque that ligaments carry instead, over its strength.
    on_ligaments: Vec<Option<f64>>,
    difference: f64,
}

/// A coordinate; its values by posture.
#[derive(Serialize)]
struct CoordinateDifferenceText {
    coordinate: String,
    unit: &'static str,
    value: Vec<f64>,
    difference: f64,
}

impl CompareText {
    pub(crate) fn new(postures: &[ComparedPosture], files: Vec<String>) -> Self {
        let mut text = Self {
            sentence: answer(postures),
            postures: postures.iter().map(ComparedPostureText::new).collect(),
            groups: vec![],
            coordinates: vec![],
            not_in_all: vec![],
            files,
        };
        for (s, stance) in postures.iter().enumerate() {
            for coordinate in stance.model.coordinates() {
                let same = |other: &ComparedPosture| {
                    let i = other.model.coordinate(&coordinate.name)?;
                    (other.model.coordinates()[i].kind == coordinate.kind).then_some(i)
                };
                let places: Option<Vec<usize>> = postures.iter().map(same).collect();
                match places {
                    Some(places) if s == 0 => text.take(postures, coordinate, &places),
                    None if !text.not_in_all.contains(&coordinate.name) => {
                        text.not_in_all.push(coordinate.name.clone());
                    }
                    _ => {}
                }
            }
        }
        // Of equals the first in the body.
        text.groups.sort_by(|a, b| b.difference.total_cmp(&a.difference));
        let weight =
            |c: &CoordinateDifferenceText| if c.unit == "rad" { c.difference.to_degrees() } else { 1e3 * c.difference };
        text.coordinates.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
        text
    }

    /// A coordinate that all have, `places` of it.
    fn take(&mut self, postures: &[ComparedPosture], coordinate: &Coordinate, places: &[usize]) {
        let value: Vec<f64> = postures.iter().zip(places).map(|(stance, &i)| stance.posture[i]).collect();
        let unit = match coordinate.kind {
            CoordinateKind::Rotation => "rad",
            CoordinateKind::Translation => "m",
            CoordinateKind::Quaternion => "1",
        };
        let difference = spread(value.iter().copied());
        self.coordinates.push(CoordinateDifferenceText {
            coordinate: coordinate.name.clone(),
            unit,
            value,
            difference,
        });
        if postures.iter().zip(places).any(|(stance, &i)| stance.model.coordinates()[i].groups.is_none()) {
            return;
        }
        for side in Side::BOTH {
            let numbers = postures.iter().zip(places).map(|(stance, &i)| work(stance, i, side));
            let (relative_load, on_ligaments): (Vec<_>, Vec<_>) = numbers.map(Option::unzip).unzip();
            let difference = [&relative_load, &on_ligaments].map(|list| spread(list.iter().flatten().copied()));
            self.groups.push(GroupDifferenceText {
                name: GroupName::new(&postures[0].model, places[0], side),
                relative_load,
                on_ligaments,
                difference: difference[0].max(difference[1]),
            });
        }
    }
}

/// Load of a group, and the torque that ligaments carry instead, as shares of its strength.
fn work(stance: &ComparedPosture, i: usize, side: Side) -> Option<(f64, f64)> {
    let frame = stance.frame.as_ref()?;
    let group = &stance.model.coordinates()[i].groups.as_ref()?[side.index()];
    let load = if Side::of(frame.active(i)) == side { frame.load[i] } else { 0.0 };
    let (external, passive) = (frame.external[i], frame.passive[i]);
    let carried = (-passive * external.signum()).clamp(0.0, external.abs());
    let strength = group.strength.torque(frame.angles[i]);
    let spared = Side::of(-external) == side && strength > 0.0;
    Some((load, if spared { carried / strength } else { 0.0 }))
}

/// Largest minus smallest; 0 without values.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    (high - low).max(0.0)
}

impl ComparedPostureText {
    /// The share of the weight of body and loads on the first support of a segment.
    fn carried_by(&self, segment: &str) -> Option<f64> {
        let of_body: Vec<f64> = self.supports.iter().filter_map(|support| support.share).collect();
        let support = self.supports.iter().position(|support| support.segment == segment)?;
        (of_body.len() == self.supports.len()).then(|| shares_of_all(&of_body)[support])
    }

    fn new(stance: &ComparedPosture) -> Self {
        let contacts =
            stance.frame.as_ref().and_then(|frame| frame.standing.as_ref()).map(|standing| &standing.contacts);
        let share = |(i, support): (usize, &Support)| SupportShareText {
            segment: stance.model.segments()[support.segment].name.clone(),
            share: contacts.and_then(|contacts| contacts.get(i)).map(|contact| contact.share),
        };
        let names = stance.model.coordinates().iter().map(|coordinate| coordinate.name.clone());
        Self {
            file: stance.file.clone(),
            title: stance.title.clone(),
            model: stance.model.name().to_owned(),
            verdict: VerdictText::new(&stance.model, &stance.verdict),
            how: stance.how.clone(),
            effort: stance.frame.as_ref().map(Frame::effort),
            supports: stance.supports.iter().enumerate().map(share).collect(),
            pelvis_list_deg: pelvis_list(&stance.model, &stance.posture),
            coordinates: names.zip(stance.posture.iter().copied()).collect(),
        }
    }
}

/// `The easiest first: B holds through 5.0 min, 33 min in all, hardest worked at 9 %; A can be held 12 min.`
fn answer(postures: &[ComparedPosture]) -> String {
    let seconds = |stance: &ComparedPosture| match stance.verdict.kind {
        VerdictKind::Holds | VerdictKind::HeldUntil => stance.verdict.seconds.unwrap_or(f64::INFINITY),
        _ => f64::NEG_INFINITY,
    };
    let said = |stance: &ComparedPosture| match stance.verdict.kind {
        VerdictKind::CannotBeDone => "cannot be done".to_owned(),
        VerdictKind::CannotStand => "cannot stand".to_owned(),
        VerdictKind::NotReached => "does not reach its target".to_owned(),
        VerdictKind::HeldUntil => format!("can be held {}", stance.verdict.seconds.map(how_long).unwrap_or_default()),
        VerdictKind::Holds => match stance.verdict.asked {
            Some(asked) => {
                let load = stance.verdict.hardest.map_or(0.0, |group| group.load);
                let all = stance.verdict.seconds.map(how_long);
                let all = all.map_or_else(|| " without a limit".to_owned(), |all| format!(", {all} in all"));
                format!("holds through {}{all}, hardest worked at {:.0} %", how_long(asked), 100.0 * load)
            }
            None => "holds without a limit by muscles".to_owned(),
        },
    };
    let mut order: Vec<&ComparedPosture> = postures.iter().collect();
    // Of two that hold, the one whose hardest worked group works less.
    let load = |stance: &ComparedPosture| stance.verdict.hardest.map_or(0.0, |group| group.load);
    order.sort_by(|a, b| seconds(b).total_cmp(&seconds(a)).then(load(a).total_cmp(&load(b))));
    let list: Vec<String> = order.iter().map(|stance| format!("{} {}", stance.letter, said(stance))).collect();
    format!("The easiest first: {}.", list.join("; "))
}

/// The table for readers.
pub(crate) fn report(postures: &[ComparedPosture], text: &CompareText) -> String {
    let mut out = format!("{}\n", text.sentence);
    for (stance, posture) in postures.iter().zip(&text.postures) {
        let sentence = &stance.verdict.sentence;
        out += &format!("{}: {} ({}, {})\n   {sentence}\n", stance.letter, stance.title, posture.file, stance.how);
    }
    out += &format!("\n{}\n", whole(postures, text));
    let letters = |what: &str| postures.iter().map(|s| format!("{what} {}", s.letter)).collect::<Vec<_>>();
    let groups: Vec<&GroupDifferenceText> =
        text.groups.iter().filter(|g| g.difference >= SAME).take(MOST_ROWS).collect();
    if !groups.is_empty() {
        let mut table = plain_table();
        table.set_header([vec!["muscle group".to_owned()], letters("load"), letters("ligaments")].concat());
        for group in groups {
            let name = group_in_words(&group.name.group, &group.name.coordinate);
            let numbers = group.relative_load.iter().chain(&group.on_ligaments).map(|value| percent(*value));
            table.add_row(std::iter::once(name).chain(numbers));
        }
        out += &format!(
            "\nMuscle groups that differ most: their load, and the torque that ligaments carry instead, as shares of strength\n{table}\n"
        );
    }
    let angles = |c: &&CoordinateDifferenceText| c.unit == "rad" && c.difference.to_degrees() >= SAME_ANGLE;
    let angles: Vec<&CoordinateDifferenceText> = text.coordinates.iter().filter(angles).take(MOST_ROWS).collect();
    if !angles.is_empty() {
        let mut table = plain_table();
        table.set_header([vec!["angle, deg".to_owned()], letters("in"), vec!["difference".to_owned()]].concat());
        for coordinate in angles {
            let values =
                coordinate.value.iter().chain([&coordinate.difference]).map(|value| number(value.to_degrees()));
            table.add_row(std::iter::once(plain(&coordinate.coordinate)).chain(values));
        }
        out += &format!("\nAngles that differ most\n{table}\n");
    }
    if let Some((first, rest)) = text.not_in_all.split_first() {
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        out += &format!("\nnot compared, because not all bodies have it: {first}{more}\n");
    }
    out + "\n"
}

/// Effort, shares and pelvis.
fn whole(postures: &[ComparedPosture], text: &CompareText) -> comfy_table::Table {
    let mut table = plain_table();
    table.set_header(std::iter::once(String::new()).chain(postures.iter().map(|stance| stance.letter.to_string())));
    let mut row = |label: String, cell: &dyn Fn(&ComparedPostureText) -> String| {
        table.add_row(std::iter::once(label).chain(text.postures.iter().map(cell)));
    };
    let known = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    row("effort of all muscles".to_owned(), &|posture| known(posture.effort.map(|effort| format!("{effort:.4}"))));
    let mut named: Vec<&str> = vec![];
    for share in text.postures.iter().flat_map(|posture| &posture.supports) {
        if !named.contains(&share.segment.as_str()) {
            named.push(&share.segment);
        }
    }
    for segment in named {
        row(format!("weight on {}", plain(segment)), &|posture| percent(posture.carried_by(segment)));
    }
    if text.postures.iter().any(|posture| posture.pelvis_list_deg.is_some()) {
        row("pelvis drops".to_owned(), &|posture| {
            known(posture.pelvis_list_deg.map(|list| match number(list.abs()).as_str() {
                "0.0" => "level".to_owned(),
                angle => format!("{angle} deg {}", if list > 0.0 { "right" } else { "left" }),
            }))
        });
    }
    table
}

/// One decimal, without the sign of -0.
fn number(value: f64) -> String {
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_owned() } else { text }
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}
