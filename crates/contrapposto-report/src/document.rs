//! Writes a page of words, pictures and tables, without a body and without any script.

use crate::page::{STYLE, escape};
use crate::{Figure, Table};

/// Everything such a page shows.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// Title of the job.
    pub title: String,
    /// The finding in one plain sentence.
    pub headline: String,
    /// The reasons, a sentence each.
    pub reasons: Vec<String>,
    /// The most important numbers.
    pub figures: Vec<Figure>,
    /// Pictures, one below the other.
    pub pictures: Vec<Picture>,
    /// Tables below the pictures.
    pub tables: Vec<Table>,
    /// Remarks at the end, a paragraph each.
    pub notes: Vec<String>,
}

/// A picture with its words.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Text of the SVG, which is put into the page as it is.
    pub svg: String,
    /// The picture in words, for those who do not see it.
    pub words: String,
}

/// Rules of such pages besides those of all.
const DOCUMENT_STYLE: &str =
    "figure { margin: .8rem 0; } figure svg { max-width: 100%; height: auto; border-radius: 8px; }
.scroll { overflow-x: auto; } th, td { text-align: left; } td { white-space: normal; } section p { max-width: 62rem; margin: .3rem 0; }
";

/// Writes the page. Its policy allows no request and no script.
pub fn write_document(document: &Document) -> String {
    let policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";
    let title = if document.title.is_empty() { "contrapposto" } else { &document.title };
    let reasons: String = document.reasons.iter().map(|reason| format!("<p>{}</p>\n", escape(reason))).collect();
    let figures: String = document.figures.iter().map(figure).collect();
    let pictures: String = document.pictures.iter().map(picture).collect();
    let tables: String = document.tables.iter().map(table).collect();
    let notes: String = document.notes.iter().map(|note| format!("<p>{}</p>\n", escape(note))).collect();
    let (title, headline) = (escape(title), escape(&document.headline));
    format!(
        "<!doctype html>\n<html lang=\"en\" data-bodiless>\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
         <style>\n{STYLE}{DOCUMENT_STYLE}</style>\n</head>\n<body>\n<header>\n<p id=\"title\">{title}</p>\n<h1>{headline}</h1>\n\
         <div id=\"reasons\">\n{reasons}</div>\n<ul id=\"figures\" aria-label=\"Most important numbers\">\n{figures}</ul>\n</header>\n\
         <main>\n{pictures}{tables}<section aria-label=\"Remarks\">\n<h2>Remarks</h2>\n{notes}</section>\n</main>\n</body>\n</html>\n"
    )
}

fn figure(figure: &Figure) -> String {
    let [label, value, note] = [&figure.label, &figure.value, &figure.note].map(|text| escape(text));
    format!("<li><span>{label}</span><b>{value}</b><span>{note}</span></li>\n")
}

fn picture(picture: &Picture) -> String {
    let words = escape(&picture.words).replace('"', "&quot;");
    format!("<figure role=\"img\" aria-label=\"{words}\">\n{}</figure>\n", picture.svg)
}

fn table(table: &Table) -> String {
    let cells = |row: &[String], tag: &str| {
        let cells: String = row.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let head = cells(&table.columns, "th scope=\"col\"").replace("</th scope=\"col\">", "</th>");
    let rows: String = table.rows.iter().map(|row| cells(row, "td")).collect();
    let heading = escape(&table.heading);
    format!(
        "<section>\n<h2>{heading}</h2>\n<div class=\"scroll\"><table>\n<thead>{head}</thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n</section>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_markup_are_text_everywhere() {
        let name = "</p><script>alert(\"1\")</script>&".to_owned();
        let document = Document {
            title: name.clone(),
            headline: name.clone(),
            reasons: vec![name.clone()],
            figures: vec![Figure { label: name.clone(), value: name.clone(), note: name.clone() }],
            pictures: vec![Picture { svg: "<svg></svg>\n".to_owned(), words: name.clone() }],
            tables: vec![Table { heading: name.clone(), columns: vec![name.clone()], rows: vec![vec![name.clone()]] }],
            notes: vec![name.clone()],
        };
        let page = write_document(&document);
        assert!(!page.contains("<script"));
        assert_eq!(page.matches("&lt;script&gt;alert(").count(), 12);
        assert!(page.contains("aria-label=\"&lt;/p&gt;&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;\""));
        assert!(page.contains("<th scope=\"col\">&lt;/p&gt;") && page.contains("<svg></svg>"));
    }
}
