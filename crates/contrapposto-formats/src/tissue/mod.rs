//! Completes models of other programs with passive torque and strength, and keeps the origin of every number.
//!
//! Published models hold no passive torque of most joints and no strength. [`SourcedModel`] reads a model file, lays an overlay over
//! it ([`SourcedModel::lay_over`]) and fills in what is still missing from the built-in data ([`SourcedModel::fill`]).

mod built_in;
mod fatigue;
mod fill;
mod hip_tracts;
mod muscle_doubts;
mod muscles;
mod origin;
mod person;
mod plausible;
mod scenario_muscles;

pub use fatigue::{FatigueChoice, FatigueParametersText, FatigueSex, fatigue_notes};
pub use hip_tracts::HipTissue;
pub use muscles::MuscleUse;
pub use origin::{Origin, Origins};
pub use person::Person;
pub use scenario_muscles::ScenarioMuscles;

use contrapposto::model::{Adult, AdultError, Model, Sex, adult};
use contrapposto::muscle::Musculature;

use crate::adult_text::credited;
use crate::input_error::InputError;
use crate::markers::ModelMarker;
use crate::model_file::{ModelFileError, ModelFormat, read_model, read_model_with};
use crate::model_ir::{Imported, MuscleTally, RootAttachment};
use crate::overlay::overlay;

/// A model, and the origin of its numbers.
#[derive(Clone, Debug)]
pub struct SourcedModel {
    /// The model.
    pub model: Model,
    /// Format of its file.
    pub format: ModelFormat,
    /// Sex of the body; `None` where nobody says it, and strength and passive torque of the library are a man's.
    pub sex: Option<Sex>,
    /// The size of the built-in adult that the file says it holds.
    pub credited: Option<Adult>,
    /// Markers and sites of its file.
    pub markers: Vec<ModelMarker>,
    /// Coordinates whose range is a hard limit of the file, with it, rad or m.
    pub hard_limits: Vec<(usize, (f64, f64))>,
    /// The muscles of its file.
    pub muscles: Musculature,
    /// The fate of the file's muscles.
    pub muscle_tally: MuscleTally,
    /// By coordinate.
    pub origins: Vec<Origins>,
    /// The kinds of things that the file holds and this model does not, with their numbers.
    pub left_out: Vec<(String, usize)>,
    /// The parts that were ignored, changed or filled in, one sentence each.
    pub notes: Vec<String>,
}

impl SourcedModel {
    /// Reads a model file: [`read_model`].
    ///
    /// ```
    /// use contrapposto_formats::tissue::{Person, SourcedModel};
    /// let urdf = r#"<robot name="arm">
    ///   <link name="base"/>
    ///   <link name="forearm"><inertial><mass value="1.5"/>
    ///     <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
    ///   <joint name="elbow_flex_r" type="revolute"><parent link="base"/><child link="forearm"/>
    ///     <axis xyz="0 0 1"/><limit lower="0" upper="2.5" effort="0" velocity="0"/></joint>
    /// </robot>"#;
    /// let no_includes = &mut |_: &str| Err("none".to_owned());
    /// let file = SourcedModel::read("arm.urdf", urdf.as_bytes(), None, no_includes)?;
    /// let filled = file.fill(&Person::default())?;
    /// // A URDF file has gravity along -z, so that its axes are not known to be OpenSim's.
    /// assert!(filled.model.coordinates()[0].passive.is_none());
    /// assert!(filled.notes.iter().any(|note| note.contains("the built-in one is not applied")));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`read_model`].
    pub fn read(
        name: &str,
        bytes: &[u8],
        root: Option<RootAttachment>,
        include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ModelFileError> {
        read_model(name, bytes, root, include).map(Self::imported)
    }

    /// Reads a model file for questions in which mass has no part: a body whose mass comes from a mesh has none, and a note reports it.
    ///
    /// # Errors
    /// As [`read_model`].
    pub fn read_without_mesh_mass(
        name: &str,
        bytes: &[u8],
        root: Option<RootAttachment>,
        include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ModelFileError> {
        read_model_with(name, bytes, (root, true), include).map(Self::imported)
    }

    fn imported((imported, format): (Imported, ModelFormat)) -> Self {
        let origins = vec![Origins::default(); imported.model.coordinates().len()];
        let mut notes = imported.notes;
        notes.splice(0..0, left_out_note(&imported.left_out));
        notes.extend(strength_note(&imported.model, format));
        let Imported { model, markers, hard_limits, muscles, muscle_tally, left_out, credits, .. } = imported;
        let credited = credits.as_deref().and_then(credited);
        let sex = None;
        Self { model, markers, hard_limits, muscles, muscle_tally, format, credited, sex, origins, left_out, notes }
    }

    /// The model without the strength that its file gives to motors; its notes no longer tell of it. For a model file as it was read.
    #[must_use]
    pub fn without_strength(mut self) -> Self {
        if self.model.coordinates().iter().any(|coordinate| coordinate.groups.is_some()) {
            self.model = self.model.without_groups();
            self.notes.retain(|note| !note.starts_with(STRENGTH_NOTE));
        }
        self
    }

    /// The built-in adult.
    ///
    /// # Errors
    /// [`AdultError`] when the size is not that of an adult.
    pub fn adult(size: &Adult) -> Result<Self, AdultError> {
        let model = adult(size)?;
        let library = Origin::Library;
        let origins = model.coordinates().iter().map(|coordinate| {
            let (twin, meant) = (Some(coordinate.name.clone()), Some(coordinate.range));
            Origins {
                twin,
                meant,
                turned: false,
                range: library,
                passive: library,
                strength: library,
                fatigue: library,
            }
        });
        let origins = origins.collect();
        let (sex, credited, left_out, notes) = (Some(size.sex), None, vec![], vec![]);
        let (muscles, muscle_tally) = (Musculature::default(), MuscleTally::default());
        let format = ModelFormat::Adult;
        let (markers, hard_limits) = (vec![], vec![]);
        Ok(Self { origins, model, markers, hard_limits, muscles, muscle_tally, format, credited, sex, left_out, notes })
    }

    /// Lays the overlay in `bytes` over the model: [`overlay`].
    ///
    /// # Errors
    /// [`InputError`] says what is wrong, where, and what would be right.
    pub fn lay_over(mut self, name: &str, bytes: &[u8]) -> Result<Self, InputError> {
        let laid = overlay(name, bytes, self.model)?;
        for change in laid.changes {
            let limit = self.hard_limits.iter_mut().find(|(index, _)| *index == change.coordinate && change.range);
            if let Some((index, range)) = limit {
                *range = laid.model.coordinates()[*index].range;
            }
            let origins = &mut self.origins[change.coordinate];
            for (changed, origin) in [
                (change.range, &mut origins.range),
                (change.passive, &mut origins.passive),
                (change.strength, &mut origins.strength),
                (change.fatigue, &mut origins.fatigue),
            ] {
                if changed {
                    *origin = Origin::Overlay;
                }
            }
            self.notes.push(change.note);
        }
        self.model = laid.model;
        Ok(self)
    }

    /// Fills in passive laws and muscle groups that the model does not have, from the built-in adult, by the standard OpenSim names.
    /// A coordinate is filled where its turning axis lies along that of the adult's (or against it; its curve runs the other way
    /// then) and gravity acts along -y; a note says of each what was filled, or why not. Strength and passive torque are those of an
    /// adult of the size of `person`. The adult itself stays as it is. A file of this program that holds the built-in adult, and says so in its
    /// `credits`, is that adult again where `person` says nothing else.
    ///
    /// # Errors
    /// [`AdultError`] when `person` has no adult's size.
    pub fn fill(mut self, person: &Person) -> Result<Self, AdultError> {
        if self.format == ModelFormat::Adult {
            return Ok(self);
        }
        let own = built_in::verified(self.credited.as_ref(), &self.model).filter(|_| *person == Person::default());
        if let Some(size) = own {
            return self.fill_own(&size);
        }
        let size = person.size(&self.model);
        let twin = adult(&size)?;
        let said = person.said(&self.model, &size);
        let count = self.notes.len();
        let format = (self.format, false);
        self.model = fill::fill(self.model, format, &size, &twin, &mut self.origins, &mut self.notes);
        let filled = |origins: &Origins| [origins.passive, origins.strength].contains(&Origin::Library);
        if self.origins.iter().any(filled) {
            self.notes.insert(count, said);
        }
        self.sex = self.sex.or(person.sex);
        Ok(self)
    }

    /// Whether the model comes from a file of this program that holds the built-in adult.
    pub fn is_exported_adult(&self) -> bool {
        built_in::verified(self.credited.as_ref(), &self.model).is_some()
    }

    /// Fills in the built-in adult of this size, which the file holds.
    fn fill_own(mut self, size: &Adult) -> Result<Self, AdultError> {
        let (twin, mut of_joints) = (adult(size)?, vec![]);
        self.model = fill::fill(self.model, (self.format, true), size, &twin, &mut self.origins, &mut of_joints);
        self.model = built_in::completed(self.model, &twin);
        let all = self.origins.iter().zip(self.model.coordinates());
        let changed = all.filter(|(origins, c)| origins.passive == Origin::File && c.passive.is_some());
        let changed: Vec<String> = changed.map(|(_, coordinate)| format!("`{}`", coordinate.name)).collect();
        self.notes.push(built_in::said(size, &changed));
        self.sex = Some(size.sex);
        Ok(self)
    }

    /// By coordinate: the range (rad) outside of which its passive torque stays what it is at the nearer end; `None` for none.
    ///
    /// Published exponentials reach 10^15 N m at angles that no joint has and published models allow. The range of a built-in curve
    /// is that of the adult's coordinate, or that of the overlay.
    pub fn passive_ranges(&self) -> Vec<Option<(f64, f64)>> {
        let ranges = self.origins.iter().zip(self.model.coordinates()).map(|(origins, coordinate)| {
            let meant = if origins.range == Origin::Overlay { Some(coordinate.range) } else { origins.meant };
            meant.filter(|_| origins.passive == Origin::Library && coordinate.passive.is_some())
        });
        ranges.collect()
    }
}

/// First words of the note about strength from the file.
const STRENGTH_NOTE: &str = "strength of ";

/// Note with the number of joints that have the strength that the file gives to their motors; `None` without such joints.
fn strength_note(model: &Model, format: ModelFormat) -> Option<String> {
    let known = model.coordinates().iter().filter(|coordinate| coordinate.groups.is_some()).count();
    let from = match format {
        ModelFormat::Mjcf => "`actuatorfrcrange`, or `forcerange` or a motor's `ctrlrange` times `gear`",
        _ => "`effort`",
    };
    (known > 0).then(|| {
        format!(
            "{STRENGTH_NOTE}{known} joints from the file ({from}): the same at every angle, and motors do not tire; \
             --no-strength, in a scenario `file_strength = false`, leaves it out"
        )
    })
}

/// One note for everything in the file that the model does not have.
fn left_out_note(left_out: &[(String, usize)]) -> Option<String> {
    let in_words = |(kind, count): &(String, usize)| match kind.as_str() {
        "muscles" => format!("{count} muscles (neither their strength nor their passive torque)"),
        _ => format!("{count} {kind}"),
    };
    let all: Vec<String> = left_out.iter().map(in_words).collect();
    (!all.is_empty()).then(|| format!("in the file and not used: {}", all.join(", ")))
}
