//! Tests muscles that tire while they share torques: against the law of a joint, a second derivation in small steps, and conditions of
//! optimality.

use contrapposto::fatigue::{Compartments, FatigueLaw, FatigueState, ThreeCompartment};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::muscle::{
    FiberLaw, Location, Muscle, MuscleFatigue, MuscleSpec, Musculature, Path, PathGeometry, PathPoint, PathRule, Paths,
    SharedTorques, Sharing, Thelen2003, hold,
};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

/// Straight muscles from a segment to another one, by places in their frames, m.
type Line<'a> = (&'a str, Vector3<f64>, &'a str, Vector3<f64>);

fn musculature(model: &Model, lines: &[Line<'_>]) -> Musculature {
    let point = |name: &str, place| PathPoint { segment: model.segment(name), location: Location::Fixed(place) };
    let path = |(from, start, to, end): &Line<'_>| Path {
        points: vec![point(from, *start), point(to, *end)],
        ..Path::default()
    };
    let muscle = |path| {
        let spec = MuscleSpec {
            name: format!("m{path}"),
            path,
            max_isometric_force: 1000.0,
            optimal_fiber_length: 0.1,
            tendon_slack_length: 0.15,
            pennation: 0.0,
            max_pennation: 1.4,
            least_activation: 0.01,
            rigid_tendon: false,
            law: FiberLaw::Thelen2003(Thelen2003::default()),
        };
        Muscle::new(spec).unwrap()
    };
    Musculature {
        paths: Paths { paths: lines.iter().map(path).collect(), ..Paths::default() },
        muscles: (0..lines.len()).map(muscle).collect(),
        ..Musculature::default()
    }
}

/// Muscles of the right elbow at 20 degrees with given moments (N m) at full activation, and their forces.
struct Elbow {
    muscles: Musculature,
    geometry: PathGeometry,
    rate: usize,
    forces: Vec<f64>,
}

fn elbow(moments: &[f64]) -> Elbow {
    let model = adult(&Adult::default()).unwrap();
    let lower = model.segment("ulna_r").unwrap();
    let end = model.segments()[lower].in_parent.translation.vector;
    let lines: Vec<Line<'_>> = (0..moments.len())
        .map(|i| {
            let x = 0.03 - 0.005 * i as f64;
            ("humerus_r", Vector3::new(x, end.y + 0.2, 0.0), "ulna_r", Vector3::new(x, -0.1, 0.0))
        })
        .collect();
    let muscles = musculature(&model, &lines);
    let coordinate = model.coordinate("elbow_flex_r").unwrap();
    let rate = model.coordinates()[coordinate].rate.unwrap();
    let mut posture = model.default_posture();
    posture.values_mut()[coordinate] = 20f64.to_radians();
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let mut geometry = PathGeometry::new(&model, &muscles.paths);
    geometry.update(&model, &kinematics, &muscles.paths, PathRule::Geodesic);
    let forces = moments.iter().enumerate().map(|(i, moment)| moment / geometry.moment_arms(i)[rate]).collect();
    Elbow { muscles, geometry, rate, forces }
}

impl Elbow {
    fn asked<'a>(&'a self, torque: &'a [f64; 1]) -> SharedTorques<'a> {
        let Self { muscles, geometry, rate, forces } = self;
        SharedTorques { muscles, geometry, rates: std::slice::from_ref(rate), torques: torque, forces }
    }
}

fn law(fatigue_rate: f64, recovery_rate: f64) -> ThreeCompartment {
    ThreeCompartment { name: "test".to_owned(), fatigue_rate, recovery_rate, rest_multiplier: 15.0 }
}

/// A muscle alone at a joint tires as the joint's group does: compartments and fatigue at every time to 1e-9, and the instant of failure.
#[test]
fn one_muscle_on_one_joint_tires_as_the_joint() {
    let elbow = elbow(&[40.0]);
    for (fatigue, recovery, load) in [(0.015, 0.00149, 0.35), (0.00912, 0.00094, 0.8), (0.0182, 0.00168, 0.2)] {
        let (law, torque) = (law(fatigue, recovery), [40.0 * load]);
        let joint = FatigueLaw::ThreeCompartment(law.clone());
        let asked = elbow.asked(&torque);
        let rested = asked.strengths(&[1.0]);
        let of_joint = |seconds: f64| joint.advance(joint.start(0.0, load), load, seconds);
        let (mut samples, mut worst) = (0, 0f64);
        let mut muscles = MuscleFatigue::rested(vec![law.clone()]);
        let end = hold(&mut muscles, &asked, 86_400.0, |time, muscles| {
            let FatigueState::Compartments(expected) = of_joint(time) else { unreachable!() };
            let found = muscles.states()[0];
            worst = worst.max((found.fatigued - expected.fatigued).abs()).max((found.active - expected.active).abs());
            assert!((muscles.loads()[0] - load).abs() < 1e-12, "{:?}", muscles.loads());
            // Fatigue of a group by its strength: (S0 - S) / (S0 - T).
            let tired = asked.strengths(&[1.0 - found.fatigued]);
            let [flexors, extensors] = asked.group_fatigue(&rested, &tired)[0];
            worst = worst.max((flexors - of_joint(time).level(load)).abs());
            assert!(extensors == 0.0, "there are none: {extensors}");
            samples += 1;
        })
        .unwrap();
        assert!(end.failed && samples > 10 && worst < 1e-9, "{end:?}, {samples} samples, {worst}");
        let (mut low, mut high) = (0.0, 1e4);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if of_joint(middle).level(load) < 1.0 { low = middle } else { high = middle }
        }
        assert!((end.seconds - low).abs() < 1e-6, "{} s, the joint {low} s", end.seconds);
        // The closed form has no controller; with it a steady load is carried by `L / (L + F)` of the target.
        let carried = ThreeCompartment { fatigue_rate: fatigue * 10.0 / (10.0 + fatigue), ..law };
        let formula = FatigueLaw::ThreeCompartment(carried).endurance_time(load);
        assert!((end.seconds / formula - 1.0).abs() < 1e-4, "{} s, by the formula {formula} s", end.seconds);
        assert!((end.limit.times - 1.0).abs() < 1e-8 && (end.limit.of_torques[0] - 1.0).abs() < 1e-12, "{end:?}");
        assert!((end.limit.of_muscles[0] - end.limit.times).abs() < 1e-12, "{end:?}");
    }
}

/// One Euler step of 3CC-r, written anew.
fn euler(state: &mut [f64; 2], law: &ThreeCompartment, load: f64, h: f64) {
    let [active, fatigued] = *state;
    let resting = 1.0 - active - fatigued;
    let drive = if active < load { 10.0 * (load - active).min(resting) } else { 10.0 * (load - active) };
    let recovery = if load <= 0.01 { law.rest_multiplier * law.recovery_rate } else { law.recovery_rate };
    state[0] += h * (drive - law.fatigue_rate * active);
    state[1] += h * (law.fatigue_rate * active - recovery * fatigued);
}

/// Least sum of squares of two activations with given moments, in closed form; `None` where the capacities do not suffice.
fn two(moments: [f64; 2], torque: f64, capacities: [f64; 2]) -> Option<[f64; 2]> {
    let [a, b] = moments;
    let free = torque / (a * a + b * b);
    let shares = [a * free, b * free];
    let with_first = |first: f64| [first, (torque - a * first) / b];
    let with_second = |second: f64| [(torque - b * second) / a, second];
    let found = if shares[0] > capacities[0] {
        with_first(capacities[0])
    } else if shares[1] > capacities[1] {
        with_second(capacities[1])
    } else {
        shares
    };
    (found[0] <= capacities[0] * (1.0 + 1e-12) && found[1] <= capacities[1] * (1.0 + 1e-12)).then_some(found)
}

/// Two muscles share a joint: the stronger one is exhausted first and the other takes over, until both are. Against steps of 1 ms.
#[test]
fn two_muscles_on_one_joint_agree_with_small_steps() {
    for (moments, rates, torque) in
        [([40.0, 25.0], [0.02, 0.009], 24.0), ([30.0, 30.0], [0.006, 0.018], 20.0), ([50.0, 10.0], [0.01, 0.01], 30.0)]
    {
        let laws = rates.map(|rate| law(rate, 0.1 * rate));
        let (mut states, mut time, h) = ([[0.0; 2]; 2], 0.0, 1e-3);
        let first = two(moments, torque, [1.0, 1.0]).unwrap();
        states.iter_mut().zip(first).for_each(|(state, load)| state[0] = load);
        let (mut course, mut exhausted) = (vec![], [f64::INFINITY; 2]);
        while let Some(loads) = two(moments, torque, states.map(|state| 1.0 - state[1])) {
            for m in 0..2 {
                if loads[m] >= (1.0 - states[m][1]) * (1.0 - 1e-9) && exhausted[m].is_infinite() {
                    exhausted[m] = time;
                }
                euler(&mut states[m], &laws[m], loads[m], h);
            }
            course.push((loads, states));
            time += h;
        }
        let elbow = elbow(&moments);
        let torques = [torque];
        let asked = elbow.asked(&torques);
        let mut found_exhausted = [f64::INFINITY; 2];
        let mut muscles = MuscleFatigue::rested(laws.to_vec());
        let mut worst = 0f64;
        let end = hold(&mut muscles, &asked, 86_400.0, |now, muscles| {
            for (m, exhausted) in found_exhausted.iter_mut().enumerate() {
                if muscles.is_exhausted(m) && exhausted.is_infinite() {
                    *exhausted = now;
                }
            }
            let at = ((now / h).round() as usize).min(course.len()).saturating_sub(1);
            for m in 0..2 {
                worst = worst.max((muscles.states()[m].fatigued - course[at].1[m][1]).abs());
                worst = worst.max((muscles.loads()[m] - course[at].0[m]).abs());
            }
        })
        .unwrap();
        assert!(end.failed && (end.seconds - time).abs() < 2e-3 * time, "{} s, small steps {time} s", end.seconds);
        println!("{moments:?}: within {worst:.1e} of small steps");
        assert!(worst < 2.5e-4, "{worst}");
        let first = usize::from(exhausted[1] < exhausted[0]);
        let (theirs, ours) = (exhausted[first], found_exhausted[first]);
        assert!(theirs < 0.9 * time, "the second muscle takes over: {exhausted:?} of {time} s");
        assert!((ours - theirs).abs() < 0.2 + 1e-3 * theirs, "exhausted at {ours} s, small steps {theirs} s");
        assert!((end.limit.times - 1.0).abs() < 1e-6, "{end:?}");
        // Both limit the torque, each by what it still gives.
        for (m, moment) in moments.iter().enumerate() {
            let gives = moment * (1.0 - muscles.states()[m].fatigued) / torque;
            assert!((end.limit.of_muscles[m] - gives).abs() < 1e-9, "{end:?}, {gives}");
        }
    }
}

/// Muscles of one joint with one law tire together as the joint does, however they share the torque: what one of them is spared tires another
/// one as much.
#[test]
fn muscles_of_one_joint_and_one_law_fail_when_the_joint_does() {
    let (law, torque, moments) = (law(0.015, 0.00149), 30.0, [40.0, 25.0, 12.0, 6.0]);
    let elbow = elbow(&moments);
    let torques = [torque];
    let (mut exhausted, mut muscles) = (0, MuscleFatigue::rested(vec![law.clone(); 4]));
    let end = hold(&mut muscles, &elbow.asked(&torques), 86_400.0, |_, muscles| {
        exhausted = exhausted.max((0..4).filter(|&m| muscles.is_exhausted(m)).count());
    })
    .unwrap();
    let joint = FatigueLaw::ThreeCompartment(law).endurance_time(torque / moments.iter().sum::<f64>());
    assert!(end.failed && exhausted >= 3, "{exhausted} exhausted, {end:?}");
    assert!((end.seconds / joint - 1.0).abs() < 3e-3, "{} s, the joint {joint} s", end.seconds);
}

/// Muscles of one and two joints at the right leg of the adult, as a random numbers' generator places them.
fn leg(random: &mut Pcg64) -> (Model, Musculature, PathGeometry, Vec<usize>) {
    let model = adult(&Adult::default()).unwrap();
    let pairs = [
        ("pelvis", "femur_r"),
        ("femur_r", "tibia_r"),
        ("pelvis", "tibia_r"),
        ("tibia_r", "talus_r"),
        ("femur_r", "talus_r"),
    ];
    let pairs: Vec<_> =
        pairs.into_iter().filter(|(a, b)| model.segment(a).is_some() && model.segment(b).is_some()).collect();
    assert!(pairs.len() >= 3, "names of segments have changed");
    let mut place = |y: f64| {
        Vector3::new(
            random.random_range(-0.06..0.06),
            y * random.random_range(0.5..1.0),
            random.random_range(-0.04..0.04),
        )
    };
    let lines: Vec<Line<'_>> =
        (0..30).map(|i| pairs[i % pairs.len()]).map(|(a, b)| (a, place(-0.05), b, place(-0.15))).collect();
    let muscles = musculature(&model, &lines);
    let mut posture = model.default_posture();
    let knee = model.coordinate("knee_angle_r").unwrap();
    posture.values_mut()[knee] = model.coordinates()[knee].range.1.min(0.6).max(model.coordinates()[knee].range.0);
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let mut geometry = PathGeometry::new(&model, &muscles.paths);
    geometry.update(&model, &kinematics, &muscles.paths, PathRule::Geodesic);
    let rates = geometry.crossed(&model);
    (model, muscles, geometry, rates)
}

/// Thirty muscles, several joints: activations are optimal within the capacities at every time, the torques are given, and at the instant of
/// failure multipliers prove that no activations give more.
#[test]
fn activations_are_optimal_until_multipliers_prove_that_none_suffice() {
    for sharing in [Sharing::Squares, Sharing::Cubes] {
        let seed = 20_261_124;
        println!("seed {seed}, {sharing:?}");
        optimal_until_none_suffice(seed, sharing);
    }
}

fn optimal_until_none_suffice(seed: u128, sharing: Sharing) {
    let mut random = Pcg64::new(seed, 0);
    let (mut failures, mut judged) = (0, 0);
    for _ in 0..12 {
        let (_, muscles, geometry, rates) = leg(&mut random);
        let muscles = Musculature { sharing, ..muscles };
        let forces: Vec<f64> = (0..30).map(|_| random.random_range(100.0..1500.0)).collect();
        let laws: Vec<_> =
            (0..30).map(|_| law(random.random_range(0.005..0.02), random.random_range(0.0005..0.002))).collect();
        // Torques that some activations give, so that the rested muscles can.
        let given: Vec<f64> = (0..30).map(|_| random.random_range(0.0f64..1.0).powi(3)).collect();
        let column = |m: usize, rate: usize| geometry.moment_arms(m)[rate] * forces[m];
        let torques: Vec<f64> = rates.iter().map(|&rate| (0..30).map(|m| column(m, rate) * given[m]).sum()).collect();
        let asked =
            SharedTorques { muscles: &muscles, geometry: &geometry, rates: &rates, torques: &torques, forces: &forces };
        let scale = torques.iter().fold(1.0f64, |most, torque| most.max(torque.abs()));
        let run = |visit: &mut dyn FnMut(f64, &MuscleFatigue)| {
            let mut fatigue = MuscleFatigue::rested(laws.clone());
            let end = hold(&mut fatigue, &asked, 3600.0, visit).unwrap();
            (end, fatigue.states().to_vec())
        };
        let (end, states) = run(&mut |time, fatigue| {
            let optimality = fatigue.optimality();
            if optimality.is_finite() {
                judged += 1;
                assert!(optimality < 1e-8, "{time} s: {optimality}");
            }
            for (k, &rate) in rates.iter().enumerate() {
                let sum: f64 = (0..30).map(|m| column(m, rate) * fatigue.loads()[m]).sum();
                assert!((sum - torques[k]).abs() < 1e-8 * scale, "{time} s: {sum} N m for {}", torques[k]);
            }
            for (load, capacity) in fatigue.loads().iter().zip(fatigue.capacities()) {
                assert!(*load >= 0.0 && *load <= capacity && capacity <= 1.0, "{time} s: {load} of {capacity}");
            }
        });
        let again = run(&mut |_, _| {});
        assert!(again.0 == end && again.1 == states, "the same hold twice");
        if !end.failed {
            assert!(end.limit.times >= 1.0 - 1e-9, "{end:?}");
            continue;
        }
        failures += 1;
        assert!((end.limit.times - 1.0).abs() < 1e-6, "{end:?}");
        // With these multipliers no activations within the capacities give more than the bound.
        let y: Vec<f64> = end.limit.of_torques.iter().zip(&torques).map(|(share, torque)| share / torque).collect();
        let sum: f64 = end.limit.of_torques.iter().sum();
        let bound: f64 = states
            .iter()
            .enumerate()
            .map(|(m, state)| {
                let gain: f64 = rates.iter().zip(&y).map(|(&rate, y)| y * column(m, rate)).sum();
                gain.max(0.0) * (1.0 - state.fatigued)
            })
            .sum();
        assert!((sum - 1.0).abs() < 1e-8 && (bound - end.limit.times).abs() < 1e-6, "{sum}, {bound}, {end:?}");
        let of_muscles: f64 = end.limit.of_muscles.iter().sum();
        assert!(end.limit.of_muscles.iter().all(|share| *share >= 0.0), "{end:?}");
        assert!((of_muscles - end.limit.times).abs() < 1e-9, "{of_muscles}, {end:?}");
        // A group whose torque has a part in the limit gives no more than is asked.
        let capacities: Vec<f64> = states.iter().map(|state| 1.0 - state.fatigued).collect();
        let strengths = asked.strengths(&capacities);
        for (k, share) in end.limit.of_torques.iter().enumerate().filter(|(_, share)| **share > 0.01) {
            let strength = if torques[k] > 0.0 { strengths[k].torque[0] } else { strengths[k].torque[1] };
            assert!((strength - torques[k]).abs() < 1e-4 * scale, "{share}: {strength} for {}", torques[k]);
        }
    }
    println!("{failures} of 12 holds fail, {judged} samples judged");
    assert!(failures > 5 && judged > 500, "{failures} of 12 fail, {judged} samples judged");
}

#[test]
fn a_step_allocates_nothing() {
    let elbow = elbow(&[40.0, 25.0, 12.0]);
    let torques = [30.0];
    let asked = elbow.asked(&torques);
    let mut muscles = MuscleFatigue::rested(vec![law(0.015, 0.0015); 3]);
    assert!(muscles.begin(&asked).unwrap());
    let made = allocation_counter::measure(|| {
        for _ in 0..40 {
            assert!(muscles.advance(&asked, 1.0).unwrap().is_some());
        }
    });
    assert!(muscles.states()[0].fatigued > 0.1 && made.count_total == 0, "{} times", made.count_total);
}

#[test]
fn torques_out_of_reach_fail_at_once_and_numbers_that_are_none_are_refused() {
    let elbow = elbow(&[40.0, 25.0]);
    let rested = || MuscleFatigue::rested(vec![law(0.01, 0.001); 2]);
    let mut muscles = rested();
    let end = hold(&mut muscles, &elbow.asked(&[66.0]), 100.0, |_, _| {}).unwrap();
    assert!(end.failed && end.seconds == 0.0 && (end.limit.times - 65.0 / 66.0).abs() < 1e-12, "{end:?}");
    let end = hold(&mut rested(), &elbow.asked(&[0.0]), 100.0, |_, _| {}).unwrap();
    assert!(!end.failed && end.seconds == 100.0 && end.limit.times > 1e5, "{end:?}");
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(hold(&mut rested(), &elbow.asked(&[wrong]), 100.0, |_, _| {}).is_err(), "{wrong}");
    }
    let start = Compartments::with_fatigue(0.0, 0.0);
    assert_eq!(rested().states(), [start; 2]);
}
