//! Tests marker tracking: recovery of known postures, optimality by differences of an objective computed here, limits against a grid.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, CoordinateKind, CoordinateSpec, JointKind, Model, ModelBuilder, SegmentSpec, adult};
use contrapposto::posture::Posture;
use contrapposto::tracking::{CoordinateGoal, Goals, GoalsError, MarkerGoal, Tracker, first_posture, track};
use nalgebra::{Isometry3, Matrix3, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;

type V = Vector3<f64>;
type Places = Vec<Option<V>>;

fn random() -> Pcg64 {
    Pcg64::new(20_070_902, 23)
}

/// Three markers a segment, which fix its place.
fn markers(model: &Model, rng: &mut Pcg64) -> Vec<MarkerGoal> {
    let mut marker = |segment| {
        let point = V::from_fn(|_, _| rng.random_range(-0.15..0.15));
        MarkerGoal { segment, point, weight: rng.random_range(0.5..10.0) }
    };
    (0..3 * model.segments().len()).map(|index| marker(index / 3)).collect()
}

fn places(model: &Model, goals: &Goals, posture: &Posture) -> Places {
    let mut body = Kinematics::new(model);
    body.update(model, posture).unwrap();
    goals.markers.iter().map(|m| Some(body.station(model, m.segment, m.point))).collect()
}

/// Within the ranges, and the root within 0.5 of its default.
fn inside(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 0.5), c.range.1.min(c.default + 0.5));
        low + rng.random_range(0.1..0.9) * (high - low)
    });
    let mut posture = Posture::new(values.collect());
    posture.displace(model, &vec![0.0; model.rates().len()]);
    posture
}

/// The objective of the documentation, by its words.
fn objective(model: &Model, goals: &Goals, posture: &Posture, observed: &Places) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for ((marker, place), at) in goals.markers.iter().zip(places(model, goals, posture)).zip(observed) {
        if let (Some(place), Some(at)) = (place, at) {
            sum += marker.weight * (place - at).norm_squared();
            weights += marker.weight;
        }
    }
    let wanted = goals.coordinates.iter().map(|g| g.weight * (posture.values()[g.coordinate] - g.value).powi(2));
    0.5 * (sum / weights + wanted.sum::<f64>())
}

#[test]
fn postures_of_the_adult_come_back_from_their_markers() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let wanted: Vec<Posture> = (0..20).map(|_| inside(&mut rng, &model)).collect();
    let frames: Vec<Places> = wanted.iter().map(|posture| places(&model, &goals, posture)).collect();
    let start = model.default_posture();
    let tracked = track(&model, goals, &start, frames.iter().map(Vec::as_slice)).unwrap();
    for (frame, wanted) in tracked.iter().zip(&wanted) {
        assert!(frame.solved.converged, "{:?}", frame.solved);
        assert!(frame.root_mean_square() < 1e-9, "{}", frame.root_mean_square());
        for (found, wanted) in frame.posture.values().iter().zip(wanted.values()) {
            assert!((found - wanted).abs() < 1e-7, "{found} against {wanted}");
        }
    }
}

#[test]
fn postures_that_no_marker_fits_are_optimal_by_central_differences() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let mut goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let knee = model.coordinate("knee_angle_r").unwrap();
    let elbow = model.coordinate("elbow_flex_l").unwrap();
    goals.coordinates.push(CoordinateGoal { coordinate: elbow, value: 0.3, weight: 0.5 });
    goals.fixed.push(model.coordinate("lumbar_extension").unwrap());
    for (index, coordinate) in model.coordinates().iter().enumerate().skip(6) {
        goals.limits.push((index, (coordinate.default - 0.2, coordinate.default + 0.2)));
    }
    let limits: Vec<Option<(f64, f64)>> =
        (0..model.coordinates().len()).map(|c| goals.limits.iter().find(|l| l.0 == c).map(|l| l.1)).collect();
    let mut tracker = Tracker::new(&model, goals.clone()).unwrap();
    let (mut held, mut gaps, mut posture) = (0, 0, model.default_posture());
    for frame in 0..30 {
        let truth = inside(&mut rng, &model);
        let mut observed = places(&model, &goals, &truth);
        for place in &mut observed {
            *place = place.map(|place| place + V::from_fn(|_, _| rng.random_range(-0.03..0.03)));
            if rng.random_range(0..10) == 0 {
                (*place, gaps) = (None, gaps + 1);
            }
        }
        let solved = tracker.solve(&model, &mut posture, &observed).unwrap();
        assert!(solved.converged, "frame {frame}: {solved:?}");
        let value = objective(&model, &goals, &posture, &observed);
        assert!((value - solved.objective).abs() < 1e-12 * value.max(1.0));
        for (rate, of) in model.rates().iter().enumerate() {
            let c = of.coordinate.unwrap();
            if goals.fixed.contains(&c) {
                assert_eq!(posture.values()[c], model.coordinates()[c].default);
                continue;
            }
            let moved = |by: f64| {
                let mut step = vec![0.0; model.rates().len()];
                step[rate] = by;
                let mut posture = posture.clone();
                posture.displace(&model, &step);
                objective(&model, &goals, &posture, &observed)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            let (low, high) = limits[c].unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            let at = posture.values()[c];
            assert!((low..=high).contains(&at), "{} is {at}", of.name);
            let wrong = match () {
                () if at == low => -slope,
                () if at == high => slope,
                () => slope.abs(),
            };
            held += usize::from(at == low || at == high);
            assert!(wrong < 2e-9, "frame {frame}, {}: {slope:e} at {at}", of.name);
        }
    }
    assert!(held > 30 && gaps > 30, "{held} limits, {gaps} gaps");
    assert!(posture.values()[knee].is_finite());
}

/// Two hinges in a plane with a marker at the end.
fn two_links() -> Model {
    let mut builder = ModelBuilder::new("links", V::zeros());
    for (index, name) in ["upper", "lower"].into_iter().enumerate() {
        let spec = SegmentSpec {
            name: name.to_owned(),
            parent: (index == 1).then(|| "upper".to_owned()),
            mass: 1.0,
            center_of_mass: V::zeros(),
            inertia: Matrix3::identity(),
            joint: format!("j{name}"),
            kind: JointKind::Hinge(V::z_axis()),
            in_parent: Isometry3::translation(0.4 * index as f64, 0.0, 0.0),
            in_segment: Isometry3::identity(),
            coordinates: vec![CoordinateSpec::new(&format!("q{name}"), (-3.0, 3.0))],
        };
        builder.segment(spec).unwrap();
    }
    builder.build()
}

#[test]
fn answers_within_limits_are_the_least_of_a_grid() {
    let model = two_links();
    let mut rng = random();
    let mut at_limits = 0;
    for round in 0..100 {
        let goals = Goals {
            markers: [(0, 0.3), (1, 0.35)]
                .map(|(segment, x)| MarkerGoal { segment, point: V::x() * x, weight: 1.0 })
                .to_vec(),
            limits: vec![(0, (-0.5, 0.6)), (1, (0.0, 1.2))],
            ..Goals::default()
        };
        let observed: Places =
            (0..2).map(|_| Some(V::from_fn(|i, _| [0.5, 0.2, 0.0][i] + rng.random_range(-0.2..0.2)))).collect();
        let mut tracker = Tracker::new(&model, goals.clone()).unwrap();
        let starts = (0..16).map(|i| Posture::new(vec![-0.5 + 0.36 * f64::from(i % 4), 0.4 * f64::from(i / 4)]));
        let answers = starts.map(|start| first_posture(&mut tracker, &model, &start, &observed).unwrap());
        let (posture, solved) = answers.min_by(|a, b| a.1.objective.total_cmp(&b.1.objective)).unwrap();
        let mut least = f64::INFINITY;
        for i in 0..=200 {
            for j in 0..=200 {
                let q = Posture::new(vec![-0.5 + 1.1 * f64::from(i) / 200.0, 1.2 * f64::from(j) / 200.0]);
                least = least.min(objective(&model, &goals, &q, &observed));
            }
        }
        assert!(solved.objective <= least + 1e-12, "round {round}: {} above {least}", solved.objective);
        let on = |value: f64, (low, high): (f64, f64)| value == low || value == high;
        at_limits += usize::from(on(posture.values()[0], (-0.5, 0.6)) || on(posture.values()[1], (0.0, 1.2)));
    }
    assert!(at_limits > 20, "{at_limits}");
}

/// Turned by most of a turn, walkers come back.
#[test]
fn bodies_that_face_another_way_are_found() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let rotation = model.coordinate("pelvis_rotation").unwrap();
    for turn in [1.5, 2.5, 3.1, -2.0, -3.0] {
        let mut posture = inside(&mut rng, &model);
        posture.values_mut()[rotation] = turn;
        let observed = places(&model, &goals, &posture);
        let answer = track(&model, goals.clone(), &model.default_posture(), [observed.as_slice()]).unwrap();
        assert!(answer[0].root_mean_square() < 1e-9, "{turn}: {}", answer[0].root_mean_square());
    }
}

/// Two markers say little of the way that a body faces; the first frame with more of them decides, also after a pause.
#[test]
fn a_body_that_enters_turned_away_is_found() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let rotation = model.coordinate("pelvis_rotation").unwrap();
    let mut posture = inside(&mut rng, &model);
    posture.values_mut()[rotation] = 3.0;
    let whole = places(&model, &goals, &posture);
    posture.values_mut()[rotation] = 0.1;
    let back = places(&model, &goals, &posture);
    let few = |all: &Places| -> Places { all.iter().enumerate().map(|(i, place)| place.filter(|_| i < 2)).collect() };
    let (few, nothing) = (few(&whole), vec![None; goals.markers.len()]);
    let frames: [&[_]; 5] = [&few, &whole, &nothing, &nothing, &back];
    let answers = track(&model, goals.clone(), &model.default_posture(), frames).unwrap();
    for (frame, answer) in answers.iter().enumerate() {
        let error = answer.root_mean_square();
        assert!(answer.solved.converged && error < 1e-8, "frame {frame}: {error} m, {:?}", answer.solved);
    }
}

/// A marker on the axis of a joint tells nothing of it: its change there is rounding, which is no direction that is left to go.
#[test]
fn a_marker_at_the_centre_of_a_joint_leaves_the_joint_solved() {
    let model = two_links();
    let marker = |segment, point| MarkerGoal { segment, point, weight: 1.0 };
    // In the frame of the lower link the joint is at (1e-17, 0, 0) by rounding.
    let goals = Goals { markers: vec![marker(0, V::x() * 0.3), marker(1, V::x() * 1e-17)], ..Goals::default() };
    let observed: Places = vec![Some(V::new(0.2, 0.3, 0.05)), Some(V::new(0.3, 0.35, -0.02))];
    let answer = track(&model, goals, &model.default_posture(), [observed.as_slice()]).unwrap();
    assert!(answer[0].solved.converged && answer[0].root_mean_square() > 0.02, "{:?}", answer[0].solved);
}

/// Markers whose errors are reported only move nothing, and wanted values move no body that is not seen.
#[test]
fn markers_without_a_weight_move_nothing() {
    let model = two_links();
    let marker = MarkerGoal { segment: 1, point: V::x(), weight: 0.0 };
    let wanted = CoordinateGoal { coordinate: 0, value: 1.0, weight: 1.0 };
    let goals = Goals { markers: vec![marker], coordinates: vec![wanted], ..Goals::default() };
    let observed: Places = vec![Some(V::new(0.5, 0.5, 0.0))];
    let answer = track(&model, goals, &model.default_posture(), [observed.as_slice()]).unwrap();
    assert_eq!((&answer[0].posture, answer[0].seen), (&model.default_posture(), 1));
}

#[test]
fn a_frame_without_markers_keeps_the_posture_and_all_is_deterministic() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let posture = inside(&mut rng, &model);
    let observed = places(&model, &goals, &posture);
    let nothing = vec![None; goals.markers.len()];
    let frames = [nothing.as_slice(), &observed, &nothing, &observed];
    let run = || track(&model, goals.clone(), &model.default_posture(), frames).unwrap();
    let answers = run();
    assert_eq!(answers, run());
    assert_eq!(answers[0].posture, model.default_posture());
    assert_eq!(answers[1].posture, answers[2].posture);
    assert_eq!((answers[2].seen, answers[2].largest), (0, None));
}

#[test]
fn a_body_that_is_held_altogether_stays() {
    let model = two_links();
    let marker = MarkerGoal { segment: 1, point: V::x(), weight: 1.0 };
    let goals = Goals { markers: vec![marker], fixed: vec![0, 1], ..Goals::default() };
    let observed: Places = vec![Some(V::new(1.4, 0.3, 0.0))];
    let answer = track(&model, goals, &model.default_posture(), [observed.as_slice()]).unwrap();
    assert_eq!(answer[0].posture, model.default_posture());
    assert!(answer[0].solved.converged && (answer[0].root_mean_square() - 0.3).abs() < 1e-12);
}

#[test]
fn goals_without_meaning_are_refused_by_name() {
    let model = two_links();
    let refused = |goals: Goals| Tracker::new(&model, goals).unwrap_err();
    let marker = |segment, weight| MarkerGoal { segment, point: V::zeros(), weight };
    let with = |marker| Goals { markers: vec![marker], ..Goals::default() };
    assert!(matches!(refused(with(marker(2, 1.0))), GoalsError::Index { what: "segment", index: 2, count: 2 }));
    assert!(refused(with(marker(0, -1.0))).to_string().contains("weight of a marker is -1"));
    assert!(refused(with(marker(0, f64::NAN))).to_string().contains("weight of a marker is NaN"));
    let limits = Goals { limits: vec![(0, (1.0, 0.0))], ..Goals::default() };
    assert!(refused(limits).to_string().contains("lower limit of a coordinate is 1"));
    assert!(matches!(
        refused(Goals { fixed: vec![9], ..Goals::default() }),
        GoalsError::Index { what: "coordinate", .. }
    ));
}

/// A root that turns freely (a quaternion) is found however it is turned, with the default posture as the start.
#[test]
fn a_free_root_that_is_turned_far_is_found() {
    let mut builder = ModelBuilder::new("kite", V::zeros());
    let spec = |name: &str, parent: Option<&str>, kind: JointKind, coordinates: Vec<CoordinateSpec>| SegmentSpec {
        name: name.to_owned(),
        parent: parent.map(str::to_owned),
        mass: 1.0,
        center_of_mass: V::zeros(),
        inertia: Matrix3::identity(),
        joint: format!("j{name}"),
        kind,
        in_parent: Isometry3::translation(0.0, if parent.is_some() { 0.3 } else { 0.0 }, 0.0),
        in_segment: Isometry3::identity(),
        coordinates,
    };
    let slides = ["x", "y", "z"].map(|name| CoordinateSpec::new(name, (-5.0, 5.0))).to_vec();
    builder.segment(spec("root", None, JointKind::Free, slides)).unwrap();
    let hinge = vec![CoordinateSpec::new("bend", (-1.0, 1.0))];
    builder.segment(spec("tail", Some("root"), JointKind::Hinge(V::x_axis()), hinge)).unwrap();
    let model = builder.build();
    let mut rng = random();
    let goals = Goals { markers: markers(&model, &mut rng), ..Goals::default() };
    let ball = model.coordinates().iter().position(|c| c.kind == CoordinateKind::Quaternion).unwrap();
    let mut turned = 0;
    for _ in 0..60 {
        let mut posture = model.default_posture();
        let q = nalgebra::UnitQuaternion::from_scaled_axis(V::from_fn(|_, _| rng.random_range(-2.5..2.5)));
        posture.values_mut()[ball..ball + 4].copy_from_slice(&[q.w, q.i, q.j, q.k]);
        posture.values_mut()[model.coordinate("bend").unwrap()] = rng.random_range(-0.9..0.9);
        turned += usize::from(q.angle() > 2.0);
        let observed = places(&model, &goals, &posture);
        let answer = track(&model, goals.clone(), &model.default_posture(), [observed.as_slice()]).unwrap();
        assert!(answer[0].root_mean_square() < 1e-8, "{}: {}", q.angle(), answer[0].root_mean_square());
    }
    assert!(turned > 15, "{turned}");
    // Half a turn of markers on the axes is where nothing pulls: no descent leaves it, only turned starts do.
    let on_axes = (0..6).map(|i| MarkerGoal {
        segment: 0,
        point: V::from_fn(|axis, _| if axis == i / 2 { [0.1, -0.1][i % 2] * (1.0 + axis as f64) } else { 0.0 }),
        weight: 1.0,
    });
    let goals = Goals { markers: on_axes.collect(), ..Goals::default() };
    for axis in [V::x_axis(), V::y_axis(), V::z_axis()] {
        let mut posture = model.default_posture();
        let q = nalgebra::UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI);
        posture.values_mut()[ball..ball + 4].copy_from_slice(&[q.w, q.i, q.j, q.k]);
        let observed = places(&model, &goals, &posture);
        let answer = track(&model, goals.clone(), &model.default_posture(), [observed.as_slice()]).unwrap();
        assert!(answer[0].root_mean_square() < 1e-8, "{axis:?}: {}", answer[0].root_mean_square());
    }
}

/// A coordinate whose task has a great weight is where its task wants it, and all others are as well solved as with the coordinate held there.
#[test]
fn a_task_of_great_weight_leaves_the_others_solved() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let markers = markers(&model, &mut rng);
    let knee = model.coordinate("knee_angle_r").unwrap();
    let posture = inside(&mut rng, &model);
    let mut held = posture.clone();
    held.values_mut()[knee] = 0.3;
    let plain = Goals { markers, ..Goals::default() };
    let observed = places(&model, &plain, &posture);
    let of = |goals: Goals, start: &Posture| track(&model, goals, start, [observed.as_slice()]).unwrap().remove(0);
    let mut start = model.default_posture();
    start.values_mut()[knee] = 0.3;
    let wanted = of(Goals { fixed: vec![knee], ..plain.clone() }, &start);
    for weight in [1e3, 1e6, 1e9, 1e12] {
        let task = CoordinateGoal { coordinate: knee, value: 0.3, weight };
        let found = of(Goals { coordinates: vec![task], ..plain.clone() }, &model.default_posture());
        assert!(found.solved.converged, "{weight:e}: {:?}", found.solved);
        assert!((found.posture.values()[knee] - 0.3).abs() < 1.0 / weight, "{weight:e}");
        let apart = found.posture.values().iter().zip(wanted.posture.values()).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1.0 / weight + 1e-6, "{weight:e}: {apart}");
    }
}
