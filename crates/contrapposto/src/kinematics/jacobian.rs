//! Computes the Jacobians of points and rotations of segments.
//!
//! An elementary hinge (or axis of a ball) `r` through `p` moves a carried point `x` by `r x (x - p)` and turns its segment by
//! `r`; a slide moves it by `r`. A drive `u = f(q)` gives its coordinate `f'(q)` times that, and the column of a
//! dependent coordinate is added to that of its independent one, times the slope of the coupling, as `statics/fold.rs` does.
//!
//! All matrices have three rows (ground x, y, z) and one column a rate of the model, row after row.

use nalgebra::Vector3;

use super::Kinematics;
use crate::model::{Drive, Model, Motion};

impl Kinematics {
    /// `d point / d rates` of a point fixed in a segment (m, its frame): 3 rows in ground axes, m/rad (m/m for slides),
    /// overwritten. Columns of coordinates that follow others are zero. Does not allocate.
    ///
    /// # Panics
    /// Unless `rows` has three times as many entries as the model has rates.
    pub fn point_jacobian(&self, model: &Model, segment: usize, point: Vector3<f64>, rows: &mut [f64]) {
        let point = self.station(model, segment, point);
        let mut columns = Columns::over(model, self, rows);
        let mut next = model.segments[segment].mobility;
        while let Some(i) = next {
            let mobility = &model.mobilities[i];
            if let Motion::Slide(_) = mobility.motion {
                columns.add(mobility.rate, self.axes[mobility.rate]);
            } else {
                let arm = point - self.origins[i];
                for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                    columns.add(element, self.axes[element].cross(&arm));
                }
            }
            next = mobility.parent;
        }
        self.fold_columns(model, rows);
    }

    /// Angular velocity of a segment per rate: 3 rows in ground axes, rad/rad (rad/m for slides that drive hinges),
    /// overwritten. Columns of coordinates that follow others are zero. Does not allocate.
    ///
    /// # Panics
    /// Unless `rows` has three times as many entries as the model has rates.
    pub fn rotation_jacobian(&self, model: &Model, segment: usize, rows: &mut [f64]) {
        let mut columns = Columns::over(model, self, rows);
        let mut next = model.segments[segment].mobility;
        while let Some(i) = next {
            let mobility = &model.mobilities[i];
            if !matches!(mobility.motion, Motion::Slide(_)) {
                for element in mobility.rate..mobility.rate + mobility.motion.rates() {
                    columns.add(element, self.axes[element]);
                }
            }
            next = mobility.parent;
        }
        self.fold_columns(model, rows);
    }

    /// Second derivatives of a point by pairs of motions between the segment `above` and the point's own, seen from `above`: for each pair the
    /// rate of the outer motion, of the inner one, and the derivative, m in ground axes. A slide has none with what it carries. Nothing where
    /// `above` does not carry the segment, or a motion between them is a ball, a function or dependent. Does not allocate.
    pub(crate) fn seconds_of_point(
        &self,
        model: &Model,
        (segment, point): (usize, Vector3<f64>),
        above: usize,
        mut add: impl FnMut(usize, usize, Vector3<f64>),
    ) {
        let point = self.station(model, segment, point);
        let (start, end) = (model.segments[segment].mobility, model.segments[above].mobility);
        let rate = |m: usize| match (&model.mobilities[m].motion, &model.mobilities[m].drive) {
            (Motion::Ball, _) => None,
            (_, Drive::Coordinate(c)) if !model.is_dependent(*c) => model.coordinates[*c].rate,
            _ => None,
        };
        let mut next = start;
        while next != end {
            let Some(m) = next.filter(|m| rate(*m).is_some()) else { return };
            next = model.mobilities[m].parent;
        }
        let axis = |m: usize| self.axes[model.mobilities[m].rate];
        let slides = |m: usize| matches!(model.mobilities[m].motion, Motion::Slide(_));
        let mut inner = start;
        while let Some(j) = inner.filter(|_| inner != end) {
            let moved = if slides(j) { axis(j) } else { axis(j).cross(&(point - self.origins[j])) };
            let mut outer = inner;
            while let Some(i) = outer.filter(|_| outer != end) {
                if let (false, Some(by), Some(of)) = (slides(i), rate(i), rate(j)) {
                    add(by, of, axis(i).cross(&moved));
                }
                outer = model.mobilities[i].parent;
            }
            inner = model.mobilities[j].parent;
        }
    }

    /// Rows of derivatives by rates as if nothing were coupled become rows with the column of every dependent coordinate
    /// folded into that of its independent one. Does not allocate.
    pub fn fold_columns(&self, model: &Model, rows: &mut [f64]) {
        for (coupling, (slope, _)) in model.couplings.iter().zip(&self.couplings).rev() {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) {
                for row in rows.chunks_exact_mut(model.rates.len()) {
                    row[i] += slope * std::mem::take(&mut row[d]);
                }
            }
        }
    }
}

/// Three rows that take columns of elementary motions.
pub(super) struct Columns<'a> {
    model: &'a Model,
    kinematics: &'a Kinematics,
    x: &'a mut [f64],
    y: &'a mut [f64],
    z: &'a mut [f64],
}

impl<'a> Columns<'a> {
    /// Clears `rows`.
    pub(super) fn over(model: &'a Model, kinematics: &'a Kinematics, rows: &'a mut [f64]) -> Self {
        let n = model.rates.len();
        assert_eq!(rows.len(), 3 * n, "a Jacobian has three rows of {n} entries");
        rows.fill(0.0);
        let (x, rest) = rows.split_at_mut(n);
        let (y, z) = rest.split_at_mut(n);
        Self { model, kinematics, x, y, z }
    }

    /// Adds what an elementary motion does to the rate it belongs to.
    #[inline]
    pub(super) fn add(&mut self, element: usize, column: Vector3<f64>) {
        if self.model.direct {
            (self.x[element], self.y[element], self.z[element]) = (column.x, column.y, column.z);
        } else if let Some(rate) = self.model.elements[element] {
            let slope = self.kinematics.drives[element].0;
            self.x[rate] += slope * column.x;
            self.y[rate] += slope * column.y;
            self.z[rate] += slope * column.z;
        }
    }
}
