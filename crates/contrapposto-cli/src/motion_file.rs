//! POSTURES and MOTION on the command line, and the loads that act on the body in them.

use std::path::Path;

use contrapposto::assessment::{NEARLY_ALL, is_in_doubt, share_outside};
use contrapposto::model::{Coordinate, CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto_formats::loads::{self, GroundReaction, GroundReactionError, PlateOn};
use contrapposto_formats::markers::{is_c3d, read_force_plates, turn_upright};
use contrapposto_formats::motion::{self, Postures, Units, postures, read_table};
use contrapposto_formats::nearest;
use contrapposto_formats::tissue::SourcedModel;

use crate::args::{FrameArgs, LoadArgs};
use crate::fail::Fail;
use crate::input::{confined, is_animation, read};
use crate::output::print_note;

/// Held weights and forces, and ground reactions if there are any.
pub(crate) fn loads_of(
    args: &LoadArgs,
    model: &Model,
    motion: &[(f64, Posture)],
    notes: &mut Vec<String>,
) -> Result<(Vec<Load>, Option<GroundReaction>), Fail> {
    let mut loads = vec![];
    for text in &args.load {
        loads.push(loads::weight(model, text).map_err(|error| Fail::Refused(format!("--load \"{text}\": {error}")))?);
    }
    for text in &args.force {
        loads.push(loads::force(model, text).map_err(|error| Fail::Refused(format!("--force \"{text}\": {error}")))?);
    }
    let ground = args.grf.as_deref().map(|path| ground_reaction(path, args, (model, motion), notes)).transpose()?;
    let ground = match ground {
        Some(ground) if args.grf_splines => Some(ground.with_splines().map_err(fail_of)?),
        ground => ground,
    };
    Ok((loads, ground))
}

/// Whether a file is one of markers (.trc, .c3d).
fn holds_markers(name: &str, bytes: &[u8]) -> bool {
    let name = name.to_ascii_lowercase();
    [".trc", ".c3d"].iter().any(|ending| name.ends_with(ending)) || bytes.starts_with(b"PathFileType") || is_c3d(bytes)
}

/// Whether a file is an animation (.bvh, .glb, .gltf).
fn holds_animation(path: &Path, bytes: &[u8]) -> bool {
    is_animation(path) || bytes.starts_with(b"HIERARCHY") || bytes.starts_with(b"glTF")
}

/// The forces of --grf; notes say on which segments its plates are taken to act.
fn ground_reaction(
    path: &Path,
    args: &LoadArgs,
    (model, motion): (&Model, &[(f64, Posture)]),
    notes: &mut Vec<String>,
) -> Result<GroundReaction, Fail> {
    let (name, on) = (path.display().to_string(), &args.grf_on);
    let bytes = read(path, motion::MOST_TABLE_BYTES as u64)?;
    if is_c3d(&bytes) {
        return force_plates(&name, &bytes, args, (model, motion));
    }
    if holds_markers(&name, &bytes) {
        let accepted =
            "--grf is a C3D file with force plates, a table of ground reactions (.mot, .sto) or an ExternalLoads file";
        return Err(Fail::Refused(format!("{name}: is a marker file, which holds no forces; {accepted}")));
    }
    if !args.plate.is_empty() {
        let why = "--plate names force plates of a C3D file; --grf-on names the segments of a table's columns";
        return Err(Fail::Refused(format!("{name}: is no C3D file; {why}")));
    }
    let is_xml = bytes.trim_ascii_start().first() == Some(&b'<');
    let ground = if is_xml {
        external(path, &bytes, on, model)
    } else {
        GroundReaction::read(&name, &bytes, on, model).map_err(fail_of)
    }?;
    ground.warnings().iter().for_each(|warning| print_note("warning", warning));
    for (label, segment) in ground.guessed() {
        notes.push(format!("`{label}` of {name} is taken to act on `{segment}`; --grf-on says otherwise"));
    }
    Ok(ground)
}

/// The force plates of a C3D file. What each of them acts on is said.
fn force_plates(
    name: &str,
    bytes: &[u8],
    args: &LoadArgs,
    (model, motion): (&Model, &[(f64, Posture)]),
) -> Result<GroundReaction, Fail> {
    if !args.grf_on.is_empty() {
        let why = "--grf-on names the segments of a table's columns; --plate 1=calcn_r names that of a force plate";
        return Err(Fail::Refused(format!("{name}: is a C3D file; {why}")));
    }
    let mut read = read_force_plates(name, bytes, None).map_err(|error| Fail::Refused(error.to_string()))?;
    let up = (-model.gravity()).try_normalize(1e-9);
    if let Some(turn) = up.and_then(|up| turn_upright(read.up, up)) {
        read.turn(&turn);
        print_note("note", &turned(name));
    }
    let mut given: Vec<PlateOn> = vec![];
    for text in &args.plate {
        given.push(plate_on(text, model).map_err(|why| Fail::Refused(format!("--plate {text}: {why}")))?);
    }
    let ground = GroundReaction::of_force_plates(name, &read, &given, (model, motion));
    let ground = ground.map_err(|error| {
        Fail::Refused(format!("{error}; --plate 1=calcn_r says what plate 1 acts on, --plate 1=none leaves it out"))
    })?;
    ground.warnings().iter().for_each(|warning| print_note("warning", warning));
    ground.assigned().iter().for_each(|said| print_note("note", said));
    Ok(ground)
}

/// The note that places and forces of a laboratory are turned.
pub(crate) fn turned(name: &str) -> String {
    format!(
        "{name}: its laboratory counts heights along another axis than the model; it is turned upright (x, y, z become x, z, -y where z points up)"
    )
}

/// `1=calcn_r`, `2=none`.
fn plate_on(text: &str, model: &Model) -> Result<PlateOn, String> {
    let (number, segment) = text.split_once('=').ok_or("NUMBER=SEGMENT is accepted, such as 1=calcn_r, or 1=none")?;
    let number = number.trim().parse().map_err(|_| format!("`{}` is no number of a plate", number.trim()))?;
    match segment.trim() {
        "none" => Ok((number, None)),
        name => Ok((number, Some(model.segment(name).ok_or_else(|| loads::no_segment(model, name))?))),
    }
}

/// The table that OpenSim's ExternalLoads file at `path` names.
fn external(path: &Path, bytes: &[u8], on: &[String], model: &Model) -> Result<GroundReaction, Fail> {
    let refuse = |why: String| Fail::Refused(format!("{}: {why}", path.display()));
    if !on.is_empty() {
        return Err(refuse("names the segments of its forces itself; leave out --grf-on".to_owned()));
    }
    let loads = loads::external_loads(bytes).map_err(|error| refuse(error.to_string()))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let table = confined(folder, &loads.table).map_err(|_| {
        refuse(format!(
            "<datafile> {:?} is not in the file's folder or below; --allow-path DIR allows the files of DIR, too",
            loads.table
        ))
    })?;
    let bytes = read(&table, motion::MOST_TABLE_BYTES as u64)?;
    GroundReaction::of_external_loads(&table.display().to_string(), &bytes, &loads, model).map_err(
        |error| match error {
            GroundReactionError::Table(error) => Fail::from(error),
            error => refuse(error.to_string()),
        },
    )
}

fn fail_of(error: GroundReactionError) -> Fail {
    match error {
        GroundReactionError::Table(error) => Fail::from(error),
        GroundReactionError::Count { .. } => Fail::Refused(format!("--grf-on {error}")),
        GroundReactionError::Segment(_) => Fail::Refused(format!("--grf-on: {error}")),
        GroundReactionError::Unknown { .. } => Fail::Refused(format!("{error} with --grf-on SEG,SEG")),
        error => Fail::Refused(error.to_string()),
    }
}

/// The postures of a table between the times that are asked for, with their times. `accepted`: the sentence that names the accepted files.
pub(crate) fn read_motion(
    path: &Path,
    accepted: &str,
    args: &FrameArgs,
    model: &Model,
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Posture)>, Fail> {
    let all = read_whole_motion(path, accepted, args, model, notes)?;
    cut(&path.display().to_string(), all, args)
}

/// All postures of a table, with their times. `accepted`: the sentence that names the accepted files.
pub(crate) fn read_whole_motion(
    path: &Path,
    accepted: &str,
    args: &FrameArgs,
    model: &Model,
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Posture)>, Fail> {
    let name = path.display().to_string();
    let bytes = read(path, motion::MOST_TABLE_BYTES as u64).map_err(|fail| match fail {
        Fail::Refused(why) => Fail::Refused(format!("{why}\n  {accepted}")),
        other => other,
    })?;
    if holds_markers(&name, &bytes) {
        let why =
            "is a marker file; `contrapposto track MODEL FILE --out DIR` makes a motion of it: give DIR/motion.mot";
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    if holds_animation(path, &bytes) {
        let why =
            "is an animation; `contrapposto track adult FILE --out DIR` makes a motion of it: give DIR/motion.mot";
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    let table = read_table(&name, &bytes)?;
    table.warnings.iter().for_each(|warning| print_note("warning", warning));
    let units = match (args.degrees, args.radians) {
        (true, _) => Units::Degrees,
        (_, true) => Units::Radians,
        _ => Units::FromFile,
    };
    let read = postures(&table, &name, &bytes, model, units)?;
    for (names, what) in [
        (&read.missing, "coordinates have no column and stay at their default"),
        (&read.unknown, "columns are no coordinate of the model and are ignored"),
    ] {
        if !names.is_empty() {
            notes.push(format!("{name}: {} {what}: {}", names.len(), first_of(names)));
        }
    }
    misspelt(&read).iter().for_each(|warning| print_note("warning", &format!("{name}: {warning}")));
    if read.postures.is_empty() {
        return Err(Fail::Refused(format!("{name}: holds no rows")));
    }
    Ok(read.postures)
}

/// Endings of columns that tell the unit.
const UNITS: [&str; 5] = [".angle_deg", ".position_m", ".value", "_deg", "_m"];

/// A warning for each column that is ignored although its name is nearly that of a coordinate without a column.
fn misspelt(read: &Postures) -> Vec<String> {
    let said = |column: &String| {
        let stem = UNITS.iter().find_map(|unit| column.strip_suffix(unit)).unwrap_or(column);
        let meant = nearest(stem, read.missing.iter().map(String::as_str))?;
        Some(format!("the column `{column}` is no coordinate of the model and is ignored; did you mean `{meant}`?"))
    };
    read.unknown.iter().filter_map(said).collect()
}

/// The frames of the file `name` from a time to another one, s.
pub(crate) fn cut(name: &str, frames: Vec<(f64, Posture)>, args: &FrameArgs) -> Result<Vec<(f64, Posture)>, Fail> {
    let ends = frames.first().map(|frame| frame.0).zip(frames.last().map(|frame| frame.0));
    let (from, to) = (args.from.unwrap_or(f64::NEG_INFINITY), args.to.unwrap_or(f64::INFINITY));
    let kept: Vec<(f64, Posture)> = frames.into_iter().filter(|(time, _)| (from..=to).contains(time)).collect();
    match ends {
        Some((first, last)) if kept.is_empty() => Err(Fail::Refused(format!(
            "{name}: no instant lies between --from {from} s and --to {to} s; it goes from {first} s to {last} s"
        ))),
        _ => Ok(kept),
    }
}

fn first_of(names: &[String]) -> String {
    let more = if names.len() > 12 { ", ..." } else { "" };
    format!("{}{more}", names.iter().take(12).map(String::as_str).collect::<Vec<_>>().join(", "))
}

/// A hinge that lies so far beyond its range, rad, is an error of the file: a quarter of a turn (assumed).
const FAR: f64 = std::f64::consts::FRAC_PI_2;

/// Values above this, rad or m, that a smaller unit would lay into the range of their coordinate, are in that unit (assumed: two turns; no laboratory is
/// so large).
const LIKELY_UNIT: f64 = 12.0;

/// Notes the coordinates that leave their range, and those that leave the range of their built-in curve. Gives a warning for each whose
/// values lie outside its range in nearly all frames: a wrong sign, unit or zero.
pub(crate) fn note_values_out_of_range(
    opened: &SourcedModel,
    frames: &[(f64, Posture)],
    notes: &mut Vec<String>,
) -> Vec<String> {
    let model = &opened.model;
    let ranges = opened.passive_ranges();
    let (mut beyond, mut held, mut warnings) = (vec![], vec![], vec![]);
    for (index, coordinate) in model.coordinates().iter().enumerate() {
        if coordinate.kind == CoordinateKind::Quaternion || model.is_dependent(index) {
            continue;
        }
        let values: Vec<f64> = frames.iter().map(|(_, posture)| posture.values()[index]).collect();
        let outside = share_outside(values.iter().copied(), coordinate.range);
        if is_in_doubt(&values, coordinate.range) {
            warnings.push(out_of_range(coordinate, &values, outside));
        } else if let Some(far) = far_outside(coordinate, frames, index) {
            warnings.push(far);
        } else if outside > 0.0 {
            beyond.push(format!("`{}`", coordinate.name));
        }
        if ranges[index].is_some_and(|range| share_outside(values.iter().copied(), range) > 0.0) {
            held.push(format!("`{}`", coordinate.name));
        }
    }
    for (names, what) in [
        (beyond, "outside their range at some time"),
        (held, "outside the range of their built-in curve at some time, passive torque held at its limit"),
    ] {
        if !names.is_empty() {
            notes.insert(0, format!("{what}: {}", first_of(&names)));
        }
    }
    warnings
}

/// The warning about a hinge that some frame turns [`FAR`] beyond its range, as no body does. A root without muscles and ligaments turns round freely.
fn far_outside(coordinate: &Coordinate, frames: &[(f64, Posture)], index: usize) -> Option<String> {
    if coordinate.groups.is_none() && coordinate.passive.is_none() {
        return None;
    }
    let (min, max) = coordinate.range;
    let beyond = |value: f64| (min - value).max(value - max);
    let (time, worst) = frames
        .iter()
        .map(|(time, posture)| (*time, posture.values()[index]))
        .max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)))?;
    (coordinate.kind == CoordinateKind::Rotation && beyond(worst) > FAR).then(|| {
        format!(
            "`{}` is at {:.1} deg at {time} s, {:.1} deg beyond its range {:.1} .. {:.1} deg: no body turns so far, so that the answer \
             is not that of a person",
            coordinate.name,
            worst.to_degrees(),
            beyond(worst).to_degrees(),
            min.to_degrees(),
            max.to_degrees()
        )
    })
}

/// The warning about a coordinate whose values lie outside its range in a share `outside` of the frames.
fn out_of_range(coordinate: &Coordinate, values: &[f64], outside: f64) -> String {
    let (scale, unit) =
        if coordinate.kind == CoordinateKind::Rotation { (1f64.to_degrees(), "deg") } else { (1.0, "m") };
    let shown = |value: f64| format!("{:.1}", scale * value);
    let (least, greatest) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let [min, max] = [coordinate.range.0, coordinate.range.1].map(shown);
    let fits = 1.0 - share_outside(values.iter().map(|value| -value), coordinate.range);
    let share_inside = |scale: f64| 1.0 - share_outside(values.iter().map(|value| scale * value), coordinate.range);
    let smaller = if unit == "m" { 1e-3 } else { 1f64.to_radians() };
    let opposite = if fits >= NEARLY_ALL {
        format!("; opposite sign? With it {:.0} % of the time lies inside", 100.0 * fits)
    } else if least.abs().max(greatest.abs()) > LIKELY_UNIT && share_inside(smaller) >= NEARLY_ALL {
        let meant = if unit == "m" { "millimetres" } else { "degrees, taken for radians" };
        format!("; are its values in {meant}?")
    } else {
        String::new()
    };
    format!(
        "`{}` lies outside its range {min} .. {max} {unit} in {:.0} % of the time ({} .. {} {unit}){opposite}",
        coordinate.name,
        100.0 * outside,
        shown(least),
        shown(greatest)
    )
}
