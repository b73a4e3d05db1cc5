//! Shader files with their includes, for commands that run them.

use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, Severity};
use crate::glsl::include::{self, Wanted};
use crate::glsl::{Parsed, Shader, Stage};
use crate::text::{Assembly, SourceFile, Span, decode};

/// A file that is run.
pub struct Source {
    /// Its name, as it was given.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
    /// Its text, with includes.
    pub file: SourceFile,
    /// Its stage.
    pub stage: Stage,
    /// Includes that were not found.
    missing: Vec<Wanted>,
    /// Folders that were searched.
    folders: Vec<PathBuf>,
}

/// Reads a file and what it includes: `"path"` beside the file that asks and then in `folders`, `<path>`
/// in `folders` alone.
///
/// # Errors
/// When the file cannot be read.
pub fn read(path: &Path, folders: &[PathBuf]) -> anyhow::Result<Source> {
    let file = crate::cli::translate::read(path)?;
    let included = include::resolve(&file, &mut |wanted| find(wanted, folders));
    Ok(Source {
        name: file.name().to_owned(),
        path: path.to_owned(),
        stage: Stage::from_path(file.name()).unwrap_or(Stage::Library),
        file: included.file,
        missing: included.missing,
        folders: folders.to_vec(),
    })
}

fn find(wanted: &Wanted, folders: &[PathBuf]) -> Option<SourceFile> {
    let beside = Path::new(wanted.from.name()).parent().filter(|_| wanted.quoted).map(Path::to_owned);
    // A path from the root is one of the virtual file system of ARB_shading_language_include.
    let path = wanted.path.trim_start_matches('/');
    beside.into_iter().chain(folders.iter().cloned()).find_map(|folder| {
        let path = if folder.as_os_str().is_empty() { PathBuf::from(path) } else { folder.join(path) };
        let bytes = std::fs::read(&path).ok()?;
        Some(decode(&plain(&path), &bytes).ok()?.file)
    })
}

/// A path without `.` and without `..` behind a folder, so that a file has one name.
fn plain(path: &Path) -> String {
    use std::path::Component;
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(parts.components().next_back(), Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.display().to_string()
}

impl Source {
    /// The shader. A library that names no version is written for whatever the shaders that it is put
    /// into say: the newest version is taken, unless only the oldest has what it uses.
    pub fn parsed(&self) -> Parsed {
        let parsed = Shader::parse(&self.file, self.stage);
        if self.stage != Stage::Library || parsed.shader.version().span.is_some() {
            return parsed;
        }
        let mut newest = Assembly::new();
        newest.insert("#version 460\n", &self.file, 0);
        newest.copy(&self.file, Span::new(0, self.file.text().len()));
        let newest = Shader::parse(&newest.finish(self.file.name()), self.stage);
        let errors = |p: &Parsed| p.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        if errors(&newest) > 0 && errors(&parsed) == 0 { parsed } else { newest }
    }

    /// A diagnostic with what is known about includes that were not found.
    pub fn explained(&self, diagnostic: Diagnostic) -> Diagnostic {
        let here = |w: &&Wanted| w.from.name() == diagnostic.file.name() && w.span.touches(diagnostic.span);
        let Some(wanted) = self.missing.iter().find(here) else { return diagnostic };
        let mut searched: Vec<String> = self.folders.iter().map(|f| f.display().to_string()).collect();
        if wanted.quoted {
            searched.insert(0, "the folder of the file".to_owned());
        }
        let message = format!("`{}` is not found", wanted.path);
        let why = match searched.is_empty() {
            true => "no folder was searched".to_owned(),
            false => format!("searched: {}", searched.join(", ")),
        };
        let new = Diagnostic::new(diagnostic.code, diagnostic.severity, &wanted.from, wanted.span, message);
        new.with_why(why).with_help("name its folder with `-I FOLDER`")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_one_name() {
        assert_eq!(plain(Path::new("./a/../b/./c.glsl")), "b/c.glsl");
        assert_eq!(plain(Path::new("../a.glsl")), "../a.glsl");
    }

    #[test]
    fn quoted_files_lie_beside_and_others_in_the_folders() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("lib")).unwrap();
        std::fs::write(at("main.glsl"), "#include \"near.glsl\"\n#include <far.glsl>\n#include <near.glsl>\n").unwrap();
        std::fs::write(at("near.glsl"), "float near;\n").unwrap();
        std::fs::write(at("lib/far.glsl"), "float far;\n").unwrap();
        let source = read(&at("main.glsl"), &[at("lib")]).unwrap();
        assert!(source.file.text().contains("float near;") && source.file.text().contains("float far;"));
        assert_eq!(source.missing.iter().map(|w| w.path.as_str()).collect::<Vec<_>>(), ["near.glsl"]);
    }
}
