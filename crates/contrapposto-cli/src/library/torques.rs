//! Computes external, passive and active torque of postures at rest, in the order and to the last bit of `contrapposto torques`.

use contrapposto::joint_torques::{JointMuscles, JointTorques, JointTorquesError, Quantities};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto_formats::tissue::SourcedModel;

use crate::view::torque_rows::{Order, Torques};

/// One torque: its name and unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TorqueRow {
    /// The coordinate's name; `root_fx`, `root_mz` of a free root.
    pub name: String,
    /// N m, otherwise N.
    pub turns: bool,
}

/// Space for the torques of one posture of a model.
pub struct RestTorques {
    body: JointTorques,
    posture: Posture,
    rates: Vec<usize>,
}

impl RestTorques {
    /// The torques of a model, in their order.
    pub fn rows(model: &Model) -> Vec<TorqueRow> {
        Order::new(model).rows.into_iter().map(|row| TorqueRow { name: row.name, turns: row.turns }).collect()
    }

    /// Space for a model and its muscles.
    pub fn new(opened: &SourcedModel, muscles: Option<&JointMuscles>) -> Self {
        Self {
            body: JointTorques::with_passive_ranges(&opened.model, &opened.passive_ranges())
                .with_muscles(muscles.cloned()),
            posture: opened.model.default_posture(),
            rates: Order::new(&opened.model).rows.iter().map(|row| row.rate).collect(),
        }
    }

    /// Computes the torques of a posture (rad, m) under loads and the generalised forces of a `device` (N m, N; empty for none), which
    /// count as external torque, and writes external, passive and active torque into `out`.
    ///
    /// # Errors
    /// [`JointTorquesError`] names the coordinate or load that does not fit.
    ///
    /// # Panics
    /// When a slice has another length than the model needs.
    pub fn update(
        &mut self,
        model: &Model,
        values: &[f64],
        loads: &[Load],
        device: &[f64],
        out: [&mut [f64]; 3],
    ) -> Result<(), JointTorquesError> {
        self.posture.values_mut().copy_from_slice(values);
        let [of_external, of_passive, of_active] = out;
        self.body.place(model, &self.posture)?;
        // One after the other: together they would come with torques about the axes of three-axis joints, which take as long again.
        self.body.apply(model, &[], Quantities { passive_torque: true, ..Quantities::default() })?;
        let passive = self.body.passive_torque().torques();
        self.rates.iter().zip(&mut *of_passive).for_each(|(&rate, torque)| *torque = passive[rate]);
        self.body.apply(model, loads, Quantities { external_torque: true, ..Quantities::default() })?;
        let external = self.body.external_torque().torques();
        for (row, &rate) in self.rates.iter().enumerate() {
            // Adding 0 where there is no device would turn -0 into 0, which the program prints.
            let torque = device.get(row).map_or(external[rate], |device| external[rate] + device);
            let torques = Torques::new(torque, of_passive[row]);
            of_external[row] = torques.external;
            of_active[row] = torques.active;
        }
        Ok(())
    }

    /// Computes `d external_i / d q_j` (N m or N, per rad or m) of a posture, and writes it into `out`, row by row.
    ///
    /// # Errors
    /// As [`RestTorques::update`].
    ///
    /// # Panics
    /// As [`RestTorques::update`].
    pub fn gradient(
        &mut self,
        model: &Model,
        values: &[f64],
        loads: &[Load],
        out: &mut [f64],
    ) -> Result<(), JointTorquesError> {
        self.posture.values_mut().copy_from_slice(values);
        let quantities = Quantities { gradient: true, ..Quantities::default() };
        self.body.update(model, &self.posture, loads, quantities)?;
        let gradient = self.body.gradient();
        for (&row, out) in self.rates.iter().zip(out.chunks_exact_mut(self.rates.len().max(1))) {
            self.rates.iter().zip(out).for_each(|(&column, entry)| *entry = gradient.get(row, column));
        }
        Ok(())
    }
}
