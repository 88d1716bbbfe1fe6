//! The origin of every number of a coordinate, and how far it can be trusted.

use std::fmt::Write;

use contrapposto::assessment::GroupAssessment;
use contrapposto::joint_torques::LEAST_MUSCLE_STRENGTH;
use contrapposto::model::data::{self, Reference};
use contrapposto::model::{CoordinateKind, MuscleGroup, Sex, Side};
use contrapposto_formats::tissue::{Origin, SourcedModel};
use serde::Serialize;

/// Source of a passive torque that the muscles of the model give.
const OF_MUSCLES: &str = "muscles of the model";
/// Source of a strength that they give: it holds for fibres that stand still.
const ISOMETRIC: &str = "muscles of the model, isometric";

/// Status and source of a number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Source {
    /// `verified`, `derived`, `assumed` and so on; `from the file`, `from the overlay`.
    pub(crate) status: String,
    pub(crate) source: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(crate) note: String,
}

impl Source {
    fn reference(reference: &Reference) -> Self {
        let Reference { status, source, note } = reference;
        Self { status: status.to_string(), source: source.clone(), note: note.clone() }
    }

    /// Of a number that the muscles of the model give.
    pub(crate) fn of_muscles() -> Self {
        Self { source: OF_MUSCLES.to_owned(), ..Self::of_status("derived") }
    }

    fn of_status(status: &str) -> Self {
        Self { status: status.to_owned(), source: String::new(), note: String::new() }
    }
}

/// The sources of the numbers of a coordinate.
#[derive(Debug, Default)]
pub(crate) struct Known {
    pub(crate) range: Option<Source>,
    pub(crate) passive: Option<Source>,
    /// Name of the built-in curve.
    pub(crate) curve: Option<&'static str>,
    /// Of the positive and the negative group; one where both are the same, none where there are no groups.
    pub(crate) strength: Vec<Source>,
    /// Of the dependence of built-in strength on the angle, by group.
    pub(crate) shapes: Option<[Source; 2]>,
    /// Of the parameters of the positive and the negative group; none where there are no groups.
    pub(crate) fatigue: Vec<Source>,
}

impl Known {
    pub(crate) fn of(opened: &SourcedModel, index: usize) -> Self {
        let origins = &opened.origins[index];
        let coordinate = &opened.model.coordinates()[index];
        let library = data::library();
        let sources = origins.twin.as_deref().and_then(|twin| library.sources(twin));
        let sources = sources.as_ref();
        let pick = |origin, reference: Option<&Reference>| match origin {
            Origin::File => Some(Source::of_status("from the file")),
            Origin::Overlay => Some(Source::of_status("from the overlay")),
            Origin::Library => reference.map(Source::reference),
            Origin::Muscles => Some(Source::of_muscles()),
        };
        let mut known = Self { range: pick(origins.range, sources.map(|s| s.range)), ..Self::default() };
        if coordinate.passive.is_some() {
            let curve =
                sources.and_then(|s| s.curve_of(opened.sex.unwrap_or(Sex::Male))).and_then(|name| library.curve(name));
            known.passive = pick(origins.passive, curve.map(|row| &row.reference));
            known.curve = curve.filter(|_| origins.passive == Origin::Library).map(|row| row.name.as_str());
        }
        if coordinate.groups.is_some() {
            let [positive, negative] = match sources.and_then(|s| s.strength) {
                Some([positive, negative]) if origins.turned => [Some(negative.size), Some(positive.size)],
                Some(strength) => strength.map(|of| Some(of.size)),
                None => [None; 2],
            };
            known.strength = match origins.strength {
                Origin::Muscles => vec![Source { source: ISOMETRIC.to_owned(), ..Source::of_status("derived") }],
                origin => [positive, negative].into_iter().filter_map(|r| pick(origin, r)).collect(),
            };
            let shapes = sources.and_then(|s| s.strength).filter(|_| origins.strength == Origin::Library);
            known.shapes = shapes.map(|shapes| shapes.map(|of| Source::reference(of.shape)));
            if let Some(shapes) = known.shapes.as_mut().filter(|_| origins.turned) {
                shapes.reverse();
            }
            known.strength.dedup();
            known.fatigue = coordinate.groups.iter().flatten().filter_map(|g| of_fatigue(g, origins.fatigue)).collect();
        }
        known
    }
}

fn of_fatigue(group: &MuscleGroup, origin: Origin) -> Option<Source> {
    match origin {
        Origin::File => Some(Source::of_status("from the file")),
        Origin::Overlay => Some(Source::of_status("from the overlay")),
        Origin::Muscles => Some(Source::of_muscles()),
        Origin::Library => {
            data::library().fatigue_reference(&group.name, &group.fatigue).as_ref().map(Source::reference)
        }
    }
}

/// The strength of a muscle group at an angle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct StrengthAtText {
    /// `null` for a slide.
    angle_deg: Option<f64>,
    strength_nm: f64,
    /// `measured`, `derived`, `extrapolated`, ...; `from the file`, `from the overlay`.
    status: String,
    /// Name of the source, if muscles of the model give the strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<&'static str>,
    /// The strength is the least share of the peak, below which the curve over the angle would fall, or the least strength of muscles.
    floor: bool,
}

impl StrengthAtText {
    /// At the greatest load of a group; `None` where the strength is not known.
    pub(crate) fn new(opened: &SourcedModel, found: &GroupAssessment) -> Option<Self> {
        let text = Self::at(opened, found.coordinate, found.side, found.at_peak.angle)?;
        if text.source.is_none() {
            return Some(text);
        }
        // The strength of muscles is that of the posture at the peak; a group without a load has none.
        let strength_nm = found.at_peak.strength;
        (strength_nm > 0.0).then(|| Self { angle_deg: text.angle_deg, ..Self::of_muscles(strength_nm) })
    }

    /// Of muscles that give a group `strength_nm`; the least strength is an assumption.
    fn of_muscles(strength_nm: f64) -> Self {
        let floor = strength_nm <= LEAST_MUSCLE_STRENGTH;
        let status = if floor { "assumed" } else { "derived" }.to_owned();
        Self { angle_deg: None, strength_nm, status, source: Some(ISOMETRIC), floor }
    }

    /// Of a group at an angle (rad, m); `None` where the strength is not known.
    pub(crate) fn at(opened: &SourcedModel, coordinate: usize, side: Side, angle: f64) -> Option<Self> {
        let origins = &opened.origins[coordinate];
        let coordinate = &opened.model.coordinates()[coordinate];
        let strength = &coordinate.groups.as_ref()?[side.index()].strength;
        let of_twin = if origins.turned { 1 - side.index() } else { side.index() };
        let angle_deg = (coordinate.kind == CoordinateKind::Rotation).then(|| angle.to_degrees());
        let status = match origins.strength {
            Origin::Muscles => return Some(Self { angle_deg, ..Self::of_muscles(strength.torque(angle)) }),
            Origin::File => Some("from the file".to_owned()),
            Origin::Overlay => Some("from the overlay".to_owned()),
            Origin::Library => {
                let sources = origins.twin.as_deref().and_then(|twin| data::library().sources(twin));
                let strengths = sources.and_then(|sources| sources.strength);
                strengths.map(|of| of[of_twin].status_at(strength, angle).to_string())
            }
        };
        let (strength_nm, floor) = (strength.torque(angle), strength.is_floor(angle));
        Some(Self { angle_deg, strength_nm, status: status.unwrap_or_default(), source: None, floor })
    }

    /// Whether it is the floor.
    pub(crate) fn is_floor(&self) -> bool {
        self.floor
    }

    /// `29 N m, derived, floor`.
    pub(crate) fn words(&self) -> String {
        let floor = if self.floor { ", floor" } else { "" };
        let source = self.source.map_or_else(String::new, |source| format!(" ({source})"));
        format!("{:.0} N m, {}{source}{floor}", self.strength_nm, self.status)
    }
}

/// Sources that a table refers to by number.
#[derive(Debug, Default)]
pub(crate) struct Seen(Vec<Source>);

impl Seen {
    /// ` verified [3]`; empty where the file itself is the source.
    pub(crate) fn mark(&mut self, source: Option<&Source>) -> String {
        let Some(source) = source.filter(|source| source.status != "from the file") else { return String::new() };
        if source.source.is_empty() {
            return format!(" {}", source.status);
        }
        let number = self.0.iter().position(|seen| seen == source).unwrap_or_else(|| {
            self.0.push(source.clone());
            self.0.len() - 1
        });
        format!(" {} [{}]", source.status, number + 1)
    }

    /// The numbered sources.
    pub(crate) fn legend(&self) -> String {
        let mut text = String::new();
        for (number, Source { status, source, note }) in self.0.iter().enumerate() {
            let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
            let head = if number == 0 { "\nsources:\n" } else { "" };
            let _ = writeln!(text, "{head}  [{}] {status}: {source}{note}", number + 1);
        }
        text
    }
}
