//! Holds a JSON text as a tree that needs less memory than that of `serde_json`, whose objects need some hundred bytes each.

use std::fmt::{Formatter, Result as Written};
use std::ops::Index;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Json {
    Null,
    /// `true` or `false`, which no reader of this crate looks at.
    Truth,
    Whole(u64),
    Real(f64),
    Text(Box<str>),
    List(Box<[Self]>),
    /// Entries in the order of their names, each once.
    Object(Box<[(Box<str>, Self)]>),
}

impl Json {
    pub(super) fn is_null(&self) -> bool {
        *self == Self::Null
    }

    /// The entries of a list.
    pub(super) fn as_list(&self) -> Option<&[Self]> {
        if let Self::List(list) = self { Some(list) } else { None }
    }

    pub(super) fn as_str(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    pub(super) fn as_u64(&self) -> Option<u64> {
        if let Self::Whole(number) = self { Some(*number) } else { None }
    }

    pub(super) fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Whole(number) => Some(*number as f64),
            Self::Real(number) => Some(*number),
            _ => None,
        }
    }
}

/// The value of a name in an object; `Null` where there is none.
impl Index<&str> for Json {
    type Output = Self;

    fn index(&self, name: &str) -> &Self {
        static NULL: Json = Json::Null;
        let Self::Object(entries) = self else { return &NULL };
        let place = entries.binary_search_by(|(known, _)| (**known).cmp(name));
        place.map_or(&NULL, |place| &entries[place].1)
    }
}

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Tree)
    }
}

/// Builds the tree.
struct Tree;

impl<'de> Visitor<'de> for Tree {
    type Value = Json;

    fn expecting(&self, f: &mut Formatter<'_>) -> Written {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Json, E> {
        Ok(Json::Truth)
    }

    fn visit_u64<E>(self, number: u64) -> Result<Json, E> {
        Ok(Json::Whole(number))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Json, E> {
        Ok(Json::Real(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Json, E> {
        Ok(Json::Real(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Json, E> {
        Ok(Json::Text(text.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Json, A::Error> {
        let mut list = vec![];
        while let Some(value) = from.next_element()? {
            list.push(value);
        }
        Ok(Json::List(list.into()))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> Result<Json, A::Error> {
        let mut entries: Vec<(Box<str>, Json)> = vec![];
        while let Some(entry) = from.next_entry()? {
            entries.push(entry);
        }
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        // Of a name that is repeated the last value counts.
        entries.dedup_by(|later, before| {
            let again = later.0 == before.0;
            if again {
                std::mem::swap(later, before);
            }
            again
        });
        Ok(Json::Object(entries.into()))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]

    use super::Json;

    #[test]
    fn values_are_found_by_their_names() {
        let text = r#"{"b":[1,-2,0.5,true,null],"a":{"x":"y"},"b":[3],"c":1e3}"#;
        let read: Json = serde_json::from_str(text).unwrap();
        assert_eq!(read["a"]["x"].as_str(), Some("y"));
        assert_eq!(read["b"].as_list().unwrap(), [Json::Whole(3)], "the last one");
        assert_eq!((read["c"].as_f64(), read["c"].as_u64()), (Some(1000.0), None));
        assert!(read["a"]["z"]["z"].is_null() && read["c"].as_list().is_none());
        assert_eq!(size_of::<Json>(), 24);
    }
}
