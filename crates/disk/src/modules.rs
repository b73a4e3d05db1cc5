//! Where the files lie that a text in WGSL is composed of: packages and modules of WESL, modules of naga_oil that say
//! their own names, included files, and files of the same folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::elsewhere::{plain, refusal};
use crate::hosts::{Budget, hosts_around};
use crate::includes::only_one;
use crate::{MOST_BYTES, read_source};
use base::diagnostic::Diagnostic;
use base::text::{Shown, SourceFile, decode};
use compose::{Composed, Library, ModulePath, Options, Origin, Wanted};

/// Files and folders that are looked at for modules that say their names, at most.
const MOST_SEEN: usize = 50_000;
/// Files beside one that may belong to it, at most.
const MOST_SIBLINGS: usize = 200;
/// Endings of files with modules, in the order in which they are tried.
const ENDINGS: [&str; 2] = ["wesl", "wgsl"];
/// Folders inside of a package where its modules may begin.
const INSIDE: [&str; 4] = ["", "src", "shaders", "src/shaders"];
/// Folders beside the packages of a project, where they may lie.
const PACKAGES: [&str; 3] = ["", "crates", "packages"];

/// Why a text cannot be composed.
#[derive(Debug, thiserror::Error)]
pub enum ComposeError {
    /// A file that is there and cannot be read, and why.
    #[error("cannot read `{0}`: {1}")]
    Unreadable(String, String),
    /// Something is wrong in the files.
    #[error("the files do not fit together")]
    Wrong(Vec<Diagnostic>),
}

/// Folders that are searched, and what is known about them.
#[derive(Debug)]
pub struct Modules {
    /// Folders that a user names.
    folders: Vec<PathBuf>,
    /// Modules by the names that they say, for each folder that was searched.
    said: BTreeMap<PathBuf, BTreeMap<String, PathBuf>>,
    /// The first file that is there and cannot be read, and why.
    failed: Option<(String, String)>,
    /// Bytes that may still be read.
    left: u64,
    /// A file below the folder of the one that asks is found by its name.
    below: bool,
    /// What no file beside the one that asks declares is looked for in the folders around.
    around: bool,
}

impl Modules {
    /// Looks for files in the folders that a user names, besides those around the file that asks.
    pub fn new(folders: Vec<PathBuf>) -> Self {
        Self { folders, said: BTreeMap::new(), failed: None, left: MOST_BYTES, below: false, around: false }
    }

    /// Finds `#import name` by the name of a file in the folders below, too: a guess about the host, for a text that is run.
    #[must_use]
    pub fn with_files_below(self) -> Self {
        Self { below: true, ..self }
    }

    /// Finds names that no file beside the one that asks declares in files of its project, too: a guess as well.
    #[must_use]
    pub fn with_files_around(self) -> Self {
        Self { around: true, ..self }
    }

    /// The text that a file stands for.
    ///
    /// # Errors
    /// [`ComposeError`]
    pub fn compose(&mut self, file: &SourceFile, options: &Options) -> Result<Composed, ComposeError> {
        self.left = MOST_BYTES;
        let composed = compose::compose(file, options, self);
        match self.failed.take() {
            Some((path, why)) => Err(ComposeError::Unreadable(path, why)),
            None => composed.map_err(ComposeError::Wrong),
        }
    }

    /// One error for each name that nothing declares, also where modules that are imported are not there.
    pub fn unknown_names(&mut self, file: &SourceFile, options: &Options) -> Vec<Diagnostic> {
        self.left = MOST_BYTES;
        let found = compose::unknown_names(file, options, self);
        if self.failed.take().is_some() { Vec::new() } else { found }
    }

    /// A file as text; none where there is none, or it cannot be read, which is kept.
    fn read(&mut self, path: &Path) -> Option<SourceFile> {
        let fail = |why: String| (path.shown(), why);
        if !path.is_file() {
            return None;
        }
        let bytes = match read_source(path) {
            Ok(bytes) if bytes.len() as u64 <= self.left => bytes,
            Ok(_) => {
                let why = format!("with what it imports, the text has more than {MOST_BYTES} bytes");
                self.failed.get_or_insert(fail(why));
                return None;
            }
            Err(error) => {
                self.failed.get_or_insert(fail(error.to_string()));
                return None;
            }
        };
        self.left -= bytes.len() as u64;
        match decode(&plain(path), &bytes) {
            Ok(decoded) => Some(decoded.file),
            Err(error) => {
                self.failed.get_or_insert(fail(error.to_string()));
                None
            }
        }
    }

    /// A module below a folder.
    fn below(&mut self, folder: &Path, names: &[String]) -> Option<SourceFile> {
        let path = names.iter().fold(folder.to_owned(), |path, name| path.join(name));
        if names.is_empty() {
            // The root of a package may be called after it, or `package`.
            let name = folder.file_name()?.to_string_lossy().into_owned();
            let inside = ["package", "lib", name.as_str()].map(|stem| folder.join(stem));
            let beside = [folder.to_owned()];
            return inside.iter().chain(&beside).find_map(|path| self.with_ending(path));
        }
        self.with_ending(&path)
    }

    fn with_ending(&mut self, path: &Path) -> Option<SourceFile> {
        ENDINGS.iter().find_map(|ending| {
            let name = format!("{}.{ending}", path.file_name()?.to_string_lossy());
            self.read(&path.with_file_name(name))
        })
    }

    /// The file that `#import name` means where it lies in a folder below, as the host collects them: `shared/name.wgsl`.
    /// None where several have the name, or where a module says that it is its own.
    fn below_by_name(&mut self, folder: &Path, wanted: &Wanted) -> Option<SourceFile> {
        let bare = wanted.path.chars().all(|c| c.is_alphanumeric() || c == '_');
        let says = |modules: &mut Self, project: PathBuf| modules.said(&project).contains_key(&wanted.path);
        if !wanted.import || !bare || self.projects(&wanted.from).into_iter().any(|project| says(self, project)) {
            return None;
        }
        let mut found = files_below(folder);
        found.retain(|path| path.file_stem().is_some_and(|stem| stem.to_string_lossy() == wanted.path));
        match &found[..] {
            [file] => self.read(file),
            _ => None,
        }
    }

    /// Modules in the files of a project that say their names.
    fn said(&mut self, folder: &Path) -> &BTreeMap<String, PathBuf> {
        self.said.entry(folder.to_owned()).or_insert_with(|| {
            let mut found = BTreeMap::new();
            for path in files_below(folder) {
                let Ok(bytes) = read_source(&path) else { continue };
                let text = String::from_utf8_lossy(&bytes);
                let name = text.lines().find_map(|line| line.trim_start().strip_prefix("#define_import_path"));
                if let Some(name) = name.and_then(|name| name.split_whitespace().next()) {
                    found.entry(name.trim_end_matches(';').to_owned()).or_insert(path);
                }
            }
            found
        })
    }

    /// Folders that are searched for what a file names: those of the user, and that of its project.
    fn projects(&self, from: &SourceFile) -> Vec<PathBuf> {
        let folder = folder_of(from);
        let project = ancestors(&folder).into_iter().last().unwrap_or(folder);
        self.folders.iter().cloned().chain([project]).collect()
    }
}

/// The folder of a file.
fn folder_of(file: &SourceFile) -> PathBuf {
    let folder = Path::new(file.name()).parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() }
}

/// Files that stand in the outermost folder of a project, and maybe in folders of it.
const MANIFESTS: [&str; 7] =
    ["Cargo.toml", "package.json", "wesl.toml", "CMakeLists.txt", "meson.build", "pyproject.toml", "go.mod"];

/// Folders that a module of a package may begin in: those around a file, up to that of its project.
pub fn ancestors(folder: &Path) -> Vec<PathBuf> {
    let (mut found, project) = outwards(folder);
    // Without a sign of a project, it is the folder itself and the one around it.
    found.truncate(project.map_or(2, |project| project + 1));
    found
}

/// The folders around a file, outwards, and which of them is that of its project: it ends where git says, or with the
/// outermost folder that has a manifest.
pub fn outwards(folder: &Path) -> (Vec<PathBuf>, Option<usize>) {
    let absolute = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let count = absolute.ancestors().take(32).count();
    let mut found: Vec<PathBuf> = Vec::new();
    let mut project = None;
    let mut at = folder.to_owned();
    for steps in 0..count {
        found.push(at.clone());
        let has = |name: &str| at.join(name).exists();
        if MANIFESTS.into_iter().any(has) {
            project = Some(steps);
        }
        if has(".git") {
            return (found, Some(steps));
        }
        at = match at.components().next_back() {
            Some(std::path::Component::Normal(_)) => match at.parent() {
                Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
                Some(parent) => parent.to_owned(),
                None => break,
            },
            Some(std::path::Component::RootDir | std::path::Component::Prefix(_)) | None => break,
            Some(std::path::Component::CurDir) if at.as_os_str() == "." => PathBuf::from(".."),
            Some(_) => at.join(".."),
        };
    }
    (found, project)
}

/// True for the folder of a package: it is called so, or its manifest says so. Names of packages may have `-` where those in
/// a path have `_`.
fn is_called(folder: &Path, package: &str) -> bool {
    let own = folder.file_name().map(ToOwned::to_owned);
    let own = own.or_else(|| Some(folder.canonicalize().ok()?.file_name()?.to_owned()));
    let is_it = |name: &str| name.replace('-', "_") == package;
    if own.is_some_and(|own| is_it(&own.to_string_lossy())) {
        return true;
    }
    let text =
        |name: &str| read_source(&folder.join(name)).ok().map(|text| String::from_utf8_lossy(&text).into_owned());
    let said = |manifest: &str| -> Option<String> {
        let table: toml::Table = text(manifest)?.parse().ok()?;
        Some(table.get("package")?.get("name")?.as_str()?.to_owned())
    };
    let json = || -> Option<String> {
        let value: serde_json::Value = serde_json::from_str(&text("package.json")?).ok()?;
        Some(value.get("name")?.as_str()?.rsplit('/').next()?.to_owned())
    };
    said("wesl.toml").or_else(|| said("Cargo.toml")).or_else(json).is_some_and(|name| is_it(&name))
}

/// The folder that the nearest `wesl.toml` names as the root of its package.
fn stated_root(folders: &[PathBuf]) -> Option<PathBuf> {
    let (folder, text) = folders.iter().find_map(|folder| {
        let text = read_source(&folder.join("wesl.toml")).ok()?;
        Some((folder, String::from_utf8_lossy(&text).into_owned()))
    })?;
    let table: toml::Table = text.parse().ok()?;
    let package = table.get("package").and_then(toml::Value::as_table);
    let root = table.get("root").or_else(|| package.and_then(|package| package.get("root")))?;
    Some(folder.join(root.as_str()?))
}

/// Files with modules below a folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    below(folder, &has_ending)
}

/// Files below a folder. Hidden folders and those of build tools are left out.
pub(crate) fn below(folder: &Path, keep: &dyn Fn(&Path) -> bool) -> Vec<PathBuf> {
    let (mut open, mut found, mut seen) = (vec![folder.to_owned()], Vec::new(), 0);
    while let Some(folder) = open.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|entry| (entry.path(), entry.file_type())).collect();
        paths.sort_by(|a, b| a.0.cmp(&b.0));
        for (path, kind) in paths {
            seen += 1;
            if seen > MOST_SEEN {
                return found;
            }
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let hidden = name.starts_with('.') || matches!(name.as_str(), "target" | "node_modules");
            match kind {
                Ok(kind) if kind.is_dir() && !hidden => open.push(path),
                Ok(kind) if kind.is_file() && keep(&path) => found.push(path),
                _ => {}
            }
        }
    }
    found
}

fn has_ending(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ENDINGS.iter().any(|own| ending.eq_ignore_ascii_case(own)))
}

impl Library for Modules {
    fn include(&mut self, wanted: &Wanted) -> Option<SourceFile> {
        let own = folder_of(&wanted.from);
        let within: Vec<&Path> =
            std::iter::once(own.as_path()).chain(self.folders.iter().map(PathBuf::as_path)).collect();
        // `#import name` leaves the ending out, and so may `#include "name"`.
        let bare = Path::new(&wanted.path).extension().is_none();
        let mut paths = if bare && wanted.import { Vec::new() } else { vec![wanted.path.clone()] };
        if bare {
            paths.extend(ENDINGS.iter().map(|ending| format!("{}.{ending}", wanted.path)));
        }
        // Engines name files from the folder of all shaders, which is one around them.
        let mut around = if wanted.quoted { ancestors(&own) } else { Vec::new() };
        let outer = around.split_off(around.len().min(1));
        let folders = around.into_iter().chain(self.folders.clone()).chain(outer.clone());
        let mut candidates: Vec<PathBuf> =
            folders.flat_map(|folder| paths.iter().map(move |path| folder.join(path)).collect::<Vec<_>>()).collect();
        // Or by the name of their package: `routines/structures.wgsl` for a file in any folder of it.
        if let Some((package, rest)) = wanted.path.split_once('/').filter(|_| wanted.quoted) {
            let is_package =
                |folder: &PathBuf| folder.file_name().is_some_and(|name| name.to_string_lossy() == package);
            if let Some(last) = outer.iter().position(is_package) {
                candidates.extend(std::iter::once(&own).chain(&outer[..last]).map(|folder| folder.join(rest)));
            }
        }
        for path in candidates {
            if refusal(&path, &within).is_none() && path.is_file() {
                return self.read(&path);
            }
        }
        if let Some(found) = self.below.then(|| self.below_by_name(&own, wanted)).flatten() {
            return Some(found);
        }
        let (folders, project) = outwards(&own);
        let project = folders.get(project?)?;
        let only = only_one(project, &wanted.path).filter(|path| wanted.quoted && has_ending(path))?;
        self.read(&only)
    }

    fn module(&mut self, from: &SourceFile, path: &ModulePath) -> Option<SourceFile> {
        let folder = folder_of(from);
        let around = ancestors(&folder);
        match &path.origin {
            Origin::File(file) => {
                if !path.names.is_empty() || !has_ending(Path::new(file)) {
                    return None;
                }
                let inside = around.iter().flat_map(|folder| [folder.clone(), folder.join("assets")]);
                let all: Vec<PathBuf> = inside.chain(self.folders.clone()).collect();
                all.iter().find_map(|folder| self.read(&folder.join(file)))
            }
            Origin::Super(count) => {
                let mut base = folder;
                (1..*count).for_each(|_| base.push(".."));
                self.below(Path::new(&plain(&base)), &path.names)
            }
            Origin::Package => {
                let stated = stated_root(&around);
                let roots: Vec<PathBuf> = stated.into_iter().chain(around).collect();
                roots.iter().find_map(|root| self.below(root, &path.names))
            }
            Origin::Named => {
                let name = path.names.join("::");
                for project in self.projects(from) {
                    if let Some(file) = self.said(&project).get(&name).cloned() {
                        return self.read(&file);
                    }
                }
                let (package, names) = path.names.split_first()?;
                let mut roots = Vec::new();
                for folder in self.folders.iter().chain(&around) {
                    let own = is_called(folder, package).then(|| folder.clone());
                    let inside = PACKAGES.iter().map(|packages| folder.join(packages).join(package));
                    for package in own.into_iter().chain(inside).filter(|package| package.is_dir()) {
                        roots.extend(stated_root(std::slice::from_ref(&package)));
                        roots.extend(INSIDE.iter().map(|inside| package.join(inside)));
                    }
                }
                let found = roots.iter().find_map(|root| self.below(root, names));
                // A tool may name each file by its stem: `#import helpers` is `helpers.wgsl` beside.
                let beside = |modules: &mut Self| {
                    let file = modules.with_ending(&folder.join(package)).filter(|_| names.is_empty())?;
                    let says = |line: &str| line.trim_start().starts_with("#define_import_path");
                    (!file.text().lines().any(says)).then_some(file)
                };
                found.or_else(|| beside(self))
            }
        }
    }

    fn modules(&mut self, from: &SourceFile) -> Vec<String> {
        let mut names = Vec::new();
        for project in self.projects(from) {
            names.extend(self.said(&project).keys().cloned());
        }
        let folder = folder_of(from);
        let around = ancestors(&folder);
        let beside = |path: &Path| path.strip_prefix(&folder).map(|rest| ("super", rest.with_extension(""))).ok();
        let root = stated_root(&around).or_else(|| around.iter().find(|f| f.join("Cargo.toml").exists()).cloned());
        for path in files_below(root.as_ref().unwrap_or(&folder)) {
            let inside = root.iter().find_map(|root| {
                let rest = path.strip_prefix(root).ok()?;
                let rest = INSIDE[1..].iter().find_map(|inside| rest.strip_prefix(inside).ok()).unwrap_or(rest);
                Some(("package", rest.with_extension("")))
            });
            for (origin, rest) in beside(&path).into_iter().chain(inside) {
                let parts = rest.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
                names.push([origin.to_owned()].into_iter().chain(parts).collect::<Vec<_>>().join("::"));
            }
        }
        names
    }

    fn siblings(&mut self, from: &SourceFile) -> Vec<SourceFile> {
        let folder = folder_of(from);
        let Ok(entries) = std::fs::read_dir(&folder) else { return Vec::new() };
        let mut paths: Vec<PathBuf> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
        paths.retain(|path| has_ending(path) && plain(path) != plain(Path::new(from.name())));
        paths.sort();
        paths.truncate(MOST_SIBLINGS);
        // A file that nobody named and that is no text is none of this one's business.
        let text = |path: &PathBuf| Some(decode(&plain(path), &read_source(path).ok()?).ok()?.file);
        paths.iter().filter_map(text).collect()
    }

    fn around(&mut self, from: &SourceFile) -> Vec<Vec<SourceFile>> {
        let (mut budget, mut found) = (Budget::default(), Vec::new());
        if self.around {
            hosts_around(Path::new(from.name()), &has_ending, &mut |paths| {
                let others = paths.iter().filter(|path| plain(path) != plain(Path::new(from.name())));
                found.push(others.take(MOST_SIBLINGS).filter_map(|path| budget.read(path)).collect());
                true
            });
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Composes the first of some files, and gives the text on one line or what is told.
    fn composed(files: &[(&str, &str)], folders: &[&str]) -> String {
        composed_by(files, folders, |modules| modules)
    }

    fn composed_by(files: &[(&str, &str)], folders: &[&str], looking: fn(Modules) -> Modules) -> String {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for (name, text) in files {
            std::fs::create_dir_all(at(name).parent().unwrap()).unwrap();
            std::fs::write(at(name), text).unwrap();
        }
        let file = SourceFile::new(at(files[0].0).display().to_string(), files[0].1);
        let mut modules = looking(Modules::new(folders.iter().map(|name| at(name)).collect()));
        let root = format!("{}/", folder.path().display());
        let shown = |d: &Diagnostic| {
            let help = d.help.as_ref().map(ToString::to_string).unwrap_or_default();
            format!("{} {} {} | {help}", d.code, d.file.locate(d.span.start), &*d.message).replace(&root, "")
        };
        match modules.compose(&file, &Options::default()) {
            Ok(composed) => composed.file.text().split_whitespace().collect::<Vec<_>>().join(" "),
            Err(ComposeError::Wrong(found)) => found.iter().map(shown).collect::<Vec<_>>().join("\n"),
            Err(error) => error.to_string().replace(&root, ""),
        }
    }

    #[test]
    fn packages_lie_around_and_beside_a_file() {
        let files = [
            (
                "crates/app/src/a/main.wesl",
                "import package::b::x; import other::c::y; import super::d::z; fn f() { x(); y(); z(); }",
            ),
            ("crates/app/src/b.wesl", "fn x() {}"),
            ("crates/app/src/a/d.wesl", "fn z() {}"),
            ("crates/app/Cargo.toml", ""),
            ("crates/other/src/c.wgsl", "fn y() {}"),
            ("Cargo.toml", ""),
        ];
        assert_eq!(composed(&files, &[]), "fn f() { x(); y(); z(); } fn x() {} fn y() {} fn z() {}");
        let files = [("main.wesl", "import lib::c::y; fn f() { y(); }"), ("far/lib/shaders/c.wesl", "fn y() {}")];
        assert!(composed(&files, &["far"]).ends_with("fn y() {}"));
        assert!(composed(&files, &[]).starts_with("E070 main.wesl:1:16 no module is found for `lib::c::y`"));
    }

    #[test]
    fn a_package_is_called_as_its_manifest_says() {
        let main = ("x/test/main.wesl", "import some_lib::c::y; fn f() { y(); }");
        for manifest in [
            ("x/package.json", "{ \"name\": \"@scope/some-lib\" }"),
            ("x/Cargo.toml", "[package]\nname = \"some-lib\"\n"),
            ("x/wesl.toml", "[package]\nname = \"some_lib\"\n"),
        ] {
            assert!(composed(&[main, manifest, ("x/c.wesl", "fn y() {}")], &[]).ends_with("fn y() {}"), "{manifest:?}");
        }
        let other = ("x/package.json", "{ \"name\": \"other\" }");
        assert!(composed(&[main, other, ("x/c.wesl", "fn y() {}")], &[]).starts_with("E070"));
    }

    #[test]
    fn the_root_of_a_package_is_where_its_manifest_says() {
        let files = [
            ("app/shaders/deep/main.wesl", "import package::b::x; fn f() { x(); }"),
            ("app/shaders/b.wesl", "fn x() {}"),
            ("app/shaders/deep/b.wesl", "fn x(wrong: i32) {}"),
            ("app/wesl.toml", "[package]\nroot = \"shaders\"\n"),
        ];
        assert!(composed(&files, &[]).ends_with("fn x() {}"));
    }

    #[test]
    fn modules_that_say_their_names_are_found_in_the_project() {
        let files = [
            ("src/main.wgsl", "#import engine::view::view\nfn f() -> vec4f { return view; }\n"),
            ("src/deep/v.wgsl", "// first\n#define_import_path engine::view\nvar<private> view: vec4f;\n"),
            ("target/v.wgsl", "#define_import_path engine::other\n"),
            ("Cargo.toml", ""),
        ];
        assert!(composed(&files, &[]).ends_with("var<private> view: vec4f;"));
        let wrong =
            [("src/main.wgsl", "#import engine::vieuw::view\nfn f() { view(); }\n"), files[1], files[2], files[3]];
        let told = composed(&wrong, &[]);
        assert!(told.contains("E070 src/main.wgsl:1:24") && told.contains("did you mean `engine::view`?"), "{told}");
    }

    #[test]
    fn included_files_lie_beside_or_in_a_named_folder() {
        let files = [
            ("main.wgsl", "#include \"a.inc\"\n#import <b.wgsl>\n#import c\nfn f() { a(); b(); c(); }\n"),
            ("a.inc", "fn a() {}\n"),
            ("b.wgsl", "fn b() {}\n"),
            ("lib/c.wgsl", "fn c() {}\n"),
        ];
        let text = composed(&files, &["lib"]);
        assert!(["fn a()", "fn b()", "fn c()"].iter().all(|f| text.contains(f)), "{text}");
        let without = [("main.wgsl", "#include \"parts/a\"\nfn f() { a(); }\n"), ("parts/a.wgsl", "fn a() {}\n")];
        assert!(composed(&without, &[]).contains("fn a()"));
        assert!(composed(&files, &[]).contains("E070 main.wgsl:3:9 no module is found for `c`"));
    }

    #[test]
    fn included_files_lie_in_the_folder_of_all_shaders_or_go_by_their_package() {
        let main = |named: &str| format!("#include \"{named}\"\nfn f() {{ a(); }}\n");
        let (around, package) = (main("parts/a.wgsl"), main("routines/a.wgsl"));
        let part = ("shaders/parts/a.wgsl", "fn a() {}\n");
        assert!(composed(&[("shaders/pool/main.wgsl", &around), part], &[]).contains("fn a()"));
        let beside = ("routines/src/a.wgsl", "fn a() {}\n");
        assert!(composed(&[("routines/src/main.wgsl", &package), beside], &[]).contains("fn a()"));
        let told = composed(&[("others/src/main.wgsl", &package), ("others/src/a.wgsl", "fn a() {}\n")], &[]);
        assert!(told.contains("E070 others/src/main.wgsl:1:1"), "{told}");
    }

    #[test]
    fn a_file_beside_is_a_module_by_its_stem() {
        let main = ("a/main.wgsl", "#import helpers;\nfn f(x: helpers::S) -> u32 { return helpers::g(x); }\n");
        let helpers = ("a/helpers.wgsl", "struct S { n: u32, }\nfn g(x: S) -> u32 { return x.n; }\n");
        let text = composed(&[main, helpers], &[]);
        assert!(text.contains("struct") && text.contains("return x.n;"), "{text}");
        let without = (main.0, "#import helpers\nfn f(x: helpers::S) -> u32 { return helpers::g(x); }\n");
        let text = composed(&[without, helpers], &[]);
        assert!(text.contains("return x.n;"), "{text}");
        // One that says another name goes by that.
        let named =
            ("a/helpers.wgsl", "#define_import_path other\nstruct S { n: u32, }\nfn g(x: S) -> u32 { return x.n; }\n");
        assert!(composed(&[main, named], &[]).contains("E070 a/main.wgsl:1:9 no module is found for `helpers`"));
        let wrong = (main.0, "#import helpers;\nfn f() -> u32 { return helpers::missing(); }\n");
        assert!(composed(&[wrong, helpers], &[]).contains("declares no `missing`"));
    }

    #[test]
    fn a_file_that_is_no_text_is_not_called_missing() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("b.wesl"), [0_u8, 159, 146, 150, 0, 1]).unwrap();
        let file = SourceFile::new(at("a.wesl").display().to_string(), "import super::b::x; fn f() { x(); }");
        let error = Modules::new(Vec::new()).compose(&file, &Options::default()).unwrap_err();
        assert!(matches!(&error, ComposeError::Unreadable(path, _) if path.ends_with("b.wesl")), "{error}");
    }

    #[test]
    fn files_in_folders_below_are_found_by_their_names() {
        let found = |files: &[(&str, &str)]| composed_by(files, &[], Modules::with_files_below);
        let main = ("a/main.wgsl", "#import config\nfn f() { n(); }\n");
        let here = ("a/shared/config.wgsl", "fn n() {}\n");
        assert!(found(&[main, here]).contains("fn n()"));
        let elsewhere = ("a/other/config.wgsl", "fn n() {}\n");
        let two = found(&[main, here, elsewhere]);
        assert!(!two.contains("fn n()"), "{two}");
        let beside = found(&[main, ("b/config.wgsl", "fn n() {}\n")]);
        assert!(!beside.contains("fn n()"), "{beside}");
        assert!(!composed(&[main, here], &[]).contains("fn n()"), "not asked for");
    }

    #[test]
    fn files_outside_are_read_only_where_they_are_shaders() {
        let files = [("a/main.wgsl", "#include \"../secret\"\nfn f() {}\n"), ("secret", "fn s() {}\n")];
        assert!(composed(&files, &[]).starts_with("E070 a/main.wgsl:1:1 `../secret` is not found"));
        let files = [("a/main.wgsl", "#include \"../b.wgsl\"\nfn f() {}\n"), ("b.wgsl", "fn s() {}\n")];
        assert!(composed(&files, &[]).contains("fn s()"));
    }
}
