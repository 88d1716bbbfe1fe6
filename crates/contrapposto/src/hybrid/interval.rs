//! Gives the interval in which a passive root is searched: Table 2 of Rodriguez & Boulic 2007.

use super::extrapolation::Point;

/// `SameSignMinandMax`: torque has the same sign at both slopes as now (case 3.2).
pub(super) fn same_sign(here: Point, tolerance: f64, range: (Point, Point), slopes: (Point, Point)) -> (Point, Point) {
    if here.torque > tolerance { (range.0, slopes.0) } else { (slopes.1, range.1) }
}

/// `OppoSgnMinandMax`: torque changes sign; the first passive root in the direction of falling torque (case 3.4).
pub(super) fn opposite_sign(
    here: Point,
    tolerance: f64,
    range: (Point, Point),
    slopes: (Point, Point),
) -> (Point, Point) {
    let below = (range.0, slopes.0);
    let above = (slopes.1, range.1);
    if here.torque > tolerance {
        if here.angle < slopes.1.angle { below } else { above }
    } else if here.angle > slopes.0.angle {
        above
    } else {
        below
    }
}
