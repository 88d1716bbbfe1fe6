//! Defines the half-space `a^T theta <= b` in which the posture must stay (Eq. 4).

use serde::{Deserialize, Serialize};

/// A hard linear inequality `normal . posture <= offset` on the coordinates, normal of unit length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HalfSpace {
    /// `a`, one entry a coordinate (Eq. 5).
    pub normal: Vec<f64>,
    /// `b` (Eq. 6).
    pub offset: f64,
}

impl HalfSpace {
    /// No inequality yet: space for `n` coordinates, to be filled by [`HalfSpace::ask_for`].
    pub fn new(n: usize) -> Self {
        Self { normal: vec![0.0; n], offset: 0.0 }
    }

    /// Asks for `step` from `posture`: `a = -step/|step|`, `b = a . (posture + step)` (Eqs. 5, 6). Does not allocate.
    ///
    /// Returns `false` for a zero step, which has no direction to ask for; the half-space is then the whole space.
    pub fn ask_for(&mut self, posture: &[f64], step: &[f64]) -> bool {
        let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.normal.fill(0.0);
        self.offset = 0.0;
        if length.is_nan() || length <= 0.0 {
            return false;
        }
        for ((a, q), d) in self.normal.iter_mut().zip(posture).zip(step) {
            *a = -d / length;
            self.offset += *a * (q + d);
        }
        true
    }

    /// Puts the boundary through `posture`.
    pub(crate) fn hold(&mut self, posture: &[f64]) {
        self.offset += self.violation(posture);
    }

    /// Distance by which `posture` lies outside; not positive inside.
    pub(crate) fn violation(&self, posture: &[f64]) -> f64 {
        self.normal.iter().zip(posture).map(|(a, q)| a * q).sum::<f64>() - self.offset
    }

    /// Moves `posture` to the nearest point of the half-space, changing only the coordinates marked `free`.
    ///
    /// Returns `false` when no free coordinate enters the inequality and the posture stays outside.
    pub(crate) fn project(&self, posture: &mut [f64], free: &[bool]) -> bool {
        let excess = self.violation(posture);
        if excess <= 0.0 {
            return true;
        }
        let size: f64 = self.normal.iter().zip(free).filter(|(_, free)| **free).map(|(a, _)| a * a).sum();
        if size <= 0.0 {
            return false;
        }
        for ((q, a), _) in posture.iter_mut().zip(&self.normal).zip(free).filter(|(_, free)| **free) {
            *q -= a * excess / size;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::HalfSpace;

    #[test]
    fn projection_lands_on_the_wanted_plane() {
        let posture = [0.3, -1.0, 2.0];
        let step = [0.1, 0.0, -0.2];
        let mut plane = HalfSpace::new(3);
        assert!(plane.ask_for(&posture, &step));
        assert!((plane.violation(&posture) - 0.05f64.sqrt()).abs() < 1e-15);
        let mut moved = posture;
        assert!(plane.project(&mut moved, &[true; 3]));
        for i in 0..3 {
            assert!((moved[i] - posture[i] - step[i]).abs() < 1e-15);
        }
        let mut held = posture;
        assert!(plane.project(&mut held, &[true, true, false]));
        assert!(plane.violation(&held).abs() < 1e-15 && held[2] == posture[2]);
        assert!(!plane.project(&mut posture.clone(), &[false, true, false]));
        assert!(!plane.ask_for(&posture, &[0.0; 3]) && plane.project(&mut posture.clone(), &[true; 3]));
    }
}
