//! `contrapposto inspect --json`: everything that is known of a model.

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::math::Function;
use contrapposto::model::{Coordinate, CoordinateKind, Model};
use serde::Serialize;

use super::sources::{Known, Source};
use super::{at_limits, joint_word, law_word};
use crate::model_file::Opened;

#[derive(Serialize)]
pub(super) struct Report<'a> {
    file: &'a str,
    format: &'static str,
    name: &'a str,
    mass_kg: f64,
    gravity_m_s2: [f64; 3],
    /// In the default posture.
    center_of_mass_m: Option<[f64; 3]>,
    segments: Vec<SegmentText<'a>>,
    coordinate_order: Vec<&'a str>,
    coordinates: BTreeMap<&'a str, CoordinateText<'a>>,
    /// What was ignored, changed or filled in, one sentence each.
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
struct JointText<'a> {
    name: &'a str,
    kind: &'static str,
    coordinates: Vec<&'a str>,
}

#[derive(Serialize)]
struct CoordinateText<'a> {
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
    fatigue: Option<FatigueText>,
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
struct StrengthText<'a> {
    positive: GroupText<'a>,
    negative: GroupText<'a>,
}

#[derive(Serialize)]
struct GroupText<'a> {
    name: &'a str,
    peak_nm: f64,
    at_rad: f64,
    source: Option<Source>,
}

#[derive(Serialize)]
struct FatigueText {
    class: Option<&'static str>,
    source: Option<Source>,
}

pub(super) fn report<'a>(opened: &'a Opened, file: &'a str) -> Report<'a> {
    let model = &opened.model;
    let coordinates = model.coordinates();
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
            .map(|segment| SegmentText {
                name: &segment.name,
                parent: segment.parent.map(|parent| model.segments()[parent].name.as_str()),
                mass_kg: segment.mass,
                center_of_mass_m: segment.center_of_mass.into(),
                inertia_kg_m2: [0, 1, 2].map(|i| [0, 1, 2].map(|j| segment.inertia[(i, j)])),
                joint: JointText {
                    name: &segment.joint,
                    kind: joint_word(&segment.joint_kind),
                    coordinates: coordinates[segment.coordinates.clone()].iter().map(|c| c.name.as_str()).collect(),
                },
            })
            .collect(),
        coordinate_order: coordinates.iter().map(|c| c.name.as_str()).collect(),
        coordinates: coordinates
            .iter()
            .enumerate()
            .map(|(index, coordinate)| (coordinate.name.as_str(), text(opened, model, index, coordinate)))
            .collect(),
        notes: &opened.notes,
    }
}

fn text<'a>(opened: &Opened, model: &'a Model, index: usize, coordinate: &'a Coordinate) -> CoordinateText<'a> {
    let known = Known::of(opened, index);
    let (kind, unit) = match coordinate.kind {
        CoordinateKind::Rotation => ("rotation", "rad"),
        CoordinateKind::Translation => ("translation", "m"),
        CoordinateKind::Quaternion => ("quaternion", "1"),
    };
    let limit = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
    let follows = model.couplings().iter().find(|coupling| coupling.dependent == index);
    let group = |side: usize| {
        let source = known.strength.get(side).or(known.strength.first()).cloned();
        coordinate.groups.as_ref().map(|groups| {
            let group = &groups[side];
            GroupText { name: &group.name, peak_nm: group.strength.peak, at_rad: group.strength.best, source }
        })
    };
    CoordinateText {
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
        strength: group(0).zip(group(1)).map(|(positive, negative)| StrengthText { positive, negative }),
        fatigue: coordinate.groups.as_ref().map(|_| FatigueText { class: known.class, source: known.fatigue.clone() }),
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
