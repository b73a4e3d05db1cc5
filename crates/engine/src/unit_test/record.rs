//! What a test writes down, read from the output words of a run.

use base::value::Record;

/// Expectations of a test that are judged.
pub const MOST: usize = 64;

/// Where in the output words of a test what it writes down lies.
#[derive(Clone, Debug)]
pub struct Places {
    /// How many expectations it has reached.
    pub count: usize,
    /// First words of what was found and of what was expected, four each.
    pub actual: usize,
    pub expected: usize,
    /// Two words.
    pub tolerance: usize,
    /// Two whole numbers.
    pub words: usize,
    pub kind: usize,
    pub width: usize,
    pub site: usize,
}

impl Places {
    /// The places in outputs; none for those of something else.
    pub fn of(outputs: &Record) -> Option<Self> {
        let first = |name: &str| Some(outputs.range(outputs.index_of(&format!("return.{name}"))?).start);
        let part = |name: &str| first(&format!("last.{name}"));
        Some(Self {
            count: first("count")?,
            actual: part("actual")?,
            expected: part("expected")?,
            tolerance: part("tolerance")?,
            words: part("words")?,
            kind: part("kind")?,
            width: part("width")?,
            site: part("site")?,
        })
    }
}
