//! Computes the objective of a frame, its gradient, and the two matrices of its second derivatives.
//!
//! `matrix` is Gauss and Newton's, `J^T W J`. `curvature` is the rest, `sum w_m (x_m - o_m) . x_m''`: the gradient of the external torque
//! of world-fixed forces `w_m (x_m - o_m)` at the markers (Eqs. 7, 8). Both have one row a free rate. The curvature of a coupling in the
//! error of a dependent coordinate is left out: it changes the way to the answer, not the answer.

use nalgebra::Vector3;

use super::goals::Goals;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::{Posture, PostureError};
use crate::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};

/// Objective of one posture. Depends on posture and observations; filled by [`Objective::evaluate`] and [`Objective::derive`].
#[derive(Clone, Debug)]
pub(super) struct Objective {
    kinematics: Kinematics,
    /// `x_m - o_m` of markers that the frame has, m.
    pub(super) errors: Vec<Option<Vector3<f64>>>,
    /// `f` in the module's text of `tracking`.
    pub(super) value: f64,
    /// By free rate.
    pub(super) gradient: Vec<f64>,
    /// Row after row, whole.
    pub(super) matrix: Vec<f64>,
    pub(super) curvature: Vec<f64>,
    /// The greatest entry on the diagonal of `matrix` by markers; by coordinates where no marker gives any.
    pub(super) scale: f64,
    /// Rates that may change.
    pub(super) free: Vec<usize>,
    /// Place in `free` of each rate.
    place: Vec<Option<usize>>,
    /// Rows of a Jacobian: all rates, and those of free ones that are not zero.
    rows: Vec<f64>,
    columns: Vec<(usize, Vector3<f64>)>,
    loads: Vec<Load>,
    torque: ExternalTorque,
    bend: Gradient,
    /// One over the sum of the weights of the markers that the frame has.
    share: f64,
}

impl Objective {
    /// Space for `model`; `free` are the rates that may change.
    pub(super) fn new(model: &Model, goals: &Goals, free: Vec<usize>) -> Self {
        let (rates, n) = (model.rates().len(), free.len());
        let mut place = vec![None; rates];
        free.iter().enumerate().for_each(|(at, &rate)| place[rate] = Some(at));
        Self {
            kinematics: Kinematics::new(model),
            errors: vec![None; goals.markers.len()],
            value: 0.0,
            gradient: vec![0.0; n],
            matrix: vec![0.0; n * n],
            curvature: vec![0.0; n * n],
            scale: 0.0,
            free,
            place,
            rows: vec![0.0; 3 * rates],
            columns: Vec::with_capacity(n),
            loads: Vec::with_capacity(goals.markers.len()),
            torque: ExternalTorque::new(model),
            bend: Gradient::new(model),
            share: 0.0,
        }
    }

    /// Sets the markers of a frame: the sum of their weights. Does not allocate.
    pub(super) fn observe(&mut self, goals: &Goals, observed: &[Option<Vector3<f64>>]) {
        let seen = goals.markers.iter().zip(observed).filter(|(_, at)| at.is_some());
        let weight: f64 = seen.map(|(marker, _)| marker.weight).sum();
        self.share = if weight > 0.0 { 1.0 / weight } else { 0.0 };
    }

    /// Computes errors and value. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model.
    pub(super) fn evaluate(
        &mut self,
        model: &Model,
        goals: &Goals,
        posture: &Posture,
        observed: &[Option<Vector3<f64>>],
    ) -> Result<f64, PostureError> {
        self.kinematics.update(model, posture)?;
        let mut sum = 0.0;
        for ((error, marker), at) in self.errors.iter_mut().zip(&goals.markers).zip(observed) {
            *error = at.map(|at| self.kinematics.station(model, marker.segment, marker.point) - at);
            sum += error.map_or(0.0, |error| marker.weight * error.norm_squared());
        }
        let wanted = goals.coordinates.iter().map(|goal| {
            let error = self.kinematics.values()[goal.coordinate] - goal.value;
            goal.weight * error * error
        });
        self.value = 0.5 * (sum * self.share + wanted.sum::<f64>());
        Ok(self.value)
    }

    /// Computes gradient and matrices in the posture of the last [`Objective::evaluate`]. Does not allocate.
    pub(super) fn derive(&mut self, model: &Model, goals: &Goals) {
        self.gradient.fill(0.0);
        self.matrix.fill(0.0);
        self.loads.clear();
        for (index, marker) in goals.markers.iter().enumerate() {
            let weight = marker.weight * self.share;
            if let Some(error) = self.errors[index].filter(|_| weight > 0.0) {
                self.kinematics.point_jacobian(model, marker.segment, marker.point, &mut self.rows);
                let kind = LoadKind::Force(weight * error, FixedIn::World);
                self.loads.push(Load { segment: marker.segment, point: marker.point, kind });
                self.add_rows(weight, error);
            }
        }
        self.scale = self.greatest_diagonal();
        for goal in &goals.coordinates {
            let error = self.kinematics.values()[goal.coordinate] - goal.value;
            if let Some(rate) = model.coordinates()[goal.coordinate].rate.filter(|_| goal.weight > 0.0) {
                self.rows.fill(0.0);
                self.rows[rate] = 1.0;
                self.kinematics.fold_columns(model, &mut self.rows);
                self.add_rows(goal.weight, Vector3::new(error, 0.0, 0.0));
            }
        }
        if self.scale <= 0.0 {
            self.scale = self.greatest_diagonal();
        }
        self.bend(model);
        let n = self.free.len();
        for row in 0..n {
            for column in 0..row {
                self.matrix[row * n + column] = self.matrix[column * n + row];
            }
        }
    }

    fn greatest_diagonal(&self) -> f64 {
        let n = self.free.len();
        (0..n).map(|i| self.matrix[i * n + i]).fold(0.0, f64::max)
    }

    /// Adds the three rows of `rows` with a weight and their errors.
    fn add_rows(&mut self, weight: f64, error: Vector3<f64>) {
        let (n, rates) = (self.free.len(), self.place.len());
        let (x, rest) = self.rows.split_at(rates);
        let (y, z) = rest.split_at(rates);
        self.columns.clear();
        for (at, &rate) in self.free.iter().enumerate() {
            let column = Vector3::new(x[rate], y[rate], z[rate]);
            if column != Vector3::zeros() {
                self.columns.push((at, column));
            }
        }
        for (first, &(row, left)) in self.columns.iter().enumerate() {
            let left = weight * left;
            self.gradient[row] += left.dot(&error);
            let to = &mut self.matrix[row * n..(row + 1) * n];
            for (column, right) in &self.columns[first..] {
                to[*column] += left.dot(right);
            }
        }
    }

    /// Fills `curvature`; with zeros where the forces are larger than a load may be.
    fn bend(&mut self, model: &Model) {
        let n = self.free.len();
        if self.torque.update_weightless(model, &self.kinematics, &self.loads).is_err() {
            self.curvature.fill(0.0);
            return;
        }
        self.torque.gradient(model, &self.kinematics, &mut self.bend);
        for (row, &i) in self.free.iter().enumerate() {
            for (column, &j) in self.free.iter().enumerate() {
                self.curvature[row * n + column] = 0.5 * (self.bend.get(i, j) + self.bend.get(j, i));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::math::Function;
    use crate::model::{Adult, CoordinateSpec, JointKind, ModelBuilder, SegmentSpec, adult};
    use crate::tracking::{CoordinateGoal, MarkerGoal};

    type Places = Vec<Option<Vector3<f64>>>;

    /// Markers on all segments with places near the body, and two coordinates with wanted values.
    fn goals(model: &Model, random: &mut Pcg64Mcg, coordinates: [usize; 2]) -> (Goals, Places) {
        let mut near = |size: f64| Vector3::from_fn(|_, _| random.random_range(-size..size));
        let body = Kinematics::new(model);
        let markers: Vec<MarkerGoal> = (0..model.segments().len())
            .map(|segment| MarkerGoal { segment, point: near(0.2), weight: 0.5 + segment as f64 % 3.0 })
            .collect();
        let place = |marker: &MarkerGoal| Some(body.station(model, marker.segment, marker.point) + near(0.3));
        let observed = markers.iter().map(place).collect();
        let coordinates = coordinates.map(|coordinate| CoordinateGoal { coordinate, value: 0.1, weight: 0.7 }).to_vec();
        (Goals { markers, coordinates, ..Goals::default() }, observed)
    }

    /// Gradient by differences of the value, and second derivatives by differences of the gradient; the largest difference of each.
    fn compare(model: &Model, goals: &Goals, observed: &Places, start: &Posture) -> (f64, f64) {
        let dependent = |rate: usize| model.rates()[rate].coordinate.is_some_and(|c| model.is_dependent(c));
        let free: Vec<usize> = (0..model.rates().len()).filter(|&rate| !dependent(rate)).collect();
        let n = free.len();
        let mut objective = Objective::new(model, goals, free.clone());
        objective.observe(goals, observed);
        let mut at = |posture: &Posture| {
            objective.evaluate(model, goals, posture, observed).unwrap();
            objective.derive(model, goals);
            let second: Vec<f64> = objective.matrix.iter().zip(&objective.curvature).map(|(a, b)| a + b).collect();
            (objective.value, objective.gradient.clone(), second)
        };
        let mut moved = |rate: usize, by: f64| {
            let mut step = vec![0.0; model.rates().len()];
            step[rate] = by;
            let mut posture = start.clone();
            posture.displace(model, &step);
            at(&posture)
        };
        const H: f64 = 1e-5;
        let (mut first, mut second) = (0.0_f64, 0.0_f64);
        let here = moved(free[0], 0.0);
        for (column, &rate) in free.iter().enumerate() {
            let (ahead, behind) = (moved(rate, H), moved(rate, -H));
            first = first.max(((ahead.0 - behind.0) / (2.0 * H) - here.1[column]).abs());
            for row in 0..n {
                let difference = (ahead.1[row] - behind.1[row]) / (2.0 * H);
                second = second.max((difference - here.2[row * n + column]).abs());
            }
        }
        (first, second)
    }

    #[test]
    fn derivatives_of_the_adult_are_their_central_differences() {
        let mut random = Pcg64Mcg::new(11);
        let model = adult(&Adult::default()).unwrap();
        for _ in 0..5 {
            let mut posture = model.default_posture();
            posture.values_mut().iter_mut().for_each(|value| *value += random.random_range(-0.4..0.4));
            let (goals, observed) = goals(&model, &mut random, [7, 9]);
            let (first, second) = compare(&model, &goals, &observed, &posture);
            assert!(first < 1e-9 && second < 1e-8, "{first:e}, {second:e}");
        }
    }

    /// Of a linear coupling nothing is left out.
    #[test]
    fn derivatives_of_a_coupled_chain_are_their_central_differences() {
        let mut random = Pcg64Mcg::new(12);
        let mut builder = ModelBuilder::new("chain", Vector3::zeros());
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        for (i, name) in ["a", "b", "c", "d"].into_iter().enumerate() {
            let spec = SegmentSpec {
                name: format!("s{name}"),
                parent: (i > 0).then(|| format!("s{}", ["a", "b", "c"][i - 1])),
                mass: 1.0,
                center_of_mass: Vector3::zeros(),
                inertia: nalgebra::Matrix3::identity(),
                joint: format!("j{name}"),
                kind: JointKind::Hinge(axes[i % 3]),
                in_parent: nalgebra::Isometry3::translation(0.1, -0.3, 0.05),
                in_segment: nalgebra::Isometry3::identity(),
                coordinates: vec![CoordinateSpec::new(name, (-3.0, 3.0))],
            };
            builder.segment(spec).unwrap();
        }
        builder.couple("c", "b", Function::Linear { slope: -0.6, intercept: 0.2 }).unwrap();
        let model = builder.build();
        for _ in 0..5 {
            let mut posture = model.default_posture();
            posture.values_mut().iter_mut().for_each(|value| *value += random.random_range(-0.8..0.8));
            let (goals, observed) = goals(&model, &mut random, [1, 2]);
            let (first, second) = compare(&model, &goals, &observed, &posture);
            assert!(first < 1e-9 && second < 1e-8, "{first:e}, {second:e}");
        }
    }
}
