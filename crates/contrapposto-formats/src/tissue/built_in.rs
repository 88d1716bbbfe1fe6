//! Gives the built-in adult that a file of this program holds all that the format cannot hold.
//!
//! An OpenSim file has no strength, no contact patches and no words for positive senses, and its passive forces act on coordinates, so that a
//! joint of three axes would be judged by its coordinates. A file whose `credits` name the built-in adult, and whose segments are its
//! segments, gets them back. A passive force that was changed stays.

use contrapposto::model::{Adult, Coordinate, Model, Sex};
use contrapposto::passive::{PassiveCurve, PassiveLaw};

use crate::adult_text::adult_name;

/// Angles at which two laws are compared, evenly over the range.
const COMPARED: u32 = 33;
/// Torques count as equal within this share of the larger one, or of 1 N m.
const EQUAL: f64 = 1e-6;

/// The size, where the body has the segments of the adult of that size.
pub(super) fn verified(credited: Option<&Adult>, model: &Model) -> Option<Adult> {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6;
    let own = Adult::of(model)?;
    let named = credited?;
    let same = own.sex == named.sex && close(own.stature, named.stature) && close(own.mass, named.mass);
    same.then_some(own)
}

/// Whether the passive law that the file gives a coordinate is the curve of the built-in adult.
pub(super) fn is_own_law(coordinate: &Coordinate, twin: &Coordinate) -> bool {
    let (Some(law @ PassiveLaw::Sum(_)), Some(PassiveLaw::Curve(curve))) = (&coordinate.passive, &twin.passive) else {
        return false;
    };
    are_equal(law, curve)
}

fn are_equal(law: &PassiveLaw, curve: &PassiveCurve) -> bool {
    let (min, max) = curve.range();
    // A sum is a function of one angle.
    (0..COMPARED).all(|k| {
        let angle = min + (max - min) * f64::from(k) / f64::from(COMPARED - 1);
        let (theirs, ours) = (law.torque(0, &[angle]), curve.torque(angle));
        (theirs - ours).abs() <= EQUAL * theirs.abs().max(ours.abs()).max(1.0)
    })
}

/// The body with the contact patches and the positive senses of the adult, and its joints of three axes judged by their moment.
pub(super) fn completed(mut model: Model, twin: &Model) -> Model {
    for own in twin.coordinates() {
        if let Some(index) = model.coordinate(&own.name) {
            model = model.with_positive(index, &own.positive);
        }
    }
    for own in twin.segments().iter().filter(|segment| !segment.patch.is_empty()) {
        let index = model.segment(&own.name);
        if let Some(index) = index.filter(|&index| model.segments()[index].patch.is_empty()) {
            model = model.with_patch(index, own.patch.clone());
        }
    }
    model.with_three_axis_joints()
}

/// The note about such a file.
pub(super) fn said(size: &Adult, changed: &[String]) -> String {
    let word = if size.sex == Sex::Female { "woman" } else { "man" };
    let but = match changed {
        [] => String::new(),
        names => format!("; the passive torque of {} is that of the file, for it was changed there", names.join(", ")),
    };
    format!(
        "the file is the built-in adult, a {word} of {} m and {} kg: strength, passive torque, patches and positive senses are those of \
         `{}`{but}; --passive file leaves them out",
        size.stature,
        size.mass,
        adult_name(size)
    )
}
