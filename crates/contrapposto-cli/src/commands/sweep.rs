//! `contrapposto sweep`: a plan in, many runs of one scenario, parts of a table out.

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

use contrapposto_formats::{MOST_BYTES, Plan, read_plan, read_run, scenario_model};
use contrapposto_sweep::{COLUMNS, Study};
use serde::Serialize;

use crate::args::SweepArgs;
use crate::fail::Fail;
use crate::input::{confined, read};
use crate::interruption;
use crate::output::{Folder, json_text, print};
use crate::progress::{Progress, rows_bar};

/// The file that lists the parts of a finished sweep.
const LIST: &str = "sweep.json";
/// The file that is locked while a sweep writes into a folder, so that a second one is refused.
const SWEEP_LOCK: &str = "sweep.lock";
/// Most threads.
const MOST_THREADS: usize = 256;

pub(crate) fn sweep(args: &SweepArgs) -> Result<(), Fail> {
    let study = open(&args.plan)?;
    let parts = study.plan().parts();
    let there = parts_in(&args.out)?;
    if !there.is_empty() && !args.resume {
        let out = args.out.display();
        let why = "has parts of a sweep; --resume keeps those of this plan and removes the others";
        return Err(Fail::Refused(format!("--out {out}: {why}")));
    }
    let names: Vec<String> = (0..parts).map(|part| part_name(part, &study.key(part))).collect();
    let folder = Folder::open(&args.out)?;
    let _lock = Lock::of(&folder)?;
    // Without its list a sweep is not whole.
    folder.remove(LIST)?;
    let wanted: BTreeSet<&String> = names.iter().collect();
    there.iter().filter(|name| !wanted.contains(name)).try_for_each(|name| folder.remove(name))?;
    let missing: Vec<usize> = (0..parts).filter(|part| !there.contains(&names[*part])).collect();
    let threads = args.threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZero::get);
    let threads = threads.min(missing.len()).clamp(1, MOST_THREADS);
    interruption::watch();
    let written = compute(&study, &missing, threads, |part, text| folder.write(&[(names[part].as_str(), text)]))?;
    if written < missing.len() {
        let (whole, out) = (parts - missing.len() + written, args.out.display());
        let more = "the same command with --resume continues";
        return Err(Fail::Job(format!("interrupted: {whole} of {parts} parts are in {out}: {more}")));
    }
    folder.write(&[(LIST, list(study.plan(), &names)?)])?;
    let kept = parts - written;
    let kept = if kept > 0 { format!(", {kept} of them kept") } else { String::new() };
    print(&format!("{} rows in {parts} parts{kept}: {}\n", study.plan().rows, args.out.display()))
}

/// The lock of a folder for one sweep; its file goes with it.
struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks a folder, or refuses it while another sweep has it. Where files cannot be locked, nothing is refused.
    fn of(folder: &Folder) -> Result<Self, Fail> {
        let path = folder.path(SWEEP_LOCK);
        let failed = |error| Fail::job(path.display().to_string(), error);
        let file = File::options().write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let why = "another sweep writes into this folder; wait for its end or name another folder";
            return Err(Fail::Refused(format!("--out {}: {why}", path.parent().unwrap_or(&path).display())));
        }
        Ok(Self { path, _file: file })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// The plan of a file with its base scenario. The scenario of the first row is read, so that a wrong key ends the command before anything
/// is written.
fn open(path: &Path) -> Result<Study, Fail> {
    let plan = read_plan(&path.display().to_string(), &read(path, MOST_BYTES)?)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // A plan may stand in a folder beside the scenarios.
    let base = folder.join(&plan.base);
    let base = match folder.join("..").canonicalize() {
        Ok(above) if base.canonicalize().is_ok_and(|base| base.starts_with(&above)) => base,
        _ => confined(folder, &plan.base)
            .map_err(|why| Fail::Refused(format!("{}: base = {:?}: {why}", path.display(), plan.base)))?,
    };
    let (name, bytes) = (base.display().to_string(), read(&base, MOST_BYTES)?);
    if scenario_model(&name, &bytes)?.is_some() {
        let why = "the scenario names a model file; a sweep takes scenarios of the built-in adult";
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    let study = Study::new(&name, &bytes, &plan)?;
    read_run(&name, study.scenario(0).as_bytes(), None)?;
    Ok(study)
}

/// Computes parts in threads and gives each to `write` in this thread; gives the number of parts that were written, fewer than asked for
/// where the user interrupts.
fn compute(
    study: &Study,
    parts: &[usize],
    threads: usize,
    mut write: impl FnMut(usize, String) -> Result<(), Fail>,
) -> Result<usize, Fail> {
    let rows = parts.iter().map(|part| study.plan().rows_of(*part).len()).sum::<usize>();
    let bar = rows_bar(rows as u64);
    let work = Work { study, parts, bar, next: AtomicUsize::new(0), stop: AtomicBool::new(false) };
    // A thread that is ahead waits, so that no more parts are in memory than two for each thread.
    let (sender, finished) = sync_channel(threads);
    let mut written = 0;
    let result = std::thread::scope(|scope| {
        for _ in 0..threads {
            let (sender, work) = (sender.clone(), &work);
            scope.spawn(move || work.carry_out(&sender));
        }
        drop(sender);
        // The receiver ends with this block: a thread that waits to send goes on and ends.
        for (part, text) in finished {
            write(part, text).inspect_err(|_| work.stop.store(true, Ordering::Relaxed))?;
            written += 1;
        }
        Ok(())
    });
    work.bar.finish();
    result.map(|()| written)
}

/// The parts that threads share.
struct Work<'a> {
    study: &'a Study,
    parts: &'a [usize],
    bar: Progress,
    /// Place in `parts` of the next part that no thread has taken.
    next: AtomicUsize,
    /// A part could not be written.
    stop: AtomicBool,
}

impl Work<'_> {
    /// Computes one part after another until none is left, or the user interrupts.
    fn carry_out(&self, finished: &SyncSender<(usize, String)>) {
        let go_on = || !interruption::is_requested() && !self.stop.load(Ordering::Relaxed);
        while let Some(&part) = self.parts.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let Some(text) = self.study.part(part, go_on, || self.bar.inc(1)) else { break };
            if finished.send((part, text)).is_err() {
                break;
            }
        }
    }
}

/// `part-00012-1f0c9a7be2d34455.csv`.
fn part_name(part: usize, key: &str) -> String {
    format!("part-{part:05}-{key}.csv")
}

/// Names of the parts that a folder has.
fn parts_in(folder: &Path) -> Result<BTreeSet<String>, Fail> {
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(BTreeSet::new()),
        Err(error) => return Err(Fail::Refused(format!("--out {}: {error}", folder.display()))),
    };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    Ok(names.filter(|name| is_part(name)).collect())
}

fn is_part(name: &str) -> bool {
    let Some(middle) = name.strip_prefix("part-").and_then(|name| name.strip_suffix(".csv")) else { return false };
    let Some((part, key)) = middle.split_once('-') else { return false };
    let hexadecimal = |c: char| c.is_ascii_digit() || ('a'..='f').contains(&c);
    part.len() >= 5 && part.chars().all(|c| c.is_ascii_digit()) && key.len() == 16 && key.chars().all(hexadecimal)
}

/// The file `sweep.json`.
#[derive(Serialize)]
struct ListText<'a> {
    program: &'static str,
    base: &'a str,
    rows: usize,
    rows_per_part: usize,
    columns: Vec<ColumnText<'a>>,
    parts: &'a [String],
}

/// A column and its meaning, the unit first.
#[derive(Serialize)]
struct ColumnText<'a> {
    name: &'a str,
    meaning: String,
}

fn list(plan: &Plan, parts: &[String]) -> Result<String, Fail> {
    let row = ColumnText { name: "row", meaning: "number of the row in the plan, from 0".to_owned() };
    let parameters = plan.parameters.iter().map(|parameter| ColumnText {
        name: &parameter.key,
        meaning: "key of the scenario, in the unit that its name ends in".to_owned(),
    });
    let answer = COLUMNS.iter().map(|(name, meaning)| ColumnText { name, meaning: (*meaning).to_owned() });
    json_text(
        LIST,
        &ListText {
            program: concat!("contrapposto ", env!("CARGO_PKG_VERSION")),
            base: &plan.base,
            rows: plan.rows,
            rows_per_part: plan.rows_per_part,
            columns: std::iter::once(row).chain(parameters).chain(answer).collect(),
            parts,
        },
    )
}
