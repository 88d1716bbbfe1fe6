//! What the readers share while they build a body.

use super::{Body, Coupling, Function};
use nalgebra::{Unit, Vector3};
use std::collections::BTreeSet;

/// The direction of a vector, unless it is too short to have one.
pub(crate) fn unit(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let largest = vector.amax();
    // Scaled first: the square of a very long or very short vector leaves the range of numbers.
    (largest >= 1e-14).then(|| Unit::new_normalize(vector / largest))
}

/// Complains about the first coordinate name that is there twice.
pub(crate) fn unique_coordinates(body: &Body) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    match body.coordinates.iter().find(|c| !seen.insert(c.name.as_str())) {
        Some(twice) => Err(twice.name.clone()),
        None => Ok(()),
    }
}

/// Index of the first segment with a number that is not finite; one past the last for a spring or coupling.
pub(crate) fn first_not_finite(body: &Body) -> Option<usize> {
    let finite = |s: &super::BodySegment| {
        let pose = |p: &nalgebra::Isometry3<f64>| {
            p.translation.vector.iter().chain(p.rotation.coords.iter()).all(|x| x.is_finite())
        };
        let motion = |m: &super::BodyMotion| match m {
            super::BodyMotion::Hinge { axis, drive } | super::BodyMotion::Slide { axis, drive } => {
                let drive = if let super::Drive::Constant(value) = drive { *value } else { 0.0 };
                drive.is_finite() && axis.iter().all(|x| x.is_finite())
            }
            super::BodyMotion::Ball { .. } => true,
        };
        let numbers = s.center_of_mass.iter().chain(s.inertia.iter());
        s.mass.is_finite()
            && numbers.copied().all(f64::is_finite)
            && pose(&s.in_parent)
            && pose(&s.in_segment)
            && s.motions.iter().all(motion)
    };
    if let Some(segment) = body.segments.iter().position(|s| !finite(s)) {
        return Some(segment);
    }
    let coupled = body.couplings.iter().all(|c| powers(&c.function).is_none_or(|k| k.iter().all(|x| x.is_finite())));
    let sprung = body.passive.iter().all(|p| match &p.law {
        super::PassiveLawText::Spring { stiffness, rest } => stiffness.is_finite() && rest.is_finite(),
        super::PassiveLawText::Polynomial { coefficients, rest } => {
            rest.is_finite() && coefficients.iter().all(|x| x.is_finite())
        }
        _ => true,
    });
    (!coupled || !sprung).then_some(body.segments.len())
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

/// Replaces leaders that follow another coordinate themselves by that coordinate, composing the polynomials.
///
/// Couplings must be linear or polynomial, and a coordinate be led at most once. The error is the index of a coupling
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
                && let Some(leader) = of[couplings[index].independent]
            {
                let inner = couplings[leader].function.clone();
                couplings[index].function = compose(&couplings[index].function, &inner).ok_or(index)?;
                couplings[index].independent = couplings[leader].independent;
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
