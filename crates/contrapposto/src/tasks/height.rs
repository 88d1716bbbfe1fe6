//! Error and Jacobian of the height of a point above another segment's origin, along an axis that the other segment carries.
//!
//! With the point `p` of one segment, the origin `o` and the axis `a` of the other one, in ground, the error is `a . (p - o)` less the wanted
//! height, m. The axis turns with its segment: with `r = p - o` the row is `a . (J_p - J_o) + (a x r) . W`, `W` the rotation of that segment.
//!
//! The built-in adult's shoulder joint rises along the thorax as the arm is raised: by `H (1 - cos e) / 2` at an elevation `e`, `H` with the arm
//! overhead. The point `H / 2` above the joint along the upper arm then stays at one height of the thorax ([`Height::shoulder_rhythm`]).

use nalgebra::{UnitVector3, Vector3};

use super::check::{Check, TaskError, TaskPart};
use super::rows::{add_along, append, equation};
use crate::joint_torques::JointTorques;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::model::data::library;
use crate::posture::Posture;
use crate::statics::Gradient;
use hierarchical_least_squares::Level;

/// The segment along which shoulders rise, in the built-in adult.
const THORAX: &str = "torso";
/// The coordinate of each shoulder's rise, and the segment that it carries, in the built-in adult.
const SHOULDERS: [[&str; 2]; 2] = [["shoulder_rise_r", "humerus_r"], ["shoulder_rise_l", "humerus_l"]];

/// A point of a segment at a height above the origin of another segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// Index of the segment of the point.
    pub segment: usize,
    /// The point, in that segment's frame, m.
    pub point: Vector3<f64>,
    /// Index of the segment above which heights are counted.
    pub above: usize,
    /// The axis along which they are counted, in the frame of `above`.
    pub along: UnitVector3<f64>,
    /// Wanted height, m.
    pub height: f64,
}

impl Height {
    /// The rhythm of both shoulders, with the coordinate of each: the joint lies `H (1 - cos e) / 2` higher along the thorax than in the default
    /// posture, `e` the elevation of the upper arm against the thorax, `H` a share of the upper end of the coordinate's range
    /// (`data/adult.toml`). Empty for a body without the coordinates and segments of the built-in adult.
    ///
    /// ```
    /// use contrapposto::model::{Adult, adult};
    /// use contrapposto::tasks::Height;
    /// let model = adult(&Adult::default())?;
    /// let [(coordinate, right), _] = Height::shoulder_rhythm(&model)[..] else { panic!() };
    /// assert_eq!(model.coordinates()[coordinate].name, "shoulder_rise_r");
    /// assert_eq!(model.segments()[right.above].name, "torso");
    /// # Ok::<(), contrapposto::model::AdultError>(())
    /// ```
    pub fn shoulder_rhythm(model: &Model) -> Vec<(usize, Self)> {
        let kinematics = Kinematics::new(model);
        let of_side = |[coordinate, upper_arm]: [&str; 2]| {
            let coordinate = model.coordinate(coordinate)?;
            let (segment, above) = (model.segment(upper_arm)?, model.segment(THORAX)?);
            let rise = library().shoulder_rise() * model.coordinates()[coordinate].range.1;
            let shoulder = kinematics.station(model, segment, Vector3::zeros());
            let joint = kinematics.placement(model, above).inverse_transform_point(&shoulder.into());
            let point = Vector3::new(0.0, 0.5 * rise, 0.0);
            let height = joint.y - model.coordinates()[coordinate].default + 0.5 * rise;
            Some((coordinate, Self { segment, point, above, along: Vector3::y_axis(), height }))
        };
        SHOULDERS.into_iter().filter_map(of_side).collect()
    }

    /// Gives the shoulders of postures the rise of their rhythm; without shoulders of that kind, and where a posture does not fit the body,
    /// nothing changes.
    ///
    /// ```
    /// use contrapposto::model::{Adult, adult};
    /// use contrapposto::tasks::Height;
    /// let model = adult(&Adult::default())?;
    /// let index = |name| model.coordinate(name).unwrap();
    /// let mut posture = model.default_posture();
    /// posture.values_mut()[index("arm_add_r")] = 0.0;
    /// posture.values_mut()[index("arm_flex_r")] = 180f64.to_radians();
    /// Height::raise_shoulders(&model, [&mut posture]);
    /// // 2.2 percent of a stature of 1.741 m with the arm overhead.
    /// assert!((posture.values()[index("shoulder_rise_r")] - 0.0383).abs() < 1e-4);
    /// # Ok::<(), contrapposto::model::AdultError>(())
    /// ```
    pub fn raise_shoulders<'p>(model: &Model, postures: impl IntoIterator<Item = &'p mut Posture>) {
        let shoulders = Self::shoulder_rhythm(model);
        if shoulders.is_empty() {
            return;
        }
        let mut kinematics = Kinematics::new(model);
        for posture in postures {
            if kinematics.update(model, posture).is_ok() {
                for (coordinate, task) in &shoulders {
                    let (line, axis) = task.line(model, &kinematics);
                    posture.values_mut()[*coordinate] += task.height - axis.dot(&line);
                }
            }
        }
    }

    /// Height at which the origin of the segment meets the task, m, for a point on the axis `along` of both segments whose axes are at an angle of
    /// this cosine: the height of a shoulder joint whose arm is raised.
    pub fn of_origin(&self, cosine: f64) -> f64 {
        self.height - self.along.dot(&self.point) * cosine
    }

    /// From the origin of `above` to the point, and the axis, ground.
    fn line(&self, model: &Model, kinematics: &Kinematics) -> (Vector3<f64>, Vector3<f64>) {
        let origin = kinematics.station(model, self.above, Vector3::zeros());
        let line = kinematics.station(model, self.segment, self.point) - origin;
        (line, kinematics.direction(model, self.above, self.along.into_inner()))
    }

    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> f64 {
        let (line, axis) = self.line(model, body.kinematics());
        axis.dot(&line) - self.height
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let n = model.rates().len();
        let (line, axis) = self.line(model, body.kinematics());
        // One row, then the nine that it is made of, which are removed again.
        let (row, jacobians) = append(level, model, 10).split_at_mut(n);
        let (point, rest) = jacobians.split_at_mut(3 * n);
        let (origin, turn) = rest.split_at_mut(3 * n);
        body.kinematics().point_jacobian(model, self.segment, self.point, point);
        body.kinematics().point_jacobian(model, self.above, Vector3::zeros(), origin);
        body.kinematics().rotation_jacobian(model, self.above, turn);
        add_along(row, &axis, point);
        add_along(row, &-axis, origin);
        add_along(row, &axis.cross(&line), turn);
        level.matrix.truncate(level.matrix.len() - 9 * n);
        equation(level, axis.dot(&line) - self.height);
    }

    /// Adds the second derivative of the error, times `weight`, for a segment that `above` carries.
    pub(super) fn add_second_derivative(&self, model: &Model, kinematics: &Kinematics, weight: f64, to: &mut Gradient) {
        let axis = weight * kinematics.direction(model, self.above, self.along.into_inner());
        kinematics.seconds_of_point(model, (self.segment, self.point), self.above, |i, j, second| {
            to.add_symmetric(i, j, axis.dot(&second));
        });
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.segment(self.segment)?;
        check.segment(self.above)?;
        check.vector(TaskPart::Point, &self.point)?;
        check.unit(TaskPart::Direction, self.along.norm())?;
        check.vector(TaskPart::Target, &Vector3::new(0.0, self.height, 0.0))
    }
}
