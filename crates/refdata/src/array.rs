//! The arrays of a data set: what each holds, and how its words are called.

use serde::{Deserialize, Serialize};

/// What the words of an array are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Inputs.
    Input,
    /// What is expected.
    Expected,
    /// The number of the output's own type that is nearest to what is expected.
    Nearest,
    /// How far an output may be from what is expected.
    Bound,
    /// What is special about a sample.
    Flags,
}

/// Whether there is one value for a sample or one for all samples of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Per {
    /// One for each sample.
    Sample,
    /// One for each case: uniforms.
    Case,
}

/// Type of one word, as NumPy spells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WordType {
    /// binary32.
    #[serde(rename = "<f4")]
    F4,
    /// binary64.
    #[serde(rename = "<f8")]
    F8,
    /// 32-bit integer with sign.
    #[serde(rename = "<i4")]
    I4,
    /// 32-bit integer without sign.
    #[serde(rename = "<u4")]
    U4,
    /// 16-bit integer without sign.
    #[serde(rename = "<u2")]
    U2,
}

impl WordType {
    /// Bytes of a word.
    pub fn bytes(self) -> usize {
        match self {
            Self::F4 | Self::I4 | Self::U4 => 4,
            Self::F8 => 8,
            Self::U2 => 2,
        }
    }

    /// `<f4` and so on.
    pub fn name(self) -> &'static str {
        match self {
            Self::F4 => "<f4",
            Self::F8 => "<f8",
            Self::I4 => "<i4",
            Self::U4 => "<u4",
            Self::U2 => "<u2",
        }
    }
}

/// One array of a data set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Array {
    /// Name in the file, such as `expected.gl_Position`.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// The input or output of the shader; empty for flags.
    pub variable: String,
    /// Its type in the shader, such as `vec4`; empty for flags.
    #[serde(rename = "type")]
    pub ty: String,
    /// Type of a word.
    pub dtype: WordType,
    /// One for a sample or one for a case.
    pub per: Per,
    /// Shape of what there is for one sample or case; matrices are columns of rows.
    pub shape: Vec<usize>,
    /// What the words are called, in their order, behind the name: `.x`, `[0][0]`; for the vertices of a
    /// geometry stage `@2.x`.
    pub components: Vec<String>,
}

impl Array {
    /// Words of one sample or case.
    pub fn words(&self) -> usize {
        self.shape.iter().product()
    }

    /// Bytes of one sample or case.
    pub fn stride(&self) -> usize {
        self.words() * self.dtype.bytes()
    }

    /// Name of a word as a column of a table, such as `expected.gl_Position.x`.
    pub fn column(&self, word: usize) -> String {
        format!("{}{}", self.name, self.components.get(word).map_or("", String::as_str))
    }
}
