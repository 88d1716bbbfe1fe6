//! Reads muscles: actuators of which gain and bias follow MuJoCo's muscle, on a tendon or a joint. One that is not supported is counted with
//! its reason, and does not refuse the model.

use std::collections::BTreeMap;

use contrapposto::model::LARGEST;
use contrapposto::muscle::{FiberLaw, MujocoMuscle, Muscle, MuscleSpec, Path, Tendon};

use super::attributes::Attributes;
use super::built::Built;
use super::compiler::Settings;
use super::defaults::Classes;
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::item::Item;
use super::schema::{ACTUATORS, Tag};
use super::tendon::{self, named};
use super::value::Value;
use crate::model_ir::MusclesIr;

const GAINS: &[&str] = &["fixed", "affine", "muscle", "user", "dcmotor"];
const BIASES: &[&str] = &["none", "affine", "muscle", "user", "dcmotor"];
/// Numbers of a muscle in `gainprm` and `biasprm`.
const COUNT: usize = 10;
/// Position of each attribute of `<muscle>` among these numbers.
const ATTRIBUTES: [(&str, usize); 8] =
    [("range", 0), ("force", 2), ("scale", 3), ("lmin", 4), ("lmax", 5), ("vmax", 6), ("fpmax", 7), ("fvmax", 8)];
/// MuJoCo's numbers of an actuator, and those with which `<muscle>` replaces them where they are still the same.
const PLAIN: [f64; COUNT] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const MUSCLE: [f64; 9] = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];

/// Reads all muscles, and counts tendons.
pub(super) fn read<'a>(
    root: Item<'a>,
    (settings, classes, built): (&Settings, &Classes<'a>, &Built<'a>),
) -> Result<MusclesIr, MjcfError> {
    let mut all = MusclesIr::default();
    let mut geoms = tendon::Geoms::default();
    let mut tendons = tendon::all(root, built, &mut geoms, &mut all.tally);
    let sections = root.children().into_iter().filter(|section| section.name() == "actuator");
    for item in sections.flat_map(Item::children).filter(|item| ACTUATORS.contains(&item.name())) {
        let actuator = Attributes::new(item, Tag::Actuator, classes, classes.main());
        let known = actuator.and_then(|actuator| Ok((Parameters::read(&actuator)?, actuator)));
        let is_muscle = known.as_ref().map_or(item.name() == "muscle", |(parameters, _)| parameters.is_muscle());
        if !is_muscle {
            continue;
        }
        let read = known.and_then(|(parameters, actuator)| {
            let path = path(&actuator, built, &mut tendons)?;
            Ok((muscle(&actuator, &parameters, settings, &all)?, path))
        });
        match read {
            Ok((muscle, path)) => {
                all.tally.read(item.name());
                all.musculature.muscles.push(muscle);
                all.musculature.paths.paths.push(path);
            }
            Err(why) => all.tally.refused(item.name(), why.to_string()),
        }
    }
    for tendon in tendons.into_values() {
        match tendon.path {
            Err(why) => all.tally.refused(tendon.kind, why.to_string()),
            Ok(_) if tendon.used => {
                all.tally.read(tendon.kind);
                tendon.parts.iter().for_each(|kind| all.tally.read(kind));
            }
            Ok(_) => all.tally.left_out(tendon.kind, "no muscle that is read pulls on it"),
        }
    }
    all.musculature.paths.geoms = geoms.list;
    Ok(all)
}

/// Gain and bias of an actuator.
struct Parameters {
    gain_kind: &'static str,
    bias_kind: &'static str,
    gain: [f64; COUNT],
    bias: [f64; COUNT],
}

impl Parameters {
    /// From the classes, outermost first, and the element.
    fn read(actuator: &Attributes<'_, '_>) -> Result<Self, MjcfError> {
        let mut all = Self { gain_kind: "fixed", bias_kind: "none", gain: PLAIN, bias: [0.0; COUNT] };
        for item in actuator.elements() {
            all.take(item)?;
        }
        Ok(all)
    }

    fn take(&mut self, item: Item<'_>) -> Result<(), MjcfError> {
        match item.name() {
            "muscle" => {
                (self.gain_kind, self.bias_kind) = ("muscle", "muscle");
                for (value, (plain, muscle)) in self.gain.iter_mut().zip(PLAIN.iter().zip(&MUSCLE)) {
                    *value = if value == plain { *muscle } else { *value };
                }
                for (name, index) in ATTRIBUTES {
                    let Some(value) = Value::of(item, name) else { continue };
                    let mut given = [-1.0; 2];
                    value.prefix(&mut given[..if name == "range" { 2 } else { 1 }])?;
                    // MuJoCo takes negative numbers for those that are not given.
                    let own = self.gain[index..].iter_mut().zip(given).filter(|(_, given)| *given >= 0.0);
                    own.for_each(|(value, given)| *value = given);
                }
                self.bias = self.gain;
            }
            "general" => {
                let kind = |name, kinds: &'static [&'static str], before| {
                    Value::of(item, name).map_or(Ok(before), |value| value.keyword(kinds).map(|index| kinds[index]))
                };
                self.gain_kind = kind("gaintype", GAINS, self.gain_kind)?;
                self.bias_kind = kind("biastype", BIASES, self.bias_kind)?;
                for (name, values) in [("gainprm", &mut self.gain), ("biasprm", &mut self.bias)] {
                    Value::of(item, name).map_or(Ok(()), |value| value.prefix(values))?;
                }
            }
            _ => *self = Self { gain_kind: "fixed", bias_kind: "affine", gain: PLAIN, bias: [0.0; COUNT] },
        }
        Ok(())
    }

    fn is_muscle(&self) -> bool {
        self.gain_kind == "muscle" || self.bias_kind == "muscle"
    }
}

/// The line on which an actuator pulls, times its gear.
fn path<'a>(
    actuator: &Attributes<'a, '_>,
    built: &Built<'a>,
    tendons: &mut BTreeMap<&'a str, tendon::Read<'a>>,
) -> Result<Path, MjcfError> {
    let item = actuator.item;
    let mut gear = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    actuator.get("gear").map_or(Ok(()), |value| value.prefix(&mut gear))?;
    if gear[0].abs() > LARGEST {
        return Err(MjcfError::invalid(item, "gear", MjcfRule::TooFar));
    }
    let joint = ["joint", "jointinparent"].into_iter().find(|name| item.attribute(name).is_some());
    let mut path = if item.attribute("tendon").is_some() {
        named(item, "tendon", "tendon", tendons)?;
        let name = item.attribute("tendon").unwrap_or_default();
        let Some(tendon) = tendons.get_mut(name) else { return Ok(Path::default()) };
        tendon.used = true;
        tendon.path.clone()?
    } else if let Some(attribute) = joint {
        let (coordinate, _) = *named(item, attribute, "hinge or slide joint", &built.joints)?;
        let tendon = Tendon { parts: vec![], coordinates: vec![(coordinate, 1.0)] };
        Path { tendon: Some(tendon), ..Path::default() }
    } else {
        return Err(Unsupported::MuscleTransmission.at(item));
    };
    if let Some(tendon) = &mut path.tendon {
        tendon.parts.iter_mut().for_each(|part| part.weight *= gear[0]);
        tendon.coordinates.iter_mut().for_each(|(_, factor)| *factor *= gear[0]);
    }
    Ok(path)
}

fn muscle(
    actuator: &Attributes<'_, '_>,
    parameters: &Parameters,
    settings: &Settings,
    all: &MusclesIr,
) -> Result<Muscle, MjcfError> {
    let item = actuator.item;
    let Parameters { gain, bias, .. } = parameters;
    if parameters.gain_kind != "muscle" || !["muscle", "none"].contains(&parameters.bias_kind) {
        return Err(Unsupported::HalfMuscle.at(item));
    }
    let passive = parameters.bias_kind == "muscle";
    if passive && (gain[..3] != bias[..3] || gain[5] != bias[5]) {
        return Err(Unsupported::MuscleBias.at(item));
    }
    if actuator.limits("forcerange", "forcelimited", settings.automatic_limits)?.is_some() {
        return Err(Unsupported::MuscleForceRange.at(item));
    }
    let [low, high, force, _, least, greatest, _, _, _, _] = *gain;
    if force < 0.0 {
        return Err(Unsupported::MuscleForce.at(item));
    }
    let lengths = actuator.numbers::<2>("lengthrange")?.filter(|lengths| *lengths != [0.0; 2]);
    let Some([from, to]) = lengths else { return Err(Unsupported::MuscleLengthRange.at(item)) };
    if low >= high || from >= to {
        return Err(MjcfError::invalid(item, "lengthrange", MjcfRule::MuscleRange));
    }
    let optimal = (to - from) / (high - low);
    let count = all.musculature.muscles.len();
    let name = item.attribute("name").filter(|name| !name.is_empty());
    let name = name.map_or_else(|| format!("muscle_{}", count + 1), str::to_owned);
    if all.musculature.muscles.iter().any(|muscle| muscle.spec().name == name) {
        return Err(MjcfError::DuplicateName { place: item.place(), value: crate::xml::shorten(&name) });
    }
    let law = MujocoMuscle { least, greatest, passive_force: if passive { bias[7] } else { 0.0 } };
    Muscle::new(MuscleSpec {
        name,
        path: count,
        max_isometric_force: force,
        optimal_fiber_length: optimal,
        tendon_slack_length: from - low * optimal,
        pennation: 0.0,
        max_pennation: std::f64::consts::FRAC_PI_2,
        least_activation: 0.0,
        rigid_tendon: true,
        law: FiberLaw::Mujoco(law),
    })
    .map_err(|why| MjcfError::Muscle { place: item.place(), why })
}
