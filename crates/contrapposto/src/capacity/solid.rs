//! Computes the solid of all forces in 642 directions, and its weakest and strongest direction.
//!
//! The directions are the corners of an icosahedron whose faces are divided three times into four; they include the ground axes, and are
//! mirror images of themselves by each of them. A sweep from neighbour to neighbour keeps the basis of the linear program.
//! The weakest direction is sought further along the normal of the nearest plane, until that plane's nearest point can be reached; the
//! strongest by smaller and smaller steps around the best of all directions.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::tolerances::{STRONGEST_STEPS, WEAKER, WEAKEST_ROUNDS};
use super::{Capacity, GreatestForce};

/// Number of times that faces are divided.
const DIVISIONS: usize = 3;
/// Bands of height of a sweep.
const BANDS: f64 = 16.0;

/// The forces that can be exerted.
#[derive(Clone, Debug)]
pub struct Solid {
    /// The greatest force in every direction of [`directions`].
    pub forces: Vec<GreatestForce>,
    /// Triangles of directions, by index, seen counterclockwise from outside.
    pub faces: Vec<[usize; 3]>,
    /// The weakest direction of all that were found.
    pub weakest: GreatestForce,
    /// The strongest direction of all that were found.
    pub strongest: GreatestForce,
}

impl Capacity {
    /// The forces in 642 directions.
    pub fn solid(&mut self) -> Solid {
        let (directions, faces) = directions();
        let mut forces: Vec<Option<GreatestForce>> = vec![None; directions.len()];
        for place in sweep(&directions) {
            forces[place] = Some(self.in_direction(&directions[place]));
        }
        let forces: Vec<GreatestForce> = forces.into_iter().flatten().collect();
        let weakest = self.weakest(&forces);
        let strongest = self.strongest(&forces);
        Solid { forces, faces, weakest, strongest }
    }

    /// Along the normals of nearest planes.
    fn weakest(&mut self, forces: &[GreatestForce]) -> GreatestForce {
        let distance = |greatest: &GreatestForce| greatest.force / greatest.normal.norm();
        let least = |a: &&GreatestForce, b: &&GreatestForce| distance(a).total_cmp(&distance(b));
        let limited = || forces.iter().filter(|greatest| greatest.force.is_finite());
        let weakest = |a: &&GreatestForce, b: &&GreatestForce| a.force.total_cmp(&b.force);
        let mut best = forces.iter().min_by(weakest).cloned().unwrap_or_else(|| self.in_direction(&Vector3::x()));
        let mut next = limited().min_by(least).map(|greatest| greatest.normal);
        for _ in 0..WEAKEST_ROUNDS {
            let Some(normal) = next.filter(|normal| *normal != Vector3::zeros()) else { break };
            let found = self.in_direction(&normal);
            let weaker = found.force < best.force * (1.0 - WEAKER);
            next = weaker.then_some(found.normal);
            if weaker {
                best = found;
            }
        }
        best
    }

    /// Around the strongest of all directions.
    fn strongest(&mut self, forces: &[GreatestForce]) -> GreatestForce {
        let strongest = forces.iter().max_by(|a, b| a.force.total_cmp(&b.force)).cloned();
        let mut best = strongest.unwrap_or_else(|| self.in_direction(&Vector3::x()));
        let mut step = STRONGEST_STEPS.0;
        while step > STRONGEST_STEPS.1 && best.force.is_finite() {
            let across = best.direction.cross(&Vector3::ith(best.direction.iamin(), 1.0)).normalize();
            let other = best.direction.cross(&across);
            let mut found = best.clone();
            for (a, b) in
                [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7)]
            {
                let near = self.in_direction(&(best.direction + step * (a * across + b * other)));
                if near.force > found.force {
                    found = near;
                }
            }
            if found.force > best.force {
                best = found;
            } else {
                step *= 0.5;
            }
        }
        best
    }
}

/// Unit vectors and the triangles between them.
pub fn directions() -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let golden = f64::midpoint(1.0, 5f64.sqrt());
    let mut points = vec![];
    for k in 0..3 {
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut point = Vector3::zeros();
            point[k] = a;
            point[(k + 1) % 3] = b * golden;
            points.push(point.normalize());
        }
    }
    let mut faces = faces_of(&points);
    for _ in 0..DIVISIONS {
        faces = divided(&mut points, &faces);
    }
    (points, faces)
}

/// The twenty triangles of nearest corners, seen counterclockwise from outside.
fn faces_of(points: &[Vector3<f64>]) -> Vec<[usize; 3]> {
    let edge = (points[0] - points[1]).norm().min((points[0] - points[2]).norm()) * 1.01;
    let near = |a: usize, b: usize| (points[a] - points[b]).norm() < edge;
    let mut faces = vec![];
    for a in 0..points.len() {
        for b in (a + 1..points.len()).filter(|&b| near(a, b)) {
            for c in (b + 1..points.len()).filter(|&c| near(a, c) && near(b, c)) {
                let outward = (points[b] - points[a]).cross(&(points[c] - points[a])).dot(&points[a]) > 0.0;
                faces.push(if outward { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    faces
}

/// Every triangle in four, with the middles of its edges.
fn divided(points: &mut Vec<Vector3<f64>>, faces: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut middles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut middle = |a: usize, b: usize| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a] + points[b]).normalize());
            points.len() - 1
        })
    };
    let mut smaller = vec![];
    for &[a, b, c] in faces {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        smaller.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    smaller
}

/// The order of a sweep: bands of height, each around the vertical, every second one the other way round.
fn sweep(directions: &[Vector3<f64>]) -> Vec<usize> {
    let key = |direction: &Vector3<f64>| {
        let band = ((direction.y + 1.0) / 2.0 * BANDS).floor();
        let turn = libm::atan2(direction.x, direction.z);
        (band, if band % 2.0 == 0.0 { turn } else { -turn })
    };
    let mut order: Vec<usize> = (0..directions.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (key(&directions[a]), key(&directions[b]));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours are 0.14 rad apart.
    #[test]
    fn a_sweep_goes_through_all_directions_from_neighbour_to_neighbour() {
        let (directions, _) = directions();
        let order = sweep(&directions);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..directions.len()));
        let steps: Vec<f64> = order.windows(2).map(|pair| directions[pair[0]].angle(&directions[pair[1]])).collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        println!("steps of {mean:.3} rad on average, {:.3} at most", steps.iter().copied().fold(0.0, f64::max));
        assert!(mean < 0.2, "{mean}");
    }
}
