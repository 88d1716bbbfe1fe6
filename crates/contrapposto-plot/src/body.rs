//! Describes the bodies of a picture in plain numbers.

use crate::axes::drawable;

/// Greatest number of surfaces and of things that are drawn.
const MOST_BOXES: usize = 24;
/// Least length of the arrow of a load, m, as on pages.
const SHORTEST_LOAD: f64 = 0.25;
/// Thickness of a surface, m.
const SLAB_THICKNESS: f64 = 0.025;

/// Bodies side by side.
#[derive(Clone, Debug, Default)]
pub struct BodyFigure {
    /// First line above the picture.
    pub title: String,
    /// Second line above the picture; may be empty.
    pub subtitle: String,
    /// Meaning of the crosses in the legend, e.g. "target".
    pub target: String,
    /// The postures from left to right; the first five are drawn.
    pub postures: Vec<BodyPosture>,
}

/// One body in one posture. Axes: x forward, y up, z to the right; m, N.
#[derive(Clone, Debug, Default)]
pub struct BodyPosture {
    /// Title above the body; may be empty.
    pub title: String,
    /// Key numbers, a line each; the first six are shown.
    pub notes: Vec<String>,
    /// Parts of the body.
    pub parts: Vec<BodyPart>,
    /// Muscles, drawn over the parts, which are pale then.
    pub muscles: Vec<BodyMuscle>,
    /// The parts at the start, drawn pale; may be empty. Their loads are not shown.
    pub start: Vec<BodyPart>,
    /// Contact forces on the body.
    pub forces: Vec<BodyForce>,
    /// Centre of mass.
    pub center_of_mass: Option<[f64; 3]>,
    /// Height of the ground; with `None` no ground is drawn.
    pub ground: Option<f64>,
    /// Surfaces that carry the body, a seat, a table, a step: the four corners of each in order.
    pub surfaces: Vec<[[f64; 3]; 4]>,
    /// Things around the body and in its hands.
    pub things: Vec<BodyThing>,
    /// Loads on the body besides its weight.
    pub loads: Vec<BodyForce>,
    /// Targets of points, drawn as crosses.
    pub targets: Vec<[f64; 3]>,
    /// Lines of sight: the eye and its target.
    pub gazes: Vec<[[f64; 3]; 2]>,
}

/// A solid part: the hull of a few balls.
#[derive(Clone, Debug, Default)]
pub struct BodyPart {
    /// Centre and radius of each.
    pub balls: Vec<[f64; 4]>,
    /// Load of the muscles that move the part, as a share of their strength, not negative; `None` where it is not known.
    pub load: Option<f64>,
    /// Whether ligaments carry it where that is a hazard: it then has a colour of its own.
    pub hazard: bool,
}

/// A muscle, drawn as a line in the colour of its activation.
#[derive(Clone, Debug, Default)]
pub struct BodyMuscle {
    /// Points of its path, from attachment to attachment; one line a branch.
    pub lines: Vec<Vec<[f64; 3]>>,
    /// Radius of the muscle.
    pub radius: f64,
    /// Activation, 0 to 1.
    pub activation: f64,
}

/// A thing, drawn as a box.
#[derive(Clone, Debug, Default)]
pub struct BodyThing {
    /// Name in the legend.
    pub label: String,
    /// Corners of the thing; the bits of the index say at which end along its axes x (1), y (2) and z (4).
    pub corners: Corners,
}

/// The corners of a box, in the order that [`BodyThing`] explains.
pub(crate) type Corners = [[f64; 3]; 8];

/// A force on the body.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyForce {
    /// Point where the force acts.
    pub at: [f64; 3],
    /// The force vector.
    pub force: [f64; 3],
}

impl BodyForce {
    /// Tip of the force's arrow, m; `length_per_newton` in m/N.
    pub(crate) fn tip(&self, length_per_newton: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at[k] + length_per_newton * self.force[k])
    }

    /// The same of a load, which is never too short to be seen.
    pub(crate) fn tip_of_load(&self, length_per_newton: f64) -> [f64; 3] {
        let size = self.size();
        let is_short = size > 0.0 && length_per_newton * size < SHORTEST_LOAD;
        self.tip(if is_short { SHORTEST_LOAD / size } else { length_per_newton })
    }

    /// Size of the force, N; 0 if it cannot be drawn.
    pub(crate) fn size(&self) -> f64 {
        let size = self.force.iter().map(|f| f * f).sum::<f64>().sqrt();
        if drawable(size) { size } else { 0.0 }
    }
}

impl BodyPosture {
    /// Corners of all boxes that are drawn: surfaces as thin slabs, then things, which `true` marks.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = (Corners, bool)> {
        let surfaces = self.surfaces.iter().take(MOST_BOXES).map(|corners| (slab(corners), false));
        let things = self.things.iter().take(MOST_BOXES).map(|thing| (thing.corners, true));
        surfaces.chain(things).filter(|(corners, _)| corners.iter().flatten().all(|v| drawable(*v)))
    }

    /// A square of the ground around the contacts and below the centre of mass.
    pub(crate) fn ground_square(&self) -> Option<[[f64; 3]; 4]> {
        const AROUND: f64 = 0.28;
        let ground = self.ground.filter(|height| drawable(*height))?;
        let points = self.forces.iter().map(|force| force.at).chain(self.center_of_mass);
        let points = points.filter(|point| point.iter().all(|v| drawable(*v)));
        let around = points.fold(None, |found: Option<[f64; 4]>, [x, _, z]| {
            let [a, b, c, d] = found.unwrap_or([x, x, z, z]);
            Some([a.min(x), b.max(x), c.min(z), d.max(z)])
        });
        let [back, front, left, right] = around?;
        let corner = |x: f64, z: f64| [x, ground, z];
        let (back, front, left, right) = (back - AROUND, front + AROUND, left - AROUND, right + AROUND);
        Some([corner(back, left), corner(front, left), corner(front, right), corner(back, right)])
    }
}

/// A thin box below four corners.
fn slab(top: &[[f64; 3]; 4]) -> Corners {
    let [u, v] = [1, 3].map(|i| [0, 1, 2].map(|k| top[i][k] - top[0][k]));
    let up = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = up.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let below = |corner: [f64; 3]| [0, 1, 2].map(|k| corner[k] - SLAB_THICKNESS * up[k] / length);
    let [a, b, c, d] = *top;
    [below(a), below(b), a, b, below(d), below(c), d, c]
}
