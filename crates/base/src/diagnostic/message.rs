//! Words in the languages that the tool speaks.

use std::fmt;
use std::ops::Deref;

use crate::text::printable;

/// A language of messages and pages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lang {
    /// English.
    #[default]
    En,
    /// Japanese.
    Ja,
}

/// The same words in each language. Made by `message!`, or of one text that is the same in all
/// languages or has no translation. As a `str` it is the English text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Message {
    en: String,
    ja: Option<String>,
}

impl Message {
    /// Words in English and in Japanese.
    pub fn new(en: impl Into<String>, ja: impl Into<String>) -> Self {
        Self { en: en.into(), ja: Some(ja.into()) }
    }

    /// The words in `lang`, or in English where there are none.
    pub fn in_lang(&self, lang: Lang) -> &str {
        match (lang, &self.ja) {
            (Lang::Ja, Some(ja)) => ja,
            (Lang::Ja, None) | (Lang::En, _) => &self.en,
        }
    }

    /// The same with control characters as escapes, but for line breaks: what is quoted may be anything.
    pub(super) fn printable(self) -> Self {
        let lines = |text: String| {
            let odd = text.contains(|c: char| c.is_control() && c != '\n');
            if odd { text.split('\n').map(printable).collect::<Vec<_>>().join("\n") } else { text }
        };
        Self { en: lines(self.en), ja: self.ja.map(lines) }
    }

    /// True when there is a Japanese text.
    pub fn is_translated(&self) -> bool {
        self.ja.is_some()
    }
}

/// A [`Message`] of two format strings: English first, Japanese second. Names in braces are captured
/// in both, as by `format!`.
#[macro_export]
macro_rules! message {
    ($en:literal, $ja:literal $(,)?) => {
        $crate::diagnostic::Message::new(format!($en), format!($ja))
    };
}

impl From<String> for Message {
    fn from(en: String) -> Self {
        Self { en, ja: None }
    }
}

impl From<&str> for Message {
    fn from(en: &str) -> Self {
        en.to_owned().into()
    }
}

impl Deref for Message {
    type Target = str;

    fn deref(&self) -> &str {
        &self.en
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.en)
    }
}

impl PartialEq<str> for Message {
    fn eq(&self, other: &str) -> bool {
        self.en == other
    }
}

impl PartialEq<&str> for Message {
    fn eq(&self, other: &&str) -> bool {
        self.en == *other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_language_has_its_words() {
        let name = "p";
        let both = message!("`{name}` is an attribute", "`{name}` は頂点属性です");
        assert_eq!(both.in_lang(Lang::En), "`p` is an attribute");
        assert_eq!(both.in_lang(Lang::Ja), "`p` は頂点属性です");
        assert!(both.is_translated());
        let one = Message::from("alone");
        assert_eq!((one.in_lang(Lang::Ja), one.is_translated()), ("alone", false));
        assert_eq!((&*both, both.to_string().as_str()), ("`p` is an attribute", "`p` is an attribute"));
    }
}
