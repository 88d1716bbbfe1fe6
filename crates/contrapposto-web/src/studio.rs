//! Holds a session: a document, what it became, the posture that is shown, and a run.

use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use nalgebra::Vector3;

use crate::balance::balance;
use crate::body::{Body, check};
use crate::document::{Document, FIRST};
use crate::error::Refusal;
use crate::message::{Answer, Handle, Person, Request, Scene, Shown};
use crate::mover::{Moved, Mover};
use crate::play::Play;
use crate::shown;

/// Most changes that can be taken back.
const MOST_CHANGES: usize = 200;
/// Most samples of one call, so that a call ends.
const MOST_SAMPLES: u32 = 100_000;
/// The scenario of a model file that is opened on its own; the name stands for `{}`.
const OF_MODEL: &str = "format = 1\ntitle = \"{}\"\n[model]\nfile = \"{}\"\n[[task]]\nkind = \"effort\"\n";

/// A session.
#[derive(Debug)]
pub struct Studio {
    /// As it was opened.
    opened: Option<Document>,
    /// All states of the document, the oldest first.
    history: Vec<Document>,
    /// Which of them is shown.
    present: usize,
    body: Option<Body>,
    posture: Posture,
    mover: Option<Mover>,
    /// Segment and point that are grabbed.
    grabbed: Option<Handle>,
    play: Option<Play>,
}

impl Default for Studio {
    fn default() -> Self {
        Self::new()
    }
}

impl Studio {
    /// A session without a body; every request before the first scenario opens a standing adult.
    pub fn new() -> Self {
        Self {
            opened: None,
            history: vec![],
            present: 0,
            body: None,
            posture: Posture::new(vec![]),
            mover: None,
            grabbed: None,
            play: None,
        }
    }

    /// Answers a request; both are JSON.
    pub fn call(&mut self, request: &str) -> String {
        let answer = serde_json::from_str(request)
            .map_err(|error| Refusal(format!("the request cannot be read: {error}")))
            .and_then(|request| self.answer(request))
            .unwrap_or_else(|Refusal(sentence)| Answer::Refused { sentence });
        // An answer is made of numbers and texts, which JSON can always hold.
        serde_json::to_string(&answer).unwrap_or_default()
    }

    fn answer(&mut self, request: Request) -> Result<Answer, Refusal> {
        if self.body.is_none() && !matches!(request, Request::Open { .. } | Request::OpenModel { .. }) {
            self.open(Document::new(FIRST, Default::default())?)?;
        }
        match request {
            Request::Open { scenario, files } => {
                let text = if scenario.trim().is_empty() { FIRST } else { &scenario };
                check(text, &files)?;
                self.open(Document::new(text, files)?)
            }
            Request::OpenModel { name, text } => {
                let scenario = OF_MODEL.replace("{}", &name.replace(['"', '\\'], "_"));
                self.open(Document::new(&scenario, [(name, text)].into())?)
            }
            Request::Adult { sex, stature, mass } => self.change(|document| document.set_adult(&sex, stature, mass)),
            Request::Grab { segment, point } => self.grab(segment, point),
            Request::Drag { target } => self.drag(target.into()),
            Request::Release { hold } => self.release(hold),
            Request::Free { segment } => self.change(|document| {
                document.held.retain(|(handle, _)| handle.segment != segment);
                Ok(())
            }),
            Request::Settle {} => self.settle(),
            Request::Load { segment, mass } => {
                self.body()?.segment(&segment)?;
                self.change(|document| document.set_load(&segment, mass))
            }
            Request::Strategy { kind } => self.change(|document| {
                document.set_strategy(&kind);
                Ok(())
            }),
            Request::Play { samples } => self.play(samples.min(MOST_SAMPLES)),
            Request::Stop { take } => self.stop(take),
            Request::Balance { coordinate } => self.balance(&coordinate),
            Request::Export {} => self.export(),
            Request::Undo {} => self.go_to(self.present.checked_sub(1)),
            Request::Redo {} => self.go_to(Some(self.present + 1).filter(|at| *at < self.history.len())),
            Request::Reset {} => {
                let opened = self.opened.clone().ok_or_else(|| Refusal::of("no scenario is open"))?;
                self.change(|document| {
                    *document = opened;
                    Ok(())
                })
            }
        }
    }

    fn body(&self) -> Result<&Body, Refusal> {
        self.body.as_ref().ok_or_else(|| Refusal::of("no scenario is open"))
    }

    fn document(&self) -> Result<&Document, Refusal> {
        self.history.get(self.present).ok_or_else(|| Refusal::of("no scenario is open"))
    }

    /// Opens a document; the history begins anew.
    fn open(&mut self, document: Document) -> Result<Answer, Refusal> {
        let body = Body::read(&document)?;
        (self.opened, self.history, self.present) = (Some(document.clone()), vec![document], 0);
        self.take_body(body)
    }

    /// Changes the document, with the posture that is shown as its start, and reads it anew. Where it is refused nothing has changed.
    fn change(&mut self, change: impl FnOnce(&mut Document) -> Result<(), Refusal>) -> Result<Answer, Refusal> {
        let mut document = self.document()?.clone();
        document.posture = self.body()?.named(&self.posture);
        change(&mut document)?;
        let body = Body::read(&document)?;
        self.history.truncate(self.present + 1);
        self.history.push(document);
        let surplus = self.history.len().saturating_sub(MOST_CHANGES);
        self.history.drain(..surplus);
        self.present = self.history.len() - 1;
        self.take_body(body)
    }

    fn go_to(&mut self, at: Option<usize>) -> Result<Answer, Refusal> {
        let Some(at) = at else { return Err(Refusal::of("there is no change in that direction")) };
        let body = Body::read(&self.history[at])?;
        self.present = at;
        self.take_body(body)
    }

    fn take_body(&mut self, body: Body) -> Result<Answer, Refusal> {
        self.posture = body.scenario.start.clone();
        (self.mover, self.grabbed, self.play) = (None, None, None);
        self.body = Some(body);
        self.scene()
    }

    fn scene(&mut self) -> Result<Answer, Refusal> {
        let shown = self.held(Moved::default())?;
        let (body, document) = (self.body()?, self.document()?);
        let scenario = &body.scenario;
        let support = |support: &contrapposto::contact::Support| body.model.segments()[support.segment].name.clone();
        let adult = document.adult();
        Ok(Answer::Scene(Box::new(Scene {
            title: scenario.title.clone(),
            person: adult.map(|(sex, stature, mass)| Person { sex, stature, mass }),
            coordinates: body.coordinates(),
            segments: body.segments(),
            handles: body.handles(),
            held: document.held.iter().map(|(handle, _)| handle.clone()).collect(),
            supports: scenario.supports.iter().map(support).collect(),
            things: body.things(),
            loads: body.hung(),
            strategy: document.strategy().to_owned(),
            notes: scenario.notes.clone(),
            can_undo: self.present > 0,
            can_redo: self.present + 1 < self.history.len(),
            shown,
        })))
    }

    /// The posture that is shown, held still.
    fn held(&mut self, moved: Moved) -> Result<Shown, Refusal> {
        let body = self.body.as_ref().ok_or_else(|| Refusal::of("no scenario is open"))?;
        if self.mover.is_none() {
            self.mover = Some(Mover::settling(body, &self.posture)?);
        }
        match &mut self.mover {
            Some(mover) => shown::held(body, &mut mover.engine, &self.posture, moved),
            None => Err(Refusal::of("no scenario is open")),
        }
    }

    fn grab(&mut self, segment: String, point: [f64; 3]) -> Result<Answer, Refusal> {
        let body = self.body()?;
        let index = body.segment(&segment)?;
        if body.scenario.supports.iter().any(|support| support.segment == index) {
            let label = contrapposto::model::plain_name(&segment);
            return Err(Refusal(format!("the {label} carries weight and stays where it is")));
        }
        if point.iter().any(|x| !x.is_finite()) {
            return Err(Refusal::of("the point that is grabbed has a number that is not finite"));
        }
        self.change(|document| {
            document.held.retain(|(handle, _)| handle.segment != segment);
            Ok(())
        })?;
        let (held, body) = (self.document()?.held.len(), self.body()?);
        let label = contrapposto::model::plain_name(&segment);
        let mover = Mover::dragging(body, &self.posture, (index, point.into()), held)?;
        self.mover = Some(mover);
        self.grabbed = Some(Handle { label, segment, point });
        Ok(Answer::Shown(Box::new(self.held(Moved::default())?)))
    }

    fn drag(&mut self, target: Vector3<f64>) -> Result<Answer, Refusal> {
        let (Some(body), Some(mover)) = (&self.body, &mut self.mover) else {
            return Err(Refusal::of("nothing is grabbed; `grab` comes before `drag`"));
        };
        let mut posture = self.posture.clone();
        let moved = mover.drag(body, &mut posture, target)?;
        self.posture = posture;
        Ok(Answer::Shown(Box::new(self.held(moved)?)))
    }

    fn release(&mut self, hold: bool) -> Result<Answer, Refusal> {
        let Some(handle) = self.grabbed.take() else { return Err(Refusal::of("nothing is grabbed")) };
        let body = self.body()?;
        let segment = body.segment(&handle.segment)?;
        let at = body.kinematics(&self.posture)?.station(&body.model, segment, handle.point.into());
        // The change that began with the grab ends here: both are one.
        self.history.truncate(self.present + 1);
        if self.present > 0 {
            self.history.pop();
            self.present -= 1;
        }
        self.change(|document| {
            document.held.retain(|(held, _)| held.segment != handle.segment);
            if hold {
                document.held.push((handle, at.into()));
            }
            Ok(())
        })
    }

    fn settle(&mut self) -> Result<Answer, Refusal> {
        if self.grabbed.is_some() {
            return Err(Refusal::of("a point is grabbed; `release` comes before `settle`"));
        }
        let body = self.body.as_ref().ok_or_else(|| Refusal::of("no scenario is open"))?;
        if self.mover.is_none() {
            self.mover = Some(Mover::settling(body, &self.posture)?);
        }
        let mut posture = self.posture.clone();
        let moved = self.mover.as_mut().map_or_else(|| Ok(Moved::default()), |mover| mover.settle(&mut posture))?;
        self.posture = posture;
        Ok(Answer::Shown(Box::new(self.held(moved)?)))
    }

    fn play(&mut self, samples: u32) -> Result<Answer, Refusal> {
        if self.play.is_none() {
            if self.grabbed.is_some() {
                return Err(Refusal::of("a point is grabbed; `release` comes before `play`"));
            }
            let mut document = self.document()?.clone();
            if self.posture != self.body()?.scenario.start {
                document.posture = self.body()?.named(&self.posture);
            }
            self.play = Some(Play::new(&document)?);
        }
        match (&self.body, &mut self.play) {
            (Some(body), Some(play)) => Ok(Answer::Played(Box::new(play.advance(body, samples)?))),
            _ => Err(Refusal::of("no scenario is open")),
        }
    }

    fn stop(&mut self, take: bool) -> Result<Answer, Refusal> {
        let Some(play) = self.play.take() else { return Err(Refusal::of("no run is under way")) };
        if take && !play.last.posture.is_empty() {
            let fatigue = self.body()?.fatigue(&play.last.fatigue);
            self.posture = Posture::new(play.last.posture);
            return self.change(|document| {
                document.set_fatigue(fatigue);
                Ok(())
            });
        }
        self.scene()
    }

    fn balance(&mut self, coordinate: &str) -> Result<Answer, Refusal> {
        self.held(Moved::default())?;
        let (body, Some(mover)) = (self.body()?, &self.mover) else { return Err(Refusal::of("no scenario is open")) };
        let loads: Vec<Load> = mover.engine.torques().loads().to_vec();
        Ok(Answer::Balance(balance(body, &self.posture, &loads, coordinate)?))
    }

    /// The scenario with the posture that is shown; of a run, the scenario that it began with, as long as it has run.
    fn export(&self) -> Result<Answer, Refusal> {
        let mut document = self.document()?.clone();
        if self.posture != self.body()?.scenario.start {
            document.posture = self.body()?.named(&self.posture);
        }
        let text = match &self.play {
            Some(play) => document.text_of_run(play.last.time),
            None => document.text(),
        };
        Ok(Answer::Text { text })
    }
}
