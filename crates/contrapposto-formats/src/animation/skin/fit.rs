//! Fits the baked mesh to the joint centres of an adult: every bone has a map that carries its landmarks to the joint centres in the
//! T-pose, turns it there and stretches it, and a vertex goes where its weights say between these maps.

use contrapposto::model::{Adult, Model, Placement, Sex};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::super::solid::WATER;
use super::asset::{Asset, Middle, Place};

/// Thinnest and stoutest shape; the baked ones are -1 and 1.
const THINNEST_SHAPE: f64 = -1.5;
const STOUTEST_SHAPE: f64 = 4.0;
const HALVINGS: usize = 24;

/// Places of the source that the baked landmarks do not have, as shares of its stature: the joint between neck and trunk (C7), and of
/// the way from hips to it those of the trunk.
const NECK_HEIGHT: f64 = 0.864;
const BACK: f64 = 0.268;
const CHEST: f64 = 0.614;
/// Half the distance of the hips and of the shoulders of the built-in adult, as shares of stature (`data/adult.toml`).
const HALF_HIPS: f64 = 0.0464;
const HALF_SHOULDERS: f64 = 0.129;

/// Share of the way from the source's shoulder to the adult's at which the arm turns.
const TOWARDS_ACROMION: f64 = 0.65;

/// A map from the source to the T-pose.
#[derive(Clone, Copy)]
struct Map {
    from: Vector3<f64>,
    linear: Matrix3<f64>,
    to: Vector3<f64>,
}

/// The source and the T-pose between which bones are mapped.
struct Fit<'a> {
    asset: &'a Asset,
    model: &'a Model,
    rest: &'a [Placement],
    male: bool,
    /// Stature of the adult over that of the source.
    scale: f64,
    source_stature: f64,
}

/// Vertices in the T-pose, m, ground axes: of the adult's sex, as stout as its mass asks, as near as shapes allow.
pub(super) fn fitted(asset: &Asset, model: &Model, adult: &Adult, rest: &[Placement]) -> Option<Vec<Vector3<f64>>> {
    let male = adult.sex == Sex::Male;
    let source_stature = asset.middle(male, Middle::Top).y - asset.middle(male, Middle::Sole).y;
    let scale = adult.stature / source_stature;
    let maps = Fit { asset, model, rest, male, scale, source_stature }.maps()?;
    let at = |mass: f64| mapped(asset, &maps, &asset.vertices(male, mass));
    let (mut thin, mut stout) = (THINNEST_SHAPE, STOUTEST_SHAPE);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (thin + stout);
        if volume(&at(middle), &asset.quads) * WATER < adult.mass { thin = middle } else { stout = middle }
    }
    Some(at(0.5 * (thin + stout)))
}

fn mapped(asset: &Asset, maps: &[Map], vertices: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let weighted = |((vertex, bones), weights): ((&Vector3<f64>, &[u8; 4]), &[u8; 4])| {
        let parts = bones.iter().zip(weights).filter(|(_, weight)| **weight > 0);
        parts.map(|(&bone, &weight)| f64::from(weight) / 255.0 * maps[usize::from(bone)].apply(vertex)).sum()
    };
    vertices.iter().zip(&asset.bones).zip(&asset.weights).map(weighted).collect()
}

/// Volume within closed quads, m3.
pub(super) fn volume(vertices: &[Vector3<f64>], quads: &[[u16; 4]]) -> f64 {
    let at = |i: u16| vertices[usize::from(i)];
    let six = |q: &[u16; 4]| {
        let [a, b, c, d] = q.map(at);
        a.dot(&b.cross(&c)) + a.dot(&c.cross(&d))
    };
    quads.iter().map(six).sum::<f64>() / 6.0
}

impl Map {
    fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.to + self.linear * (point - self.from)
    }

    /// The map that turns half as far as a limb's from none or from another limb's, about the joint between them.
    fn half(&self, before: &Turned, own: &Turned) -> Self {
        let turn = before.turn().slerp(&own.turn(), 0.5);
        let linear = turn.to_rotation_matrix() * own.source * own.stretch() * own.source.inverse();
        Self { linear, ..*self }
    }
}

/// Axes of a limb before and after its map, and its stretch along these.
#[derive(Clone, Copy)]
struct Turned {
    source: Rotation3<f64>,
    target: Rotation3<f64>,
    stretch: Vector3<f64>,
}

impl Turned {
    fn turn(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&(self.target * self.source.inverse()))
    }

    fn stretch(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.stretch)
    }

    fn linear(&self) -> Matrix3<f64> {
        self.target * self.stretch() * self.source.inverse()
    }

    fn map(&self, from: Vector3<f64>, to: Vector3<f64>) -> Map {
        Map { from, linear: self.linear(), to }
    }
}

/// Axes with y up a limb and z as near to `right` as that allows.
fn limb_axes(up: Vector3<f64>, right: Vector3<f64>) -> Rotation3<f64> {
    let y = up.normalize();
    let z = (right - y * y.dot(&right)).normalize();
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[y.cross(&z), y, z]))
}

impl Fit<'_> {
    /// One map a bone, in the order of the baked file.
    fn maps(&self) -> Option<Vec<Map>> {
        let mut maps = self.trunk()?;
        for left in [false, true] {
            maps.extend(self.arm(left, &maps[2])?);
            maps.extend(self.leg(left)?);
        }
        Some(maps)
    }

    /// Centre of a segment's joint and direction of its axes in the T-pose.
    fn joint(&self, name: &str, left: bool) -> Option<(Vector3<f64>, Rotation3<f64>)> {
        let name = name.replace('*', if left { "_l" } else { "_r" });
        let rest = &self.rest[self.model.segment(&name)?];
        Some((rest.translation.vector, rest.rotation.to_rotation_matrix()))
    }

    fn mark(&self, left: bool, place: Place) -> Vector3<f64> {
        self.asset.side(self.male, left, place)
    }

    /// A landmark moved sideways so that it is `half` of the source's stature from the middle.
    fn aside(&self, left: bool, place: Place, half: f64) -> Vector3<f64> {
        let mark = self.mark(left, place);
        Vector3::new(mark.x, mark.y, mark.z.signum() * half * self.source_stature)
    }

    fn hip(&self, left: bool) -> Vector3<f64> {
        self.aside(left, Place::Hip, HALF_HIPS)
    }

    /// Height of the joint between neck and trunk, and of the one below the chest.
    fn neck_and_chest(&self) -> [f64; 2] {
        let neck = self.asset.middle(self.male, Middle::Sole).y + NECK_HEIGHT * self.source_stature;
        let hips = self.hip(false).y;
        [neck, hips + CHEST * (neck - hips)]
    }

    /// Between the source's shoulder and the place of the adult's, which is wider and higher, as that of the acromion is.
    fn shoulder(&self, left: bool) -> Option<Vector3<f64>> {
        let own = self.mark(left, Place::Shoulder);
        let height = |name: &str| self.joint(name, left).map(|joint| joint.0.y);
        let [neck, chest] = self.neck_and_chest();
        let (to_neck, to_chest) = (height("head")?, height("torso")?);
        let level = chest + (height("humerus*")? - to_chest) / (to_neck - to_chest) * (neck - chest);
        let aside = self.aside(left, Place::Shoulder, HALF_SHOULDERS);
        let towards = Vector3::new(own.x, level, aside.z);
        Some(own + TOWARDS_ACROMION * (towards - own))
    }

    /// Pelvis, abdomen, torso, neck, head: upright, from joint to joint.
    fn trunk(&self) -> Option<Vec<Map>> {
        let (hips, shoulders) = (self.hip(false), self.shoulder(false)?);
        let [neck_height, _] = self.neck_and_chest();
        let at = |share: f64| {
            let y = hips.y + share * (neck_height - hips.y);
            Vector3::new(hips.x + (shoulders.x - hips.x) * (y - hips.y) / (shoulders.y - hips.y), y, 0.0)
        };
        let place = |name: &str| self.joint(name, false).map(|joint| joint.0);
        let sources = [at(0.0), at(BACK), at(CHEST), at(1.0)];
        let targets = [place("pelvis")?, place("abdomen")?, place("torso")?, place("head")?];
        let wide = (place("humerus_r")? - place("torso")?).z / shoulders.z;
        let k = self.scale;
        let piece = |i: usize, across: f64| {
            let (from, to) = (sources[i], targets[i]);
            // A sheared column: the line of the source's joints becomes upright.
            let up = (targets[i + 1] - to).y / (sources[i + 1] - from).y;
            let lean = (sources[i + 1] - from).x / (sources[i + 1] - from).y;
            let linear = Matrix3::new(k, -k * lean, 0.0, 0.0, up, 0.0, 0.0, 0.0, across);
            Map { from, linear, to }
        };
        let head = Map { from: sources[3], linear: Matrix3::from_diagonal_element(k), to: targets[3] };
        Some(vec![piece(0, k), piece(1, k), piece(2, wide), head, head])
    }

    /// Clavicle to hand. The source's arm hangs half-way, bent, with a turned forearm.
    fn arm(&self, left: bool, torso: &Map) -> Option<Vec<Map>> {
        let mark = |place| self.mark(left, place);
        let (shoulder, elbow, wrist) = (self.shoulder(left)?, mark(Place::Elbow), mark(Place::Wrist));
        let [upper, lower, hand] = [elbow - shoulder, wrist - elbow, mark(Place::MiddleFinger) - wrist];
        let (to_shoulder, upper_target) = self.joint("humerus*", left)?;
        let (to_elbow, lower_target) = self.joint("ulna*", left)?;
        let (_, turned_target) = self.joint("radius*", left)?;
        let (to_wrist, hand_target) = self.joint("hand*", left)?;
        let k = self.scale;
        let along = |target: Vector3<f64>, source: Vector3<f64>| Vector3::new(k, target.norm() / source.norm(), k);
        // The elbow bends about z, so its axis is square to both.
        let bend = upper.cross(&lower);
        let thumb = mark(Place::Index) - mark(Place::Little);
        let of_thumb = |up: Vector3<f64>| limb_axes(up, thumb.cross(&up));
        let upper = Turned {
            source: limb_axes(-upper, bend),
            target: upper_target,
            stretch: along(to_elbow - to_shoulder, upper),
        };
        let stretch = along(to_wrist - to_elbow, lower);
        let elbow_end = Turned { source: limb_axes(-lower, bend), target: lower_target, stretch };
        let wrist_end = Turned { source: of_thumb(-lower), target: turned_target, stretch };
        let palm = Turned { source: of_thumb(-hand), target: hand_target, stretch: Vector3::from_element(k) };
        let clavicle = Map { from: shoulder, linear: torso.linear, to: to_shoulder };
        let still =
            Turned { source: Rotation3::identity(), target: Rotation3::identity(), stretch: Vector3::from_element(k) };
        let arm = upper.map(shoulder, to_shoulder);
        let forearm = |share: f64| {
            let turn = elbow_end.source.slerp(&wrist_end.source, share);
            Turned { source: turn, ..elbow_end }.map(elbow, to_elbow)
        };
        let half_shoulder = arm.half(&still, &upper);
        let half_elbow = forearm(0.0).half(&upper, &elbow_end);
        let third = 1.0 / 3.0;
        let forearms = [0.0, third, 2.0 * third, 1.0].map(forearm);
        let mut maps = vec![clavicle, half_shoulder, arm, arm, arm, half_elbow];
        maps.extend(forearms);
        maps.push(palm.map(wrist, to_wrist));
        Some(maps)
    }

    /// Hip to toes. The source stands with its legs apart.
    fn leg(&self, left: bool) -> Option<Vec<Map>> {
        let mark = |place| self.mark(left, place);
        let (hip, knee, ankle) = (self.hip(left), mark(Place::Knee), mark(Place::Ankle));
        let (to_hip, thigh_target) = self.joint("femur*", left)?;
        let (to_knee, shank_target) = self.joint("tibia*", left)?;
        let (to_ankle, foot_target) = self.joint("talus*", left)?;
        let (to_ball, _) = self.joint("toes*", left)?;
        let k = self.scale;
        let limb = |from: Vector3<f64>, end: Vector3<f64>, length: f64, target: Rotation3<f64>| Turned {
            source: limb_axes(from - end, Vector3::z()),
            target,
            stretch: Vector3::new(k, length / (end - from).norm(), k),
        };
        let thigh = limb(hip, knee, (to_knee - to_hip).norm(), thigh_target);
        let shank = limb(knee, ankle, (to_ankle - to_knee).norm(), shank_target);
        let sole = self.asset.middle(self.male, Middle::Sole).y;
        // The joint of the toes lies in the sole.
        let ball = Vector3::new(mark(Place::Ball).x, sole, mark(Place::Ball).z);
        let ahead = Vector3::new(ball.x - ankle.x, 0.0, ball.z - ankle.z);
        let foot = Turned {
            source: limb_axes(Vector3::y(), ahead.cross(&Vector3::y())),
            target: foot_target,
            stretch: Vector3::new((to_ball - to_ankle).x / ahead.norm(), (to_ankle - to_ball).y / (ankle.y - sole), k),
        };
        let still =
            Turned { source: Rotation3::identity(), target: Rotation3::identity(), stretch: Vector3::from_element(k) };
        let (upper, lower) = (thigh.map(hip, to_hip), shank.map(knee, to_knee));
        let half_hip = upper.half(&still, &thigh);
        let half_knee = lower.half(&thigh, &shank);
        Some(vec![half_hip, upper, upper, half_knee, lower, foot.map(ankle, to_ankle), foot.map(ball, to_ball)])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use contrapposto::model::adult;

    use super::super::{Skeleton, asset};
    use super::*;

    #[test]
    fn the_map_of_the_torso_carries_the_shoulders_as_far_aside_as_those_of_the_adult_are() {
        let asset = Asset::read(asset::BYTES).unwrap();
        for (sex, stature, mass) in [(Sex::Female, 1.5, 45.0), (Sex::Male, 1.741, 73.0), (Sex::Male, 1.95, 110.0)] {
            let size = Adult { sex, stature, mass, ..Adult::default() };
            let (model, male) = (adult(&size).unwrap(), sex == Sex::Male);
            let skeleton = Skeleton::of(&model).unwrap();
            let source_stature = asset.middle(male, Middle::Top).y - asset.middle(male, Middle::Sole).y;
            let scale = stature / source_stature;
            let fit = Fit { asset: &asset, model: &model, rest: &skeleton.rest, male, scale, source_stature };
            let torso = fit.maps().unwrap()[2];
            for (left, name) in [(false, "humerus_r"), (true, "humerus_l")] {
                let joint = skeleton.rest[model.segment(name).unwrap()].translation.vector;
                let shoulder = torso.apply(&fit.shoulder(left).unwrap());
                assert!((shoulder.z - joint.z).abs() < 2e-3, "{name} of {stature} m: {} {}", shoulder.z, joint.z);
            }
        }
    }
}
