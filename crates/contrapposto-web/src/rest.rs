//! Searches for the different ways to rest, as `contrapposto relax` does.

use contrapposto::equilibria::{RelaxedPosture, equilibria_watched};
use contrapposto::model::plain_name;
use contrapposto_formats::RelaxScenario;

use crate::error::Refusal;
use crate::figure::Figure;
use crate::message::Way;

/// The ways of the body in the posture of a figure; `watch` is told how many postures have been sought.
pub(crate) fn ways(figure: &Figure, watch: &mut dyn FnMut(usize)) -> Result<Vec<Way>, Refusal> {
    let body = &figure.body;
    let mut search = body.scenario.search();
    search.start = &figure.posture;
    let found = equilibria_watched(&search, RelaxScenario::OPTIONS, watch).map_err(Refusal::of)?;
    let way = |posture: &RelaxedPosture| {
        let coordinates = body.model.coordinates();
        let hanging = posture.hanging.iter().map(|joint| plain_name(&coordinates[joint.coordinate].name));
        Ok(Way {
            effort: posture.relaxed.effort,
            on_ligaments: hanging.collect(),
            shown: figure.shown_in(&posture.relaxed.posture)?,
        })
    };
    found.postures.iter().map(way).collect()
}
