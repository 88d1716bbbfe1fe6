//! Says which people the size of the built-in adult stands for.

use contrapposto::model::Sex;
use contrapposto::model::data::{PeopleOfSex, library};

use crate::error::Refusal;
use crate::message::Person;

fn people(sex: &str) -> Option<&'static PeopleOfSex> {
    let sex = match sex {
        "female" => Sex::Female,
        "male" => Sex::Male,
        _ => return None,
    };
    Some(library().people().of_sex(sex))
}

/// Stature (m) and mass (kg), to a millimetre and a tenth of a kilogram, that so many percent of people of that sex do not exceed, each alone.
pub(crate) fn at(sex: &str, percentile: f64) -> Result<(f64, f64), Refusal> {
    let people = people(sex).ok_or_else(|| Refusal(format!("`{sex}` is no sex; there are female, male")))?;
    if !(1.0..=99.0).contains(&percentile) {
        return Err(Refusal(format!("the percentile is {percentile}; it must lie between 1 and 99")));
    }
    let (stature, mass) = people.size_at(percentile / 100.0);
    Ok(((1000.0 * stature).round() / 1000.0, (10.0 * mass).round() / 10.0))
}

/// A person with the percent of people of that sex who do not exceed the size.
pub(crate) fn scene((sex, stature, mass): (String, f64, f64)) -> Option<Person> {
    let percentiles = people(&sex)?.shares_up_to(stature, mass).map(|share| 100.0 * share);
    Some(Person { sex, stature, mass, percentiles })
}
