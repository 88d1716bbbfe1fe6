//! Builds the linear program of the greatest force from a body in a posture.
//!
//! Unknowns are, each from its lower bound on: the active torque of every joint that the force or a contact force reaches, the activation of
//! every muscle, one number for every edge of the pyramid of friction at every corner (a force inside the pyramid is a sum of its edges), and the
//! force in body weights. Equations of joints are divided by their strength, those of the root by the weight. Torques of joints whose
//! strength muscles give are sums over the muscles.

use nalgebra::Vector3;

use super::available::Demand;
use super::pulls::{Pull, pulls};
use super::situation::{CapacityError, Situation, Station};
use super::tolerances::{GREATEST_EDGE_FORCE, HELD_WITHOUT_FORCE, NO_LIMIT};
use crate::contact::{ContactForces, FACES, root_rates};
use crate::joint_torques::{JointMuscles, JointTorques, Quantities};
use crate::math::LinearProgram;
use crate::model::{LARGEST, Model, Side};

/// Forces of a corner: along its normal and along two axes of its plane.
const PARTS: usize = 3;

/// Joint of an equation that has its strength alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub(super) coordinate: usize,
    /// Greatest torque of the positive and the negative group, N m.
    pub(super) strength: [f64; 2],
}

/// One equation: a rate at which torques are in equilibrium.
#[derive(Clone, Debug)]
pub(super) struct Row {
    rate: usize,
    /// Factor of the equation, 1/(N m) or 1/N.
    pub(super) scale: f64,
    /// `None` for the root, and where muscles give the torque.
    pub(super) joint: Option<Joint>,
    /// Torque per newton of force at the point, along ground axes, m.
    arm: Vector3<f64>,
}

/// A contact force of given direction at a corner.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) corner: usize,
    /// Parts along the normal and both axes of the plane, per unit of the unknown.
    pub(super) parts: [f64; PARTS],
    lower: f64,
    /// Column as it is, as it would be without friction, and as it would be at the middle of the patch.
    pub(super) column: Vec<f64>,
    pub(super) without_friction: Vec<f64>,
    pub(super) at_middle: Vec<f64>,
    /// Whether friction has a limit.
    pub(super) limited: bool,
}

/// The program with its meaning.
#[derive(Clone, Debug)]
pub(super) struct Program {
    pub(super) linear: LinearProgram,
    pub(super) cost: Vec<f64>,
    pub(super) rows: Vec<Row>,
    pub(super) muscles: Vec<Pull>,
    pub(super) edges: Vec<Edge>,
    /// Number of torques and muscles among the unknowns, which come first.
    pub(super) pulls: usize,
    /// By corner: normal and two axes of its plane, ground.
    pub(super) axes: Vec<[Vector3<f64>; PARTS]>,
    /// Unit of forces, N.
    pub(super) weight: f64,
    /// Point at which the force acts, ground, m.
    pub(super) place: Vector3<f64>,
}

impl Program {
    /// `None` where the posture cannot be held without a force.
    pub(super) fn new(
        situation: &Situation<'_>,
        station: Station,
        demand: Demand,
    ) -> Result<Option<Self>, CapacityError> {
        let Situation { model, posture, loads, supports, muscles } = *situation;
        check(model, station)?;
        let mut torques = JointTorques::new(model).with_muscles(muscles.cloned());
        torques.update(model, posture, loads, Quantities::TORQUES)?;
        let mut contact = ContactForces::new(model, supports.to_vec())?;
        let required = torques.active_torque();
        contact.update(model, torques.kinematics_by_axes(), torques.angles(), required);
        let Some(rows) = rows(situation, station, demand, &torques, &contact) else { return Ok(None) };
        let edges = edges(&contact, &rows);
        let equations: Vec<(usize, f64)> = rows.iter().map(|row| (row.rate, row.scale)).collect();
        let muscles = torques.muscles().map_or_else(Vec::new, |muscles| pulls(model, muscles, demand, &equations));
        let mut right: Vec<f64> = rows.iter().map(|row| row.scale * (required[row.rate] + row.lower())).collect();
        for edge in edges.iter().filter(|edge| edge.lower != 0.0) {
            right.iter_mut().zip(&edge.column).for_each(|(right, entry)| *right -= edge.lower * entry);
        }
        let joints: Vec<usize> = (0..rows.len()).filter(|&row| rows[row].joint.is_some()).collect();
        let mut upper: Vec<f64> = joints.iter().map(|&row| rows[row].scale * rows[row].width()).collect();
        upper.extend(muscles.iter().map(|muscle| muscle.capacity));
        upper.extend(edges.iter().map(|edge| GREATEST_EDGE_FORCE - edge.lower));
        upper.push(NO_LIMIT / contact.weight());
        let mut matrix = vec![];
        for k in 0..rows.len() {
            matrix.extend(joints.iter().map(|&joint| if joint == k { 1.0 } else { 0.0 }));
            matrix.extend(muscles.iter().map(|muscle| muscle.column[k]));
            matrix.extend(edges.iter().map(|edge| edge.column[k]));
            matrix.push(0.0);
        }
        let linear = LinearProgram::new(matrix, right, &upper);
        let mut cost = vec![0.0; upper.len()];
        cost[upper.len() - 1] = 1.0;
        let place = torques.kinematics().station(model, station.segment, station.point);
        Ok((linear.residual() <= HELD_WITHOUT_FORCE).then(|| Self {
            linear,
            cost,
            rows,
            pulls: joints.len() + muscles.len(),
            muscles,
            edges,
            axes: contact.axes().to_vec(),
            weight: contact.weight(),
            place,
        }))
    }

    /// The column of a force along `direction`.
    pub(super) fn column(&self, direction: &Vector3<f64>) -> Vec<f64> {
        self.rows.iter().map(|row| -row.scale * self.weight * row.arm.dot(direction)).collect()
    }

    /// By multipliers of the equations: the normal of a plane that no force is beyond.
    pub(super) fn normal(&self, multipliers: &[f64]) -> Vector3<f64> {
        let parts = self.rows.iter().zip(multipliers).map(|(row, y)| -y * row.scale * self.weight * row.arm);
        parts.sum::<Vector3<f64>>()
    }
}

impl Row {
    fn lower(&self) -> f64 {
        self.joint.map_or(0.0, |joint| joint.strength[Side::Negative.index()])
    }

    fn width(&self) -> f64 {
        self.joint.map_or(0.0, |joint| joint.strength.iter().sum())
    }
}

/// Whether the point is one of the model, and something limits a force.
fn check(model: &Model, station: Station) -> Result<(), CapacityError> {
    let count = model.segments().len();
    if station.segment >= count {
        return Err(CapacityError::Segment { segment: station.segment, count });
    }
    if let Some(&value) = station.point.iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
        return Err(CapacityError::Point { value });
    }
    if model.coordinates().iter().all(|coordinate| coordinate.groups.is_none()) {
        return Err(CapacityError::NoStrength { model: model.name().to_owned() });
    }
    Ok(())
}

/// The equations that the force or a contact force takes part in; `None` where another joint is too weak for its posture.
fn rows(
    situation: &Situation<'_>,
    station: Station,
    demand: Demand,
    torques: &JointTorques,
    contact: &ContactForces,
) -> Option<Vec<Row>> {
    let Situation { model, supports, .. } = *situation;
    let n = model.rates().len();
    let mut jacobian = vec![0.0; 3 * n];
    let by_axes = torques.kinematics_by_axes();
    by_axes.point_jacobian(model.by_axes(), station.segment, station.point, &mut jacobian);
    let arm = |rate: usize| Vector3::new(jacobian[rate], jacobian[n + rate], jacobian[2 * n + rate]);
    let root = if supports.is_empty() { vec![] } else { root_rates(model) };
    let root = root.into_iter().map(|rate| Row { rate, scale: contact.weight().recip(), joint: None, arm: arm(rate) });
    let mut rows: Vec<Row> = root.collect();
    let by_muscles = torques.muscles().map_or(&[][..], JointMuscles::strong);
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let (Some(rate), false) = (coordinate.rate, model.is_dependent(i)) else { continue };
        let Some(strength) = demand.torques(coordinate, torques.angles()[i]) else { continue };
        let shared = by_muscles.contains(&rate);
        let joint = (!shared).then_some(Joint { coordinate: i, strength });
        let scale = strength.iter().fold(0.0f64, |most, torque| most.max(*torque)).recip();
        let row = Row { rate, scale, joint, arm: arm(rate) };
        let reached = contact.columns().chunks_exact(n.max(1)).any(|column| column[rate] != 0.0);
        let active = torques.active_torque()[rate];
        let most = strength[Side::of(active).index()];
        // Muscles that cross several joints act on each of them.
        if shared || reached || row.arm != Vector3::zeros() {
            rows.push(row);
        } else if active.abs() > most * (1.0 + HELD_WITHOUT_FORCE) {
            return None;
        }
    }
    Some(rows)
}

/// All contact forces that supports can give, as sums of edges.
fn edges(contact: &ContactForces, rows: &[Row]) -> Vec<Edge> {
    let n = contact.torques().len().max(1);
    let all: Vec<&[f64]> = contact.columns().chunks_exact(n).collect();
    let scaled = |column: &[f64]| -> Vec<f64> { rows.iter().map(|row| row.scale * column[row.rate]).collect() };
    let mut edges = vec![];
    for (s, support) in contact.supports().iter().enumerate() {
        let corners = contact.corners(s);
        // Torque is linear in the point at which a force acts.
        let middle: [Vec<f64>; PARTS] = std::array::from_fn(|part| {
            let columns: Vec<Vec<f64>> = corners.clone().map(|corner| scaled(all[PARTS * corner + part])).collect();
            let mean = |row| columns.iter().map(|column| column[row]).sum::<f64>() / columns.len() as f64;
            (0..rows.len()).map(mean).collect()
        });
        for corner in corners {
            let own: [Vec<f64>; PARTS] = std::array::from_fn(|part| scaled(all[PARTS * corner + part]));
            edges.extend(directions(support.friction).into_iter().map(|(parts, lower)| Edge {
                corner,
                parts,
                lower,
                column: sum(&own, parts),
                without_friction: sum(&own, [parts[0], 0.0, 0.0]),
                at_middle: sum(&middle, parts),
                limited: support.friction.is_finite(),
            }));
        }
    }
    edges
}

/// Parts of the edges of a pyramid, and the lower bounds of their forces.
fn directions(friction: f64) -> Vec<([f64; PARTS], f64)> {
    if friction == 0.0 {
        return vec![([1.0, 0.0, 0.0], 0.0)];
    }
    if friction.is_infinite() {
        let least = -GREATEST_EDGE_FORCE;
        return vec![([1.0, 0.0, 0.0], 0.0), ([0.0, 1.0, 0.0], least), ([0.0, 0.0, 1.0], least)];
    }
    let most = friction / (FACES as f64 / 2.0).sqrt();
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    signs.map(|(a, b)| ([1.0, a * most, b * most], 0.0)).to_vec()
}

fn sum(columns: &[Vec<f64>; PARTS], parts: [f64; PARTS]) -> Vec<f64> {
    (0..columns[0].len()).map(|row| (0..PARTS).map(|part| parts[part] * columns[part][row]).sum()).collect()
}

impl Edge {
    /// The force itself from the unknown, which is counted from its lower bound.
    pub(super) fn force(&self, unknown: f64) -> f64 {
        self.lower + unknown
    }
}
