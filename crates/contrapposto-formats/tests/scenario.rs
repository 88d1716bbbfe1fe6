//! The scenario reader is total: any bytes give an experiment or a complaint, never a panic; and what it accepts runs without
//! a number that is not finite.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::Path;
use std::time::Instant;

use contrapposto::simulation::{Sample, Scenario, run};
use contrapposto_formats::{csv_header, csv_row, read_scenario};

const SEED: u64 = 20_070_902;

/// Mutated texts a run; `CONTRAPPOSTO_MUTANTS` asks for more.
const MUTANTS: usize = 20_000;

/// Every scenario of the repository that runs over time, and one with every table a scenario may have.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file()); // poses have a folder of their own
    paths.sort();
    let mut texts: Vec<String> = paths.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    assert!(texts.len() >= 10);
    texts.push(FULL.to_owned());
    texts
}

const FULL: &str = r#"format = 1
title = "Every table"
[model]
adult = { sex = "female", stature_m = 1.65, mass_kg = 60, part = "right_arm", lengths_m = { humerus = 0.31 } }
[passive]
elbow_flex_r = { double_exponential = { lower = { torque_nm = 12.67, rate_per_rad = 19.92, angle_deg = 0.5 }, upper = { torque_nm = 9.324, rate_per_rad = 3.811, angle_deg = 150 }, stiffness_nm_per_rad = 0.4, neutral_deg = 73 }, reshape = { zone_deg = 5, end_torque_nm = 20 } }
wrist_flex_r = { coordinate_limit_force = { upper_stiffness_nm_per_deg = 1.5, upper_limit_deg = 60, lower_stiffness_nm_per_deg = 1.2, lower_limit_deg = -50, transition_deg = 8 } }
wrist_dev_r = { table_deg_nm = [[-20, 3.5], [-10, 0.5], [15, -0.6], [30, -4.5]], reshape = true }
[posture]
arm_flex_r_deg = 60
elbow_flex_r_deg = 90
[coordinates]
locked = ["arm_rot_r"]
[[load]]
segment = "hand_r"
mass_kg = 2
[[load]]
segment = "ulna_r"
force_n = [3, -20, 1]
at_m = [0.01, -0.08, 0.02]
fixed_in = "segment"
[strategy]
kind = "passive"
minimum_decrease_ratio = 0.9
[relief]
step_gain = 0.3
max_step_deg = 2
torque_tolerance_nm = 0.05
tables = "total"
[fatigue]
law = "endurance"
curve = "rohmert_general"
critical_level = 0.6
recovery_level = 0.3
start = { elbow_flex_r = { positive = 0.7, negative = 0.1 }, arm_flex_r = { positive = 0.8 } }
[run]
duration_s = 2
step_s = 0.0333
stop_when_settled = false
"#;

/// Runs at most a second of it; every number of every sample must be finite, in memory and as written.
fn assert_sound(mut scenario: Scenario, told: &dyn Fn() -> String) {
    scenario.run.duration = scenario.run.duration.min(1.0);
    scenario.run.step = scenario.run.step.max(scenario.run.duration / 40.0);
    let columns = csv_header(&scenario.model).split(',').count();
    let mut row = String::new();
    let summary = run(&scenario, |sample: &Sample| {
        row.clear();
        csv_row(&scenario.model, sample, &mut row);
        assert_eq!(row.trim_end().split(',').count(), columns);
        for (at, cell) in row.trim_end().split(',').enumerate() {
            let number: f64 = if cell.is_empty() { 0.0 } else { cell.parse().unwrap() };
            assert!(number.is_finite(), "column {at}: {cell}\n{}", told());
        }
        assert!(sample.load.iter().all(|load| load.is_finite()), "load\n{}", told());
        for (&value, coordinate) in sample.posture.iter().zip(scenario.model.coordinates()) {
            assert!(value >= coordinate.range.0 && value <= coordinate.range.1, "{}\n{}", coordinate.name, told());
        }
        for (&level, torques) in sample.fatigue.iter().flatten().zip(sample.active.iter().flat_map(|t| [t, t])) {
            assert!((0.0..=1.0).contains(&level) && torques.is_finite(), "fatigue {level}\n{}", told());
        }
    });
    let summary = summary.unwrap_or_else(|error| panic!("{error}\n{}", told()));
    assert!(summary.end_time.is_finite() && summary.samples > 0);
}

/// Complaints are printed, too: that must not panic either.
fn complaint(error: contrapposto_formats::InputError) -> String {
    let mut text = String::new();
    miette::NarratableReportHandler::new().render_report(&mut text, &error).unwrap();
    text
}

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `end`, which is not 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn byte(&mut self) -> u8 {
        self.next().to_le_bytes()[7]
    }

    /// In 0..1.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What strangers write instead of a number.
const ODD: [&str; 22] = [
    "nan",
    "-inf",
    "inf",
    "1e999",
    "1e308",
    "-1e308",
    "1e300",
    "1e150",
    "1e16",
    "-0.0",
    "0",
    "5e-324",
    "1e-300",
    "-1",
    "0.5",
    "1",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fff",
    "\"1\"",
    "[]",
];

fn mutated(texts: &[String], random: &mut Random) -> Vec<u8> {
    let mut bytes = texts[random.below(texts.len())].clone().into_bytes();
    for _ in 0..1 + random.below(3) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        match random.below(16) {
            0 => bytes[at] = random.byte(),
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, random.byte()),
            3 => bytes.truncate(at),
            4 => {
                let other = texts[random.below(texts.len())].as_bytes();
                let from = random.below(other.len());
                let to = other.len().min(from + 1 + random.below(80));
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            5 => {
                let to = bytes.len().min(at + 1 + random.below(60));
                bytes.drain(at..to);
            }
            6 => {
                let lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
                let (one, two) = (random.below(lines.len()), random.below(lines.len()));
                let mut lines = lines;
                lines.swap(one, two);
                bytes = lines.join(&b'\n');
            }
            // Numbers are what gets through: most mutants change one.
            _ => {
                let numbers = numbers(&bytes);
                if let Some(&(from, to)) = numbers.get(random.below(numbers.len().max(1))) {
                    let odd = if random.share() < 0.5 {
                        ODD[random.below(ODD.len())].to_owned()
                    } else {
                        let value: f64 = std::str::from_utf8(&bytes[from..to]).unwrap().parse().unwrap_or(1.0);
                        format!("{:?}", value * 10f64.powf(6.0 * random.share() - 3.0))
                    };
                    bytes.splice(from..to, odd.into_bytes());
                }
            }
        }
    }
    bytes
}

/// Places of the numbers: what stands after a space or a bracket and begins with a digit, a sign or a point.
fn numbers(bytes: &[u8]) -> Vec<(usize, usize)> {
    let part = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e');
    let mut found = vec![];
    let mut at = 0;
    while at < bytes.len() {
        let starts = bytes[at].is_ascii_digit() || bytes[at] == b'-';
        if starts && (at == 0 || matches!(bytes[at - 1], b' ' | b'[')) {
            let end = (at..bytes.len()).find(|&i| !part(bytes[i])).unwrap_or(bytes.len());
            found.push((at, end));
            at = end;
        }
        at += 1;
    }
    found
}

#[test]
fn mutated_scenarios_never_panic() {
    let count = std::env::var("CONTRAPPOSTO_MUTANTS").ok().and_then(|n| n.parse().ok()).unwrap_or(MUTANTS);
    println!("seed {SEED}, {count} mutants");
    let texts = corpus();
    let mut random = Random(SEED);
    let start = Instant::now();
    let (mut accepted, mut slowest) = (0, 0.0f64);
    for i in 0..count {
        let bytes = mutated(&texts, &mut random);
        let told = || format!("mutant {i}:\n{}", String::from_utf8_lossy(&bytes));
        let begin = Instant::now();
        match read_scenario("mutant.toml", &bytes) {
            Ok(scenario) => {
                accepted += 1;
                assert_sound(scenario, &told);
            }
            Err(error) => {
                let text = complaint(error);
                assert!(text.contains("mutant.toml"), "no place: {text}\n{}", told());
                assert!(!text.contains('\u{1b}'), "{text:?}");
            }
        }
        slowest = slowest.max(begin.elapsed().as_secs_f64());
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{accepted} of {count} accepted and run; {seconds:.1} s, slowest {:.1} ms", 1e3 * slowest);
    assert!(accepted * 10 > count, "mutants must reach deep: {accepted}");
    assert!(slowest < 2.0, "{slowest} s");
}

/// NaN, infinities, the ends of the doubles, negative zero and a subnormal in each number in turn.
#[test]
fn odd_numbers_in_every_field() {
    let full = corpus().pop().unwrap();
    let places = numbers(full.as_bytes());
    assert_eq!(places.len(), 47, "numbers of the full scenario");
    let (mut accepted, mut refused) = (0, 0);
    for &(from, to) in &places {
        for odd in ODD {
            let text = format!("{}{odd}{}", &full[..from], &full[to..]);
            let told = || format!("{odd} for {} in\n{text}", &full[from..to]);
            match read_scenario("odd.toml", text.as_bytes()) {
                Ok(scenario) => {
                    let finite = odd.parse::<f64>().map_or(true, f64::is_finite);
                    assert!(finite, "accepted {}", told());
                    accepted += 1;
                    assert_sound(scenario, &told);
                }
                Err(error) => {
                    let text = complaint(error);
                    let line = full[..from].matches('\n').count() + 1;
                    let near = text.contains(&format!("line {line}, column"))
                        || !matches!(odd, "nan" | "inf" | "-inf" | "1e999");
                    assert!(near, "points elsewhere: {text}\n{}", told());
                    refused += 1;
                }
            }
        }
    }
    println!("{} fields x {} values: {accepted} accepted and run, {refused} refused", places.len(), ODD.len());
}

#[test]
fn the_full_scenario_is_read() {
    for text in corpus() {
        let scenario =
            read_scenario("corpus.toml", text.as_bytes()).unwrap_or_else(|error| panic!("{}", complaint(error)));
        assert_sound(scenario, &|| text.clone());
        // Line ends and a byte order mark are the editor's business.
        read_scenario("crlf.toml", text.replace('\n', "\r\n").as_bytes()).unwrap();
        read_scenario("bom.toml", format!("\u{feff}{text}").as_bytes()).unwrap();
    }
}

/// Every prefix of a file is a value or a complaint.
#[test]
fn truncated_scenarios_never_panic() {
    let full = corpus().pop().unwrap();
    for end in 0..full.len() {
        if let Err(error) = read_scenario("cut.toml", &full.as_bytes()[..end]) {
            assert!(complaint(error).contains("cut.toml"));
        }
    }
}
