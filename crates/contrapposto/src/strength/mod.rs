//! Computes the greatest torque that a rested muscle group can give at an angle.
//!
//! One shape: `S(q) = peak max(floor, cos(narrowness (q - best)))`. With `narrowness = 0` strength is the same everywhere.
//! With Anderson, Madigan & Nussbaum 2007 (J. Biomech. 40:3105-3113, Table 3) `peak = C1 M g H`, `narrowness = C2`,
//! `best = C3`. The floor keeps relative load finite inside the range; it is a design choice (status "assumed").

/// Greatest voluntary torque of one muscle group against angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Torque at the best angle, N m, positive.
    pub peak: f64,
    /// Angle of greatest torque, rad.
    pub best: f64,
    /// How fast it falls off, 1/rad, not negative.
    pub narrowness: f64,
    /// Least share of the peak, in 0..=1, positive.
    pub floor: f64,
}

impl Strength {
    /// The same at every angle.
    pub fn constant(peak: f64) -> Self {
        Self { peak, best: 0.0, narrowness: 0.0, floor: 1.0 }
    }

    /// Greatest torque at `angle` (rad), N m; always positive.
    ///
    /// ```
    /// let knee = contrapposto::strength::Strength { peak: 203.0, best: 1.133, narrowness: 1.258, floor: 0.1 };
    /// assert_eq!(knee.torque(1.133), 203.0);
    /// assert_eq!(knee.torque(1.133 + 3.0), 20.3);
    /// ```
    pub fn torque(&self, angle: f64) -> f64 {
        self.torque_and_slope(angle).0
    }

    /// Greatest torque (N m) and its slope (N m/rad) at `angle` (rad).
    pub fn torque_and_slope(&self, angle: f64) -> (f64, f64) {
        if self.narrowness == 0.0 {
            return (self.peak, 0.0);
        }
        let phase = self.narrowness * (angle - self.best);
        let share = if phase.abs() < std::f64::consts::FRAC_PI_2 { phase.cos() } else { 0.0 };
        if share > self.floor {
            (self.peak * share, -self.peak * self.narrowness * phase.sin())
        } else {
            (self.peak * self.floor, 0.0)
        }
    }

    /// Second derivative at `angle` (rad), N m/rad^2; 0 on the floor.
    pub(crate) fn curvature(&self, angle: f64) -> f64 {
        let torque = self.torque(angle);
        if torque > self.peak * self.floor { -self.narrowness.powi(2) * torque } else { 0.0 }
    }
}
