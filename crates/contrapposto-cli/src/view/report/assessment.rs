//! The page of `assess`: a recorded motion, the muscle groups that fail, and relief.

use contrapposto::assessment::{Assessment, GroupAssessment, Instant, PeakKind, Proposal, RepeatedGroup};
use contrapposto::contact::Support;
use contrapposto::hybrid::Outcome;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::simulation::{Contact, Standing};
use contrapposto::statics::{Load, LoadKind};
use contrapposto::verdict::{Line, Verdict, VerdictKind};
use contrapposto_formats::tissue::SourcedModel;
use contrapposto_report::{Entry, Fact, Figure, List, Moments, Table};
use nalgebra::Vector3;

use super::page;
use crate::fail::Fail;
use crate::view::answer::{Answer, group_of_title};
use crate::view::cycles::CycleCurves;
use crate::view::decision::answer;
use crate::view::excerpt::MOST_FRAMES;
use crate::view::frame::Frame;
use crate::view::muscle_work::MusclesAtWork;
use crate::view::scene::Scene;
use crate::view::scene::hazard::hazards;
use crate::view::selection::shown;
use crate::view::stage::Stage;
use crate::view::text::assess::{after, times_from};
use crate::view::text::sources::StrengthAtText;
use crate::view::words::{MOST_ROWS, group, how_long, moment_in_words, percent, plain, sentence, value};

/// Moments of a motion, as many as a page shows.
pub(crate) struct AssessedFrames<'a> {
    opened: &'a SourcedModel,
    model: &'a Model,
    instants: usize,
    frames: Vec<Frame>,
    /// The greatest relative load so far, and its place in `frames` where only the load is the reason for it.
    hardest: (f64, Option<usize>),
    /// Segments that measured forces act on.
    pushed: Vec<usize>,
}

impl<'a> AssessedFrames<'a> {
    pub(crate) fn new(opened: &'a SourcedModel, instants: usize) -> Self {
        Self { opened, model: &opened.model, instants, frames: vec![], hardest: (0.0, None), pushed: vec![] }
    }

    /// Takes in an instant, if it is one of those that are shown or has the greatest load so far. `measured` adds the measured
    /// forces of the ground.
    pub(crate) fn record(&mut self, instant: &Instant, measured: impl FnOnce(&mut Vec<Load>)) {
        let stride = self.instants.div_ceil(MOST_FRAMES).max(1);
        let chosen = instant.index.is_multiple_of(stride) || instant.index + 1 == self.instants;
        let load = instant.load.iter().flatten().copied().fold(0.0, f64::max);
        if load > self.hardest.0 {
            if let (_, Some(before)) = self.hardest {
                self.frames.remove(before);
            }
            self.hardest = (load, (!chosen).then_some(self.frames.len()));
        } else if !chosen {
            return;
        }
        let mut frame = Frame::of_instant(instant.model, instant);
        frame.fatigue = Some(instant.fatigue.to_vec());
        let mut loads = vec![];
        measured(&mut loads);
        let with_next = loads.iter().zip(loads.iter().skip(1).map(Some).chain([None]));
        let contacts = with_next.filter_map(|(load, next)| self.contact(instant.torques.kinematics(), load, next));
        let (segments, contacts): (Vec<usize>, Vec<Contact>) = contacts.unzip();
        if !contacts.is_empty() {
            let center_of_mass = instant.torques.kinematics().center_of_mass(self.model).unwrap_or_default();
            frame.standing = Some(Standing { contacts, center_of_mass, ..Standing::default() });
            self.pushed = segments;
        }
        self.frames.push(frame);
    }

    /// A measured force, where it acts without the couple that follows it (but for its part about the upright axis).
    fn contact(&self, kinematics: &Kinematics, load: &Load, next: Option<&Load>) -> Option<(usize, Contact)> {
        let LoadKind::Force(force, _) = load.kind else { return None };
        let couple = match next.map(|next| next.kind) {
            Some(LoadKind::Couple(couple, _)) => couple,
            _ => Vector3::zeros(),
        };
        let weight = -self.model.mass() * self.model.gravity();
        let up = weight.try_normalize(0.0).unwrap_or_else(Vector3::y);
        let pushes = force.dot(&up);
        let share = if weight.norm() > 0.0 { pushes / weight.norm() } else { 0.0 };
        let at = kinematics.station(self.model, load.segment, load.point) + up.cross(&couple) / pushes;
        let center_of_pressure = (pushes > 0.0).then_some(at);
        Some((load.segment, Contact { force, share, center_of_pressure, couple: up * couple.dot(&up) }))
    }

    /// In the order of time.
    pub(crate) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The frame nearest to a time.
    fn nearest(&self, time: f64) -> usize {
        let after = self.frames.partition_point(|frame| frame.time < time).min(self.frames.len().saturating_sub(1));
        let before = after.saturating_sub(1);
        let away = |frame: usize| self.frames.get(frame).map_or(f64::INFINITY, |frame| (frame.time - time).abs());
        if away(before) <= away(after) { before } else { after }
    }
}

/// The page of an assessment, with the sentence that says that inertia counts, if it does. `held`: the loads at all times.
pub(crate) fn report_of_assessment(
    title: &str,
    (assessed_frames, muscles): (&AssessedFrames<'_>, Option<&MusclesAtWork<'_>>),
    (found, inertia, cycles): (&Assessment, Option<&str>, Option<&CycleCurves>),
    Answer { verdict, advice, .. }: &Answer,
    supports: &[Support],
    held: &[Load],
    warnings: &[String],
) -> Result<String, Fail> {
    let AssessedFrames { model, frames, .. } = assessed_frames;
    let Some((first, last)) = frames.first().zip(frames.last()) else {
        return Ok(contrapposto_report::write(&contrapposto_report::Report::default()));
    };
    let working: Vec<&GroupAssessment> = found.groups.iter().filter(|group| group.peak_load.value > 0.0).collect();
    let shown = shown(model);
    let moved = |i: &&usize| frames.iter().any(|frame| (frame.posture[**i] - first.posture[**i]).abs() > 1e-6);
    let alone = supports.is_empty() && assessed_frames.pushed.is_empty() && shown.iter().filter(moved).count() <= 1;
    let stage = Stage::still(supports, &[], held);
    let mut scene =
        Scene { held: alone.then_some(held), muscles, ..Scene::of(title, model, &first.posture, frames, stage) };
    scene.carried.extend(&assessed_frames.pushed);
    let times = frames.iter().map(|frame| frame.time).collect();
    let main = group_of_title(verdict).map(|group| group.coordinate).or(working.first().map(|group| group.coordinate));
    let mut report = scene.report(Moments::Times(times), main.unwrap_or(0))?;
    for group in &found.groups {
        let place = shown.iter().position(|&i| i == group.coordinate);
        let shown_group = place.and_then(|place| report.joints[place].groups.as_mut());
        if let Some(groups) = shown_group {
            // The chart shows one cycle of a motion that is repeated.
            groups[group.side.index()].fails = group.exhausted_at.filter(|_| group.repeated.is_none());
        }
    }
    report.cycles = cycles.map(|cycles| cycles.on_page(model));
    report.open = assessed_frames.nearest(moment(found, verdict));
    let span = last.time - first.time;
    super::answer(&mut report, verdict, advice);
    // Those of the page say how long, too.
    let hazards = hazards(model, frames, true);
    report.facts.retain(|fact| hazards.is_empty() || fact.name != Line::HAZARD);
    report.facts.extend(hazards.into_iter().map(|text| Fact { name: Line::HAZARD.to_owned(), text }));
    report.reasons.extend(warnings.iter().map(|warning| sentence(warning) + "."));
    report.reasons.extend(times_from(first.time).filter(|_| found.repetition.is_none()));
    let basis = inertia.map_or_else(|| "Each posture is treated as held at rest".to_owned(), sentence);
    report.reasons.push(format!("{basis}; loads are interpolated linearly between postures."));
    report.figures = figures(model, found, &working, format!("{} postures", assessed_frames.instants), span);
    report.list = List {
        heading: "Muscle groups that fail, and relief by one joint".to_owned(),
        entries: entries(assessed_frames, &working, &shown),
        none: "None: no group fails, and no joint alone gives relief.".to_owned(),
    };
    report.table = table(assessed_frames.opened, &working);
    Ok(page(model, report))
}

/// The time that the verdict is about, s.
fn moment(found: &Assessment, verdict: &Verdict) -> f64 {
    let hardest = found.groups.iter().max_by(|a, b| a.peak_load.value.total_cmp(&b.peak_load.value));
    let time = match verdict.kind {
        VerdictKind::HeldUntil if found.repetition.is_none() => {
            found.groups.iter().filter_map(|group| group.exhausted_at).min_by(f64::total_cmp)
        }
        VerdictKind::CannotStand => found.missing.map(|(_, time)| time),
        _ => hardest.map(|group| group.peak_load.time),
    };
    time.unwrap_or_default()
}

fn figures(
    model: &Model,
    found: &Assessment,
    working: &[&GroupAssessment],
    postures: String,
    span: f64,
) -> Vec<Figure> {
    let figure = |label: &str, value: String, note: String| Figure { label: label.to_owned(), value, note };
    let failed: Vec<f64> = found.groups.iter().filter_map(|group| group.exhausted_at).collect();
    let earliest = failed.first().map_or_else(String::new, |time| {
        let first = working.iter().find_map(|group| Some(group.repeated?.fails_at)).unwrap_or(*time);
        format!("the first at {}", how_long(first))
    });
    let mut figures =
        vec![figure("Muscle groups that fail", format!("{} of {}", failed.len(), working.len()), earliest)];
    // Of equals the first to fail.
    if let Some(tired) = working.iter().rev().max_by(|a, b| a.greatest_fatigue().total_cmp(&b.greatest_fatigue())) {
        figures.push(figure("Greatest fatigue", percent(tired.greatest_fatigue()), name(model, tired)));
    }
    if let Some(hard) = working.iter().max_by(|a, b| a.peak_load.value.total_cmp(&b.peak_load.value)) {
        let note = format!("{}, at {}", name(model, hard), moment_in_words(hard.peak_load.time));
        figures.push(figure("Greatest load", percent(hard.peak_load.value), note));
    }
    figures.push(figure("The motion lasts", how_long(span), postures));
    figures
}

fn table(opened: &SourcedModel, working: &[&GroupAssessment]) -> Table {
    let repeats = working.iter().any(|group| group.repeated.is_some());
    let row = |group: &&GroupAssessment| {
        let mut row = vec![
            name(&opened.model, group),
            percent(group.peak_load.value),
            moment_in_words(group.peak_load.time),
            StrengthAtText::new(opened, group).map(|strength| strength.words()).unwrap_or_default(),
            percent(group.fatigue),
        ];
        match group.repeated {
            Some(RepeatedGroup { duty, relief_at, fails_at, .. }) => {
                row.extend([percent(duty), after(Some(relief_at)), after(Some(fails_at))]);
            }
            None => row.push(
                group.exhausted_at.map_or_else(|| "holds".to_owned(), |time| format!("at\u{a0}{}", how_long(time))),
            ),
        }
        row
    };
    let of_repeats = if repeats { &["Duty cycle", "Asks for relief"][..] } else { &[] };
    let columns = ["Muscle group", "Peak load", "At", "Of a strength of", "Fatigue at the end"];
    let columns = columns.into_iter().chain(of_repeats.iter().copied()).chain(["Fails"]);
    Table {
        heading: if repeats { "Over all repeats" } else { "Over the whole motion" }.to_owned(),
        columns: columns.map(str::to_owned).collect(),
        rows: working.iter().take(MOST_ROWS).map(row).collect(),
    }
}

/// The times at which groups fail, then relief at their peaks.
fn entries(assessed_frames: &AssessedFrames<'_>, working: &[&GroupAssessment], shown: &[usize]) -> Vec<Entry> {
    let model = assessed_frames.model;
    let (mut failures, mut reliefs) = (vec![], vec![]);
    for found in working.iter().take(MOST_ROWS) {
        let Some(joint) = shown.iter().position(|&i| i == found.coordinate) else { continue };
        if let Some(time) = found.exhausted_at {
            let why = "it cannot give the torque that is needed.";
            // After so many repeats: no moment of the motion that is shown.
            let after = found.repeated.map(|repeated| format!(" after {} of repeats", how_long(repeated.fails_at)));
            let at = after.is_none().then_some(time);
            let text = format!("{} fails{}: {why}", name(model, found), after.unwrap_or_default());
            let frame = assessed_frames.nearest(at.unwrap_or(found.peak_load.time));
            failures.push(Entry { frame, time: at, joint: Some(joint), text });
        }
        if model.coordinates()[found.coordinate].kind != CoordinateKind::Rotation {
            continue;
        }
        for peak in found.proposals.chunk_by(|a, b| a.at == b.at) {
            let moves = |proposal: &Proposal| !matches!(proposal.decision.outcome, Outcome::Stay | Outcome::None);
            if peak.iter().any(moves) {
                reliefs.push(Entry {
                    frame: assessed_frames.nearest(peak[0].time),
                    time: Some(peak[0].time),
                    joint: Some(joint),
                    text: relief(model, found, peak),
                });
            }
        }
    }
    for part in [&mut failures, &mut reliefs] {
        part.sort_by(|a, b| a.time.unwrap_or_default().total_cmp(&b.time.unwrap_or_default()));
    }
    failures.extend(reliefs);
    failures
}

/// The proposals of both strategies at a peak; one where they agree.
fn relief(model: &Model, found: &GroupAssessment, peak: &[Proposal]) -> String {
    let i = found.coordinate;
    let what = match peak[0].at {
        PeakKind::Load => format!("greatest load, {} of its strength", percent(found.peak_load.value)),
        PeakKind::Fatigue => format!("greatest fatigue, {}", percent(found.peak_fatigue.value)),
    };
    let of_proposal = |proposal: &Proposal| {
        let goal = proposal.decision.goal.map(|goal| value(model, i, goal)).unwrap_or_default();
        answer(&proposal.decision, &value(model, i, proposal.angle), &goal)
    };
    let answers: Vec<String> = peak.iter().map(of_proposal).collect();
    let agree = answers.iter().all(|answer| *answer == answers[0]);
    let relief = match answers.as_slice() {
        [active, passive] if !agree => format!("Active strategy: {active} Passive strategy: {passive}"),
        answers => sentence(&answers[0]),
    };
    format!("{}: {what}. If only {} moved: {}", name(model, found), plain(&model.coordinates()[i].name), lower(&relief))
}

/// `Right elbow flexion`: the group.
fn name(model: &Model, found: &GroupAssessment) -> String {
    let coordinate = &model.coordinates()[found.coordinate];
    let name = coordinate.groups.as_ref().map(|groups| group(&groups[found.side.index()].name, &coordinate.name));
    sentence(&name.unwrap_or_default())
}

/// The first letter small.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}
