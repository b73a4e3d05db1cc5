//! What hosts put in front of a shader, and behind it, as data: one file each in `data`, and one line here.
//!
//! A file begins with lines of `//!`: a title, and what tells that a text is written for this host. Then come parts
//! behind lines such as `--- vertex`: GLSL for a stage, for `both`, or for what stands `behind` the text.

mod isf;
#[cfg(test)]
mod tests;

use base::text::{SourceFile, Span};
use syntax::Stage;

use hosts::{Literal, marks};

/// A host whose shaders stand behind a text of its own.
#[derive(Debug, PartialEq, Eq)]
pub struct Prelude {
    /// Its name, for `--prelude`.
    pub name: &'static str,
    data: &'static str,
}

const fn prelude(name: &'static str, data: &'static str) -> Prelude {
    Prelude { name, data }
}

/// All of them, by name.
pub const PRELUDES: &[Prelude] = &[
    prelude("cocos2d", include_str!("data/cocos2d.glsl")),
    prelude("deckgl", include_str!("data/deckgl.glsl")),
    prelude("gamemaker", include_str!("data/gamemaker.glsl")),
    prelude("isf", include_str!("data/isf.glsl")),
    prelude("kivy", include_str!("data/kivy.glsl")),
    prelude("love", include_str!("data/love.glsl")),
    prelude("qt", include_str!("data/qt.glsl")),
    prelude("shadertoy", include_str!("data/shadertoy.glsl")),
    prelude("three", include_str!("data/three.glsl")),
    prelude("touchdesigner", include_str!("data/touchdesigner.glsl")),
];

/// Which prelude a text gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wanted {
    /// The one that it is recognised to be written for.
    #[default]
    Recognised,
    /// The same, or else this one where it fits: the host code of the project speaks of it.
    RecognisedOr(&'static Prelude),
    /// This one.
    Named(&'static Prelude),
    /// None.
    Nothing,
}

impl Wanted {
    /// The same where one of the texts of a project speaks of a host that only host code tells.
    pub fn in_project<'t>(self, mut texts: impl Iterator<Item = &'t str>) -> Self {
        let mut telling = PRELUDES.iter().filter_map(|p| Some((p, p.header("project")?)));
        match (self, telling.next()) {
            (Self::Recognised, Some((prelude, word))) if texts.any(|text| text.contains(word)) => {
                Self::RecognisedOr(prelude)
            }
            _ => self,
        }
    }

    /// What a name means: that of a prelude, or `none`.
    pub fn named(name: &str) -> Option<Self> {
        if name == "none" {
            return Some(Self::Nothing);
        }
        PRELUDES.iter().find(|p| p.name == name).map(Self::Named)
    }
}

/// A text between those that its host puts around it.
pub struct Between {
    /// All of it.
    pub literal: Literal,
    /// The host.
    pub prelude: &'static Prelude,
    /// What stands in front, as a part of the text.
    pub front: Span,
    /// What stands behind.
    pub behind: Span,
    /// True where the text itself says what its host declares: nothing else is.
    pub whole: bool,
}

/// The prelude of a text.
pub fn recognised(text: &str, wanted: Wanted) -> Option<&'static Prelude> {
    match wanted {
        Wanted::Nothing => None,
        Wanted::Named(prelude) => Some(prelude),
        Wanted::Recognised | Wanted::RecognisedOr(_) => {
            let told = |p: &&'static Prelude| p.header("project").is_none() || wanted == Wanted::RecognisedOr(p);
            let mut may = PRELUDES.iter().filter(told).filter(|p| p.may_fit(text)).peekable();
            may.peek()?;
            let code = marks::without_comments(text);
            may.find(|p| p.declarations(text).is_some() || p.fits(&code))
        }
    }
}

/// A text with what its host puts around it; none where nothing does.
pub fn around(text: &Literal, stage: Stage, wanted: Wanted) -> Option<Between> {
    let prelude = recognised(&text.text, wanted)?;
    let code = marks::without_comments(&text.text);
    let stage = if prelude.is_of_fragments() && stage == Stage::Library { Stage::Fragment } else { stage };
    let version = version_line(&text.text);
    let mut front = prelude.part("both", stage, &code);
    let declared = prelude.declarations(&text.text);
    let whole = declared.is_some();
    // What functions declare is their own.
    let again = |line: &&String| {
        let declaration = line.split(';').next().unwrap_or(line);
        code.split([';', '\n']).any(|statement| statement.split_whitespace().eq(declaration.split_whitespace()))
    };
    for line in declared.iter().flatten().filter(|line| !again(line)) {
        front.push_str(line);
        front.push('\n');
    }
    front.push_str(&prelude.part(stage.name(), stage, &code));
    let behind = prelude.part(&format!("behind {}", stage.name()), stage, &code);
    if version.is_some() {
        front = front.lines().filter(|l| !l.starts_with("#version")).map(|l| format!("{l}\n")).collect();
    }
    if front.is_empty() && behind.is_empty() {
        return None;
    }
    let hook = prelude.header("hook").and_then(|hook| text.text.find(hook));
    let at = hook.or(version).unwrap_or(0);
    let literal = text.with_text_at(at, &front, &format!("\n{behind}"));
    let end = literal.text.len();
    let behind = Span::new(end - behind.len(), end);
    Some(Between { front: Span::new(at, at + front.len()), behind, literal, prelude, whole })
}

/// True for a uniform to which a host gives a value in every program, also in one that declares it by itself. The host is `known`
/// to put its text around a shader of the program, or host code `says` a word that tells it.
pub fn sets(name: &str, known: Option<&'static Prelude>, says: impl Fn(&str) -> bool) -> bool {
    let mut hosts = PRELUDES.iter().filter_map(|prelude| Some((prelude, prelude.header("host")?)));
    hosts.any(|(prelude, word)| prelude.has_uniform(name) && (known == Some(prelude) || says(word)))
}

/// A file with what its host puts around it, for commands that run it; itself where nothing does.
///
/// The stage is that of a fragment shader where what stands behind a library makes one of it.
pub fn behind(file: &SourceFile, stage: Stage, wanted: Wanted) -> (SourceFile, Stage) {
    let whole = Literal::part(file, Span::new(0, file.text().len()));
    let Some(between) = around(&whole, stage, wanted) else { return (file.clone(), stage) };
    let whole = stage == Stage::Library && !between.behind.is_empty();
    (between.literal.assembled(file, file.name()), if whole { Stage::Fragment } else { stage })
}

/// Where the line of `#version` ends.
fn version_line(text: &str) -> Option<usize> {
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        at += line.len();
        if line.trim_start().starts_with("#version") {
            return Some(at);
        }
    }
    None
}

impl Prelude {
    /// What it is.
    pub fn title(&self) -> &'static str {
        self.header("title").unwrap_or(self.name)
    }

    fn header(&self, key: &str) -> Option<&'static str> {
        let mut headers = self.data.lines().map_while(|l| l.strip_prefix("//! "));
        headers.find_map(|l| l.split_once(": ").filter(|(k, _)| *k == key).map(|(_, value)| value))
    }

    /// True for a uniform that its text declares, or that it sets beside these.
    fn has_uniform(&self, name: &str) -> bool {
        let declared = self.data.lines().filter_map(|line| line.strip_prefix("uniform ")?.strip_suffix(';'));
        let mut declared = declared.filter_map(|line| line.split_whitespace().last());
        let beside = self.header("sets").unwrap_or("");
        declared.any(|one| one == name) || beside.split_whitespace().any(|one| one == name)
    }

    /// True when all that it has is for fragment shaders.
    fn is_of_fragments(&self) -> bool {
        self.data.lines().filter_map(|l| l.strip_prefix("--- ")).all(|part| part.ends_with("fragment"))
    }

    /// What a text says in front of itself that this host declares; none where it says nothing of the kind.
    fn declarations(&self, text: &str) -> Option<Vec<String>> {
        (self.header("inputs") == Some("isf")).then(|| isf::declarations(text))?
    }

    /// False for a text that says none of the words that tell this host.
    fn may_fit(&self, text: &str) -> bool {
        let words = ["hook", "defines", "uses", "says", "states"].into_iter().filter_map(|key| self.header(key));
        words.flat_map(str::split_whitespace).any(|word| text.contains(word))
    }

    /// True for code that is written for this host.
    fn fits(&self, code: &str) -> bool {
        let has_not = |key: &str| self.header(key).is_none_or(|w| !code.contains(w));
        if !has_not("without") {
            return false;
        }
        if let Some(hook) = self.header("hook") {
            return code.contains(hook);
        }
        if let Some(limit) = self.header("version-below").and_then(|v| v.parse::<u32>().ok()) {
            let stated = code.split_once("#version").and_then(|(_, rest)| rest.split_whitespace().next()?.parse().ok());
            if stated.is_none_or(|v: u32| v >= limit || v == 100) {
                return false;
            }
        }
        if let Some(function) = self.header("defines") {
            let called =
                |at: usize| code[at..].trim_start_matches(|c: char| c.is_alphanumeric()).trim_start().starts_with('(');
            return code.match_indices(function).any(|(at, _)| code[..at].trim_end().ends_with("void") && called(at))
                && !marks::has_main(code);
        }
        if let Some(words) = self.header("says") {
            return words.split_whitespace().any(|word| marks::has_word(code, word));
        }
        let words = self.header("uses").unwrap_or("").split_whitespace();
        let used = |word: &str| code.contains(word) && marks::has_word(code, word) && !declares(code, word);
        words.into_iter().any(used)
    }

    /// A part of the data without the declarations that the text has itself.
    fn part(&self, part: &str, stage: Stage, code: &str) -> String {
        if stage == Stage::Library && part == stage.name() {
            return String::new();
        }
        let mut inside = false;
        let mut found = String::new();
        for line in self.data.lines() {
            if let Some(name) = line.strip_prefix("--- ") {
                inside = name == part;
            } else if inside && !is_declared(line, code) {
                found.push_str(line);
                found.push('\n');
            }
        }
        found
    }
}

/// True when code declares itself what a line of the data declares.
fn is_declared(line: &str, code: &str) -> bool {
    if let Some(rest) = line.strip_prefix("#define ") {
        let name = rest.split([' ', '(']).next().unwrap_or(rest);
        return code.lines().any(|l| l.split_whitespace().take(2).eq(["#define", name]));
    }
    const STORAGE: [&str; 5] = ["uniform ", "attribute ", "varying ", "in ", "out "];
    let Some(rest) = STORAGE.iter().find_map(|s| line.strip_prefix(s)) else { return false };
    let end = rest.find([';', '[']).unwrap_or(rest.len());
    rest[..end].split_whitespace().last().is_some_and(|name| declares(code, name))
}

/// True when code declares a name itself.
fn declares(code: &str, name: &str) -> bool {
    const STORAGE: [&str; 8] = ["uniform", "attribute", "varying", "in", "out", "const", "layout", "flat"];
    let part = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(name).any(|(at, _)| {
        let (before, behind) = (&code[..at], &code[at + name.len()..]);
        if before.ends_with(part) || behind.starts_with(part) || before.ends_with('.') {
            return false;
        }
        let statement = before.rsplit([';', '{', '}', '\n']).next().unwrap_or("").trim_start();
        let first = statement.split(|c: char| !part(c) && c != '#').next().unwrap_or("");
        let word = before.trim_end().rsplit(|c: char| !part(c)).next().unwrap_or("");
        let typed = before.ends_with(char::is_whitespace)
            && !word.is_empty()
            && !["return", "else", "if", "define"].contains(&word);
        let is_macro = before.trim_end().ends_with("#define");
        is_macro || STORAGE.contains(&first) || (typed && syntax::types::Type::from_name(word).is_some())
    })
}
