//! Builds a model from segments, and refuses data that contradict each other.

use std::collections::HashMap;

use nalgebra::{Matrix3, Vector3};

use super::coordinate::{Coordinate, CoordinateKind, CoordinateSpec};
use super::coordinate_specs::coordinate_specs;
use super::error::{ModelError, check_coordinate, check_drive, check_segment, check_size};
use super::joint::{Drive, JointKind, Motion};
use super::segment_spec::SegmentSpec;
use super::{Coupling, Mobility, Model, Placement, Rate, Segment};
use crate::math::Function;

/// The coordinates of a joint with their kinds.
type Specs = Vec<(CoordinateSpec, CoordinateKind)>;

/// Collects segments, parents before children.
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    model: Model,
    /// Segments by name.
    segments: HashMap<String, usize>,
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
            three_axis: vec![],
            shapes: vec![],
            meeting: vec![],
            by_axes: None,
            has_balls: false,
            direct: true,
        };
        Self { model, segments: HashMap::new() }
    }

    /// Adds a segment with its joint.
    ///
    /// # Errors
    /// [`ModelError`] names what is wrong; the builder is then unchanged.
    pub fn segment(&mut self, spec: SegmentSpec) -> Result<(), ModelError> {
        let motions = spec.kind.motions();
        let (parent, specs) = self.check(&spec, &motions)?;
        let model = &mut self.model;
        let (carrier, in_carrier) = match parent {
            None => (None, spec.in_parent),
            Some(p) => (model.segments[p].mobility, model.segments[p].offset * spec.in_parent),
        };
        let first = model.coordinates.len();
        let first_rate = model.rates.len();
        model.add_coordinates(&spec.joint, specs);
        let (mobility, rest) = model.add_mobilities(&spec.kind, motions, (first, first_rate), (carrier, in_carrier));
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
        self.segments.insert(spec.name.clone(), model.segments.len());
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

    /// Index of the parent segment and the coordinates of the joint, if the segment fits the model.
    fn check(&self, spec: &SegmentSpec, motions: &[Motion]) -> Result<(Option<usize>, Specs), ModelError> {
        let model = &self.model;
        if self.segments.contains_key(&spec.name) {
            return Err(ModelError::Duplicate { what: "segment", name: spec.name.clone() });
        }
        let missing = |name: &String| ModelError::Parent { segment: spec.name.clone(), parent: name.clone() };
        let index = |name: &String| self.segments.get(name).copied().ok_or_else(|| missing(name));
        let parent = spec.parent.as_ref().map(index).transpose()?;
        check_size(&model.name, "gravity (m/s^2)", model.gravity.as_slice())?;
        check_segment(spec, motions)?;
        let specs = coordinate_specs(spec, motions)?;
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
        Ok((parent, specs))
    }

    /// Couples `dependent = function(independent)`; the independent coordinate may depend on another one itself.
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
        let independent_of = |c| self.model.couplings.iter().find(|k| k.dependent == c).map(|k| k.independent);
        if independent_of(d).is_some() {
            return refuse("it already follows another coordinate");
        }
        if std::iter::successors(Some(i), |&c| independent_of(c)).any(|c| c == d) {
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
        model.find_three_axis_joints();
        self.model
    }
}

impl Model {
    /// Adds the elementary motions of a joint of kind `kind`, whose first coordinate and rate are `first`, to the mobility of
    /// `carrier` and a place on it; the mobility and the place on it that carry the segment.
    fn add_mobilities(
        &mut self,
        kind: &JointKind,
        motions: Vec<Motion>,
        (first, first_rate): (usize, usize),
        carrier: (Option<usize>, Placement),
    ) -> (Option<usize>, Placement) {
        let (mut mobility, mut rest) = carrier;
        let mut next = first;
        for (i, motion) in motions.into_iter().enumerate() {
            let drive = match kind {
                JointKind::Driven(motions) => motions[i].1.shifted(first),
                _ => Drive::Coordinate(next),
            };
            next += motion.coordinates();
            let rate = self.elements.len();
            match (&drive, motion) {
                (Drive::Coordinate(c), Motion::Ball) => {
                    // The ball's three rates stand where its quaternion's components do.
                    let before = (first..*c).filter(|&c| self.coordinates[c].rate.is_some()).count();
                    self.elements.extend((0..3).map(|axis| Some(first_rate + before + axis)));
                    self.balls.push(*c);
                }
                (Drive::Coordinate(c) | Drive::Function(_, c), _) => self.elements.push(self.coordinates[*c].rate),
                (Drive::Fixed(_), _) => self.elements.push(None),
            }
            self.add_ancestors(mobility);
            self.mobilities.push(Mobility {
                parent: mobility,
                principal: principal(motion),
                turned: rest.rotation.to_rotation_matrix().into_inner() != Matrix3::identity(),
                rotation: rest.rotation.to_rotation_matrix().into_inner(),
                translation: rest.translation.vector,
                motion,
                drive,
                angles: None,
                rate,
                mass: 0.0,
                first_moment: Vector3::zeros(),
            });
            mobility = Some(self.mobilities.len() - 1);
            rest = Placement::identity();
        }
        (mobility, rest)
    }

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

    /// Puts every coupling behind the coupling of its independent coordinate, if that depends on another one; the order is kept
    /// otherwise.
    fn order_couplings(&mut self) {
        let mut waiting: Vec<Option<Coupling>> = self.couplings.drain(..).map(Some).collect();
        let mut by_dependent = vec![None; self.coordinates.len()];
        for (k, coupling) in waiting.iter().enumerate() {
            if let Some(coupling) = coupling {
                by_dependent[coupling.dependent] = Some(k);
            }
        }
        for start in 0..waiting.len() {
            let (mut chain, mut next) = (vec![], Some(start));
            while let Some(coupling) = next.and_then(|k| waiting[k].take()) {
                next = by_dependent[coupling.independent];
                chain.push(coupling);
            }
            self.couplings.extend(chain.into_iter().rev());
        }
    }

    /// Notes whether torques need no folding, and whether there are balls.
    pub(crate) fn set_direct(&mut self) {
        self.has_balls = self.mobilities.iter().any(|m| m.motion == Motion::Ball);
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

/// Axis of its own frame that a hinge turns about, if it is one of the three, and the sense.
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
