//! How much is asked of a text.

/// How much is asked of a text. Each level has the rules of those before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// What is wrong or wasteful for certain: silent on code that compiles and works.
    #[default]
    Default,
    /// What is often a mistake, and sometimes meant.
    Strict,
    /// Guesses by names and habits.
    Heuristic,
}
