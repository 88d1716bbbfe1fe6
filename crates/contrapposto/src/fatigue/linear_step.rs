//! Holds the change of a muscle group under given loads, which is linear as long as the group has not failed.
//!
//! Before failure the three-compartment controller drives `L (TL - MA)` whether the group is below or above its target, so `(MA, MF)` changes by
//! an affine map, and the integral of endurance times does, too. Maps of pieces compose to that of a cycle, and those of cycles to that of hours.

/// `MA -> active[0] MA + active[1]`, `MF -> fatigued[0] MA + fatigued[1] MF + fatigued[2]`. The integral has its share in place of `MF`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearStep {
    pub(super) active: [f64; 2],
    pub(super) fatigued: [f64; 3],
}

/// `MA` and `MF`, or 0 and the share.
pub(super) type Shares = (f64, f64);

impl LinearStep {
    /// Nothing changes.
    pub(super) const IDENTITY: Self = Self { active: [1.0, 0.0], fatigued: [0.0, 1.0, 0.0] };

    /// The step of a group without `MA`: `share -> factor share + constant`.
    pub(super) fn of_share(factor: f64, constant: f64) -> Self {
        Self { active: [0.0, 0.0], fatigued: [0.0, factor, constant] }
    }

    /// The step of a function that is affine, and whose `MA` depends on `MA` alone.
    pub(super) fn of(affine: impl Fn(f64, f64) -> Shares) -> Self {
        let (zero, active, fatigued) = (affine(0.0, 0.0), affine(1.0, 0.0), affine(0.0, 1.0));
        Self { active: [active.0 - zero.0, zero.0], fatigued: [active.1 - zero.1, fatigued.1 - zero.1, zero.1] }
    }

    /// This step, then another one.
    pub(super) fn then(self, next: Self) -> Self {
        let ([a, b], [p, q, r]) = (self.active, self.fatigued);
        let ([c, d], [s, t, u]) = (next.active, next.fatigued);
        Self { active: [c * a, c * b + d], fatigued: [s * a + t * p, t * q, s * b + t * r + u] }
    }

    /// This step so many times.
    pub(super) fn repeated(self, mut times: u64) -> Self {
        let (mut all, mut power) = (Self::IDENTITY, self);
        while times > 0 {
            if times & 1 == 1 {
                all = all.then(power);
            }
            power = power.then(power);
            times >>= 1;
        }
        all
    }

    pub(super) fn apply(&self, (active, fatigued): Shares) -> Shares {
        let [p, q, r] = self.fatigued;
        (self.active[0] * active + self.active[1], p * active + q * fatigued + r)
    }
}
