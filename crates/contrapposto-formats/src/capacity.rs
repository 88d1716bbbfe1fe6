//! Writes the greatest forces at a point as `capacity.json` and `capacity.csv`.

use std::fmt::Write;

use contrapposto::capacity::{GreatestForce, Limit, Limiter};
use contrapposto::model::{Model, Side};
use contrapposto::verdict::Who;
use serde::Serialize;

use crate::VerdictText;

/// The whole file. Directions, normals and places are in ground axes.
#[derive(Clone, Debug, Serialize)]
pub struct CapacityText {
    /// Title of the scenario.
    pub title: String,
    /// Name of the body.
    pub model: String,
    /// The posture: `posed`, or `simulated, 120 s`.
    pub posture: String,
    /// The answer to the posture without a force.
    pub verdict: VerdictText,
    /// The finding in one sentence.
    pub sentence: String,
    /// Segment and point that exert the force.
    pub at: AtText,
    /// Time for which the force is held, s; `null` for an instant.
    pub hold_s: Option<f64>,
    /// The direction with the least force; `null` where the posture cannot be held.
    pub weakest: Option<ForceText>,
    /// The direction with the greatest force, likewise.
    pub strongest: Option<ForceText>,
    /// Forward, back, up, down, left and right.
    pub main: Vec<ForceText>,
    /// 642 directions.
    pub directions: Vec<ForceText>,
    /// Triangles between these directions, by index, seen counterclockwise from outside.
    pub faces: Vec<[usize; 3]>,
    /// The assumptions of the computation, a sentence each.
    pub assumptions: Vec<String>,
    /// Files beside this one.
    pub files: Vec<String>,
}

/// A point of the body.
#[derive(Clone, Debug, Serialize)]
pub struct AtText {
    /// The segment.
    pub segment: String,
    /// The point in its frame, m.
    pub point_m: [f64; 3],
    /// The point in ground, m.
    pub place_m: Option<[f64; 3]>,
}

/// The greatest force in a direction.
#[derive(Clone, Debug, Serialize)]
pub struct ForceText {
    /// The direction in words.
    pub toward: String,
    /// The direction in which the body pushes, of length 1.
    pub direction: [f64; 3],
    /// The force of the mean person, N; `null` without a limit.
    pub force_n: Option<f64>,
    /// The force of people whose strength is one standard deviation below the mean, N; 0 where they cannot hold the posture.
    pub weaker_n: Option<f64>,
    /// The force of people one above.
    pub stronger_n: Option<f64>,
    /// The limits of the force, the one with the largest share first.
    pub limits: Vec<LimitText>,
    /// Every force `f` that can be exerted has `normal . f <= force_n`.
    pub normal: [f64; 3],
}

/// A limit of a force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitText {
    /// `strength`, `balance` or `friction`.
    pub kind: &'static str,
    /// The muscle group in words, of a strength.
    pub group: Option<String>,
    /// Coordinate of the limit.
    pub coordinate: Option<String>,
    /// `positive` or `negative`.
    pub side: Option<&'static str>,
    /// Relative change of the force per relative change of the limit.
    pub share: f64,
}

impl LimitText {
    /// Of a limit of a body.
    pub fn new(model: &Model, limit: &Limit) -> Self {
        let (kind, group) = match limit.by {
            Limiter::Strength { coordinate, side } => ("strength", Some((coordinate, side))),
            Limiter::Balance => ("balance", None),
            Limiter::Friction => ("friction", None),
        };
        Self {
            kind,
            group: group.map(|(coordinate, side)| Who { coordinate, side, load: 0.0 }.name(model)),
            coordinate: group.map(|(coordinate, _)| model.coordinates()[coordinate].name.clone()),
            side: group.map(|(_, side): (usize, Side)| side.word()),
            share: limit.share,
        }
    }

    /// `right shoulder flexion`, `balance`.
    pub fn name(&self) -> &str {
        self.group.as_deref().unwrap_or(self.kind)
    }
}

impl ForceText {
    /// Of the mean person's force in a direction, with those of weaker and stronger people, N.
    pub fn new(model: &Model, greatest: &GreatestForce, toward: String, [weaker, stronger]: [f64; 2]) -> Self {
        let finite = |force: f64| force.is_finite().then_some(force);
        Self {
            toward,
            direction: greatest.direction.into(),
            force_n: finite(greatest.force),
            weaker_n: finite(weaker),
            stronger_n: finite(stronger),
            limits: greatest.limits.iter().map(|limit| LimitText::new(model, limit)).collect(),
            normal: greatest.normal.into(),
        }
    }
}

impl CapacityText {
    /// One row a direction; an empty field for a force without a limit.
    pub fn csv(&self) -> String {
        let mut csv = "direction_x,direction_y,direction_z,force_n,weaker_n,stronger_n,limit,share\n".to_owned();
        let number = |force: Option<f64>| force.map_or(String::new(), |force| force.to_string());
        for force in &self.directions {
            let [x, y, z] = force.direction;
            let [mean, weaker, stronger] = [force.force_n, force.weaker_n, force.stronger_n].map(number);
            let limit = force.limits.first();
            let name = limit.map_or(String::new(), |limit| crate::motion::csv_cell(limit.name()));
            let share = number(limit.map(|limit| limit.share));
            let _ = writeln!(csv, "{x},{y},{z},{mean},{weaker},{stronger},{name},{share}");
        }
        csv
    }
}
