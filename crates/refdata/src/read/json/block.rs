//! The bits of a block of a reference file, read as the bytes of its arrays: a tree of the text would take many times
//! the memory.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::array::Array;
use crate::document::Document;

/// A block: the arrays of the document, in its order.
pub struct Arrays<'d> {
    document: &'d Document,
    number: usize,
}

impl<'d> Arrays<'d> {
    /// Of the block with this number.
    pub fn new(document: &'d Document, number: usize) -> Self {
        Self { document, number }
    }
}

impl<'de> DeserializeSeed<'de> for Arrays<'_> {
    type Value = Vec<Vec<u8>>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        let Self { document, number } = self;
        let mut arrays = vec![None; document.arrays.len()];
        Member { name: "arrays", then: Each { document, number, arrays: &mut arrays } }.deserialize(from)?;
        let missing = |array: &Array| D::Error::custom(format!("`{}` of block {number}: there is none", array.name));
        let found = arrays.into_iter().zip(&document.arrays);
        found.map(|(bytes, array)| bytes.ok_or_else(|| missing(array))).collect()
    }
}

/// One member of an object, and what reads its value; others are passed over.
struct Member<T> {
    name: &'static str,
    then: T,
}

impl<'de, T: DeserializeSeed<'de, Value = ()>> DeserializeSeed<'de> for Member<T> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_map(self)
    }
}

impl<'de, T: DeserializeSeed<'de, Value = ()>> Visitor<'de> for Member<T> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "an object with `{}`", self.name)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut then = Some(self.then);
        while let Some(name) = map.next_key::<String>()? {
            let seed = if name == self.name { then.take() } else { None };
            match seed {
                Some(seed) => map.next_value_seed(seed)?,
                None => map.next_value::<IgnoredAny>().map(|_| ())?,
            }
        }
        Ok(())
    }
}

/// The arrays by their names.
struct Each<'a> {
    document: &'a Document,
    number: usize,
    arrays: &'a mut [Option<Vec<u8>>],
}

impl<'de> DeserializeSeed<'de> for Each<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Each<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object of arrays")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let Self { document, number, arrays } = self;
        while let Some(name) = map.next_key::<String>()? {
            let Some(at) = document.arrays.iter().position(|array| array.name == name) else {
                map.next_value::<IgnoredAny>()?;
                continue;
            };
            let array = &document.arrays[at];
            let most = document.array_rows(array, document.block_rows) as usize * array.stride();
            let mut bytes = None;
            let then = Rows { array, number, most, bytes: &mut bytes };
            map.next_value_seed(Member { name: "bits", then })?;
            arrays[at] = bytes;
        }
        Ok(())
    }
}

/// The rows of an array: texts, or lists of texts.
struct Rows<'a> {
    array: &'a Array,
    number: usize,
    /// Bytes of a whole block.
    most: usize,
    bytes: &'a mut Option<Vec<u8>>,
}

impl Rows<'_> {
    fn wrong<E: Error>(&self, why: &str) -> E {
        E::custom(format!("`{}` of block {}: {why}", self.array.name, self.number))
    }
}

impl<'de> DeserializeSeed<'de> for Rows<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Rows<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "a list of the bits of `{}`", self.array.name)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<(), A::Error> {
        let mut bytes = Vec::new();
        while rows.next_element_seed(Row { rows: &self, bytes: &mut bytes })?.is_some() {
            if bytes.len() > self.most {
                return Err(self.wrong("it has more rows than a block of its provenance"));
            }
        }
        *self.bytes = Some(bytes);
        Ok(())
    }
}

/// The words of a row.
struct Row<'a> {
    rows: &'a Rows<'a>,
    bytes: &'a mut Vec<u8>,
}

impl Row<'_> {
    fn word<E: Error>(&mut self, text: &str) -> Result<(), E> {
        let size = self.rows.array.dtype.bytes();
        let bits = Some(text).filter(|text| text.len() == 2 * size).and_then(|text| u64::from_str_radix(text, 16).ok());
        let bits = bits.ok_or_else(|| self.rows.wrong("these are no bits"))?;
        self.bytes.extend_from_slice(&bits.to_le_bytes()[..size]);
        Ok(())
    }

    fn whole<E: Error>(&self, words: usize) -> Result<(), E> {
        if words == self.rows.array.words() {
            return Ok(());
        }
        Err(self.rows.wrong("a row has another number of words"))
    }
}

impl<'de> DeserializeSeed<'de> for Row<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Row<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("bits as a text")
    }

    fn visit_str<E: Error>(mut self, text: &str) -> Result<(), E> {
        self.whole(1)?;
        self.word(text)
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut words: A) -> Result<(), A::Error> {
        let mut count = 0;
        while let Some(text) = words.next_element::<String>()? {
            count += 1;
            if count > self.rows.array.words() {
                break;
            }
            self.word(&text)?;
        }
        self.whole(count)
    }
}
