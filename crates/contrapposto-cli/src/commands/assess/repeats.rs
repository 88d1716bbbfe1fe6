//! Checks a motion that is repeated: whether its end meets its start.

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;

use crate::view::words::{joint, value};

/// Ends whose angles differ by less meet, rad: 5 deg, the error of recorded angles. Assumed.
const MEET: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The warning about a motion whose end does not meet its start, with the time at which it comes nearest to its start again, if there is one.
pub(super) fn ends_apart(model: &Model, motion: &[(f64, Posture)]) -> Option<String> {
    let [(_, start), .., (_, end)] = motion else { return None };
    let turns = |i: &usize| model.coordinates()[*i].kind == CoordinateKind::Rotation && !model.is_dependent(*i);
    let angles: Vec<usize> = (0..model.coordinates().len()).filter(turns).collect();
    let away = |posture: &Posture, i: usize| (posture.values()[i] - start.values()[i]).abs();
    let apart: Vec<usize> = angles.iter().copied().filter(|&i| away(end, i) > MEET).collect();
    let worst = *apart.iter().max_by(|&&a, &&b| away(end, a).total_cmp(&away(end, b)))?;
    let distance = |posture: &Posture| angles.iter().map(|&i| away(posture, i)).fold(0.0, f64::max);
    let left = motion.iter().position(|(_, posture)| distance(posture) > 2.0 * MEET).unwrap_or(motion.len());
    let again = motion[left..].iter().min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)));
    let again = again.filter(|(_, posture)| distance(posture) <= 2.0 * MEET && distance(posture) < away(end, worst));
    let more = match apart.len() - 1 {
        0 => String::new(),
        1 => "; one more angle differs".to_owned(),
        others => format!("; {others} more angles differ"),
    };
    let cut = again.map(|(time, _)| format!("; the motion comes nearest to its start again at {time} s: --to {time}"));
    let [from, to] = [start, end].map(|posture| value(model, worst, posture.values()[worst]));
    Some(format!(
        "the end of the motion does not meet its start: {} is {from} at the start and {to} at the end{more}. Every repeat begins with that \
         jump{}",
        joint(&model.coordinates()[worst].name),
        cut.unwrap_or_default()
    ))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use contrapposto::model::{Adult, adult};

    use super::ends_apart;

    #[test]
    fn a_motion_that_goes_on_after_its_cycle_is_told_where_to_cut_it() {
        let model = adult(&Adult::default()).unwrap();
        let elbow = model.coordinate("elbow_flex_r").unwrap();
        let motion: Vec<_> = (0..=60)
            .map(|i| {
                let mut posture = model.default_posture();
                posture.values_mut()[elbow] = 1.0 - libm::cos(2.0 * std::f64::consts::PI * f64::from(i) / 40.0);
                (0.05 * f64::from(i), posture)
            })
            .collect();
        assert_eq!(ends_apart(&model, &motion[..=40]), None);
        let said = ends_apart(&model, &motion).unwrap();
        assert!(
            said.contains("right elbow flexion (elbow_flex_r) is 0.0° at the start and 114.6° at the end. Every"),
            "{said}"
        );
        assert!(said.ends_with("nearest to its start again at 2 s: --to 2"), "{said}");
        let said = ends_apart(&model, &motion[..=20]).unwrap();
        assert!(said.ends_with("Every repeat begins with that jump"), "{said}");
    }
}
