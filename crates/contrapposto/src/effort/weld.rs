//! Which body is left when some of its joints stay as they are?

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::kinematics::Kinematics;
use crate::model::{Drive, Mobility, Model, Motion, Placement};

/// The same body with every joint of which no rate moves welded as it stands in the posture that `kinematics` holds. `moves` has
/// one entry a rate; followers do as their leaders. Segments and coordinates keep their places, welded ones have no rates any
/// more. Also answers where each of the old rates has come to.
pub(crate) fn weld(body: &Model, kinematics: &Kinematics, moves: &[bool]) -> (Model, Vec<Option<usize>>) {
    let mut moves = moves.to_vec();
    let rate = |coordinate: usize| body.coordinates[coordinate].rate;
    for coupling in &body.couplings {
        if let (Some(leader), Some(follower)) = (rate(coupling.independent), rate(coupling.dependent)) {
            moves[follower] = moves[leader];
        }
    }
    let stays: Vec<bool> = (0..body.mobilities.len()).map(|m| body.rates_of(m).any(|rate| moves[rate])).collect();
    for m in (0..stays.len()).filter(|m| stays[*m]) {
        body.rates_of(m).for_each(|rate| moves[rate] = true);
    }

    let mut count = 0;
    let places: Vec<Option<usize>> = moves
        .iter()
        .map(|moves| {
            count += usize::from(*moves);
            moves.then(|| count - 1)
        })
        .collect();
    let mut model = body.clone();
    model.mobilities.clear();
    model.elements.clear();
    model.ancestors.clear();
    model.ancestor_starts = vec![0];
    model.rates = body.rates.iter().zip(&moves).filter(|(_, moves)| **moves).map(|(rate, _)| rate.clone()).collect();
    for coordinate in &mut model.coordinates {
        coordinate.rate = coordinate.rate.and_then(|rate| places[rate]);
    }
    model.balls.clear();
    for (mobility, _) in body.mobilities.iter().zip(&stays).filter(|(_, stays)| **stays) {
        if let (Motion::Ball, Drive::Coordinate(first)) = (mobility.motion, &mobility.drive) {
            model.balls.push(*first);
        }
    }

    // For each old mobility: the new one that it is now or is fixed to, and its moved frame there.
    let mut now: Vec<(Option<usize>, Matrix3<f64>, Vector3<f64>)> = vec![];
    let mut kept: Vec<usize> = vec![];
    for (i, old) in body.mobilities.iter().enumerate() {
        let (parent, rotation, translation) = match old.parent.map(|p| now[p]) {
            Some((parent, rotation, origin)) => (parent, rotation * old.rotation, rotation * old.translation + origin),
            None => (None, old.rotation, old.translation),
        };
        if stays[i] {
            model.add_ancestors(parent);
            let turned = rotation != Matrix3::identity();
            let rate = model.elements.len();
            let elements = old.rate..old.rate + old.motion.rates();
            model.elements.extend(body.elements[elements].iter().map(|rate| rate.and_then(|rate| places[rate])));
            model.mobilities.push(Mobility { parent, rotation, translation, turned, rate, ..old.clone() });
            kept.push(i);
            now.push((Some(model.mobilities.len() - 1), Matrix3::identity(), Vector3::zeros()));
            continue;
        }
        let (rotation, origin) = (kinematics.rotations[i], kinematics.origins[i]);
        let (rotation, origin, mass, moment) = match parent {
            Some(parent) => {
                let (carrier, near) = (&mut model.mobilities[parent], kept[parent]);
                let back = kinematics.rotations[near].transpose();
                let origin = back * (origin - kinematics.origins[near]);
                (back * rotation, origin, &mut carrier.mass, &mut carrier.first_moment)
            }
            None => (rotation, origin, &mut model.fixed.0, &mut model.fixed.1),
        };
        *mass += old.mass;
        *moment += rotation * old.first_moment + old.mass * origin;
        now.push((parent, rotation, origin));
    }
    for segment in &mut model.segments {
        let Some((mobility, rotation, origin)) = segment.mobility.map(|m| now[m]) else { continue };
        segment.mobility = mobility;
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        segment.offset = Placement::from_parts(origin.into(), rotation) * segment.offset;
    }
    model.set_direct();
    (model, places)
}

#[cfg(test)]
#[path = "../../tests/trees/mod.rs"]
mod trees;

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::{trees, weld};
    use crate::kinematics::{CenterOfMass, Kinematics};
    use crate::model::Model;
    use crate::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};

    /// Places, torques and gradients by rate and entry, and the centre of mass.
    fn look(model: &Model, posture: &crate::posture::Posture, loads: &[Load]) -> (Vec<f64>, Vec<f64>, Gradient) {
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).unwrap();
        let mut torque = ExternalTorque::new(model);
        torque.update(model, &kinematics, loads).unwrap();
        let mut gradient = Gradient::new(model);
        torque.gradient(model, &kinematics, &mut gradient);
        for (i, j) in (0..gradient.size().pow(2)).map(|k| (k / gradient.size(), k % gradient.size())) {
            let off = (gradient.get(i, j) - gradient.get(j, i)).abs();
            assert!(!gradient.is_symmetric() || off <= 1e-9 * (1.0 + gradient.get(i, j).abs()), "{off}");
        }
        let mut center = CenterOfMass::new(model);
        center.update(model, &kinematics);
        let mut places: Vec<f64> = center.position().iter().flatten().copied().collect();
        for segment in 0..model.segments().len() {
            let corner = [0.3, -0.2, 0.1].into();
            places.extend(kinematics.station(model, segment, corner).iter());
            places.extend(kinematics.direction(model, segment, corner).iter());
        }
        (places, torque.torques().to_vec(), gradient)
    }

    /// However the welded body moves, it is where the whole one is that moves alike, and what pulls at its joints is the same.
    #[test]
    fn a_welded_body_is_the_body_that_does_not_move_there() {
        let mut random = trees::random("weld");
        let (mut worst, mut gone) = (0f64, 0);
        for _ in 0..200 {
            let segments = random.random_range(1..12);
            let model = trees::tree(&mut random, segments, true);
            let (n, m) = (model.rates().len(), model.segments().len());
            let posture = trees::posture(&mut random, &model);
            let moves: Vec<bool> = (0..n).map(|_| random.random_range(0..2) == 0).collect();
            let mut kinematics = Kinematics::new(&model);
            kinematics.update(&model, &posture).unwrap();
            let (welded, places) = weld(&model, &kinematics, &moves);
            let follows = |rate: usize| model.rates()[rate].coordinate.is_some_and(|c| model.is_dependent(c));
            assert!((0..n).all(|rate| !moves[rate] || places[rate].is_some() || follows(rate)));
            gone += n - welded.rates().len();
            let loads: Vec<Load> = (0..3)
                .map(|k| {
                    let (force, point) = (trees::vector(&mut random, 50.0), trees::vector(&mut random, 0.3));
                    let kind = match k {
                        0 => LoadKind::Force(force, FixedIn::World),
                        1 => LoadKind::Force(force, FixedIn::Segment),
                        _ => LoadKind::Couple(force, FixedIn::World),
                    };
                    Load { segment: random.random_range(0..m), point, kind }
                })
                .collect();
            let step: Vec<f64> =
                moves.iter().map(|moves| if *moves { random.random_range(-1.0..1.0) } else { 0.0 }).collect();
            let mut short = vec![0.0; welded.rates().len()];
            places.iter().zip(&step).for_each(|(place, by)| place.iter().for_each(|place| short[*place] = *by));
            let (mut whole, mut part) = (posture.clone(), posture.clone());
            whole.displace(&model, &step);
            part.displace(&welded, &short);
            let (whole, part) = (look(&model, &whole, &loads), look(&welded, &part, &loads));
            let mut compare = |a: f64, b: f64| {
                assert!(a.is_finite() && b.is_finite(), "{a} {b}");
                worst = worst.max((a - b).abs() / (1.0 + a.abs()));
            };
            assert_eq!(whole.0.len(), part.0.len());
            whole.0.iter().zip(&part.0).for_each(|(a, b)| compare(*a, *b));
            for (i, place) in places.iter().enumerate() {
                let Some(row) = *place else { continue };
                compare(whole.1[i], part.1[row]);
                for (j, place) in places.iter().enumerate() {
                    place.iter().for_each(|column| compare(whole.2.get(i, j), part.2.get(row, *column)));
                }
            }
        }
        println!("off by {worst:.1e} at most, {gone} rates welded");
        assert!(worst < 1e-10 && gone > 500, "{worst} {gone}");
    }
}
