//! Checks the charts: hostile numbers and texts, the same bytes twice, the marks that must be there.

use contrapposto_plot::{
    BarChart, Figure, ForceLength, HoldingCurve, PassiveChart, PostureSketch, SketchRole, TimeLine, TorqueBalance,
    bar_chart, force_length, holding_curve, passive_curve, time_line, torque_balance,
};

const HOSTILE_TEXT: &str = "<script>alert(\"&'\")</script> $\\frac{a}{b}$ \u{0} \u{ffff} 関節 \u{202e}";

const HOSTILE_NUMBERS: [f64; 12] = [
    0.0,
    -0.0,
    1.0,
    -1e-300,
    1e9,
    -1e9,
    1e308,
    -f64::MAX,
    f64::MIN_POSITIVE,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Empty, constant, extreme and long lists of numbers.
fn hostile_lists() -> Vec<Vec<f64>> {
    let mut lists = vec![
        vec![],
        vec![5.0; 3],
        HOSTILE_NUMBERS.to_vec(),
        HOSTILE_NUMBERS.iter().rev().copied().collect(),
        vec![1.0, 1.0 + f64::EPSILON],
        (0..20_000).map(|i| f64::from(i % 7) * 1e8).collect(),
    ];
    lists.extend(HOSTILE_NUMBERS.map(|number| vec![number]));
    lists
}

fn balance(xs: &[f64], ys: &[f64], text: &str) -> TorqueBalance {
    let points = || xs.iter().copied().zip(ys.iter().copied());
    let sketch = |&angle_deg: &f64| PostureSketch {
        label: text.to_owned(),
        angle_deg,
        polylines: vec![vec![], points().map(|(x, y)| [x, y]).collect()],
        role: SketchRole::Zero,
    };
    TorqueBalance {
        title: text.to_owned(),
        subtitle: text.to_owned(),
        angle_label: text.to_owned(),
        angles_deg: xs.to_vec(),
        external_nm: ys.to_vec(),
        external_path: points().collect(),
        minus_passive_nm: xs.to_vec(),
        active_nm: ys.to_vec(),
        tolerance_nm: ys.first().copied().unwrap_or(0.1),
        start: points().next(),
        path: points().collect(),
        goal: points().next_back(),
        zero_torque_deg: xs.to_vec(),
        postures: xs.iter().take(20).map(sketch).collect(),
    }
}

fn passive(xs: &[f64], ys: &[f64], text: &str) -> PassiveChart {
    let first = xs.first().copied().unwrap_or(f64::NAN);
    let last = ys.last().copied().unwrap_or(f64::NAN);
    PassiveChart {
        title: text.to_owned(),
        angle_label: text.to_owned(),
        angles_deg: xs.to_vec(),
        torque_nm: ys.to_vec(),
        slope_nm_per_rad: ys.to_vec(),
        range_deg: (first, last),
        flattest_deg: Some((last, first)),
        source: text.repeat(20),
    }
}

fn line(xs: &[f64], ys: &[f64], text: &str) -> TimeLine {
    TimeLine {
        title: text.to_owned(),
        subtitle: text.to_owned(),
        coordinate: text.to_owned(),
        time_s: xs.to_vec(),
        angle_deg: ys.to_vec(),
        external_nm: ys.to_vec(),
        passive_nm: xs.to_vec(),
        active_nm: ys.to_vec(),
        fatigue_positive: ys.to_vec(),
        fatigue_negative: vec![],
        critical_level: ys.first().copied().unwrap_or(f64::NAN),
        recovery_level: f64::INFINITY,
        events: xs.iter().map(|x| (*x, text.to_owned())).collect(),
    }
}

fn holding(xs: &[f64], ys: &[f64], text: &str) -> HoldingCurve {
    HoldingCurve {
        title: text.to_owned(),
        subtitle: text.to_owned(),
        end_min: xs.last().copied().unwrap_or(f64::NAN),
        groups: [xs, ys, xs].map(|times| (text.to_owned(), times.to_vec())).to_vec(),
    }
}

fn bars(xs: &[f64], ys: &[f64], text: &str) -> BarChart {
    let row = |share: &f64| (text.to_owned(), [&[*share], ys].concat());
    BarChart {
        title: text.to_owned(),
        subtitle: text.to_owned(),
        series: vec![text.to_owned(); xs.len().min(4)],
        rows: xs.iter().take(100).map(row).collect(),
    }
}

fn fibers(xs: &[f64], ys: &[f64], text: &str) -> ForceLength {
    ForceLength {
        title: text.to_owned(),
        subtitle: text.to_owned(),
        lengths: xs.to_vec(),
        active: ys.to_vec(),
        passive: xs.to_vec(),
        states: xs.iter().zip(ys).map(|(x, y)| (text.to_owned(), *x, *y)).collect(),
    }
}

fn all_pictures(xs: &[f64], ys: &[f64], text: &str) -> [Figure; 6] {
    [
        torque_balance(&[balance(xs, ys, text)]),
        passive_curve(&passive(xs, ys, text)),
        time_line(&line(xs, ys, text)),
        holding_curve(&holding(xs, ys, text)),
        bar_chart(&bars(xs, ys, text)),
        force_length(&fibers(xs, ys, text)),
    ]
}

#[test]
fn bars_are_as_long_as_their_shares_and_a_share_is_written_beside_each() {
    let chart = BarChart {
        series: vec!["women".to_owned(), "men".to_owned()],
        rows: vec![("knee".to_owned(), vec![0.5, 1.0]), ("hip".to_owned(), vec![0.0, f64::NAN])],
        ..BarChart::default()
    };
    let svg = bar_chart(&chart).svg();
    // A bar of 100 % is 450 px long; the grey ground of a row has that length, too.
    assert_eq!((count(&svg, "width=\"225\""), count(&svg, "width=\"450\"")), (1, 3));
    for words in [">50 %<", ">100 %<", ">0 %<", ">unknown<", ">women<", ">men<", ">knee<", ">hip<"] {
        assert_eq!(count(&svg, words), 1, "{words}");
    }
}

#[test]
fn states_of_fibres_lie_on_their_curves() {
    let lengths: Vec<f64> = (0..=100).map(|i| 0.5 + 0.01 * f64::from(i)).collect();
    let active = |length: f64| 1.0 - (length - 1.0).powi(2);
    let chart = ForceLength {
        active: lengths.iter().map(|length| active(*length)).collect(),
        passive: vec![0.0; lengths.len()],
        states: vec![
            ("rest".to_owned(), 0.8, 0.0),
            ("full".to_owned(), 0.8, active(0.8)),
            ("third".to_owned(), 1.0, 1.0),
        ],
        lengths,
        ..ForceLength::default()
    };
    let svg = force_length(&chart).svg();
    // Two states, each in the picture and in the legend.
    assert_eq!(count(&svg, "<circle"), 4);
    let part = |line: &str, key: &str| -> f64 {
        let text = line.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap();
        text.parse().unwrap()
    };
    let dots: Vec<(f64, f64)> =
        svg.lines().filter(|line| line.contains("<circle")).map(|line| (part(line, "cx"), part(line, "cy"))).collect();
    // Both have one length, and the active one is higher on the sheet.
    assert!((dots[0].0 - dots[1].0).abs() < 1e-9 && dots[1].1 < dots[0].1 - 50.0, "{dots:?}");
}

fn ramp() -> (Vec<f64>, Vec<f64>) {
    (0..=50).map(|i| (f64::from(i), f64::from(i - 25))).unzip()
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

/// Every tag closed in order, no bare ampersand, no character that XML forbids, every coordinate a number.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("an end of the tag");
        let name = tag.split_whitespace().next().expect("a name");
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed));
        } else if !tag.ends_with('/') && !tag.starts_with('!') {
            open.push(name);
        }
        for entity in text.split('&').skip(1) {
            let known = ["amp;", "lt;", "gt;", "quot;", "apos;"];
            assert!(known.iter().any(|k| entity.starts_with(k)), "{entity}");
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!svg.contains(|c: char| c.is_control() && c != '\n' || c == '\u{ffff}'));
    assert!(!svg.contains("NaN") && !svg.contains("inf\""));
}

#[test]
fn extreme_and_missing_numbers_give_well_formed_pictures() {
    let lists = hostile_lists();
    for xs in &lists {
        for ys in &lists {
            for figure in all_pictures(xs, ys, "text") {
                assert_well_formed(&figure.svg());
            }
        }
        for figure in all_pictures(xs, xs, "text") {
            assert!(figure.png().unwrap().starts_with(b"\x89PNG"));
        }
    }
}

#[test]
fn texts_with_markup_are_escaped() {
    let (xs, ys) = ramp();
    for figure in all_pictures(&xs, &ys, HOSTILE_TEXT) {
        let svg = figure.svg();
        assert_well_formed(&svg);
        assert!(!svg.contains("<script"));
        assert!(svg.contains("&lt;script&gt;alert(&quot;&amp;&apos;&quot;)"));
        assert!(svg.contains("$\\frac{a}{b}$"), "a dollar is no mathematics");
        figure.png().unwrap();
    }
}

#[test]
fn texts_of_a_megabyte_are_cut() {
    let (xs, ys) = ramp();
    let text = "very long words ".repeat(100_000);
    for figure in all_pictures(&xs, &ys, &text) {
        assert!(figure.svg().len() < text.len() / 3);
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let (xs, ys) = ramp();
    let twice = [0, 1].map(|_| all_pictures(&xs, &ys, "text"));
    for (a, b) in twice[0].iter().zip(&twice[1]) {
        assert_eq!(a.svg(), b.svg());
        assert_eq!(a.png().unwrap(), b.png().unwrap());
    }
}

#[test]
fn a_torque_balance_has_the_colours_and_marks_of_the_paper() {
    let (xs, ys) = ramp();
    let mut panel = balance(&xs, &ys, "text");
    panel.zero_torque_deg = vec![25.0];
    panel.postures.truncate(2);
    let svg = torque_balance(&[panel]).svg();
    for (colour, what) in [("#1f5fbf", "passive"), ("#cc2222", "external"), ("#854a1e", "active"), ("#f7c42e", "path")]
    {
        assert!(svg.contains(&format!("stroke=\"{colour}\"")), "{what}");
    }
    // Start, goal and one zero; each once in the picture and once in the legend. The end of the path of external torque.
    assert_eq!(count(&svg, "<circle"), 7);
    // Each drawing has one line that is not empty.
    assert_eq!(count(&svg, "stroke-width=\"4\""), 2);
}

#[test]
fn a_curve_beyond_the_frame_is_cut_at_it() {
    let (xs, _) = ramp();
    let panel = TorqueBalance {
        external_nm: vec![1.0; xs.len()],
        minus_passive_nm: xs.iter().map(|x| 1e6 * (x - 25.0)).collect(),
        angles_deg: xs,
        ..TorqueBalance::default()
    };
    let svg = torque_balance(&[panel]).svg();
    let passive = svg.lines().find(|line| line.contains("#1f5fbf")).unwrap();
    let path = passive.split('"').nth(1).unwrap();
    let words = path.split(|c: char| c.is_alphabetic() || c == ' ').filter(|word| !word.is_empty());
    let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
    assert!(!numbers.is_empty() && numbers.iter().all(|n| (0.0..=800.0).contains(n)));
}

#[test]
fn two_panels_make_a_longer_picture_and_a_hundred_are_refused_as_png() {
    let (xs, ys) = ramp();
    let panel = balance(&xs, &ys, "text");
    let one = torque_balance(std::slice::from_ref(&panel));
    let two = torque_balance(&[panel.clone(), panel.clone()]);
    assert!(two.svg().len() > one.svg().len() + one.svg().len() / 2);
    let many = torque_balance(&vec![panel; 100]);
    assert!(many.png().unwrap_err().to_string().contains("fewer panels"));
}

#[test]
fn empty_pictures_contain_the_words_nothing_to_draw() {
    let empty = [
        torque_balance(&[]),
        torque_balance(&[TorqueBalance::default()]),
        passive_curve(&PassiveChart::default()),
        time_line(&TimeLine::default()),
    ];
    for figure in empty {
        assert!(figure.svg().contains("nothing to draw"));
        figure.png().unwrap();
    }
}
