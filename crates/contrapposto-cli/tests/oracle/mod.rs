//! An independent implementation of Tables 1 and 2 of Rodriguez & Boulic (2007), written from the paper alone,
//! by plain scanning and bisection, used by `minimize_agrees_with_oracle`.
//!
//! It shares no code with the library. Nothing is solved in closed form: flattest angle, slopes and roots
//! are all bisected to the narrowest bracket `f64` allows. The printed text is taken literally, with two readings:
//! `tau_c` (a slip of the paper) is `tau_e`, and the slopes are the angles where `d tau_p = -d tau_e`.
//! Angles are in radians, torques in N m.
//!
//! What the printed tables leave open, and what is done here:
//!
//! - an active torque of exactly `eps` fails `|tau_a| < eps` and also `tau_a > eps`, so it is handled as negative;
//! - `theta_c` equal to a slope is neither between the slopes nor outside them: case 2.2 or 2.3, never 2.1;
//! - `sign(0)` is 0, which equals only another 0;
//! - a straight passive curve has no flattest angle, hence no slopes; a double root at the flattest angle is
//!   not two slopes;
//! - a search between ends of the same sign has no goal; an end that is exactly zero is the goal (the lower first).
//!
//! Every comparison which decided the outcome and was close sets [`Answer::near_tie`]: there, two correct
//! implementations may differ by rounding alone.

#![allow(dead_code, unreachable_pub)] // test support: each test uses what it needs

/// Closeness of a comparison: N m, radians, or a share of the torque.
const TIE: f64 = 1e-9;
/// Rounding allowed in a torque, as a share of the largest of its terms.
const ROUNDING: f64 = 1e-12;
/// Largest exponent passed to `exp`: keeps sums of two terms, and their ratios, finite.
const MAX_EXPONENT: f64 = 650.0;

/// The passive curve `a_l exp(-b_l (q - q_l)) - a_u exp(b_u (q - q_u)) - k (q - q_mid)`, with `a, b, k >= 0`.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    /// Torque of the lower exponential at `q_l`.
    pub a_l: f64,
    /// Rate of the lower exponential, 1/rad.
    pub b_l: f64,
    /// Reference angle of the lower exponential.
    pub q_l: f64,
    /// Torque of the upper exponential at `q_u`.
    pub a_u: f64,
    /// Rate of the upper exponential, 1/rad.
    pub b_u: f64,
    /// Reference angle of the upper exponential.
    pub q_u: f64,
    /// Mid-range stiffness, N m/rad.
    pub k: f64,
    /// Angle without mid-range torque.
    pub q_mid: f64,
}

/// Everything Table 1 asks for.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    /// Passive curve, known over the whole range.
    pub curve: Curve,
    /// Lower limit `theta_min`.
    pub q_min: f64,
    /// Upper limit `theta_max`.
    pub q_max: f64,
    /// Present angle `theta_c`.
    pub q_c: f64,
    /// External torque at `q_c`.
    pub tau_e: f64,
    /// Slope of the external torque at `q_c`.
    pub d_tau_e: f64,
    /// Active strategy (otherwise passive).
    pub active: bool,
    /// Least accepted decrease ratio `R_min` of the active strategy.
    pub r_min: f64,
    /// Tolerance `eps` on the active torque.
    pub eps: f64,
}

/// The answer of Tables 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Printed case, such as `"3.2"`.
    pub case: &'static str,
    /// Goal angle; `None` where the searched interval has no sign change.
    pub goal: Option<f64>,
    /// Interval searched by dichotomy, as printed; `None` where nothing is searched.
    pub interval: Option<(f64, f64)>,
    /// Slope angles found in the range, below and above the flattest angle.
    pub slopes: (Option<f64>, Option<f64>),
    /// `R` of the candidate of case 3.1, under either strategy; only where both signs equal the present one.
    pub decrease_ratio: Option<f64>,
    /// A comparison which decided the outcome was too close to call.
    pub near_tie: bool,
}

impl Curve {
    /// The two exponential terms `(a_l exp(..), a_u exp(..))`, kept finite.
    fn exponentials(&self, q: f64) -> (f64, f64) {
        let lower = libm::exp((-self.b_l * (q - self.q_l)).min(MAX_EXPONENT));
        let upper = libm::exp((self.b_u * (q - self.q_u)).min(MAX_EXPONENT));
        (self.a_l * lower, self.a_u * upper)
    }

    /// Passive torque.
    pub fn torque(&self, q: f64) -> f64 {
        let (lower, upper) = self.exponentials(q);
        lower - upper - self.k * (q - self.q_mid)
    }

    /// `-d tau_p/dq`, never negative: what is compared with `d_tau_e` in the slope search.
    pub fn stiffness(&self, q: f64) -> f64 {
        let (lower, upper) = self.exponentials(q);
        self.b_l * lower + self.b_u * upper + self.k
    }

    /// Has the sign of the second derivative of the torque; falls with `q` and is zero at the flattest angle.
    /// The two terms are compared by their logarithms, so that neither overflows nor vanishes.
    fn bend(&self, q: f64) -> f64 {
        let lower = libm::log(self.a_l) + 2.0 * libm::log(self.b_l) - self.b_l * (q - self.q_l);
        let upper = libm::log(self.a_u) + 2.0 * libm::log(self.b_u) + self.b_u * (q - self.q_u);
        lower - upper
    }

    /// Both exponentials are constant: the curve is a straight line.
    fn is_straight(&self) -> bool {
        (self.a_l == 0.0 || self.b_l == 0.0) && (self.a_u == 0.0 || self.b_u == 0.0)
    }
}

/// Active torque of Eq. 1 at `q`, with the external torque extrapolated as a straight line.
pub fn active_torque(problem: &Problem, q: f64) -> f64 {
    -(problem.curve.torque(q) + problem.tau_e + problem.d_tau_e * (q - problem.q_c))
}

/// Distance of [`active_torque`] at `q` from a threshold beyond which the comparison is free of doubt.
fn torque_doubt(problem: &Problem, q: f64) -> f64 {
    let (lower, upper) = problem.curve.exponentials(q);
    let straight = (problem.curve.k * (q - problem.curve.q_mid)).abs();
    let external = problem.tau_e.abs() + (problem.d_tau_e * (q - problem.q_c)).abs();
    TIE + ROUNDING * (lower + upper + straight + external)
}

/// Sign of a number; zero has sign 0.
fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// Dichotomy of `f` between two angles, down to neighbouring numbers, of which the better is returned.
/// `None` if both ends have the same sign; an end which is exactly zero is the root.
fn bisect(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut low, mut high) = (from.min(to), from.max(to));
    let low_sign = sign(f(low));
    let high_sign = sign(f(high));
    if low_sign == 0 || high_sign == 0 {
        return Some(if low_sign == 0 { low } else { high });
    }
    if low_sign == high_sign {
        return None;
    }
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            return Some(if f(low).abs() <= f(high).abs() {
                low
            } else {
                high
            });
        }
        match sign(f(middle)) {
            0 => return Some(middle),
            s if s == low_sign => low = middle,
            _ => high = middle,
        }
    }
}

/// Result of the slope search: the angle on each side of the flattest one, and whether "two slopes" is doubtful.
struct Slopes {
    lower: Option<f64>,
    upper: Option<f64>,
    doubtful: bool,
}

/// Angles of the closed range where `d tau_p = -d_tau_e`, at most one on each side of the flattest angle.
fn search_slopes(problem: &Problem) -> Slopes {
    let Problem {
        curve,
        q_min,
        q_max,
        d_tau_e,
        ..
    } = *problem;
    let mut slopes = Slopes {
        lower: None,
        upper: None,
        doubtful: false,
    };
    if curve.is_straight() {
        return slopes;
    }
    let excess = |q: f64| curve.stiffness(q) - d_tau_e;
    let close = |q: f64| excess(q).abs() <= TIE * d_tau_e.abs().max(1.0);
    // The flattest angle is looked for a little beyond the range, to see whether it is clearly outside.
    // Where it is outside, one side of the curve fills the range, and there cannot be two slopes.
    let (below, above) = (q_min - TIE, q_max + TIE);
    let (flattest, both_sides) = match bisect(below, above, |q| curve.bend(q)) {
        Some(q) => (q, q > below && q < above),
        None if curve.bend(q_min) > 0.0 => (above, false),
        None => (below, false),
    };
    slopes.doubtful = both_sides && close(flattest);
    if excess(flattest) >= 0.0 {
        return slopes;
    }
    if flattest >= q_min {
        slopes.lower = bisect(q_min, flattest.min(q_max), excess);
    }
    if flattest <= q_max {
        slopes.upper = bisect(flattest.max(q_min), q_max, excess);
    }
    // A slope angle at a limit: it may be just inside or just outside.
    let at_limit = |q: f64| close(q) || sign(excess(q - TIE)) != sign(excess(q + TIE));
    let (lower_close, upper_close) = (at_limit(q_min), at_limit(q_max));
    let possible =
        (slopes.lower.is_some() || lower_close) && (slopes.upper.is_some() || upper_close);
    slopes.doubtful |= both_sides && possible && (lower_close || upper_close);
    slopes
}

/// Tables 1 and 2, as printed.
pub fn minimize(problem: &Problem) -> Answer {
    let Problem {
        q_min,
        q_max,
        q_c,
        active,
        r_min,
        eps,
        ..
    } = *problem;
    let tau = |q: f64| active_torque(problem, q);
    let near = |value: f64, threshold: f64, doubt: f64| (value - threshold).abs() <= doubt;
    let near_zero = |q: f64| near(tau(q), 0.0, torque_doubt(problem, q));

    let tau_a = tau(q_c);
    let slopes = search_slopes(problem);
    let mut answer = Answer {
        case: "",
        goal: None,
        interval: None,
        slopes: (slopes.lower, slopes.upper),
        decrease_ratio: None,
        near_tie: slopes.doubtful || near(tau_a.abs(), eps, torque_doubt(problem, q_c)),
    };
    let stay = |answer: Answer, case| Answer {
        case,
        goal: Some(q_c),
        ..answer
    };
    let dichotomy = |answer: Answer, case, (from, to): (f64, f64)| Answer {
        case,
        goal: bisect(from, to, tau),
        interval: Some((from, to)),
        near_tie: answer.near_tie || near_zero(from) || near_zero(to),
        ..answer
    };

    let (Some(s_min), Some(s_max)) = (slopes.lower, slopes.upper) else {
        return if tau_a.abs() < eps {
            stay(answer, "1.1")
        } else if tau_a > eps {
            dichotomy(answer, "1.2", (q_min, q_c))
        } else {
            dichotomy(answer, "1.3", (q_c, q_max))
        };
    };
    let (sign_min, sign_max) = (sign(tau(s_min)), sign(tau(s_max)));
    let (near_s_min, near_s_max) = (near(q_c, s_min, TIE), near(q_c, s_max, TIE));

    if tau_a.abs() < eps {
        let between = s_min < q_c && q_c < s_max;
        let outside = q_c < s_min || q_c > s_max;
        answer.near_tie |=
            near_s_min || near_s_max || (!between && (near_zero(s_min) || near_zero(s_max)));
        return if between || (outside && sign_min == sign_max) {
            stay(answer, "2.1")
        } else if active {
            dichotomy(answer, "2.2", (s_min, s_max))
        } else {
            stay(answer, "2.3")
        };
    }

    let same_min = sign(tau_a) == sign_min;
    let same_max = sign(tau_a) == sign_max;
    // One clear difference settles the test, however close the other one is.
    let clearly_different = (!same_min && !near_zero(s_min)) || (!same_max && !near_zero(s_max));
    answer.near_tie |= !clearly_different && (near_zero(s_min) || near_zero(s_max));
    if same_min && same_max {
        let candidate = if tau_a > 0.0 { s_max } else { s_min };
        let ratio = (tau_a - tau(candidate)) / tau_a;
        answer.decrease_ratio = Some(ratio);
        let doubt =
            TIE + (torque_doubt(problem, candidate) + torque_doubt(problem, q_c)) / tau_a.abs();
        answer.near_tie |= active && near(ratio, r_min, doubt);
        return if active && ratio > r_min {
            Answer {
                case: "3.1",
                goal: Some(candidate),
                ..answer
            }
        } else if tau_a > eps {
            dichotomy(answer, "3.2", (q_min, s_min)) // Table 2, DSS
        } else {
            dichotomy(answer, "3.2", (s_max, q_max))
        };
    }
    if active {
        return dichotomy(answer, "3.3", (s_min, s_max));
    }
    // Table 2, DOS.
    let (compared, to_lower) = if tau_a > eps {
        (near_s_max, q_c < s_max)
    } else {
        (near_s_min, q_c <= s_min)
    };
    answer.near_tie |= compared;
    dichotomy(
        answer,
        "3.4",
        if to_lower {
            (q_min, s_min)
        } else {
            (s_max, q_max)
        },
    )
}
