//! Builds the reduced model: the same body with some joints fixed as they stand in one posture.
//!
//! Mass and first moment of what is fixed are added to the mobility that carries it, so that torques and gradients of the joints
//! that remain are those of the whole body (Featherstone 2008, "Rigid Body Dynamics Algorithms", ch. 7).

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{Drive, Mobility, Model, Motion, Placement};

/// Frame of an old mobility: the new mobility that it is or is fixed to (`None`: ground), and its moved frame there.
type FixedTo = (Option<usize>, Matrix3<f64>, Vector3<f64>);

/// The body of which only the joints with a rate in `moves` (one entry a rate) remain, and the index in it of each old rate.
/// Dependent coordinates move when their independent ones do. Segments and coordinates keep their indices; coordinates of fixed
/// joints have no rate. `rotations` and `origins` place every mobility of `body` in ground.
pub(crate) fn reduced(
    body: &Model,
    rotations: &[Matrix3<f64>],
    origins: &[Vector3<f64>],
    moves: &[bool],
) -> (Model, Vec<Option<usize>>) {
    let (moves, remains) = what_remains(body, moves);
    let mut count = 0;
    let places: Vec<Option<usize>> = moves
        .iter()
        .map(|moves| {
            count += usize::from(*moves);
            moves.then(|| count - 1)
        })
        .collect();
    let mut model = body.clone();
    model.rates = body.rates.iter().zip(&moves).filter(|(_, moves)| **moves).map(|(rate, _)| rate.clone()).collect();
    for coordinate in &mut model.coordinates {
        coordinate.rate = coordinate.rate.and_then(|rate| places[rate]);
    }
    model.balls.clear();
    for (mobility, _) in body.mobilities.iter().zip(&remains).filter(|(_, remains)| **remains) {
        if let (Motion::Ball, Drive::Coordinate(first)) = (mobility.motion, &mobility.drive) {
            model.balls.push(*first);
        }
    }
    let now = fix_mobilities(body, &mut model, (rotations, origins), &remains, &places);
    for segment in &mut model.segments {
        let Some((mobility, rotation, origin)) = segment.mobility.map(|m| now[m]) else { continue };
        segment.mobility = mobility;
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        segment.offset = Placement::from_parts(origin.into(), rotation) * segment.offset;
    }
    model.set_direct();
    model.three_axis.retain(|joint| joint.coordinates.iter().all(|c| model.coordinates[*c].rate.is_some()));
    model.build_by_axes();
    (model, places)
}

/// Whether each rate and each mobility remains: a mobility remains with all of its rates if one of them moves, a three-axis joint
/// with all of its hinges.
fn what_remains(body: &Model, moves: &[bool]) -> (Vec<bool>, Vec<bool>) {
    let mut moves = moves.to_vec();
    let rate = |coordinate: usize| body.coordinates[coordinate].rate;
    for coupling in &body.couplings {
        if let (Some(independent), Some(dependent)) = (rate(coupling.independent), rate(coupling.dependent)) {
            moves[dependent] = moves[independent];
        }
    }
    for joint in &body.three_axis {
        let rates = joint.coordinates.map(rate);
        let any = rates.iter().flatten().any(|rate| moves[*rate]);
        rates.iter().flatten().for_each(|rate| moves[*rate] = any);
    }
    let remains: Vec<bool> = (0..body.mobilities.len()).map(|m| body.rates_of(m).any(|rate| moves[rate])).collect();
    for m in (0..remains.len()).filter(|m| remains[*m]) {
        body.rates_of(m).for_each(|rate| moves[rate] = true);
    }
    (moves, remains)
}

/// Fills the mobilities of `model` with those of `body` that remain; adds mass and first moment of the others to their carriers.
fn fix_mobilities(
    body: &Model,
    model: &mut Model,
    (rotations, origins): (&[Matrix3<f64>], &[Vector3<f64>]),
    remains: &[bool],
    places: &[Option<usize>],
) -> Vec<FixedTo> {
    model.mobilities.clear();
    model.elements.clear();
    model.ancestors.clear();
    model.ancestor_starts = vec![0];
    let mut now: Vec<FixedTo> = vec![];
    let mut kept: Vec<usize> = vec![];
    for (i, old) in body.mobilities.iter().enumerate() {
        let (parent, rotation, translation) = match old.parent.map(|p| now[p]) {
            Some((parent, rotation, origin)) => (parent, rotation * old.rotation, rotation * old.translation + origin),
            None => (None, old.rotation, old.translation),
        };
        if remains[i] {
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
        let (rotation, origin) = (rotations[i], origins[i]);
        let (rotation, origin, mass, moment) = match parent {
            Some(parent) => {
                let (carrier, near) = (&mut model.mobilities[parent], kept[parent]);
                let back = rotations[near].transpose();
                let origin = back * (origin - origins[near]);
                (back * rotation, origin, &mut carrier.mass, &mut carrier.first_moment)
            }
            None => (rotation, origin, &mut model.fixed.0, &mut model.fixed.1),
        };
        *mass += old.mass;
        *moment += rotation * old.first_moment + old.mass * origin;
        now.push((parent, rotation, origin));
    }
    now
}
