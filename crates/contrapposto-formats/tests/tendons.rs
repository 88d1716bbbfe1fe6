//! Tests muscles of MJCF files on a small body: lengths, moment arms and forces in closed form, and arms against differences of lengths.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::{FiberState, Location, Musculature, PathGeometry, PathRule};
use contrapposto::posture::Posture;
use contrapposto_formats::mjcf;
use contrapposto_formats::model_ir::{Imported, KindTally, ModelIr};
use rand::RngExt;
use rand_pcg::Pcg64;

/// A hinge `turn` about z at the origin, on it a hinge `tilt` about y that follows it, and a slide `push`; with sites and surfaces.
fn text(tendons: &str, actuators: &str) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/>
        <default><site pos="0.3 0 0"/><default class="strong">
            <general gaintype="muscle" biastype="muscle" gainprm="0.5 1.5 100 1 0.5 1.6 1 1.3 1"
                biasprm="0.5 1.5 100 1 0.5 1.6 1 1.3 1" lengthrange="0.1 0.3"/></default>
            <default class="weak"><muscle range="0.5 1.5" force="10" scale="3" lmax="2"/></default></default>
        <worldbody>
          <geom name="cylinder" type="cylinder" size="0.05 0.2"/> <geom name="sphere" type="sphere" size="0.05"/>
          <geom name="box" type="box" size="0.05 0.2 0.1"/>
          <site name="base"/> <site name="high" pos="0.3 0 0.2"/> <site name="near" pos="0.01 0 0"/>
          <site name="above" pos="0 1 0"/> <site name="below" pos="0 -1 0"/> <site name="core" pos="0.01 0.01 0.01"/>
          <body name="arm"><inertial pos="0.2 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
            <joint name="turn" axis="0 0 1" range="-3 3" limited="true"/>
            <frame pos="0.1 0 0"><site name="tip" pos="0.3 0 0"/></frame>
            <site name="same" pos="0.3 0 0"/>
            <body name="hand" pos="0.4 0 0"><inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
              <joint name="tilt" axis="0 1 0"/><joint name="push" type="slide" axis="1 0.2 0.1"/>
              <geom name="ball" type="sphere" size="0.04" pos="0.02 0.03 0.02"/>
              <geom name="rod" type="cylinder" size="0.03 0.1" pos="0.1 0.02 0" euler="0.4 0.3 0.2"/>
              <geom name="ring" type="cylinder" size="0.06 0.1" pos="0.05 0.06 0" euler="0.1 0.2 0.1"/>
              <site name="palm" pos="0.2 0.03 0.02"/> <site name="finger" pos="0.3 -0.02 0.05"/>
              <site name="hollow" pos="0.06 0.05 0.01"/> <site name="back" pos="0.1 0.4 0.3"/></body></body>
        </worldbody>
        <equality><joint joint1="tilt" joint2="turn" polycoef="0.1 0.5 -0.2 0 0"/></equality>
        <tendon>{tendons}</tendon><actuator>{actuators}</actuator></mujoco>"#
    )
}

fn body(tendons: &str, actuators: &str) -> ModelIr {
    let text = text(tendons, actuators);
    let mut include = |name: &str| Err(name.to_owned());
    mjcf::read(text.as_bytes(), "arm.xml", &mut include, &mjcf::Options::default())
        .unwrap_or_else(|why| panic!("{why}"))
}

/// One muscle on a spatial tendon of these elements, of which all are read.
fn along(elements: &str) -> Imported {
    let tendon = format!(r#"<spatial name="t">{elements}</spatial>"#);
    let imported = body(&tendon, r#"<general class="strong" name="m" tendon="t"/>"#).model().unwrap();
    assert!(imported.muscle_tally.0.values().all(|tally| tally.refused == 0), "{:?}", imported.muscle_tally);
    imported
}

fn posture(model: &Model, values: &[(&str, f64)]) -> Posture {
    let mut posture = model.default_posture();
    for (name, value) in values {
        posture.values_mut()[model.coordinate(name).unwrap()] = *value;
    }
    posture
}

/// Length and moment arms of a path.
fn lay((model, muscles): (&Model, &Musculature), posture: &Posture, path: usize) -> (f64, Vec<f64>) {
    let mut kinematics = Kinematics::new(model);
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    kinematics.update(model, posture).unwrap();
    // The rule is MuJoCo's, whichever is asked for.
    geometry.update(model, &kinematics, &muscles.paths, PathRule::OpenSim);
    let (length, arms) = (geometry.lengths()[path], geometry.moment_arms(path).to_vec());
    geometry.update(model, &kinematics, &muscles.paths, PathRule::Geodesic);
    assert_eq!((length, arms.as_slice()), (geometry.lengths()[path], geometry.moment_arms(path)));
    (length, arms)
}

/// Length, and arm about `turn`, of the only path at an angle of `turn`.
fn at(imported: &Imported, turn: f64) -> (f64, f64) {
    let Imported { model, muscles, .. } = imported;
    let (length, arms) = lay((model, muscles), &posture(model, &[("turn", turn)]), 0);
    (length, arms[model.coordinates()[model.coordinate("turn").unwrap()].rate.unwrap()])
}

fn close(found: (f64, f64), expected: (f64, f64)) {
    let error = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
    assert!(error < 1e-14, "{found:?} for {expected:?}");
}

/// Flat length between points at 0.3 and 0.4 m from the axis, `angle` apart, round a radius of 0.05 m.
fn round(angle: f64) -> f64 {
    let part = |distance: f64| (distance * distance - 0.0025f64).sqrt() - 0.05 * libm::acos(0.05 / distance);
    part(0.3) + part(0.4) + 0.05 * angle
}

#[test]
fn a_straight_tendon_has_the_length_and_arm_of_the_cosine_rule() {
    let found = at(&along(r#"<site site="base"/><site site="tip"/>"#), 0.7);
    let length = (0.25 - 0.24 * libm::cos(0.7)).sqrt();
    close(found, (length, -0.12 * libm::sin(0.7) / length));
}

#[test]
fn a_tendon_round_a_cylinder_or_sphere_has_the_radius_as_its_arm() {
    for shape in ["cylinder", "sphere"] {
        let around = along(&format!(r#"<site site="base"/><geom geom="{shape}"/><site site="tip"/>"#));
        close(at(&around, 2.9), (round(2.9), -0.05));
        close(at(&around, -2.9), (round(2.9), 0.05));
        // It does not touch.
        assert!(at(&around, 0.5).0 < 0.2);
    }
}

#[test]
fn a_side_site_makes_the_line_go_the_other_way_round() {
    let below = along(r#"<site site="base"/><geom geom="cylinder" sidesite="below"/><site site="tip"/>"#);
    close(at(&below, 2.9), (round(std::f64::consts::TAU - 2.9), 0.05));
    let above = along(r#"<site site="base"/><geom geom="cylinder" sidesite="above"/><site site="tip"/>"#);
    close(at(&above, 2.9), (round(2.9), -0.05));
}

#[test]
fn a_line_along_a_cylinder_is_a_helix() {
    let found = at(&along(r#"<site site="high"/><geom geom="cylinder"/><site site="tip"/>"#), 2.9);
    let length = libm::hypot(round(2.9), 0.2);
    close(found, (length, -0.05 * round(2.9) / length));
}

#[test]
fn a_side_site_inside_makes_the_line_touch_from_within() {
    for shape in ["cylinder", "sphere"] {
        let elements = format!(r#"<site site="base"/><geom geom="{shape}" sidesite="core"/><site site="same"/>"#);
        let half = (0.09 + 0.0025 - 0.03 * libm::cos(0.7)).sqrt();
        close(at(&along(&elements), 1.4), (2.0 * half, -0.015 * libm::sin(0.7) / half));
    }
}

#[test]
fn branches_behind_a_pulley_count_by_their_share() {
    let elements = r#"<site site="base"/><site site="high"/><pulley divisor="2"/><site site="base"/><site site="tip"/>
        <pulley divisor="4"/><site site="base"/><site site="tip"/>"#;
    let length = (0.25 - 0.24 * libm::cos(0.7)).sqrt();
    close(at(&along(elements), 0.7), (0.2 + 0.75 * length, -0.09 * libm::sin(0.7) / length));
}

#[test]
fn fixed_tendons_and_joints_are_sums_of_coordinates() {
    let tendon = r#"<fixed name="f"><joint joint="turn" coef="0.02"/><joint joint="push" coef="-0.5"/></fixed>"#;
    let actuators = r#"<general class="strong" name="m" tendon="f" gear="2"/>
        <muscle name="n" joint="tilt" gear="-3" lengthrange="-1 1" force="5"/>"#;
    let Imported { model, muscles, .. } = body(tendon, actuators).model().unwrap();
    let posture = posture(&model, &[("turn", 0.4), ("push", 0.06)]);
    let rate = |name: &str| model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap();
    let (length, arms) = lay((&model, &muscles), &posture, 0);
    assert!((length - 2.0 * (0.008 - 0.03)).abs() < 1e-15);
    assert_eq!((arms[rate("turn")], arms[rate("push")]), (-0.04, 1.0));
    // The angle follows `turn`: 0.1 + 0.5 turn - 0.2 turn^2.
    let (length, arms) = lay((&model, &muscles), &posture, 1);
    assert!((length + 3.0 * (0.1 + 0.2 - 0.032)).abs() < 1e-15, "{length}");
    assert!((arms[rate("turn")] - 3.0 * (0.5 - 0.16)).abs() < 1e-15, "{arms:?}");
    // Both turn the body about `turn`: directly, and by `tilt`, which follows it.
    assert_eq!(PathGeometry::new(&model, &muscles.paths).crossed(&model), [rate("turn")]);
}

/// Active force at full activation and passive force.
fn forces(muscles: &Musculature, muscle: usize, length: f64) -> [f64; 2] {
    let FiberState { active_force, passive_force, tendon_force, imbalance, .. } =
        muscles.muscles[muscle].at_rest(length, 1.0);
    assert!(imbalance == 0.0 && (tendon_force - active_force - passive_force).abs() < 1e-12);
    [active_force, passive_force]
}

#[test]
fn forces_are_mujocos_parabolas() {
    let actuators = r#"<general class="strong" name="m" joint="turn"/>
        <muscle class="weak" name="n" joint="turn" lengthrange="1 2" lmin="0.6"/>"#;
    let Imported { muscles, .. } = body("", actuators).model().unwrap();
    // The optimal length is 0.2 m, and that of the tendon 0; 100 N.
    for (length, active, passive) in [
        (0.09, 0.0, 0.0),
        (0.12, 0.5 * 0.16, 0.0),
        (0.16, 1.0 - 0.5 * 0.64, 0.0),
        (0.2, 1.0, 0.0),
        (0.22, 1.0 - 0.5 / 9.0, 1.3 * 0.5 / 9.0),
        (0.3, 0.5 / 9.0, 1.3 * (0.5 + 2.0 / 3.0)),
        (0.4, 0.0, 1.3 * (0.5 + 0.7 / 0.3)),
        (-0.1, 0.0, 0.0),
    ] {
        let found = forces(&muscles, 0, length);
        let error = (found[0] - 100.0 * active).abs().max((found[1] - 100.0 * passive).abs());
        assert!(error < 1e-10, "{length}: {found:?} for {active}, {passive}");
    }
    // Optimal length 1, tendon 0.5, lmax from the class and fpmax from MuJoCo, 10 N.
    let found = forces(&muscles, 1, 1.75);
    assert!((found[0] - 10.0 * 0.875).abs() < 1e-12 && (found[1] - 13.0 * 0.125).abs() < 1e-12, "{found:?}");
    let found = forces(&muscles, 1, 1.2);
    assert!((found[0] - 10.0 * 0.5 * 0.25).abs() < 1e-12, "{found:?}");
}

/// Muscles over all surfaces of the hand, from outside and within.
fn many() -> Imported {
    let mut tendons = String::new();
    let mut actuators = String::new();
    for (number, (geom, side)) in [
        ("ball", ""),
        ("ball", "back"),
        ("rod", ""),
        ("rod", "back"),
        ("rod", "above"),
        ("ring", "hollow"),
        ("sphere", "below"),
        ("cylinder", "core"),
    ]
    .iter()
    .enumerate()
    {
        let side = if side.is_empty() { String::new() } else { format!(r#"sidesite="{side}""#) };
        tendons += &format!(
            r#"<spatial name="t{number}"><site site="high"/><geom geom="{geom}" {side}/><site site="palm"/>
            <pulley divisor="3"/><site site="tip"/><geom geom="rod" sidesite="back"/><site site="finger"/></spatial>"#
        );
        actuators += &format!(r#"<general class="strong" name="m{number}" tendon="t{number}"/>"#);
    }
    body(&tendons, &actuators).model().unwrap()
}

#[test]
fn moment_arms_in_200_postures_are_minus_the_slopes_of_the_lengths() {
    let Imported { model, muscles, .. } = many();
    let mut rng = Pcg64::new(20_261_122, 1);
    let (mut worst, mut jumps, mut touching) = (0f64, 0, 0);
    let count = muscles.muscles.len();
    for _ in 0..200 {
        let own = posture(&model, &[("turn", rng.random_range(-2.9..2.9)), ("push", rng.random_range(-0.1..0.1))]);
        for path in 0..count {
            let (length, arms) = lay((&model, &muscles), &own, path);
            let mut bare = muscles.clone();
            let tendon = bare.paths.paths[path].tendon.as_mut().unwrap();
            tendon.parts.iter_mut().for_each(|part| part.around = None);
            touching += usize::from(length > lay((&model, &bare), &own, path).0 + 1e-6);
            for (rate, arm) in model.rates().iter().zip(&arms) {
                let coordinate = rate.coordinate.unwrap();
                if model.is_dependent(coordinate) {
                    continue;
                }
                let step = 1e-6;
                let [less, more] = [-step, step].map(|step| {
                    let mut moved = own.clone();
                    moved.values_mut()[coordinate] += step;
                    lay((&model, &muscles), &moved, path).0
                });
                // Where a side site lets go, the length jumps.
                if (less + more - 2.0 * length).abs() > 1e-8 {
                    jumps += 1;
                    continue;
                }
                worst = worst.max((arm + (more - less) / (2.0 * step)).abs());
            }
        }
    }
    assert!(jumps < 5, "{jumps}");
    assert!(touching > 200, "{touching} of {} lines touch", 200 * count);
    assert!(worst < 1e-8, "{worst}");
}

#[test]
fn odd_surfaces_and_places_leave_a_straight_line_and_no_nan() {
    let around = |side: &str| along(&format!(r#"<site site="base"/><geom geom="sphere" {side}/><site site="tip"/>"#));
    let straight = |turn: f64| (0.25 - 0.24 * libm::cos(turn)).sqrt();
    for side in ["", r#"sidesite="above""#, r#"sidesite="core""#] {
        let mut imported = around(side);
        // No radius; and one that contains an end.
        for radius in [0.0, 0.35] {
            imported.muscles.paths.geoms[0].radius = radius;
            let (length, arm) = at(&imported, 2.9);
            assert!((length - straight(2.9)).abs() < 1e-15 && arm.is_finite(), "{side} {radius}: {length} {arm}");
        }
    }
    // Coincident ends, an end at the centre, ends on opposite sides of the centre: finite, and never shorter than the straight line.
    let places = [0.0, 1e-16, 1e-9, 0.05, -0.05, 0.3, -0.3];
    for side in ["", r#"sidesite="above""#, r#"sidesite="base""#, r#"sidesite="core""#] {
        for shape in ["sphere", "cylinder"] {
            let elements = format!(r#"<site site="base"/><geom geom="{shape}" {side}/><site site="tip"/>"#);
            let mut imported = along(&elements);
            for (one, other) in places.iter().flat_map(|one| places.map(|other| (*one, other))) {
                let points = &mut imported.muscles.paths.paths[0].points;
                points[0].location = Location::Fixed(nalgebra::Vector3::new(one, 0.0, 0.0));
                points[1].location = Location::Fixed(nalgebra::Vector3::new(other, 0.0, 0.0));
                let (length, arm) = at(&imported, 0.0);
                let least = (one - other).abs() - 1e-15;
                assert!(length >= least && arm.is_finite(), "{shape} {side} {one} {other}: {length} {arm}");
            }
        }
    }
}

/// The tally of a kind.
fn tally<'a>(body: &'a ModelIr, kind: &str) -> &'a KindTally {
    body.muscles.tally.0.get(kind).unwrap_or_else(|| panic!("{kind}: {:?}", body.muscles.tally))
}

#[test]
fn muscles_that_are_not_read_are_counted_with_their_reasons() {
    let tendons = r#"<spatial name="a"><site site="base"/><site site="tip"/></spatial>
        <spatial name="b"><site site="base"/><geom geom="box"/><site site="tip"/></spatial>
        <spatial name="c"><site site="base"/><site site="tipp"/></spatial>
        <spatial name="d"><geom geom="sphere"/><site site="tip"/></spatial>
        <spatial name="e"><site site="base"/></spatial>
        <fixed name="f"><joint joint="turn" coef="1"/></fixed> <fixed><joint joint="turn" coef="2"/></fixed>
        <fixed name="f"><joint joint="turn" coef="3"/></fixed>"#;
    let actuators = r#"<general class="strong" name="good" tendon="a"/> <muscle name="m7" class="unknown" tendon="a"/>
        <muscle name="m8" tendon="a" force="strong"/>
        <general class="strong" name="box" tendon="b"/> <general class="strong" name="site" tendon="c"/>
        <general class="strong" name="good" tendon="a"/> <general class="strong" name="none" tendon="zz"/>
        <muscle name="m1" tendon="a"/> <muscle name="m2" tendon="a" force="3"/>
        <muscle name="m3" tendon="a" force="3" lengthrange="2 1"/> <muscle name="m4" site="tip" force="3" lengthrange="1 2"/>
        <muscle name="m5" tendon="a" force="3" lengthrange="1 2" forcerange="-1 0"/>
        <muscle name="m6" tendon="a" force="3" lengthrange="1 2" lmin="2"/>
        <general class="strong" name="half" biastype="affine" tendon="a"/>
        <general class="strong" name="two" tendon="a" biasprm="0.5 1.5 50"/> <motor name="motor" tendon="f"/>"#;
    let body = body(tendons, actuators);
    let counts = |kind: &str| (tally(&body, kind).read, tally(&body, kind).left_out, tally(&body, kind).refused);
    assert_eq!(counts("general"), (1, 0, 6));
    assert_eq!(counts("muscle"), (0, 0, 8));
    assert_eq!(counts("spatial"), (1, 0, 4));
    assert_eq!(counts("fixed"), (0, 2, 1));
    assert_eq!(counts("site of a tendon"), (2, 0, 0));
    let reasons: Vec<&String> = body.muscles.tally.0.values().flat_map(|tally| tally.reasons.keys()).collect();
    for part in [
        "did you mean `tip`?",
        "type sphere and cylinder",
        "stand between two sites",
        "at least two sites",
        "no force is given",
        "no lengthrange is given",
        "smaller than the second",
        "forcerange",
        "lmin is 2",
        "other transmissions",
        "biastype",
        "must be the same",
        "there already",
        "no tendon `zz`",
        "it has no name",
        "`unknown`",
        "`strong`",
    ] {
        assert!(reasons.iter().any(|reason| reason.contains(part)), "{part}: {reasons:#?}");
    }
}
