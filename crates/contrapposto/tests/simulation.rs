//! Tests the loop of a simulation: recovery, balance of torques, ranges, events and time steps.

use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::joint_torques::Hazard;
use contrapposto::model::{Adult, adult, data};
use contrapposto::posture::Posture;
use contrapposto::simulation::{
    Event, ReliefSettings, RunSettings, Sample, Scenario, StopReason, StrategySettings, Tables, run,
};
use contrapposto::statics::{Load, LoadKind};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The reference man's right arm, elbow free, `load` kg in the hand, an elbow curve that can carry it.
fn loaded_elbow(load: f64, duration: f64) -> (Scenario, usize) {
    let model = adult(&Adult::right_arm()).unwrap();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let curve = data::reshaped(model.coordinates()[elbow].curve().unwrap(), 5f64.to_radians(), 80.0).unwrap();
    let model = model.with_passive(elbow, curve);
    let hand = model.segment("hand_r").unwrap();
    let mut start = model.default_posture();
    start.values_mut()[model.coordinate("arm_flex_r").unwrap()] = 40f64.to_radians();
    start.values_mut()[elbow] = 50f64.to_radians();
    let n = model.coordinates().len();
    let mut free = vec![false; n];
    free[elbow] = true;
    let scenario = Scenario {
        title: "loaded elbow".into(),
        loads: vec![Load::weight(&model, hand, load)],
        model,
        start,
        free,
        supports: vec![],
        rests: vec![],
        limits: vec![],
        tasks: vec![],
        events: vec![],
        strategies: vec![],
        strategy: StrategySettings { kind: Strategy::Passive, minimum_decrease_ratio: 0.9 },
        relief: ReliefSettings {
            step_gain: 0.3,
            max_step: 2f64.to_radians(),
            torque_tolerance: 0.05,
            effort_factor: 1.25,
            tables: Tables::Total,
        },
        hysteresis: Hysteresis { critical_level: 0.6, recovery_level: 0.3 },
        muscles: None,
        muscles_tire: false,
        start_fatigue: vec![[0.0; 2]; n],
        run: RunSettings { duration, step: 1.0 / 30.0, stop_when_settled: false, threads: 1 },
    };
    (scenario, elbow)
}

#[test]
fn relief_of_a_loaded_elbow_lasts_until_its_group_has_recovered() {
    let (scenario, elbow) = loaded_elbow(10.0, 600.0);
    let (mut began, mut ended, mut load_at_trip) = (None, None, 0.0);
    run(&scenario, |sample| {
        if sample.decisions[elbow].is_some() && began.is_none() {
            began = Some(sample.time);
            load_at_trip = sample.load[elbow];
        }
        if began.is_some() && ended.is_none() && sample.decisions[elbow].is_none() {
            ended = Some(sample.time);
        }
    })
    .unwrap();
    let (began, ended) = (began.expect("the group tires"), ended.expect("the group rests"));
    assert!(load_at_trip > 0.4, "a real load: {load_at_trip}");
    // From 0.6 to 0.3 at rest, 3CC-r of the elbow: ln 2 / (15 x 0.00094 /s) = 49.2 s, after the way to the balance.
    let rest = ended - began;
    println!("trips at {began:.1} s under load {load_at_trip:.2}, rests {rest:.1} s");
    assert!((49.0..56.0).contains(&rest), "{rest}");
}

#[test]
fn in_every_sample_torques_add_up_to_zero_and_coordinates_are_in_range() {
    let (scenario, _) = loaded_elbow(4.0, 300.0);
    let mut relieved = 0;
    let summary = run(&scenario, |sample| {
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
            assert_eq!(sample.external[i] + sample.passive[i] + sample.active[i], 0.0);
            assert!((coordinate.range.0..=coordinate.range.1).contains(&sample.posture[i]));
            assert!(sample.fatigue[i].iter().all(|f| (0.0..=1.0).contains(f)));
            relieved += u32::from(sample.decisions[i].is_some());
        }
    })
    .unwrap();
    assert!(relieved > 100, "{relieved}");
    let reliefs = summary.reliefs;
    assert!(reliefs.count > 0 && reliefs.count == reliefs.records.len() as u64, "{}", reliefs.count);
    assert!(reliefs.records.iter().any(|record| record.done > 1), "a way of several steps");
}

#[test]
fn two_runs_of_one_scenario_give_the_same_bits() {
    let (scenario, _) = loaded_elbow(6.0, 120.0);
    let record = || {
        let mut bits: Vec<u64> = vec![];
        let summary = run(&scenario, |sample| {
            bits.extend(sample.posture.iter().chain(sample.active).map(|x| x.to_bits()));
            bits.extend(sample.fatigue.iter().flatten().map(|x| x.to_bits()));
        })
        .unwrap();
        (bits, summary)
    };
    assert!(record() == record(), "two runs differ");
}

#[test]
fn a_settled_run_with_an_event_to_come_ends_after_the_event() {
    let (mut scenario, _) = loaded_elbow(10.0, 600.0);
    scenario.start_fatigue.fill([0.7; 2]);
    scenario.run.stop_when_settled = true;
    let alone = run(&scenario, |_| {}).unwrap();
    assert_eq!(alone.reason, StopReason::Settled);
    let time = alone.end_time + 5.0;
    let heavier = vec![Load { kind: LoadKind::Weight(11.0), ..scenario.loads[0] }];
    scenario.events = vec![Event { time, loads: Some(heavier), ..Event::default() }];
    let (mut before, mut at_the_event) = (0.0, None);
    let summary = run(&scenario, |sample| {
        let most = sample.external.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        if sample.time + 1e-9 >= time {
            at_the_event.get_or_insert(most);
            return;
        }
        before = most;
        assert!(sample.time != alone.end_time || sample.settled);
    })
    .unwrap();
    println!("settled at {:.2} s; with something to come at {:.2} s", alone.end_time, summary.end_time);
    assert!(summary.end_time >= time && at_the_event > Some(1.05 * before), "{before} {at_the_event:?}");
    // The earliest comes first, and each has a time.
    let at = |time: f64| Event { time, ..scenario.events[0].clone() };
    for times in [[1.0, 0.5], [f64::NAN, 1.0], [1.0, f64::INFINITY], [-1.0, 0.0]] {
        let scenario = Scenario { events: times.map(at).to_vec(), ..scenario.clone() };
        let error = run(&scenario, |_| {}).unwrap_err().to_string();
        assert!(error.starts_with("time of an event (s) is "), "{error}");
    }
}

/// Under loads that come and go.
#[test]
fn fatigue_of_a_held_posture_is_the_same_at_time_steps_from_5_ms_to_60_s() {
    let (mut scenario, elbow) = loaded_elbow(4.0, 600.0);
    scenario.free.fill(false);
    scenario.hysteresis = Hysteresis { critical_level: 1.0, recovery_level: 0.0 };
    let load = |kilograms| Some(vec![Load { kind: LoadKind::Weight(kilograms), ..scenario.loads[0] }]);
    let loads = [load(1.0), load(6.0), Some(vec![]), load(2.0)];
    scenario.events = (60..)
        .step_by(60)
        .zip(loads)
        .map(|(at, loads)| Event { time: f64::from(at), loads, ..Event::default() })
        .collect();
    let integral = data::library().endurance("freylaw_avin_2010_elbow").unwrap().0;
    for law in [None, Some(integral)] {
        if let Some(law) = law {
            scenario.model = scenario.model.with_fatigue(elbow, &law);
        }
        let mut course = |step: f64| {
            scenario.run.step = step;
            let mut levels = vec![];
            let note = |sample: &Sample| {
                let minutes = sample.time / 60.0;
                if (minutes - minutes.round()).abs() < 1e-9 {
                    levels.extend(sample.fatigue[elbow]);
                }
            };
            run(&scenario, note).unwrap();
            levels
        };
        let fine = course(0.005);
        assert!(fine.len() == 22 && fine.iter().any(|level| *level > 0.4) && fine.iter().all(|level| *level < 0.99));
        for step in [1.0 / 30.0, 0.1, 1.0, 10.0, 60.0] {
            let course = course(step);
            assert_eq!(course.len(), fine.len());
            let worst = course.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("steps of {step:.3} s: fatigue is another one by {worst:.1e} at most");
            assert!(worst < 1e-9);
        }
    }
}

/// The whole body in postures drawn from all ranges, held still: the angles of its three-axis joints are far from their coordinates.
#[test]
fn hazards_of_a_run_are_those_of_its_posture_by_angles_about_axes() {
    let (arm, _) = loaded_elbow(0.0, 0.0);
    let model = adult(&Adult::default()).unwrap();
    let n = model.coordinates().len();
    let mut random = Pcg64::seed_from_u64(17);
    let (mut found, mut only_by_coordinates) = (0, 0);
    for draw in 0..400 {
        let values = model.coordinates().iter().map(|c| random.random_range(c.range.0..c.range.1)).collect();
        let scenario = Scenario {
            model: model.clone(),
            start: Posture::new(values),
            free: vec![false; n],
            loads: vec![],
            start_fatigue: vec![[0.0; 2]; n],
            ..arm.clone()
        };
        let mut torques = (vec![], vec![]);
        let summary = run(&scenario, |sample| torques = (sample.external.to_vec(), sample.passive.to_vec())).unwrap();
        let values = scenario.start.values();
        let hazards = Hazard::of_posture(&model, values, &torques.0, &torques.1);
        for (i, coordinate) in summary.coordinates.iter().enumerate() {
            let expected = hazards.iter().find(|hazard| hazard.coordinate == i);
            let name = &model.coordinates()[i].name;
            assert_eq!(coordinate.hazardous.is_some(), expected.is_some(), "{name}, posture {draw}");
            found += usize::from(expected.is_some());
            let by_coordinate = Hazard::at(&model.coordinates()[i], values[i], torques.0[i], torques.1[i]);
            only_by_coordinates += usize::from(by_coordinate.is_some() != expected.is_some());
            if let Some((hazardous, expected)) = coordinate.hazardous.zip(expected) {
                assert!((hazardous.angle - expected.angle).abs() < 1e-12, "{name}, posture {draw}");
            }
        }
    }
    println!("{found} hazards; {only_by_coordinates} answers would differ by coordinates");
    assert!(found > 50 && only_by_coordinates > 20, "{found} {only_by_coordinates}");
}
