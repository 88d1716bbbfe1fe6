//! Assesses a recorded motion of an opened model: the motion and its loads, checked, and the answer.

use contrapposto::assessment::assess as assessed;
use contrapposto::assessment::{
    ANGLE_ERROR, AssessSettings, Assessment, CycleOrigin, Cycles, FAST_SHARE, Instant, NoCycles,
};
use contrapposto::joint_torques::JointMuscles;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::suggestions::{
    Advice, Change, Job as Asked, Trial, Worked, changes, with_breaks, with_breaks_in_repeats,
};
use contrapposto::verdict::Verdict;
use contrapposto_formats::loads::GroundReaction;
use contrapposto_formats::tissue::{SourcedModel, fatigue_notes};

use super::repeats::ends_apart;
use super::support_doubts::support_doubts;
use super::warnings::{WHAT_CARRIES, warnings};
use crate::args::{AssessArgs, CyclesChoice, SuggestArgs};
use crate::fail::Fail;
use crate::motion_file::{loads_of, note_values_out_of_range};
use crate::moving::{Recorded, keep_overlap};
use crate::output::print_note;
use crate::view::answer::Answer;
use crate::view::cycles::{CycleCurves, CycleRecord, no_cycles};
use crate::view::frame::Frame;
use crate::view::muscle_work::{MusclesAtWork, muscles_at_work};
use crate::view::text::assess::AssessText;

/// A motion of a model and its loads, checked.
pub(crate) struct Job {
    pub(crate) opened: SourcedModel,
    /// Times (s) and postures.
    pub(crate) motion: Vec<(f64, Posture)>,
    /// Loads at all times.
    pub(crate) held: Vec<Load>,
    /// The measured forces of the ground.
    ground: Option<GroundReaction>,
    pub(crate) settings: AssessSettings,
    /// The sentence that says that inertia counts.
    pub(crate) said: Option<String>,
    /// Reasons to doubt model and motion.
    doubts: Vec<String>,
}

/// The answer to a motion.
pub(crate) struct Found {
    pub(crate) assessment: Assessment,
    /// Curves over the cycles of the motion, if it has any; `Err` with the reason if none are found.
    pub(crate) cycles: Option<Result<CycleCurves, String>>,
    pub(crate) answer: Answer,
    /// Reasons to doubt the numbers.
    pub(crate) warnings: Vec<String>,
}

/// A model with its muscles, and warnings about them.
pub(crate) type Opened = (SourcedModel, Option<JointMuscles>, Vec<String>);

impl Job {
    /// The motion `name`, which `read` gives, with the loads and the settings of the arguments; notes about them go to standard error.
    pub(crate) fn new(
        args: &AssessArgs,
        (opened, muscles, of_muscles): Opened,
        name: &str,
        read: impl FnOnce(&Model, &mut Vec<String>) -> Result<Vec<(f64, Posture)>, Fail>,
    ) -> Result<Self, Fail> {
        let mut opened = opened.with_fatigue(&args.fatigue.choice()?);
        let mut notes = std::mem::take(&mut opened.notes);
        notes.extend(fatigue_notes(&opened.model));
        let model = &opened.model;
        let all = read(model, &mut notes)?;
        let mut recorded = Recorded::new(name, all, (&args.dynamics, &args.under.frames), model)?;
        let (held, ground) = loads_of(&args.under, model, &recorded.frames, &mut notes)?;
        keep_overlap(&mut recorded, ground.as_ref())?;
        if let ([(first, _), .., (last, _)], frames) = (recorded.frames.as_slice(), recorded.frames.len())
            && first >= last
        {
            let why =
                format!("its {frames} instants all have the time {first} s; times must rise, or give one instant");
            return Err(Fail::Refused(format!("{name}: {why}")));
        }
        let Recorded { frames: motion, rates, said, doubts } = recorded;
        if !model.coordinates().iter().any(|coordinate| coordinate.groups.is_some()) {
            let why =
                "no strength of this model is known, so nothing can tire; lay one over it with --overlay FILE.toml";
            return Err(Fail::Refused(why.to_owned()));
        }
        let usual = if opened.is_exported_adult() { 0.0 } else { ANGLE_ERROR };
        let angle_error = args.angle_error.map_or(usual, f64::to_radians);
        let seconds = motion.first().zip(motion.last()).map_or(0.0, |(first, last)| last.0 - first.0);
        let settings = AssessSettings {
            repetition: args.repeat.repetition(seconds).map_err(Fail::Refused)?,
            supports: args.carried.supports(model)?,
            rates,
            root_held: args.carried.fixed_root,
            passive_ranges: opened.passive_ranges(),
            muscles,
            angle_error,
            ..AssessSettings::default()
        };
        if let Some(choice) = &args.cycles {
            let ends = motion.first().zip(motion.last()).map_or((0.0, 0.0), |(first, last)| (first.0, last.0));
            choice.check(ends).map_err(Fail::Refused)?;
        }
        let of_forces = ground.iter().flat_map(|ground| ground.doubts(model, &motion)).collect();
        let of_motion = [of_forces, doubts, note_values_out_of_range(&opened, &motion, &mut notes)].concat();
        of_motion.iter().for_each(|warning| print_note("warning", warning));
        said.iter().chain(&notes).for_each(|note| print_note("note", note));
        let doubts = [of_muscles, of_motion].concat();
        Ok(Self { opened, motion, held, ground, settings, said, doubts })
    }

    /// Assesses all postures and shows each to `visit`. Warnings about the numbers go to standard error.
    pub(crate) fn carry_out(
        &self,
        args: &AssessArgs,
        name: &str,
        mut visit: impl FnMut(&Instant),
    ) -> Result<Found, Fail> {
        let model = &self.opened.model;
        let loads = |time: f64, kinematics: &Kinematics, loads: &mut Vec<Load>| {
            loads.extend_from_slice(&self.held);
            self.measured(time, kinematics, loads);
        };
        let mut record = CycleRecord::new(model);
        let mut ground = vec![];
        let visit = |instant: &Instant| {
            ground.clear();
            self.measured(instant.time, instant.torques.kinematics(), &mut ground);
            record.take(instant, &ground);
            visit(instant);
        };
        let assessment = assessed(model, &self.motion, loads, &self.settings, visit)
            .map_err(|error| Fail::Refused(format!("{name}: {error}")))?;
        let found = self.cycles(args.cycles.as_ref(), &record);
        let cycles = found.map_err(|why| Fail::Refused(format!("{name}: {why}")))?;
        let cycles = cycles.map(|cycles| cycles.map(|cycles| record.curves(cycles)));
        let apart = self.settings.repetition.and_then(|_| ends_apart(model, &self.motion));
        let new = [
            apart.into_iter().collect(),
            support_doubts(model, &self.motion, &self.settings.supports),
            warnings(args, &self.opened, (&self.settings, &assessment), self.motion.len()),
        ]
        .concat();
        new.iter().for_each(|warning| print_note("warning", warning));
        let warnings = [self.doubts.clone(), new].concat();
        let (begin, end) = self.ends();
        let verdict = Verdict::of_motion_with(model, &assessment, end - begin, &self.held);
        let advice = self.advice(&assessment, &verdict, args.suggest);
        Ok(Found { assessment, cycles, answer: Answer::new(verdict, advice), warnings })
    }

    /// The cycles of the motion: those that are asked for, else those that it has, else the motion that is repeated; or the reason why a motion
    /// that moves has none.
    ///
    /// # Errors
    /// The reason why there are none, if they are asked for.
    fn cycles(
        &self,
        asked: Option<&CyclesChoice>,
        record: &CycleRecord<'_>,
    ) -> Result<Option<Result<Cycles, String>>, String> {
        let ends = self.ends();
        let whole =
            || self.settings.repetition.map(|_| Cycles { bounds: vec![ends.0, ends.1], origin: CycleOrigin::Whole });
        Ok(match asked {
            Some(CyclesChoice::None) => None,
            Some(CyclesChoice::Length(length)) => Cycles::of_length(*length, ends).map(Ok),
            Some(CyclesChoice::Bounds(bounds)) => {
                Some(Ok(Cycles { bounds: bounds.clone(), origin: CycleOrigin::Given }))
            }
            Some(CyclesChoice::Find) => Some(Ok(record.find().map_err(no_cycles)?)),
            None => match (record.find(), whole()) {
                (Ok(cycles), _) | (Err(_), Some(cycles)) => Some(Ok(cycles)),
                (Err(why @ NoCycles::NotBack(_)), None) => Some(Err(no_cycles(why))),
                (Err(NoCycles::Still | NoCycles::TooShort), None) => None,
            },
        })
    }

    /// Adds the measured forces of the ground at a time.
    pub(crate) fn measured(&self, time: f64, kinematics: &Kinematics, loads: &mut Vec<Load>) {
        self.ground.iter().for_each(|ground| ground.loads(time, &self.opened.model, kinematics, loads));
    }

    /// Whether the muscles give joints their strength.
    pub(crate) fn has_muscles(&self) -> bool {
        self.settings.muscles.as_ref().is_some_and(|muscles| !muscles.strong().is_empty())
    }

    /// The muscles in some moments of the motion.
    pub(crate) fn muscles_at_work(&self, frames: &[Frame]) -> Result<Option<MusclesAtWork<'_>>, Fail> {
        muscles_at_work(&self.opened.model, self.settings.muscles.as_ref(), frames, |_| true)
    }

    /// The words of `assess.json` about the motion `name`.
    pub(crate) fn text(
        &self,
        name: &str,
        (found, muscles): (&Found, Option<&MusclesAtWork<'_>>),
        files: Vec<String>,
    ) -> AssessText {
        let warnings = found.warnings.clone();
        let times: Vec<f64> = self.motion.iter().map(|(time, _)| *time).collect();
        let numbers = (self.settings.angle_error, &found.assessment, found.cycles.as_ref());
        let mut text = AssessText::new(&self.opened, name, &times, numbers, &found.answer, warnings, files);
        text.muscle_work = muscles.map(MusclesAtWork::text);
        text
    }

    /// Times of the first and the last posture, s.
    fn ends(&self) -> (f64, f64) {
        self.motion.first().zip(self.motion.last()).map_or((0.0, 0.0), |(first, last)| (first.0, last.0))
    }

    /// The changes that were tried: less load, and breaks. Measured forces of the ground belong to the load that was carried, so that
    /// another one is not tried with them; of a fast motion nothing is.
    fn advice(&self, found: &Assessment, verdict: &Verdict, suggest: SuggestArgs) -> Advice {
        let Self { opened, motion, held, settings, ground, .. } = self;
        let (model, frames, (begin, end)) = (&opened.model, motion.len(), self.ends());
        let Some(((_, start), budget)) = motion.first().zip(suggest.budget(frames)) else { return Advice::default() };
        if found.uncarried.is_some() {
            let notes = vec![format!("To say who carries it, {WHAT_CARRIES}.")];
            return Advice { notes, ..Advice::default() };
        }
        if found.fast_share > FAST_SHARE {
            return Advice::default();
        }
        let (supports, loads) = (&settings.supports, if ground.is_none() { vec![held.as_slice()] } else { vec![] });
        let (asked, strategy) = (verdict.asked, None);
        let job = Asked { model, start, supports, limits: &[], rests: vec![], levels: vec![], loads, asked, strategy };
        let all =
            || changes(&job, &verdict.hazards).into_iter().filter(|change| *change != Change::OtherFoot).collect();
        let groups = Worked::in_motion(model, found);
        let breaks = || match found.repetition {
            Some(_) => with_breaks_in_repeats(model, found, verdict),
            None => with_breaks((&groups, None), end - begin, (begin, end), verdict),
        };
        let trial = |change: &Change| {
            let mut loads = held.clone();
            change.apply_to_loads(&mut loads);
            let found = assessed(model, motion, |_, _, all| all.extend_from_slice(&loads), settings, |_| {});
            let verdict = found.ok().map(|found| Verdict::of_motion_with(model, &found, end - begin, &loads));
            Trial { verdict, steps: frames }
        };
        Advice::new(verdict, &job, all, || verdict.kind.is_done().then(breaks).flatten(), budget, trial)
    }
}
