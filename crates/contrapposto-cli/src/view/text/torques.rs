//! Frames as JSON, as a table for programs, and as one for readers.

use std::fmt::Write;

use contrapposto::model::{CoordinateKind, Model, Side};
use contrapposto_formats::ReactionText;
use contrapposto_formats::motion::csv_cell;
use contrapposto_formats::tissue::{Origin, SourcedModel};
use serde::Serialize;

use super::joint::AxisText;
use super::reactions::reaction_table;
use super::sources::{Source, StrengthAtText};
use super::{Named, plain_table};
use crate::view::moment::{Moment, MomentJoint};
use crate::view::torque_rows::{Frame, MusclesOfFrame, Order, Row, Torques};

/// One frame in rad, m, N and N m.
#[derive(Serialize)]
pub(crate) struct FrameText<'a> {
    frame: usize,
    time_s: f64,
    /// The posture is held at rest: there is no inertia in its torques.
    quasi_static: bool,
    coordinate_order: Vec<&'a str>,
    coordinates: Named<'a, TorquesText>,
    uncoupled: Named<'a, TorquesText>,
    /// Sum of squares of relative loads, those of three-axis joints about their axes.
    effort: f64,
    joints: Named<'a, MomentText<'a>>,
    /// Of free joints and balls, whose rates are no coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<Named<'a, f64>>,
    center_of_mass: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none", flatten)]
    muscles: Option<MusclesText<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gradient: Option<&'a [Vec<f64>]>,
}

/// Single muscles, with the least sum of squares of activations.
#[derive(Serialize)]
struct MusclesText<'a> {
    /// Tension of every muscle, that of passive fibres included.
    muscle_forces_n: Named<'a, f64>,
    /// The greatest torque that the muscles cannot give; `null`: they give all.
    muscles_lack: Option<MissingText<'a>>,
    /// By joint that muscles cross.
    reactions: Named<'a, &'a ReactionText>,
}

#[derive(Serialize)]
struct MissingText<'a> {
    coordinate: &'a str,
    torque_nm: f64,
}

#[derive(Serialize)]
struct TorquesText {
    angle: Option<f64>,
    external: f64,
    passive: f64,
    active: f64,
    /// The source, if muscles of the model give the passive torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    passive_source: Option<Source>,
    /// The part of the external torque that inertia gives; left out of a posture at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_nm: Option<f64>,
    /// Of the positive and the negative group at this angle. Left out where it is not known, and of three-axis joints, whose muscles are
    /// judged by their moment.
    #[serde(skip_serializing_if = "Option::is_none")]
    strength: Option<[StrengthAtText; 2]>,
}

/// The moment of a joint with three rotations, about axes of its distal segment.
#[derive(Serialize)]
struct MomentText<'a> {
    axes: Vec<AxisText<'a>>,
    external_nm: [f64; 3],
    passive_nm: [f64; 3],
    active_nm: [f64; 3],
    /// The source, if muscles of the model give the passive torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    passive_source: Option<Source>,
    /// Of the positive and the negative group about each axis, where all are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    strength: Option<Vec<[StrengthAtText; 2]>>,
    load: Option<f64>,
}

pub(crate) fn json<'a>(opened: &'a SourcedModel, order: &'a Order, frame: &'a Frame<'_>) -> FrameText<'a> {
    let model = &opened.model;
    let strength = |coordinate: usize| {
        let at = |side| StrengthAtText::at(opened, coordinate, side, frame.values[coordinate]);
        let judged_alone = model.three_axis_joint_of(coordinate).is_none();
        let [positive, negative] = Side::BOTH.map(|side| at(side).filter(|_| judged_alone));
        Some([positive?, negative?])
    };
    let named = |rows: &'a [Row], torques: &[Torques]| {
        let text = |(row, torques): (&'a Row, &Torques)| {
            let Torques { external, passive, active, inertia: inertia_nm } = *torques;
            let angle = row.coordinate.map(|c| frame.values[c]);
            (
                row.name.as_str(),
                TorquesText {
                    angle,
                    external,
                    passive,
                    active,
                    passive_source: row.coordinate.and_then(|coordinate| passive_source(opened, coordinate)),
                    inertia_nm,
                    strength: row.coordinate.and_then(strength),
                },
            )
        };
        Named(rows.iter().zip(torques).map(text).collect())
    };
    let value = |&c: &usize| (model.coordinates()[c].name.as_str(), frame.values[c]);
    FrameText {
        frame: frame.index,
        time_s: frame.time,
        quasi_static: frame.rows.iter().all(|torques| torques.inertia.is_none()),
        coordinate_order: order.rows.iter().map(|row| row.name.as_str()).collect(),
        coordinates: named(&order.rows, &frame.rows),
        uncoupled: named(&order.coupled, &frame.coupled),
        effort: frame.effort,
        joints: Named(order.joints.iter().zip(&frame.moments).map(|joint| moment(opened, joint)).collect()),
        values: (!order.values.is_empty()).then(|| Named(order.values.iter().map(value).collect())),
        center_of_mass: frame.center_of_mass.map(Into::into),
        muscles: frame.muscles.as_ref().map(muscles),
        gradient: frame.gradient.as_deref(),
    }
}

fn moment<'a>(opened: &'a SourcedModel, (joint, moment): (&'a MomentJoint, &Moment)) -> (&'a str, MomentText<'a>) {
    let Moment { external, passive, active, load, .. } = *moment;
    let coordinates = joint.coordinates(&opened.model);
    let strength = |(coordinate, angle): (Option<usize>, f64)| {
        let [positive, negative] = Side::BOTH.map(|side| StrengthAtText::at(opened, coordinate?, side, angle));
        Some([positive?, negative?])
    };
    let text = MomentText {
        axes: AxisText::all(&opened.model, joint),
        external_nm: external,
        passive_nm: passive,
        active_nm: active,
        passive_source: coordinates[0].and_then(|coordinate| passive_source(opened, coordinate)),
        strength: coordinates.into_iter().zip(moment.angles).map(strength).collect(),
        load,
    };
    (&joint.name, text)
}

fn muscles(of: &MusclesOfFrame) -> MusclesText<'_> {
    MusclesText {
        muscle_forces_n: Named(of.tensions.iter().map(|(name, tension)| (name.as_str(), *tension)).collect()),
        muscles_lack: of.lack.as_ref().map(|(coordinate, torque_nm)| MissingText { coordinate, torque_nm: *torque_nm }),
        reactions: Named(of.reactions.iter().map(|(name, reaction)| (name.as_str(), reaction)).collect()),
    }
}

/// The source of a passive torque that muscles of the model give.
fn passive_source(opened: &SourcedModel, coordinate: usize) -> Option<Source> {
    (opened.origins[coordinate].passive == Origin::Muscles).then(Source::of_muscles)
}

/// The columns that a table has besides the three torques.
#[derive(Clone, Copy, Default)]
pub(crate) struct Columns<'a> {
    pub(crate) gradient: bool,
    /// The sentence that says that inertia counts.
    pub(crate) inertia: Option<&'a str>,
}

/// Heads of the table, with OpenSim's own header where tabs separate.
pub(crate) fn header(model: &Model, order: &Order, frames: usize, separator: char, columns: Columns<'_>) -> String {
    let mut labels = vec!["time".to_owned()];
    for &c in &order.values {
        let coordinate = &model.coordinates()[c];
        let what = if coordinate.kind == CoordinateKind::Quaternion { "value" } else { "position_m" };
        labels.push(format!("{}.{what}", plain(&coordinate.name)));
    }
    for row in &order.rows {
        let name = plain(&row.name);
        let unit = if row.turns { "nm" } else { "n" };
        if row.coordinate.is_some() {
            labels.push(format!("{name}.{}", if row.turns { "angle_deg" } else { "position_m" }));
        }
        let torques = ["external", "passive", "active"].into_iter().chain(columns.inertia.map(|_| "inertia"));
        labels.extend(torques.map(|torque| format!("{name}.{torque}_{unit}")));
    }
    if columns.gradient {
        for row in &order.rows {
            labels.extend(
                order.rows.iter().map(|column| format!("{}.external_by.{}", plain(&row.name), plain(&column.name))),
            );
        }
    }
    let mut text = String::new();
    if separator == '\t' {
        let (width, said) = (labels.len(), columns.inertia.unwrap_or("Postures at rest: torques without inertia"));
        text = format!("torques\n{said}\nversion=1\nnRows={frames}\nnColumns={width}\ninDegrees=yes\nendheader\n");
    }
    let mut between = "";
    let separator = separator.to_string();
    for label in labels {
        text.push_str(between);
        text.push_str(&if separator == "," { csv_cell(&label) } else { label });
        between = &separator;
    }
    text.push('\n');
    text
}

/// One row of the table. Numbers are written in the shortest form that reads back the same.
pub(crate) fn row(order: &Order, frame: &Frame<'_>, separator: char) -> String {
    let mut text = format!("{:?}", frame.time);
    let mut put = |value: f64| {
        let _ = write!(text, "{separator}{value:?}");
    };
    order.values.iter().for_each(|&c| put(frame.values[c]));
    for (row, torques) in order.rows.iter().zip(&frame.rows) {
        if let Some(c) = row.coordinate {
            put(if row.turns { frame.values[c].to_degrees() } else { frame.values[c] });
        }
        [torques.external, torques.passive, torques.active].into_iter().chain(torques.inertia).for_each(&mut put);
    }
    frame.gradient.iter().flatten().flatten().for_each(|entry| put(*entry));
    text.push('\n');
    text
}

/// A table for readers, degrees and newton-metres.
pub(crate) fn readable(model: &Model, order: &Order, frame: &Frame<'_>) -> String {
    let mut table = plain_table();
    let moving = frame.rows.iter().any(|torques| torques.inertia.is_some());
    table.set_header(["coordinate", "at", "external", "passive", "active", "unit"]);
    for (row, torques) in order.rows.iter().zip(&frame.rows) {
        table.add_row(cells(row, torques, frame));
    }
    let state = if moving { "in motion, inertia among the external torque" } else { "at rest, without inertia" };
    let mut text = format!("{state}:\n{table}\n");
    if !order.coupled.is_empty() {
        let mut table = plain_table();
        table.set_header(["uncoupled", "at", "external", "passive", "active", "unit"]);
        for (row, torques) in order.coupled.iter().zip(&frame.coupled) {
            table.add_row(cells(row, torques, frame));
        }
        let _ = write!(text, "\nas if no coordinate followed another one:\n{table}\n");
    }
    if !order.values.is_empty() {
        let value = |&c: &usize| format!("{} {:.4}", model.coordinates()[c].name, frame.values[c]);
        let _ = write!(text, "\n{}\n", order.values.iter().map(value).collect::<Vec<_>>().join(", "));
    }
    if let Some(center) = frame.center_of_mass {
        let _ = write!(text, "\ncentre of mass {:.4}, {:.4}, {:.4} m\n", center.x, center.y, center.z);
    }
    if let Some(muscles) = &frame.muscles {
        let joints = muscles.reactions.iter().map(|(name, reaction)| (name.as_str(), reaction, None));
        let _ = write!(text, "\n{}", reaction_table(joints.collect()));
    }
    if let Some(gradient) = &frame.gradient {
        let mut table = plain_table();
        let names = order.rows.iter().map(|row| row.name.clone());
        table.set_header(std::iter::once("d external / d".to_owned()).chain(names));
        for (row, entries) in order.rows.iter().zip(gradient) {
            let entries = entries.iter().map(|entry| shown(*entry));
            table.add_row(std::iter::once(row.name.clone()).chain(entries));
        }
        let _ = write!(text, "\nN m (N) per rad (m):\n{table}\n");
    }
    text
}

fn cells(row: &Row, torques: &Torques, frame: &Frame<'_>) -> [String; 6] {
    let at = match row.coordinate.map(|c| frame.values[c]) {
        None => String::new(),
        Some(value) if row.turns => format!("{:.2} deg", value.to_degrees()),
        Some(value) => format!("{value:.4} m"),
    };
    let [external, passive, active] = [torques.external, torques.passive, torques.active].map(shown);
    [row.name.clone(), at, external, passive, active, if row.turns { "N m" } else { "N" }.to_owned()]
}

/// Three decimals, without the sign of -0.
fn shown(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

/// A name that is safe inside a column's title.
fn plain(name: &str) -> String {
    name.trim().chars().map(|c| if c == ',' || c == '"' || c.is_control() { '_' } else { c }).collect()
}
