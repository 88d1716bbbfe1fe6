//! Writes the file: the page with its style, data and scripts, and the policy that names what it may do.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

use crate::Report;
use crate::data::data;

const PAGE: &str = include_str!("../page/page.html");
pub(crate) const STYLE: &str = include_str!("../page/style.css");
/// In this order they form one script.
const SCRIPTS: [&str; 10] = [
    include_str!("../page/data.js"),
    include_str!("../page/meshes.js"),
    include_str!("../page/camera.js"),
    include_str!("../page/painter.js"),
    include_str!("../page/skin.js"),
    include_str!("../page/muscles.js"),
    include_str!("../page/body.js"),
    include_str!("../page/charts.js"),
    include_str!("../page/cycles.js"),
    include_str!("../page/page.js"),
];

/// plotly.js, its `basic` distribution (version and source in `vendor/plotly.js/README.md`).
const PLOTLY: &str = include_str!("../vendor/plotly.js/plotly-basic.min.js");

/// Writes the page.
///
/// The page's policy allows no request at all, and exactly two scripts, by their hashes. plotly.js stands in the page as text and
/// becomes a script once body and words are painted.
/// Inline style is allowed (`unsafe-inline`), because plotly.js sets style attributes; without a network it cannot send anything.
/// Images may come from the page itself, because plotly.js makes one when a chart is saved.
pub fn write(report: &Report) -> String {
    write_with(report, PLOTLY)
}

/// The same with the text of plotly.js given, for a program that does not carry it.
pub fn write_with(report: &Report, plotly: &str) -> String {
    let script = SCRIPTS.concat();
    let policy = format!(
        "default-src 'none'; script-src '{}' '{}'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'",
        hash(plotly),
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
        "plotly" => plotly,
        _ => "",
    };
    let mut page = String::with_capacity(plotly.len() + data.len() + (1 << 18));
    // Places are searched in our own text only, never in inserted text.
    let mut rest = PAGE;
    while let Some((before, (place, after))) = rest.split_once("{{").and_then(|(b, a)| Some((b, a.split_once("}}")?))) {
        page.push_str(before);
        page.push_str(fill(place));
        rest = after;
    }
    page.push_str(rest);
    page
}

/// The hash by which the policy names a script.
fn hash(script: &str) -> String {
    // Browsers hash the parsed text, in which every end of line is one character.
    let script = script.replace("\r\n", "\n").replace('\r', "\n");
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(script)))
}

/// The text with the characters escaped that begin elements and entities.
pub(crate) fn escape(text: &str) -> String {
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
    fn no_script_contains_the_end_of_its_element() {
        for script in [PLOTLY, &SCRIPTS.concat()] {
            assert!(!script.to_lowercase().contains("</script") && !script.contains("<!--"));
        }
    }

    #[test]
    fn every_place_is_filled_once_and_placeholders_in_titles_stay_text() {
        let page = write(&Report { title: "{{script}} <b>&".to_owned(), ..Report::default() });
        assert!(page.contains("<title>{{script}} &lt;b&gt;&amp;</title>"));
        assert!(!PAGE.is_empty() && page.ends_with("</html>\n"));
        for place in ["{{policy}}", "{{style}}", "{{data}}", "{{plotly}}"] {
            assert!(!page.contains(place), "{place}");
        }
        assert_eq!(page.matches("{{script}}").count(), 2, "the title's, and the same in the data");
    }

    #[test]
    fn our_own_text_names_no_address_and_no_request() {
        for text in [PAGE, STYLE].into_iter().chain(SCRIPTS) {
            for word in ["http:", "https:", "fetch(", "XMLHttpRequest", "WebSocket", "innerHTML", "eval(", "import("] {
                assert!(!text.contains(word), "{word}");
            }
        }
    }
}
