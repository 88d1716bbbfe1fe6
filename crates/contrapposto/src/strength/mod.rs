//! Computes the greatest torque that a rested muscle group can give at an angle.
//!
//! One shape: `S(q) = peak max(floor, cos(narrowness (q' - best)))`, where `q'` is the nearest angle to `q` that was tested: outside
//! the tested angles the strength at the nearer end is held, an extrapolation. With `narrowness = 0` strength is the same
//! everywhere. Anderson, Madigan & Nussbaum 2007 (J. Biomech. 40:3105-3113, Table 3) use this cosine: `peak = C1 M g H`,
//! `narrowness = C2`, `best = C3`. The floor keeps relative load finite inside the range. Or a measured table, through which a cubic
//! goes that never leaves the two neighbouring values (Fritsch & Carlson 1980).

use std::sync::Arc;

use crate::math::MonotoneCubic;

/// Greatest voluntary torque of one muscle group against angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Strength {
    /// Torque at the best angle, N m, positive. It is not reached where the best angle was not tested.
    pub peak: f64,
    /// Angle of greatest torque, rad.
    pub best: f64,
    /// Rate at which the torque falls off from the best angle, 1/rad, not negative.
    pub narrowness: f64,
    /// Least share of the peak, in 0..=1, positive.
    pub floor: f64,
    /// Least and greatest angle (rad) of the measurement; infinite where no angle is known to lie outside of it.
    pub tested: (f64, f64),
    /// Shares of the peak against angle (rad), in place of the cosine.
    pub table: Option<Arc<MonotoneCubic>>,
}

/// Every angle: nothing is held.
pub const EVERY_ANGLE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl Strength {
    /// The same at every angle.
    pub fn constant(peak: f64) -> Self {
        Self { peak, best: 0.0, narrowness: 0.0, floor: 1.0, tested: EVERY_ANGLE, table: None }
    }

    /// Of measured rows (angle rad, torque N m), angles strictly rising, torques positive, two rows at least; `None` of others. Outside of them
    /// the torque of the nearer end is held.
    ///
    /// ```
    /// use contrapposto::strength::Strength;
    /// let elbow = Strength::tabulated(&[(0.0, 40.0), (1.5, 60.0), (2.5, 30.0)]).unwrap();
    /// assert_eq!([elbow.torque(-1.0), elbow.torque(1.5), elbow.torque(3.0)], [40.0, 60.0, 30.0]);
    /// assert!(Strength::tabulated(&[(0.0, 40.0), (1.0, -1.0)]).is_none());
    /// ```
    pub fn tabulated(rows: &[(f64, f64)]) -> Option<Self> {
        let (first, last) = (rows.first()?, rows.last()?);
        let (best, peak) = rows.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let least = rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min);
        let shares: Vec<(f64, f64)> = rows.iter().map(|(angle, torque)| (*angle, torque / peak)).collect();
        let table = Some(Arc::new(MonotoneCubic::new(&shares).filter(|_| least > 0.0)?));
        Some(Self { peak, best, narrowness: 0.0, floor: least / peak, tested: (first.0, last.0), table })
    }

    /// Greatest torque at `angle` (rad), N m; always positive.
    ///
    /// ```
    /// use contrapposto::strength::Strength;
    /// let knee = Strength { peak: 203.0, best: 1.133, narrowness: 1.258, floor: 0.5, tested: (0.1745, 1.798), table: None };
    /// assert_eq!(knee.torque(1.133), 203.0);
    /// assert_eq!(knee.torque(0.0), 101.5);
    /// assert_eq!(knee.torque(2.3), knee.torque(1.798));
    /// assert!(knee.is_floor(0.0) && !knee.is_floor(1.133));
    /// ```
    pub fn torque(&self, angle: f64) -> f64 {
        self.torque_and_slope(angle).0
    }

    /// Greatest torque (N m) and its slope (N m/rad) at `angle` (rad).
    pub fn torque_and_slope(&self, angle: f64) -> (f64, f64) {
        if let Some(table) = &self.table {
            let at = angle.clamp(self.tested.0, self.tested.1);
            let (share, slope) = table.piece_at(at).value_and_slope(at);
            return (self.peak * share, if self.is_extrapolated(angle) { 0.0 } else { self.peak * slope });
        }
        if self.narrowness == 0.0 {
            return (self.peak, 0.0);
        }
        let phase = self.narrowness * (angle.clamp(self.tested.0, self.tested.1) - self.best);
        let share = if phase.abs() < std::f64::consts::FRAC_PI_2 { libm::cos(phase) } else { 0.0 };
        if share <= self.floor {
            return (self.peak * self.floor, 0.0);
        }
        let slope = if self.is_extrapolated(angle) { 0.0 } else { -self.peak * self.narrowness * libm::sin(phase) };
        (self.peak * share, slope)
    }

    /// Second derivative at `angle` (rad), N m/rad^2; 0 on the floor and outside the tested angles.
    pub(crate) fn curvature(&self, angle: f64) -> f64 {
        if let Some(table) = &self.table {
            let curvature = table.piece_at(angle).curvature(angle);
            return if self.is_extrapolated(angle) { 0.0 } else { self.peak * curvature };
        }
        let torque = self.torque(angle);
        let flat = torque <= self.peak * self.floor || self.is_extrapolated(angle);
        if flat { 0.0 } else { -self.narrowness.powi(2) * torque }
    }

    /// `angle` (rad) lies outside the tested angles.
    pub fn is_extrapolated(&self, angle: f64) -> bool {
        angle < self.tested.0 || angle > self.tested.1
    }

    /// The strength at `angle` (rad) is the floor: the least share of the peak, which the cosine falls below there.
    pub fn is_floor(&self, angle: f64) -> bool {
        self.is_floor_torque(self.torque(angle))
    }

    /// A strength of `torque` (N m) at some angle is the floor.
    pub fn is_floor_torque(&self, torque: f64) -> bool {
        self.narrowness > 0.0 && self.floor < 1.0 && torque <= self.peak * self.floor
    }

    /// Greatest torque at any angle, N m.
    pub fn greatest(&self) -> f64 {
        self.torque(self.best)
    }

    /// `times` the torque at every angle; `times` is positive.
    #[must_use]
    pub fn scaled(self, times: f64) -> Self {
        Self { peak: times * self.peak, ..self }
    }

    /// The same strength of a coordinate that counts the other way round.
    #[must_use]
    pub fn mirrored(self) -> Self {
        let table = self.table.map(|table| Arc::new(table.mirrored()));
        Self { best: -self.best, tested: (-self.tested.1, -self.tested.0), table, ..self }
    }
}
