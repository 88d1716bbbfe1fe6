//! In which interval is a passive root searched? Table 2 of the paper.

/// `SameSignMinandMax`: torque has the same sign at both slopes as now (case 3.2).
pub(super) fn same_sign(tau_a: f64, tolerance: f64, range: (f64, f64), slopes: (f64, f64)) -> (f64, f64) {
    if tau_a > tolerance { (range.0, slopes.0) } else { (slopes.1, range.1) }
}

/// `OppoSgnMinandMax`: torque changes sign; the first passive root in the direction of falling torque (case 3.4).
pub(super) fn opposite_sign(
    tau_a: f64,
    tolerance: f64,
    angle: f64,
    range: (f64, f64),
    slopes: (f64, f64),
) -> (f64, f64) {
    let below = (range.0, slopes.0);
    let above = (slopes.1, range.1);
    if tau_a > tolerance {
        if angle < slopes.1 { below } else { above }
    } else if angle > slopes.0 {
        above
    } else {
        below
    }
}
