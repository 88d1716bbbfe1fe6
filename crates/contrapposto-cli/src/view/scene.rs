//! The numbers that all pages share: the body, its joints and its supports in every moment.

mod closed_hand;
pub(crate) mod hazard;
mod muscle_lines;
mod skin;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model, Side};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto_formats::animation::{joined_by, solids};
use contrapposto_report::{Balance, Group, Joint, Moments, Muscles, Push, Report, Segment, Thing};
use nalgebra::Vector3;

use self::closed_hand::closed_hands;
use self::hazard::hazard;
use self::muscle_lines::muscle_lines;
use self::skin::{Course, skin};
use super::axes::{Turn, turn, visible};
use super::charts::Sweep;
use super::frame::Frame;
use super::muscle_work::MusclesAtWork;
use super::selection::shown;
use super::stage::{Stage, load_in_words, place, push};
use super::{surfaces, words};
use crate::fail::Fail;

/// Angles at which the torques of a joint are drawn.
pub(crate) const ANGLES: usize = 121;

/// A body in some moments, and its supports.
pub(crate) struct Scene<'a> {
    pub(crate) title: &'a str,
    pub(crate) model: &'a Model,
    /// Posture before anything happened.
    pub(crate) start: &'a [f64],
    pub(crate) frames: &'a [Frame],
    /// Supports, things and loads.
    pub(crate) stage: Stage<'a>,
    /// Segments of the contacts of every frame.
    pub(crate) carried: Vec<usize>,
    /// Loads while one joint alone is moved; `None` for a body on supports, whose joints cannot move alone.
    pub(crate) held: Option<&'a [Load]>,
    /// Muscles in the moments of the frames.
    pub(crate) muscles: Option<&'a MusclesAtWork<'a>>,
}

impl<'a> Scene<'a> {
    /// A body in some moments among the things of its stage, whose supports alone touch it; no joint is moved alone.
    pub(crate) fn of(
        title: &'a str,
        model: &'a Model,
        start: &'a [f64],
        frames: &'a [Frame],
        stage: Stage<'a>,
    ) -> Self {
        let carried = stage.supports.iter().map(|support| support.segment).collect();
        Self { title, model, start, frames, stage, carried, held: None, muscles: None }
    }

    /// The page without its words. `main`: the coordinate to show first.
    pub(crate) fn report(&self, moments: Moments, main: usize) -> Result<Report, Fail> {
        let model = self.model;
        let (shown, turn) = (shown(model), turn(model));
        let closed = closed_hands(model, &self.stage);
        let surroundings = surfaces::surroundings(model, &self.stage, self.start, self.frames, &turn)?;
        let standing = self.frames.iter().filter_map(|frame| frame.standing.as_ref());
        let centers: Vec<[f64; 3]> = standing.map(|standing| turn.point(standing.center_of_mass)).collect();
        // Postures that differ bend the curves of coupled laws each in its own way.
        let last = self.frames.last().into_iter().collect();
        let balanced: Vec<&Frame> =
            if matches!(moments, Moments::Times(_)) { last } else { self.frames.iter().collect() };
        Ok(Report {
            title: self.title.to_owned(),
            body: model.name().to_owned(),
            moments,
            segments: self.segments(&shown, &turn)?,
            skin: skin(&Course { model, start: self.start, frames: self.frames, closed: &closed }, &shown, &turn)?,
            joints: shown.iter().map(|&i| self.joint(i, &balanced)).collect::<Result<_, _>>()?,
            main: shown.iter().position(|&i| i == main).unwrap_or(0),
            supports: self.supports(&turn),
            ground: surroundings.ground,
            surfaces: surroundings.surfaces,
            things: self.things(&turn)?,
            loads: self.loads(&turn)?,
            muscles: self.muscles.map(|muscles| self.muscles(muscles, &shown, &turn)).transpose()?,
            center_of_mass: if centers.len() == self.frames.len() { centers } else { vec![] },
            ..Report::default()
        })
    }

    fn segments(&self, shown: &[usize], turn: &Turn) -> Result<Vec<Segment>, Fail> {
        let model = self.model;
        let mut kinematics = Kinematics::new(model);
        let mut parts: Vec<(usize, Segment)> = vec![];
        for (s, segment) in model.segments().iter().enumerate() {
            let coordinates = joined_by(model, s);
            let joints = shown.iter().enumerate().filter(|(_, i)| coordinates.contains(i)).map(|(place, _)| place);
            let joints: Vec<usize> = joints.collect();
            for balls in solids(model, s) {
                let name = segment.name.clone();
                parts.push((s, Segment { name, balls, joints: joints.clone(), ..Segment::default() }));
            }
        }
        let mut place = |posture: &[f64], parts: &mut [(usize, Segment)], put: fn(&mut Segment, [f64; 7])| {
            let posture = Posture::new(posture.to_vec());
            kinematics.update(model, &posture).map_err(|error| Fail::job("report", error))?;
            parts.iter_mut().for_each(|(s, part)| put(part, turn.place(&kinematics.placement(model, *s))));
            Ok::<(), Fail>(())
        };
        for frame in self.frames {
            place(&frame.posture, &mut parts, |part, place| part.places.push(place))?;
        }
        place(self.start, &mut parts, |part, place| part.start = place)?;
        Ok(parts.into_iter().map(|(_, part)| part).collect())
    }

    pub(super) fn kinematics(&self, frame: &Frame) -> Result<Kinematics, Fail> {
        let mut kinematics = Kinematics::new(self.model);
        let updated = kinematics.update(self.model, &Posture::new(frame.posture.clone()));
        updated.map_err(|error| Fail::job("report", error)).map(|()| kinematics)
    }

    fn muscles(&self, muscles: &MusclesAtWork<'_>, shown: &[usize], turn: &Turn) -> Result<Muscles, Fail> {
        let kinematics = self.frames.iter().map(|frame| self.kinematics(frame)).collect::<Result<Vec<_>, _>>()?;
        Ok(muscle_lines((self.model, &kinematics), muscles, shown, turn))
    }

    /// Things in every frame; those in ground once.
    fn things(&self, turn: &Turn) -> Result<Vec<Thing>, Fail> {
        let mut things = vec![];
        for thing in self.stage.things {
            let frames = if thing.segment.is_some() { self.frames } else { &self.frames[..self.frames.len().min(1)] };
            let at = |frame| Ok::<_, Fail>(turn.place(&place(self.model, &self.kinematics(frame)?, thing)));
            let places = frames.iter().map(at).collect::<Result<_, _>>()?;
            let put_down = self.frames.iter().position(|frame| !thing.is_there(frame.time));
            things.push(Thing { label: thing.name.clone(), size: thing.size.into(), places, put_down });
        }
        Ok(things)
    }

    /// Loads in every frame, with zero force where they are not in force.
    fn loads(&self, turn: &Turn) -> Result<Vec<Push>, Fail> {
        let all = self.stage.all_loads();
        let labels = all.iter().map(|load| Push { label: load_in_words(self.model, load), ..Push::default() });
        let mut pushes: Vec<Push> = labels.collect();
        for frame in self.frames.iter().filter(|_| !all.is_empty()) {
            let (kinematics, now) = (self.kinematics(frame)?, self.stage.loads_at(frame.time));
            for (load, shown) in all.iter().zip(&mut pushes) {
                let [at, force] = push(self.model, &kinematics, load).unwrap_or_default();
                shown.at.push(turn.point(at));
                shown.force.push(if now.contains(load) { turn.point(force) } else { [0.0; 3] });
            }
        }
        pushes.retain(|shown| shown.force.iter().flatten().any(|newtons| *newtons != 0.0));
        Ok(pushes)
    }

    /// Names of what carries the body, by `carried`.
    pub(crate) fn names_of_supports(&self) -> Vec<String> {
        let posture = self.frames.first().map_or(self.start, |frame| &frame.posture);
        let known = self.stage.support_names(self.model, posture);
        let more = self.carried.iter().skip(known.len());
        let more = more.map(|&segment| words::plain(&self.model.segments()[segment].name));
        known.iter().cloned().chain(more).collect()
    }

    fn supports(&self, turn: &Turn) -> Vec<contrapposto_report::Support> {
        let support = |(i, label): (usize, String)| {
            let mut shown = contrapposto_report::Support { label, ..Default::default() };
            let mut at = Vector3::zeros();
            for contact in self.frames.iter().filter_map(|frame| frame.standing.as_ref()?.contacts.get(i)) {
                at = contact.center_of_pressure.unwrap_or(at);
                shown.force.push(turn.point(contact.force));
                shown.at.push(turn.point(at));
                shown.share.push(contact.share);
            }
            shown
        };
        self.names_of_supports().into_iter().enumerate().map(support).collect()
    }

    fn joint(&self, i: usize, balanced: &[&Frame]) -> Result<Joint, Fail> {
        let coordinate = &self.model.coordinates()[i];
        let over = |value: &dyn Fn(&Frame) -> f64| self.frames.iter().map(value).collect::<Vec<f64>>();
        let about_axis = self.model.three_axis_joint_of(i).is_some();
        let tires = self.frames.iter().all(|frame| frame.fatigue.is_some());
        let group = |side: Side| {
            let group = &coordinate.groups.as_ref()?[side.index()];
            let fatigue = |frame: &Frame| frame.fatigue.as_ref().map_or(0.0, |fatigue| fatigue[i][side.index()]);
            let left = |frame: &Frame| {
                let load = if Side::of(frame.active(i)) == side { frame.load[i] } else { 0.0 };
                group.fatigue.time_left(fatigue(frame), load)
            };
            let label = words::group(&group.name, &coordinate.name);
            Some(Group { label, fatigue: if tires { over(&fatigue) } else { vec![] }, left: over(&left), fails: None })
        };
        Ok(Joint {
            name: coordinate.name.clone(),
            label: words::plain(&coordinate.name),
            positive: coordinate.positive.clone(),
            slides: coordinate.kind == CoordinateKind::Translation,
            about_axis,
            groups: group(Side::Positive).zip(group(Side::Negative)).map(|(a, b)| [a, b]),
            angle: over(&|frame| visible(coordinate, frame.angles[i])),
            coordinate: if about_axis { over(&|frame| visible(coordinate, frame.posture[i])) } else { vec![] },
            external: over(&|frame| frame.external[i]),
            passive: over(&|frame| frame.passive[i]),
            load: over(&|frame| frame.load[i]),
            hazard: self.hazard(i),
            balance: balanced
                .iter()
                .filter_map(|frame| self.balance(i, frame).transpose())
                .collect::<Result<_, _>>()?,
        })
    }

    /// By frame: the coordinate is in hazard. Empty for a coordinate that never is.
    fn hazard(&self, i: usize) -> Vec<bool> {
        let all: Vec<bool> = self.frames.iter().map(|frame| hazard(self.model, frame, i).is_some()).collect();
        if all.contains(&true) { all } else { vec![] }
    }

    /// Torques over the range, in the posture of a frame; none of a joint without passive tissue.
    fn balance(&self, i: usize, frame: &Frame) -> Result<Option<Balance>, Fail> {
        let coordinate = &self.model.coordinates()[i];
        if coordinate.passive.is_none() {
            return Ok(None);
        }
        let mut balance = Balance::default();
        let mut sweep = Sweep::new(self.model, self.held.unwrap_or_default(), i, &frame.posture)?;
        let (min, max) = sweep.range();
        for k in 0..ANGLES {
            let angle = min + (max - min) * k as f64 / (ANGLES - 1) as f64;
            balance.angle.push(visible(coordinate, angle));
            if self.held.is_some() {
                let (external, passive) = sweep.torques(angle)?;
                balance.minus_passive.push(-passive);
                balance.external.push(external);
            } else {
                balance.minus_passive.push(-sweep.passive(angle));
            }
        }
        Ok(Some(balance))
    }
}
