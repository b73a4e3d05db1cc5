//! Which words the shaders of a project have.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::Project;

/// A declaration in host code is looked at up to this many bytes behind its `uniform`.
const MOST: usize = 4000;

impl Project {
    /// True when a shader has this word, anywhere in its text, or a declaration of a uniform that host code holds.
    pub fn mentions(&self, word: &str) -> bool {
        self.words.get_or_init(|| self.all_words()).contains(&hashed(word))
    }

    fn all_words(&self) -> HashSet<u64> {
        let shaders: Vec<&str> = self.shaders().map(|s| s.file.text()).collect();
        let hosts: Vec<&str> = self.hosts().flat_map(|h| declarations(h.file.text())).collect();
        // On one thread: a rule asks first, and a thread that waited for others would take up one that asks again.
        shaders.into_iter().chain(hosts).flat_map(|text| words(text).map(hashed)).collect()
    }
}

/// From each `uniform` to the end of what it declares.
fn declarations(text: &str) -> Vec<&str> {
    let found = text.match_indices("uniform ").map(|(at, _)| {
        let rest = &text[at..];
        let rest = &rest[..rest.char_indices().map(|(i, _)| i).take_while(|i| *i < MOST).last().unwrap_or(0)];
        let first = rest.find([';', '{']).unwrap_or(rest.len());
        let end = if rest[first..].starts_with('{') { rest.find('}').unwrap_or(rest.len()) } else { first };
        &rest[..end]
    });
    found.collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty())
}

fn hashed(word: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    word.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use crate::project::{Input, Project};
    use base::text::SourceFile;

    #[test]
    fn words_of_shaders_and_of_declarations_in_host_code_count() {
        let host = "const char* part = \"uniform vec4 tint; float other;\"; int alone;";
        let files = [("a.frag", "// a hint\nuniform float gain;\nvoid main() {}"), ("m.cpp", host)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        let project = Project::new(&inputs, &crate::Config::default());
        for (word, expected) in [("gain", true), ("hint", true), ("tint", true), ("alone", false), ("gai", false)] {
            assert_eq!(project.mentions(word), expected, "{word}");
        }
    }
}
