//! Numbers in JSON that are read back as the same bits: as text in decimal, since JSON has neither NaN nor
//! infinity, and readers of its numbers may round. For `#[serde(with = …)]`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

fn text(value: f64) -> String {
    format!("{value:?}")
}

fn number<E: serde::de::Error>(text: &str) -> Result<f64, E> {
    text.parse().map_err(|_| E::custom(format!("`{text}` is no number")))
}

/// Writes a number.
///
/// # Errors
/// Those of the writer.
pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    text(*value).serialize(to)
}

/// Reads a number.
///
/// # Errors
/// When there is none.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(&String::deserialize(from)?)
}

/// A number, or none.
pub mod option {
    use super::{Deserialize, Deserializer, Serialize, Serializer, number, text};

    /// Writes a number, or none.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn serialize<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        value.map(text).serialize(to)
    }

    /// Reads a number, or none.
    ///
    /// # Errors
    /// When there is something else.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Option::<String>::deserialize(from)?.map(|text| number(&text)).transpose()
    }
}

/// Numbers in a row.
pub mod list {
    use super::{Deserialize, Deserializer, Serialize, Serializer, number, text};

    /// Writes numbers.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        values.iter().copied().map(text).collect::<Vec<_>>().serialize(to)
    }

    /// Reads numbers.
    ///
    /// # Errors
    /// When there is something else.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        Vec::<String>::deserialize(from)?.iter().map(|text| number(text)).collect()
    }
}

/// A number with something else, or none of both.
pub mod beside {
    use super::{Deserialize, Deserializer, Serialize, Serializer, number, text};

    /// Writes both.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn serialize<S: Serializer, T: Serialize>(value: &Option<(f64, T)>, to: S) -> Result<S::Ok, S::Error> {
        value.as_ref().map(|(number, other)| (text(*number), other)).serialize(to)
    }

    /// Reads both.
    ///
    /// # Errors
    /// When there is something else.
    pub fn deserialize<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Option<(f64, T)>, D::Error> {
        let pair = Option::<(String, T)>::deserialize(from)?;
        pair.map(|(text, other)| Ok((number(&text)?, other))).transpose()
    }
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Serialize, Deserialize)]
    struct All {
        #[serde(with = "super")]
        one: f64,
        #[serde(with = "super::option")]
        none: Option<f64>,
        #[serde(with = "super::list")]
        list: Vec<f64>,
        #[serde(with = "super::beside")]
        beside: Option<(f64, u8)>,
    }

    #[test]
    fn every_bit_comes_back() {
        let odd = [0.1, -0.0, f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, -f64::INFINITY, 1.0 / 3.0];
        for one in odd {
            let all = All { one, none: None, list: odd.to_vec(), beside: Some((one, 3)) };
            let read: All = serde_json::from_str(&serde_json::to_string(&all).unwrap()).unwrap();
            assert_eq!((read.one.to_bits(), read.none), (one.to_bits(), None));
            assert!(read.list.iter().zip(odd).all(|(a, b)| a.to_bits() == b.to_bits()));
            assert_eq!(read.beside.map(|(x, n)| (x.to_bits(), n)), Some((one.to_bits(), 3)));
        }
        let all = All { one: f64::NAN, none: Some(2.0), list: vec![], beside: None };
        let read: All = serde_json::from_str(&serde_json::to_string(&all).unwrap()).unwrap();
        assert!(read.one.is_nan() && read.none == Some(2.0) && read.beside.is_none());
        assert!(serde_json::from_str::<All>(r#"{"one":"x","none":null,"list":[],"beside":null}"#).is_err());
    }
}
