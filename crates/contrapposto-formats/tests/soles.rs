//! Soles of robots from their shapes for contact, and the polygon over which a centre of mass is asked.

use contrapposto::model::Model;
use contrapposto::tasks::{CenterOfMassGoal, HalfPlane, Task};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{PoseScenario, read_model, read_pose};
use nalgebra::Vector3;

const BIPED: &str = include_str!("models/biped.urdf");

fn model(name: &str, text: &str, root: Option<RootAttachment>) -> Model {
    read_model(name, text.as_bytes(), root, &mut |_: &str| Err("none".to_owned())).unwrap().0.model
}

fn patch(model: &Model, segment: &str) -> Vec<Vector3<f64>> {
    let mut patch = model.segments()[model.segment(segment).unwrap()].patch.clone();
    patch.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    patch
}

fn same(found: &[Vector3<f64>], expected: &[[f64; 3]]) -> bool {
    let near = |(a, b): (&Vector3<f64>, &[f64; 3])| (a - Vector3::from(*b)).norm() < 1e-12;
    found.len() == expected.len() && found.iter().zip(expected).all(near)
}

#[test]
fn soles_are_the_lowest_corners_of_balls_and_boxes_and_meshes_are_counted() {
    let (imported, _) =
        read_model("biped.urdf", BIPED.as_bytes(), None, &mut |_: &str| Err("none".to_owned())).unwrap();
    let corners = |z| [[-0.05, -0.04, z], [-0.05, 0.04, z], [0.15, -0.04, z], [0.15, 0.04, z]];
    assert!(same(&patch(&imported.model, "left_foot"), &corners(-0.06)), "{:?}", patch(&imported.model, "left_foot"));
    assert!(same(&patch(&imported.model, "right_foot"), &corners(-0.06)), "{:?}", patch(&imported.model, "right_foot"));
    assert!(patch(&imported.model, "left_shank").is_empty() && patch(&imported.model, "pelvis").is_empty());
    let meshes = ("collision that is no box, cylinder, capsule or sphere".to_owned(), 2);
    assert!(imported.left_out.contains(&meshes), "{:?}", imported.left_out);
}

/// One body of one geom over a floor, z up.
fn geom(geom: &str) -> Vec<Vector3<f64>> {
    let text = format!(
        "<mujoco><worldbody><body name=\"b\" pos=\"0 0 1\"><freejoint/><inertial pos=\"0 0 0\" mass=\"1\" \
         diaginertia=\"1 1 1\"/><geom {geom}/></body></worldbody></mujoco>"
    );
    patch(&model("b.xml", &text, None), "b")
}

#[test]
fn soles_of_mjcf_geoms_are_points_lines_and_rims() {
    assert!(same(&geom("type='sphere' size='0.1' pos='0.3 0 0'"), &[[0.3, 0.0, -0.1]]));
    let along_x = "type='capsule' size='0.02' fromto='-0.1 0 0 0.1 0 0'";
    assert!(same(&geom(along_x), &[[-0.1, 0.0, -0.02], [0.1, 0.0, -0.02]]), "{:?}", geom(along_x));
    let lying = geom("type='cylinder' size='0.2' fromto='-0.1 0 0 0.1 0 0'");
    assert!(lying.len() == 2 && lying.iter().all(|corner| (corner.z + 0.2).abs() < 1e-12), "{lying:?}");
    let standing = geom("type='cylinder' size='0.1 0.3'");
    let rim = |corner: &Vector3<f64>| (corner.xy().norm() - 0.1).abs() < 1e-12 && (corner.z + 0.3).abs() < 1e-12;
    assert!(standing.len() == 16 && standing.iter().all(rim), "{standing:?}");
    assert!(same(&geom("type='ellipsoid' size='0.3 0.2 0.1'"), &[[0.0, 0.0, -0.1]]));
    // Turned by 45 degrees about x: the lowest edge of the box.
    let edge = geom("type='box' size='0.2 0.1 0.1' euler='45 0 0'");
    assert!(same(&edge, &[[-0.2, 0.0, -0.1 * 2f64.sqrt()], [0.2, 0.0, -0.1 * 2f64.sqrt()]]), "{edge:?}");
    for nothing in ["type='box' size='1 1 1' contype='0' conaffinity='0'", "type='box' size='0 1 1'"] {
        assert!(geom(nothing).is_empty(), "{nothing}");
    }
}

fn polygon(lines: &str) -> Result<Vec<HalfPlane>, String> {
    let text = format!(
        "format = 1\n[model]\nfile = \"biped.urdf\"\n{lines}\n[[task]]\nkind = \"center_of_mass\"\n[coordinates]\nlocked = []\n"
    );
    let file = model("biped.urdf", BIPED, Some(RootAttachment::Free));
    let scenario: PoseScenario = read_pose("biped.toml", text.as_bytes(), Some(file))
        .map_err(|error| format!("{:?}", miette::Report::new(error)))?;
    let of_task = |task: &Task| match task {
        Task::CenterOfMass(center) => match &center.goal {
            CenterOfMassGoal::Inside { polygon, .. } => Some(polygon.clone()),
            CenterOfMassGoal::At { .. } => None,
        },
        _ => None,
    };
    Ok(scenario.goals.iter().flat_map(|goal| &goal.tasks).find_map(of_task).unwrap())
}

fn extent(polygon: &[HalfPlane], direction: Vector3<f64>) -> f64 {
    let edge = polygon.iter().find(|edge| (edge.normal - direction).norm() < 1e-9);
    edge.map_or(f64::NAN, |edge| edge.offset)
}

#[test]
fn a_centre_of_mass_over_the_supports_is_over_their_patches_not_their_joints() {
    let feet = "[[support]]\nsegment = \"left_foot\"\n[[support]]\nsegment = \"right_foot\"\n";
    let soles = polygon(feet).unwrap();
    // Soles from -0.05 to 0.15 m ahead of the ankles, to 0.04 m outside of them, 0.1 m to each side.
    assert!((extent(&soles, Vector3::x()) - 0.15).abs() < 1e-9, "{soles:?}");
    assert!((extent(&soles, -Vector3::x()) - 0.05).abs() < 1e-9, "{soles:?}");
    assert!((extent(&soles, Vector3::y()) - 0.14).abs() < 1e-9, "{soles:?}");
    let given = format!("{feet}corners_m = [[0.3, 0, -0.06], [-0.1, 0.05, -0.06], [-0.1, -0.05, -0.06]]\n");
    let given = polygon(&given).unwrap();
    assert!((extent(&given, -Vector3::x()) - 0.1).abs() < 1e-9, "{given:?}");
    assert!(given.iter().all(|edge| edge.excess(&Vector3::new(0.299, -0.1, 0.0)) < 0.0), "{given:?}");
}

#[test]
fn a_centre_of_mass_over_supports_of_unknown_patches_names_what_is_missing() {
    let shanks = "[[support]]\nsegment = \"left_shank\"\n[[support]]\nsegment = \"right_shank\"\n";
    let said = polygon(shanks).unwrap_err();
    assert!(said.contains("patches of the supports are not known (corners_m)"), "{said}");
}
