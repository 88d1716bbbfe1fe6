//! Gives the body of a scenario the passive torque of its muscles as laws near its posture.
//!
//! Relief needs a falling curve. Where the passive torque of muscles rises with the angle by more than can be levelled
//! ([`contrapposto::joint_torques::MOST_LEVELLED`]), the built-in law stands for the muscles, and a note says so.

use contrapposto::joint_torques::{JointMuscles, TorqueRise};
use contrapposto::model::Model;
use contrapposto::muscle::Sharing;
use contrapposto::passive::PassiveLaw;
use contrapposto::posture::Posture;
use contrapposto::statics::PathTensionError;

use super::SourcedModel;
use super::origin::Origin;

/// Half the range of the table of a coordinate whose range has no end, rad.
const HALF_TURN: f64 = std::f64::consts::PI;

/// The muscles of a scenario's model, and the laws that stand for them where they give no curve.
#[derive(Clone, Debug)]
pub struct ScenarioMuscles {
    muscles: JointMuscles,
    /// By coordinate.
    library: Vec<Option<PassiveLaw>>,
}

impl SourcedModel {
    /// As [`SourcedModel::joint_muscles`], for a body that is simulated: the muscles' passive torque is written to the model as laws near
    /// its default posture. `library` is the same model without its muscles.
    ///
    /// # Errors
    /// [`PathTensionError`] where the passive torque has no known gradient: tendons of MuJoCo.
    pub fn scenario_muscles(
        &mut self,
        library: &Self,
    ) -> Result<(Option<ScenarioMuscles>, Vec<String>), PathTensionError> {
        let (muscles, doubts) = self.joint_muscles(library);
        let Some(mut muscles) = muscles else { return Ok((None, doubts)) };
        let coordinates = self.model.coordinates().iter().enumerate();
        let of_muscles = coordinates.filter(|(i, _)| self.origins[*i].passive == Origin::Muscles);
        let ranges: Vec<(usize, (f64, f64))> = of_muscles
            .map(|(i, coordinate)| {
                let (low, high) = coordinate.range;
                let own = (low.max(coordinate.default - HALF_TURN), high.min(coordinate.default + HALF_TURN));
                let meant = library.origins[i].meant.unwrap_or(own);
                let cut = (own.0.max(meant.0), own.1.min(meant.1));
                (i, if cut.0 < cut.1 { cut } else { own })
            })
            .filter(|(_, (low, high))| low < high)
            .collect();
        if !ranges.is_empty() {
            muscles = muscles.with_laws(&self.model, &ranges)?;
            let posture = self.model.default_posture();
            // The default posture fits its model.
            let _ = muscles.pose(&mut self.model, &posture);
        }
        let library = library.model.coordinates().iter().map(|coordinate| coordinate.passive.clone()).collect();
        Ok((Some(ScenarioMuscles { muscles, library }), doubts))
    }
}

impl ScenarioMuscles {
    /// The same, whose muscles share torques by a measure.
    #[must_use]
    pub fn with_sharing(self, sharing: Sharing) -> Self {
        Self { muscles: self.muscles.with_sharing(sharing), ..self }
    }

    /// The muscles, with the body in the posture `start`. Joints keep a law that the scenario gives them; where `relief` is sought they have
    /// the library's if the torque of their muscles rises too much. The notes say which.
    pub fn settle(self, model: &mut Model, start: &Posture, relief: bool) -> (JointMuscles, Vec<String>) {
        let Self { mut muscles, library } = self;
        let of_muscles = |model: &Model, i: usize| matches!(model.coordinates()[i].passive, Some(PassiveLaw::Slice(_)));
        let mut notes = vec![];
        let all: Vec<usize> = muscles.rises(model, start).iter().map(|rise| rise.coordinate).collect();
        let given: Vec<usize> = all.iter().copied().filter(|i| !of_muscles(model, *i)).collect();
        if !given.is_empty() {
            notes.push(format!(
                "muscles are not added to the passive torque that the scenario gives {}",
                names(model, &given)
            ));
            leave(&mut muscles, model, &joints(model, &given), &library);
        }
        // The start fits the model, as the reader of the scenario has checked.
        let _ = muscles.pose(model, start);
        let rises = muscles.rises(model, start);
        let known = |i: usize| joint_of(model, i).into_iter().all(|c| library[c].is_some());
        let (rising, levelled): (Vec<TorqueRise>, Vec<TorqueRise>) = rises
            .into_iter()
            .filter(|rise| rise.rise > 0.0)
            .partition(|rise| !rise.is_small() && (relief || rise.rise.is_infinite()) && known(rise.coordinate));
        let rising_at: Vec<usize> = rising.iter().map(|rise| rise.coordinate).collect();
        let left = joints(model, &rising_at);
        if !rising.is_empty() {
            let all: Vec<String> = rising.iter().map(|rise| said(model, rise)).collect();
            notes.push(format!(
                "relief needs a passive torque that falls with the angle; that of the muscles rises about {}: {} have the built-in passive \
                 torque",
                all.join(", "),
                names(model, &left)
            ));
            leave(&mut muscles, model, &left, &library);
        }
        let levelled: Vec<String> =
            levelled.iter().filter(|rise| !left.contains(&rise.coordinate)).map(|rise| said(model, rise)).collect();
        if !levelled.is_empty() {
            notes.push(format!(
                "rises of the muscles' passive torque are levelled for goal angles: {}",
                levelled.join(", ")
            ));
        }
        (muscles, notes)
    }
}

/// The other coordinates of its three-axis joint, and the coordinate.
fn joint_of(model: &Model, coordinate: usize) -> Vec<usize> {
    let joint = model.three_axis_joint_of(coordinate);
    joint.map_or_else(|| vec![coordinate], |(joint, _)| model.three_axis_joints()[joint].coordinates.to_vec())
}

fn joints(model: &Model, coordinates: &[usize]) -> Vec<usize> {
    let mut all: Vec<usize> = coordinates.iter().flat_map(|&i| joint_of(model, i)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Leaves coordinates to the law that the scenario gives them, or to the library's.
fn leave(muscles: &mut JointMuscles, model: &mut Model, coordinates: &[usize], library: &[Option<PassiveLaw>]) {
    let law = |&i: &usize| {
        let own = model.coordinates()[i].passive.clone();
        let given = own.filter(|law| !matches!(law, PassiveLaw::Slice(_)));
        (i, given.or_else(|| library[i].clone()))
    };
    let laws = coordinates.iter().map(law).collect();
    muscles.leave_passive(model, laws);
}

fn names(model: &Model, coordinates: &[usize]) -> String {
    let named: Vec<String> = coordinates.iter().map(|&i| format!("`{}`", model.coordinates()[i].name)).collect();
    named.join(", ")
}

/// `` `hip_flexion_r` by 3.2 N m (41 % of its span) ``.
fn said(model: &Model, rise: &TorqueRise) -> String {
    let share = 100.0 * rise.rise / rise.span;
    format!("`{}` by {:.2} N m ({share:.0} % of its span)", model.coordinates()[rise.coordinate].name, rise.rise)
}
