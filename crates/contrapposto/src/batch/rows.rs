//! Assigns the rows of a table of results to quantities.

use super::kernel::PLACEMENT_ROWS;
use super::lanes::Lanes;
use crate::model::Model;

/// The rows of a table of results: torques, centre of mass and placements; then, where they are wanted, external, passive and active
/// torque about axes, relative loads and effort; then the gradient.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    pub(super) rates: usize,
    coordinates: usize,
    placements: usize,
    pub(super) active_torque: bool,
    pub(super) gradient: bool,
    /// Number of all of them.
    pub(super) count: usize,
}

impl Rows {
    pub(super) fn new(model: &Model, placements: usize, active_torque: bool, gradient: bool) -> Self {
        let (rates, coordinates) = (model.rates.len(), model.coordinates.len());
        let mut rows = Self { rates, coordinates, placements, active_torque, gradient, count: 0 };
        rows.count = rows.gradient_row() + if gradient { rates * rates } else { 0 };
        rows
    }

    pub(super) fn center_of_mass(&self) -> usize {
        self.rates
    }

    pub(super) fn placement(&self, which: usize) -> usize {
        self.rates + 3 + PLACEMENT_ROWS * which
    }

    /// First row of external torque about axes.
    pub(super) fn external_about_axes(&self) -> usize {
        self.placement(self.placements)
    }

    pub(super) fn passive_about_axes(&self) -> usize {
        self.external_about_axes() + self.rates
    }

    pub(super) fn active(&self) -> usize {
        self.passive_about_axes() + self.rates
    }

    pub(super) fn loads(&self) -> usize {
        self.active() + self.rates
    }

    pub(super) fn effort(&self) -> usize {
        self.loads() + self.coordinates
    }

    pub(super) fn gradient_row(&self) -> usize {
        if self.active_torque { self.effort() + 1 } else { self.external_about_axes() }
    }

    /// Torques, centre of mass, placements and all other rows of a block.
    pub(super) fn split<'a>(
        &self,
        rows: &'a mut [Lanes],
    ) -> (&'a mut [Lanes], &'a mut [Lanes], &'a mut [Lanes], &'a mut [Lanes]) {
        let (torques, rows) = rows.split_at_mut(self.rates);
        let (center_of_mass, rows) = rows.split_at_mut(3);
        let (placements, rest) = rows.split_at_mut(PLACEMENT_ROWS * self.placements);
        (torques, center_of_mass, placements, rest)
    }

    /// Of all other rows: external, passive and active torque about axes, relative loads, effort.
    pub(super) fn split_active_torque<'a>(&self, rest: &'a mut [Lanes]) -> [&'a mut [Lanes]; 5] {
        let (external, rest) = rest.split_at_mut(self.rates);
        let (passive, rest) = rest.split_at_mut(self.rates);
        let (active, rest) = rest.split_at_mut(self.rates);
        let (loads, rest) = rest.split_at_mut(self.coordinates);
        [external, passive, active, loads, &mut rest[..1]]
    }

    /// Of all other rows: those of the gradient.
    pub(super) fn split_gradient<'a>(&self, rest: &'a mut [Lanes]) -> &'a mut [Lanes] {
        &mut rest[self.gradient_row() - self.external_about_axes()..]
    }
}
