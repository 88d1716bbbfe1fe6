//! Finds the factors of bodies: by measurements, and as given by hand.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::RangeInclusive;

use contrapposto::kinematics::Kinematics;
use contrapposto_formats::markers::{ACCEPTED_FACTORS, Markers, Measurement, Order, ScaleSetup};
use contrapposto_formats::nearest;
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;

use super::files::{frames, time_range};
use crate::args::ScaleArgs;
use crate::commands::track::matching::length;
use crate::fail::Fail;
use crate::output::print_note;

/// Factors out of this range are warned of (assumed: people differ from a model of an adult by less than a factor of two).
const LIKELY: RangeInclusive<f64> = 0.5..=2.0;

/// A measurement with its result.
struct Taken<'m> {
    measurement: &'m Measurement,
    factor: f64,
    /// Distances in the model and as measured, m, by pair.
    pairs: Vec<(f64, f64)>,
}

/// The factors of all bodies.
pub(super) struct Measured<'m> {
    /// By body, for those that are scaled.
    pub(super) factors: BTreeMap<String, Vector3<f64>>,
    taken: Vec<Taken<'m>>,
    /// Number of bodies whose factors were given by hand.
    by_hand: usize,
}

/// The files that measurements compare.
struct Files<'f> {
    model: &'f SourcedModel,
    body: Kinematics,
    shown: String,
    bodies: &'f [String],
    markers: &'f Markers,
    name: &'f str,
    frames: RangeInclusive<usize>,
}

impl<'m> Measured<'m> {
    pub(super) fn new(
        args: &'m ScaleArgs,
        setup: &'m ScaleSetup,
        (model, bodies): (&SourcedModel, &[String]),
        (markers, name): (&Markers, &str),
    ) -> Result<Self, Fail> {
        let frames = frames(markers, name, time_range(args, setup.time_range))?;
        let (shown, body) = (args.model.display().to_string(), Kinematics::new(&model.model));
        let files = Files { model, body, shown, bodies, markers, name, frames };
        let mut measured = Self { factors: BTreeMap::new(), taken: vec![], by_hand: 0 };
        let file = args.setup.as_ref().map_or_else(String::new, |path| path.display().to_string());
        for step in &setup.order {
            match step {
                Order::Measurements => {
                    for measurement in &setup.measurements {
                        let place =
                            measurement.place.map_or_else(String::new, |p| format!("{file}:{}:{}: ", p.line, p.column));
                        // OpenSim goes on without them, too.
                        if let Err(why) = measured.take(&files, measurement, &place) {
                            let said = format!("{place}measurement `{}` is not used: {why}", measurement.name);
                            print_note("warning", &said);
                        }
                    }
                }
                Order::Manual => {
                    for (name, factors, place) in &setup.manual {
                        let place = format!("{file}:{}:{}: ", place.line, place.column);
                        if files.has_body(name, &place) {
                            measured.by_hand += 1;
                            measured.factors.insert(name.clone(), *factors);
                        }
                    }
                }
            }
        }
        for measurement in &args.measure {
            let name = &measurement.name;
            let refused = |why| Fail::Refused(format!("--measure {name}: {why}"));
            if let Some((body, _)) = measurement.bodies.iter().find(|(body, _)| !bodies.contains(body)) {
                return Err(refused(files.no_body(body)));
            }
            measured.take(&files, measurement, "").map_err(refused)?;
        }
        if measured.factors.is_empty() && (args.setup.is_none() || !setup.order.is_empty()) {
            let accepted = "--measure NAME=MARKER,MARKER:BODY or a setup file with measurements or factors is accepted";
            return Err(Fail::Refused(format!("{}: nothing says how large a body is; {accepted}", files.shown)));
        }
        Ok(measured)
    }

    /// Takes a measurement and gives its bodies their factors; says why it cannot be taken.
    fn take(&mut self, files: &Files<'_>, measurement: &'m Measurement, place: &str) -> Result<(), String> {
        let mut pairs = vec![];
        for pair in &measurement.pairs {
            pairs.push(files.distances(pair)?);
        }
        if pairs.is_empty() {
            return Err("it has no pair of markers".to_owned());
        }
        let factor = pairs.iter().map(|(of_model, measured)| measured / of_model).sum::<f64>() / pairs.len() as f64;
        if !ACCEPTED_FACTORS.contains(&factor) {
            let (least, most) = (ACCEPTED_FACTORS.start(), ACCEPTED_FACTORS.end());
            let units = "do the units of the markers fit? --units mm, cm or m says them";
            return Err(format!("its factor is {factor:.4}; {least} to {most} is accepted; {units}"));
        }
        if !LIKELY.contains(&factor) {
            let (least, most) = (LIKELY.start(), LIKELY.end());
            let said = format!(
                "people differ from a model by a factor between {least} and {most}; do names and units of the markers fit?"
            );
            print_note(
                "warning",
                &format!("{place}measurement `{}` gives the factor {factor:.3}; {said}", measurement.name),
            );
        }
        for (body, axes) in measurement.bodies.iter().filter(|(body, _)| files.has_body(body, place)) {
            let factors = self.factors.entry(body.clone()).or_insert(Vector3::repeat(1.0));
            (0..3).filter(|axis| axes[*axis]).for_each(|axis| factors[axis] = factor);
        }
        self.taken.push(Taken { measurement, factor, pairs });
        Ok(())
    }

    /// The smallest and the largest factor, each with a body.
    pub(super) fn extremes(&self) -> Option<[(f64, &str); 2]> {
        let mut all: Vec<(f64, &str)> = vec![];
        for (body, factors) in &self.factors {
            all.extend(factors.iter().map(|factor| (*factor, body.as_str())));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
        let (least, most) = (*all.first()?, all.last()?.0);
        Some([least, *all.iter().find(|(factor, _)| *factor == most)?])
    }

    /// A line for each measurement, and one for factors given by hand.
    pub(super) fn lines(&self) -> String {
        let mut text = String::new();
        for Taken { measurement, factor, pairs } in &self.taken {
            let distances = measurement.pairs.iter().zip(pairs).map(|([a, b], (of_model, measured))| {
                format!("{a} to {b} {} measured, {} in the model", length(*measured), length(*of_model))
            });
            let distances = distances.collect::<Vec<_>>().join("; ");
            let _ = writeln!(text, "measurement {}: factor {factor:.4} ({distances})", measurement.name);
        }
        if self.by_hand > 0 {
            let _ = writeln!(text, "given by hand: the factors of {} bodies", self.by_hand);
        }
        text
    }
}

impl Files<'_> {
    /// Whether the model has a body; warns where it has none.
    fn has_body(&self, name: &str, place: &str) -> bool {
        let known = self.bodies.iter().any(|body| body == name);
        if !known {
            print_note("warning", &format!("{place}{}", self.no_body(name)));
        }
        known
    }

    fn no_body(&self, name: &str) -> String {
        let meant = nearest(name, self.bodies.iter().map(String::as_str));
        let meant = meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"));
        format!("{} has no body `{name}`{meant}", self.shown)
    }

    /// Distances of a pair of markers in the default posture of the model and as measured, m.
    fn distances(&self, pair: &[String; 2]) -> Result<(f64, f64), String> {
        let model = &self.model.model;
        let of_model = || self.model.markers.iter().map(|marker| marker.name.as_str());
        let mut places = [Vector3::zeros(); 2];
        let mut columns = [0; 2];
        for (i, name) in pair.iter().enumerate() {
            let marker = self.model.markers.iter().find(|marker| marker.name == *name);
            let marker = marker.ok_or_else(|| missing(name, &self.shown, of_model()))?;
            places[i] = self.body.station(model, marker.segment, marker.point);
            let column = self.markers.names.iter().position(|known| known == name);
            columns[i] =
                column.ok_or_else(|| missing(name, self.name, self.markers.names.iter().map(String::as_str)))?;
        }
        let distance = (places[1] - places[0]).norm();
        let [a, b] = pair;
        if distance <= 0.0 {
            return Err(format!("the markers `{a}` and `{b}` of {} lie on the same point", self.shown));
        }
        let measured = self.markers.mean_distance(columns, self.frames.clone());
        let measured = measured.ok_or_else(|| format!("no instant of {} has both `{a}` and `{b}`", self.name))?;
        Ok((distance, measured))
    }
}

/// Says that a file has no marker of that name.
fn missing<'n>(name: &str, file: &str, names: impl Iterator<Item = &'n str>) -> String {
    let meant = nearest(name, names).map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"));
    format!("{file} has no marker `{name}`{meant}")
}
