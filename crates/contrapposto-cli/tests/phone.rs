//! Pages that the program writes, in a real browser: each is five screens of a phone at most, and two sheets of paper.

#[path = "../../contrapposto-report/tests/support/chromium.rs"]
#[allow(dead_code, reason = "other tests press keys")]
mod chromium;
use crate::support;

use std::path::{Path, PathBuf};

use chromium::Chromium;
use serde_json::json;
use support::{contrapposto, write};

/// Width and height of a phone, CSS pixels.
const PHONE: (u32, u32) = (390, 844);
/// Screens of a phone, and sheets of paper, that a page may fill.
const MOST_SCREENS: f64 = 5.0;
const MOST_SHEETS: usize = 2;

fn scenario(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    std::fs::read_to_string(path).unwrap()
}

/// The page of a call of the program, which may answer that the job cannot be done.
fn page(folder: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    let out = folder.join(name);
    let run = contrapposto(arguments).arg("--out").arg(&out).folder(folder).run();
    assert!(run.code <= 1, "{name}: {}", run.stderr);
    let pages = ["report.html", "population.html"].map(|file| out.join(file));
    let found = pages.into_iter().find(|page| page.is_file());
    found.unwrap_or_else(|| panic!("{name} has no page: {}", run.stdout))
}

/// Pages of every kind of report. Jobs of minutes and hours are cut short and few changes are tried; a table of changes with the rows of the
/// whole job is put in by [`LENGTHEN`].
fn pages(folder: &Path) -> Vec<(&'static str, PathBuf)> {
    let shortened = |name: &str, duration: &str, seconds: u32| {
        let text = scenario(name);
        assert!(text.contains(duration), "{name}");
        write(folder, name, &text.replace(duration, &format!("duration_s = {seconds}")))
    };
    let counter = shortened("counter.toml", "duration_s = 7200", 900);
    let tool = shortened("hold-tool.toml", "duration_s = 480", 240);
    let floor = shortened("reach-floor.toml", "duration_s = 120", 5);
    let stand = write(folder, "stand.toml", &scenario("stand-relaxed.toml"));
    let fixed = write(folder, "fixed.toml", &scenario("stand-relaxed-feet-fixed.toml"));
    let reach = write(folder, "reach.toml", &scenario("poses/out-of-reach.toml"));
    let motion = write(folder, "lower.csv", "time,elbow_flex_r_deg\n0,90\n60,90\n120,20\n");
    let few = "--suggest-steps";
    let assess = ["assess", "adult", &motion, "--load", "hand_r 3kg", "--support", "calcn_l,calcn_r"];
    let (hinge, still) = (
        write(folder, "m.osim", &support::hinge_with_muscles(&[("front", 0.04, 500.0), ("behind", -0.04, 500.0)])),
        write(folder, "still.csv", "time,q_deg\n0,0\n20,0\n"),
    );
    let muscles = ["assess", &hinge, &still, "--force", "b -20,0,0 at 0,-0.3,0 world", "--fixed-root"];
    let population = ["population", &tool, "--rows", "4"];
    vec![
        ("counter", page(folder, "counter", &["simulate", &counter, few, "2000"])),
        ("hold-tool", page(folder, "tool", &["simulate", &tool, few, "2000"])),
        ("reach-floor", page(folder, "floor", &["simulate", &floor, few, "2000"])),
        ("assess", page(folder, "assess", &assess)),
        ("single muscles", page(folder, "muscles", &muscles)),
        ("relax", page(folder, "relax", &["relax", &stand, few, "2000"])),
        ("compare", page(folder, "compare", &["compare", &stand, &fixed])),
        ("population", page(folder, "population", &population)),
        ("pose", page(folder, "pose", &["pose", &reach, few, "2000"])),
    ]
}

/// Adds rows to a table of changes until it has five, as whole jobs have them.
const LENGTHEN: &str = "(() => { const body = document.querySelector('#changes tbody');
  if (!body || !body.rows.length) return;
  document.getElementById('changes').hidden = false;
  while (body.rows.length < 5) {
    const row = body.rows[0].cloneNode(true);
    row.cells[0].textContent = 'right hand 10 cm nearer (horizontal distance from the middle of the body 0.34 m instead of 0.44 m)';
    body.append(row);
  } })()";

#[test]
#[ignore = "needs a browser: a Chromium, also by CONTRAPPOSTO_CHROMIUM"]
fn every_kind_of_report_is_five_screens_of_a_phone_and_two_sheets_of_paper_at_most() {
    let folder = tempfile::tempdir().unwrap();
    let mut browser = Chromium::start();
    let (width, height) = PHONE;
    let phone = json!({ "width": width, "height": height, "deviceScaleFactor": 2, "mobile": true });
    browser.call("Emulation.setDeviceMetricsOverride", phone);
    for (name, page) in pages(folder.path()) {
        let text = std::fs::read_to_string(&page).unwrap();
        if text.contains("id=\"data\"") {
            browser.open(&page);
            browser.evaluate(LENGTHEN);
        } else {
            browser.call("Page.navigate", json!({ "url": format!("file://{}", page.display()) }));
            browser.wait_for("document.readyState === 'complete' && document.querySelector('h1') !== null");
        }
        let tall = browser.evaluate("document.documentElement.scrollHeight").as_f64().unwrap();
        let wide = browser.evaluate("document.documentElement.scrollWidth").as_f64().unwrap();
        println!("{name}: {:.2} screens", tall / f64::from(height));
        assert!(tall <= MOST_SCREENS * f64::from(height), "{name}: {:.2} screens", tall / f64::from(height));
        assert!(wide <= f64::from(width), "{name}: {wide} px wide");
        let sheets = browser.sheets();
        println!("{name}: {sheets} sheets");
        assert!(sheets <= MOST_SHEETS, "{name}: {sheets} sheets");
        assert_eq!(browser.complaints(), Vec::<String>::new(), "{name}");
    }
}
