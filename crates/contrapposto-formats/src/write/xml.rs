//! Writes XML text, and numbers as text.

/// Stands at the head of every file.
const MADE_BY: &str = concat!("Written by contrapposto ", env!("CARGO_PKG_VERSION"), ".");

/// Whether XML 1.0 can hold the character, as itself or as a reference.
pub(super) fn holds(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}

/// A document in the making.
pub(super) struct Xml {
    text: String,
    open: Vec<&'static str>,
}

impl Xml {
    pub(super) fn new() -> Self {
        Self { text: String::new(), open: vec![] }
    }

    /// `text` must not contain `--`.
    pub(super) fn comment(&mut self, text: &str) {
        self.indent();
        self.text.push_str(&format!("<!-- {text} -->\n"));
    }

    pub(super) fn open(&mut self, tag: &'static str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push_str(">\n");
        self.open.push(tag);
    }

    pub(super) fn close(&mut self) {
        if let Some(tag) = self.open.pop() {
            self.indent();
            self.text.push_str(&format!("</{tag}>\n"));
        }
    }

    /// An element without content.
    pub(super) fn leaf(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push_str("/>\n");
    }

    /// An element with text in it.
    pub(super) fn value(&mut self, tag: &str, value: &str) {
        self.start(tag, &[]);
        self.text.push('>');
        self.escape(value);
        self.text.push_str(&format!("</{tag}>\n"));
    }

    /// The document, headed by the name of the program and the list of lost properties.
    pub(super) fn finish(mut self, lost: &[String]) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        let mut head = Self::new();
        head.comment(MADE_BY);
        // Names may hold what no comment can.
        lost.iter().for_each(|lost| head.comment(&format!("Lost: {}", lost.replace("--", "\u{2010}\u{2010}"))));
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}{}", head.text, self.text)
    }

    fn indent(&mut self) {
        self.text.push_str(&"\t".repeat(self.open.len()));
    }

    fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.indent();
        self.text.push('<');
        self.text.push_str(tag);
        for (name, value) in attributes {
            self.text.push_str(&format!(" {name}=\""));
            self.escape(value);
            self.text.push('"');
        }
    }

    fn escape(&mut self, text: &str) {
        for c in text.chars() {
            match c {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '>' => self.text.push_str("&gt;"),
                '"' => self.text.push_str("&quot;"),
                '\t' | '\n' | '\r' => self.text.push_str(&format!("&#{};", c as u32)),
                _ => self.text.push(c),
            }
        }
    }
}

/// The shortest text that reads back as the same number.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Several, separated by spaces.
pub(super) fn numbers<'a>(values: impl IntoIterator<Item = &'a f64>) -> String {
    values.into_iter().map(|&v| number(v)).collect::<Vec<_>>().join(" ")
}

/// The six different numbers of a symmetric matrix: xx yy zz xy xz yz.
pub(super) fn moments(m: &nalgebra::Matrix3<f64>) -> [f64; 6] {
    [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(0, 2)], m[(1, 2)]]
}
