//! Passive laws: the same torque in `.osim` files, springs in MJCF, the rest listed.

use contrapposto::model::{JointKind, Model};
use contrapposto::passive::{
    CoordinateLimitForce, DoubleExponential, End, PassiveCurve, PassiveLaw, Reshape, Tabulated, Term,
};
use contrapposto_formats::osim::expression;
use contrapposto_formats::write;

use super::{Mjcf, Osim, axis, build, difference, named, read, segment};

fn laws() -> Vec<PassiveLaw> {
    let range = (-1.2, 1.1);
    let limit = CoordinateLimitForce {
        upper_stiffness: 20f64.to_degrees(),
        upper_limit: 50f64.to_radians(),
        lower_stiffness: 13.7f64.to_degrees(),
        lower_limit: -61.3f64.to_radians(),
        transition: 7.5f64.to_radians(),
    };
    let double = DoubleExponential {
        lower: End { torque: 1.5, rate: 6.25, angle: -1.2 },
        upper: End { torque: 2.5e-7, rate: 3.811, angle: 1.0 / 3.0 },
        stiffness: 0.4,
        neutral: -0.1,
    };
    let table = [(-1.5, 6.0), (-0.5, 1.0), (0.2, 0.0), (0.7, 0.0), (1.5, -4.0)];
    let curve = |form, reshape| PassiveLaw::Curve(PassiveCurve::new(form, range, reshape).unwrap());
    let reshape = Reshape { zone: 0.3, lower_stiffness: 3.0, upper_stiffness: 5.5 };
    vec![
        curve(double.form().unwrap(), None),
        curve(double.form().unwrap(), Some(reshape)),
        curve(limit.form().unwrap(), None),
        curve(Tabulated::new(&table).unwrap().form(), None),
        PassiveLaw::Sum(vec![Term::Spring { stiffness: 3.0, rest: 0.2 }, Term::Spring { stiffness: 1.25, rest: -0.4 }]),
        PassiveLaw::Sum(vec![Term::Polynomial { coefficients: vec![1.5, -0.3, 0.7], rest: 0.1 }]),
        PassiveLaw::Sum(vec![
            Term::CoordinateLimitForce(limit),
            Term::double_exponential(double).unwrap(),
            Term::Expression(expression::parse("-k*q^3; k = 2").unwrap()),
        ]),
    ]
}

fn with_law(law: &PassiveLaw) -> Model {
    let mut coordinates = named(&["h"]);
    coordinates[0].passive = Some(law.clone());
    build(vec![segment("a", None, JointKind::Hinge(axis(0.0, 0.0, 1.0)), coordinates)])
}

#[test]
fn passive_laws_have_the_same_torque_and_slope_in_osim() {
    for law in laws() {
        let model = with_law(&law);
        let written = write::osim(&model).unwrap();
        assert_eq!(written.lost, Vec::<String>::new());
        let back = read(&written.text, Osim);
        let found = back.coordinates()[0].passive.as_ref().unwrap();
        for i in 0..=100 {
            let q = -1.2 + 2.3 * f64::from(i) / 100.0;
            let (a, b) = (law.torque(0, &[q]), found.torque(0, &[q]));
            assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{law:?} at {q}: {a} {b}\n{}", written.text);
        }
    }
}

#[test]
fn springs_stand_in_mjcf_and_the_rest_is_listed() {
    for (law, held) in laws().iter().zip([false, false, false, false, true, true, false]) {
        let model = with_law(law);
        let written = write::mjcf(&model).unwrap();
        let back = read(&written.text, Mjcf);
        let lost = written.lost.iter().any(|l| l == "Passive torques that are no springs are not written: `h`.");
        assert_eq!(lost, !held);
        if held {
            assert!(difference(&model, &back, true) < 1e-12);
        }
        assert!(write::urdf(&model).unwrap().lost.contains(&"Passive torques are not written: `h`.".to_owned()));
    }
}
