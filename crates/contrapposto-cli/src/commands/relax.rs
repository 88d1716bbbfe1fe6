//! `contrapposto relax`: the different postures of least effort under the tasks of a scenario.

mod own_strength;

use std::fmt::Write;

use contrapposto::equilibria::{Equilibria, Search, SearchError};
use contrapposto::joint_torques::active_torque;
use contrapposto::model::CoordinateKind;
use contrapposto::suggestions::Advice;
use contrapposto::verdict::{HeldPosture, Verdict};
use contrapposto_formats::motion::{csv_cell, opensim_columns, write_sto};
use contrapposto_formats::tissue::fatigue_notes;
use contrapposto_formats::{RelaxScenario, read_relax};
use contrapposto_plot::{BodyFigure, body_figure};

pub(crate) use self::own_strength::find;
pub(super) use self::own_strength::{MOST_STRENGTH_ROUNDS, SAME_STRENGTH, unsettled};
use super::trials::advice_of_search;
use crate::args::{RelaxArgs, SuggestArgs};
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print, print_note, report_line};
use crate::progress::{TRYING_CHANGES, spinner};
use crate::scenario_file::ScenarioFile;
use crate::view::animation::steps;
use crate::view::answer::{Answer, answered, without_posture};
use crate::view::body;
use crate::view::frame::{Frame, frame_of_posture};
use crate::view::muscle_work::{MusclesAtWork, muscles_at_work};
use crate::view::report::equilibria::{figures_of_equilibria, report_of_equilibria};
use crate::view::stage::Stage;
use crate::view::text::relax::{RelaxText, percent, report};

const RELAX_FILES: [&str; 8] = [
    "relax.json",
    "report.html",
    "postures.mot",
    "relax.csv",
    "postures.svg",
    "postures.png",
    "postures.glb",
    "postures.bvh",
];

pub(crate) fn relax(args: &RelaxArgs) -> Result<(), Fail> {
    let file = ScenarioFile::read_from(&args.scenario, args.start_from.as_deref())?;
    let name = file.name.clone();
    let mut scenario = read(file)?;
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &RELAX_FILES)).transpose()?;
    let spinner = spinner("trying starts");
    let found = find(&mut scenario);
    let found = match found {
        Ok(found) => found,
        Err(SearchError::CannotStand(missing)) => {
            let (title, body) = (&scenario.title, (&scenario.model, scenario.loads.as_slice()));
            let advice = |verdict: &Verdict| advice_without(&scenario, verdict, args.suggest);
            let answered = without_posture("relax.json", title, body, (missing, advice), folder.as_ref(), args.json);
            spinner.finish();
            return answered;
        }
        Err(SearchError::Relax(error)) => return Err(Fail::Refused(format!("{name}: {error}"))),
        Err(error) => return Err(Fail::Job(format!("{name}: {error}"))),
    };
    spinner.set_message(TRYING_CHANGES);
    let answer = answer(&scenario, &found, args.suggest);
    spinner.finish();
    let (frames, muscles) = frames_and_muscles(&scenario, &found)?;
    let figures = if args.figures { figures_of_equilibria(&scenario, &frames)? } else { vec![] };
    let names = RELAX_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str()));
    let files = if args.out.is_some() { names.map(str::to_owned).collect() } else { vec![] };
    let text = RelaxText::new(&scenario, (&found, muscles.as_ref()), &answer, files);
    let json = json_text("relax.json", &text)?;
    if let Some(folder) = &folder {
        let shown = (frames.as_slice(), muscles.as_ref());
        write((&scenario, shown), &found, &answer, (&text, &json), &figures, (folder, args.wooden))?;
    }
    print(&if args.json {
        json
    } else {
        answer.in_words(&scenario.model, "", &report(&text)) + &report_line(folder.as_ref())
    })?;
    answered(&answer.verdict)
}

/// The scenario of a file; notes about it go to standard error.
pub(crate) fn read(file: ScenarioFile) -> Result<RelaxScenario, Fail> {
    let ScenarioFile { name, bytes, model, muscles } = file;
    let mut scenario = read_relax(&name, &bytes, model)?;
    scenario.take_muscles(muscles);
    if !scenario.unused.is_empty() {
        let list: Vec<String> = scenario.unused.iter().map(|table| format!("[{table}]")).collect();
        print_note(
            "note",
            &format!("{} {} ignored by `relax`", list.join(", "), if list.len() == 1 { "is" } else { "are" }),
        );
    }
    if scenario.effort_added {
        print_note("note", "no task is of kind `effort`; the effort of all muscles was added as the last task");
    }
    scenario.notes.iter().for_each(|note| print_note("note", note));
    fatigue_notes(&scenario.model).iter().for_each(|note| print_note("note", note));
    Ok(scenario)
}

/// The answer: that of the posture of least effort, and the changes that were tried.
pub(crate) fn answer(scenario: &RelaxScenario, found: &Equilibria, suggest: SuggestArgs) -> Answer {
    let search = scenario.search();
    let Some((verdict, best)) = Verdict::of_equilibria(&search, found).zip(found.postures.first()) else {
        let verdict = Verdict::of_posture(&scenario.model, &HeldPosture::default());
        return Answer::new(verdict, Advice::default());
    };
    let at_best = Search { start: &best.relaxed.posture, ..search.clone() };
    let advice = advice_of_search(&verdict, (&search, &at_best), (RelaxScenario::OPTIONS, found.steps), suggest);
    Answer::new(verdict, advice)
}

/// The changes that were tried of a body that cannot stand.
pub(crate) fn advice_without(scenario: &RelaxScenario, verdict: &Verdict, suggest: SuggestArgs) -> Advice {
    let search = scenario.search();
    advice_of_search(verdict, (&search, &search), (RelaxScenario::OPTIONS, 0), suggest)
}

/// The frames of the postures, and how hard every muscle works in them.
pub(crate) fn frames_and_muscles<'a>(
    scenario: &'a RelaxScenario,
    found: &Equilibria,
) -> Result<(Vec<Frame>, Option<MusclesAtWork<'a>>), Fail> {
    let frames = found.postures.iter().map(|posture| frame_of_posture(&scenario.model, posture));
    let frames = frames.collect::<Result<Vec<_>, _>>()?;
    let muscles = muscles_at_work(&scenario.model, scenario.muscles.as_ref(), &frames, |_| true)?;
    Ok((frames, muscles))
}

/// Writes all files.
fn write(
    (scenario, shown): (&RelaxScenario, (&[Frame], Option<&MusclesAtWork<'_>>)),
    found: &Equilibria,
    answer: &Answer,
    (text, json): (&RelaxText, &str),
    figures: &[(String, Vec<u8>)],
    (folder, wooden): (&ResultSet, bool),
) -> Result<(), Fail> {
    let rows: Vec<&[f64]> = found.postures.iter().map(|posture| posture.relaxed.posture.values()).collect();
    let times: Vec<f64> = (0..rows.len()).map(|i| i as f64).collect();
    let title = if scenario.title.is_empty() { "postures of least effort" } else { &scenario.title };
    let columns = opensim_columns(&scenario.model);
    let mot = write_sto(title, &columns, true, &times, &rows).map_err(|error| Fail::job("postures.mot", error))?;
    let csv = table(scenario, found);
    let picture = body_figure(&drawing(scenario, found, shown, text)?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let page = report_of_equilibria(scenario, found, shown, answer)?;
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let [gltf, bvh] = steps(["postures.glb", "postures.bvh"], (&scenario.model, &stage), title, shown, wooden)?;
    let texts = [json, &page, &mot, &csv, &svg].map(str::as_bytes);
    let contents = texts.into_iter().chain([png.as_slice(), &gltf, &bvh]);
    let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    folder.write(&RELAX_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())
}

/// One row a posture and coordinate.
fn table(scenario: &RelaxScenario, found: &Equilibria) -> String {
    let mut csv = "posture,coordinate,value,unit,external,passive,active,relative_load\n".to_owned();
    for (number, posture) in found.postures.iter().enumerate() {
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
            let value = posture.relaxed.posture.values()[i];
            let (value, unit) = match coordinate.kind {
                CoordinateKind::Rotation => (value.to_degrees(), "deg"),
                CoordinateKind::Translation => (value, "m"),
                CoordinateKind::Quaternion => (value, "1"),
            };
            let _ = write!(csv, "{},{},{value},{unit}", number + 1, csv_cell(&coordinate.name));
            let Some(rate) = coordinate.rate else {
                csv.push_str(",,,,\n");
                continue;
            };
            let (external, passive) = (posture.torques[0][rate], posture.torques[1][rate]);
            let load =
                posture.work.iter().find(|work| work.coordinate == i).map(|work| work.relative_load().to_string());
            let active = active_torque(external, passive);
            let _ = writeln!(csv, ",{external},{passive},{active},{}", load.unwrap_or_default());
        }
    }
    csv
}

/// All postures side by side.
fn drawing(
    scenario: &RelaxScenario,
    found: &Equilibria,
    (frames, muscles): (&[Frame], Option<&MusclesAtWork<'_>>),
    text: &RelaxText,
) -> Result<BodyFigure, Fail> {
    let model = &scenario.model;
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let mut postures = vec![];
    for (i, (frame, text)) in frames.iter().zip(&text.postures).enumerate() {
        let mut drawn = body::body(model, &stage, frame)?;
        drawn.muscles = muscles.map_or(Ok(vec![]), |muscles| muscles.drawn(i, &frame.posture))?;
        drawn.title = format!("{}: effort {:.4}", i + 1, text.effort);
        // The first number is the effort of all muscles, not that of the task.
        drawn.notes = body::key_numbers(model, &scenario.supports, frame).split_off(1);
        postures.push(drawn);
    }
    let subtitle = match found.postures.len() {
        1 => "one posture of least effort".to_owned(),
        n => format!("{n} postures of least effort"),
    };
    let least = found.postures.first().map_or(0.0, |posture| posture.relaxed.effort);
    let more = found
        .postures
        .get(1)
        .map(|posture| format!("; the next takes {} more", percent(posture.relaxed.effort / least - 1.0)));
    let subtitle = subtitle + more.as_deref().unwrap_or_default();
    Ok(BodyFigure { title: scenario.title.clone(), subtitle, postures, ..BodyFigure::default() })
}
