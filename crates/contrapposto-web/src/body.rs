//! Reads the document of a session: body, job and run, by the readers of the program.

use std::collections::BTreeMap;
use std::sync::Arc;

use contrapposto::contact::{Place, Region, Support};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model, plain_group_name, plain_name};
use contrapposto::posture::Posture;
use contrapposto::statics::LoadKind;
use contrapposto::tasks::Task;
use contrapposto_formats::animation::{Skeleton, directions, joined_by, solids};
use contrapposto_formats::tissue::{MuscleUse, SourcedModel};
use contrapposto_formats::{ModelFile, RelaxScenario, RunScenario, Thing, read_relax, read_run, scenario_model};
use nalgebra::{Isometry3, Vector3};

use crate::HAS_ALL;
use crate::document::Document;
use crate::error::Refusal;
use crate::message::{CoordinateScene, Handle, Hung, SegmentScene, ThingScene};

/// Name of the document in messages.
const NAME: &str = "scenario.toml";
/// Upward part of the normal of a level plane, at least.
const LEVEL: f64 = 0.999;
/// Supports stand on one ground where their heights differ by less, m.
const GROUND: f64 = 0.005;
/// Least distance between the edges of two feet, m, and farthest one ahead, behind and aside (assumed).
const GAP: f64 = 0.02;
const FARTHEST: f64 = 1.5;
/// Points of the built-in adult that have a handle: label, segment, and whether the point is the joint or the centre of mass.
const HANDLES: [(&str, &str, At); 11] = [
    ("right hand", "hand_r", At::Mass),
    ("left hand", "hand_l", At::Mass),
    ("right elbow", "ulna_r", At::Joint),
    ("left elbow", "ulna_l", At::Joint),
    ("right foot", "calcn_r", At::Mass),
    ("left foot", "calcn_l", At::Mass),
    ("right knee", "tibia_r", At::Joint),
    ("left knee", "tibia_l", At::Joint),
    ("pelvis", "pelvis", At::Mass),
    ("chest", "torso", At::Mass),
    ("head", "head", At::Mass),
];

/// A point of a segment.
#[derive(Clone, Copy)]
enum At {
    Joint,
    Mass,
}

/// A body and its job.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) model: Arc<Model>,
    pub(crate) scenario: RelaxScenario,
    /// Of the built-in adult.
    skeleton: Option<Skeleton>,
}

impl Body {
    /// Reads a document.
    pub(crate) fn read(document: &Document) -> Result<Self, Refusal> {
        let text = document.text();
        let model = model_file(&document.files, &text)?;
        let scenario = read_relax(NAME, text.as_bytes(), model)?;
        Ok(Self { model: Arc::new(scenario.model.clone()), skeleton: Skeleton::of(&scenario.model), scenario })
    }

    /// Places of the bones of the skin; none of a body without one.
    pub(crate) fn bones(&self, kinematics: &Kinematics) -> Vec<[f64; 7]> {
        let Some(skeleton) = &self.skeleton else { return vec![] };
        let places = skeleton.place_by(&self.model, kinematics);
        places.iter().take(skeleton.bones().len()).map(place).collect()
    }

    /// The segment of this name.
    pub(crate) fn segment(&self, name: &str) -> Result<usize, Refusal> {
        self.model.segment(name).ok_or_else(|| {
            let names: Vec<&str> = self.model.segments().iter().map(|segment| segment.name.as_str()).collect();
            Refusal(format!("there is no segment `{name}`; there are: {}", names.join(", ")))
        })
    }

    /// The support on a segment.
    pub(crate) fn support_on(&self, segment: usize) -> Option<usize> {
        self.scenario.supports.iter().position(|support| support.segment == segment)
    }

    /// Whether a support can be put elsewhere: it lies level, and no other one is lower, so that the ground goes on around it.
    pub(crate) fn is_on_ground(&self, support: usize) -> Result<bool, Refusal> {
        let kinematics = self.kinematics(&self.scenario.start)?;
        let height = |support: &Support| {
            let corners = support.corners.iter();
            corners
                .map(|corner| kinematics.station(&self.model, support.segment, *corner).y)
                .fold(f64::INFINITY, f64::min)
        };
        let lowest = self.scenario.supports.iter().map(height).fold(f64::INFINITY, f64::min);
        let own = &self.scenario.supports[support];
        Ok(own.normal.y > LEVEL && height(own) - lowest < GROUND)
    }

    /// Lets a support shift on its plane, on its own side of the other foot.
    pub(crate) fn let_slide(&mut self, support: usize) -> Result<(), Refusal> {
        let kinematics = self.kinematics(&self.scenario.start)?;
        let [right, ahead, _] = directions(&self.model);
        let corners = |i: usize| {
            let support = &self.scenario.supports[i];
            let corners = support.corners.iter();
            corners.map(|corner| kinematics.station(&self.model, support.segment, *corner)).collect::<Vec<_>>()
        };
        let middle = |corners: &[Vector3<f64>]| corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
        let half = |corners: &[Vector3<f64>]| {
            let far = |corner: &Vector3<f64>| (corner - middle(corners)).dot(&right).abs();
            corners.iter().map(far).fold(0.0, f64::max)
        };
        let mut others = vec![];
        for other in (0..self.scenario.supports.len()).filter(|&other| other != support) {
            if self.is_on_ground(other)? {
                others.push(corners(other));
            }
        }
        let own = corners(support);
        let away = |other: &Vec<Vector3<f64>>| (middle(&own) - middle(other)).dot(&right);
        let nearest = others.iter().min_by(|a, b| away(a).abs().total_cmp(&away(b).abs()));
        let region = nearest.map_or(vec![], |other| {
            let now = away(other);
            let side = right * now.signum();
            let least = now.abs().min(half(&own) + half(other) + GAP);
            let place = |aside: f64, forward: f64| middle(other) + side * aside + ahead * forward;
            vec![place(least, -FARTHEST), place(least, FARTHEST), place(FARTHEST, FARTHEST), place(FARTHEST, -FARTHEST)]
        });
        self.scenario.supports[support].place = Place::Free(Region { corners: region, turn: (0.0, 0.0) });
        Ok(())
    }

    /// The thing of the scenario that a segment holds.
    pub(crate) fn thing_in(&self, segment: usize) -> Option<&str> {
        let levels = self.scenario.goals.iter().zip(&self.scenario.labels);
        let mut tasks = levels.flat_map(|(level, labels)| level.tasks.iter().zip(labels));
        let held = tasks.find(|(task, label)| {
            matches!(task, Task::Point(point) if point.segment == segment) && **label != task.label(&self.model)
        });
        // The label of a hand on a thing is that of its task after the name of the thing.
        held.map(|(_, label)| label.split_once(": ").map_or(label.as_str(), |(thing, _)| thing))
    }

    /// Frames in a posture.
    pub(crate) fn kinematics(&self, posture: &Posture) -> Result<Kinematics, Refusal> {
        let mut kinematics = Kinematics::new(&self.model);
        kinematics.update(&self.model, posture).map_err(Refusal::of)?;
        Ok(kinematics)
    }

    /// Names and values of all coordinates.
    pub(crate) fn named(&self, posture: &Posture) -> Vec<(String, f64)> {
        let names = self.model.coordinates().iter().map(|coordinate| coordinate.name.clone());
        names.zip(posture.values().iter().copied()).collect()
    }

    /// Names of the coordinates whose muscles are tired, with the fatigue of the positive and negative group.
    pub(crate) fn fatigue(&self, fatigue: &[[f64; 2]]) -> Vec<(String, [f64; 2])> {
        let tired = self.model.coordinates().iter().zip(fatigue);
        let tired = tired.filter(|(coordinate, levels)| coordinate.groups.is_some() && **levels != [0.0; 2]);
        tired.map(|(coordinate, levels)| (coordinate.name.clone(), *levels)).collect()
    }

    pub(crate) fn coordinates(&self) -> Vec<CoordinateScene> {
        let scene = |coordinate: &contrapposto::model::Coordinate| CoordinateScene {
            name: coordinate.name.clone(),
            label: plain_name(&coordinate.name),
            positive: coordinate.positive.clone(),
            turns: coordinate.kind == CoordinateKind::Rotation,
            range: [coordinate.range.0, coordinate.range.1],
            groups: coordinate
                .groups
                .as_ref()
                .map(|groups| [0, 1].map(|side: usize| plain_group_name(&groups[side].name, &coordinate.name))),
        };
        self.model.coordinates().iter().map(scene).collect()
    }

    pub(crate) fn segments(&self) -> Vec<SegmentScene> {
        let scene = |(s, segment): (usize, &contrapposto::model::Segment)| {
            let joined = joined_by(&self.model, s);
            SegmentScene {
                name: segment.name.clone(),
                label: plain_name(&segment.name),
                hulls: solids(&self.model, s),
                coordinates: [joined.start, joined.end],
            }
        };
        self.model.segments().iter().enumerate().map(scene).collect()
    }

    /// Points that can be dragged from the keyboard: those of the built-in adult, of another body the middles of all segments.
    pub(crate) fn handles(&self) -> Vec<Handle> {
        let of = |s: usize, label: String, at: At| {
            let segment = &self.model.segments()[s];
            let point = match at {
                At::Joint => segment.in_segment.translation.vector,
                At::Mass => segment.center_of_mass,
            };
            Handle { label, segment: segment.name.clone(), point: point.into() }
        };
        let named = HANDLES.iter().filter_map(|(label, name, at)| {
            self.model.segment(name).map(|segment| of(segment, (*label).to_owned(), *at))
        });
        let known: Vec<Handle> = named.collect();
        if !known.is_empty() {
            return known;
        }
        let massive = self.model.segments().iter().enumerate().filter(|(_, segment)| segment.mass > 0.0);
        massive.map(|(s, segment)| of(s, plain_name(&segment.name), At::Mass)).collect()
    }

    pub(crate) fn things(&self) -> Vec<ThingScene> {
        let scene = |thing: &Thing| ThingScene {
            name: thing.name.clone(),
            size: thing.size.into(),
            place: place(&thing.place),
            segment: thing.segment,
        };
        self.scenario.things.iter().map(scene).collect()
    }

    /// Weights that hang on segments.
    pub(crate) fn hung(&self) -> Vec<Hung> {
        let weight = |load: &contrapposto::statics::Load| match load.kind {
            LoadKind::Weight(mass) => Some(Hung { segment: self.model.segments()[load.segment].name.clone(), mass }),
            _ => None,
        };
        self.scenario.loads.iter().filter_map(weight).collect()
    }
}

/// Whether a scenario names a model file.
pub(crate) fn has_model_file(text: &str) -> Result<bool, Refusal> {
    Ok(scenario_model(NAME, text.as_bytes())?.is_some())
}

/// Whether a text is a scenario: an error names the lines of the text, not those of the document that it becomes.
pub(crate) fn check(text: &str, files: &BTreeMap<String, String>) -> Result<(), Refusal> {
    let model = model_file(files, text)?;
    Ok(read_relax(NAME, text.as_bytes(), model).map(|_| ())?)
}

/// Reads the run of a document.
pub(crate) fn read_play(document: &Document) -> Result<RunScenario, Refusal> {
    let text = document.text();
    let model = model_file(&document.files, &text)?;
    Ok(read_run(NAME, text.as_bytes(), model)?)
}

/// Position and quaternion x, y, z, w.
pub(crate) fn place(placement: &Isometry3<f64>) -> [f64; 7] {
    let (at, turn): (Vector3<f64>, _) = (placement.translation.vector, placement.rotation);
    [at.x, at.y, at.z, turn.i, turn.j, turn.k, turn.w]
}

/// The model of the file that a scenario names, read as the program reads it; `None` for the built-in adult.
fn model_file(files: &BTreeMap<String, String>, text: &str) -> Result<Option<Model>, Refusal> {
    let Some(file) = scenario_model(NAME, text.as_bytes())? else { return Ok(None) };
    if !HAS_ALL {
        return Err(Refusal::of("this module reads no model files"));
    }
    let ModelFile { file: name, overlay, root, strength, fatigue, person, muscles, .. } = &file;
    if muscles.is_some_and(|uses| uses != MuscleUse::Off) {
        let why = "the page uses no muscles of model files; write muscles = \"off\", or use the program";
        return Err(Refusal(why.to_owned()));
    }
    let mut include = |name: &str| files.get(name).map(|text| text.clone().into_bytes()).ok_or_else(|| absent(name));
    let bytes = include(name).map_err(Refusal)?;
    let refused = |error| Refusal(format!("{name}: {error}"));
    let mut opened = SourcedModel::read(name, &bytes, *root, &mut include).map_err(refused)?;
    if !strength {
        opened = opened.without_strength();
    }
    opened = match overlay {
        Some(overlay) => opened.lay_over(overlay, &include(overlay).map_err(Refusal)?)?,
        None => opened.fill(person).map_err(Refusal::of)?,
    };
    Ok(Some(opened.with_fatigue(fatigue).model))
}

fn absent(name: &str) -> String {
    format!("the scenario names the file `{name}`; drop it on the page together with the scenario")
}
