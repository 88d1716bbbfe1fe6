//! `contrapposto capacity`: the greatest force at a point of the body in every direction.

use contrapposto::capacity::{Situation, Station};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::verdict::{HeldPosture, Verdict, VerdictKind};
use contrapposto_formats::{AtText, CapacityText, VerdictText, nearest};
use contrapposto_plot::force_figure;
use nalgebra::Vector3;

use super::compare::carry_out;
use crate::args::CapacityArgs;
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print};
use crate::view::answer::answered;
use crate::view::capacity::{Forces, assumptions, finding};
use crate::view::held::{Held, held};
use crate::view::report::capacity::{picture_of_capacity, report_of_capacity};
use crate::view::text::capacity::report;
use crate::view::text::compare::ComparedPosture;
use crate::view::words::how_long;

const CAPACITY_FILES: [&str; 5] = ["capacity.json", "report.html", "capacity.csv", "capacity.svg", "capacity.png"];

pub(crate) fn capacity(args: &CapacityArgs) -> Result<(), Fail> {
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &CAPACITY_FILES)).transpose()?;
    let job = carry_out(&args.scenario, 'A')?;
    let station = station(&job.model, args)?;
    let posture = Posture::new(job.posture.clone());
    let situation = Situation {
        model: &job.model,
        posture: &posture,
        loads: &job.loads,
        supports: &job.supports,
        muscles: job.muscles.as_ref(),
    };
    let refused = |error| Fail::Refused(format!("{}: {error}", job.file));
    let mut forces = Forces::of(&situation, station, args.hold).map_err(refused)?;
    let held = held(&job.model, &posture, &job.loads, &job.supports)?;
    let verdict = verdict(&job, &held);
    let files = folder.as_ref().map_or(vec![], |_| CAPACITY_FILES.map(str::to_owned).to_vec());
    let text = text(args, &job, station, forces.as_mut(), &verdict, files);
    let json = json_text("capacity.json", &text)?;
    if let Some(folder) = &folder {
        write(&job, (&text, &json), forces.as_mut(), held, folder)?;
    }
    print(&if args.json { json } else { report(&text, folder.as_ref()) })?;
    // A force that cannot be held because the posture cannot is no force at all.
    if forces.is_none() { Err(Fail::Answered) } else { answered(&verdict) }
}

/// Writes all files.
fn write(
    job: &ComparedPosture,
    (text, json): (&CapacityText, &str),
    mut forces: Option<&mut Forces>,
    held: Held,
    folder: &ResultSet,
) -> Result<(), Fail> {
    let picture = force_figure(&picture_of_capacity(job, text, forces.as_deref_mut(), &held)?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let page = report_of_capacity(job, text, forces.as_deref(), held)?;
    let csv = text.csv();
    let contents = [json.as_bytes(), page.as_bytes(), csv.as_bytes(), svg.as_bytes(), png.as_slice()];
    folder.write(&CAPACITY_FILES.into_iter().zip(contents).collect::<Vec<_>>())
}

/// The point of the body that exerts the force.
fn station(model: &Model, args: &CapacityArgs) -> Result<Station, Fail> {
    let name = &args.at;
    let Some(segment) = model.segment(name) else {
        let names = model.segments().iter().map(|segment| segment.name.as_str());
        let near = nearest(name, names).map_or(String::new(), |near| format!("; `{near}` is one"));
        let model = model.name();
        return Err(Fail::Refused(format!("--at {name}: the model `{model}` has no such segment{near}")));
    };
    let shape = &model.segments()[segment];
    let middle = || shape.patch.iter().sum::<Vector3<f64>>() / shape.patch.len() as f64;
    let own = || if shape.patch.is_empty() { shape.center_of_mass } else { middle() };
    Ok(Station { segment, point: args.point.map_or_else(own, Vector3::from) })
}

/// The answer to the posture without a force. That of the run or pose stands where it is not done.
fn verdict(job: &ComparedPosture, held: &Held) -> Verdict {
    if matches!(job.verdict.kind, VerdictKind::NotReached | VerdictKind::CannotStand) {
        return job.verdict.clone();
    }
    let posture = HeldPosture {
        groups: held.groups.clone(),
        missing: held.missing,
        hazards: held.hazards.clone(),
        ..HeldPosture::default()
    };
    Verdict::of_posture(&job.model, &posture)
}

fn text(
    args: &CapacityArgs,
    job: &ComparedPosture,
    station: Station,
    forces: Option<&mut Forces>,
    verdict: &Verdict,
    files: Vec<String>,
) -> CapacityText {
    let model = &job.model;
    let at = AtText {
        segment: args.at.clone(),
        point_m: station.point.into(),
        place_m: forces.as_ref().map(|forces| forces.place.into()),
    };
    let held_by_hand = job.supports.is_empty();
    let mut text = CapacityText {
        title: job.title.clone(),
        model: model.name().to_owned(),
        posture: job.how.clone(),
        verdict: VerdictText::new(model, verdict),
        sentence: without_force(args.hold, verdict, job.shares()),
        at,
        hold_s: args.hold,
        weakest: None,
        strongest: None,
        main: vec![],
        directions: vec![],
        faces: vec![],
        assumptions: assumptions(
            args.hold,
            held_by_hand,
            job.shares(),
            forces.as_ref().is_none_or(|forces| forces.weaker_can_hold()),
        ),
        files,
    };
    let Some(forces) = forces else { return text };
    let solid = forces.solid.clone();
    let (weakest, strongest) = (forces.text(model, &solid.weakest), forces.text(model, &solid.strongest));
    let found = finding(&args.at, args.hold, forces, &weakest, &strongest);
    // The posture is said first where it is not the one that was asked for, or costs more than its muscles have at least effort.
    text.sentence = if verdict.kind.is_done() { found } else { format!("{} {found}", verdict.sentence) };
    text.main = forces.main(model);
    text.directions = solid.forces.iter().map(|greatest| forces.text(model, greatest)).collect();
    text.faces = solid.faces;
    (text.weakest, text.strongest) = (Some(weakest), Some(strongest));
    text
}

/// The first line of a posture that cannot be held.
fn without_force(hold: Option<f64>, verdict: &Verdict, by_muscles: bool) -> String {
    match hold {
        Some(seconds) if verdict.kind.is_done() => {
            format!("No force can be held for {}, because the posture cannot. {}", how_long(seconds), verdict.sentence)
        }
        // Groups that are strong enough one by one may not be so together: they have muscles in common.
        None if verdict.kind.is_done() && by_muscles => {
            format!("No force: the muscles together cannot give the torques of the posture. {}", verdict.sentence)
        }
        _ => verdict.in_words().trim_end().to_owned(),
    }
}
