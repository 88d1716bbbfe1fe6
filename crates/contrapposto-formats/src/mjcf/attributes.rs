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
        tag.attributes().map_or(Ok(()), |known| check(item, known))?;
        let class = classes.named(item, "class")?.unwrap_or(class);
        Ok(Self { item, tag, classes, class })
    }

    pub(super) fn get(&self, name: &'static str) -> Option<Value<'a>> {
        Value::of(self.item, name).or_else(|| self.classes.get(self.class, self.tag, name))
    }

    /// The elements of its classes, outermost first, and the element itself.
    pub(super) fn elements(&self) -> Vec<Item<'a>> {
        let mut elements = self.classes.elements(self.class, self.tag);
        elements.push(self.item);
        elements
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

    /// The range `name` if it is a limit: as the flag `limited` says, or where that is "auto", if the range is given and the compiler
    /// takes a range for a limit.
    pub(super) fn limits(
        &self,
        name: &'static str,
        limited: &'static str,
        automatic: bool,
    ) -> Result<Option<[f64; 2]>, MjcfError> {
        let limited = self.get(limited).map_or(Ok(2), |v| v.keyword(&["false", "true", "auto"]))?;
        let range = self.numbers::<2>(name)?.filter(|[low, high]| low < high);
        Ok(range.filter(|_| limited == 1 || limited == 2 && automatic))
    }

    pub(super) fn number(&self, name: &'static str) -> Result<Option<f64>, MjcfError> {
        self.get(name).map(|v| v.number()).transpose()
    }

    pub(super) fn numbers<const N: usize>(&self, name: &'static str) -> Result<Option<[f64; N]>, MjcfError> {
        self.get(name).map(|v| v.numbers()).transpose()
    }
}
