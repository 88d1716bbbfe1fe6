//! Computes falling tables of the passive torque of muscles about one coordinate, its neighbours held.
//!
//! A table has 25 rows over a range. The neighbours are held at multiples of 2 degrees (5 mm for slides), so that a table depends on the
//! posture alone, not on the postures before, and is made anew when a neighbour passes to the next one. Where the torque rises with the
//! angle, neighbouring rows are levelled to their mean (pool adjacent violators; Barlow et al. 1972, recalled).

use std::sync::Arc;

use nalgebra::Vector3;

use crate::contact::root_rates;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::muscle::{FiberState, Musculature, PathGeometry, PathRule, bushing_torque, passive_torque};
use crate::passive::{PassiveCurve, Tabulated};
use crate::posture::Posture;

/// Activation of a muscle at rest: the least of OpenSim's muscles.
pub const RESTING_ACTIVATION: f64 = 0.01;
/// Rows of a table.
const ROWS: usize = 25;
/// Steps at which neighbours are held: rad, and m for slides.
const HELD_STEPS: (f64, f64) = (2.0 * std::f64::consts::PI / 180.0, 5e-3);

/// The falling table of one coordinate near a posture, and what was levelled for it.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) curve: Arc<PassiveCurve>,
    /// Greatest rise of the torque that was levelled, N m.
    pub(super) rise: f64,
    /// Greatest less least torque, N m.
    pub(super) span: f64,
}

/// Makes the table of one coordinate, and keeps the last one.
#[derive(Clone, Debug)]
pub(super) struct TableMaker {
    coordinate: usize,
    range: (f64, f64),
    /// The muscles and ligaments that the joint moves.
    muscles: Musculature,
    geometry: PathGeometry,
    rest: Vec<FiberState>,
    kinematics: Kinematics,
    /// The coordinates that change the torque besides, with the step at which each is held; 0 for the exact value.
    neighbours: Vec<(usize, f64)>,
    held: Vec<f64>,
    table: Option<Table>,
    torques: [Vec<f64>; 2],
    step: Vec<f64>,
}

impl TableMaker {
    /// For one coordinate with a rate, over a range, rad.
    pub(super) fn new(model: &Model, all: &Musculature, coordinate: usize, range: (f64, f64)) -> Self {
        let own = own_coordinates(model, coordinate);
        let whole = PathGeometry::new(model, &all.paths);
        let crosses = |path: usize| {
            let crossed = whole.crossed_by(model, std::iter::once(path));
            own.iter().any(|&c| model.coordinates()[c].rate.is_some_and(|rate| crossed.contains(&rate)))
        };
        let muscles = Musculature {
            paths: all.paths.clone(),
            muscles: all.muscles.iter().filter(|muscle| crosses(muscle.spec().path)).cloned().collect(),
            ligaments: all.ligaments.iter().filter(|ligament| crosses(ligament.path)).cloned().collect(),
            bushings: all.bushings.clone(),
            sharing: all.sharing,
        }
        .with_used_paths();
        let n = model.rates().len();
        let geometry = PathGeometry::new(model.by_axes(), &muscles.paths);
        Self {
            coordinate,
            range,
            neighbours: neighbours(model, &muscles, coordinate),
            held: vec![],
            table: None,
            rest: vec![FiberState::default(); muscles.muscles.len()],
            geometry,
            kinematics: Kinematics::new(model.by_axes()),
            torques: [vec![0.0; n], vec![0.0; n]],
            step: vec![0.0; n],
            muscles,
        }
    }

    /// The coordinate.
    pub(super) fn coordinate(&self) -> usize {
        self.coordinate
    }

    /// The table with the neighbours near `angles` (rad or m, of all coordinates; of three-axis joints about their axes); `None` where a
    /// torque is no number, and none was made before.
    pub(super) fn table(&mut self, model: &Model, angles: &[f64]) -> Option<&Table> {
        let near = |(i, step): &(usize, f64)| if *step > 0.0 { (angles[*i] / step).round() * step } else { angles[*i] };
        let held: Vec<f64> = self.neighbours.iter().map(near).collect();
        if self.table.is_none() || held != self.held {
            self.held = held;
            // Without a new one the last one stays: torque and gradient of the posture do not depend on it.
            self.table = self.make(model).or_else(|| self.table.take());
        }
        self.table.as_ref()
    }

    fn make(&mut self, model: &Model) -> Option<Table> {
        let (low, high) = self.range;
        let mut rows = Vec::with_capacity(ROWS);
        let mut angles = model.default_posture().values().to_vec();
        for joint in model.three_axis_joints() {
            let about = joint.orientation(model.default_posture().values()).angles.values;
            joint.coordinates.into_iter().zip(about).for_each(|(i, angle)| angles[i] = angle);
        }
        self.neighbours.iter().zip(&self.held).for_each(|((i, _), angle)| angles[*i] = *angle);
        for k in 0..ROWS {
            // The last row is at the very end of the range.
            let share = k as f64 / (ROWS - 1) as f64;
            angles[self.coordinate] = (1.0 - share) * low + share * high;
            rows.push((angles[self.coordinate], self.torque(model, &angles)?));
        }
        let (rise, span) = rise_and_span(&rows);
        level(&mut rows);
        let curve = PassiveCurve::new(Tabulated::new(&rows).ok()?.form(), self.range, None).ok()?;
        Some(Table { curve: Arc::new(curve), rise, span })
    }

    /// Passive torque by the coordinate's angle, N m, at the angles of all coordinates.
    fn torque(&mut self, model: &Model, angles: &[f64]) -> Option<f64> {
        // The coordinates of a three-axis joint are near its angles; a turn makes up for the difference.
        let posture = Posture::new(angles.to_vec());
        for joint in model.three_axis_joints() {
            let to = joint.swing_twist.orientation(joint.coordinates.map(|i| angles[i]));
            let turn = (joint.rotation(angles).inverse() * to).scaled_axis();
            for (axis, i) in joint.axes.iter().zip(joint.coordinates) {
                if let Some(rate) = model.coordinates()[i].rate {
                    self.step[rate] = axis.dot(&turn);
                }
            }
        }
        let body = model.by_axes();
        self.kinematics.update_turned(body, &posture, &self.step).ok()?;
        self.geometry.update(body, &self.kinematics, &self.muscles.paths, PathRule::Geodesic);
        for (muscle, rest) in self.muscles.muscles.iter().zip(&mut self.rest) {
            *rest = muscle.at_rest(self.geometry.lengths()[muscle.spec().path], RESTING_ACTIVATION);
        }
        let [torques, more] = &mut self.torques;
        passive_torque(&self.muscles, &self.geometry, &self.rest, torques);
        bushing_torque(&self.muscles.bushings, body, &self.kinematics, more);
        let total = |i: usize| model.coordinates()[i].rate.map_or(0.0, |rate| torques[rate] + more[rate]);
        let torque = match model.three_axis_joint_of(self.coordinate) {
            None => total(self.coordinate),
            Some((joint, place)) => {
                let of = &model.three_axis_joints()[joint];
                let to = of.swing_twist.orientation(of.coordinates.map(|i| angles[i]));
                by_angles(&of.swing_twist.angles(&to).first, &Vector3::from(of.coordinates.map(total)))?[place]
            }
        };
        torque.is_finite().then_some(torque)
    }
}

/// Torques by the angles of a three-axis joint from its moment about the axes: `m_k = sum_j tau_j E_k x_j`.
pub(super) fn by_angles(first: &nalgebra::Matrix3<f64>, moment: &Vector3<f64>) -> Option<Vector3<f64>> {
    Some(first.transpose().try_inverse()? * moment)
}

/// The coordinate, with the others of its three-axis joint.
fn own_coordinates(model: &Model, coordinate: usize) -> Vec<usize> {
    let joint = model.three_axis_joint_of(coordinate);
    joint.map_or_else(|| vec![coordinate], |(joint, _)| model.three_axis_joints()[joint].coordinates.to_vec())
}

/// The coordinates besides `own` that change the torque of muscles, each with its step.
fn neighbours(model: &Model, muscles: &Musculature, own: usize) -> Vec<(usize, f64)> {
    let crossed = PathGeometry::new(model, &muscles.paths).crossed(model);
    let root = root_rates(model);
    let step = |(i, coordinate): (usize, &crate::model::Coordinate)| {
        let rate = coordinate.rate.filter(|_| i != own && !model.is_dependent(i))?;
        let in_joint = own_coordinates(model, own).contains(&i);
        match model.rates()[rate].rotational {
            true if crossed.contains(&rate) || in_joint => Some((i, HELD_STEPS.0)),
            _ if root.contains(&rate) => None,
            true if coordinate.locked => Some((i, 0.0)),
            true => None,
            false => Some((i, HELD_STEPS.1)),
        }
    };
    model.coordinates().iter().enumerate().filter_map(step).collect()
}

/// The greatest rise from one row to a later one, and greatest less least torque.
fn rise_and_span(rows: &[(f64, f64)]) -> (f64, f64) {
    let (mut least, mut greatest, mut rise) = (f64::INFINITY, f64::NEG_INFINITY, 0f64);
    for (_, torque) in rows {
        (least, greatest) = (least.min(*torque), greatest.max(*torque));
        rise = rise.max(torque - least);
    }
    (rise, greatest - least)
}

/// Levels rises: the falling rows nearest to these, by the sum of squares.
fn level(rows: &mut [(f64, f64)]) {
    // Blocks of rows: sum and number.
    let mut blocks: Vec<(f64, usize)> = vec![];
    for (_, torque) in rows.iter() {
        let mut block = (*torque, 1);
        while let Some((sum, count)) = blocks.last().copied()
            && sum / count as f64 <= block.0 / block.1 as f64
        {
            block = (block.0 + sum, block.1 + count);
            blocks.pop();
        }
        blocks.push(block);
    }
    let levels = blocks.into_iter().flat_map(|(sum, count)| std::iter::repeat_n(sum / count as f64, count));
    rows.iter_mut().zip(levels).for_each(|((_, torque), level)| *torque = level);
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::{level, rise_and_span};

    /// The falling rows nearest to these by their min-max formula: the least over starts of the greatest over ends of the means between.
    fn by_means(rows: &[(f64, f64)]) -> Vec<f64> {
        let mean = |from: usize, to: usize| {
            rows[from..=to].iter().map(|(_, torque)| torque).sum::<f64>() / (to - from + 1) as f64
        };
        let greatest =
            |from: usize, i: usize| (i..rows.len()).map(|to| mean(from, to)).fold(f64::NEG_INFINITY, f64::max);
        (0..rows.len()).map(|i| (0..=i).map(|from| greatest(from, i)).fold(f64::INFINITY, f64::min)).collect()
    }

    #[test]
    fn levelled_rows_are_the_nearest_that_fall() {
        let mut random = Pcg64::seed_from_u64(20_261_124);
        println!("levels: seed 20261124");
        for _ in 0..200 {
            let count = random.random_range(2..26);
            let trend = random.random_range(-1.0..1.0);
            let mut rows: Vec<(f64, f64)> =
                (0..count).map(|k| (f64::from(k), trend * f64::from(k) + random.random_range(-3.0..3.0))).collect();
            let means = by_means(&rows);
            let falls = rows.windows(2).all(|pair| pair[1].1 <= pair[0].1);
            assert_eq!(rise_and_span(&rows).0 == 0.0, falls);
            level(&mut rows);
            assert!(rows.windows(2).all(|pair| pair[1].1 <= pair[0].1), "{rows:?}");
            for ((_, levelled), mean) in rows.iter().zip(means) {
                assert!((levelled - mean).abs() < 1e-12, "{rows:?}");
            }
        }
    }

    #[test]
    fn rise_is_the_greatest_from_a_row_to_a_later_one() {
        let rows = [(0.0, 3.0), (1.0, 1.0), (2.0, 2.0), (3.0, 1.5), (4.0, 4.0), (5.0, -2.0)];
        assert_eq!(rise_and_span(&rows), (3.0, 6.0));
    }
}
