//! Puts passive torque and strength of a file's muscles in the place of the built-in ones.
//!
//! Built-in curves and strengths, and the passive laws of a file or an overlay, are those of whole joints: muscles stand in the place of
//! built-in ones, and nothing is added to the others. A joint of three coordinates has its passive torque from muscles about all three or
//! none.

use contrapposto::contact::root_rates;
use contrapposto::joint_torques::JointMuscles;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{MuscleGroup, data};
use contrapposto::muscle::PathGeometry;
use contrapposto::strength::Strength;

use super::origin::Origin;
use super::{ModelFormat, SourcedModel, left_out_note};
use crate::overlay::GENERAL;

/// The use of the muscles of a model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MuscleUse {
    /// None.
    Off,
    /// Strength of the joints that muscles cross.
    Strength,
    /// Passive torque of the joints that muscles, ligaments and springs along paths cross.
    Passive,
    /// Strength and passive torque.
    Both,
}

impl MuscleUse {
    /// Whether they give strength.
    pub fn gives_strength(self) -> bool {
        matches!(self, Self::Strength | Self::Both)
    }

    /// Whether they give passive torque.
    pub fn gives_passive(self) -> bool {
        matches!(self, Self::Passive | Self::Both)
    }
}

/// Kinds of left-out things that muscles in use are made of.
const OF_MUSCLES: [&str; 2] = ["muscles", "wrap objects"];
/// The kind of left-out things that only passive torque uses.
const OF_PASSIVE: &str = "ligaments, path springs and bushings";

impl SourcedModel {
    /// The use of muscles where nobody says it: both in an OpenSim model that has some.
    pub fn default_muscle_use(&self) -> MuscleUse {
        let has_muscles = self.format == ModelFormat::OpenSim && !self.muscles.muscles.is_empty();
        if has_muscles { MuscleUse::Both } else { MuscleUse::Off }
    }

    /// Leaves passive torque or strength of the joints that muscles cross to the muscles, where neither the file nor an overlay gives it. For a
    /// model that has not been filled yet ([`SourcedModel::fill`]); [`SourcedModel::joint_muscles`] computes them. Returns whether
    /// there are muscles.
    pub fn use_muscles(&mut self, uses: MuscleUse) -> bool {
        if self.muscles.muscles.is_empty() || uses == MuscleUse::Off {
            return !self.muscles.muscles.is_empty();
        }
        let geometry = PathGeometry::new(&self.model, &self.muscles.paths);
        let by_muscles = self.muscles.muscles.iter().map(|muscle| muscle.spec().path);
        let passive: Vec<usize> = self.coordinates_of(&geometry.crossed(&self.model));
        let strong = self.coordinates_of(&geometry.crossed_by(&self.model, by_muscles));
        let driven = |coordinate: &usize| self.is_driven(&geometry, *coordinate);
        let driven: Vec<usize> = passive.iter().copied().filter(driven).collect();
        let (mut given, mut kept) = (vec![], vec![]);
        for coordinate in strong.iter().copied().filter(|_| uses.gives_strength()) {
            if self.model.coordinates()[coordinate].groups.is_some() {
                kept.push(coordinate);
            } else if !driven.contains(&coordinate) {
                given.push(coordinate);
                self.origins[coordinate].strength = Origin::Muscles;
                self.add_general_groups(coordinate);
            }
        }
        for coordinate in passive.iter().copied().filter(|_| uses.gives_passive()) {
            if !self.is_open(&passive, coordinate) {
                kept.push(coordinate);
            } else if !driven.contains(&coordinate) {
                given.push(coordinate);
                self.origins[coordinate].passive = Origin::Muscles;
            }
        }
        self.tell(uses, &given, &kept, &driven);
        true
    }

    /// The muscles that [`SourcedModel::use_muscles`] left passive torque or strength to, `None` where it left nothing, and warnings about
    /// them. Writes their strength in the default posture to the model's groups. A coordinate that they leave far weaker there than
    /// `library`, the same model without its muscles, keeps the strength of `library`.
    pub fn joint_muscles(&mut self, library: &Self) -> (Option<JointMuscles>, Vec<String>) {
        let Some(mut muscles) = self.posed_muscles() else { return (None, vec![]) };
        let weak = self.weaker_than(library);
        for &(coordinate, _) in &weak {
            self.keep_strength(library, coordinate);
        }
        let warnings = self.muscle_doubts(weak);
        if let Some(fewer) = self.posed_muscles() {
            muscles = fewer;
        }
        (Some(muscles), warnings)
    }

    /// The muscles that passive torque or strength is left to, in the default posture, with their strength in the model's groups.
    fn posed_muscles(&mut self) -> Option<JointMuscles> {
        let rates = |of: &dyn Fn(usize) -> Origin| -> Vec<usize> {
            let coordinates = self.model.coordinates().iter().enumerate();
            coordinates.filter(|(i, _)| of(*i) == Origin::Muscles).filter_map(|(_, c)| c.rate).collect()
        };
        let (passive, strong) = (rates(&|i| self.origins[i].passive), rates(&|i| self.origins[i].strength));
        if passive.is_empty() && strong.is_empty() {
            return None;
        }
        let mut muscles = JointMuscles::new(&self.model, self.muscles.clone(), &passive, &strong);
        let posture = self.model.default_posture();
        // A new body is in its default posture.
        muscles.update(&self.model, &posture, &Kinematics::new(&self.model)).ok()?;
        muscles.write_strength(&mut self.model);
        Some(muscles)
    }

    /// Gives a coordinate the strength that it has in `library`.
    fn keep_strength(&mut self, library: &Self, coordinate: usize) {
        let Some(groups) = library.model.coordinates()[coordinate].groups.clone() else { return };
        self.model = self.model.clone().with_groups(coordinate, groups);
        self.origins[coordinate].strength = library.origins[coordinate].strength;
        self.origins[coordinate].fatigue = library.origins[coordinate].fatigue;
    }

    /// The coordinates of rates.
    fn coordinates_of(&self, rates: &[usize]) -> Vec<usize> {
        rates.iter().filter_map(|&rate| self.model.rates()[rate].coordinate).collect()
    }

    /// Whether a coordinate of the same three-axis joint changes the length of a path by itself: the moment about the joint's axes is
    /// then not that of the tensions.
    fn is_driven(&self, geometry: &PathGeometry, coordinate: usize) -> bool {
        let joint = self.model.three_axis_joint_of(coordinate);
        let of = |(joint, _): (usize, usize)| self.model.three_axis_joints()[joint].coordinates;
        joint.map(of).is_some_and(|all| all.iter().any(|&c| geometry.drives(c)))
    }

    /// Whether the passive torque of a coordinate can be left to muscles: its joint has no passive law.
    fn is_open(&self, crossed: &[usize], coordinate: usize) -> bool {
        let open = |c: &usize| crossed.contains(c) && self.model.coordinates()[*c].passive.is_none();
        let joint = self.model.three_axis_joint_of(coordinate);
        let alone = [coordinate];
        let all = joint.map_or(&alone[..], |(joint, _)| &self.model.three_axis_joints()[joint].coordinates);
        all.iter().all(open)
    }

    /// Groups with the general parameters of fatigue, until the built-in data know better ones.
    fn add_general_groups(&mut self, coordinate: usize) {
        let Some((fatigue, _)) = data::library().three_compartment(GENERAL) else { return };
        let name = &self.model.coordinates()[coordinate].name;
        let groups = ["positive", "negative"].map(|side| MuscleGroup {
            name: format!("{name}, {side}"),
            // The strength of a posture is written over it.
            strength: Strength::constant(1.0),
            fatigue: fatigue.clone(),
        });
        self.origins[coordinate].fatigue = Origin::Library;
        self.model = self.model.clone().with_groups(coordinate, groups);
    }

    /// Notes what the muscles give, and what they do not although they could.
    fn tell(&mut self, uses: MuscleUse, given: &[usize], kept: &[usize], driven: &[usize]) {
        let used = |kind: &str| OF_MUSCLES.contains(&kind) || (kind == OF_PASSIVE && uses.gives_passive());
        let before = left_out_note(&self.left_out);
        let left_out: Vec<_> = self.left_out.iter().filter(|(kind, _)| !used(kind)).cloned().collect();
        self.notes.retain(|note| before.as_ref() != Some(note));
        self.notes.splice(0..0, left_out_note(&left_out));
        let what = match uses {
            MuscleUse::Strength => "strength",
            MuscleUse::Passive => "passive torque",
            _ => "strength and passive torque",
        };
        let root = root_rates(&self.model);
        let turns = |rate: usize| self.model.rates()[rate].rotational && !root.contains(&rate);
        let turning = |i: &usize| self.model.coordinates()[*i].rate.is_some_and(turns);
        let all = 0..self.model.coordinates().len();
        let others: Vec<usize> =
            all.filter(turning).filter(|i| !given.contains(i) && !self.model.is_dependent(*i)).collect();
        let rest = if others.is_empty() {
            String::new()
        } else {
            format!("; {} keep what they have without muscles", self.names(&others))
        };
        self.notes.push(format!(
            "{what} of the joints that the model's {} muscles cross are theirs in each posture (derived; strength is a plain sum), in place of \
             the built-in data{rest}. Muscles have no joint capsule and fascia, so that passive torque may be less than a joint's. \
             --muscles off, in a scenario `muscles = \"off\"`, leaves them out",
            self.muscles.muscles.len(),
        ));
        if !kept.is_empty() {
            let names = self.names(kept);
            self.notes.push(format!(
                "muscles cross {names}, whose joints have a passive law or strength of their own in the file or overlay: those count, and \
                 muscles are not added to them"
            ));
        }
        if !driven.is_empty() {
            self.notes.push(format!(
                "muscles give nothing about {}: points of their paths move with coordinates of that three-axis joint, and the moment about \
                 its axes is not known then",
                self.names(driven)
            ));
        }
    }

    /// The names of coordinates, at most twelve.
    fn names(&self, coordinates: &[usize]) -> String {
        let mut names: Vec<String> = vec![];
        for &i in coordinates {
            let name = format!("`{}`", self.model.coordinates()[i].name);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let more = if names.len() > 12 { ", ..." } else { "" };
        names.truncate(12);
        names.join(", ") + more
    }
}
