//! Arranges a model for blocks of postures: elementary motions through one point become one node, constants are prepared.

use crate::model::{Drive, Mobility, Model, Motion};

/// The columns of a constant rotation.
pub(super) type Columns = [[f64; 3]; 3];

/// Elementary motions through one point, of which the last one carries all mass and all children.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) parent: Option<usize>,
    /// The point in the parent's frame, m; `None` for its origin.
    pub(super) translation: Option<[f64; 3]>,
    /// Motions of the node, which are the mobilities of the model.
    pub(super) motions: std::ops::Range<usize>,
    /// Mass fixed to it, and mass times its centre.
    pub(super) mass: f64,
    pub(super) first_moment: [f64; 3],
    /// Mass at and beyond it.
    pub(super) carried: f64,
    /// The three-axis joint whose last hinge is the last motion.
    pub(super) joint: Option<usize>,
}

/// The way of a motion.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// Turns about axis 0, 1 or 2 of its own frame.
    Principal(usize, f64),
    /// Turns about another axis.
    Axis([f64; 3]),
    Slide([f64; 3]),
    Ball,
}

/// Source of the value of a hinge or slide, or of a ball's quaternion.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// The coordinate.
    Coordinate(usize),
    /// The slot of a function's value.
    Function(usize),
    Fixed(f64),
}

/// An elementary motion.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// Rotation of the resting frame against the frame before, unless it is none.
    pub(super) turned: Option<Columns>,
    pub(super) way: Way,
    pub(super) source: Source,
    /// First elementary rate.
    pub(super) element: usize,
}

/// A frame fixed to a node, or to ground.
#[derive(Clone, Debug)]
pub(super) struct Attached {
    pub(super) node: Option<usize>,
    /// Rotation of the frame against the frame of the node, unless there is none.
    pub(super) turned: Option<Columns>,
    /// Origin of the frame in the frame of the node, m.
    pub(super) origin: [f64; 3],
}

/// The axes about which the moment of a three-axis joint is wanted, in the frame of its node, and the rates they stand for.
#[derive(Clone, Debug)]
pub(super) struct JointAxes {
    pub(super) axes: [[f64; 3]; 3],
    pub(super) rates: [usize; 3],
}

/// A model arranged for blocks of postures.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) nodes: Vec<Node>,
    pub(super) steps: Vec<Step>,
    /// The node of every mobility.
    node_of: Vec<usize>,
    pub(super) joints: Vec<JointAxes>,
    pub(super) gravity: [f64; 3],
    /// Whole mass, and mass times centre of what is fixed to ground.
    pub(super) mass: f64,
    pub(super) fixed_moment: [f64; 3],
    /// Number of functions that drive motions.
    pub(super) functions: usize,
    /// Values of motions that stand still.
    pub(super) fixed: Vec<f64>,
}

impl Plan {
    /// Arranges `model`. The frames of the mobilities `frames` are asked for, so each of them ends a node.
    pub(super) fn new(model: &Model, frames: &[usize]) -> Self {
        let joints: Vec<(usize, JointAxes)> = (0..model.three_axis.len()).map(|j| joint_axes(model, j)).collect();
        let mut plan = Self {
            nodes: vec![],
            steps: vec![],
            node_of: vec![],
            joints: vec![],
            gravity: model.gravity.into(),
            mass: 0.0,
            fixed_moment: model.fixed.1.into(),
            functions: 0,
            fixed: vec![],
        };
        for (i, mobility) in model.mobilities.iter().enumerate() {
            let step = plan.step(mobility);
            plan.steps.push(step);
            let ends = |m: usize| frames.contains(&m) || joints.iter().any(|(last, _)| *last == m);
            let joint = joints.iter().position(|(last, _)| *last == i);
            plan.place(model, i, joint, ends);
        }
        for i in (0..plan.nodes.len()).rev() {
            let carried = plan.nodes[i].carried;
            if let Some(parent) = plan.nodes[i].parent {
                plan.nodes[parent].carried += carried;
            }
        }
        let roots = plan.nodes.iter().filter(|node| node.parent.is_none());
        plan.mass = roots.fold(model.fixed.0, |sum, node| sum + node.carried);
        plan.joints = joints.into_iter().map(|(_, axes)| axes).collect();
        plan
    }

    fn step(&mut self, mobility: &Mobility) -> Step {
        let way = match (mobility.motion, mobility.principal) {
            (_, Some((k, sign))) => Way::Principal(k, sign),
            (Motion::Hinge(axis), None) => Way::Axis(axis.into_inner().into()),
            (Motion::Slide(axis), None) => Way::Slide(axis.into_inner().into()),
            (Motion::Ball, None) => Way::Ball,
        };
        let source = match &mobility.drive {
            Drive::Coordinate(c) => Source::Coordinate(*c),
            Drive::Fixed(value) => {
                self.fixed.push(*value);
                Source::Fixed(*value)
            }
            Drive::Function(..) => {
                self.functions += 1;
                Source::Function(self.functions - 1)
            }
        };
        let turned = mobility.turned.then(|| mobility.rotation.into());
        Step { turned, way, source, element: mobility.rate }
    }

    /// Adds mobility `i` to the node before, if it is its only child in the same point and the node carries nothing else, or makes
    /// a new node.
    fn place(&mut self, model: &Model, i: usize, joint: Option<usize>, ends: impl Fn(usize) -> bool) {
        let mobility = &model.mobilities[i];
        let first_moment = mobility.first_moment.into();
        let translation: [f64; 3] = mobility.translation.into();
        let slides = |m: usize| matches!(model.mobilities[m].motion, Motion::Slide(_));
        let alone = |m: usize| model.mobilities.iter().filter(|other| other.parent == Some(m)).count() == 1;
        let before = mobility.parent.filter(|&p| {
            p + 1 == i
                && translation == [0.0; 3]
                && !slides(i)
                && !slides(p)
                && model.mobilities[p].mass == 0.0
                && alone(p)
                && !ends(p)
        });
        if let (Some(_), Some(node)) = (before, self.nodes.last_mut()) {
            node.motions.end = i + 1;
            (node.mass, node.carried, node.first_moment) = (mobility.mass, mobility.mass, first_moment);
            node.joint = joint;
        } else {
            self.nodes.push(Node {
                parent: mobility.parent.map(|p| self.node_of[p]),
                translation: (translation != [0.0; 3]).then_some(translation),
                motions: i..i + 1,
                mass: mobility.mass,
                first_moment,
                carried: mobility.mass,
                joint,
            });
        }
        self.node_of.push(self.nodes.len() - 1);
    }

    /// The frame of a segment, whose mobility ends a node.
    pub(super) fn attached(&self, model: &Model, segment: usize) -> Attached {
        let segment = &model.segments[segment];
        let rotation = segment.offset.rotation.to_rotation_matrix().into_inner();
        let turned = (rotation != nalgebra::Matrix3::identity()).then(|| rotation.into());
        let origin = segment.offset.translation.vector.into();
        Attached { node: segment.mobility.map(|m| self.node_of[m]), turned, origin }
    }

    /// Whether a mobility is the last motion of its node.
    pub(super) fn ends_node(&self, mobility: usize) -> bool {
        self.nodes[self.node_of[mobility]].motions.end == mobility + 1
    }
}

/// The mobility of the last hinge of a three-axis joint, and the axes of the joint.
fn joint_axes(model: &Model, joint: usize) -> (usize, JointAxes) {
    let joint = &model.three_axis[joint];
    let drives = |m: &Mobility| m.motion != Motion::Ball && m.drive == Drive::Coordinate(joint.coordinates[2]);
    let last = model.mobilities.iter().position(drives).unwrap_or_default();
    let rates = joint.coordinates.map(|c| model.coordinates[c].rate.unwrap_or_default());
    (last, JointAxes { axes: joint.axes.map(Into::into), rates })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Adult, adult};

    #[test]
    fn every_mobility_of_the_adult_is_in_one_node_and_all_mass_is_carried_to_the_root() {
        let model = adult(&Adult::default()).unwrap();
        let plan = Plan::new(&model, &[]);
        let ends: Vec<usize> = plan.nodes.iter().map(|node| node.motions.end).collect();
        assert!(ends.windows(2).all(|pair| pair[0] < pair[1]) && ends.last() == Some(&model.mobilities.len()));
        assert!(plan.nodes.len() < plan.steps.len());
        assert!((plan.mass - model.mass()).abs() < 1e-12 * model.mass());
    }

    #[test]
    fn a_frame_that_is_asked_for_ends_a_node() {
        let model = adult(&Adult::default()).unwrap();
        let plan = Plan::new(&model, &[]);
        let inner = (0..model.mobilities.len()).find(|&m| !plan.ends_node(m)).unwrap();
        assert!(Plan::new(&model, &[inner]).ends_node(inner));
    }
}
