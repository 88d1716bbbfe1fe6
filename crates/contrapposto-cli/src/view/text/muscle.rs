//! One muscle in a posture, as JSON and in words.

use std::fmt::Write;

use contrapposto::model::Model;
use contrapposto::muscle::{CornerOrigin, FiberLaw, FiberState, Muscle, PathCorner, PathGeometry};
use contrapposto_formats::tissue::SourcedModel;
use serde::Serialize;

use super::muscles::rule_word;
use super::{Named, plain_table};
use crate::args::RuleChoice;
use crate::fail::Fail;
use crate::output::json_text;
use crate::view::words::percent;

/// Smallest moment arm that the table shows, m.
const SHOWN_ARM: f64 = 5e-5;

/// A muscle in a posture.
pub(crate) struct ShownMuscle<'a> {
    pub(crate) index: usize,
    pub(crate) time: f64,
    pub(crate) rule: RuleChoice,
    pub(crate) activation: f64,
    pub(crate) geometry: &'a PathGeometry,
    /// At `activation`, and at full activation.
    pub(crate) rest: FiberState,
    pub(crate) full: FiberState,
    pub(crate) curves: Curves,
    /// Pictures that were drawn.
    pub(crate) files: Vec<String>,
}

/// Forces along fibres over the greatest isometric force, by length over the optimal one.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Curves {
    #[serde(rename = "fibre_length_over_optimal")]
    pub(crate) lengths: Vec<f64>,
    /// At full activation.
    #[serde(rename = "active_over_max")]
    pub(crate) active: Vec<f64>,
    #[serde(rename = "passive_over_max")]
    pub(crate) passive: Vec<f64>,
}

impl ShownMuscle<'_> {
    /// The publication of the muscle's curves.
    pub(crate) fn law(&self, muscle: &Muscle) -> &'static str {
        match muscle.spec().law {
            FiberLaw::Thelen2003(_) => "Thelen 2003",
            FiberLaw::Millard2012(_) => "Millard et al. 2013",
            FiberLaw::DeGrooteFregly2016(_) => "De Groote et al. 2016",
            FiberLaw::Schutte1993(_) => "Schutte 1993",
            FiberLaw::Mujoco(_) => "MuJoCo",
        }
    }
}

#[derive(Serialize)]
struct MuscleText<'a> {
    muscle: &'a str,
    time_s: f64,
    rule: &'static str,
    activation: f64,
    law: &'static str,
    max_isometric_force_n: f64,
    optimal_fibre_length_m: f64,
    tendon_slack_length_m: f64,
    pennation_rad: f64,
    rigid_tendon: bool,
    length_m: f64,
    path: Vec<CornerText<'a>>,
    /// Those that are exactly zero are left out.
    moment_arms_m: Named<'a, f64>,
    /// At `activation`.
    rest: StateText,
    /// At full activation.
    full: StateText,
    force_length: &'a Curves,
    files: &'a [String],
}

#[derive(Serialize)]
struct CornerText<'a> {
    /// `point`, or `on` and `off`: where the line touches and leaves a surface.
    kind: &'static str,
    /// Number of the point in the file, from 1; of a point only.
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<usize>,
    /// Name of the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    surface: Option<&'a str>,
    segment: &'a str,
    ground_m: [f64; 3],
}

#[derive(Serialize)]
struct StateText {
    fibre_length_m: f64,
    fibre_length_over_optimal: f64,
    pennation_rad: f64,
    tendon_force_n: f64,
    active_force_n: f64,
    passive_force_n: f64,
    /// The fibres are at their shortest length and carry nothing.
    shortest: bool,
}

impl StateText {
    fn new(muscle: &Muscle, state: &FiberState) -> Self {
        Self {
            fibre_length_m: state.fiber_length,
            fibre_length_over_optimal: state.fiber_length / muscle.spec().optimal_fiber_length,
            pennation_rad: libm::acos(state.cos_pennation.clamp(-1.0, 1.0)),
            tendon_force_n: state.tendon_force,
            active_force_n: state.active_force,
            passive_force_n: state.passive_force,
            shortest: state.shortest,
        }
    }
}

/// Name of a segment.
fn segment(model: &Model, segment: Option<usize>) -> &str {
    segment.map_or("ground", |segment| model.segments()[segment].name.as_str())
}

/// Name of the surface that a corner of a muscle's path lies on.
fn surface<'a>(opened: &'a SourcedModel, muscle: &Muscle, corner: &PathCorner) -> Option<&'a str> {
    let (CornerOrigin::On(number) | CornerOrigin::Off(number)) = corner.origin else { return None };
    let paths = &opened.muscles.paths;
    let path = &paths.paths[muscle.spec().path];
    match &path.tendon {
        Some(tendon) => Some(paths.geoms[tendon.parts.get(number)?.around?.geom].name.as_str()),
        None => Some(paths.wrap_objects[path.wraps.get(number)?.object].name.as_str()),
    }
}

pub(crate) fn json(opened: &SourcedModel, shown: &ShownMuscle<'_>) -> Result<String, Fail> {
    let muscle = &opened.muscles.muscles[shown.index];
    let (spec, model) = (muscle.spec(), &opened.model);
    let corner = |corner: PathCorner| {
        let (kind, point) = match corner.origin {
            CornerOrigin::Point(number) => ("point", Some(number + 1)),
            CornerOrigin::On(_) => ("on", None),
            CornerOrigin::Off(_) => ("off", None),
        };
        let ground_m = [corner.place.x, corner.place.y, corner.place.z];
        let surface = surface(opened, muscle, &corner);
        CornerText { kind, point, surface, segment: segment(model, corner.segment), ground_m }
    };
    let arms = model.rates().iter().zip(shown.geometry.moment_arms(spec.path));
    let text = MuscleText {
        muscle: &spec.name,
        time_s: shown.time,
        rule: rule_word(shown.rule),
        activation: shown.activation,
        law: shown.law(muscle),
        max_isometric_force_n: spec.max_isometric_force,
        optimal_fibre_length_m: spec.optimal_fiber_length,
        tendon_slack_length_m: spec.tendon_slack_length,
        pennation_rad: spec.pennation,
        rigid_tendon: spec.rigid_tendon,
        length_m: shown.geometry.lengths()[spec.path],
        path: shown.geometry.corners(spec.path).map(corner).collect(),
        moment_arms_m: Named(
            arms.filter(|(_, arm)| **arm != 0.0).map(|(rate, arm)| (rate.name.as_str(), *arm)).collect(),
        ),
        rest: StateText::new(muscle, &shown.rest),
        full: StateText::new(muscle, &shown.full),
        force_length: &shown.curves,
        files: &shown.files,
    };
    json_text("JSON", &text)
}

pub(crate) fn readable(opened: &SourcedModel, shown: &ShownMuscle<'_>) -> String {
    let muscle = &opened.muscles.muscles[shown.index];
    let (spec, rest, full) = (muscle.spec(), &shown.rest, &shown.full);
    let relative = |state: &FiberState| percent(state.fiber_length / spec.optimal_fiber_length);
    let mut text = format!(
        "{}: fibres at {} of their optimal length, passive force {:.1} N, at full activation {:.0} N in the tendon.\n\n",
        spec.name,
        relative(rest),
        rest.passive_force,
        full.tendon_force
    );
    if rest.shortest {
        text += "The path is shorter than tendon and shortest fibres: the muscle is slack.\n";
    }
    let tendon = match (spec.rigid_tendon || spec.tendon_slack_length <= 0.0, spec.tendon_slack_length) {
        (true, slack) => format!("rigid, {:.1} mm", slack * 1e3),
        (false, slack) => format!("{:.1} mm when slack", slack * 1e3),
    };
    let _ = writeln!(
        text,
        "law {}, greatest isometric force {:.0} N, optimal fibre length {:.1} mm, pennation {:.1}°, tendon {tendon}",
        shown.law(muscle),
        spec.max_isometric_force,
        spec.optimal_fiber_length * 1e3,
        spec.pennation.to_degrees()
    );
    let length = shown.geometry.lengths()[spec.path];
    let _ = writeln!(text, "path {:.1} mm, rule {}\n", length * 1e3, rule_word(shown.rule));
    let mut table = plain_table();
    table.set_header(["activation", "fibres, mm", "of optimal", "pennation", "active, N", "passive, N", "tendon, N"]);
    for (activation, state) in [(shown.activation, rest), (1.0, full)] {
        table.add_row([
            format!("{activation}"),
            format!("{:.1}", state.fiber_length * 1e3),
            relative(state),
            format!("{:.1}°", libm::acos(state.cos_pennation.clamp(-1.0, 1.0)).to_degrees()),
            format!("{:.1}", state.active_force),
            format!("{:.1}", state.passive_force),
            format!("{:.1}", state.tendon_force),
        ]);
    }
    let _ = writeln!(text, "{table}\n\n{}\n\n{}", arms(opened, shown), corners(opened, shown));
    if !shown.files.is_empty() {
        let _ = writeln!(text, "\npictures {}", shown.files.join(", "));
    }
    text
}

/// Moment arms, with the torques that follow.
fn arms(opened: &SourcedModel, shown: &ShownMuscle<'_>) -> comfy_table::Table {
    let path = opened.muscles.muscles[shown.index].spec().path;
    let mut table = plain_table();
    table.set_header(["coordinate", "moment arm, mm", "passive, N m", "at full activation, N m"]);
    for (rate, arm) in opened.model.rates().iter().zip(shown.geometry.moment_arms(path)) {
        if rate.rotational && arm.abs() >= SHOWN_ARM {
            table.add_row([
                rate.name.clone(),
                format!("{:.1}", arm * 1e3),
                format!("{:.2}", arm * shown.rest.passive_force),
                format!("{:.1}", arm * shown.full.tendon_force),
            ]);
        }
    }
    table
}

/// Corners of the path.
fn corners(opened: &SourcedModel, shown: &ShownMuscle<'_>) -> comfy_table::Table {
    let muscle = &opened.muscles.muscles[shown.index];
    let mut table = plain_table();
    table.set_header(["path", "segment", "x, y, z in ground, m"]);
    for corner in shown.geometry.corners(muscle.spec().path) {
        let name = surface(opened, muscle, &corner).unwrap_or_default();
        let kind = match corner.origin {
            CornerOrigin::Point(number) => format!("point {}", number + 1),
            CornerOrigin::On(_) => format!("onto {name}"),
            CornerOrigin::Off(_) => format!("off {name}"),
        };
        let [x, y, z] = [corner.place.x, corner.place.y, corner.place.z];
        let place = format!("{x:.4}, {y:.4}, {z:.4}");
        table.add_row([kind, segment(&opened.model, corner.segment).to_owned(), place]);
    }
    table
}
