//! `contrapposto pose`: one posture from tasks in order of priority.

use std::slice::from_ref;

use contrapposto::contact::{Balance, Slip};
use contrapposto::equilibria::{Aim, Search, equilibria};
use contrapposto::posture_solver::{Engine, EngineError, Options, Reason, SolvedPosture};
use contrapposto::suggestions::{Advice, Change, Job, Trial, changes};
use contrapposto::tasks::{PriorityLevel, Task};
use contrapposto::verdict::{HandLoad, HeldPosture, Missed, Verdict};
use contrapposto_formats::motion::{opensim_columns, write_csv, write_sto};
use contrapposto_formats::tissue::fatigue_notes;
use contrapposto_formats::{PoseScenario, PoseText, read_pose};
use contrapposto_plot::body_figure;

use super::relax::{MOST_STRENGTH_ROUNDS, SAME_STRENGTH, unsettled};
use crate::args::{PoseArgs, SuggestArgs};
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print, print_note, report_line};
use crate::progress::{TRYING_CHANGES, spinner};
use crate::scenario_file::ScenarioFile;
use crate::view::animation::steps;
use crate::view::answer::{Answer, answered};
use crate::view::held::{Held, held};
use crate::view::muscle_work::{MusclesAtWork, muscles_at_work};
use crate::view::pose_picture::pose_picture;
use crate::view::report::pose::{figures_of_pose, report_of_pose};
use crate::view::stage::Stage;
use crate::view::text::pose::{report, subtitle};

const POSE_FILES: [&str; 8] =
    ["pose.json", "report.html", "pose.mot", "pose.csv", "pose.svg", "pose.png", "pose.glb", "pose.bvh"];

/// Largest change of a joint in a step toward a posture in balance, rad, and most of these steps.
const BALANCE_STEP: f64 = 0.1;
const BALANCE_STEPS: usize = 300;
/// Most work of the search where these steps end in a fall: about ten seconds on one core (assumed).
const MOST_BALANCE_WORK: usize = 30_000;
/// The note about a posture that had to be brought into balance.
const KEPT_BALANCE: &str = "the posture nearest to the tasks falls, and no task asks for balance: balance over the supports came before the \
     tasks, as in `relax` and `simulate`";

pub(crate) fn pose(args: &PoseArgs) -> Result<(), Fail> {
    let file = ScenarioFile::read_from(&args.scenario, args.start_from.as_deref())?;
    let name = file.name.clone();
    let mut scenario = read(file)?;
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &POSE_FILES)).transpose()?;
    let solving = spinner("solving for the posture");
    let posed = posed(&name, &mut scenario);
    solving.finish();
    let Posed { pose, held, kept_balance, .. } = with_notes(posed?);
    let figures = if args.figures { figures_of_pose(&scenario, &pose)? } else { vec![] };
    let names = POSE_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str())).map(str::to_owned);
    let files = if args.out.is_some() { names.collect() } else { vec![] };
    let trying = spinner(TRYING_CHANGES);
    let answer = answer(&scenario, &pose, &held, args.suggest);
    trying.finish();
    let muscles = muscles_at_work(&scenario.model, scenario.muscles.as_ref(), from_ref(&held.frame), |_| true)?;
    let text = PoseText::new(&scenario, &pose, (&answer.verdict, &answer.advice), files);
    let text = PoseText { muscle_work: muscles.as_ref().map(MusclesAtWork::text), ..text };
    let json = json_text("pose.json", &text)?;
    if let Some(folder) = &folder {
        let held = (held, muscles.as_ref());
        write(&scenario, (&pose, kept_balance), (&text, &json, &answer), &figures, held, (folder, args.wooden))?;
    }
    print(&if args.json {
        json
    } else {
        let tables = report(&scenario, (&pose, kept_balance), &text, &answer.verdict)
            + &muscles.map_or_else(String::new, |muscles| muscles.table());
        answer.in_words(&scenario.model, &scenario.title, &tables) + &report_line(folder.as_ref())
    })?;
    exit(&pose, kept_balance, &answer.verdict)
}

/// The scenario of a file; notes about it go to standard error.
pub(crate) fn read(file: ScenarioFile) -> Result<PoseScenario, Fail> {
    let ScenarioFile { name, bytes, model, muscles } = file;
    let mut scenario = read_pose(&name, &bytes, model)?;
    scenario.take_muscles(muscles);
    if !scenario.unused.is_empty() {
        let list: Vec<String> = scenario.unused.iter().map(|table| format!("[{table}]")).collect();
        print_note("note", &format!("{} is ignored by `pose`; it is for `simulate`", list.join(", ")));
    }
    scenario.notes.iter().for_each(|note| print_note("note", note));
    fatigue_notes(&scenario.model).iter().for_each(|note| print_note("note", note));
    Ok(scenario)
}

/// Writes all files.
fn write(
    scenario: &PoseScenario,
    (pose, kept_balance): (&SolvedPosture, bool),
    (text, json, answer): (&PoseText, &str, &Answer),
    figures: &[(String, Vec<u8>)],
    (held, muscles): (Held, Option<&MusclesAtWork<'_>>),
    (folder, wooden): (&ResultSet, bool),
) -> Result<(), Fail> {
    let columns: Vec<_> = scenario.model.coordinates().iter().map(|c| (c.name.as_str(), c.kind)).collect();
    let rows = [pose.posture.values()];
    let title = if scenario.title.is_empty() { "pose" } else { &scenario.title };
    let of_mot = opensim_columns(&scenario.model);
    let mot = write_sto(title, &of_mot, true, &[0.0], &rows).map_err(|error| Fail::job("pose.mot", error))?;
    let csv = write_csv(&columns, &[0.0], &rows).map_err(|error| Fail::job("pose.csv", error))?;
    let picture = body_figure(&pose_picture(scenario, (pose, muscles), &subtitle(text))?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let frame = held.frame.clone();
    let page = report_of_pose(scenario, (pose, kept_balance), (text, answer), (held, muscles))?;
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let shown = (from_ref(&frame), muscles);
    let [gltf, bvh] = steps(["pose.glb", "pose.bvh"], (&scenario.model, &stage), title, shown, wooden)?;
    let texts = [json, &page, &mot, &csv, &svg].map(str::as_bytes);
    let contents = texts.into_iter().chain([png.as_slice(), &gltf, &bvh]);
    let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    folder.write(&POSE_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())
}

/// The note about such a posture where the steps ended before effort was least.
const STILL_FALLING: &str = "the effort of this posture still fell when the steps toward balance ended; `relax` searches for postures of less effort";

/// The posture that was solved for.
pub(crate) struct Posed {
    pub(crate) pose: SolvedPosture,
    pub(crate) held: Held,
    /// Balance was put above the tasks, because the posture nearest to them falls.
    pub(crate) kept_balance: bool,
    /// The last change of a strength of muscles, as a share, where it has not settled.
    unsettled: Option<f64>,
}

/// Solves for the posture of a scenario named `name`, with the errors of its goals. Where the supports do not hold the one nearest to the tasks, and no task asks for balance, balance comes first.
pub(crate) fn solve(name: &str, scenario: &mut PoseScenario) -> Result<Posed, Fail> {
    Ok(with_notes(posed(name, scenario)?))
}

/// Prints the notes about a posture to standard error.
fn with_notes(posed: Posed) -> Posed {
    if let Some(change) = posed.unsettled {
        print_note("warning", &unsettled("the posture", change));
    }
    if posed.kept_balance {
        print_note("note", KEPT_BALANCE);
        if posed.pose.reason == Reason::StepLimit {
            print_note("note", STILL_FALLING);
        }
    }
    posed
}

/// As [`solve`], without a word. A body with muscles has the strength of that posture: where effort counts it is solved for again until
/// that stays.
fn posed(name: &str, scenario: &mut PoseScenario) -> Result<Posed, Fail> {
    let asks = |goal: &PriorityLevel| goal.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
    let effort = scenario.goals.iter().any(asks);
    let mut round = 0;
    loop {
        let mut posed = posed_once(name, scenario)?;
        let change = scenario.take_strength(&posed.pose.posture);
        let settles = change <= SAME_STRENGTH || !effort;
        if settles || round == MOST_STRENGTH_ROUNDS {
            posed.held = held(&scenario.model, &posed.pose.posture, &scenario.loads, &scenario.supports)?;
            posed.unsettled = (!settles).then_some(change);
            return Ok(posed);
        }
        round += 1;
    }
}

/// The posture at the strength that the body has.
fn posed_once(name: &str, scenario: &PoseScenario) -> Result<Posed, Fail> {
    let refused = |error: EngineError| Fail::Refused(format!("{name}: {error}"));
    let failed = |error| Fail::job("pose", error);
    let (levels, limits) = scenario.levels();
    let mut engine = Engine::new(&scenario.model, levels, &scenario.loads, scenario.options).map_err(refused)?;
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    let mut pose = engine.solve(&scenario.start).map_err(failed)?;
    let held_at = |pose: &SolvedPosture| held(&scenario.model, &pose.posture, &scenario.loads, &scenario.supports);
    let mut held = held_at(&pose)?;
    let balanced = if held.missing.is_some() { in_balance(scenario, &pose).map_err(failed)? } else { None };
    let kept_balance = balanced.is_some();
    if let Some(balanced) = balanced {
        let levels = engine.report(&balanced.posture).map_err(failed)?;
        pose = SolvedPosture { levels, steps: pose.steps + balanced.steps, ..balanced };
        held = held_at(&pose)?;
    }
    // The limits are not among the goals that are reported.
    limits.map(|place| pose.levels.remove(place));
    Ok(Posed { pose, held, kept_balance, unsettled: None })
}

/// The posture nearest to the tasks among those that the supports hold; `None` where a task asks for balance, and where none was found.
fn in_balance(scenario: &PoseScenario, falls: &SolvedPosture) -> Result<Option<SolvedPosture>, EngineError> {
    let goals: Vec<PriorityLevel> = scenario.goals.iter().filter(|goal| !goal.hard).cloned().collect();
    let asks = |task: &Task| matches!(task, Task::CenterOfMass(_));
    if goals.iter().flat_map(|goal| &goal.tasks).any(asks) {
        return Ok(None);
    }
    let options =
        Options { max_step: BALANCE_STEP, max_steps: BALANCE_STEPS, local_minima: 0, ..Options::least_effort() };
    let (model, supports) = (&scenario.model, scenario.supports.clone());
    let mut engine = Engine::with_supports(model, &scenario.start, supports, goals.clone(), &scenario.loads, options)?;
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    scenario.limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
    let pose = engine.solve(&falls.posture)?;
    Ok((pose.balance == Balance::Held).then_some(pose).or_else(|| least_effort_in_balance(scenario, &goals)))
}

/// The posture of least effort that the search of `relax` finds, for where the steps toward balance end in a fall.
fn least_effort_in_balance(scenario: &PoseScenario, goals: &[PriorityLevel]) -> Option<SolvedPosture> {
    let search = Search {
        model: &scenario.model,
        start: &scenario.start,
        supports: &scenario.supports,
        goals,
        limits: &scenario.limits,
        loads: &scenario.loads,
        locked: &scenario.locked,
        most_work: MOST_BALANCE_WORK,
        scattered: contrapposto::equilibria::SCATTERED_STARTS,
        aim: Aim::Ways,
        threads: 1,
    };
    let found = equilibria(&search, Options { local_minima: 0, ..Options::least_effort() }).ok()?;
    found.postures.into_iter().next().map(|best| best.relaxed)
}

/// The answer, with the changes that were tried.
pub(crate) fn answer(scenario: &PoseScenario, pose: &SolvedPosture, held: &Held, suggest: SuggestArgs) -> Answer {
    let verdict = verdict(scenario, pose, held);
    let advice = advice(scenario, &verdict, pose.steps, suggest);
    Answer::new(verdict, advice)
}

/// The changes that were tried. The supports stay where they are in the start, so that no foot changes its place.
fn advice(scenario: &PoseScenario, verdict: &Verdict, steps: usize, suggest: SuggestArgs) -> Advice {
    let Some(budget) = suggest.budget(steps) else { return Advice::default() };
    let job = Job {
        model: &scenario.model,
        start: &scenario.start,
        supports: &scenario.supports,
        limits: &scenario.limits,
        rests: vec![],
        levels: scenario.goals.iter().collect(),
        loads: vec![&scenario.loads],
        asked: None,
        strategy: None,
    };
    let all = || changes(&job, &verdict.hazards).into_iter().filter(|change| *change != Change::OtherFoot).collect();
    Advice::new(verdict, &job, all, || None, budget, |change| trial(scenario, &job, change))
}

/// Solves for the posture with a change.
fn trial(scenario: &PoseScenario, job: &Job<'_>, change: &Change) -> Trial {
    let mut changed = scenario.clone();
    change.apply_to_goals(job, &mut changed.goals);
    change.apply_to_loads(&mut changed.loads);
    let Ok(Posed { pose, held, .. }) = posed("pose", &mut changed) else { return Trial::default() };
    Trial { verdict: Some(verdict(&changed, &pose, &held)), steps: pose.steps }
}

/// The answer of a posture that is held.
pub(crate) fn verdict(scenario: &PoseScenario, pose: &SolvedPosture, held: &Held) -> Verdict {
    let levels = || scenario.goals.iter().zip(&pose.levels);
    let targets = levels().filter(|(goal, _)| !goal.hard).map(|(goal, level)| (goal, level.length));
    let posture = HeldPosture {
        groups: held.groups.clone(),
        missing: held.missing,
        slip: levels().filter(|(goal, _)| goal.hard).fold(Slip::default(), |slip, (_, level)| slip.with(level.slip())),
        missed: Missed::of_levels(&scenario.model, &pose.posture, targets),
        hazards: held.hazards.clone(),
        hands: HandLoad::all(&scenario.model, &scenario.loads),
        loads: scenario.loads.clone(),
    };
    Verdict::of_posture(&scenario.model, &posture)
}

/// A target of lower priority that is missed is no failure; the end of the steps of `[solver]` is one. That of the steps toward balance is
/// not: the posture is in balance and is judged, and only its effort still fell.
fn exit(pose: &SolvedPosture, kept_balance: bool, verdict: &Verdict) -> Result<(), Fail> {
    match pose.reason {
        Reason::StepLimit if !kept_balance => Err(Fail::Job(format!(
            "not converged after {} steps; the best posture is written. [solver] max_steps allows more",
            pose.steps
        ))),
        Reason::StepLimit | Reason::Reached | Reason::Converged => answered(verdict),
    }
}
