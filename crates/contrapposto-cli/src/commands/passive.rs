//! `contrapposto passive`: the passive torque of one coordinate, drawn and with its source.

use std::path::Path;

use contrapposto::model::{Adult, adult, data};
use contrapposto::passive::PassiveCurve;
use contrapposto_plot::{PassiveChart, passive_curve};
use serde::Serialize;

use crate::args::PassiveArgs;
use crate::fail::Fail;
use crate::output::{Folder, json_text, print};
use crate::view::charts::angle_label;

/// Number of intervals of the drawn curve.
const CURVE_INTERVALS: usize = 300;

#[derive(Serialize)]
struct PassiveText {
    coordinate: String,
    curve: String,
    positive: String,
    range_deg: [f64; 2],
    flattest_deg: [f64; 2],
    torque_at_limits_nm: [f64; 2],
    status: String,
    source: String,
    note: String,
    angle_deg: Vec<f64>,
    torque_nm: Vec<f64>,
    slope_nm_per_rad: Vec<f64>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Listed {
    coordinate: String,
    curve: Option<String>,
    status: Option<String>,
    source: Option<String>,
}

/// The library of sourced curves, keyed by coordinate name.
fn list(json: bool) -> Result<(), Fail> {
    let library = data::library();
    let listed = library.coordinate_names().map(|coordinate| {
        let curve = library.sources(&coordinate).and_then(|sources| sources.curve);
        let row = curve.and_then(|curve| library.curve(curve));
        Listed {
            curve: curve.map(str::to_owned),
            status: row.map(|row| row.reference.status.to_string()),
            source: row.map(|row| row.reference.source.clone()),
            coordinate,
        }
    });
    if json {
        let listed: Vec<Listed> = listed.collect();
        return print(&json_text("JSON", &listed)?);
    }
    let mut text = String::new();
    for Listed { coordinate, curve, status, source } in listed {
        let curve = curve.unwrap_or_else(|| "none (root)".into());
        text += &format!("{coordinate:20} {curve:27} {}\n", status.unwrap_or_default());
        if let Some(source) = source {
            text += &format!("{:20} {source}\n", "");
        }
    }
    print(&text)
}

/// A curve, its name, and the direction of its coordinate.
struct Found {
    curve: PassiveCurve,
    curve_name: String,
    positive: String,
}

pub(crate) fn passive(args: &PassiveArgs) -> Result<(), Fail> {
    let Some(name) = args.coordinate.as_deref() else { return list(args.json) };
    let Found { curve, curve_name, positive } = find(name)?;
    let row = data::library().curve(&curve_name).ok_or_else(|| Fail::Refused(format!("no data row `{curve_name}`")))?;
    let (min, max) = curve.range();
    let (flat_min, flat_max) = curve.flattest_zone();
    let mut text = PassiveText {
        coordinate: name.to_owned(),
        curve: curve_name.clone(),
        positive: positive.clone(),
        range_deg: [min.to_degrees(), max.to_degrees()],
        flattest_deg: [flat_min.to_degrees(), flat_max.to_degrees()],
        torque_at_limits_nm: [curve.torque(min), curve.torque(max)],
        status: row.reference.status.to_string(),
        source: row.reference.source.clone(),
        note: row.reference.note.clone(),
        angle_deg: vec![],
        torque_nm: vec![],
        slope_nm_per_rad: vec![],
        files: vec![],
    };
    for i in 0..=CURVE_INTERVALS {
        let angle = min + (max - min) * i as f64 / CURVE_INTERVALS as f64;
        let (torque, slope) = curve.torque_and_slope(angle);
        text.angle_deg.push(angle.to_degrees());
        text.torque_nm.push(torque);
        text.slope_nm_per_rad.push(slope);
    }
    if args.out.is_some() || !args.json {
        let folder = Folder::open(args.out.as_deref().unwrap_or(Path::new(".")))?;
        draw(&folder, &mut text)?;
    }
    if args.json {
        return print(&json_text("JSON", &text)?);
    }
    let [at_min, at_max] = text.torque_at_limits_nm;
    print(&format!(
        "{name} ({positive} positive), curve `{curve_name}`\n\
         range    {:.1} .. {:.1} deg, passive torque {at_min:.2} .. {at_max:.2} N m\n\
         flattest {:.1} deg, slope {:.3} N m/rad\n\
         status   {}\nsource   {}\n{}pictures {}\n",
        text.range_deg[0],
        text.range_deg[1],
        curve.flattest_angle().to_degrees(),
        curve.slope(curve.flattest_angle()),
        text.status,
        text.source,
        if text.note.is_empty() { String::new() } else { format!("note     {}\n", text.note) },
        text.files.join(", "),
    ))
}

/// A coordinate of the adult, or a built-in curve over the range it is meant for.
fn find(name: &str) -> Result<Found, Fail> {
    let library = data::library();
    let model = adult(&Adult::default()).map_err(|error| Fail::job("adult", error))?;
    if let (Some(index), Some(sources)) = (model.coordinate(name), library.sources(name)) {
        let coordinate = &model.coordinates()[index];
        // A law coupled to neighbouring joints is shown with them at their defaults.
        let posture = model.default_posture();
        let curve = coordinate.passive.as_ref().and_then(|law| law.curve_at(index, posture.values(), coordinate.range));
        if let (Some(curve), Some(curve_name)) = (curve, sources.curve) {
            let (curve, positive) = (curve.into_owned(), coordinate.positive.clone());
            return Ok(Found { curve, curve_name: curve_name.to_owned(), positive });
        }
    }
    if let Some(row) = library.curve(name) {
        let range = (row.range_deg[0].to_radians(), row.range_deg[1].to_radians());
        let curve = row.over(range, 1.0).map_err(|error| Fail::job(name, error))?;
        return Ok(Found { curve, curve_name: name.to_owned(), positive: row.positive.clone() });
    }
    let coordinates: Vec<String> = library.coordinate_names().collect();
    let curves: Vec<&str> = library.curve_names().collect();
    let hint =
        contrapposto_formats::nearest(name, coordinates.iter().map(String::as_str).chain(curves.iter().copied()));
    let hint = hint.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    Err(Fail::Refused(format!(
        "there is no coordinate or curve `{name}`{hint}\n  coordinates: {}\n  curves: {}",
        coordinates.join(", "),
        curves.join(", ")
    )))
}

fn draw(folder: &Folder, text: &mut PassiveText) -> Result<(), Fail> {
    let chart = PassiveChart {
        title: format!("Passive torque of {}", text.coordinate),
        angle_label: angle_label(&text.coordinate, &text.positive),
        angles_deg: text.angle_deg.clone(),
        torque_nm: text.torque_nm.clone(),
        slope_nm_per_rad: text.slope_nm_per_rad.clone(),
        range_deg: (text.range_deg[0], text.range_deg[1]),
        flattest_deg: Some((text.flattest_deg[0], text.flattest_deg[1])),
        source: format!("{}: {}", text.status, text.source),
    };
    let figure = passive_curve(&chart);
    let (svg, png) = (format!("passive-{}.svg", text.coordinate), format!("passive-{}.png", text.coordinate));
    let drawn = figure.png().map_err(|error| Fail::job("PNG", error))?;
    folder.write(&[(&svg, figure.svg().into_bytes()), (&png, drawn)])?;
    text.files = vec![folder.path(&svg).display().to_string(), folder.path(&png).display().to_string()];
    Ok(())
}
