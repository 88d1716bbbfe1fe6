//! `contrapposto compare`: carries out several scenarios, and draws and tables their last postures side by side.

use std::path::Path;

use contrapposto::posture::Posture;
use contrapposto::simulation::Run;
use contrapposto::verdict::Verdict;
use contrapposto_formats::{RunScenario, read_pose, scenario_runs};
use contrapposto_plot::{BodyFigure, BodyPosture, body_figure};

use super::pose::{Posed, solve, verdict};
use super::simulate;
use crate::args::CompareArgs;
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print};
use crate::progress::progress_bar;
use crate::scenario_file::ScenarioFile;
use crate::view::answer::answered;
use crate::view::body;
use crate::view::figures::both;
use crate::view::frame::Frame;
use crate::view::report::comparison::report_of_comparison;
use crate::view::stage::Stage;
use crate::view::text::compare::{CompareText, ComparedPosture, report};
use crate::view::words::how_long;

const FILES: [&str; 4] = ["compare.json", "report.html", "compare.svg", "compare.png"];

pub(crate) fn compare(args: &CompareArgs) -> Result<(), Fail> {
    if args.scenarios.iter().filter(|path| *path == Path::new("-")).count() > 1 {
        return Err(Fail::Refused("standard input is one file: `-` can stand for one scenario only".to_owned()));
    }
    let folder = ResultSet::open(&args.out, &FILES)?;
    let mut postures = vec![];
    for (path, letter) in args.scenarios.iter().zip('A'..) {
        postures.push(carry_out(path, letter)?);
    }
    let files = FILES.map(str::to_owned).to_vec();
    let text = CompareText::new(&postures, files);
    let json = json_text("compare.json", &text)?;
    let picture = body_figure(&picture(&postures)?);
    let [svg, png] = both("compare", &picture)?;
    let page = report_of_comparison(&postures, &text)?;
    let files =
        [("compare.json", json.as_bytes()), ("report.html", page.as_bytes()), (&svg.0, &svg.1), (&png.0, &png.1)];
    folder.write(&files)?;
    let (page, picture) = (folder.path("report.html"), folder.path(&svg.0));
    let files = format!("report: {}\npicture: {}\n", page.display(), picture.display());
    print(&if args.json { json } else { report(&postures, &text) + &files })?;
    postures.iter().try_for_each(|compared| answered(&compared.verdict))
}

/// A scenario with a duration is simulated, and its last posture taken; one without is posed.
pub(super) fn carry_out(path: &Path, letter: char) -> Result<ComparedPosture, Fail> {
    let source = ScenarioFile::read(path)?;
    let file = source.name.clone();
    if !scenario_runs(&file, &source.bytes)? {
        return posed(source, letter);
    }
    let RunScenario { mut scenario, things, .. } = simulate::read(source)?;
    let failed = |error| Fail::job(&file, error);
    let mut run = Run::new(&scenario).map_err(failed)?;
    let progress = progress_bar(scenario.run.duration);
    let mut last: Option<Frame> = None;
    while let Some(sample) = run.next_sample().map_err(failed)? {
        progress.set_position(sample.time as u64);
        last = Some(Frame::of_sample(&scenario.model, &sample));
    }
    progress.finish();
    let Some(frame) = last else { return Err(Fail::job(&file, "the run has no sample")) };
    let verdict = Verdict::of_run(&scenario, &run.summary());
    let loads = Stage::of_run(&scenario, &things).loads_at(frame.time).to_vec();
    // The strength of the posture that is compared.
    if let Some(muscles) = &mut scenario.muscles {
        let posture = Posture::new(frame.posture.clone());
        muscles.pose(&mut scenario.model, &posture).map_err(|error| Fail::job(&file, error))?;
    }
    Ok(ComparedPosture {
        letter,
        title: title(&scenario.title, path),
        how: format!("simulated, {}", how_long(frame.time)),
        verdict,
        posture: frame.posture.clone(),
        loads,
        frame: Some(frame),
        things,
        supports: scenario.supports,
        muscles: scenario.muscles,
        model: scenario.model,
        file,
    })
}

fn posed(source: ScenarioFile, letter: char) -> Result<ComparedPosture, Fail> {
    let ScenarioFile { name: file, bytes, model, muscles } = source;
    let mut scenario = read_pose(&file, &bytes, model)?;
    scenario.take_muscles(muscles);
    let Posed { pose, held, .. } = solve(&file, &mut scenario)?;
    let verdict = verdict(&scenario, &pose, &held);
    let frame = held.known();
    Ok(ComparedPosture {
        letter,
        title: title(&scenario.title, Path::new(&file)),
        how: "posed".to_owned(),
        verdict,
        posture: pose.posture.values().to_vec(),
        frame,
        things: scenario.things,
        loads: scenario.loads,
        supports: scenario.supports,
        muscles: scenario.muscles,
        model: scenario.model,
        file,
    })
}

/// The scenario's title, or the name of its file.
fn title(title: &str, path: &Path) -> String {
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if title.trim().is_empty() { stem() } else { title.to_owned() }
}

/// The postures side by side.
fn picture(postures: &[ComparedPosture]) -> Result<BodyFigure, Fail> {
    let mut drawn = vec![];
    for compared in postures {
        let mut posture = match &compared.frame {
            Some(frame) => {
                let stage = Stage::still(&compared.supports, &compared.things, &compared.loads);
                body::body(&compared.model, &stage, frame)?
            }
            None => {
                BodyPosture { parts: body::parts(&compared.model, &compared.posture, None)?, ..BodyPosture::default() }
            }
        };
        posture.title = format!("{}: {}", compared.letter, compared.title);
        posture.notes = match &compared.frame {
            Some(frame) => body::key_numbers(&compared.model, &compared.supports, frame),
            None => vec!["supports cannot hold it".to_owned()],
        };
        drawn.push(posture);
    }
    Ok(BodyFigure { postures: drawn, ..BodyFigure::default() })
}
