//! Computes the parts of a study in threads, and keeps them in a folder, from which a later command takes those that agree.

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

use contrapposto_sweep::Study;

use crate::fail::Fail;
use crate::interruption;
use crate::output::Folder;
use crate::progress::rows_bar;

/// The file that is locked while a sweep writes into a folder, so that a second one is refused.
const SWEEP_LOCK: &str = "sweep.lock";
/// Most threads.
const MOST_THREADS: usize = 256;

/// Parts in a folder that are none of a study.
#[derive(Clone, Copy)]
pub(crate) enum Others {
    /// Such parts are removed when all parts of the study are there, and the file that lists them.
    Removed,
    /// Parts behind the last one, and parts of the same bodies with fewer or more rows, stay; others are refused.
    Kept,
}

/// A folder that takes the parts of a study.
pub(crate) struct Filling {
    /// Goes before the folder, which is removed where nothing is in it.
    _lock: Lock,
    pub(crate) folder: Folder,
    /// Names of the parts in their order.
    pub(crate) names: Vec<String>,
    /// Numbers of the parts that the folder lacks.
    pub(crate) missing: Vec<usize>,
    /// Parts that are none of the study.
    foreign: Vec<String>,
}

impl Filling {
    /// Locks the folder `out`, which is made if it is not there; nothing in it changes yet.
    ///
    /// # Errors
    /// A folder that has parts, without `resume`; parts that are refused; a folder in which another sweep writes.
    pub(crate) fn open(study: &Study, (out, others): (&Path, Others), resume: bool) -> Result<Self, Fail> {
        let parts = study.parts();
        let there = parts_in(out)?;
        if !there.is_empty() && !resume {
            let why = match others {
                Others::Removed => "has parts of a sweep; --resume keeps those of this plan and removes the others",
                Others::Kept => "has bodies of a population; --resume keeps them and computes those that are missing",
            };
            return Err(Fail::Refused(format!("--out {}: {why}", out.display())));
        }
        let names: Vec<String> = (0..parts).map(|part| part_name(part, &study.key(part))).collect();
        if let Others::Kept = others {
            refuse_foreign(study, out, &there, &names)?;
        }
        let folder = Folder::open(out)?;
        let lock = Lock::of(&folder)?;
        let missing = (0..parts).filter(|part| !there.contains(&names[*part])).collect();
        let wanted: BTreeSet<&String> = names.iter().collect();
        let foreign = there.iter().filter(|name| !wanted.contains(name)).cloned().collect();
        Ok(Self { _lock: lock, folder, names, missing, foreign })
    }

    /// Number of parts that were there before.
    pub(crate) fn kept(&self) -> usize {
        self.names.len() - self.missing.len()
    }

    /// Writes a part, whole or not at all.
    pub(crate) fn write(&self, part: usize, bytes: &[u8]) -> Result<(), Fail> {
        self.folder.write(&[(self.names[part].as_str(), bytes)])
    }

    /// Computes the missing parts.
    ///
    /// # Errors
    /// The user's interruption, and parts that cannot be written.
    pub(crate) fn fill(&self, study: &Study, threads: Option<NonZero<usize>>, watch: &Watch<'_>) -> Result<(), Fail> {
        let written = compute(study, &self.missing, threads, watch, |part, bytes| self.write(part, &bytes))?;
        if written < self.missing.len() {
            let (whole, parts, out) = (self.kept() + written, self.names.len(), self.folder.path(""));
            let more = "the same command with --resume continues";
            return Err(Fail::Job(format!("interrupted: {whole} of {parts} parts are in {}: {more}", out.display())));
        }
        Ok(())
    }

    /// Writes the list of all parts under its name, and then removes those that are none of the study.
    pub(crate) fn finish(&self, name: &str, list: &str) -> Result<(), Fail> {
        self.folder.write(&[(name, list)])?;
        self.foreign.iter().try_for_each(|name| self.folder.remove(name))
    }
}

/// Looks after a computation from outside.
pub(crate) struct Watch<'a> {
    /// Called once with the number of rows.
    pub(crate) begin: &'a (dyn Fn(usize) + Sync),
    /// Whether to go on.
    pub(crate) go_on: &'a (dyn Fn() -> bool + Sync),
    /// Called after every row.
    pub(crate) done: &'a (dyn Fn() + Sync),
}

/// Carries out a computation under a bar on standard error, which ends at the first Ctrl-C.
pub(crate) fn watched<T>(job: impl FnOnce(&Watch<'_>) -> Result<T, Fail>) -> Result<T, Fail> {
    interruption::watch();
    let bar = rows_bar(0);
    let watch = Watch {
        begin: &|rows| bar.set_length(rows as u64),
        go_on: &|| !interruption::is_requested(),
        done: &|| bar.inc(1),
    };
    let result = job(&watch);
    bar.finish();
    result
}

/// Refuses a folder with a part that should have the same bodies as one of the study, and has others.
fn refuse_foreign(study: &Study, out: &Path, there: &BTreeSet<String>, names: &[String]) -> Result<(), Fail> {
    let is_foreign = |name: &&String| {
        let Some(part) = number_of(name).filter(|part| *part < names.len()) else { return false };
        let is_other_length = |key: &String| part_name(part, key) == **name;
        **name != names[part] && !study.keys_of_other_lengths(part).iter().any(is_other_length)
    };
    match there.iter().find(is_foreign) {
        Some(name) => {
            let why = "holds bodies of another scenario, seed or version";
            Err(Fail::Refused(format!("--out {}: {why} ({name}); name another folder", out.display())))
        }
        None => Ok(()),
    }
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

/// Computes parts in threads, as many as there are cores where their number is not given, and gives each to `write` in this thread; gives
/// the number of parts that were written, fewer than asked for where the computation is told to end.
pub(crate) fn compute(
    study: &Study,
    parts: &[usize],
    threads: Option<NonZero<usize>>,
    watch: &Watch<'_>,
    mut write: impl FnMut(usize, Vec<u8>) -> Result<(), Fail>,
) -> Result<usize, Fail> {
    let threads = threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZero::get);
    let threads = threads.min(parts.len()).clamp(1, MOST_THREADS);
    (watch.begin)(parts.iter().map(|part| study.rows_of(*part).len()).sum());
    let work = Work { study, parts, watch, next: AtomicUsize::new(0), stop: AtomicBool::new(false) };
    // A thread that is ahead waits, so that no more parts are in memory than two for each thread.
    let (sender, finished) = sync_channel(threads);
    let mut written = 0;
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (sender, work) = (sender.clone(), &work);
            scope.spawn(move || work.carry_out(&sender));
        }
        drop(sender);
        // The receiver ends with this block: a thread that waits to send goes on and ends.
        for (part, bytes) in finished {
            write(part, bytes).inspect_err(|_| work.stop.store(true, Ordering::Relaxed))?;
            written += 1;
        }
        Ok(written)
    })
}

/// The parts that threads share.
struct Work<'a> {
    study: &'a Study,
    parts: &'a [usize],
    watch: &'a Watch<'a>,
    /// Place in `parts` of the next part that no thread has taken.
    next: AtomicUsize,
    /// A part could not be written.
    stop: AtomicBool,
}

impl Work<'_> {
    /// Computes one part after another until none is left, or the computation is told to end.
    fn carry_out(&self, finished: &SyncSender<(usize, Vec<u8>)>) {
        let go_on = || (self.watch.go_on)() && !self.stop.load(Ordering::Relaxed);
        while let Some(&part) = self.parts.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let Some(bytes) = self.study.part(part, go_on, self.watch.done) else { break };
            if finished.send((part, bytes)).is_err() {
                break;
            }
        }
    }
}

/// `part-00012-1f0c9a7be2d34455.parquet`.
fn part_name(part: usize, key: &str) -> String {
    format!("part-{part:05}-{key}.parquet")
}

/// Number of the part of that name; `None` of one beyond all numbers.
fn number_of(name: &str) -> Option<usize> {
    name.strip_prefix("part-")?.split('-').next()?.parse().ok()
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
    let Some(middle) = name.strip_prefix("part-").and_then(|name| name.strip_suffix(".parquet")) else { return false };
    let Some((part, key)) = middle.split_once('-') else { return false };
    let hexadecimal = |c: char| c.is_ascii_digit() || ('a'..='f').contains(&c);
    part.len() >= 5 && part.chars().all(|c| c.is_ascii_digit()) && key.len() == 16 && key.chars().all(hexadecimal)
}
