//! Writes muscles, ligaments and springs with their paths, the surfaces that paths wrap over, and markers, as OpenSim's objects.
//!
//! Points of paths stand in the frames of their bodies, whatever offset frames the file had. Numbers of motion (speeds, times of
//! activation, damping) are not known here, so that the file has OpenSim's defaults for them.

use contrapposto::model::{CoordinateKind, Model, Placement};
use contrapposto::muscle::{
    FiberLaw, Ligament, LigamentLaw, Location, Millard2012, MovingPoint, Muscle, Musculature, Path, PathPoint,
    PathWrap, Quadrant, WrapMethod, WrapObject, WrapShape,
};

use super::names::Names;
use super::xml::{Xml, number, numbers};
use super::{exact, listed, osim_functions};
use crate::markers::ModelMarker;

/// Fibre damping of Millard's muscle without a least active force, OpenSim's default; with one there is none.
const MILLARD_DAMPING: f64 = 0.1;
/// OpenSim's names of the axes of a moving point.
const MOVING_AXES: [[&str; 2]; 3] = [
    ["socket_x_coordinate", "x_location"],
    ["socket_y_coordinate", "y_location"],
    ["socket_z_coordinate", "z_location"],
];

/// Names that the objects refer to.
pub(super) struct Frames<'a> {
    pub(super) model: &'a Model,
    /// Name of every segment's body.
    pub(super) bodies: &'a [String],
    /// Path of every coordinate in the file.
    pub(super) coordinates: &'a [String],
}

/// Numbers of objects that a file has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Carried {
    pub(super) muscles: usize,
    pub(super) springs: usize,
    pub(super) wrap_objects: usize,
    pub(super) markers: usize,
}

impl Frames<'_> {
    fn body(&self, segment: Option<usize>) -> String {
        segment.map_or_else(|| "/ground".to_owned(), |segment| format!("/bodyset/{}", self.bodies[segment]))
    }

    /// Whether OpenSim has words for a path.
    fn holds(&self, path: &Path) -> bool {
        let angle = |coordinate: usize| self.model.coordinates()[coordinate].kind != CoordinateKind::Quaternion;
        let point = |point: &PathPoint| match &point.location {
            Location::Fixed(_) => true,
            Location::Conditional { coordinate, .. } => angle(*coordinate),
            Location::Moving(point) => point.frame == Placement::identity() && point.coordinate.is_none_or(angle),
        };
        path.tendon.is_none() && path.points.len() > 1 && path.points.iter().all(point)
    }

    /// Muscles, then ligaments and springs. Returns the numbers of both.
    pub(super) fn forces(
        &self,
        xml: &mut Xml,
        musculature: &Musculature,
        names: &mut Names,
        lost: &mut Vec<String>,
    ) -> (usize, usize) {
        let (mut muscles, mut springs, mut without) = (0, 0, vec![]);
        for muscle in &musculature.muscles {
            let (spec, path) = (muscle.spec(), &musculature.paths.paths[muscle.spec().path]);
            if !self.holds(path) || matches!(spec.law, FiberLaw::Mujoco(_)) {
                without.push(spec.name.as_str());
                continue;
            }
            let name = names.keep("muscle", &spec.name, lost);
            self.muscle(xml, &name, muscle, (path, musculature));
            muscles += 1;
        }
        for ligament in &musculature.ligaments {
            let path = &musculature.paths.paths[ligament.path];
            if !self.holds(path) {
                without.push(ligament.name.as_str());
                continue;
            }
            let name = names.keep("ligament", &ligament.name, lost);
            self.ligament(xml, &name, ligament, (path, musculature));
            springs += 1;
        }
        without.extend(musculature.bushings.iter().map(|bushing| bushing.name.as_str()));
        if !without.is_empty() {
            lost.push(format!("{} are not written.", listed(&without)));
        }
        if muscles > 0 {
            lost.push("Speeds, times of activation and damping of muscles are OpenSim's defaults.".to_owned());
        }
        (muscles, springs)
    }

    fn muscle(&self, xml: &mut Xml, name: &str, muscle: &Muscle, path: (&Path, &Musculature)) {
        let spec = muscle.spec();
        let (kind, least) = match spec.law {
            FiberLaw::Thelen2003(_) => ("Thelen2003Muscle", Some("minimum_activation")),
            FiberLaw::Millard2012(_) => ("Millard2012EquilibriumMuscle", Some("minimum_activation")),
            FiberLaw::DeGrooteFregly2016(_) => ("DeGrooteFregly2016Muscle", None),
            FiberLaw::Schutte1993(_) | FiberLaw::Mujoco(_) => ("Schutte1993Muscle_Deprecated", None),
        };
        xml.open(kind, &[("name", name)]);
        self.path(xml, path);
        for (tag, value) in [
            ("max_isometric_force", spec.max_isometric_force),
            ("optimal_fiber_length", spec.optimal_fiber_length),
            ("tendon_slack_length", spec.tendon_slack_length),
            ("pennation_angle_at_optimal", spec.pennation),
        ] {
            xml.value(tag, &number(value));
        }
        if matches!(spec.law, FiberLaw::Thelen2003(_) | FiberLaw::Millard2012(_)) {
            xml.value("maximum_pennation_angle", &number(spec.max_pennation));
        }
        if let Some(least) = least {
            xml.value(least, &number(spec.least_activation));
        }
        xml.value("ignore_tendon_compliance", if spec.rigid_tendon { "true" } else { "false" });
        law(xml, &spec.law);
        xml.close();
    }

    fn ligament(&self, xml: &mut Xml, name: &str, ligament: &Ligament, path: (&Path, &Musculature)) {
        let kind = match ligament.law {
            LigamentLaw::Curve { .. } => "Ligament",
            LigamentLaw::Blankevoort1991 { .. } => "Blankevoort1991Ligament",
            LigamentLaw::Spring { .. } => "PathSpring",
        };
        xml.open(kind, &[("name", name)]);
        self.path(xml, path);
        match &ligament.law {
            LigamentLaw::Curve { slack_length, force, curve } => {
                xml.value("resting_length", &number(*slack_length));
                xml.value("pcsa_force", &number(*force));
                held(xml, "force_length_curve", curve);
            }
            LigamentLaw::Blankevoort1991 { slack_length, stiffness, transition_strain } => {
                xml.value("slack_length", &number(*slack_length));
                xml.value("linear_stiffness", &number(*stiffness));
                xml.value("transition_strain", &number(*transition_strain));
            }
            LigamentLaw::Spring { slack_length, stiffness } => {
                xml.value("resting_length", &number(*slack_length));
                xml.value("stiffness", &number(*stiffness));
                xml.value("dissipation", "0");
            }
        }
        xml.close();
    }

    fn path(&self, xml: &mut Xml, (path, musculature): (&Path, &Musculature)) {
        xml.open("GeometryPath", &[("name", "geometrypath")]);
        xml.open("PathPointSet", &[]);
        xml.open("objects", &[]);
        for (point, number) in path.points.iter().zip(1..) {
            self.point(xml, &format!("P{number}"), point);
        }
        xml.close();
        xml.close();
        xml.open("PathWrapSet", &[]);
        xml.open("objects", &[]);
        for (wrap, number) in path.wraps.iter().zip(1..) {
            path_wrap(xml, &format!("wrap{number}"), wrap, &musculature.paths.wrap_objects[wrap.object]);
        }
        xml.close();
        xml.close();
        xml.close();
    }

    fn point(&self, xml: &mut Xml, name: &str, point: &PathPoint) {
        let kind = match point.location {
            Location::Fixed(_) => "PathPoint",
            Location::Conditional { .. } => "ConditionalPathPoint",
            Location::Moving(_) => "MovingPathPoint",
        };
        xml.open(kind, &[("name", name)]);
        xml.value("socket_parent_frame", &self.body(point.segment));
        match &point.location {
            Location::Fixed(place) => xml.value("location", &numbers(place)),
            Location::Conditional { place, coordinate, range } => {
                xml.value("location", &numbers(place));
                xml.value("socket_coordinate", &self.coordinates[*coordinate]);
                xml.value("range", &numbers(&[range.0, range.1]));
            }
            Location::Moving(point) => self.moving(xml, point),
        }
        xml.close();
    }

    fn moving(&self, xml: &mut Xml, point: &MovingPoint) {
        for ([socket, location], function) in MOVING_AXES.into_iter().zip(&point.place) {
            if let Some(coordinate) = point.coordinate {
                xml.value(socket, &self.coordinates[coordinate]);
            }
            held(xml, location, function);
        }
    }

    /// The markers.
    pub(super) fn markers(&self, xml: &mut Xml, markers: &[ModelMarker]) {
        for marker in markers {
            xml.open("Marker", &[("name", &marker.name)]);
            xml.value("socket_parent_frame", &self.body(Some(marker.segment)));
            xml.value("location", &numbers(&marker.point));
            xml.close();
        }
    }
}

/// A function inside of a property.
fn held(xml: &mut Xml, property: &'static str, function: &contrapposto::math::Function) {
    xml.open(property, &[]);
    osim_functions::write(xml, None, function);
    xml.close();
}

fn law(xml: &mut Xml, law: &FiberLaw) {
    match law {
        FiberLaw::Thelen2003(law) => {
            for (tag, value) in [
                ("FmaxTendonStrain", law.tendon_strain),
                ("FmaxMuscleStrain", law.fiber_strain),
                ("KshapeActive", law.active_shape),
                ("KshapePassive", law.passive_shape),
            ] {
                xml.value(tag, &number(value));
            }
        }
        FiberLaw::Millard2012(law) => millard(xml, law),
        FiberLaw::DeGrooteFregly2016(law) => {
            xml.value("active_force_width_scale", &number(law.active_width));
            xml.value("passive_fiber_strain_at_one_norm_force", &number(law.fiber_strain));
            xml.value("tendon_strain_at_one_norm_force", &number(law.tendon_strain));
            xml.value("ignore_passive_fiber_force", if law.without_passive { "true" } else { "false" });
        }
        FiberLaw::Schutte1993(law) => {
            held(xml, "active_force_length_curve", &law.active);
            law.passive.iter().for_each(|curve| held(xml, "passive_force_length_curve", curve));
            held(xml, "tendon_force_length_curve", &law.tendon);
        }
        FiberLaw::Mujoco(_) => {}
    }
}

fn millard(xml: &mut Xml, law: &Millard2012) {
    let damping = if law.active.floor > 0.0 { 0.0 } else { MILLARD_DAMPING };
    xml.value("fiber_damping", &number(damping));
    let mut curve = |tag: &'static str, values: &[(&str, f64)]| {
        xml.open(tag, &[("name", tag)]);
        values.iter().for_each(|(tag, value)| xml.value(tag, &number(*value)));
        xml.close();
    };
    let active = law.active;
    curve(
        "ActiveForceLengthCurve",
        &[
            ("min_norm_active_fiber_length", active.least),
            ("transition_norm_fiber_length", active.transition),
            ("max_norm_active_fiber_length", active.greatest),
            ("shallow_ascending_slope", active.shallow_slope),
            ("minimum_value", active.floor),
        ],
    );
    let passive = law.passive;
    let mut values = vec![("strain_at_zero_force", passive.zero_strain), ("strain_at_one_norm_force", passive.strain)];
    values.extend(passive.shape.iter().flat_map(|shape| {
        [
            ("stiffness_at_low_force", shape.low_slope),
            ("stiffness_at_one_norm_force", shape.slope),
            ("curviness", shape.curviness),
        ]
    }));
    curve("FiberForceLengthCurve", &values);
    let tendon = law.tendon;
    let mut values = vec![("strain_at_one_norm_force", tendon.strain)];
    values.extend(tendon.shape.iter().flat_map(|shape| {
        [
            ("stiffness_at_one_norm_force", shape.slope),
            ("norm_force_at_toe_end", shape.toe_force),
            ("curviness", shape.curviness),
        ]
    }));
    curve("TendonForceLengthCurve", &values);
}

fn path_wrap(xml: &mut Xml, name: &str, wrap: &PathWrap, object: &WrapObject) {
    let method = match wrap.method {
        WrapMethod::Hybrid => "hybrid",
        WrapMethod::Midpoint => "midpoint",
        WrapMethod::Axial => "axial",
    };
    // OpenSim counts from 1, and -1 means all.
    let index = |index: Option<usize>| index.map_or("-1".to_owned(), |index| (index + 1).to_string());
    xml.open("PathWrap", &[("name", name)]);
    xml.value("wrap_object", &object.name);
    xml.value("method", method);
    xml.value("range", &format!("{} {}", index(wrap.range.0), index(wrap.range.1)));
    xml.close();
}

/// The surfaces of a segment, or of ground.
pub(super) fn wrap_objects(xml: &mut Xml, musculature: &Musculature, segment: Option<usize>) {
    let own: Vec<&WrapObject> = musculature.paths.wrap_objects.iter().filter(|o| o.segment == segment).collect();
    if own.is_empty() {
        return;
    }
    xml.open("WrapObjectSet", &[]);
    xml.open("objects", &[]);
    own.into_iter().for_each(|object| wrap_object(xml, object));
    xml.close();
    xml.close();
}

fn wrap_object(xml: &mut Xml, object: &WrapObject) {
    let kind = match object.shape {
        WrapShape::Cylinder { .. } => "WrapCylinder",
        WrapShape::Sphere { .. } => "WrapSphere",
        WrapShape::Ellipsoid { .. } => "WrapEllipsoid",
        WrapShape::Torus { .. } => "WrapTorus",
    };
    let quadrant = match object.quadrant {
        Quadrant::All => "all".to_owned(),
        Quadrant::Half { axis, positive } => format!("{}{}", if positive { "+" } else { "-" }, ["x", "y", "z"][axis]),
    };
    xml.open(kind, &[("name", &object.name)]);
    xml.value("active", if object.active { "true" } else { "false" });
    xml.value("xyz_body_rotation", &numbers(&exact::xyz(&object.pose.rotation)));
    xml.value("translation", &numbers(&object.pose.translation.vector));
    xml.value("quadrant", &quadrant);
    match object.shape {
        WrapShape::Cylinder { radius, length } => {
            xml.value("radius", &number(radius));
            xml.value("length", &number(length));
        }
        WrapShape::Sphere { radius } => xml.value("radius", &number(radius)),
        WrapShape::Ellipsoid { half_axes } => xml.value("dimensions", &numbers(&half_axes)),
        WrapShape::Torus { tube, circle } => {
            xml.value("inner_radius", &number(tube));
            xml.value("outer_radius", &number(circle));
        }
    }
    xml.close();
}
