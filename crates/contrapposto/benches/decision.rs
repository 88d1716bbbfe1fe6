//! Measures the time of one decision, beside a plain search of the whole range.
//!
//! The rival scans 33 points of the same extrapolated active torque and refines each bracket by Illinois false position to
//! 1e-12 N m: all roots, but no case, no strategy and no answer where there is no root. Both run over the same 512 problems.

#![allow(missing_docs, clippy::unwrap_used)]

use contrapposto::hybrid::{Extrapolation, Problem, Strategy, minimise};
use contrapposto::passive::{CoordinateLimitForce, DoubleExponential, End, PassiveCurve, Tabulated};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use std::hint::black_box;

const POINTS: u32 = 33;

/// All roots in the range, summed so that nothing is optimised away.
fn scan(problem: &Problem) -> f64 {
    let active = Extrapolation::new(problem);
    let (min, max) = problem.curve.range();
    let width = (max - min) / f64::from(POINTS - 1);
    let (mut before, mut f_before) = (min, active.active(min));
    let mut sum = 0.0;
    for i in 1..POINTS {
        let angle = min + width * f64::from(i);
        let f_angle = active.active(angle);
        if (f_before > 0.0) != (f_angle > 0.0) {
            sum += illinois(&active, (before, f_before), (angle, f_angle));
        }
        (before, f_before) = (angle, f_angle);
    }
    sum
}

/// False position; the end that stays twice has its value halved.
fn illinois(active: &Extrapolation, (mut a, mut f_a): (f64, f64), (mut b, mut f_b): (f64, f64)) -> f64 {
    for _ in 0..100 {
        let x = (a * f_b - b * f_a) / (f_b - f_a);
        let f_x = active.active(x);
        if f_x.abs() <= 1e-12 || x == a || x == b {
            return x;
        }
        if (f_x > 0.0) == (f_b > 0.0) {
            f_a *= 0.5;
        } else {
            (a, f_a) = (b, f_b);
        }
        (b, f_b) = (x, f_x);
    }
    b
}

fn curves() -> [(&'static str, PassiveCurve); 3] {
    let range = (0.0, 150f64.to_radians());
    let elbow = DoubleExponential {
        lower: End { torque: 12.67, rate: 19.92, angle: 0.0 },
        upper: End { torque: 9.324, rate: 3.811, angle: range.1 },
        stiffness: 0.4,
        neutral: 73f64.to_radians(),
    };
    let curve = |form| PassiveCurve::new(form, range, None).unwrap();
    let elbow = curve(elbow.form().unwrap());
    // MoBL-ARMS (Saul et al. 2015), elbow flexion.
    let limit_force = CoordinateLimitForce {
        upper_stiffness: 0.3037f64.to_degrees(),
        upper_limit: 85f64.to_radians(),
        lower_stiffness: 100f64.to_degrees(),
        lower_limit: 14f64.to_radians(),
        transition: 139.5813f64.to_radians(),
    };
    let limit_force = curve(limit_force.form().unwrap());
    let rows: Vec<_> = (0..=15).map(|i| range.1 * f64::from(i) / 15.0).map(|q| (q, elbow.torque(q))).collect();
    let table = curve(Tabulated::new(&rows).unwrap().form());
    [("elbow", elbow), ("coordinate_limit_force", limit_force), ("table", table)]
}

fn problems(curve: &PassiveCurve) -> Vec<Problem<'_>> {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let (min, max) = curve.range();
    let mut problem = |_| Problem {
        curve,
        angle: random.random_range(min..=max),
        external_torque: random.random_range(-3.0..3.0),
        external_slope: random.random_range(-3.0..3.0),
        strategy: if random.random() { Strategy::Active } else { Strategy::Passive },
        minimum_decrease_ratio: random.random_range(0.0..1.0),
        torque_tolerance: 0.05,
        accepted: None,
    };
    (0..512).map(&mut problem).collect()
}

fn decision(criterion: &mut Criterion) {
    for (name, curve) in curves() {
        let problems = problems(&curve);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(problems.len() as u64));
        group.bench_function("decision", |b| {
            b.iter(|| black_box(&problems).iter().map(|p| minimise(p).unwrap().goal.unwrap()).sum::<f64>());
        });
        group.bench_function("scan", |b| {
            b.iter(|| black_box(&problems).iter().map(scan).sum::<f64>());
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(std::time::Duration::from_secs(2));
    targets = decision
}
criterion_main!(benches);
