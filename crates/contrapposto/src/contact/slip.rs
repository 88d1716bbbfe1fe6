//! Measures how far supports are off their places.

use serde::{Deserialize, Serialize};

/// Distance of supports from their places: errors of all supports together, lengths and angles apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slip {
    /// Root of the sum of squared distances, m.
    pub distance: f64,
    /// Root of the sum of squared angles, rad.
    pub angle: f64,
}

impl Slip {
    /// From here on a result warns of the slip: 1 mm, 0.1 degrees. Assumed: less is not seen.
    pub const NOTICED: Self = Self { distance: 1e-3, angle: 1.745_329e-3 };
    /// Beyond this the supports do not hold the body: 5 mm, 1 degree. Assumed: more is another posture than the one asked for.
    pub const GREATEST: Self = Self { distance: 5e-3, angle: 1.745_329e-2 };

    /// Distance and angle together, for comparisons: 1 m weighs as 1 rad.
    pub fn length(self) -> f64 {
        libm::hypot(self.distance, self.angle)
    }

    /// The greater of the shares that distance and angle have of `bound`: above 1 where it exceeds it.
    pub fn share_of(self, bound: Self) -> f64 {
        (self.distance / bound.distance).max(self.angle / bound.angle)
    }

    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { distance: libm::hypot(self.distance, other.distance), angle: libm::hypot(self.angle, other.angle) }
    }

    /// Whether the distance or the angle is greater than that of `bound`.
    pub fn exceeds(self, bound: Self) -> bool {
        self.distance > bound.distance || self.angle > bound.angle
    }
}
