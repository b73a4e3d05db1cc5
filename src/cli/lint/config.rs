//! `shadercheck.toml`: what a project says about itself, and how it wants to be linted.

use std::fmt;
use std::path::{Path, PathBuf};

use globset::{GlobBuilder, GlobMatcher};
use thiserror::Error;
use toml::de::DeTable;

use crate::cli::LangName;
use analysis::range::Stated;
use base::nearest;
use base::text::{Shown, SourceFile, TextError};
use disk::Problem;
use disk::table::{At, Reader, Table};
use hosts::{Wrapped, Wrapper};
use lint::{Config, Selection};
use reading::{ProgramEntry, Variant};

use super::LevelName;

/// Name of the file.
pub const FILE_NAME: &str = "shadercheck.toml";

const KEYS: [&str; 7] = ["lint", "presets", "range", "program", "wrapper", "variant", "compare"];
const LINT_KEYS: [&str; 5] = ["select", "ignore", "level", "lang", "per-file-ignores"];
const LEVELS: [(&str, LevelName); 3] =
    [("default", LevelName::Default), ("strict", LevelName::Strict), ("heuristic", LevelName::Heuristic)];
const LANGS: [(&str, LangName); 2] = [("en", LangName::En), ("ja", LangName::Ja)];
/// More arguments than a function has.
const MOST_ARGUMENTS: u64 = 255;

/// Why a configuration cannot be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// It cannot be read.
    #[error("{}: cannot be read ({source})", path.shown())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// It is not UTF-8.
    #[error(transparent)]
    Text(#[from] TextError),
    /// Something in it is wrong.
    #[error(transparent)]
    Wrong(#[from] Problems),
}

/// Everything that is wrong in a file, in its order.
#[derive(Debug, Error)]
pub struct Problems(pub Vec<Problem>);

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(Problem::to_string).collect();
        f.write_str(&lines.join("\nerror: "))
    }
}

/// A configuration as it stands in its file.
#[derive(Clone, Debug, Default)]
pub struct FileConfig {
    /// The folder of the file; paths and patterns start there.
    pub folder: PathBuf,
    /// Rules to run, when the file says so.
    pub select: Option<Vec<String>>,
    /// Rules to leave out, when the file says so.
    pub ignore: Option<Vec<String>>,
    /// The level.
    pub level: Option<LevelName>,
    /// Language of messages.
    pub lang: Option<LangName>,
    /// Rules that are left out for files that match.
    pub per_file: Vec<PerFilePattern>,
    /// What rules are told.
    pub config: Config,
    /// Files that are to mean the same.
    pub twins: Vec<TwinPatterns>,
}

/// Files that are to mean the same as others, which `shadercheck compare` holds against each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TwinPatterns {
    /// Pattern of paths of the first.
    pub first: String,
    /// Pattern of paths of their twins.
    pub second: String,
    /// Functions that are known to differ.
    pub except: Vec<String>,
}

/// Rules that are left out for some files.
#[derive(Clone, Debug)]
pub struct PerFilePattern {
    matcher: GlobMatcher,
    /// True when the pattern names a path from the folder, and not only a file's name.
    with_path: bool,
    /// Codes, beginnings of codes, or names.
    pub rules: Vec<String>,
}

impl PerFilePattern {
    /// True for a file, given by its path from the folder of the configuration.
    pub fn matches(&self, path: &Path) -> bool {
        let path = if self.with_path { Some(path) } else { path.file_name().map(Path::new) };
        path.is_some_and(|p| self.matcher.is_match(p))
    }
}

/// A pattern of paths: `*` stays within a folder, `**` goes through all of them.
///
/// # Errors
/// When it is none.
pub fn glob(pattern: &str) -> Result<GlobMatcher, globset::Error> {
    let glob = GlobBuilder::new(pattern.trim_start_matches("./")).literal_separator(true).build()?;
    Ok(glob.compile_matcher())
}

/// Reads a configuration file.
///
/// # Errors
/// [`ConfigError`]: the system's, or everything that is wrong in the text.
pub fn read(path: &Path) -> Result<FileConfig, ConfigError> {
    let bytes = std::fs::read(path).map_err(|source| ConfigError::Read { path: path.to_owned(), source })?;
    let file = SourceFile::from_bytes(&super::files::name(path), &bytes)?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    Ok(FileConfig { folder, ..parse(&file)? })
}

/// Reads the text of a configuration. Its folder is left empty.
///
/// # Errors
/// Everything that is wrong, each with `file:line:column`.
pub fn parse(file: &SourceFile) -> Result<FileConfig, Problems> {
    let reader = Reader::new(file);
    let config = match DeTable::parse(file.text()) {
        Ok(document) => Some(whole(Table::root(&reader, document.get_ref()))),
        Err(error) => {
            let message = error.message().trim_end().replace('\n', "; ");
            reader.problem(error.span().map_or(0, |s| s.start), format!("not TOML: {message}"));
            None
        }
    };
    reader.finish(config, "the configuration cannot be read").map_err(Problems)
}

fn whole(root: Table<'_>) -> FileConfig {
    let root = root.only(&KEYS);
    let mut config = FileConfig::default();
    if let Some(lint) = root.table("lint", "[lint]") {
        let lint = lint.only(&LINT_KEYS);
        config.select = lint.has("select").then(|| rules(lint, "select"));
        config.ignore = lint.has("ignore").then(|| rules(lint, "ignore"));
        config.level = choice(lint, "level", &LEVELS);
        config.lang = choice(lint, "lang", &LANGS);
        if let Some(table) = lint.table("per-file-ignores", "[lint.per-file-ignores]") {
            config.per_file = per_file(table);
        }
    }
    if let Some(compare) = root.table("compare", "[compare]") {
        config.twins = compare.only(&["pairs"]).tables("pairs", "pairs").into_iter().filter_map(twins).collect();
    }
    config.config = Config {
        ranges: root.tables("range", "[[range]]").into_iter().filter_map(range).collect(),
        programs: root.tables("program", "[[program]]").into_iter().filter_map(program).collect(),
        wrappers: root.tables("wrapper", "[[wrapper]]").into_iter().filter_map(wrapper).collect(),
        variants: root.tables("variant", "[[variant]]").into_iter().filter_map(variant).collect(),
        presets: presets(root),
        ..Config::default()
    };
    config
}

/// Rules by code, beginning of a code, or name; unknown ones are noted.
fn rules(table: Table<'_>, key: &str) -> Vec<String> {
    let given = table.texts(key);
    for At { value, offset } in &given {
        if let Err(error) = Selection::new(std::slice::from_ref(value), &[]) {
            table.reader.problem(*offset, error.to_string());
        }
    }
    given.into_iter().map(|rule| rule.value).collect()
}

/// One of some words.
fn choice<T: Copy>(table: Table<'_>, key: &str, all: &[(&str, T)]) -> Option<T> {
    let given = table.text(key)?;
    let found = all.iter().find(|(name, _)| *name == given.value).map(|(_, value)| *value);
    if found.is_none() {
        unknown(table, key, &given, all.iter().map(|(name, _)| *name));
    }
    found
}

fn unknown<'n>(table: Table<'_>, key: &str, given: &At<String>, all: impl Iterator<Item = &'n str> + Clone) {
    let hint = match nearest(&given.value, all.clone()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("known: {}", all.collect::<Vec<_>>().join(", ")),
    };
    table.reader.problem(given.offset, format!("`{key}` cannot be `{}`; {hint}", given.value));
}

fn per_file(table: Table<'_>) -> Vec<PerFilePattern> {
    let mut patterns = Vec::new();
    for At { value: pattern, offset } in table.keys() {
        let rules = rules(table, pattern);
        match glob(pattern) {
            Ok(matcher) => {
                patterns.push(PerFilePattern { matcher, with_path: pattern.contains('/'), rules });
            }
            Err(error) => {
                table.reader.problem(offset, format!("`{pattern}` is no pattern of paths: {}", error.kind()));
            }
        }
    }
    patterns
}

fn range(table: Table<'_>) -> Option<Stated> {
    let table = table.only(&["name", "min", "max"]);
    let name = table.required_text("name", "name = \"shininess\"");
    for key in ["min", "max"].into_iter().filter(|key| !table.has(key)) {
        table.missing(key, &format!("{key} = 1.0"));
    }
    let (min, max) = (table.number("min")?, table.number("max")?);
    if max.value < min.value {
        let message = format!("`max` is {}, which is less than `min`, {}", max.value, min.value);
        table.reader.problem(max.offset, message);
    }
    Some(Stated { name: name?.value, min: min.value, max: max.value })
}

fn program(table: Table<'_>) -> Option<ProgramEntry> {
    let table = table.only(&["shaders", "hosts"]);
    if !table.has("shaders") {
        table.missing("shaders", "shaders = [\"a.vert\", \"a.frag\"]");
        return None;
    }
    let texts = |key: &str| table.texts(key).into_iter().map(|t| t.value).collect::<Vec<_>>();
    let entry = ProgramEntry { shaders: texts("shaders"), hosts: texts("hosts") };
    if entry.shaders.is_empty() {
        table.reader.problem(table.offset_of("shaders"), "`shaders` is empty; a program has at least one shader");
    }
    Some(entry)
}

/// A macro with its values; without them it may be defined or not.
fn variant(table: Table<'_>) -> Option<Variant> {
    let table = table.only(&["name", "values"]);
    let name = table.required_text("name", "name = \"QUALITY\"")?;
    let values: Vec<Option<String>> = table.texts("values").into_iter().map(|value| Some(value.value)).collect();
    if table.has("values") && values.is_empty() {
        let message = "`values` is empty; without this key, the macro may be defined or not";
        table.reader.problem(table.offset_of("values"), message);
    }
    let values = if table.has("values") { values } else { vec![Some("1".to_owned()), None] };
    Some(Variant { name: name.value, values })
}

fn wrapper(table: Table<'_>) -> Option<Wrapper> {
    let table = table.only(&["function", "kind", "argument", "sets"]);
    let function = table.required_text("function", "function = \"setMat4\"");
    if !table.has("kind") {
        table.missing("kind", "kind = \"set-uniform\"");
    }
    let kind = choice(table, "kind", &Wrapped::ALL);
    let argument = table.whole("argument", 0, MOST_ARGUMENTS);
    let sets = table.text("sets").map(|s| s.value);
    if let (Some(kind), true) = (kind, sets.is_some())
        && kind != Wrapped::SetUniform
    {
        let message = "`sets` is the type that a function of kind \"set-uniform\" sets; remove it here";
        table.reader.problem(table.offset_of("sets"), message);
    }
    Some(Wrapper { function: function?.value, kind: kind?, argument: argument.unwrap_or(0) as usize, sets })
}

fn twins(table: Table<'_>) -> Option<TwinPatterns> {
    let table = table.only(&["first", "second", "except"]);
    let first = table.required_text("first", "first = \"glsl/**\"");
    let second = table.required_text("second", "second = \"wgsl/**\"");
    for At { value: pattern, offset } in [&first, &second].into_iter().flatten() {
        if let Err(error) = glob(pattern) {
            table.reader.problem(*offset, format!("`{pattern}` is no pattern of paths: {}", error.kind()));
        }
    }
    let except = table.texts("except").into_iter().map(|name| name.value).collect();
    Some(TwinPatterns { first: first?.value, second: second?.value, except })
}

fn presets(root: Table<'_>) -> Vec<String> {
    let given = root.texts("presets");
    for preset in given.iter().filter(|p| !Config::PRESETS.contains(&p.value.as_str())) {
        unknown(root, "presets", preset, Config::PRESETS.into_iter());
    }
    given.into_iter().map(|p| p.value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<FileConfig, String> {
        parse(&SourceFile::new("shadercheck.toml", text)).map_err(|e| e.to_string())
    }

    const WHOLE: &str = r#"
presets = ["qt"]

[lint]
select = ["T", "N014"]
ignore = ["low-precision-pi"]
level = "strict"
lang = "ja"

[lint.per-file-ignores]
"third_party/**" = ["T", "H"]
"*.vert" = ["N014"]

[[range]]
name = "material.shininess"
min = 1
max = 128.0

[[program]]
shaders = ["a.vert", "a.frag"]
hosts = ["main.cpp"]

[[wrapper]]
function = "setMat4"
kind = "set-uniform"
sets = "mat4"

[[wrapper]]
function = "attribute"
kind = "attribute-location"
argument = 1

[[variant]]
name = "QUALITY"
values = ["0", "1"]

[[variant]]
name = "GLOW"

[compare]
pairs = [{ first = "glsl/**", second = "wgsl/**", except = ["hash"] }]
"#;

    #[test]
    fn every_key_is_read() {
        let config = read(WHOLE).unwrap();
        assert_eq!(config.select.as_deref(), Some(&["T".to_owned(), "N014".to_owned()][..]));
        assert_eq!(config.ignore.as_deref(), Some(&["low-precision-pi".to_owned()][..]));
        assert_eq!((config.level, config.lang), (Some(LevelName::Strict), Some(LangName::Ja)));
        assert_eq!(config.config.range_of("material.shininess"), Some((1.0, 128.0)));
        assert_eq!(config.config.presets, ["qt"]);
        assert_eq!(config.config.programs[0].shaders, ["a.vert", "a.frag"]);
        assert_eq!(config.config.programs[0].hosts, ["main.cpp"]);
        let wrappers: Vec<_> = config.config.wrappers.iter().map(|w| (w.kind, w.argument, w.sets.as_deref())).collect();
        assert_eq!(wrappers, [(Wrapped::SetUniform, 0, Some("mat4")), (Wrapped::AttributeLocation, 1, None)]);
        let values = |values: &[Option<&str>]| values.iter().map(|v| v.map(str::to_owned)).collect::<Vec<_>>();
        let variants: Vec<_> = config.config.variants.iter().map(|v| (v.name.as_str(), v.values.clone())).collect();
        assert_eq!(variants, [("QUALITY", values(&[Some("0"), Some("1")])), ("GLOW", values(&[Some("1"), None]))]);
        let twins =
            TwinPatterns { first: "glsl/**".to_owned(), second: "wgsl/**".to_owned(), except: vec!["hash".to_owned()] };
        assert_eq!(config.twins, [twins]);
        assert!(read("").unwrap().select.is_none());
    }

    #[test]
    fn patterns_match_names_anywhere_and_paths_from_the_folder() {
        let config = read(WHOLE).unwrap();
        let rules = |path: &str| {
            let matching = config.per_file.iter().filter(|p| p.matches(Path::new(path)));
            matching.map(|p| p.rules.len()).sum::<usize>()
        };
        assert_eq!(rules("third_party/x/a.cpp"), 2);
        assert_eq!(rules("x/third_party/a.cpp"), 0, "from the folder");
        assert_eq!(rules("x/y/a.vert"), 1);
        assert_eq!(rules("x/y/a.frag"), 0);
        assert_eq!(rules("third_party/a.vert"), 3);
    }

    #[test]
    fn what_is_wrong_is_reported_with_its_place() {
        for (text, at, part) in [
            ("[lnit]\n", "1:2", "did you mean `lint`?"),
            ("[lint]\nselct = []\n", "2:1", "did you mean `select`?"),
            ("[lint]\nselect = [\"T0O1\"]\n", "2:11", "T001"),
            ("[lint]\nlevel = \"strikt\"\n", "2:9", "did you mean `strict`?"),
            ("[lint]\nlang = \"fr\"\n", "2:8", "known: en, ja"),
            ("[lint.per-file-ignores]\n\"a[\" = []\n", "2:1", "no pattern"),
            ("[lint.per-file-ignores]\n\"a\" = [\"Q1\"]\n", "2:8", "Q1"),
            ("[[range]]\nname = \"a\"\nmin = 2\nmax = 1\n", "4:7", "less than"),
            ("[[range]]\nname = \"a\"\nmin = 2\n", "1:1", "missing key `max`"),
            ("[[program]]\nhosts = []\n", "1:1", "missing key `shaders`"),
            ("[[wrapper]]\nfunction = \"f\"\nkind = \"set-unifrom\"\n", "3:8", "did you mean `set-uniform`?"),
            ("[[wrapper]]\nfunction = \"f\"\nkind = \"load-program\"\nsets = \"mat4\"\n", "4:8", "remove it"),
            ("presets = [\"qtt\"]\n", "1:12", "did you mean `qt`?"),
            ("lint = 1\n", "1:8", "a table"),
            ("a = = b\n", "1:5", "not TOML"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with(&format!("shadercheck.toml:{at}: ")), "{text}: {error}");
            assert!(error.contains(part), "{text}: {error}");
        }
        let several = read("[lint]\nselct = []\nlevle = 1\n").unwrap_err();
        assert_eq!(several.lines().count(), 2, "{several}");
    }
}
