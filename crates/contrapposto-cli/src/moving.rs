//! Decides whether the inertia of a motion counts, and prepares its speeds and accelerations.

use std::f64::consts::TAU;

use contrapposto::assessment::{FAST_SHARE, Peak, acceleration};
use contrapposto::dynamics::{MotionError, Moving, Rates, Smoothing, differentiate, suggested_cutoff};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto_formats::loads::GroundReaction;

use crate::args::{CutOff, DynamicsArgs, FrameArgs};
use crate::fail::Fail;
use crate::motion_file::cut;
use crate::output::print_note;

/// Share of the frames that the padding of a filter reaches from which on a warning says so (assumed: of a second at 6 Hz a third).
const MOST_REACHED: f64 = 0.3;

/// A motion, at rest in every posture or moving.
pub(crate) struct Recorded {
    pub(crate) frames: Vec<(f64, Posture)>,
    /// Of every frame; empty where each posture is held at rest.
    pub(crate) rates: Vec<Rates>,
    /// The sentence that says that inertia counts, why, and with which filter.
    pub(crate) said: Option<String>,
    /// Reasons to doubt speeds and accelerations.
    pub(crate) doubts: Vec<String>,
}

impl Recorded {
    /// Postures at rest.
    pub(crate) fn at_rest(frames: Vec<(f64, Posture)>) -> Self {
        Self { frames, rates: vec![], said: None, doubts: vec![] }
    }

    /// The frames of the file `name` between the times that are asked for. The filter sees all frames.
    pub(crate) fn new(
        name: &str,
        all: Vec<(f64, Posture)>,
        (args, span): (&DynamicsArgs, &FrameArgs),
        model: &Model,
    ) -> Result<Self, Fail> {
        let kept = |frames| cut(name, frames, span);
        if args.at_rest {
            return Ok(Self::at_rest(kept(all)?));
        }
        if args.dynamics {
            let moving = Smoothed::new(model, all, args)
                .map_err(|error| Fail::Refused(format!("{name}: --dynamics: {error}")))?;
            return Self::moving(name, moving, span, "inertia counts");
        }
        let frames = kept(all.clone())?;
        let Some(why) = fast(acceleration(&frames, &centers(model, &frames))) else {
            return Ok(Self::at_rest(frames));
        };
        match Smoothed::new(model, all, args) {
            Ok(moving) => {
                let mut recorded = Self::moving(name, moving, span, &format!("inertia counts, because {why}"))?;
                recorded.said = recorded.said.map(|said| said + "; --static leaves it out");
                Ok(recorded)
            }
            Err(error) => {
                let doubts = vec![format!("inertia is left out, although {why}: {error}")];
                Ok(Self { doubts, ..Self::at_rest(frames) })
            }
        }
    }

    fn moving(name: &str, moving: Smoothed, span: &FrameArgs, said: &str) -> Result<Self, Fail> {
        let Smoothed { moving, smoothing, filtered, mut doubts } = moving;
        let said = Some(format!("{said}: {filtered}"));
        let ends = moving.motion.first().zip(moving.motion.last()).map_or((0.0, 0.0), |(a, b)| (a.0, b.0));
        let mut recorded = Self { frames: moving.motion, rates: moving.rates, said, doubts: vec![] };
        let frames = cut(name, recorded.frames.clone(), span)?;
        let (from, to) = (frames[0].0, frames[frames.len() - 1].0);
        recorded.keep(|time| (from..=to).contains(&time));
        doubts.extend(filter_doubts(smoothing, ends, &recorded.frames));
        recorded.doubts = doubts;
        Ok(recorded)
    }

    /// Keeps the frames at the times that `covered` accepts.
    pub(crate) fn keep(&mut self, covered: impl Fn(f64) -> bool) {
        let mut kept = Moving { motion: std::mem::take(&mut self.frames), rates: std::mem::take(&mut self.rates) };
        kept.keep(covered);
        (self.frames, self.rates) = (kept.motion, kept.rates);
    }
}

/// Leaves out the frames at which the table of ground reactions has no forces, with a warning that names the time that both have.
pub(crate) fn keep_overlap(recorded: &mut Recorded, ground: Option<&GroundReaction>) -> Result<(), Fail> {
    let Some(ground) = ground else { return Ok(()) };
    let before = recorded.frames.len();
    let ends = recorded.frames.first().map(|frame| frame.0).zip(recorded.frames.last().map(|frame| frame.0));
    let Some(((first, last), (start, end))) = ends.zip(ground.span()) else { return Ok(()) };
    recorded.keep(|time| ground.covers(time));
    if recorded.frames.is_empty() {
        let why = format!(
            "forces go from {start} s to {end} s, the motion from {first} s to {last} s: they have no time in common"
        );
        return Err(Fail::Refused(format!("{}: {why}", ground.name())));
    }
    let left_out = before - recorded.frames.len();
    if left_out > 0 {
        let kept = recorded.frames.len();
        let (from, to) = (recorded.frames[0].0, recorded.frames[kept - 1].0);
        print_note(
            "warning",
            &format!(
                "forces go from {start} s to {end} s, the motion from {first} s to {last} s: {left_out} of {before} instants are left out, \
                 {kept} from {from} s to {to} s are computed"
            ),
        );
    }
    Ok(())
}

/// A motion that is smoothed, with speeds and accelerations.
struct Smoothed {
    moving: Moving,
    smoothing: Smoothing,
    /// The words for the filter.
    filtered: String,
    doubts: Vec<String>,
}

impl Smoothed {
    fn new(model: &Model, mut all: Vec<(f64, Posture)>, args: &DynamicsArgs) -> Result<Self, MotionError> {
        let doubts = unwrap(model, &mut all);
        let (smoothing, how) = match args.cutoff_hz {
            CutOff::None => (Smoothing::None, ""),
            CutOff::Hertz(cutoff) => (args.smoothing(cutoff), ""),
            CutOff::Auto => {
                let cutoff = suggested_cutoff(model, &all, |cutoff| args.smoothing(cutoff))?;
                (args.smoothing((10.0 * cutoff).round() / 10.0), ", as residual analysis suggests")
            }
        };
        let filtered = filtered(smoothing) + how;
        Ok(Self { moving: differentiate(model, &all, smoothing)?, smoothing, filtered, doubts })
    }
}

/// Lets hinges that jump by more than half a turn between two frames turn on instead, and says so: an angle was recorded between -180 and 180 deg.
fn unwrap(model: &Model, all: &mut [(f64, Posture)]) -> Vec<String> {
    let mut doubts = vec![];
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        if coordinate.kind != CoordinateKind::Rotation || model.is_dependent(i) {
            continue;
        }
        let (mut turns, mut first) = (0.0, None);
        let recorded: Vec<f64> = all.iter().map(|(_, posture)| posture.values()[i]).collect();
        for (frame, pair) in recorded.windows(2).enumerate() {
            let jump = ((pair[1] - pair[0]) / TAU).round();
            if jump != 0.0 {
                turns -= jump;
                first.get_or_insert((all[frame + 1].0, pair[0], pair[1]));
            }
            all[frame + 1].1.values_mut()[i] = pair[1] + TAU * turns;
        }
        if let Some((time, before, after)) = first {
            doubts.push(format!(
                "`{}` jumps from {:.1} to {:.1} deg at {time} s: a whole turn is added there, so that its speed stays that of the body",
                coordinate.name,
                before.to_degrees(),
                after.to_degrees()
            ));
        }
    }
    doubts
}

/// Doubts about a filter: a cut-off that is low for the length of the file, `ends` (s), and frames that its padding reaches.
fn filter_doubts(smoothing: Smoothing, (first, last): (f64, f64), frames: &[(f64, Posture)]) -> Vec<String> {
    let (Smoothing::OpenSim(cutoff) | Smoothing::Filtfilt(cutoff)) = smoothing else { return vec![] };
    let (span, reach) = (last - first, 1.0 / cutoff);
    if cutoff < 2.0 / span {
        return vec![format!(
            "the cut-off of {cutoff} Hz is below two over the length of the motion, {span:.3} s: filtered angles leave the recorded ones; \
             --cutoff-hz {:.0} or more, or --cutoff-hz none",
            (2.0 / span).ceil()
        )];
    }
    let reached = frames.iter().filter(|(time, _)| time - first < reach || last - time < reach).count();
    if (reached as f64) < MOST_REACHED * frames.len() as f64 {
        return vec![];
    }
    vec![format!(
        "within {reach:.2} s of the ends of the file, one over the cut-off, speeds and accelerations are those of the filter's padding: {reached} \
         of {} instants; a longer recording that --from and --to cut, or --cutoff-hz none",
        frames.len()
    )]
}

/// The words for the filter.
fn filtered(smoothing: Smoothing) -> String {
    match smoothing {
        Smoothing::None => "speeds and accelerations of quintic splines through the instants, no filter".to_owned(),
        Smoothing::OpenSim(cutoff) => format!("the motion is filtered as OpenSim does, low-pass at {cutoff} Hz"),
        Smoothing::Filtfilt(cutoff) => format!("the motion is filtered as filtfilt does, low-pass at {cutoff} Hz"),
    }
}

/// Centres of mass of postures that fit the model; none of a body without mass.
fn centers(model: &Model, frames: &[(f64, Posture)]) -> Vec<nalgebra::Vector3<f64>> {
    let mut kinematics = Kinematics::new(model);
    let mut center = |posture| {
        kinematics.update(model, posture).ok()?;
        kinematics.center_of_mass(model)
    };
    frames.iter().filter_map(|(_, posture)| center(posture)).collect()
}

/// The reason why a motion is fast: greatest acceleration (m/s^2), and the share of fast frames.
fn fast((acceleration, share): (Peak, f64)) -> Option<String> {
    (share > FAST_SHARE).then(|| {
        format!(
            "the centre of mass accelerates by more than 1 m/s2 in {:.0} percent of the time (at most {:.1}, at {} s)",
            100.0 * share,
            acceleration.value,
            acceleration.time
        )
    })
}

/// The warning about a motion that is fast, though each posture is held at rest.
pub(crate) fn fast_motion(found: (Peak, f64)) -> Option<String> {
    fast(found).map(|why| {
        format!("{why}: torques of postures at rest do not describe such a motion; --dynamics counts inertia")
    })
}
