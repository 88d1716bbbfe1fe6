//! Random passive curves of every form, shared by the tests of curves and of decisions.
use contrapposto::passive::{
    CoordinateLimitForce, CoupledTerm, DoubleExponential, End, Form, PassiveCurve, Reshape, RienerEdrich1999, Tabulated,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The generator of a test; its seed is printed with a failure.
pub fn random(seed: u64) -> Pcg64Mcg {
    println!("seed {seed}");
    Pcg64Mcg::seed_from_u64(seed)
}

/// A coin that falls on true with the given share.
pub fn chance(random: &mut Pcg64Mcg, share: f64) -> bool {
    random.random::<f64>() < share
}

/// The forms, and any of them reshaped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    DoubleExponential,
    RienerEdrich,
    CoordinateLimitForce,
    Tabulated,
    Reshaped,
}

impl Kind {
    pub const ALL: [Self; 5] =
        [Self::DoubleExponential, Self::RienerEdrich, Self::CoordinateLimitForce, Self::Tabulated, Self::Reshaped];
}

/// A random curve, and the angles where it is not smooth.
pub fn curve(kind: Kind, random: &mut Pcg64Mcg) -> (PassiveCurve, Vec<f64>) {
    let min = random.random_range(-2.0..1.0);
    let range = (min, min + random.random_range(0.3..3.0));
    match kind {
        Kind::DoubleExponential => (PassiveCurve::new(double_exponential(range, random), range, None).unwrap(), vec![]),
        Kind::RienerEdrich => {
            let (form, range) = riener_edrich(random);
            (PassiveCurve::new(form, range, None).unwrap(), vec![])
        }
        Kind::CoordinateLimitForce => {
            let (form, breaks) = coordinate_limit_force(range, random);
            (PassiveCurve::new(form, range, None).unwrap(), breaks)
        }
        Kind::Tabulated => {
            let (form, breaks) = tabulated(range, random);
            (PassiveCurve::new(form, range, None).unwrap(), breaks)
        }
        Kind::Reshaped => {
            let (form, mut breaks, range) = match random.random_range(0..4) {
                0 => (double_exponential(range, random), vec![], range),
                1 => {
                    let (form, range) = riener_edrich(random);
                    (form, vec![], range)
                }
                2 => {
                    let (form, breaks) = coordinate_limit_force(range, random);
                    (form, breaks, range)
                }
                _ => {
                    let (form, breaks) = tabulated(range, random);
                    (form, breaks, range)
                }
            };
            let mut stiffness = || if chance(random, 0.1) { 0.0 } else { random.random_range(0.0f64..10.0).powi(2) };
            let (lower_stiffness, upper_stiffness) = (stiffness(), stiffness());
            let zone = random.random_range(0.01..0.49) * (range.1 - range.0);
            breaks.extend([range.0 + zone, range.1 - zone]);
            let reshape = Reshape { zone, lower_stiffness, upper_stiffness };
            (PassiveCurve::new(form, range, Some(reshape)).unwrap(), breaks)
        }
    }
}

/// Ends strong and weak, sometimes missing, with the flattest angle sometimes outside the range.
fn double_exponential(range: (f64, f64), random: &mut Pcg64Mcg) -> Form {
    let mut end = |at: f64| End {
        torque: if chance(random, 0.08) { 0.0 } else { libm::pow(10.0, random.random_range(-2.0..1.8)) },
        rate: libm::pow(10.0, random.random_range(-0.3..1.5)),
        angle: at + random.random_range(-0.1..0.1),
    };
    let (lower, upper) = (end(range.0), end(range.1));
    let stiffness = if chance(random, 0.5) { 0.0 } else { random.random_range(0.0..3.0) };
    DoubleExponential { lower, upper, stiffness, neutral: random.random_range(range.0..range.1) }.form().unwrap()
}

/// Riener & Edrich 1999 with degrees turned into radians, hip, knee, ankle (data sheet, A2).
pub fn riener_edrich_1999() -> [RienerEdrich1999; 3] {
    let law = |joint, terms: &[(f64, f64, [f64; 3])], constant| RienerEdrich1999 {
        joint,
        terms: terms
            .iter()
            .map(|&(sign, c0, per_deg)| CoupledTerm { sign, c0, rates: per_deg.map(f64::to_degrees) })
            .collect(),
        constant,
    };
    [
        law(0, &[(1.0, 1.4655, [-0.0750, -0.0034, 0.0]), (-1.0, 1.3403, [0.0305, -0.0226, 0.0])], 8.072),
        law(
            1,
            &[
                (1.0, 1.800, [0.0217, -0.0352, -0.0460]),
                (-1.0, -3.971, [-0.0128, 0.0495, -0.0004]),
                (1.0, 2.220, [0.0, -0.150, 0.0]),
            ],
            -4.820,
        ),
        law(2, &[(1.0, 2.1016, [0.0, -0.0176, -0.0843]), (-1.0, -7.9763, [0.0, 0.0008, 0.1949])], -1.792),
    ]
}

fn riener_edrich(random: &mut Pcg64Mcg) -> (Form, (f64, f64)) {
    let joint = random.random_range(0..3);
    let mirrored = chance(random, 0.3);
    let neighbours = [(-20.0, 110.0), (0.0, 110.0), (-20.0, 40.0)]
        .map(|(from, to): (f64, f64)| random.random_range(from..to).to_radians());
    let law = &riener_edrich_1999()[joint];
    let (min, max) = [(-20f64, 110f64), (-10.0, 130.0), (-30.0, 50.0)][joint];
    let range = if mirrored { (-max, -min) } else { (min, max) };
    let form = Form::Exponentials(law.held(neighbours, mirrored).unwrap());
    (form, (range.0.to_radians(), range.1.to_radians()))
}

/// Limits anywhere about the range, sides without stiffness, equal limits, wide and narrow transitions.
fn coordinate_limit_force(range: (f64, f64), random: &mut Pcg64Mcg) -> (Form, Vec<f64>) {
    let width = range.1 - range.0;
    let mut limits = [0; 2].map(|_| range.0 + width * random.random_range(-0.2..1.2));
    limits.sort_by(f64::total_cmp);
    if chance(random, 0.05) {
        limits[1] = limits[0];
    }
    let mut stiffness = || if chance(random, 0.05) { 0.0 } else { libm::pow(10.0, random.random_range(-1.0..3.0)) };
    let (upper_stiffness, lower_stiffness) = (stiffness(), stiffness());
    let transition = libm::pow(10.0, random.random_range(-1.0..1.0));
    let force = CoordinateLimitForce {
        upper_stiffness,
        upper_limit: limits[1],
        lower_stiffness,
        lower_limit: limits[0],
        transition,
    };
    let breaks = vec![limits[0], limits[0] - transition, limits[1], limits[1] + transition];
    (force.form().unwrap(), breaks)
}

/// Two to twelve rows over the range or more, some level with the row before.
fn tabulated(range: (f64, f64), random: &mut Pcg64Mcg) -> (Form, Vec<f64>) {
    let count = random.random_range(2..13);
    let margin = if chance(random, 0.5) { 0.0 } else { 0.3 };
    let mut angles = vec![range.0 - margin, range.1 + margin];
    angles.extend((2..count).map(|_| random.random_range(range.0..range.1)));
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| *a - *b < 0.005);
    *angles.last_mut().unwrap() = range.1 + margin;
    let mut torque = random.random_range(-5.0..20.0);
    let rows: Vec<_> = angles
        .iter()
        .map(|&angle| {
            if !chance(random, 0.25) {
                torque -= random.random_range(0.0f64..3.0).powi(3);
            }
            (angle, torque)
        })
        .collect();
    (Tabulated::new(&rows).unwrap().form(), angles)
}
