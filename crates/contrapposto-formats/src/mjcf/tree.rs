//! Reads bodies and frames in one walk through `<worldbody>`.

use super::attributes::Attributes;
use super::built::{Built, Freedom, Motion, Pending};
use super::chain::Chain;
use super::compiler::{MassFrom, Settings};
use super::defaults::Classes;
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::geom::contact_shape;
use super::inertial;
use super::item::Item;
use super::joint::{Joint, Kind};
use super::options::Options;
use super::orientation::pose;
use super::schema::{self, LEAST_MASS, Tag};
use super::site;
use super::value::{Value, check};
use crate::model_ir::{Ignored, ModelIr, RootAttachment, SegmentIr};
use crate::xml::shorten;
use nalgebra::{Isometry3, Translation3, Vector3};

/// The walk's state.
pub(super) struct Walk<'a, 'w> {
    body: &'w mut ModelIr,
    settings: &'w Settings,
    classes: &'w Classes<'a>,
    options: &'w Options,
    ignored: &'w mut Ignored,
    built: Built<'a>,
}

/// Parent, frame and defaults of an element.
#[derive(Clone, Copy)]
struct Context {
    parent: Option<usize>,
    /// Frames between the parent and here.
    frame: Isometry3<f64>,
    class: usize,
    depth: usize,
}

/// A body's elements, frames resolved.
#[derive(Default)]
struct Contents<'a, 'c> {
    inertial: Option<(Item<'a>, Isometry3<f64>)>,
    joints: Vec<Joint<'a>>,
    geoms: Vec<(Attributes<'a, 'c>, Isometry3<f64>)>,
    stations: Vec<(String, Vector3<f64>)>,
    bodies: Vec<(Item<'a>, Context)>,
}

impl<'a, 'w> Walk<'a, 'w> {
    pub(super) fn new(
        body: &'w mut ModelIr,
        settings: &'w Settings,
        classes: &'w Classes<'a>,
        options: &'w Options,
        ignored: &'w mut Ignored,
        root: Item<'a>,
    ) -> Self {
        let built = Built { given: root.names_of(&["body", "joint", "freejoint"]), ..Built::default() };
        Self { body, settings, classes, options, ignored, built }
    }

    pub(super) fn world(&mut self, section: Item<'a>) -> Result<(), MjcfError> {
        if let Some((name, _)) = section.attributes().next() {
            return Err(MjcfError::invalid(section, name, MjcfRule::World));
        }
        let context = Context { parent: None, frame: Isometry3::identity(), class: self.classes.main(), depth: 2 };
        let mut contents = Contents::default();
        self.collect(section, context, &mut contents)?;
        if let Some(joint) = contents.joints.first() {
            return Err(MjcfError::Invalid {
                place: joint.item.place(),
                value: "worldbody".to_owned(),
                needs: MjcfRule::World,
            });
        }
        if let Some((item, _)) = contents.inertial {
            return Err(MjcfError::Invalid {
                place: item.place(),
                value: "worldbody".to_owned(),
                needs: MjcfRule::World,
            });
        }
        self.ignored.add("geom of the world", contents.geoms.len());
        self.ignored.add("site of the world", contents.stations.len());
        self.built.top.extend(contents.bodies.iter().map(|(item, _)| *item));
        for (item, context) in contents.bodies {
            self.segment(item, context)?;
        }
        Ok(())
    }

    /// Elements of a body or frame; the elements of a frame are read in place.
    fn collect(&mut self, item: Item<'a>, context: Context, into: &mut Contents<'a, 'w>) -> Result<(), MjcfError> {
        let cap = self.options.limits.depth;
        if context.depth > cap {
            return Err(MjcfError::TooDeep { place: item.place(), cap });
        }
        let (classes, class) = (self.classes, context.class);
        for child in item.children() {
            match child.name() {
                "body" => into.bodies.push((child, Context { depth: context.depth + 1, ..context })),
                "frame" => {
                    check(child, schema::FRAME)?;
                    if let Some(name) = ["scale", "massscale"].into_iter().find(|n| child.attribute(n).is_some()) {
                        return Err(Unsupported::FrameScale.at_attribute(child, name));
                    }
                    let inner = Context {
                        frame: context.frame * pose(child, self.settings)?,
                        class: classes.named(child, "childclass")?.unwrap_or(class),
                        depth: context.depth + 1,
                        ..context
                    };
                    self.collect(child, inner, into)?;
                }
                "inertial" => {
                    if into.inertial.is_some() {
                        return Err(MjcfError::Invalid {
                            place: child.place(),
                            value: "inertial".to_owned(),
                            needs: MjcfRule::OneInertial,
                        });
                    }
                    into.inertial = Some((child, context.frame));
                }
                "joint" => {
                    let joint = Attributes::new(child, Tag::Joint, classes, class)?;
                    for kind in ["damping", "frictionloss"] {
                        self.ignored.add(&format!("joint {kind}"), usize::from(joint.get(kind).is_some()));
                    }
                    into.joints.push(Joint::read(&joint, &context.frame, self.settings)?);
                }
                "freejoint" => into.joints.push(Joint::free(child)?),
                "geom" => {
                    let geom = Attributes::new(child, Tag::Geom, classes, class)?;
                    self.built.add_geom(&geom, context.parent, &context.frame, self.settings);
                    into.geoms.push((geom, context.frame));
                }
                "site" => self.site(&Attributes::new(child, Tag::Site, classes, class)?, &context, into)?,
                "camera" | "light" => self.ignored.add(child.name(), 1),
                "attach" | "replicate" => return Err(Unsupported::Generated.at(child)),
                "composite" | "flexcomp" => return Err(Unsupported::Deformable.at(child)),
                "plugin" => return Err(Unsupported::Plugin.at(child)),
                _ => return Err(MjcfError::unknown_element(child, schema::BODY_CHILDREN)),
            }
        }
        Ok(())
    }

    fn site(
        &mut self,
        site: &Attributes<'a, '_>,
        context: &Context,
        into: &mut Contents<'a, '_>,
    ) -> Result<(), MjcfError> {
        let Some((name, at)) = site::read(site, &context.frame)? else {
            self.ignored.add("site without name", 1);
            return Ok(());
        };
        into.stations.push((name.to_owned(), at));
        let twice = self.built.sites.insert(name, (context.parent, at)).is_some();
        if twice { Err(duplicate(site.item, name)) } else { Ok(()) }
    }

    /// A body and those inside it.
    fn segment(&mut self, item: Item<'a>, context: Context) -> Result<(), MjcfError> {
        let settings = self.settings;
        let index = self.body.segments.len();
        let name = self.body_name(item, index)?;
        let pose = context.frame * pose(item, settings)?;
        let inner = Context {
            parent: Some(index),
            frame: Isometry3::identity(),
            class: self.classes.named(item, "childclass")?.unwrap_or(context.class),
            depth: context.depth,
        };
        let mut contents = Contents::default();
        self.collect(item, inner, &mut contents)?;
        let mut joints = std::mem::take(&mut contents.joints);
        self.rules(item, context, &joints)?;
        if self.options.root == Some(RootAttachment::Fixed) {
            joints.retain(|j| j.kind != Kind::Free);
        }
        let freed = self.options.root == Some(RootAttachment::Free) && context.parent.is_none() && joints.is_empty();
        let moves = !joints.is_empty() || freed;
        let carried = context.parent.is_some_and(|p| self.built.moves[p]);
        let solid = inertial::mass(item, contents.inertial, &contents.geoms, settings, moves || carried);
        let solid = inertial::known(solid, self.options, self.ignored)?;
        let known = self.body.solids.len();
        for (geom, frame) in &contents.geoms {
            self.body.solids.extend(contact_shape(geom, frame, settings, index)?);
        }
        if contents.inertial.is_some() && settings.mass_from != MassFrom::Geoms {
            self.ignored.add("geom", contents.geoms.len() - (self.body.solids.len() - known));
        }
        let world = context.parent.map_or(pose, |p| self.built.poses[p] * pose);
        self.built.poses.push(world);
        self.built.places.push(item.place());
        self.built.moves.push(moves || carried);
        let mut segment = SegmentIr {
            joint: format!("{name}_fixed"),
            name,
            parent: context.parent,
            mass: solid.mass,
            center_of_mass: solid.center,
            inertia: solid.inertia,
            in_parent: pose,
            in_segment: Isometry3::identity(),
            motions: vec![],
        };
        if freed {
            "root".clone_into(&mut segment.joint);
            segment.motions = self.body.free_joint("root", &pose);
            segment.in_parent = Isometry3::identity();
            self.push_freedoms(index, &Joint::new(item, Kind::Free));
        }
        self.joints(&joints, index, pose, &mut segment)?;
        self.body.segments.push(segment);
        self.body.stations.extend(contents.stations.into_iter().map(|(name, at)| (name, index, at)));
        for (child, context) in contents.bodies {
            self.segment(child, context)?;
        }
        Ok(())
    }

    /// Adds the motions of a body's joints, in their order, to its segment, number `index`.
    fn joints(
        &mut self,
        joints: &[Joint<'a>],
        index: usize,
        pose: Isometry3<f64>,
        segment: &mut SegmentIr,
    ) -> Result<(), MjcfError> {
        let mut chain = Chain { pose, at: Vector3::zeros(), turned: false };
        for (number, joint) in joints.iter().enumerate() {
            self.joint(joint, number, segment, &mut chain)?;
            self.push_freedoms(index, joint);
            if self.body.coordinates.len() > self.options.limits.coordinates {
                let cap = self.options.limits.coordinates;
                return Err(MjcfError::TooManyCoordinates { place: joint.item.place(), cap });
            }
        }
        segment.in_segment = Isometry3::from(Translation3::from(chain.at));
        Ok(())
    }

    /// Checks a body's own attributes, and gives its name.
    fn body_name(&mut self, item: Item<'a>, index: usize) -> Result<String, MjcfError> {
        check(item, schema::BODY)?;
        let name = match item.attribute("name").filter(|n| !n.is_empty()) {
            Some(name) if name == "world" || !self.built.body_names.insert(name) => return Err(duplicate(item, name)),
            Some(name) => name.to_owned(),
            None => self.made_up(format!("body_{}", index + 1)),
        };
        if let Some(value) = Value::of(item, "gravcomp")
            && value.number()? != 0.0
        {
            return Err(Unsupported::GravityCompensation.at_attribute(item, "gravcomp"));
        }
        Ok(name)
    }

    /// Adds joint number `number` of a body to its segment.
    fn joint(
        &mut self,
        joint: &Joint<'a>,
        number: usize,
        segment: &mut SegmentIr,
        chain: &mut Chain,
    ) -> Result<(), MjcfError> {
        let joint_name = self.joint_name(joint, &segment.name, number)?;
        // A ball's coordinates are named after its joint.
        if number == 0 || joint.kind == Kind::Ball {
            segment.joint.clone_from(&joint_name);
        }
        if joint.kind == Kind::Free {
            segment.motions = self.body.free_joint(&joint_name, &chain.pose);
            segment.in_parent = Isometry3::identity();
            return Ok(());
        }
        if joint.kind != Kind::Slide {
            chain.go_to(joint.anchor, segment);
        }
        let (coordinate, springs) = (self.body.coordinates.len(), self.body.passive.len());
        joint.add(&joint_name, self.body, self.settings, &mut segment.motions);
        if joint.kind != Kind::Ball
            && let Some(name) = joint.item.attribute("name").filter(|n| !n.is_empty())
        {
            self.built.joints.insert(name, (coordinate, joint.reference));
        }
        self.built.torques.extend(joint.torques.map(|torques| (coordinate, torques)));
        if let Some(wanted) = joint.springdamper {
            let place = joint.item.place();
            let freedom = self.built.freedoms.len();
            self.built.pending.push(Pending { freedom, spring: springs, wanted, place });
        }
        Ok(())
    }

    /// Checks MuJoCo's demands on a body's joints, and the caller's on its root.
    fn rules(&self, item: Item<'a>, context: Context, joints: &[Joint<'a>]) -> Result<(), MjcfError> {
        let top = context.parent.is_none();
        if let Some(mocap) = Value::of(item, "mocap")
            && mocap.flag()?
            && (!joints.is_empty() || !top)
        {
            return Err(mocap.invalid(MjcfRule::Mocap));
        }
        let name = item.attribute("name").unwrap_or_default();
        let invalid = |at: Item<'_>, needs| MjcfError::Invalid { place: at.place(), value: shorten(name), needs };
        if let Some(free) = joints.iter().find(|j| j.kind == Kind::Free)
            && (!top || joints.len() > 1)
        {
            return Err(invalid(free.item, MjcfRule::FreeJoint));
        }
        if joints.iter().map(Joint::freedoms).sum::<usize>() > 6 {
            return Err(invalid(item, MjcfRule::Freedoms));
        }
        if self.options.root == Some(RootAttachment::Free)
            && top
            && joints.first().is_some_and(|j| j.kind != Kind::Free)
        {
            return Err(invalid(item, MjcfRule::Root));
        }
        Ok(())
    }

    fn made_up(&self, mut name: String) -> String {
        while self.built.given.contains(name.as_str()) {
            name.push('_');
        }
        name
    }

    fn joint_name(&mut self, joint: &Joint<'a>, segment: &str, number: usize) -> Result<String, MjcfError> {
        match joint.item.attribute("name").filter(|n| !n.is_empty()) {
            Some(name) if !self.built.joint_names.insert(name) => Err(duplicate(joint.item, name)),
            Some(name) => Ok(name.to_owned()),
            None if joint.kind != Kind::Free => Ok(self.made_up(format!("{segment}_joint{}", number + 1))),
            None if std::mem::replace(&mut self.built.root_named, true) => Ok(self.made_up(format!("{segment}_free"))),
            None => Ok(self.made_up("root".to_owned())),
        }
    }

    fn push_freedoms(&mut self, segment: usize, joint: &Joint<'a>) {
        let pose = self.built.poses[segment];
        let turn = |axis: Vector3<f64>| {
            Motion::Turn(pose.rotation * axis, (pose * nalgebra::Point3::from(joint.anchor)).coords)
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let motions: Vec<Motion> = match joint.kind {
            Kind::Free => axes.into_iter().map(Motion::Slide).chain(axes.into_iter().map(turn)).collect(),
            Kind::Ball => axes.into_iter().map(turn).collect(),
            Kind::Hinge => vec![turn(joint.axis.into_inner())],
            Kind::Slide => vec![Motion::Slide(pose.rotation * joint.axis.into_inner())],
        };
        let armature = joint.armature;
        self.built.freedoms.extend(motions.into_iter().map(|motion| Freedom { segment, motion, armature }));
    }

    /// Scales the masses, and makes the checks that need all bodies.
    pub(super) fn finish(self, root: Item<'a>) -> Result<Built<'a>, MjcfError> {
        let Self { body, settings, options, built, .. } = self;
        if options.root == Some(RootAttachment::Free) && built.top.len() != 1 {
            let at = built.top.get(1).unwrap_or(&root);
            let value = shorten(at.attribute("name").unwrap_or_default());
            return Err(MjcfError::Invalid { place: at.place(), value, needs: MjcfRule::Root });
        }
        let total: f64 = body.segments.iter().map(|s| s.mass).sum();
        if settings.total_mass > 0.0 {
            let scale = settings.total_mass / total.max(LEAST_MASS);
            for segment in &mut body.segments {
                segment.mass *= scale;
                segment.inertia *= scale;
            }
        }
        // A moving body may get its mass from bodies fixed to it.
        let mut heavy: Vec<bool> =
            body.segments.iter().map(|s| s.mass >= LEAST_MASS && s.inertia.trace() >= LEAST_MASS).collect();
        for (index, segment) in body.segments.iter().enumerate().rev() {
            if segment.motions.is_empty() {
                if let Some(parent) = segment.parent {
                    heavy[parent] |= heavy[index];
                }
            } else if !heavy[index] && !options.omit_mesh_mass {
                let (place, value) = (built.places[index].clone(), shorten(&segment.name));
                return Err(MjcfError::Invalid { place, value, needs: MjcfRule::MovingMass });
            }
        }
        Ok(built)
    }
}

fn duplicate(item: Item<'_>, name: &str) -> MjcfError {
    MjcfError::DuplicateName { place: item.attribute_place("name"), value: shorten(name) }
}
