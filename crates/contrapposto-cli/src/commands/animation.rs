//! `contrapposto track` of an animation: the built-in adult moved as a jointed rig moves.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Part, Sex};
use contrapposto::tracking::TrackedFrame;
use contrapposto_formats::MOST_BYTES;
use contrapposto_formats::motion::MOST_TABLE_BYTES;
use contrapposto_formats::rigs::{
    Assignment, Fitted, Rig, RigUnit, Sizing, Targets, read_bvh, read_gltf, read_rig_names, settle_branches,
};

use super::track::{ERRORS, MOST_MOTION_VALUES, MOTION, SAME_TIME, asked, errors, left_out, motion, tracked_so_far};
use crate::args::TrackArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::model_file::built_in;
use crate::output::{ResultSet, print, print_note};

/// The adult that was moved.
const ADULT: &str = "adult.toml";
/// Root mean square of the angle between a segment and its joint, rad (15 deg), from which on a warning says so (assumed: a hinge of the adult cannot follow
/// it).
const DOUBTFUL_TURN: f64 = 15.0 * std::f64::consts::PI / 180.0;

pub(crate) fn animation(args: &TrackArgs) -> Result<(), Fail> {
    let out = ResultSet::open(&args.out, &[MOTION, ERRORS, ADULT])?;
    let sizing = sizing(args)?;
    let file = args.markers.display().to_string();
    let rig = rig(&args.markers, &file)?;
    rig.warnings.iter().for_each(|warning| print_note("warning", warning));
    let given = match &args.rig {
        Some(path) => read_rig_names(&path.display().to_string(), &read(path, MOST_BYTES)?, &rig)?,
        None => BTreeMap::new(),
    };
    let refused = |error: &dyn std::fmt::Display| Fail::Refused(format!("{file}: {error}"));
    let assignment = Assignment::find(&rig, &given).map_err(|error| refused(&error))?;
    let metres = args.units.map(|unit| unit.unit().metres());
    let fitted = Fitted::new(&rig, &assignment, &sizing, metres).map_err(|error| refused(&error))?;
    let frames = frames(args, &file, &rig, fitted.model.coordinates().len())?;
    let targets = Targets::new(&rig, &assignment, &fitted, &frames);
    say((&rig, &frames), &assignment, (&fitted, &sizing), &targets);
    let model = &fitted.model;
    let places: Vec<_> = frames.iter().map(|&frame| targets.places(frame)).collect();
    let mut tracked = tracked_so_far(model, targets.goals.clone(), &model.default_posture(), &places)
        .map_err(|error| refused(&error))?;
    settle_branches(model, tracked.iter_mut().map(|frame| &mut frame.posture));
    let all: Vec<f64> = frames.iter().map(|&frame| time(&rig, frame)).collect();
    let left = left_out(&all, tracked.len())?;
    let (frames, times) = (&frames[..tracked.len()], &all[..tracked.len()]);
    let answer = answer(&rig, &targets, (frames, times, &tracked), &fitted)?;
    let motion = motion(model, times, &tracked).map_err(|error| Fail::job(MOTION, error))?;
    let errors = errors(times, &tracked).map_err(|error| Fail::job(ERRORS, error))?;
    let adult = scenario(&fitted.size);
    out.write(&[(MOTION, motion), (ERRORS, errors), (ADULT, adult)])?;
    let (motion, adult) = (out.path(MOTION).display().to_string(), out.path(ADULT).display().to_string());
    print(&format!("{answer}{motion}, {ERRORS} and {ADULT} beside it\n"))?;
    let (motion, adult) = (quoted(&motion), quoted(&adult));
    print(&format!("next: contrapposto assess {adult} {motion} --fixed-root --out report\n"))?;
    left.map_or(Ok(()), Err)
}

/// The rig of a file, by the ending of its name.
fn rig(path: &Path, name: &str) -> Result<Rig, Fail> {
    let bytes = read(path, MOST_TABLE_BYTES as u64)?;
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("bvh")) {
        return Ok(read_bvh(name, &bytes)?);
    }
    read_gltf(name, &bytes).map_err(|error| Fail::Refused(error.to_string()))
}

/// A path as a command line has it: in quotes where it holds blanks.
fn quoted(path: &str) -> String {
    if path.contains(char::is_whitespace) { format!("\"{path}\"") } else { path.to_owned() }
}

/// The adult that is asked for: MODEL `adult` gets the bones of the rig.
fn sizing(args: &TrackArgs) -> Result<Sizing, Fail> {
    let model = &args.model;
    if model.overlay.is_some() || model.root.is_some() || model.person.is_some() || model.passive.is_some() {
        let why = "an animation moves the built-in adult as it is; --overlay, --root, --person and --passive go with `assess`";
        return Err(Fail::Refused(why.to_owned()));
    }
    if args.tasks.is_some() {
        return Err(Fail::Refused("--tasks has the weights of markers; an animation has joints".to_owned()));
    }
    let sizing = match built_in(&model.model)? {
        Some(_) if model.model.as_os_str() == "adult" => Ok(Sizing::ToRig(Sex::Male)),
        Some(size) if size.part != Part::Whole => {
            let why = "an animation moves a whole body; the model has an arm only";
            Err(Fail::Refused(format!("{}: {why}", model.model.display())))
        }
        Some(size) => Ok(Sizing::Given(size)),
        None => {
            let shown = model.model.display();
            let why = "an animation moves the built-in adult: MODEL `adult`, `adult:female,1.65m,60kg` or its .toml";
            Err(Fail::Refused(format!("{shown}: {why}")))
        }
    }?;
    if args.units.is_some() && sizing != Sizing::ToRig(Sex::Male) {
        let why = "the adult is given, and the motion is scaled by the legs; --units goes with MODEL `adult`, which gets the bones of the rig";
        return Err(Fail::Refused(format!("--units: {why}")));
    }
    Ok(sizing)
}

/// Time of a frame, s, to a microsecond.
fn time(rig: &Rig, frame: usize) -> f64 {
    (rig.frame_time * frame as f64 * 1e6).round() / 1e6
}

/// The frames that are asked for.
fn frames(args: &TrackArgs, file: &str, rig: &Rig, coordinates: usize) -> Result<Vec<usize>, Fail> {
    let from = args.from.map_or(f64::NEG_INFINITY, |from| from - SAME_TIME);
    let to = args.to.map_or(f64::INFINITY, |to| to + SAME_TIME);
    let frames: Vec<usize> = (0..rig.frames.len()).filter(|&frame| (from..=to).contains(&time(rig, frame))).collect();
    if frames.is_empty() {
        let last = time(rig, rig.frames.len() - 1);
        let asked = asked(args.from, args.to);
        let why = format!("no frame lies in the time that is asked for ({asked}); it goes from 0 s to {last} s");
        return Err(Fail::Refused(format!("{file}: {why}")));
    }
    if frames.len().saturating_mul(coordinates) > MOST_MOTION_VALUES {
        let count = frames.len();
        return Err(Fail::Refused(format!(
            "{file}: {count} frames of {coordinates} coordinates are more than {MOST_MOTION_VALUES} values; take a part of them with --from and --to"
        )));
    }
    Ok(frames)
}

/// The unit of the rig's lengths, and what else could say it.
fn unit(fitted: &Fitted, sizing: &Sizing) -> String {
    let size = &fitted.size;
    let adult = format!("{} m and {} kg", size.stature, size.mass);
    let unit = match fitted.unit {
        RigUnit::Found(name) => format!("lengths are read in {name}: with these legs an adult is {adult}"),
        RigUnit::Given => format!("with these legs an adult is {adult}"),
        RigUnit::Legs => format!(
            "no unit is known, or the adult is given: lengths are scaled so that the legs are those of an adult of {adult}"
        ),
    };
    let otherwise = match sizing {
        Sizing::ToRig(_) => "--units or MODEL `adult:female,1.65m,60kg` says otherwise",
        Sizing::Given(_) => "MODEL `adult` takes the size of the rig",
    };
    format!("{unit}; {otherwise}")
}

/// Notes and warnings about names, axes, unit and size.
fn say(
    (rig, frames): (&Rig, &[usize]),
    assignment: &Assignment,
    (fitted, sizing): (&Fitted, &Sizing),
    targets: &Targets<'_>,
) {
    let pairs = assignment.pairs().map(|(segment, joint)| format!("{segment} = {}", rig.joints[joint].name));
    print_note("note", &format!("joints of the rig by segment: {}", pairs.collect::<Vec<_>>().join(", ")));
    let size = &fitted.size;
    print_note("note", &unit(fitted, sizing));
    if !size.lengths.is_empty() {
        let lengths = size.lengths.iter().map(|(name, length)| format!("{name} {length:.3} m"));
        let list = lengths.collect::<Vec<_>>().join(", ");
        print_note(
            "note",
            &format!(
                "the adult has the rig's {list}; its mass is that of the reference body mass index, the rest follows stature"
            ),
        );
    }
    print_note("note", &format!("up is {} of the file", fitted.axes.up_word()));
    if fitted.from_first_frame {
        print_note(
            "note",
            "the rest pose does not stand; the first frame shows how the bones of the rig lie to the adult's",
        );
    }
    if targets.is_moved() {
        print_note("note", "the motion leaves the 5 m about its origin; its first frame is moved there");
    }
    if targets.turned() != 0.0 {
        let degrees = targets.turned().to_degrees();
        print_note(
            "note",
            &format!(
                "the body faces aside; the motion is turned by {degrees:.0} deg about the vertical, so that it faces ahead in the middle"
            ),
        );
    }
    if !fitted.feet_point_ahead {
        print_note("warning", "the feet of the rig point backwards: are left and right swapped in its names?");
    }
    if let (true, Some(&second)) = (targets.first_frame_jumps(), frames.get(1)) {
        let next = time(rig, second);
        print_note(
            "warning",
            &format!(
                "the first frame is another pose than the motion that follows (a T-pose?); --from {next} leaves it out"
            ),
        );
    }
}

/// The first line, and warnings about segments that do not follow.
fn answer(
    rig: &Rig,
    targets: &Targets<'_>,
    (frames, times, tracked): (&[usize], &[f64], &[TrackedFrame]),
    fitted: &Fitted,
) -> Result<String, Fail> {
    let mut body = Kinematics::new(&fitted.model);
    let mut of_segment: BTreeMap<usize, (f64, f64, f64)> = BTreeMap::new();
    for ((&frame, &time), answer) in frames.iter().zip(times).zip(tracked) {
        body.update(&fitted.model, &answer.posture).map_err(|error| Fail::job(MOTION, error))?;
        for (segment, angle) in targets.misfits(frame, &body) {
            let (sum, most, at) = of_segment.entry(segment).or_default();
            *sum += angle * angle;
            if angle > *most {
                (*most, *at) = (angle, time);
            }
        }
    }
    let name = |segment: usize| fitted.model.segments()[segment].name.as_str();
    let rms = |sum: f64, count: usize| (sum / count.max(1) as f64).sqrt();
    for (&segment, &(sum, most, at)) in &of_segment {
        let mean = rms(sum, frames.len());
        if mean > DOUBTFUL_TURN {
            let (mean, most) = (mean.to_degrees(), most.to_degrees());
            let text = format!(
                "`{}` is turned {mean:.0} deg from its joint in the root mean square, {most:.0} deg at {at:.3} s",
                name(segment)
            );
            print_note("warning", &format!("{text}: the joints of the adult do not follow it"));
        }
    }
    let open = tracked.iter().filter(|frame| !frame.solved.converged).count();
    if open > 0 {
        print_note("warning", &format!("{open} of {} frames are not solved to the end", frames.len()));
    }
    let all = rms(of_segment.values().map(|of| of.0).sum(), frames.len() * of_segment.len()).to_degrees();
    let (first, last) = (times[0], times[times.len() - 1]);
    let mut text =
        format!("Tracked {} frames from {first} s to {last:.3} s of {} joints", frames.len(), rig.joints.len());
    let _ = write!(text, ": segments are turned as theirs are within {all:.2} deg in the root mean square");
    if let Some((&segment, &(_, most, at))) = of_segment.iter().max_by(|a, b| a.1.1.total_cmp(&b.1.1)) {
        let _ = write!(text, ", the largest {:.1} deg (`{}` at {at:.3} s)", most.to_degrees(), name(segment));
    }
    Ok(text + ".\n")
}

/// The adult as a scenario that holds nothing else.
fn scenario(size: &Adult) -> String {
    let sex = if size.sex == Sex::Female { "female" } else { "male" };
    let lengths: Vec<String> = size.lengths.iter().map(|(name, length)| format!("{name} = {length:?}")).collect();
    let lengths =
        if lengths.is_empty() { String::new() } else { format!(", lengths_m = {{ {} }}", lengths.join(", ")) };
    format!(
        "format = 1\ntitle = \"an adult that an animation moves\"\n\n[model]\nadult = {{ sex = \"{sex}\", stature_m = {:?}, mass_kg = {:?}{lengths} }}\n",
        size.stature, size.mass
    )
}
