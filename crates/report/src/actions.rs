//! How words are written into commands of GitHub Actions.
//! <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>

use base::text::printable;

/// The message of a command.
pub(super) fn data(text: &str) -> String {
    let shown = |c: char| match c {
        '%' => "%25".to_owned(),
        '\r' => "%0D".to_owned(),
        '\n' => "%0A".to_owned(),
        '\t' => c.to_string(),
        // A terminal would obey it.
        c => printable(c.encode_utf8(&mut [0; 4])),
    };
    text.chars().map(shown).collect()
}

/// A property of a command.
pub(super) fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}
