//! `contrapposto assess`: the muscle group that fails first in a recorded motion, its time, and its relief.

pub(crate) mod job;
mod repeats;
mod support_doubts;
mod warnings;

use std::path::Path;

use contrapposto::assessment::Instant;
use contrapposto::model::{CoordinateKind, Model, Side};
use contrapposto_formats::motion::write_sto;

use self::job::{Found, Job};
pub(crate) use self::warnings::{RESIDUAL, WHAT_CARRIES};
use crate::args::AssessArgs;
use crate::fail::Fail;
use crate::model_file::open_with_muscles;
use crate::motion_file::read_whole_motion;
use crate::output::{ResultSet, json_text, print};
use crate::view::animation;
use crate::view::answer::answered;
use crate::view::figures::figures_of_assessment;
use crate::view::muscle_work::MusclesAtWork;
use crate::view::report::assessment::{AssessedFrames, report_of_assessment};
use crate::view::stage::Stage;
use crate::view::text::assess::report;
use crate::view::text::torques::{Columns, header, row};
use crate::view::torque_rows::{Frame, Order};

const ASSESS_FILES: [&str; 5] = ["assess.json", "torques.sto", "fatigue.sto", "report.html", "motion.glb"];

pub(crate) fn assess(args: &AssessArgs) -> Result<(), Fail> {
    if args.model.model == Path::new("-") && args.motion == Path::new("-") {
        return Err(Fail::Refused("standard input is one file: MODEL or MOTION, not both".to_owned()));
    }
    let name = args.motion.display().to_string();
    let (opened, muscles, doubts) = open_with_muscles(&args.model, args.muscles.asked())?;
    let opened = (opened, args.muscles.sharing.of(muscles), doubts);
    let accepted = "MOTION is a .mot, .sto or .csv file";
    let read =
        |model: &Model, notes: &mut _| read_whole_motion(&args.motion, accepted, &args.under.frames, model, notes);
    let job = Job::new(args, opened, &name, read)?;
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &ASSESS_FILES)).transpose()?;
    let (model, said) = (&job.opened.model, job.said.as_deref());

    let mut tables = Tables::new(model, job.motion.len(), said);
    let recorded = folder.is_some() || job.has_muscles();
    let mut assessed_frames = recorded.then(|| AssessedFrames::new(&job.opened, job.motion.len()));
    let found = job.carry_out(args, &name, |instant| {
        tables.record(instant);
        if let Some(frames) = &mut assessed_frames {
            frames.record(instant, |loads| job.measured(instant.time, instant.torques.kinematics(), loads));
        }
    })?;

    let frames = assessed_frames.as_ref().map_or(&[][..], AssessedFrames::frames);
    let muscles = job.muscles_at_work(frames)?;
    let title = args.motion.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let figures = assessed_frames.as_ref().filter(|_| args.figures).map(|assessed_frames| {
        let stage = Stage::still(&job.settings.supports, &[], &job.held);
        let worst = found.assessment.groups.iter().map(|group| group.coordinate);
        let shown = (assessed_frames.frames(), muscles.as_ref());
        figures_of_assessment((&title, found.assessment.dynamics), model, &stage, shown, worst)
    });
    let figures = figures.transpose()?.unwrap_or_default();
    let shown = assessed_frames.as_ref().filter(|_| folder.is_some());
    let page = shown.map(|shown| page(&title, &job, &found, (shown, muscles.as_ref()))).transpose()?;
    let names = ASSESS_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str()));
    let files = if folder.is_some() { names.map(str::to_owned).collect() } else { vec![] };
    let text = job.text(&name, (&found, muscles.as_ref()), files);
    let json = json_text(ASSESS_FILES[0], &text)?;
    if let (Some(folder), Some(page)) = (folder, page) {
        let fatigue = tables.fatigue()?;
        let gltf = animation::motion("motion.glb", model, &title, (&job.motion, muscles.as_ref()), args.wooden)?;
        let contents = [&json, &tables.torques, &fatigue, &page].map(String::as_bytes).into_iter().chain([&gltf[..]]);
        let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        folder.write(&ASSESS_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())?;
    }
    let answer = &found.answer;
    let tables =
        || report(&text) + &muscles.as_ref().map_or_else(String::new, |muscles| format!("\n{}", muscles.table()));
    print(&if args.json { json } else { answer.in_words(model, "", &tables()) })?;
    answered(&answer.verdict)
}

/// The page `report.html`.
pub(crate) fn page(
    title: &str,
    job: &Job,
    found: &Found,
    frames: (&AssessedFrames<'_>, Option<&MusclesAtWork<'_>>),
) -> Result<String, Fail> {
    let Found { assessment, cycles, answer, warnings } = found;
    let (numbers, supports) = (
        (assessment, job.said.as_deref(), cycles.as_ref().and_then(|cycles| cycles.as_ref().ok())),
        &job.settings.supports,
    );
    report_of_assessment(title, frames, numbers, answer, supports, &job.held, warnings)
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
