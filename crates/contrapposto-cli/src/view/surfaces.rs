//! Computes the surfaces that a body rests on: the ground, and seats, tables and walls as flat pieces around the patches.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use nalgebra::Vector3;

use super::axes::Turn;
use super::frame::Frame;
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
    /// Corners of each piece, counter-clockwise as seen from the body, m.
    pub(super) surfaces: Vec<[[f64; 3]; 4]>,
}

/// The normal of a support, and where its corners are.
type Patch = (Vector3<f64>, Vec<Vector3<f64>>);

/// A plane, and the corners of patches on it; page axes.
struct Plane {
    normal: Vector3<f64>,
    points: Vec<Vector3<f64>>,
}

impl Plane {
    fn height(&self) -> f64 {
        self.points.iter().map(|point| self.normal.dot(point)).sum::<f64>() / self.points.len() as f64
    }

    fn is_level(&self) -> bool {
        self.normal.y > 0.999
    }

    /// A rectangle about all points: its sides level or upright.
    fn piece(&self) -> [[f64; 3]; 4] {
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
        [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]
    }
}

/// Where supports are at the start. Pieces that the body moves about with are none.
pub(super) fn surroundings(
    model: &Model,
    supports: &[Support],
    start: &[f64],
    frames: &[Frame],
    turn: &Turn,
) -> Result<Surroundings, Fail> {
    let mut kinematics = Kinematics::new(model);
    let mut place = |posture: &[f64]| -> Result<Vec<Patch>, Fail> {
        kinematics.update(model, &Posture::new(posture.to_vec())).map_err(|error| Fail::job("report", error))?;
        let patch = |support: &Support| {
            let corner = |c: &Vector3<f64>| turn.0 * kinematics.station(model, support.segment, *c);
            (turn.0 * support.normal, support.corners.iter().map(corner).collect())
        };
        Ok(supports.iter().map(patch).collect())
    };
    let mut planes: Vec<Plane> = vec![];
    let at_start = place(start)?;
    let mut still = vec![true; at_start.len()];
    for frame in frames {
        for (i, (normal, points)) in place(&frame.posture)?.iter().enumerate() {
            still[i] &=
                points.iter().zip(&at_start[i].1).all(|(now, then)| normal.dot(&(now - then)).abs() < SAME_PLANE);
        }
    }
    for ((normal, points), _) in at_start.into_iter().zip(still).filter(|(_, still)| *still) {
        let height = Plane { normal, points: points.clone() }.height();
        let same =
            |plane: &&mut Plane| plane.normal.dot(&normal) > 0.999 && (plane.height() - height).abs() < SAME_PLANE;
        match planes.iter_mut().find(same) {
            Some(plane) => plane.points.extend(points),
            None => planes.push(Plane { normal, points }),
        }
    }
    kinematics.update(model, &Posture::new(start.to_vec())).map_err(|error| Fail::job("report", error))?;
    let heights = (0..model.segments().len()).map(|s| turn.point(kinematics.placement(model, s).translation.vector)[1]);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    let ground = planes.iter().filter(|plane| plane.is_level()).map(Plane::height).min_by(f64::total_cmp);
    let ground = ground.filter(|height| *height < lowest + SUNK);
    let other =
        |plane: &&Plane| !(plane.is_level() && ground.is_some_and(|height| plane.height() < height + SAME_PLANE));
    let surfaces = planes.iter().filter(other).map(Plane::piece).collect();
    Ok(Surroundings { ground: ground.or_else(|| pushed_from(supports, frames, turn)), surfaces })
}

/// Where forces that were measured come from: the height of the lowest one.
fn pushed_from(supports: &[Support], frames: &[Frame], turn: &Turn) -> Option<f64> {
    if !supports.is_empty() {
        return None;
    }
    let contacts = frames.iter().filter_map(|frame| frame.standing.as_ref()).flat_map(|s| &s.contacts);
    contacts.filter_map(|contact| Some(turn.point(contact.center_of_pressure?)[1])).min_by(f64::total_cmp)
}
