//! Computes the length of one step toward the goal angle (Eq. 9).
//!
//! `delta theta = min(beta (theta_g - theta_c), delta theta_max)` as printed clips upward motion only; the size is meant
//! (docs/deviations.md, D2).

/// The step toward `goal` from `angle` (rad): a share `gain` of the way, in size at most `max_step`.
pub fn relief_step(goal: f64, angle: f64, gain: f64, max_step: f64) -> f64 {
    (gain * (goal - angle)).clamp(-max_step, max_step)
}

#[cfg(test)]
mod tests {
    use super::relief_step;

    #[test]
    fn step_is_clipped_in_size() {
        let printed = |goal: f64, angle: f64, gain: f64, max: f64| (gain * (goal - angle)).min(max);
        assert_eq!(printed(0.0, 1.0, 0.5, 0.1), -0.5); // downward, five times the greatest step
        assert_eq!(relief_step(0.0, 1.0, 0.5, 0.1), -0.1);
        assert_eq!(relief_step(1.0, 0.0, 0.5, 0.1), 0.1);
        assert_eq!(relief_step(0.1, 0.0, 0.5, 0.1), 0.05);
    }
}
