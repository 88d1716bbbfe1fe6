//! Measures the time of a one-joint simulation of ten minutes, at 30 steps a second.

use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::model::{Adult, adult};
use contrapposto::simulation::{ReliefSettings, RunSettings, Scenario, StrategySettings, Tables, run};
use contrapposto::statics::Load;
use criterion::{Criterion, criterion_group, criterion_main};

/// The right arm of the reference man, elbow free, upper arm 30 degrees forward, 3 kg in the hand: the elbow tires and is
/// relieved again and again.
fn ten_minutes() -> Scenario {
    let model = adult(&Adult::right_arm()).expect("the reference man");
    let index = |name: &str| model.coordinate(name).expect("a coordinate of the arm");
    let (shoulder, elbow) = (index("arm_flex_r"), index("elbow_flex_r"));
    let hand = model.segment("hand_r").expect("a hand");
    let mut start = model.default_posture();
    start.values_mut()[shoulder] = 30f64.to_radians();
    start.values_mut()[elbow] = 80f64.to_radians();
    let n = model.coordinates().len();
    let mut free = vec![false; n];
    free[elbow] = true;
    Scenario {
        title: "ten minutes".into(),
        loads: vec![Load::weight(&model, hand, 3.0)],
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
        run: RunSettings { duration: 600.0, step: 1.0 / 30.0, stop_when_settled: false, threads: 1 },
    }
}

fn bench(c: &mut Criterion) {
    let scenario = ten_minutes();
    c.bench_function("simulation/10 min, one joint, 30 steps/s", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            let summary = run(&scenario, |sample| sum += sample.active[3]).expect("a checked scenario");
            (summary.samples, sum)
        });
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
