//! Describes the bodies of a picture in plain numbers.

use crate::axes::drawable;

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
    /// The parts at the start, drawn pale; may be empty. Their loads are not shown.
    pub start: Vec<BodyPart>,
    /// Contact forces on the body.
    pub forces: Vec<BodyForce>,
    /// Centre of mass.
    pub center_of_mass: Option<[f64; 3]>,
    /// Height of the ground; with `None` no ground is drawn.
    pub ground: Option<f64>,
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
}

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

    /// Size of the force, N; 0 if it cannot be drawn.
    pub(crate) fn size(&self) -> f64 {
        let size = self.force.iter().map(|f| f * f).sum::<f64>().sqrt();
        if drawable(size) { size } else { 0.0 }
    }
}

impl BodyPosture {
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
