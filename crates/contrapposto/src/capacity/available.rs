//! Computes the torque that a muscle group can give for a time, in people of different strength.

use crate::fatigue::FatigueLaw;
use crate::model::data::library;
use crate::model::{Coordinate, MuscleGroup, Side};

/// The people whose strength counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum People {
    /// The mean person, with the law of fatigue of the model.
    #[default]
    Mean,
    /// One standard deviation of strength below the mean, with the published law that leaves least.
    Weaker,
    /// One above, with the law that leaves most: between these are two of three people, by the laws of [`crate::verdict::spread`].
    Stronger,
}

/// The force that is asked for: how long it is held, and by whom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Time for which rested groups hold the force, s; `None` for an instant.
    pub hold: Option<f64>,
    /// By whom.
    pub people: People,
}

impl Demand {
    /// Greatest torque of both groups of a coordinate at an angle (rad), N m; `None` where no strength is known.
    pub(super) fn torques(self, coordinate: &Coordinate, angle: f64) -> Option<[f64; 2]> {
        let groups = coordinate.groups.as_ref()?;
        Some(Side::BOTH.map(|side| {
            let group = &groups[side.index()];
            group.strength.torque(angle) * self.share(group)
        }))
    }

    /// Share of the mean person's strength that a group can give.
    pub(super) fn share(self, group: &MuscleGroup) -> f64 {
        let held = |law: &FatigueLaw| self.hold.map_or(1.0, |seconds| law.load_held_for(seconds));
        let own = held(&group.fatigue);
        let library = library();
        let variation = library.strength_variation(&group.name).map_or(0.0, |(coefficient, _)| coefficient);
        let laws = library.published_laws(&group.name);
        let shares = laws.iter().map(held);
        match self.people {
            People::Mean => own,
            People::Weaker => (1.0 - variation) * shares.fold(own, f64::min),
            People::Stronger => (1.0 + variation) * shares.fold(own, f64::max),
        }
    }
}
