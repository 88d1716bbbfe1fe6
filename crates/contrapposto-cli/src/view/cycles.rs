//! The joints over the cycles of a motion: recorded instant by instant, then mean and spread.

use contrapposto::assessment::{ALIKE, Curve, CycleGrid, CycleOrigin, Cycles, Instant, NoCycles};
use contrapposto::joint_torques::active_torque;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;

use super::axes::visible;
use super::selection::shown;
use super::three_axis::angles;
use super::words::{how_long, plain};

/// Values of the joints at all instants of a motion.
pub(crate) struct CycleRecord<'a> {
    model: &'a Model,
    shown: Vec<usize>,
    up: Vector3<f64>,
    times: Vec<f64>,
    /// Upward force of the ground by segment, N.
    forces: Vec<(usize, Vec<f64>)>,
    /// By joint that is shown: angle, external torque, active torque, load.
    values: Vec<[Vec<f64>; 4]>,
}

/// Curves over the cycles of a motion.
pub(crate) struct CycleCurves {
    pub(crate) cycles: Cycles,
    /// Joints that are shown, in their order.
    pub(crate) joints: Vec<JointCurves>,
}

/// Curves of a joint: of a three-axis joint those about the axis that stands for its coordinate.
pub(crate) struct JointCurves {
    pub(crate) coordinate: usize,
    /// Degrees, or m.
    pub(crate) angle: Curve,
    pub(crate) external: Curve,
    pub(crate) active: Curve,
    /// Active torque over strength, as it is judged.
    pub(crate) load: Curve,
}

impl<'a> CycleRecord<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        let shown = shown(model);
        let up = (-model.gravity()).try_normalize(0.0).unwrap_or_else(Vector3::y);
        let values = vec![Default::default(); shown.len()];
        Self { model, shown, up, times: vec![], forces: vec![], values }
    }

    /// Takes in an instant and the measured forces of the ground in it.
    pub(crate) fn take(&mut self, instant: &Instant, measured: &[Load]) {
        let torques = instant.torques;
        let (external, passive) = (torques.external_about_axes(), torques.passive_torque().about_axes());
        let angles = angles(self.model, torques.kinematics().values());
        for (&i, values) in self.shown.iter().zip(&mut self.values) {
            let coordinate = &self.model.coordinates()[i];
            let [external, passive] = [external, passive].map(|of| coordinate.rate.map_or(0.0, |rate| of[rate]));
            let load = instant.load[i].into_iter().fold(0.0, f64::max);
            let now = [visible(coordinate, angles[i]), external, active_torque(external, passive), load];
            values.iter_mut().zip(now).for_each(|(values, value)| values.push(value));
        }
        for load in measured {
            let LoadKind::Force(force, fixed_in) = load.kind else { continue };
            let force = match fixed_in {
                FixedIn::World => force,
                FixedIn::Segment => torques.kinematics().direction(self.model, load.segment, force),
            };
            let at = self.forces.iter().position(|(segment, _)| *segment == load.segment).unwrap_or_else(|| {
                self.forces.push((load.segment, vec![]));
                self.forces.len() - 1
            });
            let upward = &mut self.forces[at].1;
            upward.resize(self.times.len() + 1, 0.0);
            upward[self.times.len()] += force.dot(&self.up);
        }
        self.times.push(instant.time);
    }

    /// The cycles between landings, or else where angles come back.
    ///
    /// # Errors
    /// The reason why there are none.
    pub(crate) fn find(&self) -> Result<Cycles, NoCycles> {
        let turns =
            |i: &usize| self.model.coordinates()[*i].kind == CoordinateKind::Rotation && !self.model.is_dependent(*i);
        let turning = self.shown.iter().zip(&self.values).filter(|(i, _)| turns(i));
        let angles: Vec<Vec<f64>> =
            turning.map(|(_, values)| values[0].iter().map(|angle| angle.to_radians()).collect()).collect();
        let mut forces = self.forces.clone();
        forces.iter_mut().for_each(|(_, upward)| upward.resize(self.times.len(), 0.0));
        Cycles::find(&self.times, &forces, &angles)
    }

    /// The curves over cycles.
    pub(crate) fn curves(&self, cycles: Cycles) -> CycleCurves {
        let grid = CycleGrid::new(&cycles, &self.times);
        let of_joint = |(&coordinate, values): (&usize, &[Vec<f64>; 4])| {
            let [angle, external, active, load] = std::array::from_fn(|k| grid.curve(&values[k]));
            JointCurves { coordinate, angle, external, active, load }
        };
        let joints = self.shown.iter().zip(&self.values).map(of_joint).collect();
        CycleCurves { cycles, joints }
    }
}

/// The reason why a motion has no cycles, and the option that gives them.
pub(crate) fn no_cycles(why: NoCycles) -> String {
    let why = match why {
        NoCycles::TooShort => "there are fewer than three times, or no angles".to_owned(),
        NoCycles::Still => "all angles together move by less than a degree".to_owned(),
        NoCycles::NotBack(None) => "the angles do not return to those of the start".to_owned(),
        NoCycles::NotBack(Some((lag, apart))) => format!(
            "the angles do not return to earlier ones: they come nearest after {}, with {:.0} % of the movement still different ({:.0} % at most count as a cycle)",
            how_long(lag),
            100.0 * apart,
            100.0 * ALIKE
        ),
    };
    format!("no cycles are found: {why}; --cycles 1.2 gives their length in s, --cycles 0.6,1.7,2.9 their bounds")
}

impl CycleCurves {
    /// `5 cycles of 1.12 s (standard deviation 0.02 s), from a landing of the right foot to its next one`.
    pub(crate) fn in_words(&self, model: &Model) -> String {
        let (mean, deviation) = self.cycles.length();
        let origin = match self.cycles.origin {
            CycleOrigin::Landings(segment) => {
                format!("from a landing of the {} to its next one", plain(&model.segments()[segment].name))
            }
            CycleOrigin::Angles => "found where the angles come back to those of the start".to_owned(),
            CycleOrigin::Given => "as --cycles says".to_owned(),
            CycleOrigin::Whole => "the whole motion, as --repeat says".to_owned(),
        };
        match (self.cycles.count(), deviation) {
            (count, Some(deviation)) => {
                format!("{count} cycles of {} (standard deviation {deviation:.3} s), {origin}", how_long(mean))
            }
            _ => format!("One cycle only, of {}, {origin}: its curves have no spread", how_long(mean)),
        }
    }

    /// The curves as the page shows them.
    pub(crate) fn on_page(&self, model: &Model) -> contrapposto_report::Cycles {
        use contrapposto_report::{Band, CycleCurves};
        let band = |curve: &Curve| Band { mean: curve.mean.clone(), deviation: curve.deviation.clone() };
        let joint = |joint: &JointCurves| CycleCurves {
            angle: band(&joint.angle),
            external: band(&joint.external),
            active: band(&joint.active),
            load: band(&joint.load),
        };
        let bands = if self.cycles.count() > 1 {
            " Lines: mean over the cycles. Bands: one standard deviation to either side."
        } else {
            ""
        };
        let text = format!("{}.{bands}", self.in_words(model));
        contrapposto_report::Cycles { text, joints: self.joints.iter().map(joint).collect() }
    }
}
