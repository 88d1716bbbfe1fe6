//! Reads tables of measured markers: `.trc`, as motion capture and video tools write them.
//!
//! Three lines of header (a type, keys, their values), a line with `Frame#`, `Time` and the markers' names above every third column, a
//! line `X1 Y1 Z1 ...`, and rows: frame, time, three numbers a marker. Cells are separated by tabs; an empty cell or `NaN` is a gap of its
//! marker, and so are three zeros. Files without tabs have cells apart by blanks, and gaps as `NaN`.

use std::collections::HashSet;

use nalgebra::{Rotation3, Vector3};

use crate::input_error::{InputError, Source, utf8};
use crate::motion::{MOST_COLUMNS, MOST_NAME_BYTES, MOST_NUMBERS};
use contrapposto::model::LARGEST;

/// Unit of a file's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkerUnit {
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Metres.
    Metre,
}

impl MarkerUnit {
    const NAMES: [(&'static str, Self); 10] = [
        ("mm", Self::Millimetre),
        ("millimeters", Self::Millimetre),
        ("millimeter", Self::Millimetre),
        ("millimetres", Self::Millimetre),
        ("cm", Self::Centimetre),
        ("centimeters", Self::Centimetre),
        ("centimetres", Self::Centimetre),
        ("m", Self::Metre),
        ("meters", Self::Metre),
        ("metres", Self::Metre),
    ];

    /// Length of one, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Metre => 1.0,
        }
    }

    /// `mm`, `cm` or `m`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
        }
    }

    /// The unit of that name.
    pub fn named(name: &str) -> Option<Self> {
        let name = name.to_ascii_lowercase();
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, unit)| *unit)
    }
}

/// Lines above the names of markers that are read (assumed: files have four).
const MOST_HEADER_LINES: usize = 1000;
/// Most places of markers that rows leave out, which need memory without a byte of the file (assumed).
const MOST_LEFT_OUT: usize = 1_000_000;
/// Axes that are turned by less agree, rad.
const SAME_AXIS: f64 = 0.1;

/// Measured markers over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Markers {
    /// Names, each once.
    pub names: Vec<String>,
    /// Times, s, never falling.
    pub times: Vec<f64>,
    /// By frame and marker, m; `None` for gaps.
    pub places: Vec<Vec<Option<Vector3<f64>>>>,
    /// The unit in which the file was read.
    pub unit: MarkerUnit,
    /// The axis of the laboratory that points up, where the file says it.
    pub up: Option<Vector3<f64>>,
    /// Faults of a file that can be read nevertheless, a sentence each.
    pub warnings: Vec<String>,
}

impl Markers {
    /// Turns all places.
    pub fn turn(&mut self, turn: &Rotation3<f64>) {
        self.places.iter_mut().flatten().flatten().for_each(|place| *place = turn * *place);
        self.up = self.up.map(|up| turn * up);
    }
}

/// The turn from the upward axis of a laboratory to `up`; `None` where they agree.
pub fn turn_upright(own: Vector3<f64>, up: Vector3<f64>) -> Option<Rotation3<f64>> {
    Rotation3::rotation_between(&own, &up).filter(|turn| turn.angle() > SAME_AXIS)
}

/// A line without its end, and its number.
type Line<'a> = (usize, &'a str);

struct File<'a> {
    source: Source<'a>,
    /// Cells are apart by tabs.
    tabs: bool,
}

/// Numbers of the header, with their lines.
#[derive(Default)]
struct Header<'a> {
    unit: Option<&'a str>,
    frames: Option<(usize, usize)>,
    markers: Option<(usize, usize)>,
}

/// Reads a `.trc` file. `unit`: that of the coordinates, whatever the file says. `name` stands in errors only.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_trc(name: &str, bytes: &[u8], unit: Option<MarkerUnit>) -> Result<Markers, InputError> {
    let text = utf8(name, bytes)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut file = File { source: Source { name, text }, tabs: true };
    let lines = || {
        text.split('\n').map(|line| line.trim_end_matches('\r')).enumerate().filter(|line| !line.1.trim().is_empty())
    };
    let first = |line: &Line<'_>| line.1.split_whitespace().next().unwrap_or_default().to_ascii_lowercase();
    let labels = lines().enumerate().find(|(_, line)| ["frame#", "frame"].contains(&first(line).as_str()));
    let Some((above, labels)) = labels else {
        let help = "a .trc file has a line `Frame#`, `Time` and the names of its markers".to_owned();
        return Err(file.source.error(None, format!("{name}: holds no line of marker names"), "", Some(help)));
    };
    file.tabs = labels.1.contains('\t');
    let header = file.header(&lines().take(above.min(MOST_HEADER_LINES)).collect::<Vec<_>>());
    let unit = file.unit(&header, unit)?;
    let mut warnings = vec![];
    let columns = file.names(labels, &mut warnings)?;
    let mut rows = Rows {
        file: &file,
        columns: &columns,
        unit,
        times: vec![],
        places: vec![],
        zeros: 0,
        ragged: None,
        left_out: 0,
    };
    for (index, line) in lines().skip(above + 1).enumerate() {
        let is_axes = index < 2 && line.1.trim_start().starts_with(['X', 'x']);
        if !is_axes {
            rows.read(line)?;
        }
    }
    rows.warn(&mut warnings);
    let names: Vec<String> = columns.iter().filter(|c| c.kept).map(|c| c.name.to_owned()).collect();
    for (promised, found, what) in
        [(header.frames, rows.times.len(), "frames"), (header.markers, columns.len(), "markers")]
    {
        if let Some((promised, line)) = promised.filter(|(promised, _)| *promised != found) {
            let line = line + 1;
            warnings.push(format!(
                "{name}: the header says {promised} {what} (line {line}), but there are {found}, which are read; was the file cut off?"
            ));
        }
    }
    let (times, places) = (rows.times, rows.places);
    if times.is_empty() {
        let help = "rows of numbers must follow the names".to_owned();
        return Err(file.error(labels.1, format!("{name}: names markers but has no rows"), Some(help)));
    }
    Ok(Markers { names, times, places, unit, up: None, warnings })
}

/// A marker's three columns.
struct Column<'a> {
    name: &'a str,
    /// The name stands here for the first time.
    kept: bool,
}

impl<'a> File<'a> {
    fn error(&self, part: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        let start = (part.as_ptr() as usize).checked_sub(self.source.text.as_ptr() as usize);
        let span = start.map(|start| start..start + part.len()).filter(|s| self.source.text.get(s.clone()).is_some());
        self.source.error(span, message, "here", help)
    }

    /// Cells with blanks around them taken away.
    fn cells(&self, line: &'a str) -> Box<dyn Iterator<Item = &'a str> + 'a> {
        if self.tabs { Box::new(line.split('\t').map(trimmed)) } else { Box::new(line.split_whitespace()) }
    }

    /// The header's entries that matter: keys in one line, values in the next one. Neither is always separated by tabs alone.
    fn header(&self, lines: &[Line<'a>]) -> Header<'a> {
        let mut header = Header::default();
        let keys =
            lines.iter().position(|line| line.1.split_whitespace().any(|word| word == "Units" || word == "NumMarkers"));
        let Some((keys, values)) = keys.and_then(|at| Some((lines[at], *lines.get(at + 1)?))) else { return header };
        let by_tabs = |line: &'a str| line.split('\t').map(trimmed).collect::<Vec<_>>();
        let by_blanks = |line: &'a str| line.split_whitespace().collect::<Vec<_>>();
        // Cells apart by tabs may be empty; where keys and values are not apart alike, blanks tell them.
        let tabs = keys.1.contains('\t') && by_tabs(keys.1).len() == by_tabs(values.1).len();
        let pairs = if tabs { [keys.1, values.1].map(by_tabs) } else { [keys.1, values.1].map(by_blanks) };
        for (&key, &value) in pairs[0].iter().zip(&pairs[1]).filter(|(_, value)| !value.is_empty()) {
            let count = || value.parse().ok().map(|count| (count, values.0));
            match key {
                "Units" => header.unit = Some(value),
                "NumFrames" => header.frames = count(),
                "NumMarkers" => header.markers = count(),
                _ => {}
            }
        }
        header
    }

    fn unit(&self, header: &Header<'a>, given: Option<MarkerUnit>) -> Result<MarkerUnit, InputError> {
        let accepted =
            "mm, cm and m are known units; --units mm, --units cm or --units m says it, whatever the file says";
        match (given, header.unit) {
            (Some(unit), _) => Ok(unit),
            (None, Some(word)) => MarkerUnit::named(word).ok_or_else(|| {
                self.error(word, format!("`{}` is no known unit", short(word)), Some(accepted.to_owned()))
            }),
            (None, None) => {
                let message = format!("{}: the header does not say the unit of the markers", self.source.name);
                Err(self.source.error(None, message, "", Some(accepted.to_owned())))
            }
        }
    }

    /// The markers of the line of names, in the order of their columns.
    fn names(&self, line: Line<'a>, warnings: &mut Vec<String>) -> Result<Vec<Column<'a>>, InputError> {
        let mut seen = HashSet::new();
        let mut columns = vec![];
        let cells = self.cells(line.1).skip(2);
        // A name stands above the first of three columns; tools that pad their lines leave more empty cells at the end.
        for (at, name) in cells.enumerate() {
            if name.is_empty() {
                continue;
            }
            if self.tabs && at != 3 * columns.len() {
                let help = Some("a name stands above the first of the three columns of its marker".to_owned());
                return Err(self.error(
                    name,
                    format!("the marker `{}` stands above another column", short(name)),
                    help,
                ));
            }
            if name.len() > MOST_NAME_BYTES || name.contains(char::is_control) {
                let help = Some(format!("a name has {MOST_NAME_BYTES} bytes at most and no control characters"));
                return Err(self.error(name, "the marker's name cannot be read", help));
            }
            let kept = seen.insert(name);
            if !kept {
                let (file, line) = (self.source.name, line.0 + 1);
                warnings.push(format!("{file}:{line}: two markers are named `{name}`; the first one is read"));
            }
            columns.push(Column { name, kept });
            if 3 * columns.len() > MOST_COLUMNS {
                return Err(self.error(name, format!("more than {MOST_COLUMNS} columns"), None));
            }
        }
        if columns.is_empty() {
            let help = Some("names follow `Frame#` and `Time`".to_owned());
            return Err(self.error(line.1, "no marker is named", help));
        }
        Ok(columns)
    }
}

/// Rows as they are read.
struct Rows<'f, 'a> {
    file: &'f File<'a>,
    columns: &'f [Column<'a>],
    unit: MarkerUnit,
    times: Vec<f64>,
    places: Vec<Vec<Option<Vector3<f64>>>>,
    /// Places of three zeros.
    zeros: usize,
    /// First row with fewer cells than columns.
    ragged: Option<usize>,
    /// Places that such rows leave out.
    left_out: usize,
}

impl<'a> Rows<'_, 'a> {
    fn read(&mut self, line: Line<'a>) -> Result<(), InputError> {
        let file = self.file;
        if (self.times.len() + 1).saturating_mul(3 * self.columns.len()) > MOST_NUMBERS {
            return Err(file.error(&line.1[..0], format!("more than {MOST_NUMBERS} numbers"), None));
        }
        let mut cells = file.cells(line.1);
        let _frame = cells.next();
        let time = self.time(cells.next().unwrap_or(&line.1[line.1.len()..]))?;
        let mut row = Vec::with_capacity(self.columns.len());
        let mut found = 0;
        for column in self.columns {
            let mut place = [None; 3];
            for value in &mut place {
                let Some(cell) = cells.next() else { break };
                found += 1;
                *value = self.number(cell, column.name)?;
            }
            let place = match place {
                [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
                _ => None,
            };
            let is_zero = place == Some(Vector3::zeros());
            self.zeros += usize::from(is_zero);
            if column.kept {
                row.push(place.filter(|_| !is_zero));
            }
        }
        if let Some(more) = cells.find(|cell| !cell.is_empty()) {
            let message = format!("the row has more cells than the {} of its markers", 2 + 3 * self.columns.len());
            let help = "decimals need a point; every marker needs a name".to_owned();
            return Err(file.error(more, message, Some(help)));
        }
        let needed = 3 * self.columns.len();
        if found < needed && !file.tabs {
            // Which marker is missing cannot be told: all that follow it stand under other names.
            let message = format!("the row has {found} places of markers, its {} markers need {needed}", needed / 3);
            let help = "in a file whose cells are apart by blanks a gap must be NaN".to_owned();
            return Err(file.error(line.1, message, Some(help)));
        }
        if found < needed {
            self.ragged.get_or_insert(line.0 + 1);
            self.left_out += (needed - found).div_ceil(3);
            if self.left_out > MOST_LEFT_OUT {
                let message = format!("rows leave out {} places of markers", self.left_out);
                let help = format!("{MOST_LEFT_OUT} at most are accepted; write an empty cell for each missing number");
                return Err(file.error(line.1, message, Some(help)));
            }
        }
        self.times.push(time);
        self.places.push(row);
        Ok(())
    }

    fn time(&self, cell: &'a str) -> Result<f64, InputError> {
        let Some(time) = cell.parse::<f64>().ok().filter(|time| time.abs() <= LARGEST) else {
            let help = "time is the second column, a finite number of seconds".to_owned();
            return Err(self.file.error(cell, format!("`{}` is no time", short(cell)), Some(help)));
        };
        match self.times.last() {
            Some(last) if time < *last => {
                let message = format!("time falls from {last:?} to {time:?}");
                Err(self.file.error(cell, message, Some("rows must be in the order of time".to_owned())))
            }
            _ => Ok(time),
        }
    }

    /// A number in m, or `None` for a gap.
    fn number(&self, cell: &'a str, of: &str) -> Result<Option<f64>, InputError> {
        if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
            return Ok(None);
        }
        let value = cell.parse::<f64>().ok().filter(|value| (value * self.unit.metres()).abs() <= LARGEST);
        let help = "a finite number, like 12.5, is accepted; an empty cell or NaN for a gap";
        match value {
            Some(value) => Ok(Some(value * self.unit.metres())),
            None => {
                let message = format!("`{}`: `{}` is no place of a marker", short(of), short(cell));
                Err(self.file.error(cell, message, Some(help.to_owned())))
            }
        }
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        let name = self.file.source.name;
        if let Some(line) = self.ragged {
            warnings.push(format!(
                "{name}:{line}: the row has fewer cells than its {} markers need; those that are missing are gaps",
                self.columns.len()
            ));
        }
        if self.zeros > 0 {
            let zeros = self.zeros;
            warnings.push(format!("{name}: {zeros} places of markers are 0, 0, 0, which are read as gaps"));
        }
    }
}

fn trimmed(cell: &str) -> &str {
    cell.trim_matches([' ', '\r'])
}

/// The beginning of a long word.
fn short(word: &str) -> String {
    crate::xml::shorten(word)
}
