//! Tables of unknown origin: any bytes give a value or an error, in time proportional to their number.

use std::time::Duration;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::CoordinateKind::Translation;
use contrapposto_formats::loads::{GroundReaction, external_loads};
use contrapposto_formats::motion::{Units, postures, read_table, write_sto};

use super::common::{hammer, hammer_mutants, mutate, next, processor_time};
use super::{CSV, STATES, STORAGE, free, man, read, sto};

#[test]
fn mutated_bytes_give_a_table_or_a_complaint() {
    let (man, free) = (man(), free());
    let parts = [
        "endheader\n",
        "nRows=1\n",
        "nColumns=2\n",
        "inDegrees=no\n",
        "inDegrees=yes\n",
        "datarows 2\n",
        "time",
        "\t",
        ",",
        "\r\n",
        "\n",
        "nan",
        "inf",
        "1e999",
        "1e308",
        "hip_flexion_r",
        ".angle_deg",
        "_deg",
        "/value",
        "/speed",
        "\"",
        "\u{feff}",
        "\u{2028}",
        "é",
        "root_qw,root_qx,root_qy,root_qz",
        "99999999999999999999999",
    ];
    let free_text = "time,root_qw,root_qx,root_qy,root_qz\n0,1,0,0,0\n";
    let bases = [STATES, STORAGE, CSV, free_text].map(str::as_bytes);
    let (mut good, mut fitting) = (0, 0);
    hammer("motion", 1, 20_000, &bases, &parts, |bytes| {
        let Ok(table) = read_table("file", bytes) else { return false };
        good += 1;
        assert_eq!(table.times.len(), table.rows.len());
        assert!(!table.rows.is_empty() && table.rows.iter().all(|row| row.len() == table.columns.len()));
        assert!(table.rows.iter().flatten().chain(&table.times).all(|v| v.is_finite()));
        for units in [Units::FromFile, Units::Degrees, Units::Radians] {
            for model in [&man, &free] {
                let Ok(found) = postures(&table, "file", bytes, model, units) else { continue };
                fitting += 1;
                assert!(found.postures.iter().all(|(_, posture)| posture.check(model).is_ok()));
            }
        }
        // What was read can be written and is then the same.
        if table.columns.iter().all(|label| !label.contains(' ')) {
            let columns: Vec<_> = table.columns.iter().map(|c| (c.as_str(), Translation)).collect();
            let again = read(&write_sto(&table.name, &columns, false, &table.times, &table.rows).unwrap());
            assert_eq!((&again.columns, &again.times, &again.rows), (&table.columns, &table.times, &table.rows));
        }
        true
    });
    assert!(good > 1000 && fitting > 1000, "{good} tables, {fitting} motions");
}

/// Any bytes for an ExternalLoads file give finite loads or a complaint.
#[test]
fn mutated_external_loads_give_finite_loads_or_a_complaint() {
    let man = man();
    let kinematics = Kinematics::new(&man);
    let labels =
        ["force_v", "force_p", "torque_"].map(|stem| ["x", "y", "z"].map(|axis| format!("ground_{stem}{axis}")));
    let table = format!("time,{}\n0,1,2,3,4,5,6,7,8,9\n1,9,8,7,6,5,4,3,2,1\n", labels.concat().join(","));
    let element = |name: &str, text: &str| format!("<{name}>{text}</{name}>");
    let force = [
        element("applied_to_body", "calcn_r"),
        element("force_expressed_in_body", "/bodyset/tibia_r"),
        element("point_expressed_in_body", "ground"),
        element("force_identifier", "ground_force_v"),
        element("point_identifier", "ground_force_p"),
        element("torque_identifier", "ground_torque_"),
    ];
    let base = format!(
        "<OpenSimDocument Version=\"40000\"><ExternalLoads name=\"x\"><objects><ExternalForce name=\"right\">{}</ExternalForce>\
         </objects><datafile>forces.csv</datafile></ExternalLoads></OpenSimDocument>",
        force.concat()
    );
    let parts = [
        "calcn_l",
        "ground",
        "/ground",
        "Unassigned",
        "ground_",
        "ground_force_",
        "<appliesForce>false</appliesForce>",
        "<isDisabled>true</isDisabled>",
        "</ExternalForce>",
        "<ExternalForce>",
        "<objects>",
        "<",
        ">",
        "&",
        "é",
    ];
    let mut finite = 0;
    let words = ["calcn_r", "/bodyset/tibia_r", "ground_force_v", "ground_force_p", "ground_torque_", "name=\"right\""];
    let mutant = |i: usize, state: &mut u64| match i % 2 {
        0 => mutate(base.as_bytes(), &parts, state),
        _ => base.replacen(words[next(state) % words.len()], parts[next(state) % parts.len()], 1).into_bytes(),
    };
    hammer_mutants("external loads", 3, 5_000, mutant, |bytes| {
        let Ok(found) = external_loads(bytes) else { return false };
        let Ok(ground) = GroundReaction::of_external_loads("t.csv", table.as_bytes(), &found, &man) else {
            return false;
        };
        let mut loads = vec![];
        [-1.0, 0.25, 2.0].iter().for_each(|&time| ground.loads(time, &man, &kinematics, &mut loads));
        assert!(loads.iter().all(|load| load.check(&man).is_ok()));
        finite += loads.len();
        true
    });
    assert!(finite > 100, "{finite}");
}

#[test]
fn reading_takes_linear_time() {
    let time = |text: &str, repetitions: usize| {
        let start = processor_time();
        for _ in 0..repetitions {
            if let Ok(table) = read_table("x", text.as_bytes()) {
                drop(postures(&table, "x", text.as_bytes(), &free(), Units::FromFile));
            }
        }
        processor_time() - start
    };
    let labels = |n: usize| (0..n).map(|i| format!("c{i}")).collect::<Vec<_>>().join("\t");
    let shapes: [(&str, &dyn Fn(usize) -> String); 6] = [
        ("rows", &|n| sto("", &("time\troot_tx\n".to_owned() + &"0\t0.25\n".repeat(n)))),
        ("header", &|n| sto(&"comment of a stranger\n".repeat(n), "time\ta\n0\t1")),
        ("bad last cell", &|n| sto("", &("time\troot_tx\n".to_owned() + &"0\t0.25\n".repeat(n) + "0\tx\n"))),
        ("empty lines", &|n| "\n".repeat(8 * n)),
        ("one long cell", &|n| format!("a\n0.{}", "12345678".repeat(n))),
        ("columns", &|n| sto("", &format!("time\t{}\n0\t{}", labels(n / 20), vec!["1"; n / 20].join("\t")))),
    ];
    for (what, make) in shapes {
        let (small, large) = (make(10_000), make(80_000));
        // Eight small files against one of eight times the size; quadratic would take eight times as long. Clocks are
        // coarse and machines busy: one of five measurements must do.
        let linear = (0..5).any(|_| {
            let (small, large) = (time(&small, 8), time(&large, 1));
            println!("{what}: {small:?} {large:?}");
            large < 3 * small + Duration::from_millis(20)
        });
        assert!(linear, "{what} takes more than linear time");
    }
}
