//! Writes a picture as SVG text: one element a line, coordinates with at most two decimals.

use std::fmt::{Display, Formatter, Result, Write};

use crate::path::{Path, Step};
use crate::shape::{Align, Shape, Text};
use crate::style::{Ink, PAPER, WIDTH};

/// Fonts in the order of preference; the first is the font of the PNG.
const FONTS: &str = "&apos;DejaVu Sans&apos;, Verdana, Helvetica, Arial, sans-serif";

/// The SVG text of a picture of the given height.
pub(crate) fn svg(height: f64, shapes: &[Shape]) -> String {
    let (width, height) = (Px(WIDTH), Px(height));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\" font-family=\"{FONTS}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n"
    );
    for shape in shapes {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{shape}");
    }
    text.push_str("</svg>\n");
    text
}

impl Display for Shape {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            Self::Path { path, fill, stroke, width } => {
                let width = Px(*width);
                write!(f, "<path d=\"{path}\" stroke=\"{stroke}\" stroke-width=\"{width}\" fill=\"")?;
                match fill {
                    Some((fill, opacity)) if *opacity < 1.0 => {
                        write!(f, "{fill}\" fill-opacity=\"{}\"/>", Px(*opacity))
                    }
                    Some((fill, _)) => write!(f, "{fill}\"/>"),
                    None => write!(f, "none\"/>"),
                }
            }
            Self::Circle { center, radius, fill, rim, rim_width } => {
                let (x, y, r, rim_width) = (Px(center.0), Px(center.1), Px(*radius), Px(*rim_width));
                write!(f, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\" ")?;
                write!(f, "stroke=\"{rim}\" stroke-width=\"{rim_width}\"/>")
            }
            Self::Block { area, fill } => {
                let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(Px);
                write!(f, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>")
            }
            Self::Text(text) => text.fmt(f),
        }
    }
}

impl Display for Text {
    fn fmt(&self, f: &mut Formatter) -> Result {
        let (x, y) = (Px(self.at.0), Px(self.at.1));
        let anchor = match self.align {
            Align::Left => "start",
            Align::Middle => "middle",
            Align::Right => "end",
        };
        write!(f, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" ", self.size)?;
        if self.bold {
            write!(f, "font-weight=\"bold\" ")?;
        }
        if self.upward {
            write!(f, "transform=\"rotate(-90,{x},{y})\" ")?;
        }
        write!(f, "fill=\"{}\">{}</text>", self.ink, escape(&self.content))
    }
}

impl Display for Path {
    fn fmt(&self, f: &mut Formatter) -> Result {
        for step in &self.0 {
            match *step {
                Step::Move((x, y)) => write!(f, "M{} {}", Px(x), Px(y))?,
                Step::Line((x, y)) => write!(f, "L{} {}", Px(x), Px(y))?,
                Step::Curve(a, b, end) => {
                    let [x1, y1, x2, y2, x, y] = [a.0, a.1, b.0, b.1, end.0, end.1].map(Px);
                    write!(f, "C{x1} {y1} {x2} {y2} {x} {y}")?;
                }
                Step::Close => write!(f, "Z")?,
            }
        }
        Ok(())
    }
}

impl Display for Ink {
    fn fmt(&self, f: &mut Formatter) -> Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// A length with at most two decimals.
struct Px(f64);

impl Display for Px {
    fn fmt(&self, f: &mut Formatter) -> Result {
        let digits = format!("{:.2}", self.0);
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if digits == "-0" { "0" } else { digits })
    }
}

/// As text of an element.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_at_most_two_decimals_and_no_trailing_zeros() {
        let cases = [(0.0, "0"), (-0.001, "0"), (-0.01, "-0.01"), (0.57, "0.57"), (100.0, "100"), (12.305, "12.3")];
        for (value, text) in cases {
            assert_eq!(Px(value).to_string(), text);
        }
    }

    #[test]
    fn a_path_is_written_step_by_step() {
        let path = Path(vec![
            Step::Move((1.0, 2.0)),
            Step::Line((3.5, -4.0)),
            Step::Curve((1.0, 1.0), (2.0, 2.0), (3.0, 3.126)),
            Step::Close,
        ]);
        assert_eq!(path.to_string(), "M1 2L3.5 -4C1 1 2 2 3 3.13Z");
    }
}
