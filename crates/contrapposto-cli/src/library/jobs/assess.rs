//! Assesses a recorded motion of a model.

use std::path::PathBuf;

use clap::Parser;
use contrapposto::model::Model;
use contrapposto::posture::Posture;

use crate::args::AssessArgs;
use crate::commands::assess::{job::Job, page};
use crate::fail::Fail;
use crate::library::ModelSource;
use crate::library::failure::{Failure, Note, with_notes};
use crate::library::frames::Frames;
use crate::motion_file::read_whole_motion;
use crate::output::json_text;
use crate::view::frame::Frame;
use crate::view::report::assessment::AssessedFrames;

/// A recorded motion.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionSource {
    /// A file (.mot, .sto, .csv).
    File(PathBuf),
    /// Times (s), and the values of all coordinates (rad, m) at each of them, row after row.
    Rows(Vec<f64>, Vec<f64>),
}

/// A motion that was assessed.
pub struct Assessed {
    source: (ModelSource, MotionSource, Vec<String>),
    json: String,
    frames: Frames,
}

impl Assessed {
    /// Carries out `assess` of the program; `words` are its options.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn new(model: ModelSource, motion: MotionSource, words: Vec<String>) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let (args, name, job) = job(&model, &motion, &words)?;
            let mut frames = vec![];
            let mut shown = AssessedFrames::new(&job.opened, job.motion.len());
            let found = job.carry_out(&args, &name, |instant| {
                let frame = Frame::of_instant(instant.model, instant);
                frames.push(Frame { fatigue: Some(instant.fatigue.to_vec()), ..frame });
                if job.has_muscles() {
                    shown.record(instant, |_| {});
                }
            })?;
            let muscles = job.muscles_at_work(shown.frames())?;
            let json = json_text("assess.json", &job.text(&name, (&found, muscles.as_ref()), vec![]))?;
            let frames = Frames::of(&job.opened.model, &frames);
            Ok(Self { source: (model, motion, words), json, frames })
        })
    }

    /// The text of `assess.json`.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// All postures with their torques.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The page `report.html`; the motion is assessed again for it.
    ///
    /// # Errors
    /// [`Failure`] where the page cannot be drawn.
    pub fn report(&self) -> Result<String, Failure> {
        let (model, motion, words) = &self.source;
        let page = with_notes(|| {
            let (args, name, job) = job(model, motion, words)?;
            let mut shown = AssessedFrames::new(&job.opened, job.motion.len());
            let found = job.carry_out(&args, &name, |instant| {
                shown.record(instant, |loads| job.measured(instant.time, instant.torques.kinematics(), loads));
            })?;
            let title = match motion {
                MotionSource::File(path) => {
                    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into())
                }
                MotionSource::Rows(..) => name,
            };
            let muscles = job.muscles_at_work(shown.frames())?;
            page(&title, &job, &found, (&shown, muscles.as_ref()))
        });
        page.map(|(page, _)| page)
    }
}

/// The arguments, the name of the motion, and the job.
fn job(model: &ModelSource, motion: &MotionSource, words: &[String]) -> Result<(AssessArgs, String, Job), Fail> {
    let name = match motion {
        MotionSource::File(path) => path.display().to_string(),
        MotionSource::Rows(..) => "motion".to_owned(),
    };
    let begin = ["assess", "model", "motion"].map(str::to_owned);
    let args = AssessArgs::try_parse_from(begin.into_iter().chain(words.iter().cloned())).map_err(|error| {
        let text = error.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        Fail::Refused(text.split("\n\n").next().unwrap_or_default().to_owned())
    })?;
    let opened = model.opened(args.muscles.asked().0)?;
    let accepted = "a motion is a .mot, .sto or .csv file, or rows of postures with their times";
    let read = |model: &Model, notes: &mut Vec<String>| match motion {
        MotionSource::File(path) => read_whole_motion(path, accepted, &args.under.frames, model, notes),
        MotionSource::Rows(times, values) => rows(model, times, values),
    };
    let job = Job::new(&args, opened, &name, read)?;
    Ok((args, name, job))
}

/// Postures with their times, checked.
fn rows(model: &Model, times: &[f64], values: &[f64]) -> Result<Vec<(f64, Posture)>, Fail> {
    let refuse = |why: String| Err(Fail::Refused(format!("motion: {why}")));
    let width = model.coordinates().len();
    if times.is_empty() || values.len() != width * times.len() {
        let (rows, given) = (times.len(), values.len());
        return refuse(format!("{rows} times and {given} values; each time needs the values of {width} coordinates"));
    }
    if let Some(bad) = times.iter().position(|time| !time.is_finite()) {
        return refuse(format!("time of row {bad} is {} s; it must be finite", times[bad]));
    }
    if let Some(bad) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        return refuse(format!(
            "time of row {} is {} s after {} s; times must rise",
            bad + 1,
            times[bad + 1],
            times[bad]
        ));
    }
    if let Some(bad) = values.iter().position(|value| !value.is_finite()) {
        let (row, name) = (bad / width, &model.coordinates()[bad % width].name);
        return refuse(format!("`{name}` of row {row} is {}; it must be finite", values[bad]));
    }
    let postures = values.chunks_exact(width).map(|row| Posture::new(row.to_vec()));
    Ok(times.iter().copied().zip(postures).collect())
}
