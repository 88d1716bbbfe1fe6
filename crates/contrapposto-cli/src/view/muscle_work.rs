//! Computes how hard every muscle works in the moments that a page shows, and where it lies.

use contrapposto::joint_torques::{JointMuscles, JointReactions, MissingTorque, MuscleWork, PathForces};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Side};
use contrapposto::muscle::{DrawnPoint, Muscle, Musculature};
use contrapposto::posture::Posture;
use contrapposto::simulation::{MuscleOutcome, MuscleSummary};
use contrapposto::statics::{Load, LoadError};
use contrapposto_formats::animation::Tube;
use contrapposto_formats::{
    LEAST_ACTIVATION_SAID, LackText, MuscleWorkText, MusclesFailText, PeakReactionText, ReactionText, TiredMuscleText,
    WorkedMuscleText, WorksForText,
};
use contrapposto_plot::{BodyMuscle, load_color};
use nalgebra::Point3;

use super::axes::turn;
use super::frame::Frame;
use super::text::plain_table;
use super::text::reactions::reaction_table;
use super::words::{group, moment_in_words, percent, plain};
use crate::fail::Fail;

/// Most rows of the table in the terminal.
const MOST_MUSCLES: usize = 5;
/// Activations nearer than this are one: they come from different starts of the solver.
const ALIKE: f64 = 1e-6;
/// Colour of a muscle at rest, as on the page.
const RESTING_COLOR: [u8; 3] = [0xb9, 0x92, 0x8c];
/// Radius of a drawn muscle by the square root of its greatest force, m per root of N: 0.3 of that of fibres of 61 N/cm2 (assumed).
const RADIUS: f64 = 2.2e-4;
/// Least and greatest radius, m.
const RADII: [f64; 2] = [0.0025, 0.009];

/// Muscles that give joints their strength, in some moments.
pub(crate) struct MusclesAtWork<'a> {
    model: &'a Model,
    work: MuscleWork,
    /// The muscles of a run in which they tire one by one.
    tired: Option<&'a MuscleOutcome>,
    /// In the order of the frames.
    pub(crate) moments: Vec<WorkingMoment>,
}

/// The muscles in one moment.
pub(crate) struct WorkingMoment {
    pub(crate) time: f64,
    /// Whether it counts for the table: not while a support is put elsewhere.
    judged: bool,
    pub(crate) activations: Vec<f64>,
    /// N.
    pub(crate) tensions: Vec<f64>,
    /// The greatest torque that the muscles cannot give.
    pub(crate) missing: Option<MissingTorque>,
    /// By joint that muscles cross, outermost last; none where the loads are not known.
    pub(crate) reactions: Vec<(String, ReactionText)>,
    /// The line of every muscle, each point in the frame of its segment, m.
    pub(crate) lines: Vec<Vec<DrawnPoint>>,
}

/// A muscle at its greatest activation.
struct Peak<'a> {
    name: &'a str,
    works_for: Option<(usize, Side)>,
    activation: f64,
    tension: f64,
    time: f64,
    /// Of a muscle that tires by itself.
    tired: Option<&'a MuscleSummary>,
}

/// The muscles of a body in moments; `None` of one whose muscles give no joint its strength. `judged`: whether a time counts for the table.
pub(crate) fn muscles_at_work<'a>(
    model: &'a Model,
    muscles: Option<&JointMuscles>,
    frames: &[Frame],
    judged: impl Fn(f64) -> bool,
) -> Result<Option<MusclesAtWork<'a>>, Fail> {
    let Some(mut work) = muscles.and_then(|muscles| MuscleWork::new(model, muscles)) else { return Ok(None) };
    let mut reactions = JointReactions::new(model, work.muscles().musculature());
    let mut moments = vec![];
    for frame in frames {
        let active: Vec<f64> = (0..frame.external.len()).map(|i| frame.active(i)).collect();
        let posture = Posture::new(frame.posture.clone());
        work.update(model, &posture, &active).map_err(|error| Fail::job("muscles", error))?;
        let local = |mut point: DrawnPoint| {
            if let Some(segment) = point.segment {
                let frame = work.kinematics().placement(model, segment);
                point.place = frame.inverse_transform_point(&point.place.into()).coords;
            }
            point
        };
        let known = frame
            .loads
            .as_deref()
            .map(|loads| reacted(model, &work, loads, &mut reactions).map_err(|error| Fail::job("muscles", error)));
        let count = work.tensions().len();
        // Muscles that have tired one by one share the torques in another way than rested ones.
        let [activations, tensions] = match frame.muscles.is_empty() {
            true => [work.activations().to_vec(), work.tensions().to_vec()],
            false => [0, 1].map(|k| frame.muscles.iter().map(|muscle| muscle[k]).collect()),
        };
        moments.push(WorkingMoment {
            time: frame.time,
            judged: judged(frame.time),
            activations,
            tensions,
            missing: work.missing(model),
            reactions: known.transpose()?.unwrap_or_default(),
            lines: (0..count).map(|muscle| work.line(muscle).into_iter().map(local).collect()).collect(),
        });
    }
    Ok(Some(MusclesAtWork { model, work, tired: None, moments }))
}

/// Force and moment of the joints that muscles cross, by name of the joint, in the posture of `work`.
pub(crate) fn reacted(
    model: &Model,
    work: &MuscleWork,
    loads: &[Load],
    reactions: &mut JointReactions,
) -> Result<Vec<(String, ReactionText)>, LoadError> {
    let muscles = work.muscles();
    let (geometry, tensions) = (muscles.about_axes(), work.tensions());
    let paths = PathForces { muscles: muscles.musculature(), geometry, tensions };
    reactions.update(model, work.kinematics(), loads, paths)?;
    let text = |segment: usize| {
        let reaction = ReactionText::new(model, work.kinematics(), segment, &reactions.all()[segment]);
        (model.segments()[segment].joint.clone(), reaction)
    };
    Ok(reactions.crossed().map(text).collect())
}

impl<'a> MusclesAtWork<'a> {
    /// The same muscles in a run in which they tire one by one: what they did in it counts, not what rested ones would have done.
    pub(crate) fn tiring(self, outcome: Option<&'a MuscleOutcome>) -> Self {
        Self { tired: outcome, ..self }
    }

    /// The muscles.
    pub(crate) fn musculature(&self) -> &Musculature {
        self.work.muscles().musculature()
    }

    /// The group that a muscle works for, in words.
    pub(crate) fn works_for(&self, muscle: usize) -> String {
        self.work.works_for()[muscle].map_or_else(String::new, |of| group_in_words(self.model, of))
    }

    /// Index of the coordinate of that group.
    pub(crate) fn joint(&self, muscle: usize) -> Option<usize> {
        self.work.works_for()[muscle].map(|(coordinate, _)| coordinate)
    }

    /// The muscles as they lie in the first moment, coloured by their greatest activation.
    pub(crate) fn tubes(&self) -> Vec<Tube> {
        let Some(first) = self.moments.first() else { return vec![] };
        let all = self.musculature().muscles.iter().zip(&first.lines).zip(self.all_peaks());
        let tube = |((muscle, line), peak): ((&Muscle, &Vec<DrawnPoint>), Peak<'_>)| {
            let point = |point: &DrawnPoint| (point.segment, point.place.into());
            let branches = line.chunk_by(|_, next| !next.begins).map(|branch| branch.iter().map(point).collect());
            let color =
                if peak.activation < LEAST_ACTIVATION_SAID { RESTING_COLOR } else { load_color(peak.activation) };
            Tube { lines: branches.collect(), radius: radius(muscle.spec().max_isometric_force), color }
        };
        all.map(tube).collect()
    }

    /// The muscles of the moment of this number as a figure shows them.
    pub(crate) fn drawn(&self, moment: usize, posture: &[f64]) -> Result<Vec<BodyMuscle>, Fail> {
        let Some(moment) = self.moments.get(moment) else { return Ok(vec![]) };
        let (turn, mut kinematics) = (turn(self.model), Kinematics::new(self.model));
        let updated = kinematics.update(self.model, &Posture::new(posture.to_vec()));
        updated.map_err(|error| Fail::job("picture", error))?;
        let point = |point: &DrawnPoint| match point.segment {
            Some(segment) => turn.point((kinematics.placement(self.model, segment) * Point3::from(point.place)).coords),
            None => turn.point(point.place),
        };
        let lines = self.musculature().muscles.iter().zip(&moment.lines).zip(&moment.activations);
        let muscle = |((muscle, line), &activation): ((&Muscle, &Vec<DrawnPoint>), &f64)| {
            let branches = line.chunk_by(|_, next| !next.begins);
            let lines = branches.map(|branch| branch.iter().map(point).collect()).collect();
            BodyMuscle { lines, radius: radius(muscle.spec().max_isometric_force), activation }
        };
        Ok(lines.map(muscle).collect())
    }

    fn all_peaks(&self) -> impl Iterator<Item = Peak<'_>> {
        self.peaks_in(&self.moments)
    }

    /// Every muscle at its greatest activation in some moments.
    fn peaks_in<'b>(&'b self, moments: &'b [WorkingMoment]) -> impl Iterator<Item = Peak<'b>> {
        self.musculature().muscles.iter().enumerate().filter_map(|(m, muscle)| {
            let mut judged = moments.iter().filter(|moment| moment.judged);
            let (name, works_for) = (muscle.spec().name.as_str(), self.work.works_for()[m]);
            if let Some(of) = self.tired.map(|outcome| &outcome.muscles[m]) {
                let (activation, time) = of.peak_load;
                return Some(Peak { name, works_for, activation, tension: of.peak_tension, time, tired: Some(of) });
            }
            // Of equals the first.
            let greatest = judged.clone().map(|moment| moment.activations[m]).fold(0.0, f64::max);
            let moment = judged.find(|moment| moment.activations[m] >= greatest - ALIKE)?;
            Some(Peak {
                name,
                works_for,
                tired: None,
                activation: moment.activations[m],
                tension: moment.tensions[m],
                time: moment.time,
            })
        })
    }

    /// The greatest torque that the muscles cannot give, and its time, s.
    fn lack(&self) -> Option<(MissingTorque, f64)> {
        Self::lack_in(&self.moments)
    }

    fn lack_in(moments: &[WorkingMoment]) -> Option<(MissingTorque, f64)> {
        let judged = moments.iter().filter(|moment| moment.judged);
        let all = judged.filter_map(|moment| Some((moment.missing?, moment.time)));
        all.rev().max_by(|a, b| a.0.torque.total_cmp(&b.0.torque))
    }

    /// The joints that muscles cross, each at its greatest compression.
    fn pressed_in(moments: &[WorkingMoment]) -> impl Iterator<Item = (&str, PeakReactionText)> {
        let judged = || moments.iter().filter(|moment| moment.judged && !moment.reactions.is_empty());
        let joints = judged().next().map_or(0, |moment| moment.reactions.len());
        let pressed =
            |moment: &WorkingMoment, joint: usize| moment.reactions[joint].1.compression_n.unwrap_or(f64::NEG_INFINITY);
        (0..joints).filter_map(move |joint| {
            // Of equals the first.
            let greatest = judged().map(|moment| pressed(moment, joint)).fold(f64::NEG_INFINITY, f64::max);
            let moment = judged().find(|moment| pressed(moment, joint) >= greatest)?;
            let (name, reaction) = &moment.reactions[joint];
            Some((name.as_str(), PeakReactionText { at_s: moment.time, reaction: reaction.clone() }))
        })
    }

    /// The joints that are pressed together most, as a table for the terminal; empty where the loads are not known.
    fn pressed_table(&self) -> String {
        let pressed: Vec<_> = Self::pressed_in(&self.moments).collect();
        reaction_table(pressed.iter().map(|(name, peak)| (*name, &peak.reaction, Some(peak.at_s))).collect())
    }

    /// The entries of a JSON file.
    pub(crate) fn text(&self) -> MuscleWorkText {
        self.text_in(&self.moments)
    }

    /// The same for the moment of this number alone.
    pub(crate) fn text_of_moment(&self, number: usize) -> MuscleWorkText {
        self.text_in(&self.moments[number..=number])
    }

    fn text_in(&self, moments: &[WorkingMoment]) -> MuscleWorkText {
        let of_muscle = |peak: Peak<'_>| {
            let works_for = peak.works_for.map(|(coordinate, side)| WorksForText::new(self.model, coordinate, side));
            let Peak { activation: peak_activation, time: at_s, tension: force_n, .. } = peak;
            let tired =
                peak.tired.map(|of| TiredMuscleText { fatigued_end: of.fatigued, exhausted_s: of.exhausted_at });
            (peak.name.to_owned(), WorkedMuscleText { peak_activation, at_s, force_n, works_for, tired })
        };
        let fail = |outcome: &MuscleOutcome| {
            let [weaker_s, mean_s, stronger_s] = outcome.failures.map(|failure| failure.map(|failure| failure.time));
            let who = outcome.failures[1].and_then(|failure| failure.who);
            let who = who.map(|(coordinate, side)| WorksForText::new(self.model, coordinate, side));
            MusclesFailText { weaker_s, mean_s, stronger_s, who }
        };
        let lack = |(missing, at_s): (MissingTorque, f64)| {
            let coordinate = self.model.coordinates()[missing.coordinate].name.clone();
            LackText { coordinate, torque_nm: missing.torque, at_s }
        };
        MuscleWorkText {
            muscles: self.peaks_in(moments).map(of_muscle).collect(),
            muscles_lack: Self::lack_in(moments).map(lack),
            reactions: Self::pressed_in(moments).map(|(name, peak)| (name.to_owned(), peak)).collect(),
            muscles_fail: self.tired.map(fail),
        }
    }

    /// The hardest-worked muscles as a table for the terminal, with the sentence about torques that they cannot give.
    pub(crate) fn table(&self) -> String {
        let mut table = plain_table();
        let tired: &[&str] = if self.tired.is_some() { &["fatigued at the end", "exhausted after"] } else { &[] };
        let header = ["hardest-worked muscle", "works for", "activation", "force, N", "at"];
        table.set_header(header.iter().chain(tired));
        let mut peaks: Vec<Peak<'_>> =
            self.all_peaks().filter(|peak| peak.activation >= LEAST_ACTIVATION_SAID).collect();
        peaks.sort_by(|a, b| b.activation.total_cmp(&a.activation));
        for peak in peaks.iter().take(MOST_MUSCLES) {
            let mut row = vec![
                peak.name.to_owned(),
                peak.works_for.map_or_else(String::new, |of| group_in_words(self.model, of)),
                percent(peak.activation),
                format!("{:.0}", peak.tension),
                moment_in_words(peak.time),
            ];
            if let Some(of) = peak.tired {
                row.extend([percent(of.fatigued), of.exhausted_at.map_or_else(String::new, moment_in_words)]);
            }
            table.add_row(row);
        }
        let rows = if peaks.is_empty() { "no muscle of the model works\n".to_owned() } else { format!("{table}\n") };
        rows + &self.lack_in_words().map_or_else(String::new, |text| text + "\n") + &self.pressed_table()
    }

    /// The sentence about torques that the muscles cannot give.
    pub(crate) fn lack_in_words(&self) -> Option<String> {
        self.lack().map(|(missing, time)| {
            format!(
                "The muscles together cannot give all torques: {:.1} N m are missing at {}, at {}. A group's strength is the \
                 plain sum of its muscles; two-joint muscles turn other joints, too.",
                missing.torque,
                plain(&self.model.coordinates()[missing.coordinate].name),
                moment_in_words(time)
            )
        })
    }
}

/// Radius of a drawn muscle by its greatest force (N), m.
pub(crate) fn radius(force: f64) -> f64 {
    (RADIUS * force.sqrt()).clamp(RADII[0], RADII[1])
}

fn group_in_words(model: &Model, (coordinate, side): (usize, Side)) -> String {
    let of = &model.coordinates()[coordinate];
    of.groups.as_ref().map_or_else(|| plain(&of.name), |groups| group(&groups[side.index()].name, &of.name))
}
