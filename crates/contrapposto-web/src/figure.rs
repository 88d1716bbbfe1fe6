//! Holds a body in a posture, with the engine that moves it. A figure is built whole or not at all.

use contrapposto::model::plain_name;
use contrapposto::posture::Posture;
use nalgebra::Vector3;

use crate::body::Body;
use crate::document::Document;
use crate::error::Refusal;
use crate::message::{Handle, Pushed, Scene, Shown};
use crate::mover::{Moved, Mover};
use crate::person;
use crate::shown;

/// A body in a posture.
#[derive(Debug)]
pub(crate) struct Figure {
    pub(crate) body: Body,
    pub(crate) posture: Posture,
    mover: Mover,
}

impl Figure {
    /// The body of a document in a posture, by default in that of its start. It can settle.
    pub(crate) fn read(document: &Document, posture: Option<&Posture>) -> Result<Self, Refusal> {
        let body = Body::read(document)?;
        let posture = posture.unwrap_or(&body.scenario.start).clone();
        let mover = Mover::settling(&body, &posture)?;
        Ok(Self { body, posture, mover })
    }

    /// The body of a document at its start, whose last held point is dragged; `sliding`: on this support, which shifts on its plane.
    pub(crate) fn dragging(document: &Document, sliding: Option<usize>) -> Result<Self, Refusal> {
        let mut body = Body::read(document)?;
        if let Some(support) = sliding {
            body.let_slide(support)?;
        }
        let posture = body.scenario.start.clone();
        let Some((handle, place)) = document.held.last() else { return Err(Refusal::of("no point is grabbed")) };
        let mover = Mover::dragging(&body, &posture, (handle, *place), sliding.is_some())?;
        Ok(Self { body, posture, mover })
    }

    /// Names and values of all coordinates.
    pub(crate) fn named(&self) -> Vec<(String, f64)> {
        self.body.named(&self.posture)
    }

    /// Whether the posture is that in which the document starts.
    pub(crate) fn is_at_start(&self) -> bool {
        self.posture == self.body.scenario.start
    }

    /// Place of a point of a segment in ground, m.
    pub(crate) fn place(&self, handle: &Handle) -> Result<[f64; 3], Refusal> {
        let segment = self.body.segment(&handle.segment)?;
        let kinematics = self.body.kinematics(&self.posture)?;
        Ok(kinematics.station(&self.body.model, segment, handle.point.into()).into())
    }

    /// The loads of the posture, contact forces among them.
    pub(crate) fn loads(&self) -> &[contrapposto::statics::Load] {
        self.mover.engine.torques().loads()
    }

    /// One step of the dragged point toward a place in ground, m.
    pub(crate) fn drag(&mut self, target: Vector3<f64>) -> Result<Shown, Refusal> {
        let mut posture = self.posture.clone();
        let moved = self.mover.drag(&self.body, &mut posture, target)?;
        self.move_to(posture, moved)
    }

    /// One step toward least effort.
    pub(crate) fn settle(&mut self) -> Result<Shown, Refusal> {
        let mut posture = self.posture.clone();
        let moved = self.mover.settle(&mut posture)?;
        self.move_to(posture, moved)
    }

    fn move_to(&mut self, posture: Posture, moved: Moved) -> Result<Shown, Refusal> {
        let shown = shown::held(&self.body, &mut self.mover.engine, &posture, false, moved)?;
        self.posture = posture;
        Ok(shown)
    }

    /// Another posture, held still, with the same tasks.
    pub(crate) fn shown_in(&self, posture: &Posture) -> Result<Shown, Refusal> {
        let mut mover = Mover::settling(&self.body, &self.body.scenario.start)?;
        shown::held(&self.body, &mut mover.engine, posture, false, Moved::default())
    }

    /// A posture, held still, with the supports where it has them.
    pub(crate) fn still_in(&self, posture: &Posture) -> Result<Shown, Refusal> {
        let mut mover = Mover::settling(&self.body, posture)?;
        shown::held(&self.body, &mut mover.engine, posture, true, Moved::default())
    }

    /// The posture, held still.
    pub(crate) fn shown(&mut self) -> Result<Shown, Refusal> {
        shown::held(&self.body, &mut self.mover.engine, &self.posture, false, Moved::default())
    }

    /// Body and job of a document, `can`: whether there is a change to undo, and one to redo.
    pub(crate) fn scene(&mut self, document: &Document, can: (bool, bool)) -> Result<Scene, Refusal> {
        let shown = self.shown()?;
        let body = &self.body;
        let scenario = &body.scenario;
        let support = |support: &contrapposto::contact::Support| body.model.segments()[support.segment].name.clone();
        let person = document.adult().and_then(person::scene);
        let force =
            |(segment, point, force): (String, _, _)| Pushed { label: plain_name(&segment), segment, point, force };
        Ok(Scene {
            title: scenario.title.clone(),
            person,
            coordinates: body.coordinates(),
            segments: body.segments(),
            handles: body.handles(),
            held: document.held.iter().map(|(handle, _)| handle.clone()).collect(),
            supports: scenario.supports.iter().map(support).collect(),
            things: body.things(),
            loads: body.hung(),
            tables: document.things(),
            forces: document.forces().into_iter().map(force).collect(),
            strategy: document.strategy().to_owned(),
            regions: document.regions(&body.model),
            notes: scenario.notes.clone(),
            can_undo: can.0,
            can_redo: can.1,
            shown,
        })
    }
}
