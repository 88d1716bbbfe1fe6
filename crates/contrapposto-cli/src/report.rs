//! `report.html`: from a scenario, a recording of its run and its summary to the plain numbers that the page shows.

pub(crate) mod body;
mod figures;
mod film;
mod moments;
mod solid;
mod story;
mod words;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Coordinate, CoordinateKind, Model, Side};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Scenario, Summary};
use contrapposto_report::{Balance, Decision, Group, Joint, Report, Segment, Support};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::chart::Sweep;
use crate::fail::Fail;
use crate::pose::directions;
use crate::simulate::Recording;

pub(crate) use figures::{before_and_after, both, figures_of_assessment, figures_of_run};
pub(crate) use film::Frame;
use film::{Event, Film};
pub(crate) use moments::Moments;
pub(crate) use solid::parts;
pub(crate) use story::pelvis_list;
pub(crate) use words::{group as group_in_words, plain};

/// Angles at which the torques of a joint are drawn.
const ANGLES: usize = 121;

/// The page of a run.
pub(crate) fn report_of_run(scenario: &Scenario, recording: &Recording, summary: &Summary) -> Result<String, Fail> {
    let film = Film::new(scenario, recording, summary);
    let frames: Vec<&Frame> = film.frames.iter().collect();
    let model = &scenario.model;
    let shown = shown(model);
    let turn = turn(model);
    let mut report = Report {
        title: scenario.title.clone(),
        body: model.name().to_owned(),
        times: frames.iter().map(|frame| frame.time).collect(),
        segments: segments(model, &frames, &shown, &turn)?,
        levels: [scenario.hysteresis.critical_level, scenario.hysteresis.recovery_level],
        supports: supports(scenario, &frames, &turn),
        ..Report::default()
    };
    if frames.iter().all(|frame| frame.standing.is_some()) {
        report.center_of_mass =
            frames.iter().filter_map(|frame| frame.standing.as_ref()).map(|s| turn.point(s.center_of_mass)).collect();
    }
    report.effort = frames.iter().map(|frame| frame.effort()).collect();
    for &i in &shown {
        report.joints.push(joint(scenario, i, &frames)?);
    }
    report.main = shown.iter().position(|&i| i == main_coordinate(scenario, summary)).unwrap_or(0);
    report.decisions = decisions(scenario, &film, &shown);
    story::tell(scenario, &film, summary, &shown, &mut report);
    Ok(contrapposto_report::write(&report))
}

/// Coordinates that hold a torque: all with muscles or passive tissue; of a body without any, all.
fn shown(model: &Model) -> Vec<usize> {
    let all = || (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].kind != CoordinateKind::Quaternion);
    let holds = |i: &usize| model.coordinates()[*i].groups.is_some() || model.coordinates()[*i].passive.is_some();
    let holding: Vec<usize> = all().filter(holds).collect();
    if holding.is_empty() { all().collect() } else { holding }
}

/// The coordinate that the story is about: the one most often relieved, of equals a free one, of equals the hardest worked.
pub(crate) fn main_coordinate(scenario: &Scenario, summary: &Summary) -> usize {
    let weight = |i: usize| {
        let coordinate = &summary.coordinates[i];
        (coordinate.iterations.iter().sum::<u64>(), scenario.free[i], coordinate.peak_load)
    };
    let more = |a: &usize, b: &usize| {
        let (a, b) = (weight(*a), weight(*b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    // The first of equals.
    shown(&scenario.model).into_iter().rev().max_by(more).unwrap_or(0)
}

/// How ground axes are turned so that x is forward, y up and z right.
pub(crate) struct Turn(Rotation3<f64>);

impl Turn {
    pub(crate) fn point(&self, p: Vector3<f64>) -> [f64; 3] {
        (self.0 * p).into()
    }

    fn place(&self, place: &Isometry3<f64>) -> [f64; 7] {
        let [x, y, z] = self.point(place.translation.vector);
        let q = UnitQuaternion::from_rotation_matrix(&self.0) * place.rotation;
        [x, y, z, q.w, q.i, q.j, q.k]
    }
}

pub(crate) fn turn(model: &Model) -> Turn {
    let [right, ahead, up] = directions(model);
    Turn(Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[ahead.transpose(), up.transpose(), right.transpose()])))
}

fn segments(model: &Model, frames: &[&Frame], shown: &[usize], turn: &Turn) -> Result<Vec<Segment>, Fail> {
    let mut kinematics = Kinematics::new(model);
    let mut parts: Vec<(usize, Segment)> = vec![];
    for (s, segment) in model.segments().iter().enumerate() {
        let coordinates = solid::joined_by(model, s);
        let joints = shown.iter().enumerate().filter(|(_, i)| coordinates.contains(i)).map(|(place, _)| place);
        let joints: Vec<usize> = joints.collect();
        for balls in solid::parts(model, s) {
            parts.push((s, Segment { name: segment.name.clone(), balls, joints: joints.clone(), places: vec![] }));
        }
    }
    for frame in frames {
        let posture = Posture::new(frame.posture.clone());
        kinematics.update(model, &posture).map_err(|error| Fail::job("report", error))?;
        for (s, part) in &mut parts {
            part.places.push(turn.place(&kinematics.placement(model, *s)));
        }
    }
    Ok(parts.into_iter().map(|(_, part)| part).collect())
}

fn supports(scenario: &Scenario, frames: &[&Frame], turn: &Turn) -> Vec<Support> {
    let support = |(i, support): (usize, &contrapposto::contact::Support)| {
        let mut shown =
            Support { label: words::plain(&scenario.model.segments()[support.segment].name), ..Support::default() };
        let mut at = Vector3::zeros();
        for contact in frames.iter().filter_map(|frame| frame.standing.as_ref()?.contacts.get(i)) {
            at = contact.center_of_pressure.unwrap_or(at);
            shown.force.push(turn.point(contact.force));
            shown.at.push(turn.point(at));
            shown.share.push(contact.share);
        }
        shown
    };
    scenario.supports.iter().enumerate().map(support).collect()
}

/// In degrees, slides in m.
fn visible(coordinate: &Coordinate, value: f64) -> f64 {
    if coordinate.kind == CoordinateKind::Rotation { value.to_degrees() } else { value }
}

fn joint(scenario: &Scenario, i: usize, frames: &[&Frame]) -> Result<Joint, Fail> {
    let coordinate = &scenario.model.coordinates()[i];
    let over = |value: &dyn Fn(&Frame) -> f64| frames.iter().map(|frame| value(frame)).collect::<Vec<f64>>();
    let group = |side: Side| {
        let group = &coordinate.groups.as_ref()?[side.index()];
        let left = |frame: &Frame| {
            let load = if Side::of(frame.active(i)) == side { frame.load[i] } else { 0.0 };
            group.fatigue.time_left(frame.fatigue[i][side.index()], load)
        };
        let label = words::group(&group.name, &coordinate.name);
        Some(Group { label, fatigue: over(&|frame| frame.fatigue[i][side.index()]), left: over(&left) })
    };
    Ok(Joint {
        name: coordinate.name.clone(),
        label: words::plain(&coordinate.name),
        positive: coordinate.positive.clone(),
        slides: coordinate.kind == CoordinateKind::Translation,
        groups: group(Side::Positive).zip(group(Side::Negative)).map(|(a, b)| [a, b]),
        angle: over(&|frame| visible(coordinate, frame.posture[i])),
        external: over(&|frame| frame.external[i]),
        passive: over(&|frame| frame.passive[i]),
        load: over(&|frame| frame.load[i]),
        balance: balance(scenario, i, frames)?,
    })
}

/// Torques over the range. External torque is swept only where everything else can be held: not under a body that stands.
fn balance(scenario: &Scenario, i: usize, frames: &[&Frame]) -> Result<Balance, Fail> {
    let coordinate = &scenario.model.coordinates()[i];
    let (Some(last), Some(passive)) = (frames.last(), &coordinate.passive) else { return Ok(Balance::default()) };
    let (min, max) = coordinate.range;
    let mut balance = Balance::default();
    let mut values = last.posture.clone();
    let mut sweep = (!scenario.is_whole()).then(|| Sweep::new(scenario, i, &last.posture));
    for k in 0..ANGLES {
        let angle = min + (max - min) * k as f64 / (ANGLES - 1) as f64;
        balance.angle.push(visible(coordinate, angle));
        if let Some(sweep) = &mut sweep {
            let (external, passive) = sweep.torques(angle)?;
            balance.minus_passive.push(-passive);
            balance.external.push(external);
        } else {
            values[i] = angle;
            balance.minus_passive.push(-passive.torque(i, &values));
        }
    }
    Ok(balance)
}

fn decisions(scenario: &Scenario, film: &Film, shown: &[usize]) -> Vec<Decision> {
    let decision = |event: &Event| {
        let joint = shown.iter().position(|&i| i == event.coordinate)?;
        let frame = film.frames.iter().position(|frame| frame.time >= event.time)?;
        Some(Decision { frame, joint, text: words::decision(scenario, event, &film.frames[frame]) })
    };
    film.events.iter().filter_map(decision).collect()
}
