//! Writes a part of a plan, some rows together, as the text of a table, and the key that tells whether a part on a disk is this one.

use std::ops::Range;

use contrapposto_formats::motion::csv_cell;
use contrapposto_formats::{InputError, Plan, Template, Value};
use sha2::{Digest, Sha256};

use super::outcome::Outcome;
use super::sampler::Sampler;

/// Columns of a part after `row` and the parameters, with their meaning.
pub const COLUMNS: [(&str, &str); 9] = [
    (
        "kind",
        "verdict: cannot_be_done, cannot_stand, not_reached, held_until or holds; refused: no scenario with these values, or an error in the run",
    ),
    ("minutes", "min; how long the job can be done; empty: muscles set no limit, or it cannot be done"),
    ("who", "muscle group that is too weak or fails first; where none does, the one with the greatest load"),
    ("hardest", "muscle group with the greatest load"),
    ("load", "1; active torque of `hardest` over its strength"),
    ("effort", "1; sum of (active torque / strength)^2 at the end"),
    ("seconds", "s; simulated time"),
    ("search_cut", "true where a search for an easier posture was cut short: there may be one"),
    ("note", "why the row is refused"),
];

/// Characters of a key: 64 bits of a hash, two of which meet by chance once in four thousand million parts.
const KEY_CHARACTERS: usize = 16;

/// Plans of the same keys over one base scenario, ready to compute any part. Their rows take turns: of two plans the first has rows 0, 2,
/// 4, ..., so that more rows of the same plans begin with the same rows.
#[derive(Clone, Debug)]
pub struct Study {
    name: String,
    template: Template,
    samplers: Vec<Sampler>,
}

impl Study {
    /// The plan over the base scenario of these bytes; `name` is its name for messages.
    ///
    /// # Errors
    /// [`InputError`] where the scenario is not TOML, or a parameter's path leads nowhere in it.
    pub fn new(name: &str, base: &[u8], plan: &Plan) -> Result<Self, InputError> {
        Self::in_turn(name, base, std::slice::from_ref(plan))
    }

    /// Plans with the same keys, rows and rows of a part, whose rows take turns.
    ///
    /// # Errors
    /// [`InputError`] where the scenario is not TOML, or a parameter's path leads nowhere in it.
    pub fn in_turn(name: &str, base: &[u8], plans: &[Plan]) -> Result<Self, InputError> {
        let keys = plans.iter().take(1).flat_map(|plan| &plan.parameters).map(|parameter| parameter.key.as_str());
        let template = Template::new(name, base, keys)?;
        Ok(Self { name: name.to_owned(), template, samplers: plans.iter().map(Sampler::new).collect() })
    }

    /// The plans in turn.
    pub fn plans(&self) -> impl Iterator<Item = &Plan> {
        self.samplers.iter().map(Sampler::plan)
    }

    /// Keys of the parameters.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.plans().take(1).flat_map(|plan| &plan.parameters).map(|parameter| parameter.key.as_str())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.plans().map(|plan| plan.rows).sum()
    }

    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.rows().div_ceil(self.rows_per_part())
    }

    /// Number of rows of every part but the last one.
    pub fn rows_per_part(&self) -> usize {
        self.plans().next().map_or(1, |plan| plan.rows_per_part.max(1))
    }

    /// The rows of a part.
    pub fn rows_of(&self, part: usize) -> Range<usize> {
        let first = part * self.rows_per_part();
        first..(first + self.rows_per_part()).min(self.rows())
    }

    /// Number of the plan that a row belongs to.
    pub fn plan_of(&self, row: usize) -> usize {
        row % self.samplers.len().max(1)
    }

    /// Independent points of the unit interval of a row, before correlation.
    pub fn point(&self, row: usize) -> Vec<f64> {
        self.of_row(row, Sampler::point)
    }

    fn values(&self, row: usize) -> Vec<Value> {
        self.of_row(row, Sampler::values)
    }

    fn of_row<T: Default>(&self, row: usize, take: impl Fn(&Sampler, usize) -> T) -> T {
        let sampler = self.samplers.get(self.plan_of(row));
        sampler.map_or_else(T::default, |sampler| take(sampler, row / self.samplers.len()))
    }

    /// The text of the scenario of a row.
    pub fn scenario(&self, row: usize) -> String {
        self.template.text(&self.values(row))
    }

    /// Key of a part: a hash of this program's version, the names of the columns, and the scenarios of all rows.
    pub fn key(&self, part: usize) -> String {
        self.key_of(self.rows_of(part))
    }

    /// Keys of the parts that begin with the same row in studies of the same plans with fewer or more rows.
    pub fn keys_of_other_lengths(&self, part: usize) -> Vec<String> {
        let rows = self.rows_of(part);
        let is_open = self.samplers.iter().all(Sampler::is_open);
        let most = if is_open { self.rows_per_part() } else { rows.len() };
        (1..=most)
            .filter(|length| *length != rows.len())
            .map(|length| self.key_of(rows.start..rows.start + length))
            .collect()
    }

    fn key_of(&self, rows: Range<usize>) -> String {
        let mut hash = Sha256::new();
        hash.update(concat!("contrapposto ", env!("CARGO_PKG_VERSION"), "\n"));
        hash.update(self.header());
        for row in rows {
            let text = self.scenario(row);
            hash.update((row as u64).to_le_bytes());
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        }
        let hash = hash.finalize();
        let bytes = hash.iter().take(KEY_CHARACTERS / 2);
        bytes.map(|byte| format!("{byte:02x}")).collect()
    }

    /// The text of a part, while `go_on` says yes; `None` where it says no. `done` is called after every row.
    pub fn part(&self, part: usize, go_on: impl Fn() -> bool, done: impl Fn()) -> Option<String> {
        let mut text = self.header();
        for row in self.rows_of(part) {
            let values = self.values(row);
            let outcome = Outcome::of(&self.name, &self.template.text(&values), &go_on)?;
            text += &line(row, &values, &outcome);
            done();
        }
        Some(text)
    }

    /// The first line of every part: names of the columns.
    fn header(&self) -> String {
        let names = ["row"].into_iter().chain(self.keys()).chain(COLUMNS.iter().map(|(name, _)| *name));
        names.map(csv_cell).collect::<Vec<_>>().join(",") + "\n"
    }
}

/// A row as text; every number has all the digits that are needed to read the same value again.
fn line(row: usize, values: &[Value], outcome: &Outcome) -> String {
    let number = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
    let text = |text: &Option<String>| text.as_deref().map_or(String::new(), csv_cell);
    let value = |value: &Value| if let Value::Text(text) = value { csv_cell(text) } else { value.to_string() };
    let answer = [
        outcome.kind.to_owned(),
        number(outcome.minutes),
        text(&outcome.who),
        text(&outcome.hardest),
        number(outcome.load),
        number(outcome.effort),
        number(outcome.seconds),
        outcome.search_cut.map_or_else(String::new, |cut| cut.to_string()),
        text(&outcome.note),
    ];
    let cells = std::iter::once(row.to_string()).chain(values.iter().map(value)).chain(answer);
    cells.collect::<Vec<_>>().join(",") + "\n"
}
