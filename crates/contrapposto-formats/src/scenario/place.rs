//! Reads the places that a support may take.
//!
//! Without numbers of the file a patch beside another one on the same plane keeps to its own side and to within two of its lengths:
//! a foot does not cross the other one. All shares and angles here are assumed.

use contrapposto::contact::{Place, Region, Support};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use nalgebra::Vector3;

use super::ball::sole;
use super::task_text::{HeelText, NamedPlaceText, PlaceText, RegionText, SupportText};
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// Greatest distance of a patch ahead of the other one or behind it, or sideways beyond the least gap, in lengths of the patch.
const REACH_IN_LENGTHS: f64 = 2.0;
/// Least gap between two patches side by side, m.
const LEAST_GAP: f64 = 0.02;
/// Greatest distance that a patch without another one beside it may be moved, m.
const ALONE_REACH: f64 = 0.15;
/// Greatest angle of a patch inward and outward, and of one without another one beside it either way, deg.
const INWARD_DEG: f64 = 10.0;
const OUTWARD_DEG: f64 = 40.0;
/// Normals count as parallel if the cosine between them is greater.
const SAME_NORMAL: f64 = 0.999;
/// Planes count as one surface to stand on if they are no farther apart, m.
const SAME_SURFACE: f64 = 0.25;

/// Sets the places of all supports as their texts ask, in the posture of `kinematics`.
pub(super) fn set_places(
    at: &Located,
    (model, kinematics): (&Model, &Kinematics),
    texts: &[&SupportText],
    supports: &mut [Support],
) -> Result<(), InputError> {
    for (i, text) in texts.iter().enumerate() {
        supports[i].place = place(at, (model, kinematics), supports, i, (text, texts))?;
    }
    Ok(())
}

/// The place of support number `i`, all `supports` at their start.
fn place(
    at: &Located,
    (model, kinematics): (&Model, &Kinematics),
    supports: &[Support],
    i: usize,
    (text, texts): (&SupportText, &[&SupportText]),
) -> Result<Place, InputError> {
    let region = match &text.place {
        PlaceText::Named(NamedPlaceText::Start) => return Ok(Place::Fixed),
        PlaceText::Named(NamedPlaceText::Free) => &RegionText::default(),
        PlaceText::Region(region) => region,
    };
    let default = default_region(model, kinematics, (supports, texts), i);
    let corners = match &region.corners_m {
        Some(corners) => corners_of_file(at, i, corners)?,
        None => default.corners,
    };
    let turn = region.turn_deg.map_or(default.turn, |[least, greatest]| (least.to_radians(), greatest.to_radians()));
    if let Some([least, greatest]) = region.turn_deg
        && !((-90.0..=0.0).contains(&least) && (0.0..=90.0).contains(&greatest))
    {
        let message = format!("turn_deg is {}..{}; it must hold 0 and lie in -90..90", shown(least), shown(greatest));
        return Err(at.error(&["support", &i.to_string(), "place"], message, None));
    }
    Ok(Place::Free(Region { corners, turn }))
}

fn corners_of_file(at: &Located, i: usize, corners: &[[f64; 3]]) -> Result<Vec<Vector3<f64>>, InputError> {
    let error = |message: String| Err(at.error(&["support", &i.to_string(), "place"], message, None));
    if corners.len() < 3 {
        return error(format!("corners_m has {} corners; a region has three or more", corners.len()));
    }
    match corners.iter().flatten().find(|value| value.abs() > LARGEST) {
        Some(value) => error(format!("a corner of the region is at {} m; 1e9 at most", shown(*value))),
        None => Ok(corners.iter().copied().map(Vector3::from).collect()),
    }
}

/// The region of support number `i` without numbers of the file. Feet whose heel is free have the regions of their soles, each as far from
/// the middle of the ball as from that of the sole at the start.
fn default_region(
    model: &Model,
    kinematics: &Kinematics,
    (supports, texts): (&[Support], &[&SupportText]),
    i: usize,
) -> Region {
    let whole = |(support, text): (&Support, &&SupportText)| match text.heel {
        HeelText::Free => sole(model, support).unwrap_or_else(|| support.clone()),
        HeelText::Down => support.clone(),
    };
    let whole: Vec<Support> = supports.iter().zip(texts).map(whole).collect();
    let middle = |support: &Support| kinematics.station(model, support.segment, support.middle());
    let mut region = region_beside_others(model, kinematics, &whole, i);
    let ahead = middle(&supports[i]) - middle(&whole[i]);
    region.corners.iter_mut().for_each(|corner| *corner += ahead);
    region
}

/// The region of a support beside the nearest other one on the same surface.
fn region_beside_others(model: &Model, kinematics: &Kinematics, supports: &[Support], i: usize) -> Region {
    let support = &supports[i];
    let normal = support.normal;
    let own = Patch::of(model, kinematics, support);
    let others = supports.iter().enumerate().filter(|(k, other)| *k != i && other.normal.dot(&normal) > SAME_NORMAL);
    let others = others.map(|(_, other)| (other, Patch::of(model, kinematics, other)));
    let others = others.filter(|(_, other)| normal.dot(&(other.middle - own.middle)).abs() <= SAME_SURFACE);
    let distance = |patch: &Patch| (patch.middle - own.middle).norm();
    let nearest = others.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
    // Segments of feet have their x axis ahead in OpenSim's and ROS's models alike.
    let forward = kinematics.direction(model, support.segment, Vector3::x());
    let ahead = own.long_axis(normal);
    let ahead = if ahead.dot(&forward) < 0.0 { -ahead } else { ahead };
    let across = normal.cross(&ahead);
    let rectangle = |from: Vector3<f64>, [(a, b), (c, d)]: [(f64, f64); 2], aside: Vector3<f64>| {
        [(a, c), (b, c), (b, d), (a, d)].map(|(x, y)| from + x * ahead + y * aside).to_vec()
    };
    let Some((other, beside)) = nearest else {
        let either = (-ALONE_REACH, ALONE_REACH);
        let turn = OUTWARD_DEG.to_radians();
        return Region { corners: rectangle(own.middle, [either, either], across), turn: (-turn, turn) };
    };
    let way = own.middle - beside.middle;
    let aside = if across.dot(&way) < 0.0 { -across } else { across };
    // Two free patches keep to their sides of the line half way.
    let (from, width) = match other.place {
        Place::Fixed => (beside.middle, own.half_breadth(aside) + beside.half_breadth(aside) + LEAST_GAP),
        Place::Free(_) => (beside.middle + 0.5 * way, own.half_breadth(aside) + 0.5 * LEAST_GAP),
    };
    let reach = REACH_IN_LENGTHS * own.length(ahead);
    let least = width.min(aside.dot(&(own.middle - from)));
    let (inward, outward) = (INWARD_DEG.to_radians(), OUTWARD_DEG.to_radians());
    // About the normal the patch turns from `ahead` toward `across`.
    let turn = if aside == across { (-inward, outward) } else { (-outward, inward) };
    Region { corners: rectangle(from, [(-reach, reach), (least, least + reach)], aside), turn }
}

/// Corners of a patch in ground, m.
struct Patch {
    corners: Vec<Vector3<f64>>,
    middle: Vector3<f64>,
}

impl Patch {
    fn of(model: &Model, kinematics: &Kinematics, support: &Support) -> Self {
        let station = |point: &Vector3<f64>| kinematics.station(model, support.segment, *point);
        Self { corners: support.corners.iter().map(station).collect(), middle: station(&support.middle()) }
    }

    /// The direction of the plane along which the corners lie farthest from the middle, in the sum of squares.
    fn long_axis(&self, normal: Vector3<f64>) -> Vector3<f64> {
        let u = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        let v = normal.cross(&u);
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        for corner in &self.corners {
            let (a, b) = (u.dot(&(corner - self.middle)), v.dot(&(corner - self.middle)));
            (uu, uv, vv) = (uu + a * a, uv + a * b, vv + b * b);
        }
        let angle = 0.5 * libm::atan2(2.0 * uv, uu - vv);
        libm::cos(angle) * u + libm::sin(angle) * v
    }

    fn length(&self, along: Vector3<f64>) -> f64 {
        2.0 * self.half_breadth(along)
    }

    fn half_breadth(&self, along: Vector3<f64>) -> f64 {
        self.corners.iter().fold(0.0, |most, corner| most.max(along.dot(&(corner - self.middle)).abs()))
    }
}
