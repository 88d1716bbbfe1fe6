//! Writes muscles for the page's script: points in the frames of segments, so that only those that move there take room.

use serde_json::{Value, json};

use crate::column::{METRES, SHARE, TURN, column, columns};
use crate::{Muscle, Muscles, PathPoint, Report};

/// A frame that carries points of muscles: a segment, or ground.
#[derive(Clone, Debug, Default)]
pub struct Carrier {
    /// Placement in every frame of the report: origin, m, and unit quaternion `w x y z`.
    pub places: Vec<[f64; 7]>,
}

/// A joint that bones press together, over time.
#[derive(Clone, Debug, Default)]
pub struct PressedJoint {
    /// Name of the joint.
    pub name: String,
    /// The bone along which the force is taken.
    pub along: String,
    /// The force in every frame, N; negative where the joint is pulled apart.
    pub force: Vec<f64>,
    /// The force over the weight of the body.
    pub weights: Vec<f64>,
}

/// Steps to which tensions (N), forces of joints in body weights, and missing torques (N m) are rounded.
const TENSION: f64 = 1.0;
const WEIGHTS: f64 = 0.01;
const LACK: f64 = 0.1;

/// A carrier that is a drawn segment, too, names that part instead of its places.
pub(crate) fn muscles(muscles: &Muscles, report: &Report, n: usize) -> Value {
    let carrier = |carrier: &Carrier| {
        let part = report.segments.iter().position(|part| part.places == carrier.places);
        let [m, t] = [METRES, TURN];
        json!({ "part": part, "places": part.is_none().then(|| columns(&carrier.places, n, [m, m, m, t, t, t, t])) })
    };
    let known = |lack: &Option<(Option<usize>, f64)>| lack.unwrap_or_default();
    let lacks = muscles.lacks.iter().any(Option::is_some).then(|| {
        let torque = column(muscles.lacks.iter().map(|lack| known(lack).1), n, LACK);
        // One more than the index; 0 where the joint is not shown.
        let joint = |lack| known(lack).0.map_or(0.0, |joint| joint as f64 + 1.0);
        json!({ "torque": torque, "joint": column(muscles.lacks.iter().map(joint), n, 1.0) })
    });
    json!({
        "carriers": muscles.carriers.iter().map(carrier).collect::<Value>(),
        "lines": muscles.lines.iter().map(|line| muscle(line, muscles.carriers.len(), n)).collect::<Value>(),
        "lacks": lacks,
        "pressed": muscles.pressed.iter().map(|joint| pressed(joint, n)).collect::<Value>(),
    })
}

fn pressed(joint: &PressedJoint, n: usize) -> Value {
    let PressedJoint { name, along, force, weights } = joint;
    let [force, weights] = [(force, TENSION), (weights, WEIGHTS)].map(|(of, step)| column(of.iter().copied(), n, step));
    json!({ "name": name, "along": along, "force": force, "weights": weights })
}

fn muscle(muscle: &Muscle, carriers: usize, n: usize) -> Value {
    let points: Vec<&PathPoint> = muscle.points.iter().filter(|point| point.carrier < carriers).collect();
    let point = |point: &&PathPoint| json!({ "carrier": point.carrier, "at": columns(&point.at, n, [METRES; 3]) });
    // A gap is -1.
    let place = |at: &Option<usize>| match at {
        Some(at) => (*at < points.len()).then_some(*at as i64),
        None => Some(-1),
    };
    let order = |order: &Vec<Option<usize>>| order.iter().filter_map(place).collect::<Vec<_>>();
    json!({
        "name": muscle.name,
        "works_for": muscle.works_for,
        "joint": muscle.joint,
        "radius": if muscle.radius.is_finite() { (muscle.radius * 1e5).round() / 1e5 } else { 0.0 },
        "activation": column(muscle.activation.iter().copied(), n, SHARE),
        "tension": column(muscle.tension.iter().copied(), n, TENSION),
        "points": points.iter().map(point).collect::<Value>(),
        "orders": muscle.orders.iter().map(order).collect::<Vec<_>>(),
        "order": column(muscle.order.iter().map(|order| *order as f64), n, 1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Moments, Segment};

    #[test]
    fn a_carrier_that_is_drawn_is_named_and_a_point_that_does_not_move_is_one_number() {
        let [first, second] = [[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.5, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0]];
        let drawn = Segment { places: vec![first, second], ..Segment::default() };
        let carriers = vec![Carrier { places: vec![second, first] }, Carrier { places: vec![first, second] }];
        let point = |carrier| PathPoint { carrier, at: vec![[0.0, 0.1, 0.0]; 2] };
        let line = Muscle {
            points: vec![point(1), point(0), point(7)],
            orders: vec![vec![Some(0), None, Some(1), Some(2)]],
            order: vec![0, 0],
            ..Muscle::default()
        };
        let all = Muscles { carriers, lines: vec![line], lacks: vec![None, Some((Some(2), 1.25))], pressed: vec![] };
        let report = Report { segments: vec![drawn], moments: Moments::Times(vec![0.0, 1.0]), ..Report::default() };
        let value = muscles(&all, &report, 2);
        assert_eq!((&value["carriers"][1]["part"], &value["carriers"][1]["places"]), (&json!(0), &Value::Null));
        assert!(value["carriers"][0]["part"].is_null() && value["carriers"][0]["places"].is_array());
        assert_eq!(value["lines"][0]["points"][0]["at"][1], json!({ "step": 1e-4, "by": [1000] }));
        // The point without a carrier is left out of points and orders.
        assert_eq!(value["lines"][0]["points"].as_array().unwrap().len(), 2);
        assert_eq!(value["lines"][0]["orders"], json!([[0, -1, 1]]));
        assert_eq!(value["lacks"]["joint"], json!({ "step": 1.0, "by": [0, 3] }));
    }
}
