//! Recognises the built-in adult by the masses and frames of its segments.

use super::{Adult, Model, Placement, Segment, Sex, adult};

/// Numbers count as equal within this share of the larger one, or of 1.
const EQUAL: f64 = 1e-6;
/// The segment whose distance from its parent tells the stature.
const MEASURED: &str = "tibia_r";
/// Decimals to which stature (m) and mass (kg) are rounded: those of a person, without the rounding of sums.
const DECIMALS: f64 = 1e9;

impl Adult {
    /// The size of the whole built-in adult that a body is: its segments by name, each with the same mass, centre of mass, inertia and
    /// place on its parent within a millionth. `None` for every other body, and for an adult of measured segment lengths. Strength, passive
    /// torque and ranges are not compared.
    ///
    /// ```
    /// use contrapposto::model::{Adult, Sex, adult};
    /// let size = Adult { sex: Sex::Female, stature: 1.65, mass: 62.0, ..Adult::default() };
    /// assert_eq!(Adult::of(&adult(&size)?), Some(size));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(model: &Model) -> Option<Self> {
        [Sex::Female, Sex::Male].into_iter().find_map(|sex| {
            let reference = Self::reference(sex);
            let body = adult(&reference).ok()?;
            let size = Self {
                stature: rounded(reference.stature * (measured(model)? / measured(&body)?)),
                mass: rounded(reference.mass * (model.mass() / body.mass())),
                ..reference
            };
            size.has_segments_of(model).then_some(size)
        })
    }

    /// Whether the built-in adult of this size has the segments of a body.
    fn has_segments_of(&self, model: &Model) -> bool {
        let Ok(own) = adult(self) else { return false };
        own.segments().len() == model.segments().len()
            && own.segments().iter().all(|segment| {
                let other = model.segment(&segment.name).map(|index| &model.segments()[index]);
                other.is_some_and(|other| are_equal(segment, other))
            })
    }
}

fn measured(model: &Model) -> Option<f64> {
    Some(model.segments()[model.segment(MEASURED)?].in_parent.translation.vector.norm())
}

fn rounded(value: f64) -> f64 {
    (DECIMALS * value).round() / DECIMALS
}

fn are_equal(a: &Segment, b: &Segment) -> bool {
    let numbers = |s: &Segment| {
        let mut all = vec![s.mass];
        all.extend(s.center_of_mass.iter().chain(s.inertia.iter()));
        for Placement { rotation, translation } in [s.in_parent, s.in_segment] {
            all.extend(translation.vector.iter().chain(rotation.to_rotation_matrix().matrix().iter()));
        }
        all
    };
    let close = |(a, b): (f64, f64)| (a - b).abs() <= EQUAL * a.abs().max(b.abs()).max(1.0);
    numbers(a).into_iter().zip(numbers(b)).all(close)
}
