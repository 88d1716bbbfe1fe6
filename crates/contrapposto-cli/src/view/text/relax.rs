//! `relax.json`, and the terminal table of the postures of least effort.

use std::collections::BTreeMap;
use std::f64::consts::LN_2;
use std::fmt::Write;

use contrapposto::equilibria::{Direction, Equilibria, RelaxedPosture, Work};
use contrapposto::hybrid::{Carrier, Equilibrium};
use contrapposto::joint_torques::LEAST_MUSCLE_STRENGTH;
use contrapposto::model::Model;
use contrapposto::posture_solver::Reason;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::Task;
use contrapposto_formats::{AdviceText, MuscleWorkText, RelaxScenario, SlipText, VerdictText};
use serde::Serialize;

use super::group::GroupName;
use super::plain_table;
use crate::view::answer::Answer;
use crate::view::muscle_work::MusclesAtWork;
use crate::view::three_axis::angles;
use crate::view::words::how_long;
use crate::view::words::shares_of_all;
use crate::view::words::{MOST_JOINTS_SHOWN, joint as in_words};

/// Slip that a table shows, m or degrees.
const SLIP_SHOWN: f64 = 1e-6;

/// The whole file.
#[derive(Serialize)]
pub(crate) struct RelaxText {
    title: String,
    model: String,
    /// The answer: that of the posture of least effort.
    verdict: VerdictText,
    /// Changes of the job that were tried.
    #[serde(flatten)]
    advice: AdviceText,
    /// Starts that were tried, and how many of them fell.
    starts: usize,
    fell: usize,
    /// Different postures left out: their tasks were left farther away, or their supports slipped.
    left_out: usize,
    /// Postures left out that a person would call the same way to stand, or could not hold.
    alike: usize,
    steps: usize,
    coordinate_order: Vec<String>,
    /// The one of least effort first.
    pub(crate) postures: Vec<RelaxedPostureText>,
    files: Vec<String>,
}

#[derive(Serialize)]
pub(crate) struct RelaxedPostureText {
    /// Sum of (active torque / strength)^2 over the coordinates of the effort task.
    pub(crate) effort: f64,
    /// `true`: the mirror image of the posture takes the same effort and is not listed.
    mirrored: bool,
    /// `false`: it still moved after the largest number of steps; effort still fell, by little.
    settled: bool,
    /// `ligaments`, `gravity` (it comes back by itself), `attention` (it does not), or `null` where nothing can move.
    held_by: Option<&'static str>,
    /// Directions in which it does not come back by itself, the worst first.
    unstable: Vec<DirectionText>,
    /// Directions that the supports leave free.
    free_directions: usize,
    /// Size of the part of the stiffness without energy, against the rest.
    stiffness_without_energy: f64,
    supports: Vec<CarriedText>,
    /// Errors of the tasks, lengths in their units.
    tasks: Vec<TaskErrorText>,
    slip: SlipText,
    /// Joints whose ligaments carry half or more of the external torque.
    hanging: Vec<HangingText>,
    /// Groups that work, the hardest first.
    groups: Vec<WorkText>,
    /// The group that fails first when the posture is held from a rested start; `null`: none.
    fails_first: Option<WorkText>,
    /// rad, m, components of quaternions.
    coordinates: BTreeMap<String, f64>,
    /// Starts that led here.
    starts: Vec<String>,
    /// The muscles of a body whose strength they give.
    #[serde(flatten)]
    muscle_work: Option<MuscleWorkText>,
}

#[derive(Serialize)]
struct DirectionText {
    /// 1/s2, by the body's inertia.
    stiffness: f64,
    by_tissue: f64,
    by_load: f64,
    /// Time in which a disturbance grows by e; `null` where it neither grows nor comes back.
    growth_time_s: Option<f64>,
    joints: Vec<ShareText>,
}

#[derive(Serialize)]
struct ShareText {
    coordinate: String,
    share: f64,
}

#[derive(Serialize)]
pub(crate) struct CarriedText {
    segment: String,
    share: f64,
    force_n: [f64; 3],
    center_of_pressure_m: Option<[f64; 3]>,
}

#[derive(Serialize)]
struct TaskErrorText {
    task: String,
    error: f64,
}

#[derive(Serialize)]
struct HangingText {
    coordinate: String,
    /// Of a three-axis joint the angle about the axis that stands for the coordinate.
    value: f64,
    external_nm: f64,
    passive_nm: f64,
    share: f64,
}

#[derive(Serialize)]
struct WorkText {
    #[serde(flatten)]
    name: GroupName,
    active_nm: f64,
    relative_load: f64,
    /// At the angle of the posture.
    strength_nm: f64,
    /// The strength is the least share of its peak.
    strength_is_floor: bool,
    /// Time for which the group can hold this load from a rested start; `null`: for ever.
    endurance_s: Option<f64>,
}

impl RelaxText {
    pub(crate) fn new(
        scenario: &RelaxScenario,
        (found, muscles): (&Equilibria, Option<&MusclesAtWork<'_>>),
        answer: &Answer,
        files: Vec<String>,
    ) -> Self {
        let posture = |(i, posture): (usize, &RelaxedPosture)| {
            let muscles = muscles.map(|muscles| muscles.text_of_moment(i));
            RelaxedPostureText::new(scenario, posture, muscles)
        };
        let names = scenario.model.coordinates().iter().map(|c| c.name.clone());
        Self {
            title: scenario.title.clone(),
            model: scenario.model.name().to_owned(),
            verdict: VerdictText::new(&scenario.model, &answer.verdict),
            advice: (&answer.advice).into(),
            starts: found.starts,
            fell: found.fell,
            left_out: found.yielded,
            alike: found.alike,
            steps: found.steps,
            coordinate_order: names.collect(),
            postures: found.postures.iter().enumerate().map(posture).collect(),
            files,
        }
    }
}

impl RelaxedPostureText {
    fn new(scenario: &RelaxScenario, found: &RelaxedPosture, muscle_work: Option<MuscleWorkText>) -> Self {
        let model = &scenario.model;
        let name = |i: usize| model.coordinates()[i].name.clone();
        let supports = scenario.supports.iter().zip(&found.supports).map(|(support, carried)| CarriedText {
            segment: model.segments()[support.segment].name.clone(),
            share: carried.share,
            force_n: carried.force.into(),
            center_of_pressure_m: carried.center_of_pressure.map(Into::into),
        });
        let effort = |goal: &PriorityLevel| goal.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
        let goals = scenario.goals.iter().zip(&scenario.labels).zip(&found.relaxed.levels);
        let tasks = goals.filter(|((goal, _), _)| !effort(goal));
        let angles = angles(model, found.relaxed.posture.values());
        let hanging = found.hanging.iter().map(|hanging| HangingText {
            coordinate: name(hanging.coordinate),
            value: angles[hanging.coordinate],
            external_nm: hanging.external,
            passive_nm: hanging.passive,
            share: hanging.share(),
        });
        let group = |work: &Work| WorkText {
            name: GroupName::new(model, work.coordinate, work.side),
            active_nm: work.active,
            relative_load: work.relative_load(),
            strength_nm: work.strength,
            strength_is_floor: model.coordinates()[work.coordinate]
                .groups
                .as_ref()
                .is_some_and(|groups| groups[work.side.index()].strength.is_floor_torque(work.strength))
                || work.strength <= LEAST_MUSCLE_STRENGTH,
            endurance_s: work.endurance.is_finite().then_some(work.endurance),
        };
        let values = found.relaxed.posture.values().iter().copied();
        Self {
            effort: found.relaxed.effort,
            mirrored: found.mirrored,
            settled: found.relaxed.reason != Reason::StepLimit,
            held_by: found.stability.equilibrium.map(|equilibrium| match equilibrium {
                Equilibrium::Stable(Carrier::Ligaments) => "ligaments",
                Equilibrium::Stable(Carrier::Gravity) => "gravity",
                Equilibrium::Unstable => "attention",
            }),
            unstable: found.stability.unstable().iter().map(|direction| DirectionText::new(model, direction)).collect(),
            free_directions: found.stability.directions.len(),
            stiffness_without_energy: found.stability.without_energy,
            supports: supports.collect(),
            tasks: tasks
                .map(|((_, labels), level)| TaskErrorText { task: labels.join(" + "), error: level.length })
                .collect(),
            slip: found.relaxed.slip.into(),
            hanging: hanging.collect(),
            groups: found.work.iter().map(group).collect(),
            fails_first: found.fails_first().map(group),
            coordinates: (0..model.coordinates().len()).map(name).zip(values).collect(),
            starts: found.starts.clone(),
            muscle_work,
        }
    }
}

impl DirectionText {
    fn new(model: &Model, found: &Direction) -> Self {
        let share = |&(i, share): &(usize, f64)| ShareText { coordinate: model.coordinates()[i].name.clone(), share };
        Self {
            stiffness: found.stiffness,
            by_tissue: found.by_tissue,
            by_load: found.by_load,
            growth_time_s: found.growth_time(),
            joints: found.joints.iter().map(share).collect(),
        }
    }
}

/// `12 %`, with decimals where the share is small.
pub(crate) fn percent(share: f64) -> String {
    if (100.0 * share).abs() < 9.95 { format!("{:.1} %", 100.0 * share) } else { format!("{:.0} %", 100.0 * share) }
}

/// `calcn_r 85 %, calcn_l 15 %`.
pub(crate) fn weight(posture: &RelaxedPostureText) -> String {
    let shares = shares_of_all(&posture.supports.iter().map(|support| support.share).collect::<Vec<_>>());
    let words =
        posture.supports.iter().zip(shares).map(|(support, share)| format!("{} {}", support.segment, percent(share)));
    words.collect::<Vec<_>>().join(", ")
}

/// `1`, or `1 and its mirror image`.
pub(crate) fn number_in_words(i: usize, mirrored: bool) -> String {
    if mirrored { format!("{} and its mirror image", i + 1) } else { (i + 1).to_string() }
}

/// One row a posture, then the details of each.
pub(crate) fn report(text: &RelaxText) -> String {
    let mut table = plain_table();
    table.set_header(["posture", "effort", "weight on", "held by", "highest load"]);
    for (i, posture) in text.postures.iter().enumerate() {
        let hardest = posture.groups.first().map(|group| format!("{}, {}", group.name, percent(group.relative_load)));
        table.add_row([
            number_in_words(i, posture.mirrored),
            format!("{:.4}", posture.effort),
            weight(posture),
            posture.held(),
            hardest.unwrap_or_default(),
        ]);
    }
    let title = if text.title.is_empty() { String::new() } else { format!("{}\n", text.title) };
    let mut out = format!("{title}{table}\n");
    for (i, posture) in text.postures.iter().enumerate() {
        let _ = write!(out, "\nposture {}:\n{}", i + 1, posture.words());
    }
    let _ = write!(out, "\n{} start{}", text.starts, if text.starts == 1 { "" } else { "s" });
    for (count, what) in [
        (text.fell, "fell"),
        (text.left_out, "left out because tasks or supports were kept less well"),
        (text.alike, "left out as another way of the same, or too heavy"),
    ] {
        if count > 0 {
            let _ = write!(out, ", {count} {what}");
        }
    }
    out.push('\n');
    out
}

impl RelaxedPostureText {
    fn held(&self) -> String {
        match (self.held_by, self.unstable.len()) {
            (Some("attention"), 1) => "attention, in 1 direction".to_owned(),
            (Some("attention"), n) => format!("attention, in {n} directions"),
            (by, _) => by.unwrap_or("its supports alone").to_owned(),
        }
    }

    fn words(&self) -> String {
        let mut out = String::new();
        let mut line = |what: &str, list: Vec<String>| {
            if !list.is_empty() {
                let _ = writeln!(out, "  {what}: {}", list.join("; "));
            }
        };
        let hanging = self.hanging.iter().take(MOST_JOINTS_SHOWN).map(|joint| {
            let share = percent(joint.share);
            let at = format!("{} at {:.1} deg", in_words(&joint.coordinate), joint.value.to_degrees());
            format!("{at}, {:.1} N m, {share} of the external torque", joint.passive_nm)
        });
        line("hangs on ligaments", hanging.collect());
        let work = self.groups.iter().take(MOST_JOINTS_SHOWN);
        line(
            "highest loads",
            work.map(|group| format!("{} {:.1} N m, {}", group.name, group.active_nm, percent(group.relative_load)))
                .collect(),
        );
        let work = self.muscle_work.iter().flat_map(|work| work.hardest(MOST_JOINTS_SHOWN));
        line(
            "hardest-worked muscles",
            work.map(|(name, muscle)| format!("{name} {:.0} N, {}", muscle.force_n, percent(muscle.peak_activation)))
                .collect(),
        );
        let lack = self.muscle_work.iter().filter_map(|work| work.muscles_lack.as_ref());
        line(
            "muscles together lack",
            lack.map(|lack| format!("{:.1} N m at {}", lack.torque_nm, in_words(&lack.coordinate))).collect(),
        );
        line(
            "endurance",
            vec![match self.fails_first.as_ref().and_then(|group| Some((group, group.endurance_s?))) {
                Some((group, time)) => format!("{}, then {} fails", how_long(time), group.name),
                None => "no limit by muscles".to_owned(),
            }],
        );
        let unstable = self.unstable.iter().take(MOST_JOINTS_SHOWN).map(|direction| {
            let joints = direction.joints.iter().take(MOST_JOINTS_SHOWN);
            let joints: Vec<String> =
                joints.map(|joint| format!("{} {}", in_words(&joint.coordinate), percent(joint.share))).collect();
            let grows = direction.growth_time_s.map(|time| format!(" (doubles in {:.2} s)", LN_2 * time));
            joints.join(", ") + grows.as_deref().unwrap_or_default()
        });
        line("unstable", unstable.collect());
        let left = self.tasks.iter().filter(|task| task.error > 1e-6);
        line("not reached", left.map(|task| format!("{} by {:.4} (m, rad)", task.task, task.error)).collect());
        let SlipText { distance_m, angle_deg } = self.slip;
        if distance_m > SLIP_SHOWN || angle_deg > SLIP_SHOWN {
            line("supports slip", vec![format!("by {distance_m:.1e} m and {angle_deg:.1e} degrees")]);
        }
        if !self.settled {
            line("not converged", vec!["the step limit was reached; effort may still fall a little".to_owned()]);
        }
        out
    }
}
