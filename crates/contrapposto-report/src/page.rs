//! The file itself: what stands in it, and what it is allowed to do.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

use crate::Report;
use crate::data::data;

const PAGE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/style.css");
/// One after the other they are one script.
const SCRIPTS: [&str; 4] = [
    include_str!("../page/data.js"),
    include_str!("../page/body.js"),
    include_str!("../page/charts.js"),
    include_str!("../page/page.js"),
];

/// plotly.js, its `basic` distribution (version and source in `vendor/plotly.js/README.md`).
const PLOTLY: &str = include_str!("../vendor/plotly.js/plotly-basic.min.js");

/// Writes the page.
///
/// Its policy: nothing is fetched from anywhere; the two scripts run because their hashes are named, and no other does. plotly.js
/// stands in it as text and becomes a script once body and words are painted.
/// Style may stand inside (`unsafe-inline`): plotly.js sets style attributes, and without a network style can tell nobody anything.
/// Pictures may come from the page itself: plotly.js makes them when a chart is saved.
pub fn write(report: &Report) -> String {
    let script = SCRIPTS.concat();
    let policy = format!(
        "default-src 'none'; script-src '{}' '{}'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'",
        hash(PLOTLY),
        hash(&script)
    );
    let title = if report.title.is_empty() { "contrapposto" } else { &report.title };
    let (title, data) = (escape(title), data(report));
    let fill = |place: &str| match place {
        "policy" => policy.as_str(),
        "title" => &title,
        "style" => STYLE,
        "data" => &data,
        "script" => &script,
        "plotly" => PLOTLY,
        _ => "",
    };
    let mut page = String::with_capacity(PLOTLY.len() + data.len() + (1 << 18));
    // Places are looked for in our own text only, never in what was filled in.
    let mut rest = PAGE;
    while let Some((before, (place, after))) = rest.split_once("{{").and_then(|(b, a)| Some((b, a.split_once("}}")?))) {
        page.push_str(before);
        page.push_str(fill(place));
        rest = after;
    }
    page.push_str(rest);
    page
}

/// As the policy names a script.
fn hash(script: &str) -> String {
    // Browsers hash what they have parsed, where every end of line is one character.
    let script = script.replace("\r\n", "\n").replace('\r', "\n");
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(script)))
}

/// As text of an element.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotly_is_the_file_that_its_readme_names() {
        let digest: String = Sha256::digest(PLOTLY).iter().map(|byte| format!("{byte:02x}")).collect();
        let version =
            PLOTLY.split("plotly.js (basic - minified) v").nth(1).and_then(|rest| rest.lines().next()).unwrap();
        let readme = include_str!("../vendor/plotly.js/README.md");
        assert!(readme.contains(&digest), "SHA-256 {digest}");
        assert!(readme.contains(&format!("version {version},")), "version {version}");
    }

    #[test]
    fn no_script_ends_its_element() {
        for script in [PLOTLY, &SCRIPTS.concat()] {
            assert!(!script.to_lowercase().contains("</script") && !script.contains("<!--"));
        }
    }

    #[test]
    fn every_place_is_filled_once() {
        let page = write(&Report { title: "{{script}} <b>&".to_owned(), ..Report::default() });
        assert!(page.contains("<title>{{script}} &lt;b&gt;&amp;</title>"));
        assert!(!PAGE.is_empty() && page.ends_with("</html>\n"));
        for place in ["{{policy}}", "{{style}}", "{{data}}", "{{plotly}}"] {
            assert!(!page.contains(place), "{place}");
        }
        assert_eq!(page.matches("{{script}}").count(), 2, "the title's, and the same in the data");
    }

    #[test]
    fn our_own_text_fetches_nothing() {
        for text in [PAGE, STYLE].into_iter().chain(SCRIPTS) {
            for word in ["http:", "https:", "fetch(", "XMLHttpRequest", "WebSocket", "innerHTML", "eval(", "import("] {
                assert!(!text.contains(word), "{word}");
            }
        }
    }
}
