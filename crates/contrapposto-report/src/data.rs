//! Writes the data that the page's script reads: one JSON text, safe inside a `<script>` element.

use serde_json::{Value, json};

use crate::column::{DEGREES, LOAD, METRES, NEWTONS, SHARE, TORQUE, TURN, column, columns};
use crate::cycles;
use crate::muscles::muscles;
use crate::skin::mesh;
use crate::{
    Balance, Bone, Entry, Followed, ForceSolid, Group, Joint, Moments, Push, Report, Segment, Skin, Support, Surface,
    Target, Thing,
};

/// Steps to which numbers are rounded: the smallest visible differences.
const SECONDS: f64 = 1e-3;
/// Endurance times from this on, s, count as unlimited.
const UNLIMITED: f64 = 1e5;

/// The JSON text of a report. No `<`, `>` or `&` is left in it, so nothing in it can end or begin an element.
pub(crate) fn data(report: &Report) -> String {
    let n = report.moments.len();
    let (times, names) = match &report.moments {
        Moments::Times(times) => (column(times.iter().copied(), n, SECONDS), Value::Null),
        Moments::Postures(names) => (Value::Null, json!(names)),
    };
    let value = json!({
        "title": report.title,
        "body": report.body,
        "headline": report.headline,
        "facts": report.facts.iter().map(|f| json!([f.name, f.text])).collect::<Value>(),
        "changes": { "columns": report.changes.columns, "rows": report.changes.rows },
        "reasons": report.reasons,
        "figures": report.figures.iter().map(|f| json!([f.label, f.value, f.note])).collect::<Value>(),
        "motors": report.motors,
        "frames": n,
        "times": times,
        "names": names,
        "open": report.open.min(n.saturating_sub(1)),
        "segments": report.segments.iter().map(|s| segment(s, n)).collect::<Value>(),
        "skin": report.skin.as_ref().map(|s| skin(s, report, n)),
        "joints": report.joints.iter().map(|j| joint(j, n)).collect::<Value>(),
        "cycles": report.cycles.as_ref().map(|c| cycles::data(c, report.joints.iter().map(|j| j.slides))),
        "main": report.main,
        "levels": report.levels,
        "supports": report.supports.iter().map(|s| support(s, n)).collect::<Value>(),
        "ground": report.ground.map(|height| short(&[height], METRES)[0].clone()),
        "surfaces": report.surfaces.iter().map(surface).collect::<Value>(),
        "things": report.things.iter().map(|t| thing(t, n)).collect::<Value>(),
        "loads": report.loads.iter().map(|l| push(l, n)).collect::<Value>(),
        "muscles": report.muscles.as_ref().map(|of| muscles(of, report, n)),
        "targets": report.targets.iter().map(|t| target(t, n)).collect::<Value>(),
        "solid": report.solid.as_ref().map(solid),
        "center": known(&report.center_of_mass, || columns(&report.center_of_mass, n, [METRES; 3])),
        "list": {
            "heading": report.list.heading,
            "entries": report.list.entries.iter().map(entry).collect::<Value>(),
            "none": report.list.none,
        },
        "table": { "heading": report.table.heading, "columns": report.table.columns, "rows": report.table.rows },
    });
    escape(&value.to_string())
}

/// The JSON text with the characters of markup, which occur in strings only, as JSON escapes.
fn escape(json: &str) -> String {
    let mut safe = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe.push_str(&format!("\\u{:04x}", c as u32)),
            _ => safe.push(c),
        }
    }
    safe
}

fn segment(segment: &Segment, n: usize) -> Value {
    json!({
        "name": segment.name,
        "balls": segment.balls.iter().map(|ball| short(ball, METRES)).collect::<Value>(),
        "joints": segment.joints,
        "places": places(&segment.places, n),
        "start": short(&segment.start, METRES),
    })
}

/// A segment of the skin that is drawn as a solid, too, names that part instead of its places.
fn skin(skin: &Skin, report: &Report, n: usize) -> Value {
    let mut value = mesh(skin);
    let part = |followed: &Followed| {
        report.segments.iter().position(|part| part.places == followed.places && part.start == followed.start)
    };
    let followed = |followed: &Followed| {
        let part = part(followed);
        let own = part.is_none();
        json!({
            "joints": followed.joints,
            "rest": followed.rest,
            "part": part,
            "places": own.then(|| places(&followed.places, n)),
            "start": own.then(|| short(&followed.start, METRES)),
        })
    };
    value["segments"] = skin.segments.iter().map(followed).collect();
    let bone = |bone: &Bone| json!([bone.from, bone.to, bone.axis, bone.shares]);
    value["nodes"] = skin.nodes.iter().map(bone).collect();
    value
}

fn joint(joint: &Joint, n: usize) -> Value {
    let list = |values: &[f64], step: f64| column(values.iter().copied(), n, step);
    let angle = if joint.slides { METRES } else { DEGREES };
    json!({
        "name": joint.name,
        "label": joint.label,
        "positive": joint.positive,
        "slides": joint.slides,
        "about_axis": joint.about_axis,
        "groups": joint.groups.as_ref().map(|groups| groups.iter().map(|g| group(g, n)).collect::<Value>()),
        "angle": list(&joint.angle, angle),
        "coordinate": known(&joint.coordinate, || list(&joint.coordinate, angle)),
        "external": list(&joint.external, TORQUE),
        "passive": list(&joint.passive, TORQUE),
        "load": list(&joint.load, LOAD),
        "hazard": known(&joint.hazard, || list(&joint.hazard.iter().map(|is| f64::from(u8::from(*is))).collect::<Vec<_>>(), 1.0)),
        "balance": joint.balance.iter().map(|b| balance(b, angle)).collect::<Value>(),
    })
}

fn group(group: &Group, n: usize) -> Value {
    let left = |&seconds: &f64| if seconds < UNLIMITED { seconds.max(0.0) } else { -1.0 };
    json!({
        "label": group.label,
        "fatigue": known(&group.fatigue, || column(group.fatigue.iter().copied(), n, SHARE)),
        "left": column(group.left.iter().map(left), n, 1.0),
        "fails": group.fails.map(|seconds| short(&[seconds], SECONDS)[0].clone()),
    })
}

fn balance(balance: &Balance, angle: f64) -> Value {
    json!({
        "angle": short(&balance.angle, angle),
        "minus_passive": short(&balance.minus_passive, TORQUE),
        "external": short(&balance.external, TORQUE),
    })
}

fn support(support: &Support, n: usize) -> Value {
    json!({
        "label": support.label,
        "force": columns(&support.force, n, [NEWTONS; 3]),
        "at": columns(&support.at, n, [METRES; 3]),
        "share": column(support.share.iter().copied(), n, SHARE),
    })
}

fn surface(surface: &Surface) -> Value {
    json!({ "label": surface.label, "corners": points(&surface.corners) })
}

fn thing(thing: &Thing, n: usize) -> Value {
    json!({
        "label": thing.label,
        "size": short(&thing.size, METRES),
        "places": places(&thing.places, n),
        "putDown": thing.put_down,
    })
}

fn target(target: &Target, n: usize) -> Value {
    let place = |points: &[[f64; 3]]| known(points, || columns(points, n, [METRES; 3]));
    json!({ "label": target.label, "at": columns(&target.at, n, [METRES; 3]), "from": place(&target.from) })
}

fn push(push: &Push, n: usize) -> Value {
    json!({
        "label": push.label,
        "force": columns(&push.force, n, [NEWTONS; 3]),
        "at": columns(&push.at, n, [METRES; 3]),
    })
}

/// Colours of limits; the last stands for all others.
const LIMIT_COLORS: usize = 8;

fn solid(solid: &ForceSolid) -> Value {
    let known = |face: &&[usize; 3]| face.iter().all(|corner| *corner < solid.corners.len());
    let color = |limit: &usize| (*limit).min(LIMIT_COLORS - 1);
    let mut names: Vec<&str> = solid.names.iter().take(LIMIT_COLORS).map(String::as_str).collect();
    if let (true, Some(last)) = (solid.names.len() > LIMIT_COLORS, names.last_mut()) {
        *last = "others";
    }
    json!({
        "at": short(&solid.at, METRES),
        "corners": points(&solid.corners),
        "faces": solid.faces.iter().filter(known).collect::<Vec<_>>(),
        "limits": solid.limits.iter().map(color).collect::<Vec<_>>(),
        "names": names,
        "scale": solid.scale,
    })
}

fn places(places: &[[f64; 7]], n: usize) -> Value {
    let [m, t] = [METRES, TURN];
    columns(places, n, [m, m, m, t, t, t, t])
}

fn entry(entry: &Entry) -> Value {
    let time = entry.time.map(|seconds| short(&[seconds], SECONDS)[0].clone());
    json!({ "frame": entry.frame, "time": time, "joint": entry.joint, "text": entry.text })
}

fn points(points: &[[f64; 3]]) -> Value {
    points.iter().map(|point| short(point, METRES)).collect()
}

/// Null for an empty list.
fn known<T>(values: &[T], write: impl FnOnce() -> Value) -> Value {
    if values.is_empty() { Value::Null } else { write() }
}

/// Numbers rounded to a step.
fn short(values: &[f64], step: f64) -> Value {
    let per = 1.0 / step;
    values.iter().map(|v| (v * per).round() / per).map(|v| if v.is_finite() { v } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::List;

    #[test]
    fn faces_of_unknown_corners_are_left_out_and_more_than_eight_limits_share_a_colour() {
        let solid = ForceSolid {
            corners: vec![[0.0, f64::NAN, 1.0]; 3],
            faces: vec![[0, 1, 2], [0, 1, 3]],
            limits: vec![0, 7, 11],
            names: (0..12).map(|k| format!("limit {k}")).collect(),
            ..ForceSolid::default()
        };
        let report = Report { solid: Some(solid), ..Report::default() };
        let back: Value = serde_json::from_str(&data(&report)).unwrap();
        let solid = &back["solid"];
        assert_eq!(solid["faces"], json!([[0, 1, 2]]));
        assert_eq!(solid["corners"][0], json!([0.0, 0.0, 1.0]));
        assert_eq!(solid["limits"], json!([0, 7, 7]));
        assert_eq!((solid["names"].as_array().unwrap().len(), &solid["names"][7]), (8, &json!("others")));
    }

    #[test]
    fn names_with_markup_come_back_unchanged_and_contain_none_in_the_json() {
        let name = "</script><script>alert(1)</script><!-- & \u{2028}\u{2029} \"\\ \u{0} </SCRIPT >";
        let report = Report {
            title: name.to_owned(),
            segments: vec![Segment { name: name.to_owned(), ..Segment::default() }],
            list: List { entries: vec![Entry { text: name.to_owned(), ..Entry::default() }], ..List::default() },
            ..Report::default()
        };
        let text = data(&report);
        assert!(!text.contains(['<', '>', '&', '\u{2028}', '\u{2029}', '\u{0}']));
        let back: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back["title"], name);
        assert_eq!(back["segments"][0]["name"], name);
        assert_eq!(back["list"]["entries"][0]["text"], name);
    }
}
