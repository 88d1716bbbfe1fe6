//! Guesses a start by the things of the world: values of coordinates for what `[posture]` leaves out.
//!
//! A sitter has the shanks upright: with the knee `K` above the floor, the hip joint `H` above it and a thigh of length `L`, the thigh
//! rises forward by `sin phi = (K - H) / L`; hip flexion is `90 deg + phi` less the backward tilt of the pelvis, knee flexion
//! `90 deg + phi`. A body whose hands are below the hips squats, deeper for lower hands. All angles here are assumed; `start` moves the body
//! until the things fit.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use nalgebra::{UnitQuaternion, Vector3};

use super::carriers::BACKREST_DEFAULT_DEG;
use super::plan::{HandTarget, World, forearm};
use super::text::{CarriedText, SeatText};
use crate::scenario::text::ScenarioText;

/// A squat whose soles stay level, deg: hip, knee, ankle, pelvis.
const SQUAT_DEG: [(&str, f64); 7] = [
    ("hip_flexion_r", 70.0),
    ("hip_flexion_l", 70.0),
    ("knee_angle_r", 50.0),
    ("knee_angle_l", 50.0),
    ("ankle_angle_r", 15.0),
    ("ankle_angle_l", 15.0),
    ("pelvis_tilt", -35.0),
];
/// Share of the height of the hips by which hands are below them in the full squat.
const SQUAT_DEPTH: f64 = 0.65;
/// Hand on a level top: arm forward, elbow a little bent, palm down.
const PALM_DOWN_DEG: [(&str, f64); 4] =
    [("arm_flex", 40.0), ("elbow_flex", 30.0), ("pro_sup", 75.0), ("wrist_flex", -50.0)];
/// Hand at work: forearm level in front of the body.
const HAND_AHEAD_DEG: [(&str, f64); 2] = [("arm_flex", 20.0), ("elbow_flex", 80.0)];
/// Hand at work above the shoulder.
const HAND_ABOVE_DEG: [(&str, f64); 2] = [("arm_flex", 130.0), ("elbow_flex", 50.0)];

/// Sets the seeds.
pub(super) fn set(world: &mut World, text: &ScenarioText, model: &Model) {
    let kinematics = Kinematics::new(model);
    let seeds = Seeder { model, kinematics: &kinematics };
    let mut pairs: Vec<(String, f64)> = vec![];
    if let Some(seat) = &text.seat {
        pairs.extend(seeds.sitting(seat, text).unwrap_or_default());
    }
    // Who gives a posture has said how arms and legs are.
    if text.has_posture() {
        world.seeds.extend(pairs);
        return;
    }
    if text.seat.is_none() {
        pairs.extend(seeds.squat(world));
        pairs.extend(seeds.foot_on_step(text));
    }
    let carried = text.table.iter().chain(&text.counter).flat_map(|table| &table.carries);
    let carried = carried.chain(text.wall.iter().flat_map(|wall| &wall.carries));
    for part in carried.filter(|part| **part != CarriedText::Back) {
        pairs.extend(arm(&PALM_DOWN_DEG, part.segment_and_word().0));
    }
    pairs.extend(seeds.hands(world));
    world.seeds.extend(pairs);
}

/// Angles of one arm, rad.
fn arm<'a>(angles: &'a [(&str, f64)], segment: &str) -> impl Iterator<Item = (String, f64)> + use<'a> {
    let side = if segment.ends_with("_l") { "l" } else { "r" };
    angles.iter().map(move |(name, degrees)| (format!("{name}_{side}"), degrees.to_radians()))
}

impl World {
    /// Sets the seeds in the default posture of a body, inside its ranges.
    pub(in crate::scenario) fn seed(&self, model: &Model, start: &mut Posture) {
        for (name, value) in &self.seeds {
            if let Some(i) = model.coordinate(name) {
                let (low, high) = model.coordinates()[i].range;
                start.values_mut()[i] = value.max(low).min(high);
            }
        }
    }
}

/// Guesses by the sizes of the body in its default posture.
struct Seeder<'a> {
    model: &'a Model,
    kinematics: &'a Kinematics,
}

impl Seeder<'_> {
    fn joint(&self, name: &str) -> Option<Vector3<f64>> {
        Some(self.kinematics.placement(self.model, self.model.segment(name)?).translation.vector)
    }

    /// Middle of the patch of a segment, ground, m.
    fn patch(&self, name: &str) -> Option<Vector3<f64>> {
        let segment = self.model.segment(name)?;
        let patch = &self.model.segments()[segment].patch;
        let middle = patch.iter().sum::<Vector3<f64>>() / patch.len() as f64;
        (!patch.is_empty()).then(|| self.kinematics.station(self.model, segment, middle))
    }

    /// Hips and knees of a sitter, the height of the pelvis, and the arms of one with armrests.
    fn sitting(&self, seat: &SeatText, text: &ScenarioText) -> Option<Vec<(String, f64)>> {
        /// Thighs neither steeper than this (sine) nor more.
        const STEEPEST_THIGH: f64 = 0.95;
        let (hip, knee) = (self.joint("femur_r")?, self.joint("tibia_r")?);
        let (sole, buttock) = (self.patch("calcn_r")?.y, self.patch("pelvis")?);
        let recline = seat.backrest.then(|| seat.backrest_deg.unwrap_or(BACKREST_DEFAULT_DEG) - 90.0);
        let given = text.posture.get("pelvis_tilt_deg").copied();
        let tilt = given.or(recline).unwrap_or(0.0).clamp(-90.0, 90.0).to_radians();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), tilt);
        let origin = self.joint("pelvis")?;
        // Heights of pelvis and hip joint with the buttocks on the seat.
        let pelvis = seat.height_m - (turn * (buttock - origin)).y;
        let above = pelvis + (turn * (hip - origin)).y;
        let rise = libm::asin(((knee.y - sole - above) / (hip - knee).norm()).clamp(-STEEPEST_THIGH, STEEPEST_THIGH));
        let bent = std::f64::consts::FRAC_PI_2 + rise;
        let slide = self.model.coordinate("pelvis_ty")?;
        let height = self.model.coordinates()[slide].default + pelvis - origin.y;
        let mut pairs = vec![("pelvis_ty".to_owned(), height), ("pelvis_tilt".to_owned(), tilt)];
        for side in ["r", "l"] {
            pairs.push((format!("hip_flexion_{side}"), bent - tilt));
            pairs.push((format!("knee_angle_{side}"), bent));
        }
        if let (Some(armrests), Some(shoulder), Some(elbow)) =
            (seat.armrests_m, self.joint("humerus_r"), self.joint("ulna_r"))
        {
            // Upper arm forward until the elbow is at the armrests, forearm level.
            let drop = pelvis + shoulder.y - origin.y - armrests - forearm(self.model);
            let forward = libm::acos((drop / (shoulder - elbow).norm()).clamp(0.0, 1.0));
            for side in ["r", "l"] {
                pairs.push((format!("arm_flex_{side}"), forward));
                pairs.push((format!("elbow_flex_{side}"), std::f64::consts::FRAC_PI_2 - forward));
            }
        }
        Some(pairs)
    }

    /// The squat of a body whose hands are below the hips.
    fn squat(&self, world: &World) -> Vec<(String, f64)> {
        let (Some(hip), Some(sole)) = (self.joint("femur_r"), self.patch("calcn_r")) else { return vec![] };
        let lowest = targets(world).map(|(_, place)| place.y).fold(f64::INFINITY, f64::min);
        let height = hip.y - sole.y;
        let share = ((height - lowest) / (SQUAT_DEPTH * height)).clamp(0.0, 1.0);
        let bent = |(name, degrees): (&str, f64)| (name.to_owned(), share * degrees.to_radians());
        if share > 0.0 { SQUAT_DEG.into_iter().map(bent).collect() } else { vec![] }
    }

    /// The leg whose foot is on a step: hip and knee bent so that the foot, level and below the hip, is higher by the step.
    fn foot_on_step(&self, text: &ScenarioText) -> Vec<(String, f64)> {
        let (Some(hip), Some(knee)) = (self.joint("femur_r"), self.joint("tibia_r")) else { return vec![] };
        let thigh = (hip - knee).norm();
        let mut pairs = vec![];
        for step in &text.step {
            // The thigh forward, the shank upright: the hip is nearer to the foot by `thigh (1 - cos phi)`.
            let flexion = libm::acos((1.0 - step.height_m / thigh).clamp(-0.5, 1.0));
            let side = &step.under.segment()[5..];
            pairs.push((format!("hip_flexion{side}"), flexion));
            pairs.push((format!("knee_angle{side}"), flexion));
        }
        pairs
    }

    /// Arms of hands at work.
    fn hands(&self, world: &World) -> Vec<(String, f64)> {
        let Some(shoulder) = self.joint("humerus_r") else { return vec![] };
        let at_work = world.tasks.iter().flat_map(|task| &task.hands);
        let angles = |(hand, target): &(usize, HandTarget)| {
            let above = matches!(target, HandTarget::At(place) if place.y > shoulder.y);
            let angles: &[(&str, f64)] = if above { &HAND_ABOVE_DEG } else { &HAND_AHEAD_DEG };
            arm(angles, &self.model.segments()[*hand].name).collect::<Vec<_>>()
        };
        at_work.flat_map(angles).collect()
    }
}

/// Hands that must be at places of ground.
pub(super) fn targets(world: &World) -> impl Iterator<Item = (usize, Vector3<f64>)> {
    world.tasks.iter().flat_map(|task| &task.hands).filter_map(|(hand, target)| match target {
        HandTarget::At(place) => Some((*hand, *place)),
        HandTarget::Beside(_) => None,
    })
}
