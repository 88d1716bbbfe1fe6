//! Computes whether a posture returns by itself after a disturbance, and else which joints need attention.
//!
//! Muscles keep their torques, contact forces stay as world-fixed forces at their corners, supports stay in place: a small motion
//! `d` that the supports allow is answered by the torque `-K d` with the stiffness `K = -(d tau_p/dq + d tau_e/dq)`. The symmetric
//! part of `K` on the null space `Z` of the supports' Jacobians decides. One-sided constraints (a foot that could lift, the end of a
//! range) count as they are in the posture: feet stay, ranges do not push.
//!
//! The metric is the mass matrix `M`, loads with weight included: `Z^T K Z x = s Z^T M Z x`. How many `s` are negative does not
//! depend on the metric (Sylvester's law of inertia); in this one `1/sqrt(-s)` is the time in which a disturbance grows by `e`, and
//! slides and angles need no weights against each other. Joints without mass behind them get
//! [`LEAST_MASS`] of the largest entry, so that every `s` is finite.
//!
//! A slide within the body of which neither muscles nor tissue are known (the rise of a shoulder) stays in place: somebody holds it, and how
//! is not known.
//!
//! Motions of three-axis joints ([`crate::model::ThreeAxisJoint`]) are rotations about their axes.
//!
//! For one joint the result is that of [`crate::hybrid::Equilibrium`]: stable where `d tau_a / d theta > 0`.

use nalgebra::{Cholesky, DMatrix, DVector, SVD, SymmetricEigen};

use crate::contact::{Support, root_rates};
use crate::hybrid::{Carrier, Equilibrium};
use crate::joint_torques::JointTorques;
use crate::model::{CoordinateKind, Model};
use crate::statics::{Load, LoadKind};

/// Share of the largest diagonal entry of the mass matrix that every rate has at least.
pub const LEAST_MASS: f64 = 1e-9;
/// Singular values of the supports' Jacobian below this share of the largest count as zero: a free direction.
const ZERO_SINGULAR_VALUE: f64 = 1e-9;
/// Share of the largest eigenvalue below which an eigenvalue is rounding: neutral, as a ball on a table.
const ZERO_EIGENVALUE: f64 = 1e-12;

/// A motion that the supports allow, orthogonal to the others in the metric of the mass matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Change of every rate, of three-axis joints about their axes, rad or m; of length 1 in the metric of the mass matrix (kg m^2).
    pub motion: Vec<f64>,
    /// `s`, 1/s^2: acceleration back (positive) or away (negative) per motion.
    pub stiffness: f64,
    /// Part of the stiffness from passive tissue, 1/s^2.
    pub by_tissue: f64,
    /// Part of the stiffness from weight, loads and contact forces, 1/s^2.
    pub by_load: f64,
    /// Coordinates with muscles that move, with their share of the sum of squared motions; the largest first, those below a
    /// hundredth left out.
    pub joints: Vec<(usize, f64)>,
}

impl Direction {
    /// Time in which a disturbance grows by `e`, s; `None` for one that does not grow.
    pub fn growth_time(&self) -> Option<f64> {
        (self.stiffness < 0.0).then(|| 1.0 / (-self.stiffness).sqrt())
    }
}

/// Stability of a posture without attention.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// The equilibrium in the weakest direction; `None` where the supports allow no motion.
    pub equilibrium: Option<Equilibrium>,
    /// All directions, the least stable first.
    pub directions: Vec<Direction>,
    /// Number of directions that do not return by themselves.
    pub unstable: usize,
    /// Norm of the part of the stiffness that derives from no energy, over that of the symmetric part (Frobenius norms on the free
    /// directions): coupled passive laws, couples and body-fixed forces have such a part.
    pub without_energy: f64,
}

impl Stability {
    /// Directions that do not return by themselves, the least stable first.
    pub fn unstable(&self) -> &[Direction] {
        &self.directions[..self.unstable]
    }
}

/// Stiffness at every pair of rates, N m/rad, from passive tissue and from weight, loads and contact forces; row after row, not
/// symmetric. Three-axis joints turn about their axes, which turn with them: moments that have an energy give a symmetric matrix,
/// as half the moment about `e_m x e_l` is taken off.
pub fn stiffness(model: &Model, body: &JointTorques) -> [Vec<f64>; 2] {
    let n = model.rates().len();
    let mut tissue = vec![0.0; n * n];
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let (Some(rate), false) = (coordinate.rate, model.is_dependent(i)) else { continue };
        let row = &mut tissue[rate * n..(rate + 1) * n];
        body.passive_torque().add_row_about_axis(model, body.kinematics(), i, row);
    }
    let mut load: Vec<f64> = (0..n).flat_map(|rate| body.gradient_about_axes().row(rate).iter().copied()).collect();
    for (slopes, torques) in
        [(&mut tissue, body.passive_torque().about_axes()), (&mut load, body.external_about_axes())]
    {
        for joint in model.three_axis_joints() {
            let rates = joint.coordinates.map(|i| model.coordinates()[i].rate.unwrap_or_default());
            let turned = joint.turned(&rates.map(|rate| torques[rate]).into());
            for (l, row) in rates.into_iter().enumerate() {
                // Row l and column m hold E_m of the component about axis l.
                rates.into_iter().enumerate().for_each(|(m, by)| slopes[row * n + by] += 0.5 * turned[(l, m)]);
            }
        }
        slopes.iter_mut().for_each(|slope| *slope = -*slope);
    }
    [tissue, load]
}

/// Computes the stability of the posture of `body`, whose torques include contact forces. `loads` are those of the scenario:
/// weights among them have inertia. `locked`: rates that do not move, besides dependent coordinates.
pub fn stability(
    model: &Model,
    body: &JointTorques,
    supports: &[Support],
    loads: &[Load],
    locked: &[bool],
) -> Stability {
    let root = root_rates(model);
    let is_held = |coordinate: usize, rate: usize| {
        let own = &model.coordinates()[coordinate];
        let unknown = own.groups.is_none() && own.passive.is_none() && own.kind == CoordinateKind::Translation;
        model.is_dependent(coordinate) || unknown && !root.contains(&rate)
    };
    let free: Vec<usize> = (0..model.rates().len())
        .filter(|&i| !locked[i] && model.rates()[i].coordinate.is_none_or(|c| !is_held(c, i)))
        .collect();
    let basis = free_motions(model, body, supports, &free);
    if basis.ncols() == 0 {
        return Stability { equilibrium: None, directions: vec![], unstable: 0, without_energy: 0.0 };
    }
    let [tissue, load] = stiffness(model, body).map(|full| {
        let full = DMatrix::from_row_slice(model.rates().len(), model.rates().len(), &full);
        basis.transpose() * full.select_rows(&free).select_columns(&free) * &basis
    });
    let total = &tissue + &load;
    let half = symmetric(&total);
    let without_energy = (&total - &half).norm() / half.norm().max(f64::MIN_POSITIVE);
    let mut mass = mass_matrix(model, body, loads).select_rows(&free).select_columns(&free);
    let largest = mass.diagonal().max();
    let least = if largest > 0.0 { LEAST_MASS * largest } else { 1.0 };
    (0..free.len()).for_each(|i| mass[(i, i)] += least);
    let mass = basis.transpose() * mass * &basis;
    // Fails only for numbers that are not finite.
    let Some((directions, unstable)) = eigen_directions(model, (&basis, &free), &mass, [tissue, load]) else {
        return Stability { equilibrium: None, directions: vec![], unstable: 0, without_energy };
    };
    let weakest = &directions[0];
    let equilibrium = if unstable > 0 {
        Equilibrium::Unstable
    } else if weakest.by_tissue >= weakest.by_load {
        Equilibrium::Stable(Carrier::Ligaments)
    } else {
        Equilibrium::Stable(Carrier::Gravity)
    };
    Stability { equilibrium: Some(equilibrium), directions, unstable, without_energy }
}

fn symmetric(m: &DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (m + m.transpose())
}

/// Solves `K x = s M x` in the coordinates of `basis`, with `K` the sum of the two stiffnesses; returns the directions, the least
/// stable first, and the number of those that are not stable.
fn eigen_directions(
    model: &Model,
    (basis, free): (&DMatrix<f64>, &[usize]),
    mass: &DMatrix<f64>,
    [tissue, load]: [DMatrix<f64>; 2],
) -> Option<(Vec<Direction>, usize)> {
    let lower = Cholesky::new(symmetric(mass))?.l();
    let scaled = |m: &DMatrix<f64>| {
        let left = lower.solve_lower_triangular(m)?;
        lower.solve_lower_triangular(&left.transpose())
    };
    let found = SymmetricEigen::new(symmetric(&scaled(&symmetric(&(&tissue + &load)))?));
    let mut order: Vec<usize> = (0..basis.ncols()).collect();
    order.sort_by(|a, b| found.eigenvalues[*a].total_cmp(&found.eigenvalues[*b]));
    let (tissue, load) = (symmetric(&tissue), symmetric(&load));
    let direction = |i: usize| {
        let along: DVector<f64> = found.eigenvectors.column(i).into();
        let along = lower.tr_solve_lower_triangular(&along).unwrap_or(along);
        let moved = basis * &along;
        let mut motion = vec![0.0; model.rates().len()];
        free.iter().zip(moved.iter()).for_each(|(&rate, moved)| motion[rate] = *moved);
        Direction {
            stiffness: found.eigenvalues[i],
            by_tissue: along.dot(&(&tissue * &along)),
            by_load: along.dot(&(&load * &along)),
            joints: joints(model, &motion),
            motion,
        }
    };
    let directions: Vec<Direction> = order.into_iter().map(direction).collect();
    let rounding = ZERO_EIGENVALUE * found.eigenvalues.amax();
    let unstable = directions.iter().filter(|direction| direction.stiffness <= rounding).count();
    Some((directions, unstable))
}

/// An orthonormal basis of the motions of the `free` rates that leave all supports in place: one column a motion.
fn free_motions(model: &Model, body: &JointTorques, supports: &[Support], free: &[usize]) -> DMatrix<f64> {
    let n = model.rates().len();
    let mut segments: Vec<usize> = supports.iter().map(|support| support.segment).collect();
    segments.sort_unstable();
    segments.dedup();
    // At least as many rows as columns: the SVD then returns the whole basis.
    let mut jacobian = DMatrix::zeros((6 * segments.len()).max(free.len()), free.len());
    let mut rows = vec![0.0; 3 * n];
    for (i, &segment) in segments.iter().enumerate() {
        let corners = supports.iter().filter(|support| support.segment == segment).flat_map(|support| &support.corners);
        let middle = corners.clone().sum::<nalgebra::Vector3<f64>>() / corners.count().max(1) as f64;
        for turn in [false, true] {
            if turn {
                body.kinematics_by_axes().rotation_jacobian(model.by_axes(), segment, &mut rows);
            } else {
                body.kinematics_by_axes().point_jacobian(model.by_axes(), segment, middle, &mut rows);
            }
            for row in 0..3 {
                for (column, &rate) in free.iter().enumerate() {
                    jacobian[(6 * i + 3 * usize::from(turn) + row, column)] = rows[row * n + rate];
                }
            }
        }
    }
    if free.is_empty() || segments.is_empty() {
        return DMatrix::identity(free.len(), free.len());
    }
    let svd = SVD::new(jacobian, false, true);
    let largest = svd.singular_values.amax();
    let Some(rows) = svd.v_t else { return DMatrix::zeros(free.len(), 0) };
    let within = (0..free.len()).filter(|&i| svd.singular_values[i] <= ZERO_SINGULAR_VALUE * largest);
    let columns: Vec<DVector<f64>> = within.map(|i| rows.row(i).transpose()).collect();
    if columns.is_empty() { DMatrix::zeros(free.len(), 0) } else { DMatrix::from_columns(&columns) }
}

/// Mass matrix of all rates, kg m^2 (kg for slides).
fn mass_matrix(model: &Model, body: &JointTorques, loads: &[Load]) -> DMatrix<f64> {
    let n = model.rates().len();
    let mut sum = DMatrix::zeros(n, n);
    let mut rows = vec![0.0; 3 * n];
    let (kinematics, model) = (body.kinematics_by_axes(), model.by_axes());
    let mut points: Vec<_> = model.segments().iter().enumerate().map(|(i, s)| (i, s.center_of_mass, s.mass)).collect();
    for load in loads {
        if let LoadKind::Weight(mass) = load.kind {
            points.push((load.segment, load.point, mass));
        }
    }
    for (segment, point, mass) in points.into_iter().filter(|(_, _, mass)| *mass > 0.0) {
        kinematics.point_jacobian(model, segment, point, &mut rows);
        let jacobian = DMatrix::from_row_slice(3, n, &rows);
        sum += mass * jacobian.transpose() * jacobian;
    }
    for (i, segment) in model.segments().iter().enumerate() {
        kinematics.rotation_jacobian(model, i, &mut rows);
        let jacobian = DMatrix::from_row_slice(3, n, &rows);
        let turn = kinematics.placement(model, i).rotation.to_rotation_matrix();
        let inertia = turn.matrix() * segment.inertia * turn.matrix().transpose();
        sum += jacobian.transpose() * inertia * jacobian;
    }
    sum
}

/// Shares of a motion's squares, of coordinates with muscles; of all coordinates where none of those moves.
fn joints(model: &Model, motion: &[f64]) -> Vec<(usize, f64)> {
    let squares = |muscles: bool| -> Vec<(usize, f64)> {
        let coordinates = model.coordinates().iter().enumerate();
        let those = coordinates.filter(|(_, c)| !muscles || c.groups.is_some());
        those.filter_map(|(i, c)| Some((i, motion[c.rate?].powi(2)))).collect()
    };
    let sum = |list: &[(usize, f64)]| list.iter().map(|(_, square)| square).sum::<f64>();
    let mut list = squares(true);
    if sum(&list) <= 0.0 {
        list = squares(false);
    }
    let whole = sum(&list);
    list.retain(|(_, square)| *square >= 0.01 * whole && *square > 0.0);
    list.iter_mut().for_each(|(_, square)| *square /= whole);
    // A stable sort: of equals the first of the model.
    list.sort_by(|a, b| b.1.total_cmp(&a.1));
    list
}
