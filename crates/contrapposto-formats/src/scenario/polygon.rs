//! Reads the polygon over which a task wants the centre of mass.

use contrapposto::contact::Support;
use contrapposto::model::LARGEST;
use contrapposto::tasks::{HalfPlane, half_planes};
use nalgebra::Vector3;

use super::stage::Stage;
use super::task_text::TaskText;
use crate::input_error::InputError;
use crate::toml_file::shown;

/// A polygon narrower than this, m, is refused.
const NARROWEST: f64 = 0.01;

/// The half-planes of the polygon whose corners the task number `number` gives, or of the polygon around the patches of the supports;
/// around their joints where the patch of one is not known.
pub(super) fn polygon(stage: &Stage<'_>, number: &str, text: &TaskText) -> Result<Vec<HalfPlane>, InputError> {
    let error =
        |key: &str, message: &str, help: String| Err(stage.at.error(&["task", number, key], message, Some(help)));
    let gravity = stage.model.gravity();
    if gravity.norm() == 0.0 {
        return error("kind", "without gravity nothing stands over a polygon", "give `target_m`".to_owned());
    }
    let up = gravity.iamax();
    let horizontal: Vec<usize> = (0..3).filter(|axis| *axis != up).collect();
    let letters: String = horizontal.iter().map(|&axis| ["x", "y", "z"][axis]).collect::<Vec<_>>().join(", ");
    let asked = format!("give polygon_m = [[{letters}], ...] with three corners or more, or `target_m`");
    let (key, points) = match &text.polygon_m {
        Some(corners) => ("polygon_m", corner_points(stage, number, corners, &horizontal)?),
        None if stage.supports.is_empty() => {
            return error("kind", "no support is there to stand over", format!("add a [[support]], {asked}"));
        }
        None if stage.patches.is_empty() => ("kind", joints_of_supports(stage)),
        None => ("kind", corners_of_supports(stage)),
    };
    let polygon = half_planes(&points, gravity);
    let width = |edge: &HalfPlane| points.iter().map(|p| -edge.excess(p)).fold(0.0, f64::max);
    if polygon.len() < 3 || polygon.iter().any(|edge| width(edge) < NARROWEST) {
        let message = match text.polygon_m {
            None if stage.patches.is_empty() => {
                "the patches of the supports are not known (corners_m), and their joints lie on a line, over which nobody stands"
            }
            None => "the patches of the supports are narrower than a centimetre, over which nobody stands",
            Some(_) => "the polygon is narrower than a centimetre",
        };
        return error(key, message, asked);
    }
    Ok(polygon)
}

/// The corners as the file gives them, in ground, m.
fn corner_points(
    stage: &Stage<'_>,
    number: &str,
    corners: &[[f64; 2]],
    horizontal: &[usize],
) -> Result<Vec<Vector3<f64>>, InputError> {
    let mut points = vec![];
    for (i, corner) in corners.iter().enumerate() {
        if let Some(value) = corner.iter().find(|value| value.abs() > LARGEST) {
            let path = ["task", number, "polygon_m", &i.to_string()];
            let message = format!("a corner is at {} m; 1e9 at most", shown(*value));
            return Err(stage.at.error(&path, message, None));
        }
        let mut point = Vector3::zeros();
        for (axis, value) in horizontal.iter().zip(corner) {
            point[*axis] = *value;
        }
        points.push(point);
    }
    Ok(points)
}

/// Corners of the patches of the supports, ground, m.
fn corners_of_supports(stage: &Stage<'_>) -> Vec<Vector3<f64>> {
    let in_ground = |support: &Support| {
        let placement = stage.kinematics.placement(stage.model, support.segment);
        support
            .corners
            .iter()
            .map(move |&corner| (placement * nalgebra::Point3::from(corner)).coords)
            .collect::<Vec<_>>()
    };
    stage.patches.iter().flat_map(in_ground).collect()
}

/// Joints at the start of the supports, and of the segments that each support carries.
fn joints_of_supports(stage: &Stage<'_>) -> Vec<Vector3<f64>> {
    let model = stage.model;
    let carries =
        |support: usize, segment: usize| segment == support || model.segments()[segment].parent == Some(support);
    let ends = |&support: &usize| (0..model.segments().len()).filter(move |&segment| carries(support, segment));
    let joint = |segment| stage.kinematics.placement(model, segment).translation.vector;
    stage.supports.iter().flat_map(ends).map(joint).collect()
}
