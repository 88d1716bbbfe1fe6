//! Computes the centre of mass of the whole body and its Jacobian.
//!
//! Mass `m_d` and first moment `M_d = sum m_i x_i` of everything at and beyond mobility `d` are carried to the root once. A hinge
//! `r` through `p_d` then moves the centre by `r x (M_d - m_d p_d) / m`, a slide by `r m_d / m`.

use nalgebra::Vector3;

use super::Kinematics;
use super::jacobian::Columns;
use crate::model::{Model, Motion};

/// The weight at and beyond one mobility, in ground axes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Carried {
    pub(crate) mass: f64,
    /// Mass times position, kg m.
    pub(crate) first_moment: Vector3<f64>,
}

impl Carried {
    #[inline]
    fn add(&mut self, other: Self) {
        self.mass += other.mass;
        self.first_moment += other.first_moment;
    }
}

/// Centre of mass of the whole body. Depends on the posture only; filled by [`CenterOfMass::update`].
#[derive(Clone, Debug)]
pub struct CenterOfMass {
    carried: Vec<Carried>,
    whole: Carried,
}

impl CenterOfMass {
    /// Space for `model`; a body without mass until the first update.
    pub fn new(model: &Model) -> Self {
        Self { carried: vec![Carried::default(); model.mobilities.len()], whole: Carried::default() }
    }

    /// Computes it in the posture that `kinematics` holds. Does not allocate.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics) {
        self.gather(model, kinematics);
        for i in (0..model.mobilities.len()).rev() {
            self.carry(model, i);
        }
    }

    /// Mass and first moment of each mobility itself, the start of the sums.
    pub(crate) fn gather(&mut self, model: &Model, kinematics: &Kinematics) {
        self.whole = Carried { mass: model.fixed.0, first_moment: model.fixed.1 };
        for (i, (carried, mobility)) in self.carried.iter_mut().zip(&model.mobilities).enumerate() {
            carried.mass = mobility.mass;
            carried.first_moment =
                kinematics.rotations[i] * mobility.first_moment + mobility.mass * kinematics.origins[i];
        }
    }

    /// Adds a mobility, whose own sum is complete, to its parent; answers that sum. From the last mobility to the first.
    #[inline]
    pub(crate) fn carry(&mut self, model: &Model, i: usize) -> Carried {
        let carried = self.carried[i];
        match model.mobilities[i].parent {
            Some(parent) => self.carried[parent].add(carried),
            None => self.whole.add(carried),
        }
        carried
    }

    /// The centre in ground, m; `None` for a body without mass.
    pub fn position(&self) -> Option<Vector3<f64>> {
        (self.whole.mass > 0.0).then(|| self.whole.first_moment / self.whole.mass)
    }

    /// `d centre / d rates`: 3 rows in ground axes, m/rad (m/m for slides), one column a rate, row after row, overwritten; all
    /// zero for a body without mass. Columns of coordinates that follow others are zero. Does not allocate.
    ///
    /// # Panics
    /// Unless `rows` has three times as many entries as the model has rates.
    pub fn jacobian(&self, model: &Model, kinematics: &Kinematics, rows: &mut [f64]) {
        let mut columns = Columns::over(model, kinematics, rows);
        if self.whole.mass <= 0.0 {
            return;
        }
        let share = 1.0 / self.whole.mass;
        for (i, (mobility, carried)) in model.mobilities.iter().zip(&self.carried).enumerate() {
            if let Motion::Slide(_) = mobility.motion {
                columns.add(mobility.rate, kinematics.axes[mobility.rate] * (carried.mass * share));
            } else {
                let arm = (carried.first_moment - carried.mass * kinematics.origins[i]) * share;
                for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                    columns.add(element, kinematics.axes[element].cross(&arm));
                }
            }
        }
        kinematics.fold_columns(model, rows);
    }
}
