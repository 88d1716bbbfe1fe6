//! Postures of least effort: balance, mirror images, determinism, history, and what happens where a body cannot stand.

use contrapposto::contact::{Balance, Condition, Missing, Support, root_rates};
use contrapposto::fatigue::FatigueLaw;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{
    Adult, CoordinateSpec, JointKind, Model, ModelBuilder, MuscleGroup, Placement, SegmentSpec, Sex, adult,
};
use contrapposto::posture::Posture;
use contrapposto::strength::Strength;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{self, CenterOfMass, Effort, Orientation, Point, Task};
use std::f64::consts::PI;
use std::sync::OnceLock;

use contrapposto::equilibria::{
    Aim, Equilibria, Mirror, SCATTERED_STARTS, Search, SearchError, equilibria, equilibria_watched,
};
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::statics::Load;
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

/// Weight and stature are of the order of what forces and moments are measured against.
const BALANCE: f64 = 1e-8;

fn woman() -> Model {
    adult(&Adult { sex: Sex::Female, stature: 1.65, mass: 60.0, ..Adult::default() }).unwrap()
}

const OPTIONS: Options = Options { max_step: 0.1, max_steps: 300, local_minima: 0, ..Options::least_effort() };

/// The scenario `stand-relaxed`, or its mirror image.
struct Standing {
    model: Model,
    start: Posture,
    supports: Vec<Support>,
    goals: Vec<PriorityLevel>,
    loads: Vec<Load>,
}

/// The shoulders rise with the arms, as in scenarios.
fn rhythm(model: &Model) -> PriorityLevel {
    let tasks = tasks::Height::shoulder_rhythm(model).into_iter().map(|(_, task)| Task::Height(task)).collect();
    PriorityLevel { tasks, ..PriorityLevel::default() }
}

impl Standing {
    /// `resting`: the leg that rests, `None` for neither. `hand`: where the hand of the other side must be.
    fn new(resting: Option<&str>, hand: Option<V>) -> Self {
        let model = woman();
        let start = model.default_posture();
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &start).unwrap();
        let support = |side: &str| {
            let segment = model.segment(&format!("calcn_{side}")).unwrap();
            let corners = model.segments()[segment].patch.clone();
            let share_max = if resting == Some(side) { 0.15 } else { 1.0 };
            Support {
                segment,
                corners,
                normal: V::y(),
                friction: 0.6,
                share_max,
                place: contrapposto::contact::Place::Fixed,
            }
        };
        // In the order of right and left in either case.
        let supports = vec![support("r"), support("l")];
        let upright = |name: &str| {
            let segment = model.segment(name).unwrap();
            let target = kinematics.placement(&model, segment).rotation;
            PriorityLevel::from(Task::Orientation(Orientation { segment, target }))
        };
        let mut goals = vec![];
        let side = if resting == Some("r") { -1.0 } else { 1.0 };
        if resting.is_some() {
            let goal =
                tasks::CenterOfMassGoal::At { target: V::new(0.03, 0.0, side * 0.055), axes: [true, false, true] };
            goals.push(Task::CenterOfMass(CenterOfMass { goal }).into());
        }
        goals.push(upright("head"));
        goals.push(upright("torso"));
        if let Some(target) = hand {
            let segment = model.segment(if side > 0.0 { "hand_r" } else { "hand_l" }).unwrap();
            let task = Point { segment, point: V::new(0.0, -0.05, 0.0), target, axes: [true; 3] };
            goals.insert(0, Task::Point(task).into());
        }
        goals.push(rhythm(&model));
        goals.push(Task::Effort(Effort::whole(&model)).into());
        Self { start, supports, goals, loads: vec![], model }
    }

    fn search(&self) -> Search<'_> {
        Search {
            model: &self.model,
            start: &self.start,
            supports: &self.supports,
            limits: &[],
            goals: &self.goals,
            loads: &self.loads,
            locked: &[],
            most_work: usize::MAX,
            scattered: SCATTERED_STARTS,
            aim: Aim::Ways,
            threads: 1,
        }
    }

    fn engine(&self, options: Options) -> Engine<'_> {
        let (supports, goals) = (self.supports.clone(), self.goals.clone());
        Engine::with_supports(&self.model, &self.start, supports, goals, &self.loads, options).unwrap()
    }
}

/// Largest residual of the root with the given contact forces, over body weight (and weight times stature).
fn imbalance(standing: &Standing, engine: &Engine<'_>, posture: &Posture) -> f64 {
    let model = &standing.model;
    let loads: Vec<Load> = standing.loads.iter().chain(engine.contact().loads()).copied().collect();
    let mut body = JointTorques::new(model);
    body.update(model, posture, &loads, Quantities::ALL).unwrap();
    let weight = model.mass() * 9.81;
    let residual = |&rate: &usize| {
        let size = if model.rates()[rate].rotational { weight * 1.65 } else { weight };
        body.active_torque()[rate].abs() / size
    };
    root_rates(model).iter().map(residual).fold(0.0, f64::max)
}

/// Found once for all tests.
fn resting_left() -> &'static Equilibria {
    static FOUND: OnceLock<Equilibria> = OnceLock::new();
    FOUND.get_or_init(|| equilibria(&Standing::new(Some("l"), None).search(), OPTIONS).unwrap())
}

/// Any number of threads gives the same numbers, counts and labels, where the budget ends the search, too.
#[test]
fn a_search_does_not_depend_on_the_number_of_threads() {
    let standing = Standing::new(Some("l"), Some(V::new(0.45, 1.1, 0.2)));
    for most_work in [600, 20_000, usize::MAX] {
        let find = |threads| equilibria(&Search { most_work, threads, ..standing.search() }, OPTIONS).unwrap();
        let one = find(1);
        println!("most work {most_work}: {} starts, work {}", one.starts, one.work);
        for threads in [0, 2, 5] {
            let found = find(threads);
            assert_eq!(format!("{found:?}"), format!("{one:?}"), "{threads} threads, most work {most_work}");
        }
    }
}

/// Besides, changes of the dual method count. The other steps of a solve count as their changes of the working set have it.
#[test]
fn a_step_of_a_descent_counts_as_two_units_of_work() {
    let standing = Standing::new(None, None);
    let mut engine = standing.engine(Options { local_minima: 1, ..OPTIONS });
    let (mut others, mut their_work) = (0, 0);
    let solved = engine.solve_watched(&standing.start, |step, _| {
        others += 1;
        their_work += step.work();
    });
    let steps = solved.unwrap().steps;
    println!("{steps} steps, {others} of them in no descent, work {}", engine.work());
    assert!(steps > others + 10);
    let least = their_work + 2 * (steps - others);
    assert!((least..=least + least / 10).contains(&engine.work()), "{least}");
}

/// A search that may do little work ends after the start in which its budget is spent, says so, and finds the same each time.
#[test]
fn a_search_with_little_work_ends_early_says_so_and_finds_the_same_again() {
    const MOST_WORK: usize = 600;
    let standing = Standing::new(Some("l"), None);
    let whole = resting_left();
    let find = || equilibria(&Search { most_work: MOST_WORK, ..standing.search() }, OPTIONS).unwrap();
    let found = find();
    println!("work {} of {}, starts {} of {}", found.work, whole.work, found.starts, whole.starts);
    assert!(found.cut && !whole.cut);
    assert!(found.starts < whole.starts && found.work < whole.work);
    // One start may go on when the budget ends, each of its steps at some 8 units.
    assert!(found.work < 2 * MOST_WORK + 8 * OPTIONS.max_steps, "{}", found.work);
    assert!(!found.postures.is_empty());
    assert_eq!(found, find());
}

#[test]
fn one_leg_rests_in_two_ways() {
    let standing = Standing::new(Some("l"), None);
    let found = resting_left();
    for posture in &found.postures {
        println!("effort {:.6}, from {:?}", posture.relaxed.effort, posture.starts);
    }
    assert_eq!(found.postures.len(), 2, "a slouch and a level posture");
    let [slouch, level] = [&found.postures[0], &found.postures[1]];
    let at = |name: &str| standing.model.coordinate(name).unwrap();
    let hip = at("hip_adduction_r");
    let degrees =
        |posture: &contrapposto::equilibria::RelaxedPosture, i: usize| posture.relaxed.posture.values()[i].to_degrees();
    // The hip that carries hangs on its ligaments, its side of the pelvis is the higher one, the other knee is bent.
    assert!(slouch.relaxed.effort < 0.7 * level.relaxed.effort);
    assert!(degrees(slouch, hip) > 15.0 && degrees(level, hip) < 8.0);
    assert!(degrees(slouch, at("pelvis_list")).abs() > 10.0 && degrees(level, at("pelvis_list")).abs() < 5.0);
    assert!(degrees(slouch, at("knee_angle_l")) > 25.0 && degrees(slouch, at("knee_angle_r")) < 5.0);
    let hangs = slouch.hanging.iter().find(|hanging| hanging.coordinate == hip).unwrap();
    assert!(hangs.share() > 0.9 && hangs.passive < -30.0, "{hangs:?}");
    assert!(level.hanging.iter().all(|hanging| hanging.coordinate != hip));
    for posture in &found.postures {
        assert_eq!(posture.relaxed.balance, Balance::Held);
        let total: f64 = posture.supports.iter().map(|support| support.share).sum();
        assert!((total - 1.0).abs() < 1e-8 && posture.supports[1].share <= 0.15 + 1e-8);
        assert!(
            posture.relaxed.slip.length() < 1e-5 && posture.relaxed.levels[..3].iter().all(|level| level.length < 1e-5)
        );
        let mut engine = standing.engine(OPTIONS);
        engine.evaluate(&posture.relaxed.posture).unwrap();
        let left = imbalance(&standing, &engine, &posture.relaxed.posture);
        assert!(left < BALANCE, "root out of balance by {left:.1e}");
        // Somebody on two feet must attend.
        assert!(posture.stability.unstable > 0);
        let sum: f64 = posture.work.iter().map(|work| work.relative_load().powi(2)).sum();
        assert!((sum - posture.relaxed.effort).abs() < 1e-9, "effort is the sum of squared loads");
    }
}

/// The same body with the other leg resting: the same list in the mirror.
#[test]
fn the_other_leg_gives_the_mirror_image() {
    let right = Standing::new(Some("r"), None);
    let mirror = Mirror::of(&right.model).unwrap();
    let a = resting_left();
    let b = equilibria(&right.search(), OPTIONS).unwrap();
    assert_eq!(a.postures.len(), b.postures.len());
    for (rank, (a, b)) in a.postures.iter().zip(&b.postures).enumerate() {
        let image = mirror.posture(&a.relaxed.posture);
        // Forearms weigh on no muscle however they are turned: of arms only joints whose muscles carry weight are compared.
        let body = |name: &str| {
            ["hip", "knee", "ankle", "subtalar", "lumbar", "thoracic", "neck", "pelvis"]
                .iter()
                .any(|part| name.starts_with(part))
        };
        let mut worst = (0.0, "", 0.0);
        for (i, coordinate) in right.model.coordinates().iter().enumerate() {
            let off = (image.values()[i] - b.relaxed.posture.values()[i]).abs();
            if body(&coordinate.name) && off > worst.0 {
                (worst.0, worst.1) = (off, &coordinate.name);
            }
        }
        for work in &a.work {
            let (partner, _) = mirror.coordinate(work.coordinate);
            let other = b.work.iter().find(|other| other.coordinate == partner).unwrap();
            worst.2 = (work.relative_load() - other.relative_load()).abs().max(worst.2);
        }
        let effort = (a.relaxed.effort - b.relaxed.effort).abs();
        println!(
            "mirror image: effort {:.9} differs by {effort:.1e}, `{}` by {:.1e} rad, loads by {:.1e}, {:?} {:?}",
            a.relaxed.effort, worst.1, worst.0, worst.2, a.relaxed.reason, b.relaxed.reason
        );
        if rank == 0 {
            assert!(effort < 1e-12, "{effort}");
            assert!(worst.2 < 1e-9);
        }
        // Of local minima so near that they count as one, the order of the starts decides which one is the answer.
        assert!(effort < 1e-3 * a.relaxed.effort, "{effort}");
        for (a, b) in a.supports.iter().zip(b.supports.iter().rev()) {
            assert!((a.share - b.share).abs() < 1e-6);
        }
    }
}

#[test]
fn with_free_loading_left_and_right_slouch_alike_and_symmetry_costs_more() {
    let standing = Standing::new(None, None);
    let found = equilibria(&standing.search(), Options { max_steps: 1000, ..OPTIONS }).unwrap();
    let efforts: Vec<f64> = found.postures.iter().map(|posture| posture.relaxed.effort).collect();
    println!("free loading: {efforts:?}");
    assert!(efforts.len() >= 3, "{efforts:?}");
    assert!((efforts[0] - efforts[1]).abs() < 1e-5 * efforts[0]);
    let mirror = Mirror::of(&standing.model).unwrap();
    let list = standing.model.coordinate("pelvis_list").unwrap();
    let lists: Vec<f64> =
        found.postures.iter().map(|posture| posture.relaxed.posture.values()[list].to_degrees()).collect();
    assert!(lists[0] * lists[1] < 0.0 && (lists[0] + lists[1]).abs() < 0.1, "{lists:?}");
    // The first posture that does not slouch is the symmetric one.
    let symmetric = lists.iter().position(|list| list.abs() < 2.0).unwrap();
    assert!((found.postures[symmetric].supports[0].share - 0.5).abs() < 0.1, "{lists:?}");
    assert!(efforts[symmetric] > 1.03 * efforts[0]);
    let (partner, sign) = mirror.coordinate(list);
    assert_eq!((partner, sign), (list, -1.0));
}

#[test]
fn the_same_search_twice_is_the_same_to_the_bit() {
    let standing = Standing::new(Some("l"), None);
    let options = Options { max_steps: 30, ..OPTIONS };
    let mut engine = standing.engine(options);
    let first = engine.solve(&standing.start).unwrap();
    // Something else in between: the engine remembers nothing of it.
    let mut other = standing.start.clone();
    for value in other.values_mut() {
        *value += 0.2;
    }
    for (value, coordinate) in other.values_mut().iter_mut().zip(standing.model.coordinates()) {
        *value = value.clamp(coordinate.range.0, coordinate.range.1);
    }
    let _ = engine.solve(&other);
    let again = engine.solve(&standing.start).unwrap();
    let difference = |a: &Posture, b: &Posture| {
        a.values().iter().zip(b.values()).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()))
    };
    println!("after another solve: {:.1e}", difference(&first.posture, &again.posture));
    assert_eq!(first, standing.engine(options).solve(&standing.start).unwrap());
    assert_eq!(first, again);
}

#[test]
fn a_hand_never_leaves_its_target_for_comfort() {
    let target = V::new(0.35, 1.05, 0.25);
    let standing = Standing::new(Some("l"), Some(target));
    let found = equilibria(&standing.search(), Options { max_steps: 60, ..OPTIONS }).unwrap();
    let hand = standing.model.segment("hand_r").unwrap();
    let mut kinematics = Kinematics::new(&standing.model);
    for posture in &found.postures {
        kinematics.update(&standing.model, &posture.relaxed.posture).unwrap();
        let off = (kinematics.station(&standing.model, hand, V::new(0.0, -0.05, 0.0)) - target).norm();
        println!("effort {:.5}, hand off by {off:.1e} m, slip {:?}", posture.relaxed.effort, posture.relaxed.slip);
        assert!(off < 1e-5);
        let mut engine = standing.engine(OPTIONS);
        engine.evaluate(&posture.relaxed.posture).unwrap();
        assert!(imbalance(&standing, &engine, &posture.relaxed.posture) < BALANCE);
    }
}

/// A pelvis that is locked too far ahead of the feet: nothing can bring the weight over them.
#[test]
fn a_body_that_cannot_stand_says_what_is_missing() {
    let mut standing = Standing::new(None, None);
    standing.goals = vec![rhythm(&standing.model), Task::Effort(Effort::whole(&standing.model)).into()];
    for support in &mut standing.supports {
        // Ice on a slope of 45 degrees.
        support.normal = V::new(1.0, 1.0, 0.0).normalize();
        support.friction = 0.0;
    }
    let Err(SearchError::CannotStand(missing)) = equilibria(&standing.search(), OPTIONS) else {
        panic!("no body stands on ice");
    };
    let weight = standing.model.mass() * 9.81;
    println!("on a slope of ice: {missing}");
    let Missing { force, moment, condition } = missing;
    assert_eq!(condition, Condition::Friction);
    // A normal force of w cos 45 leaves w sin 45 along the slope; the solver trades a little of it for moment.
    assert!(libm::hypot(force, moment) > 0.5 * weight && force < weight);
}

#[test]
fn a_body_with_one_leg_longer_has_no_mirror_image() {
    let model = woman();
    assert!(Mirror::of(&model).is_some());
    let mut lame = model.clone();
    let i = lame.coordinate("knee_angle_l").unwrap();
    lame = lame.with_passive_law(i, None);
    assert!(Mirror::of(&lame).is_none());
    assert!(Mirror::of(&adult(&Adult::right_arm()).unwrap()).is_none());
    // Twice mirrored is the posture itself; right and left change places.
    let mirror = Mirror::of(&model).unwrap();
    let mut posture = model.default_posture();
    for (i, value) in posture.values_mut().iter_mut().enumerate() {
        *value += 0.01 * i as f64;
    }
    let image = mirror.posture(&posture);
    assert_eq!(mirror.posture(&image), posture);
    let [right, left] = ["hand_r", "hand_l"].map(|name| model.segment(name).unwrap());
    assert_eq!(mirror.segment(right), left);
    let mut both = [Kinematics::new(&model), Kinematics::new(&model)];
    both[0].update(&model, &posture).unwrap();
    both[1].update(&model, &image).unwrap();
    let hand = both[0].placement(&model, right).translation.vector;
    assert!((mirror.vector(hand) - both[1].placement(&model, left).translation.vector).norm() < 1e-12);
}

/// On a fixed pelvis, the other arm locked straight ahead, which loads its muscles: joints that may not move are left out while local minima are sought, and the
/// answer is one that steps on the whole body have nothing to gain from, no worse than theirs.
#[test]
fn what_may_not_move_is_left_out_without_loss() {
    let model = woman();
    let mut start = model.default_posture();
    let arm = model.coordinate("arm_flex_l").unwrap();
    start.values_mut()[arm] = 1.2;
    let (hand, target) = (model.segment("hand_r").unwrap(), V::new(0.35, 1.05, 0.25));
    let point = Point { segment: hand, point: V::new(0.0, -0.05, 0.0), target, axes: [true; 3] };
    let mut kept = tasks::Posture::whole(&model, start.clone());
    let leg = |name: &str| name.starts_with("hip") || name.starts_with("knee");
    for (weight, rate) in kept.weights.iter_mut().zip(model.rates()) {
        *weight = f64::from(u8::from(leg(&rate.name) || rate.name.starts_with("arm_flex_l")));
    }
    let goals = [Task::Point(point), Task::Posture(kept), Task::Effort(Effort::whole(&model))].map(PriorityLevel::from);
    let solve = |local_minima: usize, from: &Posture| {
        let options = Options { local_minima, ..OPTIONS };
        let mut engine = Engine::with_supports(&model, &start, vec![], goals.to_vec(), &[], options).unwrap();
        root_rates(&model).into_iter().chain(model.coordinates()[arm].rate).for_each(|rate| engine.lock(rate));
        engine.solve(from).unwrap()
    };
    let found = solve(6, &start);
    let (again, steps) = (solve(0, &found.posture), solve(0, &start));
    println!("effort {:.9}, after more steps {:.9}, of steps alone {:.6}", found.effort, again.effort, steps.effort);
    assert!(found.levels[0].length < 1e-8 && found.levels[1].length < 1e-8, "{:?}", found.levels);
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let still = i == arm || coordinate.rate.is_some_and(|rate| root_rates(&model).contains(&rate));
        assert!(!still || found.posture.values()[i] == start.values()[i], "{}", coordinate.name);
    }
    assert!((found.effort - again.effort).abs() < 1e-6 * found.effort && found.effort < 1.0001 * steps.effort);
}

/// A free body that nothing holds is not brought to rest by turning it over, a stiff joint that counts as no effort or not:
/// the search for local minima changes nothing.
#[test]
fn a_free_root_without_supports_stays() {
    let standing = Standing::new(None, None);
    let arm = standing.model.coordinate("arm_flex_l").unwrap();
    let mut effort = Effort::whole(&standing.model);
    effort.coordinates.retain(|c| *c != arm);
    let solve = |local_minima: usize| {
        let options = Options { local_minima, max_steps: 0, ..OPTIONS };
        let goals = vec![Task::Effort(effort.clone()).into()];
        let mut engine = Engine::with_supports(&standing.model, &standing.start, vec![], goals, &[], options).unwrap();
        standing.model.coordinates()[arm].rate.into_iter().for_each(|rate| engine.lock(rate));
        engine.solve(&standing.start).unwrap().posture
    };
    assert_eq!(solve(4), solve(0));
}

/// A muscle group that holds 50 N m and never tires.
fn group(name: &str) -> MuscleGroup {
    MuscleGroup { name: name.to_owned(), strength: Strength::constant(50.0), fatigue: FatigueLaw::Tireless }
}

/// A link of 3 kg on a hinge at the ground, which turns by -180 to 360 deg, upright or hanging at 0, with a tip without mass fixed to its end.
fn link(up: f64) -> Model {
    let mut builder = ModelBuilder::new("link", V::new(0.0, -9.81, 0.0));
    let mut coordinate = CoordinateSpec::new("q", (-PI, 2.0 * PI));
    coordinate.groups = Some([group("one way"), group("the other way")]);
    let segment = |name: &str, mass: f64, kind: JointKind| SegmentSpec {
        name: name.into(),
        parent: None,
        mass,
        center_of_mass: V::new(0.0, 0.4 * up, 0.0),
        inertia: Matrix3::zeros(),
        joint: format!("joint of {name}"),
        kind,
        in_parent: Placement::identity(),
        in_segment: Placement::identity(),
        coordinates: vec![],
    };
    let hinged = SegmentSpec { coordinates: vec![coordinate], ..segment("link", 3.0, JointKind::Hinge(V::z_axis())) };
    builder.segment(hinged).unwrap();
    let end = Placement::translation(0.0, 0.8 * up, 0.0);
    let tip = SegmentSpec { parent: Some("link".into()), in_parent: end, ..segment("tip", 0.0, JointKind::Weld) };
    builder.segment(tip).unwrap();
    builder.build()
}

/// Neither needs any torque: a limb that hangs in the start is not held up, as an arm, and one that is up in the start may stay so, as a trunk.
#[test]
fn a_limb_that_hangs_in_the_start_hangs_in_every_answer_and_one_that_is_upright_may_stay() {
    for (up, stays_upright) in [(1.0, true), (-1.0, false)] {
        let model = link(up);
        let start = Posture::new(vec![1.0]);
        let search = Search {
            model: &model,
            start: &start,
            supports: &[],
            limits: &[],
            goals: &[],
            loads: &[],
            locked: &[],
            most_work: usize::MAX,
            scattered: SCATTERED_STARTS,
            aim: Aim::Ways,
            threads: 1,
        };
        let found = equilibria(&search, OPTIONS).unwrap();
        // 1 upright, -1 hanging.
        let places = found.postures.iter().map(|posture| up * libm::cos(posture.relaxed.posture.values()[0]));
        let places: Vec<f64> = places.collect();
        println!("starts at {up}: {places:?}");
        assert!(places.iter().all(|place| place.abs() > 0.999), "{places:?}");
        assert_eq!(places.iter().any(|place| *place > 0.0), stays_upright, "{places:?}");
    }
}

/// Two links about one axis, m long and hanging where both angles are 0; the first cannot turn by more than `most`, the second by more than 1.6.
fn two_links(most: f64) -> Model {
    let mut builder = ModelBuilder::new("two links", V::new(0.0, -9.81, 0.0));
    for (name, parent, most) in [("upper", None, most), ("lower", Some("upper"), 1.6)] {
        let mut coordinate = CoordinateSpec::new(&format!("q of {name}"), (-most, most));
        coordinate.groups = Some([group(&format!("{name} one way")), group(&format!("{name} the other way"))]);
        let segment = SegmentSpec {
            name: name.into(),
            parent: parent.map(str::to_owned),
            mass: 2.0,
            center_of_mass: V::new(0.0, -0.5, 0.0),
            inertia: Matrix3::zeros(),
            joint: format!("joint of {name}"),
            kind: JointKind::Hinge(V::z_axis()),
            in_parent: Placement::translation(0.0, if parent.is_some() { -1.0 } else { 0.0 }, 0.0),
            in_segment: Placement::identity(),
            coordinates: vec![coordinate],
        };
        builder.segment(segment).unwrap();
    }
    builder.build()
}

/// The upper link is asked for an angle beyond its range, and ends at the range; beside it the lower link takes the angle of least effort, found
/// by trying all of them, from a start near another local minimum, at the end of its range.
#[test]
fn least_effort_beside_a_target_out_of_reach_is_that_of_a_scan() {
    const MOST: f64 = 0.5;
    let model = two_links(MOST);
    let target = V::new(libm::sin(1.0), -libm::cos(1.0), 0.0);
    let task = Point { segment: model.segment("upper").unwrap(), point: -V::y(), target, axes: [true, true, false] };
    let goals = vec![Task::Point(task).into(), Task::Effort(Effort::whole(&model)).into()];
    let start = Posture::new(vec![MOST, 1.5]);
    let options = |local_minima| Options { max_step: 0.1, max_steps: 300, local_minima, ..Options::least_effort() };
    let solve = |local_minima| {
        let goals: Vec<PriorityLevel> = Clone::clone(&goals);
        let mut engine = Engine::with_supports(&model, &start, vec![], goals, &[], options(local_minima)).unwrap();
        engine.solve(&start).unwrap()
    };
    let mut body = JointTorques::new(&model);
    let mut effort = |lower: f64| {
        body.update(&model, &Posture::new(vec![MOST, lower]), &[], Quantities::ALL).unwrap();
        body.active_torque().iter().map(|torque| (torque / 50.0).powi(2)).sum::<f64>()
    };
    let least = (-1600..=1600).map(|k| effort(1e-3 * f64::from(k))).fold(f64::INFINITY, f64::min);
    let [steps, minimum] = [solve(0), solve(12)];
    println!("scan {least:.6}, by steps alone {:.6}, with descents {:.6}: {minimum:?}", steps.effort, minimum.effort);
    assert!((minimum.effort - least).abs() < 1e-5 * least, "{} {least}", minimum.effort);
    assert!(steps.effort > 1.1 * least && (minimum.posture.values()[0] - MOST).abs() < 1e-9);
}

/// Local minima of an earlier search stand in for starts that are scattered.
#[test]
fn a_search_that_is_told_earlier_minima_scatters_no_starts_and_finds_the_same() {
    let (model, start) = (link(-1.0), Posture::new(vec![1.0]));
    let found = |known: &[Posture]| {
        let search = Search {
            model: &model,
            start: &start,
            supports: &[],
            limits: &[],
            goals: &[],
            loads: &[],
            locked: &[],
            most_work: usize::MAX,
            scattered: 40,
            aim: Aim::Least(known),
            threads: 1,
        };
        let mut sought = 0;
        (equilibria_watched(&search, OPTIONS, &mut |count| sought = count).unwrap(), sought)
    };
    let (first, all) = found(&[]);
    let (again, fewer) = found(&first.minima);
    println!("{all} postures sought, then {fewer}");
    assert!(all > 40 && fewer < 20, "{all} {fewer}");
    assert!((again.postures[0].relaxed.effort - first.postures[0].relaxed.effort).abs() < 1e-9);
}
