//! `contrapposto relax` of a published model: each posture has the strength of its own muscles, and the tissue beside the muscles of a hip decides
//! whether a slouch is among them (docs/contrapposto.md).

use crate::support;

use std::fmt::Write;

use serde_json::Value;
use support::{contrapposto, shared, write};

const MODEL: &str = "models/opensim/gait2392_thelen2003muscle.osim";

/// A body one of whose legs rests, on the muscles of gait2392 and `tissue` beside them.
fn standing(tissue: &str) -> String {
    let foot = "corners_m = [[0.2, -0.02, 0.04], [0.2, -0.02, -0.04], [-0.04, -0.02, -0.03], [-0.04, -0.02, 0.03]]";
    format!(
        "format = 1
         [model]
         file = \"body.osim\"
         muscles = \"both\"
         hip_tract = \"{tissue}\"
         [[support]]
         segment = \"calcn_r\"
         {foot}
         [[support]]
         segment = \"calcn_l\"
         {foot}
         place = \"free\"
         share_max = 0.15
         [[task]]
         kind = \"orientation\"
         segment = \"torso\"
         target = \"start\"
         [[task]]
         kind = \"effort\"\n"
    )
}

fn degrees(posture: &Value, name: &str) -> f64 {
    posture["coordinates"][name].as_f64().unwrap().to_degrees()
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model, on whose muscles a body relaxes"]
fn the_postures_of_gait2392_have_the_strength_of_their_own_muscles_and_slouch_on_the_tract_of_a_hip() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("body.osim");
    std::fs::copy(shared(MODEL), &model).unwrap();
    let mut efforts = vec![];
    for tissue in ["off", "mean"] {
        let scenario = write(folder.path(), "standing.toml", &standing(tissue));
        let run = contrapposto(["relax", &scenario, "--json", "--no-suggest"]).run();
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(!run.stderr.contains("its effort still fell"), "{}", run.stderr);
        let found: Value = serde_json::from_str(&run.stdout).unwrap();
        let postures = found["postures"].as_array().unwrap();
        let first = &postures[0];
        efforts.push((
            first["effort"].as_f64().unwrap(),
            degrees(first, "pelvis_list"),
            degrees(first, "hip_adduction_r"),
        ));
        let order: Vec<&str> =
            found["coordinate_order"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
        let mut compared = 0;
        for posture in postures {
            // The strength of the groups that work there, by another command.
            let row = order.iter().fold("0".to_owned(), |mut row, name| {
                write!(row, ",{}", posture["coordinates"][name].as_f64().unwrap()).unwrap();
                row
            });
            let table = write(folder.path(), "posture.csv", &format!("time,{}\n{row}\n", order.join(",")));
            let assess = ["assess", model.to_str().unwrap(), &table, "--fixed-root", "--radians", "--json"];
            let assessed: Value = serde_json::from_str(&contrapposto(assess).run().stdout).unwrap();
            for group in posture["groups"].as_array().unwrap() {
                let same = |other: &&Value| ["coordinate", "side"].iter().all(|key| other[*key] == group[*key]);
                let Some(other) = assessed["groups"].as_array().unwrap().iter().find(same) else { continue };
                let Some(strength) = other["strength_at_peak"]["strength_nm"].as_f64() else { continue };
                let own = group["strength_nm"].as_f64().unwrap();
                let off = (own - strength).abs() / strength.max(1.0);
                assert!(off < 1e-9, "{group} {strength}");
                compared += 1;
            }
        }
        println!("{tissue}: {} postures, {:?}, {compared} strengths", postures.len(), efforts.last());
        assert!(compared > 5 * postures.len(), "{compared}");
    }
    let [(level, list, _), (slouch, hung, adduction)] = efforts[..] else { panic!("two answers") };
    assert!(list.abs() < 7.0 && level > 0.01, "on muscles alone the pelvis stays level: {list} {level}");
    assert!(hung < -12.0 && adduction > 20.0 && slouch < 0.3 * level, "{hung} {adduction} {slouch}");
}
