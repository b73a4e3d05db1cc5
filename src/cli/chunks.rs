//! Texts that shaders include by a name which is no file's: a string that host code keeps under it, as in
//! `export const Noise = "…"` and `chunks["noise"] = "…"`.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use base::text::{Assembly, SourceFile, Span};
use disk::{Budget, hosts_around};
use hosts::script::{SCRIPT_EXTENSIONS, kept_under};
use program::Written;

/// Texts that are put in at most.
const MOST: usize = 256;

/// Names that are told at most.
const MOST_TOLD: usize = 6;

/// Endings of files that a name without one may mean.
const ENDINGS: [&str; 5] = ["", ".wgsl", ".wesl", ".glsl", ".h"];

/// Strings of host code by their names; none for one that was looked for and is nowhere.
#[derive(Default)]
pub struct Chunks {
    budget: Budget,
    known: HashMap<String, Option<SourceFile>>,
}

impl Chunks {
    /// The text of a file with the strings that it includes by name, and what to tell of them.
    pub fn put(&mut self, file: &SourceFile, path: &Path) -> (SourceFile, Vec<String>) {
        let is_module = Written::of(file) == Written::Wgsl;
        let (mut text, mut taken, mut left) = (file.clone(), Vec::<(String, Vec<String>)>::new(), MOST);
        let mut done = HashSet::new();
        loop {
            let asked = asked(text.text());
            let names: Vec<&str> =
                asked.iter().map(|(name, _)| &name[..]).filter(|name| !is_file(path, name)).collect();
            self.search(path, &names);
            let (mut out, mut at) = (Assembly::new(), 0);
            for (name, line) in &asked {
                let Some(Some(chunk)) = self.known.get(name).filter(|_| left > 0 && names.contains(&&name[..])) else {
                    continue;
                };
                left -= 1;
                out.copy(&text, Span::new(at, line.start));
                let again = !done.insert(name.clone());
                // A module declares nothing twice.
                if !(again && is_module) {
                    out.copy(chunk, Span::new(0, chunk.text().len()));
                }
                if !again {
                    let (named, host) = (format!("`{name}`"), chunk.origin(Span::at(0)).0);
                    match taken.iter_mut().find(|(known, _)| known == host.name()) {
                        Some((_, names)) => names.push(named),
                        None => taken.push((host.name().to_owned(), vec![named])),
                    }
                }
                at = line.end;
            }
            if at == 0 {
                return (text, taken.iter().map(|(host, names)| note(host, names)).collect());
            }
            out.copy(&text, Span::new(at, text.text().len()));
            text = out.finish(file.name());
        }
    }

    /// Looks for names around a file, the nearest folder first.
    fn search(&mut self, path: &Path, names: &[&str]) {
        let mut open: Vec<&str> = names.iter().copied().filter(|name| !self.known.contains_key(*name)).collect();
        if open.is_empty() {
            return;
        }
        let is_script = |path: &Path| {
            let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
            SCRIPT_EXTENSIONS.contains(&&ending[..])
        };
        hosts_around(path, &is_script, &mut |paths| {
            for path in paths {
                let Some(file) = self.budget.read(path) else { continue };
                for name in open.iter().filter(|name| file.text().contains(**name)) {
                    if let Some(literal) = kept_under(&file, name) {
                        let chunk = literal.assembled(&file, file.name());
                        self.known.entry((*name).to_owned()).or_insert(Some(chunk));
                    }
                }
                open.retain(|name| !self.known.contains_key(*name));
            }
            !open.is_empty()
        });
        for name in open {
            self.known.insert(name.to_owned(), None);
        }
    }
}

/// What to tell of strings of one file.
fn note(host: &str, names: &[String]) -> String {
    let (first, more) = names.split_at(names.len().min(MOST_TOLD));
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    let are = if names.len() == 1 { "is" } else { "are" };
    format!("{}{more} {are} taken from {host}", first.join(", "))
}

/// True for a name that a file beside the one that asks has.
fn is_file(path: &Path, name: &str) -> bool {
    let folder = path.parent().unwrap_or(Path::new(""));
    ENDINGS.iter().any(|ending| folder.join(format!("{name}{ending}")).is_file())
}

/// The lines of a text that include something by a name without an ending or a folder, in their order.
fn asked(text: &str) -> Vec<(String, Span)> {
    let (mut found, mut start) = (Vec::new(), 0);
    for line in text.split_inclusive('\n') {
        let end = start + line.trim_end_matches(['\n', '\r']).len();
        let named = line.trim_start().strip_prefix('#').and_then(|rest| rest.trim_start().strip_prefix("include"));
        let inside = named.map(str::trim).and_then(|rest| {
            let close = match rest.chars().next()? {
                '<' => '>',
                quote @ ('"' | '\'') => quote,
                _ => return None,
            };
            rest[1..].split_once(close).map(|(name, _)| name.trim())
        });
        let is_name = |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if let Some(name) = inside.filter(is_name) {
            found.push((name.to_owned(), Span::new(start, end)));
        }
        start += line.len();
    }
    found
}
