//! Reads one attribute as numbers, keywords or flags.

use super::error::{MjcfError, MjcfRule};
use super::item::Item;
use super::schema::ORIENTATIONS;
use crate::model_ir::near;
use crate::numbers;
use crate::xml::{Place, shorten};

/// One attribute, of an element or of a class.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    pub(super) item: Item<'a>,
    pub(super) name: &'a str,
    pub(super) text: &'a str,
}

impl<'a> Value<'a> {
    pub(super) fn of(item: Item<'a>, name: &'a str) -> Option<Self> {
        item.attribute(name).map(|text| Self { item, name, text })
    }

    pub(super) fn place(&self) -> Place {
        self.item.attribute_place(self.name)
    }

    pub(super) fn number(&self) -> Result<f64, MjcfError> {
        Ok(numbers::number(self.text, || self.place())?)
    }

    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], MjcfError> {
        let mut values = [0.0; N];
        numbers::fixed(self.text, &mut values, || self.place())?;
        Ok(values)
    }

    /// Writes as many numbers as there are over the first ones of `values`.
    pub(super) fn prefix(&self, values: &mut [f64]) -> Result<(), MjcfError> {
        let read = numbers::list(self.text, 0..=values.len(), || self.place())?;
        values[..read.len()].copy_from_slice(&read);
        Ok(())
    }

    /// Position of the value among `accepted`.
    pub(super) fn keyword(&self, accepted: &'static [&'static str]) -> Result<usize, MjcfError> {
        accepted.iter().position(|k| *k == self.text).ok_or_else(|| MjcfError::Keyword {
            place: self.place(),
            value: shorten(self.text),
            accepted,
        })
    }

    pub(super) fn flag(&self) -> Result<bool, MjcfError> {
        Ok(self.keyword(&["false", "true"])? == 1)
    }

    /// For errors: `value` and `place` filled in.
    pub(super) fn invalid(&self, needs: MjcfRule) -> MjcfError {
        MjcfError::Invalid { place: self.place(), value: shorten(self.text.trim()), needs }
    }
}

/// Refuses the first attribute that is not among `known`.
pub(super) fn check(item: Item<'_>, known: &'static [&'static str]) -> Result<(), MjcfError> {
    match item.attributes().find(|(name, _)| !known.contains(name)) {
        None => Ok(()),
        Some((name, _)) => Err(MjcfError::UnknownAttribute {
            place: item.attribute_place(name),
            nearest: near(name, known.iter().copied()),
        }),
    }
}

/// One of the five orientations, if any; several are refused.
pub(super) fn own_orientation<'a>(item: Item<'a>) -> Result<Option<Value<'a>>, MjcfError> {
    let mut given = ORIENTATIONS.iter().filter_map(|name| Value::of(item, name));
    let (first, second) = (given.next(), given.next());
    match second {
        Some(second) => Err(second.invalid(MjcfRule::OneOrientation)),
        None => Ok(first),
    }
}

/// The name under which classes keep whichever orientation they have.
pub(super) const ORIENTATION: &str = "orientation";
