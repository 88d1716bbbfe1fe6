//! Defines the source of a number of the human body, and how far the number can be trusted.

use serde::Deserialize;

/// Trust in a number, the best first: the greater of two is the weaker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub enum Status {
    /// Measured in the named source.
    #[serde(rename = "measured")]
    Measured,
    /// Copied rightly from the named source; says nothing of a measurement.
    #[serde(rename = "verified")]
    Verified,
    /// Computed from measured or verified numbers.
    #[serde(rename = "derived")]
    Derived,
    /// Measured size, assumed shape.
    #[serde(rename = "derived (partly assumed)")]
    DerivedPartlyAssumed,
    /// Held or continued outside of the measurement.
    #[serde(rename = "extrapolated")]
    Extrapolated,
    /// A steep torque that ends a range in a computation, without a measurement of its size.
    #[serde(rename = "numeric stop")]
    NumericStop,
    /// From memory; never cite as verified.
    #[serde(rename = "recalled (unverified)")]
    Recalled,
    /// A design choice without a measurement behind it.
    #[serde(rename = "assumed")]
    Assumed,
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Measured => "measured",
            Self::Verified => "verified",
            Self::Derived => "derived",
            Self::DerivedPartlyAssumed => "derived (partly assumed)",
            Self::Extrapolated => "extrapolated",
            Self::NumericStop => "numeric stop",
            Self::Recalled => "recalled (unverified)",
            Self::Assumed => "assumed",
        })
    }
}

/// Source of a number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Trust in the number.
    pub status: Status,
    /// Author, year, place; or the reason of an assumption.
    pub source: String,
    /// Remark.
    #[serde(default)]
    pub note: String,
}
