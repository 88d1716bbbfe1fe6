//! Gives the built-in adult a skin: a mesh that is fitted to its joint centres, and a skeleton that moves it.

mod asset;
mod bones;
mod fit;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Placement};
use contrapposto::posture::Posture;
use nalgebra::{UnitQuaternion, Vector3};

use self::asset::Asset;
pub use self::bones::Bone;
use self::bones::nodes;
use super::joint_frames;

/// Bones that a vertex may have a weight of; nodes from here on move no skin.
const BONES: usize = 41;

/// Least brightness of a vertex, of the brightest one; colours show load, so that cloth and hair may differ a little only.
const DARKEST: f64 = 0.68;
/// Brightness that the hem of cloth loses, halfway between the brightness of cloth and that of skin.
const HEM: f64 = 0.4;

/// The nodes that move a skin, in ground axes.
#[derive(Clone, Debug)]
pub struct Skeleton {
    /// Nodes; first those that move the skin.
    pub nodes: Vec<Bone>,
    /// Joint frames of the T-pose, by segment: centre of the joint, m, and direction of the axes.
    pub rest: Vec<Placement>,
}

impl Skeleton {
    /// The skeleton of a body; `None` unless it is the whole built-in adult ([`Adult::of`]).
    pub fn of(model: &Model) -> Option<Self> {
        Adult::of(model)?;
        let rest = t_pose(model)?;
        Some(Self { nodes: nodes(model, &rest)?, rest })
    }

    /// The nodes that move the skin: the first ones.
    pub fn bones(&self) -> &[Bone] {
        &self.nodes[..BONES.min(self.nodes.len())]
    }

    /// Place of a node in the T-pose, m, where no node is turned.
    pub fn head(&self, node: usize) -> Vector3<f64> {
        self.rest[self.nodes[node].segment].translation.vector
    }

    /// Placement of every node, by the joint frames of all segments: centre of the joint and direction of the segment's axes.
    pub fn place(&self, frames: &[Placement]) -> Vec<Placement> {
        let turns: Vec<UnitQuaternion<f64>> =
            frames.iter().zip(&self.rest).map(|(frame, rest)| frame.rotation * rest.rotation.inverse()).collect();
        let place = |node: &Bone| Placement::from_parts(frames[node.segment].translation, node.turn(&turns));
        self.nodes.iter().map(place).collect()
    }

    /// Placement of every node by the kinematics of the model in a posture.
    pub fn place_by(&self, model: &Model, kinematics: &Kinematics) -> Vec<Placement> {
        self.place(&joint_frames(model, kinematics))
    }

    /// Placement of every node in a posture; `None` for a posture that does not fit the model.
    pub fn place_in(&self, model: &Model, posture: &Posture) -> Option<Vec<Placement>> {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).ok()?;
        Some(self.place_by(model, &kinematics))
    }
}

/// A mesh that follows a body, in ground axes.
#[derive(Clone, Debug)]
pub struct Skin {
    /// Vertices in the T-pose, m.
    pub vertices: Vec<Vector3<f64>>,
    /// Unit vectors out of the skin.
    pub normals: Vec<Vector3<f64>>,
    /// Corners of triangles, anticlockwise seen from outside.
    pub triangles: Vec<[u16; 3]>,
    /// Colour of every vertex, sRGB.
    pub colors: Vec<[u8; 3]>,
    /// Nodes that move a vertex.
    pub bones: Vec<[u8; 4]>,
    /// Weights of these bones, which sum to 255.
    pub weights: Vec<[u8; 4]>,
    /// The nodes.
    pub skeleton: Skeleton,
}

impl Skin {
    /// The skin of a body; `None` unless it is the whole built-in adult ([`Adult::of`]).
    pub fn of(model: &Model) -> Option<Self> {
        Self::from_file(model, asset::BYTES)
    }

    /// The same from the bytes of `data/skin/adult.skin`, for a program that does not carry them; `None`, too, for other bytes.
    pub fn from_file(model: &Model, bytes: &[u8]) -> Option<Self> {
        let (adult, skeleton) = (Adult::of(model)?, Skeleton::of(model)?);
        let asset = Asset::read(bytes)?;
        let vertices = fit::fitted(&asset, model, &adult, &skeleton.rest)?;
        let halves = |[a, b, c, d]: &[u16; 4]| [[*a, *b, *c], [*a, *c, *d]];
        let triangles: Vec<[u16; 3]> = asset.quads.iter().flat_map(halves).collect();
        let normals = normals(&vertices, &triangles);
        let Asset { bones, weights, colors, .. } = asset;
        Some(Self { vertices, normals, triangles, colors, bones, weights, skeleton })
    }

    /// The vertices, moved by the nodes.
    pub fn moved(&self, places: &[Placement]) -> Vec<Vector3<f64>> {
        let rests: Vec<Vector3<f64>> = (0..self.skeleton.nodes.len()).map(|node| self.skeleton.head(node)).collect();
        let moved = |((vertex, bones), weights): ((&Vector3<f64>, &[u8; 4]), &[u8; 4])| {
            let parts = bones.iter().zip(weights).filter(|(_, weight)| **weight > 0);
            let at = |bone: usize| places[bone].rotation * (vertex - rests[bone]) + places[bone].translation.vector;
            parts.map(|(&bone, &weight)| f64::from(weight) / 255.0 * at(usize::from(bone))).sum()
        };
        self.vertices.iter().zip(&self.bones).zip(&self.weights).map(moved).collect()
    }

    /// Brightness of every vertex, as a share of 255, for a skin whose colours show something else. Cloth ends in a dark hem, so that it
    /// is seen as cloth.
    pub fn light(&self) -> Vec<u8> {
        light(&self.colors)
    }
}

/// Brightness of vertices of these colours, as a share of 255.
fn light(colors: &[[u8; 3]]) -> Vec<u8> {
    let of = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    let brightest = colors.iter().copied().map(of).fold(1.0, f64::max);
    let darkest = colors.iter().copied().map(of).fold(brightest, f64::min);
    let share = |color: &[u8; 3]| {
        let bright = of(*color);
        let place = (bright - darkest) / (brightest - darkest).max(1.0);
        let hem = HEM * (1.0 - (2.0 * place - 1.0).abs());
        DARKEST + (1.0 - DARKEST) * bright / brightest - hem
    };
    colors.iter().map(|color| (255.0 * share(color)).round() as u8).collect()
}

/// Joint frames of the default posture with arms straight out to both sides, palms down.
fn t_pose(model: &Model) -> Option<Vec<Placement>> {
    let mut values = model.default_posture().values().to_vec();
    for name in ["arm_add_r", "arm_add_l"] {
        values[model.coordinate(name)?] = -std::f64::consts::FRAC_PI_2;
    }
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(values)).ok()?;
    Some(joint_frames(model, &kinematics))
}

/// Of every vertex the mean normal of its triangles, by their area.
fn normals(vertices: &[Vector3<f64>], triangles: &[[u16; 3]]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| vertices[usize::from(i)]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&i| sums[usize::from(i)] += normal);
    }
    sums.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_else(Vector3::y)).collect()
}

#[cfg(test)]
mod tests {
    use super::light;

    #[test]
    fn the_hem_between_cloth_and_skin_is_darker_than_both() {
        let [cloth, hem, bare] = light(&[[40; 3], [120; 3], [200; 3]])[..] else { panic!("three vertices") };
        assert!(hem < cloth && cloth < bare && bare == 255, "{cloth} {hem} {bare}");
    }
}
