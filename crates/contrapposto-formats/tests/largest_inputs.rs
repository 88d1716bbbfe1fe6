//! Memory and time of every reader on the largest inputs that it allows: at most 64 MiB and 1 s of processor for each MiB of input.
//!
//! The suite tries a few inputs of each kind; twenty of each, which shapes and sizes vary:
//!
//! ```text
//! CONTRAPPOSTO_LARGEST=20 cargo test --release -p contrapposto-formats largest_inputs -- --nocapture
//! ```

use std::fmt::Write;

use contrapposto::model::{Adult, adult};
use contrapposto::simulation::Run;
use contrapposto_formats::loads::external_loads;
use contrapposto_formats::motion::{MOST_NUMBERS, MOST_TABLE_BYTES, read_table};
use contrapposto_formats::xml::Limits;
use contrapposto_formats::{
    MOST_BYTES, Template, overlay, read_model, read_plan, read_pose, read_relax, read_scenario,
};

use crate::common::processor_time;

/// Inputs of each kind in the suite; `CONTRAPPOSTO_LARGEST` asks for others.
const INPUTS: usize = 5;
/// Bytes that a reader may need at a time for each byte of input, and for the first MiB.
const MOST_MEMORY: f64 = 64.0;
/// Processor time for each MiB of input, and for the first, s.
const MOST_SECONDS: f64 = 1.0;
const MEBIBYTE: f64 = (1 << 20) as f64;

/// Reads the inputs of a kind; `read` says whether an input was accepted.
pub(crate) fn is_modest<I: AsRef<[u8]>>(kind: &str, make: impl Fn(usize) -> I, read: impl Fn(&[u8]) -> bool) {
    let count = std::env::var("CONTRAPPOSTO_LARGEST").map_or(INPUTS, |text| text.parse().unwrap());
    let (mut accepted, mut worst, mut largest) = (0, [0.0_f64; 2], 0);
    for i in 0..count {
        let input = make(i);
        let input = input.as_ref();
        let before = processor_time();
        let mut is_read = false;
        let memory = allocation_counter::measure(|| is_read = read(input)).bytes_max as f64;
        let seconds = (processor_time() - before).as_secs_f64();
        let size = (input.len() as f64 / MEBIBYTE).max(1.0);
        let [memory, seconds] = [memory / size / MEBIBYTE, seconds / size];
        println!("{kind} {i}: {size:.1} MiB, accepted {is_read}, {memory:.1} MiB and {seconds:.3} s a MiB");
        assert!(memory <= MOST_MEMORY, "{kind} {i} needs {memory} MiB for each MiB");
        assert!(seconds <= MOST_SECONDS, "{kind} {i} takes {seconds} s for each MiB");
        accepted += usize::from(is_read);
        worst = [worst[0].max(memory), worst[1].max(seconds)];
        largest = largest.max(input.len());
    }
    println!(
        "{kind}: {accepted} of {count} accepted, at most {largest} bytes, {:.1} MiB and {:.3} s a MiB",
        worst[0], worst[1]
    );
    assert!(2 * accepted >= count, "{kind}: most of the largest inputs are allowed");
}

/// `piece(k)` for as many k as fit into `most` bytes and `count`.
pub(crate) fn many(most: usize, count: usize, piece: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for k in 0..count {
        let next = piece(k);
        if text.len() + next.len() > most {
            break;
        }
        text += &next;
    }
    text
}

/// Bytes of the elements of a model: its head, tail and joints need the rest.
pub(crate) fn room() -> usize {
    Limits::default().file_bytes - (1 << 19)
}

/// The parent of part k: a chain, a star, a tree of two or ten branches.
fn parent(i: usize, k: usize) -> usize {
    match (i / 5) % 4 {
        0 => k.saturating_sub(1),
        1 => 0,
        2 => k.saturating_sub(1) / 2,
        _ => k.saturating_sub(1) / 10,
    }
}

fn osim(i: usize) -> String {
    let elements = Limits::default().elements;
    let joined = |k: usize, kind: &str, more: &str| {
        let from = if k == 0 { "/ground".to_owned() } else { format!("/bodyset/b{}", parent(i, k)) };
        format!(
            "<{kind} name=\"j{k}\"><socket_parent_frame>{from}</socket_parent_frame>\
             <socket_child_frame>/bodyset/b{k}</socket_child_frame>{more}</{kind}>"
        )
    };
    let coordinate =
        |k: usize| format!("<coordinates><Coordinate name=\"q{k}\"><range>-1 1</range></Coordinate></coordinates>");
    let body = |k: usize| {
        format!(
            "<Body name=\"b{k}\"><mass>1</mass><mass_center>0 0.1 0</mass_center><inertia>1 1 1 0 0 0</inertia></Body>"
        )
    };
    let pins = |count: usize| (0..count).map(|k| joined(k, "PinJoint", &coordinate(k))).collect::<String>();
    let bodies = |count: usize| (0..count).map(body).collect::<String>();
    let (bodies, joints, forces, rest) = match i % 5 {
        // Rigidly connected bodies.
        0 => {
            let count = elements / 9 - 1;
            let joints = (0..count)
                .map(|k| if k == 0 { joined(0, "PinJoint", &coordinate(0)) } else { joined(k, "WeldJoint", "") });
            (bodies(count), joints.collect(), String::new(), String::new())
        }
        // As many coordinates as are allowed, and one long comment.
        1 => (bodies(512), pins(512), String::new(), format!("<!--{}-->", " words".repeat(room() / 6 - (1 << 16)))),
        // Elements that are ignored.
        2 => (
            bodies(2),
            pins(2),
            String::new(),
            many(room(), elements - 100, |k| format!("<VisibleObject n=\"{k}\">{}</VisibleObject>", "x".repeat(40))),
        ),
        // Splines of as many points as are allowed.
        3 => {
            let list = |scale: f64| (0..4096).map(|n| format!("{:.4} ", f64::from(n) * scale)).collect::<String>();
            let (x, y) = (list(0.001), list(0.0001));
            let joints = many(room(), 200, |k| {
                let axis = |name: &str, axis: &str, function: &str, on: &str| {
                    format!(
                        "<TransformAxis name=\"{name}\"><coordinates>{on}</coordinates><axis>{axis}</axis>{function}</TransformAxis>"
                    )
                };
                let constant = "<Constant name=\"function\"><value>0</value></Constant>";
                let spline = format!("<SimmSpline name=\"function\"><x>{x}</x><y>{y}</y></SimmSpline>");
                let own = format!("q{k}");
                let transform = [
                    axis(
                        "rotation1",
                        "0 0 1",
                        "<LinearFunction name=\"function\"><coefficients>1 0</coefficients></LinearFunction>",
                        &own,
                    ),
                    axis("rotation2", "1 0 0", constant, ""),
                    axis("rotation3", "0 1 0", constant, ""),
                    axis("translation1", "1 0 0", &spline, &own),
                    axis("translation2", "0 1 0", constant, ""),
                    axis("translation3", "0 0 1", constant, ""),
                ];
                joined(
                    k,
                    "CustomJoint",
                    &format!("{}<SpatialTransform>{}</SpatialTransform>", coordinate(k), transform.concat()),
                )
            });
            let count = joints.matches("<CustomJoint").count();
            (bodies(count), joints, String::new(), String::new())
        }
        // Muscles.
        _ => {
            let point = |name: &str, body: usize, at: &str| {
                format!(
                    "<PathPoint name=\"{name}\"><socket_parent_frame>/bodyset/b{body}</socket_parent_frame><location>{at}</location></PathPoint>"
                )
            };
            let muscle = |k: usize| {
                let (o, p) = (point("o", k % 100, "0.04 -0.3 0"), point("p", (k + 1) % 100, "0.04 0.2 0"));
                format!(
                    "<Thelen2003Muscle name=\"m{k}\"><GeometryPath><PathPointSet><objects>{o}{p}</objects></PathPointSet></GeometryPath>\
                     <max_isometric_force>500</max_isometric_force><optimal_fiber_length>0.1</optimal_fiber_length>\
                     <tendon_slack_length>0.2</tendon_slack_length></Thelen2003Muscle>"
                )
            };
            (bodies(100), pins(100), many(room(), (elements - 2000) / 13, muscle), String::new())
        }
    };
    format!(
        "<OpenSimDocument Version=\"40000\"><Model name=\"m\"><gravity>0 -9.8 0</gravity><BodySet><objects>{bodies}</objects></BodySet>\
         <JointSet><objects>{joints}</objects></JointSet><ForceSet><objects>{forces}</objects></ForceSet>{rest}</Model></OpenSimDocument>"
    )
}

fn urdf(i: usize) -> String {
    let elements = Limits::default().elements;
    let link = |k: usize| {
        format!(
            "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>"
        )
    };
    let joint = |k: usize, kind: &str| {
        format!(
            "<joint name=\"j{k}\" type=\"{kind}\"><origin xyz=\"0 0 0.1\"/><parent link=\"l{}\"/><child link=\"l{}\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/></joint>",
            parent(i, k + 1),
            k + 1
        )
    };
    let chain = |count: usize, kind: &str| (0..count).map(|k| joint(k, kind) + &link(k + 1)).collect::<String>();
    let rest = match i % 5 {
        0 => chain(elements / 9 - 1, "fixed"),
        1 => chain(512, "revolute") + &format!("<!--{}-->", " words".repeat(room() / 6 - (1 << 16))),
        2 => {
            chain(2, "revolute")
                + &many(room(), elements - 100, |k| format!("<gazebo n=\"{k}\">{}</gazebo>", "x".repeat(50)))
        }
        3 => {
            let sole = "<collision><origin xyz=\"0 0 0\"/><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>";
            format!(
                "<joint name=\"s\" type=\"revolute\"><parent link=\"l0\"/><child link=\"soles\"/><limit lower=\"-1\" upper=\"1\"/></joint>\
                     <link name=\"soles\">{}</link>",
                sole.repeat(elements / 4 - 10)
            )
        }
        _ => {
            let mimic = |k: usize| {
                joint(k, "revolute")
                    .replace("</joint>", &format!("<mimic joint=\"j{}\"/></joint>", k.saturating_sub(1)))
            };
            joint(0, "revolute") + &link(1) + &(1..elements / 11).map(|k| mimic(k) + &link(k + 1)).collect::<String>()
        }
    };
    format!("<robot name=\"r\">{}{rest}</robot>", link(0))
}

fn mjcf(i: usize) -> String {
    let elements = Limits::default().elements;
    let geom = "<geom type=\"sphere\" size=\"0.1\" mass=\"1\"/>";
    let body = |k: usize, inside: &str| format!("<body name=\"b{k}\" pos=\"0 0 0.1\">{geom}{inside}</body>");
    let hinge =
        |k: usize| format!("<joint name=\"q{k}\" type=\"hinge\" axis=\"0 1 0\" range=\"-1 1\" limited=\"true\"/>");
    let mut before = String::new();
    let mut after = String::new();
    let world = match i % 5 {
        // Rigidly connected bodies, in towers of different height.
        0 => {
            let height = [1, 8, 24, 48][(i / 5) % 4];
            let tower = |k: usize| (0..height).rev().fold(String::new(), |inside, n| body(k * height + n, &inside));
            format!("<body name=\"root\">{}{geom}{}</body>", hinge(0), many(room(), elements / 2 / height - 8, tower))
        }
        1 => {
            (0..512).map(|k| body(k, &hinge(k))).collect::<String>()
                + &format!("<!--{}-->", " words".repeat(room() / 6 - (1 << 16)))
        }
        2 => body(0, &(hinge(0) + &geom.repeat(elements - 100))),
        3 => {
            before = format!(
                "<default>{}</default>",
                many(room(), elements / 2 - 100, |k| format!(
                    "<default class=\"c{k}\"><geom size=\"0.{k}1\"/></default>"
                ))
            );
            body(0, &hinge(0))
        }
        _ => {
            let sites = |k: usize| format!("<site name=\"s{k}\" pos=\"0.01 0 0\"/>");
            let count = elements / 6;
            after = many(room() / 2, count - 100, |k| {
                format!("<spatial name=\"t{k}\"><site site=\"s{k}\"/><site site=\"s{}\"/></spatial>", k + 1)
            });
            after = format!("<tendon>{after}</tendon>");
            body(0, &hinge(0)) + &body(1, &(0..count).map(sites).collect::<String>())
        }
    };
    format!("<mujoco>{before}<worldbody>{world}</worldbody>{after}</mujoco>")
}

fn reads_model(name: &str, bytes: &[u8]) -> bool {
    match read_model(name, bytes, None, &mut |_| Err("no file".to_owned())) {
        Ok(_) => true,
        Err(error) => {
            println!("  refused: {}", error.to_string().chars().take(200).collect::<String>());
            false
        }
    }
}

#[test]
fn models_of_16_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    is_modest("osim", osim, |bytes| reads_model("m.osim", bytes));
    is_modest("urdf", urdf, |bytes| reads_model("m.urdf", bytes));
    is_modest("mjcf", mjcf, |bytes| reads_model("m.xml", bytes));
}

/// Tables near the cap of bytes or of numbers.
fn table(i: usize, ending: &str) -> String {
    let columns = [1, 3, 43, 500, 9_999][i % 5];
    let cell = ["0", "0.25", "-1.234567890123456", "1e-3"][(i / 5) % 4];
    let between = if ending == "csv" { "," } else { "\t" };
    let labels: String = (0..columns).map(|k| format!("{between}column{k}")).collect();
    let cells = format!("{between}{cell}").repeat(columns);
    let rows = (MOST_NUMBERS / (columns + 1)).min((MOST_TABLE_BYTES - (1 << 20)) / (cells.len() + 8));
    let mut text = match ending {
        "csv" => format!("time{labels}\n"),
        _ => format!("m\nnRows={rows}\nnColumns={}\ninDegrees=yes\nendheader\ntime{labels}\n", columns + 1),
    };
    for k in 0..rows {
        writeln!(text, "{k}{cells}").unwrap();
    }
    text
}

#[test]
fn tables_of_64_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    for ending in ["mot", "sto", "csv"] {
        is_modest(ending, |i| table(i, ending), |bytes| read_table(&format!("m.{ending}"), bytes).is_ok());
    }
}

/// `head`, and as many `piece`s as are allowed, filled up with a comment, an array or a long text.
fn toml(i: usize, head: &str, count: usize, piece: impl Fn(usize) -> String) -> String {
    let most = MOST_BYTES as usize - 64;
    let mut text = head.to_owned() + &many(most - head.len(), count, piece);
    let rest = most.saturating_sub(text.len());
    match i % 3 {
        0 => writeln!(text, "# {}", "x".repeat(rest)).unwrap(),
        1 => text += &"\n".repeat(rest),
        _ => text += &"# x\n".repeat(rest / 4),
    }
    text
}

fn tables_of_a_job(i: usize, k: usize) -> String {
    match i % 5 {
        0 => "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.5, 0.2, 0.1]\n".to_owned(),
        1 => "[[load]]\nsegment = \"hand_r\"\nforce_n = [0, -0.01, 0]\nat_m = [0, -0.08, 0]\n".to_owned(),
        2 => "[[load]]\nsegment = \"hand_l\"\nmass_kg = 0.001\n".to_owned(),
        3 => format!("[[obstacle]]\nname = \"o{k}\"\nmiddle_m = [3, 3, {k}]\nsize_m = [0.1, 0.1, 0.1]\n"),
        _ => format!("[[event]]\nat_s = {k}\nload = [{{ segment = \"hand_r\", mass_kg = 1 }}]\n"),
    }
}

fn count_of(i: usize) -> usize {
    if i.is_multiple_of(5) { 199 } else { 1000 }
}

#[test]
fn scenarios_and_overlays_of_1_mib_need_at_most_64_mib_and_1_s() {
    let message = |kind: &str, error: &dyn std::fmt::Display| println!("  {kind} refused: {error}");
    let events =
        |i: usize| if i % 5 == 4 { "[run]\nduration_s = 2000\nstep_s = 1\n" } else { "[run]\nduration_s = 1\n" };
    let run = |i: usize| {
        let head = format!("format = 1\ntitle = \"t\"\n[strategy]\nkind = \"active\"\n{}", events(i));
        toml(i, &head, count_of(i), |k| tables_of_a_job(i, k))
    };
    is_modest("scenario", run, |bytes| {
        read_scenario("s.toml", bytes, None).inspect_err(|error| message("scenario", error)).is_ok()
    });
    let no_events = |i: usize| if i % 5 == 4 { 0 } else { i };
    let asked = "format = 1\n[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.5, 0.2, 0.1]\n";
    let posed = |i: usize| toml(i, asked, count_of(no_events(i)), |k| tables_of_a_job(no_events(i), k));
    is_modest("pose", posed, |bytes| {
        read_pose("s.toml", bytes, None).inspect_err(|error| message("pose", error)).is_ok()
    });
    let relaxed = |i: usize| {
        let head = "format = 1\n[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
        toml(i, head, count_of(no_events(i)) - 2, |k| tables_of_a_job(no_events(i), k))
    };
    is_modest("relax", relaxed, |bytes| {
        read_relax("s.toml", bytes, None).inspect_err(|error| message("relax", error)).is_ok()
    });
    let body = adult(&Adult::default()).unwrap();
    let laid = |i: usize| {
        let points = [2, 100, 1_000, 10_000, 20_000][i % 5];
        let table: String = (0..points)
            .map(|k| {
                format!(
                    "[{:.5},{:.5}],",
                    -70.0 + 140.0 * k as f64 / points as f64,
                    20.0 - 40.0 * k as f64 / points as f64
                )
            })
            .collect();
        let head = format!(
            "[coordinates.wrist_flex_r]\nrange_deg = [-70, 69]\npassive = {{ table_deg_nm = [{table}[70, -21]] }}\n"
        );
        toml(i, &head, 0, |_| String::new())
    };
    is_modest("overlay", laid, |bytes| {
        overlay("o.toml", bytes, body.clone()).inspect_err(|error| message("overlay", error)).is_ok()
    });
}

/// A plan of 64 parameters, or of fewer with long lists or names.
fn plan(i: usize) -> String {
    let head = |design: &str, rows: &str| format!("base = \"a.toml\"\ndesign = \"{design}\"\n{rows}[parameters]\n");
    let long = |k: usize| format!("{k:02}{}", "k".repeat(8_000));
    let correlated = |k: usize| {
        let others = (0..k).map(|other| format!("p{other} = 0.01,")).collect::<String>();
        format!("p{k} = {{ range = [0, 1], correlate = {{ {} }} }}\n", others.trim_end_matches(','))
    };
    match i % 5 {
        0 => {
            let list = ["0,", "true,", "0.5, ", "\"\","][(i / 5) % 4];
            // As many values as are allowed, or more.
            let count = if i < 10 { 58_000 } else { (1 << 20) / list.len() - 99 };
            head("random", "rows = 1000\n") + &format!("p = {{ list = [{}0] }}\n", list.repeat(count))
        }
        1 => toml(i / 5, &head("random", "rows = 10_000_000\n"), 64, correlated),
        2 => toml(i / 5, &head("grid", ""), 64, |k| format!("p{k} = {{ list = [\"{}\"] }}\n", "text".repeat(3_000))),
        3 => toml(i / 5, &head("sobol", "rows = 1000\n"), 64, |k| format!("{} = {{ range = [0, 1] }}\n", long(k))),
        // A misspelt name among long ones.
        _ => {
            let last = format!("x = {{ range = [0, 1], correlate = {{ {}k = 0.1 }} }}\n", long(0));
            toml(i / 5, &head("sobol", "rows = 1000\n"), 64, |k| match k {
                63 => last.clone(),
                _ => format!("{} = {{ range = [0, 1] }}\n", long(k)),
            })
        }
    }
}

#[test]
fn plans_and_their_scenarios_of_1_mib_need_at_most_64_mib_and_1_s() {
    is_modest("plan", plan, |bytes| {
        read_plan("p.toml", bytes).inspect_err(|error| println!("  plan refused: {error:.200}")).is_ok()
    });
    let keys: Vec<String> = (0..64)
        .map(|k| match k % 4 {
            0 => format!("load.{k}.mass_kg"),
            1 => format!("run.key{k}"),
            2 => format!("new{}.{}.key", k % 8, "long.".repeat(1_000).trim_end_matches('.')),
            _ => format!("key{k}"),
        })
        .collect();
    let make = |i: usize| {
        let head = "format = 1\n[run]\nduration_s = 1\n".to_owned() + &"[[load]]\nmass_kg = 1\n".repeat(64);
        let numbers = |number: &str| format!("{head}numbers = [{}0]\n", number.repeat(30_000));
        match i % 5 {
            0 => numbers(["0,", "0.5,", "true,", "\"\","][(i / 5) % 4]),
            1 => numbers(["[],", "[0],", "{},", "{a=0},"][(i / 5) % 4]),
            2 => toml(i / 5, &head, 58_000, |k| format!("[t{k}]\n")),
            3 => toml(i / 5, &head, 58_000, |k| format!("k{k}=0\n")),
            _ => toml(i / 5, &head, 900, |k| tables_of_a_job(i / 5, k)),
        }
    };
    is_modest("template", make, |bytes| {
        let template = Template::new("s.toml", bytes, keys.iter().map(String::as_str));
        template.inspect_err(|error| println!("  template refused: {error:.200}")).is_ok()
    });
}

#[test]
fn external_loads_of_16_mib_need_at_most_64_mib_and_1_s_for_each_mib() {
    let elements = Limits::default().elements;
    let make = |i: usize| {
        let count = [elements / 6 - 10, 10, 1000, elements / 12, 100][i % 5];
        let force = |k: usize| {
            format!(
                "<ExternalForce name=\"f{k}\"><applied_to_body>calcn_r</applied_to_body><force_identifier>f{k}_v</force_identifier>\
                 <point_identifier>f{k}_p</point_identifier><torque_identifier>f{k}_m</torque_identifier></ExternalForce>"
            )
        };
        let forces = many(room() / 2, count, force);
        let rest = many(room() / 2, elements - 6 * count.min(elements / 6) - 10, |k| {
            format!("<e n=\"{k}\">{}</e>", "x".repeat(30))
        });
        let rest = if rest.is_empty() { format!("<!--{}-->", "x".repeat(room() / 2)) } else { rest };
        format!(
            "<OpenSimDocument><ExternalLoads><objects>{forces}</objects><datafile>f.mot</datafile>{rest}</ExternalLoads></OpenSimDocument>"
        )
    };
    is_modest("ExternalLoads", make, |bytes| external_loads(bytes).is_ok());
}

/// The solver's memory grows with the square of the number of tasks, which are at most 80.
#[test]
fn a_run_with_as_many_tasks_as_are_allowed_needs_at_most_64_mib() {
    let tasks: String = (0..80).map(|_| tables_of_a_job(0, 0)).collect();
    let feet = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
    let text = format!("format = 1\n[strategy]\nkind = \"active\"\n{feet}{tasks}[run]\nduration_s = 1\nstep_s = 0.1\n");
    let scenario = read_scenario("s.toml", text.as_bytes(), None).unwrap();
    let memory = allocation_counter::measure(|| {
        let mut run = Run::new(&scenario).unwrap();
        while run.next_sample().unwrap().is_some() {}
    });
    let memory = memory.bytes_max as f64 / MEBIBYTE;
    println!("80 tasks: {memory:.1} MiB");
    assert!(memory <= MOST_MEMORY);
}
