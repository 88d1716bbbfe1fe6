//! Builds the capsules of the adult's parts from `data/shapes.toml`.
//!
//! A capsule stands for a stretch `h` of its segment and a share of its mass `m` at the density `rho`. Along the segment its radius
//! is `r = sqrt(m / (pi rho h))`; across it, `k` times as broad as deep, `r = sqrt(m / ((4 (k - 1) + pi) rho h))`.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::Model;
use super::adult::{AdultError, Recipe, direction, sided};
use super::data::ShapeRow;
use super::shape::{Capsule, Shape};

impl Recipe<'_> {
    /// `model` with the shapes of those segments that it has.
    pub(super) fn with_shapes(&self, model: Model) -> Result<Model, AdultError> {
        let mut shapes: Vec<Shape> = vec![];
        let mut names: Vec<[String; 2]> = vec![];
        for left in [false, true] {
            for row in self.library.shapes.shape.iter().filter(|row| !left || row.name.ends_with("_r")) {
                let Some(segment) = model.segment(&sided(&row.segment, left)) else { continue };
                let name = sided(&row.name, left);
                names.extend(row.meets.iter().map(|other| [name.clone(), other_side(other, left)]));
                shapes.push(Shape { name, capsule: self.capsule(row, &model, segment)?, sole: row.sole });
            }
        }
        let index = |name: &String| shapes.iter().position(|shape| &shape.name == name);
        let mut meeting: Vec<(usize, usize)> = vec![];
        for [a, b] in &names {
            if let (Some(a), Some(b)) = (index(a), index(b)) {
                meeting.push((a.min(b), a.max(b)));
            }
        }
        meeting.sort_unstable();
        meeting.dedup();
        Ok(model.with_shapes(shapes, meeting))
    }

    fn capsule(&self, row: &ShapeRow, model: &Model, segment: usize) -> Result<Capsule, AdultError> {
        let missing = || AdultError::Data(row.segment.clone());
        let of = self.library.adult.segment.iter().find(|s| s.name == row.segment).ok_or_else(missing)?;
        let length = self.length_of(of)?;
        let volume = row.mass_share * model.segments()[segment].mass / self.library.shapes.density.kg_per_m3;
        let section = volume / ((row.to - row.from) * length);
        let at =
            |share: f64| self.size.stature * Vector3::from(of.proximal_at_stature) + share * length * direction(of);
        let Some(across) = row.across else {
            let radius = (section / PI).sqrt();
            let by = |inset: bool, sign: f64| if inset { sign * radius * direction(of) } else { Vector3::zeros() };
            let ends = [at(row.from) + by(row.inset[0], 1.0), at(row.to) + by(row.inset[1], -1.0)];
            return Ok(Capsule { segment, ends, radius });
        };
        let radius = (section / (4.0 * (across - 1.0) + PI)).sqrt();
        let middle = at(0.5 * (row.from + row.to));
        let side = (across - 1.0) * radius * Vector3::z();
        Ok(Capsule { segment, ends: [middle - side, middle + side], radius })
    }
}

/// A name on the left side: `hand_l` becomes `hand_r` and the other way round.
fn other_side(name: &str, left: bool) -> String {
    match name.strip_suffix("_l") {
        Some(stem) if left => format!("{stem}_r"),
        _ => sided(name, left),
    }
}
