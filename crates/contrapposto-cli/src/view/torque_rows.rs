//! External, passive and active torque of one frame, and in which order and under which names they are told.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, Gradient, Load};
use nalgebra::Vector3;

use crate::model_file::Tissue;

/// Everything that is computed of a posture.
pub(crate) struct Statics {
    kinematics: Kinematics,
    external: ExternalTorque,
    gradient: Option<Gradient>,
    tissue: Tissue,
    /// By rate, as if nothing were coupled, and folded.
    raw_passive: Vec<f64>,
    passive: Vec<f64>,
}

/// The three torques of one rate, N m (N for slides), which add up to zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torques {
    pub(crate) external: f64,
    pub(crate) passive: f64,
    pub(crate) active: f64,
}

impl Torques {
    pub(crate) fn new(external: f64, passive: f64) -> Self {
        // Not the negative of the sum: that of 0 would be -0.
        Self { external, passive, active: 0.0 - (external + passive) }
    }
}

/// One rate that is told.
pub(crate) struct Row {
    /// `knee_angle_r`, `root_fx`, `root_mz`.
    pub(crate) name: String,
    /// Index of the rate.
    pub(crate) rate: usize,
    /// It turns: N m, otherwise N.
    pub(crate) turns: bool,
    /// The coordinate of the same name, if it has one.
    pub(crate) coordinate: Option<usize>,
}

/// What is told of every frame, in which order.
pub(crate) struct Order {
    /// Rates of coordinates that follow none.
    pub(crate) rows: Vec<Row>,
    /// Rates that a coupling joins.
    pub(crate) coupled: Vec<Row>,
    /// Coordinates whose value has no place in `rows` or `coupled`: those of free joints and balls.
    pub(crate) values: Vec<usize>,
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
    pub(crate) center_of_mass: Option<Vector3<f64>>,
    /// Rows and columns by `Order::rows`.
    pub(crate) gradient: Option<Vec<Vec<f64>>>,
}

impl Order {
    pub(crate) fn new(model: &Model) -> Self {
        let coordinates = model.coordinates();
        let is_coupled = |c: usize| model.couplings().iter().any(|k| k.dependent == c || k.independent == c);
        let mut order = Self { rows: vec![], coupled: vec![], values: vec![] };
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

impl Statics {
    pub(crate) fn new(model: &Model, tissue: Tissue, gradient: bool) -> Self {
        Self {
            kinematics: Kinematics::new(model),
            external: ExternalTorque::new(model),
            gradient: gradient.then(|| Gradient::new(model)),
            tissue,
            raw_passive: vec![0.0; model.rates().len()],
            passive: vec![0.0; model.rates().len()],
        }
    }

    pub(crate) fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Brings the body to a posture, with its passive torque.
    pub(crate) fn place(&mut self, model: &Model, posture: &Posture) -> Result<(), String> {
        self.kinematics.update(model, posture).map_err(|error| error.to_string())?;
        let values = self.kinematics.values();
        self.tissue.place(values);
        for (index, coordinate) in model.coordinates().iter().enumerate() {
            let Some(rate) = coordinate.rate else { continue };
            let torque = self.tissue.torque(model, index);
            if !torque.is_finite() {
                let (name, value) = (&coordinate.name, values[index]);
                return Err(format!("the passive torque of `{name}` at {value} rad is {torque}"));
            }
            self.raw_passive[rate] = torque;
        }
        self.kinematics.fold_couplings(model, &self.raw_passive, &mut self.passive);
        Ok(())
    }

    /// Lets gravity and `loads` pull.
    pub(crate) fn pull(&mut self, model: &Model, loads: &[Load]) -> Result<(), String> {
        self.external.update(model, &self.kinematics, loads).map_err(|error| error.to_string())?;
        if let Some(gradient) = &mut self.gradient {
            self.external.gradient(model, &self.kinematics, gradient);
        }
        Ok(())
    }

    pub(crate) fn frame(&self, model: &Model, order: &Order, index: usize, time: f64) -> Frame<'_> {
        let (folded, raw) = (self.external.torques(), self.external.uncoupled_torques(model));
        let torques = |rows: &[Row], external: &[f64], passive: &[f64]| -> Vec<Torques> {
            rows.iter().map(|row| Torques::new(external[row.rate], passive[row.rate])).collect()
        };
        let rates: Vec<usize> = order.rows.iter().map(|row| row.rate).collect();
        let matrix = |gradient: &Gradient| {
            rates.iter().map(|&i| rates.iter().map(|&j| gradient.get(i, j)).collect()).collect::<Vec<Vec<f64>>>()
        };
        Frame {
            index,
            time,
            values: self.kinematics.values(),
            rows: torques(&order.rows, folded, &self.passive),
            coupled: torques(&order.coupled, raw, &self.raw_passive),
            center_of_mass: self.kinematics.center_of_mass(model),
            gradient: self.gradient.as_ref().map(matrix),
        }
    }
}
