//! Every scenario of the repository, run once from its start to its end for all tests that look at whole runs; and the postures of least effort
//! that its body finds, searched for once.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use contrapposto::equilibria::{Equilibria, equilibria};
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture_solver::Options;
use contrapposto::simulation::{Run, Scenario, Snapshot, Summary};
use contrapposto_formats::{RelaxScenario, osim, read_relax, read_scenario, scenario_model};

use super::on_all_cores;
use super::samples::{Worst, digest};

/// Samples from one posture that is kept to the next one.
const KEPT: usize = 30;

/// Tired muscles, a load, a new strategy and a new target; taken up again between any of them.
const MUCH: &str = "[[event]]\nat_s = 10\nload = [{ segment = \"hand_r\", mass_kg = 6 }]\n\
    [[event]]\nat_s = 32\nstrategy = \"passive\"\n[[event]]\nat_s = 50\ntask = 1\ntarget_m = [0.35, 1.15, 0.1]\n\
    [[event]]\nat_s = 58\nstrategy_of = { spine = \"active\" }\nload = []\n\
    [fatigue]\ncritical_level = 0.1\nrecovery_level = 0.05\n";

/// The folder of the scenarios.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// The texts of all scenarios by name.
fn texts() -> Vec<(String, String)> {
    let mut paths: Vec<_> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), std::fs::read_to_string(path).unwrap())).collect()
}

/// All of them by name, and one in which much happens.
fn scenarios() -> Vec<(String, Scenario)> {
    let mut texts = texts();
    let hold = &texts.iter().find(|(name, _)| name == "hold-tool.toml").unwrap().1;
    let much = hold.replace("duration_s = 480", "duration_s = 70") + "\n" + MUCH;
    texts.push(("hold-tool.toml, in which much happens".to_owned(), much));
    let read = |(name, text): (String, String)| {
        let file = scenario_model(&name, text.as_bytes()).unwrap();
        let model = file.map(|file| {
            let bytes = std::fs::read(folder().join(&file.file)).unwrap();
            with_strength(osim::read(&bytes, &file.file).unwrap().model().unwrap().model)
        });
        let scenario = read_scenario(&name, text.as_bytes(), model);
        let scenario = scenario.unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)));
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

/// A posture of a run.
pub struct Kept {
    pub values: Vec<f64>,
    /// A hand or a foot has been put elsewhere by then.
    pub put_down: bool,
}

/// A run from start to end.
pub struct Course {
    /// Name of the file.
    pub name: String,
    pub scenario: Scenario,
    /// The bits of each sample.
    pub shown: Vec<u64>,
    /// The states from which the run can be taken up again.
    pub marks: Vec<Snapshot>,
    pub summary: Summary,
    /// The worst of all samples, of a body on supports.
    pub worst: Worst,
    /// Every thirtieth posture, and the last one.
    pub postures: Vec<Kept>,
}

impl Course {
    fn of(name: String, scenario: Scenario) -> Self {
        let mut run = Run::new(&scenario).unwrap();
        let (mut shown, mut marks, mut postures) = (vec![], vec![run.snapshot().clone()], vec![]);
        let (mut worst, mut put_down, mut last) = (Worst::default(), false, vec![]);
        while let Some(sample) = run.next_sample().unwrap() {
            put_down |= sample.stepping;
            if shown.len() % KEPT == 0 {
                postures.push(Kept { values: sample.posture.to_vec(), put_down });
            }
            last.clear();
            last.extend_from_slice(sample.posture);
            shown.push(digest(&sample));
            if !scenario.supports.is_empty() {
                worst.take(&scenario, &sample);
            }
            if marks.last().is_some_and(|mark| mark.samples < run.snapshot().samples) {
                marks.push(run.snapshot().clone());
            }
        }
        postures.push(Kept { values: last, put_down });
        let summary = run.summary();
        Self { name, scenario, shown, marks, summary, worst, postures }
    }
}

/// The runs of all scenarios.
pub fn courses() -> &'static [Course] {
    static COURSES: OnceLock<Vec<Course>> = OnceLock::new();
    COURSES.get_or_init(|| on_all_cores(scenarios(), |(name, scenario)| Course::of(name, scenario)))
}

/// The scenarios of the built-in adult on supports whose postures of least effort can be searched for, each with these postures.
pub fn searches() -> &'static [(String, RelaxScenario, Equilibria)] {
    static SEARCHES: OnceLock<Vec<(String, RelaxScenario, Equilibria)>> = OnceLock::new();
    SEARCHES.get_or_init(|| {
        let readable =
            texts().into_iter().filter(|(name, text)| scenario_model(name, text.as_bytes()).unwrap().is_none());
        let read = readable.filter_map(|(name, text)| Some((read_relax(&name, text.as_bytes(), None).ok()?, name)));
        let on_supports = read.filter(|(scenario, _)| !scenario.supports.is_empty());
        on_all_cores(on_supports.collect(), |(scenario, name)| {
            let options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };
            let found = equilibria(&scenario.search(), options).unwrap();
            (name, scenario, found)
        })
    })
}
