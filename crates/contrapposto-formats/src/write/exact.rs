//! Writes numbers that read back as the same bits.
//!
//! Readers compute: degrees become radians, angles a quaternion, a vector one of unit length. Each search here tries the
//! obvious number, its short decimal forms and its neighbours, and takes the first that the reader's own arithmetic turns into
//! the wanted bits. Values that came from a file have such a number; where there is none the nearest one is taken, which differs by
//! rounding only.

use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};

/// Neighbours that are tried on each side.
const NEIGHBOURS: i64 = 4;

/// Short forms first, then the number itself and its neighbours.
fn candidates(x: f64) -> Vec<f64> {
    let mut list: Vec<f64> = vec![];
    let mut add = |value: f64| {
        if value.is_finite() && !list.iter().any(|v| v.to_bits() == value.to_bits()) {
            list.push(value);
        }
    };
    if x.abs() < 1e-15 {
        add(0.0);
    }
    for digits in 11..=15 {
        add(format!("{x:.digits$e}").parse().unwrap_or(x));
    }
    add(x);
    for step in 1..=NEIGHBOURS {
        for bits in [x.to_bits().wrapping_add_signed(step), x.to_bits().wrapping_add_signed(-step)] {
            let near = f64::from_bits(bits);
            if (near - x).abs() <= 1e-14 * x.abs() {
                add(near);
            }
        }
    }
    list
}

/// A number near `x` that `fits`, or `x`.
pub(super) fn near(x: f64, fits: impl Fn(f64) -> bool) -> f64 {
    candidates(x).into_iter().find(|&c| fits(c)).unwrap_or(x)
}

/// Body-fixed x, y, z angles of a rotation.
fn body_angles(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let m = rotation.matrix();
    let a = if m[(1, 2)] == 0.0 && m[(2, 2)] == 0.0 { 0.0 } else { libm::atan2(-m[(1, 2)], m[(2, 2)]) };
    // What is left are turns about y and z: well conditioned also where y is a right angle.
    let rest = Rotation3::from_axis_angle(&Vector3::x_axis(), -a) * rotation;
    let r = rest.matrix();
    Vector3::new(a, libm::atan2(r[(0, 2)], r[(2, 2)]), libm::atan2(r[(1, 0)], r[(1, 1)]))
}

/// Body-fixed x, y, z angles, as OpenSim's frames have them.
pub(super) fn xyz(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
    let start = body_angles(&rotation.to_rotation_matrix());
    angles(rotation, start, |[x, y, z]| {
        let matrix = turn(Vector3::x_axis(), x) * turn(Vector3::y_axis(), y) * turn(Vector3::z_axis(), z);
        UnitQuaternion::from_rotation_matrix(&matrix)
    })
}

/// Roll, pitch and yaw, as URDF's origins have them.
pub(super) fn rpy(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let start = -body_angles(&rotation.inverse().to_rotation_matrix());
    angles(rotation, start, |[r, p, y]| UnitQuaternion::from_euler_angles(r, p, y))
}

fn angles(
    wanted: &UnitQuaternion<f64>,
    start: Vector3<f64>,
    read: impl Fn([f64; 3]) -> UnitQuaternion<f64>,
) -> [f64; 3] {
    if *wanted == UnitQuaternion::identity() {
        return [0.0; 3];
    }
    let (xs, ys, zs) = (candidates(start.x), candidates(start.y), candidates(start.z));
    let distance = |found: &UnitQuaternion<f64>| {
        let (minus, plus) = (found.coords - wanted.coords, found.coords + wanted.coords);
        minus.norm_squared().min(plus.norm_squared())
    };
    let mut best = (f64::INFINITY, start.into());
    for &x in &xs {
        for &y in &ys {
            for &z in &zs {
                let found = read([x, y, z]);
                if same(found.coords.as_slice(), wanted.coords.as_slice()) {
                    return [x, y, z];
                }
                let far = distance(&found);
                if far < best.0 {
                    best = (far, [x, y, z]);
                }
            }
        }
    }
    best.1
}

/// Equal, zeros of either sign alike.
fn same(a: &[f64], b: &[f64]) -> bool {
    a == b
}

/// Factors by which a direction is made longer to find one whose unit vector has the wanted bits.
fn factors() -> impl Iterator<Item = f64> {
    std::iter::once(1.0).chain((1..300u32).map(|k| 1.0 + f64::from(k) / 307.0))
}

/// A vector that readers make this unit vector of: they divide by its length, and once more when the model is built.
pub(super) fn axis(axis: &Unit<Vector3<f64>>) -> Vector3<f64> {
    let read = |v: &Vector3<f64>| crate::model_ir::unit(*v).map(|u| Unit::new_normalize(u.into_inner()));
    let fits = |v: &Vector3<f64>| read(v).is_some_and(|u| same(u.as_slice(), axis.as_slice()));
    let longer = factors().map(|f| axis.into_inner() * f);
    longer.into_iter().find(fits).unwrap_or(axis.into_inner())
}

/// An orientation in MJCF's words.
pub(super) enum Orientation {
    /// w, x, y, z.
    Quaternion([f64; 4]),
    /// Body-fixed x, y, z angles.
    Euler([f64; 3]),
}

/// The quaternion that reads back as this one, or the angles that do.
pub(super) fn orientation(rotation: &UnitQuaternion<f64>) -> Orientation {
    let own = *rotation.quaternion();
    let read = |q: nalgebra::Quaternion<f64>| UnitQuaternion::new_normalize(q / q.coords.amax());
    let fits = |q: &nalgebra::Quaternion<f64>| same(read(*q).coords.as_slice(), rotation.coords.as_slice());
    if let Some(q) = factors().map(|f| own * f).find(fits) {
        return Orientation::Quaternion([q.w, q.i, q.j, q.k]);
    }
    let turn = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let compose = |[x, y, z]: [f64; 3]| {
        let first = UnitQuaternion::identity() * turn(Vector3::x_axis(), x);
        first * turn(Vector3::y_axis(), y) * turn(Vector3::z_axis(), z)
    };
    let angles = angles(rotation, body_angles(&rotation.to_rotation_matrix()), compose);
    match same(compose(angles).coords.as_slice(), rotation.coords.as_slice()) {
        true => Orientation::Euler(angles),
        false => Orientation::Quaternion([own.w, own.i, own.j, own.k]),
    }
}
