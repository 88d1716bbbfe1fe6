//! Table 1 of Rodriguez & Boulic 2007, and what is done where its text has no answer.
//!
//! `table_1` below is the printed table, branch by branch. [`minimise_literal`] carries it out as it stands.
//! [`minimise`] carries it out and then closes its gaps (docs/deviations.md, D3 to D6, D11, D12): where the table searches an
//! interval without a root, the root that does exist is taken, and where none exists the angle of least torque.

use super::case::{Carrier, Case, Decision, Equilibrium, Outcome, Strategy};
use super::extrapolation::{Extrapolation, Point};
use super::interval::{opposite_sign, same_sign};
use super::problem::{Problem, ProblemError};
use crate::passive::SlopeAngles;

/// The request of a branch of Table 1.
enum Request {
    /// `theta_g := theta_c`.
    Stay,
    /// `theta_g := Dichotomy(interval)`.
    Root((Point, Point)),
    /// `theta_g := angle`, the least torque between the slopes.
    Least(f64),
}

/// Result of the search.
#[derive(Clone, Copy)]
enum Goal {
    /// The present angle.
    Stay,
    /// An angle without active torque.
    Root(f64),
    /// An angle with the least torque, but some.
    Least(f64),
}

/// Reading of the printed conditions.
#[derive(Clone, Copy, PartialEq)]
enum Reading {
    Literal,
    Total,
}

/// Decides where relief lies. Total: the goal is always set, lies in the range, and its extrapolated active torque is
/// never larger than the present one.
///
/// ```
/// use contrapposto::hybrid::{Case, Outcome, Problem, Strategy, minimise};
/// use contrapposto::passive::{DoubleExponential, End, PassiveCurve};
/// let range = (0.0, 150f64.to_radians());
/// let elbow = DoubleExponential {
///     lower: End { torque: 12.67, rate: 19.92, angle: 0.0 },
///     upper: End { torque: 9.324, rate: 3.811, angle: range.1 },
///     stiffness: 0.0,
///     neutral: 0.0,
/// };
/// let curve = PassiveCurve::new(elbow.form()?, range, None)?;
/// let decision = minimise(&Problem {
///     curve: &curve,
///     angle: 20f64.to_radians(),
///     external_torque: -2.7,
///     external_slope: 0.9,
///     strategy: Strategy::Active,
///     minimum_decrease_ratio: 0.9,
///     torque_tolerance: 0.05,
///     accepted: None,
/// })?;
/// assert_eq!((decision.case, decision.outcome), (Case::C32, Outcome::Passive));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ProblemError`] for numbers that are not finite, an angle outside the range, a ratio outside 0..=1, a negative tolerance.
pub fn minimise(problem: &Problem) -> Result<Decision, ProblemError> {
    problem.check()?;
    let active = Extrapolation::new(problem);
    let (mut decision, request) = table_1(problem, &active, Reading::Total);
    let goal = match request {
        Request::Stay => Goal::Stay,
        Request::Least(angle) => Goal::Least(angle),
        Request::Root(interval) => {
            match one_slope_active(problem, &active, &mut decision).or_else(|| active.root(interval)) {
                Some(root) => Goal::Root(root),
                None => {
                    decision.beyond_tables = true;
                    match nearest_root(problem, &active, &mut decision) {
                        Some(root) => Goal::Root(root),
                        None => least_torque(problem, &active, decision.active_torque),
                    }
                }
            }
        }
    };
    describe(problem, &active, &mut decision, goal);
    if decision.active_torque_at_goal.is_some_and(|torque| torque.abs() > decision.active_torque.abs()) {
        describe(problem, &active, &mut decision, Goal::Stay); // nothing left to gain but rounding
    }
    Ok(decision)
}

/// Decides as the printed Tables 1 and 2 do; an interval whose ends have the same sign gives [`Outcome::None`].
/// [`Problem::accepted`] plays no part.
///
/// ```
/// use contrapposto::hybrid::{Outcome, Problem, Strategy, minimise, minimise_literal};
/// use contrapposto::passive::{DoubleExponential, End, PassiveCurve};
/// let end = |angle| End { torque: 10.0, rate: 10.0, angle };
/// let form = DoubleExponential { lower: end(0.0), upper: end(2.0), stiffness: 0.0, neutral: 0.0 }.form()?;
/// let curve = PassiveCurve::new(form, (0.0, 2.0), None)?;
/// let too_heavy = Problem {
///     curve: &curve,
///     angle: 1.0,
///     external_torque: -25.0,
///     external_slope: 0.0,
///     strategy: Strategy::Passive,
///     minimum_decrease_ratio: 0.9,
///     torque_tolerance: 0.05,
///     accepted: None,
/// };
/// assert_eq!(minimise_literal(&too_heavy)?.outcome, Outcome::None);
/// assert_eq!((minimise(&too_heavy)?.outcome, minimise(&too_heavy)?.goal), (Outcome::AtLimit, Some(0.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`minimise`].
pub fn minimise_literal(problem: &Problem) -> Result<Decision, ProblemError> {
    problem.check()?;
    let active = Extrapolation::new(problem);
    let (mut decision, request) = table_1(problem, &active, Reading::Literal);
    let goal = match request {
        Request::Stay => Some(Goal::Stay),
        Request::Least(angle) => Some(Goal::Least(angle)),
        Request::Root(interval) => active.root(interval).map(Goal::Root),
    };
    if let Some(goal) = goal {
        describe(problem, &active, &mut decision, goal);
    }
    Ok(decision)
}

/// The printed table.
fn table_1(problem: &Problem, active: &Extrapolation, reading: Reading) -> (Decision, Request) {
    let eps = problem.torque_tolerance;
    let here = active.at(problem.angle);
    let tau_a = here.torque;
    let range = active.limits();
    // The total reading counts torque equal to the tolerance as within it, so that a tolerance of 0 means something.
    let within = tau_a.abs() < eps || (reading == Reading::Total && tau_a.abs() == eps);
    let slope_angles = problem.curve.slope_angles(-active.external_slope());
    let mut ratio = None;

    let (case, request) = match (slope_angles.lower, slope_angles.upper) {
        (Some(s_min), Some(s_max)) => {
            let (s_min, s_max) = (active.at(s_min), active.at(s_max));
            let (at_min, at_max) = (sign(s_min.torque), sign(s_max.torque));
            if within {
                let between = s_min.angle < here.angle && here.angle < s_max.angle;
                // On a slope angle itself the printed strict inequalities hold on neither side; the total reading counts it
                // as outside, unless the tables find the balance that lies on both slope angles.
                let on_slope = here.angle == s_min.angle || here.angle == s_max.angle;
                let outside = if on_slope { reading == Reading::Total && at_min != 0 } else { !between };
                if between || (outside && at_min == at_max) {
                    (Case::C21, Request::Stay)
                } else if wants_active(problem, reading) {
                    (Case::C22, Request::Root((s_min, s_max)))
                } else {
                    (Case::C23, Request::Stay)
                }
            } else if sign(tau_a) == at_min && sign(tau_a) == at_max {
                let least = if tau_a > 0.0 { s_max } else { s_min };
                let decrease = ((tau_a - least.torque) / tau_a).max(-f64::MAX);
                ratio = Some(decrease);
                if wants_active(problem, reading) && enough(problem, decrease, reading) {
                    (Case::C31, Request::Least(least.angle))
                } else {
                    (Case::C32, Request::Root(same_sign(here, eps, range, (s_min, s_max))))
                }
            } else if wants_active(problem, reading) {
                (Case::C33, Request::Root((s_min, s_max)))
            } else {
                (Case::C34, Request::Root(opposite_sign(here, eps, range, (s_min, s_max))))
            }
        }
        // None or one slope.
        _ if within => (Case::C11, Request::Stay),
        _ if tau_a > eps => (Case::C12, Request::Root((range.0, here))),
        _ => (Case::C13, Request::Root((here, range.1))),
    };
    let interval = if let Request::Root((from, to)) = request { Some((from.angle, to.angle)) } else { None };
    (Decision { decrease_ratio: ratio, interval, ..Decision::without_goal(case, tau_a, slope_angles) }, request)
}

/// The strategy in force: one accepted earlier in this recovery is kept (D4).
fn wants_active(problem: &Problem, reading: Reading) -> bool {
    let kept = if reading == Reading::Total { problem.accepted } else { None };
    kept.unwrap_or(problem.strategy) == Strategy::Active
}

/// Whether the active solution of case 3.1 is good enough: `R > R_min`; once accepted, as long as it does not worsen (D4).
fn enough(problem: &Problem, decrease: f64, reading: Reading) -> bool {
    let kept = reading == Reading::Total && problem.accepted == Some(Strategy::Active);
    // At the goal itself R is zero but for rounding.
    if kept { decrease > -1e-9 } else { decrease > problem.minimum_decrease_ratio }
}

/// With one slope in the range the torque falls on one side of it only; if it changes sign there, that root is the
/// active solution, which the printed cases 1.2 and 1.3 overlook (D5).
fn one_slope_active(problem: &Problem, active: &Extrapolation, decision: &mut Decision) -> Option<f64> {
    let (min, max) = active.limits();
    let falling = match decision.slope_angles {
        SlopeAngles { lower: Some(s), upper: None } => (active.at(s), max),
        SlopeAngles { lower: None, upper: Some(s) } => (min, active.at(s)),
        _ => return None,
    };
    if !wants_active(problem, Reading::Total) {
        return None;
    }
    let root = active.root(falling)?;
    decision.interval = Some((falling.0.angle, falling.1.angle));
    decision.beyond_tables = true;
    Some(root)
}

/// Of all roots in the range the one that suits the strategy in force, the nearest first; the other kind if there is
/// none. Searches every piece on which the extrapolated torque is monotone, so no root is missed.
fn nearest_root(problem: &Problem, active: &Extrapolation, decision: &mut Decision) -> Option<f64> {
    let wants_stable = !wants_active(problem, Reading::Total);
    let mut best = (true, f64::INFINITY);
    let mut nearest = None;
    for_each_piece(problem, active, |piece| {
        let Some(root) = active.root(piece) else { return };
        let stable = piece.1.torque > piece.0.torque;
        let rank = (stable != wants_stable, (root - problem.angle).abs());
        if rank < best {
            best = rank;
            nearest = Some(root);
            decision.interval = Some((piece.0.angle, piece.1.angle));
        }
    });
    nearest
}

/// The angle of least torque where no balance exists: a limit or one of the slope angles. Ties go to the
/// present angle.
fn least_torque(problem: &Problem, active: &Extrapolation, present: f64) -> Goal {
    let mut best = (present.abs(), Goal::Stay);
    for_each_piece(problem, active, |piece| {
        for end in [piece.0, piece.1] {
            if end.torque.abs() < best.0 {
                best = (end.torque.abs(), Goal::Least(end.angle));
            }
        }
    });
    best.1
}

/// Ends of pieces that one pass over the curve gathers: more than any but a long table has.
const GATHERED: usize = 8;

/// The pieces of the range on which the extrapolated torque is monotone, from below.
fn for_each_piece(problem: &Problem, active: &Extrapolation, mut visit: impl FnMut((Point, Point))) {
    let (mut from, max) = active.limits();
    while from.angle < max.angle {
        // The nearest ends above, in order.
        let mut ends = [max.angle; GATHERED];
        problem.curve.crossings(-active.external_slope(), |angle| {
            let place = ends.partition_point(|end| *end < angle);
            if angle > from.angle && place < GATHERED && ends[place] != angle {
                ends[place..].rotate_right(1);
                ends[place] = angle;
            }
        });
        for end in ends {
            if end > from.angle {
                let to = if end < max.angle { active.at(end) } else { max };
                visit((from, to));
                from = to;
            }
        }
    }
}

/// Fills in goal, outcome, torque and kind of balance.
fn describe(problem: &Problem, active: &Extrapolation, decision: &mut Decision, goal: Goal) {
    let range = problem.curve.range();
    let angle = match goal {
        Goal::Stay => problem.angle,
        Goal::Root(angle) | Goal::Least(angle) => angle,
    };
    let (torque, slope) = active.active_and_slope(angle);
    let balance = match goal {
        Goal::Stay => torque.abs() <= problem.torque_tolerance,
        Goal::Root(_) => true,
        Goal::Least(_) => false,
    };
    let equilibrium = if balance { equilibrium(slope, active.external_slope()) } else { None };
    let unbalanced_limit = !balance && decision.case != Case::C31 && (angle == range.0 || angle == range.1);
    decision.goal = Some(angle);
    decision.active_torque_at_goal = Some(torque);
    decision.equilibrium = equilibrium;
    decision.outcome = match equilibrium {
        _ if angle == problem.angle => Outcome::Stay,
        Some(Equilibrium::Stable(_)) => Outcome::Passive,
        Some(Equilibrium::Unstable) => Outcome::Active,
        None if unbalanced_limit => Outcome::AtLimit,
        None => Outcome::LeastTorque,
    };
}

/// Kind of a balance where the active torque has the slope `slope` and the external torque `external_slope` (N m/rad);
/// `None` on level torque.
fn equilibrium(slope: f64, external_slope: f64) -> Option<Equilibrium> {
    let (by_load, by_tissue) = (-external_slope, slope + external_slope);
    if slope > 0.0 {
        Some(Equilibrium::Stable(if by_tissue >= by_load { Carrier::Ligaments } else { Carrier::Gravity }))
    } else if slope < 0.0 {
        Some(Equilibrium::Unstable)
    } else {
        None
    }
}

/// Sign with zero as its own: the printed comparisons of signs treat it so.
fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}
