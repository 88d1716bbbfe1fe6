//! Compares the greatest forces at a hand with formulas by hand, with the statics of the body, and with an interior-point method.
//! Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use std::collections::BTreeMap;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use contrapposto::capacity::{Capacity, Demand, GreatestForce, Limiter, People, Situation, Solid, Station, directions};
use contrapposto::contact::{ContactForces, FACES, Place, Support, root_rates};
use contrapposto::fatigue::FatigueLaw;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::{
    Adult, CoordinateSpec, JointKind, Model, ModelBuilder, Motion, MuscleGroup, Placement, SegmentSpec, Side, adult,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::strength::Strength;
use nalgebra::{Matrix3, Translation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_261_123);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

/// A body in a posture.
#[derive(Clone)]
struct Body {
    model: Model,
    posture: Posture,
    loads: Vec<Load>,
    supports: Vec<Support>,
    station: Station,
}

impl Body {
    /// The built-in adult, with both feet on the ground.
    fn standing(friction: f64, hand: &str) -> Self {
        let model = adult(&Adult::default()).unwrap();
        let support = |name: &str| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support { segment, corners, normal: V::y(), friction, share_max: 1.0, place: Place::Fixed }
        };
        let supports = vec![support("calcn_r"), support("calcn_l")];
        let mut posture = model.default_posture();
        for (name, degrees) in
            [("arm_flex_r", 40.0), ("elbow_flex_r", 70.0), ("arm_flex_l", 40.0), ("elbow_flex_l", 70.0)]
        {
            posture.values_mut()[model.coordinate(name).unwrap()] = f64::to_radians(degrees);
        }
        let station = Station { segment: model.segment(hand).unwrap(), point: V::new(0.0, -0.07, 0.0) };
        Self { model, posture, loads: vec![], supports, station }
    }

    /// The right arm alone, its shoulder fixed.
    fn arm(rng: &mut Pcg64) -> Self {
        let model = adult(&Adult::right_arm()).unwrap();
        let values =
            model.coordinates().iter().map(|c| c.range.0 + rng.random_range(0.2..0.8) * (c.range.1 - c.range.0));
        let posture = Posture::new(values.collect());
        let station = Station { segment: model.segment("hand_r").unwrap(), point: V::new(0.0, -0.07, 0.0) };
        Self { model, posture, loads: vec![], supports: vec![], station }
    }

    fn situation(&self) -> Situation<'_> {
        Situation {
            model: &self.model,
            posture: &self.posture,
            loads: &self.loads,
            supports: &self.supports,
            muscles: None,
        }
    }

    fn capacity(&self) -> Capacity {
        Capacity::new(&self.situation(), self.station, Demand::default()).unwrap().unwrap()
    }

    fn solid(&self) -> Solid {
        self.capacity().solid()
    }

    /// The force on the hand beside the loads of the body.
    fn pushed(&self, force: V) -> Vec<Load> {
        let load = Load {
            segment: self.station.segment,
            point: self.station.point,
            kind: LoadKind::Force(-force, FixedIn::World),
        };
        self.loads.iter().copied().chain([load]).collect()
    }

    /// Torques under loads.
    fn torques(&self, loads: &[Load]) -> JointTorques {
        let mut torques = JointTorques::new(&self.model);
        torques.update(&self.model, &self.posture, loads, Quantities::TORQUES).unwrap();
        torques
    }

    /// Coordinate, rate and both strengths of every joint that works.
    fn joints(&self) -> Vec<(usize, usize, [f64; 2])> {
        let torques = self.torques(&self.loads);
        let coordinates = self.model.coordinates().iter().enumerate().filter(|(i, _)| !self.model.is_dependent(*i));
        coordinates
            .filter_map(|(i, c)| {
                let groups = c.groups.as_ref()?;
                Some((i, c.rate?, Side::BOTH.map(|side| groups[side.index()].strength.torque(torques.angles()[i]))))
            })
            .collect()
    }

    /// By rate: active torque without a force and without supports, and its change per newton along each ground axis.
    fn required(&self) -> (Vec<f64>, [Vec<f64>; 3]) {
        let rest = self.torques(&self.loads).active_torque().to_vec();
        let change = [V::x(), V::y(), V::z()].map(|axis| {
            let pushed = self.torques(&self.pushed(axis)).active_torque().to_vec();
            pushed.iter().zip(&rest).map(|(with, without)| with - without).collect()
        });
        (rest, change)
    }
}

/// Two links of 0.3 m and 0.25 m in the plane of x and y, hinged about z, without weight.
fn two_links() -> Body {
    let mut builder = ModelBuilder::new("two links", V::new(0.0, -9.81, 0.0));
    let group = |name: &str, torque: f64| MuscleGroup {
        name: name.to_owned(),
        strength: Strength::constant(torque),
        fatigue: FatigueLaw::Tireless,
    };
    let mut link = |name: &str, parent: Option<&str>, at: f64, torques: [f64; 2]| {
        let mut coordinate = CoordinateSpec::new(&format!("{name}_q"), (-3.0, 3.0));
        coordinate.groups = Some([group("up", torques[0]), group("down", torques[1])]);
        builder
            .segment(SegmentSpec {
                name: name.to_owned(),
                parent: parent.map(str::to_owned),
                mass: 0.0,
                center_of_mass: V::zeros(),
                inertia: Matrix3::zeros(),
                joint: format!("{name}_joint"),
                kind: JointKind::Chain(vec![Motion::Hinge(V::z_axis())]),
                in_parent: Placement::from_parts(Translation3::new(at, 0.0, 0.0), Default::default()),
                in_segment: Placement::identity(),
                coordinates: vec![coordinate],
            })
            .unwrap();
    };
    link("upper", None, 0.0, [40.0, 30.0]);
    link("fore", Some("upper"), 0.3, [20.0, 15.0]);
    let model = builder.build();
    let posture = Posture::new(vec![0.4, 1.1]);
    let station = Station { segment: 1, point: V::new(0.25, 0.0, 0.0) };
    Body { model, posture, loads: vec![], supports: vec![], station }
}

#[test]
fn two_links_exert_the_forces_of_formulas_by_hand() {
    let body = two_links();
    let mut capacity = body.capacity();
    let (q, r) = (0.4f64, 0.4f64 + 1.1);
    let hand = [0.3 * libm::cos(q) + 0.25 * libm::cos(r), 0.3 * libm::sin(q) + 0.25 * libm::sin(r)];
    let elbow = [0.3 * libm::cos(q), 0.3 * libm::sin(q)];
    assert!((capacity.place() - V::new(hand[0], hand[1], 0.0)).norm() < 1e-14);
    for turn in 0..360 {
        let angle = f64::from(turn).to_radians();
        let (x, y) = (libm::cos(angle), libm::sin(angle));
        // Muscles give the torque of the force that the hand exerts: the arm of the joint crossed with it.
        let torques = [hand[0] * y - hand[1] * x, (hand[0] - elbow[0]) * y - (hand[1] - elbow[1]) * x];
        let of_joint = |torque: f64, [up, down]: [f64; 2]| if torque > 0.0 { up / torque } else { -down / torque };
        let forces = [of_joint(torques[0], [40.0, 30.0]), of_joint(torques[1], [20.0, 15.0])];
        let least = forces[0].min(forces[1]);
        let found = capacity.in_direction(&V::new(x, y, 0.0));
        assert!((found.force - least).abs() < 1e-9 * least, "{turn}: {} for {least}", found.force);
        let joint = usize::from(forces[1] < forces[0]);
        let side = Side::of(torques[joint]);
        assert_eq!(found.limits[0].by, Limiter::Strength { coordinate: joint, side }, "{turn}");
        assert!((found.limits[0].share - 1.0).abs() < 1e-9);
    }
    // Nothing holds the plane, and nothing turns out of it.
    let along = capacity.in_direction(&V::z());
    assert!(along.force.is_infinite() && along.limits.is_empty());
}

#[test]
fn arms_with_a_fixed_shoulder_exert_what_their_weakest_joint_allows() {
    let mut rng = random("fixed arms");
    let mut worst = 0f64;
    for number in 0..40 {
        let body = Body::arm(&mut rng);
        let (rest, change) = body.required();
        let joints = body.joints();
        let held = |&(_, rate, strength): &(usize, usize, [f64; 2])| {
            let side = Side::of(rest[rate]).index();
            rest[rate].abs() <= strength[side]
        };
        let capacity = Capacity::new(&body.situation(), body.station, Demand::default()).unwrap();
        assert_eq!(capacity.is_some(), joints.iter().all(held), "{number}");
        let Some(mut capacity) = capacity else { continue };
        for direction in directions().0 {
            let limit = |&(_, rate, strength): &(usize, usize, [f64; 2])| {
                let per_newton: f64 = (0..3).map(|axis| change[axis][rate] * direction[axis]).sum();
                let room = if per_newton > 0.0 { strength[0] - rest[rate] } else { -strength[1] - rest[rate] };
                if per_newton.abs() < 1e-12 { f64::INFINITY } else { room / per_newton }
            };
            let least = joints.iter().map(limit).fold(f64::INFINITY, f64::min);
            let found = capacity.in_direction(&direction);
            if least < 1e5 {
                worst = worst.max((found.force - least).abs() / least.max(1.0));
            }
        }
    }
    println!("fixed arms: {worst:.1e} at most from the weakest joint");
    assert!(worst < 1e-9, "{worst:e}");
}

/// Checks a force by the statics: greatest excess of a strength (as a share), of friction and of pull (N), and what the root lacks.
fn excess(body: &Body, greatest: &GreatestForce) -> [f64; 4] {
    let mut loads = body.pushed(greatest.force * greatest.direction);
    let mut forces = greatest.contact.iter();
    let (mut friction, mut pull) = (0f64, 0f64);
    for support in &body.supports {
        for &point in &support.corners {
            let force = *forces.next().unwrap();
            loads.push(Load { segment: support.segment, point, kind: LoadKind::Force(force, FixedIn::World) });
            let normal = force.dot(&support.normal);
            pull = pull.max(-normal);
            friction = friction.max((force - normal * support.normal).norm() - support.friction * normal);
        }
    }
    let torques = body.torques(&loads);
    let active = torques.active_torque();
    let strength = body
        .joints()
        .into_iter()
        .map(|(_, rate, strength)| active[rate].abs() / strength[Side::of(active[rate]).index()] - 1.0);
    let root = root_rates(&body.model).into_iter().map(|rate| active[rate].abs());
    [strength.fold(0.0, f64::max), friction, pull, root.fold(0.0, f64::max)]
}

#[test]
fn every_force_of_a_standing_adult_is_held_by_the_statics_and_none_is_beyond_a_plane() {
    for friction in [0.6, 0.2, 0.0] {
        let body = Body::standing(friction, "hand_r");
        let solid = body.solid();
        assert_eq!(solid.forces.len(), 642);
        let mut worst = [0f64; 5];
        let found = || solid.forces.iter().chain([&solid.weakest, &solid.strongest]);
        for greatest in found() {
            for (worst, excess) in worst.iter_mut().zip(excess(&body, greatest)) {
                *worst = worst.max(excess);
            }
            worst[4] = worst[4].max(greatest.gap.abs());
            assert!((greatest.normal.dot(&greatest.direction) - 1.0).abs() < 1e-9);
        }
        println!(
            "friction {friction}: strength {:.1e}, friction {:.1e} N, pull {:.1e} N, root {:.1e} N, gap {:.1e}",
            worst[0], worst[1], worst[2], worst[3], worst[4]
        );
        assert!(worst[0] < 1e-9 && worst[1..4].iter().all(|excess| *excess < 1e-6) && worst[4] < 1e-9, "{worst:?}");
        // Convex: no force is beyond the plane of another one. Each plane proves that 1e-6 more cannot be exerted.
        let beyond = found().flat_map(|plane| {
            found().map(|greatest| {
                plane.normal.dot(&greatest.direction) * greatest.force / plane.force.max(1e-3)
                    - plane.force / plane.force.max(1e-3)
            })
        });
        let most = beyond.fold(f64::NEG_INFINITY, f64::max);
        assert!(most < 1e-8, "{most:e}");
        assert!(found().all(|greatest| greatest.force >= solid.weakest.force * (1.0 - 1e-12)));
        assert!(found().all(|greatest| greatest.force <= solid.strongest.force));
    }
}

/// The same program for an interior-point method, from statics alone.
fn by_interior_point(body: &Body, direction: &V) -> f64 {
    let (rest, change) = body.required();
    let mut contact = ContactForces::new(&body.model, body.supports.clone()).unwrap();
    let torques = body.torques(&body.loads);
    contact.update(&body.model, torques.kinematics_by_axes(), torques.angles(), torques.active_torque());
    let (n, forces) = (body.model.rates().len(), contact.forces().len());
    let joints = body.joints();
    let weight = contact.weight();
    let row = |rate: usize| -> Vec<f64> {
        let along: f64 = (0..3).map(|axis| change[axis][rate] * direction[axis]).sum();
        let forces = (0..forces).map(|unknown| -contact.columns()[unknown * n + rate]);
        forces.chain([along * weight]).collect()
    };
    let (mut lines, mut right) = (vec![], vec![]);
    let root = root_rates(&body.model);
    for &rate in &root {
        lines.push(row(rate).iter().map(|entry| entry / weight).collect::<Vec<f64>>());
        right.push(-rest[rate] / weight);
    }
    for &(_, rate, strength) in &joints {
        // required - C f + s J^T d <= S+, and >= -S-.
        for (sign, strength) in [(1.0, strength[0]), (-1.0, strength[1])] {
            lines.push(row(rate).iter().map(|entry| sign * entry / strength).collect());
            right.push((strength - sign * rest[rate]) / strength);
        }
    }
    let mut corner = 0;
    for support in &body.supports {
        let most = support.friction / (FACES as f64 / 2.0).sqrt();
        for _ in &support.corners {
            for (axis, sign) in [(1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
                let mut line = vec![0.0; forces + 1];
                line[3 * corner] = -most;
                line[3 * corner + axis] = sign;
                lines.push(line);
                right.push(0.0);
            }
            let mut line = vec![0.0; forces + 1];
            line[3 * corner] = -1.0;
            lines.push(line);
            right.push(0.0);
            corner += 1;
        }
    }
    let inequalities = lines.len() - root.len();
    let matrix = CscMatrix::from(&lines);
    let mut cost = vec![0.0; forces + 1];
    cost[forces] = -1.0;
    let cones = [ZeroConeT(root.len()), NonnegativeConeT(inequalities)];
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-12,
        tol_gap_rel: 1e-12,
        tol_feas: 1e-12,
        ..DefaultSettings::default()
    };
    let quadratic = CscMatrix::zeros((forces + 1, forces + 1));
    let mut solver = DefaultSolver::new(&quadratic, &cost, &matrix, &right, &cones, settings).unwrap();
    solver.solve();
    assert!(
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
        "{:?}",
        solver.solution.status
    );
    solver.solution.x[forces] * weight
}

#[test]
fn forces_agree_with_an_interior_point_method() {
    let mut rng = random("interior point");
    let (mut worst, mut compared) = (0f64, 0);
    for friction in [0.8, 0.3] {
        for _ in 0..20 {
            let mut body = Body::standing(friction, "hand_r");
            for (i, coordinate) in body.model.coordinates().iter().enumerate() {
                let most = if ["arm", "elbow", "pro", "wrist"].iter().any(|part| coordinate.name.starts_with(part)) {
                    0.6
                } else {
                    0.03
                };
                let value = &mut body.posture.values_mut()[i];
                *value = (*value + rng.random_range(-most..most)).clamp(coordinate.range.0, coordinate.range.1);
            }
            body.loads = vec![Load::weight(&body.model, body.station.segment, rng.random_range(0.0..3.0))];
            let Some(mut capacity) = Capacity::new(&body.situation(), body.station, Demand::default()).unwrap() else {
                continue;
            };
            for _ in 0..5 {
                let direction = V::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
                let (found, theirs) = (capacity.in_direction(&direction).force, by_interior_point(&body, &direction));
                worst = worst.max((found - theirs).abs() / theirs.max(1.0));
                compared += 1;
            }
        }
    }
    println!("{compared} forces: {worst:.1e} at most from Clarabel's");
    assert!(compared > 100 && worst < 1e-6, "{compared}: {worst:e}");
}

#[test]
fn a_symmetric_body_has_mirror_images_of_forces_at_both_hands() {
    let [right, left] = ["hand_r", "hand_l"].map(|hand| Body::standing(0.6, hand).solid());
    let key = |v: &V| [v.x, v.y, v.z].map(|x| (x * 1e9).round() as i64);
    let of_left: BTreeMap<[i64; 3], f64> =
        left.forces.iter().map(|greatest| (key(&greatest.direction), greatest.force)).collect();
    for greatest in &right.forces {
        let mirrored = V::new(greatest.direction.x, greatest.direction.y, -greatest.direction.z);
        let force = of_left[&key(&mirrored)];
        assert!(
            (force - greatest.force).abs() < 1e-8 * greatest.force.max(1.0),
            "{:?}: {force} {}",
            greatest.direction,
            greatest.force
        );
    }
    assert!((right.weakest.force - left.weakest.force).abs() < 1e-6 * left.weakest.force);
}

#[test]
fn shares_of_limits_are_relative_derivatives() {
    let body = Body::standing(0.4, "hand_r");
    let step = 1e-6;
    let (mut compared, mut kinds) = (0, [0; 3]);
    for greatest in body.solid().forces.iter().step_by(5) {
        for limit in &greatest.limits {
            let with = |by: f64| {
                let mut other = body.clone();
                match limit.by {
                    Limiter::Strength { coordinate, side } => {
                        let mut groups = body.model.coordinates()[coordinate].groups.clone().unwrap();
                        groups[side.index()].strength.peak *= 1.0 + by;
                        other.model = body.model.clone().with_groups(coordinate, groups);
                    }
                    Limiter::Friction => other.supports.iter_mut().for_each(|support| support.friction *= 1.0 + by),
                    Limiter::Balance => {
                        for support in &mut other.supports {
                            let middle = support.middle();
                            support.corners.iter_mut().for_each(|corner| *corner += by * (*corner - middle));
                        }
                    }
                }
                other.capacity().in_direction(&greatest.direction).force
            };
            let [more, less] = [with(step), with(-step)].map(|force| (force - greatest.force) / greatest.force / step);
            // On both sides of a corner of the program the derivative differs: the share lies between.
            let between = limit.share >= more.min(-less) - 1e-4 && limit.share <= more.max(-less) + 1e-4;
            assert!(between, "{:?} {:?}: {more} {}", greatest.direction, limit, -less);
            compared += 1;
            kinds[match limit.by {
                Limiter::Strength { .. } => 0,
                Limiter::Balance => 1,
                Limiter::Friction => 2,
            }] += 1;
        }
    }
    println!("{compared} shares: {kinds:?} of strength, balance, friction");
    assert!(kinds.iter().all(|count| *count > 5), "{kinds:?}");
}

#[test]
fn a_force_held_for_a_time_is_that_of_groups_as_weak_as_their_fatigue_allows() {
    let body = Body::standing(0.6, "hand_r");
    let hold = 120.0;
    let demand = Demand { hold: Some(hold), people: People::Mean };
    let mut held = Capacity::new(&body.situation(), body.station, demand).unwrap().unwrap();
    let mut weak = body.clone();
    for (i, coordinate) in body.model.coordinates().iter().enumerate() {
        let Some(mut groups) = coordinate.groups.clone() else { continue };
        for group in &mut groups {
            let share = group.fatigue.load_held_for(hold);
            assert!((group.fatigue.endurance_time(share) - hold).abs() < 1e-6, "{}", group.name);
            group.strength.peak *= share;
        }
        weak.model = weak.model.with_groups(i, groups);
    }
    let mut weak = weak.capacity();
    for direction in directions().0.iter().step_by(7) {
        let (a, b) = (held.in_direction(direction).force, weak.in_direction(direction).force);
        assert!((a - b).abs() < 1e-9 * b.max(1.0), "{direction:?}: {a} {b}");
    }
    let of = |people| Capacity::new(&body.situation(), body.station, Demand { hold: Some(hold), people }).unwrap();
    let (mean, strong) = (held.solid(), of(People::Stronger).unwrap().solid());
    assert!(mean.weakest.force < strong.weakest.force);
    if let Some(mut weaker) = of(People::Weaker) {
        assert!(weaker.solid().weakest.force < mean.weakest.force);
    }
}

#[test]
fn a_posture_that_cannot_be_held_has_no_forces() {
    let mut body = Body::standing(0.6, "hand_r");
    let tilt = body.model.coordinate("pelvis_tilt").unwrap();
    body.posture.values_mut()[tilt] = -0.5;
    assert!(Capacity::new(&body.situation(), body.station, Demand::default()).unwrap().is_none(), "leans too far");
    let mut body = Body::standing(0.6, "hand_r");
    body.loads = vec![Load::weight(&body.model, body.station.segment, 60.0)];
    assert!(Capacity::new(&body.situation(), body.station, Demand::default()).unwrap().is_none(), "60 kg in one hand");
    let mut body = Body::standing(0.6, "hand_r");
    let other = body.model.segment("hand_l").unwrap();
    body.supports.clear();
    body.loads = vec![Load::weight(&body.model, other, 60.0)];
    assert!(Capacity::new(&body.situation(), body.station, Demand::default()).unwrap().is_none(), "60 kg in the other");
}

#[test]
fn points_that_are_none_and_bodies_without_strength_are_refused_by_name() {
    let body = Body::standing(0.6, "hand_r");
    let refused = |station: Station, model: &Model| {
        let situation = Situation { model, ..body.situation() };
        Capacity::new(&situation, station, Demand::default()).unwrap_err().to_string()
    };
    let nowhere = Station { segment: 1000, ..body.station };
    assert!(refused(nowhere, &body.model).starts_with("a force at segment number 1000; the model has"));
    let odd = Station { point: V::new(0.0, f64::NAN, 0.0), ..body.station };
    assert!(refused(odd, &body.model).starts_with("a force at NaN m"));
    assert!(refused(body.station, &body.model.clone().without_groups()).contains("no strength of"));
}

#[test]
fn directions_are_642_unit_vectors_that_are_mirror_images_of_themselves_and_include_the_axes() {
    let (points, faces) = directions();
    assert_eq!((points.len(), faces.len()), (642, 1280));
    assert!(points.iter().all(|point| (point.norm() - 1.0).abs() < 1e-15));
    for axis in [V::x(), V::y(), V::z()] {
        for sign in [1.0, -1.0] {
            assert!(points.iter().any(|point| (point - sign * axis).norm() < 1e-12));
        }
        let mirrored = |point: &V| point - 2.0 * axis.dot(point) * axis;
        assert!(points.iter().all(|point| points.iter().any(|other| (other - mirrored(point)).norm() < 1e-12)));
    }
    // The normal of the nearest plane is within this angle of a direction, whose force is at most 1 / cos of the least force.
    let gap = |[a, b, c]: &[usize; 3]| {
        let middle = (points[*b] - points[*a]).cross(&(points[*c] - points[*a])).normalize();
        libm::acos(middle.dot(&points[*a]))
    };
    let widest = faces.iter().map(gap).fold(0.0, f64::max);
    assert!(widest < 5.6f64.to_radians() && 1.0 / libm::cos(widest) < 1.005, "{}", widest.to_degrees());
    // Volume of the body of the faces: outward everywhere, and that of a ball but for the corners cut off.
    let volume: f64 = faces.iter().map(|[a, b, c]| points[*a].dot(&points[*b].cross(&points[*c])) / 6.0).sum();
    assert!(faces.iter().all(|[a, b, c]| points[*a].dot(&points[*b].cross(&points[*c])) > 0.0));
    assert!((volume - 4.0 / 3.0 * std::f64::consts::PI).abs() < 0.06, "{volume}");
}
