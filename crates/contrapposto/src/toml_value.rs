//! Gives the values of a parsed TOML file to the types that stand for them.
//!
//! The reader of `toml` itself gives a struct the same keys in several ways (as a table, as a date, with places), each of which is a copy
//! of the struct's code: a quarter of the studio's module. The project's files have no dates, so here is one way, with the same words, but that a
//! struct is called a table. A type is shown only values of the kind that it takes: a struct a table, not an array of its fields.

use std::fmt::Display;
use std::ops::Range;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error as _, Expected, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// The reason for which a value is not what its key takes, and where it stands.
#[derive(Debug)]
pub struct Misfit {
    /// The reason, in the words of `serde`.
    pub message: String,
    /// Bytes of the text; `None` of a value that has no place of its own.
    pub span: Option<Range<usize>>,
}

/// The values of a file's tables.
///
/// # Errors
/// [`Misfit`] of the first value that its key does not take.
///
/// ```
/// use contrapposto::toml_value::typed;
/// let table = toml::de::DeTable::parse("mass_kg = 3").unwrap();
/// let masses: std::collections::BTreeMap<String, f64> = typed(table.get_ref())?;
/// assert_eq!(masses["mass_kg"], 3.0);
/// # Ok::<(), contrapposto::toml_value::Misfit>(())
/// ```
pub fn typed<T: DeserializeOwned>(table: &DeTable<'_>) -> Result<T, Misfit> {
    T::deserialize(Value { span: 0..0, kind: Kind::Table(table) })
}

impl Misfit {
    /// The same, at a place, unless its own is known.
    fn at(self, span: &Range<usize>) -> Self {
        Self { span: self.span.or_else(|| Some(span.clone())), ..self }
    }
}

impl Display for Misfit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Misfit {}

impl serde::de::Error for Misfit {
    fn custom<T: Display>(message: T) -> Self {
        Self { message: message.to_string(), span: None }
    }
}

/// A value and its place.
struct Value<'a> {
    span: Range<usize>,
    kind: Kind<'a>,
}

#[derive(Clone, Copy)]
enum Kind<'a> {
    /// The whole file, or a table in it.
    Table(&'a DeTable<'a>),
    Other(&'a DeValue<'a>),
}

/// A value that holds no others, or the kind of one that does.
enum Scalar<'a> {
    Text(&'a str),
    Whole(i128),
    Real(f64),
    Truth(bool),
    Date,
    Array,
    Table,
}

impl<'a> From<&'a Spanned<DeValue<'a>>> for Value<'a> {
    fn from(value: &'a Spanned<DeValue<'a>>) -> Self {
        let kind = match value.get_ref() {
            DeValue::Table(table) => Kind::Table(table),
            other => Kind::Other(other),
        };
        Self { span: value.span(), kind }
    }
}

impl<'a> Value<'a> {
    /// The entries of a table; a type that stands for a table takes nothing else.
    fn table<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let table = match self.kind {
            Kind::Table(table) => table,
            Kind::Other(_) => return Err(self.misfit(&visitor)),
        };
        visitor.visit_map(Entries::of(table)).map_err(|error| error.at(&self.span))
    }

    fn array<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let Kind::Other(DeValue::Array(list)) = self.kind else { return Err(self.misfit(&visitor)) };
        visitor.visit_seq(Items(list.iter())).map_err(|error| error.at(&self.span))
    }

    fn number<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.scalar() {
            Ok(Scalar::Whole(number)) => whole(number, visitor),
            Ok(Scalar::Real(number)) => visitor.visit_f64(number),
            Ok(_) => return Err(self.misfit(&visitor)),
            Err(error) => Err(error),
        }
        .map_err(|error| error.at(&self.span))
    }

    fn text<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let Kind::Other(DeValue::String(text)) = self.kind else { return Err(self.misfit(&visitor)) };
        visitor.visit_str(text).map_err(|error: Misfit| error.at(&self.span))
    }

    fn truth<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let Kind::Other(DeValue::Boolean(truth)) = self.kind else { return Err(self.misfit(&visitor)) };
        visitor.visit_bool(*truth).map_err(|error: Misfit| error.at(&self.span))
    }

    /// The value without the type that it is read into, so that its code is there once.
    fn scalar(&self) -> Result<Scalar<'a>, Misfit> {
        let Kind::Other(value) = self.kind else { return Ok(Scalar::Table) };
        Ok(match value {
            DeValue::String(text) => Scalar::Text(text),
            DeValue::Integer(number) => match i128::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => Scalar::Whole(number),
                Err(_) => return Err(Misfit::custom("integer number overflowed")),
            },
            DeValue::Float(number) => match number.as_str().parse() {
                Ok(number) => Scalar::Real(number),
                Err(_) => return Err(Misfit::custom("floating-point number overflowed")),
            },
            DeValue::Boolean(truth) => Scalar::Truth(*truth),
            DeValue::Datetime(_) => Scalar::Date,
            DeValue::Array(_) => Scalar::Array,
            DeValue::Table(_) => Scalar::Table,
        })
    }

    /// The error of a value of another kind than its key takes.
    fn misfit(&self, expected: &dyn Expected) -> Misfit {
        let kind = match self.scalar() {
            Ok(Scalar::Text(text)) => Unexpected::Str(text),
            Ok(Scalar::Whole(number)) => match i64::try_from(number) {
                Ok(number) => Unexpected::Signed(number),
                Err(_) => Unexpected::Other("integer"),
            },
            Ok(Scalar::Real(number)) => Unexpected::Float(number),
            Ok(Scalar::Truth(truth)) => Unexpected::Bool(truth),
            Ok(Scalar::Date) => Unexpected::Other("date"),
            Ok(Scalar::Array) => Unexpected::Seq,
            Ok(Scalar::Table) => Unexpected::Map,
            Err(_) => Unexpected::Other("number out of range"),
        };
        Misfit::invalid_type(kind, expected).at(&self.span)
    }
}

/// Methods that all read by the same one.
macro_rules! read_by {
    ($reader:ident: $($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
            self.$reader(visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Value<'_> {
    type Error = Misfit;

    read_by!(table: deserialize_map);
    read_by!(array: deserialize_seq);
    read_by!(text: deserialize_str deserialize_string);
    read_by!(truth: deserialize_bool);
    read_by!(number: deserialize_f32 deserialize_f64 deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_i128);
    read_by!(number: deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 deserialize_u128);

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        // The name of a struct says nothing to the author of a file.
        if !matches!(self.kind, Kind::Table(_)) {
            return Err(self.misfit(&"a table"));
        }
        self.table(visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Misfit> {
        self.array(visitor)
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.scalar().map_err(|error| error.at(&self.span))? {
            Scalar::Text(_) => self.text(visitor),
            Scalar::Whole(_) | Scalar::Real(_) => self.number(visitor),
            Scalar::Truth(_) => self.truth(visitor),
            Scalar::Date => Err(self.misfit(&visitor)),
            Scalar::Array => self.array(visitor),
            Scalar::Table => self.table(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        match self.kind {
            Kind::Other(DeValue::String(text)) => visitor.visit_enum(StrDeserializer::new(text)),
            Kind::Table(table) if table.len() == 1 => {
                visitor.visit_enum(MapAccessDeserializer::new(Entries::of(table)))
            }
            Kind::Table(table) if table.is_empty() => Err(Misfit::custom("wanted exactly 1 element, found 0 elements")),
            Kind::Table(_) => Err(Misfit::custom("wanted exactly 1 element, more than 1 element")),
            Kind::Other(_) => Err(Misfit::custom("wanted string or table")),
        }
        .map_err(|error| error.at(&self.span))
    }

    forward_to_deserialize_any! {
        char bytes byte_buf unit ignored_any unit_struct tuple_struct identifier
    }
}

/// A whole number, as the smallest kind that holds it.
fn whole<'de, V: Visitor<'de>>(number: i128, visitor: V) -> Result<V::Value, Misfit> {
    if let Ok(number) = i64::try_from(number) {
        return visitor.visit_i64(number);
    }
    match u64::try_from(number) {
        Ok(number) => visitor.visit_u64(number),
        Err(_) => visitor.visit_i128(number),
    }
}

type Entry<'a> = (&'a Spanned<DeString<'a>>, &'a Spanned<DeValue<'a>>);

/// Keys and values of a table, in the order of the file's reader.
struct Entries<'a> {
    left: std::vec::IntoIter<Entry<'a>>,
    value: Option<&'a Spanned<DeValue<'a>>>,
}

impl<'a> Entries<'a> {
    fn of(table: &'a DeTable<'a>) -> Self {
        Self { left: table.iter().collect::<Vec<_>>().into_iter(), value: None }
    }
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Misfit> {
        let Some((key, value)) = self.left.next() else { return Ok(None) };
        self.value = Some(value);
        let name = StrDeserializer::new(key.get_ref());
        seed.deserialize(name).map(Some).map_err(|error: Misfit| error.at(&key.span()))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        let value = self.value.take().ok_or_else(|| Misfit::custom("a value comes after its key"))?;
        seed.deserialize(Value::from(value)).map_err(|error| error.at(&value.span()))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left.len())
    }
}

/// Values of an array.
struct Items<'a>(std::slice::Iter<'a, Spanned<DeValue<'a>>>);

impl<'de> SeqAccess<'de> for Items<'_> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Misfit> {
        self.0.next().map(|value| seed.deserialize(Value::from(value))).transpose()
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.0.len())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        a: f64,
        list: Option<Vec<u32>>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Word {
        One,
        Two,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        #[serde(default)]
        inner: Vec<Inner>,
        word: Option<Word>,
        flag: Option<bool>,
        text: Option<String>,
        by_name: Option<BTreeMap<String, i64>>,
    }

    /// Both readers: the same values, or the same words at the same place.
    #[test]
    fn values_and_refusals_are_those_of_the_reader_of_toml() {
        let texts = [
            "",
            "word = 'two'\nflag = true\ntext = \"a\\nb\"",
            "[[inner]]\na = 1\n[[inner]]\na = 2.5e-3\nlist = [1, 0x10, 3_000]",
            "by_name = { x = -9223372036854775808, y = 7 }",
            "word = 'three'",
            "word = 3",
            "word = { one = 1, two = 2 }",
            "word = {}",
            "word = { three = 1 }",
            "flag = 'yes'",
            "inner = [{ a = true }]",
            "inner = [{ a = 1, b = 2 }]",
            "inner = [{ list = [] }]",
            "inner = [{ a = 1, list = [1, -1] }]",
            "inner = [{ a = 1, list = [4294967296] }]",
            "inner = 3",
            "text = ['a']",
            "text = 2.5",
            "flag = { a = 1 }",
            "by_name = [1]",
            "inner = [{ a = [1] }]",
            "inner = [{ a = 'x' }]",
            "inner = { a = 1 }",
            "by_name = { x = 9223372036854775808 }",
            "by_name.x.y = 1",
            "other = 1",
        ];
        let mut refused = 0;
        for text in texts {
            let ours = typed::<Outer>(DeTable::parse(text).unwrap().get_ref());
            match (ours, toml::from_str::<Outer>(text)) {
                (Ok(ours), Ok(theirs)) => assert_eq!(ours, theirs, "{text}"),
                (Err(ours), Err(theirs)) => {
                    refused += 1;
                    let place = ours.span.filter(|span| *span != (0..0));
                    assert_eq!((ours.message.as_str(), place), (theirs.message(), theirs.span()), "{text}");
                }
                (ours, theirs) => panic!("{text}: {ours:?} and {theirs:?}"),
            }
        }
        assert_eq!(refused, 22);
        assert!(typed::<Outer>(DeTable::parse("text = 1979-05-27").unwrap().get_ref()).is_err());
        // The reader of `toml` takes an array for the fields of a struct in their order; a file of ours has names.
        let unnamed = "inner = [[1.0, [2]]]";
        assert!(toml::from_str::<Outer>(unnamed).is_ok());
        let refused = typed::<Outer>(DeTable::parse(unnamed).unwrap().get_ref()).unwrap_err();
        let words = "invalid type: sequence, expected a table";
        assert_eq!((refused.message.as_str(), refused.span), (words, Some(9..19)));
    }
}
