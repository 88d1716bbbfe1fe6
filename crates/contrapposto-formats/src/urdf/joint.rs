//! Reads one `<joint>`.

use super::attributes::{name_place, number, origin, required, required_child, vector};
use super::error::{UrdfError, UrdfRule};
use crate::model_ir::{CoordinateIr, CoordinateKind, Drive, Ignored, MOST_STRENGTH, ModelIr, MotionIr, StrengthIr};
use crate::xml::Node;
use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    Fixed,
    Floating,
    Planar,
}

pub(super) struct Joint<'a> {
    pub(super) node: Node<'a>,
    pub(super) name: &'a str,
    pub(super) parent: (Node<'a>, &'a str),
    pub(super) child: (Node<'a>, &'a str),
    pub(super) origin: Isometry3<f64>,
    pub(super) mimic: Option<Mimic<'a>>,
    kind: Kind,
    axis: Unit<Vector3<f64>>,
    range: (f64, f64),
    /// Greatest torque of its motor, N m, if the file gives one above 0.
    effort: Option<f64>,
}

pub(super) struct Mimic<'a> {
    pub(super) node: Node<'a>,
    pub(super) joint: &'a str,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

const UNLIMITED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl<'a> Joint<'a> {
    pub(super) fn read(node: Node<'a>, ignored: &mut Ignored) -> Result<Self, UrdfError> {
        let name = required(node, "name")?;
        let (kind, limited) = match required(node, "type")? {
            "revolute" => (Kind::Hinge, true),
            "continuous" => (Kind::Hinge, false),
            "prismatic" => (Kind::Slide, true),
            "fixed" => (Kind::Fixed, false),
            "floating" => (Kind::Floating, false),
            "planar" => (Kind::Planar, false),
            other => {
                let value = crate::xml::shorten(other);
                return Err(UrdfError::JointType { place: node.attribute_place("type"), value });
            }
        };
        let end = |tag| -> Result<_, UrdfError> {
            let end = required_child(node, tag)?;
            Ok((end, required(end, "link")?))
        };
        let (parent, child) = (end("parent")?, end("child")?);
        for part in node.children() {
            if !matches!(part.name(), "parent" | "child" | "origin" | "axis" | "limit" | "mimic") {
                ignored.add(part.name(), 1);
            }
        }
        let mut axis = Vector3::x_axis();
        if let Some(part) = node.child("axis")
            && !matches!(kind, Kind::Fixed | Kind::Floating)
        {
            let given = vector(part, "xyz")?.unwrap_or(Vector3::x());
            axis = crate::model_ir::unit(given).ok_or_else(|| UrdfError::Invalid {
                place: part.attribute_place("xyz"),
                value: part.attribute("xyz").unwrap_or_default().trim().to_owned(),
                needs: UrdfRule::AxisLength,
            })?;
        }
        let range = if limited { limits(required_child(node, "limit")?)? } else { UNLIMITED };
        let mimic = match node.child("mimic") {
            None => None,
            Some(part) if matches!(kind, Kind::Hinge | Kind::Slide) => Some(Mimic {
                node: part,
                joint: required(part, "joint")?,
                multiplier: number(part, "multiplier")?.unwrap_or(1.0),
                offset: number(part, "offset")?.unwrap_or(0.0),
            }),
            // Of a joint that was made fixed: it moves nothing.
            Some(_) if kind == Kind::Fixed => {
                ignored.add("mimic of a fixed joint", 1);
                None
            }
            Some(part) => {
                let value = name.to_owned();
                return Err(UrdfError::Invalid { place: part.place(), value, needs: UrdfRule::MimicKind });
            }
        };
        let effort = effort(node, kind, ignored)?;
        Ok(Self { node, name, parent, child, origin: origin(node)?, mimic, kind, axis, range, effort })
    }

    /// Whether one coordinate moves it, so that another joint can mimic it.
    pub(super) fn is_single(&self) -> bool {
        matches!(self.kind, Kind::Hinge | Kind::Slide)
    }

    /// Adds the joint's coordinates and gives its motions.
    pub(super) fn motions(&self, body: &mut ModelIr, cap: usize) -> Result<Vec<MotionIr>, UrdfError> {
        let first = body.coordinates.len();
        let mut add = |name: String, kind, range: (f64, f64)| {
            let clamped = range != UNLIMITED;
            body.coordinates.push(CoordinateIr { name, kind, range, default: 0.0, locked: false, clamped });
        };
        let own = |i| Drive::Coordinate(first + i);
        let axis = self.axis.into_inner();
        let motions = match self.kind {
            Kind::Fixed => vec![],
            Kind::Hinge => {
                add(self.name.to_owned(), CoordinateKind::Rotation, self.range);
                body.strength.extend(self.effort.map(|effort| StrengthIr { coordinate: first, torque: [effort; 2] }));
                vec![MotionIr::Hinge { axis, drive: own(0) }]
            }
            Kind::Slide => {
                add(self.name.to_owned(), CoordinateKind::Translation, self.range);
                vec![MotionIr::Slide { axis, drive: own(0) }]
            }
            Kind::Planar => {
                // In the plane across the axis: for z, along x and y. Other axes by the shortest turn from z.
                let turn = UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &self.axis)
                    .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
                add(format!("{}_tx", self.name), CoordinateKind::Translation, UNLIMITED);
                add(format!("{}_ty", self.name), CoordinateKind::Translation, UNLIMITED);
                add(format!("{}_rz", self.name), CoordinateKind::Rotation, UNLIMITED);
                vec![
                    MotionIr::Slide { axis: turn * Vector3::x(), drive: own(0) },
                    MotionIr::Slide { axis: turn * Vector3::y(), drive: own(1) },
                    MotionIr::Hinge { axis, drive: own(2) },
                ]
            }
            Kind::Floating => body.free_joint(self.name, &Isometry3::identity()),
        };
        if body.coordinates.len() > cap {
            return Err(UrdfError::TooManyCoordinates { place: name_place(self.node), cap });
        }
        Ok(motions)
    }
}

fn limits(limit: Node<'_>) -> Result<(f64, f64), UrdfError> {
    let lower = number(limit, "lower")?.unwrap_or(0.0);
    let upper = number(limit, "upper")?.unwrap_or(0.0);
    if lower > upper {
        let value = format!("{lower} {upper}");
        return Err(UrdfError::Invalid { place: limit.attribute_place("lower"), value, needs: UrdfRule::LimitOrder });
    }
    Ok((lower, upper))
}

/// The greatest torque of a hinge. Files that know none write 0 there: these are counted.
fn effort(joint: Node<'_>, kind: Kind, ignored: &mut Ignored) -> Result<Option<f64>, UrdfError> {
    let effort = joint.child("limit").map_or(Ok(None), |limit| number(limit, "effort"))?;
    let limited = effort.filter(|effort| *effort > 0.0 && *effort <= MOST_STRENGTH);
    match kind {
        Kind::Hinge => {
            let unknown = effort.is_some() && limited.is_none();
            ignored.add("effort that is no torque above 0 and at most 1e6 N m", usize::from(unknown));
            Ok(limited)
        }
        Kind::Slide => {
            ignored.add("effort of a slide", usize::from(limited.is_some()));
            Ok(None)
        }
        _ => Ok(None),
    }
}
