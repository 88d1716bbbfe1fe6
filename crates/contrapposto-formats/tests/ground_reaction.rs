//! Tables of ground reactions: what they give between their rows, the times that they cover, and what is refused.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::statics::LoadKind;
use contrapposto_formats::loads::{GroundReaction, GroundReactionError};

/// A force that rises by 40 N a second ahead, and swings upward.
fn table(rows: usize) -> String {
    let row = |i: usize| {
        let time = 0.1 * i as f64;
        format!("{time},{},{},0,0.1,0,0.1\n", 40.0 * time, 700.0 + 100.0 * libm::sin(4.0 * time))
    };
    let head = "time,ground_force_vx,ground_force_vy,ground_force_vz,ground_force_px,ground_force_py,ground_force_pz\n";
    (0..rows).fold(head.to_owned(), |text, i| text + &row(i))
}

fn read(text: &str, model: &Model) -> Result<GroundReaction, GroundReactionError> {
    GroundReaction::read("forces.csv", text.as_bytes(), &["calcn_r"], model)
}

/// Force at a time, N.
fn force(ground: &GroundReaction, time: f64, model: &Model) -> [f64; 3] {
    let mut loads = vec![];
    ground.loads(time, model, &Kinematics::new(model), &mut loads);
    let [load] = &loads[..] else { panic!("{} loads", loads.len()) };
    let LoadKind::Force(force, _) = load.kind else { panic!("{:?}", load.kind) };
    force.into()
}

#[test]
fn splines_pass_nearer_to_a_swinging_force_than_lines() {
    let model = adult(&Adult::default()).unwrap();
    let lines = read(&table(21), &model).unwrap();
    let splines = lines.clone().with_splines().unwrap();
    let (mut of_lines, mut of_splines) = (0f64, 0f64);
    for time in (4..16).map(|i| 0.1 * f64::from(i) + 0.05) {
        let expected = 700.0 + 100.0 * libm::sin(4.0 * time);
        let off = |ground: &GroundReaction| {
            let [ahead, up, right] = force(ground, time, &model);
            assert!((ahead - 40.0 * time).abs() < 1e-9 && right == 0.0, "{time} s: {ahead} {right}");
            (up - expected).abs()
        };
        (of_lines, of_splines) = (of_lines.max(off(&lines)), of_splines.max(off(&splines)));
    }
    println!("off by {of_lines:.2} N with lines, {of_splines:.3} N with splines");
    // Half of the square of a step times the greatest second derivative, over four; splines gain two orders.
    assert!(of_lines > 1.0 && of_lines < 2.0 && of_splines < 0.1, "{of_lines} {of_splines}");
    let error = read(&table(3), &model).unwrap().with_splines().unwrap_err().to_string();
    assert!(error.contains("forces.csv"), "{error}");
}

#[test]
fn times_outside_of_a_table_are_refused_with_the_frame() {
    let model = adult(&Adult::default()).unwrap();
    let ground = read(&table(21), &model).unwrap();
    assert_eq!(ground.span(), Some((0.0, 2.0)));
    ground.check([0.0, 1.3, 2.0]).unwrap();
    let error = ground.check([0.0, 1.3, 2.5]).unwrap_err().to_string();
    assert!(error.starts_with("frame 2 at 2.5 s has no ground reaction: forces.csv goes from 0 s to 2 s"), "{error}");
}

#[test]
fn tables_without_rows_and_with_other_numbers_of_plates_are_refused() {
    let model = adult(&Adult::default()).unwrap();
    let error = read(&table(0), &model).unwrap_err().to_string();
    assert_eq!(error, "the table has column names but no rows");
    let two = GroundReaction::read("forces.csv", table(3).as_bytes(), &["calcn_r", "calcn_l"], &model);
    let error = two.unwrap_err().to_string();
    assert!(error.contains("forces.csv") && error.contains("ground_force_"), "{error}");
}
