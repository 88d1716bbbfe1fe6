//! Lists the constants of paths and of the equilibrium of fibres and tendons, with meaning and unit.

// Surfaces (`wrap`, `routing.rs`).

/// Angle short of a full turn from which a line over a cylinder turns by nothing, rad: rounding of a line that only just touches.
pub(super) const FULL_TURN: f64 = 1e-9;
/// Sine of the angle between a line and the way from an end to the center of a sphere below which the line passes through the center;
/// OpenSim's, which does not wrap such a line.
pub(super) const THROUGH_CENTER: f64 = 1e-5;
/// By how much a point may lie inside an ellipsoid, as a share of the squared half axes, and still count as on it; and the difference from 1
/// of the cosine between both ends below which they lie in one direction from the center. OpenSim's.
pub(super) const ELLIPSOID_ON: f64 = 1e-4;
/// OpenSim's distance from a plane of symmetry below which a place lies in it; the mean half axis is 1.
pub(super) const ELLIPSOID_PLANE: f64 = 2e-13;
/// OpenSim's cosine between a line and the nearest axis up to which the fan alone determines the plane of a line over an ellipsoid.
pub(super) const ELLIPSOID_FAN_BELOW: f64 = 0.7073;
/// The cosine from which the plane of symmetry alone does.
pub(super) const ELLIPSOID_AXIAL_FROM: f64 = 0.9;
/// Share of the chord at either end over which the plane of symmetry loses its weight.
pub(super) const ELLIPSOID_FADE: f64 = 0.3;
/// OpenSim's number of parts of the chord for the fan.
pub(super) const ELLIPSOID_BLADES: u32 = 300;
/// Length of the pieces into which OpenSim divides a line on an ellipsoid, m.
pub(super) const ELLIPSOID_PIECE: f64 = 0.001;
/// OpenSim's greatest number of such pieces.
pub(super) const ELLIPSOID_PIECES: u32 = 499;
/// Residual at which OpenSim's search of the nearest point of an ellipsoid ends; the mean half axis is 1.
pub(super) const NEAREST_RESIDUAL: f64 = 1e-9;
/// Greatest number of steps of OpenSim's search of the nearest point of an ellipsoid.
pub(super) const NEAREST_STEPS: usize = 64;
/// Sum of squares of residuals at which OpenSim's search of a point of tangency ends; the mean half axis is 1.
pub(super) const TANGENCY_RESIDUAL: f64 = 1e-8;
/// Greatest number of steps of OpenSim's search of a point of tangency.
pub(super) const TANGENCY_STEPS: usize = 50;
/// Greatest number of repetitions of a step of OpenSim's search of a point of tangency.
pub(super) const TANGENCY_REPEATS: usize = 1000;
/// Length of the tube that OpenSim takes for a torus, m.
pub(super) const TORUS_TUBE: f64 = 10_000.0;
/// Relative accuracy of OpenSim's search of the point of a torus's circle nearest to a line.
pub(super) const TORUS_ACCURACY: f64 = 1e-4;
/// First trust radius of OpenSim's search on a torus's circle, m.
pub(super) const TORUS_FIRST_STEP: f64 = 0.2;
/// Step of a difference in OpenSim's search on a torus's circle, m.
pub(super) const TORUS_NUDGE: f64 = 1e-5;
/// Greatest number of steps of OpenSim's search on a torus's circle.
pub(super) const TORUS_STEPS: usize = 500;
/// Greatest section of a geodesic that is extrapolated from [`GEODESIC_PARTS`], rad.
pub(super) const GEODESIC_SECTION: f64 = 0.75;
/// Greatest number of sections.
pub(super) const GEODESIC_SECTIONS: usize = 16;
/// Numbers of parts into which a section of a geodesic is divided for the extrapolation.
pub(super) const GEODESIC_PARTS: [u32; 6] = [2, 4, 6, 8, 10, 12];
/// Steps in which a geodesic is brought to pass through the end of a line.
pub(super) const GEODESIC_STEPS: usize = 25;
/// Step of both unknowns of a geodesic below which it passes through the end: rad, and shares of the mean half axis or m.
pub(super) const GEODESIC_FOUND: f64 = 1e-11;
/// Greatest step of the angle at which a geodesic starts, rad.
pub(super) const GEODESIC_TURN: f64 = 0.3;
/// Step of that angle from which on the derivatives of the step before are kept, rad.
pub(super) const GEODESIC_SMALL: f64 = 1e-4;
/// Difference of that angle for its derivative, rad.
pub(super) const GEODESIC_NUDGE: f64 = 1e-6;
/// Least distance of an end from a surface, as a share of its size: a nearer end counts as this far outside.
pub(super) const GEODESIC_OUTSIDE: f64 = 1e-8;
/// Planes through a line that are compared for the start of a geodesic over an ellipsoid.
pub(super) const GEODESIC_PLANES: usize = 24;
/// Pieces of the section of each plane for that comparison.
pub(super) const GEODESIC_PIECES: usize = 8;
/// Steps to the place where the shortest way through a ring bends, the first guess of a geodesic over a torus.
pub(super) const TORUS_BENDS: usize = 12;
/// Rounds in which several surfaces of a path move each other's lines, by the geodesic rule.
pub(super) const GEODESIC_ROUNDS: usize = 200;
/// Way of a corner between two rounds below which a path over several surfaces is at rest by the geodesic rule, m.
pub(super) const GEODESIC_AT_REST: f64 = 1e-14;
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

/// Steps in which the spread of neighbouring lines on an ellipsoid or a torus is integrated.
pub(super) const SPREAD_STEPS: usize = 192;

/// Points of a drawn line on each surface, both ends among them: chords of a quarter turn stay within 1.3 % of the radius of the surface.
pub(super) const ARC_POINTS: usize = 6;
/// Steps of the integration between two of them: an arc of half a turn ends within 1e-5 of its radius.
pub(super) const ARC_STEPS: usize = 4;

// Tendons of MuJoCo (`tendon/`).

/// Radius, distance or square of a distance below which MuJoCo counts it as nothing, m or m^2.
pub(super) const MUJOCO_LEAST: f64 = 1e-15;
/// Steps to the point at which a line touches a surface from within, each safeguarded by bisection.
pub(super) const INSIDE_STEPS: usize = 100;

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

// Static optimisation (`static_optimisation.rs`).

/// Singular value of the equations over their largest entry below which their multipliers are not determined.
pub(super) const LEAST_SINGULAR: f64 = 1e-12;

// Fatigue (`fatigue.rs`, `hold.rs`, `shared_torques.rs`).

/// Greatest multiple of torques that is looked for, where they are almost none.
pub(super) const MOST_TIMES: f64 = 1e6;
/// Spare capacity of a muscle, as a share of its capacity, up to which it is exhausted.
pub(super) const AT_CAPACITY: f64 = 1e-9;
/// First step of a hold, s.
pub(super) const FIRST_HOLD_STEP: f64 = 1.0;
/// Longest step of a hold, s.
pub(super) const LONGEST_HOLD_STEP: f64 = 60.0;
/// Share of a muscle by which it is more tired at a break than at the one before, up to which breaks suffice for ever.
pub(super) const STEADY_FATIGUE: f64 = 1e-6;
/// Greatest change of an activation within a step of a hold that is longer than [`EXHAUSTION_STEP`].
pub(super) const MOST_LOAD_CHANGE: f64 = 0.005;
/// Longest step of a hold in which a muscle may become exhausted, s.
pub(super) const EXHAUSTION_STEP: f64 = 0.1;
/// Time to which the instant of failure is known, s.
pub(super) const INSTANT: f64 = 1e-7;
