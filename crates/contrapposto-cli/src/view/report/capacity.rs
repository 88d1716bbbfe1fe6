//! The page and the picture of the greatest forces at a point.

use contrapposto::capacity::{GreatestForce, Limiter};
use contrapposto::model::Model;
use contrapposto::verdict::{Line, Who};
use contrapposto_formats::{CapacityText, ForceText};
use contrapposto_plot::{BodyPosture, ForceFigure, Spoke};
use contrapposto_report::{Fact, ForceSolid, Moments, Table};

use super::figure::{carriers, figure, figures_of};
use crate::fail::Fail;
use crate::view::axes::{directions, turn};
use crate::view::body::held_body;
use crate::view::capacity::{Forces, limited_by, newtons};
use crate::view::held::Held;
use crate::view::scene::Scene;
use crate::view::scene::hazard::hazards;
use crate::view::stage::Stage;
use crate::view::text::capacity::row;
use crate::view::text::compare::ComparedPosture;
use crate::view::words::{how_long, percent, plain, sentence};

/// Length of the largest force on the page, m.
const LARGEST_FORCE_LENGTH: f64 = 0.5;
/// Spokes of a section of the picture.
const SPOKES: usize = 120;
/// Spokes between two numbers.
const NUMBERED: usize = 30;

/// The limits of forces by name, that of most directions first.
pub(crate) struct Limits {
    names: Vec<String>,
}

impl Limits {
    pub(crate) fn of(text: &CapacityText) -> Self {
        let mut counted: Vec<(String, usize)> = vec![];
        for name in text.directions.iter().map(first_limit) {
            match counted.iter_mut().find(|(known, _)| *known == name) {
                Some((_, count)) => *count += 1,
                None => counted.push((name, 1)),
            }
        }
        counted.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        Self { names: counted.into_iter().map(|(name, _)| name).collect() }
    }

    fn place(&self, name: &str) -> usize {
        self.names.iter().position(|known| known == name).unwrap_or(self.names.len())
    }

    /// `balance (64 % of all directions)`.
    fn shares(&self, text: &CapacityText) -> Vec<String> {
        let all = text.directions.len().max(1) as f64;
        let share =
            |name: &String| text.directions.iter().filter(|force| first_limit(force) == *name).count() as f64 / all;
        self.names.iter().map(|name| format!("{name} ({} of all directions)", percent(share(name)))).collect()
    }
}

fn first_limit(force: &ForceText) -> String {
    force.limits.first().map_or_else(|| "nothing".to_owned(), |limit| limit.name().to_owned())
}

fn limit_of(model: &Model, greatest: &GreatestForce) -> String {
    match greatest.limits.first().map(|limit| limit.by) {
        None => "nothing".to_owned(),
        Some(Limiter::Strength { coordinate, side }) => Who { coordinate, side, load: 0.0 }.name(model),
        Some(Limiter::Balance) => "balance".to_owned(),
        Some(Limiter::Friction) => "friction".to_owned(),
    }
}

/// The page; without forces, that of the posture alone.
pub(crate) fn report_of_capacity(
    job: &ComparedPosture,
    text: &CapacityText,
    forces: Option<&Forces>,
    held: Held,
) -> Result<String, Fail> {
    let model = &job.model;
    let frames = [held.frame];
    let stage = Stage::still(&job.supports, &job.things, &job.loads);
    let scene = Scene::of(&job.title, model, &job.posture, &frames, stage);
    let [frame] = &frames;
    let limiting = |force: &Option<ForceText>| model.coordinate(force.as_ref()?.limits.first()?.coordinate.as_ref()?);
    let worst = || (0..frame.load.len()).max_by(|&a, &b| frame.load[a].total_cmp(&frame.load[b]));
    let main = limiting(&text.weakest).or_else(|| limiting(&text.strongest)).or_else(worst).unwrap_or(0);
    let mut report = scene.report(Moments::Postures(vec!["the posture".to_owned()]), main)?;
    report.headline.clone_from(&text.sentence);
    report.reasons.clone_from(&text.assumptions);
    for (label, force) in [("Weakest direction", &text.weakest), ("Strongest direction", &text.strongest)] {
        if let Some(force) = force {
            report.figures.push(figure(
                label,
                newtons(force.force_n),
                &format!("{}; {}", force.toward, limited_by(force)),
            ));
        }
    }
    figures_of(model, frame, &carriers(&scene), &mut report);
    if let Some(forces) = forces {
        report.solid = Some(solid(model, text, forces));
        let name = plain(&text.at.segment);
        let named = |force: &ForceText| row(&force.toward, force).to_vec();
        let extremes =
            [("weakest", &text.weakest), ("strongest", &text.strongest)].into_iter().filter_map(|(name, force)| {
                let force = force.as_ref()?;
                Some(row(&format!("{name}: {}", force.toward), force).to_vec())
            });
        report.table = Table {
            heading: format!("Greatest force of the {name} in the main directions"),
            columns: ["The body pushes", "Force", "Two of three people", "Limited by"].map(str::to_owned).to_vec(),
            rows: extremes.chain(text.main.iter().map(named)).collect(),
        };
    }
    let hazards = hazards(model, &frames, false);
    report.facts = hazards.into_iter().map(|text| Fact { name: Line::HAZARD.to_owned(), text }).collect();
    Ok(contrapposto_report::write(&report))
}

/// The solid around the point.
fn solid(model: &Model, text: &CapacityText, forces: &Forces) -> ForceSolid {
    let (turn, limits) = (turn(model), Limits::of(text));
    let finite = text.directions.iter().filter_map(|force| force.force_n);
    let largest = finite.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let corner = |greatest: &GreatestForce| {
        let length = LARGEST_FORCE_LENGTH * greatest.force.min(largest) / largest;
        turn.point(forces.place + length * greatest.direction)
    };
    let per_ten_centimetres = 0.1 * largest / LARGEST_FORCE_LENGTH;
    ForceSolid {
        at: turn.point(forces.place),
        corners: forces.solid.forces.iter().map(corner).collect(),
        faces: forces.solid.faces.clone(),
        limits: text.directions.iter().map(|force| limits.place(&first_limit(force))).collect(),
        names: limits.shares(text),
        scale: format!("10\u{a0}cm from the hand are {per_ten_centimetres:.0}\u{a0}N"),
    }
}

/// `Right hand, held for 2.0 min: weakest 27 N (up), strongest 109 N (back and down)`.
fn subtitle(text: &CapacityText) -> String {
    let (Some(weakest), Some(strongest)) = (&text.weakest, &text.strongest) else { return text.sentence.clone() };
    let held = text.hold_s.map_or(String::new(), |seconds| format!(", held for {}", how_long(seconds)));
    let said = |force: &ForceText| format!("{} ({})", newtons(force.force_n), force.toward);
    format!("{}{held}: weakest {}, strongest {}", sentence(&plain(&text.at.segment)), said(weakest), said(strongest))
}

/// The picture: sections of the solid, seen from the right, from the front and from above.
pub(crate) fn picture_of_capacity(
    job: &ComparedPosture,
    text: &CapacityText,
    forces: Option<&mut Forces>,
    held: &Held,
) -> Result<ForceFigure, Fail> {
    let model = &job.model;
    let stage = Stage::still(&job.supports, &job.things, &job.loads);
    let mut body = held_body(model, &stage, held)?;
    // Colours mean limits here, not loads.
    body.parts.iter_mut().for_each(|part| (part.load, part.hazard) = (None, false));
    let body = BodyPosture { forces: vec![], center_of_mass: None, ..body };
    let turn = turn(model);
    let mut limits = Limits::of(text);
    let mut figure = ForceFigure { title: job.title.clone(), subtitle: subtitle(text), body, ..ForceFigure::default() };
    let Some(forces) = forces else { return Ok(figure) };
    figure.at = turn.point(forces.place);
    let [right, ahead, up] = directions(model);
    for (section, [across, along]) in figure.sections.iter_mut().zip([[ahead, up], [right, up], [right, ahead]]) {
        for k in 0..SPOKES {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / SPOKES as f64);
            let Some(greatest) = forces.in_direction(&(cos * across + sin * along)) else { continue };
            let name = limit_of(model, &greatest);
            let limit = limits.place(&name);
            if limit == limits.names.len() {
                limits.names.push(name);
            }
            let direction = turn.point(greatest.direction);
            section.push(Spoke { direction, force: greatest.force, limit, marked: k.is_multiple_of(NUMBERED) });
        }
    }
    figure.limits = limits.names;
    Ok(figure)
}
