//! Finds reasons to doubt the numbers of an assessment.

use contrapposto::assessment::{AngleInDoubt, AssessSettings, Assessment, GroupAssessment, PeakTorques};
use contrapposto::model::CoordinateKind;
use contrapposto_formats::tissue::SourcedModel;

use crate::args::AssessArgs;
use crate::moving::fast_motion;
use crate::view::text::sources::StrengthAtText;

/// The arguments that say what carries a body.
pub(crate) const WHAT_CARRIES: &str = "give --support SEG,SEG or --grf FILE.mot; --fixed-root judges the muscles alone";
/// Least residual, as a share of the body's weight, that gives a warning.
pub(crate) const RESIDUAL: f64 = 1e-6;
/// Least load of a group that works against ligaments, as a share of its strength, that gives a warning (assumed).
const LIGAMENT_LOAD: f64 = 0.1;
/// Most groups that the warning names.
const MOST_LIGAMENTS: usize = 5;

/// Reasons to doubt the numbers.
pub(super) fn warnings(
    args: &AssessArgs,
    opened: &SourcedModel,
    (settings, found): (&AssessSettings, &Assessment),
    frames: usize,
) -> Vec<String> {
    let mut warnings = vec![];
    let (force, moment) = (found.residual_force, found.residual_moment);
    let least = RESIDUAL * (opened.model.mass() * opened.model.gravity().norm()).max(1.0);
    if !args.carried.fixed_root && (force.value > least || moment.value > least) {
        let missing = format!(
            "{:.2} N at {} s and {:.2} N m at {} s at most",
            force.value, force.time, moment.value, moment.time
        );
        warnings.push(if !args.carried.support.is_empty() {
            format!(
                "in {} of {frames} instants the supports cannot hold the body; the missing force and moment: {missing}",
                found.unheld
            )
        } else if args.under.grf.is_some() {
            format!("ground reaction and motion do not agree: the root carries {missing}")
        } else {
            format!("nothing holds the body up: the root carries {missing}; {WHAT_CARRIES}")
        });
    }
    if !found.dynamics {
        warnings.extend(fast_motion((found.acceleration, found.fast_share)));
    }
    warnings.extend(against_ligaments(opened, found));
    warnings.extend(angles_in_doubt(opened, settings.angle_error, found));
    warnings
}

/// The warning about groups that work against the ligaments of their own joint at their greatest load.
fn against_ligaments(opened: &SourcedModel, found: &Assessment) -> Option<String> {
    let worked = |group: &&GroupAssessment| {
        let angle = opened.model.coordinates()[group.coordinate].kind == CoordinateKind::Rotation;
        angle && group.peak_load.value >= LIGAMENT_LOAD && group.at_peak.works_against_ligaments()
    };
    let in_words = |group: &&GroupAssessment| {
        let PeakTorques { angle, external, passive, .. } = group.at_peak;
        let floor = StrengthAtText::new(opened, group).is_some_and(|strength| strength.is_floor());
        let [passive, external, active] = [passive, external, group.peak_torque].map(tenths);
        format!(
            "`{}` at {} deg ({} s): passive torque {passive} N m, load {external} N m, muscles {active} N m{}",
            opened.model.coordinates()[group.coordinate].name,
            tenths(angle.to_degrees()),
            group.peak_load.time,
            if floor { " over a strength that is the floor of its curve" } else { "" }
        )
    };
    let groups: Vec<&GroupAssessment> = found.groups.iter().filter(worked).collect();
    (!groups.is_empty()).then(|| {
        format!(
            "muscles work more against the passive tissue of their own joint than against loads; usually the zero of the angle is offset in the \
             motion, the joint is hyperextended, or the model's curves or muscles are stiff at this angle: {}",
            listed(&groups, in_words)
        )
    })
}

/// The warning about groups whose load hangs on the error of a recorded angle.
fn angles_in_doubt(opened: &SourcedModel, error: f64, found: &Assessment) -> Option<String> {
    let doubts = found.groups.iter().filter_map(|group| Some((group, group.in_doubt?)));
    let mut doubts: Vec<_> =
        doubts.filter(|(_, doubt)| doubt.recorded_load >= doubt.judged_load + LIGAMENT_LOAD).collect();
    doubts.sort_by(|(_, a), (_, b)| b.recorded_load.total_cmp(&a.recorded_load));
    let in_words = |(group, doubt): &(&GroupAssessment, AngleInDoubt)| {
        format!(
            "`{}` at {} deg ({} s): {} N m at that angle, {} N m judged",
            opened.model.coordinates()[group.coordinate].name,
            tenths(doubt.angle.to_degrees()),
            doubt.time,
            tenths(doubt.recorded_torque),
            tenths(doubt.judged_torque),
        )
    };
    (!doubts.is_empty()).then(|| {
        format!(
            "muscles that work against the ligaments of their own joint are judged at the angle within {} deg of the given one where that is \
             least, since angles are measured no better (--angle-error 0 takes them as exact): {}",
            tenths(error.to_degrees()),
            listed(&doubts, in_words)
        )
    })
}

/// The first groups in words, and the number of the others.
fn listed<T>(groups: &[T], in_words: impl Fn(&T) -> String) -> String {
    let more = groups.len().saturating_sub(MOST_LIGAMENTS);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    groups.iter().take(MOST_LIGAMENTS).map(in_words).collect::<Vec<_>>().join("; ") + &more
}

/// One decimal, without the sign of -0.
fn tenths(value: f64) -> String {
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_owned() } else { text }
}
