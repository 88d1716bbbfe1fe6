//! The contents of a model, as `inspect --json` prints them and as terminal tables.

mod group_strength;
mod muscle_counts;
pub(crate) mod scenario;

use std::collections::BTreeMap;
use std::fmt::Write;

use contrapposto::fatigue::FatigueLaw;
use contrapposto::kinematics::Kinematics;
use contrapposto::math::Function;
use contrapposto::model::{Coordinate, CoordinateKind, Model, MuscleGroup};
use contrapposto::passive::{PassiveLaw, Term};
use contrapposto_formats::ModelFormat;
use contrapposto_formats::model_ir::KindTally;
use contrapposto_formats::tissue::SourcedModel;
use serde::Serialize;

use super::joint::{JointText, joint_word, three_rotations};
use super::plain_table;
use super::sources::{Known, Seen, Source};
use crate::view::moment::MomentJoint;
use group_strength::StrengthText;
use muscle_counts::muscle_counts;

/// The meaning of the numbers of the adult.
const NOT_JUDGED: &str = "\nStrength is the torque that all muscles of a direction give together at a joint, and so is their fatigue; single muscles are \
                          not judged.\nThe shoulder joint rises with the arm; muscles that hold the shoulder blade (trapezius, serratus anterior) are not judged, and an arm \
                          above the shoulder is as strong as its curve says.\n";

#[derive(Serialize)]
pub(crate) struct Report<'a> {
    file: &'a str,
    format: &'static str,
    name: &'a str,
    mass_kg: f64,
    gravity_m_s2: [f64; 3],
    /// In the default posture.
    center_of_mass_m: Option<[f64; 3]>,
    segments: Vec<SegmentText<'a>>,
    coordinate_order: Vec<&'a str>,
    coordinates: BTreeMap<&'a str, InspectedCoordinateText<'a>>,
    /// The fate of muscles, the points of their paths and surfaces, by kind; left out where the file has none.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    muscles: &'a BTreeMap<String, KindTally>,
    /// Parts that were ignored, changed or filled in, one sentence each.
    notes: &'a [String],
}

#[derive(Serialize)]
struct SegmentText<'a> {
    name: &'a str,
    /// `null`: ground.
    parent: Option<&'a str>,
    mass_kg: f64,
    center_of_mass_m: [f64; 3],
    inertia_kg_m2: [[f64; 3]; 3],
    joint: JointText<'a>,
}

#[derive(Serialize)]
struct InspectedCoordinateText<'a> {
    /// `rotation`, `translation` or `quaternion`.
    kind: &'static str,
    /// Unit of range and default.
    unit: &'static str,
    positive: &'a str,
    /// `null`: no limit.
    range: [Option<f64>; 2],
    range_source: Option<Source>,
    default: f64,
    locked: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    follows: Option<FollowsText<'a>>,
    passive: Option<PassiveText>,
    strength: Option<StrengthText<'a>>,
    fatigue: Option<FatigueText<'a>>,
}

#[derive(Serialize)]
struct FollowsText<'a> {
    coordinate: &'a str,
    function: &'static str,
}

#[derive(Serialize)]
struct PassiveText {
    law: String,
    curve: Option<&'static str>,
    torque_at_limits_nm: Option<[f64; 2]>,
    source: Option<Source>,
}

#[derive(Serialize)]
struct FatigueText<'a> {
    positive: GroupFatigueText<'a>,
    negative: GroupFatigueText<'a>,
}

#[derive(Serialize)]
struct GroupFatigueText<'a> {
    /// Name of the parameters or of the endurance curve.
    parameters: &'a str,
    /// Of the three-compartment law.
    #[serde(flatten)]
    rates: Option<RatesText>,
    source: Option<Source>,
}

#[derive(Serialize)]
struct RatesText {
    fatigue_per_s: f64,
    recovery_per_s: f64,
    rest_multiplier: f64,
}

impl<'a> GroupFatigueText<'a> {
    fn new(law: &'a FatigueLaw, source: Option<Source>) -> Self {
        let rates = match law {
            FatigueLaw::ThreeCompartment(law) => Some(RatesText {
                fatigue_per_s: law.fatigue_rate,
                recovery_per_s: law.recovery_rate,
                rest_multiplier: law.rest_multiplier,
            }),
            FatigueLaw::Endurance(_) | FatigueLaw::Tireless => None,
        };
        Self { parameters: law.name(), rates, source }
    }
}

pub(crate) fn report<'a>(opened: &'a SourcedModel, file: &'a str) -> Report<'a> {
    let model = &opened.model;
    let (coordinates, moments) = (model.coordinates(), MomentJoint::all(model));
    Report {
        file,
        format: opened.format.word(),
        name: model.name(),
        mass_kg: model.mass(),
        gravity_m_s2: model.gravity().into(),
        center_of_mass_m: Kinematics::new(model).center_of_mass(model).map(Into::into),
        segments: model
            .segments()
            .iter()
            .enumerate()
            .map(|(s, segment)| SegmentText {
                name: &segment.name,
                parent: segment.parent.map(|parent| model.segments()[parent].name.as_str()),
                mass_kg: segment.mass,
                center_of_mass_m: segment.center_of_mass.into(),
                inertia_kg_m2: [0, 1, 2].map(|i| [0, 1, 2].map(|j| segment.inertia[(i, j)])),
                joint: JointText::new(model, &moments, s),
            })
            .collect(),
        coordinate_order: coordinates.iter().map(|c| c.name.as_str()).collect(),
        coordinates: coordinates
            .iter()
            .enumerate()
            .map(|(index, coordinate)| (coordinate.name.as_str(), text(opened, model, index, coordinate)))
            .collect(),
        muscles: &opened.muscle_tally.0,
        notes: &opened.notes,
    }
}

fn text<'a>(
    opened: &SourcedModel,
    model: &'a Model,
    index: usize,
    coordinate: &'a Coordinate,
) -> InspectedCoordinateText<'a> {
    let known = Known::of(opened, index);
    let (kind, unit) = match coordinate.kind {
        CoordinateKind::Rotation => ("rotation", "rad"),
        CoordinateKind::Translation => ("translation", "m"),
        CoordinateKind::Quaternion => ("quaternion", "1"),
    };
    let limit = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
    let follows = model.couplings().iter().find(|coupling| coupling.dependent == index);
    InspectedCoordinateText {
        kind,
        unit,
        positive: &coordinate.positive,
        range: [limit(coordinate.range.0), limit(coordinate.range.1)],
        range_source: known.range.clone(),
        default: coordinate.default,
        locked: coordinate.locked,
        follows: follows.map(|coupling| FollowsText {
            coordinate: &model.coordinates()[coupling.independent].name,
            function: function_word(&coupling.function),
        }),
        passive: coordinate.passive.as_ref().map(|law| PassiveText {
            law: law_word(law),
            curve: known.curve,
            torque_at_limits_nm: at_limits(opened, index),
            source: known.passive.clone(),
        }),
        strength: coordinate.groups.as_ref().map(|groups| StrengthText::new(groups, &known)),
        fatigue: coordinate.groups.as_ref().map(|[positive, negative]| FatigueText {
            positive: GroupFatigueText::new(&positive.fatigue, known.fatigue.first().cloned()),
            negative: GroupFatigueText::new(&negative.fatigue, known.fatigue.get(1).cloned()),
        }),
    }
}

fn function_word(function: &Function) -> &'static str {
    match function {
        Function::Constant(_) => "constant",
        Function::Linear { .. } => "linear",
        Function::Polynomial(_) => "polynomial",
        Function::Sine { .. } => "sine",
        Function::Spline(_) => "spline",
        Function::NaturalSpline(_) => "natural spline",
        _ => "other",
    }
}

/// The law in a word or two.
fn law_word(law: &PassiveLaw) -> String {
    let term = |term: &Term| match term {
        Term::Spring { .. } => "spring",
        Term::Polynomial { .. } => "polynomial",
        Term::CoordinateLimitForce(_) => "coordinate limit force",
        Term::Exponentials(_) => "exponentials",
        Term::Expression(_) => "formula",
    };
    match law {
        PassiveLaw::Curve(_) => "curve".to_owned(),
        PassiveLaw::Coupled(_) => "coupled law of hip, knee and ankle".to_owned(),
        PassiveLaw::Slice(_) => "muscles".to_owned(),
        PassiveLaw::Sum(terms) => terms.iter().map(term).collect::<Vec<_>>().join(" + "),
    }
}

/// Passive torque at both limits of the range, the rest of the body at its default; `None` where a limit or a law is missing.
fn at_limits(opened: &SourcedModel, index: usize) -> Option<[f64; 2]> {
    let (model, coordinate) = (&opened.model, &opened.model.coordinates()[index]);
    let law = coordinate.passive.as_ref()?;
    let ranges = opened.passive_ranges();
    let mut posture = model.default_posture();
    let mut at = |limit: f64| {
        posture.values_mut()[index] = limit;
        let within =
            |(value, range): (&f64, &Option<(f64, f64)>)| range.map_or(*value, |(min, max)| value.max(min).min(max));
        let values: Vec<f64> = posture.values().iter().zip(&ranges).map(within).collect();
        Some(law.torque(index, &values)).filter(|torque| limit.is_finite() && torque.is_finite())
    };
    Some([at(coordinate.range.0)?, at(coordinate.range.1)?])
}

pub(crate) fn readable(opened: &SourcedModel, file: &str) -> String {
    let model = &opened.model;
    let gravity = model.gravity();
    let mut text = format!(
        "{file}: {} `{}`\n{} segments, {} coordinates, {:.4} kg, gravity {} {} {} m/s2\n",
        opened.format.word(),
        model.name(),
        model.segments().len(),
        model.coordinates().len(),
        model.mass(),
        gravity.x,
        gravity.y,
        gravity.z,
    );
    let mut table = plain_table();
    table.set_header(["segment", "parent", "kg", "joint", "coordinates"]);
    for segment in model.segments() {
        let names: Vec<&str> =
            model.coordinates()[segment.coordinates.clone()].iter().map(|c| c.name.as_str()).collect();
        table.add_row([
            segment.name.clone(),
            segment.parent.map_or("ground".to_owned(), |parent| model.segments()[parent].name.clone()),
            format!("{:.4}", segment.mass),
            format!("{} ({})", segment.joint, joint_word(&segment.joint_kind)),
            names.join(", "),
        ]);
    }
    let _ = write!(text, "\n{table}\n{}\n", three_rotations(model));
    let mut seen = Seen::default();
    let _ = writeln!(text, "{}", coordinates(opened, &mut seen));
    text.push_str(&seen.legend());
    text.push_str(&muscle_counts(&opened.muscle_tally.0));
    if opened.format == ModelFormat::Adult {
        text.push_str(NOT_JUDGED);
    }
    if !opened.notes.is_empty() {
        text.push_str("\nnotes:\n");
        opened.notes.iter().for_each(|note| {
            let _ = writeln!(text, "  {note}");
        });
    }
    text
}

fn coordinates(opened: &SourcedModel, seen: &mut Seen) -> comfy_table::Table {
    let model = &opened.model;
    let mut table = plain_table();
    table.set_header([
        "coordinate",
        "positive",
        "range",
        "default",
        "passive, N m at limits",
        "strength +/-, N m",
        "fatigue",
    ]);
    for (index, coordinate) in model.coordinates().iter().enumerate() {
        let known = Known::of(opened, index);
        let [range, default] = range_and_default(model, index);
        let passive = match &coordinate.passive {
            None => String::new(),
            Some(law) => {
                let ends = at_limits(opened, index).map(|[low, high]| format!("{low:.1} .. {high:.1} "));
                format!("{}{}{}", ends.unwrap_or_default(), law_word(law), seen.mark(known.passive.as_ref()))
            }
        };
        let (strength, fatigue) = match &coordinate.groups {
            None => (String::new(), String::new()),
            Some([positive, negative]) => (
                format!(
                    "{:.0} / {:.0}{}",
                    positive.strength.greatest(),
                    negative.strength.greatest(),
                    known.strength.iter().map(|source| seen.mark(Some(source))).collect::<String>()
                ),
                fatigue_words([positive, negative], &known, seen),
            ),
        };
        let range = format!("{range}{}", seen.mark(known.range.as_ref()));
        table.add_row([
            coordinate.name.clone(),
            coordinate.positive.clone(),
            range,
            default,
            passive,
            strength,
            fatigue,
        ]);
    }
    table
}

/// The parameters of both groups and their sources; once where they are the same.
fn fatigue_words(groups: [&MuscleGroup; 2], known: &Known, seen: &mut Seen) -> String {
    let word =
        |side: usize, seen: &mut Seen| format!("{}{}", groups[side].fatigue.name(), seen.mark(known.fatigue.get(side)));
    let [positive, negative] = [0, 1].map(|side| word(side, seen));
    if positive == negative { positive } else { format!("{positive} / {negative}") }
}

/// Range and default of a coordinate, in deg or m; the independent coordinate instead of the range of a dependent one.
fn range_and_default(model: &Model, index: usize) -> [String; 2] {
    let coordinate = &model.coordinates()[index];
    let shown = |x: f64| match coordinate.kind {
        _ if x.is_infinite() => "none".to_owned(),
        CoordinateKind::Rotation => format!("{:.1}", x.to_degrees()),
        _ => format!("{x:.3}"),
    };
    let unit = match coordinate.kind {
        CoordinateKind::Rotation => " deg",
        CoordinateKind::Translation => " m",
        CoordinateKind::Quaternion => "",
    };
    let (min, max) = coordinate.range;
    let locked = if coordinate.locked { ", locked" } else { "" };
    let range = match model.couplings().iter().find(|coupling| coupling.dependent == index) {
        Some(coupling) => format!("follows {}", model.coordinates()[coupling.independent].name),
        None => format!("{} .. {}{unit}{locked}", shown(min), shown(max)),
    };
    [range, format!("{}{unit}", shown(coordinate.default))]
}
