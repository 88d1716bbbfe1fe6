//! A run in bounded memory: it thins itself as it grows, and keeps the first moment, the last, and those of decisions.

use contrapposto::hybrid::{Case, Decision, Outcome};
use contrapposto::simulation::{Relief, Sample, Scenario, Standing};

/// Most frames besides those of decisions.
const MOST_FRAMES: usize = 600;
/// Most decisions that are told.
const MOST_EVENTS: usize = 120;

/// One moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frame {
    pub(crate) time: f64,
    pub(crate) posture: Vec<f64>,
    pub(crate) external: Vec<f64>,
    pub(crate) passive: Vec<f64>,
    pub(crate) load: Vec<f64>,
    pub(crate) fatigue: Vec<[f64; 2]>,
    pub(crate) standing: Option<Standing>,
    /// Number of the sample.
    number: u64,
    /// Something was decided.
    kept: bool,
}

/// What was decided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) time: f64,
    pub(crate) coordinate: usize,
    pub(crate) what: What,
}

/// What happened to a coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) enum What {
    /// A tired group asked for relief, and this is the answer.
    Decided(Decision),
    /// It asked, but something more important holds the joint.
    Blocked,
    /// Relief was taken back so often that it waits.
    GivenUp,
    /// No group of it needs relief any more.
    Recovered,
}

/// By what two happenings are told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Key {
    Decided(Case, Outcome),
    Blocked,
    GivenUp,
}

/// A run, as far as a page shows it.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    frames: Vec<Frame>,
    latest: Frame,
    plain: usize,
    stride: u64,
    seen: u64,
    events: Vec<Event>,
    happened: u64,
    keys: Vec<Option<Key>>,
}

impl Recording {
    /// Looks at a sample.
    pub(crate) fn take(&mut self, scenario: &Scenario, sample: &Sample) {
        self.stride = self.stride.max(1);
        self.keys.resize(sample.posture.len(), None);
        let before = self.happened;
        for i in 0..sample.posture.len() {
            self.happening(scenario, sample, i);
        }
        let kept = self.happened > before && self.events.len() as u64 == self.happened;
        let wanted = self.seen.is_multiple_of(self.stride);
        self.latest.fill(sample, self.seen, kept);
        if kept || wanted {
            self.frames.push(self.latest.clone());
            self.plain += usize::from(!kept);
        }
        if self.plain > MOST_FRAMES {
            self.stride *= 2;
            let stride = self.stride;
            self.frames.retain(|frame| frame.kept || frame.number.is_multiple_of(stride));
            self.plain = self.frames.iter().filter(|frame| !frame.kept).count();
        }
        self.seen += 1;
    }

    fn happening(&mut self, scenario: &Scenario, sample: &Sample, i: usize) {
        let (key, what) = match (&sample.decisions[i], &sample.reliefs[i]) {
            (Some(decision), _) => (Some(Key::Decided(decision.case, decision.outcome)), What::Decided(*decision)),
            (None, Some(Relief::Blocked)) => (Some(Key::Blocked), What::Blocked),
            (None, Some(Relief::GivenUp)) => (Some(Key::GivenUp), What::GivenUp),
            _ => (None, What::Recovered),
        };
        // Between two steps a joint may have nothing to ask without having recovered.
        let rested = sample.fatigue[i].iter().all(|&fatigue| fatigue <= scenario.hysteresis.recovery_level);
        if key == self.keys[i] || (key.is_none() && !rested) {
            return;
        }
        self.keys[i] = key;
        self.happened += 1;
        if self.events.len() < MOST_EVENTS {
            self.events.push(Event { time: sample.time, coordinate: i, what });
        }
    }

    /// Its moments, the last one included.
    pub(crate) fn frames(&self) -> Vec<&Frame> {
        let last = self.frames.last().is_none_or(|frame| frame.number < self.latest.number);
        self.frames.iter().chain((last && self.seen > 0).then_some(&self.latest)).collect()
    }

    /// What was decided, in the order of time; the first ones of a long list.
    pub(crate) fn events(&self) -> &[Event] {
        &self.events
    }

    /// How much was decided in all.
    pub(crate) fn happened(&self) -> u64 {
        self.happened
    }
}

impl Frame {
    fn fill(&mut self, sample: &Sample, number: u64, kept: bool) {
        (self.time, self.number, self.kept) = (sample.time, number, kept);
        for (mine, given) in [
            (&mut self.posture, sample.posture),
            (&mut self.external, sample.external),
            (&mut self.passive, sample.passive),
            (&mut self.load, sample.load),
        ] {
            mine.clear();
            mine.extend_from_slice(given);
        }
        self.fatigue.clear();
        self.fatigue.extend_from_slice(sample.fatigue);
        self.standing = sample.standing.cloned();
    }

    /// Active torque of a coordinate, N m.
    pub(crate) fn active(&self, i: usize) -> f64 {
        -(self.passive[i] + self.external[i])
    }

    /// Sum of squares of relative loads.
    pub(crate) fn effort(&self) -> f64 {
        self.load.iter().map(|load| load * load).sum()
    }

    /// How much of what pulls on a coordinate passive tissue carries, 0..=1; `None` where next to nothing pulls.
    pub(crate) fn carried(&self, i: usize) -> Option<f64> {
        let external = self.external[i];
        (external.abs() > 0.5).then(|| (-self.passive[i] / external).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contrapposto::simulation::run;
    use contrapposto_formats::read_scenario;

    #[test]
    fn a_long_run_keeps_its_ends_its_decisions_and_little_else() {
        let text = include_str!("../../../../scenarios/chatter.toml").replace("duration_s = 20", "duration_s = 200");
        let scenario = read_scenario("chatter.toml", text.as_bytes(), None).unwrap();
        let mut recording = Recording::default();
        let summary = run(&scenario, |sample| recording.take(&scenario, sample)).unwrap();
        assert!(summary.samples > 5000 && recording.happened() > 5000, "{} decisions", recording.happened());
        let frames = recording.frames();
        assert!(frames.len() <= MOST_FRAMES + MOST_EVENTS + 2, "{} frames", frames.len());
        assert!(frames.len() > MOST_FRAMES / 2);
        assert_eq!((frames[0].time, frames[frames.len() - 1].time), (0.0, summary.end_time));
        assert!(frames.windows(2).all(|pair| pair[0].time < pair[1].time));
        assert_eq!(recording.events().len(), MOST_EVENTS);
        for event in recording.events() {
            assert!(
                frames.iter().any(|frame| frame.time == event.time),
                "no frame of the decision at {} s",
                event.time
            );
        }
    }
}
