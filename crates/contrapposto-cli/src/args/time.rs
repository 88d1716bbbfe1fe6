//! Reads times of the command line.

/// Longest time, s: a day.
const LONGEST: f64 = 86_400.0;

/// A time in s.
pub(super) fn time(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let unit = units.iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, *seconds)));
    let (number, unit) = unit.unwrap_or((text, f64::NAN));
    let seconds = number.trim().parse::<f64>().unwrap_or(f64::NAN) * unit;
    if seconds > 0.0 && seconds <= LONGEST {
        return Ok(seconds);
    }
    Err("a time above 0 and up to 24h with its unit is accepted, such as 30s, 2min or 1.5h".to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::time;

    #[test]
    fn times_have_a_unit_and_lie_between_nothing_and_a_day() {
        assert_eq!(["30s", "2min", "1.5h", " 2 min "].map(|text| time(text).unwrap()), [30.0, 120.0, 5400.0, 120.0]);
        for wrong in ["", "2", "0s", "-1min", "25h", "nans", "min", "2 minutes", "1e400s"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }
}
