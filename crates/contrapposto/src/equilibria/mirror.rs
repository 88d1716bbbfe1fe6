//! Computes the mirror image of a posture.
//!
//! Names tell left from right (`_r` and `_l`, `right` and `left`); the mirror plane is spanned by up and ahead, through the
//! ground's origin. The sign of a coordinate on the other side is found by moving the coordinate: a body has a mirror image only if
//! every segment, passive torque and strength agrees with that of its partner.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;

/// Largest difference between partners, m, and as a share of torques: rounding.
const SAME_SIDE: f64 = 1e-9;
/// Share of a coordinate's range (of 1 rad or m at most) by which it is moved.
const TRIAL_MOVE: f64 = 0.13;

/// Partners of all coordinates, and their signs.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    partners: Vec<(usize, f64)>,
    segments: Vec<usize>,
    across: Vector3<f64>,
}

impl Mirror {
    /// The mirror of a symmetric body; `None` for another one, or one with ball joints.
    pub fn of(model: &Model) -> Option<Self> {
        let coordinates = model.coordinates();
        if coordinates.iter().any(|coordinate| coordinate.rate.is_none()) {
            return None;
        }
        let segments: Option<Vec<usize>> =
            model.segments().iter().map(|segment| model.segment(&other_side(&segment.name))).collect();
        let mut mirror = Self { partners: vec![], segments: segments?, across: across(model) };
        for coordinate in coordinates {
            mirror.partners.push((model.coordinate(&other_side(&coordinate.name))?, 1.0));
        }
        let mut kinematics = [Kinematics::new(model), Kinematics::new(model)];
        for (i, coordinate) in coordinates.iter().enumerate() {
            let mut moved = model.default_posture();
            let (low, high) = coordinate.range;
            let far = TRIAL_MOVE * (high - low).min(1.0);
            moved.values_mut()[i] += if moved.values()[i] + far <= high { far } else { -far };
            let fits = |mirror: &mut Self, sign: f64, kinematics: &mut _| {
                mirror.partners[i].1 = sign;
                mirror.agrees(model, &moved, kinematics, Some(i))
            };
            if !fits(&mut mirror, 1.0, &mut kinematics) && !fits(&mut mirror, -1.0, &mut kinematics) {
                return None;
            }
        }
        // All coordinates at once, each by another share.
        let mut moved = model.default_posture();
        for (i, (value, coordinate)) in moved.values_mut().iter_mut().zip(coordinates).enumerate() {
            let share = 0.2 + 0.6 * ((i * 7) % 11) as f64 / 10.0;
            *value += share * TRIAL_MOVE * (coordinate.range.1 - coordinate.range.0).min(1.0);
        }
        moved.displace(model, &vec![0.0; model.rates().len()]);
        mirror.agrees(model, &moved, &mut kinematics, None).then_some(mirror)
    }

    /// The mirror image of a posture.
    pub fn posture(&self, posture: &Posture) -> Posture {
        let mut image = posture.clone();
        for (value, &(partner, sign)) in posture.values().iter().zip(&self.partners) {
            image.values_mut()[partner] = sign * value;
        }
        image
    }

    /// The partner of a coordinate, and +1 or -1: `q'_partner = sign q`.
    pub fn coordinate(&self, index: usize) -> (usize, f64) {
        self.partners[index]
    }

    /// The partner of a segment.
    pub fn segment(&self, index: usize) -> usize {
        self.segments[index]
    }

    /// The image of a point or force, ground axes.
    pub fn vector(&self, v: Vector3<f64>) -> Vector3<f64> {
        v - 2.0 * self.across.dot(&v) * self.across
    }

    /// Whether every segment of the image of `posture` is the mirror image of its partner. With `only`, other coordinates stay at
    /// their defaults, whatever their signs, and torques are not compared.
    fn agrees(&self, model: &Model, posture: &Posture, kinematics: &mut [Kinematics; 2], only: Option<usize>) -> bool {
        let mut image = model.default_posture();
        match only {
            Some(i) => image.values_mut()[self.partners[i].0] = self.partners[i].1 * posture.values()[i],
            None => image = self.posture(posture),
        }
        let mut both = kinematics.iter_mut().zip([posture, &image]);
        if !both.all(|(kinematics, posture)| kinematics.update(model, posture).is_ok()) {
            return false;
        }
        let [here, there] = kinematics;
        let agrees = |i: usize| {
            let (own, other) = (&model.segments()[i], &model.segments()[self.segments[i]]);
            let at = |k: &Kinematics, s: usize| {
                [k.placement(model, s).translation.vector, k.station(model, s, model.segments()[s].center_of_mass)]
            };
            (own.mass - other.mass).abs() <= SAME_SIDE * own.mass.max(1.0)
                && at(here, i)
                    .into_iter()
                    .zip(at(there, self.segments[i]))
                    .all(|(a, b)| (self.vector(a) - b).norm() <= SAME_SIDE * a.norm().max(1.0))
        };
        (0..model.segments().len()).all(agrees)
            && (only.is_some() || (0..self.partners.len()).all(|i| self.tissue_agrees(model, i, posture, &image)))
    }

    /// Whether passive torque and strength agree.
    fn tissue_agrees(&self, model: &Model, i: usize, posture: &Posture, image: &Posture) -> bool {
        let (partner, sign) = self.partners[i];
        let (own, other) = (&model.coordinates()[i], &model.coordinates()[partner]);
        let near = |a: f64, b: f64| (a - b).abs() <= SAME_SIDE * a.abs().max(1.0);
        let passive = match (&own.passive, &other.passive) {
            (Some(a), Some(b)) => near(sign * a.torque(i, posture.values()), b.torque(partner, image.values())),
            (a, b) => a.is_none() && b.is_none(),
        };
        let strength = match (&own.groups, &other.groups) {
            (Some(a), Some(b)) => (0..2).all(|side| {
                let turned = if sign < 0.0 { 1 - side } else { side };
                let at = |groups: &[crate::model::MuscleGroup; 2], side: usize, q: f64| groups[side].strength.torque(q);
                near(at(a, side, posture.values()[i]), at(b, turned, image.values()[partner]))
            }),
            (a, b) => a.is_none() && b.is_none(),
        };
        let ends = if sign < 0.0 { (-other.range.1, -other.range.0) } else { other.range };
        passive && strength && near(own.range.0, ends.0) && near(own.range.1, ends.1)
    }
}

/// The direction across the body: square to up (against gravity, or y) and to ahead (x, or z where x is upright).
fn across(model: &Model) -> Vector3<f64> {
    let up = (-model.gravity()).try_normalize(0.0).unwrap_or_else(Vector3::y);
    let x = if up.x.abs() > 0.9 { Vector3::z() } else { Vector3::x() };
    (x - up * up.dot(&x)).normalize().cross(&up)
}

/// The name with its side exchanged; the name itself where it names no side.
fn other_side(name: &str) -> String {
    for (one, other) in [("_r", "_l"), ("_l", "_r")] {
        if let Some(stem) = name.strip_suffix(one) {
            return format!("{stem}{other}");
        }
    }
    for (one, other) in [("right", "left"), ("left", "right"), ("Right", "Left"), ("Left", "Right")] {
        if name.contains(one) {
            return name.replacen(one, other, 1);
        }
    }
    for (one, other) in [("r_", "l_"), ("l_", "r_")] {
        if let Some(stem) = name.strip_prefix(one) {
            return format!("{other}{stem}");
        }
    }
    name.to_owned()
}
