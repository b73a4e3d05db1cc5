//! What a suite expects of its shader, and the variants of a shader that it runs.

use super::dispatch::Count;
use base::did_you_mean;
use base::text::SourceFile;

/// What gives the expected outputs.
#[derive(Clone, Debug, Default)]
pub enum Expect {
    /// A formula of this crate, by name.
    Formula(String),
    /// Another shader: what it means in binary64.
    Reference(ReferenceFile),
    /// Recorded values.
    Recorded(RecordedFile),
    /// Nothing: lanes are held against what the shader means, and relations are checked.
    #[default]
    Nothing,
}

impl Expect {
    /// The name of the formula, where it is one.
    pub fn formula(&self) -> Option<&str> {
        match self {
            Self::Formula(name) => Some(name),
            Self::Reference(_) | Self::Recorded(_) | Self::Nothing => None,
        }
    }
}

/// A shader that says what is right.
#[derive(Clone, Debug)]
pub struct ReferenceFile {
    /// Path, relative to the suite file.
    pub file: String,
    /// The function that is called; `None` for the stage of the suite, or the function of the same name.
    pub function: Option<String>,
    /// The output that the value of the function stands for.
    pub output: Option<String>,
    /// Of a compute stage, its workgroups along x, y and z; those of the suite where it states none.
    pub groups: Vec<Count>,
    /// Its text; none before it has been read.
    pub text: Option<SourceFile>,
    /// Where the suite says it.
    pub at: String,
}

/// A file with recorded inputs and outputs.
#[derive(Clone, Debug)]
pub struct RecordedFile {
    /// Path, relative to the suite file.
    pub file: String,
    /// How far a recorded value may be from the true one, as a part of the largest component of its
    /// variable.
    pub relative_error: f64,
    /// The same as a number that is added.
    pub absolute_error: f64,
    /// Its text; none before it has been read, and for arrays of NumPy.
    pub text: Option<SourceFile>,
    /// Of arrays of NumPy, the archives: paths, relative to the suite file, and bytes.
    pub archives: Vec<(String, Vec<u8>)>,
    /// Where the suite says it.
    pub at: String,
}

impl RecordedFile {
    /// True for arrays of NumPy.
    pub fn is_arrays(&self) -> bool {
        self.file.ends_with(".npz")
    }

    /// The path for sizes: `sum_{N}.npz` has the name of a size in place of its value.
    pub fn path_for(&self, sizes: &Defines) -> String {
        sizes.iter().fold(self.file.clone(), |path, (name, value)| path.replace(&format!("{{{name}}}"), value))
    }
    /// Half a step of binary32: what rounding to binary32 does, and nothing else.
    pub const ROUNDED: f64 = 1.0 / (1_u32 << 24) as f64;
}

/// A macro with the values that it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Define {
    /// Name of the macro.
    pub name: String,
    /// Its values; `None` where it is not defined.
    pub values: Vec<Option<String>>,
}

/// Macros of one variant of a shader: names and values.
pub type Defines = Vec<(String, String)>;

/// All combinations of the values of macros, the last one changing fastest. Each comes with the words that
/// tell it apart: `BONES=4`, `no-FOG`.
pub fn combinations(defines: &[Define]) -> Vec<(Vec<String>, Defines)> {
    let mut all: Vec<Vec<(&str, Option<&str>)>> = vec![Vec::new()];
    for define in defines {
        all = all
            .into_iter()
            .flat_map(|head| {
                define.values.iter().map(move |value| {
                    let mut tail = head.clone();
                    tail.push((define.name.as_str(), value.as_deref()));
                    tail
                })
            })
            .collect();
    }
    all.into_iter()
        .map(|chosen| {
            let words: Vec<String> = chosen
                .iter()
                .map(|(name, value)| match value {
                    // Names of suites stand in lines of words, where `#` begins a comment.
                    Some(value) => format!("{name}={}", value.replace([' ', '\t', '#'], "_")),
                    None => format!("no {name}").replace(' ', "-"),
                })
                .collect();
            let defines =
                chosen.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?.to_owned()))).collect();
            (words, defines)
        })
        .collect()
}

/// A hint at the name that was meant. Programs that link no catalogue know none.
pub(super) fn hint<'n>(given: &str, all: impl Iterator<Item = &'n str>) -> String {
    let mut all = all.peekable();
    if all.peek().is_none() {
        return "this program links no catalogue; that of the textbook chapter is the crate `shadercheck-chapter`, linked by \
                `use chapter as _;`"
            .to_owned();
    }
    did_you_mean(given, all, "known:")
}
