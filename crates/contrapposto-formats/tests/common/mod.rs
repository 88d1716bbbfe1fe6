//! Shared by the tests of this crate: files, mutants and their times, and forward kinematics of a [`ModelIr`] from its description alone.

pub mod c3d;
#[allow(dead_code, reason = "the benchmark of capacities uses the rest")]
pub mod hands;
pub mod muscle_reference;
pub mod muscled_arm;
pub mod peer;
pub mod runs;
pub mod samples;
pub mod shared;
pub mod toml;

pub use self::shared::shared;
use contrapposto_formats::InputError;
use contrapposto_formats::model_ir::{Drive, ModelIr, MotionIr};
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use std::path::Path;
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Everything that a reader says about what it refuses. Printing it must not panic either.
pub fn complaint(error: &InputError) -> String {
    let mut text = String::new();
    miette::NarratableReportHandler::new().render_report(&mut text, error).unwrap();
    text
}

/// The results of `work` for each item, in their order, computed on all cores.
pub fn on_all_cores<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    let (left, done) = (Mutex::new(items.into_iter().enumerate()), Mutex::new(vec![]));
    let next = || left.lock().unwrap().next();
    let until_none_is_left = || {
        while let Some((i, item)) = next() {
            let made = work(item);
            done.lock().unwrap().push((i, made));
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    std::thread::scope(|scope| (0..cores).for_each(|_| drop(scope.spawn(until_none_is_left))));
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, made)| made).collect()
}

pub fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Frames of all segments, given all coordinates (couplings are the caller's).
pub fn frames(body: &ModelIr, q: &[f64]) -> Vec<Isometry3<f64>> {
    let mut frames: Vec<Isometry3<f64>> = vec![];
    let value = |drive: &Drive| match drive {
        Drive::Coordinate(i) => q[*i],
        Drive::Function(function, i) => function.value(q[*i]),
        Drive::Fixed(c) => *c,
    };
    for segment in &body.segments {
        let mut frame = segment.parent.map_or(Isometry3::identity(), |p| frames[p]) * segment.in_parent;
        for motion in &segment.motions {
            frame *= match motion {
                MotionIr::Hinge { axis, drive } => Isometry3::from_parts(
                    Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&Unit::new_normalize(*axis), value(drive)),
                ),
                MotionIr::Slide { axis, drive } => Isometry3::from(Translation3::from(axis * value(drive))),
                MotionIr::Ball { first } => {
                    let q = Quaternion::new(q[*first], q[first + 1], q[first + 2], q[first + 3]);
                    Isometry3::from_parts(Translation3::identity(), UnitQuaternion::new_normalize(q))
                }
            };
        }
        frames.push(frame * segment.in_segment.inverse());
    }
    frames
}

pub fn center_of_mass(body: &ModelIr, q: &[f64]) -> Vector3<f64> {
    let frames = frames(body, q);
    let at = |(s, f): (&contrapposto_formats::model_ir::SegmentIr, &Isometry3<f64>)| {
        (f * nalgebra::Point3::from(s.center_of_mass)).coords * s.mass
    };
    let sum: Vector3<f64> = body.segments.iter().zip(&frames).map(at).sum();
    sum / body.segments.iter().map(|s| s.mass).sum::<f64>()
}

/// Largest absolute difference of two lists, divided by the larger of 1 and the largest expected value.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(1.0_f64, |a, b| a.max(b.abs()));
    found.iter().zip(expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / scale
}

/// Constants of a seeded generator that is good enough to choose bytes.
pub fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

/// Changes a few bytes or inserts parts of the format.
pub fn mutate(base: &[u8], parts: &[&str], state: &mut u64) -> Vec<u8> {
    let mut bytes = base.to_vec();
    for _ in 0..=next(state) % 4 {
        let at = next(state) % (bytes.len() + 1);
        match next(state) % 5 {
            0 => bytes.insert(at, next(state) as u8),
            1 => drop(bytes.splice(at..at, parts[next(state) % parts.len()].bytes())),
            2 => drop(bytes.drain(at..(at + next(state) % 12).min(bytes.len()))),
            3 if at < bytes.len() => bytes[at] = b"0123456789.-e \"<>"[next(state) % 17],
            _ => {
                // Copies a stretch elsewhere: repeats elements, moves attributes.
                let to = next(state) % (bytes.len() + 1);
                let stretch = bytes[at..(at + next(state) % 80).min(bytes.len())].to_vec();
                drop(bytes.splice(to..to, stretch));
            }
        }
    }
    bytes
}

/// Longest time that a mutated input may take.
const LONGEST: Duration = Duration::from_secs(1);

/// Reads mutated inputs, the bases in turn, and holds each to a second and all to 64 MiB. `read` tells whether it accepted
/// its input, and panics if what it read is not sound. `CONTRAPPOSTO_MUTATIONS` sets how many; ten million of each format:
///
/// ```text
/// CONTRAPPOSTO_MUTATIONS=10000000 cargo test -p contrapposto-formats mutated -- --nocapture --test-threads 1
/// ```
pub fn hammer(format: &str, seed: u64, usual: usize, bases: &[&[u8]], parts: &[&str], read: impl FnMut(&[u8]) -> bool) {
    hammer_mutants(format, seed, usual, |i, state| mutate(bases[i % bases.len()], parts, state), read);
}

/// [`hammer`] with what `mutant` makes of the number of the input and the state of [`next`].
pub fn hammer_mutants(
    format: &str,
    seed: u64,
    usual: usize,
    mut mutant: impl FnMut(usize, &mut u64) -> Vec<u8>,
    mut read: impl FnMut(&[u8]) -> bool,
) {
    let asked: Option<usize> = std::env::var("CONTRAPPOSTO_MUTATIONS").ok().and_then(|s| s.parse().ok());
    let count = asked.unwrap_or(usual);
    let (mut state, mut accepted, mut slowest) = (seed, 0, Duration::ZERO);
    let (start, before) = (Instant::now(), peak_memory());
    for i in 0..count {
        let text = mutant(i, &mut state);
        let mut timed = || {
            let begin = processor_time();
            (read(&text), processor_time() - begin)
        };
        let (is_accepted, mut time) = timed();
        accepted += usize::from(is_accepted);
        // Other programs slow a thread down on its processor, too: of a slow input the least of three times counts.
        for _ in 0..2 {
            if time >= LONGEST {
                time = time.min(timed().1);
            }
        }
        slowest = slowest.max(time);
    }
    let grown = peak_memory().saturating_sub(before) >> 10;
    println!(
        "{format}: seed {seed}, {count} inputs, {accepted} accepted, slowest {slowest:.1?}, {grown} MiB more, {:.1?}",
        start.elapsed()
    );
    assert!(slowest < LONGEST, "{format}: {slowest:?}");
    assert!(asked.is_none() || grown < 64, "{format}: {grown} MiB"); // usually other tests run beside
    assert!(accepted > count / 50 && accepted < count, "{format}: {accepted} of {count} accepted");
}

/// Time of this thread on the processor, where the system tells it: other tests and programs do not count.
pub fn processor_time() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let on_processor = statistics.split(' ').next().and_then(|ns| ns.parse().ok());
    on_processor.map_or_else(|| START.get_or_init(Instant::now).elapsed(), Duration::from_nanos)
}

/// Largest memory of the process so far, KiB; 0 where the system does not tell.
fn peak_memory() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.and_then(|text| text.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Eight times as much takes less than 24 times as long, after what `work` makes of a size: quadratic work would take 64 times
/// as long, linear work that leaves the caches up to twice eight times. Time on the processor where the system tells it: other
/// programs do not count. Some systems count that time in steps of 10 ms, so that each size is worked on for a tenth of a
/// second at least. Machines are busy all the same: one of ten measurements must do.
pub fn assert_linear<T>(name: &str, size: usize, make: impl Fn(usize) -> T, work: impl Fn(&T)) {
    let time = |input: &T| {
        let (begin, busy) = (Instant::now(), processor_time());
        let mut repeats = 0.0;
        while begin.elapsed() < Duration::from_millis(100) {
            work(input);
            repeats += 1.0;
        }
        (processor_time() - busy).as_secs_f64() / repeats
    };
    let (small, large) = (make(size), make(8 * size));
    let mut best = f64::INFINITY;
    for _ in 0..10 {
        best = best.min(time(&large) / time(&small));
        if best < 16.0 {
            break;
        }
    }
    println!("{name}, {size} and eight times as much: {best:.2} times as long");
    assert!(best < 24.0, "{name}: {best}");
}
