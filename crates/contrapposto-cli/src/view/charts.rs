//! From scenarios and runs to the plain numbers that charts are drawn from.

use contrapposto::joint_torques::{AboutAxes, JointTorques, Quantities, active_torque};
use contrapposto::kinematics::Kinematics;
use contrapposto::math::dichotomy;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::{ReliefLog, ReliefRecord};
use contrapposto::statics::Load;
use contrapposto_plot::{PostureSketch, SketchRole, TimeLine, TorqueBalance};
use nalgebra::Vector3;

use super::recording::Recording;
use super::three_axis::angles;
use crate::fail::Fail;

/// Most points of a curve.
const MOST_POINTS: usize = 4096;

/// Number of intervals of a torque curve over the range.
const SWEEP_INTERVALS: usize = 720;

/// The torques of one coordinate while its joint alone turns about its axis, all other joints held.
pub(crate) struct Sweep<'a> {
    model: &'a Model,
    loads: &'a [Load],
    coordinate: usize,
    posture: Posture,
    /// The body in the posture, and turned.
    body: JointTorques,
    turned: AboutAxes,
    /// By rate; angles of all coordinates.
    step: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> Sweep<'a> {
    pub(crate) fn new(model: &'a Model, loads: &'a [Load], coordinate: usize, posture: &[f64]) -> Result<Self, Fail> {
        let posture = Posture::new(posture.to_vec());
        let mut body = JointTorques::new(model);
        let passive = Quantities { passive_torque: true, ..Quantities::default() };
        body.update(model, &posture, &[], passive).map_err(|error| Fail::job("posture", error))?;
        let (turned, step) = (AboutAxes::new(model), vec![0.0; model.rates().len()]);
        Ok(Self { model, loads, coordinate, posture, body, turned, step, values: vec![0.0; model.coordinates().len()] })
    }

    /// The angles (rad, m) over which passive torque is known: the range of the coordinate, or the arc of its three-axis joint.
    pub(crate) fn range(&self) -> (f64, f64) {
        let range = self.model.coordinates()[self.coordinate].range;
        if self.model.three_axis_joint_of(self.coordinate).is_none() {
            return range;
        }
        let passive = self.body.passive_torque();
        let curve = passive.curve_about_axis(self.model, self.body.kinematics(), self.coordinate, range);
        curve.map_or(range, |curve| curve.range())
    }

    /// Passive torque at `angle` (rad), N m.
    pub(crate) fn passive(&mut self, angle: f64) -> f64 {
        let turn = angle - self.body.angles()[self.coordinate];
        let body = (self.model, self.body.kinematics());
        self.body.passive_torque().torque_after_turn(body, self.coordinate, turn, &mut self.values)
    }

    /// External and passive torque at `angle` (rad), N m.
    pub(crate) fn torques(&mut self, angle: f64) -> Result<(f64, f64), Fail> {
        let rate = self.model.coordinates()[self.coordinate].rate;
        if let Some(rate) = rate {
            self.step[rate] = angle - self.body.angles()[self.coordinate];
        }
        let turned = self.turned.update_displaced(self.model, &self.posture, &self.step, self.loads);
        turned.map_err(|error| Fail::job("posture", error))?;
        Ok((rate.map_or(0.0, |rate| self.turned.external().torques()[rate]), self.passive(angle)))
    }

    /// Angles (deg) where the true active torque is zero.
    pub(crate) fn zeros(&mut self) -> Result<Vec<f64>, Fail> {
        let (min, max) = self.range();
        let mut zeros: Vec<f64> = vec![];
        let mut before = (min, self.active(min)?);
        for i in 1..=SWEEP_INTERVALS {
            let angle = min + (max - min) * i as f64 / SWEEP_INTERVALS as f64;
            let torque = self.active(angle)?;
            if torque == 0.0 || (torque > 0.0) != (before.1 > 0.0) {
                let sweep = std::cell::RefCell::new(&mut *self);
                // Errors cannot occur here: the posture was checked above.
                let f = |angle: f64| (sweep.borrow_mut().active(angle).unwrap_or(f64::NAN), f64::NAN);
                zeros.extend(dichotomy(f, before.0, angle).map(f64::to_degrees));
            }
            before = (angle, torque);
        }
        Ok(zeros)
    }

    fn active(&mut self, angle: f64) -> Result<f64, Fail> {
        let (external, passive) = self.torques(angle)?;
        Ok(active_torque(external, passive))
    }

    /// The chart's curves; path, start, goal and sketches are the caller's.
    pub(crate) fn balance(&mut self, title: &str, subtitle: &str, tolerance: f64) -> Result<TorqueBalance, Fail> {
        let coordinate = &self.model.coordinates()[self.coordinate];
        let (min, max) = self.range();
        let mut chart = TorqueBalance {
            title: title.to_owned(),
            subtitle: subtitle.to_owned(),
            angle_label: angle_label(&coordinate.name, &coordinate.positive),
            tolerance_nm: tolerance,
            zero_torque_deg: self.zeros()?,
            ..TorqueBalance::default()
        };
        for i in 0..=SWEEP_INTERVALS {
            let angle = min + (max - min) * i as f64 / SWEEP_INTERVALS as f64;
            let (external, passive) = self.torques(angle)?;
            chart.angles_deg.push(angle.to_degrees());
            chart.external_nm.push(external);
            chart.minus_passive_nm.push(-passive);
            chart.active_nm.push(active_torque(external, passive));
        }
        Ok(chart)
    }

    /// A small drawing of the body with the coordinate at `angle_deg`.
    pub(crate) fn sketch(&mut self, label: &str, angle_deg: f64, role: SketchRole) -> Result<PostureSketch, Fail> {
        self.torques(angle_deg.to_radians())?;
        let rate = self.model.coordinates()[self.coordinate].rate;
        let (model, kinematics) = (self.model.by_axes(), self.turned.kinematics());
        let axis = rate.map_or(Vector3::z(), |rate| kinematics.axis(model, rate));
        // Look along the ground axis nearest the joint's: from the right, from behind, or from above.
        let view = |p: Vector3<f64>| match axis.iamax() {
            0 => [p.z, p.y],
            1 => [p.z, p.x],
            _ => [p.x, p.y],
        };
        let lines = sticks(model, kinematics, self.coordinate);
        let polylines = lines.into_iter().map(|line| line.into_iter().map(view).collect());
        Ok(PostureSketch { label: label.to_owned(), angle_deg, polylines: polylines.collect(), role })
    }
}

/// `elbow_flex_r, deg (flexion positive)`.
pub(crate) fn angle_label(name: &str, positive: &str) -> String {
    if positive.is_empty() { format!("{name}, deg") } else { format!("{name}, deg ({positive} positive)") }
}

/// Lines of the body: first one that runs along all that `coordinate` leaves in place, there and back, then one a segment that
/// it moves, from its joint to the joints of its children, or through its centre of mass to its end.
fn sticks(model: &Model, kinematics: &Kinematics, coordinate: usize) -> Vec<Vec<Vector3<f64>>> {
    let segments = model.segments();
    let origin = |segment| kinematics.placement(model, segment).translation.vector;
    let mut driven = vec![coordinate];
    // Independent coordinates stand before their dependent ones.
    for coupling in model.couplings() {
        if driven.contains(&coupling.independent) {
            driven.push(coupling.dependent);
        }
    }
    let mut moved: Vec<bool> = vec![];
    for segment in segments {
        let carried = segment.parent.is_some_and(|parent| moved[parent]);
        moved.push(carried || segment.coordinates.clone().any(|c| driven.contains(&c)));
    }
    let ends = |s: usize| -> Vec<(Option<usize>, Vector3<f64>)> {
        let children = (0..segments.len()).filter(|&c| segments[c].parent == Some(s));
        let joints: Vec<_> = children.map(|c| (Some(c), origin(c))).collect();
        let tip = || vec![(None, kinematics.station(model, s, 2.0 * segments[s].center_of_mass))];
        if joints.is_empty() { tip() } else { joints }
    };
    let mut still = vec![];
    // A walk through the tree: a segment is entered, or come back to.
    let mut waiting: Vec<(Option<usize>, Vector3<f64>)> = vec![];
    for root in (0..segments.len()).filter(|&s| segments[s].parent.is_none() && !moved[s]) {
        waiting.push((Some(root), origin(root)));
        while let Some((segment, at)) = waiting.pop() {
            still.push(at);
            for (child, end) in segment.filter(|&s| !moved[s]).into_iter().flat_map(ends) {
                waiting.extend([(None, at), (child, end)]);
            }
        }
    }
    let mut lines = vec![still];
    for s in (0..segments.len()).filter(|&s| moved[s]) {
        let away = ends(s).into_iter().filter(|(_, end)| (end - origin(s)).norm() > 1e-9);
        lines.extend(away.map(|(_, end)| vec![origin(s), end]));
    }
    lines
}

/// One coordinate over time, thinned to the points that a picture can show, with its reliefs.
pub(crate) fn course(model: &Model, recording: &Recording, log: &ReliefLog, coordinate: usize) -> TimeLine {
    let mut line = TimeLine::default();
    let rows = recording.times().len();
    let stride = rows.div_ceil(MOST_POINTS).max(1);
    // The end is always drawn.
    for row in (0..rows).filter(|row| row % stride == 0 || row + 1 == rows).map(|row| recording.row(row)) {
        line.time_s.push(row.time);
        line.angle_deg.push(angles(model, row.posture)[coordinate].to_degrees());
        line.external_nm.push(row.external[coordinate]);
        line.passive_nm.push(row.passive[coordinate]);
        line.active_nm.push(row.active(coordinate));
        line.fatigue_positive.push(row.fatigue[coordinate][0]);
        line.fatigue_negative.push(row.fatigue[coordinate][1]);
    }
    let records: Vec<&ReliefRecord> = log.records.iter().filter(|record| record.coordinate == coordinate).collect();
    let mut case = "";
    for (i, record) in records.iter().take(MOST_POINTS).enumerate() {
        let now = record.decision.map_or("waits", |decision| decision.case.number());
        if now != case {
            line.events.push((record.time.0, now.to_owned()));
            case = now;
        }
        let last = line.time_s.last().copied().unwrap_or_default();
        if record.time.1 < records.get(i + 1).map_or(last, |next| next.time.0) {
            line.events.push((record.time.1, "rested".to_owned()));
            case = "rested";
        }
    }
    line
}
