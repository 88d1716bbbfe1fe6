//! Matches the markers of a file, those of a model and the tasks by their names.

use std::collections::HashMap;

use contrapposto::model::Model;
use contrapposto::tracking::{CoordinateGoal, Goals, MarkerGoal};
use contrapposto_formats::markers::{Markers, TaskValue, TrackingTasks};
use contrapposto_formats::nearest;
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;

use crate::fail::Fail;

/// Most names in a sentence.
const MOST_NAMES: usize = 8;

/// Places of the matched markers in one frame, m.
pub(crate) type Observed = Vec<Option<Vector3<f64>>>;

/// Markers that are tracked, and the goals of every frame.
pub(crate) struct Matched {
    /// Names of the markers of the goals.
    pub(crate) names: Vec<String>,
    /// Columns of these markers in the file.
    pub(crate) columns: Vec<usize>,
    pub(crate) goals: Goals,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
}

/// Names of the files, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Source<'s> {
    pub(crate) model: &'s str,
    pub(crate) markers: &'s str,
    pub(crate) tasks: &'s str,
}

impl Matched {
    pub(crate) fn new(
        opened: &SourcedModel,
        markers: &Markers,
        tasks: Option<&TrackingTasks>,
        source: Source<'_>,
    ) -> Result<Self, Fail> {
        let (shown, name) = (source.model, source.markers);
        if opened.markers.is_empty() {
            let accepted = "an OpenSim model with a MarkerSet, or an MJCF model with sites, is accepted";
            return Err(Fail::Refused(format!("{shown}: holds no markers; {accepted}")));
        }
        let columns: HashMap<&str, usize> = markers.names.iter().map(String::as_str).zip(0..).collect();
        let weights = tasks.map(|tasks| tasks.markers.iter().map(|task| (task.name.as_str(), task.weight)));
        let weights: Option<HashMap<&str, f64>> = weights.map(Iterator::collect);
        let weight = |name: &str| weights.as_ref().map_or(Some(1.0), |weights| weights.get(name).copied());
        let mut matched =
            Self { names: vec![], columns: vec![], goals: Goals::default(), warnings: vec![], notes: vec![] };
        for marker in &opened.markers {
            let both = columns.get(marker.name.as_str()).zip(weight(&marker.name));
            if let Some((&column, weight)) = both {
                let (segment, point) = (marker.segment, marker.point);
                matched.goals.markers.push(MarkerGoal { segment, point, weight });
                matched.names.push(marker.name.clone());
                matched.columns.push(column);
            }
        }
        let of_model: Vec<&str> = opened.markers.iter().map(|marker| marker.name.as_str()).collect();
        let of_file: Vec<&str> = markers.names.iter().map(String::as_str).collect();
        if matched.names.is_empty() {
            let (model, file) = (listed(&of_model), listed(&of_file));
            let tasks = if tasks.is_some() { ", with a task," } else { "" };
            let why = format!("no marker{tasks} is in both files; {shown} has {model}, {name} has {file}");
            return Err(Fail::Refused(format!("{name}: {why}")));
        }
        if matched.goals.markers.iter().all(|marker| marker.weight == 0.0) {
            let count = matched.names.len();
            let why = format!(
                "all {count} markers that are in both files have the weight 0 in the tasks; one must have more"
            );
            return Err(Fail::Refused(format!("{name}: {why}")));
        }
        let weightless = tasks.map_or(&[][..], |tasks| &tasks.weightless);
        if !weightless.is_empty() {
            let list = listed(&weightless.iter().map(String::as_str).collect::<Vec<_>>());
            matched.warnings.push(format!("{} tasks give no weight, which is 0: {list}", weightless.len()));
        }
        matched.compare(&of_model, &of_file, tasks, (shown, name));
        matched.coordinate_goals(&opened.model, tasks, source.tasks)?;
        matched.goals.limits.clone_from(&opened.hard_limits);
        let locked = opened.model.coordinates().iter().enumerate().filter(|(_, coordinate)| coordinate.locked);
        matched.goals.fixed = locked.map(|(index, _)| index).collect();
        Ok(matched)
    }

    /// Leaves out the markers that are not to be kept, in their order.
    pub(crate) fn keep(&mut self, kept: &[bool]) {
        let mut next = kept.iter();
        self.goals.markers.retain(|_| next.next() == Some(&true));
        let mut next = kept.iter();
        self.names.retain(|_| next.next() == Some(&true));
        let mut next = kept.iter();
        self.columns.retain(|_| next.next() == Some(&true));
    }

    /// Says which markers only one of the files has.
    fn compare(
        &mut self,
        of_model: &[&str],
        of_file: &[&str],
        tasks: Option<&TrackingTasks>,
        (model, file): (&str, &str),
    ) {
        let without = |from: &[&str], others: &[&str]| -> Vec<String> {
            from.iter().filter(|name| !others.contains(*name)).map(|name| (*name).to_owned()).collect()
        };
        let (lost, missing) = (without(of_file, of_model), without(of_model, of_file));
        for (names, owner, other) in [(&lost, file, model), (&missing, model, file)] {
            if !names.is_empty() {
                let list = listed(&names.iter().map(String::as_str).collect::<Vec<_>>());
                self.notes.push(format!("{} markers of {owner} are not in {other}: {list}", names.len()));
            }
        }
        let similar = |name: &String| {
            let meant = nearest(name, missing.iter().map(String::as_str))?;
            Some(format!("the marker `{name}` of {file} is not in {model}; is it `{meant}` there?"))
        };
        self.warnings.extend(lost.iter().filter_map(similar));
        let tasks = tasks.map_or(&[][..], |tasks| &tasks.markers);
        let idle = tasks.iter().filter(|task| !self.names.contains(&task.name)).map(|task| task.name.as_str());
        let idle: Vec<&str> = idle.collect();
        if !idle.is_empty() {
            let text = format!("{} tasks have no marker in both files and are not used: {}", idle.len(), listed(&idle));
            self.notes.push(text);
        }
    }

    fn coordinate_goals(&mut self, model: &Model, tasks: Option<&TrackingTasks>, file: &str) -> Result<(), Fail> {
        for task in tasks.map_or(&[][..], |tasks| &tasks.coordinates) {
            let Some(coordinate) = model.coordinate(&task.name) else {
                let meant = nearest(&task.name, model.coordinates().iter().map(|c| c.name.as_str()));
                let meant = meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"));
                let (line, column) = (task.place.line, task.place.column);
                let why = format!("the task's coordinate `{}` is not in the model{meant}", task.name);
                return Err(Fail::Refused(format!("{file}:{line}:{column}: {why}")));
            };
            let value = match task.value {
                TaskValue::Default => model.coordinates()[coordinate].default,
                TaskValue::Manual(value) => value,
            };
            self.goals.coordinates.push(CoordinateGoal { coordinate, value, weight: task.weight });
        }
        Ok(())
    }
}

/// The first names of a list.
pub(crate) fn listed(names: &[&str]) -> String {
    let more = if names.len() > MOST_NAMES { ", ..." } else { "" };
    let shown: Vec<String> = names.iter().take(MOST_NAMES).map(|name| format!("`{name}`")).collect();
    format!("{}{more}", shown.join(", "))
}

/// A distance in words.
pub(crate) fn length(metres: f64) -> String {
    match metres {
        m if m < 1e-3 => format!("{:.2} mm", 1e3 * m),
        m if m < 0.1 => format!("{:.1} mm", 1e3 * m),
        m if m < 1.0 => format!("{:.1} cm", 1e2 * m),
        m => format!("{m:.1} m"),
    }
}
