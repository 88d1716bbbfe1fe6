//! External, passive and active torque of one frame, and the order and names of their rows.

use contrapposto::dynamics::Inertia;
use contrapposto::joint_torques::{JointTorques, active_torque, effort};
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::statics::Gradient;
use contrapposto_formats::ReactionText;
use nalgebra::Vector3;

use super::moment::{Moment, MomentJoint, loads};

/// The three torques of one coordinate or rate, N m (N for slides), which add up to zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torques {
    pub(crate) external: f64,
    pub(crate) passive: f64,
    pub(crate) active: f64,
    /// The part of the external torque that inertia gives; none of a posture at rest.
    pub(crate) inertia: Option<f64>,
}

impl Torques {
    pub(crate) fn new(external: f64, passive: f64) -> Self {
        // Adding 0 turns -0, the active torque of no torques, into 0.
        Self { external, passive, active: active_torque(external, passive) + 0.0, inertia: None }
    }
}

/// A rate, its name and its unit.
pub(crate) struct Row {
    /// `knee_angle_r`, `root_fx`, `root_mz`.
    pub(crate) name: String,
    /// Index of the rate.
    pub(crate) rate: usize,
    /// The rate is a rotation: N m, otherwise N.
    pub(crate) turns: bool,
    /// The coordinate of the same name, if it has one.
    pub(crate) coordinate: Option<usize>,
}

/// The rows of every frame, in their order.
pub(crate) struct Order {
    /// Rates of coordinates that follow none.
    pub(crate) rows: Vec<Row>,
    /// Rates that a coupling joins.
    pub(crate) coupled: Vec<Row>,
    /// Coordinates whose value has no place in `rows` or `coupled`: those of free joints and balls.
    pub(crate) values: Vec<usize>,
    /// Joints that are judged by their moment.
    pub(crate) joints: Vec<MomentJoint>,
}

/// One frame.
pub(crate) struct Frame<'a> {
    pub(crate) index: usize,
    pub(crate) time: f64,
    /// By coordinate.
    pub(crate) values: &'a [f64],
    /// By `Order::rows` and `Order::coupled`.
    pub(crate) rows: Vec<Torques>,
    pub(crate) coupled: Vec<Torques>,
    /// Sum of squares of relative loads.
    pub(crate) effort: f64,
    /// By `Order::joints`.
    pub(crate) moments: Vec<Moment>,
    pub(crate) center_of_mass: Option<Vector3<f64>>,
    /// Rows and columns by `Order::rows`.
    pub(crate) gradient: Option<Vec<Vec<f64>>>,
    /// Single muscles, of a body whose muscles give joints their strength.
    pub(crate) muscles: Option<MusclesOfFrame>,
}

/// Single muscles of a frame.
pub(crate) struct MusclesOfFrame {
    /// Names and tensions, N.
    pub(crate) tensions: Vec<(String, f64)>,
    /// The coordinate at which the muscles lack the greatest torque, and this torque, N m.
    pub(crate) lack: Option<(String, f64)>,
    /// By joint that muscles cross.
    pub(crate) reactions: Vec<(String, ReactionText)>,
}

impl Order {
    pub(crate) fn new(model: &Model) -> Self {
        let coordinates = model.coordinates();
        let is_coupled = |c: usize| model.couplings().iter().any(|k| k.dependent == c || k.independent == c);
        let mut order = Self { rows: vec![], coupled: vec![], values: vec![], joints: MomentJoint::all(model) };
        for (index, rate) in model.rates().iter().enumerate() {
            let row = |name: String, coordinate| Row { name, rate: index, turns: rate.rotational, coordinate };
            match rate.coordinate {
                None => order.rows.push(row(rate.name.clone(), None)),
                Some(c) => match force_name(model, c) {
                    Some(name) => order.rows.push(row(name, None)),
                    None => {
                        if is_coupled(c) {
                            order.coupled.push(row(rate.name.clone(), Some(c)));
                        }
                        if !model.is_dependent(c) {
                            order.rows.push(row(rate.name.clone(), Some(c)));
                        }
                    }
                },
            }
        }
        order.values = (0..coordinates.len())
            .filter(|&c| coordinates[c].kind == CoordinateKind::Quaternion || force_name(model, c).is_some())
            .collect();
        order
    }
}

/// `root_fx` for the slide `root_tx` of a joint that has a ball as well.
fn force_name(model: &Model, coordinate: usize) -> Option<String> {
    let name = &model.coordinates()[coordinate].name;
    let (joint, axis) =
        ["x", "y", "z"].iter().find_map(|axis| Some((name.strip_suffix(&format!("_t{axis}"))?, axis)))?;
    let ball = model.coordinate(&format!("{joint}_qw"))?;
    let free = model.coordinates()[ball].kind == CoordinateKind::Quaternion;
    free.then(|| format!("{joint}_f{axis}"))
}

impl<'a> Frame<'a> {
    /// The torques of `body` in the order in which they are printed.
    pub(crate) fn new(body: &'a JointTorques, model: &Model, order: &Order, (index, time): (usize, f64)) -> Self {
        let (external, passive) = (body.external_torque(), body.passive_torque());
        let torques = |rows: &[Row], external: &[f64], passive: &[f64]| -> Vec<Torques> {
            rows.iter().map(|row| Torques::new(external[row.rate], passive[row.rate])).collect()
        };
        Self {
            index,
            time,
            values: body.kinematics().values(),
            rows: torques(&order.rows, external.torques(), passive.torques()),
            coupled: torques(&order.coupled, external.uncoupled_torques(model), passive.uncoupled_torques()),
            effort: effort(&loads(model, body)),
            moments: order.joints.iter().map(|joint| joint.moment(model, body)).collect(),
            center_of_mass: body.kinematics().center_of_mass(model),
            gradient: None,
            muscles: None,
        }
    }

    /// With the part of the external torque that inertia gives.
    pub(crate) fn with_inertia(mut self, inertia: &Inertia, model: &Model, order: &Order) -> Self {
        let parts = [
            (&mut self.rows, &order.rows, inertia.torques()),
            (&mut self.coupled, &order.coupled, inertia.uncoupled_torques(model)),
        ];
        for (torques, rows, inertia) in parts {
            for (torques, row) in torques.iter_mut().zip(rows) {
                torques.inertia = Some(inertia[row.rate]);
            }
        }
        self
    }

    /// With the gradient of external torque.
    pub(crate) fn with_gradient(self, gradient: &Gradient, order: &Order) -> Self {
        let rates: Vec<usize> = order.rows.iter().map(|row| row.rate).collect();
        let matrix = rates.iter().map(|&i| rates.iter().map(|&j| gradient.get(i, j)).collect()).collect();
        Self { gradient: Some(matrix), ..self }
    }
}
