//! `contrapposto assess`: the muscle group that fails first in a recorded motion, its time, and its relief.

mod repeats;
mod support_doubts;
mod warnings;

use std::path::Path;

use contrapposto::assessment::assess as assessed;
use contrapposto::assessment::{ANGLE_ERROR, AssessError, AssessSettings, Assessment, FAST_SHARE, Instant};
use contrapposto::contact::Support;
use contrapposto::joint_torques::JointMuscles;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model, Side};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::suggestions::{Advice, Change, Job, Trial, Worked, changes, with_breaks, with_breaks_in_repeats};
use contrapposto::verdict::Verdict;
use contrapposto_formats::loads::{GroundReaction, no_segment, patch};
use contrapposto_formats::motion::write_sto;
use contrapposto_formats::tissue::{SourcedModel, fatigue_notes};
use nalgebra::Vector3;

use self::repeats::ends_apart;
use self::support_doubts::support_doubts;
use self::warnings::{WHAT_CARRIES, warnings};
use crate::args::{AssessArgs, SuggestArgs};
use crate::fail::Fail;
use crate::model_file::open_with_muscles;
use crate::motion_file::{loads_of, note_values_out_of_range, read_whole_motion};
use crate::moving::{Recorded, keep_overlap};
use crate::output::{ResultSet, json_text, print, print_note};
use crate::view::animation;
use crate::view::answer::{Answer, answered};
use crate::view::figures::figures_of_assessment;
use crate::view::report::assessment::{AssessedFrames, report_of_assessment};
use crate::view::stage::Stage;
use crate::view::text::assess::{AssessText, report};
use crate::view::text::torques::{Columns, header, row};
use crate::view::torque_rows::{Frame, Order};

const ASSESS_FILES: [&str; 5] = ["assess.json", "torques.sto", "fatigue.sto", "report.html", "motion.glb"];
/// Friction of a support: shoe on floor, as in scenarios.
const FRICTION: f64 = 0.6;

/// The motion and its loads, checked.
struct Given {
    /// Times (s) and postures.
    motion: Vec<(f64, Posture)>,
    /// Loads at all times.
    held: Vec<Load>,
    ground: Option<GroundReaction>,
    settings: AssessSettings,
    /// The sentence that says that inertia counts.
    said: Option<String>,
    /// Reasons to doubt the motion.
    warnings: Vec<String>,
    /// Folder that takes the results.
    folder: Option<ResultSet>,
}

pub(crate) fn assess(args: &AssessArgs) -> Result<(), Fail> {
    if args.model.model == Path::new("-") && args.motion == Path::new("-") {
        return Err(Fail::Refused("standard input is one file: MODEL or MOTION, not both".to_owned()));
    }
    let (mut opened, muscles, of_muscles) = open(args)?;
    let Given { motion, held, ground, settings, said, warnings: doubts, folder } = given(args, &mut opened, muscles)?;
    let model = &opened.model;

    let mut tables = Tables::new(model, motion.len(), said.as_deref());
    let mut assessed_frames = args.out.as_ref().map(|_| AssessedFrames::new(&opened, motion.len()));
    let whole = Motion { model, motion: &motion, held: &held, settings: &settings, ground: ground.as_ref() };
    let found = whole
        .assess(&mut tables, assessed_frames.as_mut())
        .map_err(|error| Fail::Refused(format!("{}: {error}", args.motion.display())))?;
    let new = new_doubts(args, &opened, (&settings, &found), &motion);
    new.iter().for_each(|warning| print_note("warning", warning));
    let warnings = [of_muscles, doubts, new].concat();

    let title = args.motion.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let figures = assessed_frames.as_ref().filter(|_| args.figures).map(|assessed_frames| {
        let stage = Stage::still(&settings.supports, &[], &held);
        let worst = found.groups.iter().map(|group| group.coordinate);
        figures_of_assessment((&title, found.dynamics), model, &stage, assessed_frames.frames(), worst)
    });
    let figures = figures.transpose()?.unwrap_or_default();
    let span = motion.first().zip(motion.last()).map_or(0.0, |(first, last)| last.0 - first.0);
    let verdict = Verdict::of_motion_with(model, &found, span, &held);
    let advice = advice(&whole, &found, &verdict, args.suggest);
    let answer = Answer::new(verdict, advice);
    let page = assessed_frames.map(|assessed_frames| {
        let dynamics = said.as_deref();
        report_of_assessment(
            &title,
            &assessed_frames,
            (&found, dynamics),
            &answer,
            &settings.supports,
            &held,
            &warnings,
        )
    });
    let names = ASSESS_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str()));
    let files = if args.out.is_some() { names.map(str::to_owned).collect() } else { vec![] };
    let text =
        AssessText::new(&opened, &args.motion, &tables.times, (settings.angle_error, &found), &answer, warnings, files);
    let json = json_text("assess.json", &text)?;
    if let (Some(folder), Some(page)) = (folder, page.transpose()?) {
        let fatigue = tables.fatigue()?;
        let gltf = animation::motion("motion.glb", model, &title, &motion, args.wooden)?;
        let contents = [&json, &tables.torques, &fatigue, &page].map(String::as_bytes).into_iter().chain([&gltf[..]]);
        let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        folder.write(&ASSESS_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())?;
    }
    print(&if args.json { json } else { answer.in_words(model, "", &report(&text)) })?;
    answered(&answer.verdict)
}

/// Reasons to doubt the motion and its assessment.
fn new_doubts(
    args: &AssessArgs,
    opened: &SourcedModel,
    (settings, found): (&AssessSettings, &Assessment),
    motion: &[(f64, Posture)],
) -> Vec<String> {
    let apart = settings.repetition.and_then(|_| ends_apart(&opened.model, motion));
    let supports = support_doubts(&opened.model, motion, &settings.supports);
    [apart.into_iter().collect(), supports, warnings(args, opened, (settings, found), motion.len())].concat()
}

/// The motion of an assessment, and its loads.
struct Motion<'a> {
    model: &'a Model,
    motion: &'a [(f64, Posture)],
    held: &'a [Load],
    settings: &'a AssessSettings,
    /// The measured forces of the ground.
    ground: Option<&'a GroundReaction>,
}

impl Motion<'_> {
    /// Assesses all postures; what each shows goes into the tables and the frames.
    fn assess(&self, tables: &mut Tables, mut frames: Option<&mut AssessedFrames>) -> Result<Assessment, AssessError> {
        let model = self.model;
        let measured = |time: f64, kinematics: &Kinematics, loads: &mut Vec<Load>| {
            self.ground.iter().for_each(|ground| ground.loads(time, model, kinematics, loads));
        };
        assessed(
            model,
            self.motion,
            |time, kinematics, loads| {
                loads.extend_from_slice(self.held);
                measured(time, kinematics, loads);
            },
            self.settings,
            |instant| {
                tables.record(instant);
                if let Some(frames) = &mut frames {
                    frames.record(instant, |loads| measured(instant.time, instant.torques.kinematics(), loads));
                }
            },
        )
    }
}

/// The changes that were tried: less load, and breaks. Measured forces of the ground belong to the load that was carried, so that
/// another one is not tried with them; of a fast motion nothing is.
fn advice(given: &Motion<'_>, found: &Assessment, verdict: &Verdict, suggest: SuggestArgs) -> Advice {
    let Motion { model, motion, held, settings, ground } = *given;
    let ends = motion.first().zip(motion.last()).map(|(first, last)| (first.0, last.0));
    let frames = motion.len();
    let (Some((begin, end)), Some(budget)) = (ends, suggest.budget(frames)) else { return Advice::default() };
    if found.uncarried.is_some() {
        let notes = vec![format!("To say who carries it, {WHAT_CARRIES}.")];
        return Advice { notes, ..Advice::default() };
    }
    if found.fast_share > FAST_SHARE {
        return Advice::default();
    }
    let start = &motion[0].1;
    let (supports, loads) = (&settings.supports, if ground.is_none() { vec![held] } else { vec![] });
    let job = Job { model, start, supports, levels: vec![], loads, asked: verdict.asked, strategy: None };
    let all = || changes(&job, &verdict.hazards).into_iter().filter(|change| *change != Change::OtherFoot).collect();
    let groups = Worked::in_motion(model, found);
    let breaks = || match found.repetition {
        Some(_) => with_breaks_in_repeats(model, found, verdict),
        None => with_breaks(&groups, end - begin, (begin, end), verdict),
    };
    let trial = |change: &Change| {
        let mut loads = held.to_vec();
        change.apply_to_loads(&mut loads);
        let found = assessed(model, motion, |_, _, all| all.extend_from_slice(&loads), settings, |_| {});
        let verdict = found.ok().map(|found| Verdict::of_motion_with(model, &found, end - begin, &loads));
        Trial { verdict, steps: frames }
    };
    Advice::new(verdict, &job, all, || verdict.kind.is_done().then(breaks).flatten(), budget, trial)
}

/// The model with its fatigue, and its muscles with warnings about them.
fn open(args: &AssessArgs) -> Result<(SourcedModel, Option<JointMuscles>, Vec<String>), Fail> {
    let (opened, muscles, doubts) = open_with_muscles(&args.model, args.muscles.asked())?;
    Ok((opened.with_fatigue(&args.fatigue.choice()?), muscles, doubts))
}

/// The motion, the loads and the settings of an assessment, checked; notes about them go to standard error.
fn given(args: &AssessArgs, opened: &mut SourcedModel, muscles: Option<JointMuscles>) -> Result<Given, Fail> {
    let mut notes = std::mem::take(&mut opened.notes);
    notes.extend(fatigue_notes(&opened.model));
    let model = &opened.model;
    let accepted = "MOTION is a .mot, .sto or .csv file";
    let span = &args.under.frames;
    let all = read_whole_motion(&args.motion, accepted, span, model, &mut notes)?;
    let mut recorded = Recorded::new(&args.motion.display().to_string(), all, (&args.dynamics, span), model)?;
    let (held, ground) = loads_of(&args.under, model, &recorded.frames, &mut notes)?;
    keep_overlap(&mut recorded, ground.as_ref())?;
    if let ([(first, _), .., (last, _)], frames) = (recorded.frames.as_slice(), recorded.frames.len())
        && first >= last
    {
        let why = format!("its {frames} frames all have the time {first} s; times must rise, or give one frame");
        return Err(Fail::Refused(format!("{}: {why}", args.motion.display())));
    }
    let Recorded { frames: motion, rates, said, doubts } = recorded;
    if !model.coordinates().iter().any(|coordinate| coordinate.groups.is_some()) {
        let why = "no strength of this model is known, so nothing can tire; lay one over it with --overlay FILE.toml";
        return Err(Fail::Refused(why.to_owned()));
    }
    let usual = if opened.is_exported_adult() { 0.0 } else { ANGLE_ERROR };
    let angle_error = args.angle_error.map_or(usual, f64::to_radians);
    let seconds = motion.first().zip(motion.last()).map_or(0.0, |(first, last)| last.0 - first.0);
    let settings = AssessSettings {
        repetition: args.repeat.repetition(seconds).map_err(Fail::Refused)?,
        supports: supports(args, model)?,
        rates,
        root_held: args.fixed_root,
        passive_ranges: opened.passive_ranges(),
        muscles,
        angle_error,
        ..AssessSettings::default()
    };
    let warnings = [doubts, note_values_out_of_range(opened, &motion, &mut notes)].concat();
    warnings.iter().for_each(|warning| print_note("warning", warning));
    said.iter().chain(&notes).for_each(|note| print_note("note", note));
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &ASSESS_FILES)).transpose()?;
    Ok(Given { motion, held, ground, settings, said, warnings, folder })
}

/// The supports, on horizontal ground.
fn supports(args: &AssessArgs, model: &Model) -> Result<Vec<Support>, Fail> {
    let mut patches = vec![];
    for text in &args.patch {
        patches.push(patch(model, text).map_err(|error| Fail::Refused(format!("--patch \"{text}\": {error}")))?);
    }
    let mut supports: Vec<Support> = vec![];
    for name in &args.support {
        let refuse = |why: String| Fail::Refused(format!("--support {name}: {why}"));
        let segment = model.segment(name).ok_or_else(|| refuse(no_segment(model, name)))?;
        if supports.iter().any(|support| support.segment == segment) {
            return Err(refuse("it is named twice".to_owned()));
        }
        let given = patches.iter().find(|(of, _)| *of == segment).map(|(_, corners)| corners);
        let corners: Vec<Vector3<f64>> = given.unwrap_or(&model.segments()[segment].patch).clone();
        if corners.is_empty() {
            return Err(refuse(format!(
                "where it touches the ground is not known; give corners in its frame (m): --patch \"{name} X,Y,Z X,Y,Z ...\""
            )));
        }
        let Some(normal) = (-model.gravity()).try_normalize(1e-9) else {
            return Err(refuse("without gravity there is no ground".to_owned()));
        };
        supports.push(Support {
            segment,
            corners,
            normal,
            friction: FRICTION,
            share_max: 1.0,
            place: contrapposto::contact::Place::Fixed,
        });
    }
    if let Some((segment, _)) = patches.iter().find(|(of, _)| !supports.iter().any(|support| support.segment == *of)) {
        let name = &model.segments()[*segment].name;
        return Err(Fail::Refused(format!("--patch \"{name} ...\": `{name}` is no support; name it with --support")));
    }
    Ok(supports)
}

/// The tables of torques and fatigue, as they grow.
struct Tables<'a> {
    model: &'a Model,
    order: Order,
    torques: String,
    /// Coordinates with muscle groups.
    working: Vec<usize>,
    times: Vec<f64>,
    /// Fatigue, then load, of both groups of each of them.
    fatigue: Vec<Vec<f64>>,
}

impl<'a> Tables<'a> {
    fn new(model: &'a Model, frames: usize, inertia: Option<&str>) -> Self {
        let order = Order::new(model);
        let torques = header(model, &order, frames, '\t', Columns { gradient: false, inertia });
        let coordinates = model.coordinates().iter().enumerate();
        let working = coordinates.filter(|(i, c)| c.groups.is_some() && !model.is_dependent(*i)).map(|(i, _)| i);
        Self { model, order, torques, working: working.collect(), times: vec![], fatigue: vec![] }
    }

    fn record(&mut self, instant: &Instant) {
        let Instant { index, time, model, torques, fatigue, load, inertia, .. } = *instant;
        let mut frame = Frame { center_of_mass: None, ..Frame::new(torques, model, &self.order, (index, time)) };
        if let Some(inertia) = inertia {
            frame = frame.with_inertia(inertia, model, &self.order);
        }
        self.torques.push_str(&row(&self.order, &frame, '\t'));
        self.times.push(time);
        let working = self.working.iter();
        self.fatigue.push(working.flat_map(|&i| [fatigue[i], load[i]]).flatten().collect());
    }

    fn fatigue(&self) -> Result<String, Fail> {
        let label = |&i: &usize| {
            let name = &self.model.coordinates()[i].name;
            ["fatigue", "load"].map(|what| Side::BOTH.map(|side| format!("{name}.{what}_{}", side.word())))
        };
        let labels: Vec<String> = self.working.iter().flat_map(label).flatten().collect();
        // Shares have no unit: as lengths they are written as they are.
        let columns: Vec<_> = labels.iter().map(|label| (label.as_str(), CoordinateKind::Translation)).collect();
        write_sto("fatigue", &columns, false, &self.times, &self.fatigue)
            .map_err(|error| Fail::job("fatigue.sto", error))
    }
}
