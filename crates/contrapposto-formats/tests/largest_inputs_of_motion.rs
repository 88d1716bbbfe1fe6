//! Memory and time of the readers of markers, rigs, lines of problems and snapshots on the largest inputs that they allow, as in
//! `largest_inputs`.

use std::fmt::Write;

use contrapposto::simulation::{Run, Snapshot, Tables};
use contrapposto_formats::markers::{
    MarkerUnit, marker_set, read_force_plates, read_markers, scale_setup, tracking_tasks,
};
use contrapposto_formats::motion::MOST_TABLE_BYTES;
use contrapposto_formats::rigs::{Rig, read_bvh, read_gltf, read_rig_names};
use contrapposto_formats::xml::Limits;
use contrapposto_formats::{MOST_BYTES, MOST_LINE_BYTES, minimize_line, read_scenario};
use serde_json::{Value, json};

use crate::common::c3d::{Kind, Trial};
use crate::largest_inputs::{is_modest, many, room};

/// Whether a file was read; says why not.
fn told<T, E: std::fmt::Display>(read: Result<T, E>) -> bool {
    read.inspect_err(|error| println!("  refused: {error:.200}")).is_ok()
}

/// Rows near the cap of bytes, or `count` of them.
fn rows(mut head: String, count: usize, row: &str) -> String {
    let count = count.min((MOST_TABLE_BYTES - head.len()) / row.len());
    head.extend(std::iter::repeat_n(row, count));
    head
}

/// Markers of so many frames as their numbers allow.
fn trc(i: usize) -> String {
    let head = |markers: usize| {
        let names: String = (0..markers).map(|k| format!("\tm{k}\t\t")).collect();
        format!("Units\nmm\nFrame#\tTime{names}\n")
    };
    let frames = |markers: usize| 3_333_333 / markers;
    match i % 5 {
        // One marker without places.
        0 => rows(head(1), frames(1), "\t0\n"),
        1 => rows(head(3_333), frames(3_333), &format!("\t0{}\n", "\t1".repeat(3 * 3_333))),
        // Long numbers.
        2 => rows(head(40), frames(40), &format!("1\t0.01{}\n", "\t-1234.5".repeat(120))),
        3 => format!("Units{0}\nmm{0}\n{1}1\t0\t1\t2\t3\n", "\t".repeat((31 << 20) - 99), head(1)),
        // Rows that leave out all places.
        _ => rows(head([3_333, 1_000, 300, 100][(i / 5) % 4]), 3_333, "\t0\n"),
    }
}

/// A trial of as many points or frames as are allowed.
fn c3d(i: usize) -> Vec<u8> {
    let (points, frames) = [(3_333, 1_000), (1, 3_300_000), (40, 80_000), (300, 11_000), (3_333, 1)][i % 5];
    let labels: Vec<String> = (0..points).map(|point| format!("m{point}")).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let frame = |k: usize| vec![[k as f64 % 1e3, 1.0, 2.0, 0.0]; points];
    let scale = if (i / 5).is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut trial = Trial::new(Kind::ALL[i % 3], scale, &labels, (0..frames).map(frame).collect());
    trial.ends = (1, frames.min(65_535) as u16);
    trial.samples = 0;
    let end = vec![(frames % 65_536) as u16, (frames / 65_536) as u16];
    trial.words = vec![(2, "ACTUAL_START_FIELD", vec![1, 0]), (2, "ACTUAL_END_FIELD", end)];
    trial.bytes()
}

/// A parameter of a C3D file: group (3 ANALOG, 4 FORCE_PLATFORM), name, bytes of a number, dimensions, data; where the data are empty, they are the
/// bytes that follow.
type Parameter<'a> = (i8, String, i8, &'a [u8], &'a [u8]);

/// A C3D file of 16-bit numbers of Intel computers. Of each frame: samples, and those of a channel.
fn bare_c3d(parameters: &[Parameter<'_>], [frames, samples, per_channel]: [usize; 3]) -> Vec<u8> {
    let mut section = vec![1, 0x50, 0, 84];
    for (id, name) in [(1, "POINT"), (3, "ANALOG"), (4, "FORCE_PLATFORM")] {
        section.extend([name.len() as u8, (256 - id) as u8]);
        section.extend(name.as_bytes());
        section.extend([3, 0, 0]);
    }
    for (id, name, kind, dimensions, data) in parameters {
        section.extend([name.len() as u8, *id as u8]);
        section.extend(name.as_bytes());
        section.extend(((4 + dimensions.len() + data.len()) as u16).to_le_bytes());
        section.extend([*kind as u8, dimensions.len() as u8]);
        section.extend(*dimensions);
        section.extend(*data);
    }
    section.resize((section.len() + 2).next_multiple_of(512), 0);
    let mut bytes = vec![2, 0x50];
    let start = 2 + section.len() / 512;
    let last = frames.min(65_535);
    for word in [0, samples, 1, last] {
        bytes.extend((word as u16).to_le_bytes());
    }
    bytes.extend([0, 0]);
    bytes.extend(1_f32.to_le_bytes());
    bytes.extend((start as u16).to_le_bytes());
    bytes.extend((per_channel as u16).to_le_bytes());
    bytes.extend(50_f32.to_le_bytes());
    bytes.resize(512, 0);
    bytes.extend(section);
    bytes.extend(std::iter::repeat_n([1, 0], frames * samples).flatten());
    bytes
}

/// Force plates of a type, each with its own channels, or all with the first ones.
fn plates(count: usize, kind: i16, own: bool, per_channel: usize, frames: usize) -> Vec<u8> {
    let width = if kind == 3 { 8 } else { 6 };
    let words = |numbers: Vec<i16>| numbers.into_iter().flat_map(i16::to_le_bytes).collect::<Vec<u8>>();
    let reals = |numbers: Vec<f32>| numbers.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let channels = (0..count * width).map(|k| if own { k as i16 + 1 } else { 1 }).collect();
    let corners = [1.0, 1.0, 0.0, -1.0, 1.0, 0.0, -1.0, -1.0, 0.0, 1.0, -1.0, 0.0_f32].repeat(count);
    let turned: Vec<f32> = (0..36 * count).map(|k| f32::from(u8::from(k % 36 % 7 == 0))).collect();
    let (plates, of_each) = (count as u8, if own { count * width } else { 1 });
    let parameters = [
        (4, "USED", 2, vec![], words(vec![count as i16])),
        (4, "TYPE", 2, vec![plates], words(vec![kind; count])),
        (4, "CORNERS", 4, vec![3, 4, plates], reals(corners)),
        (4, "ORIGIN", 4, vec![3, plates], reals(vec![0.1; 3 * count])),
        (4, "CAL_MATRIX", 4, vec![6, 6, plates], reals(turned)),
        (4, "CHANNEL", 2, vec![width as u8, plates], words(channels)),
        (3, "UNITS", -1, vec![255, 1], vec![b'N'; 255]),
    ];
    let parameters: Vec<_> = parameters
        .iter()
        .map(|(id, name, kind, dimensions, data)| {
            (*id, (*name).to_owned(), *kind, dimensions.as_slice(), data.as_slice())
        })
        .collect();
    bare_c3d(&parameters, [frames, of_each * per_channel, per_channel])
}

/// Force plates of as many numbers as are allowed, and parameters that share their bytes.
fn force_plates(i: usize) -> Vec<u8> {
    match i % 5 {
        0 => plates(64, 2, true, 65_535 / 384, 26_041 / 170),
        1 => plates(1, [1, 2, 3, 4][(i / 5) % 4], true, 1000, 1_666),
        2 => plates(16, [4, 3, 2, 1][(i / 5) % 4], true, 1, 65_535),
        // All plates have one channel.
        3 => plates(64, [1, 2, 3, 4][(i / 5) % 4], false, 26_041, 1),
        _ => {
            let names = (1..=257).map(|part| if part == 1 { String::new() } else { part.to_string() });
            let lists: Vec<Parameter<'_>> = names
                .flat_map(|part| {
                    let units = (3, format!("UNITS{part}"), -1, &[1, 255, 255, 15][..], &[][..]);
                    [units, (3, format!("SCALE{part}"), 1, &[255, 255, 15], &[])]
                })
                .collect();
            bare_c3d(&lists, [8, 65_535, 1])
        }
    }
}

#[test]
fn markers_of_64_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    is_modest("trc", trc, |bytes| told(read_markers("m.trc", bytes, None)));
    is_modest("c3d", c3d, |bytes| told(read_markers("m.c3d", bytes, None)));
    let unit = Some(MarkerUnit::Millimetre);
    is_modest("force plates", force_plates, |bytes| told(read_force_plates("m.c3d", bytes, unit)));
}

/// Objects in a set of a setup file, filled up with a comment.
fn set(head: &str, object: impl Fn(usize) -> String, elements: usize, tail: &str) -> String {
    let objects = many(room(), (Limits::default().elements - 20) / elements, object);
    let rest = "x".repeat(room().saturating_sub(objects.len()));
    format!("<OpenSimDocument>{head}<objects>{objects}</objects>{tail}<!--{rest}--></OpenSimDocument>")
}

#[test]
fn setup_files_of_16_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    let bodies: Vec<String> = (0..20_000).map(|k| format!("body{k}")).collect();
    let markers = |i: usize| {
        let last = |k: usize| format!("<Marker name=\"m{k}\"><body>body19999</body></Marker>");
        let first =
            |k: usize| format!("<Marker name=\"m{k}\"><body>body{}</body><location>1 2 3</location></Marker>", k % 9);
        let named = |k: usize| format!("<Marker name=\"{k:0150}\"><body>ground</body></Marker>");
        let full = |k: usize| {
            let more = "<x/>".repeat(90_000);
            format!("<Marker name=\"m{k}\">{more}<socket_parent_frame>/bodyset/body1</socket_parent_frame></Marker>")
        };
        let stranger = |k: usize| format!("<Marker name=\"m{k}\"><body>body2000O</body></Marker>");
        match i % 5 {
            0 => set("<MarkerSet>", last, 2, "</MarkerSet>"),
            1 => set("<MarkerSet>", first, 3, "</MarkerSet>"),
            2 => set("<MarkerSet>", named, 2, "</MarkerSet>"),
            3 => set("<MarkerSet>", full, 90_002, "</MarkerSet>"),
            _ => set("<MarkerSet>", stranger, 2, "</MarkerSet>"),
        }
    };
    is_modest("marker set", markers, |bytes| told(marker_set("m.xml", bytes, &bodies)));
    let tasks = |i: usize| {
        let bare = |k: usize| format!("<IKMarkerTask name=\"m{k:06}\"/>");
        let weighed = |k: usize| format!("<IKMarkerTask name=\"m{k}\"><weight>1</weight></IKMarkerTask>");
        let valued = |k: usize| {
            format!(
                "<IKCoordinateTask name=\"m{k:06}\"><value_type>manual_value</value_type><value>1</value></IKCoordinateTask>"
            )
        };
        let coordinate = |k: usize| format!("<IKCoordinateTask name=\"m{k:06}\"/>");
        let full = |k: usize| format!("<IKMarkerTask name=\"m{k}\">{}</IKMarkerTask>", "<x/>".repeat(9_999));
        match i % 5 {
            0 => set("<IKTaskSet>", bare, 1, "</IKTaskSet>"),
            1 => set("<IKTaskSet>", weighed, 2, "</IKTaskSet>"),
            2 => set("<IKTaskSet>", valued, 3, "</IKTaskSet>"),
            3 => set("<IKTaskSet>", coordinate, 1, "</IKTaskSet>"),
            _ => set("<IKTaskSet>", full, 10_000, "</IKTaskSet>"),
        }
    };
    is_modest("tasks", tasks, |bytes| told(tracking_tasks("t.xml", bytes)));
    let setups = |i: usize| {
        let ends =
            |set: &str| (format!("<ScaleTool><ModelScaler><{set}>"), format!("</{set}></ModelScaler></ScaleTool>"));
        let in_set = |set_name: &str, object: &dyn Fn(usize) -> String, elements: usize| {
            let (head, tail) = ends(set_name);
            set(&head, object, elements, &tail)
        };
        let pair = "<MarkerPair><markers>a b</markers></MarkerPair>";
        let pairs = |count: usize| format!("<MarkerPairSet><objects>{}</objects></MarkerPairSet>", pair.repeat(count));
        match i % 5 {
            0 => in_set("MeasurementSet", &|k| format!("<Measurement name=\"m{k}\">{}</Measurement>", pairs(1)), 5),
            1 => in_set(
                "MeasurementSet",
                &|k| format!("<Measurement name=\"m{k}\">{}</Measurement>", pairs(90_000)),
                180_003,
            ),
            2 => in_set("MeasurementSet", &|_| "<Measurement/>".to_owned(), 1),
            3 => in_set("ScaleSet", &|k| format!("<Scale><segment>b{k}</segment><scales>1 2 3</scales></Scale>"), 3),
            _ => {
                let (head, tail) = ("<ScaleTool><MarkerPlacer><IKTaskSet>", "</IKTaskSet></MarkerPlacer></ScaleTool>");
                set(head, |k| format!("<IKMarkerTask name=\"m{k:06}\"/>"), 1, tail)
            }
        }
    };
    is_modest("scale setup", setups, |bytes| told(scale_setup("s.xml", bytes)));
}

/// A chain of joints with so many channels each, up to 12.
fn chain(joints: usize, channels: usize) -> String {
    let names =
        ["Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"].repeat(2)[..channels].join(" ");
    let one = |k: usize| {
        format!("{} j{k} {{\nOFFSET 0 1 0\nCHANNELS {channels} {names}\n", if k == 0 { "ROOT" } else { "JOINT" })
    };
    let all: String = (0..joints).map(one).collect();
    format!("HIERARCHY\n{all}{}\nMOTION\nFrames: 1\nFrame Time: 0.01\n", "}".repeat(joints))
}

/// Joints, channels and frames up to their caps.
fn bvh(i: usize) -> String {
    match i % 5 {
        // Memory of a list grows by doubling.
        0 => rows(chain(1, 1), [8_388_609, 10_000_000, 4_194_305, 9_000_000][(i / 5) % 4], "0\n"),
        1 => rows(chain(2_000, 12), 416, &("0 ".repeat(24_000) + "\n")),
        2 => rows(chain(46, 6), 36_231, &("-12.3456 ".repeat(276) + "\n")),
        3 => {
            let ends = "End {OFFSET 0 0 0}".repeat((MOST_TABLE_BYTES - (1 << 20)) / 18);
            chain(2_000, 1).replacen('}', &(ends + "}"), 1) + &"0 ".repeat(2_000)
        }
        _ => chain(2_000, 1) + &(" ".repeat(MOST_TABLE_BYTES - (1 << 20)) + &"0 ".repeat(2_000)),
    }
}

/// A binary glTF file.
fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data) in [(b"JSON", json.as_bytes()), (b"BIN\0", buffer)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    bytes
}

/// Nodes that turn by keys of one or of own accessors: bytes at an offset and their stride, number of keys, and last time.
fn animated(nodes: usize, keys: usize, end: f32, shared: bool, more: &str) -> Vec<u8> {
    let list = |text: &dyn Fn(usize) -> String, count: usize| (0..count).map(text).collect::<Vec<_>>().join(",");
    let all_nodes = list(&|k| format!(r#"{{"name":"joint {k}"}}"#), nodes);
    let samplers = list(&|k| format!(r#"{{"input":0,"output":{}}}"#, k + 1), nodes);
    let channels = list(&|k| format!(r#"{{"sampler":{k},"target":{{"node":{k},"path":"rotation"}}}}"#), nodes);
    let turns = list(
        &|k| {
            let place = if shared { 0 } else { 16 * keys * k };
            format!(r#"{{"bufferView":1,"byteOffset":{place},"componentType":5126,"count":{keys},"type":"VEC4"}}"#)
        },
        nodes,
    );
    let stride = if shared { r#","byteStride":0"# } else { "" };
    let mut buffer: Vec<u8> =
        (0..keys).flat_map(|k| (end * k as f32 / (keys - 1).max(1) as f32).to_le_bytes()).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{all_nodes}],"animations":[{{"samplers":[{samplers}],"channels":[{channels}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{keys},"type":"SCALAR"}},{turns}],
        "bufferViews":[{{"buffer":0}},{{"buffer":0,"byteOffset":{}{stride}}}],"buffers":[{{}}]{more}}}"#,
        buffer.len()
    );
    let turn = [0.0_f32, 0.6, 0.0, 0.8].map(f32::to_le_bytes).concat();
    buffer.extend(turn.repeat(if shared { 1 } else { keys * nodes }));
    glb(&json, &buffer)
}

/// Keys, frames, nodes and other values up to their caps.
fn gltf(i: usize) -> Vec<u8> {
    let junk = |piece: &str, bytes: usize| format!(r#","extras":[{}0]"#, piece.repeat(bytes / piece.len()));
    match i % 5 {
        0 => animated(60, 27_000, 900.0, false, ""),
        1 => animated([1, 60, 1_000, 10_000][(i / 5) % 4], 2, [100.0, 100.0, 10.0, 1.0][(i / 5) % 4], false, ""),
        2 => animated(
            60,
            30,
            1.0,
            false,
            &junk([r#"{"":0},"#, "[0],", "0,", r#"{"":[{}]},"#][(i / 5) % 4], (1 << 24) + 99),
        ),
        // Few keys far apart.
        3 => animated([1, 60, 300, 1_000][(i / 5) % 4], 2, [160_000.0, 2_700.0, 550.0, 160.0][(i / 5) % 4], false, ""),
        // Many keys that are one.
        _ => animated([1, 4, 40, 400][(i / 5) % 4], [1_999_999, 400_000, 40_000, 4_000][(i / 5) % 4], 10.0, true, ""),
    }
}

#[test]
fn rigs_of_64_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    is_modest("bvh", bvh, |bytes| told(read_bvh("a.bvh", bytes)));
    is_modest("gltf", gltf, |bytes| told(read_gltf("a.glb", bytes)));
}

/// A rig of joints with long names.
fn long_named() -> Rig {
    let names: String = (0..9_999).map(|k| format!(r#"{{"name":"{k:0254}"}},"#)).collect();
    let json = String::from_utf8_lossy(&animated(1, 2, 1.0, false, "")[20..]).into_owned();
    let (json, _) = json.split_once("BIN").unwrap();
    let json = json[..json.len() - 4].replace(
        r#"{"name":"joint 0"}"#,
        &format!(
            r#"{names}{{"name":"hips","children":[{}]}}"#,
            (0..9_999).map(|k| k.to_string()).collect::<Vec<_>>().join(",")
        ),
    );
    let json = json.replace(r#""node":0"#, r#""node":9999"#);
    let buffer = [0.0_f32, 1.0, 0.0, 0.6, 0.0, 0.8, 0.0, 0.6, 0.0, 0.8].map(f32::to_le_bytes).concat();
    read_gltf("a.glb", &glb(&json, &buffer)).unwrap()
}

#[test]
fn names_of_rigs_of_1_mib_need_at_most_64_mib_and_1_s() {
    let rig = long_named();
    assert_eq!(rig.joints.len(), 10_000);
    let make = |i: usize| {
        let named = ["pelvis", "torso", "femur_r", "hand_l"]
            .map(|segment| format!("{segment} = \"{:0254}\"\n", 9_998))
            .concat();
        let rest = MOST_BYTES as usize - 4_096;
        match i % 5 {
            0 => format!("{named}# {}", "x".repeat(rest)),
            1 => named + &"\n".repeat(rest),
            2 => named + &"# x\n".repeat(rest / 4),
            // A name that is none.
            3 => format!("{named}hand_r = \"{:0253}\"\n", 99_999),
            _ => format!("{named}hand_r = \"{}\"\n", "x".repeat(rest)),
        }
    };
    is_modest("names of a rig", make, |bytes| told(read_rig_names("r.toml", bytes, &rig)));
}

#[test]
fn lines_of_problems_need_at_most_64_mib_and_1_s_for_each_mib() {
    let problem = |k: usize, blanks: usize, digits: usize| {
        let angle = 7 * k % 150;
        let load = (k % 37) as f64 - 18.5;
        let (blanks, digits) = (" ".repeat(blanks), "3".repeat(digits));
        let strategy = if k.is_multiple_of(2) { "active" } else { "passive" };
        format!(
            "{{{blanks}\"passive\":{{\"lower\":{{\"torque_nm\":12.5{digits},\"rate_per_rad\":19.9,\"angle_deg\":0}},\
             \"upper\":{{\"torque_nm\":9.3,\"rate_per_rad\":3.8,\"angle_deg\":150}}}},\"range_deg\":[0,150],\"angle_deg\":{angle},\
             \"external_nm\":{load},\"external_slope_nm_per_rad\":0.9,\"strategy\":\"{strategy}\",\"minimum_decrease_ratio\":0.9,\
             \"tolerance_nm\":0.05}}\n"
        )
    };
    let rest = MOST_LINE_BYTES - 600;
    let make = |i: usize| {
        let line = |k: usize| match i % 5 {
            0 => problem(k, 0, 0),
            1 => problem(k, rest, 0),
            2 => problem(k, 0, rest),
            3 => problem(k, k % rest, 40),
            _ => format!("{}\n", ["[", "{\"x\":", "9", "\"\\u00e9"][(i / 5) % 4].repeat(rest / 6)),
        };
        many(1 << 20, usize::MAX, line)
    };
    is_modest("problems", make, |bytes| {
        let lines = std::str::from_utf8(bytes).unwrap().lines();
        let refused = lines.filter(|line| minimize_line(line, Tables::Total).is_err()).count();
        refused == 0
    });
}

/// The head of a scenario of one joint.
const ONE_JOINT: &str = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.741, mass_kg = 73, part = \"right_arm\" }\n\
[coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 100\nstep_s = 0.1\n";

/// The memory for each byte does not depend on the size: lists of 24 MiB stand for those of 256 MiB, the program's cap.
#[test]
fn snapshots_need_at_most_64_mib_and_1_s_for_each_mib() {
    let scenario = read_scenario("s.toml", ONE_JOINT.as_bytes(), None).unwrap();
    let start: Value = serde_json::to_value(Run::new(&scenario).unwrap().snapshot()).unwrap();
    let posture = json!({ "values": vec![0; start["state"]["posture"]["values"].as_array().unwrap().len()] });
    let record =
        json!([0, "Positive", 0, "Active", "Strategy", null, [0, 0], [0, 0], [0, 0], 0, 0, 0, 0, 0, 0]).to_string();
    // A list, and an entry of which it gets many.
    let lists = [
        ("/state/decisions", "null".to_owned()),
        ("/state/minima", posture.to_string()),
        ("/reliefs/records", record),
        ("/coordinates/0/cases", "\"C34\"".to_owned()),
        ("/errors/last", "0".to_owned()),
        ("/state/in_use", "0".to_owned()),
        ("/reliefs/open", "null".to_owned()),
        ("/coordinates/0/loads/0/pieces", "[0,0]".to_owned()),
        ("/errors/counted", "0".to_owned()),
        ("/state/active", "0".to_owned()),
    ];
    let make = |i: usize| {
        let (list, entry) = &lists[i % lists.len()];
        let mut snapshot = start.clone();
        *snapshot.pointer_mut(list).unwrap() = json!("HERE");
        // A list grows by doubling: its memory is the greatest just above a power of two.
        let count = ((24 << 20) / (entry.len() + 1)).next_power_of_two() / 2 + 1;
        let mut entries = entry.clone();
        (1..count).for_each(|_| write!(entries, ",{entry}").unwrap());
        snapshot.to_string().replace("\"HERE\"", &format!("[{entries}]"))
    };
    is_modest("snapshot", make, |bytes| {
        let snapshot = serde_json::from_slice::<Snapshot>(bytes);
        let resumed = snapshot.map_err(|error| error.to_string());
        told(resumed.and_then(|snapshot| Run::resume(&scenario, snapshot).map(drop).map_err(|error| error.to_string())))
    });
}
