//! What is wrong with an input file, where, and what would be right?

use miette::{Diagnostic, NamedSource, SourceSpan};

/// A refused input. Prints with file, line, column and a caret when shown through `miette`.
#[derive(Debug)]
pub struct InputError(Box<Complaint>);

/// What is wrong, where, and what would be right.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
struct Complaint {
    message: String,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("{label}")]
    span: Option<SourceSpan>,
    label: String,
    #[help]
    help: Option<String>,
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for InputError {}

impl Diagnostic for InputError {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.0.help()
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.0.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.0.labels()
    }
}

/// An input text and its name, to complain about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

impl Source<'_> {
    /// A complaint about `span` (bytes), or about the whole file.
    pub(crate) fn error(
        &self,
        span: Option<std::ops::Range<usize>>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) -> InputError {
        InputError(Box::new(Complaint {
            message: message.into(),
            source_code: NamedSource::new(self.name, self.text.to_owned()),
            span: span.map(|range| SourceSpan::from((range.start, range.end - range.start))),
            label: label.into(),
            help,
        }))
    }
}

/// UTF-8 text of an input file.
///
/// # Errors
/// [`InputError`] with line and column of the first byte that is not UTF-8.
pub fn utf8<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, InputError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned();
        let byte = bytes[error.valid_up_to()];
        let at = good.len();
        let text = good + "?";
        let help = Some("save the file as UTF-8".to_owned());
        Source { name, text: &text }.error(Some(at..at + 1), "the file is not UTF-8", format!("byte 0x{byte:02x}"), help)
    })
}

/// The one of `names` that `given` was probably meant to be.
pub fn nearest<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(given, name), name))
        .filter(|(distance, name)| *distance <= 1 + name.len() / 4)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// "did you mean ..." or the list of what there is.
pub(crate) fn suggestion<'a>(given: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> Option<String> {
    match nearest(given, names.clone()) {
        Some(name) => Some(format!("did you mean `{name}`?")),
        None => {
            let all: Vec<&str> = names.into_iter().collect();
            let shown = all.iter().take(40).copied().collect::<Vec<_>>().join(", ");
            let more = if all.len() > 40 { ", ..." } else { "" };
            (!all.is_empty()).then(|| format!("there are: {shown}{more}"))
        }
    }
}
