//! Scales mass and inertia of a body, as OpenSim does (`Body::scaleInertialProperties`).

use nalgebra::{Matrix3, Vector3};

/// Factors that differ by no more than that are the same: SimTK's significant digits, the machine's precision to the power 7/8 (derived).
const SAME_FACTOR: f64 = 2.0e-14;
/// Largest mass of a body without mass, kg (SimTK's `Eps`; derived).
const NO_MASS: f64 = f64::EPSILON;

/// Mass (kg) and inertia about the mass centre (kg m^2).
pub(super) type MassAndInertia = (f64, Matrix3<f64>);

/// Mass and inertia of a body whose lengths along its axes are multiplied. `with_mass`: the mass grows with the volume, else it stays.
///
/// Equal factors multiply the inertia. With different ones the body is taken for a cylinder along the axis of its smallest moment:
/// radius and length that give two of its moments are scaled, and the moments are those of the new cylinder; products of inertia grow with
/// their two axes.
pub(super) fn scaled((mass, inertia): MassAndInertia, factors: Vector3<f64>, with_mass: bool) -> MassAndInertia {
    let volume = factors.product().abs();
    let grown = if with_mass { mass * volume } else { mass };
    let by_mass = if with_mass { volume } else { 1.0 };
    if grown <= NO_MASS {
        return (grown, Matrix3::zeros());
    }
    let same = |a: f64, b: f64| (a - b).abs() <= SAME_FACTOR * a.abs().max(b.abs()).max(1.0);
    if same(factors.x, factors.y) && same(factors.y, factors.z) {
        return (grown, inertia * by_mass * (factors.x * factors.x));
    }
    let diagonal = inertia.diagonal();
    let axis = match (diagonal.x <= diagonal.y, diagonal.x <= diagonal.z, diagonal.y <= diagonal.z) {
        (true, true, _) => 0,
        (false, _, true) => 1,
        _ => 2,
    };
    let [across, other] = [(axis + 1) % 3, (axis + 2) % 3];
    let any_across = if axis == 0 { 1 } else { 0 };
    let radius = (2.0 * diagonal[axis] / mass).max(0.0).sqrt();
    let squared = 12.0 * (diagonal[any_across] - 0.25 * mass * radius * radius) / mass;
    let length = squared.max(0.0).sqrt() * factors[axis];
    let radius_squared = radius * factors[across] * radius * factors[other];
    let long = grown * (length * length / 12.0 + 0.25 * radius_squared);
    let moments = Vector3::from_fn(|i, _| if i == axis { 0.5 * grown * radius_squared } else { long });
    let scaled = Matrix3::from_fn(|i, j| match i == j {
        true => moments[i],
        false => inertia[(i, j)] * (factors[i] * factors[j]) * by_mass,
    });
    (grown, scaled)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::scaled;

    /// A solid cylinder along `axis`: its moments from the definition.
    fn cylinder(axis: usize, mass: f64, [a, b]: [f64; 2], length: f64) -> Matrix3<f64> {
        // An elliptic cylinder with a*b = r^2 stands for the round one of the rule.
        let squared = a * b;
        let long = mass * (length * length / 12.0 + squared / 4.0);
        Matrix3::from_diagonal(&Vector3::from_fn(|i, _| if i == axis { mass * squared / 2.0 } else { long }))
    }

    #[test]
    fn a_cylinder_becomes_the_cylinder_of_the_new_size() {
        let (radius, length, mass) = (0.07, 0.42, 8.1);
        let factors = Vector3::new(1.3, 0.8, 1.1);
        for axis in 0..3 {
            let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
            let before = cylinder(axis, mass, [radius, radius], length);
            for with_mass in [false, true] {
                let new_mass = if with_mass { mass * factors.product() } else { mass };
                let sides = [radius * factors[x], radius * factors[y]];
                let expected = cylinder(axis, new_mass, sides, length * factors[axis]);
                let (found_mass, found) = scaled((mass, before), factors, with_mass);
                assert!((found_mass - new_mass).abs() < 1e-14 * new_mass);
                assert!((found - expected).amax() < 1e-14, "axis {axis}: {found} is not {expected}");
            }
        }
    }

    #[test]
    fn equal_factors_are_exact_and_no_mass_has_no_inertia() {
        let inertia = Matrix3::new(3.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 1.5);
        // Inertia is mass times squared length.
        let (mass, found) = scaled((2.0, inertia), Vector3::from_element(1.5), true);
        assert!((mass - 2.0 * 3.375).abs() < 1e-14);
        assert!((found - inertia * 1.5f64.powi(5)).amax() < 1e-13);
        assert_eq!(scaled((0.0, inertia), Vector3::new(1.0, 2.0, 3.0), true).1, Matrix3::zeros());
    }
}
