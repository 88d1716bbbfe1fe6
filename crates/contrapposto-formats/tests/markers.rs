//! Tests the readers of marker files and of tracking tasks: forms that tools write, faults with their places, mutations.

use contrapposto_formats::markers::{MarkerUnit, TaskValue, read_trc, tracking_tasks};
use contrapposto_formats::tissue::SourcedModel;
use miette::Diagnostic;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

const WALK: &str = "PathFileType\t4\t(X/Y/Z)\twalk.trc\n\
    DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\n\
    60.00\t60.00\t       3\t2\tmm\t60.00\n\
    Frame#\tTime\tR.ASIS\t\t\tL.ASIS\t\t\n\
    \t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
    \n\
    1\t0.000\t617.25\t1055.5\t170\t639\t1044\t-88\n\
    2\t0.017\t\t\t\t640\tNaN\t-88\t\n\
    3\t0.033\t617\t1055\t171\t0\t0\t0\n";

/// Message of a refusal, and the line of its place.
fn refused(text: &str) -> (String, Option<usize>) {
    let error = read_trc("walk.trc", text.as_bytes(), None).unwrap_err();
    let place = error.labels().and_then(|mut labels| labels.next());
    let line = place.map(|place| text[..place.offset()].matches('\n').count() + 1);
    (error.to_string(), line)
}

#[test]
fn units_gaps_and_names_of_a_file_are_read() {
    let read = read_trc("walk.trc", WALK.as_bytes(), None).unwrap();
    assert_eq!(
        (read.names.as_slice(), read.unit),
        (["R.ASIS".to_owned(), "L.ASIS".to_owned()].as_slice(), MarkerUnit::Millimetre)
    );
    assert_eq!(read.times, [0.0, 0.017, 0.033]);
    let first = Vector3::new(617.25 * 1e-3, 1055.5 * 1e-3, 170.0 * 1e-3);
    assert_eq!(read.places[0][0], Some(first));
    assert_eq!((read.places[1][0], read.places[1][1], read.places[2][1]), (None, None, None));
    assert_eq!(read.warnings, ["walk.trc: 1 places of markers are 0, 0, 0, which are read as gaps"]);
    // An empty cell of the header does not move the others.
    let empty = read_trc("walk.trc", WALK.replace("60.00\t60.00\t", "60.00\t\t").as_bytes(), None).unwrap();
    assert_eq!(empty, read);
    let metres = read_trc("walk.trc", WALK.as_bytes(), Some(MarkerUnit::Metre)).unwrap();
    assert_eq!(metres.places[0][0], Some(first * 1e3));
    for (unit, length) in [("cm", 1e-2), ("m", 1.0), ("Meters", 1.0), ("millimeters", 1e-3)] {
        let read = read_trc("walk.trc", WALK.replace("\tmm\t", &format!("\t{unit}\t")).as_bytes(), None).unwrap();
        assert!((read.places[0][0].unwrap().y - 1055.5 * length).abs() < 1e-12, "{unit}");
    }
}

#[test]
fn files_with_blanks_in_place_of_tabs_and_other_line_ends_are_read() {
    let dense = WALK.replace("\t\t\t\t640", "\tnan\tnan\tnan\t640");
    let plain = read_trc("walk.trc", dense.as_bytes(), None).unwrap();
    let spaced = read_trc("walk.trc", dense.replace('\t', "   ").as_bytes(), None).unwrap();
    assert_eq!((&plain.names, &plain.places), (&spaced.names, &spaced.places));
    // A marker that is left out of a row would give its place to the next one.
    let short = WALK.replace('\t', "   ");
    let (said, line) = refused(&short);
    assert!(
        said.contains("the row has 3 places of markers, its 2 markers need 6") && line == Some(8),
        "{line:?} {said}"
    );
    let windows = read_trc("walk.trc", format!("\u{feff}{}", dense.replace('\n', "\r\n")).as_bytes(), None).unwrap();
    assert_eq!(plain, windows);
}

#[test]
fn wrong_counts_short_rows_and_names_that_stand_twice_are_warnings_with_their_line() {
    let text = WALK.replace("       3\t2", "4\t3").replace("\t171\t0\t0\t0", "\t171");
    let warnings = read_trc("walk.trc", text.as_bytes(), None).unwrap().warnings;
    assert!(warnings[0].starts_with("walk.trc:9: the row has fewer cells"), "{warnings:?}");
    assert!(warnings[1].contains("says 4 frames (line 3), but there are 3"), "{warnings:?}");
    assert!(warnings[2].contains("says 3 markers (line 3), but there are 2"), "{warnings:?}");
    let twice = read_trc("walk.trc", WALK.replace("L.ASIS", "R.ASIS").as_bytes(), None).unwrap();
    assert_eq!((twice.names.len(), twice.places[0].len()), (1, 1));
    assert!(twice.warnings[0].starts_with("walk.trc:4: two markers are named `R.ASIS`"), "{:?}", twice.warnings);
}

#[test]
fn faults_are_refused_with_their_place() {
    for (from, to, place, said) in [
        ("1055.5", "1055,5", Some(7), "`R.ASIS`: `1055,5` is no place of a marker"),
        ("1055.5", "inf", Some(7), "`inf` is no place of a marker"),
        ("1055.5", "1e300", Some(7), "`1e300` is no place of a marker"),
        ("0.033", "0.003", Some(9), "time falls from 0.017 to 0.003"),
        ("0.017", "", Some(8), "is no time"),
        ("\tmm\t", "\tfurlong\t", Some(3), "`furlong` is no known unit"),
        ("-88\n2", "-88\t7\n2", Some(7), "more cells than the 8 of its markers"),
        ("R.ASIS\t\t\tL.ASIS", "R.ASIS\t\tL.ASIS", Some(4), "stands above another column"),
        ("Frame#", "Number", None, "no line of marker names"),
        ("Units", "Unit", None, "does not say the unit"),
    ] {
        assert!(WALK.contains(from), "{from}");
        let (text, line) = refused(&WALK.replacen(from, to, 1));
        assert!(text.contains(said) && line == place, "{from} -> {to}: line {line:?}: {text}");
    }
    let empty = WALK.split_inclusive('\n').take(5).collect::<String>();
    assert!(refused(&empty).0.contains("names markers but has no rows"));
}

const SETUP: &str = "<OpenSimDocument Version=\"30000\"><InverseKinematicsTool name=\"walk\">\
    <constraint_weight>20</constraint_weight><marker_file>walk.trc</marker_file>\
    <IKTaskSet><objects>\
    <IKMarkerTask name=\"R.ASIS\"><apply>true</apply><weight> 10 </weight></IKMarkerTask>\
    <IKMarkerTask name=\"L.ASIS\"/>\
    <IKMarkerTask name=\"off\"><apply>false</apply><weight>5</weight></IKMarkerTask>\
    <IKCoordinateTask name=\"knee\"><weight>1000</weight><value_type>default_value</value_type></IKCoordinateTask>\
    <IKCoordinateTask name=\"hip\"><value_type>manual_value</value_type><value>0.25</value></IKCoordinateTask>\
    </objects></IKTaskSet><time_range> 0.5 2.5</time_range></InverseKinematicsTool></OpenSimDocument>";

#[test]
fn tasks_of_a_setup_file_and_of_a_set_alone_are_read() {
    let read = tracking_tasks("setup.xml", SETUP.as_bytes()).unwrap();
    let markers: Vec<(&str, f64)> = read.markers.iter().map(|task| (task.name.as_str(), task.weight)).collect();
    // OpenSim 4.6: `IKMarkerTask().getWeight()` and `IKCoordinateTask().getWeight()` are 0.
    assert_eq!(markers, [("R.ASIS", 10.0), ("L.ASIS", 0.0)]);
    assert_eq!(read.weightless, ["L.ASIS", "hip"]);
    let coordinates: Vec<_> =
        read.coordinates.iter().map(|task| (task.name.as_str(), task.weight, task.value)).collect();
    assert_eq!(coordinates, [("knee", 1000.0, TaskValue::Default), ("hip", 0.0, TaskValue::Manual(0.25))]);
    assert_eq!((read.time_range, read.notes.len() + read.named.len()), (Some((0.5, 2.5)), 2), "{:?}", read.notes);
    let from = SETUP.find("<IKTaskSet>").unwrap();
    let set = &SETUP[from..SETUP.find("<time_range>").unwrap()];
    for text in [set.to_owned(), format!("<OpenSimDocument>{set}</OpenSimDocument>")] {
        let alone = tracking_tasks("set.xml", text.as_bytes()).unwrap();
        assert_eq!((alone.markers.len(), alone.coordinates.len(), alone.time_range), (2, 2, None));
    }
}

#[test]
fn tasks_without_meaning_are_refused_with_file_line_and_column() {
    for (from, to, said) in [
        ("default_value<", "from_file<", "`knee`: values of the kind `from_file` are not read"),
        (" 10 ", "-1", "`R.ASIS`: the weight is -1"),
        (" 10 ", "NaN", "<weight> is `NaN`; a finite number is accepted"),
        ("name=\"L.ASIS\"", "", "the <IKMarkerTask> has no name"),
        ("name=\"L.ASIS\"", "name=\"R.ASIS\"", "two tasks are named `R.ASIS`"),
        ("<apply>true", "<apply>perhaps", "<apply> is `perhaps`"),
        ("<IKMarkerTask name=\"L.ASIS\"/>", "<CMC_Task name=\"a\"/>", "<CMC_Task> is no task"),
        ("<IKTaskSet>", "<IKTaskSet file=\"tasks.xml\">", "the tasks are in the file \"tasks.xml\""),
        ("0.5 2.5", "2.5 0.5", "<time_range> is `2.5 0.5`"),
    ] {
        assert!(SETUP.contains(from), "{from}");
        let error = tracking_tasks("setup.xml", SETUP.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("setup.xml:1:") && error.contains(said), "{to}: {error}");
    }
    assert!(tracking_tasks("a.xml", b"<Model/>").unwrap_err().to_string().contains("holds no <IKTaskSet>"));
    assert!(tracking_tasks("a.xml", b"no xml").unwrap_err().to_string().starts_with("a.xml: "));
}

#[test]
fn markers_and_clamped_ranges_of_both_forms_of_models_are_kept() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    for name in ["joints_3x.osim", "joints_4x.osim"] {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let read = SourcedModel::read(name, &bytes, None, &mut |_| Err(String::new())).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let count = text.matches("<Marker ").count();
        let on_ground =
            read.left_out.iter().find(|(kind, _)| kind == "markers fixed to ground").map_or(0, |kind| kind.1);
        assert_eq!(read.markers.len() + on_ground, count, "{name}");
        assert!(
            read.hard_limits.iter().all(|(index, (low, high))| *index < read.model.coordinates().len() && low <= high)
        );
        let clamped = text.matches("<clamped>true</clamped>").count();
        assert_eq!(read.hard_limits.len(), clamped, "{name}");
    }
}

#[test]
fn the_range_of_an_overlay_is_the_limit_of_a_clamped_coordinate() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/joints_4x.osim");
    let read = SourcedModel::read("j.osim", &std::fs::read(path).unwrap(), None, &mut |_| Err(String::new())).unwrap();
    let pin = read.model.coordinate("pin_angle").unwrap();
    let limit = |read: &SourcedModel| read.hard_limits.iter().find(|limit| limit.0 == pin).unwrap().1;
    assert_eq!(limit(&read), (-1.5, 2.0));
    let overlay = "[coordinates.pin_angle]\nrange_deg = [-45, 90]\n";
    let (low, high) = limit(&read.lay_over("o.toml", overlay.as_bytes()).unwrap());
    assert!((low.to_degrees() + 45.0).abs() < 1e-12 && (high.to_degrees() - 90.0).abs() < 1e-12, "{low} {high}");
}

/// A text with a few bytes or lines changed.
fn mutated(text: &str, rng: &mut Pcg64) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..rng.random_range(1..6) {
        let at = rng.random_range(0..bytes.len().max(1)).min(bytes.len().saturating_sub(1));
        match rng.random_range(0..6) {
            0 => bytes[at] = rng.random_range(0..255),
            1 => drop(bytes.remove(at)),
            2 => bytes.truncate(at.max(1)),
            3 => bytes.insert(at, b"\t\n-e9N<>"[rng.random_range(0..8)]),
            4 => {
                let end = (at + rng.random_range(1..40)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                let end = (at + rng.random_range(1..40)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
        if bytes.is_empty() {
            bytes.push(b'F');
        }
    }
    bytes
}

#[test]
fn two_thousand_mutated_files_of_each_kind_are_read_or_refused() {
    const SEED: u64 = 2007;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let mut read = [0, 0];
    for _ in 0..2000 {
        if let Ok(markers) = read_trc("m.trc", &mutated(WALK, &mut rng), None) {
            read[0] += 1;
            assert!(!markers.names.is_empty() && markers.places.len() == markers.times.len());
            assert!(markers.times.iter().all(|time| time.is_finite()));
            for row in &markers.places {
                assert_eq!(row.len(), markers.names.len());
                assert!(row.iter().flatten().all(|place| place.iter().all(|x| x.abs() <= 1e9)));
            }
        }
        if let Ok(tasks) = tracking_tasks("t.xml", &mutated(SETUP, &mut rng)) {
            read[1] += 1;
            assert!(tasks.markers.iter().all(|task| (0.0..=1e12).contains(&task.weight)));
        }
    }
    println!("{read:?} of 2000 were read");
    assert!(read.iter().all(|read| (20..1900).contains(read)), "{read:?}");
}
