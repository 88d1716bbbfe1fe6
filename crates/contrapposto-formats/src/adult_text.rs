//! Reads the size of a body from a short text: `adult`, `adult:female,1.65m,60kg`; `female,60kg` of a person.

use contrapposto::model::{Adult, Sex};

use crate::tissue::Person;

const ADULT_FORM: &str = "accepted: `adult` (de Leva's reference man), or `adult:` and sex, stature and mass: \
    `adult:female,1.65m,60kg`";

const PERSON_FORM: &str = "accepted: sex, stature and mass, or some of them: `female,1.65m,60kg`, `female`";

/// The reason for which a text is no size of a body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{text}`: {problem}\n  {accepted}")]
pub struct AdultTextError {
    /// The text.
    pub text: String,
    /// The part that is wrong, and why.
    pub problem: String,
    /// The texts that are accepted.
    pub accepted: &'static str,
}

/// The size of the adult that `text` names, stature in m and mass in kg; `None` where the text does not begin with `adult`.
///
/// ```
/// use contrapposto_formats::adult_size;
/// let size = adult_size("adult:female,1.65m,60kg").expect("a name of the adult")?;
/// assert_eq!((size.stature, size.mass), (1.65, 60.0));
/// assert!(adult_size("subject.osim").is_none());
/// # Ok::<(), contrapposto_formats::AdultTextError>(())
/// ```
///
/// # Errors
/// [`AdultTextError`] names the part that is neither a sex, a stature nor a mass, that is missing, or that is given twice.
pub fn adult_size(text: &str) -> Option<Result<Adult, AdultTextError>> {
    if text == "adult" {
        return Some(Ok(Adult::default()));
    }
    let rest = text.strip_prefix("adult:")?;
    Some(parsed(rest).map_err(|problem| AdultTextError { text: text.to_owned(), problem, accepted: ADULT_FORM }))
}

/// Begins the `credits` of a model file of the built-in adult.
const CREDITS: &str = "Built-in adult of contrapposto: ";

/// The name of an adult of this size: `adult:female,1.65m,60kg`.
pub(crate) fn adult_name(size: &Adult) -> String {
    let sex = if size.sex == Sex::Female { "female" } else { "male" };
    format!("adult:{sex},{}m,{}kg", size.stature, size.mass)
}

/// The `credits` of a model file that holds the adult of this size.
pub(crate) fn credits(size: &Adult) -> String {
    format!("{CREDITS}{}", adult_name(size))
}

/// The size of the adult that the `credits` of a model file name; `None` where they name none.
pub(crate) fn credited(credits: &str) -> Option<Adult> {
    adult_size(credits.trim().strip_prefix(CREDITS)?)?.ok()
}

/// The person that `text` describes, stature in m and mass in kg; the parts that it leaves out stay unknown.
///
/// ```
/// let person = contrapposto_formats::person("female, 60kg")?;
/// assert_eq!((person.stature, person.mass), (None, Some(60.0)));
/// # Ok::<(), contrapposto_formats::AdultTextError>(())
/// ```
///
/// # Errors
/// [`AdultTextError`] names the part that is neither a sex, a stature nor a mass, or that is given twice.
pub fn person(text: &str) -> Result<Person, AdultTextError> {
    let wrong = |problem| AdultTextError { text: text.to_owned(), problem, accepted: PERSON_FORM };
    parts(text).map_err(wrong)
}

fn parsed(text: &str) -> Result<Adult, String> {
    let Person { sex, stature, mass } = parts(text)?;
    let missing = |what: &str| format!("the {what} is missing");
    Ok(Adult {
        sex: sex.ok_or_else(|| missing("sex"))?,
        stature: stature.ok_or_else(|| missing("stature"))?,
        mass: mass.ok_or_else(|| missing("mass"))?,
        ..Adult::default()
    })
}

fn parts(text: &str) -> Result<Person, String> {
    let (mut sex, mut stature, mut mass) = (None, None, None);
    for part in text.split(',').map(str::trim) {
        let twice = match part {
            "female" => sex.replace(Sex::Female).is_some(),
            "male" => sex.replace(Sex::Male).is_some(),
            _ => {
                if let Some(number) = part.strip_suffix("kg") {
                    mass.replace(size(number, part)?).is_some()
                } else if let Some(number) = part.strip_suffix("cm") {
                    stature.replace(size(number, part)? / 100.0).is_some()
                } else if let Some(number) = part.strip_suffix('m') {
                    stature.replace(size(number, part)?).is_some()
                } else if part.is_empty() {
                    return Err("a part between the commas is empty".to_owned());
                } else {
                    return Err(format!(
                        "`{part}` is neither a sex (female, male), a stature (1.65m) nor a mass (60kg)"
                    ));
                }
            }
        };
        if twice {
            return Err(format!("`{part}` repeats a size that was given before"));
        }
    }
    Ok(Person { sex, stature, mass })
}

fn size(number: &str, part: &str) -> Result<f64, String> {
    let value = number.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| format!("`{part}` does not begin with a number"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::parsed;
    use contrapposto::model::Sex;

    #[test]
    fn parts_in_any_order_give_the_size_and_wrong_parts_are_named() {
        for text in ["female,1.65m,60kg", "60 kg, 165 cm, female"] {
            let size = parsed(text).unwrap();
            assert_eq!((size.sex, size.mass), (Sex::Female, 60.0));
            assert!((size.stature - 1.65).abs() < 1e-12);
        }
        for (text, part) in [
            ("female,1.65,60kg", "`1.65` is neither"),
            ("female,60kg", "stature is missing"),
            ("female,male,60kg", "given before"),
            ("female,nanm,60kg", "`nanm` does not begin"),
            ("", "between the commas is empty"),
        ] {
            let error = parsed(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
