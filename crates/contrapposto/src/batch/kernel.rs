//! Computes frames, centre of mass and external torque of one block of postures.
//!
//! The sums are those of [`crate::statics::ExternalTorque`]: outward, the frame of every node; inward, mass times centre `M`, force `F`
//! and moment `N` about the ground origin of all that it carries. A hinge of axis `r` through `p` has the torque
//! `r . ((M - m p) x g + N - p x F)`, a slide `r . (m g + F)`. Hinges through one point share the bracket.
//!
//! [`statics`] is compiled for several widths of registers, of which the widest that the processor has is chosen when the program
//! runs. All give the same bits, because none of them contracts a multiplication and an addition.

use multiversion::multiversion;

use super::lanes::{Lanes, Rotations, Vectors};
use super::loads::{Effect, Pulls};
use super::plan::{Attached, Node, Plan, Source, Step, Way};
use super::sin_cos::{sin_cos, sin_cos_of_any};
use crate::statics::FixedIn;

/// Rows of a placement: the columns of its rotation, and its origin.
pub(super) const PLACEMENT_ROWS: usize = 12;

/// Frames, axes and carried sums of one block.
#[derive(Clone, Debug)]
pub(super) struct Frames {
    pub(super) rotations: Vec<Rotations>,
    pub(super) origins: Vec<Vectors>,
    /// By elementary rate.
    pub(super) axes: Vec<Vectors>,
    /// By node: mass times centre at and beyond it, once the inward pass is done.
    pub(super) moments: Vec<Vectors>,
    /// By node: force, and moment about the ground origin, of the loads at and beyond it.
    pub(super) forces: Vec<[Vectors; 2]>,
    /// By function that drives a motion: its value.
    pub(super) driven: Vec<Lanes>,
    /// Some value of a coordinate or function is larger than [`super::sin_cos::LARGEST_ANGLE`].
    pub(super) any_angle: bool,
}

impl Frames {
    pub(super) fn new(plan: &Plan, elements: usize) -> Self {
        let nodes = plan.nodes.len();
        Self {
            rotations: vec![Rotations::IDENTITY; nodes],
            origins: vec![Vectors::ZERO; nodes],
            axes: vec![Vectors::ZERO; elements],
            moments: vec![Vectors::ZERO; nodes],
            forces: vec![[Vectors::ZERO; 2]; nodes],
            driven: vec![Lanes::ZERO; plan.functions],
            any_angle: false,
        }
    }
}

/// Memory for the results of a block.
pub(super) struct Results<'a> {
    /// By elementary rate.
    pub(super) torques: &'a mut [Lanes],
    pub(super) center_of_mass: &'a mut [Lanes],
    pub(super) placements: &'a mut [Lanes],
    /// Three a three-axis joint.
    pub(super) about_axes: &'a mut [Lanes],
}

/// Computes one block from the values of its coordinates; `placed` are the frames whose placements are wanted.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub(super) fn statics(
    plan: &Plan,
    pulls: &Pulls,
    placed: &[Attached],
    frames: &mut Frames,
    values: &[Lanes],
    results: Results<'_>,
) {
    block(plan, pulls, placed, frames, values, results);
}

/// As [`statics`], in the registers that every processor has.
#[inline(always)]
pub(super) fn block(
    plan: &Plan,
    pulls: &Pulls,
    placed: &[Attached],
    frames: &mut Frames,
    values: &[Lanes],
    results: Results<'_>,
) {
    if frames.any_angle {
        outward_with_any_angle(plan, frames, values);
    } else {
        outward::<false>(plan, frames, values);
    }
    for (frame, rows) in placed.iter().zip(results.placements.chunks_exact_mut(PLACEMENT_ROWS)) {
        write_placement(frame, frames, rows);
    }
    if !pulls.all.is_empty() {
        gather_loads(pulls, frames);
    }
    let whole = inward(plan, pulls, frames, results.torques, results.about_axes);
    for (row, moment) in results.center_of_mass.iter_mut().zip(whole.0) {
        *row = moment.map(|x| x / plan.mass);
    }
}

#[cold]
#[inline(never)]
fn outward_with_any_angle(plan: &Plan, frames: &mut Frames, values: &[Lanes]) {
    outward::<true>(plan, frames, values);
}

/// Frames of all nodes, axes of all motions, and mass times centre of every node alone. Each frame is turned where it is stored: kept in
/// variables, its numbers would be regrouped across the lanes.
#[inline(always)]
fn outward<const ANY_ANGLE: bool>(plan: &Plan, frames: &mut Frames, values: &[Lanes]) {
    for (i, node) in plan.nodes.iter().enumerate() {
        let (before, now) = frames.rotations.split_at_mut(i);
        let (origins, origin) = frames.origins.split_at_mut(i);
        let (rotation, origin) = (&mut now[0], &mut origin[0]);
        (*rotation, *origin) = match node.parent {
            None => (Rotations::IDENTITY, Vectors::ZERO),
            Some(parent) => (before[parent], origins[parent]),
        };
        if let Some(translation) = node.translation {
            *origin = rotation.turn_all(translation) + *origin;
        }
        for step in &plan.steps[node.motions.clone()] {
            if let Some(turned) = step.turned {
                *rotation = rotation.times_all(turned);
            }
            let value = match step.source {
                Source::Coordinate(c) => values[c],
                Source::Function(f) => frames.driven[f],
                Source::Fixed(value) => Lanes::all(value),
            };
            let turn = |angle: Lanes| if ANY_ANGLE { sin_cos_of_any(angle) } else { sin_cos(angle) };
            let axis = &mut frames.axes[step.element];
            match step.way {
                Way::Slide(along) => {
                    *axis = rotation.turn_all(along);
                    *origin = *origin + *axis * value;
                }
                Way::Ball => turn_ball(rotation, step, values, &mut frames.axes),
                Way::Axis(about) => {
                    *axis = rotation.turn_all(about);
                    *rotation = rotation.times(about_axis(about, turn(value)));
                }
                Way::Principal(0, sign) => *axis = turn_principal::<0, 1, 2>(rotation, sign, turn(value * sign)),
                Way::Principal(1, sign) => *axis = turn_principal::<1, 2, 0>(rotation, sign, turn(value * sign)),
                Way::Principal(_, sign) => *axis = turn_principal::<2, 0, 1>(rotation, sign, turn(value * sign)),
            }
        }
        frames.moments[i] = own_moment(node, rotation, *origin);
    }
}

/// Mass times centre of what is fixed to a node.
#[inline(always)]
fn own_moment(node: &Node, rotation: &Rotations, origin: Vectors) -> Vectors {
    if node.mass == 0.0 { Vectors::ZERO } else { rotation.turn_all(node.first_moment) + origin * node.mass }
}

/// Turns a frame about its own axis `K`, and answers the axis in ground.
#[inline(always)]
fn turn_principal<const K: usize, const FROM: usize, const TO: usize>(
    rotation: &mut Rotations,
    sign: f64,
    (sin, cos): (Lanes, Lanes),
) -> Vectors {
    let (from, to) = (rotation.0[FROM], rotation.0[TO]);
    rotation.0[FROM] = from * cos + to * sin;
    rotation.0[TO] = to * cos - from * sin;
    rotation.0[K] * sign
}

/// The rotation about an axis, after Rodrigues.
#[inline(always)]
fn about_axis([x, y, z]: [f64; 3], (sin, cos): (Lanes, Lanes)) -> Rotations {
    let rest = Lanes::ONE - cos;
    let diagonal = |square: f64| rest * square + cos;
    let sum = |product: f64, along: f64| rest * product + sin * along;
    Rotations([
        Vectors([diagonal(x * x), sum(x * y, z), sum(x * z, -y)]),
        Vectors([sum(x * y, -z), diagonal(y * y), sum(y * z, x)]),
        Vectors([sum(x * z, y), sum(y * z, -x), diagonal(z * z)]),
    ])
}

/// Turns a frame by the quaternion of a ball, of any length but zero.
#[inline(always)]
fn turn_ball(rotation: &mut Rotations, step: &Step, values: &[Lanes], axes: &mut [Vectors]) {
    let Source::Coordinate(first) = step.source else { return };
    let [w, x, y, z] = [values[first], values[first + 1], values[first + 2], values[first + 3]];
    let length = (w * w + x * x + y * y + z * z).map(f64::sqrt);
    let inverse = length.map(|length| 1.0 / length);
    let [w, x, y, z] = [w * inverse, x * inverse, y * inverse, z * inverse];
    let [x2, y2, z2] = [x + x, y + y, z + z];
    let (xx, yy, zz, xy, xz, yz) = (x * x2, y * y2, z * z2, x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    *rotation = rotation.times(Rotations([
        Vectors([Lanes::ONE - (yy + zz), xy + wz, xz - wy]),
        Vectors([xy - wz, Lanes::ONE - (xx + zz), yz + wx]),
        Vectors([xz + wy, yz - wx, Lanes::ONE - (xx + yy)]),
    ]));
    axes[step.element..step.element + 3].copy_from_slice(&rotation.0);
}

/// The placement of a frame, row by row.
#[inline(always)]
fn write_placement(frame: &Attached, frames: &Frames, rows: &mut [Lanes]) {
    let (rotation, origin) = match frame.node {
        None => (Rotations::IDENTITY, Vectors::all(frame.origin)),
        Some(node) => {
            let rotation = frames.rotations[node];
            (rotation, rotation.turn_all(frame.origin) + frames.origins[node])
        }
    };
    let rotation = frame.turned.map_or(rotation, |turned| rotation.times_all(turned));
    let columns = rotation.0.into_iter().chain([origin]);
    for (row, column) in rows.chunks_exact_mut(3).zip(columns) {
        row.copy_from_slice(&column.0);
    }
}

/// Forces and moments of the loads on every node alone.
#[inline(always)]
fn gather_loads(pulls: &Pulls, frames: &mut Frames) {
    frames.forces.fill([Vectors::ZERO; 2]);
    for pull in &pulls.all {
        let rotation = &frames.rotations[pull.node];
        let point = rotation.turn_all(pull.point) + frames.origins[pull.node];
        let in_ground = |v: [f64; 3], fixed| match fixed {
            FixedIn::World => Vectors::all(v),
            FixedIn::Segment => rotation.turn_all(v),
        };
        let (force, moment) = match pull.effect {
            Effect::Force(force, fixed) => {
                let force = in_ground(force, fixed);
                (force, point.cross(force))
            }
            Effect::Couple(couple, fixed) => (Vectors::ZERO, in_ground(couple, fixed)),
        };
        let [force_sum, moment_sum] = frames.forces[pull.node];
        frames.forces[pull.node] = [force_sum + force, moment_sum + moment];
    }
}

/// Torques of all motions, and of three-axis joints about their axes; answers mass times centre of the whole body.
#[inline(always)]
fn inward(plan: &Plan, pulls: &Pulls, frames: &mut Frames, torques: &mut [Lanes], about_axes: &mut [Lanes]) -> Vectors {
    let mut whole = Vectors::all(plan.fixed_moment);
    for (i, node) in plan.nodes.iter().enumerate().rev() {
        let (first_moment, point) = (frames.moments[i], frames.origins[i]);
        match node.parent {
            Some(parent) => frames.moments[parent] = frames.moments[parent] + first_moment,
            None => whole = whole + first_moment,
        }
        let mut moment = (first_moment - point * node.carried).cross_all(plan.gravity);
        let mut force = Vectors::ZERO;
        if pulls.beyond[i] {
            let [load, load_moment] = frames.forces[i];
            if let Some(parent) = node.parent {
                let [of_parent, moment_of_parent] = frames.forces[parent];
                frames.forces[parent] = [of_parent + load, moment_of_parent + load_moment];
            }
            moment = moment + (load_moment - point.cross(load));
            force = load;
        }
        for step in &plan.steps[node.motions.clone()] {
            let element = step.element;
            let axis = frames.axes[element];
            torques[element] = match step.way {
                Way::Slide(_) => axis.dot_all(plan.gravity) * node.carried + axis.dot(force),
                Way::Principal(..) | Way::Axis(_) | Way::Ball => axis.dot(moment),
            };
            if let Way::Ball = step.way {
                torques[element + 1] = frames.axes[element + 1].dot(moment);
                torques[element + 2] = frames.axes[element + 2].dot(moment);
            }
        }
        if let Some(joint) = node.joint.filter(|_| !about_axes.is_empty()) {
            for (k, axis) in plan.joints[joint].axes.into_iter().enumerate() {
                about_axes[3 * joint + k] = frames.rotations[i].turn_all(axis).dot(moment);
            }
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Adult, adult};

    /// As [`statics`] on a processor whose registers have 256 bits.
    #[multiversion(targets("x86_64+avx2"))]
    fn narrower(
        plan: &Plan,
        pulls: &Pulls,
        placed: &[Attached],
        frames: &mut Frames,
        values: &[Lanes],
        results: Results<'_>,
    ) {
        block(plan, pulls, placed, frames, values, results);
    }

    #[test]
    fn registers_of_any_width_give_the_same_bits() {
        let model = adult(&Adult::default()).unwrap();
        let plan = Plan::new(&model, &[]);
        let mut pulls = Pulls::default();
        pulls.update(&model, &plan, &[]);
        let placed = [plan.attached(&model, 0)];
        let (elements, coordinates) = (model.elements.len(), model.coordinates.len());
        let computed = |values: &[Lanes], width: usize| {
            let mut frames = Frames::new(&plan, elements);
            let mut rows = [elements, 3, PLACEMENT_ROWS, 3 * plan.joints.len()].map(|count| vec![Lanes::ZERO; count]);
            let [torques, center_of_mass, placements, about_axes] = &mut rows;
            let results = Results { torques, center_of_mass, placements, about_axes };
            match width {
                0 => block(&plan, &pulls, &placed, &mut frames, values, results),
                1 => narrower(&plan, &pulls, &placed, &mut frames, values, results),
                _ => statics(&plan, &pulls, &placed, &mut frames, values, results),
            }
            rows
        };
        for i in 0..1000 {
            let values: Vec<Lanes> = (0..coordinates)
                .map(|c| Lanes(std::array::from_fn(|lane| ((i * 8 + lane) * (c + 3)) as f64 * 0.618_034 % 6.0 - 3.0)))
                .collect();
            let rows = computed(&values, 0);
            assert_eq!(rows, computed(&values, 1), "block {i}");
            assert_eq!(rows, computed(&values, 2), "block {i}");
            assert!(rows[0].iter().all(|torque| torque.0.iter().all(|x| x.is_finite())));
            assert!(rows[0].iter().any(|torque| torque.0[0] != torque.0[1]));
        }
    }
}
