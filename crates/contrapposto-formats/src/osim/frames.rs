//! Finds frames by their path: ground, bodies, and frames offset from others.

use std::collections::HashMap;

use nalgebra::Isometry3;

use super::attributes::Reader;
use super::error::OsimProblem;
use crate::model_ir::near;
use crate::xml::Node;

/// Frames inside each other that are followed.
const MOST_NESTED: usize = 64;
/// Components inside components of which the frames are registered.
const MOST_LEVELS: usize = 8;

/// Place at which a frame is fixed: a body's index (`None` is ground) and the pose there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attachment {
    pub(super) body: Option<usize>,
    pub(super) pose: Isometry3<f64>,
}

#[derive(Clone, Copy)]
enum Frame<'a> {
    Base(Option<usize>),
    Offset(Node<'a>),
}

/// All frames of a model.
#[derive(Default)]
pub(super) struct Frames<'a> {
    by_path: HashMap<String, Frame<'a>>,
}

impl<'a> Frames<'a> {
    pub(super) fn add_base(&mut self, path: String, body: Option<usize>) {
        self.by_path.entry(path).or_insert(Frame::Base(body));
    }

    /// Offset frames among `nodes`, as children of the component at `path`, and those inside them.
    pub(super) fn add_offsets(
        &mut self,
        reader: &Reader<'a>,
        path: &str,
        nodes: impl Iterator<Item = Node<'a>>,
    ) -> Result<(), OsimProblem> {
        self.add_level(reader, path, nodes, 0)
    }

    fn add_level(
        &mut self,
        reader: &Reader<'a>,
        path: &str,
        nodes: impl Iterator<Item = Node<'a>>,
        level: usize,
    ) -> Result<(), OsimProblem> {
        for node in nodes.filter(|n| n.name() == "PhysicalOffsetFrame") {
            let path = format!("{path}/{}", reader.unique_name(node)?);
            if let Some(inner) = node.child("components") {
                if level == MOST_LEVELS {
                    let what = "components inside each other";
                    return Err(OsimProblem::TooMany { place: node.place(), what, cap: MOST_LEVELS });
                }
                self.add_level(reader, &path, Vec::from_iter(inner.children()).into_iter(), level + 1)?;
            }
            self.by_path.entry(path).or_insert(Frame::Offset(node));
        }
        Ok(())
    }

    /// Frames that are fixed to others, with their paths, in the file's order.
    pub(super) fn offsets(&self) -> Vec<(&str, Node<'a>)> {
        let mut found = Vec::from_iter(self.by_path.iter().filter_map(|(path, frame)| match frame {
            Frame::Offset(node) => Some((path.as_str(), *node)),
            Frame::Base(_) => None,
        }));
        found.sort_by_key(|(_, node)| node.index());
        found
    }

    /// The frame that the socket `name` of the component at `path` is connected to.
    pub(super) fn socket(
        &self,
        reader: &Reader<'a>,
        component: Node<'a>,
        name: &str,
        path: &str,
    ) -> Result<Attachment, OsimProblem> {
        let (mut component, mut name, mut path) = (component, name, path.to_owned());
        let mut pose = Isometry3::identity();
        for _ in 0..MOST_NESTED {
            let (text, node) = reader.required_text(component, name)?;
            let target = absolute(&text, &path);
            let Some(frame) = self.by_path.get(&target) else {
                let near =
                    near(&target, self.by_path.keys().map(String::as_str).collect::<std::collections::BTreeSet<_>>());
                return Err(OsimProblem::Unknown {
                    place: node.place(),
                    what: "frame",
                    name: crate::xml::shorten(&text),
                    near,
                });
            };
            match *frame {
                Frame::Base(body) => return Ok(Attachment { body, pose }),
                Frame::Offset(offset) => {
                    pose = reader.pose(offset, "translation", "orientation")? * pose;
                    (component, name, path) = (offset, "socket_parent", target);
                }
            }
        }
        Err(OsimProblem::TooMany { place: component.place(), what: "frames fixed to each other", cap: MOST_NESTED })
    }
}

/// A path from the root, as seen from the component at `from`.
fn absolute(path: &str, from: &str) -> String {
    let start = if path.starts_with('/') { "" } else { from };
    let mut parts: Vec<&str> = start.split('/').filter(|p| !p.is_empty()).collect();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    format!("/{}", parts.join("/"))
}
