//! Draws one picture of every kind into a folder: `cargo run -p contrapposto-plot --example preview -- FOLDER`.
//!
//! The first is the paper's Figure 1 (and 7, 8): an elbow with the upper arm held level, forward.

use std::error::Error;
use std::path::{Path, PathBuf};

use contrapposto_plot::{
    Figure, PassiveChart, PostureSketch, SketchRole, TimeLine, TorqueBalance, passive_curve, time_line, torque_balance,
};

const RANGE_DEG: (f64, f64) = (0.0, 150.0);

/// Passive torque of the elbow, N m, at an angle in radians.
fn passive(q: f64) -> f64 {
    12.67 * libm::exp(-19.92 * q) - 9.324 * libm::exp(3.811 * (q - 2.618))
}

/// Slope of the passive torque, N m/rad.
fn passive_slope(q: f64) -> f64 {
    -19.92 * 12.67 * libm::exp(-19.92 * q) - 3.811 * 9.324 * libm::exp(3.811 * (q - 2.618))
}

/// External torque of the forearm's weight, N m.
fn external(q: f64) -> f64 {
    -2.9 * libm::cos(q)
}

fn active(degrees: f64) -> f64 {
    let q = degrees.to_radians();
    -(passive(q) + external(q))
}

fn angles() -> Vec<f64> {
    (0..=600).map(|i| RANGE_DEG.1 * f64::from(i) / 600.0).collect()
}

fn at_angles(f: impl Fn(f64) -> f64) -> Vec<f64> {
    angles().iter().map(|degrees| f(degrees.to_radians())).collect()
}

/// Trunk, upper arm forward, forearm and hand bent by the angle.
fn arm(label: &str, degrees: f64, role: SketchRole) -> PostureSketch {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let along = |length: f64| [0.28 + length * cos, length * sin];
    PostureSketch {
        label: label.to_owned(),
        angle_deg: degrees,
        polylines: vec![vec![[0.0, -0.45], [0.0, 0.1]], vec![[0.0, 0.0], [0.28, 0.0], along(0.27), along(0.35)]],
        role,
    }
}

fn elbow(title: &str, subtitle: &str) -> TorqueBalance {
    TorqueBalance {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        angle_label: "elbow_flex_r, deg (flexion positive)".to_owned(),
        angles_deg: angles(),
        external_nm: at_angles(external),
        minus_passive_nm: at_angles(|q| -passive(q)),
        active_nm: angles().into_iter().map(active).collect(),
        tolerance_nm: 0.05,
        zero_torque_deg: vec![4.3, 94.6, 123.5],
        ..TorqueBalance::default()
    }
}

fn with_path(mut panel: TorqueBalance, from: f64, to: f64) -> TorqueBalance {
    let steps = (0..=40).map(|i| from + (to - from) * f64::from(i) / 40.0);
    panel.path = steps.map(|degrees| (degrees, active(degrees))).collect();
    panel.start = panel.path.first().copied();
    panel.goal = panel.path.last().copied();
    panel
}

fn figure_1() -> Figure {
    let mut panel = elbow("Level upper arm", "passive strategy: cases 3.2 ×30, 2.1 ×1");
    panel.postures = vec![
        arm("goal 4.3°", 4.3, SketchRole::Goal),
        arm("start 20°", 20.0, SketchRole::Start),
        arm("mid-range 94.6°", 94.6, SketchRole::Zero),
        arm("limit 123.5°", 123.5, SketchRole::Zero),
    ];
    torque_balance(&[with_path(panel, 20.0, 4.3)])
}

fn figures_7_and_8() -> Figure {
    let mut wide = with_path(elbow("Active strategy, R_min = 0.2", "cases 3.1 ×24, 3.3 ×18, 2.1 ×1"), 20.0, 94.6);
    wide.tolerance_nm = 0.3;
    let narrow = elbow("Active strategy, R_min = 1", "cases 3.2 ×30, 2.1 ×1");
    torque_balance(&[with_path(narrow, 20.0, 4.3), wide])
}

fn elbow_passive() -> Figure {
    passive_curve(&PassiveChart {
        title: "Passive torque of the elbow".to_owned(),
        angle_label: "elbow_flex_r, deg (flexion positive)".to_owned(),
        angles_deg: angles(),
        torque_nm: at_angles(passive),
        slope_nm_per_rad: at_angles(passive_slope),
        range_deg: RANGE_DEG,
        flattest_deg: Some((29.5, 41.0)),
        source: "Source: double exponential of the project's data sheet, mid-range stiffness set to 0 \
                 (with the measured stiffness Figures 7, 9 and 14 of the paper do not come out)."
            .to_owned(),
    })
}

fn elbow_in_time() -> Figure {
    let time_s: Vec<f64> = (0..=1200).map(|i| f64::from(i) * 0.1).collect();
    let angle_deg: Vec<f64> =
        time_s.iter().map(|t| if *t < 40.0 { 20.0 } else { 4.3 + 15.7 * libm::exp(-(t - 40.0) / 8.0) }).collect();
    let at_time = |f: fn(f64) -> f64| angle_deg.iter().map(|a| f(a.to_radians())).collect();
    let fatigue = |t: f64| if t < 40.0 { 0.6 * t / 40.0 } else { 0.6 * libm::exp(-(t - 40.0) / 50.0) };
    time_line(&TimeLine {
        title: "Elbow, passive strategy".to_owned(),
        subtitle: "relief begins at fatigue 0.6 and ends at 0.2".to_owned(),
        coordinate: "elbow_flex_r".to_owned(),
        external_nm: at_time(external),
        passive_nm: at_time(passive),
        active_nm: angle_deg.iter().map(|a| active(*a)).collect(),
        fatigue_positive: time_s.iter().map(|t| fatigue(*t)).collect(),
        fatigue_negative: vec![0.0; time_s.len()],
        critical_level: 0.6,
        recovery_level: 0.2,
        events: vec![(40.0, "3.2".to_owned()), (70.0, "2.1".to_owned()), (72.0, "released".to_owned())],
        angle_deg,
        time_s,
    })
}

fn save(folder: &Path, name: &str, figure: &Figure) -> Result<(), Box<dyn Error>> {
    std::fs::write(folder.join(format!("{name}.svg")), figure.svg())?;
    std::fs::write(folder.join(format!("{name}.png")), figure.png()?)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("give a folder to draw into")?);
    std::fs::create_dir_all(&folder)?;
    save(&folder, "torque-balance", &figure_1())?;
    save(&folder, "two-panels", &figures_7_and_8())?;
    save(&folder, "passive-curve", &elbow_passive())?;
    save(&folder, "time-line", &elbow_in_time())
}
