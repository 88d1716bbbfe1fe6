//! The answer to a posture that muscles hold, as JSON and in words.

use std::fmt::Write;

use contrapposto::fatigue::REST_LOAD;
use contrapposto::joint_torques::MuscleShare;
use contrapposto::model::{Model, Side};
use contrapposto::muscle::{CoupledStrength, Muscle, MuscleFatigue, MuscleHold};
use serde::Serialize;

use super::group::GroupName;
use super::{Named, plain_table};
use crate::fail::Fail;
use crate::output::json_text;
use crate::view::words::{MOST_JOINTS_SHOWN, MOST_ROWS, group, how_long, list, percent, share_in_words};

/// Fatigue from which a group is at its limit: the instant of failure is known to 1e-7 s.
const AT_LIMIT: f64 = 1.0 - 1e-5;
/// Least growth of a load of which the text tells as help.
const LEAST_HELP: f64 = 0.005;

/// A posture that muscles held.
pub(crate) struct HeldPosture {
    /// Time, s.
    pub(crate) asked: f64,
    pub(crate) end: MuscleHold,
    pub(crate) share: MuscleShare,
    /// Strength of rested muscles about each rate, and that at the end.
    pub(crate) rested: Vec<CoupledStrength>,
    pub(crate) tired: Vec<CoupledStrength>,
    /// Fatigue at the end of the positive and the negative group of each rate.
    pub(crate) groups: Vec<[f64; 2]>,
    pub(crate) muscles: Vec<HeldMuscle>,
    /// The group that fails first by the law of its joint, of joints whose strength muscles give, and of all others.
    pub(crate) joint_law: Option<JointLimit>,
    pub(crate) without_muscles: Option<JointLimit>,
}

/// The course of a muscle.
pub(crate) struct HeldMuscle {
    name: String,
    /// Activation at the start, at the first exhaustion of a muscle, and at the end.
    start: f64,
    pub(crate) before_help: f64,
    end: f64,
    fatigued: f64,
    /// Time at which it first gave all that it had, s.
    pub(crate) exhausted: Option<f64>,
}

/// A group that fails by the law of its joint.
#[derive(Clone, Copy)]
pub(crate) struct JointLimit {
    pub(crate) coordinate: usize,
    pub(crate) side: Side,
    pub(crate) load: f64,
    /// Infinite where it never does.
    pub(crate) seconds: f64,
}

impl HeldMuscle {
    pub(crate) fn new(muscle: &Muscle) -> Self {
        let name = muscle.spec().name.clone();
        Self { name, start: 0.0, before_help: 0.0, end: 0.0, fatigued: 0.0, exhausted: None }
    }

    /// Takes the state of muscle `i` at a time, s.
    pub(crate) fn record(&mut self, i: usize, time: f64, now: &MuscleFatigue) {
        self.end = now.loads()[i];
        self.fatigued = now.states()[i].fatigued;
        if time == 0.0 {
            (self.start, self.before_help) = (self.end, self.end);
        }
        if self.exhausted.is_none() && now.is_exhausted(i) {
            self.exhausted = Some(time);
        }
    }

    /// Growth of the load since the first exhaustion.
    fn help(&self) -> f64 {
        self.end - self.before_help
    }
}

impl JointLimit {
    /// The first to fail, and of those that fail together the one with the greatest load.
    pub(crate) fn first(all: impl Iterator<Item = Self>) -> Option<Self> {
        let order = |a: &Self, b: &Self| a.seconds.total_cmp(&b.seconds).then(b.load.total_cmp(&a.load));
        all.filter(|limit| limit.load > 0.0).min_by(order)
    }

    fn group(&self, model: &Model) -> String {
        group_name(model, self.coordinate, self.side)
    }
}

impl HeldPosture {
    /// Time for which all hold, s.
    fn seconds(&self) -> f64 {
        self.without_muscles.map_or(f64::INFINITY, |limit| limit.seconds).min(self.end.seconds)
    }

    /// Whether all hold for the asked time.
    pub(crate) fn is_held(&self) -> bool {
        !self.end.failed && self.seconds() >= self.asked
    }

    /// The group of a rate that its torque asks for.
    fn asked_of(&self, model: &Model, k: usize) -> Option<(usize, Side)> {
        Some((model.rates()[self.share.rates[k]].coordinate?, Side::of(self.share.torques[k])))
    }

    /// The groups at their limit when the muscles fail, those with the largest share in it first: also those that fail at the same time.
    fn failed(&self) -> Vec<usize> {
        let shares = &self.end.limit.of_torques;
        let also = |k: usize| {
            let side = Side::of(self.share.torques[k]).index();
            let works = self.share.torques[k].abs() > REST_LOAD * self.rested[k].torque[side].abs();
            works && self.end.limit.times >= AT_LIMIT && self.groups[k][side] >= AT_LIMIT
        };
        let at_limit = |k: &usize| self.end.failed && (shares[*k] > LEAST_HELP || also(*k));
        let mut failed: Vec<usize> = (0..shares.len()).filter(at_limit).collect();
        failed.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
        failed
    }

    /// The muscles that limit these groups, by their shares.
    fn limiting(&self) -> Vec<usize> {
        let shares = &self.end.limit.of_muscles;
        let mut limiting: Vec<usize> =
            (0..shares.len()).filter(|&m| self.end.failed && shares[m] > LEAST_HELP).collect();
        limiting.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
        limiting
    }
}

fn group_name(model: &Model, coordinate: usize, side: Side) -> String {
    let of = &model.coordinates()[coordinate];
    of.groups.as_ref().map_or_else(|| of.name.clone(), |groups| group(&groups[side.index()].name, &of.name))
}

#[derive(Serialize)]
struct HoldText<'a> {
    asked_s: f64,
    /// Time for which muscles, and joints whose strength they do not give, hold.
    held_s: f64,
    held: bool,
    muscles_held_s: f64,
    muscles_failed: bool,
    /// Multiple of the asked torques that the muscles can still give at the end.
    torque_limit: f64,
    /// Groups at their limit when the muscles fail, the worst first.
    failed_groups: Vec<FailedText>,
    /// Muscles that limit them.
    failed_muscles: Vec<&'a str>,
    muscles: Named<'a, MuscleText>,
    groups: Vec<GroupText>,
    /// By the law of each joint, with the plain sum of its muscles as strength.
    joint_law: Option<JointLimitText>,
    /// The same of joints whose strength muscles do not give.
    without_muscles: Option<JointLimitText>,
}

#[derive(Serialize)]
struct FailedText {
    #[serde(flatten)]
    group: Option<GroupName>,
    /// Share of this torque in the limit of all.
    share: f64,
}

#[derive(Serialize)]
struct MuscleText {
    works_for: Option<GroupName>,
    force_n: f64,
    load_start: f64,
    load_at_first_exhaustion: f64,
    load_end: f64,
    fatigued_end: f64,
    exhausted_s: Option<f64>,
    share_of_limit: f64,
}

#[derive(Serialize)]
struct GroupText {
    #[serde(flatten)]
    group: Option<GroupName>,
    asked_nm: f64,
    /// While the muscles give all other torques: rested, and at the end.
    strength_rested_nm: f64,
    strength_end_nm: f64,
    fatigue_end: f64,
}

#[derive(Serialize)]
struct JointLimitText {
    #[serde(flatten)]
    group: GroupName,
    load: f64,
    /// None where it never fails.
    held_s: Option<f64>,
}

pub(crate) fn json(model: &Model, held: &HeldPosture) -> Result<String, Fail> {
    let name = |of: Option<(usize, Side)>| of.map(|(coordinate, side)| GroupName::new(model, coordinate, side));
    let limit = |limit: &JointLimit| JointLimitText {
        group: GroupName::new(model, limit.coordinate, limit.side),
        load: limit.load,
        held_s: Some(limit.seconds).filter(|seconds| seconds.is_finite()),
    };
    let muscle = |(m, of): (usize, &HeldMuscle)| MuscleText {
        works_for: name(held.share.works_for[m]),
        force_n: held.share.forces[m],
        load_start: of.start,
        load_at_first_exhaustion: of.before_help,
        load_end: of.end,
        fatigued_end: of.fatigued,
        exhausted_s: of.exhausted,
        share_of_limit: held.end.limit.of_muscles[m],
    };
    let of_group = |k: usize| {
        let (side, torque) = (Side::of(held.share.torques[k]).index(), held.share.torques[k]);
        let [rested, tired] = [&held.rested, &held.tired].map(|of| of[k].torque[side].abs());
        GroupText {
            group: name(held.asked_of(model, k)),
            asked_nm: torque.abs(),
            strength_rested_nm: rested,
            strength_end_nm: tired,
            fatigue_end: held.groups[k][side],
        }
    };
    let failed = |k: usize| FailedText { group: name(held.asked_of(model, k)), share: held.end.limit.of_torques[k] };
    let text = HoldText {
        asked_s: held.asked,
        held_s: held.seconds(),
        held: held.is_held(),
        muscles_held_s: held.end.seconds,
        muscles_failed: held.end.failed,
        torque_limit: held.end.limit.times,
        failed_groups: held.failed().into_iter().map(failed).collect(),
        failed_muscles: held.limiting().into_iter().map(|m| held.muscles[m].name.as_str()).collect(),
        muscles: Named(
            held.muscles.iter().enumerate().map(|(m, of)| (held.muscles[m].name.as_str(), muscle((m, of)))).collect(),
        ),
        groups: (0..held.share.rates.len()).map(of_group).collect(),
        joint_law: held.joint_law.as_ref().map(limit),
        without_muscles: held.without_muscles.as_ref().map(limit),
    };
    json_text("JSON", &text)
}

pub(crate) fn readable(model: &Model, held: &HeldPosture) -> String {
    let mut text = answer(model, held) + "\n\n";
    let _ = writeln!(text, "{}", who_takes_over(held));
    if let Some(limit) = &held.joint_law {
        let time = if limit.seconds.is_finite() { how_long(limit.seconds) } else { "no limit".to_owned() };
        let _ = writeln!(
            text,
            "By the law of each joint, with the plain sum of its muscles as strength: {time} ({}, load {}).",
            limit.group(model),
            percent(limit.load)
        );
    }
    if let Some(limit) = held.without_muscles.as_ref().filter(|limit| limit.seconds.is_finite()) {
        let _ = writeln!(
            text,
            "Of joints whose strength the muscles do not give, {} fails first by its law, after {}.",
            limit.group(model),
            how_long(limit.seconds)
        );
    }
    text + "\n" + &tables(model, held)
}

/// The first line.
fn answer(model: &Model, held: &HeldPosture) -> String {
    let asked = how_long(held.asked);
    if held.is_held() {
        return format!("The muscles hold this posture for {asked}.");
    }
    if let Some(limit) = held.without_muscles.filter(|limit| limit.seconds < held.end.seconds) {
        let (time, group) = (how_long(limit.seconds), limit.group(model));
        let until = if held.end.failed { "longer than that" } else { "to the end" };
        return format!(
            "Held for {time} of {asked}: {group}, which is judged by its joint, fails; the muscles hold {until}."
        );
    }
    let failed = held.failed();
    let name = |&k: &usize| held.asked_of(model, k).map_or_else(String::new, |(i, side)| group_name(model, i, side));
    let groups = list(&failed.iter().take(MOST_JOINTS_SHOWN).map(name).collect::<Vec<_>>());
    let more = failed.len().saturating_sub(MOST_JOINTS_SHOWN);
    let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
    let one = failed.len() == 1;
    let muscles: Vec<String> =
        held.limiting().into_iter().take(MOST_JOINTS_SHOWN).map(|m| held.muscles[m].name.clone()).collect();
    if held.end.seconds == 0.0 {
        let most = share_in_words(held.end.limit.times);
        let lack = if one { "lacks" } else { "lack" };
        return format!(
            "The muscles cannot hold this posture: they give {most} of its torques at most, and {groups}{more} {lack} the rest."
        );
    }
    let time = how_long(held.end.seconds);
    let fail = if one { "fails" } else { "fail" };
    let muscles = list(&muscles);
    format!("The muscles hold this posture for {time} of {asked}: {groups}{more} {fail}, with {muscles} exhausted.")
}

/// The muscle that is exhausted first, and the others that help.
fn who_takes_over(held: &HeldPosture) -> String {
    let exhausted = held.muscles.iter().filter_map(|muscle| Some((muscle.exhausted?, muscle)));
    let Some((time, first)) = exhausted.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return "No muscle is exhausted.".to_owned();
    };
    let mut text = if time == 0.0 {
        format!("From the start {} gives all that it has.", first.name)
    } else {
        format!("First exhausted: {}, after {}.", first.name, how_long(time))
    };
    let mut helping: Vec<&HeldMuscle> = held.muscles.iter().filter(|muscle| muscle.help() > LEAST_HELP).collect();
    helping.sort_by(|a, b| b.help().total_cmp(&a.help()));
    let most = helping.iter().take(MOST_ROWS / 2);
    let words = |muscle: &&HeldMuscle| {
        format!("{} (load {} to {})", muscle.name, percent(muscle.before_help), percent(muscle.end))
    };
    let more = helping.len().saturating_sub(MOST_ROWS / 2);
    if helping.is_empty() {
        text += " No other muscle takes over more than a trace.";
    } else {
        let names: Vec<String> = most.map(words).collect();
        let more = if more > 0 { format!("; and {more} more") } else { String::new() };
        let _ = write!(text, " Then take over: {}{more}.", names.join(", "));
    }
    text
}

/// The hardest-worked muscles, and the most tired groups.
fn tables(model: &Model, held: &HeldPosture) -> String {
    let mut table = plain_table();
    table.set_header(["muscle", "works for", "load at start", "at the end", "fatigued", "exhausted after"]);
    let mut order: Vec<usize> = (0..held.muscles.len()).filter(|&m| held.muscles[m].end > 0.0).collect();
    order.sort_by(|&a, &b| held.muscles[b].end.total_cmp(&held.muscles[a].end));
    for &m in order.iter().take(MOST_ROWS) {
        let of = &held.muscles[m];
        let works_for = held.share.works_for[m].map_or_else(String::new, |(i, side)| group_name(model, i, side));
        table.add_row([
            of.name.clone(),
            works_for,
            percent(of.start),
            percent(of.end),
            percent(of.fatigued),
            of.exhausted.map_or_else(String::new, how_long),
        ]);
    }
    let mut groups = plain_table();
    groups.set_header(["muscle group", "asked, N m", "rested, N m", "at the end, N m", "fatigue"]);
    let side = |k: usize| Side::of(held.share.torques[k]).index();
    let mut order: Vec<usize> = (0..held.groups.len()).collect();
    order.sort_by(|&a, &b| held.groups[b][side(b)].total_cmp(&held.groups[a][side(a)]));
    for &k in order.iter().take(MOST_ROWS) {
        let name = held.asked_of(model, k).map_or_else(String::new, |(i, side)| group_name(model, i, side));
        let strength = |of: &[CoupledStrength]| format!("{:.1}", of[k].torque[side(k)].abs());
        let asked = format!("{:.1}", held.share.torques[k].abs());
        let fatigue = format!("{:.2}", held.groups[k][side(k)]);
        groups.add_row([name, asked, strength(&held.rested), strength(&held.tired), fatigue]);
    }
    format!("{table}\n\n{groups}\n")
}
