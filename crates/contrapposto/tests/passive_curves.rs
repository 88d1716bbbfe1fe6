//! Every passive curve answers for itself: slope is the derivative of torque, torque minus the derivative of energy, the
//! torque falls, and the angles of a given slope are those that a fine scan sees. Published values are met.

use crate::support;

use contrapposto::math::MonotoneCubic;
use contrapposto::passive::{
    CoordinateLimitForce, DoubleExponential, End, Exponentials, Form, PassiveCurve, PassiveError, PassiveParameter,
    Reshape, Tabulated,
};
use rand::RngExt;
use support::{Kind, chance, random};

/// Central difference on five points: exact for quartics, else error of order step^4.
fn derivative(f: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    let d = |k: f64| f(x + k * step) - f(x - k * step);
    (8.0 * d(1.0) - d(2.0)) / (12.0 * step)
}

#[test]
fn slope_is_the_derivative_of_torque_and_torque_minus_that_of_energy() {
    let mut random = random(1);
    let mut worst = (0.0f64, 0.0f64);
    for kind in Kind::ALL {
        for _ in 0..300 {
            let (curve, breaks) = support::curve(kind, &mut random);
            let (min, max) = curve.range();
            for _ in 0..40 {
                let step = 5e-5;
                let q = random.random_range(min + 2.0 * step..max - 2.0 * step);
                if breaks.iter().any(|b| (q - b).abs() < 3.0 * step) {
                    continue;
                }
                let (torque, slope) = curve.torque_and_slope(q);
                assert_eq!((torque, slope), (curve.torque(q), curve.slope(q)));
                // Steep exponentials in a sum: relative to the steepest slope, not to what is left of it.
                let size = 1.0 + slope.abs() + torque.abs();
                let slope_error = (derivative(|x| curve.torque(x), q, step) - slope).abs() / size;
                let energy = curve.energy(q);
                let size = 1.0 + torque.abs() + 1e-3 * energy.abs();
                let torque_error = (-derivative(|x| curve.energy(x), q, step) - torque).abs() / size;
                worst = (worst.0.max(slope_error), worst.1.max(torque_error));
                assert!(slope_error < 1e-9, "{kind:?} slope at {q}: {slope_error:e} {curve:?}");
                assert!(torque_error < 1e-9, "{kind:?} torque at {q}: {torque_error:e} {curve:?}");
            }
        }
    }
    println!("worst slope error {:.1e}, worst torque error {:.1e}", worst.0, worst.1);
}

#[test]
fn every_curve_falls() {
    let mut random = random(2);
    for kind in Kind::ALL {
        for _ in 0..400 {
            let (curve, _) = support::curve(kind, &mut random);
            let scan = scan(&curve, 2000);
            let size = 1.0 + curve.torque(curve.range().0).abs() + curve.torque(curve.range().1).abs();
            for pair in scan.windows(2) {
                let rise = curve.torque(pair[1]) - curve.torque(pair[0]);
                assert!(rise <= 1e-14 * size, "{kind:?} rises by {rise:e} at {} {curve:?}", pair[0]);
                assert!(curve.slope(pair[0]) <= 0.0);
            }
        }
    }
}

fn scan(curve: &PassiveCurve, count: u32) -> Vec<f64> {
    let (min, max) = curve.range();
    let mut points: Vec<_> = (0..count).map(|i| min + (max - min) * f64::from(i) / f64::from(count)).collect();
    points.push(max);
    points
}

#[test]
fn flattest_zone_is_the_flattest() {
    let mut random = random(3);
    for kind in Kind::ALL {
        for _ in 0..400 {
            let (curve, _) = support::curve(kind, &mut random);
            let (from, to) = curve.flattest_zone();
            let (min, max) = curve.range();
            assert!(min <= from && from <= to && to <= max, "{kind:?} {curve:?}");
            assert!(from <= curve.flattest_angle() && curve.flattest_angle() <= to);
            let flattest = curve.slope(curve.flattest_angle());
            for q in scan(&curve, 2000) {
                let slope = curve.slope(q);
                assert!(
                    slope <= flattest + 1e-12 * (1.0 + slope.abs()),
                    "{kind:?} {slope} at {q}, not {flattest} {curve:?}"
                );
                if from < q && q < to {
                    assert!((slope - flattest).abs() < 1e-12 * (1.0 + slope.abs()), "{kind:?} {q} {curve:?}");
                }
            }
            // The zone is not too short either (a table may have several).
            if kind == Kind::CoordinateLimitForce {
                let level = |q: f64| curve.slope(q) == flattest && flattest == 0.0;
                assert!(scan(&curve, 2000).into_iter().all(|q| !level(q) || (from <= q && q <= to)), "{curve:?}");
            }
        }
    }
}

#[test]
fn slope_angles_and_crossings_are_those_of_a_scan() {
    let mut random = random(4);
    let (mut two, mut one, mut more) = (0, 0, 0);
    for kind in Kind::ALL {
        for _ in 0..400 {
            let (curve, _) = support::curve(kind, &mut random);
            let (min, max) = curve.range();
            let flattest = curve.slope(curve.flattest_angle());
            let mut targets = vec![curve.slope(min), curve.slope(max), flattest, 0.0, -0.0, 1.0, -1e9, 1e9];
            targets.extend([flattest - 1e-6, flattest + 1e-6, flattest - 1e-12]);
            targets.extend((0..6).map(|_| curve.slope(random.random_range(min..max))));
            targets.extend((0..4).map(|_| flattest - libm::pow(10.0, random.random_range(-6.0..3.0))));
            for target in targets {
                let crossings = check_crossings(&curve, target);
                let found = check_slope_angles(&curve, target, &crossings);
                two += u32::from(found == 2);
                one += u32::from(found == 1);
                more += u32::from(crossings.len() > 2);
            }
        }
    }
    println!("two {two}, one {one}, more than two {more}");
    assert!(two > 1000 && one > 1000 && more > 1000);
}

/// Slopes within rounding of the target: neither steeper nor flatter can be said.
fn noise(curve: &PassiveCurve, target: f64) -> f64 {
    let (min, max) = curve.range();
    1e-12 * (1.0 + target.abs()) + 1e-14 * (curve.slope(min).abs() + curve.slope(max).abs())
}

fn check_crossings(curve: &PassiveCurve, target: f64) -> Vec<f64> {
    let (min, max) = curve.range();
    let noise = noise(curve, target);
    let mut crossings = vec![];
    curve.crossings(target, |angle| crossings.push(angle));
    crossings.sort_by(f64::total_cmp);
    crossings.dedup();
    let reach = 1e-7 * (max - min);
    for &angle in &crossings {
        assert!((min..=max).contains(&angle), "{target} at {angle} {curve:?}");
        let around =
            [-reach, -1e-6 * reach, 0.0, 1e-6 * reach, reach].map(|d| curve.slope((angle + d).clamp(min, max)));
        let (least, most) = around.iter().fold((f64::MAX, f64::MIN), |(a, b), s| (a.min(*s), b.max(*s)));
        assert!(
            least <= target + noise && most >= target - noise,
            "{target} is not met at {angle}: {around:?} {curve:?}"
        );
    }
    let points = scan(curve, 1000);
    for pair in points.windows(2) {
        let miss = [pair[0], pair[1]].map(|q| curve.slope(q) - target);
        if miss.iter().all(|m| m.abs() > noise) && (miss[0] < 0.0) != (miss[1] < 0.0) {
            let seen = crossings.iter().any(|c| (pair[0] - 1e-9..=pair[1] + 1e-9).contains(c));
            assert!(seen, "{target} is passed in {pair:?}, found {crossings:?} {curve:?}");
        }
    }
    crossings
}

fn check_slope_angles(curve: &PassiveCurve, target: f64, crossings: &[f64]) -> usize {
    let zone = curve.flattest_zone();
    let (min, max) = curve.range();
    let noise = noise(curve, target);
    let found = curve.slope_angles(target);
    let flattest = curve.slope(curve.flattest_angle());
    if let Some(lower) = found.lower {
        assert!((min..=zone.0).contains(&lower), "{target} {found:?} {curve:?}");
    }
    if let Some(upper) = found.upper {
        assert!((zone.1..=max).contains(&upper), "{target} {found:?} {curve:?}");
    }
    if target == flattest && zone.0 < zone.1 {
        assert_eq!((found.lower, found.upper), (Some(zone.0), Some(zone.1)), "{curve:?}");
    } else if target < flattest {
        // A kink may be the flattest angle itself: steeper than the target just above it, it is the upper one.
        let upper_kink = |c: f64| c == zone.0 && c == zone.1 && c < max && curve.slope(c.next_up()) < target;
        let lower = crossings.iter().copied().filter(|c| *c <= zone.0 && !upper_kink(*c)).reduce(f64::max);
        let upper =
            crossings.iter().copied().filter(|c| *c > zone.1 || (*c == zone.1 && (zone.0 < zone.1 || upper_kink(*c))));
        let upper = upper.reduce(f64::min);
        assert_eq!((found.lower, found.upper), (lower, upper), "{target} {curve:?}");
        // Nothing steeper between the pair, so the nearest is what it says.
        let (from, to) = (lower.unwrap_or(min), upper.unwrap_or(max));
        for q in scan(curve, 1000) {
            if from < q && q < to {
                assert!(curve.slope(q) >= target - noise, "{target}: {q} lies between {found:?} {curve:?}");
            }
        }
    } else {
        assert_eq!((found.lower, found.upper), (None, None), "{target} {curve:?}");
    }
    usize::from(found.lower.is_some()) + usize::from(found.upper.is_some())
}

#[test]
fn degenerate_curves_have_plain_slope_angles() {
    let none = End { torque: 0.0, rate: 1.0, angle: 0.0 };
    let curve = |lower, upper, stiffness| {
        let form = DoubleExponential { lower, upper, stiffness, neutral: 0.5 }.form().unwrap();
        PassiveCurve::new(form, (0.0, 1.0), None).unwrap()
    };
    let pair = |curve: &PassiveCurve, slope| {
        let found = curve.slope_angles(slope);
        (found.lower, found.upper)
    };
    // Nothing at all, and a plain spring: one zone, the whole range.
    for (curve, slope) in [(curve(none, none, 0.0), 0.0), (curve(none, none, 2.0), -2.0)] {
        assert_eq!(curve.flattest_zone(), (0.0, 1.0));
        assert_eq!(curve.flattest_angle(), 0.5);
        assert_eq!(pair(&curve, slope), (Some(0.0), Some(1.0)));
        assert_eq!(pair(&curve, slope - 1.0), (None, None));
        assert_eq!(pair(&curve, slope + 1.0), (None, None));
    }
    // One side only: flattest at the far limit; exp(-2 q) has slope -1 at ln(2)/2.
    let lower = curve(End { torque: 1.0, rate: 2.0, angle: 0.0 }, none, 0.0);
    assert_eq!(lower.flattest_zone(), (1.0, 1.0));
    let at = pair(&lower, -1.0);
    assert!((at.0.unwrap() - 0.5 * libm::log(2.0)).abs() < 1e-15 && at.1.is_none());
    assert_eq!(pair(&lower, -2.0), (Some(0.0), None)); // the closed range includes its limit
    let upper = curve(none, End { torque: 1.0, rate: 2.0, angle: 1.0 }, 0.0);
    assert_eq!(upper.flattest_zone(), (0.0, 0.0));
    assert_eq!(pair(&upper, -2.0), (None, Some(1.0)));
    // Limit forces: the whole flat middle, clipped to the range; a spring without stiffness belongs to it.
    let force = CoordinateLimitForce {
        upper_stiffness: 10.0,
        upper_limit: 0.8,
        lower_stiffness: 10.0,
        lower_limit: 0.3,
        transition: 0.1,
    };
    let limit_force = |force: CoordinateLimitForce| PassiveCurve::new(force.form().unwrap(), (0.0, 1.0), None).unwrap();
    assert_eq!(limit_force(force).flattest_zone(), (0.3, 0.8));
    assert_eq!(pair(&limit_force(force), 0.0), (Some(0.3), Some(0.8)));
    let one_sided = CoordinateLimitForce { lower_stiffness: 0.0, ..force };
    assert_eq!(pair(&limit_force(one_sided), -0.0), (Some(0.0), Some(0.8)));
    let far = CoordinateLimitForce { lower_limit: -1.0, upper_limit: -0.5, ..force };
    assert_eq!(limit_force(far).flattest_zone(), (0.0, 1.0)); // beyond the transition: straight
    let near = CoordinateLimitForce { lower_limit: -1.0, upper_limit: -0.08, ..force };
    let zone = limit_force(near).flattest_zone(); // begins where it is steepest, straight from 0.02
    assert!((zone.0 - 0.02).abs() < 1e-15 && zone.1 == 1.0);
    // Full stiffness is met where the slope first reaches it, again where the transition ends, and at the range's limit.
    let mut met = vec![];
    limit_force(force).crossings(-10.0, |q| met.push(q));
    met.sort_by(f64::total_cmp);
    met.dedup();
    assert_eq!(met.len(), 6, "{met:?}");
    assert!(pair(&limit_force(force), -10.0).1.unwrap() < 0.8 + 0.1 * 2.0 / 3.0);
    // Rows level with each other make one zone, however many they are.
    let rows = [(0.0, 1.0), (0.2, 0.0), (0.4, 0.0), (0.7, 0.0), (1.0, -1.0)];
    let table = PassiveCurve::new(Tabulated::new(&rows).unwrap().form(), (0.0, 1.0), None).unwrap();
    assert_eq!(table.flattest_zone(), (0.2, 0.7));
    // A straight table has no trace of curvature.
    let table = PassiveCurve::new(Tabulated::new(&[(0.0, 0.7), (1.0, 0.4)]).unwrap().form(), (0.0, 1.0), None).unwrap();
    assert_eq!(table.flattest_zone(), (0.0, 1.0));
}

#[test]
fn a_reshaped_curve_has_kinks_and_the_asked_strength() {
    let elbow = |reshape| {
        let range = (0.0, 150f64.to_radians());
        let form = DoubleExponential {
            lower: End { torque: 12.67, rate: 19.92, angle: 0.0 },
            upper: End { torque: 9.324, rate: 3.811, angle: range.1 },
            stiffness: 0.0,
            neutral: 0.0,
        };
        PassiveCurve::new(form.form().unwrap(), range, reshape).unwrap()
    };
    let plain = elbow(None);
    let (min, max) = plain.range();
    let reshape = Reshape::reaching(20.0, 0.2, (plain.torque(min), plain.torque(max)));
    let shaped = elbow(Some(reshape));
    assert!((shaped.torque(min) - 20.0).abs() < 1e-12 && (shaped.torque(max) + 20.0).abs() < 1e-12);
    for q in [min + 0.2, 1.0, max - 0.2] {
        assert_eq!(shaped.torque(q), plain.torque(q));
    }
    // The slope jumps by the added stiffness; a slope inside the jump is met at the kink itself.
    let kink = max - 0.2;
    let jump = plain.slope(kink) - shaped.slope(kink + 1e-9);
    assert!((jump - reshape.upper_stiffness).abs() < 1e-6);
    assert_eq!(shaped.slope_angles(plain.slope(kink) - 0.5 * reshape.upper_stiffness).upper, Some(kink));
    // Strong enough already: nothing is added.
    let weak = Reshape::reaching(1.0, 0.2, (plain.torque(min), plain.torque(max)));
    assert_eq!((weak.lower_stiffness, weak.upper_stiffness), (0.0, 0.0));
    assert_eq!(elbow(Some(weak)).slope_angles(-2.0), plain.slope_angles(-2.0));
}

#[test]
fn tables_never_overshoot() {
    let mut random = random(5);
    for _ in 0..2000 {
        let mut point = (0.0, 0.0);
        let points: Vec<_> = (0..random.random_range(2..10))
            .map(|_| {
                point.0 += libm::pow(10.0, random.random_range(-4.0..1.0));
                point.1 -= if chance(&mut random, 0.3) { 0.0 } else { libm::pow(10.0, random.random_range(-6.0..3.0)) };
                point
            })
            .collect();
        let cubic = MonotoneCubic::new(&points).unwrap();
        for (piece, ends) in cubic.pieces().iter().zip(points.windows(2)) {
            let slack = 1e-13 * (1.0 + ends[0].1.abs() + ends[1].1.abs());
            for i in 0..=50 {
                let x = piece.start + (piece.end - piece.start) * f64::from(i) / 50.0;
                let (value, _) = piece.value_and_slope(x);
                assert!(value <= ends[0].1 + slack && value >= ends[1].1 - slack, "{points:?} {x} {value}");
            }
            assert_eq!(piece.value_and_slope(piece.start).0, ends[0].1);
            assert!((piece.value_and_slope(piece.end).0 - ends[1].1).abs() <= slack);
        }
        // Smooth: neighbours share their tangent.
        for pair in cubic.pieces().windows(2) {
            assert_eq!(pair[0].end_slope, pair[1].coefficients[1]);
            let jump = (pair[0].value_and_slope(pair[0].end).1 - pair[1].coefficients[1]).abs();
            let [_, c1, c2, c3] = pair[0].coefficients.map(f64::abs);
            let width = pair[0].end - pair[0].start;
            let spacing = 1e-15 * (width + pair[0].end);
            assert!(
                jump <= 1e-14 * (c1 + width * (c2 + width * c3)) + 10.0 * spacing * (c2 + width * c3),
                "{jump:e} {points:?}"
            );
        }
    }
}

/// Torques of OpenSim 4.6 (4.6-2026-06-22-85aaf64): angle rad, torque N m.
const TOY_LANDING_KNEE: [(f64, f64); 5] = [
    (-2.321287903, 129.99999876673235),
    (-2.2532200621, 90.42294207462504),
    (-0.959931085, 0.0),
    (-0.07504915330000017, -0.04311914106593095),
    (0.40142573299999995, -560.000005776909),
];

/// Of degrees and N m per degree.
fn limit_force(
    upper_stiffness: f64,
    upper_limit: f64,
    lower_stiffness: f64,
    lower_limit: f64,
    transition: f64,
) -> CoordinateLimitForce {
    CoordinateLimitForce {
        upper_stiffness: upper_stiffness.to_degrees(),
        upper_limit: upper_limit.to_radians(),
        lower_stiffness: lower_stiffness.to_degrees(),
        lower_limit: lower_limit.to_radians(),
        transition: transition.to_radians(),
    }
}

/// Greatest difference from a sweep of angles and torques, N m.
fn worst(force: CoordinateLimitForce, sweep: &[(f64, f64)]) -> f64 {
    let ends = (sweep[0].0, sweep[sweep.len() - 1].0);
    let curve = PassiveCurve::new(force.form().unwrap(), ends, None).unwrap();
    sweep.iter().map(|(q, torque)| (curve.torque(*q) - torque).abs()).fold(0.0, f64::max)
}

#[test]
fn the_limit_force_of_a_knee_is_opensims() {
    // ToyLandingModel.osim, KneeLimit_r.
    assert!(worst(limit_force(20.0, -5.0, 10.0, -120.0, 10.0), &TOY_LANDING_KNEE) < 1e-9);
}

#[test]
#[ignore = "needs ../shared: sweeps of limit forces of published models by OpenSim"]
fn limit_forces_of_published_models_are_opensims() {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/vectors/opensim_coordinate_limit_force_sweeps.json");
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let mut sweeps = 0;
    for sweep in text.split("\"model\":").skip(1) {
        let number = |key: &str| -> f64 {
            let rest = sweep.split_once(&format!("\"{key}\":")).unwrap().1;
            rest[..rest.find([',', '}']).unwrap()].trim().parse().unwrap()
        };
        let force = limit_force(
            number("upper_stiffness"),
            number("upper_limit"),
            number("lower_stiffness"),
            number("lower_limit"),
            number("transition"),
        );
        let list = sweep.split_once("\"sweep_theta_torque\":").unwrap().1.split_once("]]").unwrap().0;
        let numbers: Vec<f64> = list.split(['[', ']', ',']).filter_map(|text| text.trim().parse().ok()).collect();
        let pairs: Vec<_> = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        assert_eq!(pairs.len(), 121);
        let worst = worst(force, &pairs);
        assert!(worst < 1e-9, "{force:?}: {worst:e}");
        sweeps += 1;
    }
    assert!(sweeps > 10, "{sweeps}");
}

#[test]
fn a_rising_curve_is_refused_with_the_angle() {
    let range = (0.0, 2.0);
    let end = |torque, rate, angle| End { torque, rate, angle };
    let make = |lower, upper, stiffness| {
        PassiveCurve::new(DoubleExponential { lower, upper, stiffness, neutral: 1.0 }.form().unwrap(), range, None)
    };
    // Negative stiffness: rises most at the flattest angle, here the middle by symmetry.
    let found = make(end(1.0, 5.0, 0.0), end(1.0, 5.0, 2.0), -1.0).unwrap_err();
    let PassiveError::Rises { angle, slope } = found else { panic!("{found}") };
    assert!((angle - 1.0).abs() < 1e-12 && (slope - (1.0 - 10.0 * libm::exp(-5f64))).abs() < 1e-12, "{angle} {slope}");
    // The same in a curve that is steep enough everywhere falls, and is welcome.
    assert!(make(end(1.0, 5.0, 0.0), end(1.0, 5.0, 2.0), -9.9 * libm::exp(-5f64)).is_ok());
    // A term of the wrong sign.
    let found = make(end(-1.0, 5.0, 0.0), end(1.0, 5.0, 2.0), 0.0).unwrap_err();
    assert!(matches!(found, PassiveError::Rises { angle: 0.0, .. }), "{found}");
    let found = make(end(-1.0, 5.0, 0.0), end(1.0, 5.0, 2.0), 100.0).unwrap_err();
    assert!(matches!(found, PassiveError::Parameter { parameter: PassiveParameter::Torque, .. }), "{found}");
    // A table: the row where it begins to rise.
    let found = Tabulated::new(&[(0.0, 3.0), (1.0, 2.0), (2.0, 2.5)]).unwrap_err();
    assert_eq!(found, PassiveError::Rises { angle: 1.0, slope: 0.5 });
    assert!(found.to_string().contains("57.2958 deg"), "{found}");
}

#[test]
fn parameters_without_meaning_are_refused() {
    let parameter =
        |found: Result<Form, PassiveError>| assert!(matches!(found, Err(PassiveError::Parameter { .. })), "{found:?}");
    let end = End { torque: 1.0, rate: 5.0, angle: 0.0 };
    let double = DoubleExponential { lower: end, upper: end, stiffness: 1.0, neutral: 0.0 };
    let force = CoordinateLimitForce {
        upper_stiffness: 1.0,
        upper_limit: 1.0,
        lower_stiffness: 1.0,
        lower_limit: 0.0,
        transition: 0.1,
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        parameter(DoubleExponential { lower: End { torque: bad, ..end }, ..double }.form());
        parameter(DoubleExponential { upper: End { rate: bad, ..end }, ..double }.form());
        parameter(DoubleExponential { upper: End { angle: bad, ..end }, ..double }.form());
        parameter(DoubleExponential { stiffness: bad, ..double }.form());
        parameter(DoubleExponential { neutral: bad, ..double }.form());
        parameter(CoordinateLimitForce { upper_stiffness: bad, ..force }.form());
        parameter(CoordinateLimitForce { upper_limit: bad, ..force }.form());
        parameter(CoordinateLimitForce { transition: bad, ..force }.form());
        assert!(matches!(Tabulated::new(&[(0.0, 1.0), (1.0, bad)]), Err(PassiveError::Table { row: 2, .. })));
        for range in [(bad, 1.0), (0.0, bad)] {
            assert!(matches!(
                PassiveCurve::new(double.form().unwrap(), range, None),
                Err(PassiveError::Parameter { .. })
            ));
        }
        for reshape in [
            Reshape { zone: bad, lower_stiffness: 1.0, upper_stiffness: 1.0 },
            Reshape { zone: 0.1, lower_stiffness: bad, upper_stiffness: 1.0 },
            Reshape { zone: 0.1, lower_stiffness: 1.0, upper_stiffness: bad },
        ] {
            let found = PassiveCurve::new(double.form().unwrap(), (0.0, 1.0), Some(reshape));
            assert!(matches!(found, Err(PassiveError::Parameter { .. })), "{found:?}");
        }
    }
    parameter(DoubleExponential { lower: End { rate: 0.0, ..end }, ..double }.form());
    parameter(CoordinateLimitForce { transition: 0.0, ..force }.form());
    parameter(CoordinateLimitForce { upper_stiffness: -1.0, ..force }.form());
    parameter(CoordinateLimitForce { lower_limit: 1.5, ..force }.form());
    parameter(Exponentials::new(&[(1.0, -1.0, 0.0); 4], 0.0, 0.0, 0.0).map(Form::Exponentials));
    let half = Reshape { zone: 0.5, lower_stiffness: 1.0, upper_stiffness: 1.0 };
    assert!(PassiveCurve::new(double.form().unwrap(), (0.0, 1.0), Some(half)).is_err());
    for range in [(1.0, 1.0), (1.0, 0.0), (-1e7, 0.0)] {
        assert!(PassiveCurve::new(double.form().unwrap(), range, None).is_err(), "{range:?}");
    }
    for rows in [&[][..], &[(0.0, 1.0)], &[(0.0, 1.0), (0.0, 0.5)], &[(0.0, 1.0), (-1.0, 0.5)]] {
        assert!(matches!(Tabulated::new(rows), Err(PassiveError::Table { .. })), "{rows:?}");
    }
    let short = Tabulated::new(&[(0.0, 1.0), (1.0, 0.0)]).unwrap();
    for range in [(-0.1, 1.0), (0.0, 1.1)] {
        let found = PassiveCurve::new(short.clone().form(), range, None);
        assert!(matches!(found, Err(PassiveError::Table { .. })), "{found:?}");
    }
}

/// Numbers of any size: refused, or a curve all of whose answers are finite and in the range.
#[test]
fn huge_and_tiny_parameters_never_give_nonsense() {
    let mut random = random(6);
    let (mut refused, mut made) = (0, 0);
    for i in 0..40_000 {
        let mut any = || {
            const SPECIAL: [f64; 14] = [
                0.0,
                -0.0,
                1.0,
                -1.0,
                5e-324,
                1e-310,
                1e-150,
                1e-9,
                1e3,
                1e6,
                1e150,
                1e300,
                f64::MAX,
                f64::MIN_POSITIVE,
            ];
            let size = SPECIAL[random.random_range(0..SPECIAL.len())];
            if chance(&mut random, 0.5) { random.random_range(-3.0..3.0) } else { size }
        };
        let form = match i % 4 {
            0 => DoubleExponential {
                lower: End { torque: any().abs(), rate: any().abs(), angle: any() },
                upper: End { torque: any().abs(), rate: any().abs(), angle: any() },
                stiffness: any(),
                neutral: any(),
            }
            .form(),
            1 => {
                let limits = (any(), any());
                CoordinateLimitForce {
                    upper_stiffness: any().abs(),
                    upper_limit: limits.0.max(limits.1),
                    lower_stiffness: any().abs(),
                    lower_limit: limits.0.min(limits.1),
                    transition: any().abs(),
                }
                .form()
            }
            2 => {
                let terms = [0; 3].map(|_| (any(), any(), any()));
                Exponentials::new(&terms, any(), any(), any()).map(Form::Exponentials)
            }
            _ => {
                let mut rows = [0; 4].map(|_| any());
                let mut torques = [0; 4].map(|_| any());
                rows.sort_by(f64::total_cmp);
                torques.sort_by(|a, b| b.total_cmp(a));
                Tabulated::new(&[0, 1, 2, 3].map(|i| (rows[i], torques[i]))).map(Tabulated::form)
            }
        };
        let range = (any(), any());
        let reshape = Reshape { zone: any().abs(), lower_stiffness: any().abs(), upper_stiffness: any().abs() };
        let curve = form.and_then(|form| PassiveCurve::new(form, range, (i % 3 == 0).then_some(reshape)));
        let Ok(curve) = curve else {
            refused += 1;
            continue;
        };
        made += 1;
        let (min, max) = curve.range();
        let zone = curve.flattest_zone();
        assert!(min <= zone.0 && zone.0 <= zone.1 && zone.1 <= max, "{curve:?}");
        for q in scan(&curve, 20) {
            let (torque, slope) = curve.torque_and_slope(q);
            assert!(torque.is_finite() && slope.is_finite() && curve.energy(q).is_finite(), "{q} {curve:?}");
        }
        for slope in [any(), -any().abs(), curve.slope(min), curve.slope(max), curve.slope(zone.0)] {
            curve.crossings(slope, |angle| assert!((min..=max).contains(&angle), "{angle} {curve:?}"));
            let found = curve.slope_angles(slope);
            assert!(found.lower.is_none_or(|q| (min..=zone.0).contains(&q)), "{slope} {found:?} {curve:?}");
            assert!(found.upper.is_none_or(|q| (zone.1..=max).contains(&q)), "{slope} {found:?} {curve:?}");
        }
    }
    println!("refused {refused}, made {made}");
    assert!(made > 1000 && refused > 1000);
}

#[test]
fn riener_and_edrich_meet_the_published_values() {
    let laws = support::riener_edrich_1999();
    // Hip, knee, ankle (deg), torque (N m), two decimals.
    type Row = ([f64; 3], f64);
    let hip: [Row; 6] = [
        ([-20.0, 0.0, 0.0], 25.40),
        ([-10.0, 0.0, 0.0], 14.42),
        ([0.0, 0.0, 0.0], 8.58),
        ([30.0, 0.0, 0.0], -1.01),
        ([60.0, 0.0, 0.0], -15.70),
        ([90.0, 90.0, 0.0], 0.30),
    ];
    let knee: [Row; 7] = [
        ([0.0, -5.0, 0.0], 21.87),
        ([0.0, 0.0, 0.0], 10.42),
        ([0.0, 5.0, 0.0], 4.58),
        ([0.0, 20.0, 0.0], -1.42),
        ([0.0, 90.0, 0.0], -6.19),
        ([90.0, 0.0, 0.0], 47.03),
        ([90.0, 90.0, 0.0], -3.54),
    ];
    let ankle: [Row; 6] = [
        ([0.0, 0.0, -20.0], 42.36),
        ([0.0, 0.0, -10.0], 17.21),
        ([0.0, 0.0, 0.0], 6.39),
        ([0.0, 0.0, 20.0], -0.29),
        ([0.0, 0.0, 40.0], -2.35),
        ([0.0, 90.0, 0.0], -0.11),
    ];
    for (law, rows) in laws.iter().zip([&hip[..], &knee[..], &ankle[..]]) {
        for (degrees, torque) in rows {
            let angles = degrees.map(f64::to_radians);
            let (own, gradient) = law.torque_and_gradient(angles);
            // The sheet rounds -15.6945 to -15.70; all others agree to half of the last digit.
            assert!((own - torque).abs() < 0.0056, "joint {} at {degrees:?}: {own}, not {torque}", law.joint);
            for j in 0..3 {
                let along = |x: f64| {
                    let mut moved = angles;
                    moved[j] = x;
                    law.torque_and_gradient(moved).0
                };
                let expected = derivative(along, angles[j], 1e-3);
                assert!((gradient[j] - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{degrees:?} {j}");
            }
            // Held neighbours, either way round.
            for mirrored in [false, true] {
                let sign = if mirrored { -1.0 } else { 1.0 };
                let form = Form::Exponentials(law.held(angles, mirrored).unwrap());
                let q = sign * angles[law.joint];
                let held = PassiveCurve::new(form, (q - 0.5, q + 0.5), None).unwrap();
                assert!((sign * held.torque(q) - own).abs() < 1e-12 * (1.0 + own.abs()));
                assert!((held.slope(q) - gradient[law.joint]).abs() < 1e-12 * (1.0 + held.slope(q).abs()));
            }
        }
    }
    let [mut stray, ..] = laws;
    stray.joint = 3;
    assert!(matches!(
        stray.held([0.0; 3], false),
        Err(PassiveError::Parameter { parameter: PassiveParameter::Joint, .. })
    ));
}
