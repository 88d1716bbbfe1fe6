//! Muscles in a posture, as a line of JSON and as tables for readers.

use std::fmt::Write;

use contrapposto::muscle::{CoupledStrength, FiberState, Muscle, PathGeometry};
use contrapposto_formats::tissue::SourcedModel;
use serde::Serialize;

use super::{Named, plain_table};
use crate::args::RuleChoice;
use crate::fail::Fail;

/// All muscles in one posture.
pub(crate) struct MuscleFrame<'a> {
    pub(crate) index: usize,
    pub(crate) time: f64,
    pub(crate) rule: RuleChoice,
    pub(crate) activation: f64,
    pub(crate) geometry: &'a PathGeometry,
    /// At `activation`.
    pub(crate) rest: &'a [FiberState],
    /// At full activation.
    pub(crate) full: &'a [FiberState],
    /// By rate, positive first.
    pub(crate) strength: &'a [[f64; 2]],
    /// Strength about each crossed rate while all others carry no torque.
    pub(crate) coupled: &'a [CoupledStrength],
    /// Torque of passive fibre forces by rate.
    pub(crate) passive: &'a [f64],
}

/// One posture, in rad, m, N and N m.
#[derive(Serialize)]
struct FrameText<'a> {
    frame: usize,
    time_s: f64,
    rule: &'static str,
    activation: f64,
    lengths_m: Named<'a, f64>,
    /// By muscle, by coordinate; those that are exactly zero are left out.
    moment_arms_m: Named<'a, Named<'a, f64>>,
    fibre_lengths_m: Named<'a, f64>,
    tendon_forces_n: Named<'a, f64>,
    /// Along the tendon.
    passive_forces_n: Named<'a, f64>,
    /// Of the tendon at full activation.
    max_forces_n: Named<'a, f64>,
    passive_torques_nm: Named<'a, f64>,
    strength_nm: Named<'a, StrengthText>,
}

#[derive(Serialize)]
struct StrengthText {
    positive: SenseText,
    negative: SenseText,
    /// Torque that the muscles lack to keep all other joints without torque, summed over these joints.
    missing_nm: f64,
}

/// Strength of one sense.
#[derive(Serialize)]
struct SenseText {
    /// The muscles that pull this way at full activation, all others at that of the frame.
    sum: f64,
    /// The same while the muscles give no torque about any other joint.
    coupled: f64,
}

pub(crate) fn json(opened: &SourcedModel, frame: &MuscleFrame<'_>) -> Result<String, Fail> {
    let muscles = &opened.muscles.muscles;
    let by_muscle = |value: &dyn Fn(usize, &Muscle) -> f64| {
        Named(muscles.iter().enumerate().map(|(i, muscle)| (muscle.spec().name.as_str(), value(i, muscle))).collect())
    };
    let arms = |muscle: &Muscle| {
        let arms = opened.model.rates().iter().zip(frame.geometry.moment_arms(muscle.spec().path));
        Named(arms.filter(|(_, arm)| **arm != 0.0).map(|(rate, arm)| (rate.name.as_str(), *arm)).collect())
    };
    let text = FrameText {
        frame: frame.index,
        time_s: frame.time,
        rule: rule_word(frame.rule),
        activation: frame.activation,
        lengths_m: by_muscle(&|_, muscle| frame.geometry.lengths()[muscle.spec().path]),
        moment_arms_m: Named(muscles.iter().map(|muscle| (muscle.spec().name.as_str(), arms(muscle))).collect()),
        fibre_lengths_m: by_muscle(&|i, _| frame.rest[i].fiber_length),
        tendon_forces_n: by_muscle(&|i, _| frame.rest[i].tendon_force),
        passive_forces_n: by_muscle(&|i, _| frame.rest[i].passive_force),
        max_forces_n: by_muscle(&|i, _| frame.full[i].tendon_force),
        passive_torques_nm: Named(
            frame.coupled.iter().map(|c| (opened.model.rates()[c.rate].name.as_str(), frame.passive[c.rate])).collect(),
        ),
        strength_nm: Named(
            frame
                .coupled
                .iter()
                .map(|coupled| {
                    let sense =
                        |k: usize| SenseText { sum: frame.strength[coupled.rate][k], coupled: coupled.torque[k] };
                    let text = StrengthText { positive: sense(0), negative: sense(1), missing_nm: coupled.missing };
                    (opened.model.rates()[coupled.rate].name.as_str(), text)
                })
                .collect(),
        ),
    };
    serde_json::to_string(&text).map(|line| line + "\n").map_err(|error| Fail::job("JSON", error))
}

pub(super) fn rule_word(rule: RuleChoice) -> &'static str {
    match rule {
        RuleChoice::Geodesic => "geodesic",
        RuleChoice::Opensim => "opensim",
    }
}

pub(crate) fn readable(opened: &SourcedModel, frame: &MuscleFrame<'_>) -> String {
    let mut text = format!(
        "instant {} at {} s, rule {}, activation {}\n",
        frame.index,
        frame.time,
        rule_word(frame.rule),
        frame.activation
    );
    let mut table = plain_table();
    table.set_header(["muscle", "path, mm", "fibres, mm", "tendon, N", "passive, N", "at most, N", "moment arms, mm"]);
    for (i, muscle) in opened.muscles.muscles.iter().enumerate() {
        let (rest, full) = (&frame.rest[i], &frame.full[i]);
        let row = opened.model.rates().iter().zip(frame.geometry.moment_arms(muscle.spec().path));
        let arms = row.filter(|(rate, arm)| rate.rotational && arm.abs() >= LEAST_ARM);
        let arms: Vec<String> = arms.map(|(rate, arm)| format!("{} {:.1}", rate.name, arm * 1e3)).collect();
        table.add_row([
            muscle.spec().name.clone(),
            format!("{:.1}", frame.geometry.lengths()[muscle.spec().path] * 1e3),
            format!("{:.1}", rest.fiber_length * 1e3),
            format!("{:.1}", rest.tendon_force),
            format!("{:.1}", rest.passive_force),
            format!("{:.0}", full.tendon_force),
            arms.join(", "),
        ]);
    }
    let _ = writeln!(text, "{table}\n");
    let mut table = plain_table();
    table.set_header(["coordinate", "passive, N m", "strength +/-, N m", "other joints without torque"]);
    for coupled in frame.coupled {
        let both = |[positive, negative]: [f64; 2]| format!("{positive:.1} / {negative:.1}");
        let lacks =
            if coupled.missing > LEAST_LACK { format!(" (lacks {:.1})", coupled.missing) } else { String::new() };
        table.add_row([
            opened.model.rates()[coupled.rate].name.clone(),
            format!("{:.2}", frame.passive[coupled.rate]),
            both(frame.strength[coupled.rate]),
            both(coupled.torque) + &lacks,
        ]);
    }
    let _ = writeln!(text, "{table}\n");
    text
}

/// Smallest moment arm that the table shows, m.
const LEAST_ARM: f64 = 5e-5;
/// Smallest torque that muscles lack at other joints of which the table tells, N m.
const LEAST_LACK: f64 = 0.05;
