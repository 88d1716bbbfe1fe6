//! Computes a part of a plan, some rows together, as a table, and the key that tells whether a part on a disk is this one.

use std::ops::Range;

use contrapposto_formats::motion::csv_cell;
use contrapposto_formats::{InputError, Plan, Template, Value};
use sha2::{Digest, Sha256};

use super::outcome::Outcome;
use super::part_file::{self, Column, PROGRAM};
use super::sampler::Sampler;
use super::table::{self, Answer, COLUMNS};

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
        hash.update(PROGRAM);
        hash.update("\n");
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

    /// The bytes of a part, a Parquet file, while `go_on` says yes; `None` where it says no. `done` is called after every row.
    pub fn part(&self, part: usize, go_on: impl Fn() -> bool, done: impl Fn()) -> Option<Vec<u8>> {
        let mut answers = vec![];
        for row in self.rows_of(part) {
            answers.push(Answer { row, outcome: Outcome::of(&self.name, &self.scenario(row), &go_on)? });
            done();
        }
        Some(self.bytes(part, &answers))
    }

    /// The answers of a part that was kept; `None` of bytes that are not those of this part with any answers: cut off, changed, or of
    /// other rows.
    pub fn read(&self, part: usize, bytes: &[u8]) -> Option<Vec<Answer>> {
        let rows = self.rows_of(part);
        let columns = part_file::read(bytes, &self.columns(&[]), rows.len())?;
        let columns = columns.get(columns.len() - COLUMNS.len()..)?;
        let answer = |(i, row)| Some(Answer { row, outcome: table::outcome(columns, i)? });
        let answers: Vec<Answer> = rows.enumerate().map(answer).collect::<Option<_>>()?;
        (self.bytes(part, &answers) == bytes).then_some(answers)
    }

    fn bytes(&self, part: usize, answers: &[Answer]) -> Vec<u8> {
        part_file::write(&self.columns(answers), &self.facts(part))
    }

    fn columns(&self, answers: &[Answer]) -> Vec<(String, Column)> {
        let rows = answers.iter().map(|answer| answer.row as i64).collect();
        let values: Vec<Vec<Value>> = answers.iter().map(|answer| self.values(answer.row)).collect();
        let parameter = |(i, key): (usize, &str)| {
            let distributions = self.plans().map(|plan| &plan.parameters[i].distribution);
            (key.to_owned(), table::parameter(distributions, values.iter().map(|values| values[i].clone())))
        };
        let answers = COLUMNS.iter().map(|(name, _)| (*name).to_owned()).zip(table::columns(answers));
        let row = ("row".to_owned(), Column::Whole(rows));
        std::iter::once(row).chain(self.keys().enumerate().map(parameter)).chain(answers).collect()
    }

    /// The metadata of a part: program, key, and the meaning of every column.
    fn facts(&self, part: usize) -> Vec<(String, String)> {
        let meanings = self.meanings().map(|(name, meaning)| (format!("column {name}"), meaning.to_owned()));
        let facts = [("program", PROGRAM.to_owned()), ("key", self.key(part))];
        facts.into_iter().map(|(name, text)| (name.to_owned(), text)).chain(meanings).collect()
    }

    /// Names of all columns, with their meaning, the unit first.
    pub fn meanings(&self) -> impl Iterator<Item = (&str, &str)> {
        let parameter = "key of the scenario, in the unit that its name ends in";
        let row = [("row", "number of the row in the plan, from 0")];
        row.into_iter().chain(self.keys().map(move |key| (key, parameter))).chain(COLUMNS)
    }

    /// Answers as the text of a CSV file: a line with the names of the columns, then one for each row.
    pub fn csv(&self, answers: &[Answer]) -> String {
        let lines = answers.iter().map(|answer| table::line(answer.row, &self.values(answer.row), &answer.outcome));
        std::iter::once(self.header()).chain(lines).collect()
    }

    /// Names of the columns, as the first line of a CSV file.
    fn header(&self) -> String {
        self.meanings().map(|(name, _)| csv_cell(name)).collect::<Vec<_>>().join(",") + "\n"
    }
}
