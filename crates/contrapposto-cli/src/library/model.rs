//! Keeps the bytes from which a model is made, so that it can be made again elsewhere.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use contrapposto::joint_torques::JointMuscles;
use contrapposto::model::data::library;
use contrapposto::model::{Adult, Sex};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::tissue::{MuscleUse, Person, SourcedModel};
use contrapposto_formats::xml::Limits;
use contrapposto_formats::{MOST_BYTES, person};
use serde::{Deserialize, Serialize};

use super::failure::{Failure, Note, with_notes};
use crate::commands::assess::job::Opened;
use crate::fail::Fail;
use crate::input::read;
use crate::model_file::{completed, confined, refused_file, with_joint_muscles};
use crate::output::print_note;

/// The options that complete a model file, as those of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ModelOptions {
    /// Ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the model.
    pub overlay: Option<PathBuf>,
    /// `fixed` or `free`: how the root of a URDF or MJCF model is attached; as the file says when left out.
    pub root: Option<String>,
    /// Passive torque and strength that the file does not have come from the built-in library; without an overlay when left out.
    pub fill: Option<bool>,
    /// The file's strength of motors is left out.
    pub no_strength: bool,
    /// The person whom the model stands for: `female,1.65m,60kg`, or some of them.
    pub person: Option<String>,
}

/// A model with its muscles, where they are used.
pub type OpenedModel = (SourcedModel, Option<JointMuscles>);

/// All bytes and words that a model is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSource {
    kind: Kind,
    /// Overlays laid over the model one after the other, as TOML.
    laid: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Kind {
    Adult {
        female: bool,
        stature: f64,
        mass: f64,
        /// The percentile of people of that sex from which stature and mass come.
        percentile: Option<f64>,
    },
    File(Box<File>),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct File {
    name: String,
    bytes: Vec<u8>,
    /// Files that it includes, by their names.
    included: BTreeMap<String, Vec<u8>>,
    overlay: Option<(String, Vec<u8>)>,
    free_root: Option<bool>,
    fill: bool,
    no_strength: bool,
    person: Option<String>,
}

impl ModelSource {
    fn of(kind: Kind) -> Self {
        Self { kind, laid: vec![] }
    }

    /// The same with an overlay (TOML) laid over it.
    #[must_use]
    pub fn lay_over(mut self, overlay: String) -> Self {
        self.laid.push(overlay);
        self
    }

    /// The built-in adult, stature in m and mass in kg; those of the reference woman or man where they are left out.
    pub fn adult(sex: Sex, stature: Option<f64>, mass: Option<f64>) -> Self {
        let reference = Adult::reference(sex);
        let (stature, mass) = (stature.unwrap_or(reference.stature), mass.unwrap_or(reference.mass));
        Self::of(Kind::Adult { female: sex == Sex::Female, stature, mass, percentile: None })
    }

    /// The built-in adult whose stature and mass are each at a percentile (0 to 100) of people of that sex (`data/people.toml`).
    ///
    /// # Errors
    /// [`Failure`] of a percentile that is not between 0 and 100.
    pub fn adult_at(sex: Sex, percentile: f64) -> Result<Self, Failure> {
        if !(percentile > 0.0 && percentile < 100.0) {
            let message = format!("percentile is {percentile}; it must lie between 0 and 100");
            return Err(Failure::refused(message));
        }
        let (stature, mass) = library().people().of_sex(sex).size_at(percentile / 100.0);
        Ok(Self::of(Kind::Adult { female: sex == Sex::Female, stature, mass, percentile: Some(percentile) }))
    }

    /// Reads a model file, and the files that it includes.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn read(path: &Path, options: &ModelOptions) -> Result<(Self, SourcedModel, Vec<Note>), Failure> {
        let root = options.root.as_deref().map(|root| match root {
            "fixed" => Ok(false),
            "free" => Ok(true),
            other => Err(Failure::refused(format!("root is `{other}`; it must be `fixed` or `free`"))),
        });
        let ((source, opened), notes) = with_notes(|| {
            let most = Limits::default().file_bytes as u64;
            let bytes_of = |path: &Path| Ok::<_, Fail>((path.display().to_string(), read(path, MOST_BYTES)?));
            let mut file = File {
                name: path.display().to_string(),
                bytes: read(path, most)?,
                included: BTreeMap::new(),
                overlay: options.overlay.as_deref().map(bytes_of).transpose()?,
                free_root: root.transpose().map_err(|failure| Fail::Refused(failure.message))?,
                fill: options.fill.unwrap_or(options.overlay.is_none()),
                no_strength: options.no_strength,
                person: options.person.clone(),
            };
            let (mut include, mut included) = (confined(path, most), BTreeMap::new());
            let mut keep = |name: &str| {
                let bytes = include(name)?;
                included.insert(name.to_owned(), bytes.clone());
                Ok(bytes)
            };
            let (opened, _) = file.open(&mut keep, &[], None)?;
            file.included = included;
            Ok((Self::of(Kind::File(Box::new(file))), opened))
        })?;
        Ok((source, opened, notes))
    }

    /// As bytes, for [`ModelSource::from_bytes`].
    ///
    /// # Errors
    /// A text about a value that has no place in JSON.
    pub fn to_bytes(&self) -> Result<Vec<u8>, String> {
        serde_json::to_vec(self).map_err(|error| error.to_string())
    }

    /// From the bytes of [`ModelSource::to_bytes`].
    ///
    /// # Errors
    /// A text that says why the bytes are none.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        serde_json::from_slice(bytes).map_err(|error| error.to_string())
    }

    /// Makes the model, without a look at any file.
    ///
    /// # Errors
    /// [`Failure`] for an adult of no adult's size, or bytes that are no model.
    pub fn open(&self) -> Result<(SourcedModel, Vec<Note>), Failure> {
        with_notes(|| Ok(self.completed(None)?.0))
    }

    /// Makes the model and gives its muscles the use that is asked of them, that of the program's `--muscles` without one.
    ///
    /// # Errors
    /// As [`ModelSource::open`]; and a use of muscles that the model does not have.
    pub fn open_with_muscles(&self, uses: Option<MuscleUse>) -> Result<(OpenedModel, Vec<Note>), Failure> {
        with_notes(|| self.opened(uses).map(|(opened, muscles, _)| (opened, muscles)))
    }

    /// The model with its muscles, and warnings about them.
    pub(super) fn opened(&self, uses: Option<MuscleUse>) -> Result<Opened, Fail> {
        with_joint_muscles(self.completed(Some((uses, "muscles")))?)
    }

    fn completed(&self, muscles: Muscles) -> Result<(SourcedModel, Option<SourcedModel>), Fail> {
        match &self.kind {
            &Kind::Adult { female, stature, mass, percentile } => {
                let sex = if female { Sex::Female } else { Sex::Male };
                if let Some(percentile) = percentile {
                    print_note("note", &at_percentile((female, percentile), (stature, mass)));
                }
                let size = Adult { stature, mass, ..Adult::reference(sex) };
                let opened = SourcedModel::adult(&size).map_err(|error| Fail::Refused(error.to_string()))?;
                completed(lay(opened, &self.laid)?, muscles, Ok)
            }
            Kind::File(file) => file.open(
                &mut |name| file.included.get(name).cloned().ok_or_else(|| "it was not kept".to_owned()),
                &self.laid,
                muscles,
            ),
        }
    }
}

fn lay(opened: SourcedModel, overlays: &[String]) -> Result<SourcedModel, Fail> {
    overlays.iter().try_fold(opened, |opened, text| Ok(opened.lay_over("overlay", text.as_bytes())?))
}

/// The use of muscles that is asked for, and the name of the key that asks.
type Muscles = Option<(Option<MuscleUse>, &'static str)>;

/// The sentence about an adult at a percentile.
fn at_percentile((female, percentile): (bool, f64), (stature, mass): (f64, f64)) -> String {
    let reference = &library().people().reference;
    let people = if female { "women" } else { "men" };
    format!(
        "stature {stature:.3} m and mass {mass:.1} kg are each at percentile {percentile} of {people} ({}; {}: {}); of both together fewer \
         people are that small or that large",
        reference.status, reference.note, reference.source
    )
}

impl File {
    /// The model; where muscles are in question the same one without them, too.
    fn open(
        &self,
        include: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
        laid: &[String],
        muscles: Muscles,
    ) -> Result<(SourcedModel, Option<SourcedModel>), Fail> {
        let root = self.free_root.map(|free| if free { RootAttachment::Free } else { RootAttachment::Fixed });
        let person = self.person.as_deref().map_or(Ok(Person::default()), person);
        let person = person.map_err(|error| Fail::Refused(format!("person: {error}")))?;
        let mut opened = SourcedModel::read(&self.name, &self.bytes, root, include)
            .map_err(|error| refused_file(&self.name, error))?;
        if self.no_strength {
            opened = opened.without_strength();
        }
        if let Some((name, bytes)) = &self.overlay {
            opened = opened.lay_over(name, bytes)?;
        }
        let opened = lay(opened, laid)?;
        completed(opened, muscles, |opened| {
            let refused = |error| Fail::Refused(format!("person: {error}"));
            if self.fill { opened.fill(&person).map_err(refused) } else { Ok(opened) }
        })
    }
}
