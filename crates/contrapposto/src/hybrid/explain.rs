//! Writes the reason of a decision as one sentence.

use super::{Carrier, Case, Decision, Equilibrium, Outcome, Problem, Strategy};

/// The decision and its reason in one sentence, angles in degrees, torques in N m.
///
/// ```
/// use contrapposto::hybrid::{Problem, Strategy, explain, minimise};
/// use contrapposto::passive::{DoubleExponential, End, PassiveCurve};
/// let end = |angle| End { torque: 10.0, rate: 10.0, angle };
/// let form = DoubleExponential { lower: end(0.0), upper: end(2.0), stiffness: 0.0, neutral: 0.0 }.form()?;
/// let curve = PassiveCurve::new(form, (0.0, 2.0), None)?;
/// let problem = Problem {
///     curve: &curve,
///     angle: 0.5,
///     external_torque: -2.0,
///     external_slope: 0.5,
///     strategy: Strategy::Passive,
///     minimum_decrease_ratio: 0.9,
///     torque_tolerance: 0.05,
///     accepted: None,
/// };
/// let sentence = explain(&problem, &minimise(&problem)?);
/// assert_eq!(
///     sentence,
///     "case 3.2 (passive strategy): balance at 8.74 deg takes 1.933 N m off the muscles, stable by ligaments"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn explain(problem: &Problem, decision: &Decision) -> String {
    let torque = decision.active_torque;
    let at_goal = decision.active_torque_at_goal.unwrap_or(torque);
    let goal = decision.goal.unwrap_or(problem.angle).to_degrees();
    let tolerance = problem.torque_tolerance;
    let in_force = problem.accepted.unwrap_or(problem.strategy);
    let strategy = match in_force {
        Strategy::Active => "active",
        Strategy::Passive => "passive",
    };
    let body = match decision.outcome {
        Outcome::Stay if torque.abs() <= tolerance => {
            format!("active torque {torque:.3} N m is within {tolerance} N m: stay")
        }
        Outcome::Stay => format!("active torque {torque:.3} N m is the least in reach: stay"),
        Outcome::None => {
            let (from, to) = decision.interval.unwrap_or(problem.curve.range());
            format!(
                "the printed table searches {:.2}..{:.2} deg, where active torque {torque:.3} N m does not change sign",
                from.to_degrees(),
                to.to_degrees()
            )
        }
        Outcome::AtLimit => format!(
            "the range holds no balance, because passive torque at a limit is too weak; the limit at {goal:.2} deg leaves \
             {at_goal:.3} of {torque:.3} N m"
        ),
        Outcome::LeastTorque if decision.case == Case::C31 => {
            let share = 100.0 * decision.decrease_ratio.unwrap_or(0.0);
            format!(
                "least torque between the slope angles at {goal:.2} deg removes {share:.0} percent of {torque:.3} N m; no balance"
            )
        }
        Outcome::LeastTorque => format!(
            "least torque at {goal:.2} deg leaves {at_goal:.3} of {torque:.3} N m; neither a stable nor an unstable balance"
        ),
        Outcome::Active | Outcome::Passive => match (decision.case, decision.decrease_ratio) {
            (Case::C32, Some(ratio)) if in_force == Strategy::Active => format!(
                "mid-range would remove {:.0} percent of {torque:.3} N m, not more than {:.0}; balance at {goal:.2} deg instead",
                100.0 * ratio.max(0.0),
                100.0 * problem.minimum_decrease_ratio
            ),
            _ => format!("balance at {goal:.2} deg takes {:.3} N m off the muscles", torque.abs()),
        },
    };
    let kind =
        decision.equilibrium.map_or_else(String::new, |equilibrium| format!(", {}", equilibrium_in_words(equilibrium)));
    let beyond = if decision.beyond_tables { "; the printed table has no such answer" } else { "" };
    format!("case {} ({strategy} strategy): {body}{kind}{beyond}", decision.case)
}

/// The goal of a decision in words that follow its value: `a balance, stable by ligaments`.
pub fn goal_in_words(decision: &Decision) -> String {
    match (decision.outcome, decision.equilibrium) {
        (Outcome::Stay, Some(_)) => "where muscles hold almost nothing".to_owned(),
        (Outcome::None, _) => "because the printed tables give no goal".to_owned(),
        (Outcome::AtLimit, _) => "the end of its range, where muscles hold least".to_owned(),
        (_, Some(equilibrium)) => format!("a balance, {}", equilibrium_in_words(equilibrium)),
        (_, None) => "where muscles hold least".to_owned(),
    }
}

fn equilibrium_in_words(equilibrium: Equilibrium) -> &'static str {
    match equilibrium {
        Equilibrium::Stable(Carrier::Ligaments) => "stable by ligaments",
        Equilibrium::Stable(Carrier::Gravity) => "stable by the load, as a pendulum",
        Equilibrium::Unstable => "unstable, held by attention",
    }
}
