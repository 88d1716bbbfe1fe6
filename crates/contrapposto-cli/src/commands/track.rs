//! `contrapposto track`: the motion of a model whose markers lie nearest to measured ones.

pub(crate) mod doubts;
pub(crate) mod matching;

use std::path::Path;

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::tracking::{self, Goals, TrackedFrame, TrackingError};
use contrapposto_formats::markers::{Markers, NamedFile, TrackingTasks, read_markers, tracking_tasks, turn_upright};
use contrapposto_formats::motion::{MOST_TABLE_BYTES, UnwritableTable, opensim_columns, write_sto};
use contrapposto_formats::xml::Limits;

use crate::args::{TrackArgs, UpChoice};
use crate::fail::Fail;
use crate::input::read;
use crate::interruption;
use crate::model_file::open;
use crate::motion_file::turned;
use crate::output::{ResultSet, print, print_note};
use crate::progress::frames_bar;
use matching::{Matched, Observed, Source, length};

/// The motion that is written.
pub(super) const MOTION: &str = "motion.mot";
/// The errors of its markers.
pub(super) const ERRORS: &str = "marker-errors.sto";
/// Times of a setup file and of a marker file are the same up to this, s: both are rounded to a millisecond.
pub(super) const SAME_TIME: f64 = 5e-4;
/// Most values of the motion that is written: `assess` and `torques` read tables of 64 MiB.
pub(super) const MOST_MOTION_VALUES: usize = 3_000_000;

pub(crate) fn track(args: &TrackArgs) -> Result<(), Fail> {
    if args.rig.is_some() {
        return Err(Fail::Refused(
            "--rig names the joints of an animation (.bvh, .glb, .gltf); markers have names of their own".to_owned(),
        ));
    }
    let out = ResultSet::open(&args.out, &[MOTION, ERRORS])?;
    let opened = open(&args.model, false)?;
    let model = &opened.model;
    let name = args.markers.display().to_string();
    let mut markers =
        read_markers(&name, &read(&args.markers, MOST_TABLE_BYTES as u64)?, args.units.map(|unit| unit.unit()))?;
    let up = args.up.map(UpChoice::axis).or(markers.up).zip((-model.gravity()).try_normalize(1e-9));
    if let Some(turn) = up.and_then(|(own, up)| turn_upright(own, up)) {
        markers.turn(&turn);
        print_note("note", &turned(&name));
    }
    let tasks = tasks(args)?;
    if let Some(tasks) = &tasks {
        print_other_files(args.tasks.as_deref(), &tasks.named, [Path::new(&args.model.model), &args.markers]);
        tasks.notes.iter().for_each(|note| print_note("note", note));
    }
    markers.warnings.iter().for_each(|warning| print_note("warning", warning));
    let [shown, tasks_file] = [Some(&args.model.model), args.tasks.as_ref()]
        .map(|path| path.map_or_else(String::new, |path| path.display().to_string()));
    let source = Source { model: &shown, markers: &name, tasks: &tasks_file };
    let matched = Matched::new(&opened, &markers, tasks.as_ref(), source)?;
    matched.warnings.iter().for_each(|warning| print_note("warning", warning));
    matched.notes.iter().for_each(|note| print_note("note", note));
    let (mut times, mut frames) = frames(args, &name, &markers, (&matched, model.coordinates().len()), tasks.as_ref())?;
    let start = model.default_posture();
    let tracked = tracked_so_far(model, matched.goals.clone(), &start, &frames)
        .map_err(|error| Fail::Refused(format!("{}: {error}", args.model.model.display())))?;
    let left = left_out(&times, tracked.len())?;
    times.truncate(tracked.len());
    frames.truncate(tracked.len());
    for warning in doubts::doubts(model, &matched, markers.unit, (&times, &frames, &tracked)) {
        print_note("warning", &warning);
    }
    let motion = motion(model, &times, &tracked).map_err(|error| Fail::job(MOTION, error))?;
    let errors = errors(&times, &tracked).map_err(|error| Fail::job(ERRORS, error))?;
    out.write(&[(MOTION, motion), (ERRORS, errors)])?;
    print(&answer(&matched, &times, &tracked))?;
    print(&format!("{} and {ERRORS} beside it\n", out.path(MOTION).display()))?;
    left.map_or(Ok(()), Err)
}

/// The frames that are tracked until someone asks the program to end.
pub(super) fn tracked_so_far(
    model: &Model,
    goals: Goals,
    start: &Posture,
    frames: &[Observed],
) -> Result<Vec<TrackedFrame>, TrackingError> {
    interruption::watch();
    let progress = frames_bar(frames.len());
    let going = frames.iter().take_while(|_| !interruption::is_requested()).inspect(|_| progress.inc(1));
    let tracked = tracking::track(model, goals, start, going.map(Vec::as_slice))?;
    progress.finish();
    Ok(tracked)
}

/// The failure that ends the command once the frames so far are written, if there are more of them.
pub(super) fn left_out(times: &[f64], done: usize) -> Result<Option<Fail>, Fail> {
    let failure =
        |so_far: String| Fail::Job(format!("interrupted: {done} of {} instants were tracked{so_far}", times.len()));
    match (done, times.get(done.wrapping_sub(1))) {
        (done, _) if done == times.len() => Ok(None),
        (_, Some(last)) => Ok(Some(failure(format!(", up to {last} s, and written")))),
        (_, None) => Err(failure(String::new())),
    }
}

/// Notes of the model and the markers that a setup file names otherwise than the command line.
pub(super) fn print_other_files(setup: Option<&Path>, named: &[NamedFile], [model, markers]: [&Path; 2]) {
    let setup = setup.map(|path| path.display().to_string()).unwrap_or_default();
    for file in named {
        let given = if file.element == "model_file" { model } else { markers };
        file.note(&setup, given).iter().for_each(|note| print_note("note", note));
    }
}

fn tasks(args: &TrackArgs) -> Result<Option<TrackingTasks>, Fail> {
    let Some(path) = &args.tasks else { return Ok(None) };
    let bytes = read(path, Limits::default().file_bytes as u64)?;
    let tasks = tracking_tasks(&path.display().to_string(), &bytes);
    tasks.map(Some).map_err(|error| Fail::Refused(error.to_string()))
}

/// Times and places of the frames that are asked for.
fn frames(
    args: &TrackArgs,
    name: &str,
    markers: &Markers,
    (matched, coordinates): (&Matched, usize),
    tasks: Option<&TrackingTasks>,
) -> Result<(Vec<f64>, Vec<Observed>), Fail> {
    let limits = tasks.and_then(|tasks| tasks.time_range);
    let (first, last) = limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let (from, to) = (args.from.unwrap_or(first - SAME_TIME), args.to.unwrap_or(last + SAME_TIME));
    let rows = markers.times.iter().zip(&markers.places).filter(|(time, _)| (from..=to).contains(time));
    let place = |row: &Observed| matched.columns.iter().map(|&column| row[column]).collect::<Observed>();
    let (times, frames): (Vec<f64>, Vec<Observed>) = rows.map(|(time, row)| (*time, place(row))).unzip();
    let ends = markers.times.first().zip(markers.times.last());
    match ends {
        Some((first, last)) if times.is_empty() => Err(Fail::Refused(format!(
            "{name}: no instant lies in the time that is asked for ({}); it goes from {first} s to {last} s",
            asked(args.from.or(limits.map(|limits| limits.0)), args.to.or(limits.map(|limits| limits.1)))
        ))),
        _ if frames.iter().flatten().flatten().next().is_none() => Err(Fail::Refused(format!(
            "{name}: none of the {} markers that are tracked has a place in any of the {} instants",
            matched.columns.len(),
            frames.len()
        ))),
        _ if frames.len().saturating_mul(coordinates) > MOST_MOTION_VALUES => Err(Fail::Refused(format!(
            "{name}: {} instants of {coordinates} coordinates are more than {MOST_MOTION_VALUES} values; take a part of them with --from and --to",
            frames.len()
        ))),
        _ => Ok((times, frames)),
    }
}

/// `from 1 s`, `up to 2 s`, `from 1 s to 2 s`.
pub(super) fn asked(from: Option<f64>, to: Option<f64>) -> String {
    match (from, to) {
        (Some(from), Some(to)) => format!("from {from} s to {to} s"),
        (Some(from), None) => format!("from {from} s"),
        (None, Some(to)) => format!("up to {to} s"),
        (None, None) => "all of the file".to_owned(),
    }
}

pub(super) fn motion(model: &Model, times: &[f64], tracked: &[TrackedFrame]) -> Result<String, UnwritableTable> {
    let rows: Vec<&[f64]> = tracked.iter().map(|frame| frame.posture.values()).collect();
    write_sto("Coordinates", &opensim_columns(model), true, times, &rows)
}

/// The table that OpenSim's tool writes.
pub(super) fn errors(times: &[f64], tracked: &[TrackedFrame]) -> Result<String, UnwritableTable> {
    let names = ["total_squared_error", "marker_error_RMS", "marker_error_max"];
    let columns = names.map(|name| (name, CoordinateKind::Translation));
    let row = |frame: &TrackedFrame| {
        let most = frame.largest.map_or(0.0, |(_, error)| error);
        [frame.total_squared_error, frame.root_mean_square(), most]
    };
    let rows: Vec<[f64; 3]> = tracked.iter().map(row).collect();
    write_sto("Model Marker Errors from IK", &columns, false, times, &rows)
}

/// The first line.
fn answer(matched: &Matched, times: &[f64], tracked: &[TrackedFrame]) -> String {
    let (first, last) = (times[0], times[times.len() - 1]);
    let frames = match tracked.len() {
        1 => format!("1 instant at {first} s"),
        count => format!("{count} instants from {first} s to {last} s"),
    };
    let largest = doubts::largest(times, tracked).map_or_else(String::new, |(time, index, error)| {
        format!(", the largest {} (`{}` at {time} s)", length(error), matched.names[index])
    });
    let rms = length(doubts::root_mean_square(tracked));
    let markers = matched.names.len();
    format!("Tracked {frames} by {markers} markers: their error is {rms} in the root mean square{largest}.\n")
}
