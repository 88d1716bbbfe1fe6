//! Checks body figures: every mark is there, no text touches another text or a body, and hostile input gives a well-formed picture.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

use contrapposto_plot::{BodyFigure, BodyForce, BodyMuscle, BodyPart, BodyPosture, BodyThing, body_figure};

const HOSTILE_TEXT: &str = "</text><script>alert(\"&'\")</script> $x$ \u{0} \u{ffff} 関節 \u{202e}";

/// A cube before the body.
fn thing(label: &str, edge: f64) -> BodyThing {
    let end = |i: usize, bit: usize| if i & bit == 0 { 0.0 } else { edge };
    let corners = std::array::from_fn(|i| [0.3 + end(i, 1), 0.7 + end(i, 2), 0.1 + end(i, 4)]);
    BodyThing { label: label.to_owned(), corners }
}

/// A standing body of a few parts: trunk, head, two arms, two legs.
fn body(load: f64) -> BodyPosture {
    let part = |balls: &[[f64; 4]], load: Option<f64>| BodyPart { balls: balls.to_vec(), load, hazard: false };
    let limb = |z: f64, top: f64, bottom: f64| part(&[[0.0, top, z, 0.07], [0.05, bottom, z, 0.05]], Some(load));
    BodyPosture {
        title: "A: standing".to_owned(),
        notes: vec![
            "effort 0.1234".to_owned(),
            "right foot 85 %".to_owned(),
            "pelvis 15.7° down to the left".to_owned(),
        ],
        parts: vec![
            part(&[[0.0, 1.0, 0.0, 0.12], [0.0, 1.3, 0.1, 0.1], [0.0, 1.3, -0.1, 0.1]], None),
            part(&[[0.0, 1.62, 0.0, 0.1]], Some(0.0)),
            limb(0.25, 1.35, 0.8),
            limb(-0.25, 1.35, 0.8),
            limb(0.1, 0.95, 0.05),
            limb(-0.1, 0.95, 0.05),
        ],
        muscles: vec![],
        start: vec![part(&[[0.0, 1.0, 0.3, 0.2]], Some(1.0))],
        forces: vec![BodyForce { at: [0.0, 0.0, 0.1], force: [0.0, 500.0, 0.0] }],
        center_of_mass: Some([0.02, 0.95, 0.0]),
        ground: Some(0.0),
        surfaces: vec![[[0.5, 0.4, -0.3], [0.2, 0.4, -0.3], [0.2, 0.4, 0.3], [0.5, 0.4, 0.3]]],
        things: vec![thing("a box", 0.3), thing("a wall", 30.0)],
        loads: vec![BodyForce { at: [0.3, 0.9, 0.2], force: [0.0, -80.0, 0.0] }],
        targets: vec![[0.4, 1.5, 0.2]],
        gazes: vec![[[0.05, 1.6, 0.0], [0.4, 1.5, 0.2]]],
    }
}

fn figure(postures: Vec<BodyPosture>, text: &str) -> BodyFigure {
    let text = text.to_owned();
    BodyFigure { title: text.clone(), subtitle: text.clone(), target: text, postures }
}

/// Value of an attribute of an element.
fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
    element.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap_or_default()
}

fn number(element: &str, name: &str) -> f64 {
    attribute(element, name).parse().unwrap_or_else(|_| panic!("no number {name} in {element}"))
}

/// A rectangle on the sheet: left, top, right, bottom.
type Extent = [f64; 4];

/// Advance of a letter of DejaVu Sans, em: the widest of its kind.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | ' ' | '.' | ',' => 0.32,
        'f' | 't' | 'r' | '-' | '(' | ')' | ':' => 0.42,
        'm' | 'w' | '%' | 'M' | 'W' | '…' => 1.0,
        'A'..='Z' => 0.78,
        _ => 0.64,
    }
}

/// The extents of a picture's texts, from the widest letters of DejaVu Sans, and their contents.
fn texts(svg: &str) -> Vec<(Extent, String)> {
    let text = |element: &str| {
        let (opening, rest) = element.split_once('>').unwrap();
        let said = rest.split("</text>").next().unwrap().to_owned();
        let (x, y, size) = (number(opening, "x"), number(opening, "y"), number(opening, "font-size"));
        let width = size * said.chars().map(advance).sum::<f64>();
        let left = match attribute(opening, "text-anchor") {
            "middle" => x - 0.5 * width,
            "end" => x - width,
            _ => x,
        };
        ([left, y - 0.76 * size, left + width, y + 0.22 * size], said)
    };
    svg.split("<text").skip(1).map(text).filter(|(_, said)| !said.is_empty()).collect()
}

/// Filled shapes with curved outlines: parts of bodies. Their points and handles bound them.
fn parts(svg: &str) -> Vec<Extent> {
    let curved = svg.lines().filter(|line| line.contains("<path") && attribute(line, "d").contains('C'));
    let extent = |line: &str| {
        let numbers: Vec<f64> = attribute(line, "d")
            .split(|c: char| c.is_alphabetic() || c == ' ')
            .filter_map(|n| n.parse().ok())
            .collect();
        numbers.chunks_exact(2).fold([f64::INFINITY, f64::INFINITY, 0.0, 0.0], |[l, t, r, b], p| {
            [l.min(p[0]), t.min(p[1]), r.max(p[0]), b.max(p[1])]
        })
    };
    curved.map(extent).collect()
}

fn touch(a: &Extent, b: &Extent) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[test]
fn no_text_touches_another_text_or_a_body_and_all_are_on_the_sheet() {
    for count in 1..=5 {
        let mut wide = body(0.2);
        wide.parts[2].balls[1] = [1.2, 1.35, 0.9, 0.05];
        let mut postures = vec![body(0.1); count - 1];
        postures.push(wide);
        for text in ["Standing", "", &"long words ".repeat(40)] {
            let svg = body_figure(&figure(postures.clone(), text)).svg();
            let (texts, parts) = (texts(&svg), parts(&svg));
            assert_eq!(parts.len(), count * 3 * (6 + 2), "parts, and the ghost twice");
            for (i, (extent, said)) in texts.iter().enumerate() {
                assert!(extent[0] >= 0.0 && extent[2] <= 800.0 + 0.12 * (extent[2] - extent[0]), "{said}: {extent:?}");
                for (other, also) in &texts[..i] {
                    assert!(!touch(extent, other), "{said} on {also}");
                }
                assert!(!parts.iter().any(|part| touch(extent, part)), "{said} on a body");
            }
            let height = number(&svg, "height");
            assert!(parts.iter().all(|p| p[0] >= 0.0 && p[2] <= 800.0 && p[1] >= 0.0 && p[3] <= height));
        }
    }
}

#[test]
fn a_posture_of_half_the_size_is_drawn_half_as_tall_on_the_same_ground() {
    let mut small = body(0.1);
    for ball in small.parts.iter_mut().chain(&mut small.start).flat_map(|part| &mut part.balls) {
        *ball = ball.map(|v| 0.5 * v);
    }
    let svg = body_figure(&figure(vec![body(0.1), small], "")).svg();
    let parts = parts(&svg);
    // Front views come first: of both postures the ghost twice, then the parts.
    let [tall, short] = [0, 1].map(|i| {
        let own = &parts[8 * i + 2..8 * i + 8];
        let [top, bottom] = [1, 3].map(|k| own.iter().map(move |p| p[k]));
        (top.fold(f64::INFINITY, f64::min), bottom.fold(0.0, f64::max))
    });
    assert!(((tall.1 - tall.0) / (short.1 - short.0) - 2.0).abs() < 0.01, "{tall:?} {short:?}");
    assert!((tall.1 - short.1).abs() < 0.1, "{tall:?} {short:?}");
}

#[test]
fn a_load_has_the_same_colour_whatever_the_others_are_and_the_legend_names_all_bounds() {
    let with_loads = |loads: [Option<f64>; 3]| {
        let parts = loads.map(|load| BodyPart { balls: vec![[0.0, 0.0, 0.0, 1.0]], load, hazard: false });
        body_figure(&figure(vec![BodyPosture { parts: parts.to_vec(), ..BodyPosture::default() }], "")).svg()
    };
    let drawn = |svg: &str, colour: &str| {
        svg.lines().filter(|l| l.contains('C') && l.contains(&format!("fill=\"{colour}\""))).count()
    };
    for others in [0.02, 0.3, 4.0] {
        let svg = with_loads([Some(0.14), Some(others), Some(1.2)]);
        assert!(drawn(&svg, "#e8942a") == 3 && drawn(&svg, "#3d0a1e") >= 3, "{others}");
        let words: Vec<String> = texts(&svg).into_iter().map(|(_, said)| said).collect();
        for bound in ["8", "14", "50", "100", "% of strength"] {
            assert!(words.iter().any(|word| word == bound), "{bound}: {words:?}");
        }
        assert!(!svg.contains("not known"));
    }
    let svg = with_loads([Some(0.31), Some(3.0), None]);
    assert!(svg.contains("load not known"));
    assert_eq!(svg.matches("fill=\"#b9bfc9\"").count(), 3 + 1, "three views and the legend");
    assert!(!with_loads([None, None, None]).contains("of strength"));
}

#[test]
fn a_part_in_hazard_has_a_colour_of_its_own_and_a_key() {
    let mut posture = body(0.02);
    assert!(!body_figure(&figure(vec![posture.clone()], "")).svg().contains("#c2188f"));
    posture.parts[1].hazard = true;
    let svg = body_figure(&figure(vec![posture], "")).svg();
    assert_eq!(svg.matches("fill=\"#c2188f\"").count(), 3 + 1, "three views and the legend");
    assert!(svg.contains("held by ligaments: hazard"));
}

#[test]
fn muscles_have_the_colours_of_load_over_a_pale_body_the_nearer_over_the_farther() {
    let loaded = body(0.3);
    let muscle = |x: f64, activation: f64| BodyMuscle {
        lines: vec![vec![[x, 0.9, 0.1], [x, 0.5, 0.1]]],
        radius: 0.01,
        activation,
    };
    let with = BodyPosture { muscles: vec![muscle(0.2, 0.3), muscle(0.0, 0.05)], ..loaded.clone() };
    let [plain, drawn] = [loaded, with].map(|posture| body_figure(&figure(vec![posture], "t")).svg());
    let color = |activation: f64| {
        let [r, g, b] = contrapposto_plot::load_color(activation);
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    let lines = |svg: &str, activation: f64| {
        let stroke = format!("stroke=\"{}\"", color(activation));
        svg.match_indices(&stroke).map(|(at, _)| at).collect::<Vec<_>>()
    };
    assert_eq!(lines(&plain, 0.3).len(), 0);
    // One line a view; from the front the first muscle is the nearer one, and comes later.
    let (near, far) = (lines(&drawn, 0.3), lines(&drawn, 0.05));
    assert_eq!((near.len(), far.len()), (3, 3), "{drawn}");
    assert!(near[0] > far[0]);
    let part = format!("fill=\"{}\"", color(0.3));
    // The legend may have the colour, too; four limbs have it in three views.
    assert_eq!(plain.matches(&part).count(), drawn.matches(&part).count() + 12, "parts are pale");
    assert!(drawn.contains("activation of muscles:") && plain.contains("muscle load:"));
}

#[test]
fn boxes_are_translucent_cut_off_far_from_the_body_and_named_in_the_legend() {
    let svg = body_figure(&figure(vec![body(0.1)], "")).svg();
    let glass: Vec<&str> = svg.lines().filter(|line| line.contains("fill-opacity")).collect();
    // Seat, box and wall in three views, and two samples of the legend.
    assert_eq!(glass.len(), 3 * 3 + 2);
    let height = number(&svg, "height");
    let lines = svg.lines().filter(|line| line.contains("#5f7690") || line.contains("#a07a4c"));
    for line in lines {
        let numbers = attribute(line, "d").replace(['M', 'L', 'Z'], " ");
        let numbers: Vec<f64> = numbers.split_whitespace().map(|n| n.parse().unwrap()).collect();
        let inside = |p: &[f64]| (0.0..=800.0).contains(&p[0]) && (0.0..=height).contains(&p[1]);
        assert!(numbers.chunks_exact(2).all(inside), "{line}");
    }
    let words: Vec<String> = texts(&svg).into_iter().map(|(_, said)| said).collect();
    for said in ["a box, a wall", "seat, table, step or wall"] {
        assert!(words.iter().any(|word| word == said), "{said}");
    }
    assert!(words.iter().any(|word| word.starts_with("load, ")));
    let mut bare = body(0.1);
    (bare.surfaces, bare.things, bare.loads) = (vec![], vec![], vec![]);
    let bare = body_figure(&figure(vec![bare], "")).svg();
    assert!(!bare.contains("fill-opacity") && !bare.contains("#6a2c91"));
}

/// The rectangle of the marks in the first view that have the colour of things, px, without the samples of the legend.
fn thing_in_first_view(svg: &str) -> (f64, f64) {
    let glass = svg.lines().find(|line| line.contains("fill-opacity") && line.contains("#5f7690")).unwrap();
    let numbers: Vec<f64> =
        attribute(glass, "d").replace(['M', 'L', 'Z'], " ").split_whitespace().map(|n| n.parse().unwrap()).collect();
    let across = numbers.chunks_exact(2).map(|p| p[0]);
    across.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// Pixels of a metre, from the scale bar of the legend, the last line before the length that it stands for.
fn pixels_per_metre(svg: &str) -> f64 {
    let lines: Vec<&str> = svg.lines().collect();
    let end = lines.iter().rposition(|line| line.contains(" m</text>")).unwrap();
    let metres: f64 = texts(lines[end])[0].1.trim_end_matches(" m").parse().unwrap();
    let bar = attribute(lines[end - 3], "d").replace(['M', 'L'], " ");
    let bar: Vec<f64> = bar.split_whitespace().map(|n| n.parse().unwrap()).collect();
    (bar[2] - bar[0]) / metres
}

/// A table of 2 m is as long in pixels as the scale bar of the legend says; of a wall of 30 m only a strip is drawn.
#[test]
fn a_wide_table_is_drawn_whole_and_a_wall_is_cut_off() {
    let drawn = |from: f64, to: f64| {
        let mut posture = body(0.1);
        let end = |i: usize, bit: usize| if i & bit == 0 { 0.0 } else { 1.0 };
        let corners =
            std::array::from_fn(|i| [0.4 + 0.6 * end(i, 1), 0.9 + 0.04 * end(i, 2), from + (to - from) * end(i, 4)]);
        (posture.surfaces, posture.start) = (vec![], vec![]);
        posture.things = vec![BodyThing { label: "a table".to_owned(), corners }];
        let svg = body_figure(&figure(vec![posture], "")).svg();
        let (low, high) = thing_in_first_view(&svg);
        (high - low) / pixels_per_metre(&svg)
    };
    assert!((drawn(-1.3, 0.7) - 2.0).abs() < 0.01, "{}", drawn(-1.3, 0.7));
    assert!(drawn(-15.0, 15.0) < 1.6, "{}", drawn(-15.0, 15.0));
}

#[test]
fn arrows_of_forces_have_the_scale_of_the_legend() {
    let svg = body_figure(&figure(vec![body(0.1)], "")).svg();
    let words = texts(&svg).into_iter().map(|(_, said)| said).find(|said| said.starts_with("contact force, ")).unwrap();
    let newtons: f64 = words.split_whitespace().nth(2).unwrap().parse().unwrap();
    // Heads of arrows: the tip comes first; before it stands the shaft, from its foot.
    let lines: Vec<&str> = svg.lines().collect();
    let lengths = lines.windows(2).filter(|pair| pair.iter().all(|line| line.contains("#009e73")));
    let lengths: Vec<f64> = lengths
        .map(|pair| {
            let point = |line: &str| -> Vec<f64> {
                let d = attribute(line, "d").trim_start_matches('M').replace(['L', ','], " ");
                d.split_whitespace().take(2).map(|n| n.parse().unwrap()).collect()
            };
            let (foot, tip) = (point(pair[0]), point(pair[1]));
            libm::hypot(tip[0] - foot[0], tip[1] - foot[1])
        })
        .collect();
    // Front, right, three-quarter, legend; the third one is seen from above.
    assert_eq!(lengths.len(), 4);
    assert!((lengths[0] - lengths[3] * 500.0 / newtons).abs() < 0.1, "{lengths:?} {newtons}");
    assert!((lengths[0] - lengths[1]).abs() < 0.02 && lengths[2] < lengths[0]);
}

#[test]
fn extreme_numbers_and_texts_with_markup_give_well_formed_figures() {
    let odd = [0.0, -0.0, 1e9, -1e9, 1e308, 1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let mut postures = vec![];
    for &a in &odd {
        for &b in &odd {
            let parts = vec![
                BodyPart { balls: vec![[a, b, a, b], [b, a, b, a], [0.0, 0.0, 0.0, 0.1]], load: Some(a), hazard: true },
                BodyPart { balls: vec![], load: Some(b), hazard: false },
            ];
            postures.push(BodyPosture {
                title: HOSTILE_TEXT.to_owned(),
                notes: vec![HOSTILE_TEXT.repeat(50); 20],
                start: parts.clone(),
                parts,
                muscles: vec![BodyMuscle { lines: vec![vec![[a, b, a], [b, a, b]], vec![]], radius: a, activation: b }],
                forces: vec![BodyForce { at: [a, b, a], force: [b, a, b] }],
                center_of_mass: Some([a, a, b]),
                ground: Some(b),
                surfaces: vec![[[a, b, a], [b, a, b], [a, a, b], [b, b, a]]],
                things: vec![BodyThing { label: HOSTILE_TEXT.to_owned(), corners: [[a, b, a]; 8] }, thing("box", a)],
                loads: vec![BodyForce { at: [b, b, a], force: [a, b, a] }],
                targets: vec![[a, b, b]],
                gazes: vec![[[a, b, a], [b, b, a]]],
            });
        }
    }
    for chunk in postures.chunks(4) {
        let drawn = body_figure(&figure(chunk.to_vec(), HOSTILE_TEXT));
        let svg = drawn.svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<script"));
        assert!(svg.contains("&lt;/text&gt;") && !svg.contains('\u{0}') && !svg.contains('\u{ffff}'));
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
        assert!(drawn.png().unwrap().starts_with(b"\x89PNG"));
    }
    let many = BodyPosture { parts: vec![postures[0].parts[0].clone(); 5_000], ..BodyPosture::default() };
    assert!(body_figure(&figure(vec![many; 9], "many")).svg().len() < 4_000_000);
}

#[test]
fn empty_figures_say_nothing_to_draw_and_equal_input_gives_equal_bytes() {
    let part =
        BodyPart { balls: vec![[0.0, 0.0, 0.0, -0.1], [f64::NAN, 0.0, 0.0, 0.1]], load: Some(0.1), hazard: false };
    let unreal = BodyPosture { parts: vec![part], ..BodyPosture::default() };
    for postures in [vec![], vec![BodyPosture::default()], vec![BodyPosture::default(); 3], vec![unreal]] {
        let drawn = body_figure(&figure(postures, ""));
        assert!(drawn.svg().contains("nothing to draw"));
        drawn.png().unwrap();
    }
    let twice = [0, 1].map(|_| body_figure(&figure(vec![body(0.1), body(0.3)], "twice")));
    assert_eq!(twice[0].svg(), twice[1].svg());
    assert_eq!(twice[0].png().unwrap(), twice[1].png().unwrap());
}
