//! Reads loads and patches from short texts: `hand_r 3kg`, `hand_r 0,-20,0 at 0,-0.08,0 world`.

use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;

use crate::input_error::nearest;

const PATCH_FORM: &str = "\"SEGMENT X,Y,Z X,Y,Z ...\" (m, the segment's axes): \
    \"calcn_r 0.1,-0.02,0.04 0.1,-0.02,-0.04 -0.04,-0.02,0\"";
const LOAD_FORM: &str = "\"SEGMENT MASSkg\" or \"SEGMENT MASSkg at X,Y,Z\" (m, the segment's axes): \"hand_r 3kg\"";
const FORCE_FORM: &str = "\"SEGMENT FX,FY,FZ\" (N), then if wanted \"at X,Y,Z\" (m, the segment's axes), then if wanted \
    \"world\" or \"segment\" (the force's axes): \"hand_r 0,-20,0 at 0,-0.08,0 world\"";

/// The reason for which a text is no load or patch of the model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{problem}\n  accepted: {accepted}")]
pub struct LoadTextError {
    /// The part that is wrong, and why.
    pub problem: String,
    /// The accepted form, with an example.
    pub accepted: &'static str,
}

/// A held weight: `SEGMENT MASSkg`, at the segment's centre of mass, or `SEGMENT MASSkg at X,Y,Z` (m, the segment's axes).
///
/// ```
/// use contrapposto::model::{Adult, adult};
/// use contrapposto::statics::LoadKind;
/// use contrapposto_formats::loads::weight;
/// let model = adult(&Adult::default())?;
/// let load = weight(&model, "hand_r 3kg at 0,-0.08,0")?;
/// assert_eq!(load.kind, LoadKind::Weight(3.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LoadTextError`] names the segment or number that is not understood, and the accepted form.
pub fn weight(model: &Model, text: &str) -> Result<Load, LoadTextError> {
    let refuse = |problem: String| LoadTextError { problem, accepted: LOAD_FORM };
    let (segment, words) = segment(model, text).map_err(refuse)?;
    let words: Vec<&str> = words.split_whitespace().collect();
    let (mass, rest) = match words.as_slice() {
        [mass, "kg", rest @ ..] => (*mass, rest),
        [mass, rest @ ..] if mass.ends_with("kg") => (mass.trim_end_matches("kg"), rest),
        [] => return Err(refuse("the mass is missing".to_owned())),
        [other, ..] => return Err(refuse(format!("`{other}` is no mass in kg"))),
    };
    let mass = number(mass).map_err(refuse)?;
    let point = match rest {
        [] => model.segments()[segment].center_of_mass,
        ["at", point] => vector(point).map_err(refuse)?,
        _ => return Err(refuse(format!("`{}` is not understood", rest.join(" ")))),
    };
    checked(model, Load { segment, point, kind: LoadKind::Weight(mass) }).map_err(refuse)
}

/// A force (N): `SEGMENT FX,FY,FZ`, then, where wanted, `at X,Y,Z` (m, the segment's axes), and `world` or `segment` (the axes of
/// the force; world where nothing is said).
///
/// # Errors
/// As [`weight`].
pub fn force(model: &Model, text: &str) -> Result<Load, LoadTextError> {
    let refuse = |problem: String| LoadTextError { problem, accepted: FORCE_FORM };
    let (segment, words) = segment(model, text).map_err(refuse)?;
    let words: Vec<&str> = words.split_whitespace().collect();
    let (force, rest) = match words.as_slice() {
        [force, rest @ ..] => (vector(force).map_err(refuse)?, rest),
        [] => return Err(refuse("the force is missing".to_owned())),
    };
    let (point, rest) = match rest {
        ["at", point, rest @ ..] => (vector(point).map_err(refuse)?, rest),
        _ => (model.segments()[segment].center_of_mass, rest),
    };
    let fixed_in = match rest {
        [] | ["world"] => FixedIn::World,
        ["segment"] => FixedIn::Segment,
        _ => return Err(refuse(format!("`{}` is not understood", rest.join(" ")))),
    };
    checked(model, Load { segment, point, kind: LoadKind::Force(force, fixed_in) }).map_err(refuse)
}

/// The patch on which a segment is supported, `SEGMENT X,Y,Z X,Y,Z ...`: index of the segment, and corners in its frame, m.
///
/// # Errors
/// As [`weight`].
pub fn patch(model: &Model, text: &str) -> Result<(usize, Vec<Vector3<f64>>), LoadTextError> {
    let refuse = |problem: String| LoadTextError { problem, accepted: PATCH_FORM };
    let (segment, words) = segment(model, text).map_err(refuse)?;
    let corners = words.split_whitespace().map(vector).collect::<Result<Vec<_>, _>>().map_err(refuse)?;
    if corners.is_empty() { Err(refuse("the corners are missing".to_owned())) } else { Ok((segment, corners)) }
}

fn checked(model: &Model, load: Load) -> Result<Load, String> {
    load.check(model).map(|()| load).map_err(|error| error.to_string())
}

/// The segment named first, and what follows, blanks around commas removed. Names may hold blanks: the longest one counts.
fn segment(model: &Model, text: &str) -> Result<(usize, String), String> {
    let text = text.trim();
    let named = model.segments().iter().enumerate().filter(|(_, segment)| {
        text.strip_prefix(segment.name.as_str())
            .is_some_and(|rest| rest.is_empty() || rest.starts_with(char::is_whitespace))
    });
    let Some((index, found)) = named.max_by_key(|(_, segment)| segment.name.len()) else {
        let given = text.split_whitespace().next().unwrap_or_default();
        return Err(no_segment(model, given));
    };
    let parts: Vec<&str> = text[found.name.len()..].split(',').map(str::trim).collect();
    Ok((index, parts.join(",")))
}

/// "the model has no segment `han_r`; did you mean `hand_r`?"
pub fn no_segment(model: &Model, given: &str) -> String {
    let names = || model.segments().iter().map(|segment| segment.name.as_str());
    // The distance of two words costs their product.
    let near = Some(given).filter(|given| given.len() <= 64).and_then(|given| nearest(given, names()));
    let hint = match near {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("there are: {}", names().take(60).collect::<Vec<_>>().join(", ")),
    };
    format!("the model has no segment `{given}`; {hint}")
}

fn vector(text: &str) -> Result<Vector3<f64>, String> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers.as_slice() {
        &[x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err(format!("`{text}` holds {} numbers; three are needed, with commas between them", numbers.len())),
    }
}

fn number(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| format!("`{text}` is not a number"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::{force, weight};
    use contrapposto::model::{Adult, Model, adult};
    use contrapposto::statics::{FixedIn, LoadKind};
    use nalgebra::Vector3;

    fn model() -> Model {
        adult(&Adult::default()).unwrap()
    }

    #[test]
    fn accepted_forms_give_mass_force_point_and_axes() {
        let model = model();
        let hand = model.segment("hand_r").unwrap();
        for text in ["hand_r 3kg", " hand_r  3 kg ", "hand_r 3.0kg"] {
            let load = weight(&model, text).unwrap();
            assert_eq!((load.segment, load.kind), (hand, LoadKind::Weight(3.0)), "{text}");
            assert_eq!(load.point, model.segments()[hand].center_of_mass);
        }
        assert_eq!(weight(&model, "hand_r 3kg at 0,-0.08, 0").unwrap().point, Vector3::new(0.0, -0.08, 0.0));
        let load = force(&model, "hand_r 0,-20,0 at 0,-0.08,0 segment").unwrap();
        assert_eq!(load.kind, LoadKind::Force(Vector3::new(0.0, -20.0, 0.0), FixedIn::Segment));
        let load = force(&model, "hand_r 0 , -20 , 0").unwrap();
        assert_eq!(load.kind, LoadKind::Force(Vector3::new(0.0, -20.0, 0.0), FixedIn::World));
        assert_eq!(load.point, model.segments()[hand].center_of_mass);
    }

    #[test]
    fn other_forms_are_refused_with_the_accepted_one() {
        let model = model();
        for (text, part) in [
            ("han_r 3kg", "did you mean `hand_r`"),
            ("hand_r", "the mass is missing"),
            ("hand_r 3", "`3` is no mass in kg"),
            ("hand_r 3lb", "`3lb` is no mass"),
            ("hand_r nankg", "`nan` is not a number"),
            ("hand_r -3kg", "between 0 and"),
            ("hand_r 3kg on 0,0,0", "`on 0,0,0` is not understood"),
            ("hand_r 3kg at 0,0", "holds 2 numbers"),
        ] {
            let message = weight(&model, text).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("accepted:"), "{message}");
        }
        for (text, part) in [
            ("hand_r 0,-20", "holds 2 numbers"),
            ("hand_r 0,-20,x", "`x` is not a number"),
            ("hand_r", "holds 1 numbers|the force is missing"),
            ("hand_r 0,-20,0 sideways", "`sideways` is not understood"),
        ] {
            let message = force(&model, text).unwrap_err().to_string();
            assert!(part.split('|').any(|part| message.contains(part)), "{message}");
        }
    }
}
