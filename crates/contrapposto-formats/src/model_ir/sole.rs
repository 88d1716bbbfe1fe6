//! Finds the soles of segments: the lowest corners of their shapes for contact in the default posture.
//!
//! A corner belongs to the sole if it lies no more than 2 mm above the lowest one (assumed: a flat sole, as files round it). Of more than
//! 32 corners those that lie farthest in 32 directions of the ground are kept, so that the patch lies inside the shape.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use nalgebra::{Unit, Vector3};
use std::f64::consts::TAU;

use super::{SolidIr, SolidShape};

/// Corners higher than this above the lowest one are no part of the sole, m.
const SOLE_DEPTH: f64 = 0.002;
/// Most corners of a sole, and the directions in which they lie farthest.
const SOLE_CORNERS: usize = 32;
/// Corners of a round edge, inside of it.
const RIM_CORNERS: usize = 16;
/// Corners nearer to each other than this are one, m.
const SAME_PLACE: f64 = 1e-9;

/// The model with the soles of its segments; without gravity there is no lowest place.
pub(super) fn with_soles(mut model: Model, solids: &[SolidIr]) -> Model {
    let Some(down) = Unit::try_new(model.gravity(), 1e-9) else { return model };
    let mut kinematics = Kinematics::new(&model);
    if solids.is_empty() || kinematics.update(&model, &model.default_posture()).is_err() {
        return model;
    }
    let mut by_segment: Vec<Vec<&SolidIr>> = vec![vec![]; model.segments().len()];
    solids.iter().for_each(|solid| by_segment[solid.segment].push(solid));
    for (segment, solids) in by_segment.into_iter().enumerate().filter(|(_, solids)| !solids.is_empty()) {
        let down = kinematics.placement(&model, segment).rotation.inverse() * down;
        let corners: Vec<Vector3<f64>> = solids.into_iter().flat_map(|solid| lowest(solid, &down)).collect();
        let corners = sole(corners, &down);
        if !corners.is_empty() {
            model = model.with_patch(segment, corners);
        }
    }
    model
}

/// Corners of a solid that may be its lowest, in the segment's frame.
fn lowest(solid: &SolidIr, down: &Unit<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let own = solid.pose.rotation.inverse() * down.into_inner();
    let points = match solid.shape {
        SolidShape::Box([a, b, c]) => {
            let signs = (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { 1.0 } else { -1.0 }));
            signs.map(|[x, y, z]| Vector3::new(a * x, b * y, c * z)).collect()
        }
        SolidShape::Ellipsoid(axes) => {
            let scaled = own.component_mul(&Vector3::from(axes));
            vec![scaled.component_mul(&Vector3::from(axes)) / scaled.norm().max(f64::MIN_POSITIVE)]
        }
        SolidShape::Capsule { radius, half } => {
            [half, -half].map(|end| Vector3::new(0.0, 0.0, end) + own * radius).to_vec()
        }
        SolidShape::Cylinder { radius, half } => {
            // The lowest place of a rim, or around the whole rim where the cylinder stands upright.
            let lowest = libm::atan2(own.y, own.x);
            let angles = (0..RIM_CORNERS).map(move |i| lowest + TAU * i as f64 / RIM_CORNERS as f64);
            let rim = angles.map(|angle| Vector3::new(radius * libm::cos(angle), radius * libm::sin(angle), 0.0));
            rim.flat_map(|point| [half, -half].map(|end| point + Vector3::new(0.0, 0.0, end))).collect()
        }
    };
    points.into_iter().map(|point| (solid.pose * nalgebra::Point3::from(point)).coords).collect()
}

/// The lowest corners along `down`, at most [`SOLE_CORNERS`].
fn sole(mut corners: Vec<Vector3<f64>>, down: &Unit<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let depth = |corner: &Vector3<f64>| corner.dot(down);
    corners.retain(|corner| corner.iter().all(|x| x.abs() <= LARGEST));
    let deepest = corners.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
    corners.retain(|corner| depth(corner) >= deepest - SOLE_DEPTH);
    // One more is enough to know that there are too many.
    let few = distinct(&corners, SOLE_CORNERS + 1);
    if few.len() <= SOLE_CORNERS {
        return few;
    }
    let right = down.cross(&Vector3::ith(down.iamin(), 1.0)).normalize();
    let ahead = down.cross(&right);
    let mut farthest = vec![];
    for i in 0..SOLE_CORNERS {
        let angle = TAU * i as f64 / SOLE_CORNERS as f64;
        let direction = libm::cos(angle) * right + libm::sin(angle) * ahead;
        let along = |place: usize| corners[place].dot(&direction);
        farthest.extend((0..corners.len()).max_by(|&a, &b| along(a).total_cmp(&along(b))));
    }
    farthest.sort_unstable();
    let farthest: Vec<Vector3<f64>> = farthest.into_iter().map(|place| corners[place]).collect();
    distinct(&farthest, SOLE_CORNERS)
}

/// The first `most` different corners.
fn distinct(corners: &[Vector3<f64>], most: usize) -> Vec<Vector3<f64>> {
    let mut kept: Vec<Vector3<f64>> = vec![];
    for corner in corners {
        if kept.len() < most && kept.iter().all(|other| (other - corner).norm() > SAME_PLACE) {
            kept.push(*corner);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a fine grid of corners, some above the sole, those on the edge of its disc are kept, 32 at most, in the order of the file.
    #[test]
    fn of_many_corners_the_farthest_ones_are_kept() {
        let down = Unit::new_normalize(Vector3::new(0.0, -1.0, 0.0));
        let places = (-20..=20).flat_map(|x| (-20..=20).map(move |z| (f64::from(x), f64::from(z))));
        let disc = places.filter(|(x, z)| x * x + z * z <= 400.0);
        let corners: Vec<Vector3<f64>> =
            disc.flat_map(|(x, z)| [0.0, 0.0015, 0.01].map(|y| Vector3::new(0.01 * x, y, 0.01 * z))).collect();
        let kept = sole(corners.clone(), &down);
        assert!(kept.len() > 8 && kept.len() <= SOLE_CORNERS, "{}", kept.len());
        for direction in (0..SOLE_CORNERS).map(|i| TAU * i as f64 / SOLE_CORNERS as f64) {
            let along = |corner: &Vector3<f64>| corner.x * libm::cos(direction) + corner.z * libm::sin(direction);
            let farthest = |corners: &[Vector3<f64>]| corners.iter().map(along).fold(0.0, f64::max);
            assert!(farthest(&kept) > 0.98 * farthest(&corners), "{direction} rad");
        }
        let place = |corner: &Vector3<f64>| corners.iter().position(|other| other == corner).unwrap();
        assert!(kept.iter().all(|corner| corner.y < SOLE_DEPTH) && kept.is_sorted_by_key(place));
    }

    #[test]
    fn few_corners_are_all_kept_and_equal_ones_once() {
        let down = Unit::new_normalize(Vector3::new(0.0, -1.0, 0.0));
        let corners = vec![Vector3::x(), Vector3::z(), Vector3::x(), Vector3::y()];
        assert_eq!(sole(corners, &down), [Vector3::x(), Vector3::z()]);
    }
}
