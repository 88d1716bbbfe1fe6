//! Writes a model as a URDF file.
//!
//! One joint for each hinge and slide, named after its coordinate, with links without mass between those of one chain.
//! URDF has no gravity; its programs take 9.81 m/s^2 along -z. Where the model's gravity points elsewhere the file's ground is
//! turned: with `R` the shortest turn from the direction of gravity to -z, a point of ours at `x` stands at `R x`.
//! For the built-in adult (y up) it is a right angle about x: our (x, y, z) is (x, -z, y). Coordinates and torques stay the
//! same, being counted from segment to segment.

use contrapposto::model::{Coordinate, JointKind, Model, Motion, Placement, Segment};
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use super::law;
use super::mjcf_body::ball_of_size;
use super::names::Names;
use super::steps::{By, moved, steps};
use super::xml::{Xml, moments, number, numbers};
use super::{PLACEHOLDER_EFFORT, PLACEHOLDER_LIMIT, PLACEHOLDER_VELOCITY, WriteError, Written, common, exact, listed};
use crate::model_ir::{FREE_ENDINGS, Function};
use crate::urdf::GRAVITY;

/// Writes the model as a URDF file. Effort limits are the greater peak strength of a coordinate's two groups.
///
/// Lost: passive laws, couplings that are not linear, defaults, locks, names of joints with several coordinates, size of gravity.
///
/// # Errors
/// [`WriteError`] for balls (other than a free joint's) and for joints that functions drive, which URDF has not.
pub fn urdf(model: &Model) -> Result<Written, WriteError> {
    let mut lost = common(model, |[positive, negative]| positive == negative)?;
    let mut writer = Writer::new(model, &mut lost);
    writer.xml.comment("Gravity is taken to be 9.81 m/s^2 along -z. Speed limits are placeholders.");
    let name = if model.name().is_empty() { "model" } else { model.name() };
    writer.xml.open("robot", &[("name", name)]);
    let turn = upright(model.gravity());
    if turn != UnitQuaternion::identity() {
        lost.push("The ground is turned so that gravity points along -z.".to_owned());
    }
    let size = model.gravity().norm();
    if size != GRAVITY {
        lost.push(format!("Gravity is {} m/s^2; URDF programs take {GRAVITY} m/s^2.", number(size)));
    }
    let roots: Vec<&Segment> = model.segments().iter().filter(|s| s.parent.is_none()).collect();
    let own_root = |s: &Segment| {
        s.joint_kind == JointKind::Weld && [s.in_parent, s.in_segment].iter().all(|p| *p == Placement::identity())
    };
    let root = match roots[..] {
        [root] if own_root(root) && turn == UnitQuaternion::identity() => None,
        _ => Some(writer.links.take("ground")),
    };
    if let Some(root) = &root {
        writer.xml.leaf("link", &[("name", root)]);
    }
    for (index, segment) in model.segments().iter().enumerate() {
        let parent = match segment.parent {
            Some(p) => writer.names[p].clone(),
            None => match &root {
                Some(root) => root.clone(),
                None => {
                    let name = writer.names[index].clone();
                    writer.link(&name, Some(segment), &mut lost);
                    continue;
                }
            },
        };
        let start = if segment.parent.is_none() { turn * segment.in_parent } else { segment.in_parent };
        writer.segment(index, parent, start, &mut lost)?;
    }
    writer.losses(&mut lost);
    Ok(Written { text: writer.xml.finish(&lost), lost })
}

/// The shortest turn that takes the direction of gravity to -z.
fn upright(gravity: Vector3<f64>) -> UnitQuaternion<f64> {
    let down = -Vector3::z();
    if gravity.norm() == 0.0 || gravity.x == 0.0 && gravity.y == 0.0 && gravity.z < 0.0 {
        return UnitQuaternion::identity();
    }
    if gravity.x == 0.0 && gravity.z == 0.0 && gravity.y < 0.0 {
        return UnitQuaternion::from_euler_angles(std::f64::consts::FRAC_PI_2, 0.0, 0.0);
    }
    UnitQuaternion::rotation_between(&gravity, &down)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

struct Writer<'m> {
    model: &'m Model,
    xml: Xml,
    /// Of each segment: its link.
    names: Vec<String>,
    links: Names,
    joints: Names,
    /// Of each coordinate: its joint.
    coordinates: Vec<String>,
}

impl<'m> Writer<'m> {
    fn new(model: &'m Model, lost: &mut Vec<String>) -> Self {
        let (mut links, mut joints) = (Names::new(&[], |_| true), Names::new(&[], |_| true));
        let names = model.segments().iter().map(|s| links.keep("segment", &s.name, lost)).collect();
        let mut coordinates = vec![String::new(); model.coordinates().len()];
        for segment in model.segments() {
            let whole = planar(model, segment) || free(segment);
            let free = whole.then_some(segment.joint.as_str());
            let ours = model.coordinates()[segment.coordinates.clone()].iter().map(|c| c.name.as_str());
            if let Some(joint) = free
                && !planar(model, segment)
                && !ours.zip(FREE_ENDINGS).all(|(name, ending)| name == format!("{joint}_{ending}"))
            {
                lost.push(format!("The coordinates of the free joint `{joint}` have no names in the file."));
            }
            for c in segment.coordinates.clone() {
                coordinates[c] = match free {
                    Some(joint) if c == segment.coordinates.start => joints.keep("joint", joint, lost),
                    Some(_) => String::new(),
                    None => joints.keep("coordinate", &model.coordinates()[c].name, lost),
                };
            }
        }
        Self { model, xml: Xml::new(), names, links, joints, coordinates }
    }

    fn link(&mut self, name: &str, segment: Option<&Segment>, lost: &mut Vec<String>) {
        let heavy = segment.filter(|s| s.mass != 0.0 || s.inertia != Matrix3::zeros());
        let Some(segment) = heavy else { return self.xml.leaf("link", &[("name", name)]) };
        self.xml.open("link", &[("name", name)]);
        self.xml.open("inertial", &[]);
        self.xml.leaf("origin", &[("xyz", &numbers(&segment.center_of_mass))]);
        self.xml.leaf("mass", &[("value", &number(segment.mass))]);
        let mut inertia = segment.inertia;
        if inertia.diagonal().min() < 0.0 {
            inertia = ball_of_size(&inertia);
            let changed = "is not that of a solid body; the file has a ball's of that size.";
            lost.push(format!("The inertia of `{name}` {changed}"));
        }
        let values = moments(&inertia).map(number);
        let names = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
        let attributes: Vec<(&str, &str)> = names.into_iter().zip(values.iter().map(String::as_str)).collect();
        self.xml.leaf("inertia", &attributes);
        self.xml.close();
        self.xml.close();
    }

    /// A joint's beginning: all parts but its motion.
    fn joint(&mut self, name: &str, kind: &str, parent: &str, child: &str, origin: &Placement) {
        self.xml.open("joint", &[("name", name), ("type", kind)]);
        self.xml.leaf("parent", &[("link", parent)]);
        self.xml.leaf("child", &[("link", child)]);
        if *origin != Placement::identity() {
            let (xyz, rpy) = (numbers(&origin.translation.vector), numbers(&exact::rpy(&origin.rotation)));
            self.xml.leaf("origin", &[("xyz", &xyz), ("rpy", &rpy)]);
        }
    }

    /// The joints and links of a segment, whose first joint rests at `origin`.
    fn segment(
        &mut self,
        index: usize,
        mut parent: String,
        origin: Placement,
        lost: &mut Vec<String>,
    ) -> Result<(), WriteError> {
        let segment = &self.model.segments()[index];
        let own = self.names[index].clone();
        let planar = planar(self.model, segment);
        let (movers, origin) = movers(segment, planar, origin)?;
        let rest = origin * segment.in_segment.inverse();
        let fixed = movers.is_empty() || rest != Placement::identity();
        let last = movers.len();
        for (n, (origin, motion, c)) in movers.into_iter().enumerate() {
            let name = self.coordinates[c].clone();
            let child =
                if n + 1 == last && !fixed { own.clone() } else { self.links.take(&format!("{own}_at_{name}")) };
            let coordinate = &self.model.coordinates()[c];
            let kind = match motion {
                None if planar => "planar",
                None => "floating",
                Some(Motion::Slide(_)) => "prismatic",
                _ if unlimited(coordinate) => "continuous",
                _ => "revolute",
            };
            self.joint(&name, kind, &parent, &child, &origin);
            if let Some(Motion::Hinge(axis) | Motion::Slide(axis)) = motion {
                self.xml.leaf("axis", &[("xyz", &numbers(&exact::axis(&axis)))]);
                self.limit(coordinate, kind == "continuous", lost);
                self.mimic(c);
            }
            if let (true, Some(Motion::Hinge(axis))) = (planar, segment.joint_kind.motions().last()) {
                self.xml.leaf("axis", &[("xyz", &numbers(&exact::axis(axis)))]);
            }
            self.xml.close();
            self.link(&child, if n + 1 == last && !fixed { Some(segment) } else { None }, lost);
            parent = child;
        }
        if fixed {
            let name = self.joints.take(&segment.joint);
            self.joint(&name, "fixed", &parent, &own, &rest);
            self.xml.close();
            self.link(&own, Some(segment), lost);
        }
        let own_joint = last == 1 && !fixed && self.coordinates[segment.coordinates.start] == segment.joint;
        if !matches!(segment.joint_kind, JointKind::Weld) && !free(segment) && !planar && !own_joint {
            let of: Vec<&str> = segment.coordinates.clone().map(|c| self.coordinates[c].as_str()).collect();
            let (joint, of) = (&segment.joint, listed(&of));
            lost.push(format!("Joint `{joint}` is a chain of joints named after its coordinates: {of}."));
        }
        Ok(())
    }

    fn limit(&mut self, coordinate: &Coordinate, continuous: bool, lost: &mut Vec<String>) {
        let known = coordinate.groups.as_ref().map(|[a, b]| a.strength.peak.max(b.strength.peak));
        let (effort, velocity) = (number(known.unwrap_or(PLACEHOLDER_EFFORT)), number(PLACEHOLDER_VELOCITY));
        let (lower, upper) = coordinate.range;
        let [low, high] = [lower, upper].map(|v| number(v.clamp(-PLACEHOLDER_LIMIT, PLACEHOLDER_LIMIT)));
        let rest = [("effort", effort.as_str()), ("velocity", velocity.as_str())];
        if continuous {
            return self.xml.leaf("limit", &rest);
        }
        if lower.is_infinite() || upper.is_infinite() {
            lost.push(format!(
                "`{}` has no limit on one side or both; the file gives it {PLACEHOLDER_LIMIT:e}.",
                coordinate.name
            ));
        }
        self.xml.leaf("limit", &[("lower", &low), ("upper", &high), rest[0], rest[1]]);
    }

    fn mimic(&mut self, c: usize) {
        let Some(coupling) = self.model.couplings().iter().find(|coupling| coupling.dependent == c) else { return };
        if let Some((slope, intercept)) = linear(&coupling.function) {
            let (multiplier, offset) = (number(slope), number(intercept));
            let independent = self.coordinates[coupling.independent].clone();
            self.xml.leaf("mimic", &[("joint", &independent), ("multiplier", &multiplier), ("offset", &offset)]);
        }
    }

    fn losses(&self, lost: &mut Vec<String>) {
        let coordinates = self.model.coordinates();
        let named = |wanted: &dyn Fn(&Coordinate) -> bool| -> Vec<&str> {
            coordinates.iter().filter(|c| wanted(c)).map(|c| c.name.as_str()).collect()
        };
        let springs =
            named(&|c| c.passive.as_ref().is_some_and(|l| law::summands(l).is_none_or(|parts| !parts.is_empty())));
        let moved = named(&|c| c.rate.is_some() && c.default != 0.0);
        let locked = named(&|c| c.locked);
        for (names, text) in [
            (springs, "Passive torques are not written"),
            (moved, "Defaults other than 0 are not written"),
            (locked, "Locks are not written"),
        ] {
            if !names.is_empty() {
                lost.push(format!("{text}: {}.", listed(&names)));
            }
        }
        for coupling in self.model.couplings().iter().filter(|c| linear(&c.function).is_none()) {
            let [dependent, independent] = [coupling.dependent, coupling.independent].map(|c| &coordinates[c].name);
            lost.push(format!("`{dependent}` follows `{independent}` by a curve; in the file it moves by itself."));
        }
        if coordinates.iter().any(|c| c.rate.is_some()) {
            lost.push(format!("Speed limits of {PLACEHOLDER_VELOCITY} rad/s or m/s are placeholders."));
        }
        if coordinates.iter().any(|c| c.rate.is_some() && c.groups.is_none()) {
            lost.push(format!("Efforts of {PLACEHOLDER_EFFORT} N m or N are placeholders where no strength is known."));
        }
    }
}

/// Whether URDF's floating joint is this one.
fn free(segment: &Segment) -> bool {
    let axes = JointKind::Free.motions();
    match &segment.joint_kind {
        JointKind::Free => true,
        JointKind::Chain(motions) => *motions == axes,
        _ => false,
    }
}

/// Whether URDF's planar joint is this one: two slides across an axis and a hinge about it, without limits.
fn planar(model: &Model, segment: &Segment) -> bool {
    let JointKind::Chain(motions) = &segment.joint_kind else { return false };
    let &[Motion::Slide(x), Motion::Slide(y), Motion::Hinge(axis)] = &motions[..] else { return false };
    let turn = UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    let same = |ours: Unit<Vector3<f64>>, theirs| ours == Unit::new_normalize(turn * theirs);
    let own = &model.coordinates()[segment.coordinates.clone()];
    let plain = |(c, ending): (&Coordinate, _)| c.name == format!("{}_{ending}", segment.joint) && unlimited(c);
    same(x, Vector3::x()) && same(y, Vector3::y()) && own.iter().zip(["tx", "ty", "rz"]).all(plain)
}

fn unlimited(coordinate: &Coordinate) -> bool {
    coordinate.range == (f64::NEG_INFINITY, f64::INFINITY)
}

fn linear(function: &Function) -> Option<(f64, f64)> {
    match function {
        Function::Constant(value) => Some((0.0, *value)),
        Function::Linear { slope, intercept } => Some((*slope, *intercept)),
        _ => None,
    }
}

/// A joint of URDF: its origin in the parent, its motion (none for a floating or planar joint), and its first coordinate.
type Mover = (Placement, Option<Motion>, usize);

/// The moving joints of a segment, and the fixed placement that remains behind them.
fn movers(segment: &Segment, planar: bool, mut origin: Placement) -> Result<(Vec<Mover>, Placement), WriteError> {
    if free(segment) || planar {
        return Ok((vec![(origin, None, segment.coordinates.start)], Placement::identity()));
    }
    let mut movers = vec![];
    for (motion, by) in steps(segment) {
        let refuse = |problem| Err(WriteError::Joint { joint: segment.joint.clone(), problem });
        match (motion, by) {
            (Motion::Ball, _) => return refuse("URDF has no ball joint"),
            (_, By::Function(..)) => return refuse("URDF has no joint that a function drives"),
            (_, By::Fixed(value)) => origin *= moved(motion, value),
            (_, By::Coordinate(c)) => {
                movers.push((std::mem::replace(&mut origin, Placement::identity()), Some(motion), c));
            }
        }
    }
    Ok((movers, origin))
}
