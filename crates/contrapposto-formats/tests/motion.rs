//! Tables of motion: read, turned into postures, written, refused with a place.

use crate::common;
mod hostile;

use common::next;
use contrapposto::math::Function;
use contrapposto::model::{
    Adult, CoordinateKind, CoordinateSpec, Drive, JointKind, Model, ModelBuilder, Motion, SegmentSpec, adult,
};
use contrapposto_formats::InputError;
use contrapposto_formats::motion::{
    MOST_COLUMNS, MOST_NAME_BYTES, MOST_TABLE_BYTES, Table, Units, UnwritableTable, opensim_columns, postures,
    read_table, write_csv, write_sto,
};
use miette::Diagnostic;
use nalgebra::{Isometry3, Matrix3, Vector3};

use CoordinateKind::{Quaternion, Rotation, Translation};

/// A table of OpenSim 4.6's `STOFileAdapter`: no name line, state paths.
const STATES: &str = "inDegrees=no\nDataType=double\nversion=3\nOpenSimVersion=4.6-2026-06-22-85aaf64\nendheader\n\
    time\t/jointset/hip_r/hip_flexion_r/value\t/jointset/hip_r/hip_flexion_r/speed\n\
    0\t0.1\t0.3333333333333333\n0.01\t9.999999999999999e-21\t2e+17\n";

/// A table of OpenSim's `Storage`: fixed digits, blanks before numbers, a description in the header.
const STORAGE: &str = "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nUnits are S.I. units (second, meters, \
    Newtons, ...)\nIf the header above contains a line with 'inDegrees', this indicates whether rotational values are in \
    degrees (yes) or radians (no).\n\nendheader\ntime\thip_flexion_r\tpelvis_ty\n      0.00000000\t     30.00000000\t      \
    0.95000000\n      0.01000000\t    -45.00000000\t      0.96000000\n";

const CSV: &str = "time,hip_flexion_r.angle_deg,pelvis_tx.position_m,hip_flexion_r.case,hip_flexion_r.goal_deg,heel\n\
    0,90,0.5,,,1\n0.5,-180,0.25,2.1,12.5,2\n";

fn sto(header: &str, rest: &str) -> String {
    format!("motion\nversion=1\n{header}\nendheader\n{rest}")
}

fn read(text: &str) -> Table {
    read_table("file", text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}"))
}

fn man() -> Model {
    adult(&Adult::default()).unwrap()
}

/// One free segment: `root_tx` to `root_qz`.
fn free() -> Model {
    let mut builder = ModelBuilder::new("free", Vector3::zeros());
    let slide = |name| CoordinateSpec::new(name, (-1.0, 1.0));
    let spec = SegmentSpec {
        name: "trunk".to_owned(),
        parent: None,
        mass: 1.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::identity(),
        joint: "root".to_owned(),
        kind: JointKind::Free,
        in_parent: Isometry3::identity(),
        in_segment: Isometry3::identity(),
        coordinates: ["root_tx", "root_ty", "root_tz"].map(slide).to_vec(),
    };
    builder.segment(spec).unwrap();
    builder.build()
}

/// Hinges by a curve of their coordinate, by half of it, and by itself.
fn driven() -> Model {
    let axis = || Motion::Hinge(Vector3::z_axis());
    let bent = Function::Polynomial(vec![0.1, 0.9, 0.2]);
    let motions = vec![
        (axis(), Drive::Function(bent, 0)),
        (axis(), Drive::Function(Function::Linear { slope: 0.5, intercept: 0.0 }, 1)),
        (axis(), Drive::Coordinate(2)),
    ];
    let mut builder = ModelBuilder::new("driven", Vector3::zeros());
    let spec = SegmentSpec {
        name: "patella".to_owned(),
        parent: None,
        mass: 1.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::identity(),
        joint: "knee".to_owned(),
        kind: JointKind::Driven(motions),
        in_parent: Isometry3::identity(),
        in_segment: Isometry3::identity(),
        coordinates: ["bent", "half", "plain"].map(|name| CoordinateSpec::new(name, (-2.0, 2.0))).to_vec(),
    };
    builder.segment(spec).unwrap();
    builder.build()
}

/// OpenSim counts an angle that turns a body by a curve as "coupled", and its files have it in radians among degrees (as the patella's of
/// Rajagopal2016: its inverse dynamics of a file in degrees was 350 N m off at the hip).
#[test]
fn angles_by_curves_stand_in_radians_among_degrees_as_opensim_has_them() {
    let model = driven();
    let columns = opensim_columns(&model);
    assert_eq!(columns.iter().map(|column| column.1).collect::<Vec<_>>(), [Translation, Rotation, Rotation]);
    let text = write_sto("m", &columns, true, &[0.0], &[[1.25, 0.5, -0.5]]).unwrap();
    let row: Vec<f64> = text.lines().last().unwrap().split('\t').map(|cell| cell.parse().unwrap()).collect();
    assert_eq!(row[1], 1.25);
    assert!((row[2] - 0.5f64.to_degrees()).abs() < 1e-12 && (row[3] + 0.5f64.to_degrees()).abs() < 1e-12, "{row:?}");
    let values =
        |units| postures(&read(&text), "m", text.as_bytes(), &model, units).unwrap().postures[0].1.values().to_vec();
    let back = values(Units::FromFile);
    assert!(back[0] == 1.25 && (back[1] - 0.5).abs() < 1e-15 && (back[2] + 0.5).abs() < 1e-15, "{back:?}");
    assert_eq!(values(Units::Degrees)[0], 1.25f64.to_radians(), "as the user says");
}

/// Message, help and place (line and column from 1) of a complaint.
fn complaint(error: &InputError) -> (String, String, Option<(usize, usize)>) {
    let help = error.help().map(|h| h.to_string()).unwrap_or_default();
    let span = error.labels().into_iter().flatten().next();
    let place = span.and_then(|span| {
        let found = error.source_code()?.read_span(span.inner(), 0, 0).ok()?;
        Some((found.line() + 1, found.column() + 1))
    });
    (error.to_string(), help, place)
}

fn refused(text: &str) -> (String, String, Option<(usize, usize)>) {
    complaint(&read_table("file", text.as_bytes()).expect_err(text))
}

fn value(text: &str, units: Units, model: &Model, coordinate: &str) -> Result<Vec<f64>, InputError> {
    let found = postures(&read(text), "file", text.as_bytes(), model, units)?;
    let at = model.coordinate(coordinate).unwrap();
    Ok(found.postures.iter().map(|(_, posture)| posture.values()[at]).collect())
}

#[test]
fn what_opensim_writes_is_read() {
    let states = read(STATES);
    assert_eq!((states.name.as_str(), states.in_degrees), ("", Some(false)));
    assert_eq!(states.times, [0.0, 0.01]);
    assert_eq!(states.rows, [[0.1, 0.3333333333333333], [1e-20, 2e17]]);
    let storage = read(STORAGE);
    assert_eq!((storage.name.as_str(), storage.in_degrees), ("Coordinates", Some(true)));
    assert_eq!(storage.columns, ["hip_flexion_r", "pelvis_ty"]);
    assert_eq!(storage.rows, [[30.0, 0.95], [-45.0, 0.96]]);
    let old = "\n# SIMM Motion File Header:\nname walk\ndatacolumns 2\ndatarows 1\notherdata 1\nrange 0 1\nendheader\n\
        time hip_flexion_r \n 0.5  30 \n";
    let old = read(old);
    assert_eq!((old.name.as_str(), old.in_degrees, &old.times[..]), ("walk", Some(true), &[0.5][..]));
    assert_eq!(read(&sto("Angles are in radians.", "time\ta\n0\t1")).in_degrees, Some(false));
    assert_eq!(read(&sto("inDegrees=yes\nAngles are in radians.", "time\ta\n0\t1")).in_degrees, Some(true));
    assert_eq!(read(&sto("datacolumns 2", "time\ta\n0\t1")).in_degrees, None);
}

#[test]
fn line_ends_and_blanks_do_not_matter() {
    for text in [STATES, STORAGE, CSV] {
        let table = read(text);
        assert_eq!(read(&text.replace('\n', "\r\n")), table);
        assert_eq!(read(&format!("\u{feff}{text}")), table);
        assert_eq!(read(&text.replace('\n', " \t \n")), table);
        assert_eq!(read(&format!("{text}\n \r\n\t\n\n")), table);
        assert_eq!(read(text.trim_end()), table);
    }
    let spaces = read(&sto("nColumns=3", "time a  b\n0 1 2"));
    assert_eq!(spaces.columns, ["a", "b"]);
    // Tabs allow spaces inside names.
    assert_eq!(read(&sto("nColumns=3", "time\tleft foot\tb \n0 1\t2")).columns, ["left foot", "b"]);
}

#[test]
fn comma_separated_text_is_read() {
    let table = read(CSV);
    assert_eq!(table.columns, ["hip_flexion_r.angle_deg", "pelvis_tx.position_m", "heel"]);
    assert_eq!(table.rows, [[90.0, 0.5, 1.0], [-180.0, 0.25, 2.0]]);
    assert_eq!((table.times, table.in_degrees, table.name.as_str()), (vec![0.0, 0.5], None, ""));
    let plain = read("\"a\", b\n1, 2\n3, 4\n");
    assert_eq!((plain.columns, plain.times), (vec!["a".to_owned(), "b".to_owned()], vec![0.0, 1.0]));
    assert_eq!(read("a\n1\n").rows, [[1.0]]);
    // Content decides: OpenSim's form under another name.
    assert_eq!(read_table("x.csv", STATES.as_bytes()).unwrap(), read(STATES));
}

#[test]
fn complaints_have_a_place_and_say_what_would_be_right() {
    let check = |text: &str, place, message: &str, help: &str| {
        let (found, hint, at) = refused(text);
        assert!(found.contains(message), "{found} | {message}");
        assert!(hint.contains(help), "{hint} | {help}");
        assert_eq!(at, place, "{found}");
    };
    let rows = "time\ta\tb\n0\t1\t2\n1\t3\t4\n";
    check(&sto("nRows=2\ndatarows 1", rows), Some((4, 1)), "further up, 2", "");
    check(&sto("nRows=many", rows), Some((3, 1)), "not a whole number", "nRows=");
    check(&sto("inDegrees=perhaps", rows), Some((3, 1)), "neither yes nor no", "inDegrees=yes");
    check(&sto("inDegrees=yes\ninDegrees=no", rows), Some((4, 1)), "both", "");
    check(&sto("DataType=Quaternion", "time\tpelvis\n0\t1,0,0,0"), Some((3, 1)), "plain numbers", "double");
    check(&sto("", "time\ta\tb\n0\t1\tnan\n"), Some((6, 5)), "column `b`: `nan` is not finite", "finite");
    check(&sto("", "time\ta\tb\n0\t-inf\t1\n"), Some((6, 3)), "not finite", "");
    check("time,a\n0,1\n1,1e999\n", Some((3, 3)), "`1e999` is not finite", "");
    check("time,a\n0,1\nNaN,1\n", Some((3, 1)), "column `time`", "");
    check("time,a\n0,\n", Some((2, 3)), "column `a`: `` is not a number", "12.5");
    check("time,a\n0,1.#QNAN\n", Some((2, 3)), "not a number", "");
    check("time,a\n0,1,5\n", Some((2, 5)), "more than the 2 cells", "point");
    check(&sto("", "time\ta\tb\n0\t\t1\n"), Some((6, 5)), "2 cells; the labels name 3", "cut off");
    check("time,a,a\n0,1,2\n", Some((1, 8)), "two columns are named `a`", "unique");
    check(&sto("", "a\ttime\n0\t1\n"), Some((5, 1)), "first column is `a`", "time");
    check("a,Time\n0,1\n", Some((1, 3)), "`Time` is column 2", "first");
    check("a,,b\n0,1,2\n", Some((1, 3)), "column 2 has no name", "");
    check("0,1\n2,3\n", Some((1, 1)), "`0` stands where", "name the columns");
    check("a;b\n0;1\n", Some((1, 1)), "one column only", "commas");
    check("time\n0\n", Some((1, 1)), "no values", "");
    check("time,a\n1,0\n0.5,0\n", Some((3, 1)), "time falls from 1.0 to 0.5", "order");
    check("time,a\n", Some((1, 1)), "no rows", "follow");
    check(&sto("nRows=0", "time\ta\n"), Some((5, 1)), "no rows", "");
    check("", None, "no table", "");
    check(&sto("", ""), None, "no table", "");
    check("a\u{7}b,c\n1,2\n", Some((1, 1)), "\\u{7}", "");
    let (message, help, _) = complaint(&read_table("walk.MOT", b"time\ta\n0\t1\n").unwrap_err());
    assert!(message.contains("endheader") && help.contains("nRows"), "{message} {help}");
    let (message, _, place) = complaint(&read_table("x", b"time,a\n0,\xff").unwrap_err());
    assert!(message.contains("UTF-8") && place == Some((2, 3)), "{message}");
    // Lines too wide for a caret have the place in words.
    let wide: Vec<String> = (0..500).map(|i| format!("c{i}")).collect();
    let text = format!("{}\n{}nan\n", wide.join(","), "1,".repeat(499));
    assert!(refused(&text).0.starts_with("file:2:999: column `c499`: `nan`"), "{}", refused(&text).0);
}

#[test]
fn bounds_hold() {
    let labels = |n: usize| (0..n).map(|i| format!("c{i}")).collect::<Vec<_>>().join(",");
    let row = |n: usize| vec!["1"; n].join(",");
    let text = |n| format!("{}\n{}\n", labels(n), row(n));
    assert_eq!(read(&text(MOST_COLUMNS)).columns.len(), MOST_COLUMNS);
    assert!(refused(&text(MOST_COLUMNS + 1)).0.contains("more than 10000 columns"));
    assert_eq!(read(&format!("{}\n1", "n".repeat(MOST_NAME_BYTES))).columns[0].len(), MOST_NAME_BYTES);
    assert!(refused(&format!("{}\n1", "n".repeat(MOST_NAME_BYTES + 1))).0.contains("257 bytes"));
    assert!(refused(&format!("{}\nendheader\ntime\ta\n0\t1", "n".repeat(257))).0.contains("257 bytes"));
    assert!(read_table("x", &vec![b'\n'; MOST_TABLE_BYTES + 1]).unwrap_err().to_string().contains("67108865 bytes"));
    let numbers = format!("{}\n{}", labels(10_000), format!("{}\n", row(10_000)).repeat(1000));
    assert_eq!(read(&numbers).rows.len(), 1000);
    assert!(refused(&format!("{numbers}{}\n", row(10_000))).0.contains("more than 10000000 numbers"));
    // Few columns and many rows must not become many full postures.
    let many = "elbow_flex_r_deg\n".to_owned() + &"1\n".repeat(1_000_000);
    let error = postures(&read(&many), "x", many.as_bytes(), &man(), Units::FromFile).unwrap_err();
    assert!(error.to_string().contains("too many"), "{error}");
}

#[test]
fn columns_become_coordinates() {
    let model = man();
    let radians = |d: f64| d.to_radians();
    assert_eq!(value(STATES, Units::FromFile, &model, "hip_flexion_r").unwrap(), [0.1, 1e-20]);
    assert_eq!(value(STATES, Units::Degrees, &model, "hip_flexion_r").unwrap()[0], radians(0.1));
    assert_eq!(value(STORAGE, Units::FromFile, &model, "hip_flexion_r").unwrap(), [radians(30.0), radians(-45.0)]);
    assert_eq!(value(STORAGE, Units::Radians, &model, "hip_flexion_r").unwrap(), [30.0, -45.0]);
    // Lengths are never converted.
    assert_eq!(value(STORAGE, Units::FromFile, &model, "pelvis_ty").unwrap(), [0.95, 0.96]);
    for units in [Units::FromFile, Units::Degrees, Units::Radians] {
        assert_eq!(value(CSV, units, &model, "hip_flexion_r").unwrap(), [radians(90.0), radians(-180.0)]);
        assert_eq!(value(CSV, units, &model, "pelvis_tx").unwrap(), [0.5, 0.25]);
    }
    // As scenarios name them; far out of range is fine.
    let text = "elbow_flex_r_deg,pelvis_ty_m\n720,30\n";
    assert_eq!(value(text, Units::FromFile, &model, "elbow_flex_r").unwrap(), [radians(720.0)]);
    assert_eq!(value(text, Units::FromFile, &model, "pelvis_ty").unwrap(), [30.0]);
    let found = postures(&read(STATES), "file", STATES.as_bytes(), &model, Units::FromFile).unwrap();
    assert_eq!(found.unknown, [""; 0]);
    assert_eq!(found.missing.len(), model.coordinates().len() - 1);
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    assert_eq!(found.postures[1].1.values()[elbow], model.coordinates()[elbow].default);
    assert_eq!(found.postures[1].0, 0.01);
    let found = postures(&read(CSV), "file", CSV.as_bytes(), &model, Units::FromFile).unwrap();
    assert_eq!(found.unknown, ["heel"]);
    let of_run =
        "time,elbow_flex_r.angle_deg,elbow_flex_r.external_nm,elbow_flex_r.fatigue_positive,elbow_flex_r.x\n0,1,2,3,4";
    let found = postures(&read(of_run), "", b"", &model, Units::FromFile).unwrap();
    assert_eq!(found.unknown, ["elbow_flex_r.x"]);
}

#[test]
fn columns_that_do_not_fit_the_model_are_refused() {
    let model = man();
    let fail = |text: &str, units| complaint(&value(text, units, &model, "elbow_flex_r").unwrap_err());
    // As OpenSim's own reference output: says radians, holds degrees.
    let wrong = sto("inDegrees=no", "time\tpelvis_ty\thip_flexion_r\n0\t9\t1\n0.1\t9\t18.2\n");
    let (message, help, place) = fail(&wrong, Units::FromFile);
    for part in ["line 7", "`hip_flexion_r`", "18.2", "probably holds degrees", "inDegrees=no"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(help.contains("--degrees") && help.contains("--radians"), "{help}");
    assert_eq!(place, Some((7, 7)));
    assert_eq!(value(&wrong, Units::Radians, &model, "hip_flexion_r").unwrap(), [1.0, 18.2]);
    assert_eq!(value(&wrong, Units::Degrees, &model, "hip_flexion_r").unwrap()[1], 18.2f64.to_radians());
    let error = postures(&read(&wrong), "", b"", &model, Units::FromFile).unwrap_err().to_string();
    assert!(error.contains("row 2"), "{error}");

    let (message, help, place) = fail("time,elbow_flex_r\n0,1\n", Units::FromFile);
    assert!(message.contains("degrees or radians") && help.contains("--degrees"), "{message}");
    assert_eq!(place, Some((1, 6)));
    let (message, help, _) = fail("time,elbow_flexr\n0,1\n", Units::FromFile);
    assert!(message.contains("no column is a coordinate") && help.contains("did you mean `elbow_flex_r`"), "{help}");
    assert!(fail("qqqqqq\n1\n", Units::FromFile).1.contains("pelvis_tilt"));
    let twice = "elbow_flex_r_deg,elbow_flex_r.angle_deg\n0,1\n";
    assert!(fail(twice, Units::FromFile).0.contains("same coordinate, `elbow_flex_r`"));
    assert!(fail("elbow_flex_r\n1e10\n", Units::Radians).0.contains("too large"));
    let ragged = Table { rows: vec![vec![]], ..read("elbow_flex_r\n1\n") };
    assert!(postures(&ragged, "", b"", &model, Units::Degrees).unwrap_err().to_string().contains("ragged"));
}

#[test]
fn quaternions_are_checked_and_normalised() {
    let model = free();
    let of = |qw: &str, units| {
        let text = format!("root_qw,root_qx,root_qy,root_qz,root_tx\n{qw},0,0,0.6,0.5\n");
        let table = read(&text);
        postures(&table, "file", text.as_bytes(), &model, units).map(|p| p.postures[0].1.values()[3..].to_vec())
    };
    for units in [Units::FromFile, Units::Degrees, Units::Radians] {
        assert_eq!(of("0.8", units).unwrap(), [0.8, 0.0, 0.0, 0.6]);
        let near = of("0.801", units).unwrap();
        assert!((near.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-15 && near[0] < 0.801, "{near:?}");
    }
    let (message, _, place) = complaint(&of("0.81", Units::FromFile).unwrap_err());
    assert!(message.contains("line 2: column `root_qw`") && message.contains("length"), "{message}");
    assert_eq!(place, Some((2, 1)));
    let text = "root_qw,root_qx\n1,0\n";
    let error = postures(&read(text), "file", text.as_bytes(), &model, Units::FromFile).unwrap_err();
    assert!(error.to_string().contains("root_qy"), "{error}");
}

/// Doubles of every size, of both signs.
fn numbers(n: usize, state: &mut u64, most: f64) -> Vec<f64> {
    let mut one = || {
        let value = f64::from_bits((next(state) as u64) << 33 ^ (next(state) as u64) << 11 ^ next(state) as u64);
        if value.is_finite() && value.abs() < most { value } else { next(state) as f64 / 1e9 - 1.0 }
    };
    (0..n).map(|_| one()).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn what_is_written_reads_back() {
    let columns = [("hip_flexion_r", Rotation), ("pelvis_ty", Translation), ("elbow_flex_r", Rotation)];
    let (model, mut state) = (man(), 7);
    let at: Vec<usize> = columns.iter().map(|(name, _)| model.coordinate(name).unwrap()).collect();
    let mut rows: Vec<Vec<f64>> = (0..2000).map(|_| numbers(3, &mut state, 6.0)).collect();
    rows[0] = vec![-0.0, f64::MIN_POSITIVE, 5e-324];
    let times: Vec<f64> = (0..2000).map(|i| f64::from(i) / 30.0).collect();
    let back = |text: &str| postures(&read(text), "file", text.as_bytes(), &model, Units::FromFile).unwrap().postures;
    let text = write_sto("run", &columns, false, &times, &rows).unwrap();
    let head = "run\nversion=1\nnRows=2000\nnColumns=4\ninDegrees=no\nendheader\n\
        time\thip_flexion_r\tpelvis_ty\telbow_flex_r\n0.0\t-0.0\t2.2250738585072014e-308\t5e-324\n";
    assert!(text.starts_with(head), "{}", &text[..200]);
    let table = read(&text);
    assert_eq!((table.name.as_str(), table.in_degrees), ("run", Some(false)));
    for ((time, posture), (row, expected)) in back(&text).iter().zip(rows.iter().zip(&times)) {
        assert_eq!(time.to_bits(), expected.to_bits());
        let values: Vec<f64> = at.iter().map(|i| posture.values()[*i]).collect();
        assert_eq!(bits(&values), bits(row));
    }
    let degrees = write_sto("run", &columns, true, &times, &rows).unwrap();
    assert!(degrees.contains("\ninDegrees=yes\n"));
    let csv = write_csv(&columns, &times, &rows).unwrap();
    assert!(csv.starts_with("time,hip_flexion_r.angle_deg,pelvis_ty.position_m,elbow_flex_r.angle_deg\n0.0,-0.0,"));
    let in_degrees: Vec<Vec<f64>> =
        rows.iter().map(|row| vec![row[0].to_degrees(), row[1], row[2].to_degrees()]).collect();
    for text in [degrees, csv] {
        // The numbers of the file keep their bits; angles take two roundings each way.
        assert!(read(&text).rows.iter().zip(&in_degrees).all(|(a, b)| bits(a) == bits(b)));
        for ((_, posture), row) in back(&text).iter().zip(&rows) {
            assert_eq!(posture.values()[at[1]].to_bits(), row[1].to_bits());
            for i in [0, 2] {
                let (found, expected) = (posture.values()[at[i]], row[i]);
                assert!((found - expected).abs() <= 4.5e-16 * expected.abs() + 5e-324, "{found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn names_of_strangers_are_written_harmlessly() {
    let strange = [("a,b", Rotation), (" \"q\"\t", Rotation), ("x\ny z", Translation), ("", Quaternion)];
    let rows = [[0.5, 1.0, 2.0, 1.0]];
    let sto = read(&write_sto("a\nnRows=9\tb", &strange, false, &[0.0], &rows).unwrap());
    assert_eq!(sto.name, "a_nRows_9_b");
    assert_eq!(sto.columns, ["a,b", "_\"q\"_", "x_y_z", "_"]);
    let csv = read(&write_csv(&strange, &[0.0], &rows).unwrap());
    assert_eq!(csv.columns, ["a_b.angle_deg", "__q__.angle_deg", "x_y z.position_m", "_.value"]);
    for name in ["", "endheader", "nRows", "name", "inDegrees no", "  ", &"é".repeat(200)] {
        let text = write_sto(name, &[("a", Rotation)], true, &[0.0], &[[1.0]]).unwrap();
        let table = read(&text);
        assert_eq!((table.in_degrees, table.rows.len()), (Some(true), 1), "{name}");
        assert!(!table.name.is_empty());
    }
    // Never a file that would be refused.
    let one = [("a", Rotation)];
    let write = |columns: &[(&str, CoordinateKind)], times: &[f64], rows: &[Vec<f64>]| {
        let csv = write_csv(columns, times, rows).unwrap_err();
        (write_sto("n", columns, true, times, rows).unwrap_err(), csv)
    };
    assert!(matches!(write(&one, &[], &[]), (UnwritableTable::Empty, UnwritableTable::Empty)));
    assert!(matches!(write(&one, &[0.0], &[vec![]]).0, UnwritableTable::Ragged { row: 0, found: 0, needed: 1 }));
    assert!(matches!(write(&one, &[], &[vec![1.0]]).0, UnwritableTable::Ragged { .. }));
    assert!(matches!(write(&one, &[0.0], &[vec![f64::MAX]]).0, UnwritableTable::NotFinite { row: 0, .. }));
    assert!(matches!(write(&one, &[f64::NAN], &[vec![1.0]]).1, UnwritableTable::NotFinite { .. }));
    assert!(matches!(write(&one, &[1.0, 0.0], &[vec![1.0], vec![1.0]]).0, UnwritableTable::Time { row: 1 }));
    assert!(matches!(
        write(&[("a\n", Rotation), ("a\t", Rotation)], &[0.0], &[vec![1.0; 2]]).1,
        UnwritableTable::Name(_)
    ));
    assert!(write_sto("n", &[("Time", Rotation)], true, &[0.0], &[[1.0]]).is_err());
}

/// OpenSim reads such files, and some of its own examples are.
#[test]
fn a_wrong_number_of_rows_or_columns_in_the_header_is_a_warning_with_its_line() {
    for (header, said) in [
        ("nRows=3\nnColumns=2", "says 3 rows (line 2), but there are 2"),
        ("datarows 1", "says 1 rows (line 2)"),
        ("nRows=2\nnColumns=4", "says 4 columns (line 3), but there are 2"),
    ] {
        let text = format!("motion\n{header}\nendheader\ntime\telbow_flex_r\n0\t1\n1\t2\n");
        let table = read_table("m.sto", text.as_bytes()).unwrap();
        assert_eq!(table.rows, [[1.0], [2.0]]);
        assert!(table.warnings.len() == 1 && table.warnings[0].contains(said), "{:?}", table.warnings);
    }
    let text = "motion\nnRows=2\nendheader\ntime\telbow_flex_r\n0\t1\n1\t2\n";
    assert!(read_table("m.sto", text.as_bytes()).unwrap().warnings.is_empty());
}

/// A time by another name would be left out in silence, and rows would last a second each.
#[test]
fn time_is_known_by_its_usual_names_and_what_is_like_it_is_refused() {
    for name in ["time", "Time", "time_s", "Time (s)", "time [s]"] {
        let table = read(&format!("{name},knee\n0,1\n600,2\n"));
        assert_eq!((table.times, table.columns), (vec![0.0, 600.0], vec!["knee".to_owned()]), "{name}");
        assert!(read_table("file", format!("knee,{name}\n0,1\n").as_bytes()).is_err(), "{name} after a value");
    }
    assert!(write_sto("n", &[("time_s", Rotation)], true, &[0.0], &[[1.0]]).is_err());
    for name in ["t", "time_ms", "timestamp", "Seconds", "TimeCode (ms)"] {
        let error = read_table("file", format!("{name},knee\n0,1\n600,2\n").as_bytes()).unwrap_err();
        let text = format!("{error} {}", error.help().unwrap());
        assert!(text.contains(&format!("`{name}`, is like a time")) && text.contains("name it `time`"), "{text}");
        assert_eq!(read(&format!("knee,{name}\n0,1\n600,2\n")).columns, ["knee", name]);
    }
}
