//! Finds supports of a recorded motion that do not touch the ground: above another support, or tilted.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use nalgebra::Vector3;

/// A support counts as in the air from this height above the lowest one on, m. Assumed: twice what skin, shoe and markers move.
const IN_THE_AIR: f64 = 0.03;
/// A patch counts as tilted from this angle on, rad (10 degrees). Assumed likewise.
const TILTED: f64 = 0.174_533;

/// The greatest of a quantity over a motion.
#[derive(Clone, Copy, Default)]
struct Greatest {
    value: f64,
    time: f64,
    /// Frames in which it exceeds its limit.
    frames: usize,
}

impl Greatest {
    fn take(&mut self, time: f64, value: f64, limit: f64) {
        self.frames += usize::from(value > limit);
        if value > self.value {
            (self.value, self.time) = (value, time);
        }
    }
}

/// A warning for each support that is in the air or tilted at some time: `assess` judges it as lying on the ground.
pub(super) fn support_doubts(model: &Model, motion: &[(f64, Posture)], supports: &[Support]) -> Vec<String> {
    let mut kinematics = Kinematics::new(model);
    let mut heights = vec![Greatest::default(); supports.len()];
    let mut tilts = heights.clone();
    for (time, posture) in motion {
        if kinematics.update(model, posture).is_err() {
            continue;
        }
        let corners: Vec<Vec<Vector3<f64>>> = supports
            .iter()
            .map(|support| support.corners.iter().map(|c| kinematics.station(model, support.segment, *c)).collect())
            .collect();
        let lowest: Vec<f64> =
            corners.iter().zip(supports).map(|(corners, support)| height(corners, &support.normal)).collect();
        let ground = lowest.iter().copied().fold(f64::INFINITY, f64::min);
        for (i, support) in supports.iter().enumerate() {
            heights[i].take(*time, lowest[i] - ground, IN_THE_AIR);
            tilts[i].take(*time, tilt(&corners[i], &support.normal), TILTED);
        }
    }
    let share = |greatest: &Greatest| 100.0 * greatest.frames as f64 / motion.len().max(1) as f64;
    let mut warnings = vec![];
    for (i, support) in supports.iter().enumerate() {
        let name = &model.segments()[support.segment].name;
        let (height, tilt) = (&heights[i], &tilts[i]);
        if height.frames > 0 {
            warnings.push(format!(
                "support `{name}` is {:.1} cm above the lowest support at {} s, and above {:.0} cm in {:.0} % of the time, yet it \
                 carries the body there as if it stood on the ground: name in --support only what touches it, or give --grf",
                100.0 * height.value,
                height.time,
                100.0 * IN_THE_AIR,
                share(height)
            ));
        }
        if tilt.frames > 0 {
            warnings.push(format!(
                "the patch of support `{name}` is tilted by {:.0} deg at {} s, and by more than {:.0} deg in {:.0} % of the time, yet \
                 it carries the body as if it lay flat on the ground",
                tilt.value.to_degrees(),
                tilt.time,
                TILTED.to_degrees(),
                share(tilt)
            ));
        }
    }
    warnings
}

/// Height of the lowest corner along the normal of the ground, m.
fn height(corners: &[Vector3<f64>], up: &Vector3<f64>) -> f64 {
    corners.iter().map(|corner| corner.dot(up)).fold(f64::INFINITY, f64::min)
}

/// Angle between a patch and the ground, rad, 0..=pi/2; 0 of a patch without an area.
fn tilt(corners: &[Vector3<f64>], up: &Vector3<f64>) -> f64 {
    let [first, rest @ ..] = corners else { return 0.0 };
    let pairs = rest.windows(2).map(|pair| (pair[0] - first).cross(&(pair[1] - first)));
    let normal = pairs.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).and_then(|n| n.try_normalize(1e-9));
    normal.map_or(0.0, |normal| libm::acos(normal.dot(up).abs().min(1.0)))
}
