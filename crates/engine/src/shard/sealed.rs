//! The text in which a shard hands over what it found: what run it is of, which shards it covers, and a checksum
//! of all of it. A text that was cut off, or changed, is not read.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use base::text::fingerprint;
use lanes::Description;

/// Name of the format.
pub const SCHEMA: &str = "shadercheck.shard";
/// Its version: raised when a reader of the one before could misread it.
pub const SCHEMA_VERSION: u64 = 1;

/// What makes two shards parts of one run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the subcommand, such as `check`.
    pub command: String,
    /// Version of the tool.
    pub version: String,
    /// Seed of the inputs.
    pub seed: u64,
    /// Everything else that the result depends on, by name.
    pub parameters: BTreeMap<String, String>,
    /// Number of shards.
    pub shards: u64,
}

/// How two identities differ.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{what} is `{one}` in one and `{other}` in the other")]
pub struct Mismatch {
    /// The part of the identity that differs, such as `the seed`.
    pub what: String,
    /// In the first.
    pub one: String,
    /// In the second.
    pub other: String,
}

impl Identity {
    /// That of a run of this version of the tool.
    pub fn new(command: &str, seed: u64, shards: u64) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { command: command.to_owned(), version, seed, parameters: BTreeMap::new(), shards }
    }

    /// The same with one parameter more.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.parameters.insert(name.to_owned(), value.to_string());
        self
    }

    /// The same on lanes, each with its driver.
    #[must_use]
    pub fn on<'l>(self, lanes: impl IntoIterator<Item = &'l Description>) -> Self {
        lanes.into_iter().fold(self, |all, lane| all.with(&format!("lane `{}`", lane.name), &lane.driver))
    }

    /// The same of a text, known by its fingerprint.
    #[must_use]
    pub fn of(self, what: &str, text: &str) -> Self {
        self.with(what, format!("{:016x}", fingerprint(text)))
    }

    /// Whether both are of one run.
    ///
    /// # Errors
    /// [`Mismatch`] with the first thing that differs.
    pub fn same(&self, other: &Self) -> Result<(), Mismatch> {
        let pair = |what: &str, one: &dyn ToString, other: &dyn ToString| {
            let (what, one, other) = (what.to_owned(), one.to_string(), other.to_string());
            if one == other { Ok(()) } else { Err(Mismatch { what, one, other }) }
        };
        pair("the command", &self.command, &other.command)?;
        pair("the version of the tool", &self.version, &other.version)?;
        pair("the seed", &self.seed, &other.seed)?;
        pair("the number of shards", &self.shards, &other.shards)?;
        let none = String::from("not given");
        for name in self.parameters.keys().chain(other.parameters.keys()) {
            let of = |identity: &Self| identity.parameters.get(name).unwrap_or(&none).clone();
            pair(name, &of(self), &of(other))?;
        }
        Ok(())
    }
}

/// What a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    /// What one or more shards found, from beginning to end.
    Result,
    /// How far a shard got.
    Checkpoint,
}

/// A result or checkpoint with the run and the shards that it is of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sealed<T> {
    /// A result or a checkpoint.
    pub sort: Sort,
    /// The run that it is a part of.
    pub identity: Identity,
    /// Numbers of the shards that this is of, ascending.
    pub covers: Vec<u64>,
    /// What they found.
    pub found: T,
}

/// Why a text is no sealed one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SealError {
    /// The text does not begin with the schema.
    #[error("this is no result of a shard: it does not begin with the schema `{SCHEMA}`")]
    NotOne,
    /// Of another version of the format.
    #[error(
        "this is a result of schema version {0}, and this version of the tool reads version {SCHEMA_VERSION}; run all \
         shards and the merge with one version of the tool"
    )]
    Version(u64),
    /// Cut off or changed.
    #[error("the file is damaged: {0}; remove it and run its shard again")]
    Damaged(String),
}

/// The first line; what follows is the body and a closing bracket, so that the whole is one JSON object.
fn head(version: u64, checksum: u64, bytes: usize) -> String {
    format!(
        "{{\"schema\":\"{SCHEMA}\",\"schema_version\":{version},\"checksum\":\"{checksum:016x}\",\"bytes\":{bytes},\"body\":\n"
    )
}

/// The text for something found.
///
/// # Errors
/// When it cannot be written as JSON: a defect of the caller.
pub fn seal<T: Serialize>(sealed: &Sealed<T>) -> Result<String, serde_json::Error> {
    let body = serde_json::to_string(sealed)?;
    Ok(format!("{}{body}\n}}\n", head(SCHEMA_VERSION, checksum(body.as_bytes()), body.len())))
}

/// Reads a text, if it is whole.
///
/// # Errors
/// [`SealError`] with what is wrong with it.
pub fn open<T: DeserializeOwned>(text: &str) -> Result<Sealed<T>, SealError> {
    let beginning = format!("{{\"schema\":\"{SCHEMA}\",\"schema_version\":");
    let rest = text.strip_prefix(&beginning).ok_or(SealError::NotOne)?;
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let cut = || SealError::Damaged("it ends too early".to_owned());
    let version: u64 = rest[..digits].parse().map_err(|_| cut())?;
    if version != SCHEMA_VERSION && digits < rest.len() {
        return Err(SealError::Version(version));
    }
    let (_, after) = text.split_once('\n').ok_or_else(cut)?;
    let body = after.strip_suffix("\n}\n").ok_or_else(cut)?;
    if !text.starts_with(&head(version, checksum(body.as_bytes()), body.len())) {
        return Err(SealError::Damaged("its checksum does not fit".to_owned()));
    }
    serde_json::from_str(body).map_err(|error| SealError::Damaged(error.to_string()))
}

/// FNV-1a of 64 bits: it shows accidents, and is no seal against somebody who wants to deceive.
fn checksum(bytes: &[u8]) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(OFFSET, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed() -> Sealed<Vec<u64>> {
        let identity = Identity::new("check", 7, 4).with("samples", 1000).with("lanes", "embedded");
        Sealed { sort: Sort::Result, identity, covers: vec![0, 2], found: vec![1, u64::MAX] }
    }

    #[test]
    fn what_is_sealed_is_read_back_and_is_json() {
        let text = seal(&sealed()).unwrap();
        assert_eq!(open(&text), Ok(sealed()));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&value["schema"], &value["body"]["covers"]), (&SCHEMA.into(), &serde_json::json!([0, 2])));
    }

    #[test]
    fn every_prefix_is_refused() {
        let text = seal(&sealed()).unwrap();
        for end in 0..text.len() {
            assert!(open::<Vec<u64>>(&text[..end]).is_err(), "{}", &text[..end]);
        }
    }

    #[test]
    fn every_changed_byte_is_refused() {
        let text = seal(&sealed()).unwrap();
        for at in 0..text.len() {
            let mut bytes = text.clone().into_bytes();
            bytes[at] ^= 1;
            let Ok(changed) = String::from_utf8(bytes) else { continue };
            assert!(open::<Vec<u64>>(&changed).is_err(), "byte {at}: {changed}");
        }
    }

    #[test]
    fn another_version_and_another_file_are_reported() {
        let text = seal(&sealed()).unwrap();
        let newer = text.replace("\"schema_version\":1", "\"schema_version\":2");
        assert_eq!(open::<Vec<u64>>(&newer), Err(SealError::Version(2)));
        assert_eq!(open::<Vec<u64>>("{}\n"), Err(SealError::NotOne));
        assert_eq!(open::<Vec<u64>>(""), Err(SealError::NotOne));
    }

    #[test]
    fn runs_that_differ_are_told_apart() {
        let one = sealed().identity;
        assert_eq!(one.same(&one), Ok(()));
        let reported = |other: Identity| one.same(&other).unwrap_err().to_string();
        assert_eq!(reported(Identity { seed: 8, ..one.clone() }), "the seed is `7` in one and `8` in the other");
        assert_eq!(
            reported(Identity { version: "9.9.9".into(), ..one.clone() }),
            format!("the version of the tool is `{}` in one and `9.9.9` in the other", env!("CARGO_PKG_VERSION"))
        );
        assert_eq!(reported(one.clone().with("samples", 5)), "samples is `1000` in one and `5` in the other");
        assert_eq!(reported(one.clone().with("quick", true)), "quick is `not given` in one and `true` in the other");
        assert!(reported(Identity { shards: 5, ..one.clone() }).contains("number of shards"));
        assert!(reported(Identity { command: "fuzz".into(), ..one.clone() }).contains("the command"));
    }
}
