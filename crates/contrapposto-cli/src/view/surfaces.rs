//! Computes the surfaces that a body rests on: the ground, and seats, tables and walls as flat pieces around the patches.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_report::Surface;
use nalgebra::Vector3;

use super::axes::Turn;
use super::frame::Frame;
use super::stage::{Stage, carries};
use crate::fail::Fail;

/// Planes that are nearer to each other, m, are one.
const SAME_PLANE: f64 = 0.02;
/// So little of the body, m, may be below the ground.
const SUNK: f64 = 0.05;
/// A piece is so much larger than the patches on it, on every side, m.
const MARGIN: f64 = 0.1;
/// The least width of a piece, m.
const WIDTH: f64 = 0.4;

/// The ground, and all other surfaces.
pub(super) struct Surroundings {
    /// Height, m, where there is a ground.
    pub(super) ground: Option<f64>,
    /// The pieces, their corners counter-clockwise as seen from the body, m.
    pub(super) surfaces: Vec<Surface>,
}

/// A support in page axes.
struct Patch {
    normal: Vector3<f64>,
    points: Vec<Vector3<f64>>,
    /// Name of what carries it.
    label: String,
    /// A thing that is drawn carries it.
    on_thing: bool,
}

/// A plane, and the corners of patches on it; page axes.
struct Plane {
    normal: Vector3<f64>,
    points: Vec<Vector3<f64>>,
    /// Name of what carries the first of the patches.
    label: String,
    /// Things that are drawn carry all patches on it.
    on_things: bool,
}

impl Plane {
    fn of(patch: Patch) -> Self {
        Self { normal: patch.normal, points: patch.points, label: patch.label, on_things: patch.on_thing }
    }

    fn height(&self) -> f64 {
        self.points.iter().map(|point| self.normal.dot(point)).sum::<f64>() / self.points.len() as f64
    }

    fn is(&self, other: &Self) -> bool {
        self.normal.dot(&other.normal) > 0.999 && (self.height() - other.height()).abs() < SAME_PLANE
    }

    fn is_level(&self) -> bool {
        self.normal.y > 0.999
    }

    /// A rectangle about all points: its sides level or upright.
    fn piece(&self) -> Surface {
        let n = self.normal;
        let level = if n.y.abs() > 0.9 { n.cross(&Vector3::z()) } else { Vector3::y().cross(&n) };
        let u = -level.normalize();
        let v = n.cross(&u);
        let side = |axis: Vector3<f64>| {
            let along = self.points.iter().map(|point| axis.dot(point));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            let more = MARGIN.max(0.5 * (WIDTH - (high - low)));
            [low - more, high + more]
        };
        let (along, across, height) = (side(u), side(v), self.height());
        let corner = |a: usize, b: usize| (u * along[a] + v * across[b] + n * height).into();
        let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        Surface { label: self.label.clone(), corners }
    }
}

/// Surfaces under the supports at the start. Pieces that the body moves about with are none.
pub(super) fn surroundings(
    model: &Model,
    stage: &Stage<'_>,
    start: &[f64],
    frames: &[Frame],
    turn: &Turn,
) -> Result<Surroundings, Fail> {
    let supports = stage.supports;
    let mut kinematics = Kinematics::new(model);
    let carriers = stage.carriers(model, start);
    let mut place = |posture: &[f64]| -> Result<Vec<Patch>, Fail> {
        kinematics.update(model, &Posture::new(posture.to_vec())).map_err(|error| Fail::job("report", error))?;
        let patch = |(support, carrier): (&Support, &Option<String>)| {
            let corners = support.corners.iter().map(|corner| kinematics.station(model, support.segment, *corner));
            let corners: Vec<Vector3<f64>> = corners.collect();
            let name = &model.segments()[support.segment].name;
            let on_thing = stage.things.iter().any(|thing| carries(thing, name, &corners));
            let label = carrier.clone().unwrap_or_else(|| "surface".to_owned());
            let points = corners.iter().map(|corner| turn.0 * corner).collect();
            Patch { normal: turn.0 * support.normal, points, label, on_thing }
        };
        Ok(supports.iter().zip(&carriers).map(patch).collect())
    };
    let mut planes: Vec<Plane> = vec![];
    let at_start = place(start)?;
    let mut still = vec![true; at_start.len()];
    for frame in frames {
        for (i, Patch { normal, points, .. }) in place(&frame.posture)?.iter().enumerate() {
            let moved = |(now, then): (&Vector3<f64>, &Vector3<f64>)| normal.dot(&(now - then)).abs() >= SAME_PLANE;
            still[i] &= !points.iter().zip(&at_start[i].points).any(moved);
        }
    }
    for (patch, _) in at_start.into_iter().zip(still).filter(|(_, still)| *still) {
        let (new, mut known) = (Plane::of(patch), planes.iter_mut());
        match known.find(|plane| plane.is(&new)) {
            Some(plane) => {
                plane.points.extend(new.points);
                plane.on_things &= new.on_things;
            }
            None => planes.push(new),
        }
    }
    kinematics.update(model, &Posture::new(start.to_vec())).map_err(|error| Fail::job("report", error))?;
    let heights = (0..model.segments().len()).map(|s| turn.point(kinematics.placement(model, s).translation.vector)[1]);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    let ground = planes.iter().filter(|plane| plane.is_level()).map(Plane::height).min_by(f64::total_cmp);
    let ground = ground.filter(|height| *height < lowest + SUNK);
    let other =
        |plane: &&Plane| !(plane.is_level() && ground.is_some_and(|height| plane.height() < height + SAME_PLANE));
    let surfaces = planes.iter().filter(other).filter(|plane| !plane.on_things).map(Plane::piece).collect();
    Ok(Surroundings { ground: ground.or_else(|| pushed_from(supports, frames, turn)), surfaces })
}

/// Height of the floor of measured forces: that of the lowest point at which one acts.
fn pushed_from(supports: &[Support], frames: &[Frame], turn: &Turn) -> Option<f64> {
    if !supports.is_empty() {
        return None;
    }
    let contacts = frames.iter().filter_map(|frame| frame.standing.as_ref()).flat_map(|s| &s.contacts);
    contacts.filter_map(|contact| Some(turn.point(contact.center_of_pressure?)[1])).min_by(f64::total_cmp)
}
