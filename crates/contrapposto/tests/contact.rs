//! Contact forces: they balance the root, push and never pull, stay inside friction and patches, and need no more effort
//! than those of an independent solver. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use contrapposto::contact::{Balance, Condition, ContactForces, FACES, Support, SupportError, root_rates};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::{
    Adult, CoordinateSpec, JointKind, Model, ModelBuilder, Motion, Placement, SegmentSpec, Side, adult,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

const G: f64 = 9.81;
const STATURE: f64 = 1.741;

fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

/// A body, its torques without contact, and its contact forces.
struct Stand {
    model: Model,
    body: JointTorques,
    contact: ContactForces,
    loads: Vec<Load>,
}

impl Stand {
    fn new(model: Model, supports: Vec<Support>, loads: Vec<Load>) -> Self {
        let contact = ContactForces::new(&model, supports).unwrap();
        let body = JointTorques::new(&model);
        Self { model, body, contact, loads }
    }

    /// The adult on both soles, 3 kg in a hand.
    fn adult(friction: f64, share_max: f64) -> Self {
        let model = adult(&Adult::default()).unwrap();
        let support = |name: &str, share_max: f64| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support {
                segment,
                corners,
                normal: V::y(),
                friction,
                share_max,
                place: contrapposto::contact::Place::Fixed,
            }
        };
        let supports = vec![support("calcn_r", 1.0), support("calcn_l", share_max)];
        let loads = vec![Load::weight(&model, model.segment("hand_r").unwrap(), 3.0)];
        Self::new(model, supports, loads)
    }

    fn update(&mut self, posture: &Posture) -> Balance {
        self.body.update(&self.model, posture, &self.loads, Quantities::TORQUES).unwrap();
        let Self { body, contact, .. } = self;
        contact.update(&self.model, body.kinematics_by_axes(), body.angles(), body.active_torque())
    }

    /// Torque of muscles, and of the root what is missing.
    fn active(&self, rate: usize) -> f64 {
        let passive = self.body.passive_torque().about_axes()[rate];
        -(self.body.external_about_axes()[rate] + passive + self.contact.torques()[rate])
    }

    /// The reason for which the supports do not hold.
    fn condition(&self) -> Condition {
        self.contact.missing(&self.model, self.body.kinematics()).unwrap().condition
    }

    fn effort(&self) -> f64 {
        let groups =
            self.model.coordinates().iter().enumerate().filter_map(|(i, c)| Some((i, c.rate?, c.groups.as_ref()?)));
        let load = |(i, rate, groups): (usize, usize, &[contrapposto::model::MuscleGroup; 2])| {
            let active = self.active(rate);
            let strength = groups[Side::of(active).index()].strength.torque(self.body.angles()[i]);
            (active / strength).powi(2)
        };
        groups.map(load).sum()
    }
}

/// Near standing: legs bent a little either way, arms and trunk anywhere near.
fn near_standing(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let legs = ["hip", "knee", "ankle", "subtalar", "pelvis", "lumbar", "thoracic"];
        let most = if legs.iter().any(|part| c.name.starts_with(part)) { 0.07 } else { 0.7 };
        (c.default + rng.random_range(-most..most)).clamp(c.range.0, c.range.1)
    });
    Posture::new(values.collect())
}

#[test]
fn forces_hold_the_root_push_and_stay_inside_friction_and_patch() {
    let mut rng = random("forces");
    let (mut held, mut worst, mut kept) = (0, 0f64, 0);
    let mut without = JointTorques::new(&Stand::adult(0.6, 1.0).model);
    for round in 0..4 {
        let (friction, share_max) = [(0.6, 1.0), (0.3, 0.4), (f64::INFINITY, 1.0), (0.8, 0.15)][round];
        let mut stand = Stand::adult(friction, share_max);
        let weight = stand.model.mass() * G;
        for _ in 0..150 {
            let posture = near_standing(&mut rng, &stand.model);
            if stand.update(&posture) != Balance::Held {
                continue;
            }
            held += 1;
            // With the forces as plain loads the root is in equilibrium.
            let loads: Vec<Load> = stand.loads.iter().chain(stand.contact.loads()).copied().collect();
            without.update(&stand.model, &posture, &loads, Quantities::TORQUES).unwrap();
            for rate in root_rates(&stand.model) {
                let size = if stand.model.rates()[rate].rotational { weight * STATURE } else { weight };
                worst = worst.max(without.active_torque()[rate].abs() / size);
            }
            // Two ways to the torque of contact forces.
            for rate in 0..stand.model.rates().len() {
                let difference = without.external_about_axes()[rate] - stand.body.external_about_axes()[rate];
                assert!((difference - stand.contact.torques()[rate]).abs() < 1e-9 * weight);
            }
            for support in 0..2 {
                let shares = &stand.contact.forces()
                    [3 * stand.contact.corners(support).start..3 * stand.contact.corners(support).end];
                for corner in shares.chunks_exact(3) {
                    assert!(corner[0] >= -1e-12, "a corner pulls with {} of weight", -corner[0]);
                    if friction.is_finite() {
                        let pyramid = friction / (FACES as f64 / 2.0).sqrt() * corner[0];
                        assert!(corner[1].abs() <= pyramid + 1e-9 && corner[2].abs() <= pyramid + 1e-9);
                        assert!(libm::hypot(corner[1], corner[2]) <= friction * corner[0] + 1e-9, "outside the cone");
                    }
                }
                inside_the_patch(&stand, support);
            }
            let share = stand.contact.share(1);
            let total = stand.contact.share(0) + share;
            let lifted =
                stand.loads.iter().map(|l| if let LoadKind::Weight(m) = l.kind { m * G } else { 0.0 }).sum::<f64>();
            assert!((total - (weight + lifted) / weight).abs() < 1e-8, "all weight is carried: {total}");
            if share_max < 1.0 {
                let least = Oracle::of(&stand).least_share(1);
                let most = share_max.max(least);
                kept += usize::from(least <= share_max);
                assert!(share <= most + 2e-6, "share {share}, least {least}, greatest {share_max}");
            }
        }
    }
    println!("{held} postures held of 600, root off by {worst:.1e} at most; the greatest share was kept in {kept}");
    assert!(held > 200 && kept > 20);
    assert!(worst < 1e-8, "{worst}");
}

/// The centre of pressure, from force and moment of the loads alone, lies within the corners in every direction of the plane.
fn inside_the_patch(stand: &Stand, support: usize) {
    let Some(center) = stand.contact.center_of_pressure(&stand.model, stand.body.kinematics(), support) else { return };
    let corners = stand.contact.corners(support);
    let mut force = 0.0;
    let mut moment = V::zeros();
    let mut stations = vec![];
    for load in &stand.contact.loads()[corners] {
        let LoadKind::Force(f, _) = load.kind else { panic!() };
        let at = stand.body.kinematics().station(&stand.model, load.segment, load.point);
        force += f.y;
        moment += at.cross(&V::new(0.0, f.y, 0.0));
        stations.push(at);
    }
    // r x (f y) = (-z f, 0, x f)
    assert!((moment.z / force - center.x).abs() < 1e-9 && (-moment.x / force - center.z).abs() < 1e-9);
    for k in 0..64 {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 64.0);
        let along = V::new(cos, 0.0, sin);
        let most = stations.iter().map(|station| station.dot(&along)).fold(f64::NEG_INFINITY, f64::max);
        assert!(center.dot(&along) <= most + 1e-9);
    }
}

/// The same unknowns as a quadratic program: corner forces, and what the muscles of either side of every joint give.
struct Oracle {
    /// Unknown forces, and groups of both sides.
    forces: usize,
    joints: usize,
    /// Rows `a x = b` and `a x <= b`, sparse.
    equal: Vec<(Vec<(usize, f64)>, f64)>,
    below: Vec<(Vec<(usize, f64)>, f64)>,
}

impl Oracle {
    fn of(stand: &Stand) -> Self {
        let n = stand.model.rates().len();
        let columns = stand.contact.columns();
        let forces = stand.contact.forces().len();
        let weight = stand.contact.weight();
        let row = |rate: usize, size: f64| -> Vec<(usize, f64)> {
            (0..forces).map(|j| (j, columns[j * n + rate] / size)).collect()
        };
        let rest = |rate: usize| -stand.body.active_torque()[rate];
        let mut oracle = Self { forces, joints: 0, equal: vec![], below: vec![] };
        for rate in root_rates(&stand.model) {
            oracle.equal.push((row(rate, weight), -rest(rate) / weight));
        }
        for (i, coordinate) in stand.model.coordinates().iter().enumerate() {
            let (Some(rate), Some(groups)) = (coordinate.rate, &coordinate.groups) else { continue };
            let q = stand.body.angles()[i];
            let strengths = [0, 1].map(|side| groups[side].strength.torque(q));
            let [positive, negative] = [0, 1].map(|side| forces + 2 * oracle.joints + side);
            // Loads of both groups, shares of their strength: S+ positive - S- negative = active, all over S+.
            let mut entries = row(rate, strengths[0]);
            entries.extend([(positive, 1.0), (negative, -strengths[1] / strengths[0])]);
            oracle.equal.push((entries, -rest(rate) / strengths[0]));
            oracle.below.push((vec![(positive, -1.0)], 0.0));
            oracle.below.push((vec![(negative, -1.0)], 0.0));
            oracle.joints += 1;
        }
        let mut corner = 0;
        for support in stand.contact.supports() {
            for _ in &support.corners {
                oracle.below.push((vec![(3 * corner, -1.0)], 0.0));
                if support.friction.is_finite() {
                    let most = support.friction / (FACES as f64 / 2.0).sqrt();
                    for (axis, sign) in [(1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
                        oracle.below.push((vec![(3 * corner, -most), (3 * corner + axis, sign)], 0.0));
                    }
                }
                // No force beyond two body weights.
                for axis in 0..3 {
                    oracle.below.push((vec![(3 * corner + axis, 1.0)], 2.0));
                    oracle.below.push((vec![(3 * corner + axis, -1.0)], 2.0));
                }
                corner += 1;
            }
        }
        oracle
    }

    /// Least `sum weights x^2 + linear x`.
    fn solve(&self, weights: &[f64], linear: &[f64]) -> Option<f64> {
        let n = self.forces + 2 * self.joints;
        let diagonal = |values: &[f64]| {
            let entries = (0..n).filter(|&i| values[i] != 0.0);
            let (rows, values): (Vec<usize>, Vec<f64>) = entries.map(|i| (i, 2.0 * values[i])).unzip();
            CscMatrix::new_from_triplets(n, n, rows.clone(), rows, values)
        };
        let (mut rows, mut columns, mut values, mut right) = (vec![], vec![], vec![], vec![]);
        for (i, (entries, limit)) in self.equal.iter().chain(&self.below).enumerate() {
            for &(column, value) in entries.iter().filter(|(_, value)| *value != 0.0) {
                rows.push(i);
                columns.push(column);
                values.push(value);
            }
            right.push(*limit);
        }
        let matrix = CscMatrix::new_from_triplets(right.len(), n, rows, columns, values);
        let cones = [ZeroConeT(self.equal.len()), NonnegativeConeT(self.below.len())];
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-11)
            .tol_gap_rel(1e-11)
            .tol_feas(1e-11)
            .max_iter(200)
            .build()
            .unwrap();
        let mut solver = DefaultSolver::new(&diagonal(weights), linear, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        let solved = solver.solution.status == SolverStatus::Solved;
        solved.then_some(solver.solution.obj_val)
    }

    fn least_effort(&self) -> Option<f64> {
        let mut weights = vec![0.0; self.forces];
        weights.extend(vec![1.0; 2 * self.joints]);
        self.solve(&weights, &vec![0.0; weights.len()])
    }

    fn least_share(&self, support: usize) -> f64 {
        let n = self.forces + 2 * self.joints;
        let corners = self.forces / 6;
        let mut linear = vec![0.0; n];
        (support * corners..(support + 1) * corners).for_each(|corner| linear[3 * corner] = 1.0);
        self.solve(&vec![0.0; n], &linear).unwrap()
    }
}

#[test]
fn no_forces_spare_the_muscles_more() {
    let mut rng = random("least effort");
    let (mut compared, mut worst, mut better) = (0, 0f64, 0f64);
    for friction in [0.6, 0.2, f64::INFINITY] {
        let mut stand = Stand::adult(friction, 1.0);
        for _ in 0..150 {
            let posture = near_standing(&mut rng, &stand.model);
            if stand.update(&posture) != Balance::Held {
                continue;
            }
            let Some(least) = Oracle::of(&stand).least_effort() else { continue };
            compared += 1;
            let over = (stand.effort() - least) / least;
            worst = worst.max(over);
            better = better.max(-over);
        }
    }
    println!("{compared} postures: effort above Clarabel's by {worst:.1e} of it at most, below by {better:.1e}");
    assert!(compared > 60);
    assert!(worst < 1e-6 && better < 1e-6, "{worst} {better}");
}

/// A block that may slide along x and y and turn about z, weight at `center`, on one patch.
fn block(center: V, corners: Vec<V>, normal: V, friction: f64) -> Stand {
    let motions = vec![Motion::Slide(V::x_axis()), Motion::Slide(V::y_axis()), Motion::Hinge(V::z_axis())];
    block_on(motions, Placement::identity(), center, corners, normal, friction)
}

/// A block at `frame` that may move in all ways and does not slip.
fn free_block(frame: Placement, center: V, corners: Vec<V>, normal: V) -> Stand {
    let axes = [V::x_axis(), V::y_axis(), V::z_axis()];
    let motions = axes.map(Motion::Slide).into_iter().chain(axes.map(Motion::Hinge)).collect();
    block_on(motions, frame, center, corners, normal, f64::INFINITY)
}

fn block_on(motions: Vec<Motion>, in_parent: Placement, center: V, corners: Vec<V>, normal: V, friction: f64) -> Stand {
    let mut builder = ModelBuilder::new("block", V::new(0.0, -G, 0.0));
    let names = 0..motions.len();
    let coordinates = names.map(|i| CoordinateSpec::new(&format!("q{i}"), (-10.0, 10.0))).collect();
    builder
        .segment(SegmentSpec {
            name: "block".to_owned(),
            parent: None,
            mass: 20.0,
            center_of_mass: center,
            inertia: Matrix3::identity(),
            joint: "root".to_owned(),
            kind: JointKind::Chain(motions),
            in_parent,
            in_segment: Placement::identity(),
            coordinates,
        })
        .unwrap();
    let support = Support {
        segment: 0,
        corners,
        normal: normal.normalize(),
        friction,
        share_max: 1.0,
        place: contrapposto::contact::Place::Fixed,
    };
    Stand::new(builder.build(), vec![support], vec![])
}

/// Two patches whose front edges differ by less than counts as balance: the weight acts at the edge, where the last digits of equilibrium
/// would have the patch farther in front carry 35 % though 20 % are allowed.
#[test]
fn at_the_edge_of_the_supports_shares_are_kept() {
    let patch = |front: f64, sides: [f64; 2]| {
        sides.iter().flat_map(|&z| [V::new(-0.1, 0.0, z), V::new(front, 0.0, z)]).collect::<Vec<_>>()
    };
    for beyond in [-1e-6, -2e-10, 0.0, 2e-10, 6e-10] {
        let center = V::new(0.1 + beyond, 1.0, 0.08);
        let mut stand = free_block(Placement::identity(), center, patch(0.1, [0.05, 0.15]), V::y());
        let [first] = stand.contact.supports() else { unreachable!() };
        let other = Support { corners: patch(0.1 + 3e-10, [-0.15, -0.05]), share_max: 0.2, ..first.clone() };
        stand = Stand::new(stand.model, vec![first.clone(), other], vec![]);
        assert_eq!(stand.update(&stand.model.default_posture()), Balance::Held, "{beyond}");
        let share = stand.contact.share(1);
        println!("weight {beyond} m beyond the first edge: the other patch carries {share}");
        assert!(share <= 0.2 + 2e-6, "{share}");
    }
}

/// Weight `reach` beyond the edge `a` of the patch: a force `N` at the edge leaves `(N - 1)` of weight and `(N a - c)` of moment,
/// least in squares at `N = (1 + a c)/(1 + a^2)`. Both together, times `sqrt(1 + a^2)`, are how far the body leans too far.
#[test]
fn a_body_that_leans_beyond_its_feet_is_short_by_that_much() {
    let weight = 20.0 * G;
    for (edge, center) in [(0.1, 0.25), (0.1, 0.1 + 1e-4), (0.3, 0.9)] {
        let mut stand =
            block(V::new(center, 1.0, 0.0), vec![V::new(-edge, 0.0, 0.0), V::new(edge, 0.0, 0.0)], V::y(), 0.5);
        let start = stand.model.default_posture();
        let Balance::Short { force, moment } = stand.update(&start) else { panic!("it would fall") };
        let n = (1.0 + edge * center) / (1.0 + edge * edge);
        assert!((force - (n - 1.0).abs() * weight).abs() < 1e-9 * weight, "{force} N");
        assert!((moment - (n * edge - center).abs() * weight).abs() < 1e-9 * weight, "{moment} N m");
        let reach = libm::hypot(force, moment) / weight * (1.0 + edge * edge).sqrt();
        assert!((reach - (center - edge)).abs() < 1e-9, "{reach} m beyond the edge");
        let Condition::Beyond(lean) = stand.condition() else { panic!("it leans") };
        assert!((lean - V::new(center - edge, 0.0, 0.0)).norm() < 1e-9, "{lean}");
    }
    // On the edge itself, and inside: it stands.
    for center in [0.1, 0.05, -0.1] {
        let mut stand =
            block(V::new(center, 1.0, 0.0), vec![V::new(-0.1, 0.0, 0.0), V::new(0.1, 0.0, 0.0)], V::y(), 0.5);
        let start = stand.model.default_posture();
        assert_eq!(stand.update(&start), Balance::Held, "{center}");
        let at = stand.contact.center_of_pressure(&stand.model, stand.body.kinematics(), 0).unwrap();
        assert!((at.x - center).abs() < 1e-9);
    }
}

/// On a slope of angle `a` friction reaches `atan(mu / sqrt 2)` along an axis of the pyramid: what is left of the weight is the
/// sine of the difference, all of it force, where the weight stands above the one corner.
#[test]
fn on_too_steep_a_slope_friction_is_short_by_the_sine() {
    let weight = 20.0 * G;
    for (slope, friction) in [(0.5f64, 0.6f64), (0.9, 0.3), (0.3, 0.0), (0.2, 0.6)] {
        let normal = V::new(libm::sin(slope), libm::cos(slope), 0.0);
        let mut stand = block(V::new(0.0, 0.5, 0.0), vec![V::zeros()], normal, friction);
        let start = stand.model.default_posture();
        let balance = stand.update(&start);
        let reach = libm::atan(friction / 2f64.sqrt());
        if slope <= reach {
            assert_eq!(balance, Balance::Held);
            continue;
        }
        let Balance::Short { force, moment } = balance else { panic!("it would slip") };
        assert!(
            (force - weight * libm::sin(slope - reach)).abs() < 1e-9 * weight,
            "{force} N at {slope} and {friction}"
        );
        assert!(moment < 1e-9 * weight);
        assert_eq!(stand.condition(), Condition::Friction);
    }
}

/// On a slope too steep for its friction, with the weight beyond its lower edge: by how far says the line of the weight, which meets the
/// plane `h tan a` farther down than the foot of the centre of mass.
#[test]
fn a_body_that_slips_and_leans_is_told_how_far_it_leans_with_more_friction() {
    for (slope, friction, height) in [(0.5f64, 0.3, 0.6f64), (0.3, 0.0, 0.9), (0.7, 0.1, 0.3)] {
        let (normal, down) =
            (V::new(libm::sin(slope), libm::cos(slope), 0.0), V::new(libm::cos(slope), -libm::sin(slope), 0.0));
        let mut stand = block(height * normal, vec![-0.1 * down, 0.1 * down], normal, friction);
        let start = stand.model.default_posture();
        assert!(matches!(stand.update(&start), Balance::Short { .. }));
        let Condition::FrictionBeyond(lean) = stand.condition() else { panic!("it slips and leans") };
        let wanted = height * libm::tan(slope) - 0.1;
        assert!((lean - wanted * down).norm() < 1e-9, "{lean} for {wanted} m");
        let words = stand.contact.missing(&stand.model, stand.body.kinematics()).unwrap().to_string();
        assert!(
            words.contains(&format!(
                "they slip, and with more friction weight and loads still act {wanted:.3} m beyond"
            )),
            "{words}"
        );
        // Without friction's part in it the same block only leans.
        let mut held = block(height * normal, vec![-0.1 * down, 0.1 * down], normal, 10.0);
        assert!(matches!(held.update(&start), Balance::Short { .. }));
        assert!(matches!(held.condition(), Condition::Beyond(found) if (found - lean).norm() < 1e-9));
    }
}

/// Weight and a push through the centre of mass act where their line meets the plane; the nearest point between the corners is
/// found by trying: the point itself if it lies in a triangle of corners, else the nearest of all lines between two.
#[test]
fn weight_and_loads_act_as_far_beyond_the_supports_as_their_line_says() {
    let mut rng = random("beyond");
    let (mut leaning, mut worst) = (0, 0f64);
    for _ in 0..400 {
        let mut any = |size: f64| V::from_fn(|_, _| rng.random_range(-size..size));
        let normal = (V::y() + any(0.3)).normalize();
        let across = normal.cross(&V::x()).normalize();
        let plane = [across, normal.cross(&across)];
        let origin = any(2.0);
        let (center, push) = (origin + normal + any(0.4), any(60.0));
        let (place, turn) = (any(1.0), any(3.0));
        let corners: Vec<V> = (0..rng.random_range(1..8))
            .map(|_| origin + plane.iter().map(|axis| rng.random_range(-0.3..0.3) * *axis).sum::<V>())
            .collect();
        // The block lies elsewhere and turned in its own frame.
        let frame = Placement::new(place, turn);
        let own = |point: &V| frame.inverse_transform_point(&(*point).into()).coords;
        let mut stand = free_block(frame, own(&center), corners.iter().map(own).collect(), normal);
        let kind = LoadKind::Force(push, FixedIn::World);
        stand.loads = vec![Load { segment: 0, point: own(&center), kind }];
        let start = stand.model.default_posture();
        let balance = stand.update(&start);
        let line = push - 20.0 * G * V::y();
        let acts = center + line * (origin - center).dot(&normal) / line.dot(&normal);
        let flat = |point: &V| plane.map(|axis| (point - origin).dot(&axis));
        let lean = beyond(flat(&acts), &corners.iter().map(flat).collect::<Vec<_>>());
        if libm::hypot(lean[0], lean[1]) < 1e-6 {
            assert_eq!(balance, Balance::Held);
            continue;
        }
        let Condition::Beyond(found) = stand.condition() else { panic!("it leans by {lean:?}") };
        worst = worst.max((found - lean[0] * plane[0] - lean[1] * plane[1]).norm());
        leaning += 1;
    }
    println!("{leaning} blocks lean, by {worst:.1e} m more or less than the line says");
    assert!(leaning > 200 && leaning < 390);
    assert!(worst < 1e-7, "{worst}");
}

/// From the nearest point of the hull of `corners` to `point`.
fn beyond(point: [f64; 2], corners: &[[f64; 2]]) -> [f64; 2] {
    let cross =
        |a: &[f64; 2], b: &[f64; 2], p: &[f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let mut least = [f64::INFINITY; 2];
    for a in corners {
        for b in corners {
            let along = [b[0] - a[0], b[1] - a[1]];
            let square = along[0].powi(2) + along[1].powi(2);
            let share = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / square.max(1e-300);
            let share = share.clamp(0.0, 1.0);
            let off = [0, 1].map(|i| point[i] - a[i] - share * along[i]);
            if libm::hypot(off[0], off[1]) < libm::hypot(least[0], least[1]) {
                least = off;
            }
            for c in corners {
                let sides = [cross(a, b, &point), cross(b, c, &point), cross(c, a, &point)];
                let whole = cross(a, b, c);
                if whole.abs() > 1e-9 && sides.iter().all(|side| side * whole >= 0.0) {
                    return [0.0; 2];
                }
            }
        }
    }
    least
}

/// Nothing under the feet at all: the whole weight is missing, and the reason is not friction.
#[test]
fn without_supports_the_weight_is_missing() {
    let model = adult(&Adult::default()).unwrap();
    let start = model.default_posture();
    let mut stand = Stand::new(model, vec![], vec![]);
    stand.update(&start);
    assert_eq!(stand.condition(), Condition::NoSupport);
}

/// Feet at different heights share no plane: no distance is given.
#[test]
fn without_a_common_plane_no_distance_is_given() {
    let corners = vec![V::new(-0.1, 0.0, 0.0), V::new(0.1, 0.2, 0.0)];
    let mut stand = block(V::new(0.5, 1.0, 0.0), corners, V::y(), 0.5);
    let start = stand.model.default_posture();
    assert!(matches!(stand.update(&start), Balance::Short { .. }));
    assert_eq!(stand.condition(), Condition::Friction);
    let missing = stand.contact.missing(&stand.model, stand.body.kinematics()).unwrap();
    assert!(missing.to_string().ends_with(" N m are missing") && !missing.to_string().contains("beyond"));
}

/// Power of the forces at their points is torque times rate, and `columns` are the torques of one body weight each.
#[test]
fn forces_do_the_work_that_their_torques_say() {
    let mut rng = random("work");
    let mut stand = Stand::adult(0.6, 1.0);
    let n = stand.model.rates().len();
    let mut jacobian = vec![0.0; 3 * n];
    for _ in 0..50 {
        let posture = near_standing(&mut rng, &stand.model);
        stand.update(&posture);
        let rates: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
        let mut power = 0.0;
        for load in stand.contact.loads() {
            let LoadKind::Force(force, _) = load.kind else { panic!() };
            let kinematics = stand.body.kinematics_by_axes();
            kinematics.point_jacobian(stand.model.by_axes(), load.segment, load.point, &mut jacobian);
            for k in 0..3 {
                power += force[k] * jacobian[k * n..(k + 1) * n].iter().zip(&rates).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        let by_torque: f64 = stand.contact.torques().iter().zip(&rates).map(|(a, b)| a * b).sum();
        let by_columns: f64 = (0..n)
            .map(|rate| {
                let torque: f64 = stand
                    .contact
                    .forces()
                    .iter()
                    .enumerate()
                    .map(|(j, f)| f * stand.contact.columns()[j * n + rate])
                    .sum();
                torque * rates[rate]
            })
            .sum();
        let size = stand.contact.weight();
        assert!((power - by_torque).abs() < 1e-10 * size && (power - by_columns).abs() < 1e-10 * size);
    }
}

/// Forces move steadily with the posture where nothing switches: the torque of muscles and contact together answers what weight and
/// ligaments ask, in every posture, and the same posture gives the same forces, whatever was asked in between.
#[test]
fn the_same_posture_gives_the_same_forces() {
    let mut rng = random("history");
    let mut stand = Stand::adult(0.6, 0.3);
    let postures: Vec<Posture> = (0..20).map(|_| near_standing(&mut rng, &stand.model)).collect();
    let mut worst = 0f64;
    for posture in &postures {
        stand.contact.forget();
        let balance = stand.update(posture);
        let first = stand.contact.forces().to_vec();
        for other in postures.iter().take(3) {
            stand.update(other);
        }
        // From what the others left: the same to rounding.
        assert_eq!(std::mem::discriminant(&stand.update(posture)), std::mem::discriminant(&balance));
        let off = first.iter().zip(stand.contact.forces()).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        worst = worst.max(off);
        // Forgetting it: the same to the bit.
        stand.contact.forget();
        stand.update(posture);
        assert_eq!(first, stand.contact.forces());
    }
    println!("after other postures forces differ by {worst:.1e} of weight at most");
    assert!(worst < 1e-7, "{worst}");
}

#[test]
fn numbers_without_meaning_are_refused() {
    let model = adult(&Adult::default()).unwrap();
    let good = Support {
        segment: 0,
        corners: vec![V::zeros()],
        normal: V::y(),
        friction: 0.5,
        share_max: 1.0,
        place: contrapposto::contact::Place::Fixed,
    };
    assert!(good.check(&model).is_ok());
    let refused = |change: &dyn Fn(&mut Support)| {
        let mut support = good.clone();
        change(&mut support);
        ContactForces::new(&model, vec![support]).err()
    };
    assert!(matches!(refused(&|s| s.segment = 1000), Some(SupportError::Segment { .. })));
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(bad == f64::INFINITY || refused(&|s| s.friction = bad).is_some(), "friction {bad}");
        assert!(bad == f64::INFINITY || refused(&|s| s.share_max = bad).is_some(), "share {bad}");
        assert!(refused(&|s| s.normal = V::new(0.0, bad * 2.0, 0.0)).is_some(), "normal {bad}");
        assert!(bad == -1.0 || refused(&|s| s.corners[0].x = bad).is_some(), "corner {bad}");
    }
    assert!(refused(&|s| s.corners.clear()).is_some());
}
