//! The origin of the numbers of a coordinate: model file, overlay or built-in data.

/// Origin of a number of a coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// The model file.
    #[default]
    File,
    /// The overlay.
    Overlay,
    /// The built-in data.
    Library,
    /// The muscles of the model, in each posture.
    Muscles,
}

/// Origin of every number of one coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origins {
    /// The coordinate of the built-in adult whose data are used.
    pub twin: Option<String>,
    /// The coordinate runs against that of the adult: its positive group is the adult's negative one.
    pub turned: bool,
    /// Range (rad) that the built-in passive law is meant for, in the coordinate's direction.
    pub meant: Option<(f64, f64)>,
    /// Of the range.
    pub range: Origin,
    /// Of the passive law.
    pub passive: Origin,
    /// Of the strength of both muscle groups.
    pub strength: Origin,
    /// Of the fatigue law of both muscle groups.
    pub fatigue: Origin,
}
