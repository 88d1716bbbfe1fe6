//! Tests the force and moment that joints transmit on the built-in adult with muscles: against sums over free bodies made another way, against
//! virtual work, and against a leg whose numbers fit on paper.

use contrapposto::joint_torques::{JointReactions, PathForces};
use contrapposto::kinematics::Kinematics;
use contrapposto::math::Function;
use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::muscle::{
    FiberLaw, Ligament, LigamentLaw, Location, MovingPoint, Muscle, MuscleSpec, Musculature, Path, PathGeometry,
    PathPoint, PathRule, PathWrap, Paths, Quadrant, Thelen2003, WrapMethod, WrapObject, WrapShape,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, FixedIn, Load, LoadKind};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random() -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_261_126);
    println!("joint reaction: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

fn inside(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.0), c.range.1.min(c.default + 1.0));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    Posture::new(values.collect())
}

fn point(segment: Option<usize>, x: f64, y: f64, z: f64) -> PathPoint {
    PathPoint { segment, location: Location::Fixed(V::new(x, y, z)) }
}

fn muscle(path: usize) -> Muscle {
    Muscle::new(MuscleSpec {
        name: format!("m{path}"),
        path,
        max_isometric_force: 1000.0,
        optimal_fiber_length: 0.1,
        tendon_slack_length: 0.2,
        pennation: 0.0,
        max_pennation: 1.4,
        least_activation: 0.01,
        rigid_tendon: false,
        law: FiberLaw::Thelen2003(Thelen2003::default()),
    })
    .unwrap()
}

/// Muscles from ground to the trunk, over elbow and wrist on two cylinders, from arm to arm, from trunk to shank past the hip; and a ligament at the knee.
/// The first path has a point that moves with the elbow.
fn muscles(model: &Model, moves: bool) -> Musculature {
    let [torso, upper, lower, hand, other, thigh, shank] =
        ["torso", "humerus_r", "ulna_r", "hand_r", "humerus_l", "femur_r", "tibia_r"].map(|name| model.segment(name));
    assert!([torso, upper, lower, hand, other, thigh, shank].iter().all(Option::is_some));
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let moving = MovingPoint {
        frame: Placement::from_parts(
            Translation3::new(0.1, 0.0, 0.2),
            UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1),
        ),
        coordinate: Some(elbow),
        range: (-1.0, 3.0),
        place: [
            Function::Linear { slope: 0.03, intercept: 0.0 },
            Function::Constant(0.01),
            Function::Linear { slope: 0.02, intercept: 0.1 },
        ],
    };
    let led = PathPoint { segment: upper, location: Location::Moving(Box::new(moving)) };
    let end = model.segments()[lower.unwrap()].in_parent.translation.vector;
    let wrist = model.segments()[hand.unwrap()].in_parent.translation.vector;
    let straight = |points: Vec<PathPoint>| Path { points, ..Path::default() };
    let wraps = [0, 1].map(|object| PathWrap { object, method: WrapMethod::Hybrid, range: (None, None) }).to_vec();
    let over = Path {
        points: vec![point(upper, 0.01, end.y + 0.15, 0.0), point(hand, 0.05, -0.1, 0.0)],
        wraps,
        ..Path::default()
    };
    let mut first = vec![point(None, 0.1, 0.4, 0.2), point(torso, 0.05, 0.2, 0.1), point(hand, 0.02, -0.05, 0.01)];
    if moves {
        first.insert(2, led);
    }
    let roll = |at: V, turn: (f64, f64, f64)| WrapObject {
        name: "roll".to_owned(),
        segment: lower,
        pose: Placement::from_parts(at.into(), UnitQuaternion::from_euler_angles(turn.0, turn.1, turn.2)),
        quadrant: Quadrant::All,
        active: true,
        shape: WrapShape::Cylinder { radius: 0.03, length: 1.0 },
    };
    Musculature {
        paths: Paths {
            paths: vec![
                straight(first),
                over,
                straight(vec![point(upper, 0.03, -0.1, 0.0), point(other, 0.03, -0.15, 0.0)]),
                straight(vec![
                    point(torso, 0.05, 0.1, 0.05),
                    point(thigh, 0.04, -0.1, 0.0),
                    point(shank, 0.04, -0.06, 0.0),
                ]),
                straight(vec![point(thigh, -0.02, -0.35, 0.0), point(shank, -0.02, -0.05, 0.0)]),
            ],
            wrap_objects: vec![
                roll(V::new(0.0, 0.0, 0.01), (0.1, 0.2, 0.0)),
                roll(V::new(0.02, 0.6 * wrist.y, 0.0), (-0.2, 0.1, 0.3)),
            ],
            ..Paths::default()
        },
        muscles: (0..4).map(muscle).collect(),
        ligaments: vec![Ligament {
            name: "behind".to_owned(),
            path: 4,
            law: LigamentLaw::Spring { slack_length: 0.01, stiffness: 3000.0 },
        }],
        ..Musculature::default()
    }
}

/// A body in a posture under loads, with muscles.
struct Bench {
    model: Model,
    muscles: Musculature,
    kinematics: Kinematics,
    geometry: PathGeometry,
    tensions: Vec<f64>,
    loads: Vec<Load>,
    reactions: JointReactions,
}

impl Bench {
    fn new(rng: &mut Pcg64, moves: bool) -> Self {
        let model = adult(&Adult::default()).unwrap();
        let muscles = muscles(&model, moves);
        let mut vector = |size: f64| V::from_fn(|_, _| rng.random_range(-size..size));
        let [hand, foot] = ["hand_l", "calcn_r"].map(|name| model.segment(name).unwrap());
        let loads = vec![
            Load { segment: hand, point: vector(0.1), kind: LoadKind::Weight(4.0) },
            Load { segment: foot, point: vector(0.1), kind: LoadKind::Force(vector(500.0), FixedIn::World) },
            Load { segment: hand, point: vector(0.1), kind: LoadKind::Force(vector(50.0), FixedIn::Segment) },
            Load { segment: foot, point: vector(0.1), kind: LoadKind::Couple(vector(20.0), FixedIn::Segment) },
            Load { segment: hand, point: vector(0.1), kind: LoadKind::Couple(vector(5.0), FixedIn::World) },
        ];
        Self {
            kinematics: Kinematics::new(&model),
            geometry: PathGeometry::new(&model, &muscles.paths),
            tensions: muscles.muscles.iter().map(|_| rng.random_range(0.0..1500.0)).collect(),
            reactions: JointReactions::new(&model, &muscles),
            muscles,
            model,
            loads,
        }
    }

    fn update(&mut self, posture: &Posture, rule: PathRule) {
        self.kinematics.update(&self.model, posture).unwrap();
        self.geometry.update(&self.model, &self.kinematics, &self.muscles.paths, rule);
        let paths = PathForces { muscles: &self.muscles, geometry: &self.geometry, tensions: &self.tensions };
        self.reactions.update(&self.model, &self.kinematics, &self.loads, paths).unwrap();
    }

    /// Tension of every path.
    fn of_paths(&self) -> Vec<f64> {
        let ligament = &self.muscles.ligaments[0];
        let (tension, _) = ligament.law.tension_and_slope(self.geometry.lengths()[ligament.path]);
        assert!(tension > 1.0);
        self.tensions.iter().copied().chain([tension]).collect()
    }

    /// Forces on segments with their places, and couples, from corners, weights and loads.
    fn forces(&self) -> Vec<(usize, V, V, V)> {
        let (model, at) = (&self.model, &self.kinematics);
        let mut all: Vec<(usize, V, V, V)> = vec![];
        for (s, segment) in model.segments().iter().enumerate() {
            let place = at.placement(model, s) * nalgebra::Point3::from(segment.center_of_mass);
            all.push((s, place.coords, segment.mass * model.gravity(), V::zeros()));
        }
        for load in &self.loads {
            let frame = at.placement(model, load.segment);
            let place = (frame * nalgebra::Point3::from(load.point)).coords;
            let turned = |v: V, fixed| if fixed == FixedIn::World { v } else { frame.rotation * v };
            let (force, couple) = match load.kind {
                LoadKind::Weight(mass) => (mass * model.gravity(), V::zeros()),
                LoadKind::Force(force, fixed) => (turned(force, fixed), V::zeros()),
                LoadKind::Couple(couple, fixed) => (V::zeros(), turned(couple, fixed)),
            };
            all.push((load.segment, place, force, couple));
        }
        for (path, tension) in self.of_paths().into_iter().enumerate() {
            let corners: Vec<_> = self.geometry.corners(path).collect();
            for pair in corners.windows(2) {
                // Between two corners of one surface the line presses on its segment alone.
                if pair[0].segment == pair[1].segment {
                    continue;
                }
                let pull = tension * (pair[1].place - pair[0].place).normalize();
                for (corner, force) in [(&pair[0], pull), (&pair[1], -pull)] {
                    corner.segment.into_iter().for_each(|s| all.push((s, corner.place, force, V::zeros())));
                }
            }
        }
        all
    }
}

/// Whether a segment is moved by the joint of another one, or its own.
fn beyond(model: &Model, segment: usize, joint: usize) -> bool {
    segment == joint || model.segments()[segment].parent.is_some_and(|parent| beyond(model, parent, joint))
}

#[test]
fn the_part_beyond_a_joint_and_the_rest_of_the_body_are_in_equilibrium() {
    let mut rng = random();
    let mut bench = Bench::new(&mut rng, true);
    let mut largest = 0.0_f64;
    for _ in 0..20 {
        let posture = inside(&mut rng, &bench.model);
        bench.update(&posture, PathRule::Geodesic);
        let forces = bench.forces();
        let all = bench.reactions.all();
        for (joint, reaction) in all.iter().enumerate() {
            // Beyond the joint, and the other side: everything else, with what holds the roots, and the joint's reaction turned round.
            for (side, sign) in [(true, 1.0), (false, -1.0)] {
                let (mut force, mut moment) = (sign * reaction.force, sign * reaction.moment);
                let about = reaction.center;
                for (segment, place, f, couple) in &forces {
                    if beyond(&bench.model, *segment, joint) == side {
                        force += f;
                        moment += (place - about).cross(f) + couple;
                    }
                }
                let roots = (0..all.len()).filter(|&s| bench.model.segments()[s].parent.is_none());
                for root in
                    roots.filter(|&root| !side || beyond(&bench.model, root, joint)).filter(|&root| root != joint)
                {
                    force += all[root].force;
                    moment += (all[root].center - about).cross(&all[root].force) + all[root].moment;
                }
                if bench.model.segments()[joint].parent.is_some() || side {
                    assert!(force.norm() < 1e-9 && moment.norm() < 1e-9, "joint {joint}, {side}: {force} {moment}");
                }
                largest = largest.max(reaction.force.norm());
            }
        }
    }
    println!("greatest force {largest:.0} N");
    assert!(largest > 500.0);
}

/// By virtual work: reactions, times the motions of segments against each other as a rate moves the body, give the torque that nothing else gives.
#[test]
fn the_part_of_a_moment_along_a_free_axis_is_the_torque_that_no_path_gives() {
    let mut rng = random();
    let mut bench = Bench::new(&mut rng, false);
    let mut external = ExternalTorque::new(&bench.model);
    for _ in 0..10 {
        let posture = inside(&mut rng, &bench.model);
        bench.update(&posture, PathRule::Geodesic);
        external.update(&bench.model, &bench.kinematics, &bench.loads).unwrap();
        let tensions = bench.of_paths();
        for (coordinate, rate) in bench.model.coordinates().iter().enumerate().filter_map(|(c, of)| Some((c, of.rate?)))
        {
            let by_arms: f64 = tensions.iter().enumerate().map(|(p, t)| t * bench.geometry.moment_arms(p)[rate]).sum();
            let lacking = -(external.torques()[rate] + by_arms);
            let virtual_work = by_motion(&bench, &posture, coordinate);
            let size = 1.0 + tensions.iter().sum::<f64>();
            assert!((virtual_work - lacking).abs() < 1e-9 * size, "{coordinate}: {virtual_work} {lacking}");
        }
    }
}

/// Power of all reactions at a speed of 1 of one coordinate, W. Exact for hinges and slides: the segments beyond turn about one axis.
fn by_motion(bench: &Bench, posture: &Posture, coordinate: usize) -> f64 {
    let model = &bench.model;
    // Richardson's rule over central differences of placements.
    let rates = |step: f64| -> Vec<(V, V)> {
        let at = |sign: f64| {
            let mut moved = posture.clone();
            moved.values_mut()[coordinate] += sign * step;
            let mut kinematics = Kinematics::new(model);
            kinematics.update(model, &moved).unwrap();
            kinematics
        };
        let (ahead, behind) = (at(1.0), at(-1.0));
        let of = |s: usize| {
            let [a, b] = [&ahead, &behind].map(|k| k.placement(model, s));
            let turn = (a.rotation * b.rotation.inverse()).scaled_axis() / (2.0 * step);
            (turn, (a.translation.vector - b.translation.vector) / (2.0 * step))
        };
        (0..model.segments().len()).map(of).collect()
    };
    let (coarse, fine, finest) = (rates(8e-3), rates(4e-3), rates(2e-3));
    let better = |a: V, b: V, c: V| {
        let [ab, bc] = [(4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0];
        (16.0 * bc - ab) / 15.0
    };
    let rate = |s: usize| {
        let [(w0, v0), (w1, v1), (w2, v2)] = [coarse[s], fine[s], finest[s]];
        (better(w0, w1, w2), better(v0, v1, v2))
    };
    let velocity = |s: usize, place: &V| {
        let (turn, moved) = rate(s);
        let origin = bench.kinematics.placement(model, s).translation.vector;
        (turn, moved + turn.cross(&(place - origin)))
    };
    let power = |(s, segment): (usize, &contrapposto::model::Segment)| {
        let reaction = bench.reactions.all()[s];
        let (turn, moved) = velocity(s, &reaction.center);
        let (turn_before, moved_before) =
            segment.parent.map_or_else(Default::default, |parent| velocity(parent, &reaction.center));
        reaction.force.dot(&(moved - moved_before)) + reaction.moment.dot(&(turn - turn_before))
    };
    model.segments().iter().enumerate().map(power).sum()
}

/// The knee of a standing leg bent by its foot's force: quadriceps times arm balances the moment, and presses the joint by its whole tension.
#[test]
fn a_muscle_presses_the_joint_that_it_crosses_along_the_bone() {
    let model = adult(&Adult::default()).unwrap();
    let [thigh, shank] = ["femur_r", "tibia_r"].map(|name| model.segment(name).unwrap());
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &model.default_posture()).unwrap();
    let knee = kinematics.station(&model, shank, model.segments()[shank].in_segment.translation.vector);
    let ankle = model.segments().iter().position(|s| s.parent == Some(shank)).unwrap();
    let foot = kinematics.station(&model, ankle, model.segments()[ankle].in_segment.translation.vector);
    let bone = (foot - knee).normalize();
    // 0.04 m in front of the knee, along the bone.
    let across = bone.cross(&V::z()).normalize();
    let local = |s: usize, place: V| {
        let frame = kinematics.placement(&model, s);
        frame.inverse_transform_point(&place.into()).coords
    };
    let at = |s: usize, place: V| PathPoint { segment: Some(s), location: Location::Fixed(local(s, place)) };
    let path = Path {
        points: vec![at(thigh, knee + 0.04 * across - 0.1 * bone), at(shank, knee + 0.04 * across + 0.1 * bone)],
        ..Path::default()
    };
    let muscles = Musculature {
        paths: Paths { paths: vec![path], ..Paths::default() },
        muscles: vec![muscle(0)],
        ..Musculature::default()
    };
    let mut geometry = PathGeometry::new(&model, &muscles.paths);
    geometry.update(&model, &kinematics, &muscles.paths, PathRule::Geodesic);
    let mut reactions = JointReactions::new(&model, &muscles);
    let mut with = |tension: f64| {
        let paths = PathForces { muscles: &muscles, geometry: &geometry, tensions: &[tension] };
        reactions.update(&model, &kinematics, &[], paths).unwrap();
        reactions.all()[shank]
    };
    let (rested, pulling) = (with(0.0), with(800.0));
    let carried = model.segments().iter().enumerate().filter(|(s, _)| beyond(&model, *s, shank));
    let mass: f64 = carried.map(|(_, segment)| segment.mass).sum();
    let weight = mass * model.gravity().dot(&bone);
    let compression = |of: &contrapposto::joint_torques::JointReaction| of.compression.unwrap();
    assert!((compression(&rested).force + weight).abs() < 1e-9, "the hanging shank pulls: {rested:?}");
    assert!((compression(&pulling).force - (800.0 - weight)).abs() < 1e-9, "{pulling:?}");
    assert_eq!(compression(&pulling).along, shank);
    let turned = (pulling.moment - rested.moment).dot(&across.cross(&-bone));
    assert!((turned.abs() - 32.0).abs() < 1e-9 && (pulling.moment - rested.moment).norm() - 32.0 < 1e-9, "{turned}");
    // The foot is short: its joint is pressed along the shank.
    assert_eq!(reactions.all()[ankle].compression.unwrap().along, shank);
    assert_eq!(reactions.crossed().collect::<Vec<_>>(), [shank]);
}

/// Repeated calls do not add up, and a load that does not fit leaves the answer as it is.
#[test]
fn a_call_leaves_nothing_behind() {
    let mut rng = random();
    let mut bench = Bench::new(&mut rng, true);
    let posture = inside(&mut rng, &bench.model);
    bench.update(&posture, PathRule::Geodesic);
    let before = bench.reactions.all().to_vec();
    bench.update(&posture, PathRule::Geodesic);
    assert_eq!(before, bench.reactions.all());
    let paths = PathForces { muscles: &bench.muscles, geometry: &bench.geometry, tensions: &bench.tensions };
    let load = [Load { segment: 9999, point: V::zeros(), kind: LoadKind::Weight(1.0) }];
    assert!(bench.reactions.update(&bench.model, &bench.kinematics, &load, paths).is_err());
    assert_eq!(before, bench.reactions.all());
}
