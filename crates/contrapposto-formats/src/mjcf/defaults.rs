//! Reads default classes.

use super::error::{MjcfError, MjcfRule};
use super::item::Item;
use super::schema::{self, ORIENTATIONS, Tag};
use super::value::{ORIENTATION, Value, check, own_orientation};
use crate::model_ir::near;
use crate::xml::{Limits, shorten};
use std::collections::BTreeMap;

/// All classes; every file has "main".
pub(super) struct Classes<'a> {
    classes: Vec<Class<'a>>,
    names: BTreeMap<&'a str, usize>,
}

#[derive(Default)]
struct Class<'a> {
    parent: Option<usize>,
    values: BTreeMap<(Tag, &'a str), Value<'a>>,
    elements: Vec<(Tag, Item<'a>)>,
}

impl<'a> Classes<'a> {
    /// All `<default>` sections, wherever they stand.
    pub(super) fn read(root: Item<'a>, limits: &Limits) -> Result<Self, MjcfError> {
        let mut classes = Self { classes: vec![Class::default()], names: BTreeMap::from([("main", 0)]) };
        let sections = root.children().into_iter().filter(|c| c.name() == "default");
        for (number, section) in sections.enumerate() {
            check(section, &["class"])?;
            if section.attribute("class").is_some_and(|name| name != "main" && !name.is_empty()) {
                return Err(MjcfError::invalid(section, "class", MjcfRule::MainClass));
            }
            if number >= limits.depth {
                return Err(MjcfError::invalid(section, "class", MjcfRule::DefaultSections));
            }
            if number > 0 {
                // Classes inherit what "main" was when they were made, so a further section makes a further "main".
                let parent = Some(classes.main());
                classes.names.insert("main", classes.classes.len());
                classes.classes.push(Class { parent, ..Class::default() });
            }
            classes.fill(section, classes.main(), limits.depth)?;
        }
        Ok(classes)
    }

    /// The class of elements that name none.
    pub(super) fn main(&self) -> usize {
        self.names.get("main").copied().unwrap_or(0)
    }

    /// An element's own settings first, then the classes inside, which inherit them wherever they stand.
    fn fill(&mut self, item: Item<'a>, class: usize, depth_left: usize) -> Result<(), MjcfError> {
        let Some(depth_left) = depth_left.checked_sub(1) else {
            return Err(MjcfError::TooDeep { place: item.place(), cap: Limits::default().depth });
        };
        let children = item.children();
        for &child in children.iter().filter(|c| c.name() != "default") {
            let Some(tag) = Tag::of(child.name()) else {
                if schema::DEFAULT_CHILDREN.contains(&child.name()) {
                    continue;
                }
                return Err(MjcfError::unknown_element(child, schema::DEFAULT_CHILDREN));
            };
            tag.attributes().map_or(Ok(()), |known| check(child, known))?;
            self.classes[class].elements.push((tag, child));
            let values = &mut self.classes[class].values;
            if let Some(value) = own_orientation(child)? {
                values.insert((tag, ORIENTATION), value);
            }
            for (name, _) in child.attributes().filter(|(name, _)| !ORIENTATIONS.contains(name)) {
                if let Some(value) = Value::of(child, name) {
                    values.insert((tag, name), value);
                }
            }
        }
        for child in children.into_iter().filter(|c| c.name() == "default") {
            check(child, &["class"])?;
            let name = child.attribute("class").filter(|n| !n.is_empty());
            let name = name.ok_or_else(|| MjcfError::Missing { place: child.attribute_place("class") })?;
            let index = self.classes.len();
            if self.names.insert(name, index).is_some() {
                return Err(MjcfError::DuplicateName { place: child.attribute_place("class"), value: shorten(name) });
            }
            self.classes.push(Class { parent: Some(class), ..Class::default() });
            self.fill(child, index, depth_left)?;
        }
        Ok(())
    }

    /// The class that an attribute (`class` or `childclass`) names.
    pub(super) fn named(&self, item: Item<'a>, attribute: &'static str) -> Result<Option<usize>, MjcfError> {
        let Some(name) = item.attribute(attribute).filter(|n| !n.is_empty()) else { return Ok(None) };
        match self.names.get(name) {
            Some(&class) => Ok(Some(class)),
            None => Err(MjcfError::UnknownName {
                place: item.attribute_place(attribute),
                kind: "class",
                value: shorten(name),
                nearest: near(name, self.names.keys().copied()),
            }),
        }
    }

    /// The value in a class or the nearest class around it.
    pub(super) fn get(&self, class: usize, tag: Tag, name: &'static str) -> Option<Value<'a>> {
        self.chain(class).find_map(|c| c.values.get(&(tag, name)).copied())
    }

    /// The values in a class and those around it, outermost first.
    pub(super) fn layers(&self, class: usize, tag: Tag, name: &'static str) -> Vec<Value<'a>> {
        let mut layers: Vec<_> = self.chain(class).filter_map(|c| c.values.get(&(tag, name)).copied()).collect();
        layers.reverse();
        layers
    }

    /// The elements of a kind in a class and those around it, outermost first.
    pub(super) fn elements(&self, class: usize, tag: Tag) -> Vec<Item<'a>> {
        let mut chain: Vec<_> = self.chain(class).collect();
        chain.reverse();
        chain.iter().flat_map(|c| &c.elements).filter(|(kind, _)| *kind == tag).map(|(_, item)| *item).collect()
    }

    fn chain(&self, class: usize) -> impl Iterator<Item = &Class<'a>> {
        std::iter::successors(Some(&self.classes[class]), |c| c.parent.map(|p| &self.classes[p]))
    }
}
