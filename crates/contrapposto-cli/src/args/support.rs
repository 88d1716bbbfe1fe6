//! Arguments about what carries a body.

use contrapposto::contact::{Place, Support};
use contrapposto::model::Model;
use contrapposto_formats::loads::{no_segment, patch};
use nalgebra::Vector3;

use crate::fail::Fail;

/// Friction of a support: shoe on floor, as in scenarios.
const FRICTION: f64 = 0.6;

/// The supports that carry a body in given postures.
#[derive(Debug, clap::Args)]
pub(crate) struct SupportArgs {
    /// Segments that carry the body in every frame; their forces are computed for the least effort of the muscles.
    #[arg(long, value_delimiter = ',', value_name = "SEG,SEG", conflicts_with = "grf")]
    pub(crate) support: Vec<String>,
    /// Nothing carries the body, and its root is held as if by hand: only the muscles are judged.
    #[arg(long, conflicts_with_all = ["grf", "support"])]
    pub(crate) fixed_root: bool,
    /// Corners of the patch on which a supporting segment rests, in its frame (m): "calcn_r 0.1,-0.02,0.04 0.1,-0.02,-0.04 -0.04,-0.02,0".
    #[arg(long, value_name = "PATCH", requires = "support")]
    pub(crate) patch: Vec<String>,
}

impl SupportArgs {
    /// The supports, on horizontal ground.
    pub(crate) fn supports(&self, model: &Model) -> Result<Vec<Support>, Fail> {
        let mut patches = vec![];
        for text in &self.patch {
            patches.push(patch(model, text).map_err(|error| Fail::Refused(format!("--patch \"{text}\": {error}")))?);
        }
        let mut supports: Vec<Support> = vec![];
        for name in &self.support {
            let refuse = |why: String| Fail::Refused(format!("--support {name}: {why}"));
            let segment = model.segment(name).ok_or_else(|| refuse(no_segment(model, name)))?;
            if supports.iter().any(|support| support.segment == segment) {
                return Err(refuse("it is named twice".to_owned()));
            }
            let given = patches.iter().find(|(of, _)| *of == segment).map(|(_, corners)| corners);
            let corners: Vec<Vector3<f64>> = given.unwrap_or(&model.segments()[segment].patch).clone();
            if corners.is_empty() {
                return Err(refuse(format!(
                    "where it touches the ground is not known; give corners in its frame (m): --patch \"{name} X,Y,Z X,Y,Z ...\""
                )));
            }
            let Some(normal) = (-model.gravity()).try_normalize(1e-9) else {
                return Err(refuse("without gravity there is no ground".to_owned()));
            };
            supports.push(Support {
                segment,
                corners,
                normal,
                friction: FRICTION,
                share_max: 1.0,
                place: Place::Fixed,
            });
        }
        if let Some((segment, _)) =
            patches.iter().find(|(of, _)| !supports.iter().any(|support| support.segment == *of))
        {
            let name = &model.segments()[*segment].name;
            return Err(Fail::Refused(format!(
                "--patch \"{name} ...\": `{name}` is no support; name it with --support"
            )));
        }
        Ok(supports)
    }
}
