//! Looks at report pages in a headless Chromium: prints how large they are, how long they take to open (words and
//! charts drawn, then the body and the page at rest; since the browser was asked for the page) and how fast the slider answers, and takes
//! pictures of them: light, dark, on a phone and on paper.
//!
//! `cargo run --release -p contrapposto-report --example look -- PICTURES out/report.html ...`

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a tool for developers")]

#[path = "../tests/support/chromium.rs"]
#[allow(dead_code, reason = "the tests press keys")]
mod chromium;

use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use chromium::Chromium;
use serde_json::{Value, json};

/// Thirty places of the slider, each from its event to the next painted frame, ms; sorted.
const SLIDE: &str = "(async () => {
  const slider = document.getElementById('slider'), took = [], next = () => new Promise(requestAnimationFrame);
  for (let i = 0; i < 30; i++) {
    await next();
    const begin = performance.now();
    slider.value = slider.max * ((i * 7) % 30) / 29;
    slider.dispatchEvent(new Event('input'));
    await next();
    await new Promise((done) => { const c = new MessageChannel(); c.port1.onmessage = done; c.port2.postMessage(0); });
    took.push(performance.now() - begin);
  }
  return took.sort((a, b) => a - b);
})()";

/// Number of times that each page is opened.
const OPENINGS: usize = 5;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let pictures = arguments.next().expect("a folder for the pictures, then pages");
    std::fs::create_dir_all(&pictures).unwrap();
    for page in arguments {
        look(Path::new(&page), Path::new(&pictures));
    }
}

fn look(page: &Path, pictures: &Path) {
    let name = page.parent().and_then(Path::file_name).map_or("report".into(), |name| name.to_string_lossy());
    let text = std::fs::read_to_string(page).unwrap();
    let data = text.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap().len();
    let mut times = vec![];
    for _ in 0..OPENINGS {
        let mut browser = Chromium::start_quietly();
        size(&mut browser, 1400, 900, 1);
        // Besides the clock, the processor time of the page's own thread: it hardly depends on who else uses the machine.
        browser.call("Performance.enable", json!({ "timeDomain": "threadTicks" }));
        browser.open(page);
        let mark = |name: &str| format!("Number(document.documentElement.dataset.{name}) / 1000");
        let mut moment = |name: &str| browser.evaluate(&mark(name)).as_f64().unwrap();
        times.push([moment("charted"), moment("ready"), busy(&mut browser)]);
    }
    let [charted, ready, opening] = [0, 1, 2].map(|k| middle(times.iter().map(|time| time[k])));
    let mut browser = Chromium::start();
    size(&mut browser, 1400, 900, 1);
    browser.call("Performance.enable", json!({ "timeDomain": "threadTicks" }));
    browser.open(page);
    let before = busy(&mut browser);
    let took: Vec<f64> = serde_json::from_value(browser.evaluate(SLIDE)).unwrap();
    let slide = 1e3 * (busy(&mut browser) - before) / 30.0;
    println!(
        "{name}: {:.2} MB, of which data {:.2} MB; words and charts after {charted:.2} s, the body after {ready:.2} s \
         ({opening:.2} s of processor; middle of {OPENINGS}); slider answers in {:.0} ms (middle of 30), {:.0} ms at most \
         ({slide:.0} ms of processor); {} requests, {} complaints; load of the machine {}",
        text.len() as f64 / 1e6,
        data as f64 / 1e6,
        took[took.len() / 2],
        took[took.len() - 1],
        browser.requests().len(),
        browser.complaints().len(),
        std::fs::read_to_string("/proc/loadavg").unwrap_or_default().split(' ').next().unwrap_or_default(),
    );
    // As a reader opens it.
    browser.open(page);
    for (kind, scheme, width) in [("light", "light", 1400), ("dark", "dark", 1400), ("phone", "light", 390)] {
        size(&mut browser, width, if width < 500 { 844 } else { 900 }, if width < 500 { 2 } else { 1 });
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        browser.call("Emulation.setEmulatedMedia", json!({ "media": "", "features": features }));
        settle(&mut browser);
        let shot = browser.call("Page.captureScreenshot", json!({ "captureBeyondViewport": true }));
        save(&pictures.join(format!("{name}-{kind}.png")), &shot);
    }
    size(&mut browser, 1400, 900, 1);
    browser.call("Emulation.setEmulatedMedia", json!({ "media": "", "features": [] }));
    settle(&mut browser);
    let paper = json!({ "printBackground": true, "preferCSSPageSize": true, "paperWidth": 8.27, "paperHeight": 11.69 });
    let paper = browser.call("Page.printToPDF", paper);
    save(&pictures.join(format!("{name}.pdf")), &paper);
}

fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Processor time of the page's thread so far, s.
fn busy(browser: &mut Chromium) -> f64 {
    let metrics = browser.call("Performance.getMetrics", json!({}));
    let found =
        metrics["metrics"].as_array().and_then(|all| all.iter().find(|metric| metric["name"] == "TaskDuration"));
    found.and_then(|metric| metric["value"].as_f64()).unwrap_or(f64::NAN)
}

fn size(browser: &mut Chromium, width: u32, height: u32, scale: u32) {
    let size = json!({ "width": width, "height": height, "deviceScaleFactor": scale, "mobile": width < 500 });
    browser.call("Emulation.setDeviceMetricsOverride", size);
}

fn settle(browser: &mut Chromium) {
    browser.evaluate("new Promise((done) => setTimeout(() => done(1), 800))");
}

fn save(path: &Path, answer: &Value) {
    std::fs::write(path, BASE64_STANDARD.decode(answer["data"].as_str().unwrap()).unwrap()).unwrap();
}
