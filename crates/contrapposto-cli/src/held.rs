//! What does a posture that is held still ask of the muscles? External, passive and active torque, contact forces of least effort.

use contrapposto::contact::Support;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::{AssessSettings, assess};
use contrapposto::statics::Load;

use crate::fail::Fail;
use crate::report::Frame;

/// A posture and what it asks for; `None` where the supports cannot hold it. Without supports its root is held as if by hand.
pub(crate) fn held(
    model: &Model,
    posture: &Posture,
    loads: &[Load],
    supports: &[Support],
) -> Result<Option<Frame>, Fail> {
    let settings = AssessSettings { supports: supports.to_vec(), ..AssessSettings::default() };
    let mut frame = None;
    let found = assess(
        model,
        &[(0.0, posture.clone())],
        |_, _, all| all.extend_from_slice(loads),
        &settings,
        |instant| frame = Some(Frame::of_instant(model, instant)),
    )
    .map_err(|error| Fail::job("posture", error))?;
    Ok(frame.filter(|_| found.unheld == 0))
}
