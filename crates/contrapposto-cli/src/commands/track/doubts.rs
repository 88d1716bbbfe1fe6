//! Warnings about a tracked motion: units, sides that are swapped, gaps, frames that are not solved.

use contrapposto::assessment::NEARLY_ALL;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::tracking::{Goals, TrackedFrame, track};
use contrapposto_formats::markers::MarkerUnit;
use nalgebra::Vector3;

use super::matching::{Matched, Observed, length, listed};

/// Sizes of a body and of its markers that differ by this factor have different units (assumed: people differ by a factor of two).
const OTHER_UNIT: f64 = 5.0;
/// A marker that is farther away than this, m, is of another body, unit or name.
const LOST_MARKER: f64 = 0.5;
/// Root mean square of all errors, m, from which on left and right are swapped for a trial.
const DOUBTFUL: f64 = 0.03;
/// cos 60 deg. A root that is turned farther from its default direction against gravity lies (assumed).
const LYING: f64 = 0.5;
/// Number of frames of the trial.
const TRIALS: usize = 3;
/// Share of the error that is left when names that were swapped are swapped back: half of the root mean square.
const SWAPPED: f64 = 0.25;

/// Times, places and answers of all frames.
type Motion<'a> = (&'a [f64], &'a [Observed], &'a [TrackedFrame]);

/// The warnings, in the order of their weight.
pub(crate) fn doubts(model: &Model, matched: &Matched, unit: MarkerUnit, motion: Motion<'_>) -> Vec<String> {
    let mut warnings = vec![];
    let other_unit = size(model, matched, unit, motion.1);
    let sides = if other_unit.is_some() { None } else { swapped_sides(model, matched, (motion.1, motion.2)) };
    if other_unit.is_none() && sides.is_none() {
        warnings.extend(swapped_pairs(model, matched, motion));
        warnings.extend(far(matched, motion));
        warnings.extend(lying(model, motion));
    }
    warnings.extend(gaps(matched, motion));
    let open = motion.2.iter().filter(|frame| !frame.solved.converged).count();
    if open > 0 {
        let worst = motion.2.iter().map(|frame| frame.solved.optimality).fold(0.0, f64::max);
        let frames = motion.2.len();
        warnings.push(format!("{open} of {frames} instants are not solved to the end: optimality up to {worst:.1e}"));
    }
    other_unit.into_iter().chain(sides).chain(warnings).collect()
}

/// Root mean square of all errors, m.
pub(crate) fn root_mean_square(tracked: &[TrackedFrame]) -> f64 {
    let sum: f64 = tracked.iter().map(|frame| frame.total_squared_error).sum();
    let count: usize = tracked.iter().map(|frame| frame.seen).sum();
    if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
}

/// Time (s), marker and size (m) of the largest error.
pub(crate) fn largest(times: &[f64], tracked: &[TrackedFrame]) -> Option<(f64, usize, f64)> {
    let all = times.iter().zip(tracked).filter_map(|(time, frame)| frame.largest.map(|(m, error)| (*time, m, error)));
    all.max_by(|a, b| a.2.total_cmp(&b.2))
}

/// Diagonal of the box about some places, m.
fn extent(places: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = places.fold(none, |(low, high), place| (low.inf(&place), high.sup(&place)));
    if low.x <= high.x { (high - low).norm() } else { 0.0 }
}

/// The warning about markers that are much larger or smaller than the body.
pub(crate) fn size(model: &Model, matched: &Matched, unit: MarkerUnit, frames: &[Observed]) -> Option<String> {
    let fullest = frames.iter().max_by_key(|frame| frame.iter().flatten().count())?;
    let body = Kinematics::new(model);
    let seen = matched.goals.markers.iter().zip(fullest).filter(|(_, place)| place.is_some());
    let of_body = extent(seen.map(|(marker, _)| body.station(model, marker.segment, marker.point)));
    let measured = extent(fullest.iter().flatten().copied());
    let ratio = measured / of_body;
    if !ratio.is_finite() || (1.0 / OTHER_UNIT..=OTHER_UNIT).contains(&ratio) || measured == 0.0 {
        return None;
    }
    let units = [MarkerUnit::Millimetre, MarkerUnit::Centimetre, MarkerUnit::Metre];
    let misfit = |other: &MarkerUnit| libm::log(ratio * other.metres() / unit.metres()).abs();
    let meant = units.into_iter().min_by(|a, b| misfit(a).total_cmp(&misfit(b)))?;
    let try_it = if meant == unit {
        String::new()
    } else {
        format!("; are they in {}? --units {0} reads them so", meant.word())
    };
    let (measured, of_body) = (length(measured), length(of_body));
    let unit = unit.word();
    Some(format!("the markers, read in {unit}, span {measured}, those of the model {of_body}{try_it}"))
}

/// The warning about left and right, where swapping all names lowers the error by much.
pub(crate) fn swapped_sides(
    model: &Model,
    matched: &Matched,
    (frames, tracked): (&[Observed], &[TrackedFrame]),
) -> Option<String> {
    let before = root_mean_square(tracked);
    let pairs = pairs(&matched.names);
    if before < DOUBTFUL || pairs.is_empty() {
        return None;
    }
    let mut order: Vec<usize> = (0..matched.names.len()).collect();
    pairs.iter().for_each(|&(a, b)| order.swap(a, b));
    let mut chosen: Vec<usize> = (0..TRIALS).map(|trial| trial * (frames.len() - 1) / (TRIALS - 1).max(1)).collect();
    chosen.dedup();
    let (mut sums, mut counts) = ([0.0; 2], [0; 2]);
    for frame in chosen {
        let plain = frames[frame].clone();
        let swapped: Observed = order.iter().map(|&index| plain[index]).collect();
        for (kind, observed) in [plain, swapped].into_iter().enumerate() {
            let goals: Goals = matched.goals.clone();
            let answer = track(model, goals, &model.default_posture(), [observed.as_slice()]).ok()?;
            sums[kind] += answer[0].total_squared_error;
            counts[kind] += answer[0].seen;
        }
    }
    if counts[0] == 0 || sums[1] > SWAPPED * sums[0] {
        return None;
    }
    let [now, then] = [0, 1].map(|kind| length((sums[kind] / counts[kind] as f64).sqrt()));
    Some(format!(
        "left and right seem to be swapped in the names of the markers: with the {} pairs swapped the error is {then} in place of {now}",
        pairs.len()
    ))
}

/// Warnings about single pairs whose names are swapped in some frames.
fn swapped_pairs(model: &Model, matched: &Matched, (times, frames, tracked): Motion<'_>) -> Vec<String> {
    let mut body = Kinematics::new(model);
    let pairs = pairs(&matched.names);
    let mut found = vec![(0, f64::NAN); pairs.len()];
    for ((time, observed), frame) in times.iter().zip(frames).zip(tracked) {
        if body.update(model, &frame.posture).is_err() {
            continue;
        }
        let place = |index: usize| {
            let marker = &matched.goals.markers[index];
            body.station(model, marker.segment, marker.point)
        };
        for (&(a, b), found) in pairs.iter().zip(&mut found) {
            let Some((at_a, at_b)) = observed[a].zip(observed[b]) else { continue };
            let squared =
                |x: Vector3<f64>, y: Vector3<f64>| (place(a) - x).norm_squared() + (place(b) - y).norm_squared();
            let (now, then) = (squared(at_a, at_b), squared(at_b, at_a));
            if now > 2.0 * DOUBTFUL * DOUBTFUL && then < SWAPPED * now {
                *found = (found.0 + 1, if found.0 == 0 { *time } else { found.1 });
            }
        }
    }
    let swapped = pairs.iter().zip(&found).filter(|(_, found)| found.0 > 0);
    let said = |(&(a, b), &(count, time)): (&(usize, usize), &(usize, f64))| {
        let (a, b) = (&matched.names[a], &matched.names[b]);
        format!("`{a}` and `{b}` seem to be swapped in {count} instants, from {time} s on")
    };
    swapped.map(said).collect()
}

/// The warning about a marker that is far from its place.
fn far(matched: &Matched, (times, _, tracked): Motion<'_>) -> Option<String> {
    let (time, marker, error) = largest(times, tracked)?;
    let name = &matched.names[marker];
    (error > LOST_MARKER).then(|| {
        format!(
            "`{name}` is {} from its place at {time} s; do unit, names and scale of markers and model fit?",
            length(error)
        )
    })
}

/// The warning about a body that lies in nearly all frames: markers of a laboratory whose z axis points up turn the whole body.
fn lying(model: &Model, (_, _, tracked): Motion<'_>) -> Option<String> {
    let up = (-model.gravity()).try_normalize(1e-9)?;
    let root = model.segments().iter().position(|segment| segment.parent.is_none())?;
    let mut body = Kinematics::new(model);
    let carried = body.placement(model, root).rotation.inverse() * up;
    let is_lying = |frame: &&TrackedFrame| {
        body.update(model, &frame.posture).is_ok() && (body.placement(model, root).rotation * carried).dot(&up) < LYING
    };
    let count = tracked.iter().filter(is_lying).count();
    (count as f64 >= NEARLY_ALL * tracked.len() as f64 && count > 0).then(|| {
        format!(
            "the body lies in {count} of {} instants; does the vertical axis of the markers point along z? Gravity acts along {}: --up z turns \
             them",
            tracked.len(),
            axis_of(&-up)
        )
    })
}

/// `-y`: the axis nearest to a direction.
fn axis_of(direction: &Vector3<f64>) -> String {
    let axis = direction.iamax();
    format!("{}{}", if direction[axis] < 0.0 { "-" } else { "+" }, ["x", "y", "z"][axis])
}

/// Numbers of gaps, and of frames without a marker.
fn gaps(matched: &Matched, (_, frames, tracked): Motion<'_>) -> Vec<String> {
    let gaps = |marker: usize| frames.iter().filter(|frame| frame[marker].is_none()).count();
    let with: Vec<(usize, usize)> =
        (0..matched.names.len()).map(|m| (m, gaps(m))).filter(|(_, gaps)| *gaps > 0).collect();
    let mut warnings = vec![];
    if !with.is_empty() {
        let all: usize = with.iter().map(|(_, gaps)| gaps).sum();
        let names: Vec<&str> = with.iter().map(|(marker, _)| matched.names[*marker].as_str()).collect();
        let count = with.len();
        warnings.push(format!("{all} gaps in {count} of {} markers: {}", matched.names.len(), listed(&names)));
    }
    let empty = tracked.iter().filter(|frame| frame.seen == 0).count();
    if empty > 0 {
        warnings.push(format!("{empty} instants have no marker at all; the posture stays there"));
    }
    warnings
}

/// Pairs of markers of the left and the right side, by their names.
fn pairs(names: &[String]) -> Vec<(usize, usize)> {
    let mut found = vec![];
    for (index, name) in names.iter().enumerate() {
        let other = mirrored(name).into_iter().find_map(|other| names.iter().position(|name| *name == other));
        if let Some(other) = other.filter(|&other| other > index) {
            found.push((index, other));
        }
    }
    found
}

/// Names that the marker of the other side may have.
fn mirrored(name: &str) -> Vec<String> {
    let mut all = vec![];
    for (one, other) in [("right", "left"), ("Right", "Left"), ("RIGHT", "LEFT"), ("R", "L"), ("r", "l")] {
        for (from, to) in [(one, other), (other, one)] {
            all.extend(name.strip_prefix(from).map(|rest| format!("{to}{rest}")));
            all.extend(name.strip_suffix(from).map(|rest| format!("{rest}{to}")));
            if from.len() > 1 && name.contains(from) {
                all.push(name.replacen(from, to, 1));
            }
        }
    }
    all
}
