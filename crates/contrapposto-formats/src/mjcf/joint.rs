//! Reads the joints of one body: coordinates, motions and springs.

use super::attributes::Attributes;
use super::compiler::Settings;
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::item::Item;
use super::schema;
use super::value::{Value, check};
use crate::model_ir::{CoordinateIr, CoordinateKind, Drive, ModelIr, MotionIr, PassiveIr, PassiveLawIr, unit};
use nalgebra::{Isometry3, Unit, Vector3};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Free,
    Ball,
    Slide,
    Hinge,
}

/// One joint, resolved.
pub(super) struct Joint<'a> {
    pub(super) item: Item<'a>,
    pub(super) kind: Kind,
    /// Anchor in the body's frame.
    pub(super) anchor: Vector3<f64>,
    /// Axis in the body's frame.
    pub(super) axis: Unit<Vector3<f64>>,
    /// Value at the file's configuration.
    pub(super) reference: f64,
    pub(super) armature: f64,
    /// Time constant and damping ratio.
    pub(super) springdamper: Option<[f64; 2]>,
    /// Least and greatest torque of all its actuators together (N m), of a hinge.
    pub(super) torques: Option<[f64; 2]>,
    range: Option<(f64, f64)>,
    stiffness: [f64; 3],
    rest: f64,
}

const JOINT_KINDS: &[&str] = &["free", "ball", "slide", "hinge"];

impl<'a> Joint<'a> {
    /// `<freejoint>`, which takes no defaults.
    pub(super) fn free(item: Item<'a>) -> Result<Self, MjcfError> {
        check(item, schema::FREE_JOINT)?;
        if let Some(align) = Value::of(item, "align")
            && align.keyword(&["false", "true", "auto"])? == 1
        {
            return Err(Unsupported::AlignFree.at_attribute(item, "align"));
        }
        Ok(Self::new(item, Kind::Free))
    }

    pub(super) fn new(item: Item<'a>, kind: Kind) -> Self {
        Self {
            item,
            kind,
            anchor: Vector3::zeros(),
            axis: Vector3::z_axis(),
            reference: 0.0,
            armature: 0.0,
            springdamper: None,
            torques: None,
            range: None,
            stiffness: [0.0; 3],
            rest: 0.0,
        }
    }

    pub(super) fn read(
        joint: &Attributes<'a, '_>,
        frame: &Isometry3<f64>,
        settings: &Settings,
    ) -> Result<Self, MjcfError> {
        let kind = match joint.get("type").map_or(Ok(3), |v| v.keyword(JOINT_KINDS))? {
            0 => Kind::Free,
            1 => Kind::Ball,
            2 => Kind::Slide,
            _ => Kind::Hinge,
        };
        let mut read = Self::new(joint.item, kind);
        let scale = |value: f64| if kind == Kind::Slide { value } else { settings.angle(value) };
        if let Some(value) = joint.get("axis") {
            let given = frame.rotation * Vector3::from(value.numbers::<3>()?);
            if matches!(kind, Kind::Slide | Kind::Hinge) {
                read.axis = unit(given).ok_or_else(|| value.invalid(MjcfRule::AxisLength))?;
            }
        } else {
            read.axis = frame.rotation * read.axis;
        }
        let anchor = joint.numbers("pos")?.unwrap_or_default();
        read.anchor = (frame * nalgebra::Point3::from(anchor)).coords;
        read.armature = joint.number("armature")?.unwrap_or(0.0);
        if matches!(kind, Kind::Slide | Kind::Hinge) {
            read.reference = scale(joint.number("ref")?.unwrap_or(0.0));
        }
        read.rest = scale(joint.number("springref")?.unwrap_or(0.0));
        if kind == Kind::Hinge {
            read.torques = joint.limits("actuatorfrcrange", "actuatorfrclimited", settings.automatic_limits)?;
        }
        read.range = range(joint, kind, settings)?.map(|[low, high]| (scale(low), scale(high)));
        if settings.springs {
            read.springs(joint)?;
        }
        Ok(read)
    }

    fn springs(&mut self, joint: &Attributes<'a, '_>) -> Result<(), MjcfError> {
        self.stiffness = joint.merged("stiffness")?;
        let mut sprung = self.stiffness != [0.0; 3];
        if let Some(value) = joint.get("springdamper") {
            let both: [f64; 2] = value.numbers()?;
            if both.iter().all(|&b| b > 0.0) {
                self.springdamper = Some(both);
                self.stiffness[0] = 0.0;
                sprung = true;
            } else if both != [0.0; 2] {
                return Err(value.invalid(MjcfRule::Springdamper));
            }
        }
        if !sprung {
            return Ok(());
        }
        let at = |name: &'static str, what: Unsupported| {
            let value = joint.get(name);
            let place = value.map_or_else(|| joint.item.place(), |v| v.place());
            let value = value.map_or_else(String::new, |v| crate::xml::shorten(v.text));
            MjcfError::Unsupported { place, value, what }
        };
        if matches!(self.kind, Kind::Free | Kind::Ball) {
            let name = if self.springdamper.is_some() { "springdamper" } else { "stiffness" };
            return Err(at(name, Unsupported::BallSpring));
        }
        if joint.number("springyield")?.unwrap_or(0.0) > 0.0 {
            return Err(at("springyield", Unsupported::SpringYield));
        }
        Ok(())
    }

    pub(super) fn freedoms(&self) -> usize {
        match self.kind {
            Kind::Free => 6,
            Kind::Ball => 3,
            Kind::Slide | Kind::Hinge => 1,
        }
    }

    /// Adds the coordinates and springs of a joint that is not free; its motions follow those of `motions`.
    pub(super) fn add(&self, name: &str, body: &mut ModelIr, settings: &Settings, motions: &mut Vec<MotionIr>) {
        let first = body.coordinates.len();
        let limited = self.range.filter(|_| settings.limits);
        let mut push = |name: String, kind, range: Option<(f64, f64)>, default| {
            body.coordinates.push(CoordinateIr {
                name,
                kind,
                range: range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)),
                default,
                locked: false,
                clamped: range.is_some(),
            });
        };
        if self.kind == Kind::Ball {
            // The angle of rotation is at most `high` where w is at least the cosine of its half.
            let w =
                limited.map(|(_, high)| (if high >= std::f64::consts::PI { 0.0 } else { libm::cos(high / 2.0) }, 1.0));
            push(format!("{name}_qw"), CoordinateKind::Quaternion, w, 1.0);
            for letter in ["x", "y", "z"] {
                push(format!("{name}_q{letter}"), CoordinateKind::Quaternion, None, 0.0);
            }
            motions.push(MotionIr::Ball { first });
            return;
        }
        let axis = self.axis.into_inner();
        let motion = |drive| match self.kind {
            Kind::Slide => MotionIr::Slide { axis, drive },
            _ => MotionIr::Hinge { axis, drive },
        };
        if self.reference != 0.0 {
            motions.push(motion(Drive::Fixed(-self.reference)));
        }
        motions.push(motion(Drive::Coordinate(first)));
        let kind = match self.kind {
            Kind::Slide => CoordinateKind::Translation,
            _ => CoordinateKind::Rotation,
        };
        push(name.to_owned(), kind, limited, self.reference);
        let law = match self.stiffness {
            [0.0, 0.0, 0.0] if self.springdamper.is_none() => return,
            [stiffness, 0.0, 0.0] => PassiveLawIr::Spring { stiffness, rest: self.rest },
            coefficients => PassiveLawIr::Polynomial { coefficients: coefficients.to_vec(), rest: self.rest },
        };
        body.passive.push(PassiveIr { name: name.to_owned(), coordinate: first, law });
    }
}

/// The range in the file's units if the joint is limited.
fn range(joint: &Attributes<'_, '_>, kind: Kind, settings: &Settings) -> Result<Option<[f64; 2]>, MjcfError> {
    let limited = joint.get("limited").map_or(Ok(2), |v| v.keyword(&["false", "true", "auto"]))?;
    let value = joint.get("range");
    let [low, high] = value.map_or(Ok([0.0; 2]), |v| v.numbers())?;
    let invalid = |needs| value.map_or_else(|| MjcfError::invalid(joint.item, "range", needs), |v| v.invalid(needs));
    let limited = match limited {
        0 => false,
        1 => true,
        _ if !settings.automatic_limits && value.is_some() => return Err(invalid(MjcfRule::RangeWithoutLimited)),
        _ => settings.automatic_limits && low < high,
    };
    if !limited || kind == Kind::Free {
        return Ok(None);
    }
    if low >= high || (kind == Kind::Ball && low != 0.0) {
        return Err(invalid(MjcfRule::Range));
    }
    Ok(Some([low, high]))
}
