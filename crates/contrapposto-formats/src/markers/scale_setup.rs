//! Reads the setup file of OpenSim's ScaleTool: measurements, factors given by hand, and the tasks that place markers.

use nalgebra::Vector3;

use super::measurement::axis_flags;
use super::tasks::{Reader, text};
use super::{Measurement, NamedFile, TaskFileError, TrackingTasks};
use crate::xml::{self, Limits, Node, Position, shorten};

/// A step of scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Factors from measurements.
    Measurements,
    /// Factors given by hand.
    Manual,
}

/// Smallest and largest factor of a body that is accepted (assumed: a body a hundred times as large is of another unit).
pub const ACCEPTED_FACTORS: std::ops::RangeInclusive<f64> = 0.01..=100.0;

/// A setup file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScaleSetup {
    /// Name of the subject, which the scaled model gets.
    pub name: Option<String>,
    /// Mass of the subject, kg; `None` where masses come as they come.
    pub mass: Option<f64>,
    /// Markers that the model gets, by the file's name.
    pub marker_set_file: Option<String>,
    /// Steps of scaling in their order; later ones replace factors.
    pub order: Vec<Order>,
    /// Measurements that are applied.
    pub measurements: Vec<Measurement>,
    /// Factors given by hand, by body, with their places in the file.
    pub manual: Vec<(String, Vector3<f64>, Position)>,
    /// Times over which distances are averaged, s.
    pub time_range: Option<(f64, f64)>,
    /// Masses keep their proportions.
    pub preserve_mass_distribution: bool,
    /// Tasks of the static posture in which markers are placed; `None` where they stay.
    pub placing: Option<TrackingTasks>,
    /// Markers move onto the measured ones.
    pub moves_markers: bool,
    /// Model and markers that the file names.
    pub named: Vec<NamedFile>,
}

/// Reads the setup file of a ScaleTool. `file` stands in errors.
///
/// # Errors
/// [`TaskFileError`] with file, line and column.
pub fn scale_setup(file: &str, bytes: &[u8]) -> Result<ScaleSetup, TaskFileError> {
    let document =
        xml::parse(bytes, &Limits::default()).map_err(|error| TaskFileError::Xml { file: file.to_owned(), error })?;
    let reader = Reader { file };
    let root = document.root();
    let tool = if root.name() == "ScaleTool" { Some(root) } else { root.child("ScaleTool") };
    let Some(tool) = tool else {
        let found = root.children().next().map_or(root.name(), |child| child.name());
        let problem = format!("holds <{}>; the setup file of a ScaleTool is accepted", shorten(found));
        return Err(reader.error(root, problem));
    };
    let mut setup = ScaleSetup {
        name: tool.attribute("name").map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned),
        mass: reader.number(tool, "mass")?.filter(|mass| *mass > 0.0),
        ..ScaleSetup::default()
    };
    if let Some(maker) = tool.child("GenericModelMaker") {
        setup.marker_set_file = text(maker, "marker_set_file");
        if let Some(model) = text(maker, "model_file") {
            setup.name("model_file", model);
        }
    }
    if let Some(scaler) = tool.child("ModelScaler")
        && reader.flag(scaler, "apply")?
    {
        reader.scaler(scaler, &mut setup)?;
    }
    if let Some(placer) = tool.child("MarkerPlacer")
        && reader.flag(placer, "apply")?
    {
        reader.placer(placer, &mut setup)?;
    }
    Ok(setup)
}

impl ScaleSetup {
    fn name(&mut self, element: &'static str, name: String) {
        let file = NamedFile { element, name };
        if !self.named.contains(&file) {
            self.named.push(file);
        }
    }
}

impl Reader<'_> {
    fn scaler(&self, node: Node<'_>, setup: &mut ScaleSetup) -> Result<(), TaskFileError> {
        for word in text(node, "scaling_order").unwrap_or_default().split_ascii_whitespace() {
            setup.order.push(match word {
                "measurements" => Order::Measurements,
                "manualScale" => Order::Manual,
                other => {
                    let accepted = "`measurements` and `manualScale` are accepted";
                    let problem = format!("<scaling_order> has `{}`; {accepted}", shorten(other));
                    return Err(self.error(node.child("scaling_order").unwrap_or(node), problem));
                }
            });
        }
        for measurement in objects(node.child("MeasurementSet")) {
            if self.flag(measurement, "apply")? {
                setup.measurements.push(self.measurement(measurement)?);
            }
        }
        for scale in objects(node.child("ScaleSet")) {
            if self.flag(scale, "apply")? {
                setup.manual.push(self.manual(scale)?);
            }
        }
        setup.time_range = self.time_range(node)?.filter(|(_, to)| *to >= 0.0);
        setup.preserve_mass_distribution =
            node.child("preserve_mass_distribution").is_some() && self.flag(node, "preserve_mass_distribution")?;
        if let Some(markers) = text(node, "marker_file") {
            setup.name("marker_file", markers);
        }
        Ok(())
    }

    fn measurement(&self, node: Node<'_>) -> Result<Measurement, TaskFileError> {
        let name = node.attribute("name").unwrap_or_default().trim().to_owned();
        let mut measurement = Measurement { name, place: Some(node.position()), ..Measurement::default() };
        for pair in objects(node.child("MarkerPairSet")) {
            let names = text(pair, "markers").unwrap_or_default();
            let names: Vec<&str> = names.split_ascii_whitespace().collect();
            let [first, second] = names[..] else {
                let problem = format!("<markers> has {} names; a pair has two", names.len());
                return Err(self.error(pair, problem));
            };
            measurement.pairs.push([first.to_owned(), second.to_owned()]);
        }
        for body in objects(node.child("BodyScaleSet")) {
            let axes = text(body, "axes").unwrap_or_default();
            let Some(flags) = axis_flags(&axes) else {
                let problem = format!("<axes> is `{}`; some of X, Y and Z are accepted", shorten(&axes));
                return Err(self.error(body, problem));
            };
            measurement.bodies.push((body.attribute("name").unwrap_or_default().trim().to_owned(), flags));
        }
        Ok(measurement)
    }

    fn manual(&self, node: Node<'_>) -> Result<(String, Vector3<f64>, Position), TaskFileError> {
        let segment = text(node, "segment").unwrap_or_default();
        let factors = self.vector(node, "scales")?.unwrap_or(Vector3::repeat(1.0));
        if let Some(factor) = factors.iter().find(|factor| !ACCEPTED_FACTORS.contains(factor)) {
            let (least, most) = (ACCEPTED_FACTORS.start(), ACCEPTED_FACTORS.end());
            let problem = format!("the factor of `{}` is {factor}; {least} to {most} is accepted", shorten(&segment));
            return Err(self.error(node, problem));
        }
        Ok((segment, factors, node.position()))
    }

    fn placer(&self, node: Node<'_>, setup: &mut ScaleSetup) -> Result<(), TaskFileError> {
        let set = node.child("IKTaskSet");
        if let Some(set) = set.filter(|set| set.attribute("file").is_some()) {
            let problem = "the tasks are in another file; put the IKTaskSet into the setup file".to_owned();
            return Err(self.error(set, problem));
        }
        let mut tasks = set.map_or_else(|| Ok(TrackingTasks::default()), |set| self.tasks(set))?;
        tasks.time_range = self.time_range(node)?.filter(|(_, to)| *to >= 0.0);
        if let Some(markers) = text(node, "marker_file") {
            setup.name("marker_file", markers);
        }
        setup.placing = Some(tasks);
        setup.moves_markers = node.child("move_model_markers").is_none() || self.flag(node, "move_model_markers")?;
        Ok(())
    }
}

/// Children of a set: those of its `<objects>`.
fn objects(set: Option<Node<'_>>) -> impl Iterator<Item = Node<'_>> {
    set.and_then(|set| set.child("objects")).into_iter().flat_map(Node::children)
}
