//! Random worlds: bodies of the library and of files, with muscles or without, on feet or a seat with tasks, loads, things, events and
//! strategies at random, run for some seconds. Every sample keeps what the program promises, a second run with another number of threads gives
//! the same bits, and so does one that is resumed from a snapshot. `CONTRAPPOSTO_DIGESTS` names a file that gets a line of each world with all
//! bits of its samples, to compare two builds.

use crate::common::{processor_time, samples};
mod body;
#[path = "../../../contrapposto/tests/no_chatter/judge.rs"]
mod judge;
mod targets;
mod world;

use std::io::Write;

use contrapposto::contact::Slip;
use contrapposto::simulation::{Run, Scenario, ScenarioError, Snapshot, StopReason};
use contrapposto::verdict::Verdict;
use contrapposto_formats::read_scenario;
use judge::{Findings, Judge};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg as Random;
use samples::{Worst, digest};
use targets::Targets;
use world::World;

/// Worlds of the suite; `CONTRAPPOSTO_WORLDS` asks for others.
const WORLDS: u64 = 6;
/// A slower step than this, s, is a finding; said, not judged, since it depends on the machine.
const SLOW: f64 = 1.0;

/// A run to its end: the bits of each sample.
struct Course {
    digests: Vec<u64>,
    worst: Worst,
    targets: Targets,
    findings: Findings,
    /// The last snapshot: after 900 samples, else that of the start.
    snapshot: Snapshot,
    /// Processor time of the slowest step, or of the start, s.
    slowest: f64,
}

fn course(scenario: &Scenario) -> Result<(Course, StopReason), ScenarioError> {
    let begin = processor_time();
    let mut run = Run::new(scenario)?;
    let mut slowest = processor_time() - begin;
    println!("  start found in {slowest:.2?} of processor, {} solver steps", run.solver_steps());
    let (mut digests, mut worst) = (vec![], Worst::default());
    let (mut targets, mut judge) = (Targets::default(), Judge::new(scenario));
    loop {
        let begin = processor_time();
        let Some(sample) = run.next_sample()? else { break };
        worst.take(scenario, &sample);
        targets.take(scenario, &sample);
        judge.take(&sample);
        digests.push(digest(&sample));
        slowest = slowest.max(processor_time() - begin);
    }
    let summary = run.summary();
    let verdict = Verdict::of_run(scenario, &summary);
    println!("  {}", verdict.sentence);
    assert!(!verdict.sentence.contains("NaN") && !verdict.sentence.contains("inf "), "{}", verdict.sentence);
    let (slip, _) = summary.slip.unwrap();
    assert_eq!(slip.share_of(Slip::NOTICED), worst.slip, "the greatest slip of the summary is that of the samples");
    assert!(summary.sliding_since.is_some() || summary.standing.is_some_and(|end| !end.slip.exceeds(Slip::GREATEST)));
    let (snapshot, findings) = (run.snapshot().clone(), judge.findings());
    let slowest = slowest.as_secs_f64();
    Ok((Course { digests, worst, targets, findings, snapshot, slowest }, summary.reason))
}

#[test]
fn random_worlds_keep_the_promises_of_every_sample_and_repeat_to_the_bit() {
    let environment = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let (count, first) =
        (environment("CONTRAPPOSTO_WORLDS").unwrap_or(WORLDS), environment("CONTRAPPOSTO_SEED").unwrap_or(1));
    let mut bits = std::env::var_os("CONTRAPPOSTO_DIGESTS").map(|name| std::fs::File::create(name).unwrap());
    let (mut held, mut refused, mut slid, mut slow, mut all) = (0, 0, 0, 0, Findings::default());
    for seed in first..first + count {
        let world = World::random(&mut Random::seed_from_u64(seed));
        println!("seed {seed}: {:?}", world.body.kind);
        let scenario = world.scenario().unwrap_or_else(|error| panic!("seed {seed}: {error}\n{}", world.text));
        match course(&scenario) {
            // A world in which nothing holds the body is refused by name.
            Err(ScenarioError::CannotStand(_) | ScenarioError::Falls(_)) => refused += 1,
            Err(other) => panic!("seed {seed}: {other}\n{}", world.text),
            Ok((course, reason)) => {
                held += 1;
                slid += u64::from(reason == StopReason::Slid);
                slow += u64::from(course.slowest > SLOW);
                let name = format!("seed {seed}, slowest step {:.2} s\n{}", course.slowest, world.text);
                course.worst.is_held(&name);
                course.targets.are_kept(&name);
                course.keeps_what_relief_promises(&name);
                all.add(&course.findings);
                repeats(&world.with_threads(&scenario), &course, seed);
                if let Some(file) = &mut bits {
                    writeln!(file, "{seed} {:?}", course.digests).unwrap();
                }
            }
        }
    }
    println!(
        "{count} worlds: {held} ran ({slid} of them slid, {slow} had a step over {SLOW} s), {refused} cannot stand; {all:?}"
    );
    assert!(held >= count / 2, "the generator makes worlds in which bodies stand");
}

/// Worlds in which an error above relief once rose by 1 mm to 2 cm: the solver moved what a level above held (869; 853 is kept since that was
/// mended, too), the judge did not count what a foot carries beyond its share (368), or a whole step left as much of second order (962). In 358, 433 and 460 a
/// foot carried 0.1 to 27 % of the weight beyond its share for a while, in 1843 13 % in one sample: half of a step still led to the very edge of the
/// supports.
#[test]
fn errors_above_relief_rise_by_less_than_a_millimetre_where_they_once_rose_by_more() {
    for seed in [358, 368, 433, 460, 853, 869, 962, 1843] {
        let world = World::random(&mut Random::seed_from_u64(seed));
        let (course, _) = course(&world.scenario().unwrap()).unwrap();
        course.targets.are_kept(&format!("seed {seed}"));
    }
}

/// A world in which supports once stayed 2.4 mm off their places under 13.5 kg that an event puts into a hand: steps became ever shorter, since tasks and
/// effort rose while the supports came back.
#[test]
fn supports_are_back_in_their_places_once_a_body_has_recovered_its_balance() {
    let world = World::random(&mut Random::seed_from_u64(348));
    let scenario = world.scenario().unwrap();
    let (course, reason) = course(&scenario).unwrap();
    assert!(!scenario.events.is_empty() && reason == StopReason::Duration);
    assert!(course.worst.slip < 1.0, "{} times what is noticed", course.worst.slip);
    course.targets.are_kept("seed 348");
}

/// Worlds in which the body once went back and forth by 2 to 14 mm, before a target out of reach or at an arm's end, while a relief asked for motion.
#[test]
fn a_body_before_a_target_out_of_reach_does_not_quiver_while_a_relief_asks_for_motion() {
    for seed in [404, 470, 558, 894] {
        let world = World::random(&mut Random::seed_from_u64(seed));
        let (course, _) = course(&world.scenario().unwrap()).unwrap();
        course.targets.are_kept(&format!("seed {seed}"));
    }
}

/// A world that misses a target after an event, and has a snapshot then.
#[test]
fn a_run_that_misses_a_target_after_an_event_is_the_same_from_its_snapshot() {
    let seed = 260;
    let world = World::random(&mut Random::seed_from_u64(seed));
    let scenario = world.scenario().unwrap();
    let (course, _) = course(&scenario).unwrap();
    assert!(course.snapshot.samples > 0 && !scenario.events.is_empty());
    repeats(&world.with_threads(&scenario), &course, seed);
}

impl Course {
    /// No goal is taken up again, and no step of a relief raises effort above its factor.
    fn keeps_what_relief_promises(&self, name: &str) {
        let Findings { violations, wrong_attempts, efforts_above, .. } = self.findings;
        assert_eq!((violations, wrong_attempts, efforts_above), (0, 0, 0), "{name}: {:?}", self.findings);
    }
}

/// Random scenarios that once took up to 22 s of processor: no step, nor the start, takes 10 s, and all repeat to the bit.
#[test]
fn slow_worlds_take_less_than_ten_seconds_of_processor_a_step() {
    const MOST_SECONDS: f64 = 10.0;
    let files: [(&str, &[u8]); 3] = [
        ("10035", include_bytes!("slow-10035.toml")),
        ("10214", include_bytes!("slow-10214.toml")),
        ("10338", include_bytes!("slow-10338.toml")),
    ];
    let files = files.map(|(name, bytes)| (name, read_scenario(name, bytes, None).unwrap()));
    // Three tired groups ask for a step at once: each search took four seconds, and was made three times.
    let world = World::random(&mut Random::seed_from_u64(259)).scenario().unwrap();
    for (name, scenario) in files.into_iter().chain([("259", world)]) {
        let begin = processor_time();
        let mut run = Run::new(&scenario).unwrap();
        let mut slowest = processor_time() - begin;
        println!("{name}: the start took {slowest:?} of processor");
        let mut digests = vec![];
        loop {
            let begin = processor_time();
            let Some(sample) = run.next_sample().unwrap() else { break };
            digests.push(digest(&sample));
            slowest = slowest.max(processor_time() - begin);
        }
        println!("{name}: the slowest step, or the start, took {slowest:?} of processor");
        assert!(slowest.as_secs_f64() < MOST_SECONDS, "{name}: {slowest:?}");
        let mut again = Run::new(&scenario).unwrap();
        let mut expected = digests.iter();
        while let Some(sample) = again.next_sample().unwrap() {
            assert_eq!(Some(&digest(&sample)), expected.next(), "{name}");
        }
        assert_eq!(expected.next(), None, "{name}");
    }
}

/// A second run of the scenario, and one from the snapshot, show the same bits.
fn repeats(scenario: &Scenario, course: &Course, seed: u64) {
    for mut run in [Run::new(scenario).unwrap(), Run::resume(scenario, course.snapshot.clone()).unwrap()] {
        let first = run.snapshot().samples as usize;
        for (i, expected) in course.digests.iter().enumerate().skip(first) {
            let sample = run.next_sample().unwrap().unwrap_or_else(|| panic!("seed {seed}: it ends before sample {i}"));
            assert_eq!(digest(&sample), *expected, "seed {seed}: sample {i} is another one");
        }
        assert!(run.next_sample().unwrap().is_none(), "seed {seed}");
    }
}
