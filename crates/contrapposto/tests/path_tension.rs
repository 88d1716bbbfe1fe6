//! Tests the gradient of torques of tensions along paths on the built-in adult: against central differences, and its symmetry.

use contrapposto::joint_torques::{JointMuscles, JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::math::{Function, Spline};
use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::muscle::{
    Band, Bushing, FiberLaw, FiberState, Ligament, LigamentLaw, Location, MovingPoint, Muscle, MuscleSpec, Musculature,
    Path, PathGeometry, PathPoint, PathRule, PathWrap, Paths, Quadrant, Tension, Thelen2003, WrapMethod, WrapObject,
    WrapShape, passive_tensions,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{PathTension, PathTensionError};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random() -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_261_122);
    println!("path tension: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

/// Anywhere inside the ranges; the root about its default.
fn inside(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.0), c.range.1.min(c.default + 1.0));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    Posture::new(values.collect())
}

fn segment(model: &Model, name: &str) -> Option<usize> {
    Some(model.segment(name).unwrap_or_else(|| panic!("no segment {name}")))
}

fn point(segment: Option<usize>, x: f64, y: f64, z: f64) -> PathPoint {
    PathPoint { segment, location: Location::Fixed(V::new(x, y, z)) }
}

fn cylinder(segment: Option<usize>, at: V, turn: (f64, f64, f64), radius: f64) -> WrapObject {
    WrapObject {
        name: "roll".to_owned(),
        segment,
        pose: Placement::from_parts(Translation3::from(at), UnitQuaternion::from_euler_angles(turn.0, turn.1, turn.2)),
        quadrant: Quadrant::All,
        active: true,
        shape: WrapShape::Cylinder { radius, length: 1.0 },
    }
}

fn over(points: Vec<PathPoint>, objects: &[usize]) -> Path {
    let wraps = objects.iter().map(|&object| PathWrap { object, method: WrapMethod::Hybrid, range: (None, None) });
    Path { points, wraps: wraps.collect(), ..Path::default() }
}

/// Paths of the right arm: from ground over the trunk with a moving point, over one cylinder, over two, between two branches, over a
/// sphere and over an ellipsoid.
fn arm(model: &Model) -> Paths {
    let [torso, upper, lower, hand] = ["torso", "humerus_r", "ulna_r", "hand_r"].map(|name| segment(model, name));
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let spline = Function::Spline(Spline::simm(&[-1.0, 0.0, 1.0, 2.0, 3.0], &[0.0, 0.02, -0.01, 0.03, 0.01]).unwrap());
    let moving = MovingPoint {
        frame: Placement::from_parts(
            Translation3::new(0.1, 0.0, 0.2),
            UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1),
        ),
        coordinate: Some(elbow),
        range: (-1.0, 3.0),
        place: [spline, Function::Constant(0.01), Function::Linear { slope: 0.02, intercept: 0.1 }],
    };
    let end = model.segments()[lower.unwrap()].in_parent.translation.vector;
    let moved = PathPoint { segment: upper, location: Location::Moving(Box::new(moving)) };
    let over_elbow = |x| vec![point(upper, x, end.y + 0.15, 0.0), point(lower, x, -0.15, 0.02)];
    let wrist = model.segments()[hand.unwrap()].in_parent.translation.vector;
    Paths {
        paths: vec![
            over(
                vec![point(None, 0.1, 0.4, 0.2), point(torso, 0.05, 0.2, 0.1), moved, point(hand, 0.02, -0.05, 0.01)],
                &[],
            ),
            over(over_elbow(0.01), &[0]),
            over(vec![point(upper, 0.01, end.y + 0.15, 0.0), point(hand, 0.05, -0.1, 0.0)], &[0, 1]),
            over(vec![point(upper, 0.03, -0.1, 0.0), point(segment(model, "humerus_l"), 0.03, -0.15, 0.0)], &[]),
            over(over_elbow(0.005), &[2]),
            over(over_elbow(0.006), &[3]),
        ],
        wrap_objects: vec![
            cylinder(lower, V::new(0.0, 0.0, 0.01), (0.1, 0.2, 0.0), 0.03),
            cylinder(lower, V::new(0.02, 0.6 * wrist.y, 0.0), (-0.2, 0.1, 0.3), 0.03),
            WrapObject {
                shape: WrapShape::Sphere { radius: 0.03 },
                ..cylinder(lower, V::new(0.0, 0.0, 0.01), (0.0, 0.0, 0.0), 0.03)
            },
            WrapObject {
                shape: WrapShape::Ellipsoid { half_axes: V::new(0.03, 0.025, 0.05) },
                ..cylinder(lower, V::new(0.0, 0.0, 0.01), (0.2, 0.1, 0.3), 0.03)
            },
        ],
        ..Paths::default()
    }
}

/// A body with its paths, each with a spring from the length 0.1 m.
struct Bench {
    model: Model,
    paths: Paths,
    kinematics: Kinematics,
    geometry: PathGeometry,
    torque: PathTension,
}

const STIFFNESS: f64 = 3.0;

impl Bench {
    fn new() -> Self {
        let model = adult(&Adult::default()).unwrap();
        let paths = arm(&model);
        let (geometry, torque) = (PathGeometry::new(&model, &paths), PathTension::new(&model, &paths));
        Self { kinematics: Kinematics::new(&model), geometry, torque, paths, model }
    }

    /// The springs of one path alone.
    fn update(&mut self, posture: &Posture, path: usize) {
        self.kinematics.update(&self.model, posture).unwrap();
        self.geometry.update(&self.model, &self.kinematics, &self.paths, PathRule::Geodesic);
        let mut tensions = [Tension::default(); 6];
        tensions[path] = Tension { force: STIFFNESS * (self.geometry.lengths()[path] - 0.1), stiffness: STIFFNESS };
        self.torque.update(&self.model, &self.kinematics, &self.paths, &self.geometry, &tensions).unwrap();
    }

    /// Corners of the path: it wraps if it has more than points.
    fn wraps(&self, path: usize) -> bool {
        let mut bare = self.paths.clone();
        bare.paths.iter_mut().for_each(|path| path.wraps.clear());
        let mut straight = PathGeometry::new(&self.model, &bare);
        straight.update(&self.model, &self.kinematics, &bare, PathRule::Geodesic);
        self.geometry.lengths()[path] > straight.lengths()[path] + 1e-5
    }
}

#[test]
fn the_gradient_of_springs_along_paths_is_their_central_difference_and_symmetric() {
    let mut rng = random();
    let mut bench = Bench::new();
    let mut wrapped = [0; 6];
    for number in 0..60 {
        let mut posture = inside(&mut rng, &bench.model);
        let elbow = bench.model.coordinate("elbow_flex_r").unwrap();
        // Flexed elbows wrap.
        if number % 2 == 0 {
            posture.values_mut()[elbow] = rng.random_range(0.05..1.2);
        }
        for (path, wrapped) in wrapped.iter_mut().enumerate() {
            bench.update(&posture, path);
            *wrapped += usize::from(bench.wraps(path));
            let n = bench.model.rates().len();
            let gradient: Vec<Vec<f64>> = (0..n).map(|row| bench.torque.gradient_row(row).to_vec()).collect();
            let coordinates: Vec<usize> = bench.model.rates().iter().map(|rate| rate.coordinate.unwrap()).collect();
            for (column, coordinate) in coordinates.into_iter().enumerate() {
                let mut at = |step: f64| {
                    let mut moved = posture.clone();
                    moved.values_mut()[coordinate] += step;
                    bench.update(&moved, path);
                    bench.torque.torques().to_vec()
                };
                let h = 1e-4;
                let sides = [at(h), at(-h), at(2.0 * h), at(-2.0 * h)];
                for row in 0..n {
                    let [near, far] =
                        [(0, 2.0 * h), (2, 4.0 * h)].map(|(k, way)| (sides[k][row] - sides[k + 1][row]) / way);
                    let difference = near + (near - far) / 3.0;
                    let entry = gradient[row][column];
                    let names = [row, column].map(|i| &bench.model.rates()[i].name);
                    let off = (entry - difference).abs();
                    assert!(off < 1e-7, "posture {number}, path {path}, {names:?}: {entry} for {difference}");
                    assert!((entry - gradient[column][row]).abs() < 1e-9, "path {path}, {names:?}");
                }
            }
        }
    }
    println!("postures in which the paths wrap: {wrapped:?}");
    assert!(wrapped[1] > 10 && wrapped[2] > 10 && wrapped[4] > 10 && wrapped[5] > 10, "{wrapped:?}");
}

#[test]
fn the_torque_of_springs_along_paths_is_their_tension_times_their_moment_arms() {
    let mut bench = Bench::new();
    let posture = inside(&mut random(), &bench.model);
    bench.update(&posture, 0);
    let force = STIFFNESS * (bench.geometry.lengths()[0] - 0.1);
    for (torque, arm) in bench.torque.torques().iter().zip(bench.geometry.moment_arms(0)) {
        assert!((torque - force * arm).abs() < 1e-12);
    }
}

#[test]
fn a_tendon_of_mujoco_is_refused_by_its_index() {
    let mut bench = Bench::new();
    let posture = inside(&mut random(), &bench.model);
    bench.update(&posture, 0);
    bench.paths.paths[2].tendon = Some(contrapposto::muscle::Tendon::default());
    let tensions = [Tension { force: 1.0, stiffness: 0.0 }; 6];
    let found = bench.torque.update(&bench.model, &bench.kinematics, &bench.paths, &bench.geometry, &tensions);
    assert_eq!(found, Err(PathTensionError::Tendon(2)));
    assert!(found.unwrap_err().to_string().contains("path 2 is a tendon of MuJoCo"));
}

#[test]
fn the_gradient_of_tensions_allocates_nothing() {
    let mut rng = random();
    let mut bench = Bench::new();
    let tensions = [Tension { force: 10.0, stiffness: 100.0 }; 6];
    for _ in 0..10 {
        let posture = inside(&mut rng, &bench.model);
        bench.update(&posture, 2);
        let Bench { model, paths, kinematics, geometry, torque } = &mut bench;
        let update = || torque.update(model, kinematics, paths, geometry, &tensions).unwrap();
        assert_eq!(allocation_counter::measure(update).count_total, 0);
    }
}

#[test]
fn the_passive_stiffness_of_fibres_is_the_slope_of_their_passive_force() {
    for rigid_tendon in [false, true] {
        let spec = MuscleSpec {
            name: "m".to_owned(),
            path: 0,
            max_isometric_force: 500.0,
            optimal_fiber_length: 0.1,
            tendon_slack_length: 0.2,
            pennation: 0.3,
            max_pennation: 1.4,
            least_activation: 0.01,
            rigid_tendon,
            law: FiberLaw::Thelen2003(Thelen2003::default()),
        };
        let muscle = Muscle::new(spec).unwrap();
        for step in 0..40 {
            let length = 0.26 + 0.003 * f64::from(step) + 1e-4;
            let force = |length: f64| muscle.at_rest(length, 0.01).passive_force;
            let h = 1e-6;
            let slope = (force(length + h) - force(length - h)) / (2.0 * h);
            let state = muscle.at_rest(length, 0.01);
            let off = (state.passive_stiffness - slope).abs();
            assert!(off < 1e-5 * (1.0 + slope.abs()), "{rigid_tendon}, {length}: {state:?}, {slope}");
        }
    }
}

#[test]
fn passive_tensions_of_two_muscles_on_one_path_add_up() {
    let spec = |name: &str, path| MuscleSpec {
        name: name.to_owned(),
        path,
        max_isometric_force: 500.0,
        optimal_fiber_length: 0.1,
        tendon_slack_length: 0.2,
        pennation: 0.0,
        max_pennation: 1.4,
        least_activation: 0.01,
        rigid_tendon: false,
        law: FiberLaw::Thelen2003(Thelen2003::default()),
    };
    let model = adult(&Adult::default()).unwrap();
    let muscles = [spec("a", 1), spec("b", 1), spec("c", 2)].map(|spec| Muscle::new(spec).unwrap()).to_vec();
    let muscles = Musculature { paths: arm(&model), muscles, ..Musculature::default() };
    let geometry = PathGeometry::new(&model, &muscles.paths);
    let state =
        |force: f64| FiberState { passive_force: force, passive_stiffness: 10.0 * force, ..FiberState::default() };
    let mut tensions = [Tension { force: 9.0, stiffness: 9.0 }; 6];
    passive_tensions(&muscles, &geometry, &[state(1.0), state(2.0), state(4.0)], &mut tensions);
    let expected = [0.0, 3.0, 4.0, 0.0, 0.0, 0.0].map(|force| Tension { force, stiffness: 10.0 * force });
    assert_eq!(tensions, expected);
}

#[test]
fn passive_torque_of_springs_in_use_is_minus_the_derivative_of_their_energy_about_coordinates_and_axes() {
    let mut rng = random();
    let model = adult(&Adult::default()).unwrap();
    let paths = arm(&model);
    let law = LigamentLaw::Spring { slack_length: 0.1, stiffness: 1000.0 };
    let ligaments = (0..6).map(|path| Ligament { name: format!("spring {path}"), path, law: law.clone() }).collect();
    let muscles = Musculature { paths: paths.clone(), ligaments, ..Musculature::default() };
    let rates: Vec<usize> = (0..model.rates().len()).collect();
    let muscles = JointMuscles::new(&model, muscles, &rates, &[]);
    let mut sprung = JointTorques::new(&model).with_muscles(Some(muscles));
    let mut bare = JointTorques::new(&model);
    let (mut kinematics, mut geometry) = (Kinematics::new(&model), PathGeometry::new(&model, &paths));
    let mut energy = |posture: &Posture| -> f64 {
        kinematics.update(&model, posture).unwrap();
        geometry.update(&model, &kinematics, &paths, PathRule::Geodesic);
        geometry.lengths().iter().map(|length| 500.0 * (length - 0.1f64).max(0.0).powi(2)).sum()
    };
    let (mut greatest, mut joints) = (0f64, 0);
    for _ in 0..20 {
        let posture = inside(&mut rng, &model);
        sprung.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
        bare.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
        let of = |with: &[f64], without: &[f64]| -> Vec<f64> {
            with.iter().zip(without).map(|(with, without)| with - without).collect()
        };
        let torques = of(sprung.passive_torque().torques(), bare.passive_torque().torques());
        let about_axes = of(sprung.passive_torque().about_axes(), bare.passive_torque().about_axes());
        let active = of(sprung.active_torque(), bare.active_torque());
        for (rate, torque) in torques.iter().enumerate() {
            let mut at = |step: f64| {
                let mut moved = posture.clone();
                moved.values_mut()[model.rates()[rate].coordinate.unwrap()] += step;
                energy(&moved)
            };
            let h = 1e-4;
            let (near, far) = ((at(h) - at(-h)) / (2.0 * h), (at(2.0 * h) - at(-2.0 * h)) / (4.0 * h));
            let slope = near + (near - far) / 3.0;
            assert!((torque + slope).abs() < 1e-6, "{}: {torque} for {}", model.rates()[rate].name, -slope);
            assert!((active[rate] + about_axes[rate]).abs() < 1e-9, "Eq. 1");
            greatest = greatest.max(torque.abs());
        }
        for (joint, orientation) in model.three_axis_joints().iter().zip(sprung.passive_torque().orientations()) {
            let rates = joint.coordinates.map(|i| model.coordinates()[i].rate.unwrap());
            let moment = V::from(rates.map(|rate| about_axes[rate]));
            let folded = orientation.hinges.tr_mul(&moment);
            assert!((folded - V::from(rates.map(|rate| torques[rate]))).norm() < 1e-9, "{}", joint.name);
            joints += usize::from(moment.norm() > 1.0);
        }
    }
    println!("greatest torque {greatest} N m; {joints} moments of three-axis joints above 1 N m");
    assert!(greatest > 10.0 && joints > 20);
}

/// The adult, the muscles' passive torque of whose right arm is a law near its posture, with the coordinates of these laws; springs and a bushing.
fn with_laws(bushing: f64) -> (Model, JointMuscles, Vec<usize>) {
    let model = adult(&Adult::default()).unwrap();
    let law = LigamentLaw::Spring { slack_length: 0.1, stiffness: 1000.0 };
    let ligaments = (1..6).map(|path| Ligament { name: format!("spring {path}"), path, law: law.clone() }).collect();
    let [upper, lower] = ["humerus_r", "ulna_r"].map(|name| segment(&model, name));
    let bushing = Bushing {
        name: "elbow".to_owned(),
        segments: [upper, lower],
        frames: [Placement::identity(); 2],
        rotational_stiffness: bushing * V::new(1.0, 2.0, 3.0),
        translational_stiffness: V::new(10.0, 20.0, 30.0),
        bands: vec![
            Band { axis: 0, torque: bushing, angle: 0.4, rate: 3.0 },
            Band { axis: 2, torque: bushing, angle: 0.1, rate: 2.0 },
        ],
    };
    let muscles = Musculature { paths: arm(&model), ligaments, bushings: vec![bushing], ..Musculature::default() };
    let names = ["arm_flex_r", "arm_add_r", "arm_rot_r", "elbow_flex_r", "pro_sup_r"];
    let coordinates = names.map(|name| model.coordinate(name).unwrap());
    assert!(model.three_axis_joint_of(coordinates[0]).is_some() && model.three_axis_joint_of(coordinates[3]).is_none());
    let rates = coordinates.map(|i| model.coordinates()[i].rate.unwrap());
    let ranges = coordinates.map(|i| (i, model.coordinates()[i].range));
    let muscles = JointMuscles::new(&model, muscles, &rates, &[]).with_laws(&model, &ranges).unwrap();
    (model, muscles, coordinates.to_vec())
}

/// Anywhere inside the ranges, those of angles about axes, too: beyond them laws no longer follow the angle.
fn inside_about_axes(rng: &mut Pcg64, model: &Model) -> Posture {
    loop {
        let posture = inside(rng, model);
        let all_inside = model.three_axis_joints().iter().all(|joint| {
            let angles = joint.orientation(posture.values()).angles.values;
            joint.coordinates.iter().zip(angles).all(|(i, angle)| {
                let (low, high) = model.coordinates()[*i].range;
                (low + 0.01..high - 0.01).contains(&angle)
            })
        });
        if all_inside {
            return posture;
        }
    }
}

/// Passive torque of the laws of `model` about axes, and of `muscles`, at the coordinates with laws.
fn by_law_and_by_muscles(
    model: &Model,
    muscles: &mut JointMuscles,
    coordinates: &[usize],
    posture: &Posture,
) -> [Vec<f64>; 2] {
    let mut body = JointTorques::new(model);
    body.update(model, posture, &[], Quantities::TORQUES).unwrap();
    muscles.update(model, posture, body.kinematics()).unwrap();
    let of = |torques: &[f64]| coordinates.iter().map(|i| torques[model.coordinates()[*i].rate.unwrap()]).collect();
    [of(body.passive_torque().about_axes()), of(muscles.passive_torques()[1])]
}

#[test]
fn laws_near_a_posture_have_the_torque_of_the_muscles_there_and_its_whole_gradient() {
    let mut rng = random();
    let (mut model, mut muscles, coordinates) = with_laws(1.0);
    let (mut greatest, mut off_torque, mut off_slope, mut greatest_slope) = (0f64, 0f64, 0f64, 0f64);
    for _ in 0..12 {
        let posture = inside_about_axes(&mut rng, &model);
        muscles.pose(&mut model, &posture).unwrap();
        let change = muscles.pose(&mut model, &posture).unwrap();
        assert!(change < 1e-9, "the second time nothing changes: {change}");
        let [law, exact] = by_law_and_by_muscles(&model, &mut muscles, &coordinates, &posture);
        for (law, exact) in law.iter().zip(&exact) {
            off_torque = off_torque.max((law - exact).abs());
            greatest = greatest.max(exact.abs());
        }
        // Any direction: the laws must follow every coordinate.
        for _ in 0..6 {
            let mut step = vec![0.0; model.rates().len()];
            step.iter_mut().for_each(|step| *step = rng.random_range(-1.0..1.0));
            let mut slopes = |h: f64| {
                let at = [h, -h].map(|h| {
                    let mut moved = posture.clone();
                    moved.displace(&model, &step.iter().map(|step| h * step).collect::<Vec<_>>());
                    by_law_and_by_muscles(&model, &mut muscles, &coordinates, &moved)
                });
                let along = |by: usize, i: usize| (at[0][by][i] - at[1][by][i]) / (2.0 * h);
                (0..coordinates.len()).map(|i| (along(0, i), along(1, i))).collect::<Vec<_>>()
            };
            for ((near_law, near), (far_law, far)) in slopes(1e-4).into_iter().zip(slopes(2e-4)) {
                let (of_law, of_muscles) = (near_law + (near_law - far_law) / 3.0, near + (near - far) / 3.0);
                off_slope = off_slope.max((of_law - of_muscles).abs());
                greatest_slope = greatest_slope.max(of_muscles.abs());
            }
        }
    }
    println!(
        "torque up to {greatest:.1} N m, off {off_torque:.1e}; slope up to {greatest_slope:.0} N m/rad, off {off_slope:.1e}"
    );
    assert!(greatest > 5.0 && off_torque < 1e-9, "{off_torque}");
    assert!(greatest_slope > 20.0 && off_slope < 1e-4, "{off_slope}");
}

#[test]
fn tables_of_laws_are_the_torques_of_the_muscles_along_the_joint() {
    // A bushing so stiff that the torque of all falls.
    let (mut model, mut muscles, coordinates) = with_laws(60.0);
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let (low, high) = model.coordinates()[elbow].range;
    let row = |k: i32| low + (high - low) * f64::from(k) / 24.0;
    // Neighbours at multiples of two degrees are held as they are.
    let mut posture = model.default_posture();
    let rotation = |i: &usize| model.coordinates()[*i].rate.is_some();
    (0..posture.values().len()).filter(rotation).for_each(|i| posture.values_mut()[i] = 0.0);
    posture.values_mut()[elbow] = row(9);
    muscles.pose(&mut model, &posture).unwrap();
    let rise = muscles.rises(&model, &posture).into_iter().find(|rise| rise.coordinate == elbow).unwrap();
    let mut body = JointTorques::new(&model);
    body.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
    let curve =
        body.passive_torque().curve_about_axis(&model, body.kinematics(), elbow, (low, high)).unwrap().into_owned();
    let place = coordinates.iter().position(|i| *i == elbow).unwrap();
    let mut compared = 0;
    for k in 0..25 {
        let mut moved = posture.clone();
        moved.values_mut()[elbow] = row(k);
        let exact = by_law_and_by_muscles(&model, &mut muscles, &coordinates, &moved)[1][place];
        // Rows after a rise are levelled.
        assert!(
            (curve.torque(row(k)) - exact).abs() < 1e-9 + rise.rise,
            "row {k}: {} for {exact}",
            curve.torque(row(k))
        );
        compared += usize::from((curve.torque(row(k)) - exact).abs() < 1e-9);
    }
    println!("{compared} of 25 rows are exact; levelled {rise:?}");
    assert!(compared >= 12 && rise.span > 1.0, "{compared} {rise:?}");
}

/// The laws near the posture before are not those of the next one: the change is told as a share of the weaker group's strength.
#[test]
fn a_posture_tells_by_how_much_the_torque_of_the_laws_changes() {
    let mut rng = random();
    let (mut model, mut muscles, coordinates) = with_laws(1.0);
    let first = inside_about_axes(&mut rng, &model);
    muscles.pose(&mut model, &first).unwrap();
    let mut greatest = 0f64;
    for _ in 0..12 {
        let posture = inside_about_axes(&mut rng, &model);
        let [before, exact] = by_law_and_by_muscles(&model, &mut muscles, &coordinates, &posture);
        let share = |(i, (before, exact)): (&usize, (f64, f64))| {
            let groups = model.coordinates()[*i].groups.as_ref().unwrap();
            let weaker = groups[0].strength.peak.min(groups[1].strength.peak);
            (before - exact).abs() / weaker.max(1.0)
        };
        let expected = coordinates.iter().zip(before.into_iter().zip(exact)).map(share).fold(0.0, f64::max);
        let change = muscles.pose(&mut model, &posture).unwrap();
        assert!((change - expected).abs() < 1e-9 * (1.0 + expected), "{change} for {expected}");
        greatest = greatest.max(expected);
    }
    println!("up to {greatest:.2} of the strength");
    assert!(greatest > 0.01, "{greatest}");
}
