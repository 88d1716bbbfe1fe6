//! Orders links and joints to a tree, depth first, without recursion.

use super::attributes::{name_place, required};
use super::error::{UrdfError, UrdfRule};
use super::joint::Joint;
use super::link::{segment, solids};
use super::options::Options;
use crate::model_ir::{
    Coupling, Function, Ignored, ModelIr, RootAttachment, compose_couplings, near, unique_coordinates,
};
use crate::xml::{Node, shorten};
use nalgebra::Isometry3;
use std::collections::BTreeMap;

type Names<'a> = BTreeMap<&'a str, usize>;

pub(super) fn build(
    body: &mut ModelIr,
    robot: Node<'_>,
    links: &[Node<'_>],
    joints: &[Joint<'_>],
    options: &Options,
    ignored: &mut Ignored,
) -> Result<(), UrdfError> {
    let names = names_of_links(links)?;
    let mut by_name = Names::new();
    for (index, joint) in joints.iter().enumerate() {
        if by_name.insert(joint.name, index).is_some() {
            return Err(UrdfError::DuplicateName { place: name_place(joint.node), value: joint.name.to_owned() });
        }
    }
    let mut children: Vec<Vec<usize>> = vec![vec![]; links.len()];
    let mut is_child = vec![false; links.len()];
    for &index in by_name.values() {
        let joint = &joints[index];
        children[link_index(&names, joint.parent)?].push(index);
        let child = link_index(&names, joint.child)?;
        if std::mem::replace(&mut is_child[child], true) {
            let place = joint.child.0.attribute_place("link");
            return Err(UrdfError::Invalid { place, value: joint.child.1.to_owned(), needs: UrdfRule::OneParent });
        }
    }
    let root = root_link(robot, links, &is_child, &body.name)?;
    let mut coordinate_of = vec![None; joints.len()];
    let mut seen = vec![false; links.len()];
    let mut waiting = vec![(root, None::<(usize, usize)>)]; // link, (joint, parent segment)
    while let Some((link, by)) = waiting.pop() {
        seen[link] = true;
        let mut segment = segment(links[link], links[link].attribute("name").unwrap_or_default(), ignored)?;
        let index = body.segments.len();
        body.solids.extend(solids(links[link], index, ignored)?);
        if let Some((joint, parent)) = by {
            let first = body.coordinates.len();
            segment.parent = Some(parent);
            segment.joint = joints[joint].name.to_owned();
            segment.in_parent = joints[joint].origin;
            segment.motions = joints[joint].motions(body, options.limits.coordinates)?;
            coordinate_of[joint] = joints[joint].is_single().then_some(first);
        } else if options.root == RootAttachment::Free {
            segment.motions = body.free_joint("root", &Isometry3::identity());
        }
        body.segments.push(segment);
        // The last one pushed is taken first.
        for &joint in children[link].iter().rev() {
            waiting.push((link_index(&names, joints[joint].child)?, Some((joint, index))));
        }
    }
    if let Some(lost) = seen.iter().position(|s| !s) {
        return Err(invalid(links[lost], UrdfRule::NoCycle));
    }
    unique_coordinates(body).map_err(|value| UrdfError::DuplicateName { place: robot.place(), value })?;
    couple(body, joints, &by_name, &coordinate_of, ignored)
}

/// Numbers of the links by name.
fn names_of_links<'a>(links: &[Node<'a>]) -> Result<Names<'a>, UrdfError> {
    let mut names = Names::new();
    for (index, &link) in links.iter().enumerate() {
        let name = required(link, "name")?;
        if names.insert(name, index).is_some() {
            return Err(UrdfError::DuplicateName { place: name_place(link), value: name.to_owned() });
        }
    }
    Ok(names)
}

/// The one link that is no child.
fn root_link(robot: Node<'_>, links: &[Node<'_>], is_child: &[bool], model: &str) -> Result<usize, UrdfError> {
    let mut roots = (0..links.len()).filter(|&i| !is_child[i]);
    let root = match (roots.next(), links.first()) {
        (Some(root), _) => root,
        (None, Some(&link)) => return Err(invalid(link, UrdfRule::NoCycle)),
        (None, None) => {
            let value = model.to_owned();
            return Err(UrdfError::Invalid { place: robot.place(), value, needs: UrdfRule::SomeLink });
        }
    };
    match roots.next() {
        Some(second) => Err(invalid(links[second], UrdfRule::OneRoot)),
        None => Ok(root),
    }
}

fn invalid(link: Node<'_>, needs: UrdfRule) -> UrdfError {
    UrdfError::Invalid { place: name_place(link), value: link.attribute("name").unwrap_or_default().to_owned(), needs }
}

fn link_index(names: &Names<'_>, (node, name): (Node<'_>, &str)) -> Result<usize, UrdfError> {
    names.get(name).copied().ok_or_else(|| UrdfError::UnknownName {
        place: node.attribute_place("link"),
        value: shorten(name),
        nearest: near(name, names.keys().copied()),
    })
}

/// Mimicking joints, chains of them composed to the joint that moves by itself.
fn couple(
    body: &mut ModelIr,
    joints: &[Joint<'_>],
    by_name: &Names<'_>,
    coordinate_of: &[Option<usize>],
    ignored: &mut Ignored,
) -> Result<(), UrdfError> {
    let mut followers = vec![];
    for (joint, dependent) in joints.iter().zip(coordinate_of) {
        let (Some(mimic), &Some(dependent)) = (&joint.mimic, dependent) else { continue };
        let place = || mimic.node.attribute_place("joint");
        // As in Pinocchio, the joint then moves by itself.
        let Some(&leader) = by_name.get(mimic.joint) else {
            ignored.add("mimic of a joint that is not there", 1);
            continue;
        };
        let independent = coordinate_of[leader].ok_or_else(|| UrdfError::Invalid {
            place: place(),
            value: shorten(mimic.joint),
            needs: UrdfRule::MimicKind,
        })?;
        let function = Function::Linear { slope: mimic.multiplier, intercept: mimic.offset };
        followers.push((Coupling { dependent, independent, function }, place()));
    }
    followers.sort_by_key(|(coupling, _)| coupling.dependent);
    let (mut couplings, places): (Vec<_>, Vec<_>) = followers.into_iter().unzip();
    compose_couplings(&mut couplings, body.coordinates.len()).map_err(|index| {
        let value = body.coordinates[couplings[index].independent].name.clone();
        UrdfError::Invalid { place: places[index].clone(), value, needs: UrdfRule::MimicCircle }
    })?;
    body.couplings = couplings;
    Ok(())
}
