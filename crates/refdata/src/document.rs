//! Where a data set comes from and what is in it: the same document in every format.

use serde::{Deserialize, Serialize};

use super::array::Array;
use super::flags::Flag;

/// Name of the schema.
pub const SCHEMA: &str = "shadercheck-refdata";
/// Its version. The number before the point changes when a reader of before cannot read what is written now.
pub const SCHEMA_VERSION: &str = "1.1";

/// Provenance of a data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: String,
    /// What wrote it.
    pub tool: Tool,
    /// Suite and shader whose inputs and outputs these are.
    pub suite: SuiteSource,
    /// What gives the expected values.
    pub expected: ExpectedSource,
    /// Where inputs come from.
    pub domain: Vec<Domain>,
    /// Seed of the inputs, in decimal: a 64-bit number is more than every reader of JSON takes.
    pub seed: String,
    /// Samples of one case, which share its uniforms.
    pub per_case: u64,
    /// Samples of the whole data set.
    pub samples: u64,
    /// The first sample of this file, counted from 0.
    pub first: u64,
    /// Samples of this file.
    pub rows: u64,
    /// Samples of a block, which is what is hashed at a time; the last of a data set may be shorter.
    pub block_rows: u64,
    /// What bounds are derived from; `null` when the file has none.
    pub profile: Option<ProfileSource>,
    /// Meaning of the bits of `flags`.
    pub flags: Vec<FlagBit>,
    /// The arrays, in the order in which blocks are hashed.
    pub arrays: Vec<Array>,
    /// SHA-256 over the SHA-256 of each block.
    pub sha256: String,
}

/// Bytes of a block in memory, at most: those that are written have some tens of MiB.
const MOST_BLOCK: u64 = 1 << 30;
/// Samples of a data set, at most.
const MOST_SAMPLES: u64 = 1 << 48;

/// What wrote a data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Name.
    pub name: String,
    /// Version.
    pub version: String,
}

/// The suite of a data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SuiteSource {
    /// Name.
    pub name: String,
    /// What is tested, in a few words.
    pub title: String,
    /// File name of the shader.
    pub shader: String,
    /// `vertex`, `geometry`, `fragment`, `compute` or `function`.
    pub stage: String,
    /// Macros of this variant.
    pub defines: Vec<(String, String)>,
    /// SHA-256 of the text of the suite file.
    pub suite_sha256: String,
    /// SHA-256 of the text of the shader.
    pub shader_sha256: String,
}

/// What gives expected values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExpectedSource {
    /// `formula`: real numbers, rounded once, so that they are within 1 ULP of binary64; `meaning`: the
    /// shader's own operations in binary64; `reference`: those of another shader; `recorded`: recorded values.
    pub by: String,
    /// How exact they are, in words; empty in files of schema 1.0.
    #[serde(default)]
    pub accuracy: String,
    /// Name of the formula.
    pub formula: Option<String>,
    /// The formula in words, with the numbers of its equations.
    pub source: Option<String>,
    /// The numbers of its equations.
    pub equations: Vec<u32>,
}

/// Inputs that one generator fills.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Names of inputs that one generator fills together.
    pub inputs: Vec<String>,
    /// Name of the generator.
    pub generator: String,
    /// What it makes.
    pub about: String,
    /// What bounds it.
    pub range: Option<[f64; 2]>,
    /// Its values, for one that has fixed ones.
    pub values: Vec<f64>,
    /// Components that the host feeds; all without it.
    pub components: Option<u8>,
}

/// The profile of a data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileSource {
    /// Name.
    pub name: String,
    /// Revision of the specification, or extent of the measurement.
    pub revision: String,
    /// Stage of the device, which decides about subnormal numbers.
    pub stage: String,
    /// Whether sums and products may be regrouped.
    pub rearranged: bool,
}

/// What one bit of the array `flags` says of a sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlagBit {
    /// Name.
    pub name: String,
    /// Value of the bit.
    pub bit: u16,
    /// What it says.
    pub about: String,
}

/// All bits of `flags`.
pub(super) fn flag_bits() -> Vec<FlagBit> {
    let bit = |flag: Flag| FlagBit { name: flag.name().into(), bit: flag as u16, about: flag.about().into() };
    Flag::ALL.into_iter().map(bit).collect()
}

/// Stands for the digest until it is known, in files that begin with the document.
pub(super) const NO_DIGEST: &str = "0000000000000000000000000000000000000000000000000000000000000000";

impl Document {
    /// The document in one line.
    pub fn line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// The document of a file.
    ///
    /// # Errors
    /// What is wrong with the text: no document, another schema, or a version that is not read here.
    pub fn read(text: &str) -> Result<Self, String> {
        #[derive(Deserialize)]
        struct Head {
            schema: String,
            schema_version: String,
        }
        let head: Head = serde_json::from_str(text)
            .map_err(|error| format!("its provenance is no document of schema `{SCHEMA}`: {error}"))?;
        if head.schema != SCHEMA {
            return Err(format!("its schema is `{}`, not `{SCHEMA}`", head.schema));
        }
        let major = |version: &str| version.split('.').next().and_then(|n| n.parse::<u32>().ok());
        if major(&head.schema_version) != major(SCHEMA_VERSION) {
            return Err(format!(
                "its schema has version {}, and this program reads {SCHEMA_VERSION}; generate it again or use the \
                 version of shadercheck that wrote it",
                head.schema_version
            ));
        }
        serde_json::from_str(text).map_err(|error| format!("its provenance cannot be read: {error}"))
    }

    /// The same without a digest: what a writer begins with.
    #[must_use]
    pub fn without_digest(&self) -> Self {
        Self { sha256: NO_DIGEST.into(), ..self.clone() }
    }

    /// Whether another document is of the same run.
    ///
    /// # Errors
    /// The first thing that differs, in words.
    pub fn same_run(&self, other: &Self) -> Result<(), String> {
        let profile =
            |d: &Self| d.profile.as_ref().map_or_else(|| "none".to_owned(), |p| format!("{} {}", p.name, p.revision));
        let pairs = [
            ("the suite", &self.suite.name, &other.suite.name),
            ("the version of the tool", &self.tool.version, &other.tool.version),
            ("the version of the schema", &self.schema_version, &other.schema_version),
            ("the seed", &self.seed, &other.seed),
            ("the profile", &profile(self), &profile(other)),
            ("--samples", &self.samples.to_string(), &other.samples.to_string()),
            ("SHA-256 of the suite file", &self.suite.suite_sha256, &other.suite.suite_sha256),
            ("SHA-256 of the shader", &self.suite.shader_sha256, &other.suite.shader_sha256),
        ];
        for (what, one, two) in pairs {
            if one != two {
                return Err(format!("{what} is `{one}` in one and `{two}` in the other"));
            }
        }
        let rest = |d: &Self| Self { first: 0, rows: 0, sha256: String::new(), ..d.clone() };
        if rest(self) == rest(other) { Ok(()) } else { Err("their provenance differs".to_owned()) }
    }

    /// Whether the sizes are those of a data set, and blocks are whole cases, as readers rely on.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub(super) fn check_sizes(&self) -> Result<(), String> {
        self.check_blocks()?;
        let end = self.first.checked_add(self.rows);
        if self.samples > MOST_SAMPLES || end.is_none_or(|end| end > self.samples) {
            let Self { first, rows, samples, .. } = self;
            return Err(format!("its provenance states {rows} samples from {first} on, of {samples} in all"));
        }
        let bytes = self.arrays.iter().try_fold(0_u64, |all, array| {
            let words = array.shape.iter().try_fold(array.dtype.bytes(), |all, &n| all.checked_mul(n))?;
            all.checked_add((words as u64).checked_mul(self.array_rows(array, self.block_rows))?)
        });
        match bytes.filter(|&bytes| bytes <= MOST_BLOCK) {
            Some(_) => Ok(()),
            None => Err(format!("its provenance states blocks of more than {MOST_BLOCK} bytes, which nothing writes")),
        }
    }

    fn check_blocks(&self) -> Result<(), String> {
        let Self { first, block_rows, per_case, .. } = self;
        let whole = *block_rows > 0 && *per_case > 0 && block_rows.is_multiple_of(*per_case);
        if whole && first.is_multiple_of(*block_rows) {
            return Ok(());
        }
        // The part behind the last block is empty, and begins where the data set ends.
        if whole && self.rows == 0 && *first == self.samples {
            return Ok(());
        }
        Err("its provenance states blocks that are no whole cases".to_owned())
    }

    /// Bytes of one array for a number of samples that begin with a case.
    pub fn array_rows(&self, array: &Array, rows: u64) -> u64 {
        match array.per {
            super::Per::Sample => rows,
            super::Per::Case => rows.div_ceil(self.per_case.max(1)),
        }
    }
}

/// The JSON Schema of the JSON format.
pub fn schema() -> &'static str {
    include_str!(env!("SHADERCHECK_REFDATA_SCHEMA"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_schemas_and_versions_are_told_apart() {
        let read = |text: &str| Document::read(text).unwrap_err();
        assert!(read("[]").starts_with("its provenance is no document"));
        assert_eq!(
            read(r#"{"schema": "other", "schema_version": "1.0"}"#),
            "its schema is `other`, not `shadercheck-refdata`"
        );
        assert!(
            read(r#"{"schema": "shadercheck-refdata", "schema_version": "2.0"}"#)
                .starts_with("its schema has version 2.0, and this program reads 1.1;")
        );
        // A later version with the same number before the point is read as far as it is known.
        assert!(
            read(r#"{"schema": "shadercheck-refdata", "schema_version": "1.7"}"#)
                .starts_with("its provenance cannot be read: missing field")
        );
    }
}
