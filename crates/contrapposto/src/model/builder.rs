//! How is a model put together, and what is refused?

use nalgebra::{Matrix3, Vector3};

use super::{
    Coordinate, CoordinateKind, CoordinateSpec, Coupling, Drive, JointKind, LARGEST, Mobility, Model, Motion,
    Placement, Rate, Segment,
};
use crate::math::Function;

/// A segment and its joint as given to the builder.
#[derive(Clone, Debug)]
pub struct SegmentSpec {
    /// Unique name.
    pub name: String,
    /// Name of the parent segment; `None` joins it to ground.
    pub parent: Option<String>,
    /// Mass, kg, not negative.
    pub mass: f64,
    /// Centre of mass in the segment's frame, m.
    pub center_of_mass: Vector3<f64>,
    /// Inertia about the centre of mass, kg m^2.
    pub inertia: Matrix3<f64>,
    /// Name of the joint.
    pub joint: String,
    /// Its kind.
    pub kind: JointKind,
    /// The joint's resting frame in the parent's frame.
    pub in_parent: Placement,
    /// The joint's moved frame in this segment's frame.
    pub in_segment: Placement,
    /// One spec for every hinge and slide of the joint, in the order of its motions. A ball takes none, or four whose
    /// defaults count: its components are named `{joint}_qw` and so on, so a joint has one ball at most.
    pub coordinates: Vec<CoordinateSpec>,
}

/// Why a model was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two things have one name.
    #[error("two {what}s are named `{name}`; names must be unique")]
    Duplicate {
        /// Segment or coordinate.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A parent does not come before its child.
    #[error("segment `{segment}` has parent `{parent}`, which is not among the segments before it")]
    Parent {
        /// The child.
        segment: String,
        /// The missing parent.
        parent: String,
    },
    /// A number has no meaning.
    #[error("{what} of `{name}` is {value}; it must be {accepted}")]
    Number {
        /// Segment, coordinate or model.
        name: String,
        /// The quantity with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// What would be accepted.
        accepted: &'static str,
    },
    /// Two coordinates cannot be coupled.
    #[error("`{dependent}` cannot follow `{independent}`: {problem}")]
    Coupling {
        /// The coordinate that should follow.
        dependent: String,
        /// The one that should lead.
        independent: String,
        /// Why not.
        problem: &'static str,
    },
    /// The joint has another number of hinges and slides.
    #[error("joint `{joint}` has {given} coordinates; its kind needs {needed}, one for each hinge and slide")]
    Coordinates {
        /// The joint.
        joint: String,
        /// Number given.
        given: usize,
        /// Number needed.
        needed: usize,
    },
}

/// Collects segments, parents before children.
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    model: Model,
}

impl ModelBuilder {
    /// An empty model in a field of gravity (ground axes, m/s^2), which the first segment checks.
    pub fn new(name: &str, gravity: Vector3<f64>) -> Self {
        let model = Model {
            name: name.to_owned(),
            gravity,
            segments: vec![],
            coordinates: vec![],
            mobilities: vec![],
            rates: vec![],
            elements: vec![],
            couplings: vec![],
            balls: vec![],
            ancestors: vec![],
            ancestor_starts: vec![0],
            fixed: (0.0, Vector3::zeros()),
            direct: true,
        };
        Self { model }
    }

    /// Adds a segment with its joint.
    ///
    /// # Errors
    /// [`ModelError`] names what is wrong; the builder is then unchanged.
    pub fn segment(&mut self, spec: SegmentSpec) -> Result<(), ModelError> {
        let model = &mut self.model;
        if model.segment(&spec.name).is_some() {
            return Err(ModelError::Duplicate { what: "segment", name: spec.name });
        }
        let parent = match &spec.parent {
            None => None,
            Some(name) => Some(
                model
                    .segment(name)
                    .ok_or_else(|| ModelError::Parent { segment: spec.name.clone(), parent: name.clone() })?,
            ),
        };
        let motions = spec.kind.motions();
        check_size(&model.name, "gravity (m/s^2)", model.gravity.as_slice())?;
        check_segment(&spec, &motions)?;
        let specs = coordinate_specs(&spec, &motions)?;
        for (i, (coordinate, _)) in specs.iter().enumerate() {
            let taken = model.coordinate(&coordinate.name).is_some()
                || specs[..i].iter().any(|(other, _)| other.name == coordinate.name);
            if taken {
                return Err(ModelError::Duplicate { what: "coordinate", name: coordinate.name.clone() });
            }
            check_coordinate(coordinate)?;
        }
        if let JointKind::Driven(motions) = &spec.kind {
            motions.iter().try_for_each(|(_, drive)| check_drive(&spec.joint, drive))?;
        }

        let (mut mobility, mut rest) = match parent {
            None => (None, spec.in_parent),
            Some(p) => (model.segments[p].mobility, model.segments[p].offset * spec.in_parent),
        };
        let first = model.coordinates.len();
        let first_rate = model.rates.len();
        model.add_coordinates(&spec.joint, specs);
        let mut next = first;
        for (i, motion) in motions.into_iter().enumerate() {
            let drive = match &spec.kind {
                JointKind::Driven(motions) => motions[i].1.shifted(first),
                _ => Drive::Coordinate(next),
            };
            next += motion.coordinates();
            let rate = model.elements.len();
            match (&drive, motion) {
                (Drive::Coordinate(c), Motion::Ball) => {
                    // The ball's three rates stand where its quaternion's components do.
                    let before = (first..*c).filter(|&c| model.coordinates[c].rate.is_some()).count();
                    model.elements.extend((0..3).map(|axis| Some(first_rate + before + axis)));
                }
                (Drive::Coordinate(c) | Drive::Function(_, c), _) => model.elements.push(model.coordinates[*c].rate),
                (Drive::Fixed(_), _) => model.elements.push(None),
            }
            model.add_ancestors(mobility);
            if let (Drive::Coordinate(c), Motion::Ball) = (&drive, motion) {
                model.balls.push(*c);
            }
            model.mobilities.push(Mobility {
                parent: mobility,
                principal: principal(motion),
                turned: rest.rotation.to_rotation_matrix().into_inner() != Matrix3::identity(),
                rotation: rest.rotation.to_rotation_matrix().into_inner(),
                translation: rest.translation.vector,
                motion,
                drive,
                rate,
                mass: 0.0,
                first_moment: Vector3::zeros(),
            });
            mobility = Some(model.mobilities.len() - 1);
            rest = Placement::identity();
        }
        let offset = rest * spec.in_segment.inverse();
        let first_moment = spec.mass * (offset * nalgebra::Point3::from(spec.center_of_mass)).coords;
        let (mass, moment) = match mobility {
            Some(m) => {
                let carrier = &mut model.mobilities[m];
                (&mut carrier.mass, &mut carrier.first_moment)
            }
            None => (&mut model.fixed.0, &mut model.fixed.1),
        };
        *mass += spec.mass;
        *moment += first_moment;
        model.segments.push(Segment {
            name: spec.name,
            parent,
            mass: spec.mass,
            center_of_mass: spec.center_of_mass,
            inertia: spec.inertia,
            joint: spec.joint,
            joint_kind: spec.kind,
            coordinates: first..model.coordinates.len(),
            in_parent: spec.in_parent,
            in_segment: spec.in_segment,
            patch: vec![],
            mobility,
            offset,
        });
        Ok(())
    }

    /// Makes `dependent` follow `function(independent)`; the leader may follow another coordinate itself.
    ///
    /// # Errors
    /// [`ModelError::Coupling`] for a name that is not there, a quaternion component, a coordinate that already follows
    /// another one, or a circle.
    pub fn couple(&mut self, dependent: &str, independent: &str, function: Function) -> Result<(), ModelError> {
        let refuse = |problem| {
            let (dependent, independent) = (dependent.to_owned(), independent.to_owned());
            Err(ModelError::Coupling { dependent, independent, problem })
        };
        let index = |name: &str| self.model.coordinate(name).filter(|&i| self.model.coordinates[i].rate.is_some());
        let (Some(d), Some(i)) = (index(dependent), index(independent)) else {
            return refuse("both must be angles or distances of the model");
        };
        let leader = |c| self.model.couplings.iter().find(|k| k.dependent == c).map(|k| k.independent);
        if leader(d).is_some() {
            return refuse("it already follows another coordinate");
        }
        if std::iter::successors(Some(i), |&c| leader(c)).any(|c| c == d) {
            return refuse("it would follow itself");
        }
        check_size(dependent, "number of the function it follows", &function.numbers())?;
        self.model.couplings.push(Coupling { dependent: d, independent: i, function });
        Ok(())
    }

    /// The finished model.
    pub fn build(mut self) -> Model {
        let model = &mut self.model;
        model.order_couplings();
        model.set_direct();
        self.model
    }
}

impl Model {
    /// Adds the coordinates of a joint and their rates; a ball's four have three rates.
    fn add_coordinates(&mut self, joint: &str, specs: Vec<(CoordinateSpec, CoordinateKind)>) {
        for (c, kind) in specs {
            let rate = (kind != CoordinateKind::Quaternion).then_some(self.rates.len());
            if rate.is_some() {
                let rotational = kind == CoordinateKind::Rotation;
                self.rates.push(Rate { name: c.name.clone(), rotational, coordinate: Some(self.coordinates.len()) });
            } else if c.name.ends_with("_qw") {
                for axis in ["mx", "my", "mz"] {
                    let name = format!("{joint}_{axis}");
                    self.rates.push(Rate { name, rotational: true, coordinate: None });
                }
            }
            let CoordinateSpec { name, range, default, positive, passive, groups, locked, .. } = c;
            self.coordinates.push(Coordinate { name, kind, range, default, positive, passive, groups, rate, locked });
        }
    }
}

impl Model {
    /// Puts every coupling behind the one that its leader follows by, if there is one; the order stays where it can.
    fn order_couplings(&mut self) {
        let mut waiting: Vec<Option<Coupling>> = self.couplings.drain(..).map(Some).collect();
        let mut by_follower = vec![None; self.coordinates.len()];
        for (k, coupling) in waiting.iter().enumerate() {
            if let Some(coupling) = coupling {
                by_follower[coupling.dependent] = Some(k);
            }
        }
        for start in 0..waiting.len() {
            let (mut chain, mut next) = (vec![], Some(start));
            while let Some(coupling) = next.and_then(|k| waiting[k].take()) {
                next = by_follower[coupling.independent];
                chain.push(coupling);
            }
            self.couplings.extend(chain.into_iter().rev());
        }
    }

    /// Does torque need no folding?
    pub(crate) fn set_direct(&mut self) {
        let plain = |m: &Mobility| matches!(m.drive, Drive::Coordinate(_));
        let in_order = self.elements.iter().enumerate().all(|(i, rate)| *rate == Some(i));
        let idle = |coupling: &Coupling| self.coordinates[coupling.dependent].rate.is_none();
        self.direct = self.couplings.iter().all(idle)
            && in_order
            && self.rates.len() == self.elements.len()
            && self.mobilities.iter().all(plain);
    }

    /// Lists the hinges and balls between a new mobility and the root.
    pub(crate) fn add_ancestors(&mut self, parent: Option<usize>) {
        let mut next = parent;
        while let Some(p) = next {
            let near = &self.mobilities[p];
            if !matches!(near.motion, Motion::Slide(_)) {
                self.ancestors.extend(near.rate..near.rate + near.motion.rates());
            }
            next = near.parent;
        }
        self.ancestor_starts.push(self.ancestors.len());
    }
}

/// Which axis of its own frame a hinge turns about, if it is one of the three, and in which sense.
fn principal(motion: Motion) -> Option<(usize, f64)> {
    let Motion::Hinge(axis) = motion else { return None };
    (0..3).find(|&k| axis[k].abs() == 1.0).map(|k| (k, axis[k]))
}

impl Drive {
    /// The same drive with its coordinate counted from `first`.
    fn shifted(&self, first: usize) -> Self {
        match self {
            Self::Coordinate(c) => Self::Coordinate(first + c),
            Self::Function(function, c) => Self::Function(function.clone(), first + c),
            Self::Fixed(value) => Self::Fixed(*value),
        }
    }
}

fn check_segment(spec: &SegmentSpec, motions: &[Motion]) -> Result<(), ModelError> {
    let refuse = |what, value, accepted| Err(ModelError::Number { name: spec.name.clone(), what, value, accepted });
    if !(0.0..=LARGEST).contains(&spec.mass) {
        return refuse("mass (kg)", spec.mass, "between 0 and 1e9");
    }
    for (what, values) in [
        ("centre of mass (m)", spec.center_of_mass.as_slice()),
        ("inertia (kg m^2)", spec.inertia.as_slice()),
        ("joint's place in the parent (m)", spec.in_parent.translation.vector.as_slice()),
        ("joint's place in the segment (m)", spec.in_segment.translation.vector.as_slice()),
    ] {
        check_size(&spec.name, what, values)?;
    }
    let rotations = [&spec.in_parent, &spec.in_segment].map(|p| p.rotation.coords.norm());
    let axes = motions.iter().filter_map(|motion| match motion {
        Motion::Hinge(axis) | Motion::Slide(axis) => Some(axis.norm()),
        Motion::Ball => None,
    });
    let lengths = rotations.map(|length| ("length of a joint frame's quaternion", length));
    for (what, length) in lengths.into_iter().chain(axes.map(|length| ("length of a joint axis", length))) {
        if length.is_nan() || (length - 1.0).abs() > 1e-6 {
            return refuse(what, length, "1");
        }
    }
    Ok(())
}

fn check_drive(joint: &str, drive: &Drive) -> Result<(), ModelError> {
    match drive {
        Drive::Coordinate(_) => Ok(()),
        Drive::Function(function, _) => check_size(joint, "number of a function of the joint", &function.numbers()),
        Drive::Fixed(value) => check_size(joint, "fixed angle or distance (rad or m)", &[*value]),
    }
}

fn check_size(name: &str, what: &'static str, values: &[f64]) -> Result<(), ModelError> {
    match values.iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
        Some(&value) => {
            Err(ModelError::Number { name: name.to_owned(), what, value, accepted: "finite and at most 1e9 in size" })
        }
        None => Ok(()),
    }
}

fn check_coordinate(spec: &CoordinateSpec) -> Result<(), ModelError> {
    let refuse = |what, value, accepted| Err(ModelError::Number { name: spec.name.clone(), what, value, accepted });
    let (min, max) = spec.range;
    if min.is_nan() || max.is_nan() || min > max {
        return refuse("lower limit of the range", min, "at or below the upper limit");
    }
    if !(min..=max).contains(&spec.default) {
        return refuse("default", spec.default, "inside the range");
    }
    check_size(&spec.name, "default", &[spec.default])
}

/// The coordinates with their kinds, balls filled in.
fn coordinate_specs(
    spec: &SegmentSpec,
    motions: &[Motion],
) -> Result<Vec<(CoordinateSpec, CoordinateKind)>, ModelError> {
    if let JointKind::Driven(motions) = &spec.kind {
        return driven_specs(spec, motions);
    }
    let mut given = spec.coordinates.iter().cloned();
    let axes = motions.iter().filter(|m| **m != Motion::Ball).count();
    let full = motions.iter().map(|m| m.coordinates()).sum::<usize>() == spec.coordinates.len();
    if spec.coordinates.len() != axes && !full {
        return Err(ModelError::Coordinates { joint: spec.joint.clone(), given: spec.coordinates.len(), needed: axes });
    }
    let mut all = vec![];
    for motion in motions {
        match motion {
            Motion::Hinge(_) => all.extend(given.next().map(|c| (c, CoordinateKind::Rotation))),
            Motion::Slide(_) => all.extend(given.next().map(|c| (c, CoordinateKind::Translation))),
            Motion::Ball if full => all.extend(quaternion(&spec.joint, given.by_ref().map(|c| c.default))),
            Motion::Ball => all.extend(quaternion(&spec.joint, [1.0, 0.0, 0.0, 0.0].into_iter())),
        }
    }
    Ok(all)
}

/// The components of a ball at these defaults.
fn quaternion(
    joint: &str,
    defaults: impl Iterator<Item = f64>,
) -> impl Iterator<Item = (CoordinateSpec, CoordinateKind)> {
    ["qw", "qx", "qy", "qz"].into_iter().zip(defaults).map(move |(axis, default)| {
        let mut component = CoordinateSpec::new(&format!("{joint}_{axis}"), (-1.0, 1.0));
        component.default = default;
        (component, CoordinateKind::Quaternion)
    })
}

/// The coordinates of a joint driven by functions: as many as were given, each of the kind that was given; those of a ball
/// are its components.
fn driven_specs(
    spec: &SegmentSpec,
    motions: &[(Motion, Drive)],
) -> Result<Vec<(CoordinateSpec, CoordinateKind)>, ModelError> {
    let given = spec.coordinates.len();
    let mut all: Vec<_> = spec.coordinates.iter().map(|c| (c.clone(), c.kind)).collect();
    for (motion, drive) in motions {
        let needed = match (motion, drive) {
            (_, Drive::Coordinate(c)) => c + motion.coordinates(),
            (Motion::Ball, _) => given + 1,
            (_, Drive::Function(_, c)) => c + 1,
            (_, Drive::Fixed(_)) => 0,
        };
        if needed > given {
            return Err(ModelError::Coordinates { joint: spec.joint.clone(), given, needed });
        }
        if let (Motion::Ball, Drive::Coordinate(c)) = (motion, drive) {
            let defaults: Vec<f64> = all[*c..].iter().map(|(component, _)| component.default).collect();
            all.splice(*c..c + 4, quaternion(&spec.joint, defaults.into_iter()));
        }
    }
    Ok(all)
}
