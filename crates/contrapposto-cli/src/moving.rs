//! Decides whether the inertia of a motion counts, and prepares its speeds and accelerations.

use contrapposto::assessment::{FAST_SHARE, Peak, acceleration};
use contrapposto::dynamics::{Moving, Rates, Smoothing, differentiate};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_formats::loads::GroundReaction;

use crate::args::{DynamicsArgs, FrameArgs};
use crate::fail::Fail;
use crate::motion_file::cut;
use crate::output::print_note;

/// A motion, at rest in every posture or moving.
pub(crate) struct Recorded {
    pub(crate) frames: Vec<(f64, Posture)>,
    /// Of every frame; empty where each posture is held at rest.
    pub(crate) rates: Vec<Rates>,
    /// The sentence that says that inertia counts, why, and with which filter.
    pub(crate) said: Option<String>,
}

impl Recorded {
    /// Postures at rest.
    pub(crate) fn at_rest(frames: Vec<(f64, Posture)>) -> Self {
        Self { frames, rates: vec![], said: None }
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
        let smoothing = args.smoothing();
        if args.dynamics {
            let moving = differentiate(model, &all, smoothing)
                .map_err(|error| Fail::Refused(format!("{name}: --dynamics: {error}")))?;
            return Self::moving(name, moving, span, format!("inertia counts: {}", filtered(smoothing)));
        }
        let frames = kept(all.clone())?;
        let why = fast(acceleration(&frames, &centers(model, &frames)));
        match why.map(|why| (why, differentiate(model, &all, smoothing))) {
            Some((why, Ok(moving))) => {
                let said = format!("inertia counts, because {why}: {}; --static leaves it out", filtered(smoothing));
                Self::moving(name, moving, span, said)
            }
            Some((_, Err(_))) | None => Ok(Self::at_rest(frames)),
        }
    }

    fn moving(name: &str, moving: Moving, span: &FrameArgs, said: String) -> Result<Self, Fail> {
        let mut recorded = Self { frames: moving.motion, rates: moving.rates, said: Some(said) };
        let frames = cut(name, recorded.frames.clone(), span)?;
        let (from, to) = (frames[0].0, frames[frames.len() - 1].0);
        recorded.keep(|time| (from..=to).contains(&time));
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
                "forces go from {start} s to {end} s, the motion from {first} s to {last} s: {left_out} of {before} frames are left out, \
                 {kept} from {from} s to {to} s are computed"
            ),
        );
    }
    Ok(())
}

/// The words for the filter.
fn filtered(smoothing: Smoothing) -> String {
    match smoothing {
        Smoothing::None => "speeds and accelerations of quintic splines through the frames, no filter".to_owned(),
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
            "the centre of mass accelerates by more than 1 m/s2 in {:.0} percent of the frames (at most {:.1}, at {} s)",
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
