//! Anyone's outputs in JSON, read as columns of numbers: a tree of the text would take many times the memory.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::{Column, Numbers};

/// Columns of a file, at most.
const COLUMNS: usize = 1 << 16;

/// An object of lists, or a list alone, which has no name.
pub struct Columns;

impl<'de> Visitor<'de> for Columns {
    type Value = Vec<Column>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object of lists")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut columns = BTreeMap::new();
        while let Some(name) = map.next_key::<String>()? {
            if let Some(column) = map.next_value_seed(List { name: &name })? {
                columns.insert(name, column);
            }
            if columns.len() > COLUMNS {
                return Err(A::Error::custom(format!("it has more than {COLUMNS} members")));
            }
        }
        Ok(columns.into_values().collect())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
        Ok(List { name: "" }.visit_seq(list)?.into_iter().collect())
    }
}

/// A list with an entry for each sample. Members that are none are passed over.
struct List<'n> {
    name: &'n str,
}

impl<'de> DeserializeSeed<'de> for List<'_> {
    type Value = Option<Column>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for List<'_> {
    type Value = Option<Column>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a list with an entry for each sample")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let (mut numbers, mut width, mut row) = (Vec::new(), None, 0);
        let name = self.name;
        loop {
            let before = numbers.len();
            match list.next_element_seed(Entry { numbers: &mut numbers, name, row })? {
                None => break,
                Some(()) if *width.get_or_insert(numbers.len() - before) == numbers.len() - before => row += 1,
                Some(()) => {
                    return Err(A::Error::custom(format!("`{name}`, entry {row} has another number of words")));
                }
            }
        }
        let numbers = Numbers::F8(numbers);
        Ok(Some(Column { name: name.to_owned(), width: width.unwrap_or(1), numbers }))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(None)
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_unit<E: Error>(self) -> Result<Self::Value, E> {
        Ok(None)
    }
}

/// The numbers of a sample, however they are nested.
struct Entry<'a> {
    numbers: &'a mut Vec<f64>,
    name: &'a str,
    row: usize,
}

impl Entry<'_> {
    fn push<E>(self, number: f64) -> Result<(), E> {
        self.numbers.push(number);
        Ok(())
    }

    fn wrong<E: Error>(&self, what: impl fmt::Display) -> E {
        E::custom(format!("`{}`, entry {}: `{what}` is no number", self.name, self.row))
    }
}

impl<'de> DeserializeSeed<'de> for Entry<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Entry<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "numbers in `{}`, entry {}", self.name, self.row)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Self { numbers, name, row } = self;
        while list.next_element_seed(Entry { numbers: &mut *numbers, name, row })?.is_some() {}
        Ok(())
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<(), E> {
        self.push(number)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<(), E> {
        self.push(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<(), E> {
        self.push(number as f64)
    }

    // JSON has no literal for infinities and NaN.
    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.push(f64::NAN)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        match text.parse() {
            Ok(number) => self.push(number),
            Err(_) => Err(self.wrong(text)),
        }
    }

    fn visit_bool<E: Error>(self, what: bool) -> Result<(), E> {
        Err(self.wrong(what))
    }
}
