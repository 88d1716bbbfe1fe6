//! Holds a job under way: the states of its document, the body, a point that is grabbed, and a run.
//!
//! Figure, scene and history of a request are built whole before they are put in place, so a request that is refused changes nothing.

use contrapposto::model::{Model, plain_name};
use contrapposto::posture::Posture;

use crate::balance::balance;
use crate::body::read_play;
use crate::document::Document;
use crate::drawn::{self, Motion};
use crate::error::Refusal;
use crate::figure::Figure;
use crate::history::History;
use crate::message::{Answer, Course, Handle, Request};
use crate::person;
use crate::play::Play;
use crate::recorded;
use crate::report::{self, Moment, Told};
use crate::rest;
use crate::sides;

/// Most samples of one call, so that a call ends.
const MOST_SAMPLES: u32 = 100_000;

/// A job under way.
#[derive(Debug)]
pub(crate) struct Job {
    history: History,
    figure: Figure,
    grab: Option<Grab>,
    play: Option<Play>,
}

/// A point that is grabbed. The body that is dragged is another one, with that point among its tasks.
#[derive(Debug)]
struct Grab {
    handle: Handle,
    figure: Figure,
    /// A foot that carries weight is put elsewhere.
    slides: bool,
}

impl Job {
    /// Of a document that is opened.
    pub(crate) fn new(document: Document) -> Result<Self, Refusal> {
        let figure = Figure::read(&document, None)?;
        Ok(Self { history: History::new(document), figure, grab: None, play: None })
    }

    /// The body and its job.
    pub(crate) fn scene(&mut self) -> Result<Answer, Refusal> {
        let (document, can) = (self.history.document(), self.history.can());
        Ok(Answer::Scene(Box::new(self.figure.scene(document, can)?)))
    }

    pub(crate) fn model(&self) -> &Model {
        &self.figure.body.model
    }

    /// A course, by default the run so far or the posture that is shown, as glTF.
    pub(crate) fn gltf(&self, skin: Option<&[u8]>, course: Option<Course>) -> Result<Answer, Refusal> {
        let motion = self.motion(course.as_ref())?;
        // A run puts things down, also one that another session has carried out.
        let things = match &self.play {
            Some(play) => play.things().to_vec(),
            None if motion.0.len() > 1 => read_play(&self.document_as_shown())?.things,
            None => self.figure.body.scenario.things.clone(),
        };
        Ok(Answer::Bytes { bytes: drawn::gltf((self.model(), &things), self.title(), &motion, skin)? })
    }

    /// Document and course, for a session of the module that has all writers.
    pub(crate) fn elsewhere(&self) -> Result<Answer, Refusal> {
        let (times, postures) = self.motion(None)?;
        let course = Course { times, postures: postures.into_iter().map(<[f64]>::to_vec).collect() };
        let samples = self.play.as_ref().map_or(0, Play::samples);
        Ok(Answer::Elsewhere { state: self.document_as_shown().state()?, course: Some(course), samples })
    }

    /// The posture that is shown, or the run so far, as `report.html`.
    pub(crate) fn report(&mut self, skin: Option<&[u8]>, charts: &str) -> Result<Answer, Refusal> {
        let figure = self.grab.as_mut().map_or(&mut self.figure, |grab| &mut grab.figure);
        let (moments, run) = match &self.play {
            Some(play) => (play.moments(&figure.body)?, Some((play.decisions(), play.levels()))),
            None => (vec![Moment { time: 0.0, shown: figure.shown()?, fatigue: vec![] }], None),
        };
        let things = self.play.as_ref().map_or(figure.body.scenario.things.as_slice(), Play::things);
        let text = report::html(&Told { body: &figure.body, things, moments, run, skin }, charts)?;
        Ok(Answer::Text { text })
    }

    fn title(&self) -> &str {
        &self.figure.body.scenario.title
    }

    /// Times and postures of a course; without one of the run so far, at even steps; without a run the posture that is shown.
    fn motion<'a>(&'a self, course: Option<&'a Course>) -> Result<Motion<'a>, Refusal> {
        let figure = self.grab.as_ref().map_or(&self.figure, |grab| &grab.figure);
        if let Some(Course { times, postures }) = course {
            let due = self.model().coordinates().len();
            if times.len() != postures.len() || postures.iter().any(|posture| posture.len() != due) {
                return Err(Refusal(format!("a course has one posture of {due} numbers at each of its times")));
            }
            return Ok((times.clone(), postures.iter().map(Vec::as_slice).collect()));
        }
        Ok(match &self.play {
            Some(play) => play.motion(),
            None => (vec![0.0], vec![figure.posture.values()]),
        })
    }

    /// Answers a request that is not to open another job; `watch` is told how far a long one has come.
    pub(crate) fn answer(&mut self, request: Request, watch: &mut dyn FnMut(usize)) -> Result<Answer, Refusal> {
        match request {
            Request::Grab { segment, point } => self.grab(segment, point),
            Request::Drag { target } => self.drag(target),
            Request::Release { hold } => self.release(hold),
            Request::Settle {} => self.settle(),
            Request::Play { samples } => self.play(samples.min(MOST_SAMPLES)),
            Request::Stop { take } => self.stop(take),
            Request::Look { time } => {
                let play = self.play.as_ref().ok_or_else(|| Refusal::of("no run is under way"))?;
                Ok(Answer::Played(Box::new(play.look(&self.figure.body, time)?)))
            }
            Request::Relax {} => {
                self.check_released()?;
                self.check_no_run()?;
                Ok(Answer::Ways { ways: rest::ways(&self.figure, watch)? })
            }
            Request::Motion { name, text } => recorded::motion(self.model(), &name, &text),
            Request::At { q } => {
                self.check_released()?;
                let shown =
                    if q.is_empty() { self.figure.shown()? } else { self.figure.still_in(&self.posture_of(&q)?)? };
                Ok(Answer::Shown(Box::new(shown)))
            }
            Request::Balance { coordinate } => self.balance(&coordinate),
            Request::Bvh { course } => {
                let text = drawn::text(self.model(), self.title(), &self.motion(course.as_ref())?)?;
                Ok(Answer::Text { text })
            }
            Request::Export {} => Ok(self.export()),
            Request::State {} => Ok(Answer::Text { text: self.document_as_shown().state()? }),
            request => self.edit(request),
        }
    }

    /// Answers a request that makes another document the present one.
    fn edit(&mut self, request: Request) -> Result<Answer, Refusal> {
        match request {
            Request::Adult { sex, stature, mass } => self.change(|document| document.set_adult(&sex, stature, mass)),
            Request::Percentile { sex, percentile } => {
                let (stature, mass) = person::at(&sex, percentile)?;
                self.change(|document| document.set_adult(&sex, stature, mass))
            }
            Request::Free { segment } => self.change(|document| {
                document.free(&segment);
                Ok(())
            }),
            Request::Load { segment, mass } => {
                self.figure.body.segment(&segment)?;
                self.change(|document| document.set_load(&segment, mass))
            }
            Request::Push { segment, point, force } => {
                self.figure.body.segment(&segment)?;
                self.change(|document| document.set_force(&segment, point, force))
            }
            Request::Put { word, keys } => self.change(|document| document.put(&word, keys)),
            Request::TakeAway { word, number } => self.change(|document| document.take_away(&word, number)),
            Request::Strategy { kind, region } => {
                self.change(|document| document.set_strategy(&kind, region.as_deref()))
            }
            Request::Go { q } => self.go_to(&q),
            Request::Mirror {} => {
                self.check_released()?;
                let Figure { body, posture, .. } = &self.figure;
                self.replace(sides::exchanged(self.history.document(), &body.model, posture)?)
            }
            Request::Restore { state } => {
                self.check_released()?;
                self.replace(Document::from_state(&state)?)
            }
            Request::Undo {} => self.go(false),
            Request::Redo {} => self.go(true),
            Request::Reset {} => {
                let opened = self.history.opened().clone();
                self.change(|document| {
                    *document = opened;
                    Ok(())
                })
            }
            _ => Err(Refusal::of("no request to a job")),
        }
    }

    /// Changes the document, with the posture that is shown as its start, and reads it anew. A run ends.
    fn change(&mut self, change: impl FnOnce(&mut Document) -> Result<(), Refusal>) -> Result<Answer, Refusal> {
        self.check_released()?;
        let mut document = self.history.document().clone();
        document.posture = self.figure.named();
        change(&mut document)?;
        self.replace(document)
    }

    /// Makes a document the present one.
    fn replace(&mut self, document: Document) -> Result<Answer, Refusal> {
        let mut figure = Figure::read(&document, None)?;
        let scene = figure.scene(&document, (true, false))?;
        let before = std::mem::replace(&mut self.figure, figure);
        self.history.push(document, before.posture);
        (self.grab, self.play) = (None, None);
        Ok(Answer::Scene(Box::new(scene)))
    }

    /// Goes to a posture.
    fn go_to(&mut self, q: &[f64]) -> Result<Answer, Refusal> {
        let posture = self.figure.body.named(&self.posture_of(q)?);
        self.change(|document| {
            document.posture = posture;
            Ok(())
        })
    }

    /// A posture by the values of all coordinates.
    fn posture_of(&self, q: &[f64]) -> Result<Posture, Refusal> {
        let due = self.figure.posture.values().len();
        if q.len() == due {
            return Ok(Posture::new(q.to_vec()));
        }
        Err(Refusal(format!("{} numbers are given; the body has {due} coordinates", q.len())))
    }

    /// Undo, or redo: the posture is that in which the state was left. A run ends.
    fn go(&mut self, after: bool) -> Result<Answer, Refusal> {
        self.check_released()?;
        let (at, document, left) = self.history.neighbour(after)?;
        let mut figure = Figure::read(document, left)?;
        let scene = figure.scene(document, self.history.can_at(at))?;
        let before = std::mem::replace(&mut self.figure, figure);
        self.history.go_to(at, before.posture);
        self.play = None;
        Ok(Answer::Scene(Box::new(scene)))
    }

    fn check_released(&self) -> Result<(), Refusal> {
        let grabbed = self.grab.as_ref().map(|grab| &grab.handle.label);
        grabbed.map_or(Ok(()), |label| Err(Refusal(format!("the {label} is grabbed; `release` comes first"))))
    }

    fn check_no_run(&self) -> Result<(), Refusal> {
        if self.play.is_some() { Err(Refusal::of("a run is under way; `stop` comes first")) } else { Ok(()) }
    }

    /// Takes hold of a point. The document stays as it is until the point is let go.
    fn grab(&mut self, segment: String, point: [f64; 3]) -> Result<Answer, Refusal> {
        self.check_released()?;
        self.check_no_run()?;
        let body = &self.figure.body;
        let (index, label) = (body.segment(&segment)?, plain_name(&segment));
        let support = body.support_on(index);
        if let Some(support) = support
            && !body.is_on_ground(support)?
        {
            return Err(Refusal(format!(
                "the {label} carries weight and stays where it is; only a foot on the floor is put elsewhere"
            )));
        }
        if point.iter().any(|x| !x.is_finite()) {
            return Err(Refusal::of("the point that is grabbed has a number that is not finite"));
        }
        if let Some(thing) = body.thing_in(index) {
            return Err(Refusal(format!("the {label} holds the {thing} of the scenario, which stays where it is")));
        }
        let handle = Handle { label, segment, point };
        let mut document = self.history.document().clone();
        document.posture = self.figure.named();
        document.hold(handle.clone(), self.figure.place(&handle)?);
        let mut figure = Figure::dragging(&document, support)?;
        let shown = figure.shown()?;
        self.grab = Some(Grab { handle, figure, slides: support.is_some() });
        Ok(Answer::Shown(Box::new(shown)))
    }

    fn drag(&mut self, target: [f64; 3]) -> Result<Answer, Refusal> {
        let grab = self.grab.as_mut();
        let grab = grab.ok_or_else(|| Refusal::of("nothing is grabbed; `grab` comes before `drag`"))?;
        Ok(Answer::Shown(Box::new(grab.figure.drag(target.into())?)))
    }

    /// Lets go; a foot that has been put elsewhere stands there. Where neither the body nor the points that are held have changed, no change is recorded.
    fn release(&mut self, hold: bool) -> Result<Answer, Refusal> {
        let Some(Grab { handle, figure, slides }) = &self.grab else { return Err(Refusal::of("nothing is grabbed")) };
        let hold = hold && !slides;
        let mut document = self.history.document().clone();
        let held = document.holds(&handle.segment);
        if figure.is_at_start() && hold == held {
            self.grab = None;
            return self.scene();
        }
        document.posture = figure.named();
        document.free(&handle.segment);
        if hold {
            document.hold(handle.clone(), figure.place(handle)?);
        }
        self.replace(document)
    }

    fn settle(&mut self) -> Result<Answer, Refusal> {
        self.check_released()?;
        self.check_no_run()?;
        Ok(Answer::Shown(Box::new(self.figure.settle()?)))
    }

    fn play(&mut self, samples: u32) -> Result<Answer, Refusal> {
        self.check_released()?;
        if let Some(play) = &mut self.play {
            return Ok(Answer::Played(Box::new(play.advance(&self.figure.body, samples)?)));
        }
        let mut play = Play::new(&self.document_as_shown())?;
        let played = play.advance(&self.figure.body, samples)?;
        // A run that is refused at its first samples has not begun.
        self.play = Some(play);
        Ok(Answer::Played(Box::new(played)))
    }

    /// Ends a run. `take`: the scenario then begins where the run ended.
    fn stop(&mut self, take: bool) -> Result<Answer, Refusal> {
        let Some(play) = &self.play else { return Err(Refusal::of("no run is under way")) };
        if take && !play.last.posture.is_empty() {
            let mut document = self.history.document().clone();
            document.posture = self.figure.body.named(&Posture::new(play.last.posture.clone()));
            document.set_fatigue(self.figure.body.fatigue(&play.last.fatigue));
            document.begin_at(play.last.time, play.strategies());
            return self.replace(document);
        }
        let scene = self.scene()?;
        self.play = None;
        Ok(scene)
    }

    fn balance(&mut self, coordinate: &str) -> Result<Answer, Refusal> {
        let figure = self.grab.as_mut().map_or(&mut self.figure, |grab| &mut grab.figure);
        figure.shown()?;
        Ok(Answer::Balance(balance(&figure.body, &figure.posture, figure.loads(), coordinate)?))
    }

    /// The scenario with the posture that is shown; of a run, the scenario that it began with, as long as it has run.
    fn export(&self) -> Answer {
        let document = self.document_as_shown();
        let text = match &self.play {
            Some(play) => document.text_of_run(play.last.time),
            None => document.text(),
        };
        Answer::Text { text }
    }

    /// The document, starting in the posture that is shown.
    fn document_as_shown(&self) -> Document {
        let figure = self.grab.as_ref().map_or(&self.figure, |grab| &grab.figure);
        let mut document = self.history.document().clone();
        if self.grab.is_some() || !figure.is_at_start() {
            document.posture = figure.named();
        }
        document
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::document::FIRST;

    #[test]
    fn a_posture_of_a_run_that_cannot_be_kept_leaves_the_run_and_the_body() {
        let mut job = Job::new(Document::new(FIRST, Default::default()).unwrap()).unwrap();
        job.answer(Request::Play { samples: 2 }, &mut |_| ()).unwrap();
        let (posture, text) = (job.figure.posture.clone(), job.history.document().text());
        let elbow = job.figure.body.model.coordinate("elbow_flex_r").unwrap();
        let angle = std::mem::replace(&mut job.play.as_mut().unwrap().last.posture[elbow], 100.0);
        let refusal = job.answer(Request::Stop { take: true }, &mut |_| ()).err().unwrap();
        assert!(refusal.0.contains("outside its range"), "{refusal:?}");
        assert_eq!((&posture, &text), (&job.figure.posture, &job.history.document().text()));
        job.play.as_mut().unwrap().last.posture[elbow] = angle;
        job.answer(Request::Play { samples: 1 }, &mut |_| ()).unwrap();
        job.answer(Request::Stop { take: true }, &mut |_| ()).unwrap();
    }
}
