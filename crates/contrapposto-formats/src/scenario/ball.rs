//! Lets the heel of a foot rise: its support becomes the ball of the foot.
//!
//! With `heel = "free"` the toes lie flat on the surface, and the foot turns about their joint. The ball of the foot is the patch: the front
//! edge of the sole, which is at that joint, and a quarter of the length of the sole ahead of it (assumed). The heel cannot go below the
//! surface: the toes extend by 0 or more.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, ModelError};
use nalgebra::{Point3, Vector3};

use super::names;
use super::task_text::{HeelText, SupportText};
use crate::input_error::InputError;
use crate::toml_file::Located;

/// Length of the ball of the foot, a share of the length of the sole (assumed).
const BALL: f64 = 0.25;
/// Corners of the sole that lie no farther behind the foremost one than this share of its length are its front edge.
const FRONT: f64 = 0.1;

/// The body whose heels stop at the surface, and the texts of all supports, those of feet with a free heel about the toes.
pub(super) fn with_free_heels(
    at: &Located,
    (mut model, built_in): (Model, bool),
    texts: &[&SupportText],
) -> Result<(Model, Vec<SupportText>), InputError> {
    let mut changed = vec![];
    for (i, &text) in texts.iter().enumerate() {
        let mut text = text.clone();
        if text.heel == HeelText::Free {
            let number = i.to_string();
            let path = ["support", &number, "heel"];
            let segment = names::segment(at, &model, &["support", &number, "segment"], &text.segment)?;
            let Some(foot) = Foot::of(&model, segment).filter(|_| built_in) else {
                let help = "the feet of the built-in adult are `calcn_r` and `calcn_l`".to_owned();
                let message = format!("`{}` has no heel that rises while its toes stay", text.segment);
                return Err(at.key_error(&path, message, Some(help)));
            };
            if text.corners_m.is_some() {
                let help = "leave out one of the two: the patch is the ball of the foot".to_owned();
                return Err(at.key_error(&path, "`heel` does not go with `corners_m`", Some(help)));
            }
            text.segment.clone_from(&model.segments()[foot.toes].name);
            text.corners_m = Some(foot.ball(&model).into_iter().map(Into::into).collect());
            let (_, most) = model.coordinates()[foot.joint].range;
            let refused = |error: ModelError| at.key_error(&path, error.to_string(), None);
            model = model.with_range(foot.joint, (0.0, most)).map_err(refused)?;
        }
        changed.push(text);
    }
    Ok((model, changed))
}

/// The sole of a foot that stands on its ball, as the support of a foot with its heel down; `None` of other segments.
pub(super) fn sole(model: &Model, support: &Support) -> Option<Support> {
    let name = &model.segments()[support.segment].name;
    let segment = model.segment(&name.replace("toes", "calcn")).filter(|&segment| segment != support.segment)?;
    let corners = model.segments()[segment].patch.clone();
    Some(Support { segment, corners, ..support.clone() })
}

/// A foot with toes.
struct Foot {
    sole: usize,
    toes: usize,
    /// The coordinate between them.
    joint: usize,
}

impl Foot {
    /// The foot whose sole is a patch of this segment.
    fn of(model: &Model, sole: usize) -> Option<Self> {
        let side = model.segments()[sole].name.strip_prefix("calcn")?;
        let (toes, joint) = (model.segment(&format!("toes{side}"))?, model.coordinate(&format!("mtp_angle{side}"))?);
        (!model.segments()[sole].patch.is_empty()).then_some(Self { sole, toes, joint })
    }

    /// Corners of the ball in the frame of the toes, m.
    fn ball(&self, model: &Model) -> Vec<Vector3<f64>> {
        let patch = &model.segments()[self.sole].patch;
        let (least, most) =
            patch.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), corner| (a.min(corner.x), b.max(corner.x)));
        let length = most - least;
        // The default posture has its toes straight.
        let kinematics = Kinematics::new(model);
        let toes = kinematics.placement(model, self.toes);
        let place = |corner: &Vector3<f64>| {
            toes.inverse_transform_point(&Point3::from(kinematics.station(model, self.sole, *corner))).coords
        };
        let mut edge: Vec<Vector3<f64>> =
            patch.iter().filter(|corner| most - corner.x <= FRONT * length).map(place).collect();
        edge.sort_by(|a, b| a.z.total_cmp(&b.z));
        let ahead = edge.iter().rev().map(|corner| corner + BALL * length * Vector3::x());
        edge.iter().copied().chain(ahead).collect()
    }
}
