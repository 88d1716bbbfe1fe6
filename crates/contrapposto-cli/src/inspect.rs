//! `contrapposto inspect`: what is in a model, what was ignored, and how far every number can be trusted.

mod report;
mod sources;

use std::fmt::Write;

use contrapposto::model::JointKind;
use contrapposto::passive::{PassiveLaw, Term};

use crate::args::InspectArgs;
use crate::fail::Fail;
use crate::model_file::{Opened, Tissue, open};
use crate::output::print;
use crate::torques::plain_table;
use sources::{Known, Seen};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Fail> {
    let opened = open(&args.model, true)?;
    let file = args.model.model.display().to_string();
    if args.json {
        let text = report::report(&opened, &file);
        let json = serde_json::to_string_pretty(&text).map_err(|error| Fail::job("JSON", error))?;
        return print(&(json + "\n"));
    }
    print(&readable(&opened, &file))
}

/// `hinge`, `free`, `driven by functions`.
fn joint_word(kind: &JointKind) -> &'static str {
    match kind {
        JointKind::Weld => "weld",
        JointKind::Hinge(_) => "hinge",
        JointKind::Slide(_) => "slide",
        JointKind::Universal(_) => "universal",
        JointKind::Gimbal(_) => "gimbal",
        JointKind::Ball => "ball",
        JointKind::Free => "free",
        JointKind::Chain(_) => "chain",
        JointKind::Driven(_) => "driven",
    }
}

/// The law in a word or two.
fn law_word(law: &PassiveLaw) -> String {
    let term = |term: &Term| match term {
        Term::Spring { .. } => "spring",
        Term::Polynomial { .. } => "polynomial",
        Term::CoordinateLimitForce(_) => "coordinate limit force",
        Term::Exponentials(_) => "exponentials",
        Term::Expression(_) => "formula",
    };
    match law {
        PassiveLaw::Curve(_) => "curve".to_owned(),
        PassiveLaw::Coupled(_) => "coupled law of hip, knee and ankle".to_owned(),
        PassiveLaw::Sum(terms) => terms.iter().map(term).collect::<Vec<_>>().join(" + "),
    }
}

/// Passive torque at both limits of the range, the rest of the body at its default; `None` where a limit or a law is missing.
fn at_limits(opened: &Opened, index: usize) -> Option<[f64; 2]> {
    let (model, coordinate) = (&opened.model, &opened.model.coordinates()[index]);
    coordinate.passive.as_ref()?;
    let mut posture = model.default_posture();
    let mut tissue = Tissue::new(opened);
    let mut at = |limit: f64| {
        posture.values_mut()[index] = limit;
        tissue.place(posture.values());
        Some(tissue.torque(model, index)).filter(|torque| limit.is_finite() && torque.is_finite())
    };
    Some([at(coordinate.range.0)?, at(coordinate.range.1)?])
}

fn readable(opened: &Opened, file: &str) -> String {
    let model = &opened.model;
    let gravity = model.gravity();
    let mut text = format!(
        "{file}: {} `{}`\n{} segments, {} coordinates, {:.4} kg, gravity {} {} {} m/s2\n",
        opened.format.word(),
        model.name(),
        model.segments().len(),
        model.coordinates().len(),
        model.mass(),
        gravity.x,
        gravity.y,
        gravity.z,
    );
    let mut table = plain_table();
    table.set_header(["segment", "parent", "kg", "joint", "coordinates"]);
    for segment in model.segments() {
        let names: Vec<&str> =
            model.coordinates()[segment.coordinates.clone()].iter().map(|c| c.name.as_str()).collect();
        table.add_row([
            segment.name.clone(),
            segment.parent.map_or("ground".to_owned(), |parent| model.segments()[parent].name.clone()),
            format!("{:.4}", segment.mass),
            format!("{} ({})", segment.joint, joint_word(&segment.joint_kind)),
            names.join(", "),
        ]);
    }
    let _ = write!(text, "\n{table}\n\n");
    let mut seen = Seen::default();
    let _ = writeln!(text, "{}", coordinates(opened, &mut seen));
    text.push_str(&seen.legend());
    if !opened.notes.is_empty() {
        text.push_str("\nnotes:\n");
        opened.notes.iter().for_each(|note| {
            let _ = writeln!(text, "  {note}");
        });
    }
    text
}

fn coordinates(opened: &Opened, seen: &mut Seen) -> comfy_table::Table {
    use contrapposto::model::CoordinateKind::{Quaternion, Rotation, Translation};
    let model = &opened.model;
    let mut table = plain_table();
    table.set_header([
        "coordinate",
        "positive",
        "range",
        "default",
        "passive, N m at limits",
        "strength +/-, N m",
        "fatigue",
    ]);
    for (index, coordinate) in model.coordinates().iter().enumerate() {
        let known = Known::of(opened, index);
        let shown = |x: f64| match coordinate.kind {
            _ if x.is_infinite() => "none".to_owned(),
            Rotation => format!("{:.1}", x.to_degrees()),
            _ => format!("{x:.3}"),
        };
        let unit = match coordinate.kind {
            Rotation => " deg",
            Translation => " m",
            Quaternion => "",
        };
        let (min, max) = coordinate.range;
        let mut range = format!("{} .. {}{unit}", shown(min), shown(max));
        if let Some(coupling) = model.couplings().iter().find(|coupling| coupling.dependent == index) {
            range = format!("follows {}", model.coordinates()[coupling.independent].name);
        } else if coordinate.locked {
            range.push_str(", locked");
        }
        let passive = match &coordinate.passive {
            None => String::new(),
            Some(law) => {
                let ends = at_limits(opened, index).map(|[low, high]| format!("{low:.1} .. {high:.1} "));
                format!("{}{}{}", ends.unwrap_or_default(), law_word(law), seen.mark(known.passive.as_ref()))
            }
        };
        let (strength, fatigue) = match &coordinate.groups {
            None => (String::new(), String::new()),
            Some([positive, negative]) => (
                format!(
                    "{:.0} / {:.0}{}",
                    positive.strength.peak,
                    negative.strength.peak,
                    known.strength.iter().map(|source| seen.mark(Some(source))).collect::<String>()
                ),
                format!("{}{}", known.class.unwrap_or("of a class"), seen.mark(known.fatigue.as_ref())),
            ),
        };
        let default = format!("{}{unit}", shown(coordinate.default));
        let range = format!("{range}{}", seen.mark(known.range.as_ref()));
        table.add_row([
            coordinate.name.clone(),
            coordinate.positive.clone(),
            range,
            default,
            passive,
            strength,
            fatigue,
        ]);
    }
    table
}
