//! Writes the bounds and rows of contact forces: friction pyramids and shares of the weight.

use super::FACES;
use super::support::Support;
use hierarchical_least_squares::Level;

/// Greatest force of a corner, body weights. Without a limit, straight legs would press two supports that cannot slip apart
/// with ever greater forces for a small decrease of effort.
const GREATEST_FORCE: f64 = 2.0;

/// Number of unknowns of a corner.
pub(crate) const FORCES_PER_CORNER: usize = 3;

/// Bounds of a force, in body weights: corners push and never pull.
pub(crate) fn bounds(force: usize) -> (f64, f64) {
    if force.is_multiple_of(FORCES_PER_CORNER) { (0.0, GREATEST_FORCE) } else { (-GREATEST_FORCE, GREATEST_FORCE) }
}

/// Place of the forces among the unknowns of a problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknowns<'a> {
    /// Index of the first force.
    pub(crate) first: usize,
    /// Present forces, where the unknowns are their changes.
    pub(crate) now: Option<&'a [f64]>,
}

impl Unknowns<'_> {
    fn now(&self, force: usize) -> f64 {
        self.now.map_or(0.0, |now| now[force])
    }
}

/// Rows that keep the friction of a support's corners inside its pyramid. `row` has an entry for every unknown.
pub(crate) fn friction_rows(
    level: &mut Level,
    row: &mut [f64],
    support: &Support,
    corners: std::ops::Range<usize>,
    unknowns: Unknowns<'_>,
) {
    if support.friction.is_infinite() {
        return;
    }
    let most = support.friction / (FACES as f64 / 2.0).sqrt();
    for normal in corners.map(|corner| FORCES_PER_CORNER * corner) {
        for (axis, sign) in [(1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            row.fill(0.0);
            row[unknowns.first + normal] = -most;
            row[unknowns.first + normal + axis] = sign;
            let excess = sign * unknowns.now(normal + axis) - most * unknowns.now(normal);
            level.push(row, f64::NEG_INFINITY, -excess);
        }
    }
}

/// The row that limits a support to its share; arguments as of [`friction_rows`].
pub(crate) fn share_row(
    level: &mut Level,
    row: &mut [f64],
    support: &Support,
    corners: std::ops::Range<usize>,
    unknowns: Unknowns<'_>,
) {
    if support.share_max >= 1.0 {
        return;
    }
    row.fill(0.0);
    let mut share = 0.0;
    for normal in corners.map(|corner| FORCES_PER_CORNER * corner) {
        row[unknowns.first + normal] = 1.0;
        share += unknowns.now(normal);
    }
    level.push(row, f64::NEG_INFINITY, support.share_max - share);
}
