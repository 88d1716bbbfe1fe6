//! `contrapposto inspect`: the contents of a model or a scenario, ignored and added parts, and the source of every number.

use std::path::Path;

use contrapposto::model::Model;
use contrapposto_formats::read_contents;
use contrapposto_plot::body_map;

use crate::args::InspectArgs;
use crate::fail::Fail;
use crate::model_file::open_without_mesh_mass;
use crate::output::{Folder, json_text, print};
use crate::scenario_file::ScenarioFile;
use crate::view::body_map::map_of_body;
use crate::view::text::inspect::scenario::{readable_scenario, scenario_report};
use crate::view::text::inspect::{readable, report};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Fail> {
    if args.model.model.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        return inspect_scenario(&args.model.model, args);
    }
    let opened = open_without_mesh_mass(&args.model, true)?.with_fatigue(&args.fatigue.choice()?);
    let file = args.model.model.display().to_string();
    draw(&opened.model, args)?;
    if args.json {
        let text = report(&opened, &file);
        return print(&json_text("JSON", &text)?);
    }
    print(&readable(&opened, &file))
}

/// Draws the body, where a folder is given.
fn draw(model: &Model, args: &InspectArgs) -> Result<(), Fail> {
    let Some(out) = &args.out else { return Ok(()) };
    let figure = body_map(&map_of_body(model)?);
    let png = figure.png().map_err(|error| Fail::job("PNG", error))?;
    Folder::open(out)?.write(&[("body.svg", figure.svg().as_bytes()), ("body.png", png.as_slice())])
}

fn inspect_scenario(path: &Path, args: &InspectArgs) -> Result<(), Fail> {
    let model = &args.model;
    if model.overlay.is_some() || model.root.is_some() || model.passive.is_some() || model.person.is_some() {
        let why = "a scenario says in its table [model] what --overlay, --root, --passive and --person say of a model";
        return Err(Fail::Refused(format!("{}: {why}", path.display())));
    }
    let ScenarioFile { name, bytes, model, .. } = ScenarioFile::read(path)?;
    let contents = read_contents(&name, &bytes, model)?;
    draw(&contents.model, args)?;
    let report = scenario_report(&contents, &name);
    print(&if args.json { json_text("JSON", &report)? } else { readable_scenario(&report) })
}
