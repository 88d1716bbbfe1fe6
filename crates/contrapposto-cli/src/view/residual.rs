//! Computes the residual of a free root: the largest force and moment that neither loads nor muscles give.

use contrapposto::model::{CoordinateKind, Model, Motion};

use crate::view::torque_rows::{Frame, Order};

/// The rates of joints that let a body fall, and the largest residual there.
pub(crate) struct Residual {
    /// Joint's name, its slides and its turns, by `Order::rows`.
    roots: Vec<(String, Vec<usize>, Vec<usize>)>,
    /// By root: force (N) and moment (N m), each with its time, s.
    largest: Vec<[(f64, f64); 2]>,
}

impl Residual {
    /// The free roots of `model`: joints to ground that slide in two directions at least, and turn.
    pub(crate) fn new(model: &Model) -> Self {
        let order = Order::new(model);
        let mut roots = vec![];
        for segment in model.segments().iter().filter(|segment| segment.parent.is_none()) {
            let own = |kind| {
                let of_kind = move |c: &usize| model.coordinates()[*c].kind == kind;
                segment.coordinates.clone().filter(of_kind).filter_map(|c| model.coordinates()[c].rate)
            };
            let slides: Vec<usize> = own(CoordinateKind::Translation).collect();
            let mut turns: Vec<usize> = own(CoordinateKind::Rotation).collect();
            if segment.joint_kind.motions().contains(&Motion::Ball) {
                let axes = ["mx", "my", "mz"].map(|axis| format!("{}_{axis}", segment.joint));
                turns.extend((0..model.rates().len()).filter(|&r| axes.contains(&model.rates()[r].name)));
            }
            let rows = |rates: &[usize]| -> Vec<usize> {
                (0..order.rows.len()).filter(|&row| rates.contains(&order.rows[row].rate)).collect()
            };
            if slides.len() >= 2 && !turns.is_empty() {
                roots.push((segment.joint.clone(), rows(&slides), rows(&turns)));
            }
        }
        let largest = vec![[(0.0, 0.0); 2]; roots.len()];
        Self { roots, largest }
    }

    pub(crate) fn record(&mut self, frame: &Frame<'_>) {
        for ((_, slides, turns), largest) in self.roots.iter().zip(&mut self.largest) {
            let size = |rows: &[usize]| rows.iter().map(|&row| frame.rows[row].active.powi(2)).sum::<f64>().sqrt();
            for (rows, largest) in [slides, turns].into_iter().zip(largest) {
                let size = size(rows);
                if size > largest.0 {
                    *largest = (size, frame.time);
                }
            }
        }
    }

    /// A warning or note about the largest residual: its kind, and its text. `None` where it is negligible.
    pub(crate) fn message(&self, model: &Model, grounded: bool) -> Option<(&'static str, String)> {
        let worst = self.roots.iter().zip(&self.largest).max_by(|a, b| a.1[0].0.total_cmp(&b.1[0].0))?;
        let ((joint, ..), [(force, at_force), (moment, at_moment)]) = worst;
        let weight = model.mass() * model.gravity().norm();
        if *force < 1e-6 * weight.max(1.0) && *moment < 1e-6 * weight.max(1.0) {
            return None;
        }
        let residual = format!("residual force {force:.2} N at {at_force} s, moment {moment:.2} N m at {at_moment} s");
        Some(if grounded {
            ("note", format!("`{joint}` still carries a residual that muscles cannot give: {residual}"))
        } else {
            let advice = "give what holds the body with --grf FILE.mot or --force";
            ("warning", format!("nothing holds the body up: `{joint}` carries a {residual}; {advice}"))
        })
    }
}
