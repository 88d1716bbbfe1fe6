//! Every scenario of the repository from its start to its end (two long ones: to their first minutes): every sample is in equilibrium, and the run gives
//! the same bytes when it is continued from any snapshot, by any number of threads.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use contrapposto::model::{Adult, Model, adult};
use contrapposto::simulation::{Run, RunSettings, Scenario, Snapshot, Summary, run};
use contrapposto_formats::{osim, read_scenario, scenario_model};
use samples::{Worst, digest};

#[path = "common/samples.rs"]
mod samples;

/// Tired muscles, a load, a new strategy and a new target; taken up again between any of them.
const MUCH: &str = "[[event]]\nat_s = 10\nload = [{ segment = \"hand_r\", mass_kg = 6 }]\n\
    [[event]]\nat_s = 32\nstrategy = \"passive\"\n[[event]]\nat_s = 50\ntask = 1\ntarget_m = [0.35, 1.15, 0.1]\n\
    [[event]]\nat_s = 58\nstrategy_of = { spine = \"active\" }\nload = []\n\
    [fatigue]\ncritical_level = 0.1\nrecovery_level = 0.05\n";

/// Long runs that end earlier here, s: the rest of them repeats what `stand-shifting` shows in an hour.
const CUT: [(&str, f64); 2] = [("counter.toml", 300.0), ("sit-slumped.toml", 1000.0)];

/// All of them by name, and one in which much happens.
fn scenarios() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let mut texts: Vec<_> = paths.iter().map(|path| (name(path), std::fs::read_to_string(path).unwrap())).collect();
    let hold = &texts.iter().find(|(name, _)| name == "hold-tool.toml").unwrap().1;
    let much = hold.replace("duration_s = 480", "duration_s = 70") + "\n" + MUCH;
    texts.push(("hold-tool.toml, in which much happens".to_owned(), much));
    let read = |(name, text): (String, String)| {
        let file = scenario_model(&name, text.as_bytes()).unwrap();
        let model = file.map(|file| {
            let bytes = std::fs::read(folder.join(&file.file)).unwrap();
            with_strength(osim::read(&bytes, &file.file).unwrap().model().unwrap().model)
        });
        let scenario = read_scenario(&name, text.as_bytes(), model);
        let mut scenario = scenario.unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)));
        if let Some((_, end)) = CUT.iter().find(|(cut, _)| *cut == name) {
            assert!(scenario.run.duration > *end, "{name} need not be cut");
            scenario.run.duration = *end;
        }
        (name, scenario)
    };
    texts.into_iter().map(read).collect()
}

/// A model file knows no strength: the built-in adult's, by name.
fn with_strength(model: Model) -> Model {
    let adult = adult(&Adult::default()).unwrap();
    let known = |model: Model, i: usize| {
        let twin = adult.coordinate(&model.coordinates()[i].name).map(|twin| &adult.coordinates()[twin]);
        let groups = twin.and_then(|twin| twin.groups.clone());
        groups.map_or(model.clone(), |groups| model.with_groups(i, groups))
    };
    (0..model.coordinates().len()).fold(model, known)
}

/// In every sample of every scenario: forces on the root are zero, torques add up, feet stay, ground only pushes, within its
/// friction and inside the patch.
#[test]
fn every_sample_is_in_equilibrium() {
    for (name, scenario) in scenarios() {
        if scenario.supports.is_empty() {
            continue;
        }
        let mut worst = Worst::default();
        run(&scenario, |sample| worst.take(&scenario, sample)).unwrap();
        worst.is_held(&name);
        assert!(worst.slip < 1.0, "{name}"); // less than a result warns of
    }
}

/// A run from start to end: what each sample shows, the marks at which it can be taken up again, and what it comes to.
struct Course {
    shown: Vec<u64>,
    marks: Vec<Snapshot>,
    summary: Summary,
}

impl Course {
    fn of(scenario: &Scenario) -> Self {
        let mut run = Run::new(scenario).unwrap();
        let (mut shown, mut marks) = (vec![], vec![run.snapshot().clone()]);
        while let Some(sample) = run.next_sample().unwrap() {
            shown.push(digest(&sample));
            if marks.last().is_some_and(|mark| mark.samples < run.snapshot().samples) {
                marks.push(run.snapshot().clone());
            }
        }
        Self { shown, marks, summary: run.summary() }
    }

    /// From a mark the run comes to the next one, or to the end, in the same way and to the same state: what holds for every
    /// mark holds from each of them to the end.
    fn is_repeated_from(&self, mark: usize, scenario: &Scenario) {
        let first = self.marks[mark].samples as usize;
        let next = self.marks.get(mark + 1);
        // A mark is set by the sample after it.
        let last = next.map_or(self.shown.len(), |next| next.samples as usize + 1);
        let mut again = Run::resume(scenario, self.marks[mark].clone()).unwrap();
        for (i, &shown) in self.shown.iter().enumerate().take(last).skip(first) {
            let sample = again.next_sample().unwrap().unwrap();
            assert!(digest(&sample) == shown, "{}: sample {i} from mark {mark} is another one", scenario.title);
        }
        match next {
            Some(next) => assert!(again.snapshot() == next, "{}: mark {mark} leads elsewhere", scenario.title),
            None => {
                assert!(again.next_sample().unwrap().is_none());
                assert_eq!(again.summary(), self.summary);
            }
        }
    }
}

fn with_threads(scenario: &Scenario, threads: usize) -> Scenario {
    Scenario { run: RunSettings { threads, ..scenario.run }, ..scenario.clone() }
}

/// Alone from start to end, then from every mark to the next one: every third mark by two threads, every third by three, by
/// eight; and each start by as many threads for its search.
#[test]
fn every_run_is_the_same_from_every_mark_and_for_any_number_of_threads() {
    let scenarios: Vec<Scenario> = scenarios().into_iter().map(|(_, scenario)| scenario).collect();
    let courses: Vec<Course> = scenarios.iter().map(Course::of).collect();
    for (scenario, course) in scenarios.iter().zip(&courses) {
        println!("{}: {} samples, {} marks", scenario.title, course.shown.len(), course.marks.len());
        assert!(course.marks.len() >= 3 || !scenario.has_supports_or_tasks(), "no share for each number of threads");
    }
    for (share, threads) in [2, 3, 8].into_iter().enumerate() {
        let mut pieces = vec![];
        let threaded: Vec<Scenario> = scenarios.iter().map(|scenario| with_threads(scenario, threads)).collect();
        for (of_all, (scenario, course)) in threaded.iter().zip(&courses).enumerate() {
            if of_all % 3 == share {
                let begun = Run::new(scenario).unwrap();
                assert!(begun.snapshot() == &course.marks[0], "{}: {threads} threads begin elsewhere", scenario.title);
            }
            let marks = (0..course.marks.len()).filter(|mark| course.marks.len() < 3 || mark % 3 == share);
            pieces.extend(marks.map(|mark| (course, mark, scenario)));
        }
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some((course, mark, scenario)) = pieces.get(next.fetch_add(1, Ordering::Relaxed)) {
                course.is_repeated_from(*mark, scenario);
            }
        };
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
        println!("{threads} threads: {} pieces the same", pieces.len());
    }
}
