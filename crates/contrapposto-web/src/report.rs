//! Fills the program's `report.html` with what a session shows: a posture, or the moments of a run that are kept.
//!
//! Body, torques, contact forces, fatigue and decisions are there as the program has them; its narrative and the changes that it tries are not.

use contrapposto::joint_torques::Hazard;
use contrapposto::model::{CoordinateKind, Model, Side, plain_group_name, plain_name};
use contrapposto::posture::Posture;
use contrapposto::verdict::has_motors;
use contrapposto_formats::Thing;
use contrapposto_formats::animation::{Skin, directions, joined_by, solids};
use contrapposto_report as page;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::balance::balance;
use crate::body::Body;
use crate::error::Refusal;
use crate::message::{LogLine, Shown};

/// One moment.
#[derive(Debug)]
pub(crate) struct Moment {
    /// s.
    pub(crate) time: f64,
    pub(crate) shown: Shown,
    /// By coordinate; empty where nothing tires.
    pub(crate) fatigue: Vec<[f64; 2]>,
}

/// All that a report tells.
#[derive(Debug)]
pub(crate) struct Told<'a> {
    pub(crate) body: &'a Body,
    /// Things around the body and in its hands.
    pub(crate) things: &'a [Thing],
    /// At least one; of a posture this one.
    pub(crate) moments: Vec<Moment>,
    /// Decisions of a run, and the fatigue at which relief begins and ends.
    pub(crate) run: Option<(Vec<LogLine>, [f64; 2])>,
    /// The file of the skin.
    pub(crate) skin: Option<&'a [u8]>,
}

/// From ground to the axes of a report: x ahead, y up, z right.
struct Turn(UnitQuaternion<f64>);

impl Turn {
    fn of(model: &Model) -> Self {
        let [right, ahead, up] = directions(model);
        let rows = Matrix3::from_rows(&[ahead.transpose(), up.transpose(), right.transpose()]);
        Self(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows)))
    }

    fn point(&self, at: [f64; 3]) -> [f64; 3] {
        (self.0 * Vector3::from(at)).into()
    }

    fn place(&self, place: &Isometry3<f64>) -> [f64; 7] {
        let turned = self.0 * place;
        let (at, q) = (turned.translation.vector, turned.rotation);
        [at.x, at.y, at.z, q.w, q.i, q.j, q.k]
    }

    /// The same of position and quaternion x, y, z, w.
    fn shown(&self, place: &[f64; 7]) -> [f64; 7] {
        self.place(&isometry(place))
    }
}

fn isometry(&[x, y, z, i, j, k, w]: &[f64; 7]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k)),
    )
}

/// The page. `charts`: the text of its chart library.
pub(crate) fn html(told: &Told<'_>, charts: &str) -> Result<String, Refusal> {
    let Told { body, moments, .. } = told;
    let (model, turn) = (&*body.model, Turn::of(&body.model));
    let Some(last) = moments.last() else { return Err(Refusal::of("nothing is shown yet")) };
    let joints = carrying(model);
    let hardest = |a: &usize, b: &usize| last.shown.load[joints[*a]].total_cmp(&last.shown.load[joints[*b]]);
    let fact = |line: &String| {
        let (name, text) = line.split_once(": ").unwrap_or(("", line));
        page::Fact { name: name.to_owned(), text: text.trim_end_matches('.').to_owned() }
    };
    let lowest = moments[0].shown.patches.iter().map(|corner| turn.point(*corner)[1]).reduce(f64::min);
    let mut report = page::Report {
        title: body.scenario.title.clone(),
        body: model.name().to_owned(),
        headline: last.shown.verdict.sentence.clone(),
        facts: last.shown.verdict.lines.iter().map(fact).collect(),
        motors: has_motors(model),
        moments: page::Moments::Postures(vec!["the posture".to_owned()]),
        open: moments.len() - 1,
        segments: segments(told, &joints, &turn),
        skin: told.skin.and_then(|file| skin(told, file, &joints, &turn)),
        joints: joints.iter().map(|&i| joint(told, i)).collect::<Result<_, _>>()?,
        main: (0..joints.len()).rev().max_by(hardest).unwrap_or(0),
        supports: supports(told, &turn),
        ground: lowest,
        things: things(told, &turn),
        loads: loads(told, &turn),
        center_of_mass: moments.iter().map(|moment| turn.point(moment.shown.center)).collect(),
        ..page::Report::default()
    };
    if let Some((log, levels)) = &told.run {
        report.moments = page::Moments::Times(moments.iter().map(|moment| moment.time).collect());
        report.levels = Some(*levels);
        let frame = |time: f64| moments.iter().position(|moment| moment.time >= time).unwrap_or(moments.len() - 1);
        let entry = |line: &LogLine| page::Entry {
            frame: frame(line.time),
            time: Some(line.time),
            joint: None,
            text: line.sentence.clone(),
        };
        report.list = page::List {
            heading: "Decisions".to_owned(),
            entries: log.iter().map(entry).collect(),
            none: "None: no muscle group needed relief.".to_owned(),
        };
    }
    Ok(page::write_with(&report, charts))
}

/// Coordinates that carry a torque.
fn carrying(model: &Model) -> Vec<usize> {
    let coordinates = model.coordinates().iter().enumerate();
    let carries = coordinates.filter(|(_, c)| c.rate.is_some() && (c.groups.is_some() || c.passive.is_some()));
    carries.map(|(i, _)| i).collect()
}

/// Places, in a list of coordinates, of those that join a segment to its parent.
fn joints_of(model: &Model, segment: usize, joints: &[usize]) -> Vec<usize> {
    let joined = joined_by(model, segment);
    (0..joints.len()).filter(|&place| joined.contains(&joints[place])).collect()
}

fn segments(told: &Told<'_>, joints: &[usize], turn: &Turn) -> Vec<page::Segment> {
    let model = &*told.body.model;
    let places = |s: usize| told.moments.iter().map(move |moment| turn.shown(&moment.shown.places[s]));
    let solid = |s: usize, balls| page::Segment {
        name: model.segments()[s].name.clone(),
        balls,
        joints: joints_of(model, s, joints),
        places: places(s).collect(),
        start: places(s).next().unwrap_or_default(),
    };
    (0..model.segments().len())
        .flat_map(|s| solids(model, s).into_iter().map(move |balls| (s, balls)))
        .map(|(s, balls)| solid(s, balls))
        .collect()
}

fn skin(told: &Told<'_>, file: &[u8], joints: &[usize], turn: &Turn) -> Option<page::Skin> {
    let model = &*told.body.model;
    let skin = Skin::from_file(model, file)?;
    let bones = skin.skeleton.bones();
    let mut segments: Vec<usize> = bones.iter().flat_map(|bone| [bone.from, bone.segment]).collect();
    segments.sort_unstable();
    segments.dedup();
    let index = |segment: usize| segments.iter().position(|other| *other == segment).unwrap_or(0);
    let bone = |bone: &contrapposto_formats::animation::Bone| page::Bone {
        from: index(bone.from),
        to: index(bone.segment),
        axis: turn.point(bone.axis.into()),
        shares: bone.shares,
    };
    let followed = |&segment: &usize| {
        let places: Vec<_> = told.moments.iter().map(|moment| turn.shown(&moment.shown.places[segment])).collect();
        let (joints, rest) = (joints_of(model, segment, joints), turn.place(&skin.skeleton.rest[segment]));
        page::Followed { joints, rest, start: places.first().copied().unwrap_or_default(), places }
    };
    Some(page::Skin {
        vertices: skin.vertices.iter().map(|vertex| turn.point((*vertex).into())).collect(),
        triangles: skin.triangles.clone(),
        light: skin.light(),
        bones: skin.bones.clone(),
        weights: skin.weights.clone(),
        nodes: bones.iter().map(bone).collect(),
        segments: segments.iter().map(followed).collect(),
    })
}

fn joint(told: &Told<'_>, i: usize) -> Result<page::Joint, Refusal> {
    let Told { body, moments, .. } = told;
    let coordinate = &body.model.coordinates()[i];
    let turns = coordinate.kind == CoordinateKind::Rotation;
    let visible = |value: f64| if turns { value.to_degrees() } else { value };
    let over = |value: &dyn Fn(&Moment) -> f64| moments.iter().map(value).collect::<Vec<f64>>();
    let about_axis = body.model.three_axis_joint_of(i).is_some();
    let tires = moments.iter().all(|moment| !moment.fatigue.is_empty());
    let group = |side: Side| {
        let group = &coordinate.groups.as_ref()?[side.index()];
        let fatigue = |moment: &Moment| moment.fatigue.get(i).map_or(0.0, |levels| levels[side.index()]);
        let left = |moment: &Moment| {
            let works = Side::of(moment.shown.active[i]) == side;
            group.fatigue.time_left(fatigue(moment), if works { moment.shown.load[i] } else { 0.0 })
        };
        Some(page::Group {
            label: plain_group_name(&group.name, &coordinate.name),
            fatigue: if tires { over(&fatigue) } else { vec![] },
            left: over(&left),
            fails: None,
        })
    };
    let in_hazard = |moment: &Moment| {
        let Shown { angles, external, passive, .. } = &moment.shown;
        Hazard::all(&body.model, angles, external, passive).iter().any(|hazard| hazard.coordinate == i)
    };
    let hazard: Vec<bool> = moments.iter().map(in_hazard).collect();
    Ok(page::Joint {
        name: coordinate.name.clone(),
        label: plain_name(&coordinate.name),
        positive: coordinate.positive.clone(),
        slides: !turns,
        about_axis,
        groups: group(Side::Positive).zip(group(Side::Negative)).map(|(a, b)| [a, b]),
        angle: over(&|moment| visible(moment.shown.angles[i])),
        coordinate: if about_axis { over(&|moment| visible(moment.shown.q[i])) } else { vec![] },
        external: over(&|moment| moment.shown.external[i]),
        passive: over(&|moment| moment.shown.passive[i]),
        load: over(&|moment| moment.shown.load[i]),
        hazard: if hazard.contains(&true) { hazard } else { vec![] },
        balance: moments.last().map_or(Ok(vec![]), |last| curve(body, last, i))?,
    })
}

/// The passive torque over the range of a joint in a moment; none of a joint without tissue.
fn curve(body: &Body, moment: &Moment, i: usize) -> Result<Vec<page::Balance>, Refusal> {
    let coordinate = &body.model.coordinates()[i];
    if coordinate.passive.is_none() {
        return Ok(vec![]);
    }
    let found = balance(body, &Posture::new(moment.shown.q.clone()), &[], &coordinate.name)?;
    let turns = coordinate.kind == CoordinateKind::Rotation;
    let angle = found.angle.iter().map(|angle| if turns { angle.to_degrees() } else { *angle }).collect();
    Ok(vec![page::Balance { angle, minus_passive: found.minus_passive, external: vec![] }])
}

fn supports(told: &Told<'_>, turn: &Turn) -> Vec<page::Support> {
    let support = |(i, support): (usize, &contrapposto::contact::Support)| {
        let label = plain_name(&told.body.model.segments()[support.segment].name);
        let mut shown = page::Support { label, ..page::Support::default() };
        let mut at = [0.0; 3];
        for contact in told.moments.iter().filter_map(|moment| moment.shown.contacts.get(i)) {
            at = contact.at.unwrap_or(at);
            shown.force.push(turn.point(contact.force));
            shown.at.push(turn.point(at));
            shown.share.push(contact.share);
        }
        shown
    };
    told.body.scenario.supports.iter().enumerate().map(support).collect()
}

/// Things in every moment; those in ground once.
fn things(told: &Told<'_>, turn: &Turn) -> Vec<page::Thing> {
    let thing = |thing: &Thing| {
        let places = match thing.segment {
            None => vec![turn.place(&thing.place)],
            Some(segment) => {
                let at = |moment: &Moment| turn.place(&(isometry(&moment.shown.places[segment]) * thing.place));
                told.moments.iter().map(at).collect()
            }
        };
        let put_down = told.moments.iter().position(|moment| !thing.is_there(moment.time));
        page::Thing { label: thing.name.clone(), size: thing.size.into(), places, put_down }
    };
    told.things.iter().map(thing).collect()
}

/// Loads in every moment, with zero force where there are fewer of them.
fn loads(told: &Told<'_>, turn: &Turn) -> Vec<page::Push> {
    let most = told.moments.iter().map(|moment| moment.shown.pushes.len()).max().unwrap_or(0);
    let load = |i: usize| {
        let pushes = told.moments.iter().map(|moment| moment.shown.pushes.get(i));
        page::Push {
            label: format!("load {}", i + 1),
            at: pushes.clone().map(|push| push.map_or([0.0; 3], |push| turn.point(push.at))).collect(),
            force: pushes.map(|push| push.map_or([0.0; 3], |push| turn.point(push.force))).collect(),
        }
    };
    (0..most).map(load).collect()
}
