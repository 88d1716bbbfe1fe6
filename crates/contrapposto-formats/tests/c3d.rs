//! Tests the reader of C3D files: all kinds of computers, long trials, faults with their places, mutations, and other programs' numbers.

use crate::common::c3d as writer;

use std::path::PathBuf;

use contrapposto_formats::markers::{MarkerUnit, read_c3d, read_markers};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;
use writer::{Kind, Trial};

/// Two markers in three frames, with a gap and a place of zeros.
fn short(kind: Kind, scale: f64) -> Trial {
    let frames = vec![
        vec![[617.0, 1055.0, -170.0, 1.0], [639.0, 1044.0, -88.0, 0.0]],
        vec![[618.0, 1056.0, -171.0, 0.0], [640.0, 1045.0, -89.0, -1.0]],
        vec![[0.0, 0.0, 0.0, 0.0], [641.0, 1046.0, -90.0, 2.0]],
    ];
    Trial::new(kind, scale, &["R.ASIS", "L.ASIS"], frames)
}

#[test]
fn numbers_of_all_computers_are_read_exactly() {
    const SEED: u64 = 1986;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    for kind in Kind::ALL {
        for scale in [-1.0, -0.1, 0.0625, 0.75] {
            let mut number = || match scale < 0.0 {
                true => {
                    f64::from(rng.random_range(-16_777_215..16_777_216_i32)) * 2_f64.powi(rng.random_range(-30..-8))
                }
                false => f64::from(rng.random_range(-32_768..32_768_i32)),
            };
            let mut frame = || (0..5).map(|_| [number(), number(), number(), 0.0]).collect::<Vec<_>>();
            let frames: Vec<_> = (0..7).map(|_| frame()).collect();
            let mut trial = Trial::new(kind, scale, &["a", "b", "c", "d", "e"], frames);
            trial.ends = (31, 37);
            trial.rate = 62.5;
            for (unit, metres) in [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)] {
                trial.unit = unit;
                let read = read_c3d("a.c3d", &trial.bytes(), None).unwrap();
                assert!(read.warnings.is_empty(), "{:?}", read.warnings);
                assert_eq!(read.names, ["a", "b", "c", "d", "e"]);
                let times: Vec<f64> = (30..37).map(|n| f64::from(n) / 62.5).collect();
                assert_eq!(read.times, times);
                let factor = if scale < 0.0 { 1.0 } else { scale };
                for (row, frame) in read.places.iter().zip(&trial.frames) {
                    let wanted = frame.iter().map(|p| Some(Vector3::new(p[0], p[1], p[2]) * factor * metres));
                    assert_eq!(row, &wanted.collect::<Vec<_>>(), "{kind:?} {scale} {unit}");
                }
            }
        }
    }
}

#[test]
fn gaps_names_and_units_are_read() {
    for kind in Kind::ALL {
        for scale in [-1.0, 1.0] {
            let trial = short(kind, scale);
            let read = read_c3d("walk.c3d", &trial.bytes(), None).unwrap();
            assert_eq!(read.places[0][0], Some(Vector3::new(617.0, 1055.0, -170.0) * 1e-3));
            let seen: Vec<bool> = read.places.iter().flatten().map(Option::is_some).collect();
            assert_eq!(seen, [true, true, true, false, false, true], "{kind:?} {scale}");
            assert_eq!(read.warnings, ["walk.c3d: 1 places of markers are 0, 0, 0, which are read as gaps"]);
            let metres = read_c3d("walk.c3d", &trial.bytes(), Some(MarkerUnit::Metre)).unwrap();
            assert_eq!(metres.places[0][0], Some(Vector3::new(617.0, 1055.0, -170.0)));
        }
        let mut nan = short(kind, -1.0);
        nan.frames[0][0][1] = f64::NAN;
        if kind != Kind::Dec {
            assert_eq!(read_c3d("walk.c3d", &nan.bytes(), None).unwrap().places[0][0], None);
        }
    }
    let mut twice = short(Kind::Intel, -1.0);
    twice.labels = vec!["R.ASIS".to_owned(), "R.ASIS".to_owned()];
    let read = read_c3d("walk.c3d", &twice.bytes(), None).unwrap();
    assert_eq!((read.names.len(), read.places[1].len()), (1, 1));
    assert!(read.warnings[0].contains("two markers are named `R.ASIS`; the first one is read"), "{:?}", read.warnings);
    twice.labels[0].clear();
    let read = read_c3d("walk.c3d", &twice.bytes(), None).unwrap();
    assert_eq!(read.places[0][0], Some(Vector3::new(639.0, 1044.0, -88.0) * 1e-3));
    assert!(read.warnings[0].contains("1 of 2 points have no name"), "{:?}", read.warnings);
}

#[test]
fn more_than_255_labels_go_on_in_further_parameters() {
    let labels: Vec<String> = (0..600).map(|i| format!("m{i}")).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let frame = (0..600).map(|i| [f64::from(i), 1.0, 2.0, 0.0]).collect();
    let read = read_c3d("many.c3d", &Trial::new(Kind::Dec, -1.0, &labels, vec![frame]).bytes(), None).unwrap();
    assert_eq!(read.names, labels);
    for (i, place) in read.places[0].iter().enumerate() {
        assert_eq!(place.unwrap().x, i as f64 * 1e-3);
    }
}

#[test]
fn frames_beyond_those_of_the_header_are_counted_by_parameters() {
    let frame = |i: usize| vec![[i as f64, 5.0, 6.0, 0.0]];
    let mut trial = Trial::new(Kind::Mips, -1.0, &["a"], (0..70_000).map(frame).collect());
    let ends = |start: u32, end: u32| {
        let halves = |n: u32| vec![(n % 65_536) as u16, (n / 65_536) as u16];
        vec![(2, "ACTUAL_START_FIELD", halves(start)), (2, "ACTUAL_END_FIELD", halves(end))]
    };
    // Headers stop at 65535, or hold the lower 16 bits.
    for (header, start) in [((1, 65_535), 1), ((1, 4_464), 1), ((65_535, 65_535), 70_001), ((4_465, 8_928), 70_001)] {
        trial.ends = header;
        trial.words = ends(start, start + 69_999);
        let read = read_c3d("long.c3d", &trial.bytes(), None).unwrap();
        assert_eq!(read.times.len(), 70_000, "{header:?}");
        assert_eq!(read.times[0], f64::from(start - 1) / 50.0, "{header:?}");
        assert!(read.warnings.is_empty(), "{header:?}: {:?}", read.warnings);
        assert_eq!(read.places[69_999][0].unwrap().x, 69_999.0 * 1e-3);
    }
    // Parameters that do not agree with the header are those of another trial.
    trial.ends = (4_465, 8_927);
    let read = read_c3d("long.c3d", &trial.bytes(), None).unwrap();
    assert_eq!((read.times.len(), read.times[0]), (4_463, 4_464.0 / 50.0));
    (trial.ends, trial.words) = ((1, 65_535), vec![(1, "FRAMES", vec![65_535])]);
    assert_eq!(read_c3d("long.c3d", &trial.bytes(), None).unwrap().times.len(), 65_535);
    // Some programs count from 0.
    trial.frames.truncate(10);
    trial.words.clear();
    trial.ends = (0, 9);
    let read = read_c3d("long.c3d", &trial.bytes(), None).unwrap();
    assert_eq!((read.times.len(), read.times[0], read.warnings.len()), (10, 0.0, 0));
    (trial.ends, trial.words) = ((0, 10), vec![(1, "FRAMES", vec![10])]);
    let read = read_c3d("long.c3d", &trial.bytes(), None).unwrap();
    assert_eq!((read.times.len(), read.warnings.len()), (10, 0));
}

#[test]
fn a_header_that_counts_channels_for_samples_is_mended_by_the_size_of_the_file() {
    // As in sample 24 of c3d.org.
    let mut trial = short(Kind::Intel, -1.0);
    let wanted = read_c3d("walk.c3d", &trial.bytes(), None).unwrap();
    trial.samples = 200;
    trial.words = vec![(3, "USED", vec![100])];
    let mut bytes = trial.bytes();
    (bytes[4], bytes[5], bytes[18]) = (100, 0, 2);
    let read = read_c3d("walk.c3d", &bytes, None).unwrap();
    assert_eq!(read.places, wanted.places);
    let warning = "walk.c3d: the header says 100 analog samples a frame, ANALOG:USED and the size of the file 200";
    assert!(read.warnings[0].starts_with(warning), "{:?}", read.warnings);
}

#[test]
fn refusals_name_file_place_and_the_accepted() {
    let plain = short(Kind::Intel, -1.0).bytes();
    let refused = |bytes: &[u8]| read_markers("walk.c3d", bytes, None).unwrap_err().to_string();
    let changed = |at: usize, with: &[u8]| {
        let mut bytes = plain.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        refused(&bytes)
    };
    let unit = plain.windows(4).position(|bytes| bytes == b"mm  ").unwrap();
    let rate = plain.windows(4).position(|bytes| bytes == b"RATE").unwrap() + 8;
    let start = 512 * (usize::from(plain[16]) - 1);
    for (said, wanted) in [
        (changed(1, b"x"), "byte 0: the file is no C3D file; its header has 512 bytes".to_owned()),
        (refused(b"\x02\x50"), "byte 0: the file is no C3D file".to_owned()),
        (changed(0, &[8]), "byte 0: the file ends before its parameters, which begin at byte 3584".to_owned()),
        (changed(515, b"W"), "byte 515: the number of the processor is 87; 84 (Intel)".to_owned()),
        (changed(unit, b"feet"), format!("byte {unit}: the unit of the points (POINT:UNITS) is `feet`; mm, cm and m")),
        (changed(2, &[0xff, 0xff]), "byte 2: the file has 65535 points a frame; 3333 at most are accepted".to_owned()),
        (
            changed(rate, &1e9_f32.to_le_bytes()),
            format!("byte {rate}: the rate is 1000000000 frames a second; 0.001 to"),
        ),
        (changed(16, &[1]), "byte 16: its frames begin in block 1; a block after the header".to_owned()),
        (
            changed(6, &[4]),
            format!("byte {start}: the file holds no whole frame of 44 bytes; the header says 0 frames"),
        ),
        (
            refused(&plain[..start + 43]),
            format!("byte {start}: the file holds no whole frame of 44 bytes; the header says 3"),
        ),
        (
            changed(start + 16, &f32::INFINITY.to_le_bytes()),
            format!("byte {}: `L.ASIS` in frame 1: inf is no place of a marker; a finite", start + 16),
        ),
    ] {
        assert!(said.starts_with("walk.c3d: ") && said.contains(&wanted), "{said}\n{wanted}");
    }
    let cut = read_c3d("walk.c3d", &plain[..plain.len() - 1], None).unwrap();
    assert_eq!(cut.times.len(), 2);
    let warning = "walk.c3d: the header says 3 frames, but there are 2, which are read; was the file cut off?";
    assert_eq!(cut.warnings, [warning]);
    // Names do not matter where the first bytes tell.
    assert_eq!(read_markers("walk.trc", &plain, None).unwrap().times.len(), 3);
}

#[test]
fn cut_and_mutated_files_are_read_or_refused() {
    const SEED: u64 = 2026;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let (mut read, mut refused) = (0, 0);
    let mut attack = |bytes: &[u8]| match read_c3d("m.c3d", bytes, None) {
        Ok(markers) => {
            read += 1;
            assert!(!markers.names.is_empty() && !markers.times.is_empty());
            assert_eq!(markers.places.len(), markers.times.len());
            assert!(markers.times.iter().all(|time| (0.0..=1e9).contains(time)));
            for row in &markers.places {
                assert_eq!(row.len(), markers.names.len());
                assert!(row.iter().flatten().all(|place| place.iter().all(|x| x.abs() <= 1e9)));
            }
        }
        Err(error) => {
            refused += 1;
            assert!(error.to_string().starts_with("m.c3d: byte "), "{error}");
        }
    };
    for (kind, scale) in Kind::ALL.into_iter().flat_map(|kind| [(kind, -1.0), (kind, 0.5)]) {
        let plain = short(kind, scale).bytes();
        (0..plain.len()).for_each(|length| attack(&plain[..length]));
        let used = plain.iter().rposition(|byte| *byte != 0).unwrap();
        for _ in 0..1000 {
            let mut bytes = plain.clone();
            for _ in 0..rng.random_range(1..5) {
                // The header and the parameters, mostly.
                let at = [rng.random_range(0..24), rng.random_range(512..700), rng.random_range(0..used)];
                let at = at[rng.random_range(0..3)].min(bytes.len() - 1);
                match rng.random_range(0..5) {
                    0 => bytes[at] = rng.random_range(0..=255),
                    1 => bytes[at] = [0, 1, 127, 128, 255][rng.random_range(0..5)],
                    2 => bytes[at] ^= 1 << rng.random_range(0..8),
                    3 => bytes.truncate(at.max(1)),
                    _ => drop(bytes.drain(at..(at + rng.random_range(1..40)).min(bytes.len()))),
                }
                if bytes.is_empty() {
                    bytes.push(2);
                }
            }
            attack(&bytes);
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 500 && refused > 500, "{read}, {refused}");
}

/// Points of published files by ezc3d and by Python's c3d, as `scripts/c3d_peer.py` writes them beside the files.
#[test]
#[ignore = "needs CONTRAPPOSTO_C3D: a folder of C3D files, with points that scripts/c3d_peer.py wrote beside them"]
fn points_of_published_files_are_those_of_other_readers() {
    /// Rounding of places of up to 10 m, m.
    const SAME_PLACE: f64 = 1e-14;
    /// Rounding of places by Python's c3d, which keeps them as reals of 32 bits, m.
    const SAME_SINGLE_PLACE: f64 = 1e-6;
    let folder = PathBuf::from(std::env::var_os("CONTRAPPOSTO_C3D").unwrap());
    let (mut files, mut points, mut gaps, mut largest) = (0, 0, 0, 0.0_f64);
    let mut faults = vec![];
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("c3d"))) {
        let name = path.file_name().unwrap().to_string_lossy();
        let bytes = std::fs::read(path).unwrap();
        let Ok(peer) = std::fs::read_to_string(path.with_extension("points")) else {
            let ours = read_c3d(&name, &bytes, None);
            let ours = ours.map(|read| format!("{} markers, {} frames", read.names.len(), read.times.len()));
            println!("{name}: no other reader; {}", ours.unwrap_or_else(|error| error.to_string()));
            continue;
        };
        let mut lines = peer.lines();
        let (unit, reader) = lines.next().unwrap().split_once('\t').unwrap();
        let unit = MarkerUnit::named(unit).unwrap();
        let same_place = if reader == "by_c3d" { SAME_SINGLE_PLACE } else { SAME_PLACE };
        let labels: Vec<&str> = lines.next().unwrap().split('\t').collect();
        let read = match read_c3d(&name, &bytes, Some(unit)) {
            Ok(read) => read,
            Err(error) => {
                faults.push(error.to_string());
                continue;
            }
        };
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split('\t').map(|cell| cell.parse().unwrap()).collect()).collect();
        if read.times.len() != rows.len() {
            faults.push(format!("{name}: {} frames, {} wanted: {:?}", read.times.len(), rows.len(), read.warnings));
            continue;
        }
        let columns: Vec<usize> =
            read.names.iter().map(|label| labels.iter().position(|l| l == label).unwrap()).collect();
        let mut apart = 0;
        for (time, (row, wanted)) in read.times.iter().zip(read.places.iter().zip(&rows)) {
            apart += usize::from((time - wanted[0]).abs() > 1e-9 * wanted[0].max(1.0));
            for (place, &column) in row.iter().zip(&columns) {
                let wanted = Vector3::from_column_slice(&wanted[1 + 3 * column..4 + 3 * column]);
                let gap = wanted.iter().any(|x| x.is_nan()) || wanted == Vector3::zeros();
                points += usize::from(!gap);
                gaps += usize::from(gap);
                let apart_by = place.map_or(0.0, |place| (place - wanted * unit.metres()).norm());
                apart += usize::from(place.is_none() != gap || apart_by > same_place);
                largest = if gap { largest } else { largest.max(apart_by) };
            }
        }
        if apart > 0 {
            faults.push(format!("{name}: {apart} times, gaps or places are apart: {:?}", read.warnings));
        }
        files += 1;
    }
    println!("{files} files, {points} points, {gaps} gaps, largest difference {largest:e} m");
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(files > 0);
}
