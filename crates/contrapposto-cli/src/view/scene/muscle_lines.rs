//! Turns the muscles of a body into lines of a page: points fixed in segments, and the order in which they follow one another in every frame.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::muscle::Path;
use contrapposto_formats::ReactionText;
use contrapposto_report::{Carrier, Muscle, Muscles, PathPoint, PressedJoint};
use nalgebra::Isometry3;

use crate::view::axes::Turn;
use crate::view::muscle_work::{MusclesAtWork, radius};
use crate::view::words::plain;

/// The muscles of a body in postures, whose `kinematics` are those of the moments of `muscles`. `shown`: the coordinates of the page.
pub(super) fn muscle_lines(
    (model, kinematics): (&Model, &[Kinematics]),
    muscles: &MusclesAtWork<'_>,
    shown: &[usize],
    turn: &Turn,
) -> Muscles {
    let musculature = muscles.musculature();
    let mut carriers: Vec<Option<usize>> = vec![];
    let mut drawn = vec![];
    for (m, muscle) in musculature.muscles.iter().enumerate() {
        let spec = muscle.spec();
        let path = &musculature.paths.paths[spec.path];
        let line = line(muscles, m, path, &mut carriers);
        let over = |value: &dyn Fn(usize) -> f64| (0..muscles.moments.len()).map(value).collect::<Vec<f64>>();
        drawn.push(Muscle {
            name: spec.name.clone(),
            works_for: muscles.works_for(m),
            joint: muscles.joint(m).and_then(|i| shown.iter().position(|&of| of == i)),
            radius: radius(spec.max_isometric_force),
            activation: over(&|frame| muscles.moments[frame].activations[m]),
            tension: over(&|frame| muscles.moments[frame].tensions[m]),
            ..line
        });
    }
    let places = |carrier: &Option<usize>| {
        let place = |kinematics: &Kinematics| match carrier {
            Some(segment) => turn.place(&kinematics.placement(model, *segment)),
            None => turn.place(&Isometry3::identity()),
        };
        Carrier { places: kinematics.iter().map(place).collect() }
    };
    let lack = |missing: &Option<contrapposto::joint_torques::MissingTorque>| {
        missing.map(|missing| (shown.iter().position(|&i| i == missing.coordinate), missing.torque))
    };
    Muscles {
        carriers: carriers.iter().map(places).collect(),
        lines: drawn,
        lacks: muscles.moments.iter().map(|moment| lack(&moment.missing)).collect(),
        pressed: pressed(muscles),
    }
}

/// The joints that muscles cross, where the loads of all moments are known.
fn pressed(muscles: &MusclesAtWork<'_>) -> Vec<PressedJoint> {
    let Some(((first, rest), moments)) = muscles.moments.split_first().map(|parts| (parts, &muscles.moments)) else {
        return vec![];
    };
    if rest.iter().any(|moment| moment.reactions.len() != first.reactions.len()) {
        return vec![];
    }
    let of_joint = |(joint, (name, reaction)): (usize, &(String, ReactionText))| {
        let over = |value: fn(&ReactionText) -> Option<f64>| {
            moments.iter().map(|moment| value(&moment.reactions[joint].1).unwrap_or(0.0)).collect()
        };
        Some(PressedJoint {
            name: plain(name),
            along: plain(reaction.along.as_deref()?),
            force: over(|reaction| reaction.compression_n),
            weights: over(|reaction| reaction.body_weights),
        })
    };
    first.reactions.iter().enumerate().filter_map(of_joint).collect()
}

/// The points of a muscle, and their orders.
fn line(muscles: &MusclesAtWork<'_>, m: usize, path: &Path, carriers: &mut Vec<Option<usize>>) -> Muscle {
    let mut points: Vec<PathPoint> = vec![];
    let mut numbers: Vec<Option<usize>> = vec![None; path.drawn_points()];
    let mut line = Muscle::default();
    for (frame, moment) in muscles.moments.iter().enumerate() {
        let mut order = vec![];
        for point in &moment.lines[m] {
            let place = point.place.into();
            let at = *numbers[point.number].get_or_insert_with(|| {
                let carrier = carriers.iter().position(|carrier| *carrier == point.segment).unwrap_or_else(|| {
                    carriers.push(point.segment);
                    carriers.len() - 1
                });
                points.push(PathPoint { carrier, at: vec![place; frame] });
                points.len() - 1
            });
            points[at].at.push(place);
            if point.begins {
                order.push(None);
            }
            order.push(Some(at));
        }
        // A point that this posture has not stays where it was.
        for point in points.iter_mut().filter(|point| point.at.len() == frame) {
            point.at.extend(point.at.last().copied());
        }
        let known = line.orders.iter().position(|of| *of == order);
        line.order.push(known.unwrap_or(line.orders.len()));
        if known.is_none() {
            line.orders.push(order);
        }
    }
    Muscle { points, ..line }
}
