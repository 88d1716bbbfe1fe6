//! The page of postures side by side.

use contrapposto_report::{Entry, Fact, List, Moments, Report, Table};

use super::figure::figure;
use super::page;
use crate::fail::Fail;
use crate::view::frame::Frame;
use crate::view::muscles::hardest;
use crate::view::scene::Scene;
use crate::view::stage::Stage;
use crate::view::text::compare::{CompareText, ComparedPosture};
use crate::view::words::{how_long, percent};

/// The page of a comparison. The body is drawn where all postures are of one body and known; tables say the rest.
pub(crate) fn report_of_comparison(postures: &[ComparedPosture], text: &CompareText) -> Result<String, Fail> {
    let frames: Vec<Frame> = postures.iter().filter_map(|compared| compared.frame.clone()).collect();
    let names: Vec<String> =
        postures.iter().map(|compared| format!("{}: {}", compared.letter, compared.title)).collect();
    let Some(first) = postures.first() else { return Ok(contrapposto_report::write(&Report::default())) };
    let same = postures
        .iter()
        .all(|compared| compared.model.name() == first.model.name() && compared.supports.len() == first.supports.len());
    let mut report = if same && frames.len() == postures.len() {
        // Things and loads that differ from posture to posture are not drawn.
        let alike = postures.iter().all(|other| other.things == first.things && other.loads == first.loads);
        let (things, loads) =
            if alike { (first.things.as_slice(), first.loads.as_slice()) } else { (&[][..], &[][..]) };
        let stage = Stage::still(&first.supports, things, loads);
        let scene = Scene::of("Compared postures", &first.model, &first.posture, &frames, stage);
        let main = first.verdict.who.map_or(0, |group| group.coordinate);
        scene.report(Moments::Postures(names.clone()), main)?
    } else {
        Report { title: "Compared postures".to_owned(), ..Report::default() }
    };
    report.headline.clone_from(&text.sentence);
    let fact = |compared: &ComparedPosture| Fact {
        name: compared.letter.to_string(),
        text: compared.verdict.sentence.trim_end_matches('.').to_owned(),
    };
    report.facts = postures.iter().map(fact).collect();
    report.figures = postures
        .iter()
        .map(|compared| {
            let none = if compared.verdict.kind.is_done() { "no limit" } else { "no time" };
            let time = compared.verdict.seconds.map_or_else(|| none.to_owned(), how_long);
            figure(&compared.letter.to_string(), time, &compared.title)
        })
        .collect();
    let entry = |(frame, compared): (usize, &ComparedPosture)| Entry {
        frame,
        time: None,
        joint: Some(report.main),
        text: format!("{}: {} {}", compared.letter, compared.title, compared.verdict.sentence),
    };
    report.list = List {
        heading: "Postures".to_owned(),
        entries: if report.joints.is_empty() { vec![] } else { postures.iter().enumerate().map(entry).collect() },
        none: String::new(),
    };
    report.table = table(postures);
    Ok(page(&first.model, report))
}

fn table(postures: &[ComparedPosture]) -> Table {
    let row = |compared: &ComparedPosture| {
        let frame = compared.frame.as_ref();
        let hardest = frame.and_then(|frame| hardest(&compared.model, frame));
        vec![
            format!("{}: {}", compared.letter, compared.title),
            compared.verdict.sentence.clone(),
            frame.map_or_else(|| "not known".to_owned(), |frame| format!("{:.4}", frame.effort())),
            hardest.map_or_else(String::new, |(name, load)| format!("{name}, {}", percent(load))),
        ]
    };
    Table {
        heading: "Side by side".to_owned(),
        columns: ["Posture", "Answer", "Effort", "Highest load"].map(str::to_owned).to_vec(),
        rows: postures.iter().map(row).collect(),
    }
}
