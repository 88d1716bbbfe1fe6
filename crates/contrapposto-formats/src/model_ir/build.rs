//! Helps the readers build a [`ModelIr`]: checks, couplings of couplings, polynomials.

use super::{Coupling, Drive, Function, ModelIr, MotionIr, PassiveLawIr, SegmentIr};
use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use std::collections::BTreeSet;

/// The direction of a vector, unless it is too short to have one.
pub(crate) fn unit(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let largest = vector.amax();
    // Scaled first: the square of a very long or very short vector leaves the range of numbers.
    (largest >= 1e-14).then(|| Unit::new_normalize(vector / largest))
}

/// An inertia in turned axes. Rounding would leave it not quite symmetric: the upper triangle counts.
pub(crate) fn turned(inertia: &Matrix3<f64>, by: &Matrix3<f64>) -> Matrix3<f64> {
    let full = by * inertia * by.transpose();
    Matrix3::from_fn(|row, column| full[(row.min(column), row.max(column))])
}

/// Refuses the first coordinate name that is there twice.
pub(crate) fn unique_coordinates(body: &ModelIr) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    match body.coordinates.iter().find(|c| !seen.insert(c.name.as_str())) {
        Some(twice) => Err(twice.name.clone()),
        None => Ok(()),
    }
}

/// Larger numbers are refused: sums and squares of as many as a file can hold stay finite below it.
const LARGEST: f64 = 1e30;

/// Index of the first segment with a number that is not finite or too large to calculate with; one past the last for
/// anything else.
pub(crate) fn first_too_large(body: &ModelIr) -> Option<usize> {
    let fits = |x: &f64| x.abs() <= LARGEST; // false for NaN
    let pose = |p: &Isometry3<f64>| p.translation.vector.iter().chain(p.rotation.coords.iter()).all(fits);
    let motion = |m: &MotionIr| match m {
        MotionIr::Hinge { axis, drive } | MotionIr::Slide { axis, drive } => {
            axis.iter().all(fits) && if let Drive::Fixed(value) = drive { fits(value) } else { true }
        }
        MotionIr::Ball { .. } => true,
    };
    let segment = |s: &SegmentIr| {
        s.center_of_mass.iter().chain(s.inertia.iter()).chain([&s.mass]).all(fits)
            && pose(&s.in_parent)
            && pose(&s.in_segment)
            && s.motions.iter().all(motion)
    };
    if let Some(segment) = body.segments.iter().position(|s| !segment(s)) {
        return Some(segment);
    }
    let end = |x: &f64| x.is_infinite() || fits(x);
    let coordinates = body.coordinates.iter().all(|c| fits(&c.default) && end(&c.range.0) && end(&c.range.1));
    let couplings = body.couplings.iter().all(|c| powers(&c.function).is_none_or(|k| k.iter().all(fits)));
    let springs = body.passive.iter().all(|p| match &p.law {
        PassiveLawIr::Spring { stiffness, rest } => fits(stiffness) && fits(rest),
        PassiveLawIr::Polynomial { coefficients, rest } => fits(rest) && coefficients.iter().all(fits),
        _ => true,
    });
    let stations = body.stations.iter().all(|(_, _, at)| at.iter().all(fits));
    let rest = body.gravity.iter().all(fits) && coordinates && couplings && springs && stations;
    (!rest).then_some(body.segments.len())
}

/// The name that `given` was probably meant to be, among those short enough to compare quickly.
pub(crate) fn near<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    const MOST_BYTES: usize = 64;
    const MOST_NAMES: usize = 1000;
    if given.len() > MOST_BYTES {
        return None;
    }
    let short = names.into_iter().filter(|n| n.len() <= MOST_BYTES).take(MOST_NAMES);
    crate::nearest(given, short).map(str::to_owned)
}

/// Most powers of a polynomial that couplings of couplings may reach.
const MOST_POWERS: usize = 33;

/// Replaces independent coordinates that depend on another one themselves by that one, composing the polynomials.
///
/// Couplings must be linear or polynomial, and a coordinate depend on one other at most. The error is the index of a coupling
/// in a circle, or whose composed polynomial has too many powers.
pub(crate) fn compose_couplings(couplings: &mut [Coupling], coordinates: usize) -> Result<(), usize> {
    let mut of = vec![None; coordinates];
    for (index, coupling) in couplings.iter().enumerate() {
        of[coupling.dependent] = Some(index);
    }
    // Follows each chain to its end; ends are short-cut as they are found, so the whole is linear.
    let mut done = vec![false; couplings.len()];
    for start in 0..couplings.len() {
        let mut path = vec![start];
        while let Some(next) = of[couplings[path[path.len() - 1]].independent].filter(|&n| !done[n]) {
            if path.len() > couplings.len() {
                return Err(start);
            }
            path.push(next);
        }
        for index in path.into_iter().rev() {
            if !std::mem::replace(&mut done[index], true)
                && let Some(next) = of[couplings[index].independent]
            {
                let inner = couplings[next].function.clone();
                couplings[index].function = compose(&couplings[index].function, &inner).ok_or(index)?;
                couplings[index].independent = couplings[next].independent;
            }
        }
    }
    Ok(())
}

fn compose(outer: &Function, inner: &Function) -> Option<Function> {
    let inner = powers(inner)?;
    let mut result = vec![0.0];
    for &coefficient in powers(outer)?.iter().rev() {
        let mut next = vec![0.0; result.len() + inner.len() - 1];
        for (i, a) in result.iter().enumerate() {
            for (j, b) in inner.iter().enumerate() {
                next[i + j] += a * b;
            }
        }
        next[0] += coefficient;
        while next.len() > 1 && next[next.len() - 1] == 0.0 {
            next.pop();
        }
        if next.len() > MOST_POWERS {
            return None;
        }
        result = next;
    }
    Some(polynomial(result))
}

fn powers(function: &Function) -> Option<Vec<f64>> {
    match function {
        Function::Constant(value) => Some(vec![*value]),
        Function::Linear { slope, intercept } => Some(vec![*intercept, *slope]),
        Function::Polynomial(coefficients) => Some(coefficients.clone()),
        _ => None,
    }
}

/// The simplest function with these coefficients, lowest power first.
pub(crate) fn polynomial(mut coefficients: Vec<f64>) -> Function {
    while coefficients.len() > 2 && coefficients[coefficients.len() - 1] == 0.0 {
        coefficients.pop();
    }
    match coefficients[..] {
        [] => Function::Constant(0.0),
        [value] => Function::Constant(value),
        [intercept, slope] => Function::Linear { slope, intercept },
        _ => Function::Polynomial(coefficients),
    }
}
