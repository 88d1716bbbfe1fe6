//! Lists the constants of paths and of the equilibrium of fibres and tendons, with meaning and unit.

// Surfaces (`wrap`, `routing.rs`).

/// Angle short of a full turn from which a line over a cylinder turns by nothing, rad: rounding of a line that only just touches.
pub(super) const FULL_TURN: f64 = 1e-9;
/// Sine of the angle between a line and the way from an end to the center of a sphere below which the line passes through the center;
/// OpenSim's, which does not wrap such a line.
pub(super) const THROUGH_CENTER: f64 = 1e-5;
/// Rounds in which several surfaces of a path move each other's lines, by the geodesic rule.
pub(super) const GEODESIC_ROUNDS: usize = 200;
/// Change of length between two rounds below which a path over several surfaces is at rest by the geodesic rule, m.
pub(super) const GEODESIC_AT_REST: f64 = 1e-15;
/// OpenSim's number of such rounds.
pub(super) const OPENSIM_ROUNDS: usize = 8;
/// OpenSim's change of length below which it stops them, m.
pub(super) const OPENSIM_AT_REST: f64 = 0.0005;
/// Distance along the axis in which OpenSim looks for the plane of a line over a cylinder, m.
pub(super) const OPENSIM_REACH: f64 = 10.0;
/// OpenSim's least slope of that plane against the axis, and the share by which it may exceed its reach.
pub(super) const OPENSIM_PARALLEL: f64 = 1e-5;
/// OpenSim's greatest angle between a straight part and a helix at their common point, rad (0.1 degrees).
pub(super) const OPENSIM_TANGENCY: f64 = 0.001_745_329_251_994_329_5;
/// OpenSim's number of attempts to reach it.
pub(super) const OPENSIM_TANGENCY_TRIES: usize = 100;
/// Length of the pieces into which OpenSim divides a helix, m.
pub(super) const OPENSIM_PIECE: f64 = 0.002;
/// Distance from the range of a conditional point within which OpenSim counts it as inside, rad or m.
pub(super) const RANGE_SLACK: f64 = 1e-5;

// Curves (`curve.rs`).

/// Newton steps to the parameter of a Bezier curve, each safeguarded by bisection.
pub(super) const PARAMETER_STEPS: usize = 60;
/// Difference of two slopes below which a corner of a curve is half way between its ends.
pub(super) const EQUAL_SLOPES: f64 = 1.5e-8;

// Equilibrium of fibre and tendon (`equilibrium.rs`), as shares of the greatest isometric force.

/// Imbalance of forces below which fibre and tendon are in equilibrium.
pub(super) const EQUILIBRIUM: f64 = 1e-13;
/// Steps to the equilibrium, each safeguarded by bisection.
pub(super) const EQUILIBRIUM_STEPS: usize = 200;
/// Stretch of the tendon beyond its slack length from which the search starts.
pub(super) const FIRST_STRETCH: f64 = 0.01;
