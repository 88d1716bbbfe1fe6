//! Reads attributes of one element, and those of its default class where the element has none.

use super::defaults::Classes;
use super::error::MjcfError;
use super::item::Item;
use super::schema::Tag;
use super::value::{ORIENTATION, Value, check, own_orientation};

/// Attributes of one element over those of its class.
pub(super) struct Attributes<'a, 'c> {
    pub(super) item: Item<'a>,
    tag: Tag,
    classes: &'c Classes<'a>,
    class: usize,
}

impl<'a, 'c> Attributes<'a, 'c> {
    /// `class` is the class of the surrounding body or frame.
    pub(super) fn new(item: Item<'a>, tag: Tag, classes: &'c Classes<'a>, class: usize) -> Result<Self, MjcfError> {
        check(item, tag.attributes())?;
        let class = classes.named(item, "class")?.unwrap_or(class);
        Ok(Self { item, tag, classes, class })
    }

    pub(super) fn get(&self, name: &'static str) -> Option<Value<'a>> {
        Value::of(self.item, name).or_else(|| self.classes.get(self.class, self.tag, name))
    }

    pub(super) fn orientation(&self) -> Result<Option<Value<'a>>, MjcfError> {
        Ok(own_orientation(self.item)?.or_else(|| self.classes.get(self.class, self.tag, ORIENTATION)))
    }

    /// Up to three numbers; where there are fewer the class's further ones stay.
    pub(super) fn merged(&self, name: &'static str) -> Result<[f64; 3], MjcfError> {
        let mut values = [0.0; 3];
        for value in self.classes.layers(self.class, self.tag, name) {
            value.prefix(&mut values)?;
        }
        if let Some(own) = Value::of(self.item, name) {
            own.prefix(&mut values)?;
        }
        Ok(values)
    }

    pub(super) fn number(&self, name: &'static str) -> Result<Option<f64>, MjcfError> {
        self.get(name).map(|v| v.number()).transpose()
    }

    pub(super) fn numbers<const N: usize>(&self, name: &'static str) -> Result<Option<[f64; N]>, MjcfError> {
        self.get(name).map(|v| v.numbers()).transpose()
    }
}
