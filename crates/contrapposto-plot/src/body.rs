//! What is known of bodies that are to be drawn? Plain numbers.

use crate::axes::drawable;

/// Bodies side by side.
#[derive(Clone, Debug, Default)]
pub struct BodyFigure {
    /// First line above the picture.
    pub title: String,
    /// Second line above the picture; may be empty.
    pub subtitle: String,
    /// What crosses stand for, e.g. "target".
    pub target: String,
    /// From left to right; the first five are drawn.
    pub postures: Vec<BodyPosture>,
}

/// One body in one posture. Axes: x forward, y up, z to the right; m, N.
#[derive(Clone, Debug, Default)]
pub struct BodyPosture {
    /// Above it; may be empty.
    pub title: String,
    /// Key numbers, a line each; the first six are shown.
    pub notes: Vec<String>,
    /// What it is made of.
    pub parts: Vec<BodyPart>,
    /// The same before, drawn pale; may be empty. Loads of these parts are not shown.
    pub start: Vec<BodyPart>,
    /// What carries it.
    pub forces: Vec<BodyForce>,
    /// Its centre of mass.
    pub center_of_mass: Option<[f64; 3]>,
    /// Height of the ground; none is drawn without.
    pub ground: Option<f64>,
    /// What points should reach: crosses.
    pub targets: Vec<[f64; 3]>,
    /// Lines of sight: eye, and what it should meet.
    pub gazes: Vec<[[f64; 3]; 2]>,
}

/// A solid part: the hull of a few balls.
#[derive(Clone, Debug, Default)]
pub struct BodyPart {
    /// Centre and radius of each.
    pub balls: Vec<[f64; 4]>,
    /// Load of the muscles that move it, as a share of their strength, not negative; none where nothing is known.
    pub load: Option<f64>,
}

/// A force on the body.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyForce {
    /// Where it acts.
    pub at: [f64; 3],
    /// How large it is and which way it points.
    pub force: [f64; 3],
}

impl BodyForce {
    /// Where its arrow ends, m; `reach` is in m/N.
    pub(crate) fn tip(&self, reach: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at[k] + reach * self.force[k])
    }

    /// N; 0 where it cannot be drawn.
    pub(crate) fn size(&self) -> f64 {
        let size = self.force.iter().map(|f| f * f).sum::<f64>().sqrt();
        if drawable(size) { size } else { 0.0 }
    }
}

impl BodyPosture {
    /// A piece of the ground about its feet and below its centre of mass.
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
